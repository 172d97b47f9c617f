"""Regions: what is left of a form in boxes, as lists of entries, and the rows of their tapes.

An entry is three numbers: of a leaf its number, and nothing more; of a gate MIN or MAX and the entries of its operands;
where no operand of a gate matters, INFINITE or MINUS_INFINITE. Operands come before their gate, the last entry is the
form. From a region and the bounds of its entries over a box in it follows the region of that box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.backends.tape_code import ROW_VECTORS, VARIES
from rsym.logic.sign_form import SignForm
from rsym.program.tape import WIDTH, patterns
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.regions.leaf_tapes import LeafTapes
from rsym.sampling.sharp.loops import loop, step

Entries: TypeAlias = NDArray[np.int32]

MIN, MAX, INFINITE, MINUS_INFINITE = -1, -2, -3, -4
SIGN, VALUE = 0, 1  # what a region is to keep of the form: its sign, or its value
VECTOR = 8 * LANES  # bytes


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
    [[0, 0, 0], [1, 0, 0], [-1, 0, 1]]
    """
    leaves = [(k, 0, 0) for k in range(len(form.leaves))]
    gates = [(MIN if operation == "min" else MAX, first, second) for operation, first, second in form.gates]
    entries = np.array([*leaves, *gates], np.int32)
    return Regions(np.array([0, len(entries)]), entries)


@loop
def gather(chosen: Any, old: Any, entries: Any, new: Any, result: Any) -> None:
    """Copy the entries of chosen regions."""
    for k in range(len(chosen)):
        shift = old[chosen[k]] - new[k]
        for i in range(new[k], new[k + 1]):
            for j in range(3):
                result[i, j] = entries[i + shift, j]


@loop
def reduce(
    first: int,
    last: int,
    start: Any,
    entries: Any,
    bounds: Any,
    places: Any,
    lanes: int,
    keeps: int,
    keep: Any,
    sizes: Any,
    results: Any,
) -> int:
    """The regions of boxes, up to eight in each region from first to below last, one after the other.

    `bounds` (entries, 2, 8) begin at ``places[region]``; `sizes` (regions, 8) tells how many entries each has, none
    where the box may not matter: the form has no zero there, or it was not asked for by `keep`.
    """
    most, made = 0, 0
    for region in range(first, last):
        most = max(most, start[region + 1] - start[region])
    need, where = np.empty(most, np.bool_), np.empty(most, np.int32)
    for region in range(first, last):
        begin, count = start[region], start[region + 1] - start[region]
        values = places[region]
        for lane in range(lanes):
            sizes[region, lane] = 0
            root = values + count - 1
            if not keep[region, lane]:
                continue
            if keeps == SIGN and not (bounds[root, 0, lane] <= 0 <= bounds[root, 1, lane]):
                keep[region, lane] = False
                continue
            for i in range(count):
                need[i] = False
            need[count - 1] = True
            for i in range(count - 1, -1, -1):
                what = entries[begin + i, 0]
                if need[i] and (what == MIN or what == MAX):
                    idle = _idle(what, entries, begin + i, bounds, values, lane, keeps)
                    for k in range(2):
                        if not idle >> k & 1:
                            need[entries[begin + i, 1 + k]] = True
            number = 0
            for i in range(count):
                if not need[i]:
                    continue
                what = entries[begin + i, 0]
                a, b = 0, 0
                if what == MIN or what == MAX:
                    idle = _idle(what, entries, begin + i, bounds, values, lane, keeps)
                    if idle == 1 or idle == 2:
                        where[i] = where[entries[begin + i, 2 if idle == 1 else 1]]
                        continue
                    if idle == 3:
                        what = INFINITE if what == MIN else MINUS_INFINITE
                    else:
                        a, b = where[entries[begin + i, 1]], where[entries[begin + i, 2]]
                results[made + number, 0], results[made + number, 1], results[made + number, 2] = what, a, b
                where[i] = number
                number += 1
            made += number
            sizes[region, lane] = number
    return made


@step
def _idle(what: int, entries: Any, entry: int, bounds: Any, values: int, lane: int, keeps: int) -> int:
    """Which operands of a gate do not matter: bits 1 and 2."""
    a, b = values + entries[entry, 1], values + entries[entry, 2]
    if keeps == SIGN:
        if what == MIN:
            return (bounds[a, 0, lane] > 0) + 2 * (bounds[b, 0, lane] > 0)
        return (bounds[a, 1, lane] < 0) + 2 * (bounds[b, 1, lane] < 0)
    if what == MIN:
        return (bounds[a, 0, lane] > bounds[b, 1, lane]) + 2 * (bounds[b, 0, lane] > bounds[a, 1, lane])
    return (bounds[a, 1, lane] < bounds[b, 0, lane]) + 2 * (bounds[b, 1, lane] < bounds[a, 0, lane])


@loop
def measure(
    first: int, last: int, start: Any, entries: Any, kind: Any, rows: Any, numbers: Any, registers: Any, size: Any
) -> None:
    """Of each region how many rows, uniform numbers and registers its tape has (3, regions), behind coordinates."""
    for region in range(first, last):
        own, given, scratch = 1, 0, 0
        for i in range(start[region], start[region + 1]):
            what = entries[i, 0]
            if what >= 0:
                own += rows[kind[what] + 1] - rows[kind[what]]
                given += numbers[what + 1] - numbers[what]
                scratch = max(scratch, registers[kind[what]])
            else:
                own, given = own + 2, given + 1
        size[0, region - first], size[1, region - first], size[2, region - first] = own, given, scratch


