"""Algebraic clean-up before a proof: the same function, written so that less is lost in enclosures.

- f + g - sqrt(f**2 + g**2), the conjunction of R_0 written out in roots, becomes the node again; so do the disjunction
  and trimming. The sign of a node is read off its operands; of the roots it is not, for they cancel.
- f**2 - g**2 with roots in f or g becomes (f - g)*(f + g): half of a leading edge each.
- Squares leave roots: sqrt(x**2*y**2 + x**2) = |x| sqrt(y**2 + 1), if what stays is never negative (else the root
  would be defined on fewer points: sqrt(x**2*(y - 1)) is 0 on x = 0); and moduli: |x**2*y| = x**2*|y|.
- Powers of a modulus become nodes with derivatives of their own: |x|**(5/2), x**2*|x| = |x|**3, and so on;
  written as products their derivatives are quotients by |x|, without a bound on a box around x = 0.
- A positive quadratic form under a root becomes a sum of squares.
- Angles fold: 1 - cos(u) = 2 sin(u/2)**2 under a root, asin(sin(u)) = atan2(sin(u), |cos(u)|), and so on.
- Steep profiles become exponentials that stay between 0 and 1, 1/(1 + exp(u)) = exp(-log(1 + exp(u))): of exp(u) on a
  box a ball keeps the largest value alone, and next to it 1 is nothing.

Nothing else. Every rule is an identity of real functions, also of where they are defined.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import sympy as sp

from rsym.model.functions import Softplus
from rsym.model.nodes import Trimming, expand_nodes
from rsym.model.powers import AbsolutePower, absolute_power, signed_power
from rsym.model.rnodes import R0Conjunction, R0Disjunction, R1Conjunction, R1Disjunction, R1Operation
from rsym.model.symbols import postorder, rebuild
from rsym.verify.angles import root_of_angles, unfolded
from rsym.verify.boxes.polynomials import sum_of_squares

ROUNDS = 3  # a rule may make room for another one
LARGEST = 4_000  # parts of an expression; a larger one is left as it is
FAR = 2**64  # a factor of omega beyond it drops
FACES = 3  # functions of which the largest counts, from which on they are leaves of their own
TERMS, DEGREE = 300, 24  # of a polynomial that is expanded or factored, at most


def cleaned(expression: sp.Expr) -> sp.Expr:
    """The expression with R_0 and trimming recognised in roots, and squares taken out of roots and moduli.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> cleaned(x + y**2 - sp.sqrt(x**2 + y**4))
    conjunction(x, y**2)
    >>> cleaned(sp.sqrt(x**2 * y**2 + x**2))
    sqrt(y**2 + 1)*Abs(x)
    """
    expression = rebuild(expression, lambda part: sp.Rational(part) if isinstance(part, sp.Float) else None)
    for _ in range(ROUNDS):
        if len(postorder(expression)) > LARGEST:
            break
        result = rebuild(rebuild(expression, _recognised), _freed)
        if result == expression:
            break
        expression = result
    return rebuild(expression, _gathered)


def spread(expression: sp.Expr) -> sp.Expr:
    """An expression with leaves that are a number less a multiple of the largest of many functions as conjunctions.

    c - k max(f, g, |h|) = min(c - k f, c - k g, c - k h, c + k h) for k > 0, and so on: the faces of a polyhedron are
    leaves, and its edges are between leaves.

    Examples
    --------
    >>> from rsym import R1, x, y, z
    >>> spread(1 - 2 * R1.disjunction(x, y, sp.Abs(x + y, evaluate=False)))
    conjunction(1 - 2*x, 1 - 2*y, -2*x - 2*y + 1, 2*x + 2*y + 1, system=R1)
    >>> spread(z - R1.disjunction(x, y, -x))
    z - disjunction(x, y, -x, system=R1)
    """
    leaves, stack = set(), [expression]
    while stack:
        part = stack.pop()
        if isinstance(part, R1Operation) or type(part) in {R0Conjunction, R0Disjunction}:
            stack.extend(part.args)
        elif isinstance(part, sp.Add):
            leaves.add(part)
    return rebuild(expression, lambda part: _faces(part) if part in leaves else None)


def _faces(part: sp.Add) -> sp.Expr | None:
    constant, rest = part.as_coeff_Add()
    factor, gate = rest.as_independent(R1Operation, as_Add=False)
    if not (isinstance(gate, R1Operation) and len(gate.args) >= FACES and (factor.is_positive or factor.is_negative)):
        return None
    upward = isinstance(gate, R1Disjunction)
    operands: list[sp.Expr] = []
    for operand in gate.args:
        split = upward and isinstance(operand, sp.Abs)
        operands += [operand.args[0], -operand.args[0]] if split else [operand]
    system = R1Disjunction if upward == bool(factor.is_positive) else R1Conjunction
    return system(*(constant + (factor * operand).expand() for operand in operands))


def without_scale(expression: sp.Expr) -> sp.Expr:
    """An expression of the same sign: a positive number that all terms share drops if it is far from 1.

    In float64 the squares of values below 1e-154 are 0, and nothing is proved of them.

    Examples
    --------
    >>> from rsym import x
    >>> without_scale((1 - x**2) / 10**300), without_scale((1 - x**2) / 2)
    (1 - x**2, 1/2 - x**2/2)
    """
    if not isinstance(expression, sp.Add | sp.Mul):
        return expression
    scale, rest = expression.primitive() if isinstance(expression, sp.Add) else expression.as_coeff_Mul()
    far = isinstance(scale, sp.Rational) and scale != 0 and not 1 / FAR < abs(scale) < FAR
    return (rest if scale > 0 else -rest) if far else expression


def _recognised(part: sp.Basic) -> sp.Basic | None:
    if isinstance(part, sp.Add):
        return _systems(part) or _squares(part)
    return _trimming(part) if _is_root(part) else None


def _freed(part: sp.Basic) -> sp.Basic | None:
    if isinstance(part, sp.asin | sp.acos):
        return unfolded(part)
    if isinstance(part, sp.tanh):
        return 1 - 2 * sp.exp(-Softplus(2 * part.args[0]))
    if isinstance(part, sp.Pow) and isinstance(part.exp, sp.Integer) and part.exp < 0:
        return _logistic(part)
    if isinstance(part, sp.Pow) and isinstance(part.exp, sp.Rational) and part.exp.q == 2:
        return _root_without_squares(part) or _root_of_squares(part) or root_of_angles(part)
    return _modulus_without_squares(part) if isinstance(part, sp.Abs) else None


def _logistic(power: sp.Pow) -> sp.Expr | None:
    """(c + k exp(u))**(-n) as exp(-n log(1 + exp(v)))/c**n with v = u + log(k/c), for positive numbers c and k."""
    constant, rest = power.base.as_coeff_Add()
    coefficient, wave = rest.as_coeff_Mul()
    if not (constant > 0 and coefficient > 0 and isinstance(wave, sp.exp)):
        return None
    exponent = wave.args[0] + sp.log(coefficient / constant)
    return constant**power.exp * sp.exp(power.exp * Softplus(exponent))


def _gathered(part: sp.Basic) -> sp.Basic | None:
    """u**k |u|**q as |u|**(k + q) for even k, sign(u) |u|**(k + q) for odd: for k >= 0, q > 0 and k + q > 1, not 2.

    Both sides are defined wherever u is. Of order 2 the boundary has a jump of curvature, which is proved by the two
    sides as they are written.
    """
    if not isinstance(part, sp.Mul | sp.Pow):
        return None
    factors, changed = list(sp.Mul.make_args(part)), False
    for factor in sp.Mul.make_args(part):
        modulus, exponent = factor.as_base_exp()
        if isinstance(factor, AbsolutePower):  # a part of the product that was gathered before
            modulus, exponent = sp.Abs(factor.args[0], evaluate=False), factor.args[1]
        if not (isinstance(modulus, sp.Abs) and isinstance(exponent, sp.Rational) and exponent > 0):
            continue
        base = modulus.args[0]
        power = next((other for other in factors if other.as_base_exp()[0] == base), sp.S.One)
        times = power.as_base_exp()[1] if power != 1 else sp.S.Zero
        if not (isinstance(times, sp.Integer) and times >= 0 and 1 < times + exponent != 2):
            continue
        factors.remove(factor)
        if power != 1:
            factors.remove(power)
        factors.append((absolute_power if times % 2 == 0 else signed_power)(base, times + exponent))
        changed = True
    return sp.Mul(*factors) if changed else None


def _is_root(part: sp.Basic) -> bool:
    return isinstance(part, sp.Pow) and part.exp == sp.S.Half


class Atoms:
    """Expressions as polynomials with rational coefficients, in whatever is not itself made by + - * and powers."""

    def __init__(self) -> None:
        self.names: dict[sp.Expr, sp.Symbol] = {}

    def polynomials(self, *masked: sp.Expr) -> list[sp.Poly] | None:
        """The polynomials of masked expressions; None if one is too large."""
        for part in masked:
            bulk = _bulk(part)
            if bulk is None or bulk[0] > TERMS or bulk[1] > DEGREE:
                return None
        symbols = list(self.names.values()) or [sp.Dummy()]
        return [sp.Poly(part, *symbols, domain=sp.QQ) for part in masked]

    def masked(self, part: sp.Expr) -> sp.Expr:
        """The expression with a symbol for each atom."""
        if isinstance(part, sp.Rational):
            return part
        if isinstance(part, sp.Add | sp.Mul):
            return part.func(*(self.masked(argument) for argument in part.args))
        if isinstance(part, sp.Pow) and isinstance(part.exp, sp.Integer) and part.exp > 0:
            return self.masked(part.base) ** part.exp
        return self.names.setdefault(part, sp.Dummy(real=True))

    def unmasked(self, polynomial: sp.Poly) -> sp.Expr:
        """Back again."""
        return polynomial.as_expr().xreplace({name: atom for atom, name in self.names.items()})


def _bulk(part: sp.Expr) -> tuple[int, int] | None:
    """Bounds of the number of terms and of the degree after expansion; None where they are beyond all use."""
    terms, degree = 1, 0
    if isinstance(part, sp.Add | sp.Mul):
        inner = [_bulk(argument) for argument in part.args]
        terms, degree = (0, 0) if isinstance(part, sp.Add) else (1, 0)
        for found in inner:
            if found is None:
                return None
            if isinstance(part, sp.Add):
                terms, degree = terms + found[0], max(degree, found[1])
            else:
                terms, degree = terms * found[0], degree + found[1]
    elif isinstance(part, sp.Pow):
        found = _bulk(part.base)
        exponent = int(part.exp)
        if found is None or exponent > DEGREE:
            return None
        terms, degree = found[0] ** exponent, found[1] * exponent
    elif part.is_Symbol:
        degree = 1
    return None if terms > TERMS else (terms, degree)


def _systems(total: sp.Add) -> sp.Expr | None:
    """k*(f + g) -+ k*sqrt(f**2 + g**2) + rest as k times the operation of R_0 + rest, for rational k."""
    for term in total.args:
        scale, root = term.as_coeff_Mul()
        if not isinstance(scale, sp.Rational) or not _is_root(root):
            continue
        others = sp.Add(*(other for other in total.args if other is not term))
        for f, g in _legs(root.base):
            for factor, kind in ((-scale, R0Conjunction), (scale, R0Disjunction)):
                rest = _difference(others, factor * f + factor * g)
                if rest is not None:
                    rest = (_systems(rest) or rest) if isinstance(rest, sp.Add) else rest
                    return factor * kind(f, g) + rest
    return None


def _squares(total: sp.Add) -> sp.Expr | None:
    """f**2 - g**2 as (f - g)*(f + g) where one of them has roots: of the product the zeros are seen one by one."""
    if len(total.args) != 2 or not any(_is_root(part) for part in postorder(total)):
        return None
    roots = [(_square_root(term), _square_root(-term)) for term in total.args]
    for (f, _), (_, g) in (roots, roots[::-1]):
        if f is not None and g is not None:
            return (f - g) * (f + g)
    return None


def _legs(radicand: sp.Expr) -> Iterator[tuple[sp.Expr, sp.Expr]]:
    """The pairs f, g with radicand = f**2 + g**2 as it is written, with all signs."""
    if not isinstance(radicand, sp.Add) or len(radicand.args) != 2:
        return
    roots = [_square_root(term) for term in radicand.args]
    if roots[0] is None or roots[1] is None:
        return
    yield from product(*([root, -root] for root in roots if root is not None))


def _square_root(term: sp.Expr) -> sp.Expr | None:
    """A u with u**2 equal to the term, if the term is a product of even powers."""
    result = sp.S.One
    for factor in sp.Mul.make_args(term):
        if isinstance(factor, sp.Rational) and factor > 0 and sp.sqrt(factor).is_Rational:
            result *= sp.sqrt(factor)
        elif isinstance(factor, sp.Pow) and isinstance(factor.exp, sp.Integer) and factor.exp % 2 == 0:
            result *= factor.base ** (factor.exp // 2)
        else:
            return None
    return result


def _difference(whole: sp.Expr, share: sp.Expr) -> sp.Expr | None:
    """Whole - share, if the share was added as such: all its terms go, or nothing is left after expansion."""
    for written in (share, expand_nodes(share)):
        rest = whole - written
        if _count(rest) == _count(whole) - _count(written):
            return rest
    return sp.S.Zero if _are_equal(expand_nodes(share), expand_nodes(whole)) else None


def _count(total: sp.Expr) -> int:
    return 0 if total == 0 else len(sp.Add.make_args(total))


def _trimming(root: sp.Pow) -> sp.Expr | None:
    """sqrt(f**2 + gap**2) with gap = (sqrt(t**2 + f**4) - t)/2."""
    if not isinstance(root.base, sp.Add) or len(root.base.args) != 2:
        return None
    for square, other in (root.base.args, root.base.args[::-1]):
        f, gap = _square_root(square), _square_root(other)
        if f is None or not isinstance(gap, sp.Add):
            continue
        for sign in (1, -1):  # the square of the gap is that of its negative
            for term in gap.args:
                scale, inner = term.as_coeff_Mul()
                if scale != sign * sp.S.Half or not _is_root(inner):
                    continue
                t = -2 * sign * sp.Add(*(rest for rest in gap.args if rest is not term))
                if _are_equal(expand_nodes(t) ** 2 + expand_nodes(f) ** 4, expand_nodes(inner.base)):
                    return Trimming(f, t)
    return None


def _root_without_squares(power: sp.Pow) -> sp.Expr | None:
    """P**(n/2) with P = p**2 * rest as |p|**n * rest**(n/2), if the rest is never negative."""
    taken = _factored(power.base)
    if taken is None:
        return None
    outside, inside = sp.S.One, taken[0]
    for factor, multiplicity in taken[1]:
        outside *= _modulus(factor, multiplicity // 2)
        inside *= factor if multiplicity % 2 else 1
    if outside == 1 or not _is_never_negative(inside):
        return None
    return outside ** (2 * power.exp) * sp.Pow(inside, power.exp)


def _root_of_squares(power: sp.Pow) -> sp.Expr | None:
    """sqrt(x**2 + x*y + y**2) as the root of a sum of squares, (x + y/2)**2 + 3*y**2/4: where it is zero is seen."""
    atoms = Atoms()
    found = atoms.polynomials(atoms.masked(power.base))
    if found is None or not all(atom.is_Symbol for atom in atoms.names):
        return None
    if all(max(powers) in (0, 2) for powers in found[0].monoms()):
        return None  # it is one already, or none
    squares = sum_of_squares(found[0])
    if not squares:
        return None
    return sp.Pow(sp.Add(*(factor * atoms.unmasked(form) ** 2 for factor, form in squares)), power.exp)


def _modulus_without_squares(modulus: sp.Abs) -> sp.Expr | None:
    """|P| with even powers of the factors of P outside."""
    taken = _factored(modulus.args[0])
    if taken is None or all(multiplicity == 1 for _, multiplicity in taken[1]):
        return None
    result = abs(taken[0])
    for factor, multiplicity in taken[1]:
        result *= _modulus(factor, multiplicity)
    return result


def _modulus(factor: sp.Expr, exponent: int) -> sp.Expr:
    """|factor|**exponent."""
    if exponent == 0:
        return sp.S.One
    even = factor ** (exponent - exponent % 2)
    return even * sp.Abs(factor, evaluate=False) if exponent % 2 else even


def _factored(expression: sp.Expr) -> tuple[sp.Rational, list[tuple[sp.Expr, int]]] | None:
    """The square-free factorisation of a polynomial."""
    atoms = Atoms()
    masked = atoms.masked(expression)
    found = atoms.polynomials(masked)
    if found is None or found[0].is_ground or found[0].free_symbols != set(atoms.names.values()):
        return None
    constant, factors = found[0].sqf_list()
    return constant, [(atoms.unmasked(factor), multiplicity) for factor, multiplicity in factors]


def _is_never_negative(expression: sp.Expr) -> bool:
    """Whether all terms are positive numbers times even powers, or a polynomial of one variable has no real root."""
    atoms = Atoms()
    found = atoms.polynomials(atoms.masked(expression))
    if found is None:
        return False
    terms = found[0].terms()
    if all(coefficient > 0 and all(power % 2 == 0 for power in powers) for powers, coefficient in terms):
        return True
    if len(found[0].free_symbols) != 1:
        return False
    single = sp.Poly(found[0].as_expr(), *found[0].free_symbols, domain=sp.QQ)
    return bool(single.LC() > 0 and single.count_roots() == 0)


def _are_equal(kept: sp.Expr, dropped: sp.Expr) -> bool:
    """Whether two expressions are one polynomial, and nothing can be undefined in the second that is not in the first.

    Terms may cancel, log(x) - log(x), but not the points where they are undefined.
    """
    atoms = Atoms()
    first = atoms.masked(kept)
    count = len(atoms.names)
    second = atoms.masked(dropped)
    found = atoms.polynomials(first, second) if len(atoms.names) == count else None
    return found is not None and found[0] == found[1]
