"""The octree: boxes into which a region in space falls until each is settled, or too small to go on.

Letters that range are further sides of a box, divided where they change the leaves more than the coordinates do.
A level of boxes at a time: intervals in float64 discard most and settle nearly all that hold one analytic sheet or
two that cross; balls decide what is left. The results do not depend on how many threads there are.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.bounds.balls import ctx
from rsym.logic.kleene import Formula, as_gate, leaves_of
from rsym.logic.stripping import is_even
from rsym.sampling.progress import Effort
from rsym.verify.boxes.classes import CURVED
from rsym.verify.boxes.contact_relations import contacts_of
from rsym.verify.boxes.joints import BoundaryArc, Meeting
from rsym.verify.boxes.local import PRECISION, Box
from rsym.verify.cover.box_arrays import area, at, cut, eighths, grown, halves, listed, patterns, reach_from, widths_of
from rsym.verify.cover.deciding import EMPTY as NO_ZEROS
from rsym.verify.cover.deciding import MEETING, REGULAR, UNKNOWN, Decider
from rsym.verify.cover.deciding import OPEN as UNDIVIDED
from rsym.verify.cover.folds import Folds
from rsym.verify.cover.formation import DOUBLE, MAX, MIN, OPEN
from rsym.verify.cover.images import Boxes, Images
from rsym.verify.cover.independence import apart, independent, step_to_both
from rsym.verify.cover.repetition import Repetition
from rsym.verify.cover.subdivision import Subdivision, settled_boxes
from rsym.verify.cover.surfaces import SheetInspector

COARSEST = 1 / 16  # of the extent: larger boxes are divided, so that the cover follows the boundary
BALLS_FROM = 1 / 32  # of the extent: on larger boxes balls rarely say more than float64 intervals
# Boxes so many and so narrow are those of a surface on which nothing can be proved; the car takes 6 000 at most.
MOST, WIDE = 50_000, 1 / 128
RANGING = 30_000  # so many are too many where letters range; a blend of two balls over two letters takes 4 000
BESIDE = 1 + 2.0**-20  # a curve that runs along a side of a box counts as in it
MANY, DETAIL = 4096, 1e-3  # boxes that make less than this share of the boundary are left as they are
TOLD = 64  # boxes that balls look at between two reports
FINEST = 1 / 512  # of the extent: what intervals leave open on boxes so small balls look at too
TRIALS = 32  # boxes with sheets that may touch that are looked at, for each one that is settled by it
RELATED = 8  # leaves of a body, beyond which none are asked whether they touch
NEAR = 4  # widths of its range on a box, within which a factor counts as near zero: beyond it sheets part soon
TOUCHING = 3  # sheets of which two may touch
EDGES_FROM = 1 / 32  # of the extent: a curve that seems to pass through so small a box of a piece does
CORNERS_FROM = 1 / 64  # of the extent: a curve runs nearly straight through a box with a corner


class LiveSheets(NamedTuple):
    """The functions of the sheets on a box, and what joins two; none where it takes a closer look to know them."""

    nodes: tuple[int, ...]
    gate: int


HARD, EMPTY = LiveSheets((), OPEN), LiveSheets((), 0)


class _State(NamedTuple):
    """A level of boxes, which of them are to be divided, which need a closer look, and which are settled.

    `beside`: the places of boxes in which two sheets cross, if at all, and their curve seems not to pass; `touching`:
    those that are looked at closer because two of their sheets may touch.
    """

    level: Boxes
    divided: Flags
    hard: Flags
    settled: Flags
    beside: list[tuple[LiveSheets, NDArray[np.int64]]]
    touching: list[tuple[LiveSheets, NDArray[np.int64]]]


class Octree:
    """Subdivides a region level by level; a piece of one only as long as it holds nothing but sheets."""

    def __init__(
        self,
        images: Images,
        region: Box,
        *,
        smallest: float,
        budget: int,
        inspections: int,
        effort: Effort,
        piece: Repetition | None = None,
    ) -> None:
        self.images, self.region, self.piece = images, region, piece
        self.extent = max(high - low for low, high in region[:3])
        self.smallest, self.budget, self.inspections = smallest, budget, inspections
        self.effort = effort
        self.found = Subdivision()
        self._decider = Decider(images)
        self._folds = Folds(images, region[:3])
        self._known: dict[tuple[int, ...], LiveSheets] = {}
        self._contacts = contacts_of(images.model)
        self._contacts.sought = len(images.formed.leaves) <= RELATED
        self._tried: Counter[LiveSheets] = Counter()  # boxes looked at because two sheets may touch, and those settled
        self._settled: Counter[LiveSheets] = Counter()

    def run(self) -> Subdivision:
        """Subdivide until every box is settled, narrower than `smallest`, too many, or the time over."""
        level = np.array(list(eighths(self.region)))
        while len(level) and not (self._is_in_vain or self._has_an_edge()):
            self.found.examined += len(level)
            self._tell(level)
            level = self._level(level)
        self.found.leave(level)
        self._tell(level)
        return self.found

    @property
    def _is_in_vain(self) -> bool:
        """Whether a piece was found to hold more than sheets, so that the whole region must be searched."""
        piece, found = self.piece, self.found
        return piece is not None and (found.has_more or (bool(found.joined) and not piece.is_small))

    def _has_an_edge(self) -> bool:
        """Whether a piece seems to hold a point at which sheets meet; a small one may hold boxes in which none do."""
        for meeting, groups in self.found.joined.items() if self.piece is not None else ():
            boxes, (arc, _) = np.concatenate(groups), meeting.arcs
            fine = boxes[widths_of(boxes) <= EDGES_FROM * self.extent]
            if len(fine) and self._passed((arc.function, arc.side), fine)[1].any():
                return True
        return False

    def _tell(self, level: Boxes) -> None:
        """Report the share of the boundary that is settled, by the areas of the boxes."""
        settled = sum(area(part) for part in settled_boxes(self.found))
        open_area = area(level) + area(np.array([box for box, _ in self.found.left]).reshape(-1, *level.shape[1:]))
        undecided = open_area / (open_area + settled) if open_area else 0.0
        self.effort.reach(1 - undecided, undecided=undecided)

    def _level(self, level: Boxes) -> Boxes:
        if self.piece is not None:
            level = level[self.piece.meets(level)]
        alive, joined, defined, signs = self.images.alive(level)
        keep = alive.any(axis=0) | (joined == OPEN) | ~defined
        keep[~defined] = ~self.images.is_empty(level[~defined])
        level, alive, joined, defined, signs = level[keep], alive[:, keep], joined[keep], defined[keep], signs[:, keep]
        widths = widths_of(level)
        divided = (widths > COARSEST * self.extent) & (level.shape[1] == 3)
        small = np.flatnonzero(~divided)
        state = _State(level, divided, np.zeros(len(level), bool), np.zeros(len(level), bool), [], [])
        for sheets, own in self._grouped(alive[:, small], joined[small], defined[small], signs[:, small]).items():
            if sheets == EMPTY:
                state.settled[small[own]] = True
            else:
                self._settle(sheets, small[own], state)
        divided |= state.hard & (widths > BALLS_FROM * self.extent)
        looked_at = ~divided
        self._inspect(state, widths, defined)
        for sheets, own in state.touching:
            self._tried[sheets] += int(looked_at[own].sum())
            self._settled[sheets] += int((looked_at & ~divided)[own].sum())
        tiny = widths <= self.smallest
        self._leave(state, divided & tiny)
        self._account(state)
        following: Boxes = level[divided & ~tiny]
        enough = len(following) > MOST and bool(widths.max(initial=0) < WIDE * self.extent)
        enough |= (level.shape[1] > 3 and len(following) > RANGING) or self.effort.is_over
        if enough or self.found.examined + 8 * len(following) > self.budget or self._is_detail(following):
            self._leave(state, divided & ~tiny)
            return following[:0]
        return self._parts(following)

    def _parts(self, boxes: Boxes) -> Boxes:
        """The boxes divided in space, or across the letter to which their leaves are most sensitive."""
        if boxes.shape[1] == 3:
            return halves(boxes)
        across = np.zeros(boxes.shape[:2], bool)
        influence = self.images.influence(boxes)
        ranging = influence.max(axis=1) > 1
        across[ranging, 3 + influence[ranging].argmax(axis=1)] = True
        return np.concatenate([cut(boxes[ranging], across[ranging]), halves(boxes[~ranging])])

    def _account(self, state: _State) -> None:
        """Boxes that are neither settled nor divided were lost: nothing is proved on them."""
        lost = ~(state.settled | state.divided)
        self.found.unsettled += int(lost.sum())
        self.found.leave(state.level[lost])

    def _is_detail(self, boxes: Boxes) -> bool:
        """Whether so many boxes make so little of the boundary that dividing them further would not be worth it."""
        return len(boxes) >= MANY and area(boxes) < DETAIL * sum(area(part) for part in settled_boxes(self.found))

    def _leave(self, state: _State, own: Flags) -> None:
        """Boxes that are not divided any more: those beside the curve of two sheets are settled all the same."""
        for sheets, crossing in state.beside:
            settled = crossing[own[crossing]]
            if len(settled):
                self.found.joined.setdefault(self._meeting(sheets), []).append(state.level[settled])
                own[settled] = False
        self.found.leave(state.level[own])

    def _grouped(
        self, alive: Flags, joined: NDArray[np.int8], defined: Flags, signs: NDArray[np.int8]
    ) -> dict[LiveSheets, NDArray[np.int64]]:
        """The boxes by the sheets that they can hold."""
        groups: dict[LiveSheets, list[NDArray[np.int64]]] = {}
        count = alive.sum(axis=0)
        simple = defined & (joined != OPEN) & (count <= 2)
        leaves = self.images.formed.leaves
        codes = np.where(count == 1, 0, joined).astype(np.int8)
        for place, pattern in patterns(np.concatenate([alive, codes[None]]), np.flatnonzero(simple)):
            nodes = tuple(leaves[k] for k in np.flatnonzero(pattern[:-1]))
            opposite = len(nodes) == 2 and self.images.model.builder.neg(nodes[0]) == nodes[1]
            sheets = LiveSheets(nodes[:1], DOUBLE) if opposite else LiveSheets(nodes, int(pattern[-1]))
            groups.setdefault(sheets, []).append(place)
        for place, pattern in patterns(signs, np.flatnonzero(~simple & defined)):
            groups.setdefault(self._logic(tuple(pattern.tolist())), []).append(place)
        groups.setdefault(HARD, []).append(np.flatnonzero(~defined))
        return {sheets: np.concatenate(places) for sheets, places in groups.items()}

    def _logic(self, signs: tuple[int, ...]) -> LiveSheets:
        """The sheets of boxes on which the leaves have these signs."""
        if signs not in self._known:
            formula = self.images.formed.logic(signs)
            self._known[signs] = HARD if formula is None else self._sheets(formula)
        return self._known[signs]

    def _sheets(self, formula: Formula) -> LiveSheets:
        leaves, single = leaves_of(formula), as_gate(formula)
        b, nodes = self.images.model.builder, self.images.formed.leaves
        if not leaves:
            return EMPTY
        if len(leaves) > 2:
            return LiveSheets(tuple(nodes[k] for k in leaves), OPEN)
        if single is None:
            return LiveSheets((nodes[leaves[0]],), DOUBLE) if len(leaves) == 1 else HARD
        operation, signs = single
        signed = (nodes[k] if sign > 0 else b.neg(nodes[k]) for k, sign in zip(leaves, signs, strict=True))
        return LiveSheets(tuple(signed), 0 if len(leaves) == 1 else MIN if operation == "min" else MAX)

    def _settle(self, sheets: LiveSheets, own: NDArray[np.int64], state: _State) -> None:
        """Boxes with one sheet are settled where it is regular, those with two where they cross."""
        if not sheets.nodes or is_even(self.images.model.builder, sheets.nodes[0]):
            state.hard[own] = True
            return
        if sheets.gate == 0 and len(sheets.nodes) == 1:
            own = self._decide(sheets.nodes[0], own, state)
            own = self._unfold(sheets.nodes[0], own, state)
        boxes, count = state.level[own], len(sheets.nodes)
        slopes, orders = self._slopes(sheets.nodes, boxes if count == 1 else grown(boxes))
        order, crossing = np.minimum.reduce(orders), independent(slopes)
        # One sheet of finite class is regular all the same; where two meet, what follows asks for their series.
        analytic = order > CURVED if count == 1 else np.isinf(order)
        if count == 2:
            single, passed = self._passed(sheets.nodes, boxes)
            single &= analytic & independent(slopes[:1]) & independent(slopes[1:])
            for node in sheets.nodes if single.any() else ():
                self.found.regular.setdefault(node, []).append(boxes[single])
            state.settled[own[single]] = True
            state.beside.append((sheets, own[analytic & crossing & ~passed & ~single]))
            crossing &= passed
            own, boxes, analytic, crossing = own[~single], boxes[~single], analytic[~single], crossing[~single]
        if sheets.gate == DOUBLE:
            both = analytic & crossing & self._changes_sign(sheets.nodes[0], boxes)
            self.found.double.extend(listed(boxes[both]))
            state.settled[own[both]] = True
            analytic, crossing, own, boxes = analytic[~both], crossing[~both] & False, own[~both], boxes[~both]
        touching = self._touch(sheets, boxes)
        state.touching.append((sheets, own[analytic & ~crossing & touching]))
        state.hard[own[~analytic | (crossing & (count == 3)) | (~crossing & touching)]] = True
        state.divided[own[analytic & ~crossing & ~touching]] = True
        done = boxes[analytic & crossing]
        if len(done) and count == 1:
            self.found.regular.setdefault(sheets.nodes[0], []).append(done)
            self.found.order = min(self.found.order, float(order[analytic & crossing].min()))
        elif len(done) and count == 2:
            self.found.joined.setdefault(self._meeting(sheets), []).append(done)
        if count <= 2:
            state.settled[own[analytic & crossing]] = True

    def _decide(self, leaf: int, own: NDArray[np.int64], state: _State) -> NDArray[np.int64]:
        """Settle or divide the boxes on which the branches of a leaf are decided, or all but one; the others."""
        branched = own[self.images.slopes(leaf, state.level[own])[2] <= CURVED]
        decided = self._decider.decide(leaf, state.level[branched])
        kinds = decided.kinds
        fine = (state.level[branched, :, 1] - state.level[branched, :, 0]).max(axis=1) <= FINEST * self.extent
        kinds[fine & (kinds == UNDIVIDED)] = UNKNOWN
        state.divided[branched[kinds == UNDIVIDED]] = True
        settled = (kinds == REGULAR) | (kinds == NO_ZEROS) | (kinds >= MEETING)
        state.settled[branched[settled]] = True
        if (kinds == REGULAR).any():
            self.found.regular.setdefault(leaf, []).append(state.level[branched[kinds == REGULAR]])
        for number, meeting in enumerate(decided.meetings):
            if (kinds == number).any():
                self.found.joined.setdefault(meeting, []).append(state.level[branched[kinds == number]])
        return np.setdiff1d(own, branched[kinds != UNKNOWN])

    def _touch(self, sheets: LiveSheets, boxes: Boxes) -> Flags:
        """Where exact division says that two sheets may touch: balls tell what they make, unless that proved futile."""
        found = np.zeros(len(boxes), bool)
        futile = not self._contacts.sought or self._tried[sheets] >= TRIALS * (1 + self._settled[sheets])
        for f, g in combinations(sheets.nodes, 2) if len(sheets.nodes) <= TOUCHING and not futile else ():
            for contact in self._contacts.between(f, g):
                near = np.ones(len(boxes), bool)
                for low, high in (self.images.value(factor, boxes) for factor, power in contact.factors if power > 1):
                    near &= (low <= NEAR * (high - low)) & (high >= NEAR * (low - high))
                found |= near
        return found

    def _unfold(self, leaf: int, own: NDArray[np.int64], state: _State) -> NDArray[np.int64]:
        """Settle or divide boxes of one sheet with switches whose pieces agree; the others are given back."""
        rough = own[self.images.slopes(leaf, state.level[own])[2] <= CURVED]
        for made, sheet, places in self._folds.unfolded(leaf, state.level[rough]) if len(rough) else ():
            these, boxes = rough[places], state.level[rough[places]]
            empty, regular = self._folds.empty(made, boxes), self._folds.regular(made, boxes)
            state.settled[these[empty | regular]] = True
            if (regular & ~empty).any():
                self.found.regular.setdefault(sheet, []).append(boxes[regular & ~empty])
                self.found.order = min(self.found.order, made.order)
            fine = (boxes[:, :, 1] - boxes[:, :, 0]).max(axis=1) <= FINEST * self.extent
            state.divided[these[~empty & ~regular & ~fine & np.isinf(made.order)]] = True
        return own[~(state.settled | state.divided)[own]]

    def _slopes(self, nodes: Sequence[int], boxes: Boxes) -> tuple[list[tuple[Floats, Floats]], list[Floats]]:
        """The gradients of nodes over boxes, and their orders."""
        found = [self.images.slopes(node, boxes) for node in nodes]
        return [(low, high) for low, high, _ in found], [order for _, _, order in found]

    def _changes_sign(self, node: int, boxes: Boxes) -> Flags:
        """Whether a node certainly has both signs at corners of a box."""
        seen = np.zeros((2, len(boxes)), bool)
        for ends in product((0, 1), repeat=3):
            low, high = self.images.first(node, at(boxes[:, range(3), list(ends)], boxes))[0]
            seen |= [low > 0, high < 0]
        both: Flags = np.logical_and(seen[0], seen[1])
        return both

    def _passed(self, nodes: Sequence[int], boxes: Boxes) -> tuple[Flags, Flags]:
        """Where two sheets certainly do not meet in a box, and where their curve seems to pass through it."""
        middle = boxes[:, :3].mean(axis=-1)
        values = [self.images.first(node, at(middle, boxes))[0] for node in nodes]
        reach = reach_from(middle, boxes)
        slopes = self._slopes(nodes, boxes)[0]
        passed: Flags = np.logical_and.reduce(np.abs(step_to_both(values, slopes)) <= BESIDE * reach, axis=0)
        return apart(values, slopes, reach), passed

    def _meeting(self, sheets: LiveSheets) -> Meeting:
        f, g = sheets.nodes
        b = self.images.model.builder
        sides = (g, f) if sheets.gate == MIN else (b.neg(g), b.neg(f))
        return Meeting((BoundaryArc(f, sides[0]), BoundaryArc(g, sides[1])), 1)

    def _inspect(self, state: _State, widths: Floats, defined: Flags) -> None:
        """What balls say of hard boxes, one by one; those that stay open are divided, the smallest are left."""
        model, found = self.images.model, self.found
        with ctx.workprec(PRECISION):
            for place in np.flatnonzero(state.hard & ~state.divided):
                if found.inspected >= self.inspections or self.effort.is_over or self._is_in_vain:
                    state.divided[place] = True
                    continue
                found.inspected += 1
                if found.inspected % TOLD == 0:
                    self.effort.reach(0.0)  # whose answer may cancel
                (box,) = listed(state.level[place : place + 1])
                number = self.images.formed.value if defined[place] else model.root
                near = bool(widths[place] <= CORNERS_FROM * self.extent)
                inspected = SheetInspector(corners=near).inspect(model.over(box), number)
                settled = inspected.kind != "open" and (inspected.corner is None or inspected.corner.point is not None)
                if settled:
                    state.settled[place] = found.note(box, inspected)
                elif widths[place] <= self.smallest:
                    found.left.append((box, inspected))
                    state.settled[place] = True
                else:
                    state.divided[place] = True
