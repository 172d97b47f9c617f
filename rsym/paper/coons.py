"""Figures of Coons patches: the test program of the source, twists at the corners, exact tori, two patches joined."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.gallery import Gallery
from rsym.output.joins import plot_continuity
from rsym.output.patches import compare_patches, map_range, plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.coons_patches import CoonsPatch
from rsym.surfaces.coons.exact import torus
from rsym.surfaces.coons.twists import estimate_twists
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.joints.joining import join
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.patch import Patch
from rsym.surfaces.symbols import t, u, v

K = 1.7  # how much faster the second patch leaves the edge than the first one comes to it
JOINT_ELEVATION, JOINT_AZIMUTH = 34.0, -62.0
R, TUBE = 3.0, 1.0
PIECES, SPAN = 3, 2 * math.pi / 3  # around either circle
BLENDS = {
    "bicubic": HermiteBlend.cubic(),
    "class II, μ = −12": HermiteBlend.class2(-12, SPAN),
    "class II, μ = 3": HermiteBlend.class2(3, SPAN),
}
SWELLING = 1.7  # of the tangents along the meridians, for a tube that is no circle
TORUS_ELEVATION, TORUS_AZIMUTH = 38.0, -60.0
TORUS_EQUATIONS = (
    r"F_{1} = 3 t^{2} - 2 t^{3} + \mu\, t^{2} \left(1 - t\right)^{2} \left(2 t - 1\right), \quad F_{0} = 1 - F_{1}",
    r"G_{0} = \frac{\sin\alpha t - \sin\alpha\, F_{1}}{\alpha} - \cos\alpha\, G_{1}, \quad "
    r"G_{1} = \frac{F_{0} + \cos\alpha\, F_{1} - \cos\alpha t}{\alpha \sin\alpha}",
)
CORNERS = ((0, 0), (0, 1), (1, 0), (1, 1))
ARROW, BARB = 0.2, 0.14  # of a tangent vector that is drawn, and of that its barbs
ELEVATION, AZIMUTH = 36.0, -30.0
FLAT = np.array([1.0, 1.0, 0.2])  # z is drawn at a fifth
KINDS = ("zero", "bilinear", "adini", "bessel")
NODES = 4  # along each side of the square that the twists are shown on
PARABOLOID_EQUATIONS = (
    r"r\left(u, v\right) = a\left(u\right)^{T} Q\, a\left(v\right)",
    r"a\left(t\right) = \left(1 - 3 t^{2} + 2 t^{3},\; 3 t^{2} - 2 t^{3},\; "
    r"t - 2 t^{2} + t^{3},\; t^{3} - t^{2}\right)^{T}",
)


def test1() -> BicubicCoons:
    """The paraboloid z = x**2 + y**2 over [-5, 5]**2 as the source's program `test1` gives it.

    Examples
    --------
    >>> test1()(0.25, 0.9).round(12).tolist()
    [-2.5, 4.0, 22.25]
    """
    matrix = np.zeros((4, 4, 3))
    for i, x in enumerate((-5.0, 5.0)):
        for j, y in enumerate((-5.0, 5.0)):
            matrix[i, j] = x, y, x**2 + y**2
            matrix[2 + i, j] = 10.0, 0.0, 20.0 * x
            matrix[i, 2 + j] = 0.0, 10.0, 20.0 * y
    return BicubicCoons(matrix)


def four_corners() -> CoonsPatch:
    """What the corners of `test1` alone give, as MATLAB's interp2 does: the plane z = 50."""
    x, y = -5 + 10 * t, -5 + 10 * t
    return CoonsPatch((-5, y, 50), (5, y, 50), (x, -5, 50), (x, 5, 50))


