"""Routines of a sign form along rays: its model on segments, what matters in a beam, its active leaf at points."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import numpy as np

from rsym.arrays import Ints
from rsym.backends.interpreter import interpret_nodes
from rsym.backends.vector_code import Value
from rsym.bounds.ray_forms import LINE, MODEL, NUMBER, RayForm, RayFunction, input_names, ray_form
from rsym.bounds.ray_models import RayArithmetic, RayModel
from rsym.logic.gates import Gate, balanced
from rsym.logic.sign_form import SignForm
from rsym.logic.stripping import is_positive
from rsym.program.builder import Builder
from rsym.program.expansion import expand
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, Program
from rsym.program.row import Test
from rsym.sampling.kernels.form_code import (
    AXES,
    WORD,
    Parts,
    ReducedWalk,
    better,
    leaf_number,
    leaf_program,
    share_parts,
    with_bit,
)
from rsym.sampling.kernels.leaf_kinds import LeafKinds
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Formulas, Routine
from rsym.sampling.kernels.table_layout import FormTable, WorkRoom

NAMED = f"{{ {DOUBLES}, {SHORTS} }}"
ZERO = "zeroinitializer"
# Beyond the models of a form, within what models may be.
HUGE = 1e90
# The models of the coordinates, which are linear along rays.
ENDS = tuple(f"{axis}_{part}" for axis in AXES for part in ("low", "high", "linear"))
# So many gates: from here on what matters is known for cells of the bounds, and a form is tables that loops walk. Of 70
# balls that takes a quarter of the time of branches, to compile and to look.
CELLED = TABLED = 64
# Calls. What more than one leaf needs is made once where it is that much, though maybe no leaf in a block needs it.
MUCH = 8


class RayFormulas:
    """A sign form as routines along rays need it.

    Of the array `constants` the first are the uniform numbers of models, then those of the formulas at points, then a
    scale for each leaf, then the distance below which leaves are taken for one. Of a large form the rows of its leaves
    follow, tables of its leaves and gates in integers, and the cells of its bounds.
    """

    def __init__(self, form: SignForm) -> None:
        self.form = form
        self.rays = ray_form(form, lines=True, guards=True)
        self.count = len(form.leaves)
        self.gates = balanced(self.rays.gates, len(self.rays.leaves))
        self.uniforms = len(self.rays.uniforms.outputs)
        self.points = Formulas(expand(leaf_program(form)), self.uniforms)
        self.coordinates = form.builder.coordinates
        self.scales = self.uniforms + self.points.constants
        self.tolerance = self.scales + self.count
        self.constants = self.tolerance + 1
        self.celled, self.tabled = len(self.gates) >= CELLED, len(self.gates) >= TABLED
        self.operands = len(self.rays.leaves) + len(self.gates)

    @property
    def tile(self) -> int:
        """How many pixels a beam is wide: of a large form it must be thin to march by cells."""
        return 8 if self.celled else 16

    @cached_property
    def kinds(self) -> LeafKinds:
        """The kinds of leaves."""
        return LeafKinds(self.rays, self.points.program)

    @cached_property
    def table(self) -> FormTable:
        """Where the tables of a large form begin among its constants."""
        return FormTable(self.constants, len(self.kinds.sources), len(self.rays.leaves), len(self.gates))

    @cached_property
    def integers(self) -> Ints:
        """The tables of leaves and gates."""
        leaves = [
            (kind, self.table.rows + begin, k if k < self.count else 0)
            for k, (kind, begin) in enumerate(self.kinds.leaves)
        ]
        known = [sum(self.everywhere[operand] << k for k, operand in enumerate(gate[1:])) for gate in self.gates]
        gates = [
            (int(gate.operation == "max"), *gate[1:], flags) for gate, flags in zip(self.gates, known, strict=True)
        ]
        return np.concatenate([np.array(leaves, np.int64).ravel(), np.array(gates, np.int64).ravel()])

    @property
    def cells(self) -> int:
        """Where the cells of a large form begin among its constants."""
        return self.table.end if self.tabled else self.constants

    @cached_property
    def room(self) -> WorkRoom:
        """The memory that routines of a large form work in."""
        return WorkRoom(self.words, self.operands)

    @property
    def words(self) -> int:
        """How many words hold a bit for each operand of each gate."""
        return max(1, -(-2 * len(self.gates) // WORD))

    @cached_property
    def everywhere(self) -> tuple[bool, ...]:
        """Which operands of gates have a value everywhere, as their form shows: of leaves, then of gates.

        What depends on letters alone has one, or the form is undefined everywhere.
        """
        b = self.form.builder
        defined: list[bool] = []
        for number, node in enumerate(b.nodes):
            if b.uniform[number]:
                defined.append(True)
                continue
            holds = all(any(_holds(b, node, test) for test in clause) for clause in OPERATIONS[node.operation].domain)
            defined.append(holds and all(defined[argument] for argument in node.arguments))
        known = [*(defined[leaf] for leaf in self.form.leaves), *[False] * self.rays.guards]
        for gate in self.gates:
            known.append(known[gate.first] and known[gate.second])
        return tuple(known)


def _holds(b: Builder, node: Node, test: Test) -> bool:
    """Whether the form of an operand shows that a condition on it holds."""
    if test.place < 0:
        return False
    argument = node.arguments[test.place]
    return b.nonnegative[argument] if test.kind == "nonnegative" else is_positive(b, argument)


def library(s: RayFormulas) -> list[str]:
    """The image functions as LLVM functions, and the range of a model."""
    b = Builder(input_names(0, MODEL), ())
    low, high = RayArithmetic(b).range(RayModel(*map(b.input, b.coordinates)))
    functions = [_function(one.name, one.inputs, one.program, _results(one)) for one in s.rays.library.values()]
    return [*functions, _function("range", b.coordinates, b.program({"low": low, "high": high}), ("low", "high"))]


def _results(function: RayFunction) -> tuple[str, ...]:
    return input_names(0, LINE if function.gives_line else MODEL)


def _function(name: str, inputs: Sequence[str], program: Program, results: Sequence[str]) -> str:
    """A program as a function of vectors; a min or max of numbers that are no NaN is one instruction."""
    r = Routine(f"ray_{name}", dict.fromkeys(inputs, DOUBLES), _struct(len(results)), True)
    formulas = Formulas(program)
    known = formulas.inputs({name: f"%{name}" for name in inputs})
    fixed = interpret_nodes(program, dict.fromkeys(inputs, 0.0))
    known.update({number: r.number(float(fixed[number])).name for number in formulas.slots})
    for number, node in enumerate(program.nodes):
        if number not in known and node.operation in {"min", "max"}:
            a, b = (known[argument] for argument in node.arguments)
            first = r.emit(f"fcmp {'olt' if node.operation == 'min' else 'ogt'} {DOUBLES} {a}, {b}")
            known[number] = r.select(first, a, b, DOUBLES)
        else:
            formulas.emit(r, [number], known)
    value = "poison"
    for place, output in enumerate(number for _, number in program.outputs[: len(results)]):
        value = r.emit(f"insertvalue {_struct(len(results))} {value}, {DOUBLES} {known[output]}, {place}")
    r.do(f"ret {_struct(len(results))} {value}")
    return r.text


def _struct(count: int) -> str:
    return f"{{ {', '.join([DOUBLES] * count)} }}"


STRUCT = _struct(4)


def called(r: Routine, name: str, arguments: Iterable[str], count: int) -> Parts:
    """What a function of the library gives."""
    given = ", ".join(f"{DOUBLES} {argument}" for argument in arguments)
    value = r.emit(f"call {_struct(count)} @ray_{name}({given})")
    return [r.emit(f"extractvalue {_struct(count)} {value}, {k}") for k in range(count)]


class ModelCalls:
    """The calls that make the models of leaves, in a routine."""

    def __init__(self, rays: RayForm, r: Routine) -> None:
        self.rays, self.r = rays, r
        self.known: dict[int, Parts] = {
            k: [*(f"%{axis}_{part}" for part in ("low", "high", "linear")), ZERO] for k, axis in enumerate(AXES)
        }

    def needed(self, wanted: Iterable[int], known: Mapping[int, Parts]) -> list[int]:
        """The models to be made, in order."""
        seen: set[int] = set()
        stack = list(wanted)
        while stack:
            number = stack.pop()
            if number not in seen and number not in known:
                seen.add(number)
                call = self.rays.calls[number - len(AXES)]
                stack.extend(value.number for value in call.arguments if value.kind == MODEL)
        return sorted(seen)

    def share(self) -> None:
        """Make what more than one leaf needs, where that is much."""
        leaves = [leaf.number for leaf in self.rays.leaves if leaf.kind == MODEL]
        uses = Counter(part for leaf in leaves for part in self.needed([leaf], self.known))
        large = [part for part, count in uses.items() if count > 1 and len(self.needed([part], self.known)) > MUCH]
        self.make(sorted(large), self.known)

    def leaf(self, number: int, known: dict[int, Parts]) -> Parts:
        """The model of a leaf."""
        leaf = self.rays.leaves[number]
        if leaf.kind == NUMBER:
            k = self.uniform(leaf.number)
            return [k, k, ZERO, ZERO]
        self.make([leaf.number], known)
        return known[leaf.number]

    def make(self, wanted: Iterable[int], known: dict[int, Parts]) -> None:
        """Make models, and note them."""
        for number in self.needed(wanted, known):
            call = self.rays.calls[number - len(AXES)]
            function = self.rays.library[call.function]
            given: list[str] = []
            for value, kind in zip(call.arguments, function.parameters, strict=True):
                parts = known[value.number] if value.kind == MODEL else [self.uniform(value.number)]
                given += parts[: len(input_names(0, kind))]
            results = called(self.r, function.name, given, len(_results(function)))
            known[number] = [*results, *[ZERO] * (4 - len(results))]

    def uniform(self, number: int) -> str:
        """A uniform number in every lane."""
        return self.r.splat(self.r.load("%constants", number, "double"))


class _ReducedModel(ReducedWalk):
    """The model of the form where some operands do not matter."""

    types = (DOUBLES,) * 4

    def __init__(self, s: RayFormulas, r: Routine) -> None:
        super().__init__(s.gates, len(s.rays.leaves), r)
        self.s = s
        self.calls = ModelCalls(s.rays, r)
        self.calls.share()

    def leaf(self, number: int) -> Parts:
        return self.calls.leaf(number, dict(self.calls.known))

    def neutral(self, gate: Gate) -> Parts:
        end = self.r.number(HUGE if gate.operation == "min" else -HUGE).name
        return [end, end, ZERO, ZERO]

    def join(self, gate: Gate, a: Parts, b: Parts) -> Parts:
        return called(self.r, gate.operation, [*a, *b], 4)

    def made(self, gate: int, a: Parts, b: Parts) -> Parts:
        """The value of a gate: where an operand is skipped the other one, for a call takes longer than to look."""
        r, number = self.r, len(self.r.lines)
        first, second = self.idle(gate, 0), self.idle(gate, 1)
        one = r.emit(f"or i1 {first}, {second}")
        r.do(f"br i1 {one}, label %one{number}, label %both{number}")
        r.start(f"one{number}")
        kept = [r.emit(f"select i1 {first}, {DOUBLES} {q}, {DOUBLES} {p}") for p, q in zip(a, b, strict=True)]
        r.do(f"br label %made{number}")
        r.start(f"both{number}")
        joined = self.join(self.s.gates[gate], a, b)
        r.label(f"joined{number}")
        r.label(f"made{number}")
        pairs = zip(kept, joined, strict=True)
        return [r.emit(f"phi {DOUBLES} [ {p}, %one{number} ], [ {q}, %joined{number} ]") for p, q in pairs]


def model(s: RayFormulas) -> Routine:
    """The model of the form on a segment of each lane."""
    r = Routine("model", dict.fromkeys(ENDS, DOUBLES) | {"constants": "ptr", "words": "ptr"}, _struct(4), True)
    value = "poison"
    for place, part in enumerate(_ReducedModel(s, r).emit()):
        value = r.emit(f"insertvalue {_struct(4)} {value}, {DOUBLES} {part}, {place}")
    r.do(f"ret {_struct(4)} {value}")
    return r


def survey(s: RayFormulas) -> Routine:
    """Which operands of gates do not matter on a segment of each lane: words, those of each lane a stride apart."""
    parameters = dict.fromkeys(ENDS, DOUBLES) | {"constants": "ptr", "words": "ptr", "stride": "i64"}
    r = Routine("survey", parameters, internal=True)
    calls = ModelCalls(s.rays, r)
    values = [calls.leaf(number, calls.known) for number in range(len(s.rays.leaves))]
    vector = f"<{LANES} x i64>"
    words = [ZERO] * s.words
    ranges: dict[int, Parts] = {}

    def ends(operand: int) -> Iterable[Value]:
        if operand not in ranges:
            ranges[operand] = called(r, "range", values[operand], 2)
        return map(r.value, ranges[operand])

    for number, (operation, *operands) in enumerate(s.gates):
        for position, idle in _idle(s, r, operation, operands, ends):
            word, bit = divmod(2 * number + position, WORD)
            words[word] = with_bit(r, words[word], idle.name, bit)
        values.append(called(r, operation, [*values[operands[0]], *values[operands[1]]], 4))
    for word, flags in enumerate(words):
        for lane in range(LANES):
            one = r.emit(f"extractelement {vector} {flags}, i32 {lane}")
            place = r.emit(f"add i64 {r.emit(f'mul i64 %stride, {lane}')}, {word}")
            r.do(f"store i64 {one}, ptr {r.place('%words', 'i64', place)}, align 8")
    r.do("ret void")
    return r


def _idle(
    s: RayFormulas, r: Routine, operation: str, operands: Sequence[int], ends: Callable[[int], Iterable[Value]]
) -> Iterator[tuple[int, Value]]:
    """Where each operand of a gate does not matter."""
    if s.celled:
        ranges = [(-high, -low) if operation == "max" else (low, high) for low, high in map(ends, operands)]
        known = [r.value("splat (i1 true)" if s.everywhere[operand] else ZERO, "i1") for operand in operands]
        yield from enumerate(idle_operands(ranges, known))
        return
    for position, operand in enumerate(operands):
        if s.everywhere[operand]:
            low, high = ends(operand)
            yield position, low > 0.0 if operation == "min" else high < 0.0


def idle_operands(ranges: Sequence[tuple[Value, Value]], known: Sequence[Value]) -> tuple[Value, Value]:
    """Which operands of a min do not matter for its sign: what is positive, and what is beside a negative one.

    Only what has a value everywhere, and not both of two negative ones.
    """
    (low, high), (other_low, other_high) = ranges
    second = known[1] & ((other_low > 0.0) | (high < 0.0))
    return known[0] & ((low > 0.0) | ((other_high < 0.0) & (second ^ 1))), second


class _ReducedPoint(ReducedWalk):
    """The value of the form at points, about a distance near its zeros, and its active leaf; of equals the first."""

    types = (DOUBLES, SHORTS)

    def __init__(self, s: RayFormulas, r: Routine) -> None:
        super().__init__(s.gates, len(s.rays.leaves), r)
        self.s = s
        self.known = s.points.inputs(dict(zip(s.coordinates, ("%x", "%y", "%z"), strict=True)))
        share_parts(s.points, r, [f"leaf{k}" for k in range(s.count)], self.known)
        self.tolerance = r.element("%constants", s.tolerance)

    def leaf(self, number: int) -> Parts:
        if number >= self.s.count:  # a guard: at a point the leaves tell themselves where they are undefined
            return [self.r.number(float("inf")).name, leaf_number(0)]
        (value,) = self.s.points.outputs(self.r, [f"leaf{number}"], dict(self.known))
        return [(value * self.r.element("%constants", self.s.scales + number)).name, leaf_number(number)]

    def neutral(self, gate: Gate) -> Parts:
        infinite = self.r.number(float("inf") if gate.operation == "min" else float("-inf"))
        return [infinite.name, leaf_number(0)]

    def join(self, gate: Gate, a: Parts, b: Parts) -> Parts:
        return first_of_equals(self.r, gate.operation, a, b, self.tolerance)


def first_of_equals(r: Routine, operation: str, a: Parts, b: Parts, tolerance: Value) -> Parts:
    """The min or max of two values, and the number of its leaf; of what lies no farther apart the first leaf."""
    p, q = r.value(a[0]), r.value(b[0])
    take = better(operation, p, q)
    first = r.emit(f"icmp slt {SHORTS} {a[1]}, {b[1]}")
    equal = abs(p - q).compare("ole", tolerance)
    chosen = r.select(take.name, a[1], b[1], SHORTS)
    name = r.select(equal.name, r.select(first, a[1], b[1], SHORTS), chosen, SHORTS)
    return [take.choose(p, q).name, name]


def point(s: RayFormulas) -> Routine:
    """The form at a point of each lane."""
    r = Routine("point", dict.fromkeys(AXES, DOUBLES) | {"constants": "ptr", "words": "ptr"}, NAMED, True)
    value, leaf = _ReducedPoint(s, r).emit()
    first = r.emit(f"insertvalue {NAMED} poison, {DOUBLES} {value}, 0")
    r.do(f"ret {NAMED} {r.emit(f'insertvalue {NAMED} {first}, {SHORTS} {leaf}, 1')}")
    return r
