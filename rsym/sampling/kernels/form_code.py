"""Routines of the sign form and its leaves at points: whole, and reduced to the operands that matter in a block."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import TypeAlias

from rsym.backends.vector_code import Value
from rsym.bounds.intervals import interval_program
from rsym.logic.gates import Gate
from rsym.logic.sign_form import SignForm
from rsym.program.differentiation import gradient
from rsym.program.expansion import expand
from rsym.program.program import Program, assemble, live
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Formulas, Routine

AXES = ("x", "y", "z")
ENDS = ("lower", "upper")
WORD = 64  # bits
Parts: TypeAlias = list[str]  # the names of what makes up a value


class LeafFormulas:
    """A sign form as its routines need it; without `gradients` the values of leaves alone."""

    def __init__(self, form: SignForm, *, gradients: bool = True) -> None:
        self.form, self.gradients = form, gradients
        self.gates: tuple[Gate, ...] = form.gates
        self.count = len(form.leaves)
        self.coordinates = form.builder.coordinates

    @cached_property
    def program(self) -> Program:
        """Value and gradient of every leaf."""
        return leaf_program(self.form, gradients=self.gradients)

    @cached_property
    def scaled_program(self) -> Program:
        """The same, each leaf times its scale."""
        return leaf_program(self.form, scaled=True, gradients=self.gradients)

    @cached_property
    def points(self) -> Formulas:
        """Leaves at points, each times its scale, a letter."""
        return Formulas(expand(self.scaled_program))

    @cached_property
    def bounds(self) -> Formulas:
        """Leaves over boxes, by mean values where a coordinate repeats; nothing where one may be undefined."""
        leaves = [number for _, number in self.program.outputs[:: 1 + len(AXES) * self.gradients]]
        return Formulas(expand(interval_program(self.program, leaves, strict=True)), self.points.constants)

    @property
    def words(self) -> int:
        """How many words hold a bit for each operand of each gate."""
        return max(1, -(-2 * len(self.gates) // WORD))

    def at(self, r: Routine, points: str, stride: str, i: str) -> dict[int, str]:
        """The coordinates of points from `i` on, as inputs."""
        places = [r.load(r.row(points, stride, k), i) for k in range(3)]
        return self.points.inputs(dict(zip(self.coordinates, places, strict=True)))


def leaf_outputs(k: int) -> list[str]:
    """The names of value and derivatives of a leaf."""
    return [f"leaf{k}", *(f"leaf{k}_{axis}" for axis in AXES)]


def scale_letters(count: int) -> list[str]:
    """The letters that leaves are multiplied by; no letter of a user has a space in its name."""
    return [f"scale {k}" for k in range(count)]


def leaf_program(form: SignForm, scaled: bool = False, gradients: bool = True) -> Program:
    """Value and gradient of every leaf."""
    b = form.builder
    outputs: dict[str, int] = {}
    scales = scale_letters(len(form.leaves)) if scaled else []
    for k, leaf in enumerate(form.leaves):
        value = b.mul(b.input(scales[k]), leaf) if scaled else leaf
        outputs.update(
            zip(leaf_outputs(k), (value, *gradient(b, value)), strict=True) if gradients else {f"leaf{k}": value}
        )
    return assemble(b.nodes, b.coordinates, (*b.letters, *scales), outputs)


# Operations. Mostly one leaf or two matter in a block: what only others need is lost, and what waits takes registers.
# With everything shared, signs of the car took three times as long.
MUCH = 50
NAMED = f"{{ {DOUBLES}, {SHORTS} }}"


def form(s: LeafFormulas) -> Routine:
    """The form at points of one block, its idle operands left out."""
    r = Routine("form", dict.fromkeys(AXES, DOUBLES) | {"constants": "ptr", "words": "ptr"}, DOUBLES, True)
    (value,) = ReducedForm(s, r, named=False).emit()
    r.do(f"ret {DOUBLES} {value}")
    return r


def named(s: LeafFormulas) -> Routine:
    """The same, and the number of the leaf that is active."""
    r = Routine("named", dict.fromkeys(AXES, DOUBLES) | {"constants": "ptr", "words": "ptr"}, NAMED, True)
    value, leaf = ReducedForm(s, r, named=True).emit()
    first = r.emit(f"insertvalue {NAMED} poison, {DOUBLES} {value}, 0")
    r.do(f"ret {NAMED} {r.emit(f'insertvalue {NAMED} {first}, {SHORTS} {leaf}, 1')}")
    return r


def value(s: LeafFormulas) -> Routine:
    """The form at any points, and the number of the leaf that is active."""
    r = Routine(
        "value",
        {"count": "i64", "points": "ptr", "stride": "i64", "constants": "ptr", "value": "ptr", "leaf": "ptr"},
    )
    with r.loop("0", "%count", LANES) as i:
        known = s.at(r, "%points", "%stride", i)
        values = s.points.outputs(r, (f"leaf{k}" for k in range(s.count)), known)
        names = [leaf_number(k) for k in range(s.count)]
        for operation, first, second in s.gates:
            take = better(operation, values[first], values[second])
            names.append(r.select(take.name, names[first], names[second], SHORTS))
            values.append(take.choose(values[first], values[second]))
        r.store(values[-1].name, "%value", i)
        r.store(names[-1], "%leaf", i, SHORTS)
    r.do("ret void")
    return r


class ReducedWalk(ABC):
    """A form where some operands of its gates do not matter, as branches around them.

    An explicit stack walks the gates, so that deep nests do no harm. What several places use is computed before.
    """

    def __init__(self, gates: Sequence[Gate], count: int, r: Routine) -> None:
        self.gates, self.count, self.r = gates, count, r
        self.values: dict[int, Parts] = {}

    @property
    @abstractmethod
    def types(self) -> Sequence[str]:
        """The types of the parts of a value."""

    @abstractmethod
    def leaf(self, number: int) -> Parts:
        """The value of a leaf."""

    @abstractmethod
    def neutral(self, gate: Gate) -> Parts:
        """What the gate never chooses."""

    @abstractmethod
    def join(self, gate: Gate, a: Parts, b: Parts) -> Parts:
        """The value of a gate."""

    def emit(self) -> Parts:
        """The value of the form."""
        uses = Counter(operand for _, *operands in self.gates for operand in operands)
        for gate in range(self.count, self.count + len(self.gates)):
            if uses[gate] > 1:
                self.values[gate] = self._walk(gate)
        return self._walk(self.count + len(self.gates) - 1)

    def _walk(self, root: int) -> Parts:
        results: list[Parts] = []
        actions: list[Callable[[], None]] = []

        def visit(operand: int) -> None:
            if operand in self.values:
                results.append(self.values[operand])
            elif operand < self.count:
                results.append(self.leaf(operand))
            else:
                gate = operand - self.count
                _, first, second = self.gates[gate]
                actions.append(partial(self._join, gate, results))
                for position, inner in ((1, second), (0, first)):
                    mark = f"{len(self.r.lines)}.{len(actions)}"
                    actions.append(partial(self._leave, gate, mark, results))
                    actions.append(partial(visit, inner))
                    actions.append(partial(self._enter, gate, position, mark))

        visit(root)
        while actions:
            actions.pop()()
        return results.pop()

    def idle(self, gate: int, position: int) -> str:
        """Whether the bit of an operand is set."""
        word, bit = divmod(2 * gate + position, WORD)
        flags = self.r.load("%words", word, "i64")
        return self.r.emit(f"icmp ne i64 {self.r.emit(f'and i64 {flags}, {1 << bit}')}, 0")

    def _enter(self, gate: int, position: int, mark: str) -> None:
        """Skip the operand if its bit is set."""
        r, idle = self.r, self.idle(gate, position)
        r.label(f"ask{mark}")
        r.do(f"br i1 {idle}, label %join{mark}, label %work{mark}")
        r.start(f"work{mark}")

    def _leave(self, gate: int, mark: str, results: list[Parts]) -> None:
        """Where the operand was skipped, what no min or max chooses."""
        r, values = self.r, results.pop()
        neutral = self.neutral(self.gates[gate])
        r.label(f"done{mark}")
        r.label(f"join{mark}")
        triples = zip(self.types, neutral, values, strict=True)
        results.append([r.emit(f"phi {kind} [ {n}, %ask{mark} ], [ {v}, %done{mark} ]") for kind, n, v in triples])

    def _join(self, gate: int, results: list[Parts]) -> None:
        b, a = results.pop(), results.pop()
        results.append(self.made(gate, a, b))

    def made(self, gate: int, a: Parts, b: Parts) -> Parts:
        """The value of a gate by its number."""
        return self.join(self.gates[gate], a, b)


class ReducedForm(ReducedWalk):
    """The form at points, and if asked the number of the active leaf."""

    def __init__(self, formulas: LeafFormulas, r: Routine, named: bool) -> None:
        super().__init__(formulas.gates, formulas.count, r)
        self.formulas, self.named = formulas, named
        self.known = formulas.points.inputs(dict(zip(formulas.coordinates, ("%x", "%y", "%z"), strict=True)))
        share_parts(formulas.points, r, [f"leaf{k}" for k in range(formulas.count)], self.known)

    @property
    def types(self) -> Sequence[str]:
        """Value and number."""
        return (DOUBLES, SHORTS) if self.named else (DOUBLES,)

    def leaf(self, number: int) -> Parts:
        """The value of a leaf."""
        known = dict(self.known)
        (value,) = self.formulas.points.outputs(self.r, [f"leaf{number}"], known)
        return [value.name, leaf_number(number)] if self.named else [value.name]

    def neutral(self, gate: Gate) -> Parts:
        """An infinite value, of any leaf."""
        infinite = self.r.number(float("inf") if gate.operation == "min" else float("-inf")).name
        return [infinite, leaf_number(0)] if self.named else [infinite]

    def join(self, gate: Gate, a: Parts, b: Parts) -> Parts:
        """The better of both."""
        take = better(gate.operation, self.r.value(a[0]), self.r.value(b[0])).name
        parts = list(zip(self.types, a, b, strict=True))
        return [self.r.select(take, p, q, kind) for kind, p, q in parts[::-1]][::-1]


def share_parts(points: Formulas, r: Routine, outputs: Sequence[str], known: dict[int, str]) -> None:
    """Compute what more than one output needs, where that is much."""
    nodes = [points.numbers[name] for name in outputs]
    uses = Counter(part for node in nodes for part in live(points.program.nodes, [node]))
    shared = [part for part, count in uses.items() if count > 1 and not points.program.uniform[part]]
    large = [part for part in shared if len(live(points.program.nodes, [part])) > MUCH]
    points.emit(r, large, known)


def better(operation: str, a: Value, b: Value) -> Value:
    """Where a is the min (max) of both, or undefined: NaN must not get lost."""
    return (a < b if operation == "min" else a > b) | a.compare("uno", a)


def leaf_number(number: int) -> str:
    """The number of a leaf in every lane."""
    return f"<{', '.join([f'i16 {number}'] * LANES)}>"


def with_bit(r: Routine, word: str, truths: str, bit: int) -> str:
    """The words of the lanes, with a bit set where something is true."""
    words = f"<{LANES} x i64>"
    number = (1 << bit) - (1 << WORD if bit == WORD - 1 else 0)
    yes = f"<{', '.join([f'i64 {number}'] * LANES)}>"
    return r.emit(f"or {words} {word}, {r.select(truths, yes, 'zeroinitializer', words)}")
