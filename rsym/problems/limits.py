"""Derivatives on a boundary where a formula has none, by their limits from inside.

Where parts of a shape are flush their leaves vanish together, and the root of an R-operation has no derivative though
what it stands in may have one: along an edge that two parts share, or at a corner where another leaf is 0 too.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rsym.arrays import Flags, Floats

NEAR, FAR = 1e-9, 1e-5  # of the size of a shape: from where a limit is told, and what is small against
VANISHING = 1e-2  # the share of what is far that is 0 in the limit; linearly it is 1e-4
ALIKE = 1e-5  # how well those of all directions agree where there is a limit
WAYS = 24
SEED = 5


def with_limits(
    field: Callable[[Floats], Floats], points: Floats, inside: Callable[[Floats], Flags], size: float
) -> Floats:
    """Fields (kinds, n) at points (n, dimension), in place of NaN the limit from inside if all directions have one.

    Examples
    --------
    >>> def field(points):  # of a slope that is 0/0 at y = 0, and of one that depends on the direction
    ...     x, y = points.T
    ...     return np.stack([(3 + x) * y / y, x / np.hypot(x, y)])
    >>> with np.errstate(invalid="ignore"):
    ...     with_limits(field, np.zeros((1, 2)), lambda points: points[:, 1] >= 0, 1.0).round(6).tolist()
    [[3.0], [nan]]
    """
    found = field(points)
    bad = np.flatnonzero(~np.isfinite(found).all(axis=0))
    if not len(bad):
        return found
    ways = np.random.default_rng(SEED).standard_normal((WAYS, points.shape[1]))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    near, far = (_around(field, points[bad], ways * size * distance, inside) for distance in (NEAR, FAR))
    with np.errstate(all="ignore"):
        least, most = (np.fmin.reduce(near, axis=2), np.fmax.reduce(near, axis=2))
        top, wide = np.fmax(np.abs(least), np.abs(most)), np.fmax.reduce(np.abs(far), axis=2)
        limit = np.where(
            top <= VANISHING * wide, 0.0, np.where(most - least <= ALIKE * top, (least + most) / 2, np.nan)
        )
    found[:, bad] = np.where(np.isfinite(found[:, bad]), found[:, bad], limit)
    return found


def _around(
    field: Callable[[Floats], Floats], points: Floats, steps: Floats, inside: Callable[[Floats], Flags]
) -> Floats:
    """Fields (kinds, n, steps) beside points, NaN outside."""
    places = (points[:, None] + steps).reshape(-1, points.shape[1])
    values = np.where(inside(places), field(places), np.nan)
    return values.reshape(len(values), len(points), len(steps))
