"""Fundamental forms, normals and curvatures of patches, at poles too.

At a pole one derivative vanishes along an edge, p_u = 0 say. With d the distance in v to the pole, p_u/d tends to
p_uv: so normal and first form are those of the basis (p_uv, p_v). The second form in that basis is

    L = n_v . p_uuv + n . p_uuvv/2,   M = n . p_uvv/2,   N = n . p_vv,

where n_v lies in the tangent plane and n_v . p_v = -N, n_v . p_uv = -M (from n . p_v = 0 and n . p_u = 0). At the
apex of a cone n . p_uuv is not 0, and there is no curvature.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.surfaces.parameters import Interval

Array: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]
LetterValues: TypeAlias = Mapping[Any, float] | None

# Share d of a length below which the value at the pole is used. The limit is off by about d; p_u x p_v by eps/d in
# the normal and eps/d**2 in the curvature: so both ways cost the same at eps**(1/2) and eps**(1/3). The length is the
# interval, for curvatures at most that on which p_v turns: a blunt tip far smaller than the surface has its own.
NORMAL_LIMIT, CURVATURE_LIMIT = 1.5e-8, 6e-6

# At a regular pole n . p_uuv is 0, at the apex of a cone it is not small.
APEX = 1e-3
# Share of the interval from its end within which a pole is that end.
AT_END = 1e-5

SECOND = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
POLE = ((1, 1), (0, 1), (0, 2), (1, 2), (2, 1), (2, 2))


class Surface(Protocol):
    """What has derivatives over a rectangle."""

    @property
    def domain(self) -> tuple[Interval, Interval]:
        """The intervals of u and v."""

    def derivatives(self, u: ArrayLike, v: ArrayLike, orders: Any, *, letters: LetterValues = None) -> list[Array]:
        """Several derivatives, (..., 3) each."""


class Forms(NamedTuple):
    """A normal and the coefficients of both fundamental forms in one basis of the tangent plane."""

    normal: Array
    E: Array
    F: Array
    G: Array
    L: Array
    M: Array
    N: Array


def dot(a: Array, b: Array) -> Array:
    """The scalar product along the last axis."""
    return np.asarray(np.einsum("...i,...i->...", a, b))


def normals(surface: Surface, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Array:
    """Unit normals (..., 3); NaN where the surface has none."""
    p_u, p_v, p_uv = surface.derivatives(u, v, ((1, 0), (0, 1), (1, 1)), letters=letters)
    result = _unit(np.cross(p_u, p_v))
    for axis, at_pole in enumerate(_poles((p_u, p_v), p_uv, [NORMAL_LIMIT * size for size in _lengths(surface)])):
        if at_pole.any():
            places = _places(u, v, at_pole)
            side = _side(surface, places[1 - axis], axis, (p_u, p_v)[axis][at_pole], p_uv[at_pole])
            result[at_pole] = _limit_normal(axis, side, p_u[at_pole], p_v[at_pole], p_uv[at_pole])
    return result


def first_form(surface: Surface, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Array:
    """[[E, F], [F, G]], (..., 2, 2)."""
    p_u, p_v = surface.derivatives(u, v, ((1, 0), (0, 1)), letters=letters)
    return _matrix(dot(p_u, p_u), dot(p_u, p_v), dot(p_v, p_v))


def second_form(surface: Surface, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Array:
    """[[L, M], [M, N]], (..., 2, 2)."""
    n = normals(surface, u, v, letters)
    p_uu, p_uv, p_vv = surface.derivatives(u, v, ((2, 0), (1, 1), (0, 2)), letters=letters)
    return _matrix(dot(n, p_uu), dot(n, p_uv), dot(n, p_vv))


def curvatures(surface: Surface, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> tuple[Array, Array]:
    """The Gaussian and the mean curvature; NaN where the surface has none."""
    one = limit_forms(surface, u, v, letters)
    with np.errstate(all="ignore"):
        area = one.E * one.G - one.F**2
        gaussian = (one.L * one.N - one.M**2) / area
        mean = (one.E * one.N - 2 * one.F * one.M + one.G * one.L) / (2 * area)
    return gaussian, mean


def principal(gaussian: Array, mean: Array) -> Array:
    """The principal curvatures (..., 2), the larger first."""
    root = np.sqrt(np.maximum(mean**2 - gaussian, 0.0))
    return np.stack([mean + root, mean - root], axis=-1)


def limit_forms(surface: Surface, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Forms:
    """Both forms in the basis (p_u, p_v); at a pole in the basis that p_u over the distance to it tends to."""
    p_u, p_v, p_uu, p_uv, p_vv = surface.derivatives(u, v, SECOND, letters=letters)
    n = normals(surface, u, v, letters)
    found = [dot(p_u, p_u), dot(p_u, p_v), dot(p_v, p_v), dot(n, p_uu), dot(n, p_uv), dot(n, p_vv)]
    turns = [
        np.minimum(size, np.maximum(_turning_length(first, second), np.abs(np.asarray(place, np.float64))))
        for first, second, place, size in zip((p_u, p_v), (p_uu, p_vv), (u, v), _lengths(surface), strict=True)
    ]
    for axis, at_pole in enumerate(_poles((p_u, p_v), p_uv, [CURVATURE_LIMIT * one for one in turns])):
        if at_pole.any():
            places, gone = _places(u, v, at_pole), (p_u, p_v)[axis][at_pole]
            side = _side(surface, places[1 - axis], axis, gone, p_uv[at_pole])
            places[1 - axis] = _at_pole(surface, places[1 - axis], axis, gone, p_uv[at_pole])
            limits = _pole_forms(surface, places, axis, side, letters)
            for known, limit in zip(found, limits, strict=True):
                known[at_pole] = limit
    return Forms(n, *found)


def _pole_forms(surface: Surface, places: list[Array], axis: int, side: Array, letters: LetterValues) -> list[Array]:
    """E, F, G, L, M, N at poles where the derivative along the axis vanishes."""
    orders = [order if axis == 0 else order[::-1] for order in POLE]
    p_uv, p_v, p_vv, p_uvv, p_uuv, p_uuvv = surface.derivatives(places[0], places[1], orders, letters=letters)
    n = _limit_normal(axis, side, p_v, p_v, p_uv)
    E, F, G = dot(p_uv, p_uv), dot(p_uv, p_v), dot(p_v, p_v)
    M, N = dot(n, p_uvv) / 2, dot(n, p_vv)
    with np.errstate(all="ignore"):
        area = E * G - F**2
        n_v = ((F * N - G * M) / area)[..., None] * p_uv + ((F * M - E * N) / area)[..., None] * p_v
    L = dot(n_v, p_uuv) + dot(n, p_uuvv) / 2
    L[np.abs(dot(n, p_uuv)) > APEX * np.sqrt(dot(p_uuv, p_uuv))] = np.nan
    return [E, F, G, L, M, N] if axis == 0 else [G, F, E, N, M, L]


def _poles(tangents: tuple[Array, Array], p_uv: Array, near: Sequence[Any]) -> tuple[Flags, Flags]:
    """Where p_u vanishes beside p_uv, nearer in v than the second of two distances, and where p_v does."""
    turning = _size(p_uv)
    at_u, at_v = (_size(one) < distance * turning for one, distance in zip(tangents, near[::-1], strict=True))
    return at_u & ~at_v, at_v & ~at_u


def _lengths(surface: Surface) -> list[float]:
    """The lengths of both intervals."""
    return [high - low for low, high in surface.domain]


def _turning_length(first: Array, second: Array) -> Array:
    """The change of the parameter in which the tangent changes by itself; infinite along a line."""
    with np.errstate(all="ignore"):
        length = _size(first) / _size(second)
    return np.where(np.isfinite(length), length, np.inf)


def _places(u: ArrayLike, v: ArrayLike, where: Flags) -> list[Array]:
    return [np.broadcast_to(np.asarray(one, np.float64), where.shape)[where] for one in (u, v)]


def _at_pole(surface: Surface, values: Array, axis: int, gone: Array, p_uv: Array) -> Array:
    """The parameter of the pole near each place, where `gone`, the derivative along the axis, vanishes."""
    low, high = surface.domain[1 - axis]
    room = AT_END * (high - low)
    moved = np.clip(values - dot(gone, p_uv) / dot(p_uv, p_uv), low, high)
    return np.where(moved < low + room, low, np.where(moved > high - room, high, moved))


def _side(surface: Surface, values: Array, axis: int, gone: Array, p_uv: Array) -> Array:
    """1 where the place is above its pole and -1 where it is below: the sign of the way inwards at an end."""
    low, high = surface.domain[1 - axis]
    pole = _at_pole(surface, values, axis, gone, p_uv)
    inner = (pole > low) & (pole < high)
    return np.where(inner, np.where(dot(gone, p_uv) < 0, -1.0, 1.0), np.where(pole == high, -1.0, 1.0))


def _limit_normal(axis: int, side: Array, p_u: Array, p_v: Array, p_uv: Array) -> Array:
    """The normal at poles where the derivative along the axis is side p_uv times a distance that vanishes."""
    limit = side[:, None] * p_uv
    return _unit(np.cross(limit, p_v) if axis == 0 else np.cross(p_u, limit))


def _size(vectors: Array) -> Array:
    return np.sqrt(dot(vectors, vectors))


def _matrix(a: Array, b: Array, c: Array) -> Array:
    return np.stack([np.stack([a, b], axis=-1), np.stack([b, c], axis=-1)], axis=-2)


def _unit(vectors: Array) -> Array:
    with np.errstate(all="ignore"):
        lengths = _size(vectors)[..., None]
        return np.where(lengths > 0, vectors / lengths, np.nan)
