"""Half-space, slab, sphere, box, cylinder, capsule and cones: normalised without roots that vanish inside.

Axes are parallel to z; motions turn them.
"""

from __future__ import annotations

import math
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, number, point, positive, unit_vector
from rsym.model.arguments import angle as in_radians
from rsym.model.bounding import BoundingBox
from rsym.model.powers import signed_power
from rsym.model.primitives.formulas import between, box_around, centred, within
from rsym.model.shape import Shape
from rsym.model.symbols import SPACE
from rsym.model.systems import R0, RSystem
from rsym.model.vectors import cross, dot, minus, norm, squared


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
    return Shape(dot(unit_vector(normal, 3, "the normal", letters), SPACE) - distance, SPACE, letters=letters)


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
    along = dot(unit_vector(direction, 3, "the direction", letters), SPACE)
    return Shape(between(along, lower, upper, letters), SPACE, letters=letters)


def sphere(radius: Any = 1, centre: Any = (0, 0, 0), exact: bool = False, *, letters: LetterMapping = None) -> Shape:
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
    expression = within(squared(minus(SPACE, centre)), radius, exact)
    return Shape(expression, SPACE, letters=letters, box=centred(centre, (radius,) * 3, letters))


def box(
    width: Any = 2,
    depth: Any = 2,
    height: Any = 2,
    centre: Any = (0, 0, 0),
    *,
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Shape:
    """The conjunction of three slabs (a**2 - x**2)/(2 a), a half the side: width along x, depth y, height z.

    Normalised to order 1 on the faces, in R_0. Analytic there except on the lines through edges, where it is
    continuous. In `Rho`, which takes lengths, of a - |x|: edges are cylinders and corners balls of exactly that radius.

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
    slabs = (
        within(part**2, half, not system.keeps_sets) for half, part in zip(halves, minus(SPACE, centre), strict=True)
    )
    return Shape(system.conjunction(*slabs), SPACE, letters=letters, box=centred(centre, halves, letters))


def cylinder(
    radius: Any = 1,
    height: Any = None,
    centre: Any = (0, 0, 0),
    *,
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Shape:
    """(R**2 - rho**2)/(2 R), rho the distance from the axis, parallel to z; cut by a slab where there is a height.

    Normalised to order 1 on the mantle and the ends, in R_0. Analytic there, axis included, except on the rims, where
    it is continuous. In `Rho`, which takes lengths, of R - rho and a - |z|. Without a height it is infinite.

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
    across, up, along = minus(SPACE, centre)
    mantle = within(across**2 + up**2, radius, height is not None and not system.keeps_sets)
    if height is None:
        return Shape(mantle, SPACE, letters=letters)
    half = positive(height, "the height", letters) / 2
    box = centred(centre, (radius, radius, half), letters)
    return Shape(
        system.conjunction(mantle, within(along**2, half, not system.keeps_sets)), SPACE, letters=letters, box=box
    )


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
    start, end = point(start, 3, "the start"), point(end, 3, "the end")
    way = minus(end, start)
    unit, half = unit_vector(way, 3, "the segment from start to end", letters), norm(part / 2 for part in way)
    away = minus(SPACE, ((a + b) / 2 for a, b in zip(start, end, strict=True)))
    along = dot(unit, away)
    square = squared(cross(unit, away)) + _beyond(along - half) + _beyond(-along - half)
    reach, ends = default(radius, letters), [[default(part, letters) for part in tip] for tip in (start, end)]
    box = box_around([[part + side * reach for part in tip] for tip in ends for side in (-1, 1)])
    return Shape(within(square, radius, exact), SPACE, letters=letters, box=box)


def _beyond(excess: sp.Expr) -> sp.Expr:
    """max(u, 0)**2 as (u**2 + u |u|)/2, whose derivative u + |u| is defined at 0 as well."""
    return (excess**2 + signed_power(excess, sp.Integer(2))) / 2


def cone(
    radius: Any = 1, height: Any = 2, base: Any = (0, 0, 0), *, system: RSystem = R0, letters: LetterMapping = None
) -> Shape:
    """The conjunction of the mantle ((h - z)*R - rho*h)/sqrt(R**2 + h**2) and z, measured from the base.

    rho is the distance from the axis, `base` the centre of the base, the apex h above it. The mantle is the
    signed distance from its cone. Normalised to order 1, in R_0; singular on the axis and continuous on the rim.

    Raises
    ------
    RsymError
        For a radius or height that is not positive.

    Examples
    --------
    >>> import rsym
    >>> rsym.cone(3, 4).expression
    conjunction(-3*z/5 - 4*sqrt(x**2 + y**2)/5 + 12/5, z)
    """
    radius, height = positive(radius, "the radius", letters), positive(height, "the height", letters)
    base = point(base, 3, "the base")
    rho, up = _meridian(base)
    mantle = _mantle(radius, sp.S.Zero, height, rho, up)
    box = _box(base, radius, height, letters)
    return Shape(system.conjunction(mantle, up), SPACE, letters=letters, box=box)


def frustum(
    bottom: Any = 2,
    top: Any = 1,
    height: Any = 2,
    base: Any = (0, 0, 0),
    *,
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Shape:
    """A cone cut across: radius `bottom` at the base, `top` a height h above it.

    The conjunction of the mantle (a*h - (a - b)*z - rho*h)/sqrt((a - b)**2 + h**2), a the radius of the bottom,
    b of the top, and the slab z*(h - z)/h. Normalised to order 1, in R_0; singular on the axis and continuous on the
    rims.

    Raises
    ------
    RsymError
        For radii or a height that are not positive.

    Examples
    --------
    >>> import rsym
    >>> rsym.frustum(4, 1, 4).expression
    conjunction(-3*z/5 - 4*sqrt(x**2 + y**2)/5 + 16/5, z*(4 - z)/4)
    """
    bottom, top = positive(bottom, "the bottom radius", letters), positive(top, "the top radius", letters)
    height, base = positive(height, "the height", letters), point(base, 3, "the base")
    rho, up = _meridian(base)
    mantle = _mantle(bottom, top, height, rho, up)
    widest = max(bottom, top, key=lambda radius: default(radius, letters))
    box = _box(base, widest, height, letters)
    return Shape(
        system.conjunction(mantle, between(up, 0, height, letters, not system.keeps_sets)),
        SPACE,
        letters=letters,
        box=box,
    )


def nappe(
    angle: Any = sp.pi / 4, apex: Any = (0, 0, 0), *, degrees: bool = False, letters: LetterMapping = None
) -> Shape:
    """z*sin(a) - rho*cos(a), measured from the apex: one nappe of a cone that opens upwards, without end.

    a is the angle between axis and mantle, in radians, or with `degrees` in degrees. Exact: the signed distance from
    the mantle wherever its nearest point is not the apex. Singular on the axis, apex included.

    Raises
    ------
    RsymError
        For an angle that is not between 0 and pi/2.

    Examples
    --------
    >>> import rsym, sympy
    >>> rsym.nappe(sympy.pi / 3).expression
    sqrt(3)*z/2 - sqrt(x**2 + y**2)/2
    """
    angle = _half_angle(angle, degrees, letters)
    rho, up = _meridian(point(apex, 3, "the apex"))
    return Shape(up * sp.sin(angle) - rho * sp.cos(angle), SPACE, letters=letters)


def double_cone(
    angle: Any = sp.pi / 4, apex: Any = (0, 0, 0), *, degrees: bool = False, letters: LetterMapping = None
) -> Shape:
    """u/|grad u| with u = z**2*sin(a)**2 - rho**2*cos(a)**2: both nappes, without a singular axis.

    |grad u|**2 = 4*(z**2*sin(a)**4 + rho**2*cos(a)**4) vanishes at the apex alone. Normalised to order 1, analytic
    and homogeneous of degree 1 except at the apex, where it has no value. With `degrees` the angle is in degrees.

    Raises
    ------
    RsymError
        For an angle that is not between 0 and pi/2.

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.double_cone())([1.0, 0.0], 0.0, [1.0, 2.0])["value"].tolist()
    [0.0, 1.0]
    """
    angle = _half_angle(angle, degrees, letters)
    across, aside, up = minus(SPACE, point(apex, 3, "the apex"))
    sine, cosine = sp.sin(angle), sp.cos(angle)
    rise, reach = up**2 * sine**2, (across**2 + aside**2) * cosine**2
    slope = 2 * sp.sqrt(rise * sine**2 + reach * cosine**2)
    return Shape((rise - reach) / slope, SPACE, letters=letters)


def _meridian(centre: Point) -> tuple[sp.Expr, sp.Expr]:
    """(rho, z) measured from a point of the axis."""
    across, aside, up = minus(SPACE, centre)
    return norm((across, aside)), up


def _mantle(bottom: sp.Expr, top: sp.Expr, height: sp.Expr, rho: sp.Expr, up: sp.Expr) -> sp.Expr:
    lost = bottom - top
    return (bottom * height - lost * up - rho * height) / norm((lost, height))


def _half_angle(angle: Any, degrees: bool, letters: LetterMapping) -> sp.Expr:
    angle = in_radians(angle, "the angle", degrees=degrees)
    value = default(angle, letters, "the angle")
    if not 0 < value < math.pi / 2:
        raise RsymError(
            f"the angle between axis and mantle must be between 0 and pi/2, got {angle}",
            code="angle",
            remedy="angles are in radians, or in degrees with degrees=True",
        )
    return angle


def _box(base: Point, radius: sp.Expr, height: sp.Expr, letters: LetterMapping) -> BoundingBox:
    a, b, c = (default(part, letters, "the base") for part in base)
    r, h = default(radius, letters), default(height, letters)
    return box_around([(a - r, b - r, c), (a + r, b + r, c + h)])
