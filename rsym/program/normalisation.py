"""Normalisation on nodes: the next order from the one below."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from rsym.analysis.tensors import indices, partials, unit_index, weight
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative


def next_order(builder: Builder, lower: int, order: int, *, keep_sign: bool = False) -> int:
    """The omega_m of `rsym.normalise` from omega_(m-1)."""
    size = len(builder.coordinates)
    found = partials(lower, order, builder.coordinates, partial(derivative, builder))
    slopes = [found[unit_index(size, axis)] for axis in range(size)]
    share = contraction(builder, [found[index] for index in indices(size, order)], slopes, order)
    correction = builder.mul(builder.powi(lower, order), share)
    if keep_sign:
        ratio = builder.mul(builder.powi(lower, order - 1), share)
        correction = builder.div(correction, builder.add(builder.const(1), builder.square(ratio)))
    return builder.sub(lower, correction)


def contraction(builder: Builder, entries: Sequence[int], vector: Sequence[int], order: int) -> int:
    """1/m! times the symmetric tensor with these entries, contracted m times with a vector."""
    total = builder.const(0)
    for index, entry in zip(indices(len(vector), order), entries, strict=True):
        term = builder.mul(builder.const(weight(index)), entry)
        for component, count in zip(vector, index, strict=True):
            term = builder.mul(term, builder.powi(component, count))
        total = builder.add(total, term)
    return total
