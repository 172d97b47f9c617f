"""The leaves of a sign form in a plane: which one is the boundary where, and where two of them meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.backends.kernel import Kernel, compile_program, run_in_blocks
from rsym.logic.sign_form import Gate, shape_form, through
from rsym.model.shape import Shape
from rsym.program.differentiation import derivative

NEWTON_STEPS = 12


@dataclass(frozen=True)
class PlaneLeaves:
    """The leaves of a sign form, as functions of two free coordinates.

    `flat` are leaves that are zero all over the plane: the plane runs along a face of theirs.
    Zero counts as inside, so they are left out of what bounds the section.

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
    flat: tuple[int, ...] = ()

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """The values (leaves, n) and the gradients (leaves, n, 2) at points (n, 2)."""
        program = self.kernel.program
        coordinates = [np.full(len(points), self.fixed.get(k, 0.0)) for k in range(len(program.coordinates))]
        coordinates[self.free[0]], coordinates[self.free[1]] = points.T
        values = self.kernel.letters.values_with(self.letters)
        out = np.empty((len(program.outputs), len(points)))
        letters = [values[name] for name in program.letters]
        run_in_blocks(self.kernel.function, coordinates, letters, out, self.kernel.threads)
        parts = out.reshape(len(out) // 3, 3, len(points))
        parts[list(self.flat), 0] = np.inf
        return parts[:, 0], parts[:, 1:].transpose(0, 2, 1)

    def at(self, fixed: Mapping[int, float], points: Floats) -> PlaneLeaves:
        """The same in another plane; `points` are some of it."""
        plane = replace(self, fixed=fixed, flat=())
        return replace(plane, flat=tuple(np.flatnonzero((plane(points)[0] == 0).all(axis=1)).tolist()))

    def active(self, values: Floats) -> tuple[Floats, Ints]:
        """The value of the form, and the number of the leaf that gives it."""
        return active_leaf(self.gates, values)

    def form(self, points: Floats) -> Floats:
        """The value of the form."""
        return self.active(self(points)[0])[0]

    def distance(self, points: Floats) -> tuple[Floats, Ints]:
        """How far the zero of the active leaf is, to first order, and which leaf it is."""
        values, gradients = self(points)
        value, leaf = self.active(values)
        slope = np.linalg.norm(gradients[leaf, np.arange(len(points))], axis=1)
        with np.errstate(all="ignore"):
            return np.abs(value) / slope, leaf

    def slide(self, points: Floats, leaf: Ints) -> Floats:
        """Newton from each point onto its leaf."""
        at = np.arange(len(points))
        for _ in range(NEWTON_STEPS):
            values, gradients = self(points)
            f, p = values[leaf, at], gradients[leaf, at]
            with np.errstate(all="ignore"):
                points = points - (f / np.einsum("ij,ij->i", p, p))[:, None] * p
        return points

    def common(self, points: Floats, one: Ints, other: Ints) -> Floats:
        """Newton from points to the common zeros of two leaves each; NaN or far away where there is none."""
        at = np.arange(len(points))
        for _ in range(NEWTON_STEPS):
            values, gradients = self(points)
            f, g = values[one, at], values[other, at]
            (p, q), (u, v) = gradients[one, at].T, gradients[other, at].T
            with np.errstate(all="ignore"):
                points = points - np.stack([f * v - g * q, g * p - f * u], axis=1) / (p * v - q * u)[:, None]
        return points


def active_leaf(gates: Sequence[Gate], values: Sequence[Floats] | Floats) -> tuple[Floats, Ints]:
    """The values of a form whose leaves have the values (leaves, n), and the number of the leaf that gives each."""

    def join(gate: Gate, one: tuple[Floats, Ints], other: tuple[Floats, Ints]) -> tuple[Floats, Ints]:
        (f, i), (g, j) = one, other
        take = f <= g if gate.operation == "min" else f >= g
        return np.where(take, f, g), np.where(take, i, j)

    return through(gates, [(row, np.full(len(row), k)) for k, row in enumerate(values)], join)[-1]


def leaves_of(
    shape: Shape, free: tuple[int, int], fixed: Mapping[int, float], letters: Mapping[Any, float] | None = None
) -> PlaneLeaves:
    """Compile value and gradient in the plane of each leaf of a shape."""
    form = shape_form(shape)
    builder = form.builder
    outputs = {}
    for k, leaf in enumerate(form.leaves):
        outputs[f"leaf_{k}"] = leaf
        outputs.update({f"leaf_{k}_{i}": derivative(builder, leaf, builder.coordinates[i]) for i in free})
    kernel = compile_program(builder.program(outputs), (), shape)
    return PlaneLeaves(kernel, form.gates, free, fixed, letters)
