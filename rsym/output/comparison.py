"""Several surfaces side by side, by the same maps in the same colours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from matplotlib.figure import Figure

from rsym.errors import RsymError
from rsym.model.requirements import require_mapping
from rsym.output.gallery import Gallery
from rsym.output.paints import MAPS
from rsym.output.patches import Lines, Patches, map_range, plot_patches
from rsym.output.shading import AZIMUTH, ELEVATION


def compare_patches(
    surfaces: Mapping[str, Patches],
    *,
    colour_by: Sequence[str] = ("mean_curvature", "zebra"),
    lines: Lines = 0,
    edges: bool = True,
    resolution: int | None = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    letters: Mapping[Any, float] | None = None,
    figure: Figure | None = None,
) -> Figure:
    """Draw surfaces side by side, one column for each and one row for each map; a row has one scale of colours.

    Parameters
    ----------
    surfaces : mapping
        Titles to patches, one or several each.
    colour_by : sequence of str
        The maps of `plot_patches`.
    lines, edges, resolution, elevation, azimuth, letters
        As for `plot_patches`.
    figure : Figure, optional
        An empty figure to fill; a new pyplot figure is made if it is left out.

    Returns
    -------
    Figure

    Raises
    ------
    RsymError
        Without surfaces or maps, and as `plot_patches`.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> twisted = {name: ParametricSurface((u, v, k * u * v)) for name, k in (("a", 1), ("b", 2))}
    >>> figure = compare_patches(twisted, resolution=8, figure=Figure())
    >>> [text.get_text() for text in figure.texts], len(figure.axes)
    (['a', 'b'], 5)
    """
    require_mapping(surfaces, "patch", 'for example {"one": patch, "two": other}')
    if not surfaces or not colour_by:
        raise RsymError("a comparison needs surfaces and maps", code="patch")
    if figure is None:
        import matplotlib.pyplot

        figure = matplotlib.pyplot.figure()
    gallery = Gallery(figure, len(colour_by), len(surfaces))
    for name, row in zip(colour_by, gallery.axes, strict=True):
        limits = map_range(list(surfaces.values()), name, resolution, letters) if name in MAPS else None
        for patches, ax in zip(surfaces.values(), row, strict=True):
            plot_patches(
                patches,
                ax=ax,
                colour_by=name,
                limits=limits,
                lines=lines,
                edges=edges,
                resolution=resolution,
                elevation=elevation,
                azimuth=azimuth,
                letters=letters,
            )
    gallery.arrange([list(surfaces)])
    return figure
