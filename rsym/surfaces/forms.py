"""Fundamental forms, normals and curvatures of patches, at poles too.

At a pole one derivative vanishes along an edge, p_u = 0 say. At the distance d from it in v, with means over the way
s d, 0 <= s <= 1, the forms in the basis (a, p_v) are those of

    a = p_u/d = mean of p_uv,   M/d = n . mean of s p_uvv,   L/d**2 = n . w/d + n . mean of (1 - s) p_uuvv,

with w = p_uuv at the pole. There w lies in the tangent plane, w = alpha a + beta p_v, and as n is perpendicular to a
and p_v, n . w/d = -n . (alpha mean of (1 - s) p_uvv + beta mean of p_vv). So nothing is divided by d, which may be 0.
At the apex of a cone w is not in that plane: the curvature grows as 1/d, and at the apex there is none.

Where a parameter stands still on an edge, p_v = 0 = p_uv there, s = d**2/2 runs in its place: p_s = p_v/d tends to a =
p_vv. The forms in the basis (p_u, a) have M = n . p_uvv and N = n . p_vvvv/3, or none where p_vvv leaves the plane.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Flags, Floats
from rsym.surfaces.parameters import Interval, LetterValues

# Share d of a length below which a place is taken for one at a pole. At an end of the interval means with three nodes
# are off by d**6, p_u x p_v by eps/d**2. At a pole inside, whose place is not known so well, its own value is taken,
# and the normal is so at any: that is off by d, p_u x p_v by eps/d in the normal. The length is the interval, for
# curvatures at most that on which p_v turns: a blunt tip far smaller than the surface has its own.
AT_POLE, INNER_POLE, NORMAL_LIMIT = 2e-3, 6e-6, 1.5e-8

# At a regular pole n . p_uuv is 0, at the apex of a cone it is not small beside p_uuv and p_uv over the interval of u.
APEX = 1e-9
# Share of the interval from its end within which a pole is that end, if p_u there is not more than VANISHED of p_uv
# times the length.
AT_END, VANISHED = 1e-5, 1e-9
# Gauss's rule on [0, 1].
NODES, WEIGHTS = (0.5 - 0.15**0.5, 0.5, 0.5 + 0.15**0.5), (5 / 18, 8 / 18, 5 / 18)

SECOND = ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
STILL = ((1, 0), (0, 2), (2, 0), (1, 2), (0, 3), (0, 4))
POLE = ((1, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 1), (2, 2))


class HasDerivatives(Protocol):
    """What has derivatives over a rectangle."""

    @property
    def domain(self) -> tuple[Interval, Interval]:
        """The intervals of u and v."""

    def derivatives(self, u: ArrayLike, v: ArrayLike, orders: Any, *, letters: LetterValues = None) -> list[Floats]:
        """Several derivatives, (..., 3) each."""


class Forms(NamedTuple):
    """A normal and the coefficients of both fundamental forms in one basis of the tangent plane."""

    normal: Floats
    E: Floats
    F: Floats
    G: Floats
    L: Floats
    M: Floats
    N: Floats


def dot(a: Floats, b: Floats) -> Floats:
    """The scalar product along the last axis."""
    return np.asarray(np.einsum("...i,...i->...", a, b))


def normals(surface: HasDerivatives, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Floats:
    """Unit normals (..., 3); NaN where the surface has none."""
    p_u, p_v, p_uv = surface.derivatives(u, v, ((1, 0), (0, 1), (1, 1)), letters=letters)
    result = _unit(np.cross(p_u, p_v))
    at_u, at_v = _poles((p_u, p_v), p_uv, [AT_POLE * size for size in _lengths(surface)])
    near = at_u | at_v
    if near.any():
        rows, columns = _places(u, v, near)
        result[near] = limit_forms(surface, rows, columns, letters).normal
    return result


def first_form(surface: HasDerivatives, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Floats:
    """[[E, F], [F, G]], (..., 2, 2)."""
    p_u, p_v = surface.derivatives(u, v, ((1, 0), (0, 1)), letters=letters)
    return _matrix(dot(p_u, p_u), dot(p_u, p_v), dot(p_v, p_v))


def second_form(surface: HasDerivatives, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Floats:
    """[[L, M], [M, N]], (..., 2, 2)."""
    n = normals(surface, u, v, letters)
    p_uu, p_uv, p_vv = surface.derivatives(u, v, ((2, 0), (1, 1), (0, 2)), letters=letters)
    return _matrix(dot(n, p_uu), dot(n, p_uv), dot(n, p_vv))


def curvatures(
    surface: HasDerivatives, u: ArrayLike, v: ArrayLike, letters: LetterValues = None
) -> tuple[Floats, Floats]:
    """The Gaussian and the mean curvature; NaN where the surface has none."""
    one = limit_forms(surface, u, v, letters)
    with np.errstate(all="ignore"):
        area = one.E * one.G - one.F**2
        gaussian = (one.L * one.N - one.M**2) / area
        mean = (one.E * one.N - 2 * one.F * one.M + one.G * one.L) / (2 * area)
    return gaussian, mean


def principal(gaussian: Floats, mean: Floats) -> Floats:
    """The principal curvatures (..., 2), the larger first."""
    root = np.sqrt(np.maximum(mean**2 - gaussian, 0.0))
    return np.stack([mean + root, mean - root], axis=-1)


def limit_forms(surface: HasDerivatives, u: ArrayLike, v: ArrayLike, letters: LetterValues = None) -> Forms:
    """Both forms in the basis (p_u, p_v); at a pole in the basis that p_u over the distance to it tends to."""
    p_u, p_v, p_uu, p_uv, p_vv = surface.derivatives(u, v, SECOND, letters=letters)
    n = _unit(np.cross(p_u, p_v))
    found = [dot(p_u, p_u), dot(p_u, p_v), dot(p_v, p_v), dot(n, p_uu), dot(n, p_uv), dot(n, p_vv)]
    turns = [
        np.minimum(size, np.maximum(_turning_length(first, second), np.abs(np.asarray(place, np.float64))))
        for first, second, place, size in zip((p_u, p_v), (p_uu, p_vv), (u, v), _lengths(surface), strict=True)
    ]
    for axis, near in enumerate(_poles((p_u, p_v), p_uv, [AT_POLE * one for one in turns])):
        if near.any():
            places, gone = _places(u, v, near), (p_u, p_v)[axis][near]
            inner = np.broadcast_to(INNER_POLE * turns[1 - axis], near.shape)[near]
            (sure, used), normal, limits = _pole_forms(surface, places, axis, gone, p_uv[near], inner, letters)
            n[near] = np.where(sure[:, None], normal, n[near])
            for known, limit in zip(found, limits, strict=True):
                known[near] = np.where(used, limit, known[near])
    for axis, (gone, second, size) in enumerate(zip((p_u, p_v), (p_uu, p_vv), _lengths(surface), strict=True)):
        least = VANISHED * size * norm(second)
        still = (norm(gone) <= least) & (norm(p_uv) <= least) & (least > 0) & (least < np.inf)
        if still.any():
            places = _places(u, v, still)
            n[still], limits = _still_forms(surface, places, axis, letters)
            for known, limit in zip(found, limits, strict=True):
                known[still] = limit
    return Forms(n, *found)


def _still_forms(
    surface: HasDerivatives, places: list[Floats], axis: int, letters: LetterValues
) -> tuple[Floats, list[Floats]]:
    """Normal and forms on an edge on which the parameter of an axis stands still, NaN elsewhere."""
    low, high = surface.domain[axis]
    side = np.where(places[axis] == low, 1.0, np.where(places[axis] == high, -1.0, np.nan))
    orders = [order if axis == 1 else order[::-1] for order in STILL]
    u, v = places
    along, a, bent, twist, off, steep = surface.derivatives(u, v, orders, letters=letters)
    a, twist = side[:, None] * a, side[:, None] * twist
    n = _unit(np.cross(along, a) if axis == 1 else np.cross(a, along))
    there = np.where(np.abs(dot(n, off)) <= APEX * norm(a) / (high - low), dot(n, steep) / 3, np.nan)
    forms = [dot(along, along), dot(along, a), dot(a, a), dot(n, bent), dot(n, twist), there]
    return n, forms if axis == 1 else [forms[k] for k in (2, 1, 0, 5, 4, 3)]


def _pole_forms(
    surface: HasDerivatives,
    places: list[Floats],
    axis: int,
    gone: Floats,
    p_uv: Floats,
    inner: Floats,
    letters: LetterValues,
) -> tuple[tuple[Flags, Flags], Floats, list[Floats]]:
    """Where normal and forms near poles hold, and what they are; `gone` is the derivative that vanishes."""
    low, high = surface.domain[1 - axis]
    pole = _at_pole(surface, places[1 - axis], axis, gone, p_uv)
    at_end = (pole == low) | (pole == high)
    distance = np.where(at_end, places[1 - axis] - pole, 0.0)
    way = pole + np.array([0.0, *NODES, 1.0])[:, None] * distance
    along = np.broadcast_to(places[axis], way.shape)
    orders = [order if axis == 0 else order[::-1] for order in POLE]
    u, v = (along, way) if axis == 0 else (way, along)
    p_u, p_v, p_vv, p_uv, p_uvv, p_uuv, p_uuvv = surface.derivatives(u, v, orders, letters=letters)
    side = _side(surface, places[1 - axis], axis, gone, p_uv[0])
    normal, forms = _forms_by_means(
        axis, side, distance, _lengths(surface)[axis], (p_v, p_vv, p_uv, p_uvv, p_uuv, p_uuvv)
    )
    vanished = norm(p_u[0]) <= VANISHED * (high - low) * norm(p_uv[0])
    vanished &= np.isfinite(forms).all(axis=0) | (distance == 0)  # derivatives of high order may not exist
    away = np.abs(places[1 - axis] - pole)
    hold = [np.where(at_end, vanished, away < room) for room in (NORMAL_LIMIT * (high - low), inner)]
    return (hold[0], hold[1]), normal, forms if axis == 0 else [forms[k] for k in (2, 1, 0, 5, 4, 3)]


def _forms_by_means(
    axis: int, side: Floats, distance: Floats, length: float, derivatives: Sequence[Floats]
) -> tuple[Floats, list[Floats]]:
    """Normal and forms in the basis (p_u/d, p_v), from derivatives at the pole, on the way from it and at its end."""
    p_v, p_vv, p_uv, p_uvv, p_uuv, p_uuvv = derivatives
    back = [1 - share for share in NODES]
    a, n = _mean(p_uv), _limit_normal(axis, side, p_v[-1], p_v[-1], _mean(p_uv))
    E, F, G = dot(a, a), dot(a, p_v[-1]), dot(p_v[-1], p_v[-1])
    w, pole_a, pole_v = p_uuv[0], p_uv[0], p_v[0]
    out = dot(w, _limit_normal(axis, side, pole_v, pole_v, pole_a))
    with np.errstate(all="ignore"):
        e, f, g = dot(pole_a, pole_a), dot(pole_a, pole_v), dot(pole_v, pole_v)
        in_a, in_v = dot(w, pole_a) / (e * g - f**2), dot(w, pole_v) / (e * g - f**2)
        alpha, beta = g * in_a - f * in_v, e * in_v - f * in_a
        steep = np.where(distance == 0, np.nan, out / distance)
    L = dot(n, _mean(p_uuvv, back) - alpha[:, None] * _mean(p_uvv, back) - beta[:, None] * _mean(p_vv))
    L += np.where(np.abs(out) > APEX * (norm(w) + norm(pole_a) / length), steep, 0.0)
    return n, [E, F, G, L, dot(n, _mean(p_uvv, NODES)), dot(n, p_vv[-1])]


def _mean(values: Floats, weights: Sequence[float] = (1.0, 1.0, 1.0)) -> Floats:
    """The mean over the way of values at its start, the nodes and its end, times weights at the nodes."""
    terms = [w * one * value for w, one, value in zip(WEIGHTS, weights, values[1:-1], strict=True)]
    return np.asarray(np.add.reduce(terms))


def _poles(tangents: tuple[Floats, Floats], p_uv: Floats, near: Sequence[Any]) -> tuple[Flags, Flags]:
    """Where p_u vanishes beside p_uv, nearer in v than the second of two distances, and where p_v does."""
    turning = norm(p_uv)
    at_u, at_v = (
        (norm(one) <= distance * turning) & (turning > 0) for one, distance in zip(tangents, near[::-1], strict=True)
    )
    return at_u & ~at_v, at_v & ~at_u


def _lengths(surface: HasDerivatives) -> list[float]:
    """The lengths of both intervals."""
    return [high - low for low, high in surface.domain]


def _turning_length(first: Floats, second: Floats) -> Floats:
    """The change of the parameter in which the tangent changes by itself; infinite along a line."""
    with np.errstate(all="ignore"):
        length = norm(first) / norm(second)
    return np.where(np.isfinite(length), length, np.inf)


def _places(u: ArrayLike, v: ArrayLike, where: Flags) -> list[Floats]:
    return [np.broadcast_to(np.asarray(one, np.float64), where.shape)[where] for one in (u, v)]


def _at_pole(surface: HasDerivatives, values: Floats, axis: int, gone: Floats, p_uv: Floats) -> Floats:
    """The parameter of the pole near each place, where `gone`, the derivative along the axis, vanishes."""
    low, high = surface.domain[1 - axis]
    room = AT_END * (high - low)
    moved = np.clip(values - dot(gone, p_uv) / dot(p_uv, p_uv), low, high)
    return np.where(moved < low + room, low, np.where(moved > high - room, high, moved))


def _side(surface: HasDerivatives, values: Floats, axis: int, gone: Floats, p_uv: Floats) -> Floats:
    """1 where the place is above its pole and -1 where it is below: the sign of the way inwards at an end."""
    low, high = surface.domain[1 - axis]
    pole = _at_pole(surface, values, axis, gone, p_uv)
    inner = (pole > low) & (pole < high)
    return np.where(inner, np.where(dot(gone, p_uv) < 0, -1.0, 1.0), np.where(pole == high, -1.0, 1.0))


def _limit_normal(axis: int, side: Floats, p_u: Floats, p_v: Floats, p_uv: Floats) -> Floats:
    """The normal at poles where the derivative along the axis is side p_uv times a distance that vanishes."""
    limit = side[:, None] * p_uv
    return _unit(np.cross(limit, p_v) if axis == 0 else np.cross(p_u, limit))


def norm(vectors: Floats) -> Floats:
    """The lengths of vectors along the last axis."""
    return np.sqrt(dot(vectors, vectors))


def _matrix(a: Floats, b: Floats, c: Floats) -> Floats:
    return np.stack([np.stack([a, b], axis=-1), np.stack([b, c], axis=-1)], axis=-2)


def _unit(vectors: Floats) -> Floats:
    with np.errstate(all="ignore"):
        lengths = norm(vectors)[..., None]
        return np.where(lengths > 0, vectors / lengths, np.nan)
