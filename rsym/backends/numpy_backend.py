"""Backend `numpy`: readable Python source over arrays, shared parts computed once.

It works without any compiler package, and is the reference in speed and form
for the others. A slot is used again as soon as its value is no longer needed,
so a large program does not hold thousands of arrays. What is the same for all
points is computed in float64 and rounded where it meets the coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Arrays
from rsym.program.operations import OPERATIONS
from rsym.program.program import FLOAT64, Node, Precision, Program, constant_value


def numpy_source(program: Program, precision: Precision = FLOAT64) -> str:
    """Python source of a function of coordinates and letters that returns the outputs in order."""
    names = [f"c{k}" for k in range(len(program.coordinates))] + [f"p{k}" for k in range(len(program.letters))]
    input_name = dict(zip((*program.coordinates, *program.letters), names, strict=True))
    lines = [f"def kernel({', '.join(names)}):"]
    slots: list[str] = []
    for number, (text, slot) in enumerate(_in_slots(program, input_name, precision)):
        slots.append(slot)
        if program.nodes[number].operation not in {"const", "input", "undefined"}:
            lines.append(f"    {slot} = {text}")
    lines.append(f"    return {', '.join(slots[number] for _, number in program.outputs)},")
    return "\n".join(lines) + "\n"


def _in_slots(program: Program, input_name: dict[str, str], precision: Precision) -> list[tuple[str, str]]:
    """For each node its text and the variable that holds it."""
    last_use = {argument: number for number, node in enumerate(program.nodes) for argument in node.arguments}
    kept = {number for _, number in program.outputs}
    free: list[str] = []
    made = 0
    result: list[tuple[str, str]] = []
    for number, node in enumerate(program.nodes):
        leaf = _leaf(node, input_name, precision)
        if leaf is not None:
            result.append(("", leaf))
            continue
        rounded = precision is not FLOAT64 and not program.uniform[number]
        text = (
            OPERATIONS[node.operation]
            .texts["numpy"]
            .format(
                *(
                    f"numpy.{precision.name}({result[a][1]})" if rounded and program.uniform[a] else result[a][1]
                    for a in node.arguments
                )
            )
        )
        for argument in sorted(set(node.arguments)):
            slot = result[argument][1]
            if last_use[argument] == number and argument not in kept and slot.startswith("v"):
                free.append(slot)
        slot = free.pop() if free else f"v{made}"
        made += slot == f"v{made}"
        result.append((text, slot))
    return result


def _leaf(node: Node, input_name: dict[str, str], precision: Precision) -> str | None:
    if node.operation == "const":
        value = constant_value(node.data, precision)
        return repr(value) if np.copysign(1, value) > 0 else f"({value!r})"
    if node.operation == "undefined":
        return "numpy.nan"
    return input_name[str(node.data)] if node.operation == "input" else None


def function_of(source: str, program: Program, package: Any) -> Callable[..., tuple[Any, ...]]:
    """The function ``kernel`` of a text that was made of a program, its arrays those of a package like NumPy."""
    namespace: dict[str, Any] = {"numpy": package}
    exec(compile(source, f"<rsym kernel {program.digest[:12]}>", "exec"), namespace)
    made: Callable[..., tuple[Any, ...]] = namespace["kernel"]
    return made


class NumpyFunction:
    """A compiled program: arrays in, arrays out."""

    # Of 1k to 64k points the fastest on the six fields of the skeleton body, by a third: the slots stay in the cache.
    block_size = 4096

    def __init__(self, program: Program, precision: Precision = FLOAT64) -> None:
        self.program = program
        self.source = numpy_source(program, precision)
        self._function = function_of(self.source, program, np)

    def run(self, coordinates: Sequence[NDArray[Any]], letters: Sequence[float], outputs: Arrays) -> None:
        """Fill the outputs (contiguous, one-dimensional, of the precision) at the coordinates (likewise)."""
        with np.errstate(all="ignore"):
            values = self._function(*coordinates, *(np.float64(letter) for letter in letters))
        for output, value in zip(outputs, values, strict=True):
            output[...] = value
