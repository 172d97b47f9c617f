"""Backend `llvm`: explicit vectors through llvmlite, eight lanes of float64 or sixteen of float32.

No fast-math flag is ever set, contraction included: a lane computes the same
bits whatever stands beside it.

What is the same for all points is computed once per call, in float64 scalars,
before the loop, and rounded where it enters the loop. Every point runs through
the vector code, the last few in a padded buffer.
"""

from __future__ import annotations

import ctypes
import hashlib
import threading
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Arrays, Floats, addresses
from rsym.backends.caches import keep_entry, read_entry
from rsym.backends.vector_code import number_text
from rsym.backends.vector_functions import ARITIES, definitions
from rsym.program.operations import OPERATIONS
from rsym.program.program import FLOAT64, Node, Precision, Program, constant_value

_COMPILING = threading.Lock()  # LLVM's global context is not safe against two compilations at once

KIND = "kernels"
KEPT_FROM = 40_000  # characters of text: what compiles in a thirtieth of a second is not worth a file
# Registers for 36 000 nodes take 25 s to choose well, and more than in proportion; 1 s to choose at once, and then a
# point takes 2.6 times as long: the longer way is worth it from some millions of points on.
MOST_TUNED = 16_000  # nodes
INTRINSICS = ("sqrt", "fabs")  # that the texts of rows call


@dataclass(frozen=True)
class Kind:
    """A scalar or a vector type of LLVM."""

    element: str
    lanes: int

    @property
    def type(self) -> str:
        """The type as LLVM writes it."""
        return f"<{self.lanes} x {self.element}>" if self.lanes > 1 else self.element

    @property
    def booleans(self) -> str:
        """The type of its comparisons."""
        return f"<{self.lanes} x i1>" if self.lanes > 1 else "i1"

    @property
    def suffix(self) -> str:
        """What the names of intrinsics end in."""
        bits = "f64" if self.element == "double" else "f32"
        return f"v{self.lanes}{bits}" if self.lanes > 1 else bits


SCALAR = Kind("double", 1)
# 512 bits, whatever the machine: LLVM splits what its registers do not hold. On the car half as
# many lanes take a third longer, twice as many a fiftieth less.
VECTORS = {"float64": Kind("double", 8), "float32": Kind("float", 16)}


class Emitter:
    """The text of one basic block, scalar or vector."""

    def __init__(self, kind: Kind, prefix: str, lines: list[str] | None = None) -> None:
        self.kind, self.prefix = kind, prefix
        self.lines: list[str] = [] if lines is None else lines

    def name(self) -> str:
        """The name of the next value."""
        return f"%{self.prefix}{len(self.lines)}"

    def emit(self, text: str) -> str:
        """One more instruction."""
        name = self.name()
        self.lines.append(f"  {name} = {text}")
        return name

    def operation(self, node: Node, a: Sequence[str]) -> str:
        """A primitive operation of a program."""
        operation, kind = node.operation, self.kind.type
        text = OPERATIONS[operation].texts["llvm"]
        if text not in {"choice", "function"}:
            return self.emit(text.format(*a, type=kind, suffix=self.kind.suffix))
        if operation == "select":
            return self.choose(f"fcmp ogt {kind} {a[0]}, {a[1]}", a[2], a[3])
        if operation in ("min", "max"):
            better = self.emit(f"fcmp {'olt' if operation == 'min' else 'ogt'} {kind} {a[0]}, {a[1]}")
            is_nan = self.emit(f"fcmp uno {kind} {a[0]}, {a[0]}")
            return self.choose(f"or {self.kind.booleans} {better}, {is_nan}", a[0], a[1])
        return self.function(operation, a)

    def choose(self, condition: str, yes: str, no: str) -> str:
        """`yes` where the condition holds."""
        flag = self.emit(condition)
        return self.emit(f"select {self.kind.booleans} {flag}, {self.kind.type} {yes}, {self.kind.type} {no}")

    def convert(self, value: str, source: str, target: str) -> str:
        """The same numbers as float or double."""
        if source == target:
            return value
        return self.emit(f"{'fptrunc' if 'float' in target else 'fpext'} {source} {value} to {target}")

    def function(self, operation: str, a: Sequence[str]) -> str:
        """A function of libm, on vectors one of `vector_functions`: in float64, rounded to the element."""
        wide = Kind("double", self.kind.lanes).type
        arguments = ", ".join(f"{wide} {self.convert(value, self.kind.type, wide)}" for value in a)
        name = operation if self.kind == SCALAR else f"rsym_{operation}"
        return self.convert(self.emit(f"call {wide} @{name}({arguments})"), wide, self.kind.type)


