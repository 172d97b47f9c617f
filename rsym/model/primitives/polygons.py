"""Polygons: half-planes of edges in R-operations, each edge once."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import sympy as sp

from rsym.errors import RsymError, warn
from rsym.model.arguments import LetterMapping, Point, default, point, positive, whole
from rsym.model.blends.rho import Rho
from rsym.model.primitives.formulas import box_around
from rsym.model.primitives.outlines import (
    Branch,
    Junction,
    Place,
    area,
    check_simple,
    in_symmetric_pairs,
    mirrors,
    monotone_formula,
    nearness,
    shown,
    straight,
)
from rsym.model.primitives.plane import right_of
from rsym.model.shape import Shape
from rsym.model.symbols import PLANE, symbols_of, x, y
from rsym.model.systems import R0, RSystem
from rsym.model.vectors import minus

SAME_ANGLE = 1e-9  # cosines


def polygon(points: Any, *, system: RSystem = R0, letters: LetterMapping = None) -> Shape:
    """The inside of a simple polygon, convex or not: a monotone formula of the half-planes of its edges.

    What mirrors each other in x or in y is joined first, so that omega is as even as the polygon, where that can be.
    Each edge occurs once; edges on one line at the outside of a bay or of the whole share their half-plane, or
    normalisation would be lost on them. Corners are given in order, either way round; a last one equal to the first
    may be given; one in which the outline does not turn is left out. What is convex and in which order the edges are
    joined is decided where letters have their defaults.

    Normalised to order 1 with R_0, to every order with R_1 (p - 1 with R_p). With R_0 analytic except at the corners
    and at points off the boundary where two operands vanish together, there continuous.

    Parameters
    ----------
    points : sequence of points, or an array of shape (n, 2)
        The corners.
    system : RSystem
        What the half-planes are joined in. In `Rho` a convex polygon whose corners have one angle, as a rectangle, has
        circles of its radius; of others the arcs are none, and an RsymWarning says so.

    Raises
    ------
    RsymError
        For fewer than three corners, corners that coincide, an outline that crosses or touches itself, or edges
        that lie on one line only at the defaults of their letters.

    Examples
    --------
    >>> import rsym
    >>> rsym.polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]).expression
    conjunction(y, 2 - x, disjunction(1 - y, 1 - x), 2 - y, x)

    Source: Dobkin, Guibas, Hershberger, Snoeyink, "An efficient algorithm for finding the CSG representation of a
    simple polygon" (1988).
    """
    corners = _turning(_corners(points), letters)
    places = _places(corners, letters)
    if area(places) < 0:
        corners, places = corners[::-1], places[::-1]
    check_simple(places)
    edges = [_left_of(*ends, letters) for ends in zip(corners, (*corners[1:], corners[0]), strict=True)]
    try:
        formula: Branch
        formula, shared = monotone_formula(places)
        written = {edge: kept for kept, edge in shared}
        symmetries = [[written.get(edge, edge) for edge in symmetry] for symmetry in mirrors(places)]
        if isinstance(system, Rho):  # it takes lengths, so nothing that was joined before
            system = _with_angles(system, places, letters)
        else:
            formula = in_symmetric_pairs(formula, symmetries)
        expression = _joined(formula, edges, system)
    except RecursionError:
        raise RsymError(
            f"the {len(corners)} corners of this polygon wind too often around one another",
            code="polygon",
            remedy="use fewer corners: every bay within a bay is an operation within an operation",
        ) from None
    for first, second in shared:
        _check_aligned([corners[(edge + step) % len(corners)] for edge in (first, second) for step in (0, 1)])
    return Shape(expression, PLANE, letters=letters, box=box_around(places))


def regular_polygon(
    sides: int = 6, radius: Any = 1, centre: Any = (0, 0), *, system: RSystem = R0, letters: LetterMapping = None
) -> Shape:
    """The conjunction of n half-planes R*cos(pi/n) - n_k . (p - c): corners on a circle, the first to the right.

    They are joined in pairs that mirror each other, so that omega is even in y, and in x if n is even.

    The unit normal n_k points in the direction (2 k + 1)*pi/n; its components are exact. Normalised to order 1 with
    R_0, to every order with R_1. With R_0 analytic except at the corners and at points off the boundary where two
    operands vanish together, there continuous. In `Rho` the corners are circles of its radius.

    Raises
    ------
    RsymError
        For fewer than three sides, or a radius that is not positive.

    Examples
    --------
    >>> import rsym
    >>> rsym.regular_polygon(4, sp.sqrt(2)).expression
    conjunction(-sqrt(2)*x/2 - sqrt(2)*y/2 + 1, sqrt(2)*x/2 + sqrt(2)*y/2 + 1, \
conjunction(sqrt(2)*x/2 - sqrt(2)*y/2 + 1, -sqrt(2)*x/2 + sqrt(2)*y/2 + 1))
    """
    count = whole(sides, "the number of sides", 3)
    radius = positive(radius, "the radius", letters)
    centre = point(centre, 2, "the centre")
    across, up = minus(PLANE, centre)
    angles = [(2 * side + 1) * sp.pi / count for side in range(count)]
    turns = [count // 2**k for k in range(1, count) if count % 2**k == 0]  # edges that a half turn, a quarter, .. skips
    symmetries = [[(side + turn) % count for side in range(count)] for turn in turns]
    formula: Branch = Junction(True, tuple(range(count)))
    if not isinstance(system, Rho):  # which takes lengths
        formula = in_symmetric_pairs(formula, [*symmetries, range(count)[::-1]])
    elif system.cosine == 0:
        system = replace(system, cosine=sp.cos(2 * sp.pi / count))
    apothem = radius * sp.cos(sp.pi / count)
    edges = [apothem - sp.cos(angle) * across - sp.sin(angle) * up for angle in angles]
    ((right, above),), reach = _places([centre], letters), default(radius, letters)
    corners = [2 * math.pi * corner / count for corner in range(count)]
    box = box_around([(right + reach * math.cos(turn), above + reach * math.sin(turn)) for turn in corners])
    return Shape(_joined(formula, edges, system), PLANE, letters=letters, box=box)


def _corners(points: Any) -> list[Point]:
    """The corners as expressions, the first not again at the end."""
    given = points.tolist() if hasattr(points, "tolist") else points
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise RsymError(
            f"a polygon needs a sequence of corners, got {points!r}", code="polygon", remedy="[(0, 0), (1, 0), (0, 1)]"
        )
    corners = [point(value, 2, f"corner {index + 1}") for index, value in enumerate(given)]
    if len(corners) > 1 and corners[0] == corners[-1]:
        corners.pop()
    if len(corners) < 3:
        raise RsymError(f"a polygon needs three corners or more, got {len(corners)}", code="polygon")
    return corners


def _places(corners: Sequence[Point], letters: LetterMapping) -> list[Place]:
    return [(default(a, letters, "a corner"), default(b, letters, "a corner")) for a, b in corners]


def _turning(corners: list[Point], letters: LetterMapping) -> list[Point]:
    """Without those in which the outline goes straight on."""
    places = _places(corners, letters)
    near = nearness(places)
    for a, b in zip(places, (*places[1:], places[0]), strict=True):
        if math.dist(a, b) <= near:
            raise RsymError(
                f"neighbouring corners of a polygon must differ, got {shown(a)} twice",
                code="polygon",
                remedy="give every corner once",
            )
    kept = []
    for index, corner in enumerate(corners):
        before, after = index - 1, (index + 1) % len(corners)
        if straight(places[before], places[index], places[after], near):
            _check_aligned([corners[before], corner, corners[after]])
        else:
            kept.append(corner)
    return kept


def _check_aligned(corners: Sequence[Point]) -> None:
    """Refuse points that lie on one line only where letters have their defaults."""
    (a, b), (c, d), *others = corners
    if not symbols_of(*(part for corner in corners for part in corner)):
        return
    for e, f in others:
        if sp.expand((c - a) * (f - b) - (d - b) * (e - a)) != 0:
            raise RsymError(
                f"{', '.join(map(str, corners))} lie on one line where letters have their defaults, but not elsewhere",
                code="polygon",
                remedy="choose defaults at which the corners are those of the polygon that is meant",
            )


def _with_angles(system: Rho, places: Sequence[Place], letters: LetterMapping) -> Rho:
    """The system whose radius is that of the corners, where all have one angle; else a warning."""
    sides = [(c - a, d - b) for (a, b), (c, d) in zip(places, (*places[1:], places[0]), strict=True)]
    pairs = list(zip(sides, (*sides[1:], sides[0]), strict=True))
    cosines = [(p * u + q * v) / (math.hypot(p, q) * math.hypot(u, v)) for (p, q), (u, v) in pairs]
    bays = any(p * v < q * u for (p, q), (u, v) in pairs)
    if system.cosine == 0 and not bays and not letters and max(cosines) - min(cosines) < SAME_ANGLE < abs(cosines[0]):
        system = replace(system, cosine=sp.Float(cosines[0]))
    if bays or any(abs(cosine - default(system.cosine, letters)) > SAME_ANGLE for cosine in cosines):
        warn(
            f"{system.radius} is not the radius of all corners: it is where none is hollow and all have one angle; "
            "fillet(edge, edge, radius, angle=...) rounds a corner of any angle"
        )
    return system


def _joined(branch: Branch, edges: Sequence[sp.Expr], system: RSystem) -> sp.Expr:
    """The formula in R-operations."""
    if not isinstance(branch, Junction):
        return edges[branch]
    operands = [_joined(part, edges, system) for part in branch.branches]
    return system.conjunction(*operands) if branch.common else system.disjunction(*operands)


def _left_of(start: Point, end: Point, letters: LetterMapping) -> sp.Expr:
    """The half-plane of an edge; one parallel to an axis keeps its side, and needs no length that letters could end."""
    across, up = (default(b - a, letters, "a corner") for a, b in zip(start, end, strict=True))
    if start[1] == end[1]:
        return y - start[1] if across > 0 else start[1] - y
    if start[0] == end[0]:
        return start[0] - x if up > 0 else x - start[0]
    return right_of(end, start)
