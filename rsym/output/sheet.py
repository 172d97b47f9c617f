"""The sheet: several fields in one figure, compiled once and drawn as often as letters change."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.figure import Figure, SubFigure
from numpy.typing import NDArray

from rsym.backends.kernel import compile
from rsym.model.shape import Shape
from rsym.output.looks import PLAIN, Look
from rsym.output.panels import TITLES, colour_bar, draw_levels, dress
from rsym.program.fields import checked_fields
from rsym.sampling.contours import LevelLines, trace
from rsym.sampling.plane import PlaneSampler, checked_scalar, plane_sampler
from rsym.sampling.progress import Progress, tell


@dataclass(frozen=True)
class SheetSamples:
    """What a sheet shows: values of fields on the lattice of a sampler, by name, omega and the boundary omega = 0."""

    sampler: PlaneSampler
    fields: Mapping[str, NDArray[Any]]
    omega: NDArray[Any]
    boundary: LevelLines


@dataclass(frozen=True)
class SheetSampler:
    """Several fields as one program, so that what they share is computed once; letters never compile.

    Examples
    --------
    >>> import rsym
    >>> sampler = sheet_sampler(rsym.paper.skeleton_body(), ("value", "laplacian"), resolution=16)
    >>> sampler.at({"a2": 6}).fields["laplacian"].shape
    (18, 10)
    """

    omega: PlaneSampler
    fields: PlaneSampler

    def at(self, letters: Mapping[Any, float] | None, section: Mapping[Any, float] | None = None) -> SheetSamples:
        """Sample at some letters, and in another section along the same coordinates."""
        omega = self.omega.at(letters, section)
        fields = self.fields.at(letters, section).samples()
        values = fields["value"] if "value" in fields else omega.values()
        return SheetSamples(omega, fields, values, trace(omega, 0.0, values=values))


def sheet_sampler(
    shape: Shape,
    fields: Sequence[str],
    *,
    resolution: int | Sequence[int],
    bounds: Any = None,
    section: Mapping[Any, float] | None = None,
    force: bool | None = None,
) -> SheetSampler:
    """Prepare several scalar fields for one sheet."""
    names = tuple(checked_scalar(field) for field in checked_fields(fields))
    omega = plane_sampler(
        shape, "value", resolution=resolution, bounds=bounds, section=section, held=len(names), force=force
    )
    return SheetSampler(omega, replace(omega, kernel=compile(shape, names)))


class Sheet:
    r"""Panels in a figure, filled row by row, in two columns if the bounds are wide and three if they are tall.

    Examples
    --------
    >>> import rsym
    >>> samples = sheet_sampler(rsym.paper.skeleton_body(), ("normalised",), resolution=16).at({"a2": 6})
    >>> sheet = Sheet(Figure(), samples)
    >>> sheet.draw(samples)
    >>> print(sheet.figure.axes[0].get_title())
    $\omega_n$
    """

    def __init__(
        self,
        figure: Figure | SubFigure,
        samples: SheetSamples,
        look: Look = PLAIN,
        titles: Mapping[str, str] = TITLES,
        *,
        sized: bool = True,
    ) -> None:
        self.figure = figure
        self._look, self._titles = look, titles
        rows, columns, size = _arrangement(samples.sampler, len(samples.fields))
        if sized and isinstance(figure, Figure):
            figure.set_size_inches(*size)
        axes = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
        for ax in axes.flat[len(samples.fields) :]:
            ax.set_axis_off()
        self._axes = list(axes.flat[: len(samples.fields)])
        self._bars: list[Colorbar] = []

    def draw(self, samples: SheetSamples, progress: Progress | None = None) -> None:
        """Draw, in the place of what was drawn before."""
        total = len(self._axes)
        inside = samples.omega > 0
        looks = [self._look.of(field) for field in samples.fields]
        levels = [
            look.levels_of(values, field, inside)
            for look, (field, values) in zip(looks, samples.fields.items(), strict=True)
        ]
        places: list[Axes | None] = [bar.ax for bar in self._bars] or [None] * total
        self._bars = []
        for number, (field, values) in enumerate(samples.fields.items()):
            tell(progress, field, number, total)
            ax = self._axes[number]
            for old in (*ax.collections, *ax.patches):
                old.remove()
            drawn = levels[number], samples.boundary, looks[number], samples.omega
            artist = draw_levels(ax, samples.sampler, values, *drawn)
            dress(ax, samples.sampler, self._titles[field])
            self._bars.append(colour_bar(artist, ax, place=places[number]))
            ax.label_outer()
        tell(progress, "done", total, total)


def _arrangement(sampler: PlaneSampler, count: int) -> tuple[int, int, tuple[float, float]]:
    """Rows, columns and inches of panels, each with a colour bar."""
    width, height = (sampler.lattice.spacing[k] * sampler.lattice.counts[k] for k in (0, 1))
    columns = min(2 if height <= 1.2 * width else 3, count)
    rows = -(-count // columns)
    panel = min(8.4 / columns, 5.0 * width / height)
    return rows, columns, (columns * (panel + 0.9), rows * (max(panel * height / width, 1.6) + 0.45))