def uniform_value(
    scalar: Emitter,
    program: Program,
    node: Node,
    names: Sequence[str] | Mapping[int, str],
    precision: Precision = FLOAT64,
) -> str:
    """The name of a node that is the same for all points; letters are read from `%letters`."""
    if node.operation in ("const", "undefined"):
        value = np.nan if node.operation == "undefined" else constant_value(node.data, precision)
        return number_text(value)
    if node.operation == "input":
        position = program.letters.index(str(node.data))
        pointer = scalar.emit(f"getelementptr double, ptr %letters, i64 {position}")
        return scalar.emit(f"load double, ptr {pointer}")
    return scalar.operation(node, [names[a] for a in node.arguments])


def declarations(kind: Kind, nodes: Iterable[Node]) -> list[str]:
    """What the code of these nodes calls, in scalars and in vectors of this kind."""
    libm = [f"declare double @{name}({', '.join(['double'] * count)})" for name, count in ARITIES.items()]
    intrinsics = [
        f"declare {each.type} @llvm.{intrinsic}.{each.suffix}({each.type})"
        for intrinsic in (*INTRINSICS, *sorted({"floor"} & {node.operation for node in nodes}))
        for each in (kind, SCALAR)
    ]
    return [*libm, *intrinsics, *definitions(sorted({node.operation for node in nodes} & ARITIES.keys()), kind.lanes)]


@cache
def _target() -> llvm.Target:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple()


@cache
def _host() -> dict[str, str]:
    """The processor and what it can do: to ask takes as long as to read a short module."""
    return {"cpu": llvm.get_host_cpu_name(), "features": llvm.get_host_cpu_features().flatten()}


def machine_code(source: str, effort: int = 2, *, kept: bool = False) -> llvm.ExecutionEngine:
    """The engine that holds the compiled functions of a module; they live as long as it does.

    Short texts are not kept on this machine, unless they are to be `kept`.
    """
    with _COMPILING:
        name = entry_name(source, effort) if kept or len(source) >= KEPT_FROM else ""
        code = read_entry(KIND, name) if name else None
        if code is None:
            module = llvm.parse_assembly(source)
            module.verify()
            code = _machine(effort).emit_object(module)
            if name:
                keep_entry(KIND, name, code)
        return _engine(code)


def kept_machine_code(name: str) -> llvm.ExecutionEngine | None:
    """The engine of a module that was kept under this name, without its text."""
    code = read_entry(KIND, name)
    if code is None:
        return None
    with _COMPILING:
        return _engine(code)


def bitcode(source: str) -> bytes:
    """A module in LLVM's own binary form."""
    return bytes(llvm.parse_assembly(source).as_bitcode())


def _machine(effort: int) -> llvm.TargetMachine:
    return _target().create_target_machine(**_host(), opt=effort)


def _engine(code: bytes) -> llvm.ExecutionEngine:
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), _machine(2))  # a machine of its own: it is given away
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    return engine


def entry_name(source: str, effort: int = 2) -> str:
    """A name for everything that decides what a text compiles to."""
    machine = (llvmlite.__version__, llvm.llvm_version_info, llvm.get_default_triple(), *_host().values(), effort)
    return hashlib.sha256(repr((machine, source)).encode()).hexdigest()


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
        self._engine = machine_code(self.source, effort=0 if len(program.nodes) > MOST_TUNED else 2)
        address = self._engine.get_function_address("kernel")
        pointer = ctypes.c_void_p
        self._function = ctypes.CFUNCTYPE(None, pointer, pointer, pointer, ctypes.c_int64)(address)

    def run(self, coordinates: Sequence[NDArray[Any]], letters: Sequence[float], outputs: Arrays) -> None:
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
            results = np.empty((len(outputs), lanes), self.precision.dtype)
            self._call(padded, values, results, lanes)
            for output, result in zip(outputs, results, strict=True):
                output[whole:] = result[: count - whole]

    def _call(
        self,
        coordinates: Sequence[NDArray[Any]],
        letters: Floats,
        outputs: Arrays,
        count: int,
    ) -> None:
        ins, outs = addresses(coordinates), addresses(outputs)
        self._function(ins.ctypes.data, outs.ctypes.data, letters.ctypes.data, count)
