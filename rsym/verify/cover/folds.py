"""Folds: leaves with switches, whose pieces agree; for many boxes at once.

On boxes on which the same branches are taken a leaf is one simpler function. Its pieces and their class are found once,
over the whole region; where the pieces are one polynomial, the folds cancel, and that is what the boxes hold.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags
from rsym.bounds.balls import ctx
from rsym.verify.boxes.classes import CURVED, Pieces, pieces
from rsym.verify.boxes.local import PRECISION, Box
from rsym.verify.cover.images import Boxes, Images
from rsym.verify.cover.simplest import simplest

MISSES = 8  # functions in a row whose pieces do not agree: those with more branches are not asked on this level


class Folds:
    """The pieces of the leaves of a body, found when they are asked for."""

    def __init__(self, images: Images, region: Box) -> None:
        self.images, self.region = images, region
        self._known: dict[int, Pieces] = {}

    def unfolded(self, node: int, boxes: Boxes) -> Iterator[tuple[Pieces, int, NDArray[np.int64]]]:
        """Pieces whose second derivatives are continuous, the function that they are of, and the places of its boxes.

        The function has the zeros and the signs of the node on these boxes, on which the node must be defined: what
        `simplest` drops may have kinks of its own, so the sheet is that of the function. Where the order is infinite
        it is the one polynomial that the function is on the whole region, and so on every box.
        """
        model, missed = self.images.model, 0
        # A function with few branches left is cheap to resolve, and the one whose pieces agree if any do.
        found = simplest(self.images, node, boxes, rare=0)
        for simple, places in sorted(found, key=lambda one: len(model.order(one[0]))):
            if simple not in self._known:
                if missed >= MISSES:
                    continue
                with ctx.workprec(PRECISION):
                    self._known[simple] = pieces(model.over(self.region), simple)
                missed = missed + 1 if self._known[simple].order <= CURVED else 0
            made = self._known[simple]
            if made.order > CURVED:
                yield made, made.nodes[0] if np.isinf(made.order) else simple, places

    def regular(self, made: Pieces, boxes: Boxes) -> Flags:
        """Where a component of the gradient has one sign, that of all pieces, whichever the node is."""
        slopes = [self.images.slopes(part, boxes)[:2] for part in made.nodes]
        up = np.logical_and.reduce([low > 0 for low, _ in slopes])
        down = np.logical_and.reduce([high < 0 for _, high in slopes])
        found: Flags = (up | down).any(axis=0)
        return found

    def empty(self, made: Pieces, boxes: Boxes) -> Flags:
        """Where no piece is zero."""
        values = [self.images.first(part, boxes)[0] for part in made.nodes]
        found: Flags = np.logical_and.reduce([(low > 0) | (high < 0) for low, high in values])
        return found
