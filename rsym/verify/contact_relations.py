"""How two leaves touch, by exact division: P_g = q P_f + c u**k v**m ..., with polynomials P that have their signs.

Where f = 0 the sign of g is then that of the rest c u**k v**m ..., and where q has one sign and the rest is never
negative, g is nowhere on the wrong side of f: one of both is absorbed. Along f = 0 = u they touch to the order k.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from rsym.program.lowering import lower
from rsym.verify.local import Model
from rsym.verify.root_free import RootFree, root_free

CANDIDATES = 4  # rests of a pair, by different orders of the coordinates
FACTORED = 80  # terms of a rest that is factored


@dataclass(frozen=True)
class Contact:
    """P_second = quotient P_first + sign * product of factor**power; sign 0 where nothing is left. All are nodes."""

    first: int
    second: int
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
        rests: dict[sp.Poly, sp.Poly] = {}
        for quotient, rest in _divisions(second[0].polynomial, first[0].polynomial):
            if not quotient.is_zero and len(rest.terms()) <= FACTORED:
                rests.setdefault(rest, quotient)
        found = [self._contact(f, g, quotient, rest) for rest, quotient in rests.items()]
        # Any two polynomials are related somehow: those touch, or have a face in common, whose rest says so.
        found = [one for one in found if one.sign == 0 or any(power > 1 for _, power in one.factors)]
        found.sort(key=lambda one: sum(power % 2 for _, power in one.factors))
        return found[:CANDIDATES]

    def _contact(self, f: int, g: int, quotient: sp.Poly, rest: sp.Poly) -> Contact:
        constant, factors = rest.factor_list() if not rest.is_zero else (sp.Integer(0), [])
        nodes = []
        for factor, power in factors:
            node = lower(self.model.builder, factor.as_expr())
            self._factors[node] = factor
            nodes.append((node, power))
        made = lower(self.model.builder, quotient.as_expr())
        return Contact(f, g, made, int(sp.sign(constant)), tuple(nodes))

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


def _divisions(dividend: sp.Poly, divisor: sp.Poly) -> list[tuple[sp.Poly, sp.Poly]]:
    """Quotients and remainders, each coordinate being the leading one in turn."""
    gens, found = dividend.gens, []
    for turn in range(len(gens)):
        order = gens[turn:] + gens[:turn]
        (quotient,), rest = sp.reduced(dividend.as_expr(), [divisor.as_expr()], *order, order="lex", domain=sp.QQ)
        found.append((sp.Poly(quotient, *gens, domain=sp.QQ), sp.Poly(rest, *gens, domain=sp.QQ)))
    return found


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
