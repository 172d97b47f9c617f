"""How far a function is from normalised at a point: its derivatives along the normal, as nodes of one program.

With g = grad omega, nu = g/|g| and the tensor of derivatives of order k contracted k times with nu,

    deviation_1 = d omega/d nu - 1 = |g| - 1,      deviation_k = d^k omega/d nu^k for k = 2, 3, ...

The direction is the normal at the point and does not turn along the line.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from rsym.analysis.tensors import indices, partials, unit_index
from rsym.backends.interpreter import interpret
from rsym.program.differentiation import derivative, dot
from rsym.program.normalisation import contraction
from rsym.program.program import Program, live
from rsym.verify.boxes.local import Model

# Points at once: the interpreter keeps every node, which for a program of 100 000 is 0.2 GB.
BLOCK = 256
MANY = 10_000  # nodes that nobody wants to differentiate once more


class NormalDerivatives:
    """The deviations of orders 1 to m of a node of a model, its root if none is named, from a normalised function."""

    def __init__(self, model: Model, order: int, root: int | None = None) -> None:
        self.model, self.root = model, model.root if root is None else root
        builder = model.builder
        self.size = len(builder.coordinates)
        found = partials(self.root, order, builder.coordinates, partial(derivative, builder))
        self.gradient = [found[unit_index(self.size, axis)] for axis in range(self.size)]
        self.squared = dot(builder, self.gradient, self.gradient)
        root = builder.sqrt(self.squared)
        self.deviations = [builder.sub(root, builder.const(1))]
        for k in range(2, order + 1):
            entries = [found[index] for index in indices(self.size, k)]
            share = builder.mul(builder.const(math.factorial(k)), contraction(builder, entries, self.gradient, k))
            scale = builder.powi(self.squared, k // 2)
            self.deviations.append(builder.div(share, builder.mul(scale, root) if k % 2 else scale))

    def slopes(self, k: int) -> list[int]:
        """The gradient of the deviation of order k + 1."""
        builder = self.model.builder
        return [derivative(builder, self.deviations[k], name) for name in builder.coordinates]

    def cost(self, order: int) -> int:
        """How many nodes the deviations up to an order and their gradients need; without gradients if they are many."""
        nodes = self.model.builder.nodes
        plain = len(live(nodes, self.deviations[:order]))
        if plain > MANY:
            return plain
        return len(live(nodes, [node for k in range(order) for node in (self.deviations[k], *self.slopes(k))]))

    @cached_property
    def program(self) -> Program:
        """Value, gradient and deviations."""
        names = {"value": self.root}
        names |= {f"gradient_{axis}": node for axis, node in enumerate(self.gradient)}
        names |= {f"deviation_{k}": node for k, node in enumerate(self.deviations, 1)}
        return self.model.builder.program(names)

    def at(self, points: NDArray[np.float64]) -> NormalSamples:
        """Values in float64 at points (n, dim)."""
        blocks = [points[start : start + BLOCK] for start in range(0, len(points), BLOCK)] or [points]
        parts = [self._block(block) for block in blocks]
        return NormalSamples(points, *(np.concatenate(arrays) for arrays in zip(*parts, strict=True)))

    def _block(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        inputs: Mapping[str, NDArray[np.float64] | float] = {
            **dict(zip(self.program.coordinates, points.T, strict=True)),
            **{name: float(low) for name, (low, _) in self.model.letters.items()},
        }
        found = {name: np.broadcast_to(value, len(points)) for name, value in interpret(self.program, inputs).items()}
        gradient = np.stack([found[f"gradient_{axis}"] for axis in range(self.size)], axis=-1)
        deviations = np.stack([found[f"deviation_{k}"] for k in range(1, len(self.deviations) + 1)], axis=-1)
        return found["value"], gradient, deviations


class NormalSamples:
    """At points (n, dim): value (n,), gradient (n, dim), deviations (n, order)."""

    def __init__(
        self,
        points: NDArray[np.float64],
        value: NDArray[np.float64],
        gradient: NDArray[np.float64],
        deviations: NDArray[np.float64],
    ) -> None:
        self.points = points
        self.value = value
        self.gradient = gradient
        self.deviations = deviations

    @property
    def regular(self) -> NDArray[np.bool_]:
        """Where the gradient exists, is not zero, and all deviations exist."""
        squared = np.einsum("ij,ij->i", self.gradient, self.gradient)
        found: NDArray[np.bool_] = np.isfinite(squared) & (squared > 0) & np.isfinite(self.deviations).all(axis=1)
        return found

    @property
    def normals(self) -> NDArray[np.float64]:
        """The inner unit normals, NaN where there is none."""
        with np.errstate(all="ignore"):
            normals: NDArray[np.float64] = self.gradient / np.linalg.norm(self.gradient, axis=1, keepdims=True)
        return normals
