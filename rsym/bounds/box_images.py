"""The images of nodes over a box, as nodes of another builder."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from rsym.bounds.interval_arithmetic import Interval, nonnegative, only_nonnegative
from rsym.bounds.interval_images import IMAGES, chosen, scaled
from rsym.bounds.relations import relation
from rsym.program.builder import Builder
from rsym.program.definedness import Definedness, is_decisive
from rsym.program.program import Node, live


class BoxImages:
    """The image of each node of `source` over a box, made in `target` when it is asked for.

    `sides` gives intervals of inputs; an input ``x`` that it does not name has the ends ``x_lower``, ``x_upper``.
    """

    def __init__(
        self, source: Builder, target: Builder, sides: Mapping[str, Interval] | None = None, strict: bool = False
    ) -> None:
        self.source = source
        self.target = target
        self.sides = dict(sides or {})
        self.strict = strict
        self.images: dict[int, Interval] = {}
        self._definedness = Definedness((), [])
        self._examined = 0

    def __getitem__(self, number: int) -> Interval:
        if number not in self.images:
            self.make([number])
        return self.images[number]

    def make(self, numbers: Iterable[int]) -> None:
        """The images of these nodes and of all that they need."""
        for number in live(self.source.nodes, numbers):
            if number not in self.images:
                image = self._image(number, self.source.nodes[number])
                known = self.source.nonnegative[number] and not image.nonnegative
                self.images[number] = nonnegative(self.target, image) if known else image

    def side(self, name: str) -> Interval:
        """The interval of an input."""
        if name not in self.sides:
            lower, upper = ends_of([name])
            self.sides[name] = Interval(self.target.input(lower), self.target.input(upper))
        return self.sides[name]

    def _image(self, number: int, node: Node) -> Interval:
        b, operands = self.target, [self.images[argument] for argument in node.arguments]
        if node.operation == "input":
            return self.side(str(node.data))
        if node.operation == "mul":
            factor = self.source.value(node.arguments[0])
            if factor is not None:
                return scaled(b, factor, operands[1])
        if node.operation == "select":
            return self._select(node, operands)
        name, arguments = relation(self.source.nodes, number) or (node.operation, node.arguments)
        operands = [self.images[argument] for argument in arguments]
        if self.strict and (name in {"sqrt", "log"} or (name == "pow" and self._is_root(arguments[1]))):
            operands[0] = only_nonnegative(b, operands[0])
        return IMAGES[name](b, node, operands)

    def _is_root(self, exponent: int) -> bool:
        """Whether a power with this exponent has no value for a negative base."""
        value = self.source.value(exponent)
        return value is not None and value.denominator > 1

    def _select(self, node: Node, operands: list[Interval]) -> Interval:
        """A branch that is never defined leaves the other."""
        never = [self.source.nodes[argument].operation == "undefined" for argument in node.arguments]
        if never[2] or never[3]:
            return operands[3] if never[2] else operands[2]
        return chosen(self.target, operands, is_decisive(self._definedness_of_all(), node))

    def _definedness_of_all(self) -> Definedness:
        if self._examined < len(self.source.nodes):
            self._examined = len(self.source.nodes)
            self._definedness = Definedness(tuple(self.source.nodes), self.source.nonnegative)
        return self._definedness


def ends_of(names: Sequence[str]) -> tuple[str, ...]:
    """The names of the ends of inputs or outputs.

    Examples
    --------
    >>> ends_of(["x"])
    ('x_lower', 'x_upper')
    """
    return tuple(f"{name}_{end}" for name in names for end in ("lower", "upper"))
