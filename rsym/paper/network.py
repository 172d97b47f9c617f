"""Gordon's surface through a network of curves, and the three surfaces that it is made of."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.gallery import Gallery
from rsym.output.patches import plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.networks.gordon import GordonSurface
from rsym.surfaces.patch import Patch
from rsym.surfaces.transfinite import BooleanSum

Function = Callable[[Floats], Floats]

ALONG, ACROSS = (0.0, 0.45, 1.0, 1.4), (0.0, 0.5, 1.0, 1.55, 2.0)  # where the curves run, about
ELEVATION, AZIMUTH = 34.0, -62.0
EQUATION = (
    r"p\left(u, v\right) = \sum_{j} \psi_{j}\left(v\right) r_{j}\left(u\right) + \sum_{i} \varphi_{i}\left(u\right) "
    r"s_{i}\left(v\right) - \sum_{i, j} \varphi_{i}\left(u\right) \psi_{j}\left(v\right) p_{ij}"
)


def height(x: Floats, y: Floats) -> Floats:
    """The surface on which the curves are drawn."""
    return 0.45 * np.exp(-2.2 * ((x - 0.95) ** 2 + (y - 0.7) ** 2)) + 0.22 * np.sin(1.9 * x) - 0.12 * y**2


def along(y: float) -> Function:
    """A curve in the direction of x, which wanders a little."""

    def curve(t: Floats) -> Floats:
        x = 2.3 * t - 0.15
        across = y + 0.1 * np.sin(np.pi * t) * np.sin(3 * t + 4 * y)
        return np.stack([x, across, height(x, across)], axis=-1)

    return curve


def across(x: float) -> Function:
    """A curve in the direction of y, at a pace of its own."""

    def curve(t: Floats) -> Floats:
        share = t + 0.2 * x * t * (1 - t)
        y = 1.75 * share - 0.175
        aside = x + 0.09 * np.sin(np.pi * share) * np.cos(5 * x + y)
        return np.stack([aside, y, height(aside, y)], axis=-1)

    return curve


def parts(surface: GordonSurface) -> dict[str, Patch]:
    """The Boolean sum and its terms: the lofts of both families, and the tensor product of their common points."""
    over_u, over_v = surface.lofts
    f, g = surface.basis
    assert f is not None
    assert g is not None
    return {
        "through the u-curves": BooleanSum(along_v=over_v),
        "through the v-curves": BooleanSum(along_u=over_u),
        "through their points": BooleanSum(corners=surface.corners, basis=(f, g)),
        "first + second − third: Gordon's surface": surface,
    }


def misses(surface: GordonSurface, part: Patch) -> tuple[float, float]:
    """The greatest distances of a part from the curves of both families at equal parameters."""
    net = surface.network
    u, v = (np.linspace(*interval, 101) for interval in surface.domain)
    rows = part.grid(u, net.v_knots) - net.u_curves(u)
    columns = part.grid(net.u_knots, v) - np.swapaxes(net.v_curves(v), 0, 1)
    return float(np.linalg.norm(rows, axis=-1).max()), float(np.linalg.norm(columns, axis=-1).max())


def draw_network() -> Drawing:
    """The network on each of the three terms, and on their sum."""
    surface = GordonSurface([along(y) for y in ALONG], [across(x) for x in ACROSS])
    net, named = surface.network, parts(surface)
    u, v = (np.linspace(*interval, 161) for interval in surface.domain)
    curves = [*np.swapaxes(net.u_curves(u), 0, 1), *np.swapaxes(net.v_curves(v), 0, 1)]
    gallery = Gallery(Figure(), 2, 2)
    axes = [ax for row in gallery.axes for ax in row]
    for ax, patch in zip(axes, named.values(), strict=True):
        plot_patches(patch, ax=ax, lines=16, curves=curves, elevation=ELEVATION, azimuth=AZIMUTH)
    titles = list(named)
    gallery.arrange([titles[:2], titles[2:]])
    x, y, z = np.moveaxis(surface.grid(u, v), -1, 0)
    rows = tuple((title, *(f"{one:.1g}" for one in misses(surface, patch))) for title, patch in named.items())
    remark = (
        f"{len(ALONG)} curves along u and {len(ACROSS)} along v, drawn on one surface at paces of their own; where "
        "they meet is found, and those that do not fit are run through at another pace. The sum of both lofts counts "
        "twice what they agree on, the tensor product of the points. Between the curves Gordon's surface is at most "
        f"{np.abs(z - height(x, y)).max():.2g} from that on which they were drawn, measured in z."
    )
    table = Table(("surface", "distance from the u-curves", "from the v-curves"), rows)
    return Drawing(gallery.figure, "", triangles_in(gallery.figure), remark, table)
