"""Explorations of what was solved on a shape: sliders of its letters, and its picture, found anew where they stand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rsym.errors import RsymError
from rsym.model.requirements import require_kind
from rsym.output.deformations import plot_deformation
from rsym.output.explorer import LetterSliders, button, move_section, resolution_choice, row_of, section_choice
from rsym.output.field_data import Field, solved_first
from rsym.output.fields import plot_field
from rsym.output.modes import plot_modes
from rsym.output.panels import colour_bar
from rsym.output.torsion import plot_torsion
from rsym.output.views import DPI
from rsym.problems.elastic.result import ElasticSolution
from rsym.problems.solution import Solution
from rsym.problems.spectra import Spectrum
from rsym.problems.torsion import Torsion
from rsym.sampling.lattice import checked_cells
from rsym.sampling.plane import GIVEN_FIELDS
from rsym.sampling.windows import bounds_or_extent

WIDTH, ROOM, TALLEST = 7.0, 0.6, 1.0  # inches of a picture, and about a panel; its height over its width


class SolutionExplorer(LetterSliders):
    """Sliders of letters and the picture of a solution, of modes, of a twisted shaft or of an elastic body.

    ``.found`` is what was found for the letters as they stand. ``.field`` is the choice of what is drawn of a solution,
    ``.section`` that of the plane in space, and while ``.steady`` is ticked the colours stay what they are.

    Examples
    --------
    >>> import rsym, sympy
    >>> r = sympy.Symbol("r")
    >>> u = rsym.solve(rsym.disc(r, letters={r: 1}), "-laplacian(u) = 1", 0, cells=8)
    >>> widget = SolutionExplorer(u, resolution=24)
    >>> widget.letters["r"].value = 2
    >>> round(float(widget.found(0, 0)), 9), widget.message.value
    (1.0, '')
    """

    def __init__(
        self, solution: Field, fields: Sequence[str] = GIVEN_FIELDS, *, bounds: Any = None, resolution: int
    ) -> None:
        first = solved_first(solution)
        shape = first.shape
        if not shape.letters:
            raise RsymError(
                "the shape and the problem have no letters to move",
                code="letters",
                remedy="plot_field(solution) draws it; letters={...} of the shape, or of solve, are what can be moved",
            )
        super().__init__(shape.letters)
        self.found, self._at, self._bounds = solution, self.values, bounds
        self._limits: tuple[float, float] | None = None
        alone = isinstance(solution, Solution)
        names = [(name.replace("_", " "), name) for name in checked_names(fields)]
        self.field = ipywidgets.Dropdown(options=names, description="field", layout={"width": "16em"})
        self.resolution = resolution_choice(checked_cells(resolution))
        self.section: tuple[Any, ...] = ()
        if shape.dimension == 3:
            box = dict(zip(map(str, shape.coordinates), bounds_or_extent(shape, bounds), strict=True))
            self.section = section_choice(box)
            self.section[0].observe(lambda _: move_section(self, self.section, box), "value")
        self.steady = ipywidgets.Checkbox(False, description="keep the colours", indent=False)
        self.reset = button("reset", "all letters back to their defaults")
        self.reset.on_click(lambda _: self.attempt(self.reset_letters))
        chosen = (self.field,) if alone else ()
        changing = (*chosen, self.resolution, *self.section)
        rows = ((*changing, self.steady, self.reset), (self.message,), (self.picture,))
        self.add_rows(row_of(row, first=False) for row in rows)
        for widget in (*self.letters.values(), *chosen, self.resolution, *self.section[1:]):
            widget.observe(self.redraw, "value")
        self.redraw()

    def draw(self) -> Figure:
        """The picture at the letters as the sliders stand; nothing is compiled for other letters."""
        if self.values != self._at:
            self.found = self.found.with_letters(self.values)
            self._at = self.values
        figure = Figure(layout="compressed", dpi=DPI)
        options: Any = {"resolution": self.resolution.value, "bounds": self._bounds}
        if self.steady.value:
            options["limits"] = self._limits
        if self.section:
            options["section"] = {self.section[0].value: self.section[1].value}
        if isinstance(self.found, Spectrum):
            plot_modes(self.found, figure=figure, **options)
        else:
            artist = self._draw_one(figure.add_subplot(), options)
            self._limits = float(artist.levels[0]), float(artist.levels[-1])
            colour_bar(artist, artist.axes)
        ax = figure.axes[0]
        (left, right), (low, high) = ax.get_xlim(), ax.get_ylim()
        spec = ax.get_subplotspec()
        assert spec is not None
        rows, columns = spec.get_gridspec().get_geometry()
        wide = WIDTH / columns
        figure.set_size_inches(WIDTH, rows * min(wide * (high - low) / (right - left) + ROOM, TALLEST * wide))
        return figure

    def _draw_one(self, ax: Axes, options: Any) -> Any:
        found = self.found
        if isinstance(found, Torsion):
            return plot_torsion(found, ax=ax, **options)
        if isinstance(found, ElasticSolution):
            return plot_deformation(found, ax=ax, **options)
        return plot_field(require_kind(Solution, found, "solution"), self.field.value, ax=ax, **options)


def checked_names(fields: Sequence[str]) -> Sequence[str]:
    """Fields of a solution, some or all."""
    if isinstance(fields, str) or not fields or not set(fields) <= set(GIVEN_FIELDS):
        raise RsymError(
            f"fields of a solution are {', '.join(GIVEN_FIELDS)}, got {fields!r}",
            code="unknown-field",
            remedy='fields=("value",), or leave them out',
        )
    return fields
