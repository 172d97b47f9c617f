"""Where two leaves that matter have a zero in common: boxes are divided until each holds none, or one that is proved.

For a pair (f, g) with Jacobian J over a box about m, C the inverse of J(m), Krawczyk's map

    m - C (f, g)(m) + (1 - C J) (box - m)

holds every common zero in the box; if it lies inside, there is exactly one. Leaves that touch have no such C: near the
contact f - c*g, c chosen so that its gradient vanishes in m, is of second order, and leaves some boxes on every level,
which are what is left in the end. Source: R. Krawczyk (1969); R. E. Moore (1977).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.problems.corners.leaf_boxes import LeafBoxes
from rsym.sampling.form_signs import Boxes, grid, halves, points

FIRST = 16  # boxes along a side
OVERLAP = 0.05  # of a side on each side: a zero on the side of a box lies inside of its neighbour
DEEPEST = 27  # levels; then a box is 1e-9 of the whole, and rounded bounds can say no more of leaves that touch
MANY, COARSE = 8, 10  # leaves in a box on the first levels, whose pairs are not looked at
MOST = 1 << 15  # boxes at once: a contact in a point leaves a few
SCATTER = 16.0  # boxes: rounded bounds leave some around a contact, with gaps
STEPS = 6  # of Newton's method from a proved box
ROUNDING = 8 * np.finfo(float).eps


@dataclass(frozen=True)
class CommonZero:
    """A point where leaves meet, how well it is known, and whether they only touch there, or one is singular."""

    point: Floats
    radius: float
    touching: bool


class _Pairs(NamedTuple):
    box: Ints
    one: Ints
    other: Ints


def common_zeros(leaves: LeafBoxes, box: Boxes) -> tuple[list[CommonZero], tuple[RsymError, ...]]:
    """The points in a box where leaves that matter meet, each once, in the order of their coordinates.

    Where leaves have more in common than points nothing is found, and why is in the second answer.
    """
    refused: tuple[RsymError, ...] = ()
    boxes, zeros, errors = grid(box, FIRST), [np.empty((2, 0))], [np.empty(0)]
    floor = ROUNDING * float(np.abs([box.lower, box.upper]).max())
    for level in range(DEEPEST):
        sides = boxes.sides
        wide = Boxes(boxes.lower - OVERLAP * sides, boxes.upper + OVERLAP * sides)
        bounds = leaves.over(wide)
        matter = leaves.matter(bounds)
        flat = matter & ~leaves.steady(bounds)
        distinct = _distinct(matter, leaves.lines)
        kept = np.flatnonzero(_several(distinct) | flat.any(axis=0))
        boxes, wide, bounds, distinct = boxes[kept], wide[kept], bounds[..., kept], distinct[:, kept]
        open_, found, error = _settled(leaves, wide, bounds, distinct, coarse=level < COARSE)
        zeros.append(found)
        errors.append(error + floor)
        boxes = boxes[open_ | flat[:, kept].any(axis=0)]
        if not len(boxes):
            break
        if len(boxes) > MOST:
            refused, boxes = (_degenerate(boxes),), boxes[np.empty(0, np.int64)]
            break
        boxes, _ = halves(boxes)
    regular = _joined(np.hstack(zeros), np.concatenate(errors))
    reach = np.hypot(*boxes.sides)
    left = _joined(boxes.centres, reach, SCATTER) if len(boxes) else []
    own = [one for one in regular if all(np.hypot(*(one[0] - other[0])) > 2 * other[1] for other in left)]
    every = [CommonZero(*one, False) for one in own] + [CommonZero(*one, True) for one in left]
    return sorted(every, key=lambda one: tuple(one.point)), refused


def _distinct(matter: Flags, lines: tuple[int, ...]) -> Flags:
    """Of leaves with the same zeros that matter in a box the first."""
    found = matter.copy()
    for number, line in enumerate(lines):
        for before in (k for k in range(number) if lines[k] == line):
            found[number] &= ~found[before]
    return found


def _several(matter: Flags) -> Flags:
    several: Flags = matter.sum(axis=0) > 1
    return several


def _settled(
    leaves: LeafBoxes, boxes: Boxes, bounds: Floats, matter: Flags, *, coarse: bool
) -> tuple[Flags, Floats, Floats]:
    """Which boxes have pairs of which nothing is proved, and the zeros (2, n) of those that have one, with errors."""
    crowded = (matter.sum(axis=0) > MANY) & coarse
    pairs = _pairs(matter & ~crowded)
    centres = boxes.centres
    middle = leaves.at(centres)
    shift, spread, none = _krawczyk(pairs, bounds, middle, boxes.sides / 2)
    half = boxes.sides[:, pairs.box] / 2
    with np.errstate(invalid="ignore"):
        none |= (np.abs(shift) > spread + half * (1 + ROUNDING)).any(axis=0)
        one = ~none & (np.abs(shift) + spread < half * (1 - ROUNDING)).all(axis=0)
    open_ = crowded.copy()
    open_[pairs.box[~none & ~one]] = True
    proved = _Pairs(*(part[one] for part in pairs))
    return open_, *_polished(leaves, centres[:, proved.box] - shift[:, one], proved)


def _pairs(matter: Flags) -> _Pairs:
    """The pairs of leaves that matter in each box."""
    found = [np.empty((3, 0), np.int64)]
    for one in range(len(matter) - 1):
        own = np.flatnonzero(matter[one])
        other, at = np.nonzero(matter[one + 1 :, own])
        found.append(np.stack([own[at], np.full(len(at), one), other + one + 1]))
    return _Pairs(*np.hstack(found))


def _krawczyk(pairs: _Pairs, bounds: Floats, middle: Floats, half: Floats) -> tuple[Floats, Floats, Flags]:
    """The centre of Krawczyk's map, from the middle of the box and turned round, its half sides, and known misses."""
    box, *both = pairs
    value = np.stack([middle[leaf, 0, box] for leaf in both])  # (2, n)
    slope = np.stack([middle[leaf, 1:, box] for leaf in both]).transpose(0, 2, 1)  # (2 leaves, 2 axes, n)
    low, high = (np.stack([bounds[leaf, 1:, end, box] for leaf in both]).transpose(0, 2, 1) for end in (0, 1))
    with np.errstate(all="ignore"):
        centre, radius = low / 2 + high / 2, high / 2 - low / 2
        (p, q), (u, v) = slope
        inverse = np.array([[v, -q], [-u, p]]) / (p * v - q * u)
        shift = np.einsum("abn,bn->an", inverse, value)
        off = np.abs(np.einsum("abn,bcn->acn", inverse, centre) - np.eye(2)[:, :, None])
        off = off + np.einsum("abn,bcn->acn", np.abs(inverse), radius)
        spread = np.einsum("abn,bn->an", off, half[:, box]) * (1 + ROUNDING)
        # f - c*g with the smallest gradient in the middle.
        times = (p * u + q * v) / (u * u + v * v)
        gap = value[0] - times * value[1]
        steep = np.abs(centre[0] - times * centre[1]) + radius[0] + np.abs(times) * radius[1]
        rounding = ROUNDING * (np.abs(value[0]) + np.abs(times * value[1]))
        none: Flags = np.abs(gap) - rounding > np.einsum("an,an->n", steep, half[:, box]) * (1 + ROUNDING)
    return shift, spread, none


