"""Bicubic Coons patches: the test program of the source, and what the twists at the corners do."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from rsym.arrays import Floats
from rsym.output.comparison import compare_patches
from rsym.output.gallery import Gallery
from rsym.output.patches import plot_patches
from rsym.paper.drawing import Drawing, Table, triangles_in
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.coons_patches import CoonsPatch
from rsym.surfaces.coons.twists import estimate_twists
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v

CORNERS = ((0, 0), (0, 1), (1, 0), (1, 1))
ARROW, BARB = 0.2, 0.14  # of a tangent vector that is drawn, and of that its barbs
ELEVATION, AZIMUTH = 36.0, -30.0
FLAT = np.array([1.0, 1.0, 0.2])  # z is drawn at a fifth
KINDS = ("zero", "bilinear", "adini", "bessel")
NODES = 4  # along each side of the square that the twists are shown on
EQUATIONS = (
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
