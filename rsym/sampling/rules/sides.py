"""Sides of cells that nothing of a shape crosses: what lies on both is joined by some other way, if at all."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.gaps import leaf_roots, signs
from rsym.sampling.rules.quadrature import Quadrature

LINES = 5  # across a side, in space along each of its axes
PIECES = 4  # of a line, in each of which a leaf is taken for a cubic
AT_ONCE = 2**14


def closed_sides(functions: Any, rule: Quadrature) -> Ints:
    """Pairs (n, 2) of cells next to each other, both touched, with nothing of the shape on the side between them.

    functions : the leaves that the rule was made of. A side that a full cell has is open. The others are looked at on
    lines, where leaves have their roots, and where points of the rule in both cells are seen from the side.

    Examples
    --------
    >>> import rsym
    >>> from rsym.sampling.rules.quadrature import prepared
    >>> halves = prepared(rsym.rectangle(1, 2, (-0.6, 0)) | rsym.rectangle(1, 2, (0.6, 0)), None, None)
    >>> closed_sides(halves.functions, halves.rule(10, 4)).tolist()[:2]
    [[40, 50], [41, 51]]
    """
    full = np.zeros(int(np.prod(rule.grid.counts)), np.bool_)
    full[rule.full] = True
    found = [np.empty((0, 2), np.int64)]
    for axis, pairs in enumerate(_neighbours(rule)):
        pairs = pairs[~full[pairs].any(axis=1)]
        for met in (_met, _crossed):
            pairs = pairs[~met(functions, *_lines(rule, pairs[:, 1], axis))]
        found.append(pairs[~_seen_from(functions, rule, pairs, axis)] if len(pairs) else pairs)
    return np.concatenate(found)


def pieces_of(rule: Quadrature) -> Ints:
    """For each cell the number of the piece of the shape that it has, -1 of none: cells next to each other have one.

    What sides tell apart has to be known (`closed_sides`); pieces that meet in a cell are one.

    Examples
    --------
    >>> import rsym
    >>> discs = rsym.quadrature(rsym.disc(1) | rsym.disc(1, (3, 0)), cells=20)
    >>> sorted(set(pieces_of(discs).tolist()))
    [-1, 0, 1]
    """
    total = int(np.prod(rule.grid.counts))
    both = np.array([total, 1])
    joined = np.setdiff1d(np.concatenate(list(_neighbours(rule))) @ both, rule.closed @ both)
    links = coo_matrix((np.ones(len(joined)), np.divmod(joined, total)), shape=(total, total))
    _, found = connected_components(links, directed=False)
    pieces = np.full(total, -1, np.int64)
    _, pieces[rule.touched] = np.unique(found[rule.touched], return_inverse=True)
    return pieces


def _neighbours(rule: Quadrature) -> Iterator[Ints]:
    """For each axis the pairs (n, 2) of touched cells next to each other along it."""
    counts = rule.grid.counts
    touched, index = np.zeros(int(np.prod(counts)), np.bool_), np.indices(counts).reshape(len(counts), -1)
    touched[rule.touched] = True
    for axis, count in enumerate(counts):
        first = np.flatnonzero(index[axis] < count - 1)
        second = first + int(np.prod(counts[axis + 1 :]))
        asked = touched[first] & touched[second]
        yield np.stack([first[asked], second[asked]], axis=1)


def _lines(rule: Quadrature, cells: Ints, axis: int) -> tuple[Floats, Floats]:
    """The ends (dim, lines, cells) of lines on the lower sides of cells."""
    lower, size = rule.grid.corners(cells)[0], rule.grid.size
    others = [k for k in range(len(lower)) if k != axis]
    begins, ends = [], []
    for along in others:
        steps = [0.0] if len(others) == 1 else np.linspace(0, 1, LINES)
        for across in steps:
            begin = lower.copy()
            for other in others:
                if other != along:
                    begin[other] += across * size
            end = begin.copy()
            end[along] += size
            for first, last in pairwise(np.linspace(0, 1, PIECES + 1)):
                begins.append(begin + first * (end - begin))
                ends.append(begin + last * (end - begin))
    return np.stack(begins, axis=1), np.stack(ends, axis=1)


def _met(functions: Any, begin: Floats, end: Floats) -> Flags:
    """Which cells have something of the shape in the middle of one of a few of their lines."""
    some = (begin[:, 1::3] + end[:, 1::3]) / 2
    return np.asarray((signs(functions, some.reshape(len(some), -1)) > 0).reshape(some.shape[1:]).any(axis=0))


def _crossed(functions: Any, begin: Floats, end: Floats) -> Flags:
    """Which cells have something of the shape on some of their lines."""
    dimension, lines, count = begin.shape
    met = np.zeros(lines * count, np.bool_)
    begin, along = begin.reshape(dimension, -1), (end - begin).reshape(dimension, -1)
    size = max(1, AT_ONCE // functions.count)
    for first in range(0, lines * count, size):
        some = slice(first, first + size)
        roots = np.sort(np.minimum(leaf_roots(functions, begin[:, some], along[:, some]), 1.0), axis=0)
        row = np.zeros((1, roots.shape[1]))
        for lower, upper in pairwise(np.concatenate([row, roots, row + 1])):
            asked = np.flatnonzero((upper > lower) & ~met[some]) + first
            middle = ((lower + upper) / 2)[asked - first]
            met[asked] = signs(functions, begin[:, asked] + middle * along[:, asked]) > 0
    return np.asarray(met.reshape(lines, count).any(axis=0))


def _seen_from(functions: Any, rule: Quadrature, pairs: Ints, axis: int) -> Flags:
    """Which sides between cells have some of the shape straight across from points of the rule in either cell."""
    place = rule.grid.corners(pairs[:, 1])[0][axis]
    met = np.zeros(len(pairs), np.bool_)
    for column in pairs.T:
        order = np.argsort(column)
        begin, end = (np.searchsorted(rule.cells, column[order], side) for side in ("left", "right"))
        points = np.concatenate([np.arange(low, high) for low, high in zip(begin, end, strict=True)])
        owner = np.repeat(order, end - begin)
        moved = rule.points[points].T.copy()
        moved[axis] = place[owner]
        met[owner[signs(functions, moved) > 0]] = True
    return met
