"""Fields: the functions that are derived from omega, as nodes of one program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.codegen import differentiation
from rsym.codegen.builder import Builder
from rsym.codegen.differentiation import derivative, dot
from rsym.codegen.lowering import lower
from rsym.codegen.program import Program
from rsym.errors import RsymError
from rsym.model.shape import Shape

SIX: tuple[str, ...] = (
    "value",
    "normalised",
    "gradient_squared",
    "normalised_gradient_squared",
    "laplacian",
    "normalised_laplacian",
)
SCALARS: tuple[str, ...] = SIX
FIELDS: tuple[str, ...] = (*SCALARS, "gradient", "hessian", "singular")


class Calculus:
    """What calculus makes of one scalar node; nothing is built before it is asked for."""

    def __init__(self, builder: Builder, value: int) -> None:
        self.builder = builder
        self.value = value

    @cached_property
    def gradient(self) -> list[int]:
        """The first derivatives with respect to the coordinates."""
        return differentiation.gradient(self.builder, self.value)

    @cached_property
    def gradient_squared(self) -> int:
        """|grad|**2."""
        return dot(self.builder, self.gradient, self.gradient)

    @cached_property
    def laplacian(self) -> int:
        """The sum of the unmixed second derivatives."""
        return self._divergence(self.gradient)

    def _divergence(self, vector: Sequence[int]) -> int:
        b = self.builder
        total = b.const(0)
        for component, name in zip(vector, b.coordinates, strict=True):
            total = b.add(total, derivative(b, component, name))
        return total

    def second(self, i: int, j: int) -> int:
        """The second derivative with respect to coordinates i and j."""
        low, high = sorted((i, j))
        return derivative(self.builder, self.gradient[low], self.builder.coordinates[high])

    @cached_property
    def normalised(self) -> Calculus:
        """omega/sqrt(omega**2 + |grad omega|**2)."""
        return Calculus(self.builder, self.builder.normalised(self.value, self.gradient_squared))

    def scalar(self, field: str) -> int:
        """The node of a scalar field."""
        if field == "value":
            return self.value
        if field.startswith("normalised"):
            return self.normalised.scalar(field.removeprefix("normalised").removeprefix("_") or "value")
        return self.gradient_squared if field == "gradient_squared" else self.laplacian


def outputs_of(calculus: Calculus, field: str) -> dict[str, int]:
    """The scalar outputs that make up a field."""
    size = len(calculus.builder.coordinates)
    if field in {"gradient", "singular"}:
        return {f"gradient_{i}": node for i, node in enumerate(calculus.gradient)}
    if field == "hessian":
        return {f"hessian_{i}_{j}": calculus.second(i, j) for i in range(size) for j in range(i, size)}
    return {field: calculus.scalar(field)}


def gather(parts: Mapping[str, NDArray[Any]], fields: Sequence[str], size: int) -> dict[str, NDArray[Any]]:
    """The fields from their scalar parts: gradient (..., dim), hessian (..., dim, dim), singular boolean."""
    result: dict[str, NDArray[Any]] = {}
    for field in fields:
        if field in {"gradient", "singular"}:
            gradient = np.stack([parts[f"gradient_{i}"] for i in range(size)], axis=-1)
            result[field] = gradient if field == "gradient" else ~np.isfinite(gradient).all(axis=-1)
        elif field == "hessian":
            rows = [[parts[f"hessian_{min(i, j)}_{max(i, j)}"] for j in range(size)] for i in range(size)]
            result[field] = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
        else:
            result[field] = parts[field]
    return result


def checked_fields(fields: Sequence[str]) -> tuple[str, ...]:
    """The fields as a tuple of known names; one name alone is accepted too."""
    names = (fields,) if isinstance(fields, str) else tuple(fields)
    unknown = [name for name in names if name not in FIELDS]
    if unknown or not names:
        raise RsymError(
            f"no field {unknown[0]!r}" if unknown else "no field was asked for",
            code="unknown-field",
            remedy=f"choose from {', '.join(FIELDS)}",
        )
    return tuple(dict.fromkeys(names))


def surface_program(shape: Shape, fields: Sequence[str]) -> Program:
    """The program of a function with the same zero set and signs: positive factors drop, omega_n goes back to omega.

    Where omega and its gradient vanish together a normalised value does not exist; omega does.
    """
    builder = _builder_for(shape)
    node, sign = lower(builder, shape.expression), 1
    while True:
        operation, arguments, _ = builder.nodes[node]
        factor = builder.value(arguments[0]) if operation == "mul" else None
        if operation in {"neg", "normalised"}:
            node, sign = arguments[0], -sign if operation == "neg" else sign
        elif factor is not None and factor > 0:
            node = arguments[1]
        else:
            break
    return _program(builder, Calculus(builder, node if sign > 0 else builder.neg(node)), fields)


def program_of(shape: Shape, fields: Sequence[str], *, of: str = "value") -> Program:
    """The program that computes the fields of a shape, or of the scalar field `of` of the shape."""
    builder = _builder_for(shape)
    calculus = Calculus(builder, lower(builder, shape.expression))
    if of != "value":
        calculus = Calculus(builder, calculus.scalar(of))
    return _program(builder, calculus, fields)


def _builder_for(shape: Shape) -> Builder:
    return Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(shape.letters))


def _program(builder: Builder, calculus: Calculus, fields: Sequence[str]) -> Program:
    outputs: dict[str, int] = {}
    for field in checked_fields(fields):
        outputs.update(outputs_of(calculus, field))
    return builder.program(outputs)
