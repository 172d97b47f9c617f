"""Backend `tape`: nothing is compiled for a program; an executor that is compiled once on a machine runs its rows."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.arrays import Arrays, Floats, Ints, addresses
from rsym.backends.llvm_code import VECTORS, machine_code
from rsym.backends.tape_code import ROW_VECTORS, VARIES, executor_source, size_of
from rsym.program.program import FLOAT64, Node, Precision, Program, assemble, constant_value
from rsym.program.tape import Rows, Tape, tape_of

ALIGNMENT = 64
SCALAR_SIZE = 8  # bytes


class Executor:
    """The compiled executor of a precision."""

    def __init__(self, precision: Precision) -> None:
        self.precision = precision
        self.vector = size_of(VECTORS[precision.name])
        self._engine = machine_code(executor_source(precision.name))
        pointer, integer = ctypes.c_void_p, ctypes.c_int64
        kinds = (pointer, pointer, pointer, integer, pointer, integer, pointer, integer)
        self.evaluate = ctypes.CFUNCTYPE(None, *kinds)(self._engine.get_function_address("evaluate"))
        if precision is FLOAT64:
            address = self._engine.get_function_address("evaluate_uniform")
            self.evaluate_uniform = ctypes.CFUNCTYPE(None, pointer, pointer, integer, integer)(address)

    def above(self, tape: Tape) -> int:
        """The byte of the memory where the registers end and the uniform numbers begin, each a whole vector."""
        return self.vector * ROW_VECTORS * tape.registers

    def addresses(self, tape: Tape, places: NDArray[Any]) -> Ints:
        """Where places lie in the memory; `VARIES` marks registers."""
        registers = self.vector * ROW_VECTORS * places.astype(np.int64) + VARIES
        return np.where(places >= 0, registers, self.above(tape) + self.vector * ~places)

    def code(self, tape: Tape) -> Rows:
        """The rows as the executor reads them."""
        code = tape.rows.copy()
        code[:, 1:] = self.addresses(tape, tape.rows[:, 1:])
        code[:, 1] -= VARIES
        return code

    def memory(self, tape: Tape, uniform: Floats) -> NDArray[np.uint8]:
        """Room for the registers of a tape, with its uniform numbers in place."""
        room = aligned(self.above(tape) + self.vector * len(tape.uniform))
        lanes = VECTORS[self.precision.name].lanes
        with np.errstate(over="ignore"):
            splats = np.repeat(uniform.astype(self.precision.dtype), lanes)
        room[self.above(tape) :] = splats.view(np.uint8)
        return room


def aligned(size: int) -> NDArray[np.uint8]:
    """So many bytes, from the beginning of a vector on."""
    room = np.zeros(size + ALIGNMENT, np.uint8)
    begin = -room.ctypes.data % ALIGNMENT
    return room[begin : begin + size]


@cache
def executor(precision: Precision = FLOAT64) -> Executor:
    """The executor, compiled when it is first needed."""
    return Executor(precision)


class UniformNumbers:
    """What of a program is the same at all points, from its letters: single numbers, in float64."""

    def __init__(self, program: Program, numbers: Sequence[int], precision: Precision = FLOAT64) -> None:
        part = assemble(program.nodes, (), program.letters, {str(k): number for k, number in enumerate(numbers)})
        # Constants and letters are what varies here.
        known = {n: f"constant {n}" for n, node in enumerate(part.nodes) if node.operation in ("const", "undefined")}
        nodes = tuple(Node("input", (), known[n]) if n in known else node for n, node in enumerate(part.nodes))
        self._tape = tape_of(Program(nodes, (*known.values(), *program.letters), (), part.outputs))
        self._constants = [
            np.nan if node.operation == "undefined" else constant_value(node.data, precision)
            for node in (part.nodes[number] for number in known)
        ]
        self._code = self._tape.rows.copy()
        self._code[:, 1:] *= SCALAR_SIZE

    def __call__(self, letters: ArrayLike) -> Floats:
        """The numbers (n, numbers) for rows of letters (n, letters), or those for one row."""
        rows = np.asarray(letters, np.float64)
        given, first = np.atleast_2d(rows), len(self._constants)
        rooms = np.empty((len(given), max(1, self._tape.registers)))
        rooms[:, :first] = self._constants
        rooms[:, first : first + given.shape[1]] = given
        executor().evaluate_uniform(self._code.ctypes.data, rooms.ctypes.data, rooms.strides[0], len(rooms))
        return rooms[:, list(self._tape.outputs)].reshape(*rows.shape[:-1], -1)


class TapeFunction:
    """A program as a tape: arrays in, arrays out."""

    block_size = 32768  # as of `llvm`

    def __init__(self, program: Program, precision: Precision = FLOAT64) -> None:
        self.program, self.precision = program, precision
        self.tape = tape_of(program)
        self._executor = executor(precision)
        self._code = self._executor.code(self.tape)
        self._uniform = UniformNumbers(program, self.tape.uniform, precision)
        places = np.array([*range(len(program.coordinates)), *self.tape.outputs])
        self._places = self._executor.addresses(self.tape, places) & ~VARIES

    @cached_property
    def source(self) -> str:
        """The tape, readable."""
        return str(self.tape)

    def run(self, coordinates: Sequence[NDArray[Any]], letters: Sequence[float], outputs: Arrays) -> None:
        """Fill the outputs (contiguous, one-dimensional, of the precision) at the coordinates (likewise)."""
        memory = self._executor.memory(self.tape, self._uniform(letters))
        ins, outs = addresses(coordinates), addresses(outputs)
        counts = len(coordinates), len(outputs)
        self._executor.evaluate(
            self._code.ctypes.data, memory.ctypes.data, ins.ctypes.data, counts[0], outs.ctypes.data, counts[1],
            self._places.ctypes.data, len(outputs[0]),
        )  # fmt: skip
