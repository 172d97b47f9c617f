"""Lifting: min, max and absolute values inside sums and multiples come to the top, where they are gates.

Rounding keeps the order of numbers, so a + c and k*a, each rounded, of the larger of two numbers are the larger of
both results: max(a, b) + c = max(a + c, b + c) and -2*max(a, b) = min(-2*a, -2*b) to the last bit, and |a| is
max(a, -a). An offset or a shell of a body of a thousand parts is then a form of a thousand leaves, of which few matter
at a place, instead of one leaf that is evaluated in whole.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import partial

from rsym.logic.choices import sides
from rsym.logic.domains import replaced
from rsym.logic.gates import gate_of
from rsym.logic.sign_form import SignForm, sign_form
from rsym.logic.steps import chosen_gate, is_partial
from rsym.logic.stripping import sign_gate
from rsym.model.recent import recently
from rsym.model.symbols import with_operands
from rsym.program.builder import Builder
from rsym.program.program import live

TURNED = {"min": "max", "max": "min"}
CHOICES = {*TURNED, "abs"}
# Of so few choices in a leaf, as of so few gates, all is evaluated everywhere; they also keep the surface they had.
FEW = 64
MOST_FOLDS = 6  # in a leaf that is split in two by each
# So many times the choices of a leaf may be made on the way: absolute values within each other double them.
GROWTH = 32


def opened(form: SignForm) -> SignForm:
    """The form with the choices in its large leaves lifted to gates.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import surface_form
    >>> row = rsym.disjunction(*[1 - (x - 3 * k) ** 2 - y**2 for k in range(100)], system=rsym.R1)
    >>> form = surface_form(rsym.Shape(row / 2 - 1, (x, y, z)))
    >>> len(form.leaves), len(opened(form).leaves)
    (1, 100)
    """
    builder = form.builder
    leaves = tuple(lifted(builder, leaf) for leaf in form.leaves)
    if leaves == form.leaves:
        return form
    return replace(sign_form(builder, form.remade(leaves)), parameters=form.parameters)


@recently(16)
def unfolded(form: SignForm) -> SignForm:
    """The form with the choices in its leaves as gates, as long as it stays small: where they change are corners.

    Those within products and powers become two leaves with their condition, as steps are (`logic.steps`): that is a
    fold, and no zero of the form is there. Leaves that end at walls stay as they are, and choices of which a side has
    no value beyond its condition.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import shape_form
    >>> forms = [unfolded(shape_form(rsym.Shape(omega, (x, y)))) for omega in (1 - abs(x) - abs(y), 1 + abs(x) * y)]
    >>> [(len(form.leaves), len(form.folds)) for form in forms]
    [(4, 0), (4, 2)]
    """
    builder = form.builder
    unfolding = _Unfolding(builder)
    made = [unfolding.of(leaf) for leaf in form.leaves]
    if tuple(made) == form.leaves:
        return form
    found = sign_form(builder, form.remade(made, partial(sign_gate, builder)))
    if len(found.leaves) > FEW:
        return form
    faces = {leaf for node in unfolding.faces for leaf in sign_form(builder, node).leaves}
    folds = tuple(number for number, leaf in enumerate(found.leaves) if leaf not in faces)
    return replace(found, parameters=form.parameters, folds=folds)


class _Unfolding:
    """What leaves become, and all `faces` that they end in."""

    def __init__(self, builder: Builder) -> None:
        self.builder, self.faces = builder, list[int]()
        self._ended = {leaf for wall, ends in builder.walls.items() for leaf in (wall, *ends)}

    def of(self, leaf: int) -> int:
        """A leaf as gates of leaves without choices."""
        builder = self.builder
        node = leaf if leaf in self._ended or len(self.faces) > FEW else lifted(builder, leaf, 0)
        if gate_of(builder.nodes[node].operation):
            form = sign_form(builder, node)
            return form.remade([self.of(part) for part in form.leaves], partial(sign_gate, builder))
        found = None if leaf in self._ended or choices_in(builder, node) > MOST_FOLDS else self._first_fold(node)
        if found is None:
            self.faces.append(node)
            return node
        condition, *values = found
        return chosen_gate(builder, (condition, builder.neg(condition)), [self.of(value) for value in values])

    def _first_fold(self, node: int) -> tuple[int, int, int] | None:
        """The first condition on which a choice in a node depends, and the node where it holds and where not."""
        builder = self.builder
        for part in live(builder.nodes, [node]):
            if builder.uniform[part] or builder.nodes[part].operation not in {*CHOICES, "select"}:
                continue
            condition, *values = sides(builder, part)
            split = [replaced(builder, node, {part: value}) for value in values]
            if not is_partial(builder, *split):
                return condition, split[0], split[1]
        return None


def origins(form: SignForm, made: Sequence[int], found: SignForm) -> list[int]:
    """For each leaf of `found` the number of the leaf of a form that it comes from, which became the node `made` of it.

    -1 for those that come from none.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import surface_form
    >>> row = rsym.disjunction(*[1 - (x - 3 * k) ** 2 - y**2 for k in range(100)], system=rsym.R1)
    >>> form = surface_form(rsym.Shape(rsym.conjunction(z, row / 2 - 1), (x, y, z)))
    >>> large = [lifted(form.builder, leaf) for leaf in form.leaves]
    >>> origins(form, large, opened(form))[:3]
    [0, 1, 1]
    """
    first: dict[tuple[int, bool], int] = {}
    for number, node in enumerate(made):
        for leaf in (node,) if node == form.leaves[number] else sign_form(form.builder, node).leaves:
            first.setdefault((leaf, number in form.ends), number)
    flags = [number in found.ends for number in range(len(found.leaves))]
    return [
        first.get((leaf, end), first.get((leaf, not end), -1)) for leaf, end in zip(found.leaves, flags, strict=True)
    ]


def lifted(builder: Builder, number: int, few: int | None = None) -> int:
    """A node of the same value to the bit, with choices on top of sums and multiples if it has more than a few."""
    few = FEW if few is None else few
    choices = choices_in(builder, number)
    if choices <= few:
        return number
    lifting = _Lifting(builder, GROWTH * choices)
    found = number
    for part, below in with_operands(number, lifting.operands, int):
        found = lifting.lift(part) if below else part
    return number if lifting.made > lifting.most else found


def choices_in(builder: Builder, number: int, kinds: Collection[str] = CHOICES) -> int:
    """How many minima, maxima and absolute values a node is made of."""
    return sum(builder.nodes[part].operation in kinds for part in live(builder.nodes, [number]))


class _Lifting:
    """What nodes become, by their numbers, and how many gates were `made`, at `most` so many."""

    def __init__(self, builder: Builder, most: int) -> None:
        self.builder, self.most, self.made = builder, most, 0
        self._done: dict[int, int] = {}
        self._weight: dict[int, int] = {}
        self._large: dict[int, bool] = {}

    def operands(self, number: int) -> Sequence[int]:
        """The arguments through which choices come to the top.

        Of a sum they come from one side, and all leaves they choose from hold the other side: it must be small.
        """
        operation, arguments, _ = self.builder.nodes[number]
        if operation == "add" and all(self._is_large(argument) for argument in arguments):
            return ()
        if operation in CHOICES or operation in {"add", "neg"}:
            return arguments
        return arguments[1:] if operation == "mul" and self._factor(number) else ()

    def lift(self, number: int) -> int:
        """The node, those of its operands being known."""
        found = self._done[number] = self._lift(number)
        return found

    def _lift(self, number: int) -> int:
        make = self.builder.make
        operation, arguments, _ = self.builder.nodes[number]
        below = [self._done.get(argument, argument) for argument in arguments]
        if operation in TURNED:
            return make(operation, *below)
        if operation == "abs":
            return make("max", below[0], self._over(below[0], self.builder.neg, turned=True))
        if operation == "neg":
            return self._over(below[0], self.builder.neg, turned=True)
        if operation == "mul":
            negative = self._factor(number) < 0
            return self._over(below[1], lambda part: make("mul", arguments[0], part), turned=negative)
        k = 0 if self._gates(below[0]) >= self._gates(below[1]) else 1
        other = arguments[1 - k]
        return self._over(below[k], lambda part: make("add", *((part, other) if k == 0 else (other, part))))

    def _is_large(self, number: int) -> bool:
        """Whether a node holds more choices than are evaluated everywhere."""
        if number not in self._large:
            self._large[number] = choices_in(self.builder, number) > FEW
        return self._large[number]

    def _factor(self, number: int) -> float:
        """The constant that a node is a multiple by, 0 if it is none."""
        return float(self.builder.value(self.builder.nodes[number].arguments[0]) or 0)

    def _gates(self, number: int) -> int:
        """How many gates are on top of a node, each as often as it is used."""
        for part, below in with_operands(number, self._choices, int):
            if part not in self._weight:
                self._weight[part] = min(1 + sum(self._weight[one] for one in below), 1 << 62) if below else 0
        return self._weight[number]

    def _choices(self, number: int) -> Sequence[int]:
        operation, arguments, _ = self.builder.nodes[number]
        return arguments if operation in TURNED else ()

    def _over(self, number: int, call: Callable[[int], int], *, turned: bool = False) -> int:
        """What is done with a value, done with those that its gates choose from."""
        done: dict[int, int] = {}
        for part, below in with_operands(number, self._choices if self.made <= self.most else lambda _: (), int):
            if below:
                operation = self.builder.nodes[part].operation
                done[part] = self.builder.make(
                    TURNED[operation] if turned else operation, *(done[one] for one in below)
                )
                self.made += 1
            else:
                done[part] = call(part)
        return done[number]
