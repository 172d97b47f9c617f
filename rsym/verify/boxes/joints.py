"""Joints: two analytic arcs of a boundary that meet in a point, and the jump between them, enclosed.

An arc is {F = 0, G >= 0} with F and G analytic on the box. Where grad F and grad G are nowhere parallel, G is
strictly monotone along F = 0: the arc starts or ends where G = 0 and does so once. Of a switch u the two arcs are
{F+ = 0, u >= 0} and {F- = 0, -u >= 0}, of a conjunction {f = 0, g >= 0} and {g = 0, f >= 0}. The jump is that of
the enclosures at the point: where they are disjoint it is proved.

On u = 0 itself omega may be a third function T, which is neither F+ nor F-. Then {T = 0, u = 0} belongs to the
boundary, and the ends of the arcs do only if T is zero there: two arcs are a curve if T and u have one common zero,
and that is the point where the arcs meet, or none if they do not.
"""

from __future__ import annotations

from dataclasses import dataclass

from rsym.bounds.balls import arb, ctx, hypotenuse
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.generators import Generators, generators
from rsym.verify.boxes.krawczyk import Point, common_zero
from rsym.verify.boxes.local import PRECISE, Local, Model
from rsym.verify.boxes.locus import Locus
from rsym.verify.boxes.resolution import resolved
from rsym.verify.boxes.vanishing import vanishes_with
from rsym.verify.boxes.vectors import sign_of

_EQUAL = 1e-25  # a jump enclosed in a ball around 0 narrower than this (relative) is called numerically zero


@dataclass(frozen=True)
class BoundaryArc:
    """{function = 0, side >= 0}, the inside where the function is positive."""

    function: int
    side: int

    @property
    def ends(self) -> tuple[int, int]:
        """The nodes that vanish where the arc begins or ends."""
        return self.function, self.side


@dataclass(frozen=True)
class Meeting:
    """Two arcs, and the order to which their functions agree where they meet (`contact`).

    `thin`: between the arcs, where the side is zero, omega is this function; None where it is that of an arc.
    """

    arcs: tuple[BoundaryArc, BoundaryArc]
    contact: float
    thin: BoundaryArc | None = None

    @property
    def continuous(self) -> bool:
        """Whether omega is proved to be continuous from arc to arc, so that both end where one does."""
        return self.contact >= 1 and self.thin is None


def meeting(local: Local, locus: Locus, found: Generators | None) -> Meeting | None:
    """The two arcs of a locus on a box, if it consists of two: one switch, or two leaves."""
    builder = local.model.builder
    if locus.kind in {"conjunction", "disjunction"}:
        f, g = locus.nodes
        sides = (g, f) if locus.kind == "conjunction" else (builder.neg(g), builder.neg(f))
        return Meeting((BoundaryArc(f, sides[0]), BoundaryArc(g, sides[1])), 1)
    if locus.kind != "leaf" or found is None or len(found.switches) != 1:
        return None
    (switch,) = found.switches
    (leaf,) = locus.nodes
    both = resolved(local, leaf, switch)
    thin = None if both.thin is None else BoundaryArc(both.thin, switch)
    # What is not resolved may be so on the sides alone: it tells nothing of how they agree.
    contact = 0 if found.hard else both.contact
    return Meeting((BoundaryArc(both.plus, switch), BoundaryArc(both.minus, builder.neg(switch))), contact, thin)


def others_of(meeting: Meeting) -> list[BoundaryArc]:
    """The functions of which it is not known that they are zero where the first arc ends."""
    return [*(meeting.arcs[1:] if meeting.contact < 1 else ()), *([] if meeting.thin is None else [meeting.thin])]


def is_transversal(local: Local, meeting: Meeting) -> bool:
    """Whether all functions are analytic on the box, and nothing that meets is tangent to its side anywhere on it."""
    if meeting.thin is not None and not generators(local, meeting.thin.function).analytic:
        return False
    return all(is_crossed(local, arc) for arc in meeting.arcs)


def is_crossed(local: Local, arc: BoundaryArc) -> bool:
    """Whether a function and its side are analytic, and their gradients nowhere parallel, all over the box."""
    return all(generators(local, number).analytic for number in arc.ends) and steepest(local, arc) is not None


def steepest(local: Local, arc: BoundaryArc) -> int | None:
    """The axis along which the curve in which a function and its side vanish runs most steeply; of a point the third.

    None where the gradients may be parallel.
    """
    p, q = map(local.gradient, arc.ends)
    minors = {3 - i - j: p[i] * q[j] - p[j] * q[i] for i, j in ((1, 2), (2, 0), (0, 1)) if max(i, j) < len(p)}
    least = {axis: float(abs(minor).lower()) for axis, minor in minors.items()}
    steep = [axis for axis in least if least[axis] > 0]  # NaN is not
    return max(steep, key=lambda axis: (least[axis], -axis), default=None)


def _determinant(local: Local, arc: BoundaryArc) -> int:
    """The sign of the growth of G along F = 0, the inside on the left: 1 the arc leaves the joint, -1 it arrives."""
    (fx, fy), (gx, gy) = local.gradient(arc.function), local.gradient(arc.side)
    return sign_of(gx * fy - gy * fx)


