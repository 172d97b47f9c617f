"""The derivatives of a patch on an edge as a program of one parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple

import sympy as sp

from rsym.errors import RsymError
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower_all
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.functions.entries import exact
from rsym.surfaces.joints.edges import Edge
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.patch import Patch
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part, Specialised
from rsym.surfaces.proofs.spline_edges import spline_jet
from rsym.surfaces.splitting import PatchPiece

# Position and derivatives (i, j): i times along the edge, j times out of the patch.
ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


class Walk(NamedTuple):
    """The parameter of an edge as a function of the common one: start + speed t."""

    start: Fraction
    speed: Fraction

    def __call__(self, t: Fraction) -> Fraction:
        """The place on the edge at the common parameter t."""
        return self.start + self.speed * t

    def inverse(self, s: Fraction) -> Fraction:
        """The common parameter of a place of the edge."""
        return (s - self.start) / self.speed


# The edge as it is.
ALONG = Walk(Fraction(0), Fraction(1))


class Jet(NamedTuple):
    """Nodes of the target, three for each of `ORDERS`, and where on the part other formulas begin.

    joins : where a comparison of the formula has equal sides; lies_on_border : whether one has so all along.
    """

    nodes: tuple[int, ...]
    borders: frozenset[Fraction]
    joins: frozenset[Fraction] = frozenset()
    lies_on_border: bool = False


class PatchFormula:
    """A patch and its derivatives to the second order as one program of u and v.

    The formula is that of `Patch.expression`: floats in the data stand for the shortest decimals that they are
    written as, letters for the exact values of the floats that they have.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> edge = Edge(ParametricSurface((u, v, u * v)), "u1")
    >>> target = Builder(("t",), ())
    >>> jet = PatchFormula(edge.patch, {}).jet(edge, target, (Fraction(0), Fraction(1)), Walk(Fraction(0), Fraction(1)))
    >>> [target.nodes[number].operation for number in jet.nodes[:3]]
    ['const', 'input', 'input']
    """

    def __init__(self, patch: Patch, letters: Mapping[str, Fraction]) -> None:
        self.patch, self.letters = patch.patch if isinstance(patch, PatchPiece) else patch, letters
        self._program: tuple[Builder, dict[tuple[int, int], list[int]]] | None = None

    def jet(
        self,
        edge: Edge,
        target: Builder,
        part: Part,
        walk: Walk,
        orders: Sequence[tuple[int, int]] = ORDERS,
        *,
        literal: bool = False,
    ) -> Jet:
        """The derivatives along t and outwards on a part of the edge, by the common parameter; of other orders zero.

        Where pieces of a formula meet, those that hold inside the part and the patch are taken, or what is `literal`.
        """
        known, notes = self._vectors(edge, target, part, walk, orders, literal=literal)
        outwards = 1 if edge.upper else -1
        zero = [target.const(0)] * 3
        scales = {(i, j): target.const(walk.speed**i * outwards**j) for i, j in ORDERS}
        flat = [target.mul(scale, one) for order, scale in scales.items() for one in known.get(order, zero)]
        return notes._replace(nodes=tuple(flat))

    def third(self, edge: Edge, target: Builder, part: Part, walk: Walk) -> list[int]:
        """The third derivative across the edge, by the patch's own parameter."""
        if isinstance(self.patch, BSplineSurface):
            raise NoProof("the third derivatives of splines are not asked for")
        builder, known = self._formulas()
        order, before, name = ((3, 0), (2, 0), "u") if edge.across == 0 else ((0, 3), (0, 2), "v")
        if order not in known:
            known[order] = [derivative(builder, one, name) for one in known[before]]
        copy = self._copy(edge, target, part, walk, literal=False)
        return [copy.node(one) for one in known[order]]

    def _copy(self, edge: Edge, target: Builder, part: Part, walk: Walk, *, literal: bool) -> Specialised:
        """What copies nodes of the whole patch to the edge."""
        builder, _ = self._formulas()
        names = ("u", "v") if edge.across == 0 else ("v", "u")
        letters = {name: target.const(value) for name, value in self.letters.items()}
        inputs = {**letters, names[0]: lower_all(target, [constant_parameter(edge)])[0], names[1]: _place(target, walk)}
        return Specialised(builder, target, inputs, part, (names[0], -1 if edge.upper else 1), literal=literal)

    def _vectors(
        self, edge: Edge, target: Builder, part: Part, walk: Walk, orders: Sequence[tuple[int, int]], *, literal: bool
    ) -> tuple[dict[tuple[int, int], list[int]], Jet]:
        """The derivatives by the patch's own parameters, and the borders of pieces."""
        if isinstance(self.patch, BSplineSurface):
            place = _place(target, walk)
            ends = sorted([walk(part[0]), walk(part[1])])
            vectors, knots = spline_jet(self.patch, edge, (ends[0], ends[1]))
            found = {order: [_horner(target, one, place) for one in vectors[order]] for order in orders}
            return found, Jet((), frozenset(map(walk.inverse, knots)))
        _, known = self._formulas()
        copy = self._copy(edge, target, part, walk, literal=literal)
        turned = {order: known[order[::-1] if edge.across == 0 else order] for order in orders}
        found = {order: [copy.node(one) for one in vector] for order, vector in turned.items()}
        return found, Jet((), frozenset(copy.borders), frozenset(copy.joins), copy.lies_on_border)

    def _formulas(self) -> tuple[Builder, dict[tuple[int, int], list[int]]]:
        """The program of the whole patch and the nodes of its derivatives."""
        if self._program is None:
            builder = Builder(("u", "v"), tuple(self.letters))
            known = {(0, 0): lower_all(builder, formula_of(self.patch))}
            for i, j in ORDERS[1:]:
                before, name = ((i - 1, j), "u") if i else ((i, j - 1), "v")
                known[i, j] = [derivative(builder, one, name) for one in known[before]]
            self._program = builder, known
        return self._program


def formula_of(patch: Patch) -> list[sp.Expr]:
    """The coordinates, of numbers that a program holds exactly.

    Raises
    ------
    NoProof
        The patch is not made of formulas, or of other numbers.
    """
    try:
        point = list(patch.expression())
    except RsymError as error:
        raise NoProof(f"a {type(patch).__name__} that is not made of formulas") from error
    unknown = {one for entry in point for one in entry.atoms(sp.NumberSymbol)} - {sp.pi, sp.E}
    if unknown:
        raise NoProof(f"the number {min(map(str, unknown))} has no exact form in a program")
    return point


def constant_parameter(edge: Edge) -> sp.Expr:
    """The constant parameter of an edge, exactly: a turn as 2 pi if it was given so."""
    patch, side = edge.patch, int(edge.upper)
    if isinstance(patch, ParametricSurface) and not patch.ends[edge.across][side].has(sp.Float):
        return patch.ends[edge.across][side]
    return exact(patch.domain[edge.across][side])


def _place(target: Builder, walk: Walk) -> int:
    parameter = target.input(PARAMETER)
    return target.add(target.const(walk.start), target.mul(target.const(walk.speed), parameter))


def _horner(target: Builder, coefficients: list[Fraction], place: int) -> int:
    """The polynomial with these coefficients, the lowest first."""
    total = target.const(0)
    for coefficient in reversed(coefficients):
        total = target.add(target.mul(total, place), target.const(coefficient))
    return total
