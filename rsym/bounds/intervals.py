"""The interval backend: a program becomes the program of its bounds over boxes.

The new program has for each input two, its ends, and for each output two, its
bounds; it is compiled like any other, so boxes run through vectors and threads.
It is made before R-operations are expanded, while each still has its exact
image; expanded, the dependency between operands and root would undo every bound.

[value_lower, value_upper] contains the value at every point of the box and for
all letters in their intervals where the value is defined. Where nothing can be
said it is (-inf, inf), never NaN. Rounding is argued in `interval_arithmetic`
and, for R-operations, in `interval_monotone`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.backends.interpreter import CHECK_POINTS, check_at
from rsym.backends.kernel import checked_threads, compiled, run_in_blocks
from rsym.backends.registry import CompiledFunction, default_backend
from rsym.bounds.box_images import BoxImages, ends_of
from rsym.bounds.interval_arithmetic import Interval, neighbours
from rsym.bounds.mean_values import narrowed, sharpen
from rsym.errors import RsymError
from rsym.program.builder import Builder
from rsym.program.program import FLOAT64, Program

Bounds: TypeAlias = dict[str, tuple[Floats, Floats]]
Range: TypeAlias = Fraction | float | tuple[Fraction | float, Fraction | float]

# Up to 30 000 nodes LLVM takes 0.1 to 0.3 ms a node (NumPy 0.04), at 40 000 it may take 52 s (1.5), at 465 000 it had
# not ended after minutes (18 s).
LARGE = 30_000


def interval_program(program: Program, sharpened: Collection[int] = (), strict: bool = False) -> Program:
    """The bounds of a program's outputs over boxes.

    Inputs ``x`` become ``x_lower``, ``x_upper``, letters and outputs likewise. The images of the nodes `sharpened` are
    intersected with their mean-value form, where one of their coordinates repeats. `strict`: where an output may be
    undefined at some point of a box nothing is said of it.

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
    source = Builder(program.coordinates, program.letters)
    for node in program.nodes:
        source.make(node.operation, *node.arguments, data=node.data)
    target = Builder(ends_of(program.coordinates), ends_of(program.letters))
    images = BoxImages(source, target, strict=strict)
    sharpen(images, sharpened)
    images.make(number for _, number in program.outputs)
    return target.program(_known_ends(target, {name: narrowed(images, number) for name, number in program.outputs}))


def _known_ends(b: Builder, images: Mapping[str, Interval]) -> dict[str, int]:
    """The ends of the outputs, one that says nothing infinite."""
    down = b.make("log", b.const(0))
    outputs: dict[str, int] = {}
    for name, image in images.items():
        lower, upper = ends_of([name])
        outputs[lower] = b.select(image.lower, down, image.lower, down)
        outputs[upper] = b.select(b.neg(down), image.upper, image.upper, b.neg(down))
    return outputs


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
    sharpened : tuple of int, optional
        Nodes whose bounds are intersected with their mean-value form.
    strict : bool
        Whether nothing is said of what may be undefined somewhere on a box.

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
    sharpened: tuple[int, ...] = ()
    strict: bool = False

    @cached_property
    def bounds(self) -> Program:
        """The program of the bounds."""
        return interval_program(self.program, self.sharpened, self.strict)

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

    def _coordinates(self, lower: Sequence[ArrayLike], upper: Sequence[ArrayLike]) -> list[Floats]:
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
    return value if isinstance(value, float) else neighbours(Fraction(value))[end]


def _check(bounds: Program, function: CompiledFunction) -> None:
    """Against the interpreter, over small boxes around the origin and letters near 1."""
    generator = np.random.default_rng(20130605)
    points = []
    for _ in bounds.coordinates[::2]:
        low = generator.uniform(-1, 1, CHECK_POINTS)
        points += [low, low + generator.uniform(0, 0.25, CHECK_POINTS)]
    letters = [end for k in range(len(bounds.letters) // 2) for end in (1.0 + k / 8, 1.125 + k / 8)]
    check_at(bounds, function, FLOAT64, points, letters)
