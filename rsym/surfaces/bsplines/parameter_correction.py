"""Fits with conditions: vertices stay on planes or along curves, and data move to where the surface is nearest.

Data move along the surface to where they are nearest, and it is fitted anew: Hoschek (1988), Intrinsic parametrization
for approximation.

Of kept vertices the source says that an iteration over the parameters of the data does this, and not how; this one is
ours. Each step lets them slide along the tangents of their planes and curves to where the fit of all is best, and
brings them back: the method of Gauss and Newton. Planes take one step. Corrections of the parameters may go between.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.bsplines.band_qr import BandQR
from rsym.surfaces.bsplines.bspline_fitting import (
    Pair,
    Residual,
    SplineFit,
    broadcast,
    collocation_matrix,
    fitted_net,
    residual_of,
)
from rsym.surfaces.bsplines.spline_spaces import Spaces, SplineSpace, tensor_values
from rsym.surfaces.forms import dot
from rsym.surfaces.functions.curves import as_curve
from rsym.surfaces.functions.univariate import Univariate
from rsym.surfaces.parameters import wrapped

# Halvings of a step that leads a point away, before it stays where it is.
HALVINGS = 6

# Steps of the iteration, and the share of the size of the net below which a step is none.
STEPS, STILL = 100, 1e-13
# Halvings of a step that makes the fit worse.
BACKTRACKS = 12
# Places of a curve that are compared before Newton's method sets in.
PLACES = 257


def approximated(
    spaces: Spaces, points: Floats, parameters: Pair, steps: int, kept: Sequence[tuple[Any, Any]], smoothing: float
) -> tuple[Floats, SplineFit]:
    """The net that fits best, then with its kept vertices in place, then with corrected parameters."""
    if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or steps < 0:
        raise RsymError(f"corrections is a number >= 0, got {steps!r}", code="corrections")
    loci = kept_vertices(kept, (spaces[0].count, spaces[1].count))
    if loci and smoothing:
        raise RsymError(
            "vertices are kept, or the surface is smoothed", code="kept", remedy="leave kept= or smoothing= out"
        )
    settled = True

    def fit(places: Pair) -> Floats:
        nonlocal settled
        net = fitted_net(spaces, points, places, smoothing)
        if loci:
            net, settled = constrained_net(spaces, points, places, loci, net)
        return net

    history = [residual_of(spaces, fitted_net(spaces, points, parameters, smoothing), points, parameters)]
    net = fit(parameters)
    if loci:
        history.append(residual_of(spaces, net, points, parameters))
    net, parameters, further = corrected(spaces, points, parameters, net, steps, fit)
    return net, SplineFit(points, parameters, (*history, *further), settled)


def corrected(
    spaces: Spaces, points: Floats, parameters: Pair, net: Floats, steps: int, fit: Callable[[Pair], Floats]
) -> tuple[Floats, Pair, list[Residual]]:
    """A net and parameters after so many corrections, fewer where none helps, and the residual after each."""
    history: list[Residual] = []
    rms = residual_of(spaces, net, points, parameters).rms
    for _ in range(steps):
        nearer = moved(spaces, net, points, parameters)
        try:
            candidate = fit(nearer)
        except RsymError:
            # The data have crowded where they determine too little.
            break
        residual = residual_of(spaces, candidate, points, nearer)
        if residual.rms >= rms:
            break
        net, parameters, rms = candidate, nearer, residual.rms
        history.append(residual)
    return net, parameters, history


def moved(spaces: Spaces, net: Floats, points: Floats, parameters: Pair) -> Pair:
    """Parameters of places on the surface that are nearer to the points; where no step helps, the same."""
    u, v = (np.array(one) for one in np.broadcast_arrays(*broadcast(parameters)))
    steps = _steps(spaces, net, points, (u, v))
    distances = _distances(spaces, net, points, (u, v))
    waiting = np.ones(u.shape, bool)
    for halving in range(HALVINGS):
        tried = tuple(
            _slid(space, values, 0.5**halving * step) for space, values, step in zip(spaces, (u, v), steps, strict=True)
        )
        better = waiting & (_distances(spaces, net, points, (tried[0], tried[1])) < distances)
        u[better], v[better] = tried[0][better], tried[1][better]
        waiting &= ~better
    return u, v


def _distances(spaces: Spaces, net: Floats, points: Floats, parameters: Pair) -> Floats:
    gaps = points - tensor_values(spaces, net, *parameters)
    return dot(gaps, gaps)


def _steps(spaces: Spaces, net: Floats, points: Floats, parameters: Pair) -> Pair:
    """The changes (du, dv) that minimise |p + p_u du + p_v dv - D|, by Gram-Schmidt."""
    p, p_u, p_v = (tensor_values(spaces, net, *broadcast(parameters), order) for order in ((0, 0), (1, 0), (0, 1)))
    gap = points - p
    with np.errstate(all="ignore"):
        share = dot(p_u, p_v) / dot(p_u, p_u)
        share = np.where(np.isfinite(share), share, 0.0)
        rest = p_v - share[..., None] * p_u
        dv = dot(gap, rest) / dot(rest, rest)
        dv = np.where(np.isfinite(dv), dv, 0.0)
        du = dot(gap, p_u) / dot(p_u, p_u) - share * dv
    return np.where(np.isfinite(du), du, 0.0), dv


def _slid(space: SplineSpace, values: Floats, step: Floats) -> Floats:
    """Parameters a step further; those at an end stay there, since the edges of data belong to those of the surface."""
    low, high = space.domain
    if space.closed:
        return wrapped(values + step, space.domain)
    at_end = (values == low) | (values == high)
    return np.where(at_end, values, np.clip(values + step, low, high))


# Vertices kept on planes or along curves while the others are fitted to data.
class Frames(NamedTuple):
    """The nearest places (n, 3) of a locus, orthonormal tangents there (n, 3, dimension), and which end it is.

    `ends` is -1 where the first tangent leads from an end inwards, 1 where it leads outwards, 0 where there is no end.
    """

    places: Floats
    tangents: Floats
    ends: Floats


class Guide(Protocol):
    """Where vertices may lie."""

    def frames(self, points: Floats) -> Frames:
        """What is nearest to the points (n, 3)."""


@dataclass(frozen=True)
class Plane:
    """The plane through a point, perpendicular to a normal.

    Examples
    --------
    >>> places, tangents, ends = Plane((0, 0, 1), (0, 0, 2)).frames(np.array([[3.0, 4.0, 5.0]]))
    >>> places.tolist(), tangents.shape
    ([[3.0, 4.0, 1.0]], (1, 3, 2))
    """

    point: ArrayLike
    normal: ArrayLike
    _place: Floats = field(init=False, repr=False, compare=False)
    _unit: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        try:
            place, normal = (np.array(one, np.float64) for one in (self.point, self.normal))
        except (TypeError, ValueError):
            place = normal = np.empty(0)
        length = float(np.sqrt((normal**2).sum()))
        if place.shape != (3,) or normal.shape != (3,) or not np.isfinite(place).all() or not 0 < length < np.inf:
            raise RsymError("a plane has a point (3,) and a normal (3,) that is not zero", code="plane")
        object.__setattr__(self, "_place", place)
        object.__setattr__(self, "_unit", normal / length)

    def frames(self, points: Floats) -> Frames:
        """The feet of the perpendiculars, and two tangents."""
        heights = np.einsum("ni,i->n", points - self._place, self._unit)
        # The axis least along the normal gives tangents without cancellation.
        first = np.cross(self._unit, np.eye(3)[np.abs(self._unit).argmin()])
        first /= np.sqrt((first**2).sum())
        tangents = np.stack([first, np.cross(self._unit, first)], axis=-1)
        feet = points - heights[:, None] * self._unit
        return Frames(feet, np.broadcast_to(tangents, (len(points), 3, 2)), np.zeros(len(points)))


@dataclass(frozen=True, eq=False)
class Along:
    """The points of a curve."""

    curve: Univariate

    def frames(self, points: Floats) -> Frames:
        """The nearest points of the curve, and its unit tangents there."""
        low, high = self.curve.domain
        sampled = np.linspace(low, high, PLACES)
        gaps = self.curve(sampled)[None] - points[:, None]
        t = sampled[np.einsum("nti,nti->nt", gaps, gaps).argmin(axis=1)]
        for _ in range(20):
            place, speed, bend = self.curve.evaluate(t, [0, 1, 2])
            gap = place - points
            slope = np.einsum("ni,ni->n", speed, gap)
            square = np.einsum("ni,ni->n", speed, speed)
            rise = square + np.einsum("ni,ni->n", bend, gap)
            # Where Newton's step would climb, that of Gauss and Newton does not.
            t = t - slope / np.where(rise > 0.1 * square, rise, np.where(square > 0, square, 1.0))
            t = wrapped(t, (low, high)) if self.curve.closed else np.clip(t, low, high)
        place, speed = self.curve.evaluate(t, [0, 1])
        lengths = np.sqrt(np.einsum("ni,ni->n", speed, speed))
        ends = np.zeros(len(t)) if self.curve.closed else (t == high) * 1.0 - (t == low)
        # Where a curve stands still it has no tangent, and a vertex stays.
        return Frames(place, (speed / np.where(lengths > 0, lengths, 1.0)[:, None])[:, :, None], ends)


@dataclass(frozen=True, eq=False)
class Kept:
    """Vertices and the locus that they are kept on, by numbers i*(m+1) + j."""

    vertices: NDArray[np.intp]
    locus: Guide


def kept_vertices(given: Sequence[tuple[Any, Any]], shape: tuple[int, int]) -> list[Kept]:
    """The user's pairs (index into the net, plane or curve)."""
    numbers = np.arange(shape[0] * shape[1]).reshape(shape)
    taken: set[int] = set()
    result = []
    for index, locus in _pairs(given):
        try:
            vertices = np.unique(numbers[index])
        except IndexError:
            vertices = numbers[:0, 0]
        if not len(vertices):
            raise RsymError(f"no vertices {index!r} in a net of {shape[0]} x {shape[1]}", code="kept")
        twice = taken.intersection(vertices.tolist())
        if twice:
            vertex = divmod(min(twice), shape[1])
            raise RsymError(f"the vertex {vertex} is kept on two loci", code="kept", remedy="give each vertex one")
        taken.update(vertices.tolist())
        result.append(Kept(vertices, locus if isinstance(locus, Plane) else Along(as_curve(locus, what="a locus"))))
    return result


