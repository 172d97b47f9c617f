"""What is known about a program on one box: enclosures of its nodes, computed when they are asked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence, Set
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias, TypeVar

from rsym.bounds.balls import Step, arb, ball, ctx, exact, run, step
from rsym.logic.sign_form import decided
from rsym.model.nodes import without_zeros
from rsym.model.shape import Shape
from rsym.program.builder import Builder
from rsym.program.calculus import Calculus
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower
from rsym.program.program import live
from rsym.verify.boxes.vectors import sign_of

T = TypeVar("T")
Interval: TypeAlias = tuple[Fraction, Fraction]
Box: TypeAlias = tuple[tuple[float, float], ...]

PRECISION = 80  # bits of the balls: 53 would do, a few more keep corners from being decided by rounding
# What meets on a side of a box meets inside the box grown by this share of its width; in the plane joints are located
# in it at once, and where letters range they move.
GROWN = 0.25
GROWN_FOR_RANGES = 1.5
PRECISE = 256  # bits at which a place is located: 60 digits remain after the third derivative


def side(low: float, high: float) -> arb:
    """The ball around an interval of floats."""
    return ball(arb(low), arb(high))


class _Plan(NamedTuple):
    """How some nodes are enclosed: inputs by name, numbers, and the steps in their order."""

    inputs: list[tuple[int, str]]
    numbers: list[Step]
    steps: list[Step]
    known: dict[int, dict[int, arb | None]]

    def constants(self) -> dict[int, arb | None]:
        """The balls of the numbers, at the working precision."""
        if ctx.prec not in self.known:
            balls: dict[int, arb | None] = {}
            run(self.numbers, balls)
            self.known[ctx.prec] = balls
        return self.known[ctx.prec]


class _Formula:
    """What a model knows whatever its letters are: its program, as far as it has grown, and what was made of it."""

    def __init__(self, shape: Shape, coordinates: tuple[str, ...], letters: tuple[str, ...], signs: bool) -> None:
        self.builder = Builder(coordinates, letters)
        root = lower(self.builder, without_zeros(shape.expression))
        self.root = decided(self.builder, root) if signs else root
        self.orders: dict[int, list[int]] = {}
        self.steps: dict[int, Step] = {}
        self.gradients: dict[int, tuple[int, ...]] = {}
        self.curvatures: dict[int, int] = {}
        self.parts: dict[tuple[int, Set[str]], list[int]] = {}
        self.made_of: dict[tuple[int, Set[str]], bool] = {}
        self.plans: dict[tuple[int, ...], _Plan] = {}
        self.made: dict[tuple[Any, ...], Any] = {}


class Model:
    """A shape as a growing program of its coordinates, with the letters that are fixed and those that range.

    `axes` are what a box has sides along: the coordinates, then the letters that range. Of a `body` of revolution
    the coordinates are those of the meridian, the second one the distance from the axis, with either sign. What is
    outside the `bounds`, if there are any, is nobody's concern. A model `like` another, of the same shape with other
    letters, takes over its program and all that does not depend on them. It has the `signs` of the shape alone, and
    where these say more another value, unless the value is asked for.
    """

    def __init__(
        self,
        shape: Shape,
        letters: Mapping[str, Interval],
        *,
        body: bool = False,
        bounds: Box | None = None,
        like: Model | None = None,
        signs: bool = True,
    ) -> None:
        self.body, self.bounds = body, bounds
        names = tuple(symbol.name for symbol in shape.coordinates)
        self._formula: _Formula = _Formula(shape, names, tuple(letters), signs) if like is None else like._formula
        self.builder, self.root = self._formula.builder, self._formula.root
        self.letters = dict(letters)
        self.axes = (*names, *(name for name, (low, high) in letters.items() if low != high))
        self._orders, self._steps = self._formula.orders, self._formula.steps
        self.resolutions: dict[tuple[object, ...], int] = {}  # by what they depend on, on whatever box
        self.orders_of_contact: dict[tuple[object, ...], float] = {}
        self._remembered: dict[tuple[Any, ...], Any] = {}
        self._gradients, self._curvatures = self._formula.gradients, self._formula.curvatures
        self._fixed: dict[int, dict[str, arb]] = {}
        self._parts, self._made_of, self._plans = self._formula.parts, self._formula.made_of, self._formula.plans

    def remembered(self, maker: Callable[..., T], *arguments: Any) -> T:
        """What `maker(model, *arguments)` gives, made when it is first asked for: the ring of the model, say."""
        key = (maker, *arguments)
        if key not in self._remembered:
            self._remembered[key] = maker(self, *arguments)
        found: T = self._remembered[key]
        return found

    def made(self, maker: Callable[..., T], number: int) -> T:
        """What `maker(builder, number)` gives, made when it is first asked for, whatever the letters are."""
        key = (maker, number)
        if key not in self._formula.made:
            self._formula.made[key] = maker(self.builder, number)
        found: T = self._formula.made[key]
        return found

    def order(self, number: int) -> list[int]:
        """The nodes that a node needs, in evaluation order."""
        if number not in self._orders:
            self._orders[number] = live(self.builder.nodes, [number])
        return self._orders[number]

    def enclose(self, number: int, inputs: Mapping[str, arb], known: dict[int, arb | None]) -> None:
        """Add the balls of a node, and of all that it needs, to those known on the box."""
        self.enclose_all((number,), inputs, known)

    def enclose_all(self, numbers: tuple[int, ...], inputs: Mapping[str, arb], known: dict[int, arb | None]) -> None:
        """Add the balls of some nodes, and of all that they need, to those known on the box."""
        plan = self._plan(numbers)
        given = dict(known)  # slopes, say, in the place of coordinates and numbers
        known.update(plan.constants())
        for number, name in plan.inputs:
            known[number] = inputs[name]
        known.update(given)
        run([one for one in plan.steps if one[0] not in given] if given else plan.steps, known)

    def _plan(self, numbers: tuple[int, ...]) -> _Plan:
        if numbers not in self._plans:
            nodes, order = self.builder.nodes, live(self.builder.nodes, numbers)
            for part in order:
                if part not in self._steps and nodes[part].operation != "input":
                    self._steps[part] = step(nodes, part)
            named = [(part, str(nodes[part].data)) for part in order if nodes[part].operation == "input"]
            fixed = [self._steps[part] for part in order if nodes[part].operation == "const"]
            steps = [self._steps[part] for part in order if nodes[part].operation not in {"input", "const"}]
            self._plans[numbers] = _Plan(named, fixed, steps, {})
        return self._plans[numbers]

    def parts(self, number: int, operations: Set[str]) -> list[int]:
        """The nodes of some operations that a node needs, in evaluation order."""
        if (number, operations) not in self._parts:
            nodes = self.builder.nodes
            found = [part for part in self.order(number) if nodes[part].operation in operations]
            self._parts[number, operations] = found
        return self._parts[number, operations]

    def uses_only(self, number: int, operations: Set[str]) -> bool:
        """Whether a node and all that it needs are of some operations."""
        if (number, operations) not in self._made_of:
            nodes = self.builder.nodes
            self._made_of[number, operations] = all(nodes[part].operation in operations for part in self.order(number))
        return self._made_of[number, operations]

    @property
    def dimension(self) -> int:
        """How many coordinates there are."""
        return len(self.builder.coordinates)

    def gradient(self, number: int) -> tuple[int, ...]:
        """The nodes of the first derivatives."""
        if number not in self._gradients:
            coordinates = self.builder.coordinates
            self._gradients[number] = tuple(derivative(self.builder, number, name) for name in coordinates)
        return self._gradients[number]

    def inputs(self, sides: Sequence[arb]) -> dict[str, arb]:
        """The balls of all inputs, given those along the axes."""
        if ctx.prec not in self._fixed:
            self._fixed[ctx.prec] = {name: ball(exact(low), exact(high)) for name, (low, high) in self.letters.items()}
        return self._fixed[ctx.prec] | dict(zip(self.axes, sides, strict=False))

    def curvature(self, number: int) -> int:
        """The node of the curvature of the level lines of a node."""
        if number not in self._curvatures:
            self._curvatures[number] = Calculus(self.builder, number).curvature
        return self._curvatures[number]

    def on(self, sides: Sequence[arb]) -> Local:
        """What is known on a box with these sides; letters without a side have their whole range."""
        return Local(self, sides)

    def over(self, box: Box) -> Local:
        """What is known on a box of floats."""
        return self.on([side(*ends) for ends in box])


class Local:
    """Enclosures on one box."""

    def __init__(self, model: Model, sides: Sequence[arb]) -> None:
        self.model = model
        self.sides = list(sides)
        self.inputs = model.inputs(sides)
        self.values: dict[int, arb | None] = {}
        self.decided: dict[int, tuple[int, ...]] = {}
        self.defined: dict[tuple[int, bool], bool] = {}
        self._made: dict[tuple[Callable[..., Any], int], Any] = {}

    def value(self, number: int) -> arb | None:
        """A ball around all values of a node; None if it is nowhere defined."""
        if number not in self.values:
            self.model.enclose(number, self.inputs, self.values)
        return self.values[number]

    def all(self, numbers: tuple[int, ...]) -> list[arb | None]:
        """The balls of some nodes, enclosed at once."""
        if any(number not in self.values for number in numbers):
            self.model.enclose_all(numbers, self.inputs, self.values)
        return [self.values[number] for number in numbers]

    def made(self, maker: Callable[[Local, int], T], number: int) -> T:
        """What `maker(local, number)` gives, made when it is first asked for."""
        key = (maker, number)
        if key not in self._made:
            self._made[key] = maker(self, number)
        found: T = self._made[key]
        return found

    def sign(self, number: int) -> int:
        """1 or -1 where the node certainly has that sign wherever it is defined, else 0."""
        return sign_of(self.value(number))

    def balls(self, numbers: tuple[int, ...]) -> list[arb]:
        """Balls around the values of some nodes, the whole line where there is none."""
        return [arb(0, math.inf) if value is None else value for value in self.all(numbers)]

    def ball(self, number: int) -> arb:
        """A ball around all values of a node, the whole line where there is none."""
        return self.balls((number,))[0]

    def gradient(self, number: int) -> list[arb]:
        """Balls around the first derivatives of a node, the whole line where there is no bound."""
        return self.balls(self.model.gradient(number))

    @cached_property
    def surroundings(self) -> Local:
        """The box that `grown` gives, one and the same to all who ask."""
        return self.grown()

    def grown(self) -> Local:
        """What is known on a box a little larger along the coordinates."""
        size = self.model.dimension
        share = GROWN_FOR_RANGES if size == 2 and len(self.sides) > size else GROWN
        sides = [side + arb(0, 2 * share) * arb(side.rad()) for side in self.sides[:size]]
        return self.model.on([*sides, *self.sides[size:]])

    def nonzero(self, number: int) -> bool:
        """Whether the node is certainly not zero."""
        return self.sign(number) != 0
