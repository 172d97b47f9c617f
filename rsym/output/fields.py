"""Pictures of fields: filled level lines, the boundary emphasised."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure
from numpy.typing import NDArray

from rsym.codegen.fields import SIX, checked_fields
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.output.panels import COLOUR_MAP, TITLES, colour_bar, draw_levels, dress, robust_levels
from rsym.output.sheet import Sheet, sheet_sampler
from rsym.sampling.contours import level_lines, trace
from rsym.sampling.plane import plane_sampler
from rsym.sampling.progress import Progress, report


def plot_field(
    shape: Shape,
    field: str = "value",
    *,
    ax: Axes | None = None,
    levels: Sequence[float] | None = None,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    colour_map: str = COLOUR_MAP,
) -> QuadContourSet:
    r"""Filled level lines of one field, the boundary omega = 0 as a heavy line.

    Levels are evenly spaced over a robust range, so that a singular spot does not
    flatten the picture; what lies beyond has the colour of the end. Where the
    field is undefined the ground is hatched.

    Parameters
    ----------
    shape : Shape
        A shape in the plane, or one in space with ``section={z: 1.0}``.
    field : str
        A scalar field of `compile`.
    ax : matplotlib axes, optional
        Where to draw; without it a new figure with a colour bar is made.
    levels : sequence of float, optional
        Two or more increasing levels.

    Returns
    -------
    matplotlib.contour.QuadContourSet
        The filled contours, fit for a colour bar.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> ax = matplotlib.figure.Figure().add_subplot()
    >>> artist = rsym.plot_field(disc, ax=ax, levels=[-1, 0, 0.5], resolution=32)
    >>> print(ax.get_title())
    $\omega$
    """
    require_shape(shape)
    sampler = plane_sampler(shape, field, resolution=resolution, bounds=bounds, letters=letters, section=section)
    values = sampler.values()
    chosen = _checked_levels(levels) if levels is not None else robust_levels(values)
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(layout="compressed")
    if field == "value":
        boundary = trace(sampler, 0.0, values=values)
    else:
        boundary = level_lines(shape, resolution=resolution, bounds=bounds, letters=letters, section=section)
    artist = draw_levels(ax, sampler, values, chosen, boundary, colour_map)
    dress(ax, sampler, TITLES[field])
    if alone:
        colour_bar(artist, ax)
    return artist


def plot_fields(
    shape: Shape,
    fields: Sequence[str] = SIX,
    *,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    colour_map: str = COLOUR_MAP,
    progress: Progress | None = None,
) -> Figure:
    r"""The sheet: level lines of several fields, by default the six of the source's Fig. 11.

    Panels are filled row by row, in two columns if the bounds are wide and three if they are tall.
    ``progress(done, total)`` is called before each; returning False cancels with an RsymError.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> figure = rsym.plot_fields(disc, ("value", "normalised"), resolution=32)
    >>> print(*(ax.get_title() for ax in figure.axes[:2]))
    $\omega$ $\omega_n$
    """
    require_shape(shape)
    import matplotlib.pyplot

    names = checked_fields(fields)
    report(progress, 0, len(names))
    sampler = sheet_sampler(shape, names, resolution=resolution, bounds=bounds, section=section)
    samples = sampler.at(letters)
    figure: Figure = matplotlib.pyplot.figure(layout="compressed")
    Sheet(figure, samples, colour_map).draw(samples, progress)
    return figure


def _checked_levels(levels: Sequence[float]) -> NDArray[np.float64]:
    chosen = np.asarray(levels, np.float64)
    if chosen.ndim != 1 or len(chosen) < 2 or not (np.diff(chosen) > 0).all():
        raise RsymError(f"levels must be two or more increasing numbers, got {levels!r}", code="levels")
    return chosen
