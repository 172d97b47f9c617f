"""Points on the zero sets of several functions of one shape, compiled together, at random and off singular points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

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
Progress: TypeAlias = Callable[[int, int], Any]
Box: TypeAlias = tuple[tuple[float, float], ...]
SCATTERED = {2: 6_000, 3: 20_000}  # points in the box from which the nearest to a zero set begin
SAMPLES = 800  # points for each zero set: of a face of a hundredth of its area, eight
EVALUATIONS = 8_000_000  # in a step; a hundred leaves have all these points, three hundred a tenth
FEWEST = 50
# Leaves that tapes evaluate at points of their own: against one kernel that computes all everywhere a lint of 65 discs
# takes half as long, one of 1000 a quarter.
MANY, MOST = 64, 32_000
STEPS = 30  # of Newton's iteration; double zeros converge by halves
LONGEST = 0.1  # of the diagonal, for a step
CONVERGED = 1e-9  # of the diagonal: what is nearer lies on the zero set
ASIDE = 1e-6  # of the diagonal: where one-sided derivatives are taken
TANGENT = 1e-4  # of the diagonal: so far off along its tangent plane a smooth zero set has hardly left it
BENT = 0.2  # by less than this share of the way


@dataclass(frozen=True)
class Zeros:
    """Regular points of zero sets.

    which : the number of the function (n,), of which `points` (n, dim) are zeros.
    sides : unit normals (n, dim), of either sign.
    slopes : the length of the gradient (n,), beside the point where the function does not change its sign.
    signed : whether the function changes its sign (n,).
    """

    which: Ints
    points: Floats
    sides: Floats
    slopes: Floats
    signed: NDArray[np.bool_]

    def __getitem__(self, kept: Any) -> Zeros:
        return Zeros(*(column[kept] for column in vars(self).values()))


def scattered(box: Box, count: int) -> Floats:
    """Points at random in a box, always the same."""
    low, high = np.array(box).T
    points: Floats = low + (high - low) * np.random.default_rng(20130605).random((count, len(box)))
    return points


def diagonal(box: Box) -> float:
    """The length of the diagonal of a box."""
    return float(np.linalg.norm([high - low for low, high in box]))


def zeros_of(functions: Functions, cloud: Floats, box: Box, progress: Progress | None = None) -> Zeros:
    """Points of the zero sets of all functions, which begin at those of a cloud that seem nearest.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.verify.lint.zeros import functions_of
    >>> box = ((-2.0, 2.0), (-2.0, 2.0))
    >>> found = zeros_of(functions_of(rsym.Shape(x, (x, y)), [1 - x**2 - y**2]), scattered(box, 500), box)
    >>> bool(np.ptp(np.linalg.norm(found.points, axis=1)) < 1e-9), found.slopes.round(4).min().tolist()
    (True, 2.0)
    """
    size = diagonal(box)
    which, starts = _starts(functions, cloud)
    points, arrived = _newton(functions, which, starts, size, progress)
    low, high = np.array(box).T
    arrived = arrived & ((points >= low) & (points <= high)).all(axis=1)
    which, starts, points = which[arrived], starts[arrived], points[arrived]
    return _regular(functions, which, starts, points, size)


def onto(functions: Functions, which: Ints, starts: Floats, size: float) -> tuple[Floats, NDArray[np.bool_]]:
    """Points on the zero sets near starting points, and whether they were reached."""
    return _newton(functions, which, starts, size, None, 8)


def _starts(functions: Functions, cloud: Floats) -> tuple[Ints, Floats]:
    """For each function the points of the cloud that seem nearest to its zero set."""
    distances = np.empty((functions.count, len(cloud)))
    for start in range(0, len(cloud), functions.portion):
        values, gradients = functions(cloud[start : start + functions.portion])
        with np.errstate(all="ignore"):
            distances[:, start : start + functions.portion] = np.abs(values) / np.linalg.norm(gradients, axis=2)
    distances[~np.isfinite(distances)] = np.inf
    count = min(SAMPLES, len(cloud), max(FEWEST, EVALUATIONS // functions.count**2))
    # In the order of the cloud: in which one a partition leaves them depends on the processor.
    nearest = np.sort(np.argpartition(distances, count - 1, axis=1)[:, :count], axis=1)
    usable = np.isfinite(np.take_along_axis(distances, nearest, axis=1)).ravel()
    which = np.repeat(np.arange(functions.count), count)
    return which[usable], cloud[nearest.ravel()[usable]]


def _newton(
    functions: Functions, which: Ints, starts: Floats, size: float, progress: Progress | None, steps: int = STEPS
) -> tuple[Floats, NDArray[np.bool_]]:
    """Newton's iteration along gradients; what has no gradient stays where it is."""
    points = starts.copy()
    arrived = np.zeros(len(points), bool)
    going = np.arange(len(points))
    for step in range(steps):
        if progress is not None:
            progress(step + 1, STEPS)
        values, slopes = functions.of(which[going], points[going])
        with np.errstate(all="ignore"):
            move = -(values / (slopes**2).sum(axis=1))[:, None] * slopes
        length = np.linalg.norm(move, axis=1)
        arrived[going] = (values == 0) | (length <= CONVERGED * size)
        moves = np.isfinite(length) & (values != 0)
        with np.errstate(all="ignore"):
            move *= np.minimum(1, LONGEST * size / length)[:, None]
        going, move, length = going[moves], move[moves], length[moves]
        points[going] += move
        going = going[length > np.finfo(float).eps * size]
        if not len(going):
            break
    return points, arrived


