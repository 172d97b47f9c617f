"""Figures of surfaces through curves and data: a hull through sections, a network, B-splines with fewer vertices."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.gallery import Gallery
from rsym.output.patches import map_range, plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.networks.gordon import GordonSurface, HermiteSurface, SplineLoft
from rsym.surfaces.patch import Patch
from rsym.surfaces.transfinite import BooleanSum

COUNT = 24  # of data along each direction
NOISE = 0.002  # standard deviation of each coordinate
VERTICES = ((24, 24), (12, 12), (7, 7))
FITTED_ELEVATION, FITTED_AZIMUTH = 32.0, 35.0
SHOWN = ((24, 24), (7, 7))
Function = Callable[[Floats], Floats]
ALONG, ACROSS = (0.0, 0.45, 1.0, 1.4), (0.0, 0.5, 1.0, 1.55, 2.0)  # where the curves run, about
ELEVATION, AZIMUTH = 34.0, -62.0
EQUATION = (
    r"p\left(u, v\right) = \sum_{j} \psi_{j}\left(v\right) r_{j}\left(u\right) + \sum_{i} \varphi_{i}\left(u\right) "
    r"s_{i}\left(v\right) - \sum_{i, j} \varphi_{i}\left(u\right) \psi_{j}\left(v\right) p_{ij}"
)
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


def draw_fitting() -> Drawing:
    """The surface through all data and one with few vertices: data and net above, stripes below."""
    surfaces = {vertices: fitted(vertices) for vertices in VERTICES}
    gallery = Gallery(Figure(), 2, 2)
    (first, second), stripes = gallery.axes
    plot_patches(
        surfaces[SHOWN[0]], ax=first, lines=0, points=measured(), elevation=FITTED_ELEVATION, azimuth=FITTED_AZIMUTH
    )
    plot_patches(
        surfaces[SHOWN[1]],
        ax=second,
        lines=0,
        net=surfaces[SHOWN[1]].net,
        elevation=FITTED_ELEVATION,
        azimuth=FITTED_AZIMUTH,
    )
    for ax, vertices in zip(stripes, SHOWN, strict=True):
        plot_patches(
            surfaces[vertices], ax=ax, colour_by="zebra", lines=0, elevation=FITTED_ELEVATION, azimuth=FITTED_AZIMUTH
        )
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


def fitted(vertices: tuple[int, int]) -> BSplineSurface:
    """The bicubic surface with so many vertices: through the data, or nearest to them."""
    data = measured()
    return (
        BSplineSurface.interpolate(data) if vertices == data.shape[:2] else BSplineSurface.least_squares(data, vertices)
    )


def measured() -> Floats:
    """Points of the bonnet on a grid, with the errors of measuring; the same every time."""
    x, y = np.meshgrid(np.linspace(0.0, 1.3, COUNT), np.linspace(-0.75, 0.75, COUNT), indexing="ij")
    return bonnet(x, y) + np.random.default_rng(7).normal(scale=NOISE, size=(COUNT, COUNT, 3))


def bonnet(x: Floats, y: Floats) -> Floats:
    """A bonnet that falls to the front and the sides, with a dome over the engine; points (..., 3)."""
    height = (
        0.42 - 0.16 * x**2 - 0.09 * y**2 * (1 + 0.6 * x) + 0.05 * np.exp(-(((x - 0.4) / 0.35) ** 2) - (y / 0.3) ** 2)
    )
    return np.stack([x, y, height], axis=-1)
