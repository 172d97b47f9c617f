"""Leaves by number: bounds over boxes, values and gradients at points, and which of them is active."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.sampling.kernels.mesher_kernels import MesherKernels, columns, padded

Numbers = NDArray[np.int16]


class Leaves(Protocol):
    """What certificates, and the measures of what is thin, need of a sign form; arrays are of any layout."""

    def enclose(self, leaf: Numbers, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds (2, n) of leaf[k] over box k of (3, n), and (3, 2, n) of its gradient; infinite where it may fail."""

    def evaluate(self, leaf: Numbers, points: Floats) -> tuple[Floats, Floats]:
        """Values (n,) of leaf[k] at point k of (3, n), and gradients (3, n)."""

    def active(self, points: Floats) -> tuple[Floats, Numbers]:
        """Values (n,) of the form at points (3, n), and the number of the leaf that gives each."""


class CompiledLeaves:
    """The leaves of compiled kernels."""

    def __init__(self, kernels: MesherKernels) -> None:
        self._kernels = kernels

    def enclose(self, leaf: Numbers, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds of leaves and gradients over boxes."""
        count = len(leaf)
        bounds = np.empty((8, padded(count)))
        self._kernels.enclose(count, _numbers(leaf), columns(lower), columns(upper), bounds)
        return bounds[:2, :count].copy(), bounds[2:, :count].reshape(3, 2, count)

    def evaluate(self, leaf: Numbers, points: Floats) -> tuple[Floats, Floats]:
        """Values and gradients of leaves at points."""
        count = len(leaf)
        value, gradient = np.empty(padded(count)), np.empty((3, padded(count)))
        self._kernels.leaf(count, _numbers(leaf), columns(points), value, gradient)
        return value[:count], gradient[:, :count]

    def active(self, points: Floats) -> tuple[Floats, Numbers]:
        """The form at points, and its active leaf."""
        count = points.shape[1]
        value, leaf = np.empty(padded(count)), np.empty(padded(count), np.int16)
        self._kernels.value(count, columns(points), value, leaf)
        return value[:count], leaf[:count]


def _numbers(leaf: Numbers) -> Numbers:
    """Numbers of leaves, and behind them -1, which asks for nothing."""
    array = np.full(padded(len(leaf)), -1, np.int16)
    array[: len(leaf)] = leaf
    return array
