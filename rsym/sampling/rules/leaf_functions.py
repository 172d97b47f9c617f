"""The leaves of a sign form as functions at points and over boxes, each scaled to gradients of length about 1."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.logic.lifting import opened
from rsym.logic.sign_form import Gate, SignForm, surface_form
from rsym.model.recent import recently
from rsym.model.shape import Bounds, Shape
from rsym.sampling.kernels.mesher_kernels import (
    MesherKernels,
    backend_for,
    letters_of_form,
    median_scales,
    mesher_kernels,
)
from rsym.sampling.regions.own_leaves import across, unscaled
from rsym.sampling.regions.region_kernels import region_kernels
from rsym.sampling.sharp.crossings import CompiledLeaves

EPSILON = float(np.finfo(np.float64).eps)


class LeafFunctions:
    """The leaves of a shape at letters, seen from a box of bounds.

    Attributes
    ----------
    dimension : int
        2 or 3.
    count : int
        How many leaves there are.
    gates : (n, 3) int
        0 for a min and 1 for a max, and its operands.
    tolerance : float
        A scaled value up to this is zero to rounding: it belongs to a distance of some last places of the bounds.
    """

    def __init__(self, shape: Shape, form: SignForm, letters: Mapping[Any, float] | None, bounds: Bounds) -> None:
        self.dimension, self.count = shape.dimension, len(form.leaves)
        self.gates = gate_array(form.gates)
        self.tolerance = 8 * EPSILON * max(abs(end) for pair in bounds for end in pair)
        box = (*bounds, (-1.0, 1.0))[:3]
        values = shape.letters.values_with(letters)
        kernels: Any = _kernels(form).copy()
        kernels.set(values, box)
        plain = letters_of_form(form, values, box)
        if isinstance(kernels, MesherKernels):
            kernels.set_points([*plain, *[1.0] * self.count])
        else:
            kernels = unscaled(kernels, dict(zip(form.builder.letters, plain, strict=True)), box)
        self.scales = median_scales(kernels, self.count, box)
        self._leaves = CompiledLeaves(kernels)

    def evaluate(self, leaf: Ints, points: Floats) -> tuple[Floats, Floats]:
        """Values (n,) of leaf[k] at point k of (dim, n), and gradients (dim, n)."""
        value, gradient = self._leaves.evaluate(leaf.astype(np.int16), self._in_space(points))
        scale = self.scales[leaf]
        return value * scale, gradient[: self.dimension] * scale

    def enclose(self, leaf: Ints, lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
        """Bounds (2, n) of leaf[k] over box k of (dim, n), and (dim, 2, n) of its gradient; infinite if undefined."""
        value, gradient = self._leaves.enclose(leaf.astype(np.int16), self._in_space(lower), self._in_space(upper))
        scale = self.scales[leaf]
        return value * scale, gradient[: self.dimension] * scale

    def _in_space(self, points: Floats) -> Floats:
        return points if self.dimension == 3 else np.vstack([points, np.zeros(points.shape[1])])


@recently(16)
def rule_form(shape: Shape, capped: bool) -> SignForm:
    """The sign form of a shape as kernels want it, in three coordinates; its first leaves are those of the shape."""
    form = opened(surface_form(shape, *across(shape)))
    return form.capped() if capped else form


def gate_array(gates: tuple[Gate, ...]) -> Ints:
    """Gates as rows of whole numbers."""
    return np.array([(operation == "max", *operands) for operation, *operands in gates], np.int64).reshape(-1, 3)


def _kernels(form: SignForm) -> Any:
    return region_kernels(form) if backend_for(form) == "tape" else mesher_kernels(form)
