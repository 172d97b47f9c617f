"""Knots for data, and the condition under which they determine a spline.

Schoenberg and Whitney (1953): there are parameters u_0 < u_1 < ... among the
data with t_j < u_j < t_(j+k), one in the support of every basis function.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.bsplines.spline_spaces import ROUNDING, SplineSpace, around, clamped
from rsym.surfaces.parameters import Interval


def averaged_space(mean: Floats, interval: Interval, degree: int, count: int, closed: bool) -> SplineSpace:
    """A space whose knots follow the data.

    As many vertices as data: t_(j+p) = (u_j + ... + u_(j+p-1))/p (de Boor 1978). Fewer: knots at equal shares of the
    data, so that every span holds some (Piegl and Tiller 1997, equations 9.68 and 9.69). Closed: knots at the data
    where the degree is odd, halfway between them where it is even.
    """
    if closed:
        return SplineSpace(degree, around(_shares(mean, interval, degree, count), degree), True)
    if count == len(mean):
        windows = np.lib.stride_tricks.sliding_window_view(mean[1:-1], degree) if count > degree + 1 else mean[:0]
        inner = windows.mean(axis=1) if len(windows) else mean[:0]
    else:
        step = len(mean) / (count - degree)
        places = step * np.arange(1, count - degree)
        whole = places.astype(int)
        inner = mean[whole - 1] + (places - whole) * (mean[whole] - mean[whole - 1])
    return SplineSpace(degree, clamped(np.concatenate([interval[:1], inner, interval[1:]]), degree))


def _shares(mean: Floats, interval: Interval, degree: int, count: int) -> Floats:
    """The knots of one period at equal shares of the data, half a datum earlier where the degree is even."""
    period = interval[1] - interval[0]
    turns = np.concatenate([mean[-1:] - period, mean, mean[:1] + period])
    places = np.arange(count + 1) * (len(mean) / count) + (1.0 if degree % 2 else 0.5)
    knots = np.interp(places, np.arange(len(turns)), turns)
    knots[-1] = knots[0] + period
    return np.asarray(knots)


def check_data(parameters: Floats, space: SplineSpace, name: str) -> None:
    """Refuse data that do not determine the spline, naming the first vertex without a datum of its own."""
    distinct = np.unique(parameters)
    low, high = space.domain
    start = 0
    for vertex in range(space.count):
        left, right = space.knots[vertex], space.knots[vertex + space.degree + 1]
        if space.closed:
            inside = _in_support(distinct, left, right, high - low)
            found = np.flatnonzero(inside)
        else:
            first, last = vertex == 0, vertex == space.count - 1
            inside = ((distinct > left) | (first & (distinct == low))) & (
                (distinct < right) | (last & (distinct == high))
            )
            found = np.flatnonzero(inside[start:])
        if not len(found):
            raise RsymError(
                f"the data do not determine the vertex {vertex} along {name}: no parameter left for it"
                f" between its knots {left:g} and {right:g} (Schoenberg-Whitney)",
                code="schoenberg-whitney",
                remedy='take knots="averaged", which follow the data, or fewer vertices',
            )
        start += int(found[0]) + 1


def are_settled(parameters: Floats, space: SplineSpace) -> bool:
    """Whether data that `check_data` lets pass determine the spline for certain, however crowded they are.

    Open: Schoenberg and Whitney. Closed: knots that follow the data one by one; proved for odd degrees, and
    for degrees 1 to 6 found regular in each of 6000 random sets of up to 60 data, crowded to 1e-9.
    """
    if not space.closed:
        return True
    if space.count != len(parameters):
        return False
    followed = averaged_space(np.sort(parameters), space.domain, space.degree, space.count, True).knots
    return np.allclose(followed, space.knots, rtol=0, atol=ROUNDING * (space.domain[1] - space.domain[0]))


def _in_support(values: Floats, left: float, right: float, period: float) -> NDArray[np.bool_]:
    """Whether a value or one of its repetitions lies strictly between left and right."""
    return np.asarray(left + np.mod(values - left, period) < right) & (np.mod(values - left, period) > 0)
