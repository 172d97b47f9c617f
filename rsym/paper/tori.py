"""The torus from exact patches: shape parameters leave it alone and form everything else."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.gallery import Gallery
from rsym.output.patches import map_range, plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.exact import torus

R, TUBE = 3.0, 1.0
PIECES, SPAN = 3, 2 * math.pi / 3  # around either circle
BLENDS = {
    "bicubic": HermiteBlend.cubic(),
    "class II, μ = −12": HermiteBlend.class2(-12, SPAN),
    "class II, μ = 3": HermiteBlend.class2(3, SPAN),
}
SWELLING = 1.7  # of the tangents along the meridians, for a tube that is no circle
ELEVATION, AZIMUTH = 38.0, -60.0
EQUATIONS = (
    r"F_{1} = 3 t^{2} - 2 t^{3} + \mu\, t^{2} \left(1 - t\right)^{2} \left(2 t - 1\right), \quad F_{0} = 1 - F_{1}",
    r"G_{0} = \frac{\sin\alpha t - \sin\alpha\, F_{1}}{\alpha} - \cos\alpha\, G_{1}, \quad "
    r"G_{1} = \frac{F_{0} + \cos\alpha\, F_{1} - \cos\alpha t}{\alpha \sin\alpha}",
)


def ring(blend: HermiteBlend, swelling: float = 1.0) -> list[BicubicCoons]:
    """Nine patches with the corner information of a torus, the tangents along the meridians swollen.

    Examples
    --------
    >>> patch = ring(BLENDS["class II, μ = 3"])[0]
    >>> abs(distance(patch)) < 1e-14, abs(distance(ring(BLENDS["bicubic"])[0])) > 0.1
    (True, True)
    """
    along = np.array([1.0, 1.0, swelling, swelling])[:, None]
    return [BicubicCoons(matrix * along, blend, blend) for matrix in corner_information()]


@cache
def corner_information() -> tuple[Floats, ...]:
    """The matrices (4, 4, 3) of the pieces of the torus."""
    return tuple(piece.matrix for piece in torus(R, TUBE, pieces=(PIECES, PIECES)))


def distance(patch: BicubicCoons) -> float:
    """The greatest distance of a patch from the torus."""
    x, y, z = np.moveaxis(patch.grid(np.linspace(0, 1, 41), np.linspace(0, 1, 41)), -1, 0)
    return float(np.abs(np.hypot(np.hypot(x, y) - R, z) - TUBE).max())


def draw_torus() -> Drawing:
    """The data of a torus with three blends, and the same data with longer tangents."""
    rings = [{name: ring(blend, swelling) for name, blend in BLENDS.items()} for swelling in (1.0, SWELLING)]
    gallery = Gallery(Figure(), 2, len(BLENDS))
    for row, surfaces in zip(gallery.axes, rings, strict=True):
        limits = map_range(list(surfaces.values()), "gaussian_curvature", None, None)
        for ax, patches in zip(row, surfaces.values(), strict=True):
            plot_patches(
                patches,
                ax=ax,
                colour_by="gaussian_curvature",
                limits=limits,
                lines=0,
                elevation=ELEVATION,
                azimuth=AZIMUTH,
            )
    gallery.arrange([list(BLENDS)])
    # The pieces of one meridian stand for all: the others are turned about the axis.
    rows = tuple((name, *(f"{max(map(distance, one[name][:PIECES])):.1e}" for one in rings)) for name in BLENDS)
    remark = (
        f"Nine patches with the corner information of a torus, R = {R:g}, r = {TUBE:g}, a third of a turn each way. "
        "Above: with blends of class II they are the torus itself, whatever μ; bicubic ones are not. Below: the same "
        f"with tangents along the meridians {SWELLING:g} times as long, where μ is a handle on the shape."
    )
    table = Table(("blend", "distance from the torus", "with longer tangents"), rows)
    return Drawing(gallery.figure, "", triangles_in(gallery.figure), remark, table)
