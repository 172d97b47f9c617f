"""The boundary coloured by what is proved of it, over the boxes of the proof; a defect under the magnifying glass."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Arc
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.model.shape import Shape
from rsym.reports.numbers import measured
from rsym.sampling.level_lines import level_lines
from rsym.verify.answers.report import Cover, Joint, SmoothnessReport
from rsym.verify.revolution import meridian

RESOLUTION = 240
# Shares of the half-width of a window: where an arc is read, and where the arc of the turn is drawn.
READ = (0.04, 0.25)
TURN = 0.45
LABELLED = 50.0  # degrees; in a smaller angle there is no room for a number, the caption has it
SAME_BRANCH = math.radians(8.0)
MAGNIFICATION = 40.0  # of what is sharp at any scale
# A jump of the curvature is seen where the circles of curvature part: a window of so many of the smaller radius.
SHOWN_RADII = 0.5
LEAST, MOST = 4.0, 400.0  # magnifications
APART = 0.7  # a window ends before the next defect, at this share of the way
DEFECT = "#d55e00"
CHUNK = 1 << 19  # pairs of points and boxes at a time; their distances take 25 MB
NEAR = 0.01  # of the extent


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


def draw_magnified(
    ax: Axes, report: SmoothnessReport, about: JudgedShape, joint: Joint, *, label: str, extent: float
) -> None:
    """A window about one defect with its labels; `extent` is the width of the picture that it magnifies."""
    size = window_size(report, joint, extent)
    draw_window(ax, report, about, joint, size)
    ax.set_title(f"{label}   {joint.kind}, {extent / 2 / size:.2g} ×", fontsize=9)
    u, v = (symbol.name for symbol in about.shape.coordinates)
    ax.set_xlabel(f"${u} - {u}_{{{label}}}$\n{caption(joint)}", fontsize=8)
    ax.set_ylabel(f"${v} - {v}_{{{label}}}$", fontsize=8)


def draw_window(ax: Axes, report: SmoothnessReport, about: JudgedShape, joint: Joint, size: float) -> None:
    """The arcs that meet in a defect, their turn or their circles of curvature; coordinates are counted from it."""
    window = [(middle - size, middle + size) for middle in joint.point]
    lines = about.lines(window, RESOLUTION)
    draw_boundary(ax, lines, report, origin=joint.point)
    branches = branches_at(lines, joint.point, size)
    if joint.kind == "curvature jump":
        for branch in branches:
            ax.plot(*branch.before(2 * size).T, color=DEFECT, linewidth=0.9, dashes=(4, 2), zorder=2)
    elif len(branches) == 2 and joint.tangent_jump > 0:
        _draw_turn(ax, branches, joint, size)
    ax.plot(0, 0, marker="o", markersize=4, color=DEFECT, zorder=4)
    ax.set(xlim=(-size, size), ylim=(-size, size), aspect="equal")
    for ticks in (ax.xaxis, ax.yaxis):
        ticks.set_major_locator(MaxNLocator(3, symmetric=True, prune="both"))
    ax.tick_params(labelsize=7)


def caption(joint: Joint) -> str:
    """What the window is about, in numbers, and whether they are proved.

    Examples
    --------
    >>> print(caption(Joint((0.0, 0.0), 0.0, "corner", "G0", tangent_jump=90.0, curvatures=(0.0, 1.5), proved=True)))
    turn 90°, proved
    curvatures 0 | 1.5
    """
    status = "proved" if joint.proved else "not proved"
    first = f"{joint.continuity}, {status}"
    if joint.kind in ("corner", "cusp") and joint.tangent_jump > 0:
        first = f"turn {measured(joint.tangent_jump, joint.tangent_jump_error)}°, {status}"
    elif joint.kind == "curvature jump":
        first = f"jump {measured(joint.curvature_jump, joint.curvature_jump_error)}, {status}"
    elif joint.kind == "node":
        first = f"{joint.branches} branches, {status}"
    known = all(map(math.isfinite, joint.curvatures))
    return f"{first}\ncurvatures {joint.curvatures[0]:.6g} | {joint.curvatures[1]:.6g}" if known else first


@dataclass(frozen=True)
class LeavingArc:
    """An arc that leaves a point: its direction in radians, and how fast it turns to the left."""

    direction: float
    bend: float

    def before(self, length: float) -> Floats:
        """The circle of curvature, carried on beyond the point by a length."""
        s = np.linspace(0.0, -length, 60)
        angle = self.direction + self.bend * s / 2
        chord = s * np.sinc(self.bend * s / (2 * np.pi))
        return np.stack([chord * np.cos(angle), chord * np.sin(angle)], axis=1)


def branches_at(lines: Sequence[Floats], point: Sequence[float], size: float) -> list[LeavingArc]:
    """The arcs that leave a point, read from polylines in a window of half-width `size` about it.

    Along an arc the direction of the chord grows as half its curvature times the distance, so a straight fit gives
    the tangent and the curvature at the point. They are for drawing; the verdict has better ones.

    Examples
    --------
    >>> t = np.linspace(-1, 1, 401)
    >>> first, second = branches_at([np.stack([t, np.abs(t)], axis=1)], (0.0, 0.0), 1.0)
    >>> round(math.degrees(first.direction)), round(math.degrees(second.direction)), abs(round(first.bend, 6))
    (135, 45, 0.0)
    """
    chords = np.concatenate([np.empty((0, 2)), *lines]) - np.asarray(point)
    distance = np.hypot(*chords.T)
    near = (distance > READ[0] * size) & (distance < READ[1] * size)
    angle, distance = np.arctan2(*chords[near].T[::-1]), distance[near]
    if not angle.size:
        return []
    order = np.argsort(angle)
    angle, distance = angle[order], distance[order]
    gaps = np.flatnonzero(np.diff(np.append(angle, angle[0] + 2 * np.pi)) > SAME_BRANCH)
    if not gaps.size:
        return []
    first = gaps[0] + 1
    angle, distance = np.append(angle[first:], angle[:first] + 2 * np.pi), np.roll(distance, -first)
    groups = np.split(np.arange(len(angle)), np.flatnonzero(np.diff(angle) > SAME_BRANCH) + 1)
    return [_fitted(angle[group], distance[group]) for group in groups if len(group) > 3]


def _fitted(angle: Floats, distance: Floats) -> LeavingArc:
    slope, direction = np.polyfit(distance, angle, 1)
    return LeavingArc(float(np.mod(direction + np.pi, 2 * np.pi) - np.pi), 2 * float(slope))


def window_size(report: SmoothnessReport, joint: Joint, extent: float) -> float:
    """Half the width of the window of a defect in a picture of some extent."""
    sharpest = max((abs(value) for value in joint.curvatures if math.isfinite(value)), default=0.0)
    jumps = joint.kind == "curvature jump" and sharpest > 0
    size = SHOWN_RADII / sharpest if jumps else extent / 2 / MAGNIFICATION
    others = [math.dist(other.point, joint.point) for other in report.defects if other.point != joint.point]
    size = min(size, *(APART * distance for distance in others), extent / 2 / LEAST)
    return max(size, extent / 2 / MOST)


def _draw_turn(ax: Axes, branches: Sequence[LeavingArc], joint: Joint, size: float) -> None:
    """The tangent of one arc carried on beyond the corner, and its angle with the other arc."""
    came = branches[0].direction + math.pi
    turn = math.remainder(branches[1].direction - came, 2 * math.pi)
    ends = ([0, 0.85 * size * math.cos(came)], [0, 0.85 * size * math.sin(came)])
    ax.plot(*ends, color=DEFECT, linewidth=0.9, dashes=(4, 2), zorder=4)
    start, stop = sorted((math.degrees(came), math.degrees(came + turn)))
    wide = 2 * TURN * size
    ax.add_patch(Arc((0, 0), wide, wide, theta1=start, theta2=stop, color=DEFECT, linewidth=1.0, zorder=4))
    if stop - start > LABELLED:
        reach = (TURN + 0.2) * size
        spot = (reach * math.cos(came + turn / 2), reach * math.sin(came + turn / 2))
        ax.text(*spot, f"{joint.tangent_jump:.1f}°", color=DEFECT, fontsize=9, ha="center", va="center", zorder=5)
