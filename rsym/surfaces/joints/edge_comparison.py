"""How smoothly two patches pass into one another along a stretch: gaps, angles, jumps of curvature, and the worst."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats
from rsym.surfaces.forms import dot
from rsym.surfaces.joints.edge_matching import Stretch

# Samples lie at multiples of the golden ratio, modulo 1: no period of the surfaces, knots say, can hide between them.
# With Fibonacci numbers of samples the distances are almost equal; more are taken until the greatest values stay.
LEVELS = (34, 89, 233, 610)
GOLDEN = (5**0.5 - 1) / 2
# A greatest value that moves by less than this share of itself, or of what is tolerated, is found.
SETTLED, NEGLIGIBLE = 1e-3, 1e-2
PEAKS, INNER, ROUNDS = 3, 15, 3


@dataclass(frozen=True, eq=False)
class Comparison:
    """What was measured at parameters t of the first edge and s of the second, n of each.

    gaps are lengths, angles degrees, curvature_jumps one over length; what does not exist is NaN.
    """

    t: Floats
    s: Floats
    points: Floats
    gaps: Floats
    angles: Floats
    curvature_jumps: Floats
    curvatures: Floats

    @property
    def values(self) -> Floats:
        """Gaps, angles and jumps of curvature (3, n)."""
        return np.stack([self.gaps, self.angles, self.curvature_jumps])

    def __add__(self, other: Comparison) -> Comparison:
        """Both, in the order of t."""
        order = np.argsort(np.concatenate([self.t, other.t]), kind="stable")
        pairs = [(getattr(self, name), getattr(other, name)) for name in self.__dataclass_fields__]
        return Comparison(*(np.concatenate(pair)[order] for pair in pairs))


def compare(stretch: Stretch, t: Floats) -> Comparison:
    """Gap, kink and jump of curvature at parameters t of the first edge.

    The kink is the angle between the outer conormal of one patch and the inner one of the other: the angle between
    the normals, but 180 degrees where a surface turns back on itself. The curvatures are those across the edge, one
    transversal direction: surfaces with equal tangent planes along a curve have equal second forms there if they
    have equal normal curvatures in one direction other than the tangent's.

    Source of the criterion: Pegna and Wolter (1992), the linkage curve theorem.
    """
    first, second = (border.edge for border in stretch.borders)
    s = stretch.partner(t)
    points, others = first.position(t), second.position(s)
    (n1, out1, k1), (n2, out2, k2) = (
        edge.bend(at) for edge, at in zip((first, second), stretch.calm(t, s), strict=True)
    )
    tilt = np.degrees(np.arctan2(_length(np.cross(n1, n2)), np.abs(dot(n1, n2))))
    angles = np.where(dot(out1, out2) > 0, 180 - tilt, tilt)
    k2 = -k2 if flipped(stretch) else k2
    return Comparison(t, s, points, _length(points - others), angles, np.abs(k1 - k2), np.maximum(abs(k1), abs(k2)))


def flipped(stretch: Stretch) -> bool:
    """Whether the normals of the two patches point to different sides: both boundaries then run the same way."""
    first, second = (border.edge.anticlockwise for border in stretch.borders)
    return (first == second) != stretch.opposite


def golden_samples(count: int, low: float, high: float) -> Floats:
    """Sorted parameters, both ends among them; those for fewer are among those for more.

    Examples
    --------
    >>> golden_samples(4, 0.0, 1.0).round(3).tolist()
    [0.0, 0.236, 0.618, 1.0]
    """
    inner = np.mod(np.arange(1, count - 1) * GOLDEN, 1.0)
    return np.concatenate([[low], low + (high - low) * np.sort(inner), [high]])


@dataclass(frozen=True, eq=False)
class EdgeSurvey:
    """All that was measured, and how much the three greatest values moved when more was."""

    samples: Comparison
    errors: Floats

    @property
    def greatest(self) -> list[int]:
        """Where the gap, the angle and the jump are greatest; 0 where nothing is known."""
        return [int(np.argmax(row)) for row in _known(self.samples.values)]


def survey(stretch: Stretch, tolerances: Callable[[Comparison], Floats]) -> EdgeSurvey:
    """Measure along a stretch until the greatest values stay; they are looked for between the samples too."""
    low, high = stretch.interval
    found, before = compare(stretch, np.array([low, high])), np.full(3, np.inf)
    for count in LEVELS:
        new = np.setdiff1d(golden_samples(count, low, high), found.t)
        found = found + compare(stretch, new)
        tolerated = tolerances(found)
        if (_known(found.values).max(axis=1) > NEGLIGIBLE * tolerated).any():
            found = _climbed(stretch, found, tolerated)
        now = _known(found.values).max(axis=1)
        moved, before = np.abs(now - before), now
        if (moved <= np.maximum(SETTLED * now, NEGLIGIBLE * tolerated)).all():
            break
    return EdgeSurvey(found, moved)


def _climbed(stretch: Stretch, found: Comparison, tolerated: Floats) -> Comparison:
    """The samples, and those on the way to the greatest values: brackets round the best, divided again and again."""
    for _ in range(ROUNDS):
        values, last = _known(found.values), len(found.t) - 1
        worth = values[values.max(axis=1) > NEGLIGIBLE * tolerated]
        best = np.argsort(worth, axis=1)[:, -PEAKS:]
        peaks = np.unique(best)
        low, high = found.t[np.maximum(peaks - 1, 0)], found.t[np.minimum(peaks + 1, last)]
        shares = np.arange(1, INNER + 1) / (INNER + 1)
        new = np.setdiff1d(low[:, None] + (high - low)[:, None] * shares, found.t)
        found = found + compare(stretch, new)
    return found


def _known(values: Floats) -> Floats:
    return np.where(np.isfinite(values), values, -1.0)


def _length(vectors: Floats) -> Floats:
    return np.sqrt(dot(vectors, vectors))