def draw_paraboloid() -> Drawing:
    """The patch with the information at its corners, beside the plane."""
    patch, plane = test1(), four_corners()
    shown = BicubicCoons(patch.matrix * FLAT)
    flat = CoonsPatch(
        *((x, y, 10) for x, y in ((-5, -5 + 10 * t), (5, -5 + 10 * t), (-5 + 10 * t, -5), (-5 + 10 * t, 5)))
    )
    gallery = Gallery(Figure(), 1, 2)
    first, second = gallery.axes[0]
    corners = shown.matrix[:2, :2]
    plot_patches(
        shown, ax=first, lines=10, curves=_tangents(shown.matrix), points=corners, elevation=ELEVATION, azimuth=AZIMUTH
    )
    edges = [shown(*place) for end in (0, 1) for place in ((end, np.linspace(0, 1, 65)), (np.linspace(0, 1, 65), end))]
    plot_patches(flat, ax=second, lines=10, curves=edges, points=corners, elevation=ELEVATION, azimuth=AZIMUTH)
    for i, j in CORNERS:
        for ends, name in (((2 + i, j), "u"), ((i, 2 + j), "v")):
            tip = shown.matrix[i, j] + ARROW * shown.matrix[ends]
            first.text(*tip, f"$\\;\\;r_{name}$", fontsize=10, va="center", zorder=9)
    gallery.arrange([["corners, tangents, zero twists", "corners alone"]])
    x, y, z = np.moveaxis(patch.grid(np.linspace(0, 1, 101), np.linspace(0, 1, 51)), -1, 0)
    heights = np.moveaxis(plane.grid(np.linspace(0, 1, 101), np.linspace(0, 1, 51)), -1, 0)[2]
    errors = np.abs(z - x**2 - y**2).max(), np.abs(heights - x**2 - y**2).max()
    rows = tuple((name, f"{error:.2g}") for name, error in zip(("bicubic patch", "four corners"), errors, strict=True))
    remark = (
        "z = x² + y² over [−5, 5]², drawn at a fifth of its height. The source's test1 asks for 101 × 51 points; its "
        "patch is the paraboloid itself, whose twists are 0, and the plane z = 50 is what its interp2 makes of the "
        "same corners. Arrows are a fifth of the derivatives."
    )
    table = Table(("from", "greatest error in z"), rows)
    return Drawing(gallery.figure, "", triangles_in(gallery.figure), remark, table)


def _tangents(matrix: Floats) -> list[Floats]:
    """An arrow for each tangent at a corner, as a polyline whose barbs lie in the plane of both tangents."""
    found = []
    for i, j in CORNERS:
        for place, beside in (((2 + i, j), (i, 2 + j)), ((i, 2 + j), (2 + i, j))):
            start, way, side = matrix[i, j], ARROW * matrix[place], ARROW * matrix[beside]
            barbs = [start + (1 - BARB) * way + sign * 0.35 * BARB * side for sign in (-1, 1)]
            found.append(np.array([start, start + way, barbs[0], start + way, barbs[1]]))
    return found


def ridge() -> ParametricSurface:
    """A ridge along the diagonal of [0, 3]**2, z = 9/(6 + (u - v)**2): developable, so K = 0.

    Examples
    --------
    >>> ridge()(2, [2, 0])[:, 2].tolist(), abs(float(ridge().gaussian_curvature(1, 2))) < 1e-15
    ([1.5, 0.9], True)
    """
    return ParametricSurface((u, v, 9 / (6 + (u - v) ** 2)), ((0, 3), (0, 3)))


@cache
def quilt(kind: str) -> list[BicubicCoons]:
    """Bicubic patches between nodes of the ridge, with its points and tangents; the twists of some kind, or true."""
    knots = np.linspace(0.0, 3.0, NODES)
    places = knots[:, None], knots[None, :]
    points, along_u, along_v, true = ridge().derivatives(*places, ((0, 0), (1, 0), (0, 1), (1, 1)))
    twists = true
    if kind != "true":
        twists = estimate_twists(points, kind, u=knots, v=knots, u_tangents=along_u, v_tangents=along_v)
    found = []
    for i in range(NODES - 1):
        for j in range(NODES - 1):
            cell = slice(i, i + 2), slice(j, j + 2)
            pairs = (points, along_v), (along_u, twists)
            rows = [np.concatenate([left[cell], right[cell]], axis=1) for left, right in pairs]
            found.append(BicubicCoons(np.concatenate(rows)))
    return found


