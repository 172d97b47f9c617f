"""The derivatives of a patch on an edge as a program of one parameter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import NamedTuple, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower_all
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.functions.formulas import exact
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.patch import Patch
from rsym.surfaces.proofs.specialised import PARAMETER, NoProof, Part, Specialised
from rsym.surfaces.splitting import PatchPiece

# Position and derivatives (i, j): i times along the edge, j times out of the patch.
ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


class EdgeWalk(NamedTuple):
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
ALONG = EdgeWalk(Fraction(0), Fraction(1))


class EdgeJet(NamedTuple):
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
    >>> edge = PatchEdge(ParametricSurface((u, v, u * v)), "u1")
    >>> target = Builder(("t",), ())
    >>> jet = PatchFormula(edge.patch, {}).jet(edge, target, (Fraction(0), Fraction(1)), EdgeWalk(0, 1))
    >>> [target.nodes[number].operation for number in jet.nodes[:3]]
    ['const', 'input', 'input']
    """

    def __init__(self, patch: Patch, letters: Mapping[str, Fraction]) -> None:
        self.patch, self.letters = patch.patch if isinstance(patch, PatchPiece) else patch, letters
        self._program: tuple[Builder, dict[tuple[int, int], list[int]]] | None = None

    def jet(
        self,
        edge: PatchEdge,
        target: Builder,
        part: Part,
        walk: EdgeWalk,
        orders: Sequence[tuple[int, int]] = ORDERS,
        *,
        literal: bool = False,
    ) -> EdgeJet:
        """The derivatives along t and outwards on a part of the edge, by the common parameter; of other orders zero.

        Where pieces of a formula meet, those that hold inside the part and the patch are taken, or what is `literal`.
        """
        known, notes = self._vectors(edge, target, part, walk, orders, literal=literal)
        outwards = 1 if edge.upper else -1
        zero = [target.const(0)] * 3
        scales = {(i, j): target.const(walk.speed**i * outwards**j) for i, j in ORDERS}
        flat = [target.mul(scale, one) for order, scale in scales.items() for one in known.get(order, zero)]
        return notes._replace(nodes=tuple(flat))

    def third(self, edge: PatchEdge, target: Builder, part: Part, walk: EdgeWalk) -> list[int]:
        """The third derivative across the edge, by the patch's own parameter."""
        if isinstance(self.patch, BSplineSurface):
            raise NoProof("the third derivatives of splines are not asked for")
        builder, known = self.program
        order, before, name = ((3, 0), (2, 0), "u") if edge.across == 0 else ((0, 3), (0, 2), "v")
        if order not in known:
            known[order] = [derivative(builder, one, name) for one in known[before]]
        copy = self._copy(edge, target, part, walk, literal=False)
        return [copy.node(one) for one in known[order]]

    def _copy(self, edge: PatchEdge, target: Builder, part: Part, walk: EdgeWalk, *, literal: bool) -> Specialised:
        """What copies nodes of the whole patch to the edge."""
        builder, _ = self.program
        names = ("u", "v") if edge.across == 0 else ("v", "u")
        letters = {name: target.const(value) for name, value in self.letters.items()}
        inputs = {**letters, names[0]: lower_all(target, [constant_parameter(edge)])[0], names[1]: _place(target, walk)}
        return Specialised(builder, target, inputs, part, (names[0], -1 if edge.upper else 1), literal=literal)

    def _vectors(
        self,
        edge: PatchEdge,
        target: Builder,
        part: Part,
        walk: EdgeWalk,
        orders: Sequence[tuple[int, int]],
        *,
        literal: bool,
    ) -> tuple[dict[tuple[int, int], list[int]], EdgeJet]:
        """The derivatives by the patch's own parameters, and the borders of pieces."""
        if isinstance(self.patch, BSplineSurface):
            place = _place(target, walk)
            ends = sorted([walk(part[0]), walk(part[1])])
            vectors, knots = spline_jet(self.patch, edge, (ends[0], ends[1]))
            found = {order: [_horner(target, one, place) for one in vectors[order]] for order in orders}
            return found, EdgeJet((), frozenset(map(walk.inverse, knots)))
        _, known = self.program
        copy = self._copy(edge, target, part, walk, literal=literal)
        turned = {order: known[order[::-1] if edge.across == 0 else order] for order in orders}
        found = {order: [copy.node(one) for one in vector] for order, vector in turned.items()}
        return found, EdgeJet((), frozenset(copy.borders), frozenset(copy.joins), copy.lies_on_border)

    @property
    def program(self) -> tuple[Builder, dict[tuple[int, int], list[int]]]:
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


def constant_parameter(edge: PatchEdge) -> sp.Expr:
    """The constant parameter of an edge, exactly: a turn as 2 pi if it was given so."""
    patch, side = edge.patch, int(edge.upper)
    if isinstance(patch, ParametricSurface) and not patch.ends[edge.across][side].has(sp.Float):
        return patch.ends[edge.across][side]
    return exact(patch.domain[edge.across][side])


