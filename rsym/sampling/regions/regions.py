"""Regions: what is left of a form in boxes, as lists of entries.

An entry is three numbers: of a leaf its number, and NONE twice; of a gate MIN or MAX and the entries of its operands;
where no operand of a gate matters, INFINITE or MINUS_INFINITE. Operands come before their gate, the last entry is the
form. From a region and the bounds of its entries over a box in it follows the region of that box.

A large leaf is in parts (`leaf_parts`): it has the entries of its operands too, whose numbers are those behind the
leaves, and so on. `choices` tell by these numbers which parts are a MIN or a MAX and nothing else, 0 of others. Of
parts the values count, whatever is to be kept of the form.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Ints
from rsym.logic.leaf_parts import NONE, LeafParts
from rsym.logic.sign_form import SignForm
from rsym.sampling.sharp.loops import loop, step

Entries: TypeAlias = NDArray[np.int32]

MIN, MAX, INFINITE, MINUS_INFINITE = -1, -2, -3, -4
KINDS: Mapping[int | str, int] = {"min": MIN, "max": MAX}
# What a region is to keep of the form: its sign, where leaves that decide it hide others that are undefined; its sign
# or its value, and that it is undefined where one of its leaves is.
SIGN, DEFINED_SIGN, VALUE = 0, 1, 2
OUTSIDE, KEPT, INSIDE = 0, 1, 2  # of a box: the form is negative, may have a zero, is positive


@dataclass(frozen=True)
class Regions:
    """Regions one after the other: that of box k is ``entries[start[k]:start[k + 1]]``."""

    start: Ints
    entries: Entries

    def __len__(self) -> int:
        return len(self.start) - 1

    def __getitem__(self, which: Any) -> Regions:
        """Some of them, in the order asked for: numbers, flags or a slice."""
        chosen = np.arange(len(self))[which]
        start = np.concatenate([[0], np.cumsum(np.diff(self.start)[chosen])])
        entries = np.empty((start[-1], 3), np.int32)
        gather(chosen, self.start, self.entries, start, entries)
        return Regions(start, entries)


def joined_regions(parts: Sequence[Regions]) -> Regions:
    """Those of several, one after the other."""
    starts = np.cumsum([0, *(part.start[-1] for part in parts)])
    first = [part.start[:-1] + begin for part, begin in zip(parts, starts[:-1], strict=True)]
    entries = [part.entries for part in parts]
    return Regions(np.concatenate([*first, starts[-1:]]).astype(np.int64), np.concatenate(entries))


def whole_form(form: SignForm) -> Regions:
    """The region in which everything matters.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import surface_form
    >>> whole_form(surface_form(rsym.Shape(rsym.conjunction(x, y), (x, y, z)))).entries.tolist()
    [[0, -1, -1], [1, -1, -1], [-1, 0, 1]]
    """
    return _region([*((k, NONE, NONE) for k in range(len(form.leaves))), *form.gates])


def whole_parts(parts: LeafParts) -> Regions:
    """The same of a form in parts."""
    return _region(parts.entries)


def choices_of(parts: LeafParts | None) -> Entries:
    """MIN, MAX or 0 by the numbers of parts; nothing of a form in none."""
    count = 0 if parts is None else len(parts.form.leaves)
    chosen = {} if parts is None else parts.choices
    return np.array([KINDS.get(chosen.get(k, ""), 0) for k in range(count)], np.int32)


def _region(rows: Sequence[tuple[int | str, int, int]]) -> Regions:
    entries = np.array([(KINDS.get(what, what), first, second) for what, first, second in rows], np.int32)
    return Regions(np.array([0, len(entries)]), entries)


def of_leaves(regions: Regions) -> Regions:
    """The same regions without what is inside leaves."""
    if not ((regions.entries[:, 0] >= 0) & (regions.entries[:, 1] != NONE)).any():
        return regions
    start, entries = np.zeros_like(regions.start), np.empty_like(regions.entries)
    most = int(np.diff(regions.start).max(initial=0))
    leave_leaves(regions.start, regions.entries, start, entries, np.empty(most, np.bool_), np.empty(most, np.int32))
    return Regions(start, entries[: start[-1]].copy())


@loop
def leave_leaves(start: Any, entries: Any, new: Any, results: Any, need: Any, where: Any) -> None:
    """Copy the gates and leaves that the form is made of, without operands of leaves."""
    made = 0
    for region in range(len(start) - 1):
        begin, count = start[region], start[region + 1] - start[region]
        for i in range(count):
            need[i] = i == count - 1
        for i in range(count - 1, -1, -1):
            if need[i] and (entries[begin + i, 0] == MIN or entries[begin + i, 0] == MAX):
                for k in range(2):
                    need[entries[begin + i, 1 + k]] = True
        for i in range(count):
            if need[i]:
                what = entries[begin + i, 0]
                where[i] = made - new[region]
                results[made, 0] = what
                for k in range(2):
                    joins = what == MIN or what == MAX
                    results[made, 1 + k] = where[entries[begin + i, 1 + k]] if joins else NONE
                made += 1
        new[region + 1] = made


@loop
def gather(chosen: Any, old: Any, entries: Any, new: Any, result: Any) -> None:
    """Copy the entries of chosen regions."""
    for k in range(len(chosen)):
        shift = old[chosen[k]] - new[k]
        for i in range(new[k], new[k + 1]):
            for j in range(3):
                result[i, j] = entries[i + shift, j]


def reduce(start: Any, entries: Any, choices: Any, bounds: Any, keeps: int, keep: Any, sizes: Any, results: Any) -> int:
    """The regions of boxes, eight in each region, one after the other; how many entries they have in all.

    `bounds` (entries, 2, 8) are those of entries over boxes; `sizes` (regions, 8) tells how many entries each has, none
    where the form has no zero; `keep`, KEPT where a box is asked for, becomes its sign there.
    """
    scratch = _scratch(int(np.diff(start).max(initial=0)))
    return int(_reduce(start, entries, choices, bounds, keeps, keep, sizes, results, *scratch))


@loop
def _reduce(
    start: Any,
    entries: Any,
    choices: Any,
    bounds: Any,
    keeps: int,
    keep: Any,
    sizes: Any,
    results: Any,
    need: Any,
    where: Any,
    idle: Any,
) -> int:
    made = 0
    for region in range(len(start) - 1):
        begin, count = start[region], start[region + 1] - start[region]
        for lane in range(sizes.shape[1]):
            sizes[region, lane] = 0
            root = begin + count - 1
            if (keeps != SIGN or len(choices)) and keep[region, lane]:
                _spread(entries, begin, count, bounds, lane, keeps)
            if keeps != VALUE and keep[region, lane] and not bounds[root, 0, lane] <= 0 <= bounds[root, 1, lane]:
                keep[region, lane] = INSIDE if bounds[root, 0, lane] > 0 else OUTSIDE
            if keep[region, lane] == KEPT:
                for i in range(count):
                    what, rule = entries[begin + i, 0], keeps
                    if what >= 0 and len(choices):
                        what, rule = choices[what], VALUE
                    idle[i] = 0
                    if what == MIN or what == MAX:
                        idle[i] = _idle(what, entries, begin + i, bounds, begin, lane, rule)
                sizes[region, lane] = _left(entries, begin, count, idle, need, where, results, made)
                made += sizes[region, lane]
    return made


@step
def _spread(entries: Any, begin: int, count: int, bounds: Any, lane: int, keeps: int) -> None:
    """Nothing is known of what has an operand of which nothing is, which may be undefined; of signs gates know more."""
    for i in range(begin, begin + count):
        if entries[i, 0] >= 0 or (keeps != SIGN and (entries[i, 0] == MIN or entries[i, 0] == MAX)):
            for k in range(2):
                operand = begin + entries[i, 1 + k]
                if entries[i, 1 + k] == NONE:
                    continue
                if bounds[operand, 0, lane] == -np.inf and bounds[operand, 1, lane] == np.inf:
                    bounds[i, 0, lane], bounds[i, 1, lane] = -np.inf, np.inf


@step
def _left(entries: Any, begin: int, count: int, idle: Any, need: Any, where: Any, results: Any, made: int) -> int:
    """Write what is left of a region without idle operands, bits 1 and 2 of a gate, and say how many entries."""
    for i in range(count):
        need[i] = i == count - 1
    for i in range(count - 1, -1, -1):
        if need[i] and entries[begin + i, 0] >= MAX:
            for k in range(2):
                if entries[begin + i, 1 + k] != NONE and not idle[i] >> k & 1:
                    need[entries[begin + i, 1 + k]] = True
    number = 0
    for i in range(count):
        if not need[i]:
            continue
        what = entries[begin + i, 0]
        a, b = NONE, NONE
        if what >= MAX:
            if idle[i] == 1 or idle[i] == 2:
                where[i] = where[entries[begin + i, 2 if idle[i] == 1 else 1]]
                continue
            if idle[i] == 3:
                what = INFINITE if what == MIN else MINUS_INFINITE
            else:
                if entries[begin + i, 1] != NONE:
                    a = where[entries[begin + i, 1]]
                if entries[begin + i, 2] != NONE:
                    b = where[entries[begin + i, 2]]
        results[made + number, 0], results[made + number, 1], results[made + number, 2] = what, a, b
        where[i] = number
        number += 1
    return number


@step
def _idle(what: int, entries: Any, entry: int, bounds: Any, values: int, lane: int, keeps: int) -> Any:
    """Which operands of a gate do not matter: bits 1 and 2."""
    a, b = values + entries[entry, 1], values + entries[entry, 2]
    if keeps != VALUE:
        if what == MIN:
            return (bounds[a, 0, lane] > 0) + 2 * (bounds[b, 0, lane] > 0)
        return (bounds[a, 1, lane] < 0) + 2 * (bounds[b, 1, lane] < 0)
    if what == MIN:
        return (bounds[a, 0, lane] > bounds[b, 1, lane]) + 2 * (bounds[b, 0, lane] > bounds[a, 1, lane])
    return (bounds[a, 1, lane] < bounds[b, 0, lane]) + 2 * (bounds[b, 1, lane] < bounds[a, 0, lane])


def without_idle(whole: Regions, words: NDArray[np.uint64]) -> Regions:
    """What is left of a whole form in boxes, by their words: bit 2*gate + operand is set where that does not matter."""
    sizes = np.empty(len(words), np.int64)
    results = np.empty((len(words) * len(whole.entries), 3), np.int32)
    made = reduce_by_words(whole.entries, words, sizes, results, *_scratch(len(whole.entries)))
    return Regions(np.concatenate([[0], np.cumsum(sizes)]), results[:made].copy())


def _scratch(most: int) -> tuple[Any, Any, Any]:
    """Which entries are needed, where they come to be, and which of their operands are idle."""
    return np.empty(most, np.bool_), np.empty(most, np.int32), np.zeros(most, np.uint8)


@loop
def reduce_by_words(entries: Any, words: Any, sizes: Any, results: Any, need: Any, where: Any, idle: Any) -> int:
    """The regions of a form, box by box; how many entries they have in all."""
    count, made = len(entries), 0
    for box in range(len(words)):
        gate = 0
        for i in range(count):
            if entries[i, 0] == MIN or entries[i, 0] == MAX:
                idle[i] = np.uint8(words[box, gate >> 5] >> np.uint64(2 * (gate & 31)) & np.uint64(3))
                gate += 1
        sizes[box] = _left(entries, 0, count, idle, need, where, results, made)
        made += sizes[box]
    return made
