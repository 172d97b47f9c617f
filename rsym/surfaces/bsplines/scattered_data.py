"""From scattered points (n, 3) and their parameters to spline spaces, and whether such data determine a surface.

Each vertex needs a datum of its own where it matters (Schoenberg and Whitney 1953). Along a curve that is enough; of
scattered data it is only asked, and a system without a unique solution is found when it is solved.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.bsplines.bspline_data import directions, pair_of, space_for
from rsym.surfaces.bsplines.bspline_fitting import Pair
from rsym.surfaces.bsplines.data_parameters import DataParameters
from rsym.surfaces.bsplines.spline_spaces import Spaces, SplineSpace, checked_order, checked_space
from rsym.surfaces.parameters import real_array, wrapped

# Points whose breadth is less than this share of their length lie on a line: they have no plane.
LINE = 1e-9


def spaces_for_scattered(
    points: Floats, vertices: Any, order: Any, parameters: Any, knots: Any, closed: Any, smooth: bool
) -> tuple[Spaces, Pair]:
    """The spline spaces of a fit to points (n, 3), and their parameters, (n,) each; what is smoothed may have holes."""
    counts, turns = pair_of(vertices, "vertices"), directions(closed)
    wishes = (knots, knots) if isinstance(knots, str) else pair_of(knots, "knots")
    given = _in_plane(points) if isinstance(parameters, str) and parameters == "plane" else parameters
    if isinstance(given, str):
        raise RsymError(
            f"scattered points (n, 3) need parameters for each of them, got {given!r}",
            code="parameters",
            remedy='parameters=(u, v), or "plane": their places in the nearest plane; chords need a net (r, s, 3)',
        )
    pair = pair_of(given, "parameters")
    values = [_numbers(one, len(points), name) for one, name in zip(pair, "uv", strict=True)]
    each = zip(values, counts, order, wishes, turns, "uv", strict=True)
    first, second = (_space(*one) for one in each)
    if not smooth:
        _check_count(counts, len(points))
    places = tuple(_placed(one, space, name) for one, space, name in zip(values, (first, second), "uv", strict=True))
    if not smooth:
        check_scattered((first, second), (places[0], places[1]))
    return (first, second), (places[0], places[1])


def check_scattered(spaces: Spaces, parameters: Pair) -> None:
    """Refuse data that leave a vertex without a datum of its own, naming where it matters."""
    rows, columns = (space.local(values) for space, values in zip(spaces, parameters, strict=True))
    shape = (spaces[0].count, spaces[1].count)
    matters = (rows[1][:, :, None] > 0) & (columns[1][:, None, :] > 0)
    numbers = (rows[0][:, :, None] * shape[1] + columns[0][:, None, :])[matters]
    data = np.nonzero(matters)[0]
    graph = csr_array((np.ones(len(data), bool), (numbers, data)), shape=(shape[0] * shape[1], len(parameters[0])))
    alone = np.flatnonzero(maximum_bipartite_matching(graph, perm_type="column") < 0)
    if not len(alone):
        return
    empty = np.flatnonzero(np.diff(graph.indptr) == 0)
    row, column = divmod(int((empty if len(empty) else alone)[0]), shape[1])
    u, v = (_support(space, number) for space, number in zip(spaces, (row, column), strict=True))
    others = f", and {len(alone) - 1} more" if len(alone) > 1 else ""
    raise RsymError(
        f"no datum left for the vertex ({row}, {column}): it matters for u in {u}, v in {v}{others} "
        "(Schoenberg-Whitney)",
        code="schoenberg-whitney",
        remedy='take fewer vertices, knots="averaged", which follow the data, or least_squares with smoothing=1e-6',
    )


def _support(space: SplineSpace, number: int) -> str:
    """The interval of a basis function inside that of the parameter."""
    low, high = space.domain
    start, stop = space.knots[number], space.knots[number + space.degree + 1]
    if not space.closed:
        start, stop = max(start, low), min(stop, high)
    return f"[{start:.4g}, {stop:.4g}]"


def _space(values: Floats, count: Any, order: Any, knots: Any, closed: bool, name: str) -> SplineSpace:
    """The space along one parameter: over given knots, over [0, 1], or from the least to the greatest parameter."""
    distinct = np.unique(values)
    if isinstance(count, bool) or not isinstance(count, int | np.integer) or count > len(distinct):
        raise RsymError(
            f"{len(distinct)} different parameters {name} determine at most so many vertices, got {count!r}",
            code="vertices",
            remedy="take fewer vertices",
        )
    degree = checked_order(order, int(count), name) - 1
    if knots is not None and not isinstance(knots, str):
        return checked_space(order, knots, int(count), closed, name)
    inside = 0 <= distinct[0] and distinct[-1] <= 1
    if closed and not inside:
        raise RsymError(
            f"parameters of a closed direction lie in [0, 1], one period; those along {name} reach from "
            f"{distinct[0]:g} to {distinct[-1]:g}",
            code="closed",
            remedy="divide them by their period, or give knots of one period",
        )
    interval = (0.0, 1.0) if inside else (float(distinct[0]), float(distinct[-1]))
    followed = np.unique(np.mod(distinct, 1.0)) if closed else distinct
    return space_for(DataParameters(values, followed, interval), degree, int(count), knots, closed)


def _placed(values: Floats, space: SplineSpace, name: str) -> Floats:
    low, high = space.domain
    if space.closed:
        return wrapped(values, space.domain)
    if values.min() < low or values.max() > high:
        raise RsymError(
            f"the parameters along {name} reach from {values.min():g} to {values.max():g}, the knots from {low:g} to "
            f"{high:g}",
            code="knots",
            remedy="give knots that hold all parameters",
        )
    return values


def _numbers(given: Any, count: int, name: str) -> Floats:
    try:
        values = np.array(real_array(given))
    except (TypeError, ValueError) as error:
        raise RsymError(
            f"the parameters {name} must be numbers: {error}", code="parameters", remedy="one for each point"
        ) from error
    if values.shape != (count,):
        raise RsymError(
            f"the parameters {name} of scattered points must have the shape ({count},), got {values.shape}",
            code="parameters",
            remedy="one for each point",
        )
    if not np.isfinite(values).all():
        place = int(np.flatnonzero(~np.isfinite(values))[0])
        raise RsymError(
            f"the parameters {name} must be finite, that of the point {place} is {values[place]}",
            code="parameters",
            remedy="leave that point out",
        )
    if values.min() == values.max():
        raise RsymError(
            f"the parameters {name} are all alike, {values[0]:g}",
            code="parameters",
            remedy="a surface needs points at several parameters along u and along v",
        )
    return values


def _check_count(counts: tuple[Any, Any], available: int) -> None:
    if counts[0] * counts[1] > available:
        raise RsymError(
            f"{available} points determine at most {available} vertices, got {counts[0]} x {counts[1]}",
            code="vertices",
            remedy="take fewer vertices, or least_squares with smoothing=1e-6",
        )


def _in_plane(points: Floats) -> Pair:
    """The places of points in the plane nearest to them, along its length and its breadth, each from 0 to 1."""
    centred = points - points.mean(axis=0)
    _, lengths, axes = np.linalg.svd(centred, full_matrices=False)
    if not lengths[1] > LINE * lengths[0]:
        raise RsymError(
            "the points lie on a line: there is no plane nearest to them",
            code="parameters",
            remedy="give parameters=(u, v)",
        )
    found = []
    for axis in axes[:2]:
        along = centred @ (axis * np.sign(axis[np.argmax(np.abs(axis))]))  # the same way round, whatever LAPACK
        share = (along - along.min()) / (along.max() - along.min())
        found.append(np.clip(share, 0.0, 1.0))
    return found[0], found[1]
