"""What a picture shows: a frame that a coarse look at the body finds, and beams prove that nothing sticks out of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rsym.arrays import Floats
from rsym.output.cameras import Camera, Viewport
from rsym.output.sights import Sight, corners_of
from rsym.sampling.pencils import Pencil
from rsym.sampling.rays import Caster

COARSE, FEWEST = 10, 48  # a picture so much smaller finds where the body is; pixels of its shorter side
# How often what beams leave open is looked at anew, each time so much more closely: a beam knows what is a tile beside
# it from what is in it at half a tile, so the first round says little of the pixel that a frame is left as room.
ROUNDS, FINER = 3, 4
MOST_LOOKS = 4  # of a body that is a small part of its bounds the first look sees nothing


def framed(caster: Caster, camera: Camera, size: tuple[int, int]) -> Viewport:
    """The view of a camera that the body fills; without a body the bounds.

    Where beams do not prove that the body ends within what a coarse picture sees of it, what they leave open is shown
    as well: a mast thinner than all its pixels, or a body that none of its rays meets.
    """
    corners = corners_of(caster.bounds)
    factor = int(max(min(COARSE, min(size) / FEWEST), 1.0))
    few = (-(-size[0] // factor), -(-size[1] // factor))
    whole = replace(camera, zoom=1.0, distance=None)
    coarse = whole.frame(corners, few)
    for _ in range(MOST_LOOKS):
        found = Sight.of_pixels(coarse, caster.look(coarse.pencil))
        seen = _around(found)
        left = np.concatenate([np.zeros((0, 3)), *_left_open(caster, coarse, found)])
        if not len(left):
            break
        before, seen = coarse, np.concatenate([seen, left])
        coarse = whole.frame(seen, few, corners)
        if len(found.met) or coarse.pixel > before.pixel / 2:
            break
    return camera.frame(seen, size, corners) if len(seen) else camera.frame(corners, size)


def _around(found: Sight) -> Floats:
    """Points (n, 3) a pixel beside what is seen, for so far the body may go on."""
    if not len(found.met):
        return np.zeros((0, 3))
    points = found.points_at(slice(None))
    room = found.view.pixel_at(found.depth)[:, None]
    return np.concatenate([points + sign * room * axis for axis in found.view.axes[:2] for sign in (-1, 1)])


def _left_open(caster: Caster, view: Viewport, found: Sight) -> Iterator[Floats]:
    """Corners (n, 3) of tiles more than a pixel beside the rectangle of what is seen that may hold something."""
    width, height = view.size
    left, right, top, bottom = width, 0, 0, 0
    if len(found.met):
        left, right = int(found.column.min()) - 1, int(found.column.max()) + 2
        top, bottom = int(found.row.min()) - 1, int(found.row.max()) + 2
    for columns, rows in (
        ((0, left), (0, height)),
        ((right, width), (0, height)),
        ((left, right), (0, top)),
        ((left, right), (bottom, height)),
    ):
        begins, ends = (max(columns[0], 0), max(rows[0], 0)), (min(columns[1], width), min(rows[1], height))
        if begins[0] < ends[0] and begins[1] < ends[1]:
            yield _of_rectangle(caster, view.pencil, np.array(begins), np.array(ends))


def _of_rectangle(caster: Caster, pencil: Pencil, begins: Floats, ends: Floats) -> Floats:
    """Corners (n, 3) of the tiles of a rectangle of pixels that may hold something, more and more closely."""
    side = 1.0
    for _ in range(ROUNDS):
        columns, rows = np.ceil((ends - begins) / side - 1e-9).astype(int).tolist()
        tiles = pencil.part(begins, side, (columns, rows))
        starts = caster.starts(tiles)
        row, column = np.nonzero(np.isfinite(starts))
        if not len(row):
            return np.zeros((0, 3))
        places = np.stack([column, row], axis=1)
        begins, ends = begins + side * places.min(axis=0), begins + side * (places.max(axis=0) + 1)
        depths = starts[row, column]
        side /= FINER
    return np.concatenate(
        [o + depths[:, None] * d for o, d in (tiles.rays(column + i, row + j) for i in (0, 1) for j in (0, 1))]
    )
