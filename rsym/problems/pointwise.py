"""Formulas at points: expressions and nodes of programs, compiled once, their letters free."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy as sp

from rsym.arrays import Flags, Floats
from rsym.backends.kernel import Kernel, compile_program, run_in_blocks
from rsym.errors import RsymError
from rsym.logic.sign_form import shape_builder
from rsym.model.shape import Shape
from rsym.problems.splines.cardinals import derivatives
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower_all


@dataclass(frozen=True)
class PointFormulas:
    """Functions of points (n, dimension) that give (outputs, n).

    letters : the value of each letter of the kernel, in its order.
    functions : Python functions of the coordinates, whose values come behind these.
    """

    kernel: Kernel
    letters: tuple[float, ...]
    functions: tuple[tuple[str, Callable[..., Any]], ...] = field(default=())

    def __call__(self, points: Floats) -> Floats:
        """The outputs (outputs, n) at points (n, dimension)."""
        columns = list(np.ascontiguousarray(points.T))
        given = columns + [values_of(name, function, columns) for name, function in self.functions]
        out = np.empty((len(self.kernel.program.outputs), len(points)))
        run_in_blocks(self.kernel.function, given, self.letters, out, self.kernel.threads)
        return out


def values_of(name: str, function: Callable[..., Any], columns: list[Floats]) -> Floats:
    """What a Python function says at points, checked."""
    found = np.asarray(function(*columns), np.float64)
    if found.shape not in ((), columns[0].shape):
        raise RsymError(
            f"the function {name} gave an array of the shape {found.shape} for coordinates of {columns[0].shape}",
            code="function",
            remedy="a coefficient takes arrays of coordinates and gives an array of values",
        )
    return np.broadcast_to(found, columns[0].shape)


def formulas(
    shape: Shape, expressions: Mapping[str, sp.Expr], functions: Mapping[str, Callable[..., Any]] | None = None
) -> PointFormulas:
    """Expressions in the coordinates and letters of a shape, and in the names of Python functions.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> found = formulas(rsym.disc(1), {"a": x + y, "b": 2 * x})
    >>> found(np.array([[1.0, 3.0]])).tolist()
    [[4.0], [2.0]]
    """
    functions = functions or {}
    builder = shape_builder(shape, *functions)
    nodes = lower_all(builder, list(expressions.values()))
    return compiled(shape, builder, dict(zip(expressions, nodes, strict=True)), functions)


def compiled(
    shape: Shape,
    builder: Builder,
    nodes: Mapping[str, int],
    functions: Mapping[str, Callable[..., Any]] | None = None,
) -> PointFormulas:
    """Nodes of a builder."""
    return at_letters(shape, compile_program(builder.program(nodes), (), shape), functions)


def at_letters(
    shape: Shape, kernel: Kernel, functions: Mapping[str, Callable[..., Any]] | None = None
) -> PointFormulas:
    """What was compiled, with the values that the letters of a shape have."""
    values = shape.letters.values_with(None)
    letters = tuple(values[name] for name in kernel.program.letters)
    return PointFormulas(kernel, letters, tuple((functions or {}).items()))


def with_derivatives(builder: Builder, nodes: Mapping[str, int], names: tuple[str, ...], order: int) -> dict[str, int]:
    """The derivatives of nodes by some coordinates up to an order, in the order of `derivatives`, node after node."""
    found = {}
    for title, node in nodes.items():
        for index in derivatives(len(names), order):
            made = node
            for name, times in zip(names, index, strict=True):
                for _ in range(times):
                    made = derivative(builder, made, name)
            found[f"{title} {index}"] = made
    return found


def first_place(points: Floats, wrong: Flags) -> str:
    """The first of points (n, dim) where something is wrong, as errors tell it.

    Examples
    --------
    >>> first_place(np.array([[0.0, 1.0], [2.0, 1 / 3]]), np.array([False, True]))
    '(2, 0.3333)'
    """
    return "(" + ", ".join(f"{value:.4g}" for value in points[int(np.argmax(wrong))]) + ")"


def require_numbers(what: str, values: Floats, points: Floats) -> None:
    """Refuse data that are undefined, or infinite, at one of the points (n, dim)."""
    wrong = ~np.isfinite(np.broadcast_to(values, len(points)))
    if wrong.any():
        raise RsymError(
            f"{what} is undefined at {first_place(points, wrong)}",
            code="undefined",
            remedy="data are numbers all over the shape: Piecewise, Max or Abs where a root or logarithm ends",
        )


def defined(what: str, function: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
    """A function of points that gives (outputs, n), refused where one of these is undefined."""

    def found(points: Floats) -> Floats:
        values = function(points)
        require_numbers(what, values.sum(axis=0), points)
        return values

    return found
