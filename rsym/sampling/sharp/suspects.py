"""What unresolved cells mean: walls, gaps, sheets, touching bodies, tips and knife edges.

Unresolved cells that are neighbours (by faces, edges or corners) are one cluster.
From the conflicts in a cluster Newton's method goes to the surface, and a ray
from there along the normal finds what lies across: the far side of a wall, or
the next body beyond a gap. Each pair of leaves that face each other so is one
suspect; without such a pair a cluster is a tip, or stays unresolved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy import sparse

from rsym.sampling.sharp.boxes import Array, Ints
from rsym.sampling.sharp.certificates import STEEPEST, Unresolved
from rsym.sampling.sharp.leaves import Leaves
from rsym.sampling.sharp.thickness import FIRST, Rays, across, closest, common, level

# Two directions that no third serves with the cosine c have a cosine below 2*c**2 - 1.
OPPOSED = 2 * STEEPEST**2 - 1
# Cells of a cluster that are measured, evenly spread: the thinnest place of a pair is then sought by Newton's method.
MEASURED = 24
_THIN = "{self.thickness:.2g} cells {wide} {near}; {self.finer:.2g} times the resolution puts 2 cells across it"
SENTENCES = {
    "wall": "a wall{of}, " + _THIN.replace("{wide}", "thick"),
    "gap": "a gap{of}, " + _THIN.replace("{wide}", "wide"),
    "sheet": "the equation is zero without a change of sign{of}, in {cells} {near}; a mesh cannot show that",
    "touch": "bodies touch{of} {near}; at no resolution is the surface a manifold there",
    "knife": "an edge{of} tapers to nothing, in {cells} {near}; no resolution resolves all of it",
    "apex": "the gradient{of} vanishes on the surface {near}, as at a tip; no resolution resolves that",
    "unresolved": "what the surface does{of} in {cells} {near} is not known",
}


@dataclass(frozen=True)
class Suspect:
    """Something that a lattice may have missed.

    Attributes
    ----------
    kind : {"wall", "gap", "sheet", "touch", "knife", "apex", "unresolved"}
        A wall or a gap that is thin; a zero set where the sign does not change; bodies that touch; an edge that
        tapers to nothing; a point of the surface where the gradient vanishes; none of these.
    place : (x, y, z)
        Where it is thinnest.
    thickness : float
        Across it, in cells; 0 but for walls and gaps.
    cells : int
        How many cells without a certificate belong to it.
    leaves : tuple of int
        The leaves that meet there.
    names : tuple of str
        What they are called.

    Examples
    --------
    >>> print(Suspect("gap", (0.0, 1.0, 2.0), 0.5, 12, (0, 3), ("arch", "wheel")).remark)
    Unresolved: a gap between arch and wheel, 0.5 cells wide near (0, 1, 2); 4 times the resolution puts 2 cells \
