"""Leaves of about the same slope, for weights.

A disjunction f + g + sqrt(f**2 + g**2) falls from 2f to f where -g grows beyond f. If g is far steeper, as the slab of
a thin rib that runs through a disc, that is a ridge of the width of the rib all through the disc, which no spline
follows: its energy holds the solution down to 0 there.
"""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np

from rsym.backends.kernel import compile_program
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Shape
from rsym.problems.pointwise import at_letters, with_derivatives
from rsym.sampling.windows import bounds_or_extent

# How many times the slope of the flattest leaf is left as it is. A rib of a hundredth of a disc's width took 13 % of
# the integral of -laplacian(u) = 1 on 20 cells, one of a tenth 0.4 %, which is what its corners take.
LIKE = 16.0
SAMPLES = {2: 17, 3: 9}  # along each axis


def of_like_slopes(shape: Shape, form: SignForm) -> tuple[int, ...]:
    """The leaves of a form, divided by a power of 2 where they are far steeper than another; as they are without "or".

    The slope of a leaf is the median over the box of the shape.
    """
    if all(gate.operation == "min" for gate in form.gates):
        return form.leaves
    b, dimension = form.builder, len(shape.coordinates)
    nodes = {str(number): leaf for number, leaf in enumerate(form.leaves)}
    program = b.program(with_derivatives(b, nodes, b.coordinates, 1))
    ends = np.array(bounds_or_extent(shape, None))
    axes = [low + (high - low) * (np.arange(SAMPLES[dimension]) + 0.5) / SAMPLES[dimension] for low, high in ends]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, dimension)
    with np.errstate(all="ignore"):
        found = at_letters(shape, compile_program(program, (), shape, backend="numpy"))(points)
        slopes = np.linalg.norm(found.reshape(len(nodes), 1 + dimension, -1)[:, 1:], axis=1)
    usual = np.median(slopes, axis=1)
    usual = np.where(np.isfinite(usual) & (usual > 0), usual, math.inf)
    flattest = usual.min()
    made = []
    for leaf, slope in zip(form.leaves, usual.tolist(), strict=True):
        steep = math.isfinite(slope) and slope > LIKE * flattest
        made.append(b.mul(b.const(Fraction(1, 2 ** round(math.log2(slope / flattest)))), leaf) if steep else leaf)
    return tuple(made)
