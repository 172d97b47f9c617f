"""The leaves of a form as tapes, one set of tapes for all leaves that are the same but for uniform numbers.

A kind is found before anything is differentiated or bounded, so what a form costs to prepare grows with its kinds;
each leaf has a row of numbers for each tape.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.interpreter import CHECK_POINTS, check_at
from rsym.backends.tape import TapeFunction, UniformNumbers
from rsym.bounds.intervals import interval_program
from rsym.logic.sign_form import SignForm
from rsym.model.symbols import with_operands
from rsym.program.builder import Builder
from rsym.program.expansion import expand
from rsym.program.program import FLOAT64, Node, Program, assemble
from rsym.program.tape import Tape, tape_of
from rsym.sampling.kernels.form_code import ENDS, LeafFormulas, leaf_outputs
from rsym.sampling.kernels.leaf_kinds import ordered_nodes

# Operations whose formulas do not depend on what their uniform operands are; in others a constant stays one.
LIFTED = frozenset({"add", "mul", "div"})
SCALE = "the scale"  # no end of a letter is called so


class KindTape(NamedTuple):
    """A tape of a kind, what its uniform numbers are made of, and how many coordinates it has."""

    tape: Tape
    numbers: UniformNumbers
    coordinates: int


@dataclass(frozen=True)
class TapedKind:
    """The formulas of leaves: value and gradient at points, their bounds over boxes; letters are what is lifted.

    `formulas` has the outputs of `leaf_outputs`, at points each times a scale, its last letter, over boxes two ends
    for each.
    """

    formulas: LeafFormulas
    outputs: tuple[str, ...]

    @property
    def points(self) -> Program:
        """All outputs at points."""
        return self.formulas.points.program

    def tape(self, name: str) -> KindTape:
        """The tape "value", "gradient", "box" or "enclosure", made when it is first asked for."""
        if name not in self._tapes:
            self._tapes[name] = self._made(name)
        return self._tapes[name]

    @cached_property
    def _tapes(self) -> dict[str, KindTape]:
        return {}

    def _made(self, name: str) -> KindTape:
        ends = [f"{output}_{end}" for output in self.outputs for end in ENDS]
        match name:
            case "value":
                return kind_tape(self.points, self.outputs[:1])
            case "gradient":
                return kind_tape(self.points, self.outputs)
            case "box":
                return kind_tape(_scaled(self.formulas.bounds.program, ends[:2]), ends[:2])
        return kind_tape(self.formulas.bounds.program, ends)


def _scaled(program: Program, names: Sequence[str]) -> Program:
    """These outputs times a last letter, the scale: leaves are compared over boxes as they are at points."""
    numbers, count = dict(program.outputs), len(program.nodes)
    products = [Node("mul", (count, numbers[name])) for name in names]
    nodes = (*program.nodes, Node("input", (), SCALE), *products)
    outputs = tuple((name, count + 1 + k) for k, name in enumerate(names))
    return Program(nodes, program.coordinates, (*program.letters, SCALE), outputs)


def kind_tape(program: Program, names: Sequence[str]) -> KindTape:
    """The tape of these outputs of an expanded program."""
    numbers = dict(program.outputs)
    one = assemble(program.nodes, program.coordinates, program.letters, {name: numbers[name] for name in names})
    tape = tape_of(one)
    return KindTape(tape, UniformNumbers(one, tape.uniform), len(one.coordinates))


def check_tape(program: Program) -> None:
    """Compare with the interpreter: a miscompiled formula must never get any further."""
    generator = np.random.default_rng(20130605)
    points = [generator.uniform(-1, 1, CHECK_POINTS) for _ in program.coordinates]
    check_at(program, TapeFunction(program), FLOAT64, points, [1.0 + k / 8 for k in range(len(program.letters))])


def leaf_numbers(tapes: Sequence[KindTape], kind: Ints, given: Sequence[Sequence[float]]) -> tuple[Floats, Ints]:
    """The uniform numbers of all leaves, one after the other, from their letters, and where those of each begin."""
    start = np.zeros(len(kind) + 1, np.int64)
    start[1:] = np.cumsum(np.array([len(one.tape.uniform) for one in tapes])[kind])
    rows = np.empty(start[-1])
    for number, one in enumerate(tapes):
        some, width = np.flatnonzero(kind == number), np.arange(len(one.tape.uniform))
        rows[start[some, None] + width] = one.numbers([given[k] for k in some.tolist()])
    return rows, start


class LeafTapes:
    """The kinds of leaves of a form, which each leaf is of, and their numbers for some letters.

    Parameters
    ----------
    form : SignForm
    shared : bool
        Whether leaves that are the same but for numbers are one kind; else each leaf is one.
    gradients : bool
        Whether more than values and their bounds will be asked for.
    """

    def __init__(self, form: SignForm, *, shared: bool, gradients: bool = True) -> None:
        self.count = len(form.leaves)
        if shared:
            lifted = LiftedLetters(form)
            self.letters: _Letters = lifted
            forms, self.kind = lifted.forms()
            made = [LeafFormulas(one, gradients=gradients) for one in forms]
            self.kinds = [TapedKind(one, tuple(leaf_outputs(0))) for one in made]
        else:
            self.letters = _OwnLetters(form)
            formulas = LeafFormulas(form)
            self.kinds = [TapedKind(formulas, tuple(leaf_outputs(k))) for k in range(self.count)]
            self.kind = np.arange(self.count)

    def named(self, name: str) -> tuple[Sequence[KindTape], Ints]:
        """The tapes of one name, one for each kind, and the kind of each leaf."""
        return [kind.tape(name) for kind in self.kinds], self.kind

    def numbers(self, letters: Sequence[float], scales: Floats) -> LeafNumbers:
        """For each tape the numbers of all leaves, one after the other, and where those of each leaf begin."""
        return LeafNumbers(self, letters, scales)


class LeafNumbers(dict[str, tuple[Floats, Ints]]):
    """The numbers of tapes by name, found when they are first asked for."""

    def __init__(self, tapes: LeafTapes, letters: Sequence[float], scales: Floats) -> None:
        self._tapes, self._letters, self._scales = tapes, letters, scales

    @cached_property
    def undefined(self) -> Flags:
        """Which leaves have a number that is not defined: their bounds do not know."""
        return np.array([any(number != number for number in own) for own in self._at_points])

    @cached_property
    def _at_points(self) -> Sequence[Sequence[float]]:
        return self._tapes.letters.at(self._letters, self._scales)

    def __missing__(self, name: str) -> tuple[Floats, Ints]:
        """Those of one tape."""
        own = self._tapes.letters
        if name in ("value", "gradient"):
            given = self._at_points
        elif name == "enclosure":
            given = own.ends(self._letters)
        else:
            given = [[*ends, scale] for ends, scale in zip(own.ends(self._letters), self._scales, strict=True)]
        found = self[name] = leaf_numbers(*self._tapes.named(name), given)
        return found


class _Letters(Protocol):
    """The letters of the formulas of each leaf."""

    def at(self, letters: Sequence[float], scales: Floats) -> Sequence[Sequence[float]]:
        """Of the formulas at points, the scale last."""

    def ends(self, letters: Sequence[float]) -> Sequence[Sequence[float]]:
        """Of the formulas over boxes: lower and upper ends."""


class _OwnLetters:
    """Those of the form, and all scales."""

    def __init__(self, form: SignForm) -> None:
        self._count = len(form.leaves)

    def at(self, letters: Sequence[float], scales: Floats) -> Sequence[Sequence[float]]:
        return [[*letters, *scales]] * self._count

    def ends(self, letters: Sequence[float]) -> Sequence[Sequence[float]]:
        return [np.repeat(letters, 2).tolist()] * self._count


class LiftedLetters:
    """What is uniform in a leaf, each place a letter of its own."""

    def __init__(self, form: SignForm) -> None:
        self._program = form.builder.program({str(k): leaf for k, leaf in enumerate(form.leaves)})
        nodes, numbers = ordered_nodes(self._program), dict(self._program.outputs)
        uniform, angles = self._program.uniform, _angles(nodes)
        self._leaves = [_lifted(nodes, uniform, angles, numbers[str(k)]) for k in range(len(form.leaves))]
        used = {number for _, lifted in self._leaves for number in lifted}
        part = assemble(self._program.nodes, (), self._program.letters, {f"{number}": number for number in used})
        self._values = _uniform(expand(part))
        self._bounds = _uniform(expand(interval_program(part)))
        self._places = {int(name): k for k, (name, _) in enumerate(part.outputs)}

    def forms(self) -> tuple[list[SignForm], Ints]:
        """The kinds, each as a form of one leaf whose letters are what is lifted, and that of each leaf."""
        found: dict[tuple[Node, ...], int] = {}
        kind = [found.setdefault(nodes, len(found)) for nodes, _ in self._leaves]
        return [self._form(nodes) for nodes in found], np.array(kind)

    def _form(self, nodes: tuple[Node, ...]) -> SignForm:
        letters = tuple(str(node.data) for node in nodes if node.operation == "input")
        lifted = tuple(name for name in letters if name not in self._program.coordinates)
        builder = Builder(self._program.coordinates, lifted)
        made: list[int] = []  # sums that differ in the order of their operands are one node now
        for node in nodes:
            made.append(builder.make(node.operation, *(made[argument] for argument in node.arguments), data=node.data))
        return SignForm(builder, (made[-1],), ())

    def at(self, letters: Sequence[float], scales: Floats) -> Sequence[Sequence[float]]:
        """Of the formulas at points, the scale last."""
        values = self._values(letters)
        every = [[values[self._places[number]] for number in lifted] for _, lifted in self._leaves]
        return [[*own, scale] for own, scale in zip(every, scales, strict=True)]

    def ends(self, letters: Sequence[float]) -> Sequence[Sequence[float]]:
        """Of the formulas over boxes: lower and upper ends."""
        bounds = self._bounds(np.repeat(letters, 2)).reshape(-1, 2)
        return [bounds[[self._places[number] for number in lifted]].ravel().tolist() for _, lifted in self._leaves]


def _uniform(program: Program) -> UniformNumbers:
    return UniformNumbers(program, [number for _, number in program.outputs])


def _angles(nodes: Sequence[Node]) -> list[bool]:
    """Which nodes are angles: of these the bounds of a sine depend on whether whole turns count."""
    found: list[bool] = []
    for operation, arguments, _ in nodes:
        through = operation in {"neg", "add", "mul"} and any(found[argument] for argument in arguments)
        found.append(operation == "atan2" or through)
    return found


def _lifted(
    nodes: Sequence[Node], uniform: Sequence[bool], angles: Sequence[bool], leaf: int
) -> tuple[tuple[Node, ...], list[int]]:
    """The nodes of a leaf, uniform numbers in sums and products as letters, and what these are."""
    if uniform[leaf]:
        return (Node("input", (), "0"),), [leaf]
    local: dict[int, int] = {}
    found: list[Node] = []
    lifted: list[int] = []

    def letter(number: int) -> int:
        found.append(Node("input", (), f"{len(lifted)}"))
        lifted.append(number)
        return len(found) - 1

    def lifts(number: int, above: int) -> bool:
        free = nodes[above].operation in LIFTED and not angles[above]
        return uniform[number] and (free or nodes[number].operation != "const")

    def operands(number: int) -> Sequence[int]:
        return [a for a in nodes[number].arguments if a not in local and not lifts(a, number)]

    for number, _ in with_operands(leaf, operands, int):
        if number not in local:
            operation, arguments, data = nodes[number]
            own = tuple(letter(a) if lifts(a, number) else local[a] for a in arguments)
            found.append(Node(operation, own, data))
            local[number] = len(found) - 1
    return tuple(found), lifted