@dataclass(frozen=True)
class ArcJet:
    """The unit tangent, curvature and its derivative along an arc at the joint, the inside on the left."""

    tangent: tuple[arb, arb]
    curvature: arb
    derivative: arb


def jet(model: Model, arc: BoundaryArc, at: Local) -> ArcJet:
    """Enclosures at a point of the arc."""
    gx, gy = at.gradient(arc.function)
    size = hypotenuse(gx, gy)
    tangent = (gy / size, -gx / size)
    curvature = model.curvature(arc.function)
    kx, ky = at.gradient(curvature)
    return ArcJet(tangent, at.ball(curvature), kx * tangent[0] + ky * tangent[1])


def joint(local: Local, meeting: Meeting, at: Local) -> Joint | None:
    """The joint at the only point of the box that can be one, `located`; None where the enclosures decide nothing."""
    model, directions = local.model, [_determinant(local, arc) for arc in meeting.arcs]
    if set(directions) != {1, -1}:
        return None
    if meeting.thin is not None and _determinant(local, meeting.thin) != directions[0]:
        return None  # between the arcs the inside lies on the other side
    others = others_of(meeting)  # what may end in different points: each must have one end, and it must be the same
    if not all(end is not None and end.exists for end in (common_zero(local, other.ends) for other in others)):
        return None
    with ctx.workprec(PRECISE):
        first = meeting.arcs[0]
        if not all(vanishes_with(at, first.ends, other.function) for other in others):
            return None
        jets = {direction: jet(model, arc, at) for direction, arc in zip(directions, meeting.arcs, strict=True)}
        return judged(tuple(at.sides[:2]), jets[-1], jets[1], meeting.contact)


def judged(point: Point, arriving: ArcJet, leaving: ArcJet, order: float) -> Joint | None:
    """What two arcs make of the point where they meet, if their functions agree there to some order."""
    (ax, ay), (bx, by) = arriving.tangent, leaving.tangent
    turn = abs(arb.atan2(ax * by - ay * bx, ax * bx + ay * by)) * 180 / arb.pi()
    jump, derivative = abs(leaving.curvature - arriving.curvature), abs(leaving.derivative - arriving.derivative)
    steps = [step_of(turn, order >= 2), step_of(jump, order >= 3), step_of(derivative, order >= 4)]
    for level, (name, kind) in enumerate((("G0", "corner"), ("G1", "curvature jump"), ("G2", "smooth joint"))):
        if steps[level] == "jump":
            proved = level < 2 or steps[:2] == ["equal", "equal"]
            return _joint(point, kind, name, arriving, leaving, turn, jump, derivative, proved, steps)
        if steps[level] == "open":
            if level == 2:
                break
            return None
    level = 2 if steps[2] == "open" else 3
    proved = all(step == "equal" for step in steps[:level])
    if not proved and all(step == "equal" for step in steps[:2]):
        level, proved = 2, True
    return _joint(point, "smooth joint", f"G{level}", arriving, leaving, turn, jump, derivative, proved, steps)


def step_of(difference: arb, structural: bool) -> str:
    """Whether a difference is proved "equal" or a "jump", is "zero" to the working precision, or is "open"."""
    if structural or difference.is_zero():
        return "equal"
    if difference > 0:
        return "jump"
    return "zero" if float(difference.upper()) < _EQUAL else "open"


def _joint(
    point: Point,
    kind: str,
    continuity: str,
    arriving: ArcJet,
    leaving: ArcJet,
    turn: arb,
    jump: arb,
    derivative: arb,
    proved: bool,
    steps: list[str],
) -> Joint:
    words = {"equal": "proved equal", "zero": "equal to 25 digits, which is no proof", "jump": "proved to differ"}
    names = ("tangents", "curvatures", "derivatives of curvature")
    known = [f"{name} {words[step]}" for name, step in zip(names, steps, strict=True) if step in words]
    return Joint(
        point=(float(point[0].mid()), float(point[1].mid())),
        radius=float(hypotenuse(arb(point[0].rad()), arb(point[1].rad())).upper()) + 1e-15 * _extent(point),
        kind=kind,
        continuity=continuity,
        branches=2,
        tangent_jump=0.0 if steps[0] == "equal" else float(turn.mid()),
        tangent_jump_error=0.0 if steps[0] == "equal" else _error(turn),
        curvatures=(float(arriving.curvature.mid()), float(leaving.curvature.mid())),
        curvature_jump=0.0 if steps[1] == "equal" else float(jump.mid()),
        curvature_jump_error=0.0 if steps[1] == "equal" else _error(jump),
        derivative_jump=0.0 if steps[2] == "equal" else float(derivative.mid()),
        derivative_jump_error=0.0 if steps[2] == "equal" else _error(derivative),
        proved=proved,
        reason="two analytic arcs meet: " + ", ".join(known),
    )


def _extent(point: Point) -> float:
    return float(abs(point[0]).upper()) + float(abs(point[1]).upper())


def _error(value: arb) -> float:
    """The radius of a ball, and what rounding its middle to float64 adds."""
    return float(arb(value.rad()).upper()) + 2.0**-52 * float(abs(value).upper())
