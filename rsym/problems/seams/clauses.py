"""Clauses: a conjunction of disjunctions of literals that holds of some rows and not of others.

A monotone formula of literals that tells two sets of rows apart is there if and only if each row of the one has a
literal that holds there and not in each row of the other; straight polygons always have one. Sources: V. Shapiro and
D. L. Vossler, Separation for boundary to CSG conversion (1993); D. Dobkin, L. Guibas, J. Hershberger and J. Snoeyink,
An efficient algorithm for finding the CSG representation of a simple polygon (1988).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from rsym.arrays import Flags, Ints

MOST_LITERALS = 5  # in a clause
LOOKED_AT = 2000  # clauses for a row

Clause = tuple[int, ...]


def clauses_of(inside: Flags, outside: Flags, boundary: Flags, own: Ints) -> tuple[Clause, ...] | int:
    """Clauses of which each row inside has a literal of all, any other none of one; else a literal that has none.

    A clause of a row on the boundary begins with the literal that is zero there. Literals that bound are preferred;
    others separate. Of clauses that do as much those of few literals are taken.

    Examples
    --------
    >>> inside = np.array([[1, 0, 1, 0], [1, 0, 0, 1], [0, 1, 1, 0]], bool)
    >>> boundary = np.array([[0, 0, 0, 1], [0, 1, 0, 0]], bool)
    >>> clauses_of(inside, np.zeros((0, 4), bool), boundary, np.array([0, 2]))
    ((0, 2),)
    """
    inside = np.unique(inside, axis=0)
    every = np.unique(np.column_stack([boundary, own]).astype(np.int64), axis=0)
    rows, first = every[:, :-1].astype(np.bool_), every[:, -1]
    outside = np.unique(outside, axis=0)
    rows = np.concatenate([rows, outside])
    first = np.concatenate([first, np.full(len(outside), -1)])
    bounding = sorted({*own.tolist()})
    rest = [one for one in range(inside.shape[1]) if one not in bounding]
    left, found = np.ones(len(rows), np.bool_), list[Clause]()
    while left.any():
        row = int(np.flatnonzero(left)[0])
        best: tuple[int, int, Clause] | None = None
        for pool in (bounding, [*bounding, *rest]):
            free = [one for one in pool if one != first[row] and not rows[row, one]]
            start = () if first[row] < 0 else (int(first[row]),)
            for clause in islice(_covers(inside, free, start), LOOKED_AT):
                told = int((~rows[:, clause].any(axis=1) & left).sum()), -len(clause)
                if best is None or told > best[:2]:
                    best = (*told, clause)
            if best is not None:
                break
        if best is None:
            return int(first[row])
        found.append(best[2])
        left &= rows[:, best[2]].any(axis=1)
    return tuple(found)


def _covers(inside: Flags, free: Sequence[int], start: Clause) -> Iterator[Clause]:
    """Clauses that begin so, of which each row has a literal: shorter ones first, none with one literal too many."""
    for most in range(len(start), MOST_LITERALS + 1):
        yield from _longer(inside, free, start, most)


def _longer(inside: Flags, free: Sequence[int], clause: Clause, most: int) -> Iterator[Clause]:
    left = ~inside[:, clause].any(axis=1) if clause else np.ones(len(inside), np.bool_)
    if not left.any():
        if len(clause) == most and clause:
            yield clause
        return
    if len(clause) >= most:
        return
    rows = inside[left][:, free]
    hard = int(rows.sum(axis=1).argmin())
    for place in np.flatnonzero(rows[hard]).tolist():
        # What stands before the place was tried already.
        rest = [one for k, one in enumerate(free) if k > place or not rows[hard, k]]
        yield from _longer(inside, rest, (*clause, free[place]), most)
