"""Edges of roots: what a boundary is where the radicand of a root vanishes and omega ends with it, a leading edge.

Each leaf is a function of the root too (`lifting`), and its zeros are arcs with a tangent (P, Q) on which t grows by R.
Two such arcs end in one point p where their leaves and u have a common zero. Let J = grad G_1 . W_2: if it is not 0
on B x T, the arcs meet nowhere else, and the sign of G_1 along the second arc is that of J R_2 wherever that arc
comes from p; likewise with -J R_1. So the signs of the leaves in the three sectors at p are known, and with them which
of the arcs are boundary:
- both, with the inside between them: they are one curve through p, and omega has no value, or is negative, beyond;
- one: the boundary ends in p; neither: p is an isolated point of it.
At p itself (P, Q) = G_t (u_y, -u_x), and the curvature is sign(G_t) ((2 R**2/G_t**2) + h)/|grad u|**3 where h is that
of u = 0: tangents agree where the G_t have one sign, curvatures where R_1 G_t2 + R_2 G_t1 = 0. If one leaf is the other
with -t for t, the two arcs are one analytic curve.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product

from rsym.bounds.balls import arb, ball, ctx, root
from rsym.logic.kleene import Formula, ternary
from rsym.logic.stripping import bare, factor
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.verify.answers.report import Joint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import judged
from rsym.verify.boxes.krawczyk import Zero, common_zero, narrowed_zero, unique_zero
from rsym.verify.boxes.lifting import (
    ROOT,
    Lifted,
    across_of,
    bound_of,
    continues,
    is_regular,
    jet_of,
    lifted,
    with_root,
)
from rsym.verify.boxes.local import PRECISE, Local, Model
from rsym.verify.boxes.polynomials import same_zeros
from rsym.verify.boxes.resolution import put
from rsym.verify.boxes.sheets import sheets
from rsym.verify.boxes.vanishing import vanishes_with
from rsym.verify.boxes.vectors import floats, radius_of, sign_of

MOST = 4  # leaves at an edge: two, and what is cut off along the edge


@dataclass(frozen=True)
class RootEdge:
    """What a box at an edge holds: "regular", an analytic arc; "joined", two that meet in `joint`; "broken".

    No curvature is larger in size than `curvature`, of which at most the share `slack` is due to the enclosure.
    """

    kind: str
    curvature: float = math.inf
    slack: float = math.inf
    joint: Joint | None = None


def edge(local: Local, around: Local, number: int) -> RootEdge | None:
    """What is proved of the zeros of a node on a box on which the radicand of one root may vanish.

    Parameters
    ----------
    local, around : Local
        The box, and a little more of what surrounds it, in which the functions are examined.
    number : int
        The node.
    """
    parts = _edged(around, number)
    found = sheets(around, number) if len(parts) == 1 else None
    if found is None or not 1 <= len(found.leaves) <= MOST:
        return None
    builder, (part,) = around.model.builder, parts
    radicand, beyond = _radicand(builder, part)
    if not generators(around, radicand).analytic:
        return None
    edges = []
    for own in (radicand, builder.neg(radicand))[: 1 + (beyond == "mirrored")]:
        same = [leaf for leaf in found.leaves if bare(builder, leaf) == bare(builder, own)]
        cut = {leaf: factor(builder, leaf) * factor(builder, own) for leaf in same}
        place = _Place(local, around, part, own, beyond, found.formula, cut)
        edges.append(place.holds([leaf for leaf in found.leaves if leaf not in cut]))
    return edges[0] if len(edges) == 1 else _both(edges[0], edges[1])


def _both(first: RootEdge | None, second: RootEdge | None) -> RootEdge | None:
    """What the two sides of a switch u make together where the root is that of |u|."""
    if first is None or second is None or first.kind != second.kind or first.kind == "broken":
        return None
    if first.joint is None or second.joint is None:
        worse = max(first, second, key=lambda edge: edge.curvature)
        return worse if first.kind == "regular" else None
    reason = "two arcs meet on either side of where the radicand is zero"
    node = Joint(first.joint.point, first.joint.radius, "node", "broken", branches=4, proved=True, reason=reason)
    return RootEdge("broken", joint=node)


def _radicand(builder: Builder, part: int) -> tuple[int, str]:
    """The node u of a root, and what the root is where u < 0: "undefined", "zero" for max(u, 0), "mirrored" for |u|."""
    (radicand,) = builder.nodes[part].arguments
    operation, arguments, _ = builder.nodes[radicand]
    if operation == "abs":
        return arguments[0], "mirrored"
    if operation == "max" and any(builder.value(argument) == 0 for argument in arguments):
        return next(argument for argument in arguments if builder.value(argument) != 0), "zero"
    return radicand, "undefined"


def has_edges(local: Local, number: int) -> bool:
    """Whether there is a root in a node that may end on the box."""
    return bool(_edged(local, number))


def _edged(local: Local, number: int) -> list[int]:
    """The roots in a node whose radicand may be zero on the box, and negative beyond."""
    return [part for part in local.model.remembered(_ending, number) if _may_vanish(local, part)]


def _ending(model: Model, number: int) -> list[int]:
    """The roots in a node whose radicand may be negative somewhere, and those of |u|."""
    nodes, nonnegative = model.builder.nodes, model.builder.nonnegative
    roots = [part for part in model.order(number) if nodes[part].operation == "sqrt"]
    inner = [nodes[part].arguments[0] for part in roots]
    return [part for part, u in zip(roots, inner, strict=True) if not nonnegative[u] or nodes[u].operation == "abs"]


def _may_vanish(local: Local, part: int) -> bool:
    value = local.value(local.model.builder.nodes[part].arguments[0])
    return value is not None and value.contains(0)


@dataclass(frozen=True)
class _Place:
    """A box at the edge of a root, for u >= 0; `cut` are the leaves that are u times a constant of that sign."""

    local: Local
    around: Local
    part: int
    radicand: int
    beyond: str
    formula: Formula
    cut: Mapping[int, int]

    def lift(self, leaf: int) -> Lifted:
        """The leaf as a function of the root, remembered with the model."""
        return self.around.model.remembered(lifted, leaf, self.part, self.radicand)

    def above(self) -> Local:
        """The box with all values of the root."""
        square = self.around.value(self.radicand)
        largest = None if square is None else root(square)
        return with_root(self.around, arb(0, math.inf) if largest is None else ball(arb(0), largest.upper()))

    def end(self, leaf: Lifted) -> Zero | None:
        """The end of the arc of a leaf."""
        return common_zero(self.around, (leaf.flat, self.radicand))

    def sign(self, leaves: Sequence[int], signs: Sequence[int], side: int) -> int:
        """The sign of omega where leaves have some signs, and u has that of `side`."""
        fixed = {leaf: sign * side for leaf, sign in self.cut.items()}
        return ternary(self.formula, {**fixed, **dict(zip(leaves, signs, strict=True))})

    def holds(self, leaves: Sequence[int]) -> RootEdge | None:
        """What there is of the boundary where u >= 0, if there is nothing of it where u < 0."""
        values = product((-1, 0, 1), repeat=len(leaves))
        if self.beyond == "zero" and any(self.sign(leaves, signs, -1) != -1 for signs in values):
            return None
        if len(leaves) == 1:
            return self.alone(leaves[0])
        return self.paired(leaves[0], leaves[1]) if len(leaves) == 2 else None

    def alone(self, leaf: int) -> RootEdge | None:
        """One leaf: its arc ends at the edge, or does not come there."""
        arc, above = self.lift(leaf), self.above()
        zero = self.end(arc)
        if zero is None or not generators(above, arc.function).analytic:
            return None
        if zero.meets(self.local):
            if self.cut or self.beyond != "undefined" or not above.nonzero(arc.tangent[2]):
                return None
            at = narrowed_zero(self.around, (arc.flat, self.radicand), zero)
            reason = "omega is an analytic function of a root whose radicand is zero here: one arc leads to its edge"
            return self.broken(at, arc, "end", reason)
        flat = self.around.sign(arc.flat)
        there = [self.sign([leaf], [sign], 0) for sign in ((flat,) if flat else (1, -1))]
        changes = self.sign([leaf], [1], 1) * self.sign([leaf], [-1], 1) == -1 and not self.sign([leaf], [0], 1)
        if 0 in there or not changes or not is_regular(above, arc):
            return None
        return RootEdge("regular", *bound_of(above, [arc]))

    def broken(self, at: Local, arc: Lifted, kind: str, reason: str) -> RootEdge | None:
        """No curve at the end of an arc."""
        if is_within(at, (arc.flat, self.radicand)) is not True:
            return None
        place, branches = at.sides[:2], 0 if kind == "isolated point" else 1
        joint = Joint(floats(place), radius_of(place), kind, "broken", branches=branches, proved=True, reason=reason)
        return RootEdge("broken", joint=joint)

    def paired(self, first: int, second: int) -> RootEdge | None:
        """Two leaves whose arcs end in one point."""
        above, arcs = self.above(), (self.lift(first), self.lift(second))
        if not all(generators(above, arc.function).analytic and is_regular(above, arc) for arc in arcs):
            return None
        ends = [self.end(arc) for arc in arcs]
        turns = [above.sign(arc.tangent[2]) for arc in arcs]
        across = sign_of(across_of(above, arcs[0], arcs[1]))
        if any(end is None for end in ends):
            return None
        if not any(end.exists for end in ends if end is not None):
            return self.apart((first, second), arcs, above)
        if not all(end.exists for end in ends if end is not None) or 0 in turns or not across:
            return None
        assert ends[0] is not None
        at = narrowed_zero(self.around, (arcs[0].flat, self.radicand), ends[0])
        if not self.meet(at, arcs):
            return None
        between = across * turns[1], -across * turns[0]  # the signs of the leaves between the arcs
        kind = self.sectors((first, second), between, turns)
        if kind == "both":
            return self.joined(at, arcs, between, above)
        if kind is None or not ends[0].meets(self.local):
            return None
        reasons = {
            "end": "one of two arcs that end with a root leads here, the other is no boundary",
            "isolated point": "two arcs that end with a root lead here, and neither is boundary",
        }
        return self.broken(at, arcs[0], kind, reasons[kind])

    def apart(self, leaves: Sequence[int], arcs: Sequence[Lifted], above: Local) -> RootEdge | None:
        """Two leaves whose arcs do not end here, if they do not meet either: each is boundary or not, as it goes."""
        model, builder = above.model, above.model.builder
        beside = builder.sub(builder.square(builder.input(ROOT)), self.radicand)
        nodes = (arcs[0].function, arcs[1].function, beside)
        slopes = [(*model.gradient(node), derivative(builder, node, ROOT)) for node in nodes]
        rest = above.sides[2:]

        def local(point: Sequence[arb]) -> Local:
            return with_root(model.on([*point[:2], *rest]), point[2])

        zero = unique_zero(
            lambda point: [local(point).ball(node) for node in nodes],
            lambda point: [[local(point).ball(slope) for slope in row] for row in slopes],
            (above.sides[0], above.sides[1], above.inputs[ROOT]),
        )
        if zero is None or zero.exists:
            return None
        pairs = list(product((1, -1), repeat=2))
        if any(self.sign(leaves, pair, 0) == 0 for pair in pairs):
            return None
        for sign in (1, -1):
            for one, other, on in (((sign, 1), (sign, -1), (sign, 0)), ((1, sign), (-1, sign), (0, sign))):
                changes = self.sign(leaves, one, 1) != self.sign(leaves, other, 1)
                if changes != (self.sign(leaves, on, 1) == 0):
                    return None
        return RootEdge("regular", *bound_of(above, arcs))

    def sectors(self, leaves: Sequence[int], between: Sequence[int], turns: Sequence[int]) -> str | None:
        """What two arcs that end in one point make of it, by the signs of the formula around it."""

        def formula(signs: Sequence[int], side: int) -> int:
            return self.sign(leaves, signs, side)

        beyond = (formula((turns[0], turns[1]), 0), formula((-turns[0], -turns[1]), 0))
        middle = formula(between, 1)
        aside = formula((-between[0], between[1]), 1), formula((between[0], -between[1]), 1)
        on_arcs = formula((0, between[1]), 1), formula((between[0], 0), 1)
        if 0 in (*beyond, middle, *aside) or formula((0, 0), 0) != 0:
            return None
        if any(on != (0 if side == -middle else middle) for on, side in zip(on_arcs, aside, strict=True)):
            return None
        active = aside.count(-middle)
        if active == 2:
            return "both" if middle > 0 and beyond == (-1, -1) else None
        return "end" if active else "isolated point"

    def joined(self, at: Local, arcs: Sequence[Lifted], between: Sequence[int], above: Local) -> RootEdge | None:
        """Two arcs that are one curve: the jump of tangent and curvature from one to the other."""
        bound = bound_of(above, arcs)
        within = is_within(at, (arcs[0].flat, self.radicand))
        here = all(a.overlaps(b) for a, b in zip(at.sides, self.local.sides, strict=False))
        continued = self.beyond != "mirrored" and continues(self.around.model, *arcs)
        if not here or within is False or continued:
            return RootEdge("regular", *bound)
        if within is None or len(self.local.sides) > 2:
            return None
        with ctx.workprec(PRECISE):
            on_edge = with_root(at, arb(0))
            signs = [on_edge.sign(arc.slope) * sign for arc, sign in zip(arcs, between, strict=True)]
            if 0 in signs:
                return None
            order = 2 if signs[0] == signs[1] else 1
            if order == 2 and self.curves_agree(at, arcs):
                order = 3
            jets = {}
            for arc, sign in zip(arcs, between, strict=True):
                jets[on_edge.sign(arc.tangent[2]) * sign] = jet_of(on_edge, arc, sign)
            if set(jets) != {1, -1}:
                return None
            found = judged((at.sides[0], at.sides[1]), jets[-1], jets[1], order)
        if found is None:
            return None
        if order == 1 and found.kind == "corner":
            found = replace(found, kind="cusp")
        return RootEdge("joined", *bound, joint=found)

    def meet(self, at: Local, arcs: Sequence[Lifted]) -> bool:
        """Whether the second leaf too is zero at p, the end of the first arc."""
        model, nothing = at.model, {self.radicand: at.model.builder.const(0)}
        if same_zeros(model, *(put(model, arc.flat, nothing) for arc in arcs), free=True):
            return True
        with ctx.workprec(PRECISE):
            return vanishes_with(at, (arcs[0].flat, self.radicand), arcs[1].flat)

    def curves_agree(self, at: Local, arcs: Sequence[Lifted]) -> bool:
        """Whether R_1 G_t2 + R_2 G_t1 is exactly zero at p."""
        model = at.model
        b, (first, second) = model.builder, arcs
        sum_ = b.add(b.mul(first.tangent[2], second.slope), b.mul(second.tangent[2], first.slope))
        zero = b.const(0)
        flat = put(model, sum_, {b.input(ROOT): zero, self.radicand: zero})
        return same_zeros(model, flat, zero, free=True) or vanishes_with(at, (arcs[0].flat, self.radicand), flat)
