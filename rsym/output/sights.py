"""What the rays of a picture see: those that meet the body, in order, and what the others say."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Integers, Ints, Shorts
from rsym.output.cameras import VIEWS, Camera, Viewport
from rsym.sampling.hits import Hits
from rsym.sampling.labels import Labels
from rsym.sampling.rays import Caster

NOTHING, UNDECIDED = -1, -2  # in the place of the number of a leaf
# Pixels of a side of the pictures by which a body is known from all sides, at most.
AROUND = 64
SIDES = ("front", "rear", "left", "right", "top", "bottom")


@dataclass(frozen=True)
class Sight:
    """The hits of the rays of places (n,), columns and rows of a view.

    Rays that meet the body and are decided count from 0 in the order of the places; `column`, `row`, `leaf`, `depth`,
    `normals` are theirs.
    """

    view: Viewport
    columns: NDArray[Any]  # of pixels whole numbers
    rows: NDArray[Any]
    hits: Hits

    @classmethod
    def of_pixels(cls, view: Viewport, hits: Hits) -> Sight:
        """The hits of the middles of all pixels, row by row."""
        width, height = view.size
        row, column = np.indices((height, width)).reshape(2, -1)
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

    def unlike(self) -> Ints:
        """The pixels beside one that sees another leaf."""
        label = self.labels.reshape(self.view.size[::-1])
        mask = np.zeros(label.shape, np.bool_)
        for one, other in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
            differ = label[one] != label[other]
            mask[one] |= differ
            mask[other] |= differ
        return np.flatnonzero(mask)

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
    def called(self) -> Labels:
        """Which parts are met."""
        return self.hits.called(self.points_at(slice(None)), self.leaf)

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

    def points_at(self, numbers: Integers | slice) -> Floats:
        """The points (k, 3) that some of the rays meet, by their numbers."""
        origins, ways = self.view.rays(self.column[numbers], self.row[numbers])
        return np.asarray(origins + self.depth[numbers][:, None] * ways)


@dataclass(frozen=True)
class Probe:
    """A body seen from its six sides in few pixels: how large it is, what is on it, which leaves meet there."""

    sights: tuple[Sight, ...]

    @classmethod
    def of(cls, caster: Caster) -> Probe:
        """Look at a body from the front, the rear, the left, the right, the top and the bottom."""
        corners = corners_of(caster.bounds)
        sights = []
        for name in SIDES:
            view = Camera(*VIEWS[name]).frame(corners, (AROUND, AROUND))
            sights.append(Sight.of_pixels(view, caster.look(view.pencil)))
        return cls(tuple(sights))

    @cached_property
    def around(self) -> Floats:
        """Points (n, 3) a pixel of the pictures beside what is seen of the body; (0, 0, 0) if that is nothing."""
        found = []
        for sight in self.sights:
            if len(sight.met):
                points, (right, up) = sight.points_at(slice(None)), sight.view.pixel * sight.view.axes[:2]
                found += [points + step for step in (right + up, right - up, up - right, -right - up)]
        return np.concatenate(found) if found else np.zeros((1, 3))

    @cached_property
    def box(self) -> Floats:
        """The corners low and high (2, 3) of the box round these points."""
        return np.stack([self.around.min(axis=0), self.around.max(axis=0)])

    def values(self, of: Callable[[Sight], Floats]) -> Floats:
        """Values of all that is seen, one after the other."""
        return np.concatenate([np.zeros(0), *(of(sight) for sight in self.sights if len(sight.met))])

    @cached_property
    def shares(self) -> Floats:
        """How much of the surface each of them stands for: more where it is seen at a slant."""
        return self.values(lambda sight: 1 / np.maximum(np.abs(sight.normals @ sight.view.axes[2]), 0.1))


def corners_of(bounds: tuple[tuple[float, float], ...]) -> Floats:
    """The eight corners (8, 3) of a box."""
    return np.stack(np.meshgrid(*bounds, indexing="ij"), axis=-1).reshape(-1, 3)


def neighbours(sight: Sight) -> NDArray[np.int64]:
    """Which parts are seen side by side in a picture, pairs (n, 2) of numbers of names."""
    label = np.full(len(sight.labels), -1)
    label[sight.met] = sight.called.number
    label = label.reshape(sight.view.size[::-1])
    pairs = []
    for one, other in ((np.s_[:, :-1], np.s_[:, 1:]), (np.s_[:-1], np.s_[1:])):
        beside = (label[one] != label[other]) & (np.minimum(label[one], label[other]) >= 0)
        pairs.append(np.stack([label[one][beside], label[other][beside]], axis=1))
    return np.unique(np.concatenate(pairs), axis=0).astype(np.int64)
