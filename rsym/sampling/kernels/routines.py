"""LLVM functions with loops and branches around straight-line code of programs, eight lanes of float64 at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property

from rsym.backends.llvm_code import SCALAR, VECTORS, Emitter, uniform_value
from rsym.backends.vector_code import Block, Value
from rsym.program.program import Program, constant_value, live

LANES = VECTORS["float64"].lanes
DOUBLES = VECTORS["float64"].type
SHORTS = f"<{LANES} x i16>"
TRUTHS = VECTORS["float64"].booleans


class Routine:
    """A function under construction; `parameters` are its names with their types, in order."""

    def __init__(self, name: str, parameters: Mapping[str, str], result: str = "void", internal: bool = False) -> None:
        listed = ", ".join(f"{kind} %{parameter}" for parameter, kind in parameters.items())
        self.head = f"define {'internal ' if internal else ''}{result} @{name}({listed}) {{"
        self.lines: list[str] = ["entry:"]
        self.code = Emitter(VECTORS["float64"], "v", self.lines)
        self.block = Block(LANES, self.lines)

    @property
    def text(self) -> str:
        """The whole function."""
        return "\n".join([self.head, *self.lines, "}"])

    def emit(self, text: str) -> str:
        """One more instruction that has a value."""
        return self.code.emit(text)

    def do(self, text: str) -> None:
        """One more instruction that has none."""
        self.lines.append(f"  {text}")

    def label(self, name: str) -> None:
        """Begin a block, entered from the one before."""
        self.do(f"br label %{name}")
        self.start(name)

    def start(self, name: str) -> None:
        """Begin a block that only jumps lead to."""
        self.lines.append(f"{name}:")

    def fresh(self, word: str) -> str:
        """A name that no other has."""
        return f"{word}{len(self.lines)}"

    def value(self, name: str, kind: str = "double") -> Value:
        """A named vector, as one writes formulas with."""
        return Value(self.block, name, kind)

    def number(self, number: float) -> Value:
        """A number in every lane."""
        return self.value(self.block.constant(number, "double"))

    def place(self, pointer: str, element: str, index: str | int) -> str:
        """The address of an element of an array."""
        return self.emit(f"getelementptr {element}, ptr {pointer}, i64 {index}")

    def load(self, pointer: str, index: str | int, type: str = DOUBLES) -> str:
        """The vector (or scalar) at an index of its elements; nothing is taken for aligned."""
        element = _element(type)
        return self.emit(f"load {type}, ptr {self.place(pointer, element, index)}, align {_size(element)}")

    def store(self, value: str, pointer: str, index: str | int, type: str = DOUBLES) -> None:
        """Put a vector (or scalar) at an index of its elements."""
        element = _element(type)
        place = self.place(pointer, element, index)
        self.do(f"store {type} {value}, ptr {place}, align {_size(element)}")

    def up_to(self, begin: str, end: str, most: int) -> str:
        """How many there are from begin to below end, but no more than that."""
        left = self.emit(f"sub i64 {end}, {begin}")
        few = self.emit(f"icmp slt i64 {left}, {most}")
        return self.emit(f"select i1 {few}, i64 {left}, i64 {most}")

    def row(self, pointer: str, stride: str, k: int, element: str = "double") -> str:
        """Row k of an array."""
        return self.place(pointer, element, self.emit(f"mul i64 {stride}, {k}")) if k else pointer

    def store_some(self, value: str, type: str, buffer: str, target: str, count: str) -> None:
        """The first `count` lanes, by way of a buffer: those behind may belong to another thread."""
        self.do(f"store {type} {value}, ptr {buffer}, align 16")
        size = self.emit(f"mul i64 {count}, {_size(_element(type))}")
        self.do(f"call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {buffer}, i64 {size}, i1 false)")

    def splat(self, scalar: str, element: str = "double") -> str:
        """A scalar in every lane."""
        vector = f"<{LANES} x {element}>"
        first = self.emit(f"insertelement {vector} poison, {element} {scalar}, i32 0")
        return self.emit(f"shufflevector {vector} {first}, {vector} poison, <{LANES} x i32> zeroinitializer")

    def element(self, pointer: str, index: str | int) -> Value:
        """One float64 of an array, in every lane."""
        return self.value(self.splat(self.load(pointer, index, "double")))

    def root(self, radicand: Value) -> Value:
        """The square root."""
        return self.value(self.emit(f"call {DOUBLES} @llvm.sqrt.v{LANES}f64({DOUBLES} {radicand.name})"))

    def select(self, condition: str, yes: str, no: str, type: str) -> str:
        """`yes` in the lanes where the condition holds."""
        return self.emit(f"select {TRUTHS} {condition}, {type} {yes}, {type} {no}")

    def mask(self, truths: str) -> str:
        """The truth values of the lanes as bits of a byte."""
        return self.emit(f"bitcast {TRUTHS} {truths} to i{LANES}")

    @contextmanager
    def where(self, truths: Value) -> Iterator[None]:
        """The body, if this is true in any lane."""
        number = len(self.lines)
        some = self.emit(f"icmp ne i{LANES} {self.mask(truths.name)}, 0")
        self.do(f"br i1 {some}, label %some{number}, label %none{number}")
        self.start(f"some{number}")
        yield
        self.label(f"none{number}")

    @contextmanager
    def loop(self, start: str, stop: str, step: int, going: Callable[[], Value] | None = None) -> Iterator[str]:
        """The body for `%i` from start to below stop, and as long as `going` is true in any lane."""
        number = len(self.lines)
        index = f"%i{number}"
        self.label(f"before{number}")
        self.label(f"head{number}")
        self.do(f"{index} = phi i64 [ {start}, %before{number} ], [ %next{number}, %latch{number} ]")
        self.do(f"%more{number} = icmp slt i64 {index}, {stop}")
        more = f"%more{number}"
        if going is not None:
            some = self.emit(f"icmp ne i{LANES} {self.mask(going().name)}, 0")
            more = self.emit(f"and i1 {more}, {some}")
        self.do(f"br i1 {more}, label %body{number}, label %end{number}")
        self.start(f"body{number}")
        yield index
        self.label(f"latch{number}")
        self.do(f"%next{number} = add i64 {index}, {step}")
        self.do(f"br label %head{number}")
        self.start(f"end{number}")


def _element(type: str) -> str:
    return type.strip("<>").rpartition(" ")[2]


def _size(element: str) -> int:
    return {"double": 8, "float": 4, "i64": 8, "i16": 2, "i8": 1}[element]


class Formulas:
    """An expanded program as part of routines; what is the same for all points lies in an array of constants.

    The array is filled once for a set of letters, so no routine computes it again; those of this program begin at
    `offset` of it.
    """

    def __init__(self, program: Program, offset: int = 0) -> None:
        self.program = program
        self.numbers = dict(program.outputs)
        used = {a for n, node in enumerate(program.nodes) if not program.uniform[n] for a in node.arguments}
        used.update(self.numbers.values())
        stored = [n for n in sorted(used) if program.uniform[n] and program.nodes[n].operation != "const"]
        self.slots = {number: offset + position for position, number in enumerate(stored)}

    @cached_property
    def constants(self) -> int:
        """How many constants it stores."""
        return len(self.slots)

    def constants_text(self, name: str) -> str:
        """The function ``name(letters, constants)`` that stores them."""
        scalar = Emitter(SCALAR, "s")
        names: dict[int, str] = {}
        for number in live(self.program.nodes, self.slots):
            node = self.program.nodes[number]
            names[number] = uniform_value(scalar, self.program, node, names)
        for number, slot in self.slots.items():
            place = scalar.emit(f"getelementptr double, ptr %constants, i64 {slot}")
            scalar.lines.append(f"  store double {names[number]}, ptr {place}")
        head = f"define void @{name}(ptr %letters, ptr %constants) {{"
        return "\n".join([head, "entry:", *scalar.lines, "  ret void", "}"])

    def inputs(self, values: Mapping[str, str]) -> dict[int, str]:
        """The nodes that are inputs, with their values by name."""
        return {
            number: values[str(node.data)]
            for number, node in enumerate(self.program.nodes)
            if node.operation == "input" and node.data in values
        }

    def emit(self, routine: Routine, wanted: Iterable[int], known: dict[int, str]) -> None:
        """Compute nodes from what is known, and note their values there; constants are read from `%constants`."""
        for number in self._needed(wanted, known):
            node = self.program.nodes[number]
            if number in self.slots:
                known[number] = routine.splat(routine.load("%constants", self.slots[number], "double"))
            elif node.operation == "const":
                known[number] = routine.block.constant(constant_value(node.data), "double")
            else:
                known[number] = routine.code.operation(node, [known[argument] for argument in node.arguments])

    def _needed(self, wanted: Iterable[int], known: Mapping[int, str]) -> list[int]:
        seen: set[int] = set()
        stack = list(wanted)
        while stack:
            number = stack.pop()
            if number not in seen and number not in known:
                seen.add(number)
                if number not in self.slots:
                    stack.extend(self.program.nodes[number].arguments)
        return sorted(seen)

    def outputs(self, routine: Routine, names: Iterable[str], known: dict[int, str]) -> list[Value]:
        """Compute outputs by name."""
        numbers = [self.numbers[name] for name in names]
        self.emit(routine, numbers, known)
        return [routine.value(known[number]) for number in numbers]
