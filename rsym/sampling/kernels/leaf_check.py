"""The check of freshly compiled leaves against the interpreter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from rsym.backends.checking import CHECK_POINTS, check_at
from rsym.program.precision import FLOAT64
from rsym.program.program import Program
from rsym.sampling.kernels.routines import LANES

Floats = NDArray[np.float64]


class Leaves(Protocol):
    """What is checked of kernels: `program` has value and derivatives of one leaf after the other."""

    program: Program

    def set_points(self, letters: Sequence[float]) -> None:
        """Take letters."""

    def leaf(self, count: int, leaf: NDArray[np.int16], points: Floats, value: Floats, gradient: Floats) -> None:
        """Value and gradient of the leaf of each point."""


def check_leaves(kernels: Leaves) -> None:
    """Compare all leaves with the interpreter: a miscompiled formula must never get any further."""
    generator = np.random.default_rng(20130605)
    points = [generator.uniform(-1, 1, CHECK_POINTS) for _ in range(3)]
    letters = [1.0 + k / 8 for k in range(len(kernels.program.letters))]
    check_at(kernels.program, _AllLeaves(kernels), FLOAT64, points, letters)


class _AllLeaves:
    """Values and gradients of all leaves, as a backend computes outputs."""

    block_size = CHECK_POINTS
    source = ""

    def __init__(self, kernels: Any) -> None:
        self.kernels = kernels

    def run(self, coordinates: Sequence[Floats], letters: Sequence[float], outputs: Sequence[Floats]) -> None:
        count = len(coordinates[0])
        self.kernels.set_points(letters)
        points = np.zeros((3, count + LANES))
        points[:, :count] = coordinates
        value, gradient = np.zeros(points.shape[1]), np.zeros(points.shape)
        for number in range(len(outputs) // 4):
            self.kernels.leaf(count, np.full(points.shape[1], number, np.int16), points, value, gradient)
            for row, output in zip((value, *gradient), outputs[4 * number : 4 * number + 4], strict=True):
                output[:] = row[:count]
