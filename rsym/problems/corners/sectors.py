"""What is inside around a point where leaves meet: sectors between the directions in which leaves leave it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rsym.arrays import Floats
from rsym.logic.gates import Gate, through

ALONG = 1e-7  # radians: directions closer are one, and curvature decides what lies between
BENT = 1e-6  # of the largest curvature: curves closer are one


class Sector(NamedTuple):
    """What is inside from one edge to the next, counter-clockwise: the leaves of both, and its angle."""

    first: int
    second: int
    opening: float


class _Ray(NamedTuple):
    """A direction, and what leaves it there: the leaves, and how fast they turn to the left."""

    angle: float
    bend: float
    leaves: tuple[int, ...]


def sectors(
    gates: Sequence[Gate], signs: Sequence[int], gradients: Mapping[int, Floats], hessians: Mapping[int, Floats]
) -> list[Sector]:
    """The sectors inside at a point where some leaves vanish, those with gradients (2,) and hessians (3,).

    Of the others the signs are taken. Between directions that are the same the curvatures decide, and the opening is 0,
    or 2 pi of what lies outside of such a cusp.

    Examples
    --------
    >>> gradients = {0: np.array([1.0, 0.0]), 1: np.array([0.0, 1.0])}
    >>> straight = dict.fromkeys(gradients, np.zeros(3))
    >>> for operation in ("min", "max"):
    ...     ((first, second, opening),) = sectors([Gate(operation, 0, 1)], (0, 0), gradients, straight)
    ...     print(first, second, opening / math.pi)
    1 0 0.5
    0 1 1.5
    """
    rays = _rays(gradients, hessians)
    inside, widths, known = [], [], []
    for ray, following in zip(rays, [*rays[1:], rays[0]], strict=True):
        thin = ray.angle == following.angle and len(rays) > 1
        widths.append(0.0 if thin else (following.angle - ray.angle) % (2 * math.pi))
        known_signs = dict(enumerate(signs))
        for leaf, slope in gradients.items():
            known_signs[leaf] = _sign(slope, hessians[leaf], ray, following, thin=thin)
        known.append([known_signs[k] for k in range(len(signs))])
        inside.append(_form(gates, known[-1]) > 0)
    found = []
    for start in range(len(rays)):
        if not inside[start] or inside[start - 1]:
            continue
        length = next(n for n in range(1, len(rays)) if not inside[(start + n) % len(rays)])
        own = [(start + n) % len(rays) for n in range(length)]
        first, last = rays[start], rays[(start + length) % len(rays)]
        rest = [widths[k] for k in range(len(rays)) if k not in own]
        opening = math.fsum(widths[k] for k in own) if any(rest) else 2 * math.pi
        edges = _edge(gates, known[own[0]], first), _edge(gates, known[own[-1]], last)
        found.append(Sector(*edges, opening))
    return found


def _rays(gradients: Mapping[int, Floats], hessians: Mapping[int, Floats]) -> list[_Ray]:
    """The directions of all leaves, counter-clockwise."""
    every = []
    for leaf, (p, q) in gradients.items():
        for turn in (-1, 1):
            every.append((math.atan2(turn * p, -turn * q) % (2 * math.pi), leaf))
    every.sort()
    # Begin behind a gap, so that no direction is cut in two.
    gaps = [(every[k][0] - every[k - 1][0]) % (2 * math.pi) for k in range(len(every))]
    first = max(range(len(every)), key=lambda k: gaps[k])
    groups: list[list[tuple[float, int]]] = []
    for k in range(first, first + len(every)):
        angle, leaf = every[k % len(every)]
        if groups and gaps[k % len(every)] <= ALONG:
            groups[-1].append((angle, leaf))
        else:
            groups.append([(angle, leaf)])
    return [ray for group in groups for ray in _bundle(group[0][0], [leaf for _, leaf in group], gradients, hessians)]


def _bundle(
    angle: float, leaves: Sequence[int], gradients: Mapping[int, Floats], hessians: Mapping[int, Floats]
) -> list[_Ray]:
    """The rays of leaves that leave in one direction, by the curvature to the left."""
    bends = sorted((_bend(angle, gradients[leaf], hessians[leaf]), leaf) for leaf in leaves)
    same = BENT * max(abs(bend) for bend, _ in bends)
    rays: list[_Ray] = []
    for bend, leaf in bends:
        if rays and bend - rays[-1].bend <= same:
            rays[-1] = _Ray(angle, rays[-1].bend, (*rays[-1].leaves, leaf))
        else:
            rays.append(_Ray(angle, bend, (leaf,)))
    return rays


def _bend(angle: float, slope: Floats, hessian: Floats) -> float:
    """The curvature to the left of a leaf along a direction of its."""
    c, s = math.cos(angle), math.sin(angle)
    return float(-(c * c * hessian[0] + 2 * c * s * hessian[1] + s * s * hessian[2]) / (c * slope[1] - s * slope[0]))


def _sign(slope: Floats, hessian: Floats, ray: _Ray, following: _Ray, *, thin: bool) -> int:
    """The sign of a leaf that vanishes in the point between two rays."""
    if thin:
        c, s = math.cos(ray.angle), math.sin(ray.angle)
        left = c * slope[1] - s * slope[0]
        if abs(left) > np.hypot(*slope) / 2 and abs(c * slope[0] + s * slope[1]) <= 2 * ALONG * abs(left):
            return int(np.sign(left * ((ray.bend + following.bend) / 2 - _bend(ray.angle, slope, hessian))))
        middle = ray.angle
    else:
        middle = ray.angle + (following.angle - ray.angle) % (2 * math.pi) / 2
    return int(np.sign(math.cos(middle) * slope[0] + math.sin(middle) * slope[1]))


def _form(gates: Sequence[Gate], signs: Sequence[int]) -> int:
    rules = {"min": min, "max": max}
    return through(gates, signs, lambda gate, one, other: rules[gate.operation](one, other))[-1]


def _edge(gates: Sequence[Gate], signs: Sequence[int], ray: _Ray) -> int:
    """The leaf of a ray without which what is inside beside it, where leaves have the signs, were outside.

    Where there are several that do not need each other it is one of them that is positive inside.
    """
    positive = [leaf for leaf in ray.leaves if signs[leaf] > 0]
    without = ([-sign if k == leaf else sign for k, sign in enumerate(signs)] for leaf in positive)
    deciding = [leaf for leaf, other in zip(positive, without, strict=True) if _form(gates, other) < 0]
    return (deciding or positive)[0]
