"""The tapes of regions: the rows of their leaves and gates, one after the other, as the executor reads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.backends.tape import executor
from rsym.backends.tape_code import ROW_VECTORS, VARIES
from rsym.program.tape import WIDTH, patterns
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.regions.leaf_tapes import KindTape, LeafTapes
from rsym.sampling.regions.regions import INFINITE, MAX, MIN, Regions
from rsym.sampling.sharp.loops import loop

VECTOR = 8 * LANES  # bytes
STEP = ROW_VECTORS * VECTOR  # bytes from register to register of points


@loop
def measure(start: Any, entries: Any, kind: Any, rows: Any, numbers: Any, registers: Any, size: Any) -> None:
    """Of each region how many rows, uniform numbers and registers its tape has (3, regions), behind coordinates."""
    for region in range(len(start) - 1):
        own, given, scratch = 1, 0, 0
        for i in range(start[region], start[region + 1]):
            what = entries[i, 0]
            if what >= 0:
                own += rows[kind[what] + 1] - rows[kind[what]]
                given += numbers[what + 1] - numbers[what]
                scratch = max(scratch, registers[kind[what]])
            else:
                own, given = own + 2, given + 1
        size[0, region], size[1, region], size[2, region] = own, given, scratch


@loop
def write(
    start: Any,
    entries: Any,
    kind: Any,
    rows: Any,
    code: Any,
    numbers: Any,
    given: Any,
    ends: Any,
    coordinates: int,
    operands: int,
    outputs: int,
    step_bytes: int,
    gates: Any,
    begin: Any,
    target: Any,
    uniform: Any,
    registers: Any,
) -> None:
    """The tapes of regions: rows to `target` and uniform numbers to `uniform`, from ``begin[:, region]`` on."""
    for region in range(len(registers)):
        count = start[region + 1] - start[region]
        row, number = begin[0, region], begin[1, region]
        base = number
        scratch = coordinates + outputs * count
        above = step_bytes * registers[region]
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
                        if place >= coordinates + operands:
                            found = scratch + place - coordinates - operands
                            for j in range(outputs):
                                if place == ends[shape, j]:
                                    found = result + j
                            place = found
                        elif place >= coordinates:
                            operand = entries[entry, 1 + (place - coordinates) // outputs]
                            place = coordinates + outputs * operand + (place - coordinates) % outputs
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

    def __getitem__(self, which: Ints) -> Codes:
        """Some of them, by their numbers, as often as these are named."""
        row, number, count, above, result = (
            array[which] for array in (self.row, self.number, self.count, self.above, self.result)
        )
        return Codes(self.rows, self.uniform, row, number, count, above, result)


class FormTapes:
    """The tapes of leaves of one sort, at points or over boxes, as parts of those of regions; `kind` is each leaf's.

    Of leaves in parts so many of the last coordinates are values of `operands`, or their bounds.
    """

    def __init__(self, tapes: Sequence[KindTape], kind: Ints, operands: int = 0) -> None:
        own = [one.tape for one in tapes]
        self.kind = kind
        self.rows = np.cumsum([0, *map(len, own)])
        self.code = np.concatenate([tape.rows[:-1] for tape in own]).astype(np.int64)
        self.ends = np.array([tape.outputs for tape in own])
        self.operands = operands * self.ends.shape[1]
        self.coordinates = tapes[0].coordinates - self.operands
        self.registers = np.array([tape.registers for tape in own]) - tapes[0].coordinates
        self.step = VECTOR if self.ends.shape[1] == 2 else STEP  # bounds have two ends
        known = [pattern[0] for pattern in patterns()]
        self.gates = np.array([1 + known.index("min"), 1 + known.index("max")])

    def codes(self, regions: Regions, numbers: tuple[Floats, Ints]) -> Codes:
        """The tapes of regions, with these uniform numbers of leaves."""
        count = len(regions)
        size = np.empty((3, count), np.int64)
        given, places = numbers
        measure(regions.start, regions.entries, self.kind, self.rows, places, self.registers, size)
        begin = np.zeros((2, count + 1), np.int64)
        np.cumsum(size[:2], axis=1, out=begin[:, 1:])
        outputs = self.ends.shape[1]
        entries = np.diff(regions.start)
        registers = self.coordinates + outputs * entries + size[2]
        rows, uniform = np.empty((begin[0, -1], WIDTH), np.int32), np.zeros(begin[1, -1])
        write(
            regions.start, regions.entries, self.kind, self.rows, self.code, places, given, self.ends,
            self.coordinates, self.operands, outputs, self.step, self.gates, begin, rows, uniform, registers,
        )  # fmt: skip
        result = self.step * (self.coordinates + outputs * entries - 1)
        return Codes(rows, uniform, begin[0, :-1], begin[1, :-1], size[1], self.step * registers, result)


@dataclass(frozen=True)
class LeafCodes:
    """The tapes of single leaves as the executor reads them.

    `rows` holds all; of leaf k `row` tells where its own begin, `above` at which byte its uniform numbers lie, `ends`
    where its outputs do.
    """

    rows: NDArray[np.int32]
    row: Ints
    above: Ints
    ends: Ints


def leaf_codes(tapes: LeafTapes, name: str) -> LeafCodes:
    """The tapes "gradient" or "enclosure" of all leaves."""
    own = [kind.tape(name).tape for kind in tapes.kinds]
    registers, kind = np.array([tape.registers for tape in own]), np.array(tapes.kind)
    parts = [executor().code(tape) for tape in own]
    begin = np.cumsum([0, *map(len, parts)])[:-1]
    ends = STEP * np.array([tape.outputs for tape in own])
    return LeafCodes(np.concatenate(parts), begin[kind], STEP * registers[kind], ends[kind])
