"""Stress lines of a twisted shaft over the size of its shear stress."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet

from rsym.arrays import Floats
from rsym.model.requirements import require_kind
from rsym.output.looks import Look, levels_of_sizes
from rsym.output.panels import colour_bar, draw_levels, dress, thin_out
from rsym.output.pictures import require_axes
from rsym.problems.corners.corners import inward_corners
from rsym.problems.torsion import Torsion
from rsym.sampling.level_lines import trace
from rsym.sampling.plane import plane_sampler

LINES = 14  # stress lines between the outer boundary and the summit
COLOUR_MAP = "plasma_r"


def plot_torsion(
    torsion: Torsion,
    *,
    ax: Axes | None = None,
    lines: int = LINES,
    title: str | None = None,
    limits: tuple[float, float] | None = None,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    colour_map: str = COLOUR_MAP,
) -> QuadContourSet:
    r"""The stress lines of a twisted shaft, over the size of the shear stress, for the shear modulus and the twist 1.

    A stress line is a level line of Prandtl's function u; their levels are equally spaced, so they are the denser the
    larger the stress |grad u| is, which the colours show, to its largest value; beside a corner that points inwards,
    where it has no bound, to what all but a two hundredth of the section has.

    Parameters
    ----------
    torsion : Torsion
        What `torsion` answered.
    ax : matplotlib axes, optional
        Where to draw; without it a new figure with a colour bar is made.
    lines : int
        How many stress lines there are between 0 and the summit of u.
    title : str, optional
        Instead of the rigidity.
    limits : pair of numbers, optional
        Of the stress, where the colours end.
    resolution, bounds
        As for `plot_field`.
    colour_map : str
        A name that matplotlib knows.

    Returns
    -------
    matplotlib.contour.QuadContourSet
        The filled contours of the stress, fit for a colour bar.

    Raises
    ------
    RsymError
        For what is no torsion, an unknown colour map, limits without order.

    Source: L. Prandtl (1903), Zur Torsion von prismatischen Staeben.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> shaft = rsym.torsion(rsym.ellipse(2, 1), cells=6)
    >>> ax = matplotlib.figure.Figure().add_subplot()
    >>> artist = rsym.plot_torsion(shaft, ax=ax, resolution=32)
    >>> print(ax.get_title())
    $J = 5.027$
    """
    require_kind(Torsion, torsion, "torsion")
    solution = torsion.solution
    options: Any = {"resolution": resolution, "bounds": bounds}
    omega = plane_sampler(solution.shape, "value", **options)
    sampler = plane_sampler(solution, "value", **options)
    logic = omega.values()
    found = solution.sampled(*sampler.lattice.open_axes())
    stress = np.linalg.norm(found["gradient"], axis=-1)
    look = Look(None, limits, colour_map, "mask")
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(layout="compressed")
    require_axes(ax)
    levels = levels_of_sizes(look, stress, logic > 0, sampler.lattice, inward_corners(solution.shape))
    boundary = trace(omega, 0.0, values=logic)
    artist = draw_levels(ax, sampler, stress, levels, boundary, replace(look, levels=levels), logic, lined=False)
    _draw_lines(ax, omega, np.where(logic > 0, found["value"], np.nan), found["value"], lines)
    dress(ax, sampler, rf"$J = {torsion.rigidity:.4g}$" if title is None else title)
    if alone:
        colour_bar(artist, ax).set_label("shear stress")
    return artist


def _draw_lines(ax: Axes, omega: Any, inside: Floats, values: Floats, count: int) -> None:
    most = float(np.nanmax(inside))
    levels = most * np.arange(1, count + 1) / (count + 1)
    u, v = omega.lattice.axis(0), omega.lattice.axis(1)
    drawn = ax.contour(u, v, np.ma.masked_invalid(values.T), levels=levels, colors="black", linewidths=0.6)
    thin_out(drawn, min(omega.lattice.spacing))