@loop
def write(
    first: int,
    last: int,
    start: Any,
    entries: Any,
    kind: Any,
    rows: Any,
    code: Any,
    numbers: Any,
    given: Any,
    ends: Any,
    coordinates: int,
    outputs: int,
    step_bytes: int,
    gates: Any,
    begin: Any,
    target: Any,
    uniform: Any,
    registers: Any,
) -> None:
    """The tapes of regions: rows to `target` and uniform numbers to `uniform`, from ``begin[:, region - first]`` on."""
    for region in range(first, last):
        count = start[region + 1] - start[region]
        row, number = begin[0, region - first], begin[1, region - first]
        base = number
        scratch = coordinates + outputs * count
        above = step_bytes * registers[region - first]
        for i in range(count):
            entry = start[region] + i
            what = entries[entry, 0]
            result = coordinates + outputs * i
            if what >= 0:
                shape = kind[what]
                for r in range(rows[shape], rows[shape + 1]):
                    target[row, 0] = code[r, 0]
                    for k in range(1, code.shape[1]):
                        place = code[r, k]
                        if place < 0:
                            target[row, k] = above + VECTOR * (number - base + ~place)
                            continue
                        if place >= coordinates:
                            found = scratch + place - coordinates
                            for j in range(outputs):
                                if place == ends[shape, j]:
                                    found = result + j
                            place = found
                        target[row, k] = step_bytes * place + (VARIES if k > 1 else 0)
                    row += 1
                for k in range(numbers[what], numbers[what + 1]):
                    uniform[number] = given[k]
                    number += 1
                continue
            for j in range(outputs):
                for k in range(code.shape[1]):
                    target[row, k] = 0
                target[row, 1] = step_bytes * (result + j)
                if what == MIN or what == MAX:
                    target[row, 0] = gates[0] if what == MIN else gates[1]
                    for k in range(2):
                        target[row, 2 + k] = step_bytes * (coordinates + outputs * entries[entry, 1 + k] + j) + VARIES
                else:
                    target[row, 0] = gates[0]
                    target[row, 2] = target[row, 3] = above + VECTOR * (number - base)
                row += 1
            if what != MIN and what != MAX:
                uniform[number] = np.inf if what == INFINITE else -np.inf
                number += 1
        for k in range(code.shape[1]):
            target[row, k] = 0


@dataclass(frozen=True)
class Codes:
    """The tapes of regions as the executor reads them.

    `rows` and `uniform` hold all; of tape k `row` and `number` tell where its own begin, `count` how many numbers it
    has, `above` at which byte of the memory these lie, `result` where the last output lies.
    """

    rows: NDArray[np.int32]
    uniform: Floats
    row: Ints
    number: Ints
    count: Ints
    above: Ints
    result: Ints

    @property
    def memory(self) -> int:
        """The bytes that a thread needs for any of them."""
        return int((self.above + VECTOR * self.count).max(initial=0))


class FormTapes:
    """The tapes of leaves of one sort, "value" or "box", as parts of those of regions."""

    def __init__(self, tapes: LeafTapes, name: str) -> None:
        own = [kind.tapes[name].tape for kind in tapes.kinds]
        self.kind = np.array(tapes.kind)
        self.rows = np.cumsum([0, *map(len, own)])
        self.code = np.concatenate([tape.rows[:-1] for tape in own]).astype(np.int64)
        self.ends = np.array([tape.outputs for tape in own])
        self.coordinates = 3 if name == "value" else 6
        self.registers = np.array([tape.registers for tape in own]) - self.coordinates
        self.step = VECTOR * (ROW_VECTORS if name == "value" else 1)
        known = [pattern[0] for pattern in patterns()]
        self.gates = np.array([1 + known.index("min"), 1 + known.index("max")])

    def codes(self, regions: Regions, numbers: tuple[Floats, Ints]) -> Codes:
        """The tapes of regions, with these uniform numbers of leaves."""
        count = len(regions)
        size = np.empty((3, count), np.int64)
        given, places = numbers
        measure(0, count, regions.start, regions.entries, self.kind, self.rows, places, self.registers, size)
        begin = np.zeros((2, count + 1), np.int64)
        np.cumsum(size[:2], axis=1, out=begin[:, 1:])
        outputs = self.ends.shape[1]
        entries = np.diff(regions.start)
        registers = self.coordinates + outputs * entries + size[2]
        rows, uniform = np.empty((begin[0, -1], WIDTH), np.int32), np.zeros(begin[1, -1])
        write(
            0, count, regions.start, regions.entries, self.kind, self.rows, self.code, places, given, self.ends,
            self.coordinates, outputs, self.step, self.gates, begin, rows, uniform, registers,
        )  # fmt: skip
        result = self.step * (self.coordinates + outputs * entries - 1)
        return Codes(rows, uniform, begin[0, :-1], begin[1, :-1], size[1], self.step * registers, result)
