"""Lines along the height of cut pieces, with the leaves that matter on each, and intervals of these lines."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.sampling.rules.division import BoundedFunctions, span, starts
from rsym.sampling.rules.walks import SAME, walk_inside, walk_parts, walk_upright

# Of the side of a piece; more than one of those so small that a double zero is nothing but rounding all over it.
PAST, FAR = tuple(2.0**level for level in (-17, -12, -7, -3, 2, 7, 12)), 2.0**10


@dataclass(frozen=True)
class Panels:
    """Intervals of lines, each with a weight and a leaf or -1; of length 0 where the boundary crosses."""

    lower: Floats
    upper: Floats
    weight: Floats
    line: Ints
    leaf: Ints


@dataclass(frozen=True)
class Lines:
    """Lines with the values at both ends of the leaves that matter there.

    Attributes
    ----------
    piece, base, ends : (n,), (n,), (2, n)
        The piece of each line, and where it is.
    begin, leaf : (n + 1,), (m,)
        Leaves ``leaf[begin[k]:begin[k + 1]]`` matter on line k.
    upright : (m,)
        Which of them do not change along the height.
    below, above, root : (m,)
        The values at the lower and the upper end, and where they are zero between.
    past : (2, m)
        The signs beyond the ends of leaves that are zero there, as `beyond` has them.
    """

    functions: BoundedFunctions
    piece: Ints
    base: Floats
    ends: Floats
    begin: Ints
    leaf: Ints
    upright: Flags
    below: Floats
    above: Floats
    root: Floats
    past: Any

    def walked(self, weight: Floats, signs: Any) -> tuple[Panels, Panels]:
        """What is inside, and where the boundary crosses."""
        most = len(self.leaf) + 2 * len(self.piece)
        panels: Any = np.empty((3, most)), np.empty((2, most), np.int64)
        edges: Any = np.empty((3, most)), np.empty((2, most), np.int64)
        sizes = np.zeros(2, np.int64)
        functions, room = self.functions, (*panels, *edges, sizes, self._order())
        about: Any = (functions.tolerance, self.ends, weight, *self._leaves())
        if functions.gates is None:
            arguments: Any = (*about, functions.walls[self.leaf], *room)
            walk_parts(*arguments)
        else:
            arguments = (functions.gates, functions.domain_ends, functions.folds, *about, self.past, signs, *room)
            walk_inside(*arguments)
        return _panels(panels, sizes[0]), _panels(edges, sizes[1])

    def chosen(self, which: Ints) -> Lines:
        """Some of the lines."""
        counts = np.diff(self.begin)[which]
        pairs = span(self.begin[:-1][which], counts)
        parts: Any = [a[..., pairs] for a in (self.leaf, self.upright, self.below, self.above, self.root, self.past)]
        ends = self.ends[:, which]
        return Lines(self.functions, self.piece[which], self.base[..., which], ends, starts(counts), *parts)

    def walked_upright(self, kind: Ints, left: Any, right: Any, weight: Floats) -> Panels:
        """Where the boundary runs along the lines."""
        most = len(self.leaf) + len(self.piece)
        edges: Any = np.empty((3, most)), np.empty((2, most), np.int64)
        sizes = np.zeros(1, np.int64)
        sides: Any = (self.past, left, right, *edges, sizes, self._order())
        functions = self.functions
        walk_upright(
            functions.gates,
            functions.domain_ends,
            functions.folds,
            functions.tolerance,
            self.ends,
            kind,
            weight,
            *self._leaves(),
            *sides,
        )
        return _panels(edges, sizes[0])

    def _leaves(self) -> tuple[Any, ...]:
        return self.begin, self.leaf, self.upright, self.below, self.above, self.root

    def _order(self) -> Ints:
        return np.empty(int(np.diff(self.begin).max(initial=0)), np.int64)


def beyond(value: Callable[[Ints, Floats], Floats], at: Floats, way: Floats, zero: Flags, tolerance: float) -> Any:
    """The signs (n,) of functions beyond places where some are zero: as a rule the other one, 0 where it is not seen.

    A function may touch zero there and have one sign on both sides. It is looked at from near to far.
    """
    signs, some = np.zeros(len(at), np.int8), np.flatnonzero(zero)
    reach = np.abs(way) if way.ndim == 1 else np.abs(way).max(axis=1)
    for share in PAST:
        if share > 1:
            some = some[share * reach[some] <= FAR * np.sqrt(tolerance)]
        if not len(some):
            break
        found = value(some, at[some] + share * way[some])
        seen = np.abs(found) > SAME * tolerance
        signs[some[seen]] = np.sign(found[seen])
        some = some[~seen]
    return signs


def signs_at(value: Callable[[Ints, Floats], Floats], at: Floats, way: Floats, tolerance: float) -> Any:
    """The signs (n,) of functions at places; where one is zero to rounding that which it has on both sides, else -1."""
    found = value(np.arange(len(at)), at)
    zero = np.abs(found) <= tolerance
    one, other = (beyond(value, at, end * way, zero, tolerance) for end in (1, -1))
    return np.where(zero & (one * other > 0), one, np.where(found > 0, 1, -1))


def _panels(room: tuple[Floats, Ints], count: int) -> Panels:
    values, numbers = room
    return Panels(*values[:, :count], *numbers[:, :count])
