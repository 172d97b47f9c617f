"""What the source claims or proposes beyond its figures, made as pictures with their tables.

The cost of drawing the valve: the box round the body is cut into sub-boxes, each is sampled and meshed on its own, and
only one of them is in memory at a time, as the source describes it. Normalising before and after revolving: the
gradient commutes with revolution, the Laplacian gains omega_rho/rho.
"""

from __future__ import annotations

import itertools
import math
import time
import tracemalloc
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator

from rsym.analysis.differential import gradient
from rsym.analysis.normalisation import normalise
from rsym.errors import RsymError
from rsym.model.constructions import revolve
from rsym.model.shape import Bounds, Shape
from rsym.output.fields import plot_field
from rsym.output.image_axes import plot_image
from rsym.output.layers import svg
from rsym.output.rendering import render
from rsym.output.sections import layers_of, plot_sections
from rsym.output.surfaces import plot_mesh
from rsym.paper import preference
from rsym.paper.drawing import Drawing, Table, figure_of, letters_text, mesh_quietly
from rsym.paper.models import car, skeleton_body, valve
from rsym.sampling.mesh import Mesh
from rsym.sampling.sections import sections

LAPLACIAN_LEVELS = (-4.0, 2.0)  # what the Laplacians of a profile one unit thick span outside singular spots
LAPLACIAN_BOX = ((-7.0, 7.5), (-3.0, 3.0))
LAPLACIAN_RESOLUTION = 400
# Along each axis: 0.125, 1, 3.375 and 15.625 million points; the source has 27 and 125 boxes of 50 points cubed.
COMBINATIONS = ((50, (1, 3)), (100, (1, 3, 5)), (150, (1, 3, 5)), (250, (1, 5)))  # the sub-boxes for each
HEIGHTS = tuple(0.25 + 0.5 * k for k in range(-6, 16))  # z = -2.75, -2.25, ..., 7.75
LAYERS = "car-sections.svg"
APART = {"h5": 5.1, "ho2": 5.1}  # the lower edges of the windows, out of the plane of the boot's lid
# The headlights of the whole car cut the bonnet at a grazing angle: more samples, most along z, keep their rims clean.
FINE = (140, 280, 245)
RENDERED = (760, 540)  # pixels of each of three pictures
MILLIMETRES = 10.0  # of the layers, for one unit of the model: a car 14.6 cm wide
REVOLUTION_EQUATIONS = (
    r"\left|\nabla f\left(x,\, \rho\right)\right|^{2} = f_{x}^{2} + f_{\rho}^{2}",
    r"\Delta f\left(x,\, \rho\right) = f_{xx} + f_{\rho\rho} + \frac{f_{\rho}}{\rho}",
    r"\rho = \sqrt{y^{2} + z^{2}}",
)


def draw_cost() -> Drawing:
    """Table 1: seconds and megabytes against points, for each number of sub-boxes."""
    costs = measure()
    figure = Figure(figsize=(8.4, 3.4), layout="constrained")
    for ax, quantity, label in zip(
        figure.subplots(1, 2), ("seconds", "megabytes"), ("seconds", "peak memory in MB"), strict=True
    ):
        for boxes, marker in zip(sorted({one.boxes for one in costs}), cycle("os^"), strict=False):
            line = [(one.points, getattr(one, quantity)) for one in costs if one.boxes == boxes]
            name = "one box" if boxes == 1 else f"{boxes} sub-boxes"
            ax.loglog(*zip(*line, strict=True), marker=marker, markersize=4, linewidth=1.2, label=name)
        ax.set(xlabel="million points", ylabel=label)
        ax.xaxis.set_major_formatter(FuncFormatter(lambda points, _: f"{points / 1e6:g}"))
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        ax.grid(color="0.9", linewidth=0.6)
    ax.legend(fontsize=8, frameon=False)
    rows = tuple(
        (f"{one.points / 1e6:g}", str(one.boxes), f"{one.seconds:.2f}", f"{one.megabytes:.1f}", spaced(one.triangles))
        for one in costs
    )
    table = Table(("million points", "sub-boxes", "seconds", "peak memory, MB", "triangles"), rows)
    remark = (
        "The values of the source are lost; these are ours, measured in this run, which may draw a figure beside. "
        "Each sub-box is sampled and meshed on its own, one after the other, its points in parallel. Memory is the "
        "peak of what Python and NumPy allocate, as tracemalloc counts it, the triangles of all boxes included."
    )
    return Drawing(figure, letters_text(valve().letters), max(one.triangles for one in costs), remark, table)


@dataclass(frozen=True)
class Cost:
    """What drawing took with so many points and sub-boxes."""

    points: int
    boxes: int
    seconds: float
    megabytes: float
    triangles: int


