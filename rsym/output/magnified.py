"""A defect under the magnifying glass: the two arcs, their tangents, the turn or the circles of curvature."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc
from matplotlib.ticker import MaxNLocator

from rsym.arrays import Floats
from rsym.output.certificates import DEFECT, JudgedShape, draw_boundary
from rsym.reports.numbers import measured
from rsym.verify.answers.report import Joint, SmoothnessReport

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
