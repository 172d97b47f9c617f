"""Circles and their arcs as curves: fields that are zero on them and positive elsewhere."""

from __future__ import annotations

import math
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, point, positive, unit_vector
from rsym.model.arguments import angle as in_radians
from rsym.model.primitives.curve_nodes import Arc, Circle
from rsym.model.primitives.formulas import box_around
from rsym.model.shape import Shape
from rsym.model.symbols import SPACE
from rsym.model.vectors import cross, dot


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
    node = Circle(*SPACE[: len(middle)], *middle, *first, *second, size, sp.Integer(bool(exact)))
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
            remedy="add 2 pi to the end, exchange the two, or take circle(radius, centre) for a whole one",
        )
    node = Arc(*SPACE[: len(middle)], *middle, *first, *second, size, *angles, sp.Integer(bool(exact)))
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


def _on_circle(node: Circle, start: float, end: float, letters: LetterMapping) -> Shape:
    """The shape; a coordinate is largest or smallest at the ends, or where the circle runs at right angles to it."""
    centre, first, second = ([default(c, letters, "a curve") for c in node.vector(k)] for k in (1, 2, 3))
    radius = default(node.numbers[0], letters, "the radius")
    turning = [math.atan2(b, a) + k * math.pi for a, b in zip(first, second, strict=True) for k in range(-1, 2)]
    turns = (angle + math.tau * math.ceil((start - angle) / math.tau) for angle in turning)
    angles = [start, end, *(angle for angle in turns if angle < end)]
    axes = list(zip(centre, first, second, strict=True))
    points = [[c + radius * (a * math.cos(t) + b * math.sin(t)) for c, a, b in axes] for t in angles]
    return Shape(node, node.vector(0), letters=letters, bounds=box_around(points))
