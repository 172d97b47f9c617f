"""Leaves with branches over many boxes at once: which branch is taken, or which two sheets a switch parts.

`inspection` decides one box by balls. What it concludes from the signs of nodes depends on these signs alone, so it
is concluded once for all boxes on which float64 intervals find the same signs; what depends on slopes is then proved
for each of these boxes by intervals of the slopes. Signs that intervals do not find count as unknown, which is never
wrong: every rule asks for signs that are certain.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags
from rsym.bounds.balls import arb, exact
from rsym.program.builder import Builder
from rsym.program.operations import BRANCHING, ENTIRE
from rsym.program.program import live
from rsym.verify.boxes.classes import CURVED
from rsym.verify.boxes.domains import switch_of
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import Meeting, meeting
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.locus import Locus
from rsym.verify.boxes.resolution import resolve
from rsym.verify.cover.box_arrays import at, grown, reach_from
from rsym.verify.cover.images import Boxes, Images
from rsym.verify.cover.independence import apart, independent

WORTH = 64  # boxes with the same signs: for fewer the images of another function are not worth being made
UNKNOWN, REGULAR, OPEN, EMPTY, MEETING = -1, -2, -3, -4, 0  # what is decided; a meeting by its number
NO_SWITCH = -1


class Decided(NamedTuple):
    """For each box (n,) UNKNOWN, REGULAR, EMPTY, OPEN (more is known on its parts) or the number of a meeting."""

    kinds: NDArray[np.int64]
    meetings: Sequence[Meeting]


class Signs(Local):
    """What is known on boxes of which only the signs of some nodes are known."""

    def __init__(self, model: Model, signs: dict[int, int]) -> None:
        super().__init__(model, [arb(0, math.inf)] * len(model.axes))
        self.signs = signs

    def value(self, number: int) -> arb | None:
        """The whole line, but for numbers."""
        known = self.model.builder.value(number)
        return arb(0, math.inf) if known is None else exact(known)

    def sign(self, number: int) -> int:
        """The sign of a node, if it is one of those known or a number."""
        return self.signs[number] if number in self.signs else super().sign(number)


class Decider:
    """Decides a leaf over boxes on which omega is defined."""

    def __init__(self, images: Images) -> None:
        self.images = images
        self._tests: dict[int, tuple[int, ...]] = {}
        self._plain: dict[tuple[int, tuple[int, ...]], int | None] = {}
        self._meetings: dict[tuple[int, tuple[int, ...]], Meeting | None] = {}

    def decide(self, leaf: int, boxes: Boxes) -> Decided:
        """What is decided of the zero set of a leaf in boxes.

        REGULAR: a regular analytic sheet in all of the box. EMPTY: the functions on both sides of a switch have one
        sign there. A meeting: on the box grown by a quarter it is the union of two sheets, as `inspection` says it.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y, z
        >>> from rsym.verify.cover.forming import formation
        >>> model = Model(rsym.Shape(z - abs(x), (x, y, z)), {})
        >>> images = Images(model, formation(model, lambda node: True), {})
        >>> side = np.linspace(0, 1, 65)
        >>> boxes = np.array([[(-0.5, 0.5), (low, low + 1), (-0.5, 0.5)] for low in side])
        >>> set(Decider(images).decide(model.root, boxes).kinds.tolist())
        {0}
        >>> set(Decider(images).decide(model.root, boxes + [[[1], [0], [1]]]).kinds.tolist())
        {-2}
        """
        kinds, meetings = np.full(len(boxes), UNKNOWN), list[Meeting]()
        switched: list[NDArray[np.int64]] = [np.empty(0, np.int64)]
        for signs, own in self._patterns(leaf, boxes):
            plain = self._decided(leaf, signs)
            if plain is None:
                switched.append(own)
            elif len(own) >= WORTH:
                _, slopes, analytic = self.images.first(plain, boxes[own])
                regular = independent([slopes])
                kinds[own[analytic]] = np.where(regular[analytic], REGULAR, OPEN)
        places = np.concatenate(switched)
        around = grown(boxes[places])
        for signs, among in self._patterns(leaf, around):
            found = self._meeting(leaf, signs)
            # Where it is not continuous, or has a value of its own on the switch, omega jumps; with more contact the
            # leaf is smooth enough to be one sheet, as balls say it is.
            if found is None or len(among) < WORTH:
                continue
            own = places[among]
            empty = self._are_empty(found, boxes[own])
            kinds[own[empty]] = EMPTY
            if not found.continuous or found.contact > CURVED:
                continue
            own, among = own[~empty], among[~empty]
            single, joined, analytic = self._parted(found, boxes[own], around[among])
            kinds[own[analytic]] = OPEN
            kinds[own[joined]] = len(meetings)
            kinds[own[single]] = REGULAR
            meetings.append(found)
        return Decided(kinds, meetings)

    def _patterns(self, leaf: int, boxes: Boxes) -> Iterator[tuple[tuple[int, ...], NDArray[np.int64]]]:
        """The boxes by the signs of all nodes that decide something about a leaf."""
        if leaf not in self._tests:
            self._tests[leaf] = tuple(signs_needed(self.images.model.builder, leaf))
        if not self._tests[leaf] or not len(boxes):
            return
        signs = self.images.signs(self._tests[leaf], boxes)
        patterns, inverse = np.unique(signs, axis=1, return_inverse=True)
        for k in range(patterns.shape[1]):
            yield tuple(patterns[:, k].tolist()), np.flatnonzero(inverse.ravel() == k)

    def _known(self, leaf: int, signs: Sequence[int]) -> Signs:
        return Signs(self.images.model, dict(zip(self._tests[leaf], signs, strict=True)))

    def _decided(self, leaf: int, signs: tuple[int, ...]) -> int | None:
        """The analytic function that the leaf is where nodes have these signs, if all branches are decided."""
        if (leaf, signs) not in self._plain:
            known = self._known(leaf, signs)
            is_plain = generators(known, leaf).analytic
            self._plain[leaf, signs] = resolve(known, leaf, NO_SWITCH, 1) if is_plain else None
        return self._plain[leaf, signs]

    def _meeting(self, leaf: int, signs: tuple[int, ...]) -> Meeting | None:
        """The two sheets of a leaf where nodes have these signs, if one switch parts them and they meet in it."""
        if (leaf, signs) not in self._meetings:
            known = self._known(leaf, signs)
            found = generators(known, leaf)
            sheets = None
            if len(found.switches) == 1 and not found.hard:
                sheets = meeting(known, Locus("leaf", (leaf,)), found)
            self._meetings[leaf, signs] = sheets
        return self._meetings[leaf, signs]

    def _are_empty(self, sheets: Meeting, boxes: Boxes) -> Flags:
        """Where the functions of both sides, and what is between, have one sign."""
        thin = () if sheets.thin is None else (sheets.thin,)
        values = [self.images.first(arc.function, boxes)[0] for arc in (*sheets.arcs, *thin)]
        up = np.logical_and.reduce([low > 0 for low, _ in values])
        down = np.logical_and.reduce([high < 0 for _, high in values])
        empty: Flags = up | down
        return empty

    def _parted(self, sheets: Meeting, boxes: Boxes, around: Boxes) -> tuple[Flags, Flags, Flags]:
        """Where the sheets are regular and do not meet, where they are transversal to their sides, and analytic.

        If one sheet and its side have no common zero in a box, the other has none either, for both functions agree
        where the side is zero: then every point of the boundary lies in an open set where the leaf is one of them.
        """
        analytic, crossing = np.ones(len(boxes), bool), np.ones(len(boxes), bool)
        regular = np.ones(len(boxes), bool)
        for arc in sheets.arcs:
            _, along, first = self.images.first(arc.function, around)
            _, across, second = self.images.first(arc.side, around)
            analytic &= first & second
            crossing &= independent([along, across])
            regular &= independent([along])
        beside = self._are_apart(sheets, boxes) & analytic & regular
        return beside, analytic & crossing, analytic

    def _are_apart(self, sheets: Meeting, boxes: Boxes) -> Flags:
        """Where the first sheet certainly does not meet its side."""
        arc = sheets.arcs[0]
        middle = boxes[:, :3].mean(axis=-1)
        values = [self.images.first(node, at(middle, boxes))[0] for node in (arc.function, arc.side)]
        reach = reach_from(middle, boxes)
        slopes = [self.images.first(node, boxes)[1] for node in (arc.function, arc.side)]
        return apart(values, slopes, reach)


def signs_needed(builder: Builder, leaf: int) -> list[int]:
    """The nodes whose signs decide which branches of a leaf are taken and where it is defined and analytic."""
    tests: dict[int, None] = {}
    for part in live(builder.nodes, [leaf]):
        operation, arguments, _ = builder.nodes[part]
        if operation in BRANCHING:
            tests[switch_of(builder, part)] = None
        elif operation not in ENTIRE:
            tests |= dict.fromkeys((*arguments[:2], part) if operation == "trimming" else arguments[:2])
    return [test for test in tests if builder.value(test) is None]
