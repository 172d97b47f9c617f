"""Several functions of one shape, compiled together: values and gradients at points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.kernel import Kernel, compile_program, run_in_blocks
from rsym.model.shape import Shape
from rsym.program.builder import Builder
from rsym.program.differentiation import gradient
from rsym.program.lowering import lower_all

Ints = NDArray[np.intp]

LARGEST = 4_000_000  # numbers computed at once: 32 MB


@dataclass(frozen=True)
class Functions:
    """Functions by number.

    Examples
    --------
    >>> import numpy as np, rsym
    >>> from rsym import x, y
    >>> both = functions_of(rsym.Shape(x, (x, y)), [x * y, 3 * x])
    >>> values, gradients = both(np.array([[2.0, 5.0]]))
    >>> values[:, 0].tolist(), gradients[:, 0].tolist()
    ([10.0, 6.0], [[5.0, 2.0], [3.0, 0.0]])
    """

    kernel: Kernel
    letters: tuple[float, ...]
    count: int

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return len(self.kernel.program.coordinates)

    @property
    def portion(self) -> int:
        """How many points fit into memory at once."""
        return max(1, LARGEST // (self.count * (1 + self.dimension)))

    def __call__(self, points: Floats) -> tuple[Floats, Floats]:
        """Values (count, n) and gradients (count, n, dim) at points (n, dim)."""
        out = np.empty((self.count * (1 + self.dimension), len(points)))
        if len(points):
            columns = [np.ascontiguousarray(column) for column in points.T]
            run_in_blocks(self.kernel.function, columns, self.letters, out, self.kernel.threads)
        parts = out.reshape(self.count, 1 + self.dimension, len(points))
        return parts[:, 0], parts[:, 1:].transpose(0, 2, 1)

    def values(self, points: Floats) -> Floats:
        """Values (count, n)."""
        parts = [self(points[start : start + self.portion])[0] for start in range(0, len(points), self.portion)]
        return np.hstack([np.empty((self.count, 0)), *parts])

    def of(self, which: Ints, points: Floats) -> tuple[Floats, Floats]:
        """The value (n,) and the gradient (n, dim) of one function at each point."""
        value, slope = np.empty(len(points)), np.empty(points.shape)
        for start in range(0, len(points), self.portion):
            here = slice(start, start + self.portion)
            values, gradients = self(points[here])
            columns = np.arange(values.shape[1])
            value[here], slope[here] = values[which[here], columns], gradients[which[here], columns]
        return value, slope


def functions_of(shape: Shape, expressions: Sequence[sp.Expr]) -> Functions:
    """Compile expressions in the coordinates and letters of a shape, letters at their defaults."""
    builder = Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(shape.letters))
    outputs = {}
    for number, node in enumerate(lower_all(builder, expressions)):
        outputs[f"value_{number}"] = node
        outputs |= {f"slope_{number}_{i}": part for i, part in enumerate(gradient(builder, node))}
    kernel = compile_program(builder.program(outputs), (), shape)
    values = shape.letters.values_with(None)
    return Functions(kernel, tuple(values[name] for name in kernel.program.letters), len(expressions))
