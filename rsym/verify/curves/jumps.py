"""Jumps across a singular curve: in the plane normal to the curve, how two sheets of a boundary continue each other.

With n = -grad F/|grad F| the outward normal of a sheet {F = 0}, t the unit tangent of the curve and b = t x n, the
normal curvature across the curve is kappa = -b^T H b/|grad F|, H the matrix of second derivatives of F; it is positive
where the inside is convex. Along the curve both sheets have all else in common: where the normals agree all along,
the shape operators differ only in kappa. Source: Goldman, CAGD 22 (2005) 632-658.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.ball_arithmetic import degrees
from rsym.bounds.balls import arb, ctx, root, square
from rsym.model.vectors import cross
from rsym.program.calculus import Calculus
from rsym.verify.boxes.joints import Meeting, step_of
from rsym.verify.boxes.local import PRECISE, Local
from rsym.verify.boxes.vanishing import vanishes_with
from rsym.verify.boxes.vectors import dot
from rsym.verify.curves.continuation import Knot, Tube, ZeroCurve

WORDS = {"equal": "proved equal", "zero": "equal to 25 digits, which is no proof", "jump": "proved to differ"}

# An arc is cut into so many if the first number leaves its jump without bounds.
_PIECES = (1, 4)


@dataclass(frozen=True)
class Jump:
    """What is known at one point: both normals, the angle between them in degrees and the jump of the curvature.

    `steps` says of normals and curvatures whether they are "equal", proved to "jump", numerically "zero" or "open".
    """

    normals: Floats
    turn: arb
    curvature: arb | None
    steps: tuple[str, str]


@dataclass(frozen=True)
class CurveJudgement:
    """The class of a whole curve, from its worst points."""

    kind: str
    continuity: str
    proved: bool
    reason: str


class SheetJumps:
    """The jumps along the curve in which two sheets meet."""

    def __init__(self, curve: ZeroCurve, meeting: Meeting) -> None:
        self.curve, self.meeting, model = curve, meeting, curve.model
        builder, functions = model.builder, [arc.function for arc in meeting.arcs]
        self._hessians = [Calculus(builder, function).hessian for function in functions]
        self._laplacian = Calculus(builder, builder.sub(*functions)).laplacian

    def at(self, knot: Knot) -> Jump:
        """The jump at a point of the curve, as precise as it must be to decide."""
        jump = self._at(knot.sides)
        if knot.axis is None or all(step in {"equal", "jump"} for step in jump.steps) or jump.steps[0] == "jump":
            return jump
        with ctx.workprec(PRECISE):
            return self._at(self.curve.narrowed(knot.sides, knot.axis))

    def between(self, tube: Tube, start: Knot, end: Knot, level: int) -> tuple[float, float] | None:
        """Bounds of the angle (level 0) or of the jump of curvature on the arc between two points, None without any."""
        low, high = sorted(float(knot.sides[tube.axis].mid()) for knot in (start, end))
        for pieces in _PIECES:
            t = [low + (high - low) * number / pieces for number in range(pieces)] + [high]
            jumps = [self._at(tube.over(*part, tube.width)) for part in itertools.pairwise(t)]
            balls = [jump.curvature if level else jump.turn for jump in jumps]
            ends = [float(end) for ball in balls if ball is not None for end in (ball.lower(), ball.upper())]
            if len(ends) == 2 * pieces and all(0 < end < (math.inf if level else 180) for end in ends):  # NaN is not
                return min(ends), max(ends)
        return None

    def _at(self, sides: Sequence[arb]) -> Jump:
        local, order = self.curve.on(sides), self.meeting.contact
        gradients = [local.gradient(arc.function) for arc in self.meeting.arcs]
        sizes = [_size(gradient) for gradient in gradients]
        normals = [[-one / size for one in gradient] for gradient, size in zip(gradients, sizes, strict=True)]
        along = cross(*self.curve.slopes(local))
        length = _size(along)
        tangent = [one / length for one in along]
        middles = np.array([[float(one.mid()) for one in normal] for normal in normals])
        turn = _turn(normals, tangent)
        first = step_of(turn, order >= 2)
        if first == "jump":
            return Jump(middles, turn, None, (first, "open"))
        jump = self._of_contact(local) if order >= 2 else self._of_sheets(local, normals, tangent, sizes)
        return Jump(middles, turn, jump, (first, step_of(jump, order >= 3)))

    def _of_contact(self, local: Local) -> arb:
        """The jump where the functions F differ by h u**2, u the side: the tighter one over a whole tube.

        The second derivatives of the difference are 2 h (grad u)(grad u)^T and its Laplacian is 2 h |grad u|**2, so
        the jump is |Laplacian| sin(F, u)**2/|grad F|, with the angle between the gradients.
        """
        arc = self.meeting.arcs[0]
        slopes, across = local.gradient(arc.function), local.gradient(arc.side)
        size = _size(slopes)
        cosine = dot(slopes, across) / (size * _size(across))
        return abs(local.ball(self._laplacian)) * (1 - square(cosine)) / size

    def _of_sheets(self, local: Local, normals: Sequence[list[arb]], tangent: list[arb], sizes: Sequence[arb]) -> arb:
        bends = []
        for hessian, normal, size in zip(self._hessians, normals, sizes, strict=True):
            b = cross(tangent, normal)
            rows = [local.balls(tuple(row)) for row in hessian]
            bends.append(-dot(b, [dot(row, b) for row in rows]) / size)
        return abs(bends[0] - bends[1])

    def is_common(self, knot: Knot) -> bool:
        """Whether both sheets certainly end in this curve: continuity across it, or zeros that are known, prove it."""
        first, second = self.meeting.arcs
        if self.meeting.contact >= 1:
            return True
        return vanishes_with(self.curve.on(knot.sides), (first.function, first.side), second.function)


def _size(vector: Sequence[arb]) -> arb:
    size = root(square(vector[0]) + square(vector[1]) + square(vector[2]))
    assert size is not None
    return size


def _turn(normals: Sequence[list[arb]], tangent: list[arb]) -> arb:
    """The angle between two normals in degrees; both are orthogonal to the tangent, so is their product parallel."""
    return abs(degrees(abs(dot(cross(*normals), tangent)), dot(*normals)))


def judge(jumps: Sequence[Jump], contact: float, common: bool) -> CurveJudgement:
    """The class of a curve from the jumps at points of it; `common`: both sheets certainly end in it there."""
    turns, bends = ([jump.steps[level] for jump in jumps] for level in range(2))
    normals = f"normals {_words(turns, contact >= 2)}"
    if not common:
        return CurveJudgement("unresolved", "G0", False, "the sheets need not end in the same curve")
    if "jump" in turns:
        return CurveJudgement("edge", "G0", True, normals)
    if "open" in turns or not turns:
        return CurveJudgement("unresolved", "G0", False, "whether the normals agree stays open")
    both = f"{normals}, curvatures across {_words(bends, contact >= 3)}"
    if "jump" in bends:
        return CurveJudgement("curvature jump", "G1", True, both)
    if "open" in bends:
        return CurveJudgement("unresolved", "G1", False, f"{normals}; whether the curvatures agree stays open")
    return CurveJudgement("smooth joint", "G3" if contact >= 4 else "G2", contact >= 3, both)


def _words(steps: Sequence[str], structural: bool) -> str:
    """The worst of the steps, and at how many points it was found."""
    worst = next((word for word in ("jump", "open", "zero") if word in steps), "equal")
    if structural:
        return f"{WORDS['equal']} all along"
    return f"{WORDS.get(worst, 'not decided')} at {steps.count(worst)} of {len(steps)} points"
