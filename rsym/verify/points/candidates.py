"""Where a singular point can be: three equations for each way to be one, solved by Newton's method, then proved.

A corner of three leaves; the place where the squares under a root vanish; a zero of the gradient of a leaf; a point
where two leaves touch, which is a critical point of one on the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, islice
from typing import NamedTuple, TypeAlias

from flint import arb_mat

from rsym.bounds.balls import arb, ctx, exact
from rsym.verify.boxes.generators import generators, square_roots
from rsym.verify.boxes.krawczyk import common_zero, narrowed
from rsym.verify.boxes.local import PRECISION, Local, Model
from rsym.verify.boxes.resolution import put
from rsym.verify.boxes.sheets import Sheets
from rsym.verify.boxes.vanishing import SIMPLE as SIMPLEST
from rsym.verify.boxes.vanishing import as_fraction
from rsym.verify.points.locating import CONVERGED, LOCATED, PAIRS, STEPS
from rsym.verify.points.rays import exact_at

Point: TypeAlias = tuple[arb, ...]

TRIPLES = 12  # of leaves: a pyramid of six sides has twenty, of which one will do
PINNED = 2.0**-90  # half the width of the box in which the equations must have just one zero
SMALLEST = 1e-12  # of a value that may be zero at a point that was found


class Equations(NamedTuple):
    """Three nodes whose common zero is sought, and pairs of nodes: where the first vanishes too, the second does."""

    nodes: tuple[int, int, int]
    implied: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True)
class ZeroPlace:
    """A point where omega vanishes to the working precision.

    `coordinates` are exact where they are simple fractions; `zeros`, the nodes proved to vanish, are those whose only
    common zero it is, or none where nothing is proved; `proved` says whether the point is known at all.
    """

    point: Point
    coordinates: Mapping[str, Fraction | None]
    zeros: frozenset[int]
    proved: bool


def places(model: Model, local: Local, found: Sheets, centre: Sequence[float], reach: float) -> Iterator[ZeroPlace]:
    """Points within the reach of the centre that satisfy some equations, the sheets being known on a box around it."""
    seen: list[Point] = []
    for equations in _equations(local, found):
        with ctx.workprec(LOCATED):
            point = _newton(model, equations.nodes, centre)
            if point is None or max(abs(float(p) - c) for p, c in zip(point, centre, strict=True)) > reach:
                continue
            if any(all(abs(p - q) < CONVERGED for p, q in zip(point, other, strict=True)) for other in seen):
                continue
            place = _snapped(model, point) or _pinned(model, point, equations)
            if not _vanishes(model, place.point):
                continue
        seen.append(point)
        yield place


def _vanishes(model: Model, point: Point) -> bool:
    value = model.on(point).value(model.root)
    return value is not None and float(abs(value).upper()) < SMALLEST


def _snapped(model: Model, point: Point) -> ZeroPlace | None:
    """The simple fractions that the coordinates agree with, if all do."""
    fractions = [as_fraction(part).limit_denominator(SIMPLEST) for part in point]
    if any(
        abs(as_fraction(part) - fraction) > 4 * Fraction(CONVERGED)
        for part, fraction in zip(point, fractions, strict=True)
    ):
        return None
    coordinates = dict(zip(model.builder.coordinates, fractions, strict=True))
    return ZeroPlace(tuple(exact(fraction) for fraction in fractions), coordinates, frozenset(), True)


def _pinned(model: Model, point: Point, equations: Equations) -> ZeroPlace:
    """The only common zero of the equations in a tiny box, if that is proved."""
    local = model.on([part + arb(0, PINNED) for part in point])
    unknown: dict[str, Fraction | None] = dict.fromkeys(model.builder.coordinates)
    if all(generators(local, number).analytic for number in equations.nodes):
        zero = common_zero(local, equations.nodes)
        if zero is not None and zero.exists:
            point = tuple(narrowed(local, equations.nodes, zero).sides)
            known = exact_at(model, point, unknown, frozenset(equations.nodes))
            implied = (second for first, second in equations.implied if known.vanishes(first))
            return ZeroPlace(point, unknown, frozenset((*equations.nodes, *implied)), True)
    return ZeroPlace(point, unknown, frozenset(), False)


def _newton(model: Model, nodes: Sequence[int], start: Sequence[float]) -> Point | None:
    """Newton's method; a multiple zero halves the error at each step."""
    point = tuple(arb(part) for part in start)
    slopes = [model.gradient(number) for number in nodes]
    for _ in range(STEPS):
        at = model.on(point)
        values = [at.value(number) for number in (*nodes, *(part for row in slopes for part in row))]
        if any(value is None or not value.is_finite() for value in values):
            return None
        middles = [value.mid() for value in values if value is not None]
        if not any(middles[:3]):
            return point
        try:
            step = arb_mat(3, 3, middles[3:]).solve(arb_mat(3, 1, middles[:3])).entries()
        except ZeroDivisionError:
            return None
        point = tuple((part - change).mid() for part, change in zip(point, step, strict=True))
        if not all(part.is_finite() for part in point):
            return None
        if all(abs(change) < CONVERGED for change in step):
            return point
    return None


def _equations(local: Local, found: Sheets) -> Iterator[Equations]:
    """The systems, those first that say most."""
    with ctx.workprec(PRECISION):
        for leaf in found.leaves:
            yield from _of_roots(local, leaf, found.leaves)
        for first, second, third in islice(combinations(found.leaves, 3), TRIPLES):
            yield Equations((first, second, third))
        for f, g in combinations(found.leaves, 2):
            yield _touching(local, f, g)
            yield _touching(local, g, f)
        for leaf in found.leaves:
            x, y, z = local.model.gradient(leaf)
            yield Equations((x, y, z))


def _of_roots(local: Local, leaf: int, leaves: Sequence[int]) -> Iterator[Equations]:
    """What vanishes under the roots of a leaf, and the leaf without them."""
    builder = local.model.builder
    for part in sorted(generators(local, leaf).hard):
        operation, arguments, _ = builder.nodes[part]
        if operation in {"sqrt", "trimming", "gap"}:
            squares = square_roots(builder, arguments[0])
            if operation != "sqrt" and len(squares) == 1:
                squares.append(arguments[1])
        else:
            squares = list(arguments[:2]) if operation in PAIRS else []
        for u, v, w in combinations(squares, 3):
            yield Equations((u, v, w))
        for u, v in combinations(squares, 2):
            rest = put(local.model, leaf, {part: builder.const(0)})
            yield Equations((u, v, rest), ((part, leaf),))
            yield from (Equations((u, v, other)) for other in leaves if other != leaf)


def _touching(local: Local, f: int, g: int) -> Equations:
    """F = 0, and grad f and grad g parallel."""
    sizes = [abs(float(slope.mid())) if slope.is_finite() else 0.0 for slope in local.gradient(f)]
    return Equations((f, *across(local.model, f, g, sizes.index(max(sizes)))))


def across(model: Model, f: int, g: int, k: int) -> tuple[int, int]:
    """The components of grad f x grad g with the component k of grad f: where that is not 0, they decide."""
    b, p, q = model.builder, model.gradient(f), model.gradient(g)
    i, j = (axis for axis in range(3) if axis != k)
    first, second = (b.sub(b.mul(p[k], q[axis]), b.mul(p[axis], q[k])) for axis in (i, j))
    return first, second
