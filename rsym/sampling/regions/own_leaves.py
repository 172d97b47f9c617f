"""Many functions, each at points of its own: value and gradient, with nothing compiled for them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.logic.sign_form import SignForm, shape_builder
from rsym.model.shape import Bounds, Shape
from rsym.program.lowering import lower_all
from rsym.sampling.kernels.mesher_kernels import in_order, padded
from rsym.sampling.regions.region_kernels import RegionKernels

ACROSS = "across it"  # kernels have three coordinates; no user has one of this name
FLAT: Mapping[int, float] = {2: 0.0}


def across(shape: Shape) -> Sequence[str]:
    """The coordinate that a shape in the plane lacks."""
    return (ACROSS,) if shape.dimension == 2 else ()


def unscaled(kernels: RegionKernels, letters: Mapping[str, float], bounds: Bounds | None = None) -> RegionKernels:
    """Kernels with letters, the leaves as they are, for questions that come mostly from within bounds in space."""
    own = kernels.copy()
    own.take((in_order(kernels.form, letters), np.ones(len(kernels.form.leaves)), bounds))
    return own


@dataclass(frozen=True)
class OwnLeaves:
    """The leaves of a form as functions of its free coordinates.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> both = own_leaves(rsym.Shape(x, (x, y)), [x * y, 3 * x])
    >>> both.leaf(np.array([[2.0, 5.0], [1.0, 7.0]]), np.array([0, 1]))
    (array([10.,  3.]), array([[5., 2.],
           [3., 0.]]))
    """

    kernels: RegionKernels
    free: tuple[int, ...]
    fixed: Mapping[int, float]

    def leaf(self, points: Floats, leaf: Ints) -> tuple[Floats, Floats]:
        """The value (n,) and the gradient (n, free) of the leaf of each point (n, free)."""
        places = self.in_space(points)
        value, gradient = np.empty(places.shape[1]), np.empty(places.shape)
        self.kernels.leaf(len(points), leaf.astype(np.int16), places, value, gradient)
        return value[: len(points)], gradient[list(self.free), : len(points)].T

    def in_space(self, points: Floats) -> Floats:
        """Points as kernels take them."""
        places = np.zeros((3, padded(len(points))))
        places[list(self.fixed)] = np.array([*self.fixed.values()])[:, None]
        places[list(self.free), : len(points)] = points.T
        return places


def own_leaves(shape: Shape, expressions: Sequence[Any]) -> OwnLeaves:
    """Expressions in the coordinates and letters of a shape, letters at their defaults."""
    builder = shape_builder(shape, *across(shape))
    form = SignForm(builder, tuple(lower_all(builder, expressions)), ())
    kernels = unscaled(RegionKernels(form, shared=True), shape.letters.values_with(None))
    return OwnLeaves(kernels, tuple(range(shape.dimension)), FLAT if shape.dimension == 2 else {})
