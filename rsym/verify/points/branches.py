"""Branches of a plane zero set at a point: their one-sided tangents, curvatures and slopes of curvature."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mpmath as mp
from mpmath import mpf

from rsym.verify.points.circles import CircleZeros
from rsym.verify.points.extrapolation import Limit, limit


@dataclass(frozen=True)
class Ends:
    """What the ends of branches are computed from: the field, the centre, and how well it is known."""

    field: Callable[[mpf, mpf], Any]
    centre: tuple[mpf, mpf]
    radius: mpf
    digits: int


@dataclass(frozen=True)
class Branch:
    """One branch at the centre: where it leads, and its limits, taken in the direction with the inside on the left.

    bearing is the angle in which it lies as seen from the centre, slope the limit of dkappa/ds.
    """

    leaving: bool
    bearing: mpf
    tangent: Limit
    curvature: Limit
    slope: Limit


@dataclass(frozen=True)
class _BranchPoint:
    """A branch on one circle."""

    radius: mpf
    bearing: mpf
    tangent: mpf
    curvature: mpf
    slope: mpf


def one_sided(circles: Sequence[CircleZeros], ends: Ends) -> list[Branch]:
    """The branches that cross all circles, in the order of their angles on the last.

    Examples
    --------
    >>> from rsym.verify.points.circles import zeros_on_circle
    >>> from rsym.verify.points.probing import Sample
    >>> def circle(x, y):
    ...     return Sample(2 * x - x * x - y * y, (2 - 2 * x, -2 * y), (mpf(-2), mpf(0), mpf(-2)))
    >>> def height(x, y):
    ...     return circle(x, y).value
    >>> centre = (mpf(0), mpf(0))
    >>> with mp.workdps(40):
    ...     circles = [zeros_on_circle(height, centre, mpf(2) ** -k, 30) for k in range(7, 16)]
    ...     branches = one_sided(circles, Ends(circle, centre, mpf(0), 30))
    >>> [(branch.leaving, mp.nstr(branch.curvature.value, 12)) for branch in branches]
    [(False, '1.0'), (True, '1.0')]
    """
    return [_branch(track, rising, circles, ends) for track, rising in _tracks(circles)]


def _tracks(circles: Sequence[CircleZeros]) -> list[tuple[list[mpf], bool]]:
    """Angles of each branch on all circles: the cyclic order of branches never changes, only where it starts."""
    tracks = [[angle] for angle, _ in circles[-1].crossings]
    rising = [up for _, up in circles[-1].crossings]
    count = len(tracks)
    for circle in reversed(circles[:-1]):
        shifts = [
            shift for shift in range(count) if all(circle.crossings[i - shift][1] == rising[i] for i in range(count))
        ]
        nearest = min(shifts, key=lambda shift: _distance([t[0] for t in tracks], circle, shift), default=0)
        for index, track in enumerate(tracks):
            track.insert(0, _near(circle.crossings[index - nearest][0], track[0]))
    return list(zip(tracks, rising, strict=True))


def _near(angle: mpf, other: mpf) -> mpf:
    """The angle, a multiple of a full turn away, that is nearest to the other."""
    return angle - 2 * mp.pi * mp.nint((angle - other) / (2 * mp.pi))


def _distance(angles: list[mpf], circle: CircleZeros, shift: int) -> mpf:
    return sum(abs(_near(circle.crossings[i - shift][0], angle) - angle) for i, angle in enumerate(angles))


def _branch(track: list[mpf], leaving: bool, circles: Sequence[CircleZeros], ends: Ends) -> Branch:
    """Extrapolate one branch; w rises through a leaving one in the sense of growing angles."""
    places = [_place(circle.radius, angle, leaving, ends) for circle, angle in zip(circles, track, strict=True)]
    noise = mpf(10) ** (-mpf("0.6") * ends.digits)
    sense = 1 if leaving else -1
    chord = limit(track, noise)
    offset = 0 if leaving else mp.pi
    by_chord = Limit(chord.value + offset, chord.error + 10 * ends.radius / circles[-1].radius, chord.exponent)
    by_gradient = _unwrapped([place.tangent for place in places], track[-1] + offset)
    tangent = _better(_limit(by_gradient, ends, places, noise), by_chord)
    # An arc of curvature kappa leaves the tangent by kappa r/2 at distance r.
    bends = [2 * sense * bend for bend in _differences(track, places)]
    curvatures = [place.curvature for place in places]
    curvature = _better(_limit(curvatures, ends, places, noise), limit(bends, mp.sqrt(noise)))
    slopes = [place.slope for place in places]
    differences = [sense * slope for slope in _differences(curvatures, places)]
    slope = _better(_limit(slopes, ends, places, noise), limit(differences, mp.sqrt(noise)))
    return Branch(leaving, chord.value, tangent, curvature, slope)


def _differences(values: Sequence[mpf], places: Sequence[_BranchPoint]) -> list[mpf]:
    """Difference quotients with respect to the radius."""
    return [
        (after - before) / (outer.radius - inner.radius) * -1
        for (before, after), (outer, inner) in zip(pairwise(values), pairwise(places), strict=True)
    ]


def _unwrapped(angles: Sequence[mpf], end: mpf) -> list[mpf]:
    """Angles without leaps by full turns, the last near `end`."""
    result = [end]
    for angle in reversed(angles):
        result.insert(0, _near(angle, result[0]) if mp.isfinite(angle) else mp.nan)
        if mp.isnan(result[0]):
            return [mp.nan] * len(angles)
    return result[:-1]


def _limit(values: Sequence[mpf], ends: Ends, places: Sequence[_BranchPoint], noise: mpf) -> Limit:
    """A limit whose error contains what a centre known only to within `ends.radius` does to it."""
    found = limit(values, noise)
    if not found.finite or ends.radius == 0:
        return found
    power = min(found.exponent, 1) if mp.isfinite(found.exponent) else 1
    drift = 2 * abs(values[-1] - found.value) * (ends.radius / places[-1].radius) ** power
    return Limit(found.value, found.error + drift, found.exponent)


def _better(first: Limit, second: Limit) -> Limit:
    """The first limit if it can be had, else the second; two that contradict each other have no small error."""
    if not first.finite:
        return first if mp.isinf(first.value) or not second.finite else second
    if not second.finite:
        return first
    distance = abs(first.value - second.value)
    best = first if first.error <= second.error else second
    doubt = distance if distance > 10 * (first.error + second.error) else 0
    return Limit(best.value, max(best.error, doubt), best.exponent)


def _place(radius: mpf, bearing: mpf, leaving: bool, ends: Ends) -> _BranchPoint:
    """Tangent, curvature and its slope where a branch meets a circle, NaN where the field has no derivatives."""
    sample = ends.field(ends.centre[0] + radius * mp.cos(bearing), ends.centre[1] + radius * mp.sin(bearing))
    (wx, wy), (wxx, wxy, wyy) = sample.gradient, sample.hessian
    size = mp.sqrt(wx * wx + wy * wy)
    if not mp.isfinite(size) or size == 0:
        return _BranchPoint(radius, bearing, mp.nan, mp.nan, mp.nan)
    numerator = wxx * wy**2 - 2 * wxy * wx * wy + wyy * wx**2
    curvature = -numerator / size**3
    slope = mp.nan
    if sample.third is not None:
        slope = _slope((wx, wy), (wxx, wxy, wyy), sample.third, numerator, size)
    return _BranchPoint(radius, bearing, mp.atan2(-wx, wy), curvature, slope)


def _slope(
    gradient: tuple[mpf, mpf], hessian: tuple[mpf, mpf, mpf], third: tuple[mpf, ...], numerator: mpf, size: mpf
) -> mpf:
    """The derivative of kappa = -N/|grad w|^3 along t = (w_y, -w_x)/|grad w|."""
    (wx, wy), (wxx, wxy, wyy) = gradient, hessian
    wxxx, wxxy, wxyy, wyyy = third
    tx, ty = wy / size, -wx / size
    dx, dy = wxx * tx + wxy * ty, wxy * tx + wyy * ty
    dxx, dxy, dyy = wxxx * tx + wxxy * ty, wxxy * tx + wxyy * ty, wxyy * tx + wyyy * ty
    change = dxx * wy**2 + 2 * wxx * wy * dy - 2 * (dxy * wx * wy + wxy * dx * wy + wxy * wx * dy)
    change += dyy * wx**2 + 2 * wyy * wx * dx
    return -change / size**3 + 3 * numerator * (wx * dx + wy * dy) / size**5
