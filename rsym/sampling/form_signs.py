"""Proved signs of a sign form over boxes, which come in arrays, and over cones of directions that go to infinity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.interpreter import interpret
from rsym.bounds.far_forms import far_leaves
from rsym.bounds.intervals import IntervalFunction
from rsym.errors import RsymError
from rsym.logic.gates import Gate, through
from rsym.logic.sign_form import SignForm
from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import Program, live


@dataclass(frozen=True)
class Boxes:
    """n boxes: their lower and their upper ends, (dim, n) each."""

    lower: Floats
    upper: Floats

    def __len__(self) -> int:
        return int(self.lower.shape[1])

    def __getitem__(self, which: NDArray[Any]) -> Boxes:
        return Boxes(self.lower[:, which], self.upper[:, which])

    @property
    def sides(self) -> Floats:
        """The lengths of the sides, (dim, n)."""
        return self.upper - self.lower

    @property
    def centres(self) -> Floats:
        """The middle points, (dim, n)."""
        return self.lower / 2 + self.upper / 2

    def hull(self) -> Boxes:
        """The one box around them all."""
        return Boxes(self.lower.min(axis=1, keepdims=True), self.upper.max(axis=1, keepdims=True))

    def followed_by(self, other: Boxes) -> Boxes:
        """These boxes, then the others."""
        return Boxes(np.hstack([self.lower, other.lower]), np.hstack([self.upper, other.upper]))


def points(places: Floats) -> Boxes:
    """Boxes of one point each, (dim, n)."""
    return Boxes(places, places)


def cube(dimension: int, size: float) -> Boxes:
    """The cube max|x_i| <= size."""
    return Boxes(np.full((dimension, 1), -size), np.full((dimension, 1), size))


def slabs(box: Boxes, thickness: Floats) -> Boxes:
    """At the lower and the upper side of each axis of a box a slab of the thickness (dim, 2).

    Examples
    --------
    >>> sides = slabs(cube(2, 1.0), np.array([[0.0, 0.0], [0.5, 1.0]]))
    >>> sides.lower.tolist(), sides.upper.tolist()
    ([[-1.0, 1.0, -1.0, -1.0], [-1.0, -1.0, -1.0, 0.0]], [[-1.0, 1.0, 1.0, 1.0], [1.0, 1.0, -0.5, 1.0]])
    """
    dimension = len(box.lower)
    lower, upper = (np.repeat(end, 2 * dimension, axis=1) for end in (box.lower, box.upper))
    axes = np.arange(dimension)
    upper[axes, 2 * axes] = box.lower[:, 0] + thickness[:, 0]
    lower[axes, 2 * axes + 1] = box.upper[:, 0] - thickness[:, 1]
    return Boxes(lower, upper)


def grid(box: Boxes, count: int) -> Boxes:
    """A box in `count` equal parts along each axis; neighbours share their ends."""
    dimension = len(box.lower)
    ends = box.lower + box.sides * (np.arange(count + 1) / count)
    ends[:, -1] = box.upper[:, 0]
    index = np.indices((count,) * dimension).reshape(dimension, -1)
    return Boxes(np.take_along_axis(ends, index, axis=1), np.take_along_axis(ends, index + 1, axis=1))


def halves(boxes: Boxes) -> tuple[Boxes, NDArray[np.intp]]:
    """The boxes cut in two across every side longer than half the longest, and which box each part comes from.

    Examples
    --------
    >>> parts, origin = halves(Boxes(np.zeros((2, 1)), np.array([[4.0], [1.0]])))
    >>> parts.lower.tolist(), parts.upper.tolist(), origin.tolist()
    ([[0.0, 2.0], [0.0, 0.0]], [[2.0, 4.0], [1.0, 1.0]], [0, 0])
    """
    lower, upper, origin = boxes.lower, boxes.upper, np.arange(len(boxes))
    long = boxes.sides > boxes.sides.max(axis=0) / 2
    for axis in range(len(lower)):
        cut = np.flatnonzero(long[axis, origin])
        lower, upper = np.hstack([lower, lower[:, cut]]), np.hstack([upper, upper[:, cut]])
        upper[axis, cut] = lower[axis, len(origin) :] = lower[axis, cut] / 2 + upper[axis, cut] / 2
        origin = np.concatenate([origin, origin[cut]])
    return Boxes(lower, upper), origin


Signs: TypeAlias = NDArray[np.int8]


class LeafBounds(Protocol):
    """The signs (leaves, n) that the leaves of a form are proved to have over boxes, 0 where that is not known."""

    form: SignForm

    def near(self, parts: Sequence[Boxes], letters: Mapping[str, Any]) -> Signs:
        """Over boxes, the only part, by images and mean values."""

    def far(self, parts: Sequence[Boxes], letters: Mapping[str, Any]) -> Signs:
        """Over boxes, directions and nearness."""


class FormBounds:
    """The compiled bounds of the leaves of a form, over boxes and far away; letters are given later."""

    def __init__(self, form: SignForm) -> None:
        self.form = form

    def near(self, parts: Sequence[Boxes], letters: Mapping[str, Any]) -> Signs:
        """Over boxes, the only part, by images and mean values."""
        return _signs(self._near, parts, letters)

    def far(self, parts: Sequence[Boxes], letters: Mapping[str, Any]) -> Signs:
        """Over boxes, directions and nearness."""
        return _signs(self._far, parts, letters)

    @cached_property
    def _near(self) -> IntervalFunction:
        program = _program(self.form.builder, self.form.leaves)
        return IntervalFunction(program, threads=1, sharpened=tuple(sorted({number for _, number in program.outputs})))

    @cached_property
    def _far(self) -> IntervalFunction:
        """In NumPy, for it is larger and called for few boxes."""
        return IntervalFunction(_program(*far_leaves(self.form)), "numpy", threads=1)


def _signs(function: IntervalFunction, parts: Sequence[Boxes], letters: Mapping[str, Any]) -> Signs:
    lower, upper = [row for part in parts for row in part.lower], [row for part in parts for row in part.upper]
    # The bounds are letters of the builder too, though no leaf uses them.
    values = dict.fromkeys(function.program.letters, 0.0) | dict(letters)
    return np.array([signs_between(low, high) for low, high in function(lower, upper, values).values()], np.int8)


def signs_between(low: Floats, high: Floats) -> Signs:
    """1 or -1 where all between bounds have that sign, else 0."""
    signs: Signs = (low > 0).astype(np.int8) - (high < 0)
    return signs


@dataclass(frozen=True)
class FormSigns:
    """Signs of a form at letters: 1 or -1 where it has that sign all over a box, 0 where that is not known.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import surface_form
    >>> signs = FormSigns(FormBounds(surface_form(rsym.Shape(1 - x**2 - y**2, (x, y)))), {})
    >>> signs.over(Boxes(np.array([[-0.5, 0, 2.0], [0, 0, 0]]), np.array([[0.5, 1, 3.0], [0.5, 1, 1]]))).tolist()
    [1, 0, -1]
    >>> signs.beyond(Boxes(np.array([[1.0], [-1.0]]), np.array([[1.0], [1.0]])), 2.0).tolist()
    [-1]
    """

    bounds: LeafBounds
    letters: Mapping[str, Any]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Their names."""
        return self.bounds.form.builder.coordinates

    def over(self, boxes: Boxes) -> Signs:
        """The signs over boxes."""
        return self._joined(self.bounds.near([boxes], self.letters))

    def beyond(self, directions: Boxes, size: float) -> Signs:
        """The signs at all s*u with u in the directions, on faces of the cube max|u_i| = 1, and s >= size.

        A leaf that the box of all those points leaves open is looked at in its far form.
        """
        lower, upper = directions.lower, directions.upper
        near = Boxes(np.where(lower >= 0, lower * size, -np.inf), np.where(upper <= 0, upper * size, np.inf))
        leaves = self.bounds.near([near], self.letters)
        open_boxes = np.flatnonzero(self._joined(leaves) == 0)
        if len(open_boxes):
            nearness = Boxes(np.zeros((1, len(open_boxes))), np.full((1, len(open_boxes)), 1 / size))
            far = self.bounds.far([near[open_boxes], directions[open_boxes], nearness], self.letters)
            leaves[:, open_boxes] = np.where(leaves[:, open_boxes] == 0, far, leaves[:, open_boxes])
        return self._joined(leaves)

    def _joined(self, leaves: Signs) -> Signs:
        """Of -1, 0 and 1: a min is negative where one operand is, and positive where both are."""
        signs: list[Signs] = list(leaves)
        return through(self.bounds.form.gates, signs, joined_signs)[-1]


