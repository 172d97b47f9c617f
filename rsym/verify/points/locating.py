"""Where exactly a singular point is: Newton's method on the equations that make it one, a simple fraction, a proof.

A zero that the equations have alone in a tiny box is proved by Krawczyk's operator; one whose coordinates agree with
simple fractions is tried there.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, TypeAlias

from flint import arb_mat

from rsym.bounds.balls import arb, ctx, exact
from rsym.program.operations import LOGICAL
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.krawczyk import common_zero, narrowed_zero
from rsym.verify.boxes.local import Model
from rsym.verify.boxes.vanishing import SIMPLE, as_fraction, exact_at

Point: TypeAlias = tuple[arb, ...]

PAIRS = LOGICAL | {"trimming", "gap", "norm", "joining", "equivalence", "atan2", "normalised"}
LOCATED = 320  # bits of the search
STEPS = 300  # a multiple zero halves the error at each step
CONVERGED = 2.0**-120
PINNED = 2.0**-90  # half the width of the box in which the equations must have just one zero


class Equations(NamedTuple):
    """Nodes whose common zero is sought, and pairs of nodes: where the first vanishes there, the second does.

    That holds if some nodes, `nonzero`, do not vanish.
    """

    nodes: tuple[int, ...]
    implied: tuple[tuple[int, int], ...] = ()
    nonzero: tuple[int, ...] = ()


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

    @property
    def exact(self) -> bool:
        """Whether all coordinates are known as fractions."""
        return None not in self.coordinates.values()


def located(
    model: Model, systems: Iterable[Equations], centre: Sequence[float], reach: float, least: float
) -> Iterator[ZeroPlace]:
    """Points within the reach of the centre that satisfy some equations, and where omega is smaller than `least`."""
    seen: list[Point] = []
    for equations in systems:
        with ctx.workprec(LOCATED):
            point = model.remembered(_newton, equations.nodes, tuple(centre))  # many boxes suggest the same
            if point is None or away(point, centre) > reach:
                continue
            if any(all(abs(p - q) < CONVERGED for p, q in zip(point, other, strict=True)) for other in seen):
                continue
            place = snapped(model, point) or _pinned(model, point, equations)
            if not vanishes_at(model, place.point, least):
                continue
        seen.append(point)
        yield place


def away(point: Point, centre: Sequence[float]) -> float:
    """How far a point is from the centre along a coordinate, at most."""
    return max(abs(float(part) - middle) for part, middle in zip(point, centre, strict=True))


def vanishes_at(model: Model, point: Point, least: float) -> bool:
    """Whether omega is certainly smaller than `least` at a point."""
    value = model.on(point).value(model.root)
    return value is not None and float(abs(value).upper()) < least


def snapped(model: Model, point: Sequence[arb]) -> ZeroPlace | None:
    """The simple fractions that the coordinates agree with, if all do."""
    fractions = [as_fraction(part).limit_denominator(SIMPLE) for part in point]
    if any(abs(as_fraction(p) - f) > 4 * Fraction(CONVERGED) for p, f in zip(point, fractions, strict=True)):
        return None
    return at_fractions(model, fractions)


def at_fractions(model: Model, fractions: Sequence[Fraction]) -> ZeroPlace:
    """The place with these coordinates."""
    coordinates = dict(zip(model.builder.coordinates, fractions, strict=True))
    return ZeroPlace(tuple(map(exact, fractions)), coordinates, frozenset(), True)


def _pinned(model: Model, point: Point, equations: Equations) -> ZeroPlace:
    """The only common zero of the equations in a tiny box, if that is proved."""
    local = model.on([part + arb(0, PINNED) for part in point])
    unknown: dict[str, Fraction | None] = dict.fromkeys(model.builder.coordinates)
    if all(generators(local, number).analytic for number in equations.nodes):
        zero = common_zero(local, equations.nodes)
        if zero is not None and zero.exists:
            point = tuple(narrowed_zero(local, equations.nodes, zero).sides)
            known = exact_at(model, point, unknown, frozenset(equations.nodes))
            held = all(map(model.on(point).nonzero, equations.nonzero))
            implied = (second for first, second in equations.implied if held and known.vanishes(first))
            return ZeroPlace(point, unknown, frozenset((*equations.nodes, *implied)), True)
    return ZeroPlace(point, unknown, frozenset(), False)


def _newton(model: Model, nodes: tuple[int, ...], start: tuple[float, ...]) -> Point | None:
    """Newton's method; a multiple zero halves the error at each step."""
    point, size = tuple(arb(part) for part in start), len(nodes)
    wanted = (*nodes, *(part for number in nodes for part in model.gradient(number)))
    for _ in range(STEPS):
        values = model.on(point).all(wanted)
        if any(value is None or not value.is_finite() for value in values):
            return None
        middles = [value.mid() for value in values if value is not None]
        if not any(middles[:size]):
            return point
        try:
            step = arb_mat(size, size, middles[size:]).solve(arb_mat(size, 1, middles[:size])).entries()
        except ZeroDivisionError:
            return None
        point = tuple((part - change).mid() for part, change in zip(point, step, strict=True))
        if not all(part.is_finite() for part in point):
            return None
        if all(abs(change) < CONVERGED for change in step):
            return point
    return None
