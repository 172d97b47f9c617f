"""What the rays of a picture see: those that meet the body, in order, and what the others say."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints, Shorts
from rsym.output.cameras import View
from rsym.sampling.hits import Hits

NOTHING, UNDECIDED = -1, -2  # in the place of the number of a leaf


@dataclass(frozen=True)
class Sight:
    """The hits of the rays of places (n,), columns and rows of a view.

    Rays that meet the body and are decided count from 0 in the order of the places; `column`, `row`, `leaf`, `depth`,
    `normals` are theirs.
    """

    view: View
    columns: Floats
    rows: Floats
    hits: Hits

    @classmethod
    def of_pixels(cls, view: View, hits: Hits) -> Sight:
        """The hits of the middles of all pixels, row by row."""
        width, height = view.size
        row, column = np.divmod(np.arange(width * height), width)
        return cls(view, column, row, hits)

    @cached_property
    def labels(self) -> Shorts:
        """The leaf of each ray, NOTHING or UNDECIDED."""
        leaf = self.hits.leaf.reshape(-1)
        undecided = self.hits.undecided.reshape(-1)
        return np.where(undecided, np.int16(UNDECIDED), leaf) if undecided.any() else leaf

    @cached_property
    def met(self) -> Ints:
        """Which rays meet the body."""
        return np.flatnonzero(self.labels >= 0)

    @cached_property
    def number(self) -> NDArray[np.int32]:
        """Of each ray its number among those that meet the body; of others anything."""
        number = np.zeros(len(self.labels), np.int32)
        number[self.met] = np.arange(len(self.met), dtype=np.int32)
        return number

    @cached_property
    def depths(self) -> NDArray[np.float32]:
        """How far each ray goes; inf where it meets nothing."""
        depths = np.full(len(self.labels), np.inf, np.float32)
        depths[self.met] = self.depth
        return depths

    @cached_property
    def column(self) -> Floats:
        """The columns of those that meet the body."""
        return np.asarray(self.columns[self.met])

    @cached_property
    def row(self) -> Floats:
        """The rows of those that meet the body."""
        return np.asarray(self.rows[self.met])

    @cached_property
    def leaf(self) -> Shorts:
        """The leaves that are met."""
        return np.asarray(self.labels[self.met])

    @cached_property
    def depth(self) -> Floats:
        """How far rays go that meet the body."""
        return np.asarray(self.hits.depth.reshape(-1)[self.met])

    @cached_property
    def normals(self) -> Floats:
        """The outer unit normals (m, 3); towards the eye where the leaf has none."""
        normals = self.hits.normal.reshape(-1, 3)[self.met]
        unknown = np.isnan(normals[:, 0])
        if unknown.any():
            normals[unknown] = self.view.axes[2]
        return normals

    def field(self, name: str) -> Floats:
        """A field of the leaves that are met."""
        values = self.hits.fields(name)[name]
        return np.asarray(values.reshape(len(self.labels), *values.shape[self.hits.leaf.ndim :])[self.met])

    def points_at(self, numbers: Ints | slice) -> Floats:
        """The points (k, 3) that some of the rays meet, by their numbers."""
        origins, ways = self.view.rays(self.column[numbers], self.row[numbers])
        return np.asarray(origins + self.depth[numbers][:, None] * ways)
