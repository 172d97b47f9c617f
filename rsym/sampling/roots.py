"""Many roots at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rsym.arrays import Floats, Ints

# With a thousand cells along the box the ends of a lattice edge are themselves rounded to about this share of it.
NEAR_ENOUGH = 1e-13
# Bisection alone needs 43 steps for that.
MOST_STEPS = 60


def bracketed_roots(function: Callable[[Floats, Ints], Floats], low: Floats, high: Floats) -> Floats:
    """Roots t in [0, 1] of functions with values `low` at 0 and `high` at 1 of different sign.

    Chandrupatla's method (1997): inverse quadratic interpolation where it is safe,
    bisection elsewhere. ``function(t, which)`` evaluates the functions numbered `which`.

    Examples
    --------
    >>> import numpy as np
    >>> targets = np.array([0.25, 0.49])
    >>> bracketed_roots(lambda t, which: t * t - targets[which], -targets, 1 - targets).round(12).tolist()
    [0.5, 0.7]
    """
    result = np.where(np.abs(low) < np.abs(high), 0.0, 1.0)
    active = np.arange(len(low))
    a, b, c = np.ones(len(low)), np.zeros(len(low)), np.ones(len(low))
    fa, fb, fc = high.copy(), low.copy(), high.copy()
    t = np.full(len(low), 0.5)
    for _ in range(MOST_STEPS):
        x = a + t * (b - a)
        fx = function(x, active)
        same = np.sign(fx) == np.sign(fa)
        c, fc = np.where(same, a, b), np.where(same, fa, fb)
        b, fb = np.where(same, b, a), np.where(same, fb, fa)
        a, fa = x, fx
        nearer = np.abs(fa) < np.abs(fb)
        best = np.where(nearer, a, b)
        result[active] = best
        tolerance = NEAR_ENOUGH / np.abs(b - a)
        going = (tolerance < 0.5) & (np.where(nearer, fa, fb) != 0) & np.isfinite(fx)
        if not going.any():
            break
        if not going.all():
            a, b, c, fa, fb, fc, active, tolerance = (v[going] for v in (a, b, c, fa, fb, fc, active, tolerance))
        t = np.clip(_interpolated(a, b, c, fa, fb, fc), tolerance, 1 - tolerance)
    return result


def _interpolated(a: Floats, b: Floats, c: Floats, fa: Floats, fb: Floats, fc: Floats) -> Floats:
    """The next relative position: inverse quadratic where Chandrupatla's criterion holds, else the middle."""
    with np.errstate(all="ignore"):
        xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
        quadratic = fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        use = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi) & np.isfinite(quadratic)
    return np.where(use, quadratic, 0.5)


def repeated(step: Callable[[Floats, Ints], Floats], points: Floats, steps: int) -> Floats:
    """Points (n, k) after so many steps of Newton's method; one that stays, or is nowhere, does so for good.

    ``step(points, which)`` moves the points numbered `which`.

    Examples
    --------
    >>> squares = np.array([[4.0], [9.0], [-1.0]])
    >>> with np.errstate(all="ignore"):
    ...     repeated(lambda x, which: (x + squares[which] / x) / 2, np.array([[1.0], [3.0], [np.nan]]), 8).T
    array([[ 2.,  3., nan]])
    """
    points, moving = points.copy(), np.arange(len(points))
    for _ in range(steps):
        before = points[moving]
        with np.errstate(all="ignore"):
            points[moving] = after = step(before, moving)
        moving = moving[((after != before) & (after == after)).any(axis=1)]
        if not len(moving):
            break
    return points
