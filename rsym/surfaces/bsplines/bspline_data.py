"""From data points and the wishes of the user to parameters and spline spaces; curves through points or near them."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.bsplines.band_qr import DEPENDENT, BandQR
from rsym.surfaces.bsplines.bspline_fitting import (
    Pair,
    SplineFit,
    broadcast,
    check_met,
    check_near,
    residual_at,
    singular,
    undetermined,
)
from rsym.surfaces.bsplines.data_parameters import (
    EXPONENTS,
    DataParameters,
    are_settled,
    averaged_space,
    check_data,
    chord_parameters,
    given_parameters,
)
from rsym.surfaces.bsplines.spline_spaces import Spaces, SplineSpace, checked_order, checked_space, uniform_space
from rsym.surfaces.parameters import Interval, real_array, wrapped

Both: TypeAlias = tuple[Any, Any]
# What has one parameter of this name: rows and columns of a net, points of a curve.
WORDS = {"u": "row", "v": "column", "t": "point"}


def checked_points(points: ArrayLike, what: str, *, scattered: bool = False) -> Floats:
    """A net of finite points (r, s, 3), r and s at least 2; or points (n, 3) where these are allowed."""
    shapes = "(r, s, 3) or (n, 3)" if scattered else "(r, s, 3)"
    try:
        net = np.array(real_array(points))
    except (TypeError, ValueError) as error:
        raise RsymError(
            f"{what} must be an array of numbers {shapes}: {error}",
            code="points",
            remedy="np.stack([x, y, z], axis=-1)",
        ) from error
    fits = net.ndim == 3 or (scattered and net.ndim == 2)
    if not fits or net.shape[-1] != 3 or min(net.shape[:-1]) < 2:
        raise RsymError(
            f"{what} must have the shape {shapes} with r and s at least 2, got {net.shape}",
            code="points",
            remedy="r rows of s points in space: a topological rectangle"
            + (", or scattered points with parameters for each" if scattered else ""),
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


def orders_of(order: Any, degree: Any) -> Both:
    """The orders for u and v, given as such or as degrees, which are one less; (4, 4) where neither is given."""
    if degree is None:
        return (4, 4) if order is None else pair_of(order, "order")
    first, second = pair_of(degree, "degree")
    return order_of(order, first), order_of(order, second)


def order_of(order: Any, degree: Any) -> Any:
    """One order, given as such or as a degree, which is one less; 4 where neither is given.

    Examples
    --------
    >>> order_of(None, 2), order_of(5, None), order_of(None, None)
    (3, 5, 4)
    """
    if degree is None:
        return 4 if order is None else order
    if order is not None:
        raise RsymError(
            f"an order is one more than the degree, and both are given: {order!r} and {degree!r}",
            code="order",
            remedy="give one of them",
        )
    if isinstance(degree, bool) or not isinstance(degree, int | np.integer) or degree < 1:
        raise RsymError(f"a degree is an integer >= 1, got {degree!r}", code="degree", remedy="3 for cubic splines")
    return int(degree) + 1


def spaces_for_data(
    points: Floats, vertices: Any, order: Any, parameters: Any, per_point: bool, knots: Any, closed: Any
) -> tuple[Spaces, Pair]:
    """The spline spaces of a fit, and the parameters of its data."""
    counts, orders, turns = pair_of(vertices, "vertices"), pair_of(order, "order"), directions(closed)
    rules = (parameters, parameters) if isinstance(parameters, str) else pair_of(parameters, "parameters")
    wishes = (knots, knots) if isinstance(knots, str) else pair_of(knots, "knots")
    (first, u), (second, v) = (
        space_along(
            points, axis, "uv"[axis], counts[axis], orders[axis], rules[axis], per_point, wishes[axis], turns[axis]
        )
        for axis in (0, 1)
    )
    if max(u.ndim, v.ndim) == 2:
        u, v = (np.broadcast_to(one, points.shape[:2]) for one in broadcast((u, v)))
    return (first, second), (u, v)


def space_along(
    points: Floats, axis: int, name: str, count: Any, order: Any, rule: Any, per_point: bool, knots: Any, closed: bool
) -> tuple[SplineSpace, Floats]:
    """The spline space of a fit along one axis of the data (r, s, 3), and their parameters."""
    available = points.shape[axis]
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count > available:
        raise RsymError(
            f"{available} points along {name} determine at most {available} vertices, got {count!r}",
            code="vertices",
            remedy="take fewer vertices; the source asks 2 <= k <= n + 1 <= r",
        )
    degree = checked_order(order, int(count), name) - 1
    if closed:
        _check_turn(points, axis, name)
    ready = None if knots is None or isinstance(knots, str) else checked_space(order, knots, int(count), closed, name)
    interval = ready.domain if ready else (0.0, 1.0)
    data = _parameters(points, axis, name, degree, rule, per_point, closed, interval)
    if count == available:
        _check_steps(data, name, closed)
    space = ready or space_for(data, degree, int(count), knots, closed)
    return space, _placed(data, space, name)


def _parameters(
    points: Floats, axis: int, name: str, degree: int, rule: Any, per_point: bool, closed: bool, interval: Interval
) -> DataParameters:
    if not isinstance(rule, str):
        return given_parameters(rule, axis, name, points.shape, closed)
    if rule not in EXPONENTS:
        raise RsymError(
            f"parameters are {' or '.join(map(repr, EXPONENTS))} or arrays, got {rule!r}", code="parameters"
        )
    return chord_parameters(points, axis, name, rule, per_point, interval, closed, halved=degree % 2 == 0)


def space_for(data: DataParameters, degree: int, count: int, knots: Any, closed: bool) -> SplineSpace:
    """The space with knots by a rule, over the interval of the parameters."""
    if knots == "averaged":
        return averaged_space(data.mean, data.interval, degree, count, closed)
    if knots is None or knots == "uniform":
        return uniform_space(degree, count, closed, data.interval)
    raise RsymError(f"knots are 'averaged' or 'uniform' or arrays, got {knots!r}", code="knots")


def _placed(data: DataParameters, space: SplineSpace, name: str) -> Floats:
    """The parameters in the interval of the space."""
    low, high = space.domain
    if space.closed:
        period = data.interval[1] - data.interval[0]
        if not np.isclose(high - low, period, rtol=1e-12, atol=0):
            raise RsymError(
                f"the knots along {name} have the period {high - low:g}, the parameters {period:g}", code="knots"
            )
        return wrapped(data.values, space.domain)
    if (data.values < low).any() or (data.values > high).any():
        raise RsymError(
            f"the parameters along {name} reach from {data.values.min():g} to {data.values.max():g},"
            f" the knots from {low:g} to {high:g}",
            code="knots",
            remedy="give knots that hold all parameters",
        )
    return data.values


def _check_turn(points: Floats, axis: int, name: str) -> None:
    first, last = points.take(0, axis=axis), points.take(-1, axis=axis)
    if np.array_equal(first, last):
        raise RsymError(
            f"the last points along {name} repeat the first: a closed direction closes by itself",
            code="closed",
            remedy=f"leave out the last {WORDS[name]}",
        )


def _check_steps(data: DataParameters, name: str, closed: bool) -> None:
    """Interpolation needs parameters that differ."""
    steps = np.diff(data.mean, append=data.mean[:1] + np.diff(data.interval)) if closed else np.diff(data.mean)
    if (steps <= 0).any():
        place = int(np.flatnonzero(steps <= 0)[0])
        raise RsymError(
            f"the {WORDS[name]}s {place} and {(place + 1) % len(data.mean)} have the same parameter {name}:"
            f" no {'curve' if name == 't' else 'surface'} passes both",
            code="parameters",
            remedy="leave one of them out, give parameters, or use least_squares",
        )


def fitted_curve(
    points: Floats, vertices: Any, order: Any, parameters: Any, knots: Any, closed: bool
) -> tuple[SplineSpace, Floats, SplineFit]:
    """The space, the vertices and the fit of the spline curve nearest to points (n, 3); through them for n vertices.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0.0, 0, 0], [1, 1, 0], [2, 4, 0], [3, 9, 0]])
    >>> space, vertices, fit = fitted_curve(points, 3, 3, range(4), "averaged", False)
    >>> (vertices.round(9) + 0.0).tolist(), fit.residual.maximum < 1e-14
    ([[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [3.0, 9.0, 0.0]], True)
    """
    space, t = space_along(points[:, None, :], 0, "t", vertices, order, parameters, False, knots, closed)
    t = t.reshape(-1)
    check_data(t, space, "t")
    settled = are_settled(t, space)
    system = BandQR(space.matrix(t), 0.0 if settled else DEPENDENT)
    dependent = system.dependent if settled else undetermined(system)
    if dependent is not None:
        raise singular((space,), f"the vertex {dependent} along t")
    found = system.solve(points)
    check_near(found, points)
    residual = residual_at(points, space.spline(found)(t), (t,))
    if space.count == len(points):
        check_met(residual, points)
    return space, found, SplineFit(points, (t,), (residual,))
