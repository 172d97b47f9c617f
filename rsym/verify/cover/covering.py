"""Subdivision: the boxes into which a region falls until each is settled, or too small to go on."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from rsym.bounds.balls import ctx
from rsym.bounds.intervals import IntervalFunction
from rsym.logic.sign_form import decided
from rsym.model.shape import Shape
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.lowering import lower
from rsym.sampling.progress import Effort
from rsym.verify.answers.account import Balance
from rsym.verify.boxes.local import PRECISION, Box, Interval, Model
from rsym.verify.cover.arcs import ArcInspector
from rsym.verify.cover.inspection import OPEN, Inspection

COARSEST = 1 / 24  # of the extent: larger regular boxes are divided, so that the cover follows the boundary
FINER = 600  # boxes into which a few that were left over are divided further: a disc takes 130
FINEST, RESOLVED = 2.0**-18, 2.0**-44  # of those boxes, and of their coordinates: what is narrower is not divided
REPORTED = 64  # boxes between two reports of progress
# The first cut is off centre, so that no side of a box lies on the planes of symmetry of a model.
OFF_CENTRE = 0.4375 + 1 / 64


Prune = Callable[[Sequence[Box]], Sequence[bool]]


@dataclass
class Covering:
    """Settled boxes with what was found on them, and the boxes left over.

    All boxes that were `made` are settled, left, `divided`, or `empty` of zeros.
    """

    settled: list[tuple[Box, Inspection]] = field(default_factory=list)
    left: list[tuple[Box, Inspection]] = field(default_factory=list)
    examined: int = 0
    made: int = 0
    empty: int = 0
    divided: int = 0

    def finer(self, covers: Mapping[Box, Covering]) -> Covering:
        """The same with some of the boxes that were left over divided further, and settled.

        Examples
        --------
        >>> box = ((0.0, 1.0), (0.0, 1.0))
        >>> found = Covering(left=[(box, OPEN)], made=1).finer({box: Covering(examined=4, made=4, empty=4)})
        >>> found.left, found.made, found.balance.made == found.balance.closed
        ([], 5, True)
        """
        parts = [self, *covers.values()]
        return Covering(
            settled=[pair for part in parts for pair in part.settled],
            left=[(box, finding) for box, finding in self.left if box not in covers],
            divided=sum(part.divided for part in parts) + len(covers),
            **{name: sum(getattr(part, name) for part in parts) for name in ("examined", "made", "empty")},
        )

    @property
    def balance(self) -> Balance:
        """The boxes that were made, and those of which it is known what became of them."""
        return Balance(self.made, self.empty + self.divided + len(self.settled) + len(self.left))


def cover(
    model: Model,
    bounds: Box,
    *,
    smallest: float,
    budget: int,
    prune: Prune | None = None,
    effort: Effort | None = None,
) -> Covering:
    """Subdivide the bounds, breadth first, until every box is settled, too narrow, too many, or the time is over.

    `prune` says of many boxes at once which certainly hold no zero; the others are examined one by one.
    """
    result, extent, effort = Covering(), extent_of(bounds), effort or Effort()
    inspectors = ArcInspector(extent), ArcInspector(extent, bounded=False)
    level = list(_first(bounds))
    with ctx.workprec(PRECISION):
        while level:
            result.made += len(level)
            if prune is not None:
                kept = [box for box, empty in zip(level, prune(level), strict=True) if not empty]
                result.empty += len(level) - len(kept)
                level = kept
            following: list[Box] = []
            undecided = _undecided(level, result)
            for box in level:
                if result.examined >= budget or effort.is_over:
                    result.left.append((box, OPEN))
                    continue
                following.extend(_settled(model, box, inspectors, smallest, result))
                if result.examined % REPORTED == 0:
                    effort.reach(1 - undecided, undecided=undecided)
            level = following
    undecided = _undecided([], result)
    effort.reach(1 - undecided, undecided=undecided)
    return result


def settled_finely(model: Model, boxes: Sequence[Box], effort: Effort) -> dict[Box, Covering]:
    """What smaller boxes say of a few that were too small to be divided; nothing if they do not settle them all."""
    budget, covers = FINER, {}
    width, far = max(map(extent_of, boxes)), max(abs(end) for box in boxes for ends in box[:2] for end in ends)
    for box in boxes:
        covers[box] = found = cover(
            model, box, smallest=max(FINEST * width, RESOLVED * far), budget=budget, effort=effort
        )
        budget -= found.examined
        if found.left:
            return {}
    return covers


def _undecided(level: Sequence[Box], found: Covering) -> float:
    """The share of the boundary on which nothing is proved yet, each box counted by its longer side."""
    opened = sum(extent_of(box) for box in level) + sum(extent_of(box) for box, _ in found.left)
    settled = sum(extent_of(box) for box, _ in found.settled)
    return opened / (opened + settled) if opened else 0.0


def _settled(
    model: Model, box: Box, inspectors: tuple[ArcInspector, ArcInspector], smallest: float, result: Covering
) -> list[Box]:
    """Examine a box and note what is found on it; what is still open is returned in parts.

    The second inspector is for boxes that are divided though there is one regular arc on them.
    """
    result.examined += 1
    width = max(high - low for low, high in box[:2])
    coarse = width > inspectors[0].extent * COARSEST and len(box) == 2
    finding = inspectors[coarse and width > smallest].inspect(model.over(box))
    if (coarse and finding.kind == "regular") or (finding.kind == "open" and width > smallest):
        result.divided += 1
        return halves(model, box)
    if finding.kind == "empty":
        result.empty += 1
    else:
        (result.left if finding.kind == "open" else result.settled).append((box, finding))
    return []


def extent_of(bounds: Box) -> float:
    """The longer side of the region."""
    return max(high - low for low, high in bounds[:2])


def _first(bounds: Box) -> Iterator[Box]:
    boxes: list[Box] = [bounds]
    for axis in range(2):
        low, high = bounds[axis]
        boxes = [half for box in boxes for half in _cut(box, axis, low + OFF_CENTRE * (high - low))]
    return iter(boxes)


def _cut(box: Box, axis: int, at: float) -> tuple[Box, Box]:
    low, high = box[axis]
    return (*box[:axis], (low, at), *box[axis + 1 :]), (*box[:axis], (at, high), *box[axis + 1 :])


def halves(model: Model, box: Box) -> list[Box]:
    """The box cut in two across both coordinates, or across the letter to which the model is most sensitive on it."""
    axis = _widest_letter(model, box)
    if axis is not None:
        return list(_cut(box, axis, _middle(box, axis)))
    return [half for one in _cut(box, 0, _middle(box, 0)) for half in _cut(one, 1, _middle(box, 1))]


def _middle(box: Box, axis: int) -> float:
    low, high = box[axis]
    return low + (high - low) / 2


def _widest_letter(model: Model, box: Box) -> int | None:
    """The letter whose range on the box changes omega more than the coordinates do."""
    if len(box) == 2:
        return None
    local = model.over(box)
    balls = [local.value(derivative(model.builder, model.root, axis)) for axis in model.axes]
    slopes = [math.inf if ball is None else float(abs(ball).upper()) for ball in balls]
    known = max((slope for slope in slopes if math.isfinite(slope)), default=1.0)  # at a kink a slope has no bound
    smears = [min(slope, known) * (high - low) for slope, (low, high) in zip(slopes, box, strict=True)]
    widest = max(range(2, len(box)), key=smears.__getitem__)
    return widest if smears[widest] > max(smears[:2]) else None


def bounds_of_omega(shape: Shape, axes: Sequence[str], letters: Iterable[str]) -> IntervalFunction:
    """Omega over boxes with sides along the axes; letters that range are axes."""
    builder = Builder(tuple(symbol.name for symbol in shape.coordinates), tuple(letters))
    program = builder.program({"value": decided(builder, lower(builder, shape.expression))})
    return IntervalFunction(program.varying(axes[2:]), "numpy", 1)


def pruner(function: IntervalFunction, axes: Sequence[str], letters: Mapping[str, Interval]) -> Prune:
    """A function of boxes, with sides along the axes, that is true for those on which omega is not zero anywhere.

    Letters that range are axes: each box has its own part of the range.
    """
    fixed = {name: value for name, value in letters.items() if name not in axes}

    def prune(boxes: Sequence[Box]) -> Sequence[bool]:
        ends = np.array(boxes, dtype=np.float64)
        low, high = function(list(ends[..., 0].T), list(ends[..., 1].T), fixed)["value"]
        empty: list[bool] = ((low > 0) | (high < 0)).tolist()
        return empty

    return prune
