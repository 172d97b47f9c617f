"""What unresolved cells mean: walls, gaps, sheets, touching bodies, tips and knife edges.

Unresolved cells that are neighbours (by faces, edges or corners) are one cluster.
From the conflicts in a cluster Newton's method goes to the surface, and a ray
from there along the normal finds what lies across: the far side of a wall, or
the next body beyond a gap. Each pair of leaves that face each other so is one
suspect; without such a pair a cluster is a tip, or stays unresolved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints, Shorts
from rsym.sampling.sharp.certificates import STEEPEST, Unresolved
from rsym.sampling.sharp.clusters import clusters
from rsym.sampling.sharp.crossings import Leaves
from rsym.sampling.sharp.thickness import FIRST, ThinRays, across, closest, common, level
from rsym.sampling.status import KINDS, Suspect

# Two directions that no third serves with the cosine c have a cosine below 2*c**2 - 1.
OPPOSED = 2 * STEEPEST**2 - 1
# Cells of a cluster that are measured, evenly spread: the thinnest place of a pair is then sought by Newton's method.
MEASURED = 12
# Four corners of the middle half of a box, no two on one side of it: a wall through its middle has some on both sides.
_ABOUT = np.array([[1, 1, 3, 3], [1, 3, 1, 3], [1, 3, 3, 1]]) / 4


def suspects(leaves: Leaves, lattice: Floats, unresolved: Unresolved, names: Sequence[str] = ()) -> tuple[Suspect, ...]:
    """What the unresolved cells mean, kind after kind, the thinnest first; `names` are those of the leaves.

    Examples
    --------
    >>> import numpy as np, rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import surface_form
    >>> from rsym.sampling.kernels.mesher_kernels import mesher_kernels
    >>> from rsym.sampling.sharp.certificates import Form, certify
    >>> from rsym.sampling.regions.regions import whole_form
    >>> from rsym.sampling.sharp.crossings import CompiledLeaves
    >>> form = surface_form(rsym.Shape(rsym.conjunction(x, 0.02 - x), (x, y, z)))
    >>> kernels = mesher_kernels(form)
    >>> kernels.set({})
    >>> leaves, lattice = CompiledLeaves(kernels), np.array([-0.36, 0, 0, 0.1, 0.1, 0.1])
    >>> unresolved = certify(Form(leaves, 2, whole_form(form)), lattice, np.zeros((3, 1), np.int64))
    >>> [wall] = suspects(leaves, lattice, unresolved, ("left", "right"))
    >>> print(wall.kind, wall.names, round(wall.thickness, 3), wall.cells)
    wall ('left', 'right') 0.2 64
    """
    if not len(unresolved):
        return ()
    space = _Clusters(unresolved, lattice)
    ids, seeds, cluster = space.seeds()
    rays = across(leaves, ids, seeds, lattice[3:], OPPOSED)
    pairs = _pairs(rays, cluster[rays.source])
    found = _facing(leaves, space, pairs) + _alone(leaves, space, pairs.cluster)
    if names:
        found = [replace(one, names=tuple(names[leaf] for leaf in one.leaves)) for one in found]
    return tuple(sorted(found, key=lambda one: (list(KINDS).index(one.kind), one.thickness, -one.cells)))


class _Clusters:
    """Clusters of unresolved cells, and the members of their conflicts."""

    def __init__(self, unresolved: Unresolved, lattice: Floats) -> None:
        self.lattice = lattice
        self.cell = clusters(unresolved.cells)
        self.count = int(self.cell.max()) + 1
        member = self.cell[unresolved.owner]
        order = np.argsort(member, kind="stable")
        self.owner, self.leaf = unresolved.owner[order], unresolved.leaf[order]
        self.lower, self.upper = unresolved.lower[:, order], unresolved.upper[:, order]
        self.start = np.searchsorted(member[order], np.arange(self.count + 1))
        by_cluster = np.argsort(self.cell, kind="stable")
        first = np.searchsorted(self.cell[by_cluster], np.arange(self.count))
        self.low = np.minimum.reduceat(unresolved.cells[:, by_cluster], first, axis=1)
        self.high = np.maximum.reduceat(unresolved.cells[:, by_cluster], first, axis=1)
        self.cells = np.diff([*first, len(by_cluster)])

    def seeds(self) -> tuple[Shorts, Floats, Ints]:
        """Leaves, points to start from, and their clusters: about the middles of the boxes of measured conflicts."""
        some = []
        for first, last in pairwise(self.start):
            cell, begin = np.unique(self.owner[first:last], return_index=True)
            taken = np.zeros(len(cell), np.bool_)
            taken[np.linspace(0, len(cell) - 1, MEASURED).astype(np.int64)] = True
            some.append(first + np.flatnonzero(np.repeat(taken, np.diff([*begin, last - first]))))
        members = np.concatenate(some)
        lower, upper = self.lower[:, members, None], self.upper[:, members, None]
        points = (lower + _ABOUT[:, None] * (upper - lower)).reshape(3, -1)
        each = _ABOUT.shape[1]
        cluster = self.cell[self.owner[members]]
        return np.repeat(self.leaf[members], each), points, np.repeat(cluster, each)

    def holds(self, cluster: Ints, points: Floats) -> Flags:
        """Whether points lie within a cell of the ends of their clusters."""
        place = (points - self.lattice[:3, None]) / self.lattice[3:, None]
        return np.asarray(((place > self.low[:, cluster] - 1) & (place < self.high[:, cluster] + 2)).all(axis=0))

    def common_cells(self, cluster: int, pair: Shorts) -> int:
        """In how many cells of a cluster both leaves are in conflict."""
        here = slice(self.start[cluster], self.start[cluster + 1])
        one, other = (np.unique(self.owner[here][self.leaf[here] == leaf]) for leaf in pair)
        return max(1, len(np.intersect1d(one, other, assume_unique=True)))


class _Pairs(NamedTuple):
    """Leaves (2, n) that face each other in a cluster across a wall or a gap, where it is thinnest, and how thin."""

    cluster: Ints
    leaves: Shorts
    inward: Flags
    place: Floats
    thickness: Floats
    sheet: Flags


def _pairs(rays: ThinRays, cluster: Ints) -> _Pairs:
    """One for all rays of a cluster that join the same leaves in the same sense; a sheet if most have no length."""
    keys = np.concatenate([cluster[None], rays.leaves, rays.inward[None]]).astype(np.int64)
    kinds, kind = np.unique(keys, axis=1, return_inverse=True)
    order = np.lexsort([rays.cells, kind])
    first = np.searchsorted(kind[order], np.arange(kinds.shape[1] + 1))
    thinnest, middle = order[first[:-1]], order[(first[:-1] + first[1:]) // 2]
    return _Pairs(
        kinds[0],
        kinds[1:3].astype(np.int16),
        kinds[3] == 1,
        rays.place[:, thinnest],
        rays.cells[thinnest],
        rays.cells[middle] == 0,
    )


def _facing(leaves: Leaves, space: _Clusters, pairs: _Pairs) -> list[Suspect]:
    """What the pairs are, where they are thinnest by Newton's method."""
    kind = np.where(pairs.sheet, "sheet", np.where(pairs.inward, "wall", "gap")).astype(object)
    place, thickness = pairs.place.copy(), np.where(pairs.sheet, 0, pairs.thickness)
    same = pairs.leaves[0] == pairs.leaves[1]

    def settle(which: Ints, name: str, points: Floats, cells: Any = 0.0) -> None:
        kind[which], place[:, which], thickness[which] = name or kind[which], points, cells

    single = np.flatnonzero(same & ~pairs.sheet)
    points, flat = level(leaves, pairs.leaves[0, single], place[:, single], space.lattice[3:])
    flat &= space.holds(pairs.cluster[single], points)
    settle(single[flat], "apex", points[:, flat])

    double = np.flatnonzero(~same & ~pairs.sheet)
    points, between, found = closest(leaves, pairs.leaves[:, double], place[:, double], space.lattice[3:])
    between = np.where(pairs.inward[double], between, -between)
    found &= space.holds(pairs.cluster[double], points) & (between > -FIRST)
    touch, thinner = found & (between < FIRST), found & (between >= FIRST) & (between < thickness[double])
    settle(double[touch], "touch", points[:, touch])
    settle(double[thinner], "", points[:, thinner], between[thinner])

    crossing = double[~found]
    points, exist = common(leaves, pairs.leaves[:, crossing], place[:, crossing], space.lattice[3:])
    exist &= space.holds(pairs.cluster[crossing], points)
    settle(crossing[exist], "knife", points[:, exist])
    return [
        Suspect(
            str(kind[k]),
            _point(place[:, k]),
            float(thickness[k]),
            space.common_cells(pairs.cluster[k], pairs.leaves[:, k]),
            tuple(int(leaf) for leaf in np.unique(pairs.leaves[:, k])),
        )
        for k in range(len(kind))
    ]


def _alone(leaves: Leaves, space: _Clusters, paired: Ints) -> list[Suspect]:
    """Clusters without a pair: tips, or we do not know."""
    found = []
    for cluster in np.setdiff1d(np.arange(space.count), paired):
        here = slice(space.start[cluster], space.start[cluster + 1])
        ids = np.unique(space.leaf[here])
        centre = (space.lower[:, here] + space.upper[:, here]).mean(axis=1) / 2
        points, flat = level(leaves, ids, np.repeat(centre[:, None], len(ids), axis=1), space.lattice[3:])
        tips = np.flatnonzero(flat & space.holds(np.repeat(cluster, len(ids)), points))
        kind, place = ("apex", points[:, tips[0]]) if len(tips) else ("unresolved", centre)
        numbers = tuple(int(leaf) for leaf in (ids[tips[:1]] if len(tips) else ids))
        found.append(Suspect(kind, _point(place), 0.0, int(space.cells[cluster]), numbers))
    return found


def _point(place: Floats) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in place)
    return x, y, z
