"""Equations solved on shapes: a plate that loses heat in its holes, a hollow shaft, a drum like a gear."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from rsym.analysis.conditions import robin
from rsym.language.loading import loads
from rsym.model.primitives.plane import disc, rectangle
from rsym.model.shape import Shape
from rsym.output.fields import plot_field
from rsym.output.modes import plot_modes
from rsym.output.panels import colour_bar
from rsym.output.torsion import plot_torsion
from rsym.paper.drawing import Drawing, Table
from rsym.problems.solution import Solution
from rsym.problems.solving import solve
from rsym.problems.spectra import modes
from rsym.problems.torsion import torsion
from rsym.reports.numbers import short

# A radius of 0.45 in a plate of 6 by 4; what cools in them does it by Newton's law.
HOLES = tuple((2 * i, 1 if j else -1) for i in (-1, 0, 1) for j in (0, 1))
LOSS = 2
DEPTH = 0.24  # of the keyway
SHAFT = f"""
letter d = {DEPTH} "depth of the keyway"
bounds x [-1.1, 1.1] y [-1.1, 1.1]
omega = difference(disc(1), rectangle(0.44, 2*d, [0, 1]), disc(0.4))
"""
TEETH = 10
# r^10 cos(10 phi), written out.
GEAR = """
wave = x^10 - 45*x^8*y^2 + 210*x^6*y^4 - 210*x^4*y^6 + 45*x^2*y^8 - y^10
rim = (1 - x^2 - y^2)/2 + wave/(4*(1 + (x^2 + y^2)^10)) "rim"
"""
COUNT = 6
CELLS = {"plate": 32, "gear": 44}
TOLERANCE = 1e-4  # of the shaft: J in five digits
RESOLUTION = 300
EQUATIONS = (
    r"u = g + \omega\, \Phi, \quad \omega = 0 \text{ on the boundary}",
    r"-\Delta u = 0, \quad u = 1 \text{ on the edge}, \quad u_{n} + 2 u = 0 \text{ in the holes}",
    r"-\Delta u = 2, \quad J = 2 \int u\, dA + 2 \sum_{k} u_{k} A_{k}",
    r"-\Delta u = \lambda u",
)


def plate() -> Shape:
    """A plate with six holes; its parts are ``edge`` and ``holes``."""
    made = rectangle(6, 4).named("edge")
    for place in HOLES:
        made = made - disc(0.45).translate(*place).named("holes")
    return made


def shaft() -> Shape:
    """The section of a hollow shaft with a keyway, whose depth is the letter ``d``."""
    return loads(SHAFT)


def gear() -> Shape:
    """A disc with rounded teeth, (1 - r**2)/2 + r**n cos(n phi)/(4 (1 + r**(2 n))): one analytic function.

    Examples
    --------
    >>> gear().contains(1.05, 0), gear().contains(0, 1.05)
    (True, False)
    """
    return loads(GEAR)


def draw_solved() -> Drawing:
    """The plate and the shaft above, six modes of the drum below."""
    heat = solve(plate(), "-laplacian(u) = 0", {"edge": 1, "holes": robin(LOSS)}, cells=CELLS["plate"])
    twisted = torsion(shaft(), tolerance=TOLERANCE)
    drum = modes(gear(), COUNT, cells=CELLS["gear"])
    figure = Figure(figsize=(9.6, 9.6), layout="compressed")
    parts: Any = figure.subfigures(2, 1, height_ratios=(0.42, 0.58))
    above, below = parts
    left, right = above.subplots(1, 2, width_ratios=(1.35, 1))
    field: Any = plot_field(heat, ax=left, resolution=RESOLUTION, title="a plate that cools in its holes")
    stress = plot_torsion(
        twisted, ax=right, resolution=RESOLUTION, title=rf"a twisted shaft, $J = {float(twisted):.4f}$"
    )
    for ax, artist in ((left, field), (right, stress)):
        ax.title.set_fontsize(11)
        colour_bar(artist, ax)
    for axis in (right.xaxis, right.yaxis):
        axis.set_ticks([-1, -0.5, 0, 0.5, 1])
    plot_modes(drum, figure=below, resolution=200)
    rows = [
        ("plate", "lowest temperature", short(heat.minimum().value), _grid(heat)),
        ("plate", "integral of the normal derivative in the holes", short(heat.flux("holes")), _grid(heat)),
        ("shaft", "rigidity J", f"{twisted.rigidity:.5g}", _grid(twisted.solution)),
        *(
            ("drum", f"eigenvalue {number}", f"{value:.5g}", _grid(drum.modes[0]))
            for number, value in enumerate(drum.values, 1)
        ),
    ]
    remark = (
        "Every field is the weight, the equation of the shape, times splines of degree 4 on a grid that knows nothing "
        "of the boundary: values on the boundary are met exactly. The colours of the shaft are the shear stress, its "
        "lines the stress lines; the keyway's depth is a letter."
    )
    return Drawing(figure, f"d = {DEPTH:g}", 0, remark, Table(("shape", "quantity", "value", "unknowns"), tuple(rows)))


def _grid(solution: Solution) -> str:
    return str(solution.report.unknowns)
