"""Two patches joined in three ways, with the report on their common edge."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.gallery import Gallery
from rsym.output.joins import plot_continuity
from rsym.output.patches import plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.joints.joining import join
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.patch import Patch
from rsym.surfaces.symbols import u, v

K = 1.7  # how much faster the second patch leaves the edge than the first one comes to it
ELEVATION, AZIMUTH = 34.0, -62.0


def corner_information(surface: ParametricSurface, low: float, high: float) -> Floats:
    """The matrix (6, 6, 3) of derivatives to the second at the corners of [low, high] x [0, 1].

    Examples
    --------
    >>> plane = ParametricSurface((u, v, 0), ((0, 2), (0, 1)))
    >>> corner_information(plane, 1.0, 2.0)[:4, 0, 0].tolist()
    [1.0, 2.0, 1.0, 1.0]
    """
    orders = [(i, j) for i in range(3) for j in range(3)]
    found = surface.derivatives(np.array([low, high])[:, None], np.array([0.0, 1.0]), orders)
    size = high - low
    rows = [np.concatenate([size**i * found[3 * i + j] for j in range(3)], axis=1) for i in range(3)]
    return np.concatenate(rows)


def pair(kind: str) -> list[Patch]:
    """A patch and what follows it across its edge u = 1: merely meeting it, joined G1, or joined G2.

    Examples
    --------
    >>> [continuity_report(pair(kind)).continuity for kind in ("meeting", "joined G1", "joined G2")]
    ['G0', 'G1', 'G2']
    """
    first = ParametricSurface((u, v, (u - 1) ** 2 / 3 - v * (1 - v) / 2 + u * v**2 / 4), ((0, 1), (0, 1)))
    second = ParametricSurface((u, v, u * v**2 / 4 - v * (1 - v) / 2 + (u - 1) * (2 - u) / 3), ((1, 2), (0, 1)))
    p, q = (BicubicCoons(corner_information(one, k, k + 1.0)) for k, one in enumerate((first, second)))
    if kind == "meeting":
        return [p, q]
    return [p, join(p, "u1", q, "u0", K, continuity=kind.removeprefix("joined "))]


def draw_joints() -> Drawing:
    """The edge in the colour of its class above, stripes below."""
    kinds = ("meeting", "joined G1", "joined G2")
    pairs = {kind: pair(kind) for kind in kinds}
    reports = {kind: continuity_report(patches, prove=True) for kind, patches in pairs.items()}
    gallery = Gallery(Figure(), 2, len(kinds))
    for above, below, kind in zip(*gallery.axes, kinds, strict=True):
        plot_continuity(pairs[kind], reports[kind], ax=above, lines=8, elevation=ELEVATION, azimuth=AZIMUTH)
        plot_patches(pairs[kind], ax=below, colour_by="zebra", lines=0, elevation=ELEVATION, azimuth=AZIMUTH)
    gallery.arrange([kinds])
    rows = []
    for kind in kinds:
        (edge,) = reports[kind].edges
        measured = (edge.gap, edge.angle, edge.curvature_jump)
        proof = f"{edge.proved}, {'no more' if edge.verdict == 'REFUTED' else edge.verdict.lower()}"
        rows.append((kind, edge.continuity, *(f"{one.value:.2g}" for one in measured), proof))
    last = reports[kinds[-1]].edges[0].proof
    assert last is not None
    rounded = f"{last.levels[2].most:.1e}"
    remark = (
        f"Two biquintic patches along u = 1, joined with k = {K:g}: the second leaves the edge {K:g} times as fast as "
        "the first comes to it, so neither joint is C1. Stripes break at a kink, are kinked by a jump of the "
        "curvature, and pass smoothly where it is continuous. Amounts are measured at samples. What is "
        "proved holds all along the edge: of the last pair points and tangent planes agree exactly, curvatures within "
        f"{rounded}, as the numbers of its second patch are rounded."
    )
    columns = ("patches", "class", "gap", "greatest angle, degrees", "greatest jump of the curvature", "proved")
    table = Table(columns, tuple(rows))
    return Drawing(gallery.figure, "", triangles_in(gallery.figure), remark, table)
