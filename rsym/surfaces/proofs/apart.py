"""Proof that a point of one edge is away from another edge."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import pairwise
from typing import Any

from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.program.builder import Builder
from rsym.surfaces.functions.formulas import exact as decimal
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.proofs.edge_formulas import ALONG, ORDERS, PatchFormula
from rsym.surfaces.proofs.enclosures import BITS
from rsym.surfaces.proofs.sides import dot
from rsym.surfaces.proofs.specialised import PARAMETER, Part

# Series of the square of the distance: its first derivative is small where the edge is nearest.
ORDER = 4
# A gap of 1e-12 of the edge is told from none in 40 halvings; only the intervals round the nearest point are halved.
DEEPEST, MOST = 48, 600


def distance_from(
    first: tuple[PatchEdge, PatchFormula], place: Fraction, second: tuple[PatchEdge, PatchFormula], wanted: float
) -> float:
    """A lower bound, greater than what is wanted, of the distance of a point of one edge from all of another; or 0.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> low, high = (ParametricSurface((u, v, height)) for height in (0, 1))
    >>> edges = [(PatchEdge(one, "v0"), PatchFormula(one, {})) for one in (low, high)]
    >>> 0.99 < distance_from(edges[0], Fraction(1, 3), edges[1], 0.99) <= 1
    True
    """
    point, least, examined = _point(*first, place), math.inf, 0
    low, high = (Fraction(str(decimal(end))) for end in second[0].interval)
    for part, function in _pieces(*second, (low, high)):
        waiting = [(*part, 0)]
        while waiting:
            start, stop, depth = waiting.pop()
            examined += 1
            away = _away(function, point, (start, stop)) if point else 0.0
            if away > wanted:
                least = min(least, away)
            elif depth == DEEPEST or examined > MOST:
                return 0.0
            else:
                middle = (start + stop) / 2
                waiting += [(start, middle, depth + 1), (middle, stop, depth + 1)]
    return least


def _pieces(edge: PatchEdge, formula: PatchFormula, whole: Part) -> list[tuple[Part, SeriesFunction]]:
    """The parts of an edge without pieces."""
    waiting, found = [whole], []
    while waiting:
        part = waiting.pop()
        function, borders = _edge(edge, formula, part)
        if borders:
            waiting += pairwise([part[0], *borders, part[1]])
        else:
            found.append((part, function))
    return found


def _edge(edge: PatchEdge, formula: PatchFormula, part: Part) -> tuple[SeriesFunction, list[Fraction]]:
    """The points of an edge on a part, and where other formulas begin there."""
    target = Builder((PARAMETER,), ())
    jet = formula.jet(edge, target, part, ALONG, ORDERS[:1])
    borders = sorted(one for one in jet.borders if part[0] < one < part[1])
    return SeriesFunction(target.nodes, jet.nodes[:3]), borders


def _point(edge: PatchEdge, formula: PatchFormula, place: Fraction) -> list[Any] | None:
    """Balls for the coordinates of one point."""
    function, _ = _edge(edge, formula, (place, place))
    with truncated(0, BITS):
        values = [one[0] for one in function(exact(place)) if one is not None]
    return values if len(values) == 3 else None


def _away(function: SeriesFunction, point: list[Any], part: Part) -> float:
    """A lower bound of the distance of a part of an edge from a point."""
    middle, half = exact((part[0] + part[1]) / 2), exact((part[1] - part[0]) / 2)
    with truncated(ORDER, BITS):
        squares = []
        for place in (middle, ball(middle - half, middle + half)):
            values = [one for one in function(place) if one is not None]
            if len(values) < 3:
                return 0.0
            away = [one - coordinate for one, coordinate in zip(values, point, strict=True)]
            squares.append(dot(away, away))
        total, power = arb(0), arb(1)
        for k in range(ORDER + 1):
            total = total + squares[k == ORDER][k] * (ball(-power if k % 2 else arb(0), power) if k else power)
            power = power * half
        low = float(total.nonnegative_part().sqrt().lower()) if total.is_finite() else 0.0
    return max(0.0, math.nextafter(low, -math.inf))