def _pairs(given: Any) -> list[tuple[Any, Any]]:
    try:
        return [(index, locus) for index, locus in given]
    except (TypeError, ValueError) as error:
        raise RsymError(
            f"kept is a sequence of pairs (vertices, plane or curve), got {given!r}",
            code="kept",
            remedy="for example [(numpy.s_[0, :], Plane((0, 0, 0), (0, 0, 1)))]",
        ) from error


def constrained_net(
    spaces: Spaces, points: Floats, parameters: Pair, kept: Sequence[Kept], free_fit: Floats
) -> tuple[Floats, bool]:
    """The net nearest the points in the sense of least squares with its kept vertices where they may lie.

    `free_fit` is the net without constraints. Of C = [F K] with the kept vertices last, C = QR, the last block of R
    alone says what it costs to move these, if the others follow.
    """
    matrix = collocation_matrix(spaces, parameters)
    numbers = np.concatenate([one.vertices for one in kept])
    free = np.setdiff1d(np.arange(matrix.shape[1]), numbers)
    system = BandQR(matrix[:, free])
    rest = system.turned(matrix[:, numbers])[len(free) :]
    cost = BandQR(rest).upper
    flat = free_fit.reshape(-1, 3).copy()
    flat[numbers], converged = _settled(cost, flat[numbers], kept)
    gaps = points - tensor_values(spaces, flat.reshape(free_fit.shape), *broadcast(parameters))
    flat[free] += system.solve(gaps.reshape(-1, 3))
    return flat.reshape(free_fit.shape), converged


