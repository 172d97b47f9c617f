"""How two leaves touch, by exact division: P_g = q P_f + c u**k v**m ..., with polynomials P that have their signs.

Where f = 0 the sign of g is then that of the rest c u**k v**m ..., and where q has one sign and the rest is never
negative, g is nowhere on the wrong side of f: one of both is absorbed. Along f = 0 = u they touch to the order k.

A leaf with square roots has such a polynomial too: (A + B r)(A - B r) = A**2 - B**2 s, with r = sqrt(s). Where the
conjugate A - B r has one sign the leaf has the sign of that polynomial, or the opposite one: the zeros of
R - sqrt(x**2 + y**2) are those of R**2 - x**2 - y**2, as R + sqrt(x**2 + y**2) is positive.

Where no remainder shows a contact the resultant by one coordinate may: it is h = s P_g - q P_f, free of that
coordinate, and has a double factor where the surfaces touch: of a ball and a torus in it, or of two circles that touch
where no coordinate is rational. Where s and q have their signs it is a remainder like others.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from rsym.program.lowering import lower
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.polynomials import polynomial_of

CANDIDATES = 4  # rests of a pair, by different orders of the coordinates
FACTORED = 80  # terms of a rest that is factored
ELIMINATED = 16  # product of two degrees in a coordinate that is eliminated


@dataclass(frozen=True)
class Contact:
    """multiplier P_second = quotient P_first + sign * product of factor**power; sign 0 where nothing is left: nodes."""

    first: int
    second: int
    multiplier: int
    quotient: int
    sign: int
    factors: tuple[tuple[int, int], ...]


class Contacts:
    """The relations of the leaves of one model, each found once."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.sought = True  # of bodies with many leaves not: there the search costs more than it settles
        self.leaves: dict[int, int] = {}  # of a polynomial the leaf that it was made of
        self._forms: dict[int, tuple[RootFree, int] | None] = {}
        self._contacts: dict[tuple[int, int], tuple[Contact, ...]] = {}
        self._multiples: dict[tuple[int, int], tuple[int, int]] = {}
        self._factors: dict[int, sp.Poly] = {}

    def form(self, leaf: int) -> tuple[RootFree, int] | None:
        """The polynomial of a leaf, and its node."""
        if leaf not in self._forms:
            found = root_free(self.model, leaf)
            node = None if found is None else lower(self.model.builder, found.polynomial.as_expr())
            self._forms[leaf] = None if found is None or node is None else (found, node)
            if node is not None:
                self.leaves[node] = leaf
        return self._forms[leaf]

    def between(self, f: int, g: int) -> tuple[Contact, ...]:
        """The relations of two leaves, those with the fewest factors that change their signs first."""
        key = (min(f, g), max(f, g))
        if key not in self._contacts:
            self._contacts[key] = tuple(self._found(*key))
        return self._contacts[key]

    def _found(self, f: int, g: int) -> list[Contact]:
        first, second = self.form(f), self.form(g)
        if first is None or second is None:
            return []
        if first[0].polynomial.total_degree() > second[0].polynomial.total_degree():
            f, g, first, second = g, f, second, first
        for ways in (_divisions, _resultants):
            rests: dict[sp.Poly, tuple[sp.Poly, sp.Poly]] = {}
            for multiplier, quotient, rest in ways(second[0].polynomial, first[0].polynomial):
                if not quotient.is_zero and len(rest.terms()) <= FACTORED:
                    rests.setdefault(rest, (multiplier, quotient))
            found = [self._contact(f, g, *factors, rest) for rest, factors in rests.items()]
            # Any two polynomials are related somehow: those touch, or have a face in common, whose rest says so.
            found = [one for one in found if one.sign == 0 or any(power > 1 for _, power in one.factors)]
            if found:
                break
        found.sort(key=lambda one: sum(power % 2 for _, power in one.factors))
        return found[:CANDIDATES]

    def _contact(self, f: int, g: int, multiplier: sp.Poly, quotient: sp.Poly, rest: sp.Poly) -> Contact:
        constant, factors = rest.factor_list() if not rest.is_zero else (sp.Integer(0), [])
        nodes = []
        for factor, power in factors:
            node = lower(self.model.builder, factor.as_expr())
            self._factors[node] = factor
            nodes.append((node, power))
        made = [lower(self.model.builder, one.as_expr()) for one in (multiplier, quotient)]
        return Contact(f, g, made[0], made[1], int(sp.sign(constant)), tuple(nodes))

    def multiple(self, leaf: int, factor: int) -> tuple[int, int]:
        """The power of the factor of a relation that the polynomial of a leaf has, and the node of what is left."""
        if (leaf, factor) not in self._multiples:
            form, power = self.form(leaf), 0
            rest = form[0].polynomial if form is not None else sp.Poly(1, *self._factors[factor].gens)
            while not rest.is_ground:
                quotient, remainder = sp.div(rest, self._factors[factor])
                if not remainder.is_zero:
                    break
                rest, power = quotient, power + 1
            self._multiples[leaf, factor] = power, lower(self.model.builder, rest.as_expr())
        return self._multiples[leaf, factor]


