"""The reference: a program evaluated node by node with the plain meaning of its operations."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.program.operations import OPERATIONS
from rsym.program.precision import FLOAT64, Precision
from rsym.program.program import Program, constant_value


def interpret(program: Program, inputs: Mapping[str, ArrayLike]) -> dict[str, NDArray[np.float64]]:
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
