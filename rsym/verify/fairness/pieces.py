"""Pieces of a boundary: boxes that hug one analytic arc.

Where one component of grad F excludes zero on a box, F = 0 is a graph over the other axis: Newton's interval operator
narrows the box to it, and proves that there is a point above each place of the axis where its image lies within the
box.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rsym.bounds.balls import arb, ctx
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import BoundaryArc, meeting
from rsym.verify.boxes.local import Box, Local, Model, side
from rsym.verify.boxes.locus import reduce
from rsym.verify.boxes.resolution import resolve
from rsym.verify.cover.arcs import ArcInspector
from rsym.verify.cover.covering import halves

NEWTON_STEPS = 6
SLOWEST = 0.7  # of the width: a step that leaves more is the last
# The graph may leave a box by a side, across which it is followed for this share of the width of the box.
GROWN = 0.125
POINT_BITS = 128  # of balls around single points of an arc, which then have 25 digits and more


@dataclass(frozen=True)
class ArcPiece:
    """The part of an arc {function = 0}, or {function = 0, side >= 0} if `joined`, in a box.

    `whole` is the settled box that it was cut from; of the function the branches that are not taken on it are left
    out, so that the arc of a circle is that of a polynomial. `free` is the axis over which the arc is a graph, None
    where that is not known; `crosses` says that there is a point of function = 0 above every place of it.
    """

    box: Box
    whole: Box
    arc: BoundaryArc
    joined: bool
    analytic: bool
    free: int | None = None
    crosses: bool = False

    @property
    def width(self) -> float:
        """The longer side."""
        return max(high - low for low, high in self.box)


def pieces_of(model: Model, box: Box, extent: float) -> list[ArcPiece] | None:
    """The arcs in a settled box; None where it holds no curve that is known to be regular.

    Of a body of revolution the half of the meridian with a positive radius counts.
    """
    whole = box
    if model.body:
        whole = (box[0], (max(box[1][0], 0.0), box[1][1]))
        if box[1][1] < 0:
            return []
    finding = ArcInspector(extent).inspect(model.over(box))
    if finding.kind == "empty":
        return []
    if finding.kind not in {"regular", "joined"}:
        return None
    local, locus = model.over(whole), finding.locus
    found = generators(local, locus.nodes[0]) if locus.kind == "leaf" else None
    if found is not None and found.analytic:
        function = plain(local, locus.nodes[0])
        return [ArcPiece(whole, whole, BoundaryArc(function, function), False, True)]
    arcs = meeting(local, locus, found)
    if arcs is None:
        return None
    plainer = [BoundaryArc(plain(local, arc.function), arc.side) for arc in arcs.arcs]
    return [ArcPiece(whole, whole, arc, True, generators(local, arc.function).analytic) for arc in plainer]


def plain(local: Local, number: int) -> int:
    """The node without the branches that are not taken on the box."""
    return resolve(local, number, -1, 1)


def narrowed(model: Model, piece: ArcPiece) -> ArcPiece | None:
    """The piece in the smallest box around its arc; None where there is none."""
    local = model.over(piece.box)
    if piece.joined and local.sign(piece.arc.side) < 0:
        return None
    slopes = [float(abs(slope).lower()) for slope in local.gradient(piece.arc.function)]
    if not max(slopes) > 0:
        return None if local.nonzero(piece.arc.function) else piece
    across = 0 if slopes[0] > slopes[1] else 1
    box = _with_rim(model, piece, across)
    found = _graph(model, piece.arc.function, box, across)
    if found is None:
        return None
    (low, high), (least, most) = found[0][across], piece.whole[across]
    if low > most or least > high:
        return None
    return replace(piece, box=found[0], free=1 - across, crosses=found[1] and piece.analytic)


def _with_rim(model: Model, piece: ArcPiece, across: int) -> Box:
    """The box, wider across the arc where the arc goes on as it is."""
    box = grown(piece.box, across)
    steep = model.over(box).gradient(piece.arc.function)[across]
    return box if bool(steep != 0) and goes_on(model, piece, box) else piece.box


def grown(box: Box, axis: int, share: float = GROWN) -> Box:
    """The box with a rim on two sides."""
    low, high = box[axis]
    rim = share * (high - low)
    return (*box[:axis], (low - rim, high + rim), *box[axis + 1 :])


def goes_on(model: Model, piece: ArcPiece, box: Box) -> bool:
    """Whether the boundary on another box is, as far as it is this arc, described by the same analytic function."""
    local = model.over(box)
    if not piece.joined:
        locus = reduce(local, model.root)
        if locus.kind != "leaf" or plain(local, locus.nodes[0]) != piece.arc.function:
            return False
    return generators(local, piece.arc.function).analytic


def _graph(model: Model, function: int, box: Box, across: int) -> tuple[Box, bool] | None:
    """The box narrowed across the arc, and whether there is a point above every place of the other axis."""
    sides, crosses = [side(*ends) for ends in box], False
    for _ in range(NEWTON_STEPS):
        before = sides[across]
        image = _newton(model, function, sides, across)
        if image is None:
            break
        if not image.overlaps(before):
            return None
        crosses = crosses or bool(before.contains(image))
        sides[across] = image.intersection(before)
        if float(sides[across].rad()) > SLOWEST * float(before.rad()):
            break
    narrow = outward(sides[across])
    return (*box[:across], narrow, *box[across + 1 :]), crosses


def outward(ball: arb) -> tuple[float, float]:
    """An interval of floats around a ball."""
    return math.nextafter(float(ball.lower()), -math.inf), math.nextafter(float(ball.upper()), math.inf)


def _newton(model: Model, function: int, sides: list[arb], across: int) -> arb | None:
    """M - F(X, m)/F_y(X, Y), F(X, m) by the mean value form along X; None where it is unbounded."""
    along, middle = 1 - across, sides[across].mid()
    steep = model.on(sides).gradient(function)[across]
    line = list(sides)
    line[across] = middle
    at = model.on(line)
    value = at.value(function)
    if value is None:
        return None
    if not sides[along].is_exact():
        centre = list(line)
        centre[along] = sides[along].mid()
        start = model.on(centre).value(function)
        if start is None:
            return None
        sharper = start + at.gradient(function)[along] * (sides[along] - centre[along])
        if sharper.is_finite() and value.overlaps(sharper):
            value = value.intersection(sharper)
    image = middle - value / steep
    return image if image.is_finite() else None


def point_above(model: Model, piece: ArcPiece, place: arb) -> list[arb] | None:
    """The point of an arc that crosses above a place of its free axis, in a narrow ball; None where it is not found."""
    assert piece.free is not None
    across = 1 - piece.free
    sides = [place, place]
    sides[across] = side(*piece.box[across])
    with ctx.workprec(POINT_BITS):
        for _ in range(2 * NEWTON_STEPS):
            image = _newton(model, piece.arc.function, sides, across)
            if image is None or not image.overlaps(sides[across]):
                return None
            before, sides[across] = sides[across], image.intersection(sides[across])
            if float(sides[across].rad()) > SLOWEST * float(before.rad()):
                break
    return sides


def divided(model: Model, piece: ArcPiece) -> list[ArcPiece]:
    """The parts of a piece: across the axis over which it is a graph, else across both.

    A graph that is cut across the other axis as well would leave the parts by the cut.
    """
    if piece.free is None:
        boxes = halves(model, piece.box)
    else:
        low, high = piece.box[piece.free]
        middle = low + (high - low) / 2
        boxes = [_set(piece.box, piece.free, ends) for ends in ((low, middle), (middle, high))]
    return [replace(piece, box=box, crosses=False, free=None) for box in boxes]


def _set(box: Box, axis: int, ends: tuple[float, float]) -> Box:
    return (*box[:axis], ends, *box[axis + 1 :])


def lies_within(point: list[arb], piece: ArcPiece, local: Local) -> bool:
    """Whether a point of the function's zero set is proved to be one of the piece's own part of the boundary."""
    inside = all(side(*ends).contains(ball) for ball, ends in zip(point, piece.whole, strict=True))
    return inside and is_within(local) is True and (not piece.joined or local.sign(piece.arc.side) > 0)
