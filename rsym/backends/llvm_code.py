"""Text of LLVM for the operations of a program, and the way from text to machine code.

No fast-math flag is ever set, contraction included: a lane computes the same
bits whatever stands beside it.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import llvmlite.binding as llvm
import numpy as np

from rsym.backends.vector_code import number_text
from rsym.backends.vector_functions import ARITIES, definitions
from rsym.program.operations import OPERATIONS
from rsym.program.precision import FLOAT64, Precision
from rsym.program.program import Node, Program, constant_value

_COMPILING = threading.Lock()  # LLVM's global context is not safe against two compilations at once

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
        for intrinsic in INTRINSICS
        for each in (kind, SCALAR)
    ]
    return [*libm, *intrinsics, *definitions(sorted({node.operation for node in nodes} & ARITIES.keys()), kind.lanes)]


@cache
def _target() -> llvm.Target:
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm.Target.from_default_triple()


def _target_machine(effort: int) -> llvm.TargetMachine:
    """A fresh one: the engine that is made with it owns it."""
    features = llvm.get_host_cpu_features().flatten()
    return _target().create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=effort)


def machine_code(source: str, effort: int = 2) -> llvm.ExecutionEngine:
    """The engine that holds the compiled functions of a module; they live as long as it does."""
    with _COMPILING:
        machine = _target_machine(effort)
        module = llvm.parse_assembly(source)
        module.verify()
        engine = llvm.create_mcjit_compiler(module, machine)
        engine.finalize_object()
    return engine
