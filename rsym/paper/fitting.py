"""A B-spline surface with fewer vertices than data: smoother, and as near to what was measured as that deserves."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.gallery import Gallery
from rsym.output.patches import plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface

COUNT = 24  # of data along each direction
NOISE = 0.002  # standard deviation of each coordinate
VERTICES = ((24, 24), (12, 12), (7, 7))
ELEVATION, AZIMUTH = 32.0, 35.0
SHOWN = ((24, 24), (7, 7))


def bonnet(x: Floats, y: Floats) -> Floats:
    """A bonnet that falls to the front and the sides, with a dome over the engine; points (..., 3)."""
    height = (
        0.42 - 0.16 * x**2 - 0.09 * y**2 * (1 + 0.6 * x) + 0.05 * np.exp(-(((x - 0.4) / 0.35) ** 2) - (y / 0.3) ** 2)
    )
    return np.stack([x, y, height], axis=-1)


def measured() -> Floats:
    """Points of the bonnet on a grid, with the errors of measuring; the same every time."""
    x, y = np.meshgrid(np.linspace(0.0, 1.3, COUNT), np.linspace(-0.75, 0.75, COUNT), indexing="ij")
    return bonnet(x, y) + np.random.default_rng(7).normal(scale=NOISE, size=(COUNT, COUNT, 3))


def fitted(vertices: tuple[int, int]) -> BSplineSurface:
    """The bicubic surface with so many vertices: through the data, or nearest to them."""
    data = measured()
    return (
        BSplineSurface.interpolate(data) if vertices == data.shape[:2] else BSplineSurface.least_squares(data, vertices)
    )


def draw_fitting() -> Drawing:
    """The surface through all data and one with few vertices: data and net above, stripes below."""
    surfaces = {vertices: fitted(vertices) for vertices in VERTICES}
    gallery = Gallery(Figure(), 2, 2)
    (first, second), stripes = gallery.axes
    plot_patches(surfaces[SHOWN[0]], ax=first, lines=0, points=measured(), elevation=ELEVATION, azimuth=AZIMUTH)
    plot_patches(
        surfaces[SHOWN[1]], ax=second, lines=0, net=surfaces[SHOWN[1]].net, elevation=ELEVATION, azimuth=AZIMUTH
    )
    for ax, vertices in zip(stripes, SHOWN, strict=True):
        plot_patches(surfaces[vertices], ax=ax, colour_by="zebra", lines=0, elevation=ELEVATION, azimuth=AZIMUTH)
    through, near = (f"{n} × {m} vertices" for n, m in SHOWN)
    gallery.arrange([[f"through {COUNT} × {COUNT} points: {through}", f"nearest to them: {near}"]])
    rows = []
    for (n, m), surface in surfaces.items():
        x, y, z = np.moveaxis(surface.grid(*(np.linspace(*interval, 101) for interval in surface.domain)), -1, 0)
        away = z - bonnet(x, y)[..., 2]
        rows.append((f"{n} × {m}", f"{surface.residual.rms:.1e}", f"{np.sqrt((away**2).mean()):.1e}"))
    remark = (
        f"Data: a surface with errors of standard deviation {NOISE:g} in each coordinate. Bicubic, chord-length "
        "parameters, averaged knots; least squares by orthogonal reflections. Through the data the surface repeats "
        "their errors, which a picture hardly shows and the stripes do."
    )
    return Drawing(
        gallery.figure,
        "",
        triangles_in(gallery.figure),
        remark,
        Table(("vertices", "rms from the data", "rms from the truth"), tuple(rows)),
    )
