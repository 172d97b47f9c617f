"""The sheet of modes of a shape, each with its eigenvalue."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure, SubFigure

from rsym.arrays import Floats
from rsym.model.requirements import require_kind
from rsym.output.looks import TWO_SIDED, Look
from rsym.output.panels import columns_of, draw_levels, dress
from rsym.output.pictures import checked_titles, page, whole
from rsym.problems.spectra import Spectrum
from rsym.sampling.level_lines import trace
from rsym.sampling.plane import plane_sampler
from rsym.sampling.progress import Progress, tell

SHARE = 0.995  # of the samples inside: the colours end there
SIDE = 7  # levels on each side of 0
PANEL = 2.5  # inches


def plot_modes(
    spectrum: Spectrum,
    *,
    figure: Figure | SubFigure | None = None,
    titles: Sequence[str] | None = None,
    limits: tuple[float, float] | None = None,
    resolution: int | Sequence[int] = 240,
    bounds: Any = None,
    section: Mapping[Any, float] | None = None,
    colour_map: str = TWO_SIDED,
    progress: Progress | None = None,
) -> Figure:
    r"""Modes in panels, three in a row: filled level lines between -m and m about the heavy line of the boundary.

    Colours are symmetric about 0, whose level is where a drum stands still; m is where all but a two hundredth of the
    values are below, for each mode.

    Parameters
    ----------
    spectrum : Spectrum
        What `modes` answered.
    figure : Figure or SubFigure, optional
        Where to draw, in the size that it has; without it a new pyplot figure is made.
    titles : sequence of str, optional
        One for each mode; without them the eigenvalues.
    limits : pair of numbers, optional
        Where the colours end in all panels, instead of -m and m.
    resolution, bounds, section
        As for `plot_field`.
    colour_map : str
        A name that matplotlib knows; one whose middle is pale.
    progress : callable, optional
        ``progress(done, total)`` before each panel; returning False cancels with an RsymError.

    Returns
    -------
    Figure
        The whole figure, also where a part of it was given.

    Raises
    ------
    RsymError
        For what is no spectrum, an unknown colour map, titles of another number, limits without order.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> drum = rsym.modes(rsym.disc(1), 2, cells=6)
    >>> figure = rsym.plot_modes(drum, figure=matplotlib.figure.Figure(), resolution=24)
    >>> print(*(ax.get_title() for ax in figure.axes))
    $\lambda_{1} = 5.783$ $\lambda_{2} = 14.68$
    """
    require_kind(Spectrum, spectrum, "spectrum")
    own = [rf"$\lambda_{{{number}}} = {value:.4g}$" for number, value in enumerate(spectrum.values, 1)]
    named = checked_titles(titles, own)
    options: Any = {"resolution": resolution, "bounds": bounds, "section": section}
    omega = plane_sampler(spectrum.modes[0].shape, "value", **options)
    logic = omega.values()
    boundary = trace(omega, 0.0, values=logic)
    columns = columns_of(len(named))
    rows = math.ceil(len(named) / columns)
    lattice = omega.lattice
    slender = lattice.spacing[1] * lattice.counts[1] / (lattice.spacing[0] * lattice.counts[0])
    size = (columns * PANEL, rows * (PANEL * min(slender, 2.0) + 0.3))
    drawn = page(figure, layout="compressed", size=size)
    axes = drawn.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for number, ax in enumerate(axes.flat):
        if number >= len(named):
            ax.set_axis_off()
            continue
        tell(progress, named[number], number, len(named))
        sampler = plane_sampler(spectrum.modes[number], "value", **options)
        values = sampler.values()
        look = Look(_levels(values[logic > 0]) if limits is None else None, limits, colour_map, "mask")
        draw_levels(ax, sampler, values, look.levels_of(values), boundary, look, logic)
        dress(ax, sampler, named[number])
        ax.title.set_fontsize(10)
        ax.label_outer()
    tell(progress, "done", len(named), len(named))
    return whole(drawn)


def _levels(inside: Floats) -> Floats:
    most = float(np.quantile(np.abs(inside[np.isfinite(inside)]), SHARE))
    return np.linspace(-most, most, 2 * SIDE + 1)