def draw_twists() -> Drawing:
    """Nine patches with the same points and tangents: what zero twists do, and what estimates of them do."""
    shown = {"zero twists (Ferguson)": "zero", "Adini's twists": "adini", "true twists": "true"}
    surfaces: Mapping[str, list[BicubicCoons]] = {title: quilt(kind) for title, kind in shown.items()}
    maps = ("gaussian_curvature", "zebra")
    figure = compare_patches(surfaces, colour_by=maps, elevation=48.0, azimuth=-60.0, figure=Figure())
    rows = tuple((kind, *(f"{one:.2g}" for one in _errors(quilt(kind)))) for kind in (*KINDS, "true"))
    remark = (
        "Nine bicubic patches with the points and tangents of the ridge z = 9/(6 + (u − v)²), which is developable; "
        "only p_uv at the nodes differs. Zero twists flatten every node, and what lies between two of them is "
        "neither ridge nor plane."
    )
    table = Table(("twists", "greatest distance in z", "greatest angle of normals, degrees"), rows)
    return Drawing(figure, "", triangles_in(figure), remark, table)


def _errors(patches: list[BicubicCoons]) -> tuple[float, float]:
    """How far patches are from the ridge over the same place, and how far their normals turn from its own."""
    inside = np.linspace(0.0, 1.0, 33)
    away, angle = 0.0, 0.0
    for patch in patches:
        x, y, z = np.moveaxis(patch.grid(inside, inside), -1, 0)
        surface = ridge()
        away = max(away, float(np.abs(surface(x, y)[..., 2] - z).max()))
        across = np.cross(patch.normal(inside[:, None], inside), surface.normal(x, y))
        angle = max(angle, float(np.degrees(np.arcsin(np.linalg.norm(across, axis=-1).max()))))
    return away, angle


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
                elevation=TORUS_ELEVATION,
                azimuth=TORUS_AZIMUTH,
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


def ring(blend: HermiteBlend, swelling: float = 1.0) -> list[BicubicCoons]:
    """Nine patches with the corner information of a torus, the tangents along the meridians swollen.

    Examples
    --------
    >>> patch = ring(BLENDS["class II, μ = 3"])[0]
    >>> abs(distance(patch)) < 1e-14, abs(distance(ring(BLENDS["bicubic"])[0])) > 0.1
    (True, True)
    """
    along = np.array([1.0, 1.0, swelling, swelling])[:, None]
    return [BicubicCoons(matrix * along, blend, blend) for matrix in torus_corners()]


@cache
def torus_corners() -> tuple[Floats, ...]:
    """The matrices (4, 4, 3) of the pieces of the torus."""
    return tuple(piece.matrix for piece in torus(R, TUBE, pieces=(PIECES, PIECES)))


def distance(patch: BicubicCoons) -> float:
    """The greatest distance of a patch from the torus."""
    x, y, z = np.moveaxis(patch.grid(np.linspace(0, 1, 41), np.linspace(0, 1, 41)), -1, 0)
    return float(np.abs(np.hypot(np.hypot(x, y) - R, z) - TUBE).max())


def draw_joints() -> Drawing:
    """The edge in the colour of its class above, stripes below."""
    kinds = ("meeting", "joined G1", "joined G2")
    pairs = {kind: pair(kind) for kind in kinds}
    reports = {kind: continuity_report(patches, prove=True) for kind, patches in pairs.items()}
    gallery = Gallery(Figure(), 2, len(kinds))
    for above, below, kind in zip(*gallery.axes, kinds, strict=True):
        plot_continuity(pairs[kind], reports[kind], ax=above, lines=8, elevation=JOINT_ELEVATION, azimuth=JOINT_AZIMUTH)
        plot_patches(
            pairs[kind], ax=below, colour_by="zebra", lines=0, elevation=JOINT_ELEVATION, azimuth=JOINT_AZIMUTH
        )
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
