"""Backend `llvm`: explicit vectors through llvmlite, eight lanes of float64 or sixteen of float32.

What is the same for all points is computed once per call, in float64 scalars,
before the loop, and rounded where it enters the loop. Every point runs through
the vector code, the last few in a padded buffer.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.backends.llvm_code import SCALAR, VECTORS, Emitter, Kind, declarations, machine_code, uniform_value
from rsym.program.precision import FLOAT64, Precision
from rsym.program.program import Program


def llvm_source(program: Program, precision: Precision = FLOAT64) -> str:
    """LLVM text of `void kernel(coordinates, outputs, letters, n)`, n a multiple of the lanes."""
    scalar, vector = Emitter(SCALAR, "s"), Emitter(VECTORS[precision.name], "v")
    names: list[str] = []
    splats: dict[int, str] = {}
    varying_users = {a for n, node in enumerate(program.nodes) if not program.uniform[n] for a in node.arguments}
    outputs = {number for _, number in program.outputs}
    for number, node in enumerate(program.nodes):
        if program.uniform[number]:
            names.append(uniform_value(scalar, program, node, names, precision))
            if number in varying_users or number in outputs:
                splats[number] = _splat(scalar, names[number], vector.kind)
        elif node.operation == "input":
            names.append(_load_coordinate(vector, program.coordinates.index(str(node.data))))
        else:
            names.append(vector.operation(node, [splats.get(a, names[a]) for a in node.arguments]))
    for position, (_, number) in enumerate(program.outputs):
        _store_output(vector, position, splats.get(number, names[number]))
    return _module(scalar.lines, vector.lines, program, vector.kind)


def _splat(scalar: Emitter, value: str, kind: Kind) -> str:
    vector, element = kind.type, kind.element
    value = scalar.convert(value, "double", element)
    first = scalar.emit(f"insertelement {vector} poison, {element} {value}, i32 0")
    return scalar.emit(f"shufflevector {vector} {first}, {vector} poison, <{kind.lanes} x i32> zeroinitializer")


def _load_coordinate(vector: Emitter, position: int) -> str:
    place = vector.emit(f"getelementptr {vector.kind.element}, ptr %in{position}, i64 %i")
    return vector.emit(f"load {vector.kind.type}, ptr {place}, align 4")


def _store_output(vector: Emitter, position: int, value: str) -> None:
    place = vector.emit(f"getelementptr {vector.kind.element}, ptr %out{position}, i64 %i")
    vector.lines.append(f"  store {vector.kind.type} {value}, ptr {place}, align 4")


def _module(scalar: Sequence[str], vector: Sequence[str], program: Program, kind: Kind) -> str:
    pointers = [
        f"  %{name}p{k} = getelementptr ptr, ptr %{name}s, i64 {k}\n  %{name}{k} = load ptr, ptr %{name}p{k}"
        for name, count in (("in", len(program.coordinates)), ("out", len(program.outputs)))
        for k in range(count)
    ]
    return "\n".join(
        [
            *declarations(kind, program.nodes),
            "define void @kernel(ptr noalias %ins, ptr noalias %outs, ptr noalias %letters, i64 %n) {",
            "entry:",
            *pointers,
            *scalar,
            "  br label %loop",
            "loop:",
            "  %i = phi i64 [ 0, %entry ], [ %next, %loop ]",
            *vector,
            f"  %next = add i64 %i, {kind.lanes}",
            "  %more = icmp slt i64 %next, %n",
            "  br i1 %more, label %loop, label %done",
            "done:",
            "  ret void",
            "}",
        ]
    )


class LlvmFunction:
    """A compiled program: arrays in, arrays out, the interpreter lock released meanwhile."""

    # One thread: the same from 8k to 128k points. Two threads: 1.8 times as fast from 32k on, less below.
    block_size = 32768

    def __init__(self, program: Program, precision: Precision = FLOAT64) -> None:
        self.program, self.precision = program, precision
        self.source = llvm_source(program, precision)
        self._engine = machine_code(self.source)
        address = self._engine.get_function_address("kernel")
        pointer = ctypes.c_void_p
        self._function = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, ctypes.c_int64)(address)

    def run(
        self, coordinates: Sequence[NDArray[Any]], letters: Sequence[float], outputs: Sequence[NDArray[Any]]
    ) -> None:
        """Fill the outputs (contiguous, one-dimensional, of the precision) at the coordinates (likewise)."""
        lanes = VECTORS[self.precision.name].lanes
        count = len(outputs[0])
        whole = count - count % lanes
        values = np.asarray(letters, np.float64)
        if whole:
            self._call(coordinates, values, outputs, whole)
        if whole < count:
            last = np.minimum(np.arange(whole, whole + lanes), count - 1)
            padded = [array[last] for array in coordinates]
            results = [np.empty(lanes, self.precision.dtype) for _ in outputs]
            self._call(padded, values, results, lanes)
            for output, result in zip(outputs, results, strict=True):
                output[whole:] = result[: count - whole]

    def _call(
        self,
        coordinates: Sequence[NDArray[Any]],
        letters: NDArray[np.float64],
        outputs: Sequence[NDArray[Any]],
        count: int,
    ) -> None:
        ins = (ctypes.c_void_p * len(coordinates))(*(array.ctypes.data for array in coordinates))
        outs = (ctypes.c_void_p * len(outputs))(*(array.ctypes.data for array in outputs))
        self._function(ins, outs, letters.ctypes.data, count)
