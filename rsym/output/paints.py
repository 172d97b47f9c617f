"""What a surface is painted with: one colour, a map of values, or the stripes of a zebra."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from numpy.typing import ArrayLike

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.wording import proposal
from rsym.output.parts import face_colours, part_colours
from rsym.output.rasteriser import picked
from rsym.output.shading import INSIDE, Light, decode, linear, unit
from rsym.sampling.leaf_fields import LeafFields
from rsym.sampling.mesh import Mesh


class SurfaceMap(NamedTuple):
    """A map that a surface may be coloured by: the field of curvature that it is made of, its label, and how.

    power: of the length whose inverse it is. of: what becomes of the field, whose components are its last axis.
    """

    field: str
    label: str
    power: int = 1
    of: Callable[[Floats], Floats] = np.asarray


# A map is a row: `plot_mesh`, `plot_patches`, their docstrings and refusals and the explorer of patches read it.
MAPS: Mapping[str, SurfaceMap] = MappingProxyType(
    {
        "mean_curvature": SurfaceMap("mean_curvature", "mean curvature $H$"),
        "gaussian_curvature": SurfaceMap("gaussian_curvature", "Gaussian curvature $K$", power=2),
        "k1": SurfaceMap("principal_curvatures", "larger principal curvature $k_1$", of=lambda k: k[..., 0]),
        "k2": SurfaceMap("principal_curvatures", "smaller principal curvature $k_2$", of=lambda k: k[..., 1]),
    }
)
NAMES_OF_MAPS = ", ".join(f"``{name}``" for name in MAPS)  # for docstrings
# Curvatures are unbounded near edges; the colours span what lies between these shares of the vertices.
ROBUST_RANGE = (0.02, 0.98)
# Less than this share of the other values, or of the curvature of a ball as large as the body, is rounding.
NOTHING = 1e-9
UNDEFINED = "#9a9a9a"
# Of a colour bar, by whether values lie below and above it.
EXTENSIONS = {(False, False): "neither", (False, True): "max", (True, False): "min", (True, True): "both"}
STRIPES = 9  # pairs of bands between straight down and straight up
ROOM = 1.5  # radius of the room that is mirrored, of that of the body
DARK, LIGHT = "#1c1c1c", "#f7f7f7"


@dataclass(frozen=True)
class Spots:
    """Samples of a picture of a mesh: faces (n,), weights of their corners (n, 3), side seen (n,), the camera's turn.

    `shifted(rows, columns)` gives the weights so many samples further.
    """

    faces: Ints
    weights: Floats
    shifted: Callable[[int, int], Floats]
    side: Ints
    turn: Floats

    def mean(self, corners: Floats, weights: Floats) -> Floats:
        """What lies between vectors at the corners of faces (m, 3, 3), for the weights (n, 3) of the corners."""
        first, second, third = (
            weight * picked(corner, self.faces).T
            for weight, corner in zip(weights.T, np.moveaxis(corners, 1, 0), strict=True)
        )
        between: Floats = (first + second + third).T
        return between


Paint: TypeAlias = Callable[[Spots], Floats]  # linear colours (n, 3)


@dataclass(frozen=True)
class Coat:
    """A paint and what it means: of values the scale of its colours and their name, of parts the colour of each."""

    paint: Paint
    scale: ScalarMappable | None = None
    label: str = ""
    parts: Mapping[str, str] = field(default_factory=dict)


def coat_of(
    mesh: Mesh,
    normals: Floats,
    colour: str,
    colour_by: str | ArrayLike | None,
    shape: Shape | None,
    letters: Mapping[Any, float] | None,
    limits: tuple[float, float] | None = None,
    colour_map: str | None = None,
) -> Coat:
    """The paint of a mesh with the corner normals (m, 3, 3), as `plot_mesh` describes it."""
    if colour_by is None:
        return one_colour(colour)
    if not isinstance(colour_by, str):
        given = _at_corners(mesh, colour_by)
        return value_coat(between_corners(given), given, "", 0.0, limits, _areas(mesh), colour_map)
    if colour_by == "zebra":
        return Coat(zebra(mesh, normals, shape, letters))
    if colour_by == "part":
        return part_coat(mesh)
    if colour_by not in MAPS:
        names = ", ".join((*MAPS, "zebra", "part"))
        raise RsymError(f"no map {colour_by!r}", code="colour-by", remedy=f"choose from {names}, or give an array")
    field, label, power, of = MAPS[colour_by]
    unit = (2 / float(np.ptp(mesh.vertices, axis=0).max())) ** power
    if shape is None:
        if mesh.curvatures is None:
            raise RsymError(f"a map of {colour_by} needs the equation", code="colour-by", remedy="give shape=")
        at_corners = of(mesh.curvatures(field))
        return value_coat(between_corners(at_corners), at_corners, label, unit, limits, _areas(mesh), colour_map)
    on_faces = LeafFields(shape, (field,), letters).on_faces(mesh)

    def values(spots: Spots) -> Floats:
        return of(on_faces(spots.faces, spots.weights)[field])

    middles = of(on_faces(np.arange(len(mesh.faces)), np.full(mesh.faces.shape, 1 / 3))[field])
    return value_coat(values, middles, label, unit, limits, _areas(mesh), colour_map)


def one_colour(colour: str, inside: str = INSIDE) -> Coat:
    """The colour of a body outside, and of its surface seen from inside."""
    colours = np.stack([linear(inside), linear(colour)])
    return Coat(lambda spots: picked(colours, (spots.side > 0).astype(int)))


def part_coat(mesh: Mesh, inside: str | None = INSIDE) -> Coat:
    """A colour for each part; from inside another one, or none other."""
    colours, parts = face_colours(mesh), part_colours(mesh)
    if inside is None:
        return Coat(lambda spots: colours[spots.faces], parts=parts)
    other = linear(inside)
    return Coat(lambda spots: np.where(spots.side[:, None] > 0, colours[spots.faces], other), parts=parts)


def value_coat(
    between: Callable[[Spots], Floats],
    values: Floats,
    label: str,
    unit: float = 0.0,
    limits: tuple[float, float] | None = None,
    shares: Floats | None = None,
    colour_map: str | None = None,
) -> Coat:
    """Colours between limits, of two sides if those are about zero; without them values, unit and shares choose."""
    colours = ValueColours.of(values, label, unit, limits, shares, colour_map)
    return Coat(lambda spots: colours(between(spots)), colours.scale, colours.label)


def beyond(values: Floats, low: float, high: float, share: float = NOTHING) -> str:
    """At which ends of its colours a bar has an arrow: where values lie beyond them, by more than a share of both.

    Examples
    --------
    >>> beyond(np.array([-1e-17, 0.5, np.nan]), 0.0, 1.0), beyond(np.array([0.5, 2.0]), 0.0, 1.0)
    ('neither', 'max')
    """
    room = share * high - share * low
    return EXTENSIONS[bool((values < low - room).any()), bool((values > high + room).any())]


@dataclass(frozen=True)
class ValueColours:
    """The colours of values: a scale for a colour bar, its name, and 256 linear colours from its low to its high end.

    Examples
    --------
    >>> colours = ValueColours.of(np.array([-1.0, 1.0]), "height", limits=(-1, 1))
    >>> colours.scale.get_cmap().name, colours(np.array([np.nan])).round(2).tolist()
    ('coolwarm', [[0.32, 0.32, 0.32]])
    """

    scale: ScalarMappable
    label: str
    table: Floats = field(repr=False)

    @classmethod
    def of(
        cls,
        values: Floats,
        label: str,
        unit: float = 0.0,
        limits: tuple[float, float] | None = None,
        shares: Floats | None = None,
        colour_map: str | None = None,
    ) -> ValueColours:
        """Those between limits; without them the values, `unit` and the shares of the surface choose."""
        low, high = checked_limits(limits) if limits is not None else robust_limits(values, unit, shares)
        colours = colormaps[checked_map(colour_map) or ("coolwarm" if low == -high else "viridis")].copy()
        colours.colorbar_extend = beyond(values, low, high)  # type: ignore[assignment]
        table = decode(colours(np.linspace(0.0, 1.0, 256))[:, :3])
        scale = ScalarMappable(Normalize(low, high), colours)
        return cls(scale, label + _everywhere(values, unit) if label else "", table)

    def __call__(self, values: Floats) -> Floats:
        """The linear colours (n, 3) of values (n,), those that are NaN grey."""
        low, high = self.scale.get_clim()
        assert low is not None
        assert high is not None
        share = np.clip((values - low) / (high - low), 0.0, 1.0)
        index = np.nan_to_num(share * 255).round().astype(np.int64)
        return np.where(np.isnan(share)[:, None], linear(UNDEFINED), self.table[index])


def _everywhere(values: Floats, unit: float) -> str:
    """That values are one and the same, as those of planes and cylinders are: then one colour is all there is to see.

    Examples
    --------
    >>> _everywhere(np.array([0.0, 1e-12, np.nan]), 1.0), _everywhere(np.array([2.0, 2.0]), 0.0)
    (', 0 everywhere', ', 2 everywhere')
    >>> _everywhere(np.array([0.0, 0.1]), 1.0)
    ''
    """
    known = values[np.isfinite(values)]
    size = max(float(np.abs(known).max(initial=0.0)), unit)
    if not known.size or np.ptp(known) > NOTHING * size:
        return ""
    middle = float(np.median(known))
    return f", {0.0 if abs(middle) <= NOTHING * size else middle:.4g} everywhere"


def checked_map(name: Any) -> str | None:
    """The name of a colour map that somebody gave, if it is one."""
    if name is not None and not (isinstance(name, str) and name in colormaps):
        remedy = proposal(name, list(colormaps), "take the name of one that matplotlib knows")
        raise RsymError(f"no colour map {name!r}", code="colour-map", remedy=remedy)
    return name


def checked_limits(limits: Any) -> tuple[float, float]:
    """The ends of a scale of colours that somebody gave."""
    try:
        low, high = (float(limit) for limit in limits)
    except (TypeError, ValueError):
        low, high = np.nan, np.nan
    if not (np.isfinite([low, high]).all() and low < high):
        raise RsymError(
            f"limits of a scale are two numbers, the smaller first, got {limits!r}",
            code="limits",
            remedy="limits=(-1, 1), or leave it out",
        )
    return low, high


def robust_limits(values: Floats, unit: float = 0.0, shares: Floats | None = None) -> tuple[float, float]:
    """Limits of a colour scale: quantiles of the finite values, symmetric if those have both signs.

    Each value counts as its share, that of the surface it stands for. What is tiny against the other values or against
    `unit` counts as 0.

    Examples
    --------
    >>> low, high = robust_limits(np.append(np.linspace(-0.5, 2, 1001), 1e9))
    >>> low == -high, round(high, 2)
    (True, 1.95)
    """
    known = np.isfinite(values)
    if not known.any():
        raise RsymError("the values are undefined everywhere", code="undefined")
    weights = None if shares is None else np.broadcast_to(shares.reshape(-1, *[1] * (values.ndim - 1)), values.shape)
    low, high = _quantiles(values[known], None if weights is None else weights[known])
    nothing = NOTHING * max(-low, high, unit)
    low, high = (0.0 if abs(limit) <= nothing else float(limit) for limit in (low, high))
    if low < 0 < high:
        return min(low, -high), max(-low, high)
    if high - low <= nothing:
        margin = abs(high) / 2 or unit or 1.0
        return low - margin, high + margin
    return low, high


def _quantiles(values: Floats, weights: Floats | None) -> Floats:
    if weights is None or not weights.any():
        return np.asarray(np.quantile(values, ROBUST_RANGE))
    return np.asarray(np.quantile(values, ROBUST_RANGE, weights=weights, method="inverted_cdf"))


def _areas(mesh: Mesh) -> Floats:
    """The areas of the faces."""
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    across = np.cross(b - a, c - a)
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", across, across)) / 2)


def _at_corners(mesh: Mesh, values: ArrayLike) -> Floats:
    """The values of vertices, or of face corners, as values of face corners (m, 3)."""
    array = np.asarray(values, np.float64)
    if array.shape == (len(mesh.vertices),):
        array = array[mesh.faces]
    if array.shape != mesh.faces.shape:
        raise RsymError(
            f"expected one value for each of the {len(mesh.vertices)} vertices or {mesh.faces.shape} corners of faces, "
            f"got the shape {array.shape}",
            code="colour-by",
        )
    return array


def between_corners(values: Floats) -> Callable[[Spots], Floats]:
    """Values inside faces from those of their corners (m, 3); NaN is left out of the mean."""

    def between(spots: Spots) -> Floats:
        corners = values[spots.faces]
        weights = np.where(np.isfinite(corners), spots.weights, 0.0)
        with np.errstate(all="ignore"):
            mean: Floats = (weights * np.nan_to_num(corners)).sum(axis=1) / weights.sum(axis=1)
        return mean

    return between


def zebra(mesh: Mesh, normals: Floats, shape: Shape | None = None, letters: Mapping[Any, float] | None = None) -> Paint:
    """The reflection of a room with level stripes: a jump of the curvature kinks them, an edge breaks them.

    The room is a sphere round the body, not much larger: in one far away a plane would mirror a single place, and
    would have one colour.
    """
    on_faces = None if shape is None else LeafFields(shape, (), letters).on_faces(mesh)
    at = in_room(mesh.vertices, mesh.vertices.min(axis=0), mesh.vertices.max(axis=0))[mesh.faces]

    def paint(spots: Spots) -> Floats:
        here, right, above = (
            reflected_heights(spots.mean(normals, weights), spots.mean(at, weights), spots.turn)
            for weights in (spots.weights, spots.shifted(0, 1), spots.shifted(1, 0))
        )
        width = np.abs(right - here) + np.abs(above - here)
        if on_faces is not None:
            exact = -on_faces(spots.faces, spots.weights)["gradient"]
            true = reflected_heights(exact, spots.mean(at, spots.weights), spots.turn)
            here = np.where(np.isfinite(true), true, here)
        return zebra_colours(here, width)

    return paint


def zebra_colours(heights: Light, widths: Light) -> Floats:
    """The linear colours (n, 3) of reflected heights (n,), each the mean over a window of its width."""
    dark, light = linear(DARK), linear(LIGHT)
    return np.asarray(dark + (light - dark) * stripes(STRIPES * heights, STRIPES * widths)[:, None])


def in_room(points: Floats, low: Floats, high: Floats) -> Floats:
    """Points about the middle of the body between two corners, the room that its zebra mirrors having the radius 1."""
    size: float = ROOM * max(float(np.linalg.norm(high - low)) / 2, 1e-300)
    return np.asarray((points - (low + high) / 2) / size)


def reflected_heights(normals: Floats, places: Floats, turn: Floats) -> Floats:
    """How high the line of sight meets a sphere round the body after its reflection, in right angles.

    For normals and places (n, 3) of the data, the sphere being that of radius 1 round 0. The eye is far away, at the
    camera's third axis. 1 is straight up along z of the data, -1 straight down.

    Examples
    --------
    >>> from_the_front = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    >>> normals, places = np.array([[0.0, -1.0, 0.0], [0.0, -1.0, 1.0], [0.0, -1.0, 0.0]]), np.zeros((3, 3))
    >>> places[2, 2] = 0.5
    >>> reflected_heights(normals, places, from_the_front).round(6)
    array([0.      , 1.      , 0.333333])
    """
    facing, here = unit(normals @ turn.T), places @ turn.T
    up = unit(turn[:, 2])
    towards = 2 * facing[:, 2:] * facing - np.array([0.0, 0.0, 1.0])
    along = np.einsum("ij,ij->i", here, towards)
    inside = np.maximum(1.0 - np.einsum("ij,ij->i", here, here), 0.0)
    heights = (here + (np.sqrt(along**2 + inside) - along)[:, None] * towards) @ up
    angles: Floats = np.arcsin(np.clip(heights, -1.0, 1.0)) / (np.pi / 2)
    return angles


def stripes(phase: Light, width: Light) -> Light:
    """The share of light in a window of some width over stripes of period 1, light in the first half.

    Examples
    --------
    >>> stripes(np.array([0.25, 0.75, 0.5, 3.3]), np.array([0.1, 0.1, 0.1, 2.0])).round(12)
    array([1. , 0. , 0.5, 0.5])
    """
    width = np.maximum(width, 1e-9)
    low, high = (np.floor(end) / 2 + np.minimum(end % 1.0, 0.5) for end in (phase - width / 2, phase + width / 2))
    return np.asarray((high - low) / width)
