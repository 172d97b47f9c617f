"""The models of a form in arrays: the reference that compiled ones are compared with, call by call."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.registry import CompiledFunction, make_function
from rsym.bounds.ray_forms import MODEL, RayForm, RayValue, input_names
from rsym.logic.gates import through

Parts = Sequence[NDArray[Any]]  # low, high, linear, quadratic
ROUNDED = 2.0**-51  # of the terms of a point on a ray, in float64


@dataclass(frozen=True)
class RayReference:
    """Evaluates a form on many segments.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.bounds.ray_forms import ray_form
    >>> from rsym.logic.sign_form import shape_form
    >>> reference = RayReference(ray_form(shape_form(rsym.Shape(1 - x**2 - y**2, (x, y, z)))))
    >>> zero, one, two = np.zeros(1), np.ones(1), np.full(1, 2.0)
    >>> low, high, linear, quadratic = reference({}, [(two, two, one, zero), (zero,) * 4, (zero,) * 4])
    >>> low.round(9).tolist(), high.round(9).tolist(), linear.tolist(), quadratic.tolist()  # 1 - (2 + s)**2
    ([-3.0], [-3.0], [-4.0], [-1.0])
    """

    form: RayForm

    @cached_property
    def functions(self) -> Mapping[str, CompiledFunction]:
        """The library."""
        precision = self.form.precision
        return {name: make_function(one.program, "numpy", precision) for name, one in self.form.library.items()}

    def __call__(self, letters: Mapping[str, float], coordinates: Sequence[Parts]) -> Parts:
        """The model of the form, from those of the coordinates along segments."""
        leaves = self.leaves(letters, coordinates)
        return through(self.form.gates, leaves, lambda gate, one, other: self._run(gate.operation, [*one, *other]))[-1]

    def leaves(self, letters: Mapping[str, float], coordinates: Sequence[Parts]) -> list[Parts]:
        """The models of the leaves."""
        uniform = self.form.uniform_values(letters)
        count, dtype = len(coordinates[0][0]), self.form.precision.dtype
        models: list[Parts] = [[np.asarray(part, dtype) for part in parts] for parts in coordinates]

        def number(k: int) -> NDArray[Any]:
            return np.full(count, uniform[k], dtype)

        def model(value: RayValue) -> Parts:
            if value.kind == MODEL:
                return models[value.number]
            zero = np.zeros(count, dtype)
            return number(value.number), number(value.number), zero, zero

        for call in self.form.calls:
            given: list[NDArray[Any]] = []
            for value, kind in zip(call.arguments, self.form.library[call.function].parameters, strict=True):
                parts = models[value.number] if value.kind == MODEL else [number(value.number)]
                given += parts[: len(input_names(0, kind))]
            models.append(self._run(call.function, given))
        return [model(leaf) for leaf in self.form.leaves]

    def _run(self, name: str, given: Parts) -> Parts:
        outputs = [np.empty(len(given[0]), self.form.precision.dtype) for _ in range(4)]
        self.functions[name].run(given, [], outputs)
        return outputs


def along(
    origins: Floats, directions: Floats, start: Floats, length: Floats, radius: Floats | float = 0.0
) -> list[Parts]:
    """The models of the coordinates on segments of rays (n, 3), in a beam of that radius."""
    middle, half = start + length / 2, length / 2
    found: list[Parts] = []
    for o, d in zip(origins.T, directions.T, strict=True):
        centre = o + d * middle
        wide = radius + ROUNDED * (np.abs(o) + np.abs(d) * (np.abs(start) + length))
        found.append((centre - wide, centre + wide, d * half, np.zeros_like(centre)))
    return found
