"""Polygons: half-planes of edges in R-operations, each edge once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, point, positive, whole
from rsym.model.primitives.extents import around, centred
from rsym.model.primitives.monotone_formulas import Branch, Junction, monotone_formula
from rsym.model.primitives.outlines import Place, ahead, aligned, area, check_simple, nearness, straight
from rsym.model.primitives.plane import ORIGIN, PLANE, from_centre, right_of
from rsym.model.shape import Shape
from rsym.model.systems import R0, RSystem
from rsym.model.traversal import symbols_of


def polygon(points: Any, system: RSystem = R0, letters: LetterMapping = None) -> Shape:
    """The inside of a simple polygon, convex or not: a monotone formula of the half-planes of its edges.

    Each edge occurs once; edges that lie on one line and bound the same side of it share their half-plane. Corners
    are given in order, either way round; a last one equal to the first may be given; one in which the outline does
    not turn is left out. What is convex and in which order the edges are joined is decided where letters have their
    defaults.

    Normalised to order 1 with R_0, to every order with R_1 (p - 1 with R_p); analytic except at the corners and at
    points off the boundary where two operands vanish together, there continuous.

    Parameters
    ----------
    points : sequence of points, or an array of shape (n, 2)
        The corners.
    system : RSystem
        What the half-planes are joined in.

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
    expression = _joined(monotone_formula(places), corners, places, system)
    low, high = zip(*((min(axis), max(axis)) for axis in zip(*places, strict=True)), strict=True)
    return Shape(expression, PLANE, letters=letters, bounds=around(low, high))


def regular_polygon(
    sides: int = 6, radius: Any = 1, centre: Any = ORIGIN, system: RSystem = R0, letters: LetterMapping = None
) -> Shape:
    """The conjunction of n half-planes R*cos(pi/n) - n_k . (p - c): corners on a circle, the first to the right.

    The unit normal n_k points in the direction (2 k + 1)*pi/n; its components are exact. Normalised to order 1 with R_0, to
    every order with R_1; analytic except at the corners and at points off the boundary where two operands vanish
    together, there continuous.

    Raises
    ------
    RsymError
        For fewer than three sides, or a radius that is not positive.

    Examples
    --------
    >>> import rsym
    >>> rsym.regular_polygon(4, sp.sqrt(2)).expression
    conjunction(-sqrt(2)*x/2 - sqrt(2)*y/2 + 1, sqrt(2)*x/2 - sqrt(2)*y/2 + 1, sqrt(2)*x/2 + sqrt(2)*y/2 + 1, \
-sqrt(2)*x/2 + sqrt(2)*y/2 + 1)
    """
    count = whole(sides, "the number of sides", 3)
    radius = positive(radius, "the radius", letters)
    centre = point(centre, 2, "the centre")
    across, up = from_centre(centre)
    angles = [(2 * side + 1) * sp.pi / count for side in range(count)]
    apothem = radius * sp.cos(sp.pi / count)
    sides_of = [apothem - sp.cos(angle) * across - sp.sin(angle) * up for angle in angles]
    return Shape(
        system.conjunction(*sides_of), PLANE, letters=letters, bounds=centred(centre, (radius, radius), letters)
    )


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
    return [(default(x, letters, "a corner"), default(y, letters, "a corner")) for x, y in corners]


def _turning(corners: list[Point], letters: LetterMapping) -> list[Point]:
    """Without those in which the outline goes straight on."""
    places = _places(corners, letters)
    near = nearness(places)
    count = len(corners)
    for index in range(count):
        if max(abs(a - b) for a, b in zip(places[index - 1], places[index], strict=True)) <= near:
            raise RsymError(
                f"neighbouring corners of a polygon must differ, got ({places[index][0]:g}, {places[index][1]:g}) twice",
                code="polygon",
                remedy="give every corner once",
            )
    kept = []
    for index in range(count):
        three = [(index + step) % count for step in (-1, 0, 1)]
        if not straight(*(places[corner] for corner in three), near):
            kept.append(corners[index])
        else:
            _check_aligned([corners[corner] for corner in three])
    if len(kept) < 3:
        raise RsymError("the corners of a polygon must not lie on one line", code="polygon")
    return kept


def _check_aligned(corners: Sequence[Point]) -> None:
    """Refuse points that lie on one line only where letters have their defaults."""
    (a, b), *others = corners
    (c, d), *rest = others
    if not symbols_of(*(part for corner in corners for part in corner)):
        return
    for e, f in rest:
        if sp.expand((c - a) * (f - b) - (d - b) * (e - a)) != 0:
            raise RsymError(
                f"{', '.join(map(str, corners))} lie on one line where letters have their defaults, but not elsewhere",
                code="polygon",
                remedy="choose defaults at which the corners are those of the polygon that is meant",
            )


def _joined(branch: Branch, corners: Sequence[Point], places: Sequence[Place], system: RSystem) -> sp.Expr:
    """The formula in R-operations; neighbours on one line become one half-plane."""
    if not isinstance(branch, Junction):
        return right_of(corners[(branch + 1) % len(corners)], corners[branch])
    operands, lines = [], []
    for part in branch.branches:
        if isinstance(part, Junction):
            operands.append(_joined(part, corners, places, system))
        elif not lines or not _one_line(lines[-1], part, corners, places):
            operands.append(_joined(part, corners, places, system))
            lines.append(part)
    return system.conjunction(*operands) if branch.common else system.disjunction(*operands)


def _one_line(first: int, second: int, corners: Sequence[Point], places: Sequence[Place]) -> bool:
    """Whether two edges bound the same half-plane."""
    ends = [first, (first + 1) % len(corners), second, (second + 1) % len(corners)]
    a, b, c, d = (places[end] for end in ends)
    near = nearness(places)
    if ends[1] == second or not (aligned(a, b, c, near) and aligned(a, b, d, near) and ahead(a, b, c, d)):
        return False
    _check_aligned([corners[end] for end in ends])
    return True
