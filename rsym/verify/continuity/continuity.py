"""Geometric continuity of paths: of parametric curves where they are joined, and of each between its ends."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import sympy as sp

from rsym.bounds.balls import arb
from rsym.errors import RsymError
from rsym.model.requirements import several
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED, Document, Entry, Sentence
from rsym.reports.numbers import number
from rsym.reports.render import Report
from rsym.verify.answers.report import COLUMNS, CONTINUITIES, Joint
from rsym.verify.boxes.constants import enclosed, measured, norm, precise
from rsym.verify.continuity.curves import Curve, End, Vector, all_vanish, dot, end_of, minors
from rsym.verify.continuity.interiors import CurveArc, arcs_of
from rsym.verify.continuity.jumps import bend, curvature, distance, slope, torsion, turn

GRADES = CONTINUITIES[CONTINUITIES.index("broken") : -1]
KINDS = ("end", "corner", "curvature jump", "smooth joint")
# What is smaller than this, and not proved to be other than zero, is called numerically zero.
NUMERICAL_ZERO = 1e-30
# In degrees, less what a double rounds.
HALF_A_TURN = 180 * (1 - 1e-15)
BUG = "this is a bug: please report it"
DEGENERATE_ENDS = "a curve stands still at its end"


@dataclass(frozen=True)
class CurveJoint(Joint):
    """The place where curve `index` passes into the next.

    gap is the distance of their ends; curvatures are signed in the plane (positive to the left); in space
    curvature_jump is the size of the difference of the curvature vectors, and torsions are given.
    """

    index: int = 0
    gap: float = math.nan
    gap_error: float = math.nan
    torsions: tuple[float, float] = (math.nan, math.nan)


@dataclass(frozen=True)
class ContinuityReport(Report):
    """Whether a path is as smooth as `claim` says: where its curves are joined, and between.

    verdict : "CERTIFIED", every joint is proved to be that smooth, and every curve between its ends; "REFUTED", one
        place is proved not to be; "DEGENERATE", a curve is proved to be a single point; "UNDECIDED", neither is proved.
    continuity : that of the worst place.
    proved : the highest class that is proved of the whole path, None if there is none.
    joints : one for each place where two curves meet; `joint.proved` says whether its class is proved.
    inside : places inside curves at which the velocity vanishes, compared like joints.
    doubts : what is neither proved nor refuted, beside the joints, in words.

    Examples
    --------
    >>> ContinuityReport("CERTIFIED", "G3", (), "G2").defects
    ()
    """

    verdict: str
    continuity: str
    joints: tuple[CurveJoint, ...]
    claim: str
    inside: tuple[CurveJoint, ...] = ()
    doubts: tuple[str, ...] = ()
    proved: str | None = None

    @property
    def defects(self) -> tuple[CurveJoint, ...]:
        """The places that are less smooth than the claim."""
        places = (*self.joints, *self.inside)
        return tuple(joint for joint in places if GRADES.index(joint.continuity) < GRADES.index(self.claim))

    def document(self) -> Document:
        """All that the report says."""
        below = self.defects
        entries = [joint.entry(defect=joint in below, label=None) for joint in self.joints]
        entries += [joint.entry(defect=joint in below, label=f"inside {joint.index + 1}.") for joint in self.inside]
        entries += [Entry(doubt, False, label="not proved:") for doubt in self.doubts]
        return Document(
            "continuity-report",
            Sentence(
                f"{self.verdict}: the joints are {self.continuity}, {self.claim} was claimed.",
                self.verdict in {CERTIFIED, REFUTED},
            ),
            self.verdict,
            self.continuity,
            entries=tuple(entries),
            columns=COLUMNS,
            data={
                "claim": self.claim,
                "proved": self.proved,
                "joints": self.joints,
                "inside": self.inside,
                "doubts": self.doubts,
            },
        )


def continuity(curves: Sequence[Curve], *, closed: bool = False, claim: str = "G2") -> ContinuityReport:
    """How smooth a path is that curves make which pass into one another, independent of their parameters.

    Two curves join G^k if, as functions of arc length s, their derivatives up to the k-th agree: the points (G0), the
    unit tangents p_s (G1), the curvature vectors p_ss (G2; kappa in the plane) and p_sss (G3; in
    the plane dkappa/ds, in space also the torsion). With p' not zero, p_ss = (p''|p'|^2 - p'(p'.p''))/|p'|^4 is
    rational in the derivatives at the exact ends: it is compared exactly. A difference is proved by a ball that
    excludes zero, equality by exact algebra; where neither succeeds and the difference is below 1e-30, the curves are
    "numerically equal", which is not proved. Where p' vanishes at an end, the curve is looked at as a graph over its
    tangent, which no parameter has a part in. Between its ends each curve is enclosed by Taylor series in balls, which
    prove it analytic with p' not zero: then it is G^k for every k. What is claimed is proved only if all of that is;
    the ends of an open path belong to it.

    Parameters
    ----------
    curves : sequence of Curve
        In the order and direction in which they are run through.
    closed : bool
        Whether the last passes into the first.
    claim : "G0", "G1", "G2" or "G3"
        What the verdict is about.

    Returns
    -------
    ContinuityReport
        The verdict, the joints, and what is not proved of the curves between them.

    Raises
    ------
    RsymError
        If there is no joint, if dimensions differ, or if the claim is none of the four.

    Sources: Barsky and DeRose, IEEE CG&A 9(6) (1989) 60-68; do Carmo, Differential Geometry of Curves and Surfaces.

    Examples
    --------
    >>> import sympy as sp
    >>> t = sp.Symbol("t")
    >>> line = Curve((t, sp.Integer(0)), t, -1, 0)
    >>> arc = Curve((2 * sp.sin(t), 2 - 2 * sp.cos(t)), t, 0, 1)
    >>> report = continuity([line, arc])
    >>> report.verdict, report.continuity, report.joints[0].curvature_jump
    ('REFUTED', 'G1', 0.5)
    """
    if claim not in GRADES[1:]:
        raise RsymError(f"expected a claim of G0 to G3, got {claim!r}", code="claim", remedy='say claim="G2"')
    curves = several(Curve, curves, "curve")
    if len({curve.dimension for curve in curves}) > 1:
        raise RsymError("expected curves of one dimension", code="curve", remedy="give all of them z, or none")
    pairs = [*pairwise(curves), *([(curves[-1], curves[0])] if closed and curves else [])]
    if not pairs:
        raise RsymError("expected a joint, got none", code="curve", remedy="give two curves, or closed=True")
    wanted = GRADES.index(claim)
    found = [_joint(index, *pair, wanted) for index, pair in enumerate(pairs)]
    arcs = [arcs_of(curve) for curve in curves]
    within = [
        _joint(index, before.curve, after.curve, wanted)
        for index, own in enumerate(arcs)
        for before, after in pairwise(own)
    ]
    places = [*found, *within]
    free = [] if closed else _free_ends(curves, wanted)
    doubts = [*_uncovered(curves, arcs), *free, *_unaccounted(len(pairs), len(found), arcs, len(within))]
    levels = [states for _, states in places]
    held = min(_held(states) for states in levels)
    if any(False in states[:wanted] for states in levels):
        verdict = REFUTED
    elif held >= wanted and not doubts:
        verdict = CERTIFIED
    else:
        verdict = DEGENERATE if any(map(_is_point, curves)) else UNDECIDED
    worst = min((joint.continuity for joint, _ in places), key=GRADES.index)
    proved = None if doubts or held == 0 else GRADES[held]
    joints = tuple(joint for joint, _ in found)
    return ContinuityReport(verdict, worst, joints, claim, tuple(joint for joint, _ in within), tuple(doubts), proved)


Levels = tuple[bool | None, ...]
Measured = tuple[float, float]


def _held(states: Levels) -> int:
    """How many of G0 to G3 are proved, from the first."""
    return next((level for level, state in enumerate(states) if state is not True), len(states))


def _is_point(curve: Curve) -> bool:
    """Whether the coordinates are written without the parameter: a single point, which is no curve."""
    return all(sp.expand(sp.diff(one, curve.parameter)) == 0 for one in curve.expressions)


def _uncovered(curves: Sequence[Curve], arcs: Sequence[Sequence[CurveArc]]) -> Iterator[str]:
    """The parts of curves that are not proved to be regular."""
    for index, (curve, own) in enumerate(zip(curves, arcs, strict=True)):
        for arc in own:
            low, span = arc.curve.start, arc.curve.end - arc.curve.start
            for part in arc.open:
                ends = [measured(enclosed(low + span * sp.Rational(str(share))))[0] for share in part]
                place = f"{curve.parameter} in [{number(min(ends))}, {number(max(ends))}]"
                yield f"that curve {index + 1} is regular for {place}"


def _free_ends(curves: Sequence[Curve], wanted: int) -> Iterator[str]:
    """The ends of an open path at which the claimed derivatives are not proved to exist."""
    for index, at_start in ((0, True), (len(curves) - 1, False)):
        end = end_of(curves[index], at_start)
        known = (True, end.tangent is not None, end.curvature is not None, end.rate is not None)
        if not all(known[:wanted]):
            which = "starts" if at_start else "ends"
            yield f"where curve {index + 1} {which}, {end.doubt or _WITHOUT[known.index(False)]}"


_WITHOUT = {2: "the curvature is unbounded", 3: "no rate of change of the curvature is proved to exist"}


def _unaccounted(expected: int, found: int, arcs: Sequence[Sequence[CurveArc]], within: int) -> Iterator[str]:
    """What was asked and has no answer: every joint, every place inside, and every part of every curve counts once."""
    if found != expected:
        yield f"{expected} joints, of which {found} were examined; {BUG}"
    if within != sum(len(own) - 1 for own in arcs):
        yield f"some places inside the curves were not examined; {BUG}"
    for index, own in enumerate(arcs):
        if not own or not all(arc.accounted for arc in own):
            yield f"parts of curve {index + 1} were not examined; {BUG}"


def _joint(index: int, first: Curve, second: Curve, wanted: int) -> tuple[CurveJoint, Levels]:
    """One joint, and for G0 to G3 whether the difference is proved to be zero or not."""
    before, after = end_of(first, at_start=False), end_of(second, at_start=True)
    states = _states(before, after)
    sizes = _sizes(before, after, states)
    # NaN is not small, so that what is not known ends the search for the grade. Where the claim is proved, only what
    # is proved counts beyond it.
    enough = all(states[:wanted])
    equal = [
        state or (state is None and not enough and sum(size) < NUMERICAL_ZERO)
        for state, size in zip(states, sizes, strict=True)
    ]
    grade = equal.index(False) if False in equal else 4
    place = tuple(measured(enclosed(component)) for component in before.point)
    unbounded = before.unbounded or after.unbounded
    flat = first.dimension == 2
    joint = CurveJoint(
        point=tuple(value for value, _ in place),
        radius=max(error for _, error in place),
        kind="smooth joint" if enough else _kind(grade, states, sizes[1][0], unbounded),
        continuity=GRADES[grade],
        tangent_jump=sizes[1][0],
        tangent_jump_error=sizes[1][1],
        curvatures=(curvature(before, flat), curvature(after, flat)),
        curvature_jump=math.inf if unbounded else sizes[2][0],
        curvature_jump_error=sizes[2][1],
        derivative_jump=math.inf if before.rough or after.rough else sizes[3][0],
        derivative_jump_error=sizes[3][1],
        proved=all(states[:grade]) and (enough or grade == 4 or states[grade] is False),
        reason=_reason(before, after, states, sizes, grade),
        index=index,
        gap=sizes[0][0],
        gap_error=sizes[0][1],
        torsions=(torsion(before), torsion(after)),
    )
    return joint, states


def _kind(grade: int, states: Levels, turn: float, unbounded: bool) -> str:
    """What ends the agreement; beyond the curvature the joint is smooth, whatever ends it."""
    if grade < 3 and states[grade] is None:
        return "unresolved"
    if grade == 1 and turn >= HALF_A_TURN:
        return "cusp"
    return "unbounded curvature" if grade == 2 and unbounded else KINDS[min(grade, 3)]


def _states(before: End, after: End) -> Levels:
    """For G0 to G3, whether the difference is proved to be zero (True) or not to be (False)."""
    differences = _differences(before, after)
    states: list[bool | None] = []
    for difference in differences:
        # Beyond a difference nothing is asked.
        known = None if difference is None or False in states else all_vanish(difference)
        states.append(known)
    if states[1] and before.tangent is not None and after.tangent is not None:
        ball = enclosed(dot(before.tangent, after.tangent))
        states[1] = True if ball is not None and ball > 0 else False if ball is not None and ball < 0 else None
    if before.unbounded or after.unbounded:
        states[2] = False
    if before.rough or after.rough:
        states[3] = False
    if states[1] is not True:
        states[3] = None  # the ratio of the speeds is that of parallel tangents
    return tuple(states)


def _differences(before: End, after: End) -> list[Vector | None]:
    """Vectors that are zero where the ends agree in the point, the tangent, the curvature, and its derivative."""
    found: list[Vector | None] = [_minus(after.point, before.point), None, None, None]
    if before.tangent is None or after.tangent is None:
        return found
    found[1] = minors(before.tangent, after.tangent)
    if before.curvature is not None and after.curvature is not None:
        found[2] = _minus(after.curvature, before.curvature)
    if before.rate is not None and after.rate is not None:
        # p_sss = rate/|p'|; with equal tangents the ratio of the speeds is rational, and no root is left.
        ratio = dot(before.tangent, after.tangent) / dot(before.tangent, before.tangent)
        found[3] = _minus(after.rate, tuple(ratio * component for component in before.rate))
    return found


def _minus(a: Vector, b: Vector) -> Vector:
    return tuple(u - v for u, v in zip(a, b, strict=True))


def _reason(before: End, after: End, states: Sequence[bool | None], sizes: Sequence[Measured], grade: int) -> str:
    """What is not proved, and why."""
    if before.standing or after.standing:
        return DEGENERATE_ENDS
    doubts = [end.doubt for end in (before, after) if end.doubt]
    if doubts:
        return doubts[0]
    weak = [level for level in range(grade) if states[level] is None]
    if weak:
        return f"{GRADES[weak[0] + 1]} only numerically: the difference is below {sum(sizes[weak[0]]):.1e}"
    if grade < 4 and states[grade] is None:
        return f"whether it is {GRADES[grade + 1]} is not decided"
    return f"the gap is {sizes[0][0]:.6g}" if grade == 0 else ""


def _sizes(before: End, after: End, states: Levels) -> list[Measured]:
    """Gap, turn in degrees, jumps of curvature and of its derivative; what is proved to be zero is 0."""
    flat = len(before.point) == 2
    with precise():
        bends = [bend(end, flat) for end in (before, after)]
        slopes = [slope(end, flat) for end in (before, after)]
        sizes = [norm(_minus(after.point, before.point)), turn(before, after), distance(*bends), distance(*slopes)]
    return [(0.0, 0.0) if state else _jump(size) for state, size in zip(states, sizes, strict=True)]


def _jump(ball: Any | None) -> Measured:
    """A size that may be zero is called zero within its bound."""
    if ball is not None and ball.is_finite() and ball.contains(arb(0)):
        return 0.0, sum(measured(ball))
    return measured(ball)