Related: TypeAlias = tuple[sp.Poly, sp.Poly, sp.Poly]  # multiplier, quotient and rest


def _divisions(dividend: sp.Poly, divisor: sp.Poly) -> Iterator[Related]:
    """Quotients and remainders, each coordinate being the leading one in turn."""
    gens = dividend.gens
    for turn in range(len(gens)):
        order = gens[turn:] + gens[:turn]
        (quotient,), rest = sp.reduced(dividend.as_expr(), [divisor.as_expr()], *order, order="lex", domain=sp.QQ)
        yield (dividend.one, *(sp.Poly(one, *gens, domain=sp.QQ) for one in (quotient, rest)))


def _resultants(second: sp.Poly, first: sp.Poly) -> Iterator[Related]:
    """What is left of two polynomials when a coordinate is eliminated: Euclid's algorithm, with both factors."""
    gens = first.gens
    for gen in gens:
        degrees = first.degree(gen), second.degree(gen)
        if 0 in degrees or degrees[0] * degrees[1] > ELIMINATED:
            continue
        ring = sp.QQ.poly_ring(*(other for other in gens if other != gen)) if len(gens) > 1 else sp.QQ
        rows = [(first, first.zero, first.one), (second, second.one, first.zero)]  # rest, multiplier, factor of first
        rows = [tuple(sp.Poly(one.as_expr(), gen, domain=ring) for one in row) for row in rows]
        rows.sort(key=lambda row: -int(row[0].degree()))
        while rows[1][0].degree() > 0:
            own, other = rows
            steps = int(own[0].degree()) - int(other[0].degree()) + 1
            scale = other[0].LC() ** steps
            quotient = own[0].pdiv(other[0])[0]
            rows = [other, tuple(a * scale - quotient * b for a, b in zip(own, other, strict=True))]
        rest, multiplier, factor = (sp.Poly(one.as_expr(), *gens, domain=sp.QQ) for one in rows[1])
        if not rest.is_zero and not multiplier.is_zero:
            shared = sp.gcd(sp.gcd(rest, multiplier), factor)
            yield tuple(one.quo(shared) for one in (multiplier, -factor, rest))


def contacts_of(model: Model) -> Contacts:
    """The relations of the leaves of a model, remembered with it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> model = Model(rsym.Shape(rsym.conjunction(1 - x**2 - y**2, 2 * z - x**2 - y**2 - z**2), (x, y, z)), {})
    >>> (found, *_) = contacts_of(model).between(*model.builder.nodes[model.root].arguments)
    >>> found.sign, [power for _, power in found.factors]
    (-1, [2])
    """
    return model.remembered(Contacts)


# Leaves with square roots as polynomials.
HIGHEST, MOST = 12, 200  # degree and number of terms of a polynomial that is worth its divisions
ROOTS = 3  # each doubles the degree


@dataclass(frozen=True)
class RootFree:
    """A polynomial that is the product of a leaf and the conjugates: nodes, each with the sign that is asked of it."""

    polynomial: sp.Poly
    conjugates: tuple[int, ...]

    def sign(self, local: Local) -> int:
        """What the sign of the polynomial is to be multiplied by on a box to be that of the leaf; 0 if not known."""
        sign = 1
        for conjugate in self.conjugates:
            local.value(conjugate)
            sign *= local.sign(conjugate)
        return sign


def root_free(model: Model, leaf: int) -> RootFree | None:
    """The polynomial of a leaf that is one in the coordinates and in square roots; None if it is no such leaf.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> model = Model(rsym.Shape(2 - sp.sqrt(x**2 + y**2), (x, y)), {})
    >>> root_free(model, model.root).polynomial.as_expr()
    -x**2 - y**2 + 4
    """
    symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
    roots: dict[sp.Symbol, sp.Expr] = {}
    expression = polynomial_of(model, leaf, roots)
    if expression is None or len(roots) > ROOTS:
        return None
    written: dict[sp.Symbol, sp.Expr] = {}
    for root, radicand in roots.items():
        written[root] = sp.sqrt(radicand.xreplace(written))
    conjugates = []
    for root in reversed(roots):  # an inner root stands before those around it
        even, odd = _halves(expression, root, roots[root])
        if odd != 0:
            conjugates.append((even - odd * root).xreplace(written))
        expression = sp.expand(even**2 - odd**2 * roots[root]) if odd != 0 else even
    polynomial = sp.Poly(expression, *symbols, domain=sp.QQ)
    if not 0 < polynomial.total_degree() <= HIGHEST or len(polynomial.terms()) > MOST:
        return None
    return RootFree(polynomial, tuple(lower(model.builder, conjugate) for conjugate in conjugates))


def _halves(expression: sp.Expr, root: sp.Symbol, radicand: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """A and B of an expression A + B r, with r**2 replaced by its radicand."""
    halves = [sp.Integer(0), sp.Integer(0)]
    for (power,), coefficient in sp.Poly(expression, root).terms():
        halves[power % 2] += coefficient * radicand ** (power // 2)
    return sp.expand(halves[0]), sp.expand(halves[1])
