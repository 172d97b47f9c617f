"""Pictures of parametric surfaces: shaded, with parameter lines, nets, curves and points, or as maps of curvature.

Several stand side by side, by the same maps in the same colours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from typing import Any, TypeAlias

import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.model.requirements import require_mapping
from rsym.model.wording import documented
from rsym.output.bodies import show
from rsym.output.gallery import Gallery
from rsym.output.ink import INK, Stroke, dots
from rsym.output.paints import (
    MAPS,
    NAMES_OF_MAPS,
    Coat,
    between_corners,
    one_colour,
    part_coat,
    robust_limits,
    value_coat,
    zebra,
)
from rsym.output.shading import AZIMUTH, BODY, ELEVATION
from rsym.output.surfaces import ShadedMesh
from rsym.output.tessellation import Tessellation, cells_of, joined, line_parameters, pieces, tessellate
from rsym.surfaces import forms
from rsym.surfaces.functions.univariate import Univariate as SpaceCurve
from rsym.surfaces.patch import Patch, patches_of

Patches: TypeAlias = Patch | Sequence[Patch] | Mapping[str, Patch]
Lines: TypeAlias = int | tuple[ArrayLike, ArrayLike]
LINES = 8  # intervals of the parameter lines
LINE_WIDTH, EDGE_WIDTH, CURVE_WIDTH, NET_WIDTH = 0.4, 1.1, 1.5, 0.8  # points
DOT = 3.6  # points
CURVE, NET, POINT = "#8c2d04", "#6a3d9a", "#b2182b"
SAMPLES = 201  # of a curve
HIDDEN = 0.3  # the share of a net or a curve that shows through the surface


@documented(maps=NAMES_OF_MAPS)
def plot_patches(
    patches: Patches,
    *,
    ax: Axes3D | None = None,
    colour: str = BODY,
    colour_by: str | None = None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
    lines: Lines = LINES,
    edges: bool = True,
    net: ArrayLike | None = None,
    curves: Sequence[SpaceCurve | ArrayLike] = (),
    points: ArrayLike | None = None,
    resolution: int | None = None,
    elevation: float = ELEVATION,
    azimuth: float = AZIMUTH,
    letters: Mapping[Any, float] | None = None,
) -> ShadedMesh:
    """Draw patches as one shaded surface, what is hidden removed, and what belongs to them.

    Parameters
    ----------
    patches : Patch, or sequence or mapping of them
        The surface; the keys of a mapping are names for a legend. Both sides look alike.
    ax : Axes3D, optional
        Where to draw; a new pyplot figure is made if it is left out.
    colour : str
        The colour of the surface, as matplotlib writes colours.
    colour_by : str, optional
        {maps}, exact at some tens of thousands of points: where
        patches meet each shows its own; ``zebra``: the reflection of level stripes, kinked where the curvature jumps
        and broken at an edge; ``patch``: a colour for each patch. A new figure says what the colours mean, otherwise
        ``figure.colorbar(artist.scale, ax=ax)`` does, and ``artist.parts`` maps names to colours.
    limits : pair of numbers, optional
        The ends of the colour scale, so that several pictures share it; without it they come from the values.
    colour_map : str, optional
        The colours of values; without it ``coolwarm`` for limits about zero, otherwise ``viridis``.
    lines : int, or two sequences
        Lines u = const and v = const: of so many intervals in each direction, or at the parameters given.
    edges : bool
        Whether to draw the edges of the patches.
    net : (r, s, 3) array, optional
        A control net: its vertices and legs, paler where the surface hides them; of one closed patch closed too.
    curves : sequence of Curve or (k, 3) arrays
        Lines in space, such as those of a network.
    points : (..., 3) array, optional
        Data.
    resolution : int, optional
        Cells along each direction of each patch; without it about 32 000 in all.
    elevation, azimuth : float
        The direction of the eye in degrees, as for `plot_mesh`.
    letters : mapping, optional
        Values of letters by name.

    Returns
    -------
    Artist
        The picture; its figure is ``artist.get_figure()``.

    Raises
    ------
    RsymError
        For an unknown map, axes that are not three-dimensional, or an array that is no net, curve or points.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> axes = Figure().add_subplot(projection="3d")
    >>> artist = plot_patches(ParametricSurface((u, v, u * v)), ax=axes, colour_by="gaussian_curvature", resolution=16)
    >>> [round(limit, 2) for limit in artist.scale.get_clim()]
    [-0.96, -0.14]
    """
    strokes = [
        *[Stroke(pieces(_polyline(curve, letters)), CURVE, CURVE_WIDTH, HIDDEN) for curve in curves],
        *([] if net is None else _net(_checked(net, 3, "a net"), patches)),
        *([] if points is None else dots(_checked(points, None, "points").reshape(-1, 3), POINT, DOT, HIDDEN)),
    ]
    parts = tessellations(patches, lines, resolution, letters, curved=colour_by in MAPS)
    coat = coat_of_patches(parts, colour, colour_by, limits, colour_map)
    return show(shaded(parts, coat, lines, edges, strokes), ax, elevation, azimuth)


def shaded(
    parts: Sequence[Tessellation], coat: Coat, lines: Lines, edges: bool, strokes: Sequence[Stroke]
) -> ShadedMesh:
    """The picture of patches in a coat, with their own lines below other strokes."""
    drawn = [
        Stroke(part.lines(axis, parameters), INK, LINE_WIDTH)
        for part in parts
        for axis, parameters in enumerate(line_parameters(part.patch, lines))
    ]
    drawn += [Stroke(part.edges(), INK, EDGE_WIDTH) for part in parts if edges]
    return ShadedMesh(joined(parts), coat, features=False, strokes=[*drawn, *strokes])


def tessellations(
    patches: Patches,
    lines: Lines,
    resolution: int | None,
    letters: Mapping[Any, float] | None,
    *,
    curved: bool = False,
) -> list[Tessellation]:
    """The patches over grids that hold the parameters of their lines; `curved` if curvatures will be asked for."""
    named = _named(patches)
    values = merged_letters(patches).values_with(letters)
    cells = cells_of(len(named)) if resolution is None else resolution
    own = {name: {letter: values[letter] for letter in patch.letters} for name, patch in named.items()}
    return [
        tessellate(name, patch, cells, line_parameters(patch, lines), own[name], curved=curved)
        for name, patch in named.items()
    ]


def merged_letters(patches: Patches) -> Letters:
    """The letters of all patches."""
    return reduce(Letters.merge, (patch.letters for patch in _named(patches).values()), Letters({}))


def map_values(parts: Sequence[Tessellation], name: str) -> Floats:
    """A map of `MAPS` at the corners of the faces of the joined mesh, (m, 3)."""
    pairs = zip(*(part.curvatures() for part in parts), strict=True)
    gaussian, mean = (np.concatenate([one.ravel() for one in several]) for several in pairs)
    known = {
        "gaussian_curvature": gaussian,
        "mean_curvature": mean,
        "principal_curvatures": forms.principal(gaussian, mean),
    }
    values = MAPS[name].of(known[MAPS[name].field])
    return np.asarray(values[joined(parts).faces])


def _named(patches: Patches) -> dict[str, Patch]:
    """The patches by name, or by numbers from 1."""
    if isinstance(patches, Mapping):
        named = {str(name): patch for name, patch in patches.items()}
    else:
        named = {str(number): patch for number, patch in enumerate(patches_of(patches), 1)}
    if not named or not all(isinstance(one, Patch) for one in named.values()):
        raise RsymError(f"expected a Patch or several, got {patches!r}", code="patch")
    return named


def coat_of_patches(
    parts: Sequence[Tessellation],
    colour: str,
    colour_by: str | None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
) -> Coat:
    """The paint of patches, as `plot_patches` describes it."""
    if colour_by is None:
        return one_colour(colour, inside=colour)
    mesh = joined(parts)
    if colour_by == "zebra":
        return Coat(zebra(mesh, mesh.normals))
    if colour_by == "patch":
        return part_coat(mesh, inside=None)
    if colour_by not in MAPS:
        known = ", ".join((*MAPS, "zebra", "patch"))
        raise RsymError(f"no map {colour_by!r}", code="colour-by", remedy=f"choose from {known}")
    values = map_values(parts, colour_by)
    chosen = limits if limits is not None else _limits(mesh.vertices, values, colour_by)
    return value_coat(between_corners(values), values, MAPS[colour_by].label, limits=chosen, colour_map=colour_map)


def map_range(
    surfaces: Sequence[Patches], name: str, resolution: int | None, letters: Mapping[Any, float] | None
) -> tuple[float, float]:
    """The ends of a scale of curvature that several surfaces share."""
    several = [tessellations(patches, 0, resolution, letters, curved=True) for patches in surfaces]
    values = [map_values(parts, name).ravel() for parts in several]
    points = [part.points.reshape(-1, 3) for parts in several for part in parts]
    return _limits(np.concatenate(points), np.concatenate(values), name)


def _limits(points: Floats, values: Floats, name: str) -> tuple[float, float]:
    size = float(np.ptp(points, axis=0).max())
    return robust_limits(values, (2 / size) ** MAPS[name].power)


def _net(net: Floats, patches: Patches) -> list[Stroke]:
    """Legs and vertices; legs go round where one closed patch does."""
    round_u, round_v = patches.closed if isinstance(patches, Patch) else (False, False)
    along_u = np.concatenate([net, net[:1]]) if round_u else net
    along_v = np.concatenate([net, net[:, :1]], axis=1) if round_v else net
    legs = np.concatenate([pieces(along_v), pieces(along_u.swapaxes(0, 1))])
    return [Stroke(legs, NET, NET_WIDTH, HIDDEN), *dots(net.reshape(-1, 3), NET, DOT, HIDDEN)]


def _polyline(curve: SpaceCurve | ArrayLike, letters: Mapping[Any, float] | None) -> Floats:
    if not isinstance(curve, SpaceCurve):
        return _checked(curve, 2, "a curve")
    known = {name: value for name, value in (letters or {}).items() if str(name) in curve.letters}
    return _checked(curve(np.linspace(*curve.domain, SAMPLES), letters=known), 2, "a curve")


def _checked(given: ArrayLike, dimension: int | None, name: str) -> Floats:
    """Points in space as an array of so many axes."""
    array = np.asarray(given, np.float64)
    if array.ndim < 1 or array.shape[-1] != 3 or (dimension is not None and array.ndim != dimension):
        shape = {2: "(n, 3)", 3: "(r, s, 3)", None: "(..., 3)"}[dimension]
        raise RsymError(f"{name} is an array of the shape {shape}, got {array.shape}", code="array")
    if not np.isfinite(array).all():
        raise RsymError(f"{name} must be finite", code="array")
    return array


def compare_patches(
    surfaces: Mapping[str, Patches],
    *,
    colour_by: str | Sequence[str] = ("mean_curvature", "zebra"),
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
    colour_by : str or sequence of str
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
    maps = (colour_by,) if isinstance(colour_by, str) else tuple(colour_by)
    gallery = Gallery(figure, len(maps), len(surfaces))
    for name, row in zip(maps, gallery.axes, strict=True):
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