def tangents(normals: Floats) -> list[Floats]:
    """Unit vectors orthogonal to normals: one in the plane, two in space."""
    if normals.shape[1] == 2:
        return [normals[:, ::-1] * [1.0, -1.0]]
    axis = np.eye(3)[np.argmin(np.abs(normals), axis=1)]
    first = np.cross(normals, axis)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return [first, np.cross(normals, first)]


def _regular(functions: Functions, which: Ints, starts: Floats, points: Floats, size: float) -> Zeros:
    """The points around which the zero set is smooth; their normals point where the iteration came from, or uphill."""
    _, gradients = functions.of(which, points)
    slopes, ways = np.linalg.norm(gradients, axis=1), starts - points
    with np.errstate(all="ignore"):
        uphill, back = gradients / slopes[:, None], ways / np.linalg.norm(ways, axis=1, keepdims=True)
    sides = np.where(np.isfinite(uphill), uphill, back)
    ahead, gradients = functions.of(which, points + ASIDE * size * sides)
    behind, _ = functions.of(which, points - ASIDE * size * sides)
    signed = (ahead * behind < 0) & np.isfinite(slopes)
    slopes = np.where(signed, slopes, np.linalg.norm(gradients, axis=1))
    regular = np.isfinite(slopes) & np.isfinite(sides).all(axis=1)
    for tangent in tangents(sides):
        for step in (TANGENT * size, -TANGENT * size):
            value, _ = functions.of(which, points + step * tangent)
            regular &= np.abs(value) <= BENT * abs(step) * np.maximum(slopes, np.abs(ahead) / (ASIDE * size))
    return Zeros(which, points, sides, slopes, signed)[regular]


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
    own: Any = None  # of many functions all but the last, each at points of its own

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

    def signs(self, points: Floats) -> tuple[NDArray[np.int8], Floats]:
        """The signs (count - 1, n) of all functions but the last, 0 where undefined, and the value (n,) of that."""
        signs, last = np.empty((self.count - 1, len(points)), np.int8), np.empty(len(points))
        for start in range(0, len(points), self.portion):
            here = slice(start, start + self.portion)
            values, _ = self(points[here])
            signs[:, here], last[here] = np.nan_to_num(np.sign(values[:-1])), values[-1]
        return signs, last

    def of(self, which: Ints, points: Floats) -> tuple[Floats, Floats]:
        """The value (n,) and the gradient (n, dim) of one function at each point."""
        value, slope = np.empty(len(points)), np.empty(points.shape)
        rest = np.arange(len(points))
        if self.own is not None:
            (some,), (rest,) = np.nonzero(which < self.count - 1), np.nonzero(which == self.count - 1)
            value[some], slope[some] = self.own.leaf(points[some], which[some])
        for start in range(0, len(rest), self.portion):
            here = rest[start : start + self.portion]
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
    letters = tuple(values[name] for name in kernel.program.letters)
    return Functions(kernel, letters, len(expressions), _own(shape, expressions[:-1]))


def _own(shape: Shape, expressions: Sequence[sp.Expr]) -> Any:
    """Many functions by tapes, where the packages for them are there; else None."""
    if not MANY < len(expressions) <= MOST:
        return None
    try:
        from rsym.sampling.regions.own_leaves import own_leaves
    except (ImportError, OSError):
        return None
    return own_leaves(shape, expressions)
