"""What is thinner than a pixel: rays through the middles of pixels may pass it, beams round whole pixels do not.

A beam ends where its model no longer proves that all of it is outside of the body. Where that is well before all that
the rays nearby have met, the beam is divided, down to a 64th of a pixel, until nothing can be there or a ray through
the middle of a part meets it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.output.cameras import Viewport
from rsym.output.sights import Sight
from rsym.sampling.hits import Hits
from rsym.sampling.pencils import Cut
from rsym.sampling.rays import Caster

# What the rays of places see, columns and rows.
Look: TypeAlias = Callable[[Floats, Floats], Sight]

# Sides of beams in pixels, by halves; rays look through the middles of those below a pixel.
SIDES = (16, 8, 4, 2, 1, 1 / 2, 1 / 4, 1 / 8, 1 / 16, 1 / 32, 1 / 64)
# What rays have met so many pixels beside a beam explains that it ends there, and up to so many pixels, and so many of
# its sides, before: curved sides, models of formulas with many terms. A slope that rises by no more than so many sides
# explains as much again. What is not known in the end lies farther off than LEAST: models are wide about tips, where a
# form and its gradient are 0.
BESIDE, BEFORE, SIDES_BEFORE, SLOPE, LEAST = 2, 16.0, 2.0, 4.0, 3
MOST = 2  # beams for each pixel, on one level: of more the formula is such that beams tell nothing


@dataclass(frozen=True)
class Slender:
    """What lies between the rays of a picture.

    Attributes
    ----------
    pixels : (n,) array of int
        The pixels in which it was found, by number, row by row.
    columns, rows : (n,) arrays
        The places whose rays meet it first.
    undecided : (m,) array of int
        The pixels where neither a body nor its absence could be shown.
    blind : bool
        Whether the formula is such that beams tell next to nothing.
    """

    pixels: Ints
    columns: Floats
    rows: Floats
    undecided: Ints
    blind: bool


def slender(caster: Caster, sight: Sight, look: Look, cuts: Sequence[Cut] = ()) -> Slender:
    """Look between the rays of a picture.

    Examples
    --------
    >>> import numpy as np, rsym
    >>> needle = rsym.sphere(1) | rsym.box(0.01, 0.01, 3, (0, 0, 2))  # a sixth of a pixel wide
    >>> image = rsym.render(needle, camera="front", size=(60, 80))
    >>> int(image.hits.met[:40].sum()), bool((np.asarray(image)[3:40, 29:31, :3] < 200).all(2).any(1).all())
    (0, True)
    """
    view, hits = sight.view, sight.hits
    size, known = view.size, _nearest(hits, BESIDE)
    extremes = {1.0: (known, known)}
    for side in SIDES[SIDES.index(1) - 1 :: -1]:
        low, high = extremes[side / 2]
        extremes[side] = -_of_squares(-low), _of_squares(high)
    found = _Found(view, look, known.reshape(-1))
    number, begins, before = np.zeros(1, np.int64), np.array([-np.inf]), float(max(size))
    for side in SIDES:
        number, begins = _divided(number, begins, size, before, side)
        if len(number) > MOST * known.size:
            return found.all(number[:0], blind=True)
        places = number if side >= 1 else _pixels(number, size, side)
        low, high = (part.reshape(-1)[places] for part in extremes[max(side, 1.0)])
        far = _ends(low, high, max(side, 1.0), view)
        pencil = view.pencil.part((0, 0), side, _grid(size, side))
        begins = caster.starts(pencil, which=number, near=begins, far=far, cuts=cuts)
        left = np.isfinite(begins)
        number, begins, before = number[left], begins[left], side
        if side < 1:
            number, begins = found.looked(number, begins, side)
    left = _pixels(number, size, SIDES[-1])
    if len(left):
        wider = _nearest(hits, LEAST).reshape(-1)[left]
        left = left[begins < _ends(wider, wider, 1.0, view)]
    return found.all(left)


@dataclass
class _Found:
    """What rays have met where no ray through the middle of a pixel nearby has: depth, column and row by pixel."""

    view: Viewport
    look: Look
    known: NDArray[np.float32]
    places: dict[int, tuple[float, float, float]] = field(default_factory=dict)

    def looked(self, number: Ints, begins: Floats, side: float) -> tuple[Ints, Floats]:
        """Cast the rays through the middles of beams; those that are left of pixels where nothing was met."""
        pixel = _pixels(number, self.view.size, side)
        row, column = np.divmod(number, _grid(self.view.size, side)[0])
        columns, rows = (column + 0.5) * side - 0.5, (row + 0.5) * side - 0.5
        seen = self.look(columns, rows)
        known = self.known[pixel][seen.met]
        new = seen.depth < _ends(known, known, 1.0, self.view)
        which, depth = seen.met[new], seen.depth[new]
        for k, far in sorted(zip(which.tolist(), depth.tolist(), strict=True), key=lambda pair: -pair[1]):
            self.places[int(pixel[k])] = far, float(columns[k]), float(rows[k])
        left = ~np.isin(pixel, list(self.places))
        return number[left], begins[left]

    def all(self, undecided: Ints, blind: bool = False) -> Slender:
        """What was found."""
        pixels = np.array(sorted(self.places), np.int64)
        places = np.array([self.places[int(one)] for one in pixels]).reshape(-1, 3)
        return Slender(pixels, places[:, 1], places[:, 2], np.unique(undecided), blind)


def _nearest(hits: Hits, beside: int) -> NDArray[np.float32]:
    """The least depth of the hits so many pixels beside each, inf where nothing is met there."""
    depth = np.where(hits.undecided, np.inf, hits.depth).astype(np.float32)
    for axis in range(2):
        wide = np.moveaxis(depth, axis, 0)
        least = wide.copy()
        for k in range(1, min(beside, len(wide) - 1) + 1):
            np.minimum(least[k:], wide[:-k], out=least[k:])
            np.minimum(least[:-k], wide[k:], out=least[:-k])
        depth = np.moveaxis(least, 0, axis)
    return depth


def _ends(low: NDArray[np.float32], high: NDArray[np.float32], side: float, view: Viewport) -> Floats:
    """Where beams of such a side end, what is known in each from `low` to `high`."""
    least, most = low.astype(np.float64), high.astype(np.float64)
    pixel = view.pixel_at(np.where(np.isinf(most), 0.0, most))
    with np.errstate(invalid="ignore"):
        rise = np.where(most - least <= SLOPE * side * pixel, most - least, 0.0)
    return np.asarray(most - max(BEFORE, SIDES_BEFORE * side) * pixel - rise)


def _of_squares(values: NDArray[np.float32]) -> NDArray[np.float32]:
    """The greatest of each two by two, of which the last may be alone."""
    height, width = values.shape
    even = np.pad(values, ((0, height % 2), (0, width % 2)), constant_values=-np.inf)
    rows = np.maximum(even[::2], even[1::2])
    return np.maximum(rows[:, ::2], rows[:, 1::2])


def _grid(size: tuple[int, int], side: float) -> tuple[int, int]:
    """Columns and rows of beams."""
    width, height = size
    return int(np.ceil(width / side)), int(np.ceil(height / side))


def _divided(number: Ints, begins: Floats, size: tuple[int, int], side: float, finer: float) -> tuple[Ints, Floats]:
    """The beams of a finer side that others are divided into."""
    ratio = round(side / finer)
    (wide, _), (columns, rows) = _grid(size, side), _grid(size, finer)
    row, column = (part[:, None, None] * ratio for part in np.divmod(number, wide))
    below, right = row + np.arange(ratio)[:, None], column + np.arange(ratio)
    within = (below < rows) & (right < columns)
    starts = np.broadcast_to(begins[:, None, None], within.shape)
    return (below * columns + right)[within], starts[within]


def _pixels(number: Ints, size: tuple[int, int], side: float) -> Ints:
    """The pixels that beams below a pixel lie in."""
    row, column = np.divmod(number, _grid(size, side)[0])
    return np.floor(row * side).astype(np.int64) * size[0] + np.floor(column * side).astype(np.int64)
