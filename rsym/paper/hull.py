"""A ship's hull through ten sections: what the functions across them do to its fairness."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from rsym.surfaces.lofts import HermiteSurface, LagrangeSurface, SplineLoft

Floats = NDArray[np.float64]

LENGTH = 40.0
STATIONS = (0.0, 0.08, 0.2, 0.35, 0.5, 0.65, 0.78, 0.89)  # from the transom, shares of the length; the stem follows
POINTS = 15  # of a section
LOFTS = {"Lagrange": LagrangeSurface, "Hermite": HermiteSurface, "spline": SplineLoft}


def station(share: float) -> Floats:
    """One half of a section, from keel to sheer, as points (n, 3): round in the middle, a V with flare towards the bow.

    Examples
    --------
    >>> station(0.35)[[0, -1]].round(3).tolist()
    [[14.0, 0.0, 0.002], [14.0, 4.4, 5.008]]
    """
    forward, aft = np.clip((share - 0.45) / 0.55, 0, 1), np.clip((0.4 - share) / 0.4, 0, 1)
    beam = 4.4 * (1 - forward**2.6) * (1 - 0.28 * aft**2.2)
    keel, sheer = 2.6 * aft**2.4, 5.0 + 1.9 * forward**2 + 0.5 * aft**2
    fullness = 3.4 - 2.35 * forward**0.9 - aft**1.2
    angle = np.linspace(0, np.pi / 2, POINTS)
    across, up = np.sin(angle) ** (2 / fullness), 1 - np.cos(angle) ** (2 / fullness)
    return np.stack([np.full(POINTS, LENGTH * share), beam * across, keel + (sheer - keel) * up], axis=-1)


def stem() -> Floats:
    """The raked stem, in the plane of symmetry."""
    t = np.linspace(0, 1, POINTS)
    return np.stack([38.2 + 5.2 * t**1.7, 0 * t, 0.15 + 6.75 * t**0.9], axis=-1)


def sections(side: float = 1.0) -> list[Floats]:
    """All sections of one side of the ship, from the transom to the stem."""
    return [np.array([1.0, side, 1.0]) * one for one in (*map(station, STATIONS), stem())]
