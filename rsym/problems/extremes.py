"""The least value of a field on a shape: inside, along the leaves of its boundary, and where leaves meet.

Newton's method goes from points of the rule of integration to where the gradient of the field is a sum of those of the
leaves that the point stays on (Lagrange), so of the interior there is one start, of the boundary one in each cell that
may have the least value.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.problems.problem import Problem
from rsym.problems.splines.cardinals import derivatives
from rsym.sampling.rules.quadrature import Quadrature

STEPS = 8
MOST = 64  # starts on the boundary
BESIDE = 2.0  # cells: as near leaves are that may meet there


class Attained(NamedTuple):
    """A value of a field, and a point where it has it.

    Examples
    --------
    >>> import rsym
    >>> top = rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=8).maximum()
    >>> round(top.value, 12), len(top.point)
    (0.25, 2)
    """

    value: float
    point: tuple[float, ...]


@dataclass(frozen=True)
class Extremes:
    """A field by its derivatives at points (n, dimension), and which points belong to it."""

    problem: Problem
    rule: Quadrature
    jets: Callable[[Floats, int], Floats]
    inside: Callable[[Floats], Flags]

    def least(self) -> tuple[float, Floats]:
        """The least value, and where it is."""
        boundary = self.rule.boundary
        points = np.concatenate((self.rule.points, boundary.points))
        values = self.jets(points, 0)[0]
        best = int(np.nanargmin(values))
        found = [(float(values[best]), points[best]), *self._from(points[best : best + 1], np.empty((1, 0), np.int64))]
        starts = self._starts(values[len(self.rule.points) :], min(value for value, _ in found))
        if len(starts):
            there, own = boundary.points[starts], np.array(self.problem.origins)[boundary.leaves[starts]]
            for leaves in self._sets(there, own):
                good = (leaves >= 0).all(axis=1)
                found += self._from(there[good], leaves[good])
        return min(found, key=lambda one: one[0])

    def _starts(self, values: Floats, least: float) -> Ints:
        """Of the boundary the least point in each cell of each leaf, where a cell may have less than `least`."""
        boundary = self.rule.boundary
        known = np.flatnonzero((boundary.leaves < len(self.problem.origins)) & np.isfinite(values))
        order = known[np.argsort(values[known], kind="stable")]
        keys = np.column_stack((boundary.cells[order], boundary.leaves[order]))
        starts = order[np.sort(np.unique(keys, axis=0, return_index=True)[1])]
        slopes = np.linalg.norm(self.jets(boundary.points[starts], 1)[1:], axis=0)
        reach = 2 * float(np.linalg.norm(self.rule.grid.size))
        # An infinite slope, as at corners, excludes nothing.
        chosen: Ints = starts[~(values[starts] - reach * slopes > least)][:MOST]
        return chosen

    def _sets(self, points: Floats, own: Ints) -> list[Ints]:
        """Sets of leaves (n, k) to stay on: the own one, with the next near one, in space with two; -1 is none."""
        jets = self.problem.leaf_jets(points, 1)
        with np.errstate(all="ignore"):
            away = np.abs(jets[:, 0]) / np.linalg.norm(jets[:, 1:], axis=1)
        away = np.where(np.isfinite(away), away, np.inf)
        away[own, np.arange(len(own))] = np.inf
        near = np.argsort(away, axis=0, kind="stable")[:2]
        far = np.take_along_axis(away, near, axis=0) > BESIDE * float(np.linalg.norm(self.rule.grid.size))
        near = np.where(far, -1, near)
        sets: list[tuple[Ints, ...]] = [(own,)]
        if len(near):
            sets.append((own, near[0]))
        if self.problem.dimension == 3 and len(near) > 1:
            sets += [(own, near[1]), (own, near[0], near[1])]
        return [np.stack(one, axis=1) for one in sets]

    def _from(self, starts: Floats, leaves: Ints) -> list[tuple[float, Floats]]:
        """The least values on the way from starts (n, dimension) along leaves (n, k), and where they are."""
        points, n, k = starts.copy(), self.problem.dimension, leaves.shape[1]
        every = derivatives(n, 2)
        places = np.array(
            [[every.index(tuple((a == i) + (a == j) for a in range(n))) for j in range(n)] for i in range(n)]
        )
        at = np.arange(len(points))
        found: list[tuple[float, Floats]] = []
        grid = self.rule.grid
        lower, upper = np.asarray(grid.lower), grid.lower + grid.size * np.array(grid.counts)
        for _ in range(STEPS if len(points) else 0):
            field = self.jets(points, 2)
            walls = self.problem.leaf_jets(points, 2)[leaves.T, :, at] if k else np.empty((0, len(points), len(every)))
            slopes = np.moveaxis(walls[..., 1 : 1 + n], 0, 1).copy()  # (n, k, dimension)
            bordered = np.zeros((len(points), n + k, n + k))
            right = np.zeros((len(points), n + k))
            bad: Flags = np.asarray(~(np.isfinite(field).all(axis=0) & np.isfinite(walls).all(axis=(0, 2))))
            with np.errstate(all="ignore"):
                gradient, hessian = field[1 : 1 + n].T.copy(), np.moveaxis(field[places], 2, 0)
                if k:
                    slopes[bad], gradient[bad] = 0, 0
                    multipliers: Floats = np.einsum("nik,ni->nk", np.linalg.pinv(slopes), gradient)
                    hessian = hessian - np.einsum("nk,knij->nij", multipliers, walls[..., places])
                bordered[:, :n, :n] = hessian
                bordered[:, n:, :n], bordered[:, :n, n:] = slopes, np.moveaxis(slopes, 1, 2)
                right[:, :n], right[:, n:] = gradient, walls[..., 0].T
            bordered[bad], right[bad] = 0, 0
            step = np.einsum("nij,nj->ni", np.linalg.pinv(bordered, rcond=1e-12, hermitian=True), right)[:, :n]
            length = np.linalg.norm(step / self.rule.grid.size, axis=1)
            points = points - step / np.maximum(1, length)[:, None]
            there = self.inside(points)
            if there.any():
                here = points[there]
                values = self.jets(here, 0)[0]
                if np.isfinite(values).any():
                    best = int(np.nanargmin(values))
                    found.append((float(values[best]), here[best].copy()))
            points = np.clip(points, lower, upper)
        return found