across it.
    """

    kind: str
    place: tuple[float, float, float]
    thickness: float
    cells: int
    leaves: tuple[int, ...]
    names: tuple[str, ...] = ()

    @property
    def remark(self) -> str:
        """A sentence that says what is there, and where."""
        size = max(abs(value) for value in self.place)
        near = ", ".join(f"{value if abs(value) > 1e-9 * size else 0:.4g}" for value in self.place)
        cells = f"{self.cells} {'cell' if self.cells == 1 else 'cells'}"
        return f"Unresolved: {SENTENCES[self.kind].format(self=self, of=self._of, near=f'near ({near})', cells=cells)}."

    @property
    def _of(self) -> str:
        if not self.names:
            return ""
        return f" {'of' if len(self.names) == 1 else 'between'} {' and '.join(self.names)}"

    @property
    def finer(self) -> float:
        """How many times the resolution puts two cells across it."""
        return 2 / self.thickness


def suspects(leaves: Leaves, lattice: Array, unresolved: Unresolved, names: Sequence[str] = ()) -> tuple[Suspect, ...]:
    """What the unresolved cells mean, kind after kind, the thinnest first; `names` are those of the leaves."""
    if not len(unresolved):
        return ()
    cluster = clusters(unresolved.cells)
    ids, seeds, owner = _seeds(unresolved, cluster)
    rays = across(leaves, ids, seeds, lattice[3:], OPPOSED)
    found = []
    for number in range(cluster.max() + 1):
        here = cluster[owner[rays.source]] == number
        part = _Cluster(leaves, lattice, unresolved, np.flatnonzero(cluster == number))
        found += part.facing(rays, np.flatnonzero(here)) or [part.alone()]
    found = [replace(one, names=tuple(names[leaf] for leaf in one.leaves)) for one in found] if names else found
    return tuple(sorted(found, key=lambda one: (list(SENTENCES).index(one.kind), one.thickness, -one.cells)))


def clusters(cells: Ints) -> Ints:
    """The number of the cluster of each cell (3, n), in the order of their first cells."""
    count = cells.shape[1]
    shape = tuple(cells.max(axis=1) + 3)
    key = np.ravel_multi_index(tuple(cells + 1), shape)
    order = np.argsort(key)
    pairs = []
    for offset in np.ndindex(3, 3, 3):
        if offset > (1, 1, 1):
            near = np.ravel_multi_index(tuple(cells + np.array(offset)[:, None]), shape)
            at = np.minimum(np.searchsorted(key, near, sorter=order), count - 1)
            here = np.flatnonzero(key[order[at]] == near)
            pairs.append(np.stack([here, order[at[here]]]))
    one, other = np.concatenate(pairs, axis=1)
    graph = sparse.coo_array((np.ones(len(one), np.bool_), (one, other)), shape=(count, count))
    _, label = sparse.csgraph.connected_components(graph, directed=False)
    _, first, label = np.unique(label, return_index=True, return_inverse=True)
    rank = np.empty_like(first)
    rank[np.argsort(first)] = np.arange(len(first))
    return np.asarray(rank[label], np.int64)


def _seeds(unresolved: Unresolved, cluster: Ints) -> tuple[Any, Array, Ints]:
    """Leaves and points to start from: the corners of the middle halves of boxes in conflict, in measured cells."""
    measured = np.zeros(len(cluster), np.bool_)
    for number in range(cluster.max() + 1):
        cells = np.flatnonzero(cluster == number)
        measured[cells[np.unique(np.linspace(0, len(cells) - 1, MEASURED).astype(np.int64))]] = True
    some = np.flatnonzero(measured[unresolved.owner])
    share = (np.indices((2, 2, 2)).reshape(3, 1, 8) + 0.5) / 2
    lower, upper = unresolved.lower[:, some, None], unresolved.upper[:, some, None]
    points = (lower + share * (upper - lower)).reshape(3, -1)
    return np.repeat(unresolved.leaf[some], 8), points, np.repeat(unresolved.owner[some], 8)


@dataclass(frozen=True)
class _Cluster:
    leaves: Leaves
    lattice: Array
    unresolved: Unresolved
    cells: Ints

    def facing(self, rays: Rays, which: Ints) -> list[Suspect]:
        """A suspect for each pair of leaves that face each other across a wall or a gap."""
        keys = np.concatenate([rays.leaves[:, which], rays.inward[None, which]])
        found = []
        for key in np.unique(keys, axis=1).T:
            some = which[(keys == key[:, None]).all(axis=0)]
            found.append(self._pair(rays, some, (int(key[0]), int(key[1]))))
        return found

    def _pair(self, rays: Rays, which: Ints, pair: tuple[int, int]) -> Suspect:
        thinnest = which[rays.cells[which].argmin()]
        kind, place, thickness = self._kind(rays, which, thinnest, pair)
        return Suspect(kind, _point(place), float(thickness), self._count(pair), tuple(sorted(set(pair))))

    def _kind(self, rays: Rays, which: Ints, thinnest: int, pair: tuple[int, int]) -> tuple[str, Array, float]:
        place, thickness = rays.place[:, thinnest], rays.cells[thinnest]
        if np.median(rays.cells[which]) == 0:
            return "sheet", place, 0.0
        kind = "wall" if rays.inward[thinnest] else "gap"
        ids, start, spacing = np.array(pair, np.int16)[:, None], place[:, None], self.lattice[3:]
        if pair[0] == pair[1]:
            point, level_there = level(self.leaves, ids[0], start, spacing)
            return ("apex", point[:, 0], 0.0) if level_there[0] and self._holds(point) else (kind, place, thickness)
        point, between, converged = closest(self.leaves, ids, start, spacing)
        between = between[0] if kind == "wall" else -between[0]
        if converged[0] and self._holds(point) and between > -FIRST:
            if between < FIRST:
                return "touch", point[:, 0], 0.0
            return (kind, point[:, 0], between) if between < thickness else (kind, place, thickness)
        point, exists = common(self.leaves, ids, start, spacing)
        return ("knife", point[:, 0], 0.0) if exists[0] and self._holds(point) else (kind, place, thickness)

    def alone(self) -> Suspect:
        """A tip, or we do not know."""
        members = np.isin(self.unresolved.owner, self.cells)
        ids = np.unique(self.unresolved.leaf[members])
        centre = ((self.unresolved.lower + self.unresolved.upper)[:, members] / 2).mean(axis=1)
        points, flat = level(self.leaves, ids, np.repeat(centre[:, None], len(ids), axis=1), self.lattice[3:])
        for k in np.flatnonzero(flat):
            if self._holds(points[:, k : k + 1]):
                return Suspect("apex", _point(points[:, k]), 0.0, len(self.cells), (int(ids[k]),))
        return Suspect("unresolved", _point(centre), 0.0, len(self.cells), tuple(int(leaf) for leaf in ids))

    def _holds(self, point: Array) -> bool:
        """Whether a point lies in the cluster or within a cell of its ends."""
        place = (point[:, 0] - self.lattice[:3]) / self.lattice[3:]
        cells = self.unresolved.cells[:, self.cells]
        return bool((place > cells.min(axis=1) - 1).all() and (place < cells.max(axis=1) + 2).all())

    def _count(self, pair: tuple[int, int]) -> int:
        """How many cells of the cluster have both leaves in conflict."""
        holding = [np.unique(self.unresolved.owner[self.unresolved.leaf == leaf]) for leaf in pair]
        both = np.intersect1d(holding[0], holding[1])
        return max(1, int(np.isin(self.cells, both).sum()))


def _point(place: Array) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in place)
    return x, y, z
