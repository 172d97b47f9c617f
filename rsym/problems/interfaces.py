"""Interfaces: where inside a shape coefficients of an equation jump or have kinks.

Where a coefficient is one smooth function for f > 0 and another for f < 0, so is a solution, and as both of its sides
agree where f = 0 it is s + abs(f)*w with smooth s and w. So beside splines there are some times abs(f), of wider cells
(`systems.families`), and the rule of integration ends and begins where f = 0. Where interfaces meet one another, turn
sharply, or run askew into the boundary, solutions are not smooth on either side.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.relational import Relational

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError
from rsym.logic.inside import inside_kernel
from rsym.logic.sign_form import shape_builder, shape_form
from rsym.model.operations import conjunction
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import postorder
from rsym.problems.pointwise import PointFormulas, compiled, with_derivatives
from rsym.problems.seams.atoms import SignAtoms, atoms_of
from rsym.problems.splines.cardinals import multiplied
from rsym.program.lowering import lower_all
from rsym.reports.numbers import short
from rsym.sampling.windows import bounds_or_extent

STEPS = (sp.floor, sp.ceiling)
PLACES = {2: 96, 3: 24}  # cells along the longest side of a box in which functions are looked at for their signs
# Steps of Newton's method from the middle of a cell to where two functions are zero, by so many cells at most: where
# they touch a step halves the way, and their values are its square.
NEWTON, FAR = 20, 4
FLAT = 8.0  # cells, over the longest side: of the usual gradient on an interface there is less next to a node
ON, BESIDE = 1e-9, 1e-6  # of the size of a shape: rounding, and how far away the inside is looked for
ASKEW = 1e-6  # the cosine between a boundary and what meets it at a right angle, for rounded formulas

WAYS, SEED = 32, 5  # in which it is looked for
PRINTED = 4  # digits of places, of the size of a shape


@dataclass(frozen=True, eq=False)
class Interfaces:
    """Functions of the coordinates and letters of a shape, each zero on curves inside where solutions have kinks.

    doubts : why solutions may be less smooth than these tell.
    power : the order of the highest derivatives that are integrated: those below it do not jump.

    Examples
    --------
    >>> import rsym, sympy
    >>> from rsym import x, y
    >>> plate = rsym.rectangle(2, 1)
    >>> found = interfaces_of(plate, [sympy.Piecewise((1, 3 * x < 1), (10, x < 5), (3, True))])
    >>> found.functions, found.doubts
    ((x - 1/3,), ())
    >>> interfaces_of(plate, [abs(x - 2 * y)]).doubts
    ('an interface runs askew into the boundary at (-1, -0.5)',)
    """

    shape: Shape | None = None
    functions: tuple[sp.Expr, ...] = ()
    doubts: tuple[str, ...] = ()
    power: int = 1

    def __getstate__(self) -> dict[str, Any]:
        """What was compiled is made again."""
        return {name: self.__dict__[name] for name in self.__dataclass_fields__}

    def weights(self, weight: Floats, points: Floats, order: int) -> Floats:
        """The derivatives (families, kinds, n) of a weight, of which those (kinds, n) are known, and it times folds.

        These are sign(f)*f**power; on an interface their derivatives are those of the side where f is positive.
        """
        if not self.functions:
            return weight[None]
        found = self._jets(order)(points).reshape(len(self.functions), 1 + len(weight), len(points))
        folds = found[:, 1:] * np.where(found[:, :1] >= 0, 1.0, -1.0)
        return np.stack([weight, *(multiplied(weight, one, points.shape[1], order) for one in folds)])

    def _jets(self, order: int) -> PointFormulas:
        if order not in self._made:
            assert self.shape is not None
            builder = shape_builder(self.shape)
            every: dict[str, int] = {}
            for k, node in enumerate(lower_all(builder, self.functions)):
                fold = {f"{k}": builder.powi(node, self.power)}
                every |= {f"f {k}": node, **with_derivatives(builder, fold, builder.coordinates, order)}
            self._made[order] = compiled(self.shape, builder, every)
        return self._made[order]

    @cached_property
    def _made(self) -> dict[int, PointFormulas]:
        return {}


NO_INTERFACES = Interfaces()


def interfaces_of(shape: Shape, expressions: Sequence[sp.Expr], power: int = 1) -> Interfaces:
    """The interfaces of coefficients: zeros inside of what their conditions, maxima and absolute values are of."""
    kinks = kinks_in(expressions)
    stepped = any(isinstance(part, STEPS) for part in postorder(*expressions))
    doubts = ["where a floor or a ceiling jumps is not looked for"] if stepped else []
    if not kinks:
        return Interfaces(doubts=tuple(doubts))
    box = bounds_or_extent(shape, None)
    exact = tuple((sp.Float(low), sp.Float(high)) for low, high in box)
    try:
        field = conjunction(*kinks) if len(kinks) > 1 else kinks[0]
        atoms = atoms_of(Shape(field, shape.coordinates, letters=shape.letters, bounds=exact))
    except RsymError as error:
        return Interfaces(doubts=(*doubts, error.message))
    cells = _Cells(shape, box, atoms)
    inner = [k for k in range(atoms.count) if cells.crossed[k]]
    unsure = [k for k in range(atoms.count) if not cells.crossed[k] and cells.open[k].any()]
    doubts += [f"whether {atoms.functions[k]} is zero inside is not known" for k in unsure]
    return Interfaces(shape, tuple(atoms.functions[k] for k in inner), (*doubts, *cells.doubts(inner)), power)


def kinks_in(expressions: Sequence[sp.Expr]) -> list[sp.Expr]:
    """The functions on whose zeros formulas may jump or have kinks; of what only the sign counts no kinks are.

    Examples
    --------
    >>> from rsym import x, y
    >>> kinks_in([sp.Piecewise((1, abs(x) < y), (2, True)) + abs(x), sp.Max(y, 3)])
    [x, y - Abs(x), 3 - y]
    """
    found: dict[sp.Expr, None] = {}
    seen: set[sp.Basic] = set()
    left: list[sp.Basic] = [*reversed(expressions)]
    while left:
        part = left.pop()
        if part in seen:
            continue
        seen.add(part)
        if isinstance(part, Relational):
            found[part.lhs - part.rhs] = None
        elif isinstance(part, sp.sign | sp.Heaviside):
            found[part.args[0]] = None
        else:
            left += reversed(part.args)
        if isinstance(part, sp.Abs):
            found[part.args[0]] = None
        elif isinstance(part, sp.Max | sp.Min):
            found.update((other - one, None) for k, one in enumerate(part.args) for other in part.args[:k])
    return list(found)


class _Cells:
    """The cells of a lattice whose middles are inside, and of atoms where they are `open` and which have `crossed`."""

    def __init__(self, shape: Shape, box: Bounds, atoms: SignAtoms) -> None:
        low, high = np.array(box, float).T
        self._shape, self._functions, self._size = shape, atoms.functions, float((high - low).max())
        self._step = step = self._size / PLACES[shape.dimension]
        axes = [np.arange(a + step / 2, b, step) for a, b in zip(low, high, strict=True)]
        middles = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, shape.dimension)
        self._form, self._inside = shape_form(shape), inside_kernel(shape)
        self._middles = middles[self._inside(*middles.T)["value"] > 0]
        self.open: Flags = np.equal(atoms.over(self._middles - step / 2, self._middles + step / 2), 0)
        signs = atoms.signs(self._middles)
        self.crossed: Flags = np.logical_and((signs > 0).any(axis=1), (signs < 0).any(axis=1))

    @cached_property
    def _jets(self) -> PointFormulas:
        """The values and gradients of the atoms, then of the leaves of the shape."""
        builder = self._form.builder
        nodes = [*lower_all(builder, self._functions), *self._form.leaves]
        named = {f"{k}": node for k, node in enumerate(nodes)}
        return compiled(self._shape, builder, with_derivatives(builder, named, builder.coordinates, 1))

    def doubts(self, inner: Sequence[int]) -> list[str]:
        """Where some atoms are zero together, or one of them and a leaf not at a right angle, or one is singular."""
        found: dict[str, None] = {}
        count = len(self._functions)
        leaves = range(count, count + len(self._form.leaves))
        for number, one in enumerate(inner):
            start = self._middles[self.open[one]]
            steep = np.linalg.norm(self._pair(one, one, start)[1][0], axis=1)
            flat = steep <= FLAT * self._step / self._size * np.median(steep)
            self._tell(found, "an interface has a node, or nearly, near", start[flat])
            for other in (*inner[number + 1 :], *leaves):
                points, cosines = self._meeting(one, other, start)
                if other < count:
                    self._tell(found, "interfaces meet at", points)
                else:
                    self._tell(found, "an interface runs askew into the boundary at", points[cosines > ASKEW])
        return [*found]

    def _tell(self, found: dict[str, None], what: str, points: Floats) -> None:
        """Add what there is at the first of some points, if there are any."""
        if len(points):
            place = np.round(points[0], PRINTED - math.floor(math.log10(self._size))) + 0.0
            found[f"{what} ({', '.join(short(float(value)) for value in place)})"] = None

    def _meeting(self, one: int, other: int, points: Floats) -> tuple[Floats, Floats]:
        """Points of the shape where two functions are zero, and there the cosine between their gradients."""
        for _ in range(NEWTON):
            values, slopes = self._pair(one, other, points)
            squares = np.einsum("aik,bik->iab", slopes, slopes)
            with np.errstate(all="ignore"):
                det = squares[:, 0, 0] * squares[:, 1, 1] - squares[:, 0, 1] ** 2
                inverse = np.array([[squares[:, 1, 1], -squares[:, 0, 1]], [-squares[:, 0, 1], squares[:, 0, 0]]]) / det
                step = np.einsum("abi,bi,aik->ik", inverse, values, slopes)
                near = np.linalg.norm(step, axis=1) <= FAR * self._step  # false of none
            # Where they touch what is left of rounding is no step.
            there = self._zero(values, slopes)
            points = np.where(there[:, None], points, points - step)[near | there]
        values, slopes = self._pair(one, other, points)
        lengths = np.linalg.norm(slopes, axis=2)
        met = self._zero(values, slopes) & self._on_shape(points)
        cosines = np.abs(np.einsum("ik,ik->i", slopes[0], slopes[1])) / lengths.prod(axis=0)
        order = np.lexsort(points[met].T)
        return points[met][order], cosines[met][order]

    def _zero(self, values: Floats, slopes: Floats) -> Flags:
        found: Flags = np.less_equal(np.abs(values), ON * self._size * np.linalg.norm(slopes, axis=2)).all(axis=0)
        return found

    def _pair(self, one: int, other: int, points: Floats) -> tuple[Floats, Floats]:
        """The values (2, n) and gradients (2, n, dimension) of two functions."""
        count = len(self._functions) + len(self._form.leaves)
        found = self._jets(np.ascontiguousarray(points)).reshape(count, 1 + points.shape[1], len(points))[[one, other]]
        return found[:, 0], found[:, 1:].transpose(0, 2, 1)

    def _on_shape(self, points: Floats) -> Flags:
        """Which points are inside or on the boundary: there is something inside next to them."""
        ways = np.random.default_rng(SEED).standard_normal((WAYS, points.shape[1]))
        near = points[:, None] + BESIDE * self._size * ways
        values = self._inside(*near.reshape(-1, points.shape[1]).T)["value"].reshape(near.shape[:2])
        found: Flags = np.greater(values, 0).any(axis=1)
        return found
