"""The program: a hash-consed straight-line form of one or more functions, and the two formats it is computed in.

Arguments precede their users, so ascending order is evaluation order; equal
parts exist once. Constants are exact fractions until a backend prints them.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from rsym.errors import RsymError
from rsym.model.wording import within


@dataclass(frozen=True)
class Precision:
    """A floating-point format: its name in NumPy, and what rounding may cost a kernel when it is checked.

    `tolerance` is a share of the largest node value at a point; more than that is wrong code, not rounding.
    `rounding` is the share of the size of a derivative up to which its sides on the border of a choice may differ.
    """

    name: str
    tolerance: float
    rounding: Fraction

    @cached_property
    def dtype(self) -> np.dtype[Any]:
        """The type of coordinates and results."""
        return np.dtype(self.name)

    @cached_property
    def constants(self) -> Mapping[str, float]:
        """The constants that have names: pi, e, and the ends of the format."""
        limits = np.finfo(self.dtype)
        return {
            "pi": math.pi,
            "e": math.e,
            "largest": float(limits.max),
            "smallest": float(limits.smallest_subnormal),
        }


# On the six fields of the car and of the skeleton body rounding stays below 1e-16 of the largest node in float64 and
# below 3e-7 in float32; 99.999 % of a million values on random trees stay below 1e-5 in float32.
# Values of the two sides of a border are taken for one up to 4096 units in the last place.
FLOAT64 = Precision("float64", 1e-10, Fraction(1, 2**40))
FLOAT32 = Precision("float32", 1e-5, Fraction(1, 2**12))
PRECISIONS = {precision.name: precision for precision in (FLOAT64, FLOAT32)}


def precision_named(name: Any) -> Precision:
    """The precision of this name."""
    if not isinstance(name, str) or name not in PRECISIONS:
        raise RsymError(f"dtype must be 'float64' or 'float32', got {name!r}", code="dtype")
    return PRECISIONS[name]


Data: TypeAlias = Fraction | str | int | tuple[int, int, int] | None


class Node(NamedTuple):
    """One operation on earlier nodes; `data` is a constant, an input's name or integer exponents."""

    operation: str
    arguments: tuple[int, ...] = ()
    data: Data = None


@dataclass(frozen=True, repr=False)
class Program:
    """Nodes in evaluation order, the names of the inputs, and which nodes are the outputs.

    `coordinates` vary from point to point; `letters` are the same for a whole call.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> print(rsym.compile(rsym.Shape(x * y + 1, (x, y))).program)
    v0 = const 1
    v1 = input x
    v2 = input y
    v3 = mul v1 v2
    v4 = add v0 v3
    value = v4
    """

    nodes: tuple[Node, ...]
    coordinates: tuple[str, ...]
    letters: tuple[str, ...]
    outputs: tuple[tuple[str, int], ...]

    def __len__(self) -> int:
        return len(self.nodes)

    def __repr__(self) -> str:
        names = ", ".join(within([name for name, _ in self.outputs], 1000))
        return f"Program({len(self)} nodes of {', '.join(within(self.coordinates + self.letters, 1000))}; {names})"

    def __str__(self) -> str:
        lines = []
        for number, node in enumerate(self.nodes):
            words = [node.operation, *(f"v{argument}" for argument in node.arguments)]
            words += [] if node.data is None else [str(node.data)]
            lines.append(f"v{number} = {' '.join(words)}")
        return "\n".join(lines + [f"{name} = v{number}" for name, number in self.outputs])

    def varying(self, names: Sequence[str]) -> Program:
        """The same program with these letters varying from point to point, after the coordinates.

        An R-operation takes its parameter from a letter; a range of letters may differ from box to box all the same.

        Examples
        --------
        >>> Program((Node("input", (), "a"),), ("x",), ("a", "b"), (("value", 0),)).varying(["b"]).coordinates
        ('x', 'b')
        """
        letters = tuple(name for name in self.letters if name not in names)
        return replace(self, coordinates=(*self.coordinates, *names), letters=letters)

    @cached_property
    def digest(self) -> str:
        """A hash of what the program computes."""
        text = f"{self.coordinates}\n{self.letters}\n{self}"
        return hashlib.sha256(text.encode()).hexdigest()

    @cached_property
    def uniform(self) -> tuple[bool, ...]:
        """Which nodes do not depend on the point."""
        flags: list[bool] = []
        coordinates = frozenset(self.coordinates)
        for node in self.nodes:
            varying = node.operation == "input" and node.data in coordinates
            flags.append(not varying and all(flags[argument] for argument in node.arguments))
        return tuple(flags)


def constant_value(data: Data, precision: Precision = FLOAT64) -> float:
    """The nearest float64 of a constant; `largest` and `smallest` are the ends of the precision."""
    if isinstance(data, str):
        return precision.constants[data]
    assert isinstance(data, Fraction)
    try:
        return float(data)
    except OverflowError as error:
        raise RsymError(
            "a constant of the formula is larger than float64 can hold (1.8e308)",
            code="number-too-large",
            remedy="scale the model",
        ) from error


def live(nodes: Sequence[Node], outputs: Iterable[int]) -> list[int]:
    """The nodes that the outputs need, in evaluation order."""
    seen: set[int] = set()
    stack = list(outputs)
    while stack:
        number = stack.pop()
        if number not in seen:
            seen.add(number)
            stack.extend(nodes[number].arguments)
    return sorted(seen)


def assemble(
    nodes: Sequence[Node], coordinates: tuple[str, ...], letters: tuple[str, ...], outputs: Mapping[str, int]
) -> Program:
    """Keep what the outputs need, renumbered."""
    kept = live(nodes, outputs.values())
    number_of = {old: new for new, old in enumerate(kept)}
    renumbered = tuple(
        nodes[old]._replace(arguments=tuple(number_of[argument] for argument in nodes[old].arguments)) for old in kept
    )
    return Program(renumbered, coordinates, letters, tuple((name, number_of[old]) for name, old in outputs.items()))
