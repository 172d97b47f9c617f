"""The proof that clauses have the sign of a form and are zero on the boundary alone.

Over a box atoms have signs that are proved, or are open. For all signs that the open ones may have together, zeros
among them, the clauses, of which a zero is false, have to hold exactly where the form does for each sign that the zeros
may turn into. That is a question of logic, and one box answers it for much of a shape; others are halved. What is left
are boxes around points where several atoms meet, whose signs hang on each other. There the germ is looked at: on
circles about the point all atoms that pass are put in the order of their angles, which is the same on circles of two
sizes.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from rsym.arrays import Flags, Floats, Ints
from rsym.problems.seams.atoms import SignAtoms, Signs
from rsym.problems.seams.clauses import Clause
from rsym.problems.seams.rows import literals, slid

MOST_OPEN = 7  # atoms of a box of which all signs are tried
DEPTH = {2: 20, 3: 9}  # halvings
# Where atoms touch and part slowly, heaps of boxes lie beside the germ in which they are apart by less than a box.
DEEPER = {2: (4, 4), 3: (1,)}
MOST_BOXES = 20000
ROOM = 0.0137, 0.0173  # of a side, beyond the box: corners are on round numbers
RADII = 3.0, 1.2  # of the longest side of a heap of boxes, of circles about it
ANGLES = 720  # at which signs are looked for on a circle
BISECTIONS = 60
CENTRE = 1e-9  # of the radius: so near atoms pass the middle
TINY = 1e-9  # of what an atom is on a circle: so little it is zero in the middle
NEAR, FLAT = 1e-6, 1e-2  # of the size of a germ, of usual slopes
TRIED = 200  # points about a germ in space


def unproved(atoms: SignAtoms, clauses: Sequence[Clause], most: int = 20) -> Floats:
    """The places (n, dim), at most so many, where nothing is proved; none where all is."""
    checked, dimension = _Checked(atoms, clauses), atoms.shape.dimension
    low, high = np.array(atoms.box, float).T[:, None]
    heaps = [(low - ROOM[0] * (high - low), high + ROOM[1] * (high - low))]
    for depth in (DEPTH[dimension], *DEEPER[dimension]):
        left = []
        for heap in heaps:
            low, high = checked.halved(*heap, depth)
            if len(low) > MOST_BOXES:
                crowded: Floats = (low[:most] + high[:most]) / 2
                return crowded
            left += [(low[heap], high[heap]) for heap in _heaps(low, high)]
        heaps = [heap for heap in left if not checked.germ(*_around(*heap))]
    return np.array([_around(*heap)[0] for heap in heaps[:most]]).reshape(-1, dimension)


def _heaps(low: Floats, high: Floats) -> list[Ints]:
    """Boxes that touch."""
    if not len(low):
        return []
    middles, side = (low + high) / 2, float((high - low).max())
    pairs = cKDTree(middles).query_pairs(1.5 * side, p=np.inf, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(middles),) * 2)
    count, heap = connected_components(links, directed=False)
    return [np.flatnonzero(heap == number) for number in range(count)]


def _around(low: Floats, high: Floats) -> tuple[Floats, float]:
    """The middle of a heap of boxes, and its longest side."""
    first, last = low.min(axis=0), high.max(axis=0)
    return (first + last) / 2, float((last - first).max())


class _Checked:
    """What is known of clauses."""

    def __init__(self, atoms: SignAtoms, clauses: Sequence[Clause]) -> None:
        self.atoms, self.clauses = atoms, clauses
        self._known: dict[tuple[int, ...], bool] = {}

    def halved(self, low: Floats, high: Floats, depth: int) -> tuple[Floats, Floats]:
        """The boxes, halved so many times, in which it is open whether they agree; too many as soon as there are."""
        corners = np.array(list(product((False, True), repeat=self.atoms.shape.dimension)))
        for _ in range(depth):
            signs = self.atoms.over(low, high)
            kinds, which = np.unique(signs, axis=1, return_inverse=True)
            agrees = np.array([self.agrees(tuple(kind)) for kind in kinds.T.tolist()], np.bool_)
            left = ~agrees[which.ravel()]
            low, high = low[left], high[left]
            if not 0 < len(low) <= MOST_BOXES:
                break
            middle = (low + high) / 2
            low, high = (
                np.concatenate([np.where(corner, *ends) for corner in corners])
                for ends in ((middle, low), (high, middle))
            )
        return low, high

    def holds(self, signs: Signs) -> Flags:
        """Whether the clauses do (n,), zeros false."""
        told = literals(signs)
        found = np.array([told[:, clause].any(axis=1) for clause in self.clauses])
        return np.asarray(found.all(axis=0))

    def agrees(self, signs: tuple[int, ...]) -> bool:
        """Whether the clauses hold where the form does, for all signs of the atoms that are open."""
        if signs not in self._known:
            self._known[signs] = self._agrees(np.array(signs, np.int8))
        return self._known[signs]

    def _agrees(self, signs: Signs) -> bool:
        open_ = np.flatnonzero(signs == 0)
        if len(open_) > MOST_OPEN:
            return False
        every = np.repeat(signs[:, None], 3 ** len(open_), axis=1)
        every[open_] = np.array([*product((1, -1, 0), repeat=len(open_))], np.int8).T.reshape(
            len(open_), 3 ** len(open_)
        )
        sure = (every != 0).all(axis=0)
        form = np.zeros(every.shape[1], np.bool_)
        form[sure] = self.atoms.inside(every[:, sure]) > 0
        table = form.reshape((3,) * len(open_))
        for axis in range(len(open_)):  # a zero holds where both signs do
            parts = np.moveaxis(table, axis, 0)
            parts[2] = parts[0] & parts[1]
        there = np.ones(every.shape[1], np.bool_)
        for one, sign, other, with_it in self.atoms.never:
            there &= (every[one] * sign < 0) | (every[other] * with_it < 0)
        return bool(np.array_equal(form[there], self.holds(every[:, there])))

    def germ(self, place: Floats, side: float) -> bool:
        """Whether the clauses hold where the form does all about a place where atoms meet."""
        if self.atoms.shape.dimension == 3:
            return self._germ_in_space(place, side)
        found = [self._circle(place, radius * side) for radius in RADII]
        return all(one is not None for one in found) and found[0] == found[1]

    def _circle(self, place: Floats, radius: float) -> list[bytes] | None:
        """The signs in the sectors about a place, in order, where the clauses agree with the form; else None."""
        place = self._middle(place, radius)
        angles = (np.arange(ANGLES) + 0.5) * (2 * np.pi / ANGLES)

        def at(some: NDArray[Any]) -> Floats:
            return self.atoms.at(place + radius * np.stack([np.cos(some), np.sin(some)], axis=1))[:, 0]

        signs = np.sign(at(angles))
        atom, k = np.nonzero(signs * np.roll(signs, -1, axis=1) < 0)
        low, high, before = angles[k], angles[k] + 2 * np.pi / ANGLES, signs[atom, k]
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            same = np.sign(at(middle))[atom, np.arange(len(atom))] == before
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        cuts = np.sort(low) if len(low) else np.zeros(1)
        ends = np.append(cuts[1:], cuts[0] + 2 * np.pi)
        apart = ends - cuts > 1e-12
        sectors = np.sign(at((cuts + ends) / 2)).astype(np.int8)
        if not (sectors[:, apart] != 0).all():
            return None
        wide = sectors[:, apart]
        ok = np.array_equal(self.atoms.inside(wide) > 0, self.holds(wide))
        # Between two sectors those atoms are zero whose signs differ.
        next_ = np.roll(wide, -1, axis=1)
        between = np.where(wide == next_, wide, 0)
        both = (self.atoms.inside(wide) > 0) & (self.atoms.inside(next_) > 0)
        ok &= np.array_equal(both, self.holds(between))
        found = self.atoms.at(place[None])[:, :, 0]
        with np.errstate(all="ignore"):
            passing = ~(np.abs(found[:, 0]) > CENTRE * radius * np.linalg.norm(found[:, 1:], axis=1))
        passing |= np.abs(found[:, 0]) <= TINY * np.abs(at(angles)).max(axis=1)
        centre = np.where(passing, 0, np.sign(found[:, 0])).astype(np.int8)[:, None]
        ok &= bool(self.holds(centre)[0]) == bool((self.atoms.inside(wide) > 0).all())
        around = [column.tobytes() for column in wide.T]
        return min(around[k:] + around[:k] for k in range(len(around))) if ok else None

    def _middle(self, place: Floats, radius: float) -> Floats:
        """Where the two atoms next to a place meet that cross most."""
        found = self.atoms.at(place[None])[:, :, 0]
        with np.errstate(all="ignore"):
            length = np.linalg.norm(found[:, 1:], axis=1)
            near = np.flatnonzero(np.abs(found[:, 0]) <= 2 * radius * length)
        slopes = found[near, 1:] / length[near, None]
        across = np.abs(slopes[:, None, 0] * slopes[None, :, 1] - slopes[:, None, 1] * slopes[None, :, 0])
        if len(near) < 2 or across.max() < 1e-3:
            return place
        pair = np.unravel_index(across.argmax(), across.shape)
        moved = slid(self.atoms, (int(near[pair[0]]), int(near[pair[1]])), place[None])
        return moved[0] if len(moved) and np.abs(moved[0] - place).max() <= 2 * radius else place

    def _germ_in_space(self, place: Floats, side: float) -> bool:
        """The same at points about a place, on the atoms there and where two of them meet."""
        ways = np.random.default_rng(38).normal(size=(TRIED, 3))
        points = place + side * ways
        usual = np.median(np.linalg.norm(self.atoms.at(points)[:, 1:], axis=1), axis=1, keepdims=True)
        near = [
            k
            for k, sign in enumerate(self.atoms.over(place[None] - 2 * side, place[None] + 2 * side)[:, 0])
            if not sign
        ]
        for chosen in ((), *((k,) for k in near), *((j, k) for j in near for k in near if j < k)):
            there = slid(self.atoms, chosen, points) if chosen else points
            there = there[np.abs(there - place).max(axis=1, initial=0) <= 3 * side] if len(there) else there
            signs = self.atoms.signs(there)
            signs[list(chosen)] = 0
            found = self.atoms.at(there)
            slopes = np.linalg.norm(found[:, 1:], axis=1)
            close = np.abs(found[:, 0]) < NEAR * side * slopes
            # Where a slope is lost an atom is zero in one point, which no sign tells.
            close[list(chosen)] = slopes[list(chosen)] < FLAT * usual[list(chosen)]
            signs = signs[:, ~close.any(axis=0)]
            if not np.array_equal(self.atoms.holds(signs), self.holds(signs)):
                return False
        return True
