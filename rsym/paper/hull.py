"""A ship's hull through sections: what the functions across them do to its fairness."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.gallery import Gallery
from rsym.output.patches import map_range, plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.networks.gordon import HermiteSurface, SplineLoft
from rsym.surfaces.patch import Patch

LENGTH = 40.0
STATIONS = (0.0, 0.08, 0.2, 0.35, 0.5, 0.65, 0.78, 0.89)  # from the transom, shares of the length; the stem follows
POINTS = 15  # of a section
KNOTS = (*STATIONS, 1.0)
LOFTS = {"Hermite": HermiteSurface, "natural spline": SplineLoft}
VIEWS = {"from the bow": (20.0, 38.0), "from the quarter, from below": (-16.0, 128.0)}


def station(share: float) -> Floats:
    """One half of a section, from keel to sheer, as points (n, 3): round in the middle, a V with flare towards the bow.

    Examples
    --------
    >>> station(0.4)[[0, -1]].round(3).tolist()
    [[16.0, 0.0, 0.0], [16.0, 4.4, 5.0]]
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


def sections(side: int = 1) -> list[Floats]:
    """All sections of one side of the ship, from the transom to the stem; the other side runs down, not up.

    Both sides then have their normals outside.
    """
    return [(np.array([1.0, side, 1.0]) * one)[::side] for one in (*map(station, STATIONS), stem())]


def hull(kind: str) -> list[Patch]:
    """Both sides of the ship."""
    return [LOFTS[kind](sections(side), KNOTS) for side in (1, -1)]


def draw_hull() -> Drawing:
    """The hull through its sections from two sides, then the Gaussian curvature of a C1 and of a C2 surface."""
    hulls = {kind: hull(kind) for kind in LOFTS}
    gallery = Gallery(Figure(), 2, 2, width=10.0)
    for ax, (elevation, azimuth) in zip(gallery.axes[0], VIEWS.values(), strict=True):
        given = [*sections(1), *sections(-1)]
        spline = hulls["natural spline"]
        plot_patches(spline, ax=ax, lines=0, curves=given, elevation=elevation, azimuth=azimuth)
    limits = map_range(list(hulls.values()), "gaussian_curvature", None, None)
    elevation, azimuth = VIEWS["from the bow"]
    for ax, patches in zip(gallery.axes[1], hulls.values(), strict=True):
        plot_patches(
            patches,
            ax=ax,
            colour_by="gaussian_curvature",
            limits=limits,
            lines=0,
            elevation=elevation,
            azimuth=azimuth,
        )
    gallery.arrange([list(VIEWS), [f"{kind} functions" for kind in LOFTS]])
    rows = tuple((kind, *(f"{value:.1e}" for value in _fairness(patches[0]))) for kind, patches in hulls.items())
    remark = (
        f"{len(KNOTS)} sections of {POINTS} points each, each a spline over its chord length. Across them "
        "the composite Hermite functions of Golovanov (3.7.1) are C1: the curvature jumps at the sections. Cardinal "
        "functions of natural cubic splines are C2."
    )
    table = Table(("functions across", "distance from the points", "greatest jump of the mean curvature"), rows)
    return Drawing(gallery.figure, "", triangles_in(gallery.figure), remark, table)


def _fairness(side: Patch) -> tuple[float, float]:
    """How far the surface is from the points of its sections, and by how much H jumps at those inside."""
    away = 0.0
    for knot, points in zip(KNOTS, sections(), strict=True):
        shares = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        away = max(away, float(np.abs(side(shares / shares[-1], knot) - points).max()))
    inside, near = np.linspace(0.05, 0.95, 37)[:, None], 1e-9
    knots = np.array(KNOTS[1:-1])
    jump = side.mean_curvature(inside, knots + near) - side.mean_curvature(inside, knots - near)
    return away, float(np.abs(jump).max())
