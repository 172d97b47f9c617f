"""Copies that keep apart, each in a cell of its own: the largest of them is the shape; nothing folds or jumps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import sympy as sp

from rsym.errors import RsymError
from rsym.model.bounding import BoundingBox
from rsym.model.equation import combine, substituted
from rsym.model.shape import Shape
from rsym.model.symbols import postorder
from rsym.model.systems import R1

MOST_PARTS = 6_000  # of all copies together: beyond that a fold, whose formula does not grow, is the better way
ROOM = 1e-9  # of the size of the motif: what it keeps from the borders of its cell

Places = Mapping[sp.Symbol, sp.Expr]


def apart(
    shape: Shape, copies: Sequence[Places], sides: Sequence[Places], side: sp.Symbol, box: BoundingBox | None
) -> Shape | None:
    """The largest of the copies, omega of each carried to its place; None where that is not known to be their union.

    It is where the motif has no letters, is not too long for so many copies, and provably lies where the coordinate
    `side` is positive after each of the maps `sides`. Near the boundary the largest is the one copy that bounds there,
    so every order of normalisation is kept.
    """
    formulas = [formula for places in (*copies, *sides) for formula in places.values()]
    known = set(shape.coordinates)
    if len(copies) < 2 or shape.letters or not all(formula.free_symbols <= known for formula in formulas):
        return None
    if len(copies) * len(postorder(shape.expression)) > MOST_PARTS:
        return None
    if not all(_is_beside(substituted(shape, places), side) for places in sides):
        return None
    made: Shape = combine(R1.disjunction, *(substituted(shape, places) for places in copies), box=lambda boxes: box)
    return made


def _is_beside(shape: Shape, side: sp.Symbol) -> bool:
    """Whether a shape is bounded, and lies where a coordinate is positive."""
    from rsym.sampling.extent import extent

    try:
        bounds = extent(shape)
    except RsymError:
        return False
    low, high = bounds[shape.coordinates.index(side)]
    return low > ROOM * (high - low) and not shape.contains(*(2 * last - first for first, last in bounds))
