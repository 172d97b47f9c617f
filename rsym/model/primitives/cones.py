"""Cones about an axis parallel to z: finite and cut ones, one nappe and both."""

from __future__ import annotations

import math
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, point, positive
from rsym.model.arguments import angle as in_radians
from rsym.model.primitives.formulas import between, box_around
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import SPACE
from rsym.model.systems import R0, RSystem
from rsym.model.vectors import minus, norm


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
    bounds = _bounds(base, radius, height, letters)
    return Shape(system.conjunction(mantle, up), SPACE, letters=letters, bounds=bounds)


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
    bounds = _bounds(base, widest, height, letters)
    return Shape(system.conjunction(mantle, between(up, 0, height, letters)), SPACE, letters=letters, bounds=bounds)


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


def _bounds(base: Point, radius: sp.Expr, height: sp.Expr, letters: LetterMapping) -> Bounds:
    a, b, c = (default(part, letters, "the base") for part in base)
    r, h = default(radius, letters), default(height, letters)
    return box_around([(a - r, b - r, c), (a + r, b + r, c + h)])
