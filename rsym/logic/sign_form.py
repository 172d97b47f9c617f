"""The sign form: a shape as min and max of its leaves, with the zero set and the signs of omega.

The sign of an R-operation depends only on the signs of its arguments, so for the
sign a conjunction is a min and a disjunction a max, of whatever system; where
omega = 0 off the edges, its gradient has the direction of that of the active
argument. Positive factors drop, odd powers and normalisation too, and negations
move to the leaves: -(f and g) is -f or -g. What remains at the ends, a *leaf*,
has no R-operation on top: blends, trimming, joining and R-operations inside
arithmetic stay as they are.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from rsym.model.blends.gates import with_gates
from rsym.model.shape import Shape
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.program.operations import CONJUNCTIONS, KINKED, LOGICAL
from rsym.program.program import live


class Gate(NamedTuple):
    """A min or max of two operands: the number of a leaf, or the number of leaves plus that of an earlier gate."""

    operation: str
    first: int
    second: int


@dataclass(frozen=True)
class SignForm:
    """Leaves, and the gates that join them; the last gate is the form, without gates the only leaf.

    Attributes
    ----------
    builder : Builder
        Where the leaves are nodes.
    leaves : tuple of int
        Their nodes. A leaf is positive where its part of the body is inside.
    gates : tuple of Gate
        In the order of evaluation.
    parameters : tuple of (operation, node)
        The parameters of the R-operations that became gates, which must be legal for the form to hold.
    caps : int
        How many of the last leaves are sides of the bounds.
    """

    builder: Builder = field(repr=False)
    leaves: tuple[int, ...]
    gates: tuple[Gate, ...]
    parameters: tuple[tuple[str, int], ...] = ()
    caps: int = 0

    @property
    def value(self) -> int:
        """The node of the form."""
        nodes = list(self.leaves)
        for operation, first, second in self.gates:
            nodes.append(self.builder.make(operation, nodes[first], nodes[second]))
        return nodes[-1]

    def capped(self) -> SignForm:
        """The form inside its bounds, six leaves more; the bounds are the letters ``x lower``, ``x upper``, ..."""
        b = self.builder
        sides = []
        for name in b.coordinates:
            lower, upper = cap_letters(name)
            sides += [b.sub(b.input(name), b.input(lower)), b.sub(b.input(upper), b.input(name))]
        shift, count = len(sides), len(self.leaves)
        gates = [Gate(op, *(a + shift * (a >= count) for a in operands)) for op, *operands in self.gates]
        form = count + shift + len(gates) - 1 if gates else 0
        # The sides among themselves first: where none of them matters that is one question.
        last = count
        for number in range(1, shift):
            gates.append(Gate("min", last, count + number))
            last = count + shift + len(gates) - 1
        gates.append(Gate("min", form, last))
        return SignForm(b, (*self.leaves, *sides), tuple(gates), self.parameters, shift)


def cap_letters(coordinate: str) -> tuple[str, str]:
    """The letters of the bounds of a coordinate; no letter of a user has a space in its name."""
    return f"{coordinate} lower", f"{coordinate} upper"


def surface_form(shape: Shape) -> SignForm:
    """The sign form of a shape.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> form = surface_form(rsym.Shape(rsym.conjunction(x, -rsym.conjunction(y, z)), (x, y, z)))
    >>> form.gates
    (Gate(operation='max', first=1, second=2), Gate(operation='min', first=0, second=3))
    """
    names = tuple(symbol.name for symbol in shape.coordinates)
    builder = Builder(names, (*shape.letters, *(letter for name in names for letter in cap_letters(name))))
    return sign_form(builder, lower(builder, with_gates(shape.expression)))


def shape_form(shape: Shape) -> SignForm:
    """The sign form in the coordinates and letters of a shape alone: the same leaves, in the same order."""
    builder = Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(shape.letters))
    return sign_form(builder, lower(builder, with_gates(shape.expression)))


def sign_form(builder: Builder, number: int) -> SignForm:
    """The sign form of a node."""
    leaves: dict[int, int] = {}
    joined: list[tuple[str, Operand, Operand]] = []
    parameters: dict[tuple[str, int], None] = {}
    done: dict[Signed, Operand] = {}
    for part, operands in postorder(stripped(builder, number, 1), lambda part: _operands(builder, part)):
        if not operands:
            leaf = part.number if part.sign > 0 else builder.neg(part.number)
            done[part] = Operand(False, leaves.setdefault(leaf, len(leaves)))
            continue
        operation, arguments, _ = builder.nodes[part.number]
        parameters.update(((operation, parameter), None) for parameter in arguments[2:])
        first, second = (done[operand] for operand in operands)
        if first == second:
            done[part] = first
        else:
            joined.append(("min" if (operation in CONJUNCTIONS) == (part.sign > 0) else "max", first, second))
            done[part] = Operand(True, len(joined) - 1)
    gates = tuple(Gate(op, *(k + gate * len(leaves) for gate, k in operands)) for op, *operands in joined)
    return SignForm(builder, tuple(leaves), gates, tuple(parameters))


class Operand(NamedTuple):
    """A gate or a leaf by its number among its kind."""

    is_gate: bool
    number: int


class Signed(NamedTuple):
    """A node times 1 or -1."""

    number: int
    sign: int


def postorder(
    root: Signed, operands_of: Callable[[Signed], Sequence[Signed]]
) -> Iterator[tuple[Signed, Sequence[Signed]]]:
    """Each part once, after its operands; a leaf has none. Iterative: nests of five hundred must work."""
    seen: set[Signed] = set()
    stack = [(root, False)]
    while stack:
        part, ready = stack.pop()
        if part in seen:
            continue
        operands = operands_of(part)
        if ready or not operands:
            seen.add(part)
            yield part, operands
        else:
            stack.append((part, True))
            stack.extend((operand, False) for operand in reversed(operands))


def _operands(builder: Builder, part: Signed) -> Sequence[Signed]:
    operation, arguments, _ = builder.nodes[part.number]
    joins = operation in LOGICAL
    return [stripped(builder, argument, part.sign) for argument in arguments[:2]] if joins else ()


def stripped(builder: Builder, number: int, sign: int) -> Signed:
    """Without negations and negative constants, which count, positive factors, odd powers and normalisation."""
    while True:
        operation, arguments, data = builder.nodes[number]
        if operation == "neg":
            number, sign = arguments[0], -sign
        elif operation == "zero_with":
            number = arguments[1]
        elif operation == "normalised" or (operation == "powi" and isinstance(data, int) and data % 2 == 1):
            number = arguments[0]
        elif operation == "div" and is_positive(builder, arguments[1]):
            number = arguments[0]
        elif operation == "mul" and (builder.value(arguments[0]) or 0) < 0:
            number, sign = arguments[1], -sign
        elif operation == "mul" and is_positive(builder, arguments[0]):
            number = arguments[1]
        elif operation == "mul" and is_positive(builder, arguments[1]):
            number = arguments[0]
        else:
            return Signed(number, sign)


def has_kinks(builder: Builder, leaf: int) -> bool:
    """Whether a leaf has an operation inside that may make a kink in its zero set."""
    return any(builder.nodes[number].operation in KINKED for number in live(builder.nodes, [leaf]))


def is_positive(builder: Builder, number: int) -> bool:
    """Whether the form of a node shows that it is positive wherever it is defined; no form shows it of a letter."""
    operation, arguments, data = builder.nodes[number]
    if operation == "const":
        value = builder.value(number)
        return value is None or value > 0  # pi, e
    if operation == "exp":
        return True
    if operation == "add":
        return all(builder.nonnegative[a] for a in arguments) and any(is_positive(builder, a) for a in arguments)
    if operation in {"mul", "div", "sqrt"} or (operation == "powi" and data is not None):
        return all(is_positive(builder, argument) for argument in arguments)
    return False