def joined_signs(gate: Gate, first: Signs, second: Signs) -> Signs:
    """The signs of a gate from those of its operands."""
    joined: Signs = (np.minimum if gate.operation == "min" else np.maximum)(first, second)
    return joined


def check_parameters(form: SignForm, letters: Mapping[str, float]) -> None:
    """Refuse letters with which an R-operation has no value: its sign would say nothing.

    Those of a node must be legal; one that is written out, as a fillet is, chooses a formula without a value.
    """
    builder = form.builder
    for operation, node in form.parameters:
        value, legal = _values(builder, [node], letters)[node], OPERATIONS[operation].parameter
        if legal is not None and not legal.holds(value):
            raise RsymError(
                f"a parameter of {operation} is {value}, out of its range{_letters_of(builder, node, letters)}",
                code="parameter",
                remedy="-1 < alpha <= 1, m >= 1, p > 1",
            )
    parts = live(builder.nodes, form.leaves)
    choices = [part for part in parts if _is_chosen_by_letters(builder, part)]
    if not choices:
        return
    values = _values(builder, [part for part in parts if builder.uniform[part]], letters)
    without = {part for part, value in values.items() if np.isnan(value)}
    zeros, infinite = ({part for part, value in values.items() if abs(value) == size} for size in (0, np.inf))
    for part in parts:
        operation, arguments, _ = builder.nodes[part]
        needed: Sequence[int] = arguments if OPERATIONS[operation].strict else ()
        if operation == "mul" and not zeros.isdisjoint(arguments):
            (zeros if infinite.isdisjoint(arguments) else without).add(part)
        if operation == "undefined":
            without.add(part)
        if part in choices:
            needed = [arguments[2 if values[arguments[0]] > values[arguments[1]] else 3]]
            if needed[0] in without:
                raise RsymError(
                    f"an operation has no value anywhere{_letters_of(builder, arguments[0], letters)}",
                    code="parameter",
                    remedy="of a fillet the radius is positive and the cosine between -1 and 1; other letters",
                )
        if not without.isdisjoint(needed):
            without.add(part)


def _values(builder: Builder, numbers: Sequence[int], letters: Mapping[str, Any]) -> dict[int, float]:
    """The values of nodes that depend on letters alone."""
    found = interpret(builder.program({f"{number}": number for number in numbers}), letters)
    return {number: float(found[f"{number}"]) for number in numbers}


def _is_chosen_by_letters(builder: Builder, part: int) -> bool:
    """Whether a node is one of two as letters have it."""
    operation, arguments, _ = builder.nodes[part]
    return operation == "select" and builder.uniform[arguments[0]] and builder.uniform[arguments[1]]


def _letters_of(builder: Builder, node: int, letters: Mapping[str, Any]) -> str:
    """The letters that a node depends on, with their values."""
    names = {str(builder.nodes[part].data) for part in live(builder.nodes, [node])}
    told = [f"{name} = {letters[name]:g}" for name in builder.letters if name in names]
    return f", with {', '.join(told)}" if told else ""


def _program(builder: Builder, numbers: Sequence[int]) -> Program:
    return builder.program({str(k): number for k, number in enumerate(numbers)})
