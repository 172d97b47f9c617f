"""Pieces of a surface on disk: each a folder of arrays that appears whole or not at all.

Pieces are boxes in the order of the surface: of two the one before has all blocks that come before. So vertices of a
piece are a stretch of all vertices, and its crossings along one axis a stretch of all of that axis. What pieces share
is found by name. `Surface` is all of them: it holds what grows with the number of pieces, and reads the rest.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from rsym.arrays import Ints
from rsym.sampling.sharp.certificates import Unresolved
from rsym.sampling.sharp.pieces import Piece

UNFINISHED = ".unfinished"


def keep(folder: Path, piece: Piece, seeds: Ints) -> None:
    """Put a piece into a folder of its own; `seeds` are its crossings to mend."""
    draft = folder.with_name(folder.name + UNFINISHED)
    shutil.rmtree(draft, ignore_errors=True)
    draft.mkdir()
    arrays: dict[str, Any] = {
        "corner": piece.corner,
        "vertices": piece.vertices,
        "crossings": piece.crossings,
        "points": piece.surface.points,
        "faces": piece.surface.faces,
        "leaf": piece.surface.leaf,
        "flaws": piece.surface.flaws,
        "strangers": piece.strangers,
        "rim": piece.rim,
        "rim_number": piece.rim_number,
        "stranger_points": piece.stranger_points,
        "seeds": seeds,
        "sizes": np.array([piece.surface.vertices, *piece.crossings.sum(axis=1)], np.int64),
    }
    for number, notes in enumerate(piece.surface.notes):
        arrays |= {f"notes-{number}-{one.name}": np.asarray(getattr(notes, one.name)) for one in fields(Unresolved)}
    for name, array in arrays.items():
        np.save(draft / f"{name}.npy", array, allow_pickle=False)
    draft.rename(folder)


class StoredPiece:
    """A piece in its folder; `first` is the number of its first vertex, `begin` (3,) of its first crossings."""

    def __init__(self, folder: Path, box: Ints) -> None:
        self._folder, self.box = folder, box
        self.vertices, *self.per_axis = self.read("sizes").tolist()
        self.axes = np.cumsum([0, *self.per_axis])
        self.first = 0
        self.begin = np.zeros(3, np.int64)

    def read(self, name: str) -> Any:
        """An array of the piece."""
        return np.load(self._folder / f"{name}.npy", allow_pickle=False)

    def read_rows(self, name: str, which: Any) -> Any:
        """Some rows of an array of the piece, by numbers or a slice; the others stay on disk."""
        mapped = np.load(self._folder / f"{name}.npy", mmap_mode="r", allow_pickle=False)
        return np.array(mapped[which])

    @property
    def notes(self) -> Unresolved:
        """What was not resolved in it."""
        read = {one.name: self.read(f"notes-0-{one.name}") for one in fields(Unresolved)}
        return Unresolved(**read | {"tested": tuple(read["tested"].tolist())})

    @cached_property
    def rim(self) -> tuple[Ints, Ints]:
        """Names, ascending, of the vertices that others may touch, and which these are."""
        return self.read("rim"), self.read("rim_number")

    def crossing(self, local: Ints) -> Ints:
        """The numbers, among all crossings, of some of its own."""
        axis = np.searchsorted(self.axes, local, "right") - 1
        return np.asarray(self.begin[axis] + local - self.axes[axis])


class Surface:
    """All pieces, in order, on a lattice of extent blocks."""

    def __init__(self, pieces: Sequence[StoredPiece], extent: tuple[int, int, int]) -> None:
        self.pieces, self.extent = pieces, extent
        counts = np.array([[piece.vertices, *piece.per_axis] for piece in pieces], np.int64).T
        self.vertices, self.crossings = int(counts[0].sum()), int(counts[1:].sum())
        first = np.cumsum(counts[0]) - counts[0]
        begin = (np.cumsum(counts[1:]) - counts[1:].ravel()).reshape(3, -1)
        for number, piece in enumerate(pieces):
            piece.first, piece.begin = int(first[number]), begin[:, number]

    def strangers(self, piece: StoredPiece) -> Ints:
        """Numbers among all vertices of those that a piece has from others."""
        names = piece.read("strangers")
        number = np.full(len(names), -1, np.int64)
        for other in self._touching(piece):
            rim, rim_number = other.rim
            at = np.minimum(np.searchsorted(rim, names), len(rim) - 1)
            found = np.flatnonzero(rim[at] == names)
            number[found] = other.first + rim_number[at[found]]
        return number

    def _touching(self, piece: StoredPiece) -> Iterator[StoredPiece]:
        for other in self.pieces:
            if other is not piece and (other.box[1] >= piece.box[0]).all() and (other.box[0] <= piece.box[1]).all():
                if len(other.rim[0]):
                    yield other
