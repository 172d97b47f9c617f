"""Where lines cross a domain that an R-function describes.

The sign of an R-operation depends on those of its operands alone. So along a
line the domain changes only where a *leaf*, an operand without an R-operation
on top, has a root; and what happens between two roots is decided by signs, for
which 0 counts as on the boundary: a line may run along it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import brentq

from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.model.operations import conjunction
from rsym.model.rnodes import ROperation
from rsym.model.shape import Shape
from rsym.model.symbols import substitute, x, y
from rsym.sampling.windows import bounds_or_extent
from rsym.surfaces.chords.lines import NEGLIGIBLE, Chord, Line, point_of, real_constant, real_expression
from rsym.surfaces.functions.formulas import CompiledFormulas
from rsym.surfaces.symbols import t

DIGITS = 30  # twice those of float64, so that rounding to it happens once

PIECES = 64
# Pieces left open at once. A simple root keeps one, a double root a few dozen; thousands mean a function that is 0
# along a stretch or undefined there.
MOST = 4096
# Of the interval; shorter pieces are points to float64.
SHORTEST = 1e-14


@dataclass(frozen=True)
class LineLeaf:
    """A leaf along a line: its roots, and its sign at a number."""

    roots: list[sp.Expr]
    sign: Callable[[float], int]


def as_domain(given: Any) -> Shape:
    """A domain from a shape of the plane, from an expression in x and y, or from the corners of a convex polygon.

    Examples
    --------
    >>> as_domain([(0, 0), (1, 0), (0, 1)]).expression
    conjunction(y, -x - y + 1, x)
    """
    if isinstance(given, Shape):
        if given.dimension != 2:
            raise RsymError("expected a domain in the plane, got a shape in space", code="coordinates")
        values = {sp.Symbol(name, real=True): sp.sympify(one.default) for name, one in given.letters.items()}
        expression = substitute(given.expression, values | dict(zip(given.coordinates, (x, y), strict=True)))
        return Shape(_exact(expression), (x, y), bounds=given.bounds)
    if isinstance(given, sp.Expr):
        return Shape(_exact(real_expression(given)), (x, y))
    if isinstance(given, list | tuple | np.ndarray) and len(given) >= 3:
        return Shape(_polygon([point_of(one, "a corner") for one in given]), (x, y))
    raise RsymError(
        f"expected a domain, got {given!r}",
        code="domain",
        remedy="give a Shape in the plane, an expression in x and y, or the corners of a convex polygon",
    )


def _exact(expression: sp.Expr) -> sp.Expr:
    floats = {number: real_constant(number, "a number") for number in expression.atoms(sp.Float)}
    return expression.xreplace(floats)


def _polygon(corners: Sequence[tuple[sp.Expr, sp.Expr]]) -> sp.Expr:
    """The conjunction of the half planes beside the sides."""
    following = [*corners[1:], corners[0]]
    sides = [(x1 - x0, y1 - y0) for (x0, y0), (x1, y1) in zip(corners, following, strict=True)]
    turns = [float(a[0] * b[1] - a[1] * b[0]) for a, b in zip(sides, [*sides[1:], sides[0]], strict=True)]
    angles = [math.atan2(float(dy), float(dx)) for dx, dy in sides]
    turned = sum(abs(math.remainder(b - a, math.tau)) for a, b in zip(angles, [*angles[1:], angles[0]], strict=True))
    if not (all(one > 0 for one in turns) or all(one < 0 for one in turns)) or turned > 1.5 * math.tau:
        raise RsymError(
            "the corners are not those of a convex polygon, one after the other",
            code="not-convex",
            remedy="leave out corners on a side; split a polygon that is not convex",
        )
    sense = 1 if turns[0] > 0 else -1
    halves = [
        sp.expand(sense * (dx * (y - y0) - dy * (x - x0))) for (x0, y0), (dx, dy) in zip(corners, sides, strict=True)
    ]
    result: sp.Expr = conjunction(*halves)
    return result


def chord_of(domain: Shape, line: Line, where: str) -> Chord:
    """The part of a line in a convex domain.

    Raises
    ------
    RsymError
        ``line`` where the line misses the domain, ``not-convex`` where it meets it in several pieces, ``unbounded``
        where the domain goes on along it.

    Examples
    --------
    >>> disc = as_domain(4 - x**2 - y**2)
    >>> chord_of(disc, Line(*map(sp.Integer, (0, 1, 1))), "").ends
    ((sqrt(3), 1), (-sqrt(3), 1))
    """
    foot, direction = line.foot, (-line.b, line.a)
    whole = Chord(foot, direction, sp.S.One)
    low, high = -math.inf, math.inf
    if not all(whole.along(leaf).is_polynomial(t) for leaf in _leaves(domain.expression)):
        low, high = _range_in_box(domain, whole)
    leaves: dict[sp.Expr, LineLeaf] = {}
    for leaf in _leaves(domain.expression):
        leaves[leaf] = _leaf_along(whole.along(leaf), low, high)
    cuts = _distinct([root for leaf in leaves.values() for root in leaf.roots])
    (start, end) = _piece(domain, leaves, cuts, (low, high), line, where)
    middle = sp.radsimp(sp.expand((start + end) / 2))
    place = tuple(sp.expand(p + middle * d) for p, d in zip(foot, direction, strict=True))
    return replace(whole, middle=place, square=sp.radsimp(sp.expand(((end - start) / 2) ** 2)))


def _leaves(expression: sp.Expr) -> list[sp.Expr]:
    """The operands without an R-operation on top."""
    if isinstance(expression, ROperation):
        return [leaf for operand in expression.operands for leaf in _leaves(operand)]
    factor, rest = expression.as_coeff_Mul()
    return [expression] if factor == 1 else _leaves(rest)


def _sign(expression: sp.Expr, leaves: dict[sp.Expr, LineLeaf], place: float) -> int:
    """The sign of an R-function from those of its leaves."""
    if isinstance(expression, ROperation):
        signs = [_sign(operand, leaves, place) for operand in expression.operands]
        return min(signs) if expression.sign < 0 else max(signs)
    if expression in leaves:
        return leaves[expression].sign(place)
    factor, rest = expression.as_coeff_Mul()
    return int(sp.sign(factor)) * _sign(rest, leaves, place)


def _leaf_along(restricted: sp.Expr, low: float, high: float) -> LineLeaf:
    """A leaf as a function of t."""
    if not restricted.is_polynomial(t):
        return LineLeaf(*roots_between(restricted, low, high))
    polynomial = sp.Poly(sp.expand(restricted), t)
    if polynomial.is_zero:
        return LineLeaf([], lambda place: 0)
    exact = polynomial.degree() <= 2
    roots = sp.roots(polynomial, multiple=True) if exact else _numeric_roots(polynomial)
    real = [sp.radsimp(root) for root in roots if abs(sp.im(sp.N(root, DIGITS))) < NEGLIGIBLE]
    return LineLeaf(real, lambda place: int(sp.sign(polynomial.eval(sp.Rational(place)))))


def _numeric_roots(polynomial: sp.Poly) -> list[sp.Float]:
    """Real roots to rounding: isolated exactly where the coefficients are rational."""
    if polynomial.domain.is_QQ or polynomial.domain.is_ZZ:
        return [sp.Float(sp.N(root, DIGITS)) for root in polynomial.real_roots()]
    found = polynomial.nroots(n=DIGITS)
    return [sp.Float(sp.re(root)) for root in found if abs(sp.im(root)) < NEGLIGIBLE * (1 + abs(root))]


def _range_in_box(domain: Shape, chord: Chord) -> tuple[float, float]:
    """The numbers t between which a line is in the bounds of the domain, or in its extent."""
    low, high = -math.inf, math.inf
    for ends, place, step in zip(bounds_or_extent(domain, None), chord.middle, chord.direction, strict=True):
        if step == 0:
            continue
        first, last = sorted((end - float(place)) / float(step) for end in ends)
        low, high = max(low, first), min(high, last)
    return (low, high) if low < high else (0.0, 0.0)


def _distinct(roots: list[sp.Expr]) -> list[sp.Expr]:
    """The roots in ascending order, each once and the simplest way it is written."""
    result: list[sp.Expr] = []
    size = max((abs(float(root)) for root in roots), default=0.0)
    for root in sorted(roots, key=float):
        if result and float(root) - float(result[-1]) <= NEGLIGIBLE * size:
            result[-1] = min(result[-1], root, key=lambda one: (isinstance(one, sp.Float), one.count_ops()))
        else:
            result.append(root)
    return result


def _piece(
    domain: Shape,
    leaves: dict[sp.Expr, LineLeaf],
    cuts: list[sp.Expr],
    limits: tuple[float, float],
    line: Line,
    where: str,
) -> tuple[sp.Expr, sp.Expr]:
    """The ends in t of the only stretch of a line on which the domain is."""
    ends = [limits[0], *map(float, cuts), limits[1]]
    inside = [_sign(domain.expression, leaves, _between(a, b)) >= 0 for a, b in pairwise(ends)]
    if not any(inside):
        raise RsymError(
            f"the line {line} misses the domain",
            code="line",
            where=where,
            remedy="the domain is where its function is >= 0; every line must cross it",
        )
    if inside[0] or inside[-1]:
        raise RsymError(
            f"the domain does not end along {line}",
            code="unbounded",
            where=where,
            remedy="conjunct it with a box, or widen the bounds of the shape if they cut it off",
        )
    first, last = inside.index(True), len(inside) - 1 - inside[::-1].index(True)
    if not all(inside[first : last + 1]):
        places = ", ".join(f"{float(cut):.6g}" for cut in cuts)
        raise RsymError(
            f"the line {line} meets the domain in several pieces: it is not convex (cuts at {places} along the line)",
            code="not-convex",
            where=where,
            remedy="split the domain into convex ones",
        )
    return cuts[first - 1], cuts[last]


def _between(a: float, b: float) -> float:
    """A number between two, either of which may be infinite."""
    if math.isinf(a) and math.isinf(b):
        return 0.0
    if math.isinf(a):
        return b - 1 - abs(b)
    return a + 1 + abs(a) if math.isinf(b) else (a + b) / 2


# All roots of a function of one parameter on an interval, none overlooked: intervals exclude, signs bracket.
def roots_between(expression: sp.Expr, low: float, high: float) -> tuple[list[sp.Expr], Callable[[float], int]]:
    """The roots in [low, high] of an expression in t, and its sign as a function of a number.

    Examples
    --------
    >>> roots, sign = roots_between(sp.exp(t) - 2, 0.0, 1.0)
    >>> [round(float(root), 12) for root in roots], sign(0.5), sign(0.75)
    ([0.69314718056], -1, 1)
    """
    formulas = CompiledFormulas([expression], (t.name,), Letters({}), ((low, high),))

    def value(place: float) -> float:
        return float(formulas.evaluate([np.array([place])], [(0,)], {})[0][0, 0])

    function = IntervalFunction(formulas.program([(0,), (1,)]))
    edges = np.linspace(low, high, PIECES + 1)
    lower, upper = edges[:-1], edges[1:]
    found: list[float] = []
    while len(lower):
        height, slope = (function([lower], [upper])[name] for name in ("0_0", "0_1"))
        possible = (height[0] <= 0) & (height[1] >= 0)
        monotone = possible & ((slope[0] > 0) | (slope[1] < 0))
        doubtful = possible & ~monotone
        found += [root for a, b in zip(lower[monotone], upper[monotone], strict=True) for root in _single(value, a, b)]
        short = doubtful & (upper - lower <= SHORTEST * (high - low))
        found += ((lower[short] + upper[short]) / 2).tolist()
        lower, upper = lower[doubtful & ~short], upper[doubtful & ~short]
        middle = (lower + upper) / 2
        lower, upper = np.concatenate([lower, middle]), np.concatenate([middle, upper])
        if len(lower) > MOST:
            raise RsymError(
                f"where {expression} vanishes along the line cannot be told",
                code="undecided",
                remedy="describe the boundary of the domain by functions that are defined and not 0 along a stretch",
            )
    return [sp.Float(root) for root in sorted(found)], lambda place: int(np.sign(value(place)))


def _single(value: Callable[[float], float], low: float, high: float) -> list[float]:
    """The root of a monotone function between two numbers, if there is one."""
    first, last = value(low), value(high)
    if first == 0 or last == 0:
        return [low if first == 0 else high]
    return [float(brentq(value, low, high, xtol=1e-300, rtol=4 * np.finfo(float).eps))] if first * last < 0 else []
