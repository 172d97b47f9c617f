"""Half-space, slab, sphere, box, cylinder and capsule: normalised without roots that vanish inside.

Axes are parallel to z; motions turn them.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, number, point, positive
from rsym.model.arguments import direction as unit_vector
from rsym.model.powers import signed_power
from rsym.model.primitives.extents import around, centred
from rsym.model.shape import Shape
from rsym.model.symbols import x, y, z
from rsym.model.systems import R0

SPACE = (x, y, z)
ORIGIN: Point = (sp.S.Zero,) * 3


def half_space(normal: Any = (0, 0, 1), distance: Any = 0, *, letters: LetterMapping = None) -> Shape:
    """N . p - d, n the unit vector along `normal`: what lies beyond the plane at distance d from the origin.

    Exact: the signed distance. Analytic everywhere.

    Raises
    ------
    RsymError
        For a normal that is zero, or a number that is none.

    Examples
    --------
    >>> import rsym
    >>> rsym.half_space((0, 3, 4), 2).expression
    3*y/5 + 4*z/5 - 2
    """
    distance = number(distance, "the distance")
    default(distance, letters, "the distance")
    along = _along(unit_vector(normal, 3, "the normal", letters))
    return Shape(along - distance, SPACE, letters=letters)


def slab(lower: Any = -1, upper: Any = 1, direction: Any = (0, 0, 1), *, letters: LetterMapping = None) -> Shape:
    """(b - s)*(s - a)/(b - a) with s = n . p: between two parallel planes, n the unit vector along `direction`.

    Normalised to order 1. Analytic everywhere.

    Raises
    ------
    RsymError
        Unless lower < upper, or for a direction that is zero.

    Examples
    --------
    >>> import rsym
    >>> rsym.slab(0, 2).expression
    z*(2 - z)/2
    """
    return Shape(_strip(lower, upper, direction, letters), SPACE, letters=letters)


def sphere(radius: Any = 1, centre: Any = ORIGIN, exact: bool = False, *, letters: LetterMapping = None) -> Shape:
    """(R**2 - |p - c|**2)/(2 R), the ball; with `exact` R - |p - c|, the distance itself.

    Normalised to order 1 and analytic everywhere; the exact form to every order, singular at the centre.

    Raises
    ------
    RsymError
        For a radius that is not positive, or a centre that is not three numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.sphere(2).expression
    -x**2/4 - y**2/4 - z**2/4 + 1
    >>> rsym.sphere(2, exact=True).expression
    2 - sqrt(x**2 + y**2 + z**2)
    """
    radius = positive(radius, "the radius", letters)
    centre = point(centre, 3, "the centre")
    squared = sp.Add(*(part**2 for part in from_centre(centre)))
    expression = radius - sp.sqrt(squared) if exact else (radius**2 - squared) / (2 * radius)
    return Shape(expression, SPACE, letters=letters, bounds=centred(centre, (radius,) * 3, letters))


def box(
    width: Any = 2, depth: Any = 2, height: Any = 2, centre: Any = ORIGIN, *, letters: LetterMapping = None
) -> Shape:
    """The conjunction (R_0) of three slabs (a**2 - x**2)/(2 a), a half the side: width along x, depth y, height z.

    Normalised to order 1 on the faces. Analytic except on the lines through edges, where it is continuous.

    Raises
    ------
    RsymError
        For a side that is not positive, or a centre that is not three numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.box(2, 2, 4).expression
    conjunction(1/2 - x**2/2, 1/2 - y**2/2, 1 - z**2/4)
    """
    sides = (("width", width), ("depth", depth), ("height", height))
    halves = tuple(positive(side, f"the {name}", letters) / 2 for name, side in sides)
    centre = point(centre, 3, "the centre")
    strips = (_even(half, part) for half, part in zip(halves, from_centre(centre), strict=True))
    return Shape(R0.conjunction(*strips), SPACE, letters=letters, bounds=centred(centre, halves, letters))


def cylinder(radius: Any = 1, height: Any = None, centre: Any = ORIGIN, *, letters: LetterMapping = None) -> Shape:
    """(R**2 - rho**2)/(2 R), rho the distance from the axis, parallel to z; cut by a slab where there is a height.

    Normalised to order 1 on the mantle and the ends. Analytic, axis included, except on the rims, where it is
    continuous. Without a height it is infinite and has no bounds.

    Raises
    ------
    RsymError
        For a radius or height that is not positive, or a centre that is not three numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.cylinder(1).expression
    -x**2/2 - y**2/2 + 1/2
    >>> rsym.cylinder(1, height=4).expression
    conjunction(-x**2/2 - y**2/2 + 1/2, 1 - z**2/4)
    """
    radius = positive(radius, "the radius", letters)
    centre = point(centre, 3, "the centre")
    across, up, along = from_centre(centre)
    mantle = (radius**2 - across**2 - up**2) / (2 * radius)
    if height is None:
        return Shape(mantle, SPACE, letters=letters)
    half = positive(height, "the height", letters) / 2
    bounds = centred(centre, (radius, radius, half), letters)
    return Shape(R0.conjunction(mantle, _even(half, along)), SPACE, letters=letters, bounds=bounds)


def capsule(
    start: Any = (0, 0, -1),
    end: Any = (0, 0, 1),
    radius: Any = 1,
    exact: bool = False,
    *,
    letters: LetterMapping = None,
) -> Shape:
    """(r**2 - d**2)/(2 r), d the distance from a segment: a cylinder with two half-balls as ends.

    d**2 = |e x (p - m)|**2 + max(s - h, 0)**2 + max(-s - h, 0)**2 with m the middle, h half the length, e the direction
    of the segment and s = e . (p - m). With `exact` r - d, the distance itself.

    Normalised to order 1; the exact form to every order, singular on the segment. Off the planes s = -+h
    analytic, on them C1: the surface has one tangent plane there, its curvature jumps by 1/r.

    Raises
    ------
    RsymError
        For a radius that is not positive, or ends that coincide.

    Examples
    --------
    >>> import rsym
    >>> body = rsym.capsule((0, 0, 0), (0, 0, 2), 1)
    >>> rsym.compile(body)(0.0, 0.0, [-1.0, -0.5, 1.0])["value"].tolist()
    [0.0, 0.375, 0.5]
    """
    radius = positive(radius, "the radius", letters)
    start, end = sp.Matrix(point(start, 3, "the start")), sp.Matrix(point(end, 3, "the end"))
    unit = sp.Matrix(unit_vector(end - start, 3, "the segment from start to end", letters))
    middle = (start + end) / 2
    half = sp.sqrt(sp.Add(*((part / 2) ** 2 for part in end - start)))
    away = sp.Matrix(from_centre(middle))
    along = unit.dot(away)
    squared = sp.Add(*(part**2 for part in unit.cross(away)), _beyond(along - half), _beyond(-along - half))
    expression = radius - sp.sqrt(squared) if exact else (radius**2 - squared) / (2 * radius)
    reach, ends = default(radius, letters), [[default(part, letters) for part in tip] for tip in (start, end)]
    low = [min(pair) - reach for pair in zip(*ends, strict=True)]
    high = [max(pair) + reach for pair in zip(*ends, strict=True)]
    return Shape(expression, SPACE, letters=letters, bounds=around(low, high))


def from_centre(centre: Any) -> tuple[sp.Expr, ...]:
    """The coordinates measured from a point."""
    return tuple(coordinate - part for coordinate, part in zip(SPACE, centre, strict=True))


def _along(unit: Point) -> sp.Expr:
    return sp.Add(*(part * coordinate for part, coordinate in zip(unit, SPACE, strict=True)))


def _strip(lower: Any, upper: Any, across: Any, letters: LetterMapping) -> sp.Expr:
    """(b - s)*(s - a)/(b - a)."""
    lower, upper = number(lower, "the lower end"), number(upper, "the upper end")
    if default(upper - lower, letters, "an end of the slab") <= 0:
        raise RsymError(f"the lower end must be below the upper one, got {lower} and {upper}", code="interval")
    along = _along(unit_vector(across, 3, "the direction", letters))
    return (upper - along) * (along - lower) / (upper - lower)


def _even(half: sp.Expr, distance: sp.Expr) -> sp.Expr:
    """(a**2 - s**2)/(2 a)."""
    return (half**2 - distance**2) / (2 * half)


def _beyond(excess: sp.Expr) -> sp.Expr:
    """max(u, 0)**2 as (u**2 + u |u|)/2, whose derivative u + |u| is defined at 0 as well."""
    return (excess**2 + signed_power(excess, sp.Integer(2))) / 2
