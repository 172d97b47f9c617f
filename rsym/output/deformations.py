"""An elastic body as it is bent, coloured by von Mises' stress."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.contour import QuadContourSet
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.requirements import require_kind
from rsym.output.looks import Look, levels_of_sizes, snapped
from rsym.output.panels import colour_bar
from rsym.output.pictures import require_axes
from rsym.problems.corners.corners import inward_corners
from rsym.problems.elastic.result import ElasticSolution
from rsym.sampling.outlines import outline
from rsym.sampling.plane import plane_sampler
from rsym.sampling.plane_leaves import leaves_of

SHOWN = 0.1  # of the size of the body: how far its greatest displacement is drawn
COLOUR_MAP = "viridis"


def plot_deformation(
    solution: ElasticSolution,
    *,
    ax: Axes | None = None,
    scale: float | None = None,
    levels: Sequence[float] | None = None,
    limits: tuple[float, float] | None = None,
    title: str | None = None,
    resolution: int | Sequence[int] = 400,
    bounds: Any = None,
    colour_map: str = COLOUR_MAP,
) -> QuadContourSet:
    r"""The body where its points have come to, x + s u(x), coloured by von Mises' stress, over its outline at rest.

    Parameters
    ----------
    solution : ElasticSolution
        What `elasticity` answered.
    ax : matplotlib axes, optional
        Where to draw; without it a new figure with a colour bar is made.
    scale : number, optional
        s; without it the greatest displacement is a tenth of the body, and the title tells s.
    levels : sequence of float, optional
        Of the stress; without them round ones from 0 to its largest value. Beside corners that point inwards it has no
        bound: colours then end at what all but a two hundredth of the body has.
    limits : pair of numbers, optional
        Of the stress, where the colours end.
    title : str, optional
        Instead of the scale.
    resolution, bounds
        As for `plot_field`.
    colour_map : str
        A name that matplotlib knows.

    Returns
    -------
    matplotlib.contour.QuadContourSet
        The filled contours, fit for a colour bar.

    Raises
    ------
    RsymError
        For what is no such answer, a body whose outline is open within the bounds, an unknown colour map, limits
        without order.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> ring = rsym.disc(1).named("rim") - rsym.disc(0.5).named("bore")
    >>> pressed = rsym.elasticity(ring, {"rim": 0, "bore": rsym.pressure(1)}, young=1, poisson=0.3, cells=8)
    >>> ax = matplotlib.figure.Figure().add_subplot()
    >>> artist = rsym.plot_deformation(pressed, ax=ax, scale=1, resolution=24)
    >>> ax.get_title()
    'displacements × 1'
    """
    require_kind(ElasticSolution, solution, "solution")
    omega = plane_sampler(solution.shape, "value", resolution=resolution, bounds=bounds)
    leaves = leaves_of(omega.shape, omega.free, omega.fixed, omega.letters, omega.bounds)
    rest = [line for line in outline(omega, leaves)]
    if not rest or not all((line[0] == line[-1]).all() for line in rest):
        raise RsymError(
            "the outline of the body is not closed", code="open-lines", remedy="widen the bounds until they hold it"
        )
    inside = omega.values() > 0
    axes = omega.lattice.open_axes()
    moved, stress = solution.displacement(*axes), solution.von_mises(*axes)
    size = max(float(np.ptp(np.concatenate(rest)[:, k])) for k in (0, 1))
    greatest = float(np.nanmax(np.linalg.norm(moved[inside], axis=-1)))
    if scale is None:
        scale = float(f"{SHOWN * size / greatest:.1g}") if greatest > 0 else 1.0
    look = Look(levels, limits, colour_map)
    chosen = levels_of_sizes(look, stress, inside, omega.lattice, inward_corners(solution.shape))
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(layout="compressed")
    require_axes(ax)
    bent = [line + scale * solution.jets(line)[:, 0].T for line in rest]
    artist = _filled(ax, omega.lattice, scale * moved, stress, chosen, look)
    body = Path.make_compound_path(*(Path(line, closed=True) for line in bent))
    clip = PathPatch(body, transform=ax.transData, visible=False)
    ax.add_patch(clip)
    artist.set_clip_path(clip)
    ax.add_collection(LineCollection(rest, colors="0.45", linewidths=0.8, linestyles="dashed", zorder=2.8))
    ax.add_collection(LineCollection(bent, colors="black", linewidths=1.8, zorder=3))
    every = np.concatenate([*rest, *bent])
    (left, low), (right, high) = every.min(axis=0) - size / 20, every.max(axis=0) + size / 20
    ax.set(xlim=(left, right), ylim=(low, high), aspect="equal")
    ax.set(xlabel=f"${omega.names[0]}$", ylabel=f"${omega.names[1]}$")
    ax.set_title(f"displacements × {scale:g}" if title is None else title, fontsize=12)
    ax.tick_params(labelsize=8)
    if alone:
        colour_bar(artist, ax).set_label("von Mises' stress")
    return artist


def _filled(ax: Axes, lattice: Any, moved: Floats, stress: Floats, levels: Floats, look: Look) -> QuadContourSet:
    """Filled levels on the lattice as it is bent; where nothing is known nothing is drawn."""
    u, v = np.meshgrid(lattice.axis(0), lattice.axis(1), indexing="ij")
    known = np.isfinite(stress) & np.isfinite(moved).all(axis=-1)
    shift = np.where(known[..., None], moved, 0.0)
    colours, norm = look.colours(levels)
    extend = look.beyond(levels, stress)
    shown = np.ma.masked_where(~known, snapped(levels, stress, extend))
    artist = ax.contourf(
        u + shift[..., 0], v + shift[..., 1], shown, levels=levels, cmap=colours, norm=norm, extend=extend
    )
    artist.set(rasterized=True)
    return artist