def _settled(cost: Floats, target: Floats, kept: Sequence[Kept]) -> tuple[Floats, bool]:
    """The places on the loci with the least |cost (places - target)|, and whether they stand still."""
    size = float(np.abs(target).max())
    here = _brought_back(target, kept)
    for _ in range(STEPS):
        step = _slide(cost, target - here.places, here)
        for halving in range(BACKTRACKS):
            there = _brought_back(here.places + 0.5**halving * step, kept)
            if _length(cost, there.places - target) <= _length(cost, here.places - target):
                break
        else:
            return here.places, float(np.abs(step).max()) <= np.sqrt(STILL) * size
        way = float(np.abs(there.places - here.places).max())
        here = there
        if way <= STILL * size:
            return here.places, True
    return here.places, False


def _brought_back(places: Floats, kept: Sequence[Kept]) -> Frames:
    """The nearest places on the loci, with as many directions (number, 3, 2) as there are; others are zero."""
    result = Frames(np.empty_like(places), np.zeros((len(places), 3, 2)), np.zeros(len(places)))
    start = 0
    for one in kept:
        part = slice(start, start + len(one.vertices))
        found = one.locus.frames(places[part])
        result.places[part], result.ends[part] = found.places, found.ends
        result.tangents[part, :, : found.tangents.shape[2]] = found.tangents
        start = part.stop
    return result


def _slide(cost: Floats, gaps: Floats, frames: Frames) -> Floats:
    """The change of the places along their directions that brings them nearest; none beyond the end of a curve."""
    right = np.einsum("ij,jx->ix", cost, gaps)
    pull = np.einsum("ij,ix,jxd->jd", cost, right, frames.tangents)
    used = np.einsum("jxd,jxd->jd", frames.tangents, frames.tangents) > 0.5
    used &= (frames.ends == 0)[:, None] | (frames.ends[:, None] * pull < 0)
    vertices, directions = np.nonzero(used)
    tangents = frames.tangents[vertices, :, directions]
    matrix = cost[:, None, vertices] * tangents.T[None]
    found = BandQR(matrix.reshape(right.size, -1)).solve(right.reshape(-1))
    change = np.zeros_like(gaps)
    np.add.at(change, vertices, found[:, None] * tangents)
    return change


def _length(cost: Floats, gaps: Floats) -> float:
    turned = np.einsum("ij,jx->ix", cost, gaps)
    return float(np.einsum("ix,ix->", turned, turned))
