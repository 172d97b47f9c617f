"""The boundary coloured by what is proved of it, over the boxes of the proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from numpy.typing import NDArray

from rsym.codegen.kernel import compile
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.sampling.contours import level_lines
from rsym.verify.report import Cover, SmoothnessReport

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Certificate:
    """How a part of the boundary is drawn: told apart by colour-blind eyes, and by width and dashes in grey."""

    label: str
    colour: str
    width: float
    dashes: Any


# Okabe and Ito's colours.
CERTIFICATES: Mapping[str, Certificate] = {
    "certified": Certificate("regular, proved", "#0072b2", 1.8, "solid"),
    "joined": Certificate("two arcs meet, proved", "#009e73", 3.0, "solid"),
    "undecided": Certificate("undecided", "#e69f00", 3.0, (0, (1.6, 0.8))),
    "": Certificate("not examined", "0.55", 1.2, "dotted"),
}
DEFECT = "#d55e00"
SYMMETRY_POINTS = 64
CHUNK = 1 << 22  # comparisons of points with boxes at a time; 32 MB of booleans at most


@dataclass(frozen=True)
class MeridianPlane:
    """Where the boundary of a report lies: a shape, its letters, and the section if the shape is in space.

    `free` are the positions of the two coordinates of the plane, `axis` that of the axis of revolution among them,
    None for a plane shape; `bounds` hold both sides of the axis.
    """

    shape: Shape
    letters: Mapping[str, float]
    section: Mapping[str, float] | None
    free: tuple[int, int]
    axis: int | None
    bounds: tuple[tuple[float, float], ...]

    @property
    def names(self) -> tuple[str, str]:
        """The names of the two coordinates."""
        return self.shape.coordinates[self.free[0]].name, self.shape.coordinates[self.free[1]].name

    def lines(self, bounds: Sequence[Sequence[float]], resolution: int) -> list[Floats]:
        """The boundary in a window, as polylines (n, 2)."""
        found = level_lines(
            self.shape, resolution=resolution, bounds=tuple(bounds), letters=self.letters, section=self.section
        )
        return list(found)


def meridian_plane(shape: Shape, report: SmoothnessReport) -> MeridianPlane:
    """The plane of a report; letters that were intervals are taken in their middle."""
    letters = {name: (low + high) / 2 for name, (low, high) in report.letters.items() if name in shape.letters}
    bounds = tuple(report.cover.bounds[:2])
    if shape.dimension == 2:
        return MeridianPlane(shape, letters, None, (0, 1), None, bounds)
    turned = axis_of_revolution(shape, letters)
    across, fixed = (k for k in range(3) if k != turned)
    free = (min(turned, across), max(turned, across))
    axis = free.index(turned)
    reach = max(map(abs, bounds[1 - axis]))
    bounds = tuple(bounds[k] if k == axis else (-reach, reach) for k in (0, 1))
    return MeridianPlane(shape, letters, {shape.coordinates[fixed].name: 0.0}, free, axis, bounds)


def axis_of_revolution(shape: Shape, letters: Mapping[str, float]) -> int:
    """Which coordinate a body turns about: omega keeps its value when the other two turn.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> profile = rsym.Shape(4 - x**2 - (y - 3)**2, (x, y), bounds=((-3, 3), (-6, 6)))
    >>> axis_of_revolution(rsym.revolve(profile, axis=x), {}), axis_of_revolution(rsym.revolve(profile, axis=y), {})
    (0, 1)
    """
    kernel = compile(shape)
    ends = np.array(shape.bounds or ((-1.0, 1.0),) * 3)
    along = np.linspace(ends.min(), ends.max(), SYMMETRY_POINTS)
    radius, angle = np.abs(along[::-1]) * 0.7 + 0.1, 7.0 * along
    spread = np.empty(3)
    for axis in range(3):
        turned = [
            kernel(*np.insert([radius * np.cos(a), radius * np.sin(a)], axis, along, axis=0), letters=letters)["value"]
            for a in (angle, angle + 1.0)
        ]
        spread[axis] = np.abs(turned[0] - turned[1]).max() / (np.abs(turned[0]).max() or 1.0)
    if not spread.min() < 1e-9:
        raise RsymError("expected a body of revolution about a coordinate", code="revolution", remedy="rsym.revolve")
    return int(spread.argmin())


def certificates_of(points: Floats, cover: Cover, axis: int | None = None) -> NDArray[np.str_]:
    """What is proved at points (n, 2): a name among `CERTIFICATES` for each, empty outside all boxes.

    With the axis of a body of revolution, what holds on one side of it holds on the other.

    Examples
    --------
    >>> box, none = np.array([[[0.0, 1.0], [0.0, 1.0]]]), np.empty((0, 2, 2))
    >>> cover = Cover(((-2, 2), (0, 2)), box, none, none, 1)
    >>> certificates_of(np.array([[0.5, 0.5], [0.5, -0.5]]), cover).tolist()
    ['certified', '']
    >>> certificates_of(np.array([[0.5, 0.5], [0.5, -0.5]]), cover, axis=0).tolist()
    ['certified', 'certified']
    """
    names = np.full(len(points), "", "U9")
    for name in ("certified", "joined", "undecided"):
        boxes = getattr(cover, name)
        names[_inside(points, both_sides(boxes, cover, axis))] = name
    return names


def both_sides(boxes: Floats, cover: Cover, axis: int | None) -> Floats:
    """Boxes in the plane, and their mirror images where the cover has one side of an axis of revolution only."""
    flat = boxes[:, :2]
    if axis is None or cover.bounds[1 - axis][0] < 0 or not len(flat):
        return flat
    mirrored = flat.copy()
    mirrored[:, 1 - axis] = -flat[:, 1 - axis, ::-1]
    return np.concatenate([flat, mirrored])


def _inside(points: Floats, boxes: Floats) -> NDArray[np.bool_]:
    found = np.zeros(len(points), bool)
    step = max(1, CHUNK // max(1, len(points)))
    for start in range(0, len(boxes), step):
        some = boxes[start : start + step, None]
        low, high = some[..., 0], some[..., 1]
        found |= ((points >= low) & (points <= high)).all(axis=2).any(axis=0)
    return found


def draw_boundary(
    ax: Axes, lines: Sequence[Floats], cover: Cover, *, axis: int | None = None, origin: Sequence[float] = (0.0, 0.0)
) -> list[LineCollection]:
    """Polylines (n, 2) as strokes, each run of one certificate a stroke; coordinates are drawn from `origin`."""
    strokes: dict[str, list[Floats]] = {name: [] for name in CERTIFICATES}
    for line in lines:
        names = certificates_of((line[1:] + line[:-1]) / 2, cover, axis)
        cuts = np.flatnonzero(names[1:] != names[:-1]) + 1
        for start, stop in zip([0, *cuts], [*cuts, len(names)], strict=True):
            strokes[str(names[start])].append(line[start : stop + 1] - np.asarray(origin))
    artists = []
    for name, look in CERTIFICATES.items():
        if strokes[name]:
            artist = LineCollection(
                strokes[name], colors=look.colour, linewidths=look.width, linestyles=look.dashes, label=look.label
            )
            artist.set(zorder=3, capstyle="butt")
            ax.add_collection(artist, autolim=True)
            artists.append(artist)
    return artists


def draw_cover(ax: Axes, cover: Cover, *, axis: int | None = None) -> PolyCollection:
    """The boxes that meet the boundary, faint; a box in which nothing is proved is no fainter than the others."""
    corners, colours = [np.empty((0, 4, 2))], []
    for name in ("certified", "joined", "undecided"):
        boxes = both_sides(getattr(cover, name), cover, axis)
        (left, low), (right, high) = boxes[..., 0].T, boxes[..., 1].T
        corners.append(np.stack([left, low, right, low, right, high, left, high], axis=1).reshape(-1, 4, 2))
        colours += [CERTIFICATES[name].colour] * len(boxes)
    artist = PolyCollection(
        list(np.concatenate(corners)), facecolors=colours, edgecolors=colours, linewidths=0.3, alpha=0.16
    )
    artist.set_zorder(1)
    ax.add_collection(artist, autolim=False)
    return artist
