"""Tracing: all components of a singular curve in a union of boxes, each followed by certified continuation."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.balls import arb, ctx
from rsym.sampling.progress import Effort
from rsym.verify.answers.singular import SingularCurve, SingularPoint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.joints import Meeting
from rsym.verify.boxes.local import PRECISION, Box, Model, side
from rsym.verify.curves.components import Component, Search, ends
from rsym.verify.curves.continuation import Knot, ZeroCurve
from rsym.verify.curves.jumps import Jump, SheetJumps, judge

HASTY = 16  # points of a curve at which jumps are enclosed when time is over
_ROUNDED = 5e-4  # what four digits may lose


def trace(
    model: Model,
    meeting: Meeting,
    names: tuple[str, str],
    boxes: Sequence[Box],
    *,
    extent: float,
    corners: Sequence[tuple[Box, SingularPoint]] = (),
    effort: Effort | None = None,
    done: tuple[int, int] = (0, 1),
) -> list[SingularCurve]:
    """The curves in which two sheets of a boundary meet, with their classes.

    Parameters
    ----------
    model : Model
        A shape with three coordinates.
    meeting : Meeting
        The two sheets, {F1 = 0, G1 >= 0} and {F2 = 0, G2 >= 0}.
    names : pair of str
        The definitions of the sheets, in the order of the meeting.
    boxes : sequence of Box
        Disjoint but for their faces. In each, grown by a quarter of its width on every side, the functions are
        analytic, no gradient of F is parallel to that of G, and the boundary is the union of the sheets.
    extent : float
        The size of the whole body: what the accuracies are shares of.
    corners : sequence of (Box, SingularPoint)
        Small boxes and the points in them at which such curves end.
    effort : Effort, optional
        When its time is over one box stays open for all that were not looked at.
    done : pair of int
        How many of how many such meetings were traced before.

    Returns
    -------
    list of SingularCurve
        The first sheet lies to the left, seen from outside. An "unresolved" one of a single point stands for a box
        that stays open: it may hold a curve.

    Examples
    --------
    >>> from rsym import Shape, conjunction, x, y, z
    >>> from rsym.verify.boxes.joints import BoundaryArc
    >>> model = Model(Shape(conjunction(1 - x**2 - y**2 - z**2, z + y), (x, y, z)), {})
    >>> ball, plane = model.builder.nodes[model.root].arguments
    >>> sheets = Meeting((BoundaryArc(ball, plane), BoundaryArc(plane, ball)), 1)
    >>> (arc,) = trace(model, sheets, ("ball", "plane"), [((0.25, 1.25), (-1.0, 1.0), (-1.0, 1.0))], extent=2.0)
    >>> arc.traced, arc.proved, arc.kind, round(arc.tangent_jump, 9), arc.points[[0, -1], 0]
    (True, True, 'edge', 90.0, array([0.25, 0.25]))
    """
    found: list[SingularCurve] = []
    groups: dict[Box, list[Box]] = {}
    for box in boxes:
        groups.setdefault(box[3:], []).append(box)
    effort, seen = effort or Effort(), 0
    with ctx.workprec(PRECISION):
        for letters, group in groups.items():
            curve = ZeroCurve(model, _pair(meeting), [side(*one) for one in letters], extent)
            search = Search(curve, group, corners, effort)
            for box in group:
                effort.reach((done[0] + seen / len(boxes)) / done[1])
                if effort.is_over:
                    search.open.append(box)
                    break
                search.account(box)
                seen += 1
            found.extend(_described(search, meeting, names))
    return found


def _pair(meeting: Meeting) -> tuple[int, int]:
    return meeting.arcs[0].function, meeting.arcs[0].side


def _described(search: Search, meeting: Meeting, names: tuple[str, str]) -> list[SingularCurve]:
    """The components as curves, then the boxes that stay open."""
    curves = [_singular(search, component, meeting, names) for component in search.components]
    return curves + [_unresolved(search, box, meeting, names) for box in search.open]


def _singular(search: Search, component: Component, meeting: Meeting, names: tuple[str, str]) -> SingularCurve:
    jumps, knots = SheetJumps(search.curve, meeting), component.knots
    if search.effort.is_over and len(knots) > HASTY:
        places = sorted({round(k * (len(knots) - 1) / HASTY) for k in range(HASTY + 1)})
        component = replace(component, knots=[knots[place] for place in places], tubes=[])
        knots = component.knots
    found = [jumps.at(knot) for knot in knots]
    # Only in the boxes it is proved that the boundary is both sheets, and only within the bounds that it matters.
    certain = [
        knot.axis is not None
        and search.ground.boxes.holds(knot.middle)
        and is_within(search.curve.on(knot.sides), _pair(meeting)) is True
        for knot in knots
    ]
    own = list(itertools.compress(found, certain))
    common = all(jumps.is_common(knot) for knot in itertools.compress(knots, certain))
    judged = judge(own, meeting.contact, common)
    turn, turn_error = _worst([(jump.turn, jump.steps[0]) for jump in own])
    bend, bend_error = _worst([(jump.curvature, jump.steps[1]) for jump in own if jump.curvature is not None])
    return SingularCurve(
        points=np.array([knot.middle for knot in knots]),
        radius=max(knot.radius for knot in knots),
        kind=judged.kind,
        continuity=judged.continuity,
        names=names,
        normals=np.array([jump.normals for jump in found]),
        tangent_jumps=_sizes(found, 0),
        curvature_jumps=_sizes(found, 1),
        tangent_jump=turn,
        tangent_jump_error=turn_error,
        curvature_jump=bend,
        curvature_jump_error=bend_error,
        traced="lost" not in component.ends and not search.open,
        proved=judged.proved,
        reason="; ".join([judged.reason, *_between(jumps, component, judged.kind), *_remarks(search, component)]),
    )


def _between(jumps: SheetJumps, component: Component, kind: str) -> list[str]:
    """The jump between the points, enclosed over the tubes."""
    if kind not in {"edge", "curvature jump"}:
        return []
    level = 0 if kind == "edge" else 1
    what, unit = (("angle", " degrees"), ("jump of curvature", ""))[level]
    pairs = zip(component.tubes, itertools.pairwise(component.knots), strict=False)  # no tubes if time is over
    bounds = [jumps.between(tube, start, end, level) for tube, (start, end) in pairs]
    known = [bound for bound in bounds if bound is not None]
    if len(known) < len(bounds) or not known:
        return [f"between the points the {what} is not enclosed"]
    low, high = min(low for low, _ in known) * (1 - _ROUNDED), max(high for _, high in known) * (1 + _ROUNDED)
    return [f"all along the {what} lies between {low:.4g} and {high:.4g}{unit}"]


def _remarks(search: Search, component: Component) -> list[str]:
    followed = "the continuation fails at an end" if "lost" in component.ends else "one curve, followed all along"
    if not search.open:
        return [followed]
    return [followed, f"{len(search.open)} of {len(search.boxes)} boxes stay open and may hold another curve"]


def _sizes(jumps: Sequence[Jump], level: int) -> Floats:
    """The jumps at all points: 0 where proved equal, NaN where there is none."""
    found = []
    for jump in jumps:
        value = jump.turn if level == 0 else jump.curvature
        equal = jump.steps[level] == "equal"
        found.append(math.nan if value is None else 0.0 if equal else float(value.mid()))
    return np.array(found)


def _worst(jumps: Sequence[tuple[arb, str]]) -> tuple[float, float]:
    """The largest of the jumps and its error; 0 where all are proved equal."""
    if not jumps:
        return math.nan, math.nan
    if all(step == "equal" for _, step in jumps):
        return 0.0, 0.0
    worst = max((value for value, _ in jumps), key=lambda value: float(value.mid()))
    return float(worst.mid()), float(arb(worst.rad()).upper()) + 2.0**-52 * float(abs(worst).upper())


def _unresolved(search: Search, box: Box, meeting: Meeting, names: tuple[str, str]) -> SingularCurve:
    """A box in which a curve was neither found nor excluded, as a curve of one point."""
    sides = [side(*one) for one in box[:3]]
    low, high = ends(sides)
    point = tuple(one.mid() for one in sides)
    return SingularCurve(
        points=((low + high) / 2)[None],
        radius=float(np.linalg.norm(high - low)) / 2,
        kind="unresolved",
        continuity="G0",
        names=names,
        normals=SheetJumps(search.curve, meeting).at(Knot(point, None, np.zeros(3))).normals[None],
        tangent_jumps=np.array([math.nan]),
        curvature_jumps=np.array([math.nan]),
        reason="a box in which a curve was neither found nor excluded",
    )
