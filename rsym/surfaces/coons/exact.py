"""Quadrics and tori as patches, exactly: one piece, or the whole.

The corner data of a quarter of the circle, (1, 0, 0, -pi/2) of the cosine and (0, 1, pi/2, 0) of the sine, with the
twists that follow from them, and a blend that reproduces both. The blends are ours, and so is the proof that they are
exact; the thesis on patches with shape parameters states that torus, ellipsoid and sphere can be had.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.letters import Letter
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.revolution import Arc, Revolution, RevolutionPatch, Segment, number

LetterMapping: TypeAlias = Mapping[Any, Letter | float] | None
Blend: TypeAlias = HermiteBlend | None

HALF_TURN, TURN = sp.pi, 2 * sp.pi


def sphere_octant(
    radius: Any = 1, *, blend_u: Blend = None, blend_v: Blend = None, exact: bool = True, letters: LetterMapping = None
) -> RevolutionPatch:
    """The octant x, y, z >= 0 of a sphere, u the longitude and v the latitude; p_u = 0 at the pole v = 1.

    Any blend that keeps quarters of circles does: `HermiteBlend.class1(1, pi/2)`, the default,
    `HermiteBlend.class2(mu, pi/2)` and `HermiteBlend.trigonometric(nu)` with any mu, nu. Others are refused unless
    `exact=False`: the patch of the same corner data, with the cubic blend off by 2.4 per cent of the radius.

    Examples
    --------
    >>> octant = sphere_octant(3)
    >>> octant(0.5, 0.5).round(6).tolist()
    [1.5, 1.5, 2.12132]
    >>> octant.gaussian_curvature(0.3, 1.0).round(12)
    np.float64(0.111111111111)
    """
    return ellipsoid_octant(radius, radius, radius, blend_u=blend_u, blend_v=blend_v, exact=exact, letters=letters)


def ellipsoid_octant(
    a: Any,
    b: Any,
    c: Any,
    *,
    blend_u: Blend = None,
    blend_v: Blend = None,
    exact: bool = True,
    letters: LetterMapping = None,
) -> RevolutionPatch:
    """The octant x, y, z >= 0 of x**2/a**2 + y**2/b**2 + z**2/c**2 = 1; for the rest see `sphere_octant`.

    Examples
    --------
    >>> (ellipsoid_octant(3, 2, 1)([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]).round(12) + 0).tolist()
    [[3.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 1.0]]
    """
    surface = _ellipsoid(a, b, c, 0, sp.pi / 2, letters)
    return surface.patch(blend_u=blend_u, blend_v=blend_v, exact=exact)


def torus_quarter(
    R: Any,
    r: Any,
    *,
    blend_u: Blend = None,
    blend_v: Blend = None,
    exact: bool = True,
    letters: LetterMapping = None,
) -> RevolutionPatch:
    """A quarter turn of a quarter of the tube of a torus, R from the axis to the centre of the tube, r its radius.

    Examples
    --------
    >>> (torus_quarter(3, 1)([0.0, 1.0], [0.0, 1.0]).round(12) + 0).tolist()
    [[4.0, 0.0, 0.0], [0.0, 3.0, 1.0]]
    """
    return _torus(R, r, sp.pi / 2, letters).patch(blend_u=blend_u, blend_v=blend_v, exact=exact)


def cone_quarter(
    radius: Any,
    height: Any,
    *,
    top: Any = 0,
    blend_u: Blend = None,
    blend_v: Blend = None,
    exact: bool = True,
    letters: LetterMapping = None,
) -> RevolutionPatch:
    """A quarter of a cone that stands on z = 0 with a radius there and another at the top; v runs up a ruling.

    Along the ruling a blend must keep straight lines: the cubic one, the default, or class1 with any parameters.

    Examples
    --------
    >>> (cone_quarter(2, 1, top=1)([0.0, 1.0], [0.0, 1.0]).round(12) + 0).tolist()
    [[2.0, 0.0, 0.0], [0.0, 1.0, 1.0]]
    """
    surface = Revolution(Segment((radius, 0), (top, height)), letters=letters)
    return surface.patch(blend_u=blend_u, blend_v=blend_v, exact=exact)


def cylinder_quarter(
    radius: Any,
    height: Any,
    *,
    blend_u: Blend = None,
    blend_v: Blend = None,
    exact: bool = True,
    letters: LetterMapping = None,
) -> RevolutionPatch:
    """A quarter of a cylinder about the z axis, from z = 0 up to a height; for the rest see `cone_quarter`.

    Examples
    --------
    >>> cylinder_quarter(2, 5).mean_curvature(0.5, 0.5).round(12)
    np.float64(-0.25)
    """
    return cone_quarter(radius, height, top=radius, blend_u=blend_u, blend_v=blend_v, exact=exact, letters=letters)


def sphere(
    radius: Any = 1,
    *,
    pieces: tuple[int, int] = (4, 2),
    blend_u: Blend = None,
    blend_v: Blend = None,
    letters: LetterMapping = None,
) -> list[RevolutionPatch]:
    """A sphere in equal pieces, along the parallels and along the meridian; normals point outwards.

    Examples
    --------
    >>> len(sphere(2)), sphere(2)[0].surface.shape.expression
    (8, -x**2/4 - y**2/4 - z**2/4 + 1)
    """
    return ellipsoid(radius, radius, radius, pieces=pieces, blend_u=blend_u, blend_v=blend_v, letters=letters)


def ellipsoid(
    a: Any,
    b: Any,
    c: Any,
    *,
    pieces: tuple[int, int] = (4, 2),
    blend_u: Blend = None,
    blend_v: Blend = None,
    letters: LetterMapping = None,
) -> list[RevolutionPatch]:
    """An ellipsoid with the semi-axes a, b, c in equal pieces; normals point outwards.

    Examples
    --------
    >>> float(max(abs(patch(1.0, 0.5)).max() for patch in ellipsoid(3, 2, 1)).round(6))
    2.12132
    """
    surface = _ellipsoid(a, b, c, -sp.pi / 2, HALF_TURN, letters)
    return surface.patches(pieces, blend_u=blend_u, blend_v=blend_v)


def torus(
    R: Any,
    r: Any,
    *,
    pieces: tuple[int, int] = (4, 4),
    blend_u: Blend = None,
    blend_v: Blend = None,
    letters: LetterMapping = None,
) -> list[RevolutionPatch]:
    """A torus in equal pieces; normals point outwards.

    Examples
    --------
    >>> len(torus(3, 1)), torus(3, 1)[0].surface.shape.expression
    (16, -x**2/2 - y**2/2 - z**2/2 + 3*sqrt(x**2 + y**2) - 4)
    """
    return _torus(R, r, TURN, letters).patches(pieces, blend_u=blend_u, blend_v=blend_v)


def cone(
    radius: Any,
    height: Any,
    *,
    top: Any = 0,
    pieces: tuple[int, int] = (4, 1),
    blend_u: Blend = None,
    blend_v: Blend = None,
    letters: LetterMapping = None,
) -> list[RevolutionPatch]:
    """The mantle of a cone, or of a frustum with a radius at the top, in equal pieces.

    Examples
    --------
    >>> (cone(1, 1)[3](1.0, 0.0).round(12) + 0).tolist()
    [1.0, 0.0, 0.0]
    """
    surface = Revolution(Segment((radius, 0), (top, height)), letters=letters)
    return surface.patches(pieces, blend_u=blend_u, blend_v=blend_v)


def cylinder(
    radius: Any,
    height: Any,
    *,
    pieces: tuple[int, int] = (4, 1),
    blend_u: Blend = None,
    blend_v: Blend = None,
    letters: LetterMapping = None,
) -> list[RevolutionPatch]:
    """The mantle of a cylinder in equal pieces.

    Examples
    --------
    >>> len(cylinder(1, 2, pieces=(3, 2)))
    6
    """
    return cone(radius, height, top=radius, pieces=pieces, blend_u=blend_u, blend_v=blend_v, letters=letters)


def _ellipsoid(a: Any, b: Any, c: Any, start: Any, span: Any, letters: LetterMapping) -> Revolution:
    if a == b == c:
        return Revolution(Arc((0, 0), (a, a), start, span), letters=letters)
    return Revolution(Arc((0, 0), (1, c), start, span), scale=(a, b), letters=letters)


def _torus(R: Any, r: Any, span: Any, letters: LetterMapping) -> Revolution:
    outer, tube = number(R), number(r)
    if outer.is_real and tube.is_real and outer.is_number and tube.is_number and not outer >= tube:
        raise RsymError(
            f"the tube of a torus must not cross the axis: R = {float(outer):g} is less than r = {float(tube):g}",
            code="radius",
            remedy="take R >= r",
        )
    return Revolution(Arc((outer, 0), (tube, tube), 0, span), letters=letters)
