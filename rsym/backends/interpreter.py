"""The reference: a program node by node with the plain meanings, and the check of what is compiled against it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.arrays import Floats
from rsym.backends.registry import CompiledFunction
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.program.operations import OPERATIONS
from rsym.program.program import FLOAT64, Precision, Program, constant_value


def interpret(program: Program, inputs: Mapping[str, ArrayLike]) -> dict[str, Floats]:
    """The outputs at the given inputs."""
    values = interpret_nodes(program, inputs)
    return {name: np.asarray(values[number], np.float64) for name, number in program.outputs}


def interpret_nodes(
    program: Program, inputs: Mapping[str, ArrayLike], precision: Precision = FLOAT64
) -> list[NDArray[Any]]:
    """The value of every node, in order, each rounded to the precision."""
    values: list[NDArray[Any]] = []
    with np.errstate(all="ignore"):
        for operation, arguments, data in program.nodes:
            value: ArrayLike
            if operation == "const":
                value = constant_value(data)
            elif operation == "input":
                value = inputs[str(data)]
            else:
                exponents = () if data is None else (data,)
                value = OPERATIONS[operation].meaning(np, *(values[argument] for argument in arguments), *exponents)
            values.append(np.asarray(value, precision.dtype))
    return values


CHECK_POINTS = 32
# In float32 a point may be so ill-conditioned that rounding costs more than a fixed share of the largest node: 8 of a
# million values on random trees. What the interpreter loses in float32 at that point, times this, covered all of them.
SEEN_ERRORS = 8
# Last places that a point is moved by where an output looks wrong.
SWAYS = (-4, -3, -2, -1, 0, 1, 2, 3, 4)


def check(program: Program, function: CompiledFunction, precision: Precision, shape: Shape) -> None:
    """Compare with the interpreter at 32 points of the box of the shape, what else varies from -1 to 1."""
    generator = np.random.default_rng(20130605)
    more = len(program.coordinates) - shape.dimension
    own = shape.box.ends if shape.box else ((-1.0, 1.0),) * shape.dimension
    box = (*own, *(((-1.0, 1.0),) * more))
    points = [generator.uniform(low, high, CHECK_POINTS).astype(precision.dtype) for low, high in box]
    check_at(program, function, precision, points, [float(shape.letters[name].default) for name in program.letters])


def check_at(
    program: Program,
    function: CompiledFunction,
    precision: Precision,
    points: Sequence[NDArray[Any]],
    letters: Sequence[float],
) -> None:
    """Compare with the interpreter at 32 points: a miscompiled formula must never leave this module."""
    outputs = [np.empty(CHECK_POINTS, precision.dtype) for _ in program.outputs]
    function.run(points, letters, outputs)
    inputs = dict(zip((*program.coordinates, *program.letters), [*points, *letters], strict=True))
    allowed = _allowed_errors(program, inputs, precision)
    for (name, _), got, (expected, error) in zip(program.outputs, outputs, allowed, strict=True):
        with np.errstate(all="ignore"):
            wrong = np.isfinite(expected) & np.isfinite(error) & ~(np.abs(got - expected) <= error)
        if wrong.any():
            with np.errstate(all="ignore"):
                wrong &= ~(np.abs(got - expected) <= _sway(program, points, letters, name))
        if wrong.any():
            raise RsymError(
                f"the compiled {name!r} differs from its formula at {int(wrong.sum())} of {CHECK_POINTS} points",
                code="miscompiled",
                remedy="use backend='numpy' and report the model",
            )


def _sway(program: Program, points: Sequence[NDArray[Any]], letters: Sequence[float], name: str) -> Floats:
    """What last places of the coordinates may do to an output: all there is to say of a direction on a plane."""
    number, values = dict(program.outputs)[name], []
    for steps in SWAYS:
        moved = [point + steps * np.spacing(point) for point in points]
        inputs = dict(zip((*program.coordinates, *program.letters), [*moved, *letters], strict=True))
        values.append(np.broadcast_to(interpret_nodes(program, inputs)[number], CHECK_POINTS))
    sway: Floats = SEEN_ERRORS * np.ptp(values, axis=0)
    return sway


def _allowed_errors(
    program: Program, inputs: Mapping[str, Any], precision: Precision
) -> list[tuple[NDArray[Any], NDArray[Any]]]:
    """For each output its true values, and the errors that rounding may cause."""
    nodes = interpret_nodes(program, inputs)
    rounded = nodes if precision is FLOAT64 else interpret_nodes(program, inputs, precision)
    with np.errstate(all="ignore"):
        sizes = np.array([np.broadcast_to(np.abs(node), CHECK_POINTS) for node in nodes])
        scale = precision.tolerance * np.where(np.isfinite(sizes), sizes, 0).max(axis=0)
        return [
            (np.broadcast_to(nodes[k], CHECK_POINTS), scale + SEEN_ERRORS * np.abs(rounded[k] - nodes[k]))
            for _, k in program.outputs
        ]
