"""Curves of segments, arcs, graphs and helices: fields that are zero on a curve and positive elsewhere.

They are the skeletons of blended bodies, and where a boundary condition may hold.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, point, positive, unit_vector, whole
from rsym.model.arguments import angle as in_radians
from rsym.model.bounding import lines
from rsym.model.equation import combine
from rsym.model.operations import joining
from rsym.model.primitives.curve_nodes import ArcField, CircleField, HelixField, SegmentField
from rsym.model.primitives.formulas import box_around
from rsym.model.shape import Shape
from rsym.model.symbols import SPACE, x, y, z
from rsym.model.vectors import cross, dot


def segment(start: Any = (-1, 0), end: Any = (1, 0), *, letters: LetterMapping = None) -> Shape:
    """The segment between two points: the line, trimmed by the disc that has it as diameter.

    trimming(f, t) with the distance f to the line and t = (place - start).(end - place)/L, L the length.

    Off the ends normalised to order 6 on either side, in space in every
    direction: f + f**7/(32 t**2) + ... Analytic off the segment.
    Source: Sukumar and Srivastava (2022), equation 6; Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Parameters
    ----------
    start, end : points
        Both in the plane or both in space.
    letters : mapping, optional
        The values of letters in the points.

    Raises
    ------
    RsymError
        For points that coincide, or are not both in the plane or in space.

    Examples
    --------
    >>> import rsym
    >>> rod = segment((-1, 0), (1, 0))
    >>> rod.expression
    segment(x, y; -1, 0; 1, 0)
    >>> rsym.compile(rod)([0.5, 0.0], [0.0, 0.25])["value"].round(6).tolist()
    [0.0, 0.250009]
    """
    return polyline([start, end], letters=letters)


def polyline(points: Any, closed: bool = False, order: Any = 2, *, letters: LetterMapping = None) -> Shape:
    """The segments from point to point, joined: (f_1**-m + f_2**-m + ...)**(-1/m), m the order.

    Off the corners and ends normalised to order m on either side, at most to
    order 6 as its segments are. Analytic off the polyline.
    Source: Sukumar and Srivastava (2022), equations 6 and 10.

    Parameters
    ----------
    points : list of points
        Two or more, all in the plane or all in space.
    closed : bool
        Whether the last point is joined to the first.
    order : positive integer or letter
        m; a large one comes near to the distance, a small one rounds what is blended on it.
    letters : mapping, optional
        The values of letters in the points.

    Raises
    ------
    RsymError
        For fewer than two points, neighbours that coincide, or points that are not all in the plane or all in space.

    Examples
    --------
    >>> import rsym
    >>> hook = polyline([(0, 0), (2, 0), (2, 1)])
    >>> rsym.compile(hook)([1.0, 2.0], [0.0, 0.5])["value"].tolist()
    [0.0, 0.0]
    >>> polyline([(0, 0), (2, 0), (2, 1)], closed=True) == graph([(0, 0), (2, 0), (2, 1)], [(0, 1), (1, 2), (2, 0)])
    True
    """
    places = _points(points)
    edges = list(pairwise(range(len(places))))
    if closed and len(places) > 2:
        edges.append((len(places) - 1, 0))
    return _segments(places, edges, order, letters)


def graph(points: Any, edges: Any, order: Any = 2, *, letters: LetterMapping = None) -> Shape:
    """Points joined by segments: as a polyline, with branches.

    Off the points normalised to order m on either side, at most to order 6. Analytic off the graph.

    Parameters
    ----------
    points : list of points
        All in the plane or all in space.
    edges : list of pairs of integers
        Which points a segment joins, counted from 0.
    order : positive integer or letter
        As for `polyline`.
    letters : mapping, optional
        The values of letters in the points.

    Raises
    ------
    RsymError
        For an edge between points that coincide or are not there, or no edge.

    Examples
    --------
    >>> import rsym
    >>> star = graph([(0, 0), (1, 0), (-1, 1), (-1, -1)], [(0, 1), (0, 2), (0, 3)])
    >>> rsym.compile(star)([0.5, -0.5], [0.0, 0.5])["value"].tolist()
    [0.0, 0.0]
    """
    places = _points(points)
    pairs = [point(edge, 2, "an edge") for edge in _listed(edges)]
    chosen = [(whole(a, "the end of an edge", 0), whole(b, "the end of an edge", 0)) for a, b in pairs]
    outside = [index for edge in chosen for index in edge if index >= len(places)]
    if outside or not chosen:
        got = f"point {outside[0]}" if outside else "none"
        raise RsymError(
            f"a graph needs edges between its {len(places)} points, got {got}",
            code="edges",
            remedy="points are counted from 0: [(0, 1), (0, 2)] joins the first to the second and the third",
        )
    return _segments(places, chosen, order, letters)


def _points(points: Any) -> list[Point]:
    """All in the plane or all in space."""
    given = _listed(points)
    if len(given) < 2:
        raise RsymError(
            f"a curve needs two points or more, got {points!r}", code="points", remedy="for example [(0, 0), (1, 0)]"
        )
    dimension = 3 if hasattr(given[0], "__len__") and len(given[0]) == 3 else 2
    return [point(item, dimension, "a point of the curve") for item in given]


def _listed(value: Any) -> list[Any]:
    return list(value) if hasattr(value, "__iter__") and not isinstance(value, str) else []


def _segments(points: list[Point], edges: list[tuple[int, int]], order: Any, letters: LetterMapping) -> Shape:
    places = [tuple(default(item, letters, "a point of the curve") for item in place) for place in points]
    for a, b in edges:
        if places[a] == places[b]:
            raise RsymError(
                f"the points {points[a]} and {points[b]} coincide: a segment between them has no direction",
                code="points",
                remedy="leave out one of them",
            )
    coordinates = SPACE[: len(points[0])]
    # Drawn twice, a segment would be 1/2**(1/m) of the distance to it.
    once = {frozenset((points[a], points[b])): (a, b) for a, b in reversed(edges)}
    nodes = [SegmentField(*coordinates, *points[a], *points[b]) for a, b in reversed(once.values())]
    expression = joining(*nodes, order=order)
    return Shape(expression, coordinates, letters=letters, box=box_around(places, solid=False))


def space_curve(f: Any, g: Any, *, letters: LetterMapping = None) -> Shape:
    """The curve in which two surfaces meet, f = g = 0: sqrt(f**2 + g**2).

    Normalised to order 1 where f and g are and their gradients are at right
    angles; elsewhere zero on the curve and positive off it, no more.

    Parameters
    ----------
    f, g : shapes in space, or expressions in x, y, z and letters
        Zero on the two surfaces.
    letters : mapping, optional
        The values of letters in expressions.

    Raises
    ------
    RsymError
        For a shape in the plane.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> axis = space_curve(x, y)
    >>> axis.expression
    sqrt(x**2 + y**2)
    """
    surfaces = [item if isinstance(item, Shape) else Shape(item, (x, y, z), letters=letters) for item in (f, g)]
    if any(surface.dimension != 3 for surface in surfaces):
        raise RsymError(
            "a space curve needs two shapes in space, got one in the plane",
            code="coordinates",
            remedy="extrude or revolve it first; in the plane a curve is its own boundary",
        )
    curve: Shape = combine(lambda first, second: sp.sqrt(first**2 + second**2), *surfaces, box=lines)
    return curve


def helix(radius: Any = 1, pitch: Any = 1, turns: Any = None, *, letters: LetterMapping = None) -> Shape:
    """The line of a screw about z through (radius, 0, 0): (R cos a, R sin a, p a/(2 pi)), right-handed.

    sqrt((k**2 (R**2 - x**2 - y**2)**2/4 + d + d**2/(12 R**2))/(1 + k**2 R**2)) with k = 2 pi/p and
    d = (x - R cos(k z))**2 + (y - R sin(k z))**2: from the cylinder, and from the point of the curve across the axis.

    Normalised to order 1 in every direction, off the ends if it has any. It is analytic off the curve. A left-handed
    one is its mirror image.

    Parameters
    ----------
    radius, pitch : positive numbers or expressions
        R, and p: the height of one turn.
    turns : positive number or expression, optional
        Where it ends, from z = 0 on; by default it is endless.
    letters : mapping, optional
        The values of letters in the numbers.

    Raises
    ------
    RsymError
        For a number that is not positive.

    Examples
    --------
    >>> import rsym
    >>> spring = helix(2, 1, turns=3)
    >>> float(rsym.compile(spring)(-2.0, 0.0, 1.5)["value"].round(12))
    0.0
    """
    numbers = [positive(radius, "the radius of a helix", letters), positive(pitch, "the pitch of a helix", letters)]
    if turns is None:
        return Shape(HelixField(x, y, z, *numbers), (x, y, z), letters=letters)
    numbers.append(positive(turns, "the number of turns", letters))
    reach, rise, count = (default(item, letters, "a helix") for item in numbers)
    box = box_around([(-reach, -reach, 0.0), (reach, reach, rise * count)], solid=False)
    return Shape(HelixField(x, y, z, *numbers), (x, y, z), letters=letters, box=box)


def circle(
    radius: Any = 1, centre: Any = (0, 0), axis: Any = None, exact: bool = False, *, letters: LetterMapping = None
) -> Shape:
    """The line of a circle, without what is in it: |R**2 - r**2|/(2 R), r the distance to the centre.

    In space sqrt(f**2 + w**2) with the field f in the plane and the height w over it.

    Normalised to order 1 on either side, with exact distances, |R - r|, to
    every order; these are not differentiable at the centre, in space on the axis.

    Parameters
    ----------
    radius : positive number or expression
        R.
    centre : point
        Of two numbers in the plane, of three in space.
    axis : direction
        In space, at right angles to the circle; by default that of z.
    exact : bool
        Whether the field is the distance.
    letters : mapping, optional
        The values of letters in the numbers.

    Raises
    ------
    RsymError
        For a radius that is not positive, or an axis in the plane.

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(circle(1))([1.0, 0.0], [0.0, 2.0])["value"].tolist()
    [0.0, 1.5]
    """
    middle, first, second = _frame(centre, axis, letters)
    size = positive(radius, "the radius of a circle", letters)
    node = CircleField(*SPACE[: len(middle)], *middle, *first, *second, size, sp.Integer(bool(exact)))
    return _on_circle(node, 0.0, math.tau, letters)


def arc(
    radius: Any = 1,
    start: Any = 0,
    end: Any = sp.pi,
    centre: Any = (0, 0),
    axis: Any = None,
    exact: bool = False,
    *,
    degrees: bool = False,
    letters: LetterMapping = None,
) -> Shape:
    """The arc of a circle from one angle to another: the circle, trimmed by the one at right angles to it at both ends.

    trimming(f, t) with the circle's field f = (R**2 - r**2)/(2 R), r the distance to the centre, and
    t = (2 R u - cos(h) (R**2 + r**2))/(2 R sin(h)), where h = (end - start)/2 and u runs from the centre to the
    middle of the arc; both have gradients of length 1 at the ends. It is right for every arc up to a whole circle,
    and goes over into `segment` for large radii. In space f is that of `circle`.

    Off the ends normalised to order 1 on either side, with exact distances
    f = R - r to order 6; these are not differentiable at the centre, in space on the axis.

    Parameters
    ----------
    radius : positive number or expression
        R.
    start, end : numbers or expressions
        Angles in radians, start < end < start + 2 pi, counterclockwise from the direction of x. In space they are
        counterclockwise for those the axis points at, from the direction of x as seen along the axis (of y if
        the axis is along x).
    centre : point
        Of two numbers in the plane, of three in space.
    axis : direction
        In space, at right angles to the arc; by default that of z.
    exact : bool
        Whether f is the distance.
    degrees : bool
        Whether the angles are in degrees.
    letters : mapping, optional
        The values of letters in the numbers.

    Raises
    ------
    RsymError
        For a radius that is not positive, an axis in the plane, angles that do not increase, or go once around
        or more.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> bow = arc(2, 0, sp.pi / 2)
    >>> rsym.compile(bow)([2.0, 0.0, 1.0], [0.0, 2.0, 1.0])["value"].round(6).tolist()
    [0.0, 0.0, 0.50087]
    """
    middle, first, second = _frame(centre, axis, letters)
    size = positive(radius, "the radius of an arc", letters)
    ends = (start, "the start of an arc"), (end, "the end of an arc")
    angles = [in_radians(given, what, degrees=degrees) for given, what in ends]
    low, high = (default(angle, letters, "an angle of an arc") for angle in angles)
    if not low < high < low + math.tau:
        raise RsymError(
            f"an arc needs start < end < start + 2 pi, got {low:g} and {high:g}",
            code="angles",
            remedy="degrees=True for degrees; exchange the two, add 2 pi to the end, or take circle(radius, centre)",
        )
    node = ArcField(*SPACE[: len(middle)], *middle, *first, *second, size, *angles, sp.Integer(bool(exact)))
    return _on_circle(node, low, high, letters)


def _frame(centre: Any, axis: Any, letters: LetterMapping) -> tuple[Point, Point, Point]:
    """The centre, the direction in which angles begin and the one at a quarter turn."""
    if not hasattr(centre, "__len__") or len(centre) != 3:
        middle = point(centre, 2, "the centre")
        if axis is not None:
            raise RsymError(
                f"in the plane a circle has no axis, got {axis!r}",
                code="axis",
                remedy="give the centre three numbers for a circle in space",
            )
        return middle, (sp.S.One, sp.S.Zero), (sp.S.Zero, sp.S.One)
    normal = unit_vector((0, 0, 1) if axis is None else axis, 3, "the axis", letters)
    sideways = [default(component, letters, "the axis") for component in normal[1:]]
    seen = (1, 0, 0) if any(sideways) else (0, 1, 0)
    share = dot(normal, seen)
    first = unit_vector([a - share * n for a, n in zip(seen, normal, strict=True)], 3, "the axis", letters)
    return point(centre, 3, "the centre"), first, cross(normal, first)


def _on_circle(node: CircleField, start: float, end: float, letters: LetterMapping) -> Shape:
    """The shape; a coordinate is largest or smallest at the ends, or where the circle runs at right angles to it."""
    centre, first, second = ([default(c, letters, "a curve") for c in node.vector(k)] for k in (1, 2, 3))
    radius = default(node.numbers[0], letters, "the radius")
    turning = [math.atan2(b, a) + k * math.pi for a, b in zip(first, second, strict=True) for k in range(-1, 2)]
    turns = (angle + math.tau * math.ceil((start - angle) / math.tau) for angle in turning)
    angles = [start, end, *(angle for angle in turns if angle < end)]
    axes = list(zip(centre, first, second, strict=True))
    points = [[c + radius * (a * math.cos(t) + b * math.sin(t)) for c, a, b in axes] for t in angles]
    return Shape(node, node.vector(0), letters=letters, box=box_around(points, solid=False))