def measure() -> tuple[Cost, ...]:
    """Each once: first for the seconds, then again for the memory, since watching memory takes time.

    Then boxes that hold no surface are left out: they take less than those that do.

    The memory is the peak of what Python and NumPy hold, the triangles of all boxes included, as tracemalloc
    counts it; what the interpreter and compiled code take for themselves is not in it.
    """
    shape = valve()
    meshes(shape, 20, 1)  # compiles
    return tuple(_cost(shape, points, count) for points, boxes in COMBINATIONS for count in boxes)


def _cost(shape: Shape, points: int, boxes: int) -> Cost:
    start = time.perf_counter()
    pieces = meshes(shape, points, boxes)
    seconds = time.perf_counter() - start
    triangles, held = sum(piece.status.triangles for piece in pieces.values()), list(pieces)
    del pieces
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    meshes(shape, points, boxes, held)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return Cost(points**3, boxes**3, seconds, (peak - before) / 1e6, triangles)


def meshes(shape: Shape, points: int, boxes: int, only: Iterable[Bounds] = ()) -> dict[Bounds, Mesh]:
    """The surface in each box that holds some, `points` and `boxes` along each axis; `only` in these, if any are given.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> len(meshes(ball, 30, 1)), len(meshes(ball, 30, 3))
    (1, 21)
    """
    assert shape.bounds is not None
    # The mesher adds a layer of points on either side, so that neighbouring boxes overlap instead of leaving gaps.
    cells = max(2, math.ceil(points / boxes) - 2)
    pieces = {}
    for box in only or _sub_boxes(shape.bounds, boxes):
        try:
            # All points of a box are sampled, as in the source.
            pieces[box] = mesh_quietly(shape, (cells,) * len(box), method="smooth", bounds=box)
        except RsymError as error:
            if error.code != "no-surface":
                raise
    return pieces


def _sub_boxes(bounds: Bounds, boxes: int) -> list[Bounds]:
    cuts = [np.linspace(low, high, boxes + 1).tolist() for low, high in bounds]
    return list(itertools.product(*(list(itertools.pairwise(cut)) for cut in cuts)))


def draw_preference() -> Drawing:
    """Omega against omega_n as a distance, with the spreads of gradient, value and error."""
    spreads, bands = preference.measure()
    rows = tuple(
        (one.body, one.function, one.quantity, *(f"{value:.3g}".replace("-", "−") for value in one.quantiles))
        for one in spreads
    )
    table = Table(
        ("body", "function", "quantity", "least", "first quartile", "median", "third quartile", "greatest"), rows
    )
    counts = " and ".join(spaced(len(band.distance)) for band in bands)
    remark = (
        f"The band is what lies between {preference.NEAREST:g} and {preference.BAND:g} from the boundary: {counts} "
        "random points, their distances taken from fine level lines and from a fine mesh. On the boundary |∇ωₙ| is "
        "1 wherever ∇ω exists, and ωₙ stays between −1 and 1; |∇ω| and ω vary freely. Away from the boundary ωₙ "
        "bends towards ±1, so it is no distance there either. Extremes in the band lie beside creases and corners."
    )
    letters = f"{letters_text(skeleton_body().letters)}; car: {letters_text(car().letters)}"
    return Drawing(preference.draw(), letters, 0, remark, table)


def draw_sections() -> Drawing:
    """The stack of sections, and the same as layers for a mill."""
    shape = car()
    stack = sections(shape, HEIGHTS, resolution=700)
    figure = figure_of(plot_sections(stack, elevation=26.0, azimuth=42.0))
    kept = sum(section.lines.status.kept for section in stack)
    vertices = sum(section.lines.status.vertices for section in stack)
    remark = (
        f"{len(stack)} sections from z = {HEIGHTS[0]:g} to {HEIGHTS[-1]:g}, straight from the equation, without a "
        f"triangulation; {kept} of {vertices} vertices, at corners, "
        f"keep the place of linear interpolation. Layers in true scale, 1 unit = {MILLIMETRES:g} mm"
    )
    layers = svg(layers_of(stack), "mm", MILLIMETRES).encode()
    return Drawing(figure, letters_text(shape.letters), 0, remark, files={LAYERS: layers})


