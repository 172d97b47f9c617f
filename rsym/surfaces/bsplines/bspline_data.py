"""From a net of data points and the wishes of the user to parameters and spline spaces."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.errors import RsymError
from rsym.surfaces.bsplines.bspline_fitting import Pair, broadcast
from rsym.surfaces.bsplines.data_parameters import EXPONENTS, DataParameters, chord_parameters, given_parameters
from rsym.surfaces.bsplines.spline_knots import averaged_space
from rsym.surfaces.bsplines.spline_spaces import Spaces, SplineSpace, checked_order, checked_space, uniform_space
from rsym.surfaces.parameters import real_array

Array: TypeAlias = NDArray[np.float64]
Both: TypeAlias = tuple[Any, Any]


def checked_points(points: ArrayLike, what: str) -> Array:
    """A net of finite points (r, s, 3), r and s at least 2."""
    try:
        net = np.array(real_array(points))
    except (TypeError, ValueError) as error:
        raise RsymError(
            f"{what} must be an array of numbers (r, s, 3): {error}",
            code="points",
            remedy="np.stack([x, y, z], axis=-1)",
        ) from error
    if net.ndim != 3 or net.shape[2] != 3 or min(net.shape[:2]) < 2:
        raise RsymError(
            f"{what} must have the shape (r, s, 3) with r and s at least 2, got {net.shape}",
            code="points",
            remedy="r rows of s points in space: a topological rectangle",
        )
    if not np.isfinite(net).all():
        place = tuple(map(int, np.argwhere(~np.isfinite(net))[0]))
        raise RsymError(f"{what} must be finite, but entry {place} is {net[place]}", code="points")
    return net


def pair_of(given: Any, what: str) -> Both:
    """Something for u and something for v."""
    try:
        first, second = given
    except (TypeError, ValueError) as error:
        raise RsymError(f"{what} must be a pair, one for u and one for v, got {given!r}", code="pair") from error
    return first, second


def directions(closed: Any) -> tuple[bool, bool]:
    """Whether u and v are closed."""
    first, second = pair_of(closed, "closed")
    return bool(first), bool(second)


def spaces_for_data(
    points: Array, vertices: Any, order: Any, parameters: Any, per_point: bool, knots: Any, closed: Any
) -> tuple[Spaces, Pair]:
    """The spline spaces of a fit, and the parameters of its data."""
    counts, orders, turns = pair_of(vertices, "vertices"), pair_of(order, "order"), directions(closed)
    rules = (parameters, parameters) if isinstance(parameters, str) else pair_of(parameters, "parameters")
    wishes = (knots, knots) if isinstance(knots, str) else pair_of(knots, "knots")
    found = [
        _direction(points, axis, counts[axis], orders[axis], rules[axis], per_point, wishes[axis], turns[axis])
        for axis in (0, 1)
    ]
    (first, u), (second, v) = found
    if max(u.ndim, v.ndim) == 2:
        u, v = (np.broadcast_to(one, points.shape[:2]) for one in broadcast((u, v)))
    return (first, second), (u, v)


def _direction(
    points: Array, axis: int, count: Any, order: Any, rule: Any, per_point: bool, knots: Any, closed: bool
) -> tuple[SplineSpace, Array]:
    name, available = "uv"[axis], points.shape[axis]
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count > available:
        raise RsymError(
            f"{available} points along {name} determine at most {available} vertices, got {count!r}",
            code="vertices",
            remedy="take fewer vertices; the source asks 2 <= k <= n + 1 <= r",
        )
    degree = checked_order(order, int(count), name) - 1
    if closed:
        _check_turn(points, axis)
    data = _parameters(points, axis, int(count), degree, rule, per_point, closed)
    if count == available:
        _check_steps(data, name, closed)
    space = _space(data, degree, int(count), knots, closed, name)
    return space, _placed(data, space, name)


def _parameters(
    points: Array, axis: int, count: int, degree: int, rule: Any, per_point: bool, closed: bool
) -> DataParameters:
    if not isinstance(rule, str):
        return given_parameters(rule, axis, points.shape, closed)
    if rule not in EXPONENTS:
        raise RsymError(
            f"parameters are {' or '.join(map(repr, EXPONENTS))} or a pair of arrays, got {rule!r}", code="parameters"
        )
    length = float(count if closed else count - degree)
    return chord_parameters(points, axis, rule, per_point, length, closed, halved=degree % 2 == 0)


def _space(data: DataParameters, degree: int, count: int, knots: Any, closed: bool, name: str) -> SplineSpace:
    if not isinstance(knots, str):
        return checked_space(degree + 1, knots, count, closed, name)
    if knots == "averaged":
        return averaged_space(data.mean, data.interval, degree, count, closed)
    if knots == "uniform":
        return uniform_space(degree, count, closed, data.interval)
    raise RsymError(f"knots are 'averaged' or 'uniform' or a pair of arrays, got {knots!r}", code="knots")


def _placed(data: DataParameters, space: SplineSpace, name: str) -> Array:
    """The parameters in the interval of the space."""
    low, high = space.domain
    if space.closed:
        period = data.interval[1] - data.interval[0]
        if not np.isclose(high - low, period, rtol=1e-12, atol=0):
            raise RsymError(
                f"the knots along {name} have the period {high - low:g}, the parameters {period:g}", code="knots"
            )
        return low + np.mod(data.values - low, high - low)
    if (data.values < low).any() or (data.values > high).any():
        raise RsymError(
            f"the parameters along {name} reach from {data.values.min():g} to {data.values.max():g},"
            f" the knots from {low:g} to {high:g}",
            code="knots",
            remedy="give knots that hold all parameters",
        )
    return data.values


def _check_turn(points: Array, axis: int) -> None:
    first, last = points.take(0, axis=axis), points.take(-1, axis=axis)
    if np.array_equal(first, last):
        raise RsymError(
            f"the last points along {'uv'[axis]} repeat the first: a closed direction closes by itself",
            code="closed",
            remedy=f"leave out the last {'row' if axis == 0 else 'column'}",
        )


def _check_steps(data: DataParameters, name: str, closed: bool) -> None:
    """Interpolation needs parameters that differ."""
    steps = np.diff(data.mean, append=data.mean[:1] + np.diff(data.interval)) if closed else np.diff(data.mean)
    if (steps <= 0).any():
        place = int(np.flatnonzero(steps <= 0)[0])
        which = "rows" if name == "u" else "columns"
        raise RsymError(
            f"the {which} {place} and {(place + 1) % len(data.mean)} have the same parameter {name}:"
            " no surface passes both",
            code="parameters",
            remedy="leave one of them out, give parameters, or use least_squares",
        )
