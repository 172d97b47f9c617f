"""The interval backend: a program becomes the program of its bounds over boxes.

The new program has for each input two, its ends, and for each output two, its
bounds; it is compiled like any other, so boxes run through vectors and threads.
It is made before R-operations are expanded, while each still has its exact
image; expanded, the dependency between operands and root would undo every bound.

[value_lower, value_upper] contains the value at every point of the box and for
all letters in their intervals where the value is defined. Where nothing can be
said it is (-inf, inf), never NaN. Rounding is argued in `interval_arithmetic`
and, for R-operations, in `interval_systems`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.codegen.backends import CompiledFunction, default_backend
from rsym.codegen.builder import Builder
from rsym.codegen.checking import CHECK_POINTS, check_at
from rsym.codegen.definedness import Definedness, is_decisive
from rsym.codegen.interval_arithmetic import Interval, neighbours, nonnegative
from rsym.codegen.interval_images import IMAGES, chosen, scaled
from rsym.codegen.kernel import checked_threads, compiled, run_in_blocks
from rsym.codegen.precision import FLOAT64
from rsym.codegen.program import Node, Program
from rsym.codegen.relations import relation
from rsym.errors import RsymError

Bounds: TypeAlias = dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
Range: TypeAlias = Fraction | float | tuple[Fraction | float, Fraction | float]

# Up to 30 000 nodes LLVM takes 0.1 ms a node (NumPy 0.04), at 465 000 it had not ended after minutes (NumPy: 18 s).
LARGE = 50_000


def interval_program(program: Program) -> Program:
    """The bounds of a program's outputs over boxes.

    Inputs ``x`` become ``x_lower``, ``x_upper``, letters and outputs likewise.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> program = rsym.compile(rsym.Shape(rsym.conjunction(x, y), (x, y))).program
    >>> bounds = interval_program(program)
    >>> bounds.coordinates
    ('x_lower', 'x_upper', 'y_lower', 'y_upper')
    >>> [name for name, _ in bounds.outputs]
    ['value_lower', 'value_upper']
    """
    images = _Images(program)
    return images.bounds()


class _Images:
    """The image of every node of a program."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.builder = Builder(_ends(program.coordinates), _ends(program.letters))
        source = Builder(program.coordinates, program.letters)
        for node in program.nodes:
            source.make(node.operation, *node.arguments, data=node.data)
        self.source = source
        self.definedness = Definedness(program.nodes, source.nonnegative)
        self.images: list[Interval] = []
        for number, node in enumerate(program.nodes):
            image = self._image(number, node)
            known = source.nonnegative[number] and not image.nonnegative
            self.images.append(nonnegative(self.builder, image) if known else image)

    def _image(self, number: int, node: Node) -> Interval:
        b, operands = self.builder, [self.images[argument] for argument in node.arguments]
        if node.operation == "input":
            lower, upper = _ends([str(node.data)])
            return Interval(b.input(lower), b.input(upper))
        if node.operation == "mul":
            factor = self.source.value(node.arguments[0])
            if factor is not None:
                return scaled(b, factor, operands[1])
        if node.operation == "select":
            return self._select(node, operands)
        name, arguments = relation(self.program.nodes, number) or (node.operation, node.arguments)
        return IMAGES[name](b, node, [self.images[argument] for argument in arguments])

    def _select(self, node: Node, operands: list[Interval]) -> Interval:
        """A branch that is never defined leaves the other."""
        never = [self.program.nodes[argument].operation == "undefined" for argument in node.arguments]
        if never[2] or never[3]:
            return operands[3] if never[2] else operands[2]
        return chosen(self.builder, operands, is_decisive(self.definedness, node))

    def bounds(self) -> Program:
        """The outputs, an end that says nothing infinite."""
        b = self.builder
        down = b.make("log", b.const(0))
        outputs: dict[str, int] = {}
        for name, number in self.program.outputs:
            image = self.images[number]
            lower, upper = _ends([name])
            outputs[lower] = b.select(image.lower, down, image.lower, down)
            outputs[upper] = b.select(b.neg(down), image.upper, image.upper, b.neg(down))
        return b.program(outputs)


def _ends(names: Sequence[str]) -> tuple[str, ...]:
    return tuple(f"{name}_{end}" for name in names for end in ("lower", "upper"))


