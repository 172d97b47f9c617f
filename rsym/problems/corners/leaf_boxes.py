"""Bounds of the leaves of a plane shape and of their gradients over boxes, and which leaves matter there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats
from rsym.bounds.intervals import IntervalFunction
from rsym.logic.gates import through
from rsym.logic.sign_form import SignForm, has_kinks, shape_form
from rsym.logic.stripping import bare
from rsym.model.recent import recently, written
from rsym.model.shape import Shape
from rsym.program.differentiation import derivative
from rsym.sampling.form_signs import Boxes, Signs, check_parameters, joined_signs, points, signs_between

KINK = 0.02  # radians: kinks inside of a leaf that turn less are not seen


@dataclass(frozen=True, eq=False)
class LeafBoxes:
    """The leaves of a shape with letters, over boxes.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.sampling.form_signs import Boxes
    >>> leaves = leaf_boxes(rsym.Shape(rsym.conjunction(x, y), (x, y)))
    >>> boxes = Boxes(np.array([[1.0, 1.0, -1.0], [-1.0, 1.0, -1.0]]), np.array([[2.0, 2.0, 1.0], [1.0, 2.0, 1.0]]))
    >>> leaves.matter(leaves.over(boxes)).tolist()
    [[False, False, True], [True, False, True]]
    """

    form: SignForm
    function: IntervalFunction
    letters: Mapping[str, float]
    lines: tuple[int, ...]  # leaves with the same number have the same zeros
    kinked: tuple[bool, ...]  # which may have kinks

    @property
    def count(self) -> int:
        """How many leaves there are."""
        return len(self.form.leaves)

    def over(self, boxes: Boxes) -> Floats:
        """Bounds of value and gradient, (leaves, 3, 2, boxes)."""
        found = self.function(list(boxes.lower), list(boxes.upper), self.letters)
        return np.array(list(found.values())).reshape(self.count, 3, 2, len(boxes))

    def at(self, places: Floats) -> Floats:
        """Value and gradient at points (2, n), (leaves, 3, n)."""
        bounds = self.over(points(places))
        with np.errstate(invalid="ignore"):  # of a leaf that is undefined everywhere
            return bounds[:, :, 0] / 2 + bounds[:, :, 1] / 2

    def matter(self, bounds: Floats) -> Flags:
        """Whether the sign of the form over a box hangs on that of a leaf, (leaves, boxes); a tie counts."""
        signs: list[Signs] = [signs_between(*row[0]) for row in bounds]
        every = through(self.form.gates, signs, joined_signs)
        wanted = [np.zeros(bounds.shape[-1], np.bool_) for _ in every]
        wanted[-1] = every[-1] == 0
        for number, (_, *operands) in reversed(list(enumerate(self.form.gates, self.count))):
            for operand in operands:
                wanted[operand] = wanted[operand] | (wanted[number] & (every[operand] == 0))
        return np.array(wanted[: self.count])

    def steady(self, bounds: Floats) -> Flags:
        """Whether the gradient is nowhere zero, (leaves, boxes), and, where leaves may have kinks, hardly turns."""
        low, high = bounds[:, 1:, 0], bounds[:, 1:, 1]
        with np.errstate(all="ignore"):
            away = ((low > 0) | (high < 0)).any(axis=1)
            spread = np.hypot(*(high - low).transpose(1, 0, 2)) / np.hypot(*(low / 2 + high / 2).transpose(1, 0, 2))
            steady: Flags = away & (spread <= np.where(self.kinked, KINK, np.finfo(float).max)[:, None])
        return steady


def leaf_boxes(shape: Shape, letters: Mapping[Any, float] | None = None) -> LeafBoxes:
    """The leaves of ``shape_form(shape)``, in its order."""
    form, function, lines, kinked = _compiled(shape)
    values = shape.letters.values_with(letters)
    check_parameters(form, values)
    return LeafBoxes(form, function, values, lines, kinked)


@recently(16, written)
def _compiled(shape: Shape) -> tuple[SignForm, IntervalFunction, tuple[int, ...], tuple[bool, ...]]:
    form = shape_form(shape)
    b = form.builder
    outputs = {}
    for number, leaf in enumerate(form.leaves):
        parts = leaf, *(derivative(b, leaf, name) for name in b.coordinates)
        outputs.update({f"{number} {k}": part for k, part in enumerate(parts)})
    keys = [bare(b, leaf) for leaf in form.leaves]
    function = IntervalFunction(b.program(outputs), threads=1)
    kinked = tuple(has_kinks(b, leaf) for leaf in form.leaves)
    return form, function, tuple(keys.index(key) for key in keys), kinked
