"""Distances of points from a boundary, to first order, with their derivatives by letters: what a fit makes small.

Near a corner of an R-operation, and between two faces close to each other, the gradient of omega goes to 0 while that
of each leaf does not: omega/|grad omega| is there as large as one likes. So the distance is that of the sign form, min
and max of the distances of the leaves: to first order the same, exact along edges, and steady beside them. On points of
the car with an error of 0.002 the residuals of omega have an rms of 1.3 where those of the leaves have 0.002.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from rsym.arrays import Floats
from rsym.backends.kernel import Kernel, compile_program
from rsym.logic.gates import Gate, through
from rsym.logic.sign_form import shape_form
from rsym.model.shape import Shape
from rsym.program.by_letters import LENGTH, FirstOrder
from rsym.program.program import Program
from rsym.sampling.active_leaves import SAME
from rsym.sampling.silhouettes import LinesOfSight

Distances: TypeAlias = Callable[[Floats], tuple[Floats, Floats]]
DISTANCE = "distance"


def by(letter: str) -> str:
    """The output that is the derivative by a letter."""
    return f"by {letter}"


def distance_program(shape: Shape, letters: Sequence[str]) -> Program:
    """The distance, positive inside, and its derivatives by letters or coordinates; L is a letter of the shape.

    There is none where the end of a domain alone decides: omega is not zero there. An end that is as far as a face, to
    rounding, decides in a union and not in an intersection. Raises RsymError for a letter that
    is a parameter of an operation.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> disc = rsym.disc(sp.Symbol("r"), letters={"r": 2, LENGTH: 1})
    >>> print([name for name, _ in distance_program(disc, ["r"]).outputs])
    ['distance', 'by r']
    """
    form = shape_form(shape)
    b, known = form.builder, dict[tuple[int, str], int]()
    later = b.mul(b.const(Fraction(SAME)), b.input(LENGTH))
    rows = []
    for number, leaf in enumerate(form.leaves):
        one, is_end = FirstOrder(b, leaf), number in form.ends
        order = b.add(one.distance, later) if is_end else one.distance
        rows.append((order, one.distance, b.const(is_end), *(one.by(letter, known) for letter in letters)))

    def join(gate: Gate, one: tuple[int, ...], other: tuple[int, ...]) -> tuple[int, ...]:
        f, g = one[0], other[0]
        first, second = (other, one) if gate.operation == "min" else (one, other)
        chosen = [b.select(f, g, u, v) for u, v in zip(first[2:], second[2:], strict=True)]
        return (b.make(gate.operation, f, g), b.make(gate.operation, one[1], other[1]), *chosen)

    _, distance, ends, *slopes = through(form.gates, rows, join)[-1]
    found = b.select(ends, b.const(0), b.undefined(), distance) if form.ends else distance
    return b.program(dict(zip((DISTANCE, *map(by, letters)), (found, *slopes), strict=True)))


def boundary_distances(
    shape: Shape, letters: Sequence[str], points: Floats, length: float, sights: LinesOfSight | None = None
) -> Distances:
    """The distances (n,) of points, or of lines of sight, and their derivatives (n, k), as a function of the letters.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> disc = rsym.disc(sp.Symbol("r"), letters={"r": 2})
    >>> found = boundary_distances(disc, ["r"], np.array([[0.0, 2.0]]), 1e9)
    >>> [one.tolist() for one in found(np.array([2.0]))], found(np.array([2.1]))[0].round(3).tolist()
    ([[0.0], [[1.0]]], [0.103])
    """
    lengthened = shape.replace(letters={**shape.letters, LENGTH: length})

    def compiled(names: Sequence[str]) -> Kernel:
        program = distance_program(lengthened, names)
        return compile_program(program, tuple(name for name, _ in program.outputs), lengthened)

    if sights is None:
        kernel = compiled(letters)

        def of_points(values: Floats) -> tuple[Floats, Floats]:
            return _with_slopes(kernel(*points.T, letters=_named(letters, values)), letters)

        return of_points
    names = [symbol.name for symbol in shape.coordinates]
    alone, whole = compiled(()), compiled((*letters, *names))

    def of_lines(values: Floats) -> tuple[Floats, Floats]:
        chosen = _named(letters, values)

        def distance(places: Floats) -> Floats:
            return alone(*np.moveaxis(places, -1, 0), letters=chosen)[DISTANCE]

        t = sights.nearest(distance)
        slopes, along = [], []
        for aside in (-sights.aside, sights.aside):
            fields = whole(*sights.points(t + aside).T, letters=chosen)
            slopes.append(_with_slopes(fields, letters)[1])
            along.append(_with_slopes(fields, names)[1] @ sights.direction)
        with np.errstate(all="ignore"):
            rises = (along[0] > 0) & (along[1] < 0)
            behind = np.where(rises, along[0] / (along[0] - along[1]), 0.5)[:, None]
        return distance(sights.points(t)), (1 - behind) * slopes[0] + behind * slopes[1]

    return of_lines


def _named(letters: Sequence[str], values: Floats) -> dict[str, float]:
    return dict(zip(letters, values.tolist(), strict=True))


def _with_slopes(fields: Mapping[str, Floats], names: Sequence[str]) -> tuple[Floats, Floats]:
    return fields[DISTANCE], np.stack([fields[by(name)] for name in names], axis=1)
