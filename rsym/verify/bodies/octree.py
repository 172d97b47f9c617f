"""The octree: boxes into which a region in space falls until each is settled, or too small to go on.

A level of boxes at a time: intervals in float64 discard most and settle nearly all that hold one analytic sheet or
two that cross; balls decide what is left. The results do not depend on how many threads there are.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.codegen.balls import ctx
from rsym.sampling.progress import Progress, report
from rsym.verify.bodies.boxes import area, eighths, grown, halves, listed
from rsym.verify.bodies.corners import Corner
from rsym.verify.bodies.formation import DOUBLE, MAX, MIN, OPEN
from rsym.verify.bodies.formulas import Formula, as_gate, leaves_of
from rsym.verify.bodies.images import Array, Boxes, Flags, Images
from rsym.verify.bodies.independence import apart, independent, step_to_both
from rsym.verify.bodies.inspection import Inspection, inspect, is_even
from rsym.verify.covering import PRECISION
from rsym.verify.joints import Arc, Meeting
from rsym.verify.local import Box

COARSEST = 1 / 16  # of the extent: larger boxes are divided, so that the cover follows the boundary
BALLS_FROM = 1 / 32  # of the extent: on larger boxes balls rarely say more than float64 intervals
# Boxes so many and so narrow are those of a surface on which nothing can be proved; the car takes 6 000 at most.
MOST, WIDE = 50_000, 1 / 128
BESIDE = 1 + 2.0**-20  # a curve that runs along a side of a box counts as in it
MANY, DETAIL = 4096, 1e-3  # boxes that make less than this share of the boundary are left as they are
CORNERS_FROM = 1 / 64  # of the extent: a curve runs nearly straight through a box with a corner


@dataclass
class Subdivision:
    """Settled boxes by what was found on them, and those left over."""

    regular: dict[int, list[Boxes]] = field(default_factory=dict)  # by the node of the sheet
    order: float = np.inf  # the lowest of the regular sheets
    joined: dict[Meeting, list[Boxes]] = field(default_factory=dict)
    corners: list[tuple[Box, Corner]] = field(default_factory=list)
    double: list[Box] = field(default_factory=list)
    left: list[tuple[Box, Inspection]] = field(default_factory=list)
    late: list[Box] = field(default_factory=list)  # regular, but found so only afterwards
    examined: int = 0
    inspected: int = 0

    def with_late(self, regular: Sequence[Box], corners: Sequence[tuple[Box, Corner]]) -> Subdivision:
        """The same, with some boxes that were left over found to be regular after all, or to hold a corner."""
        settled = {*regular, *(box for box, _ in corners)}
        left = [pair for pair in self.left if pair[0] not in settled]
        return replace(self, left=left, late=list(regular), corners=[*self.corners, *corners])


class Sheets(NamedTuple):
    """The functions of the sheets on a box, and what joins two; none where it takes a closer look to know them."""

    nodes: tuple[int, ...]
    gate: int


HARD = Sheets((), OPEN)


class _State(NamedTuple):
    """A level of boxes, which of them are to be divided, and which need a closer look.

    `beside`: the places of boxes in which two sheets cross, if at all, and their curve seems not to pass.
    """

    level: Boxes
    divided: Flags
    hard: Flags
    beside: list[tuple[Sheets, NDArray[np.int64]]]


class Octree:
    """Subdivides a region level by level."""

    def __init__(
        self,
        images: Images,
        region: Box,
        *,
        smallest: float,
        budget: int,
        inspections: int,
        progress: Progress | None = None,
    ) -> None:
        self.images, self.region = images, region
        self.extent = max(high - low for low, high in region[:3])
        self.smallest, self.budget, self.inspections = smallest, budget, inspections
        self.progress = progress
        self.found = Subdivision()
        self._known: dict[tuple[int, ...], Sheets | None] = {}

    def run(self) -> Subdivision:
        """Subdivide until every box is settled, narrower than `smallest`, or too many."""
        level = np.array(list(eighths(self.region)))
        while len(level):
            self.found.examined += len(level)
            report(self.progress, min(self.found.examined, self.budget), self.budget)
            level = self._level(level)
        report(self.progress, self.budget, self.budget)
        return self.found

    def _level(self, level: Boxes) -> Boxes:
        alive, joined, defined, signs = self.images.alive(level)
        keep = alive.any(axis=0) | (joined == OPEN) | ~defined
        level, alive, joined, defined, signs = level[keep], alive[:, keep], joined[keep], defined[keep], signs[:, keep]
        widths = (level[..., 1] - level[..., 0]).max(axis=1)
        divided = widths > COARSEST * self.extent
        small = np.flatnonzero(~divided)
        state = _State(level, divided, np.zeros(len(level), bool), [])
        for sheets, own in self._grouped(alive[:, small], joined[small], defined[small], signs[:, small]).items():
            self._settle(sheets, small[own], state)
        divided |= state.hard & (widths > BALLS_FROM * self.extent)
        self._inspect(state, widths, defined)
        tiny = widths <= self.smallest
        self._leave(state, divided & tiny)
        following: Boxes = level[divided & ~tiny]
        enough = len(following) > MOST and bool(widths.max(initial=0) < WIDE * self.extent)
        if enough or self.found.examined + 8 * len(following) > self.budget or self._is_detail(following):
            self._leave(state, divided & ~tiny)
            return following[:0]
        return halves(following)

    def _is_detail(self, boxes: Boxes) -> bool:
        """Whether so many boxes make so little of the boundary that dividing them further would not be worth it."""
        if len(boxes) < MANY:
            return False
        settled = [*(part for parts in self.found.regular.values() for part in parts), *joined_boxes(self.found)]
        return bool(area(boxes) < DETAIL * sum(area(part) for part in settled))

    def _leave(self, state: _State, own: Flags) -> None:
        """Boxes that are not divided any more: those beside the curve of two sheets are settled all the same."""
        for sheets, crossing in state.beside:
            settled = crossing[own[crossing]]
            if len(settled):
                self.found.joined.setdefault(self._meeting(sheets), []).append(state.level[settled])
                own[settled] = False
        self.found.left.extend((box, Inspection("open")) for box in listed(state.level[own]))

    def _grouped(
        self, alive: Flags, joined: NDArray[np.int8], defined: Flags, signs: NDArray[np.int8]
    ) -> dict[Sheets, NDArray[np.int64]]:
        """The boxes by the sheets that they can hold; those that hold none are left out."""
        groups: dict[Sheets, list[NDArray[np.int64]]] = {}
        count = alive.sum(axis=0)
        simple = defined & (joined != OPEN) & (count <= 2)
        leaves = self.images.formed.leaves
        codes = np.where(count == 1, 0, joined).astype(np.int8)
        for place, pattern in _patterns(np.concatenate([alive, codes[None]]), np.flatnonzero(simple)):
            nodes = tuple(leaves[k] for k in np.flatnonzero(pattern[:-1]))
            opposite = len(nodes) == 2 and self.images.model.builder.neg(nodes[0]) == nodes[1]
            sheets = Sheets(nodes[:1], DOUBLE) if opposite else Sheets(nodes, int(pattern[-1]))
            groups.setdefault(sheets, []).append(place)
        for place, pattern in _patterns(signs, np.flatnonzero(~simple & defined)):
            found = self._logic(tuple(pattern.tolist()))
            if found is not None:
                groups.setdefault(found, []).append(place)
        groups.setdefault(HARD, []).append(np.flatnonzero(~defined))
        return {sheets: np.concatenate(places) for sheets, places in groups.items()}

    def _logic(self, signs: tuple[int, ...]) -> Sheets | None:
        """The sheets of boxes on which the leaves have these signs; None where there are none."""
        if signs not in self._known:
            formula = self.images.formed.logic(signs)
            self._known[signs] = HARD if formula is None else self._sheets(formula)
        return self._known[signs]

    def _sheets(self, formula: Formula) -> Sheets | None:
        leaves, single = leaves_of(formula), as_gate(formula)
        b, nodes = self.images.model.builder, self.images.formed.leaves
        if not leaves:
            return None
        if len(leaves) > 2:
            return Sheets(tuple(nodes[k] for k in leaves), OPEN)
        if single is None:
            return Sheets((nodes[leaves[0]],), DOUBLE) if len(leaves) == 1 else HARD
        operation, signs = single
        signed = (nodes[k] if sign > 0 else b.neg(nodes[k]) for k, sign in zip(leaves, signs, strict=True))
        return Sheets(tuple(signed), 0 if len(leaves) == 1 else MIN if operation == "min" else MAX)

    def _settle(self, sheets: Sheets, own: NDArray[np.int64], state: _State) -> None:
        """Boxes with one sheet are settled where it is regular, those with two where they cross."""
        if not sheets.nodes or is_even(self.images.model.builder, sheets.nodes[0]):
            state.hard[own] = True
            return
        boxes, count = state.level[own], len(sheets.nodes)
        slopes, flags = self._slopes(sheets.nodes, boxes if count == 1 else grown(boxes))
        analytic, crossing = np.logical_and.reduce(flags), independent(slopes)
        if count == 2:
            single, passed = self._passed(sheets.nodes, boxes)
            single &= analytic & independent(slopes[:1]) & independent(slopes[1:])
            for node in sheets.nodes if single.any() else ():
                self.found.regular.setdefault(node, []).append(boxes[single])
            state.beside.append((sheets, own[analytic & crossing & ~passed & ~single]))
            crossing &= passed
            own, boxes, analytic, crossing = own[~single], boxes[~single], analytic[~single], crossing[~single]
        if sheets.gate == DOUBLE:
            both = analytic & crossing & self._changes_sign(sheets.nodes[0], boxes)
            self.found.double.extend(listed(boxes[both]))
            analytic, crossing, own, boxes = analytic[~both], crossing[~both] & False, own[~both], boxes[~both]
        state.hard[own[~analytic | (crossing & (count == 3))]] = True
        state.divided[own[analytic & ~crossing]] = True
        done = boxes[analytic & crossing]
        if len(done) and count == 1:
            self.found.regular.setdefault(sheets.nodes[0], []).append(done)
        elif len(done) and count == 2:
            self.found.joined.setdefault(self._meeting(sheets), []).append(done)

    def _slopes(self, nodes: Sequence[int], boxes: Boxes) -> tuple[list[tuple[Array, Array]], list[Flags]]:
        """The gradients of nodes over boxes, and where they are analytic."""
        found = [self.images.slopes(node, boxes) for node in nodes]
        return [(low, high) for low, high, _ in found], [analytic for _, _, analytic in found]

    def _changes_sign(self, node: int, boxes: Boxes) -> Flags:
        """Whether a node certainly has both signs at corners of a box."""
        seen = np.zeros((2, len(boxes)), bool)
        for ends in product((0, 1), repeat=3):
            points = boxes[:, range(3), list(ends)]
            low, high = self.images.first(node, np.stack([points, points], axis=-1))[0]
            seen |= [low > 0, high < 0]
        both: Flags = np.logical_and(seen[0], seen[1])
        return both

    def _passed(self, nodes: Sequence[int], boxes: Boxes) -> tuple[Flags, Flags]:
        """Where two sheets certainly do not meet in a box, and where their curve seems to pass through it."""
        middle = boxes.mean(axis=-1)
        points = np.stack([middle, middle], axis=-1)
        values = [self.images.first(node, points)[0] for node in nodes]
        # The subtractions are rounded: a unit more is outward.
        reach = np.maximum(middle - boxes[..., 0], boxes[..., 1] - middle).T * (1 + 2.0**-51)
        slopes = self._slopes(nodes, boxes)[0]
        return apart(values, slopes, reach), (np.abs(step_to_both(values, slopes)) <= BESIDE * reach).all(axis=0)

    def _meeting(self, sheets: Sheets) -> Meeting:
        f, g = sheets.nodes
        b = self.images.model.builder
        sides = (g, f) if sheets.gate == MIN else (b.neg(g), b.neg(f))
        return Meeting((Arc(f, sides[0]), Arc(g, sides[1])), 1)

    def _inspect(self, state: _State, widths: Array, defined: Flags) -> None:
        """What balls say of hard boxes, one by one; those that stay open are divided, the smallest are left."""
        model, found = self.images.model, self.found
        with ctx.workprec(PRECISION):
            for at in np.flatnonzero(state.hard & ~state.divided):
                if found.inspected >= self.inspections:
                    state.divided[at] = True
                    continue
                found.inspected += 1
                (box,) = listed(state.level[at : at + 1])
                number = self.images.formed.value if defined[at] else model.root
                near = bool(widths[at] <= CORNERS_FROM * self.extent)
                inspected = inspect(model.over(box), self.extent, number, corners=near)
                settled = inspected.kind != "open" and (inspected.corner is None or inspected.corner.point is not None)
                if settled:
                    self._note(box, inspected)
                elif widths[at] <= self.smallest:
                    found.left.append((box, inspected))
                else:
                    state.divided[at] = True

    def _note(self, box: Box, inspected: Inspection) -> None:
        found = self.found
        if inspected.kind == "regular":
            found.regular.setdefault(inspected.nodes[0], []).append(np.array([box]))
            found.order = min(found.order, inspected.order)
        elif inspected.meeting is not None:
            found.joined.setdefault(inspected.meeting, []).append(np.array([box]))
        elif inspected.corner is not None:
            found.corners.append((box, inspected.corner))
        elif inspected.kind == "double":
            found.double.append(box)


def _patterns(rows: NDArray[Any], own: NDArray[np.int64]) -> Iterator[tuple[NDArray[np.int64], NDArray[Any]]]:
    """The columns of an array that are equal: their places among `own`, and what they are."""
    if len(own):
        patterns, inverse = np.unique(rows[:, own], axis=1, return_inverse=True)
        order = np.argsort(inverse.ravel(), kind="stable")
        ends = np.cumsum(np.bincount(inverse.ravel(), minlength=patterns.shape[1]))
        for k, places in enumerate(np.split(own[order], ends[:-1])):
            yield places, patterns[:, k]


def joined_boxes(found: Subdivision) -> Sequence[Boxes]:
    """All boxes in which sheets meet."""
    corners = [np.array([box]) for box, _ in found.corners]
    return [*(boxes for group in found.joined.values() for boxes in group), *corners]
