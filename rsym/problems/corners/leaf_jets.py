"""Leaves of a plane shape with their derivatives to the second, at points, and what bends them beside a corner."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from rsym.arrays import Floats
from rsym.backends.kernel import Kernel, compile_program, run_in_blocks
from rsym.logic.sign_form import SignForm, shape_form
from rsym.model.recent import recently, written
from rsym.model.shape import Shape
from rsym.problems.splines.cardinals import multiplied
from rsym.program.differentiation import derivative

FEW = 12  # leaves that are compiled; a tape takes twice as long at each point


class StraightEdge(NamedTuple):
    """A linear function in place of a leaf: 0 at a point, and its slope."""

    point: tuple[float, float]
    slope: tuple[float, float]


class Bend(NamedTuple):
    """A factor of a leaf about a point d away: 1 + s/sqrt(1 + 4 s^2), s = slope . d, between 1/2 and 3/2."""

    point: tuple[float, float]
    slope: tuple[float, float]

    def at(self, places: Floats) -> Floats:
        """Its derivatives (6, n) at points (n, 2), as those of leaves."""
        slope = np.array(self.slope)
        s = (places - self.point) @ slope
        root = 1 / np.sqrt(1 + 4 * s * s)
        first, second = root**3, -12 * s * root**5
        (p, q) = slope
        return np.stack([1 + s * root, p * first, q * first, p * p * second, p * q * second, q * q * second])


@dataclass(frozen=True)
class LeafJets:
    """Some leaves of a shape, by their numbers, with letters.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> jets = leaf_jets(rsym.Shape(rsym.conjunction(x, 5 - x * y**2), (x, y)), (1,))
    >>> jets.at(np.array([[1.0, 2.0]])).ravel().tolist()
    [1.0, -4.0, -4.0, 0.0, -4.0, -2.0]
    """

    kernel: Kernel
    rows: tuple[int, ...]
    letters: Mapping[str, float]
    lines: tuple[StraightEdge | None, ...] = ()
    bends: tuple[Bend, ...] = ()

    def at(self, places: Floats) -> Floats:
        """Value, both first and the three second derivatives xx, xy, yy at points (n, 2): (leaves, 6, n)."""
        program = self.kernel.program
        out = np.empty((len(program.outputs), len(places)))
        given = [self.letters[name] for name in program.letters]
        run_in_blocks(self.kernel.function, list(np.ascontiguousarray(places.T)), given, out, self.kernel.threads)
        found: Floats = out.reshape(-1, 6, len(places))[list(self.rows)]
        for row, line in zip(found, self.lines, strict=False):
            if line is not None:
                slope = np.array(line.slope)
                row[:] = 0.0
                row[0] = (places - line.point) @ slope
                row[1:3] = slope[:, None]
        for row, bend in zip(found, self.bends, strict=False):
            row[:] = multiplied(row, bend.at(places), 2, 2)
        return found


def leaf_jets(
    shape: Shape,
    leaves: Sequence[int],
    letters: Mapping[Any, float] | None = None,
    lines: Sequence[StraightEdge | None] = (),
) -> LeafJets:
    """Some leaves of ``shape_form(shape)``, or what stands for them; other letters need no compilation."""
    own = sorted(set(leaves))
    rows = tuple(own.index(leaf) for leaf in leaves)
    return LeafJets(_kernel(shape, tuple(own)), rows, shape.letters.values_with(letters), tuple(lines))


@recently(8, written)
def _form(shape: Shape) -> SignForm:
    return shape_form(shape)


@recently(64, written)
def _kernel(shape: Shape, leaves: tuple[int, ...]) -> Kernel:
    form = _form(shape)
    b = form.builder
    outputs = {}
    for k, number in enumerate(leaves):
        leaf = form.leaves[number]
        first = [derivative(b, leaf, name) for name in b.coordinates]
        second = [derivative(b, first[i], b.coordinates[j]) for i, j in ((0, 0), (0, 1), (1, 1))]
        outputs.update({f"{k} {part}": node for part, node in enumerate((leaf, *first, *second))})
    backend = None if len(form.leaves) <= FEW else "tape"
    return compile_program(b.program(outputs), (), shape, backend=backend, threads=1)
