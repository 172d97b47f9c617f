"""Where exactly a suspect point is: Newton's method on the equations that make it one, then a simple fraction."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from rsym.bounds.balls import arb, ctx, exact
from rsym.program.operations import LOGICAL
from rsym.verify.boxes.generators import generators, square_roots
from rsym.verify.boxes.local import PRECISION, Box, Model
from rsym.verify.boxes.resolution import resolve
from rsym.verify.boxes.vanishing import SIMPLE, as_fraction
from rsym.verify.cover.inspection import Inspection

PAIRS = LOGICAL | {"trimming", "gap", "norm", "joining", "equivalence", "atan2", "normalised"}
LOCATED = 320  # bits of the search
STEPS = 300  # a multiple zero halves the error at each step
CONVERGED = 2.0**-120
ROUND = 64  # the largest denominator of a point that is guessed where no equations find it


@dataclass(frozen=True)
class Place:
    """A point where omega vanishes to the working precision, and the pair of nodes whose common zero it is."""

    point: tuple[arb, arb]
    pair: tuple[int, int] | None = None


def places(model: Model, box: Box, finding: Inspection, centre: Sequence[float], radius: float) -> Iterator[Place]:
    """Points within the radius where omega and one pair of equations vanish to the working precision."""
    for pair in _equations(model, box, finding):
        with ctx.workprec(LOCATED):
            point = _newton(model, pair, centre)
            if point is None or _distance(point, centre) > 4 * radius:
                continue
            snapped = (_simple(point[0]), _simple(point[1]))
            found = next((candidate for candidate in (snapped, point) if _vanishes(model, candidate)), None)
        if found is not None:
            yield Place(found, pair)
    with ctx.workprec(LOCATED):
        whole = tuple(Fraction(value).limit_denominator(ROUND) for value in centre)
        candidate = (exact(whole[0]), exact(whole[1]))
        found = candidate if _distance(candidate, centre) <= radius and _vanishes(model, candidate) else None
    if found is not None:
        yield Place(found)


def _vanishes(model: Model, point: tuple[arb, arb]) -> bool:
    value = model.on(point).value(model.root)
    return value is not None and float(abs(value).upper()) < 1e-20


def _equations(model: Model, box: Box, finding: Inspection) -> Iterator[tuple[int, int]]:
    """Pairs of nodes whose common zero may be the point."""
    nodes = model.builder.nodes
    if finding.locus.kind in {"conjunction", "disjunction", "product"}:
        yield finding.locus.nodes[0], finding.locus.nodes[1]
    leaf = finding.locus.nodes[0] if finding.locus.kind == "leaf" else model.root
    with ctx.workprec(PRECISION):
        local = model.over(box)
        found = generators(local, leaf)
    for number in sorted(found.hard):
        operation, arguments, _ = nodes[number]
        roots = square_roots(model.builder, arguments[0]) if operation == "sqrt" else []
        if len(roots) > 1:
            yield roots[0], roots[1]
        elif arguments:
            yield arguments[0], arguments[1] if operation in PAIRS else leaf
    yield from pairwise(found.switches)
    for switch in found.switches:
        for way in (1, -1):
            with ctx.workprec(PRECISION):
                resolved = resolve(local, leaf, switch, way)
            yield switch, resolved
    x, y = model.gradient(leaf)
    yield x, y


def _newton(model: Model, pair: tuple[int, int], start: Sequence[float]) -> tuple[arb, arb] | None:
    point = (arb(start[0]), arb(start[1]))
    slopes = [model.gradient(number) for number in pair]
    for _ in range(STEPS):
        at = model.on(point)
        found = [at.value(number) for number in (*pair, *slopes[0], *slopes[1])]
        if any(value is None or not value.is_finite() for value in found):
            return None
        f, g, a, b, c, d = (value.mid() for value in found if value is not None)
        if f == 0 and g == 0:
            return point
        determinant = (a * d - b * c).mid()
        if determinant == 0:
            return None
        step = (((d * f - b * g) / determinant).mid(), ((a * g - c * f) / determinant).mid())
        point = ((point[0] - step[0]).mid(), (point[1] - step[1]).mid())
        if all(abs(change) < CONVERGED for change in step):
            return point
    return None


def _distance(point: tuple[arb, arb], centre: Sequence[float]) -> float:
    return max(abs(float(point[k]) - centre[k]) for k in range(2))


def _simple(value: arb) -> arb:
    """The simple fraction that a number agrees with, if there is one."""
    fraction = as_fraction(value).limit_denominator(SIMPLE)
    return exact(fraction) if abs(as_fraction(value) - fraction) < Fraction(CONVERGED) * 4 else value
