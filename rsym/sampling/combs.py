"""Curvature along level lines, at places evenly spaced by arc length."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats
from rsym.backends.kernel import Kernel, compile
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.sampling.contours import move_onto_level
from rsym.sampling.level_lines import trace
from rsym.sampling.plane import PlaneSampler, plane_sampler, plane_section

FEWEST_TEETH = 12  # on a line, however short
# Between neighbours the normal turns by the curvature times the distance; on a circle exactly so. What differs by more
# than this (3 degrees) is halved, and after so many halvings, at a thousandth of a tooth's distance, it is a jump.
UNEXPLAINED_TURN = 0.05
# Also halved: a turn larger than this (6 degrees), and a change of the curvature larger than this share of it or, where
# the line is nearly straight, of the curvature of a circle as long as the line. An envelope looks smooth then.
LARGEST_TURN = 0.1
LARGEST_CHANGE = 0.1
WITHIN = 0.381966  # of its longest chord a closed line begins here
HALVINGS = 10
# Farther from the level, in cells, the curvature would be that of another line.
ON_LEVEL = 1e-6


@dataclass(frozen=True)
class Comb:
    """Points (n, 2) along one level line with outward unit normals (n, 2) and curvatures (n,), NaN where undefined.

    `teeth` (n,) marks the evenly spaced points; those between them resolve what is finer than their distance.
    `breaks` (n - 1,) marks the steps in which the normal jumps, as at a corner, or is undefined.
    A closed line repeats its first point.
    """

    points: Floats
    normals: Floats
    curvature: Floats
    teeth: Flags
    breaks: Flags


def combs(
    shape: Shape,
    level: float = 0.0,
    *,
    teeth: int = 300,
    resolution: int | Sequence[int] = 512,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    section: Mapping[Any, float] | None = None,
) -> list[Comb]:
    """The curvature along the lines omega = level, exact at every point and evenly spaced by arc length.

    Parameters
    ----------
    shape : Shape
        A shape in the plane, or one in space with ``section={z: 1.0}``; the curvature is then that of the plane line.
    teeth : int
        Places on all lines together; each line has twelve at least.
    resolution, bounds, letters
        As for `level_lines`.

    Raises
    ------
    RsymError
        As `level_lines`, and for a level that the shape does not reach.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(4 - x**2 - y**2, (x, y), bounds=((-3, 3), (-3, 3)))
    >>> (comb,) = combs(disc, teeth=20, resolution=64)
    >>> int(comb.teeth.sum()), comb.curvature.round(12).min(), comb.curvature.round(12).max()
    (21, np.float64(0.5), np.float64(0.5))
    """
    if isinstance(teeth, bool) or not isinstance(teeth, int) or teeth < 1:
        raise RsymError(f"teeth must be a positive integer, got {teeth!r}", code="teeth")
    flat, box = plane_section(shape, section, bounds)
    sampler = plane_sampler(flat, "value", resolution=resolution, bounds=box, letters=letters)
    lines = trace(sampler, level)
    if not len(lines):
        raise RsymError(
            f"omega = {level:g} has no line in the bounds",
            code="no-line",
            remedy="choose another level or wider bounds",
        )
    bearings = _Bearings(sampler, compile(flat, ("value", "gradient", "curvature")), level)
    spacing = sum(float(_lengths(line).sum()) for line in lines) / teeth
    # The outside to the left, where the teeth point: the upper side of a body then runs along the first axis.
    return [_comb(line[::-1], spacing, bearings) for line in lines]


@dataclass(frozen=True)
class _Bearings:
    """Moves points onto the level and tells normals and curvatures there."""

    sampler: PlaneSampler
    kernel: Kernel
    level: float

    def at(self, points: Floats, teeth: Flags) -> Comb:
        points, _ = move_onto_level(self.sampler, points, self.level)
        fields = self.kernel(*points.T, letters=self.sampler.letters)
        with np.errstate(all="ignore"):
            slope = np.hypot(*fields["gradient"].T)
            off = np.abs(fields["value"] - self.level) / slope
            good = (off <= ON_LEVEL * min(self.sampler.lattice.spacing)) & np.isfinite(fields["curvature"])
            normals = np.where(good[:, None], -fields["gradient"] / slope[:, None], np.nan)
        curvature = np.where(good, fields["curvature"], np.nan)
        breaks = ~(_unexplained_turns(points, normals, curvature) <= UNEXPLAINED_TURN)
        return Comb(points, normals, curvature, teeth, breaks)


def _comb(line: Floats, spacing: float, bearings: _Bearings) -> Comb:
    """One line: evenly spaced points, and halves of the steps that need them."""
    if (line[0] == line[-1]).all():  # a corner is no place for a tooth, nor what halves lead to from a middle
        longest = int(_lengths(line).argmax())
        start = line[longest : longest + 1] + WITHIN * np.diff(line[longest : longest + 2], axis=0)
        line = np.concatenate([start, line[longest + 1 : -1], line[: longest + 1], start])
    lengths = np.append(0.0, np.cumsum(_lengths(line)))
    count = max(round(lengths[-1] / spacing), FEWEST_TEETH)
    places = np.linspace(0.0, lengths[-1], count + 1)
    points = np.stack([np.interp(places, lengths, line[:, k]) for k in (0, 1)], axis=1)
    comb = bearings.at(points, np.ones(count + 1, bool))
    for _ in range(HALVINGS):
        (coarse,) = np.nonzero(comb.breaks | _large_steps(comb, 2 * np.pi / lengths[-1]))
        if not coarse.size:
            break
        middles = (comb.points[coarse] + comb.points[coarse + 1]) / 2
        points, teeth = np.insert(comb.points, coarse + 1, middles, axis=0), np.insert(comb.teeth, coarse + 1, False)
        comb = bearings.at(points, teeth)
    return comb


def _lengths(line: Floats) -> Floats:
    lengths: Floats = np.hypot(*np.diff(line, axis=0).T)
    return lengths


def _unexplained_turns(points: Floats, normals: Floats, curvature: Floats) -> Floats:
    """How far the change of the normal is from the curvature times the step; NaN where undefined."""
    mean = (curvature[1:] + curvature[:-1]) / 2
    turns: Floats = np.hypot(*(np.diff(normals, axis=0) - mean[:, None] * np.diff(points, axis=0)).T)
    return turns


def _large_steps(comb: Comb, least: float) -> Flags:
    """The steps in which normal or curvature change much."""
    sizes = np.maximum(np.abs(comb.curvature), least)
    changes = np.abs(np.diff(comb.curvature)) > LARGEST_CHANGE * np.maximum(sizes[1:], sizes[:-1])
    turns = np.hypot(*np.diff(comb.normals, axis=0).T) > LARGEST_TURN
    return np.asarray(changes | turns)
