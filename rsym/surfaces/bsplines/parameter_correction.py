"""Hoschek's correction: data move along the surface to where they are nearest, and the surface is fitted anew.

Source: Hoschek (1988), Intrinsic parametrization for approximation.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.surfaces.bsplines.bspline_fitting import Pair, Residual, SplineFit, broadcast, fitted_net, residual_of
from rsym.surfaces.bsplines.bspline_loci import constrained_net, kept_vertices
from rsym.surfaces.bsplines.spline_spaces import Spaces, SplineSpace, tensor_values

Array: TypeAlias = NDArray[np.float64]

# Halvings of a step that leads a point away, before it stays where it is.
HALVINGS = 6


def approximated(
    spaces: Spaces, points: Array, parameters: Pair, steps: int, kept: Sequence[tuple[Any, Any]], smoothing: float
) -> tuple[Array, SplineFit]:
    """The net that fits best, then with its kept vertices in place, then with corrected parameters."""
    if isinstance(steps, bool) or not isinstance(steps, int | np.integer) or steps < 0:
        raise RsymError(f"corrections is a number >= 0, got {steps!r}", code="corrections")
    loci = kept_vertices(kept, (spaces[0].count, spaces[1].count))
    if loci and smoothing:
        raise RsymError(
            "vertices are kept, or the surface is smoothed", code="kept", remedy="leave kept= or smoothing= out"
        )
    settled = True

    def fit(places: Pair) -> Array:
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
    spaces: Spaces, points: Array, parameters: Pair, net: Array, steps: int, fit: Callable[[Pair], Array]
) -> tuple[Array, Pair, list[Residual]]:
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


def moved(spaces: Spaces, net: Array, points: Array, parameters: Pair) -> Pair:
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


def _distances(spaces: Spaces, net: Array, points: Array, parameters: Pair) -> Array:
    gaps = points - tensor_values(spaces, net, *parameters)
    return _dot(gaps, gaps)


def _steps(spaces: Spaces, net: Array, points: Array, parameters: Pair) -> Pair:
    """The changes (du, dv) that minimise |p + p_u du + p_v dv - D|, by Gram-Schmidt."""
    p, p_u, p_v = (tensor_values(spaces, net, *broadcast(parameters), order) for order in ((0, 0), (1, 0), (0, 1)))
    gap = points - p
    with np.errstate(all="ignore"):
        share = _dot(p_u, p_v) / _dot(p_u, p_u)
        share = np.where(np.isfinite(share), share, 0.0)
        rest = p_v - share[..., None] * p_u
        dv = _dot(gap, rest) / _dot(rest, rest)
        dv = np.where(np.isfinite(dv), dv, 0.0)
        du = _dot(gap, p_u) / _dot(p_u, p_u) - share * dv
    return np.where(np.isfinite(du), du, 0.0), dv


def _slid(space: SplineSpace, values: Array, step: Array) -> Array:
    """Parameters a step further; those at an end stay there, since the edges of data belong to those of the surface."""
    low, high = space.domain
    if space.closed:
        return np.asarray(low + np.mod(values + step - low, high - low))
    at_end = (values == low) | (values == high)
    return np.where(at_end, values, np.clip(values + step, low, high))


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("...i,...i->...", a, b))
