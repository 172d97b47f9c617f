"""How large patches are, and the distances that count as none beside that."""

from __future__ import annotations

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.patch import LetterValues, Patch

# Coordinates far from the origin carry rounding of their own size.
ROUNDING = 1e-14
GRID = 9


def sample_grid(patch: Patch, letters: LetterValues = None) -> Floats:
    """Points (GRID, GRID, 3) of the whole patch."""
    with np.errstate(all="ignore"):
        points = patch.grid(*(np.linspace(*interval, GRID) for interval in patch.domain), letters=letters)
    if not np.isfinite(points).all():
        raise RsymError(f"{patch!r} is not finite everywhere", code="patch", remedy="leave its singular edge out")
    if not np.ptp(points.reshape(-1, 3), axis=0).any():
        raise RsymError(f"{patch!r} is a point, not a surface", code="patch", remedy="leave it out")
    return points


def extent(*grids: Floats) -> float:
    """The diagonal of the box round some points.

    Examples
    --------
    >>> extent(np.array([[0.0, 0.0, 0.0]]), np.array([[3.0, 4.0, 0.0]]))
    5.0
    """
    return float(np.linalg.norm(np.ptp(np.concatenate([grid.reshape(-1, 3) for grid in grids]), axis=0)))


def room_for(share: float, *grids: Floats) -> float:
    """The distance that counts as none: a share of the smallest of several patches, or rounding if that is more.

    Examples
    --------
    >>> room_for(1e-9, np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0]]), np.array([[1e8, 0.0, 0.0], [2e8, 0.0, 0.0]]))
    2e-06
    """
    return max(share * min(map(extent, grids)), ROUNDING * max(float(np.abs(grid).max()) for grid in grids))
