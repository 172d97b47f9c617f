"""Pictures of fields: filled level lines, the boundary emphasised; several in a sheet, compiled once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colorbar import Colorbar
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure, SubFigure
from matplotlib.image import AxesImage
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.kernel import compile
from rsym.errors import RsymError, warn
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.output.boundaries import draw_parts
from rsym.output.looks import PLAIN, Look
from rsym.output.panels import TITLES, colour_bar, draw_levels, dress
from rsym.output.pictures import page, require_axes, whole
from rsym.output.sign_pictures import draw_signs
from rsym.program.fields import SIX, checked_fields
from rsym.sampling.blanks import missing_boundary, undefined_picture
from rsym.sampling.contours import LevelLines
from rsym.sampling.level_lines import trace
from rsym.sampling.plane import GIVEN, GivenField, PlaneSampler, checked_scalar, plane_sampler, plane_section
from rsym.sampling.progress import Progress, tell
from rsym.sampling.undefined import undefined_in

# The Laplacian of what is harmonic is the error of its second derivatives: drawn where it is asked for.
GIVEN_SHEET = ("value", "gradient_squared")
GIVEN_TITLES = {"value": "$u$", "gradient_squared": r"$|\nabla u|^2$", "laplacian": r"$\Delta u$"}


def plot_field(
    shape: Shape | GivenField,
    field: str = "value",
    *,
    ax: Axes | None = None,
    levels: Sequence[float] | None = None,
    limits: tuple[float, float] | None = None,
    title: str | None = None,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    colour_map: str | None = None,
    outside: str | None = None,
    force: bool = False,
) -> QuadContourSet | AxesImage:
    r"""Filled level lines of one field, the boundary omega = 0 as a heavy line.

    Levels are round and spaced over a robust range, so that a singular spot does not
    flatten the picture; what lies beyond has the colour of the end. A field of both
    signs has levels and colours of its own on each side of 0. Where the
    field is undefined the ground is hatched.

    Parameters
    ----------
    shape : Shape, Solution or Torsion
        A shape in the plane, or one in space with ``section={z: 1.0}``; or what `solve` found on one: then the outside
        is white, and named parts of the boundary have colours and a legend where there are several.
    field : str
        A scalar field of `compile`, of a solution "value", "gradient_squared" or "laplacian"; or "sign", the inside in
        one colour: at each place only what matters there is evaluated, and of a shape of thousands of operations that
        is little.
    ax : matplotlib axes, optional
        Where to draw; without it a new figure with a colour bar is made.
    levels : sequence of float, optional
        Two or more increasing levels.
    limits : pair of numbers, optional
        The ends of the colours instead; round levels lie between, and what is beyond has the colour of the end.
    title : str, optional
        Instead of the symbol of the field.
    colour_map : str, optional
        A name that matplotlib knows; without it ``RdBu_r`` for levels on both sides of 0, which is its middle,
        otherwise ``viridis``.
    outside : {"mask", "dim"}, optional
        What is outside is white, or pale; what is inside alone chooses the levels, but of omega and its normalised
        forms each side its own where the outside is only pale.
    force : bool
        Whether to go on where the estimate says that there is not memory enough.

    Returns
    -------
    matplotlib.contour.QuadContourSet
        The filled contours, fit for a colour bar; of a sign a matplotlib.image.AxesImage, whose array (ny, nx) is 1
        inside and on the boundary, -1 elsewhere.

    Raises
    ------
    RsymError
        For a shape in space without a section, an unknown field, colour map or word for the outside, levels or limits
        that do not increase, a field that is nowhere defined, more samples than there is memory for.

    Warns
    -----
    RsymWarning
        Where there is no boundary in the bounds, for a section outside the bounds of the shape, where omega has no
        value in some of the picture, and for another field that is undefined on most of it.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> ax = matplotlib.figure.Figure().add_subplot()
    >>> artist = rsym.plot_field(disc, ax=ax, levels=[-1, 0, 0.5], resolution=32)
    >>> print(ax.get_title(), artist.get_cmap().name)
    $\omega$ RdBu_r
    >>> rsym.plot_field(disc, "sign", ax=ax, resolution=4).get_array()[2].tolist()
    [-1, -1, 1, 1, -1, -1]
    """
    field_on = shape
    if isinstance(shape, GivenField):
        shape, outside, title = shape.shape, outside or "mask", title or GIVEN_TITLES.get(field)
    require_shape(shape)
    look = Look(levels, limits, colour_map, outside)
    if field == "sign":
        return draw_signs(shape, ax, look, title, resolution, bounds, letters, section)
    options: Any = {"resolution": resolution, "bounds": bounds, "letters": letters, "section": section, "force": force}
    sampler = plane_sampler(field_on, field, **options)
    alike = sampler.field == "value" and field_on is shape
    omega = sampler if alike else plane_sampler(shape, "value", **options)
    values = sampler.values()
    logic = values if omega is sampler else omega.values()
    chosen = look.levels_of(values, sampler.field, logic > 0)
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(layout="compressed")
    require_axes(ax)
    boundary = trace(omega, 0.0, values=logic)
    artist = draw_levels(ax, sampler, values, chosen, boundary, look, logic)
    dress(ax, sampler, TITLES[field] if title is None else title)
    if field_on is not shape:
        draw_parts(ax, omega)
    if alone:
        colour_bar(artist, ax)
    _remark(shape, omega, logic, boundary, {field: values if field_on is shape else np.where(logic > 0, values, 0.0)})
    return artist


def plot_fields(
    shape: Shape | GivenField,
    fields: Sequence[str] = SIX,
    *,
    figure: Figure | SubFigure | None = None,
    levels: Mapping[str, Sequence[float]] | None = None,
    limits: Mapping[str, tuple[float, float]] | None = None,
    titles: Mapping[str, str] | None = None,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    colour_map: str | None = None,
    outside: str | None = None,
    progress: Progress | None = None,
    force: bool = False,
) -> Figure:
    r"""The sheet: level lines of several fields, by default the six of the source's Fig. 11.

    Panels are filled row by row, in two columns if the bounds are wide and three if they are tall.
    ``progress(done, total)`` is called before each; returning False cancels with an RsymError.

    Parameters
    ----------
    figure : Figure or SubFigure, optional
        Where to draw, in the size that it has; without it a new pyplot figure is made. With its
        ``layout="compressed"`` colour bars are as tall as their panels.
    levels, limits, titles : mapping, optional
        By the names of fields what `plot_field` takes for each.
    fields : sequence of str
        Of a solution "value" and "gradient_squared", by default, and "laplacian".
    shape, resolution, bounds, letters, section, colour_map, outside, force
        As for `plot_field`, with its errors and warnings.

    Returns
    -------
    Figure
        The whole figure, also where a part of it was given.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> figure = rsym.plot_fields(disc, ("value", "normalised"), resolution=32, titles={"value": "a disc"})
    >>> print(*(ax.get_title() for ax in figure.axes[:2]))
    a disc $\omega_n$
    """
    field_on = shape
    if isinstance(shape, GivenField):
        shape, outside = shape.shape, outside or "mask"
        fields = GIVEN_SHEET if fields is SIX else fields
    require_shape(shape)
    names = checked_fields(fields)
    look = Look(_by_field(levels, names, "levels"), _by_field(limits, names, "limits"), colour_map, outside)
    given = field_on is not shape
    named = {**(GIVEN_TITLES if given else TITLES), **_by_field(titles, names, "titles")}
    tell(progress, "compiling", 0, len(names))
    options: Any = {"resolution": resolution, "bounds": bounds, "section": section, "force": force}
    sampler = None if given else sheet_sampler(shape, names, **options)
    tell(progress, "sampling", 0, len(names))
    samples = _given_samples(field_on, names, letters, **options) if sampler is None else sampler.at(letters)
    drawn = page(figure, layout="compressed")
    Sheet(drawn, samples, look, named, sized=figure is None).draw(samples, progress)
    omega = samples.omega
    shown = {name: np.where(omega > 0, values, 0.0) if given else values for name, values in samples.fields.items()}
    _remark(shape, samples.sampler, omega, samples.boundary, shown)
    return whole(drawn)


def _remark(
    shape: Shape, omega: PlaneSampler, logic: Floats, boundary: LevelLines, fields: Mapping[str, Floats]
) -> None:
    """Warn of what a picture does not show: a boundary, omega, fields."""
    flat, _ = plane_section(shape, {shape.coordinates[k].name: value for k, value in omega.fixed.items()})
    gap = undefined_in(flat, omega.bounds, omega.letters)
    there = np.ones(logic.shape, np.bool_) if gap is None or np.isnan(logic).all() else ~np.isnan(logic)
    remarks = [missing_boundary(shape, omega, logic, boundary), "" if gap is None else str(gap)]
    remarks += [undefined_picture(name, values[there]) for name, values in fields.items()]
    for remark in filter(None, remarks):
        warn(remark)


def _by_field(given: Any, names: Sequence[str], word: str) -> dict[str, Any]:
    """What was given by the names of fields, which are among those that are drawn."""
    if given is None:
        return {}
    if not isinstance(given, Mapping) or not set(given) <= set(names):
        raise RsymError(
            f"{word} of several fields are given by their names ({', '.join(names)}), got {given!r}",
            code=word,
            remedy=f"{word}={{{names[0]!r}: ...}}",
        )
    return dict(given)


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
            look.levels_of(values, samples.called(field), inside)
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


@dataclass(frozen=True)
class SheetSamples:
    """What a sheet shows: values of fields on the lattice of a sampler, by name, omega and the boundary omega = 0."""

    sampler: PlaneSampler
    fields: Mapping[str, NDArray[Any]]
    omega: NDArray[Any]
    boundary: LevelLines
    solved: bool = False

    def called(self, field: str) -> str:
        """The name of a field to choose levels by: u says nothing of what is inside, omega does."""
        return GIVEN if self.solved and field == "value" else field


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
    return SheetSampler(omega, replace(omega, given=compile(shape, names)))


def _given_samples(
    field_on: Any, names: Sequence[str], letters: Mapping[Any, float] | None, **options: Any
) -> SheetSamples:
    """Fields of a solution, and omega of its shape."""
    values = {name: plane_sampler(field_on, name, letters=letters, **options).values() for name in names}
    omega = plane_sampler(field_on.shape, "value", **options)
    logic = omega.values()
    return SheetSamples(omega, values, logic, trace(omega, 0.0, values=logic), solved=True)


def _arrangement(sampler: PlaneSampler, count: int) -> tuple[int, int, tuple[float, float]]:
    """Rows, columns and inches of panels, each with a colour bar."""
    width, height = (sampler.lattice.spacing[k] * sampler.lattice.counts[k] for k in (0, 1))
    columns = min(2 if height <= 1.2 * width else 3, count)
    rows = -(-count // columns)
    panel = min(8.4 / columns, 5.0 * width / height)
    return rows, columns, (columns * (panel + 0.9), rows * (max(panel * height / width, 1.6) + 0.45))
