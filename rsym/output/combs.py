"""Curvature combs: teeth along a level line as long as its curvature is large."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Colormap, ListedColormap, Normalize

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError
from rsym.model.letters import real_number
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.output.paints import beyond, checked_limits, checked_map
from rsym.output.pictures import require_axes
from rsym.sampling.combs import Comb, combs

USUAL = 0.95  # the share of a line's length whose curvature the usual one is not below
# Teeth of the usual and of the largest curvature, as shares of the picture's diagonal.
USUAL_LENGTH, MOST_LENGTH = 0.10, 0.25
# A needle's curvature may be a hundred times the usual: beyond so many times a tooth is cut, and the envelope is open.
LONGEST = 4.0
NOTHING = 1e-9  # of the largest curvature: below, the sign is that of rounding


class CombTeeth(LineCollection):
    """The teeth of combs, with the `envelopes` over them and the `lines` on which they stand."""

    def __init__(
        self, segments: Floats, values: Floats, scale: ScalarMappable, envelopes: LineCollection, lines: LineCollection
    ) -> None:
        super().__init__(list(segments), array=values, cmap=scale.get_cmap(), norm=scale.norm, linewidths=0.8, zorder=2)
        self.envelopes, self.lines = envelopes, lines


def plot_curvature_comb(
    shape: Shape,
    *,
    ax: Axes | None = None,
    level: float = 0.0,
    scale: float | None = None,
    teeth: int = 300,
    resolution: int | Sequence[int] = 512,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
) -> CombTeeth:
    r"""Teeth normal to the lines omega = level, of length proportional to the curvature, outwards where convex.

    A jump of the curvature is a step of the envelope, a corner of the line a gap in it. Teeth are coloured by the
    curvature, from both sides of zero if it has both signs.

    Parameters
    ----------
    shape : Shape
        A shape in the plane, or one in space with ``section={z: 1.0}``.
    ax : matplotlib axes, optional
        Where to draw; without it a new figure with a colour bar is made.
    scale : float, optional
        The length of a tooth over the curvature. If it is left out, the usual tooth is a tenth of the picture or less
        and the longest a quarter; one of more than four times the usual is cut, and the envelope is open there.
    teeth : int
        Teeth on all lines together, evenly spaced by arc length.
    resolution, bounds, letters
        As for `level_lines`.
    limits : pair of numbers, optional
        The curvatures at the ends of the colours; without it those of the teeth.
    colour_map : str, optional
        A name that matplotlib knows; without it ``coolwarm`` for limits about zero, otherwise pale to dark.

    Returns
    -------
    matplotlib.collections.LineCollection
        The teeth, fit for a colour bar; its ``envelopes`` and ``lines`` are line collections too.

    Raises
    ------
    RsymError
        As `level_lines`, for a scale that is not positive, and for a level that the shape does not reach.

    Examples
    --------
    >>> import matplotlib.figure, rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(4 - x**2 - y**2, (x, y), bounds=((-3, 3), (-3, 3)))
    >>> ax = matplotlib.figure.Figure().add_subplot()
    >>> drawn = rsym.plot_curvature_comb(disc, ax=ax, scale=1, teeth=20, resolution=64)
    >>> len(drawn.get_segments())
    20
    """
    require_shape(shape)
    found = combs(shape, level, teeth=teeth, resolution=resolution, bounds=bounds, letters=letters, section=section)
    factor, longest = _scale(found) if scale is None else (_checked_scale(scale), np.inf)
    alone = ax is None
    if ax is None:
        import matplotlib.pyplot

        _, ax = matplotlib.pyplot.subplots(figsize=_page(found, factor, longest), layout="compressed")
    require_axes(ax)
    drawn = _draw(ax, found, factor, longest, limits, checked_map(colour_map))
    names = [symbol.name for symbol in shape.coordinates if symbol.name not in map(str, section or {})]
    ax.set(aspect="equal", xlabel=f"${names[0]}$", ylabel=f"${names[1]}$")
    ax.autoscale_view()
    if alone:
        _colour_bar(ax, drawn, found)
    return drawn


def _draw(
    ax: Axes,
    found: Sequence[Comb],
    scale: float,
    longest: float,
    limits: tuple[float, float] | None,
    colour_map: str | None,
) -> CombTeeth:
    ends = [_ends(comb, scale, longest) for comb in found]
    marked = [_marked(comb) for comb in found]
    segments = np.concatenate(
        [np.stack([comb.points, end], axis=1)[mark] for comb, end, mark in zip(found, ends, marked, strict=True)]
    )
    values = np.concatenate([comb.curvature[mark] for comb, mark in zip(found, marked, strict=True)])
    colours, norm = _colours(np.concatenate([comb.curvature for comb in found]), longest, limits)
    open_ends = [
        _runs(np.where((np.abs(comb.curvature) <= longest)[:, None], end, np.nan), comb.breaks)
        for comb, end in zip(found, ends, strict=True)
    ]
    envelopes = LineCollection([run for runs in open_ends for run in runs], colors="0.35", linewidths=0.7, zorder=3)
    lines = LineCollection([comb.points for comb in found], colors="black", linewidths=1.8, zorder=4)
    teeth = CombTeeth(segments, values, ScalarMappable(norm, colour_map or colours), envelopes, lines)
    for collection in (teeth, envelopes, lines):
        ax.add_collection(collection)
    return teeth


def _ends(comb: Comb, scale: float, longest: float) -> Floats:
    return comb.points + scale * np.clip(comb.curvature, -longest, longest)[:, None] * comb.normals


def _page(found: Sequence[Comb], scale: float, longest: float) -> tuple[float, float]:
    """The size of a figure in inches that the comb fills."""
    points = np.concatenate([part for comb in found for part in (comb.points, _ends(comb, scale, longest))])
    width, height = np.nanmax(points, axis=0) - np.nanmin(points, axis=0)
    return 8.0, float(np.clip(7.0 * height / max(width, 1e-3 * height), 2.2, 8.0)) + 0.6


def _marked(comb: Comb) -> Flags:
    """The teeth to draw: where the curvature is defined, and the first point of a closed line once."""
    marked: Flags = np.isfinite(comb.curvature) & comb.teeth
    if np.array_equal(comb.points[0], comb.points[-1]):
        marked[-1] = False
    return marked


def _runs(points: Floats, breaks: Flags) -> list[Floats]:
    """The pieces of a line between its breaks and undefined points."""
    undefined = np.isnan(points[:, 0])
    parts = np.split(np.arange(len(points)), np.flatnonzero(breaks | undefined[1:] | undefined[:-1]) + 1)
    return [points[part] for part in parts if len(part) > 1]


def _scale(found: Sequence[Comb]) -> tuple[float, float]:
    """The length of a tooth over the curvature, and the curvature at which teeth are cut."""
    points = np.concatenate([comb.points for comb in found])
    diagonal = float(np.hypot(*np.ptp(points, axis=0)))
    sizes = np.concatenate([np.abs(comb.curvature[_marked(comb)]) for comb in found])
    most = max(float(np.nan_to_num(np.abs(comb.curvature)).max()) for comb in found)
    if not sizes.size or most * diagonal < NOTHING:
        return 1.0, np.inf
    usual = float(np.quantile(sizes, USUAL))
    longest = LONGEST * usual if usual * diagonal > NOTHING else most
    factor = MOST_LENGTH / min(most, longest)
    return diagonal * (min(factor, USUAL_LENGTH / usual) if usual > 0 else factor), longest


def _colours(values: Floats, longest: float, limits: tuple[float, float] | None) -> tuple[Colormap, Normalize]:
    """Pale where the curvature is small; two colours if it has both signs."""
    if limits is not None:
        low, high = checked_limits(limits)
        return colormaps["coolwarm" if low < 0 < high else "viridis_r"], Normalize(low, high)
    values = values[np.isfinite(values)]
    most = float(min(np.abs(values).max(initial=0.0), longest)) or 1.0
    if values.min(initial=0.0) < -NOTHING * most < NOTHING * most < values.max(initial=0.0):
        return colormaps["coolwarm"], Normalize(-most, most)
    one_sign = ListedColormap(colormaps["viridis_r"](np.linspace(0.12, 1.0, 256)))
    return (one_sign, Normalize(0.0, most)) if values.sum() >= 0 else (one_sign.reversed(), Normalize(-most, 0.0))


def _colour_bar(ax: Axes, teeth: LineCollection, found: Sequence[Comb]) -> None:
    """Pointed at an end that the curvature exceeds somewhere."""
    values, (low, high) = np.concatenate([comb.curvature for comb in found]), teeth.get_clim()
    bar = ax.figure.colorbar(teeth, ax=ax, pad=0.02, shrink=0.7, extend=beyond(values, low, high))
    bar.set_label(r"curvature $\kappa$")


def _checked_scale(scale: float) -> float:
    value = float(real_number(scale, "scale"))
    if not value > 0:
        raise RsymError(f"scale must be positive, got {scale!r}", code="scale", remedy="leave it out")
    return value
