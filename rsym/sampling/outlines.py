"""Outlines: the boundary of a body in a plane, every vertex and every corner exact.

The signs of omega on the lattice decide how the vertices connect. Each vertex is
the zero of the sign form on its edge of the lattice; where two neighbours lie on
different leaves, the point that both leaves have in common goes between them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage.measure import find_contours

from rsym.codegen.builder import Builder
from rsym.codegen.differentiation import derivative
from rsym.codegen.kernel import Kernel, compile_program, run_in_blocks
from rsym.codegen.lowering import lower
from rsym.codegen.sign_form import Gate, sign_form
from rsym.model.shape import Shape
from rsym.sampling.contours import NEWTON_STEPS, ON_LEVEL, LevelLines, LevelLinesStatus
from rsym.sampling.plane import PlaneSampler
from rsym.sampling.roots import bracketed_roots

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

# A corner may stick out of the cell through which the line runs; the tip of a needle does.
REACH = 2.0
# Leaves that meet at an angle below this, in radians, have no corner to lose.
SMOOTH_JOINT = 1e-2


@dataclass(frozen=True)
class Leaves:
    """The leaves of a sign form in space, as functions of two free coordinates.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> leaves = leaves_of(rsym.Shape(rsym.conjunction(x, y, 1 - z), (x, y, z)), (0, 1), {2: 0.0})
    >>> values, gradients = leaves(np.array([[3.0, 2.0]]))
    >>> leaves.active(values)[0].tolist(), gradients[:, 0].tolist()
    ([1.0], [[1.0, 0.0], [0.0, 1.0], [0.0, 0.0]])
    """

    kernel: Kernel
    gates: tuple[Gate, ...]
    free: tuple[int, int]
    fixed: Mapping[int, float]
    letters: Mapping[Any, float] | None

    def __call__(self, points: Array) -> tuple[Array, Array]:
        """The values (leaves, n) and the gradients (leaves, n, 2) at points (n, 2)."""
        program = self.kernel.program
        coordinates = [np.full(len(points), self.fixed.get(k, 0.0)) for k in range(3)]
        coordinates[self.free[0]], coordinates[self.free[1]] = points.T
        values = self.kernel.letters.values_with(self.letters)
        out = np.empty((len(program.outputs), len(points)))
        letters = [values[name] for name in program.letters]
        run_in_blocks(self.kernel.function, coordinates, letters, out, self.kernel.threads)
        parts = out.reshape(len(out) // 3, 3, len(points))
        return parts[:, 0], parts[:, 1:].transpose(0, 2, 1)

    def active(self, values: Array) -> tuple[Array, Ints]:
        """The value of the form, and the number of the leaf that gives it."""
        joined = [(row, np.full(len(row), k)) for k, row in enumerate(values)]
        for operation, first, second in self.gates:
            (f, i), (g, j) = joined[first], joined[second]
            take = f <= g if operation == "min" else f >= g
            joined.append((np.where(take, f, g), np.where(take, i, j)))
        return joined[-1]

    def distance(self, points: Array) -> tuple[Array, Ints]:
        """How far the zero of the active leaf is, to first order, and which leaf it is."""
        values, gradients = self(points)
        value, leaf = self.active(values)
        slope = np.linalg.norm(gradients[leaf, np.arange(len(points))], axis=1)
        with np.errstate(all="ignore"):
            return np.abs(value) / slope, leaf

    def common(self, points: Array, one: Ints, other: Ints) -> Array:
        """Newton from points to the common zeros of two leaves each; NaN or far away where there is none."""
        at = np.arange(len(points))
        for _ in range(NEWTON_STEPS):
            values, gradients = self(points)
            (f, g), (p, q) = ((array[one, at], array[other, at]) for array in (values, gradients))
            with np.errstate(all="ignore"):
                determinant = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
                step = np.stack([g * p[:, 1] - f * q[:, 1], f * q[:, 0] - g * p[:, 0]]) / determinant
            points = points + step.T
        return points


def leaves_of(
    shape: Shape, free: tuple[int, int], fixed: Mapping[int, float], letters: Mapping[Any, float] | None = None
) -> Leaves:
    """Compile value and gradient in the plane of each leaf of a shape."""
    builder = Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(shape.letters))
    form = sign_form(builder, lower(builder, shape.expression))
    outputs = {}
    for k, leaf in enumerate(form.leaves):
        outputs[f"leaf_{k}"] = leaf
        outputs.update({f"leaf_{k}_{i}": derivative(builder, leaf, builder.coordinates[i]) for i in free})
    kernel = compile_program(builder.program(outputs), (), shape)
    return Leaves(kernel, form.gates, free, fixed, letters)


def outline(sampler: PlaneSampler, leaves: Leaves) -> LevelLines:
    """The lines omega = 0 of a prepared plane."""
    values = sampler.values()
    # Signs alone: then every vertex lies in the middle of its edge, and its edge is known.
    found = find_contours(np.where(np.isnan(values), np.nan, np.where(values >= 0, 1.0, -1.0)), 0.0)
    cell = min(sampler.lattice.spacing)
    index = np.concatenate([*found, np.empty((0, 2))])
    points = _on_edges(sampler, leaves, index)
    distance, leaf = leaves.distance(points)
    starts = np.cumsum([0, *map(len, found)])
    joints = np.flatnonzero(np.diff(leaf))
    joints = joints[~np.isin(joints + 1, starts)]
    reach = REACH * np.array(sampler.lattice.spacing)
    places, corners, unresolved = _corners(leaves, points, leaf, joints, reach, cell)
    ends = starts + np.searchsorted(places, starts)
    lines = tuple(np.split(np.insert(points, places, corners, axis=0), ends[1:-1])) if found else ()
    closed = sum(bool((line[0] == line[-1]).all()) for line in found)
    status = LevelLinesStatus(
        vertices=sum(map(len, lines)),
        kept=int(np.count_nonzero(~(distance <= ON_LEVEL * cell))),
        undefined_samples=int(np.isnan(values).sum()),
        closed=closed,
        open=len(found) - closed,
        unresolved_corners=unresolved,
    )
    return LevelLines(lines, 0.0, "value", status)


def _on_edges(sampler: PlaneSampler, leaves: Leaves, index: Array) -> Array:
    """The zero of the form on the edge of each vertex; `index` holds the middles of the edges."""
    low = np.floor(index)
    along = index - low > 0
    ends = [sampler.lattice.points(low + k * along) for k in (0, 1)]

    def form(points: Array) -> Array:
        return leaves.active(leaves(points)[0])[0]

    def at(t: Array, which: Ints) -> Array:
        return form(sampler.lattice.points(low[which] + t[:, None] * along[which]))

    t = bracketed_roots(at, form(ends[0]), form(ends[1]))
    return sampler.lattice.points(low + t[:, None] * along)


def _corners(
    leaves: Leaves, points: Array, leaf: Ints, joints: Ints, reach: Array, cell: float
) -> tuple[Ints, Array, int]:
    """Where to insert which corners after vertices whose successor lies on another leaf; how many were not found.

    Where the leaves of both have their common zero behind a third one, that one comes between them.
    """
    one, other = leaf[joints], leaf[joints + 1]
    middle = (points[joints] + points[joints + 1]) / 2

    def corner(which: Ints, start: Array, one: Ints, other: Ints) -> tuple[Array, NDArray[np.bool_], Ints]:
        found = leaves.common(start, one, other)
        near: NDArray[np.bool_] = np.all(np.abs(found - middle[which]) <= reach, axis=1)
        found = np.where(near[:, None], found, start)
        distance, active = leaves.distance(found)
        return found, near & (distance <= ON_LEVEL * cell), active

    every = np.arange(len(joints))
    single, exact, third = corner(every, middle, one, other)
    rest = every[~exact]
    before, first, _ = corner(rest, single[rest], one[rest], third[rest])
    after, second, _ = corner(rest, single[rest], third[rest], other[rest])
    double = first & second
    places = np.concatenate([every[exact], np.repeat(rest[double], 2)])
    corners = np.concatenate([single[exact], np.stack([before, after], axis=1)[double].reshape(-1, 2)])
    order = np.argsort(places, kind="stable")
    missed = rest[~double]
    turn = _turn(leaves, points[joints[missed]], points[joints[missed] + 1], one[missed], other[missed])
    return joints[places[order]] + 1, corners[order], int(np.count_nonzero(turn > SMOOTH_JOINT))


def _turn(leaves: Leaves, before: Array, after: Array, one: Ints, other: Ints) -> Array:
    """The sine of the angle between a leaf at one point and another leaf at the next."""
    at = np.arange(len(before))
    (p, q), (u, v) = leaves(before)[1][one, at].T, leaves(after)[1][other, at].T
    with np.errstate(all="ignore"):
        turn: Array = np.abs(p * v - q * u) / np.hypot(p, q) / np.hypot(u, v)
    return turn
