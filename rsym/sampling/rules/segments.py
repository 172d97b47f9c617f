"""The bases of cut pieces between breaks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.sampling.compiled import loop


@dataclass(frozen=True)
class Segments:
    """Parts of bases, sorted; and breaks where leaves stand upright, each once: the segments before and after it."""

    piece: Ints
    lower: Floats
    upper: Floats
    before: Ints  # -1: none in the piece
    after: Ints

    @classmethod
    def of(cls, piece: Ints, lower: Floats, upper: Floats, stand_piece: Ints, stand_place: Floats) -> Segments:
        """Of parts of bases, and places where leaves stand."""
        first, last = np.searchsorted(piece, stand_piece), np.searchsorted(piece, stand_piece, "right")
        nearest = np.empty(len(stand_piece), np.int64)
        nearest_break(lower, upper, first, last, stand_place, nearest)
        _, some = np.unique(np.stack([stand_piece, nearest]), axis=1, return_index=True)
        first, last, nearest = first[some], last[some], nearest[some]
        return cls(
            piece, lower, upper, np.where(nearest > first, nearest - 1, -1), np.where(nearest < last, nearest, -1)
        )

    @property
    def stand_piece(self) -> Ints:
        """The pieces of the breaks where leaves stand."""
        return self.piece[np.maximum(self.before, self.after)]

    @property
    def stand_place(self) -> Floats:
        """Their places."""
        return np.where(self.before < 0, self.lower[self.after], self.upper[self.before])


@loop
def nearest_break(lower: Any, upper: Any, first: Any, last: Any, place: Any, nearest: Any) -> None:
    """The segment, or the one behind the last, that begins nearest to each place."""
    for k in range(len(place)):
        best, nearest[k] = abs(upper[last[k] - 1] - place[k]), last[k]
        for j in range(first[k], last[k]):
            if abs(lower[j] - place[k]) < best:
                best, nearest[k] = abs(lower[j] - place[k]), j