def _polished(leaves: LeafBoxes, places: Floats, pairs: _Pairs) -> tuple[Floats, Floats]:
    """Newton's method from places near a regular zero, and how far it may be off by rounding."""
    every, error = np.arange(places.shape[1]), np.zeros(places.shape[1])
    for _ in range(STEPS if len(every) else 0):
        bounds = leaves.over(points(places))
        both = np.stack([bounds[leaf, :, :, every] for leaf in pairs[1:]])  # (2, n, 3, 2)
        value = both.mean(axis=3)
        (p, q), (u, v) = value[0, :, 1:].T, value[1, :, 1:].T
        f, g = value[:, :, 0]
        inverse = np.array([[v, -q], [-u, p]]) / (p * v - q * u)
        places = places - np.einsum("abn,bn->an", inverse, np.stack([f, g]))
        doubt = both[:, :, 0, 1] - both[:, :, 0, 0]
        error = np.hypot(*np.einsum("abn,bn->an", np.abs(inverse), doubt)) + ROUNDING * np.hypot(*places)
    return places, error


def _joined(places: Floats, radii: Floats, scatter: float = 1.0) -> list[tuple[Floats, float]]:
    """Points whose circles, so many times wider, meet as one: the best known of them, and a radius around all."""
    if not len(radii):
        return []
    apart = np.hypot(*(places[:, :, None] - places[:, None, :]))
    one, other = np.nonzero(apart <= scatter * (radii[:, None] + radii))
    count, group = connected_components(
        coo_matrix((np.ones(len(one)), (one, other)), shape=apart.shape), directed=False
    )
    found = []
    for number in range(count):
        own = np.flatnonzero(group == number)
        best = own[np.argmin(radii[own])]
        middle = places[:, best] if radii[best] < radii[own].max() else places[:, own].mean(axis=1)
        found.append((middle, float((np.hypot(*(places[:, own] - middle[:, None])) + radii[own]).max())))
    return found


def _degenerate(boxes: Boxes) -> RsymError:
    place = boxes.centres[:, 0]
    return RsymError(
        "two leaves vanish along the same piece of a line, or the gradient of one does",
        code="degenerate",
        where=f"near ({place[0]:.6g}, {place[1]:.6g})",
        remedy="write the common piece as one part, with one formula",
    )