def _place(target: Builder, walk: EdgeWalk) -> int:
    parameter = target.input(PARAMETER)
    return target.add(target.const(walk.start), target.mul(target.const(walk.speed), parameter))


def _horner(target: Builder, coefficients: list[Fraction], place: int) -> int:
    """The polynomial with these coefficients, the lowest first."""
    total = target.const(0)
    for coefficient in reversed(coefficients):
        total = target.add(target.mul(total, place), target.const(coefficient))
    return total


# Edges of B-spline surfaces as polynomials with rational coefficients, span by span.
# Coefficients of the powers of the parameter, the lowest first.
Polynomial: TypeAlias = list[Fraction]
ONE, NONE = Fraction(1), Fraction(0)


def spline_jet(
    surface: BSplineSurface, edge: PatchEdge, part: Part
) -> tuple[dict[tuple[int, int], list[Polynomial]], list[Fraction]]:
    """Three polynomials of the parameter along the edge for each order (along, across), and the knots inside the part.

    The polynomials are those of the span in the middle of the part. Derivatives across are towards growing u or v.

    Examples
    --------
    >>> net = [[[i, j, i * j] for j in range(3)] for i in range(3)]
    >>> surface = BSplineSurface(net, order=(3, 3))
    >>> vectors, knots = spline_jet(surface, PatchEdge(surface, "u1"), (NONE, ONE))
    >>> [[str(c) for c in one] for one in vectors[0, 0]], knots
    ([['2', '0', '0'], ['0', '2', '0'], ['0', '4', '0']], [])
    """
    spaces = surface.spaces if edge.across == 0 else surface.spaces[::-1]
    net = surface.net if edge.across == 0 else surface.net.swapaxes(0, 1)
    knots = [[_fraction(one) for one in space.knots] for space in spaces]
    end = _fraction(edge.patch.domain[edge.across][int(edge.upper)])
    first, fixed = _pieces(knots[0], spaces[0].degree, end, edge.upper)
    second, moving = _pieces(knots[1], spaces[1].degree, (part[0] + part[1]) / 2, False)
    used = [[[_fraction(x) for x in net[i % len(net), j % net.shape[1]]] for j in second] for i in first]
    vectors = {}
    for i, j in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        across = [_at(_differentiated(one, j), end) for one in fixed]
        along = [_differentiated(one, i) for one in moving]
        vectors[i, j] = [_combined(across, along, [[cell[axis] for cell in row] for row in used]) for axis in range(3)]
    inner = sorted({one for one in knots[1] if part[0] < one < part[1]})
    return vectors, inner


def _fraction(value: float) -> Fraction:
    return Fraction(str(exact(value)))


def _pieces(knots: list[Fraction], degree: int, place: Fraction, before: bool) -> tuple[range, list[Polynomial]]:
    """Numbers and polynomials of the basis functions on the span round a place, or before it."""
    spans = [k for k in range(len(knots) - 1) if knots[k] < knots[k + 1]]
    before = before or place == knots[-degree - 1]
    inside = [k for k in spans if (knots[k] < place <= knots[k + 1] if before else knots[k] <= place < knots[k + 1])]
    span = inside[0]
    known: dict[int, Polynomial] = {span: [ONE]}
    for k in range(1, degree + 1):
        raised: dict[int, Polynomial] = {}
        for i in range(span - k, span + 1):
            rising = _ramp(known.get(i), knots[i], knots[i + k])
            falling = _ramp(known.get(i + 1), knots[i + k + 1], knots[i + 1])
            raised[i] = [a + b for a, b in zip(_padded(rising, k + 1), _padded(falling, k + 1), strict=True)]
        known = raised
    numbers = range(span - degree, span + 1)
    return numbers, [known[i] for i in numbers]


def _ramp(function: Polynomial | None, zero: Fraction, end: Fraction) -> Polynomial:
    """A function times (t - zero)/(end - zero), none where the knots coincide."""
    if function is None or end == zero:
        return []
    scale = ONE / (end - zero)
    shifted = [NONE, *function]
    return [scale * (a - zero * b) for a, b in zip(shifted, _padded(function, len(shifted)), strict=True)]


def _padded(coefficients: Polynomial, length: int) -> Polynomial:
    return [*coefficients, *[NONE] * (length - len(coefficients))]


def _differentiated(coefficients: Polynomial, times: int) -> Polynomial:
    for _ in range(times):
        coefficients = [k * c for k, c in enumerate(coefficients)][1:] or [NONE]
    return coefficients


def _at(coefficients: Polynomial, place: Fraction) -> Fraction:
    total = NONE
    for coefficient in reversed(coefficients):
        total = total * place + coefficient
    return total


def _combined(across: list[Fraction], along: list[Polynomial], vertices: list[list[Fraction]]) -> Polynomial:
    """The sum of vertices times numbers times polynomials."""
    weights = [sum((a * row[j] for a, row in zip(across, vertices, strict=True)), NONE) for j in range(len(along))]
    length = max(map(len, along))
    rows = [_padded(one, length) for one in along]
    return [sum((w * row[k] for w, row in zip(weights, rows, strict=True)), NONE) for k in range(length)]