@dataclass(frozen=True)
class IntervalFunction:
    """A program over boxes: ``function(lower, upper, letters)`` gives the bounds of each output.

    Parameters
    ----------
    program : Program
        The program at points, not expanded.
    backend : {"llvm", "numpy"}, optional
        As in `compile`, but ``numpy`` for programs so large that LLVM takes minutes; both give the same bits for
        arithmetic.
    threads : int, optional
        As in `compile`; the bits do not depend on it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> function = IntervalFunction(rsym.compile(rsym.Shape(1 - x**2 - y**2, (x, y))).program)
    >>> lower, upper = function([[0.0, 2.0], [0.0, 0.0]], [[0.5, 3.0], [0.5, 1.0]])["value"]
    >>> lower.round(12).tolist(), upper.round(12).tolist()
    ([0.5, -9.0], [1.0, -3.0])
    """

    program: Program
    backend: str | None = None
    threads: int | None = None

    @cached_property
    def bounds(self) -> Program:
        """The program of the bounds."""
        return interval_program(self.program)

    @cached_property
    def function(self) -> CompiledFunction:
        """The compiled program of the bounds, checked when it is made."""
        name = self.backend or (default_backend() if len(self.bounds) <= LARGE else "numpy")
        return compiled(self.bounds, name, FLOAT64, lambda made: _check(self.bounds, made))

    @property
    def source(self) -> str:
        """The generated code."""
        return self.function.source

    def __call__(
        self,
        lower: Sequence[ArrayLike],
        upper: Sequence[ArrayLike],
        letters: Sequence[Range] | Mapping[str, Range] = (),
    ) -> Bounds:
        """Bounds over the boxes: for each coordinate an array of lower and one of upper ends, which broadcast.

        Letters are numbers or pairs of ends, in the order of the program or by name.

        Raises
        ------
        RsymError
            For a wrong number of arrays or letters, or a lower end above its upper end.
        """
        arrays = self._coordinates(lower, upper)
        ends = [end for value in self._letters(letters) for end in value]
        out = np.empty((len(self.bounds.outputs), *arrays[0].shape))
        run_in_blocks(self.function, arrays, ends, out, checked_threads(self.threads))
        return {name: (out[2 * k], out[2 * k + 1]) for k, (name, _) in enumerate(self.program.outputs)}

    def _coordinates(self, lower: Sequence[ArrayLike], upper: Sequence[ArrayLike]) -> list[NDArray[np.float64]]:
        names = self.program.coordinates
        if len(lower) != len(names) or len(upper) != len(names):
            raise RsymError(
                f"expected lower and upper ends of {len(names)} coordinates ({', '.join(names)}), "
                f"got {len(lower)} and {len(upper)}",
                code="arity",
            )
        pairs = [end for pair in zip(lower, upper, strict=True) for end in pair]
        arrays = list(np.broadcast_arrays(*(np.asarray(end, np.float64) for end in pairs)))
        for name, low, high in zip(names, arrays[::2], arrays[1::2], strict=True):
            if (low > high).any():
                raise RsymError(f"a box has a lower end of {name} above the upper end", code="box")
        return arrays

    def _letters(self, letters: Sequence[Range] | Mapping[str, Range]) -> list[tuple[float, float]]:
        names = self.program.letters
        if isinstance(letters, Mapping):
            missing = [name for name in names if name not in letters]
            values = [letters[name] for name in names if name in letters]
        else:
            missing, values = list(names[len(letters) :]), list(letters)
        if missing or len(values) > len(names):
            raise RsymError(
                f"expected the letters {', '.join(names) or '(none)'}; missing: {', '.join(missing) or 'none'}",
                code="letters",
                remedy="give each a number or a pair (lower, upper)",
            )
        return [_outward(name, value) for name, value in zip(names, values, strict=True)]


def _outward(name: str, value: Any) -> tuple[float, float]:
    """Float64 ends of an interval that contains the given one."""
    low, high = value if isinstance(value, tuple | list) else (value, value)
    if not low <= high:
        raise RsymError(f"the letter {name!r} has the lower end {low} above the upper end {high}", code="letters")
    return _exact(low, 0), _exact(high, 1)


def _exact(value: Any, end: int) -> float:
    finite = not isinstance(value, float) or np.isfinite(value)
    return neighbours(Fraction(value))[end] if finite else float(value)


def _check(bounds: Program, function: CompiledFunction) -> None:
    """Against the interpreter, over small boxes around the origin and letters near 1."""
    generator = np.random.default_rng(20130605)
    points = []
    for _ in bounds.coordinates[::2]:
        low = generator.uniform(-1, 1, CHECK_POINTS)
        points += [low, low + generator.uniform(0, 0.25, CHECK_POINTS)]
    letters = [end for k in range(len(bounds.letters) // 2) for end in (1.0 + k / 8, 1.125 + k / 8)]
    check_at(bounds, function, FLOAT64, points, letters)
