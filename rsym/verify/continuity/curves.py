"""Parametric curves, and what they bring to their ends: tangent, curvature, and its rate of change."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations

import sympy as sp

from rsym.errors import RsymError
from rsym.model.functions import FUNCTIONS
from rsym.model.symbols import as_expression
from rsym.verify.boxes.constants import enclosed, exact, vanishes

# Analytic wherever they are defined (asin is not: at 1 it ends, upright); where that is, is examined for powers, tan,
# cot and log.
ANALYTIC = (
    *(sp.Symbol, sp.Rational, sp.NumberSymbol, sp.Add, sp.Mul, sp.Pow),
    *(row.kind for row in FUNCTIONS.values() if row.analytic),
)
# A velocity that vanishes to a higher order than this is no longer examined.
HIGHEST_ORDER = 4

Vector = tuple[sp.Expr, ...]


@dataclass(frozen=True)
class Curve:
    """A curve in the plane or in space, p(t) for t from `start` to `end`, in that direction.

    Parameters
    ----------
    expressions : sequence of 2 or 3 expressions
        The coordinates.
    parameter : Symbol
        The parameter t, the only symbol of the coordinates.
    start, end : number or constant expression
        Where t begins and ends; taken exactly, a float as its binary value. `end` may lie below `start`.

    Raises
    ------
    RsymError
        If there are not 2 or 3 coordinates, if another symbol occurs, or if the interval is empty.

    Examples
    --------
    >>> t = sp.Symbol("t")
    >>> Curve((sp.cos(t), sp.sin(t)), t, 0, sp.pi / 2).dimension
    2
    """

    expressions: tuple[sp.Expr, ...]
    parameter: sp.Symbol
    start: sp.Expr
    end: sp.Expr

    def __post_init__(self) -> None:
        for name in ("start", "end"):
            object.__setattr__(self, name, exact(as_expression(getattr(self, name))))
        given = self.expressions if isinstance(self.expressions, Iterable) else ()
        object.__setattr__(self, "expressions", tuple(exact(as_expression(e)) for e in given))
        if self.dimension not in (2, 3):
            raise _refused(f"expected 2 or 3 coordinates, got {self.dimension}", "give (x, y) or (x, y, z)")
        free = set().union(*(e.free_symbols for e in self.expressions)) - {self.parameter}
        if free or self.start.free_symbols or self.end.free_symbols:
            names = ", ".join(sorted(map(str, free | self.start.free_symbols | self.end.free_symbols)))
            raise _refused(f"expected no symbol but {self.parameter}, got {names}", "put numbers for them")
        if vanishes(self.end - self.start) is not False:
            raise _refused(f"expected an interval, got {self.start} to {self.end}", "let the ends differ")
        for part in (part for e in self.expressions for part in sp.preorder_traversal(e)):
            if not isinstance(part, ANALYTIC):
                raise _refused(f"expected analytic coordinates, got {part}", "split the curve where it is not smooth")

    @property
    def dimension(self) -> int:
        """How many coordinates it has."""
        return len(self.expressions)

    @property
    def sense(self) -> int:
        """1 if the parameter grows along the curve, else -1."""
        ball = enclosed(self.end - self.start)
        return 1 if ball is not None and ball > 0 else -1


def _refused(message: str, remedy: str) -> RsymError:
    return RsymError(message, code="curve", remedy=remedy)


@dataclass(frozen=True)
class End:
    """One end of a curve, exactly: the point, a vector along the tangent, the curvature vector, the rate of change.

    Where p' is not zero, K = p_ss = (p''|p'|^2 - p'(p'.p''))/|p'|^4 and rate = dK/dt, so that p_sss = rate/|p'|.
    Where p' = ... = p^(m-1) = 0, see `_standing`: the tangent is that of p^(m), and the curve is
    looked at as a graph over it; K is `unbounded`, or its rate is (`rough`), where fractional powers remain. What
    cannot be decided is None, `doubt` says why; `standing`: no derivative up to the fourth but vanishes. `order` is
    m, 0 if it is not known.
    """

    point: Vector
    tangent: Vector | None = None
    curvature: Vector | None = None
    rate: Vector | None = None
    unbounded: bool = False
    doubt: str = ""
    standing: bool = False
    rough: bool = False
    order: int = 0


def dot(a: Sequence[sp.Expr], b: Sequence[sp.Expr]) -> sp.Expr:
    """The scalar product.

    Examples
    --------
    >>> dot((1, 2), (3, 4))
    11
    """
    return sum((u * v for u, v in zip(a, b, strict=True)), sp.Integer(0))


def minors(a: Sequence[sp.Expr], b: Sequence[sp.Expr]) -> Vector:
    """The components of the vector product: one in the plane, three in space up to order and sign.

    Examples
    --------
    >>> minors((1, 2), (3, 4))
    (-2,)
    """
    return tuple(a[i] * b[j] - a[j] * b[i] for i, j in combinations(range(len(a)), 2))


def all_vanish(vector: Sequence[sp.Expr]) -> bool | None:
    """Whether a vector is zero, proved either way; None if it is not known.

    Examples
    --------
    >>> all_vanish((sp.Integer(0), sp.sqrt(4) - 2)), all_vanish((sp.Integer(0), sp.Integer(1)))
    (True, False)
    """
    # Balls are cheap, algebra is not: one component that is not zero is enough.
    balls = [enclosed(component) for component in vector]
    if any(ball is not None and (ball > 0 or ball < 0) for ball in balls):
        return False
    found = [vanishes(component) for component in vector]
    return False if False in found else None if None in found else True


def end_of(curve: Curve, at_start: bool) -> End:
    """What a curve brings to its start or to its end, directed as it is run through.

    Examples
    --------
    >>> t = sp.Symbol("t")
    >>> end = end_of(Curve((2 * sp.cos(t), 2 * sp.sin(t)), t, 0, 1), at_start=True)
    >>> end.tangent, end.curvature
    ((0, 2), (-1/2, 0))
    >>> end_of(Curve((t**2, t**3), t, 0, 1), at_start=True).unbounded
    True
    """
    place = curve.start if at_start else curve.end
    point = tuple(_at(expression, curve, place) for expression in curve.expressions)
    if not is_analytic_at(curve, place):
        return End(point, doubt="the coordinates are not known to be analytic here; another parameter may be")
    for order in range(1, HIGHEST_ORDER + 1):
        first = derivative_at(curve, place, order)
        still = all_vanish(first)
        if still is None:
            return End(point, doubt="whether the velocity is zero is not decided")
        if not still:
            return _moving(curve, place, order, at_start)
    return End(point, doubt="the first four derivatives are zero", standing=True)


def _at(expression: sp.Expr, curve: Curve, place: sp.Expr) -> sp.Expr:
    return expression.subs(curve.parameter, place)


def derivative_at(curve: Curve, place: sp.Expr, order: int) -> Vector:
    """The derivative of some order at a place, with respect to a parameter that grows along the curve.

    Examples
    --------
    >>> t = sp.Symbol("t")
    >>> derivative_at(Curve((t**2, t**3), t, 1, 0), sp.Integer(1), 1)
    (-2, -3)
    """
    return tuple(
        curve.sense**order * _at(_differentiated(expression, curve.parameter, order), curve, place)
        for expression in curve.expressions
    )


@lru_cache(maxsize=512)
def _differentiated(expression: sp.Expr, parameter: sp.Symbol, order: int) -> sp.Expr:
    """A derivative from the one before; polynomials are multiplied out, which keeps them short."""
    if order == 0:
        return sp.expand(expression) if expression.is_polynomial(parameter) else expression
    return sp.diff(_differentiated(expression, parameter, order - 1), parameter)


def is_analytic_at(curve: Curve, place: sp.Expr) -> bool:
    """Whether every root and logarithm has a positive argument at a place, and every denominator is not zero.

    Examples
    --------
    >>> t = sp.Symbol("t")
    >>> curve = Curve((t, sp.sqrt(t)), t, 0, 1)
    >>> is_analytic_at(curve, sp.Integer(0)), is_analytic_at(curve, sp.Integer(1))
    (False, True)
    """
    return all(_analytic(expression, curve, place) for expression in curve.expressions)


def _analytic(expression: sp.Expr, curve: Curve, place: sp.Expr) -> bool:
    for part in sp.preorder_traversal(expression):
        if not part.has(curve.parameter):
            continue
        if isinstance(part, sp.tan):
            condition, strict = sp.cos(part.args[0]), False
        elif isinstance(part, sp.log):
            condition, strict = part.args[0], True
        elif isinstance(part, sp.Pow) and not (part.exp.is_Integer and part.exp > 0):
            condition, strict = part.base, not part.exp.is_Integer
        else:
            continue
        ball = enclosed(_at(condition, curve, place))
        if ball is None or not (ball > 0 or (not strict and ball < 0)):
            return False
    return True


def _moving(curve: Curve, place: sp.Expr, order: int, at_start: bool) -> End:
    """The first derivative that is not zero has this order."""
    point = tuple(_at(expression, curve, place) for expression in curve.expressions)
    if order > 1:
        jets = [derivative_at(curve, place, one) for one in range(1, 3 * order + 1)]
        return _standing(point, jets, order, at_start)
    jets = [derivative_at(curve, place, one) for one in (1, 2, 3)]
    return End(point, jets[0], _across(jets[1], jets[0], dot(jets[0], jets[0])), _rate(jets), order=1)


def _standing(point: Vector, jets: list[Vector], order: int, at_start: bool) -> End:
    """The end of a curve whose derivatives below this order vanish, as a graph over its tangent.

    With q = p^(m), X = q.(p - p(end))/|q|^2 = t^m/m! + ... and Y the part of p - p(end) across q, the curve is Y over
    X. As X^(1/m) is an analytic parameter, Y is a series of it: Y = A X^2 + B X^3 + o(X^3) if and only if no power of
    t between the m-th, the 2m-th and the 3m-th is left in Y, and then in Y - A X^2. With the length x = |q| X along
    the tangent Y = (A/|q|^2) x^2 + (B/|q|^3) x^3: p_ss = 2A/|q|^2, and p_sss is 6B/|q|^3 across and -|p_ss|^2 along.
    Before an end of even order the curve comes from where q points to, and so runs against it.
    """
    q = jets[order - 1]
    sign, size = 1 if at_start else (-1) ** (order - 1), dot(q, q)
    tangent = tuple(sign * one for one in q)
    scaled = [tuple(one / sp.factorial(k) for one in jet) for k, jet in enumerate(jets, 1)]
    along = [sp.Integer(0), *(dot(q, one) / size for one in scaled)]
    across = [(sp.Integer(0),) * len(q), *(_minus_share(one, q, x) for one, x in zip(scaled, along[1:], strict=True))]
    left = [all_vanish(one) for one in across[order + 1 : 2 * order]]
    if False in left:
        return End(point, tangent, unbounded=True, order=order)
    if None in left:
        return End(point, tangent, doubt="whether the curvature is bounded is not decided", order=order)
    half = tuple(sp.factorial(order) ** 2 * one for one in across[2 * order])
    bend = tuple(2 * one / size for one in half)
    squares = [sum((along[i] * along[k - i] for i in range(k + 1)), sp.Integer(0)) for k in range(3 * order + 1)]
    rest = [
        tuple(y - a * square for y, a in zip(one, half, strict=True))
        for one, square in zip(across, squares, strict=True)
    ]
    left = [all_vanish(one) for one in rest[2 * order + 1 : 3 * order]]
    if False in left:
        return End(point, tangent, bend, rough=True, order=order)
    if None in left:
        return End(point, tangent, bend, order=order)
    third = [6 * sp.factorial(order) ** 3 * one / size for one in rest[3 * order]]
    rate = tuple(sign * (b - dot(bend, bend) * one) for b, one in zip(third, q, strict=True))
    return End(point, tangent, bend, rate, order=order)


def _minus_share(vector: Vector, tangent: Vector, share: sp.Expr) -> Vector:
    return tuple(a - share * t for a, t in zip(vector, tangent, strict=True))


def _across(vector: Vector, tangent: Vector, size: sp.Expr) -> Vector:
    """The part of a vector across the tangent, divided by the square of the speed."""
    share = dot(vector, tangent) / size
    return tuple((a - share * t) / size for a, t in zip(vector, tangent, strict=True))


def _rate(jets: list[Vector]) -> Vector:
    """dK/dt of K = p''/q - p' (p'.p'')/q^2 with q = |p'|^2."""
    v, a, j = jets[:3]
    q, va = dot(v, v), dot(v, a)
    beside = (dot(a, a) + dot(v, j)) / q**2 - 4 * va**2 / q**3
    return tuple(jk / q - 3 * ak * va / q**2 - vk * beside for vk, ak, jk in zip(v, a, j, strict=True))


def determinant(a: Vector, b: Vector, c: Vector) -> sp.Expr:
    """The determinant of three vectors of space.

    Examples
    --------
    >>> determinant((1, 0, 0), (0, 1, 0), (0, 0, 2))
    2
    """
    # SymPy's determinants simplify on the way, which may take minutes.
    return dot(a, (b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]))