def draw_parts() -> Drawing:
    """The car coloured by the parts of its model, with their areas."""
    shape = car().with_letters(APART)
    body = mesh_quietly(shape, FINE)
    figure = figure_of(plot_mesh(body, azimuth=48.0, colour_by="part"))
    a, b, c = body.vertices[body.faces].transpose(1, 0, 2)
    triangles = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    names = body.labels.each
    areas = {name: float(triangles[names == name].sum()) for name in body.parts if name in names}
    rows = tuple((name, f"{area:.1f}") for name, area in sorted(areas.items(), key=lambda item: -item[1]))
    remark = (
        "Each triangle knows the formula that it comes from, and edges are where two formulas meet. The windows "
        f"begin at z = 5.1: at 5, as printed, they share the plane of the boot, which then has two names; {body.status}"
    )
    table = Table(("part", "area"), rows)
    return Drawing(figure, letters_text(shape.letters), body.status.triangles, remark, table)


def draw_rendered() -> Drawing:
    """The car by rays cast at its equation: from the front and the left, cut in its middle, in a room with stripes."""
    shape = car()
    figure = Figure(figsize=(12.0, 3.4), layout="compressed")
    views: tuple[tuple[str, str, dict[str, Any]], ...] = (
        ("the parts, with shadows", "front-left", {"colour_by": "part", "shadows": True}),
        ("the half behind $x = 0$", "front-right", {"section": {"x": 0.0}}),
        ("the reflection of level stripes", "front-right", {"colour_by": "zebra"}),
    )
    told = []
    for ax, (title, camera, asked) in zip(figure.subplots(1, 3), views, strict=True):
        image = render(shape, camera=camera, size=RENDERED, **asked)
        plot_image(image, ax=ax)
        ax.set_title(title, fontsize=10)
        told.append(int(np.count_nonzero(image.undecided)))
    remark = (
        "No mesh and no samples: each ray meets the first zero of the sign form along it, found by enclosures, and "
        f"each normal is that of the leaf there; {sum(told)} of {len(told) * RENDERED[0] * RENDERED[1]} rays undecided"
    )
    return Drawing(figure, letters_text(shape.letters), 0, remark)


def draw_revolution() -> Drawing:
    """The Laplacian of omega_n in the plane and of the body of revolution."""
    remark = (
        "The gradient commutes with revolution, so normalise(revolve(ω)) and revolve(normalise(ω)) are one function; "
        "the Laplacian of the revolved function has one term more, f_ρ/ρ, which is large about the axis."
    )
    return Drawing(drawn_laplacians(), letters_text(skeleton_body().letters), 0, remark)


def drawn_laplacians() -> Figure:
    """Three panels on the meridian plane: the Laplacian of the plane field, of the revolved one, and their difference.

    The field is omega_n of Fig. 11. Normalising the revolved body gives the same function as revolving the
    normalised profile, so one revolved panel stands for both orders.
    """
    profile = skeleton_body()
    body = revolve(profile)
    plane = normalise(profile)
    levels = MaxNLocator(14).tick_values(*LAPLACIAN_LEVELS)
    figure = Figure(figsize=(9.0, 6.6), layout="compressed")
    axes = figure.subplots(3, 1, sharex=True)
    artists = [
        plot_field(
            profile,
            "normalised_laplacian",
            ax=axes[0],
            levels=levels,
            bounds=LAPLACIAN_BOX,
            resolution=LAPLACIAN_RESOLUTION,
        ),
        plot_field(
            body,
            "normalised_laplacian",
            ax=axes[1],
            levels=levels,
            bounds=(*LAPLACIAN_BOX, LAPLACIAN_BOX[1]),
            resolution=LAPLACIAN_RESOLUTION,
            section={"z": 0.0},
        ),
        plot_field(gain(plane), ax=axes[2], levels=levels, bounds=LAPLACIAN_BOX, resolution=LAPLACIAN_RESOLUTION),
    ]
    titles = (
        r"$\Delta\omega_n$ in the plane",
        r"$\Delta\omega_n$ of the body of revolution, on its meridian plane $z = 0$",
        r"their difference, $\frac{1}{\rho}\,\frac{\partial\omega_n}{\partial\rho}$",
    )
    for ax, artist, title in zip(axes, artists, titles, strict=True):
        ax.set_title(title, fontsize=11)
        ax.label_outer()
        figure.colorbar(artist, ax=ax, pad=0.02, fraction=0.04).ax.tick_params(labelsize=7)
    return figure


def gain(shape: Shape) -> Shape:
    """What revolving about x adds to the Laplacian of a plane field f: f_y/y, as a field in the plane.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> gain(rsym.Shape(1 - x**2 - y**2, (x, y))).expression
    -2
    """
    across = shape.coordinates[1]
    return shape.replace(expression=gradient(shape)[1] / across)


def spaced(number: int) -> str:
    """A count with its thousands apart.

    Examples
    --------
    >>> spaced(1234567)
    '1 234 567'
    """
    return f"{number:,}".replace(",", " ")
