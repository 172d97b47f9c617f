"""Which parts of an expression make a defect: those that are not analytic at its point."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.bounds.balls import arb, ctx
from rsym.bounds.enclosures import ranges_of
from rsym.model.nodes import Trimming, written_out
from rsym.model.rnodes import ROperation
from rsym.model.shape import Shape
from rsym.model.symbols import postorder
from rsym.program.lowering import lower
from rsym.program.operations import CHOOSING
from rsym.program.program import live
from rsym.sampling.windows import bounds_or_extent
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import Joint, SmoothnessReport
from rsym.verify.answers.singular import SingularCurve, SingularPoint
from rsym.verify.boxes.generators import is_analytic_at
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.locus import chosen
from rsym.verify.revolution import meridian

Verdict: TypeAlias = SmoothnessReport | BodyReport
Point: TypeAlias = tuple[float, ...]

PRECISION = 106  # bits; differences over STEP lose 20 of them
STEP = 2.0**-20  # of the extent: how far from a point slopes are taken; boundaries hardly bend over it
NEAR = 2.0**-30  # of the extent: half the side of the least box around a point
LISTED = 8  # undecided boxes that are looked at


@dataclass(frozen=True)
class Culprit:
    """A part of an expression that is not analytic at points of the boundary.

    Of a fold of several operands, `level` says how many are folded when it happens; 0 for other parts.
    """

    part: sp.Expr
    level: int
    points: tuple[Point, ...]

    @property
    def point(self) -> Point:
        """The first of them, where the verdict is worst."""
        return self.points[0]


class Anatomy:
    """A shape as a program, and which numbers of the program its parts are.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> corner = rsym.Shape(rsym.conjunction(x, y, x + y + 9), (x, y), bounds=((-2, 2), (-2, 2)))
    >>> [(culprit.part, culprit.level) for culprit in Anatomy(corner).culprits((0.0, 0.0))]
    [(conjunction(x, y, x + y + 9), 2)]
    """

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self.model = Model(shape, ranges_of(shape.letters, None))
        self.extent = max(high - low for low, high in bounds_or_extent(shape, None))

    def culprits(self, point: Point, radius: float = 0.0) -> list[Culprit]:
        """The parts that a move may change and that are not analytic within the radius of a point."""
        reach = 2 * radius + NEAR * self.extent
        with ctx.workprec(PRECISION):
            wrong = self._not_analytic(self.model.over(tuple((c - reach, c + reach) for c in point)))
        return [Culprit(part, level, (point,)) for part, level, own in self._parts() if own & wrong]

    def _not_analytic(self, local: Local) -> set[int]:
        """The nodes that are alive on a box and not analytic there."""
        found: set[int] = set()
        seen: set[int] = set()
        stack = [self.model.root]
        while stack:
            number = stack.pop()
            if number in seen:
                continue
            seen.add(number)
            operation, arguments, _ = self.model.builder.nodes[number]
            if operation in CHOOSING and (branch := chosen(local, number)) is not None:
                stack.append(branch[0])
                continue
            stack.extend(arguments)
            if operation not in {"const", "input"} and not is_analytic_at(local, number):
                found.add(number)
        return found

    def _parts(self) -> Iterator[tuple[sp.Expr, int, set[int]]]:
        """Parts that a move may change, and the nodes that are theirs alone."""
        for part in postorder(self.shape.expression):
            if isinstance(part, ROperation):
                before = part.operands[0]
                for level in range(2, len(part.operands) + 1):
                    head = part.func(*part.parameters, *part.operands[:level])
                    yield part, level, self._own(head, (before, part.operands[level - 1]))
                    before = head
            elif is_root(part):
                yield part, 0, self._own(part, part.args)

    def _own(self, part: sp.Expr, arguments: Sequence[sp.Expr]) -> set[int]:
        inside = [lower(self.model.builder, argument) for argument in arguments]
        outside = lower(self.model.builder, part)
        nodes = self.model.builder.nodes
        return set(live(nodes, [outside])) - set(live(nodes, inside))

    def value(self, expression: sp.Expr, point: Sequence[float] | Floats) -> float:
        """The value of an expression in the coordinates and letters of the shape; NaN where there is none."""
        with ctx.workprec(PRECISION):
            found = self.model.on([arb(float(c)) for c in point]).value(lower(self.model.builder, expression))
            return math.nan if found is None else float(found.mid())

    def gradient(self, expression: sp.Expr, point: Point) -> list[float]:
        """Central differences."""
        ways = np.eye(len(point))
        return [self._difference(expression, point, way) for way in ways]

    def _difference(self, expression: sp.Expr, point: Point, way: Floats) -> float:
        step = STEP * self.extent
        before, after = (self.value(expression, np.asarray(point) + sign * step * way) for sign in (-1, 1))
        return (after - before) / (2 * step)

    def slope(self, root: sp.Expr, point: Point) -> float:
        """How fast a root that is zero at a point grows from there, in the direction in which it grows fastest.

        Its square is a quadratic form there, of which this is the root of the largest eigenvalue.
        """
        ways = np.eye(len(point))
        form = np.array([[self._form(root, point, one + other) for other in ways] for one in ways])
        form -= [[self._form(root, point, one - other) for other in ways] for one in ways]
        return math.sqrt(max(0.0, float(np.linalg.eigvalsh(form / 4)[-1]))) if np.isfinite(form).all() else math.nan

    def _form(self, root: sp.Expr, point: Point, way: Floats) -> float:
        """The mean square of a root at both sides of a point, in units of the step."""
        step = STEP * self.extent
        ends = (self.value(root, np.asarray(point) + sign * step * way) / step for sign in (-1, 1))
        return sum(end * end for end in ends) / 2


def is_root(part: sp.Basic) -> bool:
    """Whether a part is |u|, a root, a trimming, a minimum or a maximum."""
    if isinstance(part, sp.Pow):
        return bool(part.exp.is_Rational) and not part.exp.is_Integer and bool(part.base.free_symbols)
    return isinstance(part, sp.Abs | sp.Max | sp.Min | Trimming)


def anatomy(shape: Shape, places: Sequence[tuple[Point, float]]) -> tuple[Anatomy, list[Culprit]]:
    """The culprits at some places, each once; compositions are written out if none is seen without."""
    for candidate in (shape, shape.replace(expression=written_out(shape.expression))):
        body = Anatomy(candidate)
        found: dict[tuple[sp.Expr, int], tuple[Point, ...]] = {}
        for point, radius in places:
            for culprit in body.culprits(point, radius):
                key = culprit.part, culprit.level
                found[key] = (*found.get(key, ()), point)
        if found:
            break
    return body, [Culprit(part, level, points) for (part, level), points in found.items()]


def troubles(report: Verdict, shape: Shape) -> list[tuple[Point, float]]:
    """Where a verdict is not what it should be: points in the coordinates of the shape, each with its radius."""
    if isinstance(report, BodyReport):
        both: tuple[SingularCurve | SingularPoint, ...] = (*report.curves, *report.points)
        return [_of_body(one) for one in both if one in report.defects or not one.proved] + _undecided(report)
    joints: list[Joint] = [*report.defects, *(joint for joint in report.joints if not joint.proved)]
    places = [(joint.point, joint.radius) for joint in joints] + _undecided(report)
    if not report.body:
        return places
    axis = meridian(shape)[1]
    return [(_in_space(point, axis), radius) for point, radius in places]


def _of_body(one: SingularCurve | SingularPoint) -> tuple[Point, float]:
    """A point; of a curve its middle, away from the corners at its ends."""
    if isinstance(one, SingularPoint):
        return one.point, one.radius
    return tuple(float(c) for c in one.points[len(one.points) // 2]), one.radius


def _undecided(report: Verdict) -> list[tuple[Point, float]]:
    boxes = report.undecided[:: max(1, len(report.undecided) // LISTED)][:LISTED]
    return [(tuple(map(float, box.mean(axis=1))), float((box[:, 1] - box[:, 0]).max()) / 2) for box in boxes]


def _in_space(point: Point, axis: int) -> Point:
    """A point (axis, radius) of a meridian, in the half plane of the first coordinate across the axis."""
    place = [abs(point[1]), 0.0]
    place.insert(axis, point[0])
    return tuple(place)
