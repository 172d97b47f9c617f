"""The boundary coloured by what is proved of it, over the boxes of the proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.model.shape import Shape
from rsym.sampling.contours import level_lines
from rsym.verify.answers.report import Cover, SmoothnessReport
from rsym.verify.revolution import meridian


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
CHUNK = 1 << 19  # pairs of points and boxes at a time; their distances take 25 MB
NEAR = 0.01  # of the extent


@dataclass(frozen=True)
class JudgedShape:
    """The plane shape that a report is about, at which letters, and in which bounds.

    For a body of revolution it is the meridian, in (axis, radius), and the bounds hold its mirror image too.
    """

    shape: Shape
    letters: Mapping[str, float]
    bounds: tuple[tuple[float, float], ...]
    body: bool

    def lines(self, bounds: Sequence[Sequence[float]], resolution: int) -> list[Floats]:
        """The boundary in a window, as polylines (n, 2)."""
        return list(level_lines(self.shape, resolution=resolution, bounds=tuple(bounds), letters=self.letters))


def subject(report: SmoothnessReport, shape: Shape) -> JudgedShape:
    """What a report is about; letters that were intervals are taken in their middle."""
    letters = {name: (low + high) / 2 for name, (low, high) in report.letters.items() if name in shape.letters}
    along, across = report.cover.bounds[:2]
    if not report.body:
        return JudgedShape(shape, letters, (along, across), False)
    reach = max(map(abs, across))
    return JudgedShape(meridian(shape)[0], letters, (along, (-reach, reach)), True)


def certificates_of(points: Floats, cover: Cover, *, body: bool = False) -> NDArray[np.str_]:
    """What is proved at points (n, 2) of the boundary: a name among `CERTIFICATES` for each, empty outside all boxes.

    The boundary lies in the boxes, its polyline only nearly so: a point that misses them belongs to the nearest.
    What holds on one side of the axis of a body of revolution holds on the other.

    Examples
    --------
    >>> box, none = np.array([[[0.0, 1.0], [0.0, 1.0]]]), np.empty((0, 2, 2))
    >>> cover = Cover(((-2, 2), (0, 2)), box, none, none, 1)
    >>> certificates_of(np.array([[0.5, 1.01], [0.5, -0.5]]), cover).tolist()
    ['certified', '']
    >>> certificates_of(np.array([[0.5, 1.01], [0.5, -0.5]]), cover, body=True).tolist()
    ['certified', 'certified']
    """
    names = np.full(len(points), "", "U9")
    nearest = np.full(len(points), NEAR * float(np.diff(cover.bounds, axis=1).max()))
    for name in ("undecided", "joined", "certified"):
        distance = _distances(points, both_sides(getattr(cover, name), body=body))
        names[distance < nearest] = name
        nearest = np.minimum(nearest, distance)
    return names


def both_sides(boxes: Floats, *, body: bool) -> Floats:
    """Boxes in the plane, for a body of revolution with their mirror images in the axis."""
    flat = boxes[:, :2]
    if not body:
        return flat
    mirrored = flat.copy()
    mirrored[:, 1] = -flat[:, 1, ::-1]
    return np.concatenate([flat, mirrored])


def _distances(points: Floats, boxes: Floats) -> Floats:
    """From each point to the nearest box, along the axis where it is farther."""
    found = np.full(len(points), np.inf)
    step = max(1, CHUNK // max(1, len(points)))
    for start in range(0, len(boxes), step):
        low, high = np.moveaxis(boxes[start : start + step, None], 3, 0)
        outside = np.maximum(low - points, points - high).max(axis=2)
        found = np.minimum(found, np.maximum(outside, 0.0).min(axis=0))
    return found


def draw_boundary(
    ax: Axes, lines: Sequence[Floats], report: SmoothnessReport, *, origin: Sequence[float] = (0.0, 0.0)
) -> list[LineCollection]:
    """Polylines (n, 2) as strokes, each run of one certificate a stroke; coordinates are drawn from `origin`."""
    strokes: dict[str, list[Floats]] = {name: [] for name in CERTIFICATES}
    for line in lines:
        names = certificates_of((line[1:] + line[:-1]) / 2, report.cover, body=report.body)
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


def draw_cover(ax: Axes, report: SmoothnessReport) -> PolyCollection:
    """The boxes that meet the boundary, faint; a box in which nothing is proved is no fainter than the others."""
    corners, colours = [np.empty((0, 4, 2))], []
    for name in ("certified", "joined", "undecided"):
        boxes = both_sides(getattr(report.cover, name), body=report.body)
        (left, low), (right, high) = boxes[..., 0].T, boxes[..., 1].T
        corners.append(np.stack([left, low, right, low, right, high, left, high], axis=1).reshape(-1, 4, 2))
        colours += [CERTIFICATES[name].colour] * len(boxes)
    artist = PolyCollection(
        list(np.concatenate(corners)), facecolors=colours, edgecolors=colours, linewidths=0.3, alpha=0.16
    )
    artist.set_zorder(1)
    ax.add_collection(artist, autolim=False)
    return artist
