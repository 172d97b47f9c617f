"""The moves "rho" and "pasko": an edge where two definitions meet is replaced by a blend."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

import sympy as sp

from rsym.model.blends.displacement import Displacement
from rsym.model.blends.rho import CircularOperation, Rho
from rsym.model.rnodes import R0mOperation, R0Operation, R1Operation, RAlphaOperation, ROperation
from rsym.model.shape import Shape
from rsym.model.systems import R0
from rsym.verify.repair.anatomy import Anatomy, Culprit, Point, Verdict, anatomy, troubles
from rsym.verify.repair.moves import (
    ROUNDS,
    Move,
    MoveFamily,
    Operation,
    Request,
    changed,
    folded,
    name_of,
    number_text,
    pair_of,
    rounded,
    short,
)


@dataclass(frozen=True)
class Geometry:
    """How two faces meet: the slope of the first, its ratio to that of the second, the product of the unit normals."""

    slope: Fraction
    ratio: Fraction
    cosine: Fraction


Blend: TypeAlias = Callable[[sp.Expr, Fraction, Geometry], Operation]

# Slopes of two definitions that differ by less are taken as one: the fillet is not quite symmetric then.
ALIKE = 0.02
# Faces whose normals have a smaller product meet at right angles; the radius is off by less than this share.
SQUARE = 0.01
# A displacement a0/(1 + (f**2 + g**2)/rho**2) with a0 = rho/5 is as deep between perpendicular planes as the circle
# of radius rho: there f = g = (1 - 1/sqrt(2))*rho, and (2 - sqrt(2))*f = 0.172*rho = a0/1.172.
DEPTH = Fraction(1, 5)
NAMED = 2  # edges
STEEPEST = Fraction(99, 100)  # of the product of normals: beyond it faces hardly part


class RhoBlend(Move):
    """A conjunction or disjunction is replaced by its cubic rho-blend: G2, the boundary outside a tube not moved.

    A circular blend becomes the cubic one of the same radius. What is no edge, a tip, is rounded.
    """

    name = "rho"

    def families(self, request: Request) -> list[MoveFamily]:
        """One family: all edges among the defects."""
        return [MoveFamily(self.name, "cubic rho-blends at the edges", request.scale(), rho_blended, ROUNDS, rounded)]


class PaskoBlend(Move):
    """A conjunction or disjunction is displaced as Pasko and Savchenko do: analytic, the boundary moved everywhere.

    What is no edge, a tip, is rounded.
    """

    name = "pasko"

    def families(self, request: Request) -> list[MoveFamily]:
        """One family: all edges among the defects."""
        return [
            MoveFamily(self.name, "displacement blends at the edges", request.scale(), pasko_blended, ROUNDS, rounded)
        ]


def rho_blended(shape: Shape, report: Verdict, size: Fraction) -> tuple[Shape, str] | None:
    """The shape with cubic rho-blends of a radius at the edges that the verdict finds wrong.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> corner = rsym.Shape(rsym.conjunction(x, 2 * y), (x, y), bounds=((-2, 2), (-2, 2)))
    >>> found = rho_blended(corner, rsym.verify_smoothness(corner), Fraction(1, 10))
    >>> found[0].expression, found[1]
    (conjunction(x, y, system=Rho(1/10, "G2")), 'edge of x and 2*y blended with radius 0.1')
    """
    return _blended(shape, report, size, _rho, "blended with radius")


def pasko_blended(shape: Shape, report: Verdict, size: Fraction) -> tuple[Shape, str] | None:
    """The shape with displacement blends at the edges that the verdict finds wrong.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> corner = rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=((-2, 2), (-2, 2)))
    >>> found = pasko_blended(corner, rsym.verify_smoothness(corner), Fraction(1, 10))
    >>> found[0].expression, found[1]
    (displacement(-1/50, 1/10, 1/10, x, y) + conjunction(x, y), 'edge of x and y displaced within 0.1')
    """
    return _blended(shape, report, size, _pasko, "displaced within")


def _blended(shape: Shape, report: Verdict, size: Fraction, blend: Blend, verb: str) -> tuple[Shape, str] | None:
    body, culprits = anatomy(shape, troubles(report, shape))
    logic = _logic(body.shape.expression)
    levels: dict[sp.Expr, dict[int, Operation]] = {}
    edges: dict[str, list[str]] = {}
    for culprit in culprits:
        part = culprit.part
        fillet = isinstance(part, CircularOperation)
        if not _replaceable(part, part in logic) or (fillet and blend is not _rho):
            continue
        faces = pair_of(part, culprit.level)
        levels.setdefault(part, {})[max(culprit.level, 2)] = blend(part, size, _geometry(body, culprit, faces))
        what = f"made cubic, radius {part.parameters[0]} kept" if fillet else f"{verb} {number_text(size)}"
        pairs = (" and ".join(_face(body, face, point) for face in faces) for point in culprit.points)
        edges.setdefault(what, []).extend(pairs)
    if not levels:
        return None
    changes = {part: _refolding(operations) for part, operations in levels.items()}
    return changed(body.shape, changes), "; ".join(
        _edges(list(dict.fromkeys(found)), what) for what, found in edges.items()
    )


def _edges(pairs: list[str], what: str) -> str:
    """The edges of which something is said, the first few by name.

    Examples
    --------
    >>> _edges(["a and b", "b and c", "c and d"], "blended")
    'edges of a and b, b and c and 1 more blended'
    """
    if len(pairs) == 1:
        return f"edge of {pairs[0]} {what}"
    more = f" and {len(pairs) - NAMED} more" if len(pairs) > NAMED else ""
    return f"edges of {', '.join(pairs[:NAMED])}{more} {what}"


def _face(body: Anatomy, face: sp.Expr, point: Point) -> str:
    """The name of a face: of operands combined before, that of the one which vanishes."""
    while isinstance(face, ROperation) and all(face != part for _, part in body.shape.parts):
        face = min(face.operands, key=lambda operand: abs(body.value(operand, point)))
    return name_of(body.shape, face)


def _refolding(operations: Mapping[int, Operation]) -> Callable[[sp.Expr], sp.Expr]:
    return lambda new: folded(new, operations)


def _logic(root: sp.Expr) -> set[sp.Expr]:
    """The parts of which the root takes nothing but the sign."""
    found: set[sp.Expr] = set()
    stack = [root]
    while stack:
        part = stack.pop()
        if part in found:
            continue
        found.add(part)
        if isinstance(part, ROperation):
            stack.extend(part.operands)
        elif isinstance(part, sp.Max | sp.Min):
            stack.extend(part.args)
        elif part.is_Mul and len(part.args) == 2 and part.args[0].is_Number:
            stack.append(part.args[1])
    return found


def _replaceable(part: sp.Expr, logical: bool) -> bool:
    """Whether a blend may take the place of a part: those of R_0 have its values, others need but their sign kept."""
    if isinstance(part, CircularOperation):
        return True
    if isinstance(part, R0Operation) and not isinstance(part, R0mOperation):
        return True
    pairs = isinstance(part, sp.Max | sp.Min) and len(part.args) == 2
    return logical and (pairs or isinstance(part, R1Operation | RAlphaOperation))


def _geometry(body: Anatomy, culprit: Culprit, faces: tuple[sp.Expr, sp.Expr]) -> Geometry:
    """The slopes of both faces and the product of their unit normals, as short numbers."""
    first, second = (body.gradient(face, culprit.point) for face in faces)
    lengths = math.hypot(*first), math.hypot(*second)
    if not all(0 < length < math.inf for length in lengths):
        return Geometry(Fraction(1), Fraction(1), Fraction(0))
    product = math.fsum(a * b for a, b in zip(first, second, strict=True)) / math.prod(lengths)
    cosine = 0 if abs(product) < SQUARE else max(-STEEPEST, min(STEEPEST, round(Fraction(product), 2)))
    slope = _simple(lengths[0])
    ratio = Fraction(1) if abs(lengths[0] / lengths[1] - 1) < ALIKE else _simple(lengths[0] / lengths[1])
    return Geometry(slope, ratio, Fraction(cosine))


def _simple(value: float) -> Fraction:
    return Fraction(1) if abs(value - 1) < ALIKE else short(value)


def _rho(part: sp.Expr, size: Fraction, geometry: Geometry) -> Operation:
    if isinstance(part, CircularOperation):
        radius, cosine, ratio = *part.parameters, sp.S.One
    else:
        radius, cosine, ratio = map(sp.Rational, (size * geometry.slope, geometry.cosine, geometry.ratio))
    system = Rho(radius, "G2", cosine=cosine)
    operation = system.conjunction if _joins(part) else system.disjunction
    return lambda f, g: operation(f, _times(ratio, g))


def _pasko(part: sp.Expr, size: Fraction, geometry: Geometry) -> Operation:
    reach, ratio = sp.Rational(size * geometry.slope), sp.Rational(geometry.ratio)
    height = sp.Rational(DEPTH) * reach
    operation, sign = (R0.conjunction, -1) if _joins(part) else (R0.disjunction, 1)

    def displaced(f: sp.Expr, g: sp.Expr) -> sp.Expr:
        scaled = _times(ratio, g)
        return operation(f, scaled) + Displacement(sign * height, reach, reach, f, scaled)

    return displaced


def _times(ratio: sp.Expr, g: sp.Expr) -> sp.Expr:
    """A multiple of a face that leaves it whole: a name may belong to it."""
    return sp.Mul(ratio, g, evaluate=False) if g.is_Add and ratio != 1 else ratio * g


def _joins(part: sp.Expr) -> bool:
    """Whether a part is a conjunction."""
    return isinstance(part, sp.Min) or (isinstance(part, ROperation) and part.sign < 0)
