"""Light that does not arrive: soft shadows of the key light, and how much of the sky a place sees.

Each pixel casts one ray to the light and one to the sky. Which of sixteen directions it takes goes round in squares of
4 x 4 pixels, and what is said of a pixel is the mean over such a square about it, as far as its surface goes: so there
is no noise, and no number at random.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Ints
from rsym.output.shading import KEY, unit
from rsym.output.sights import Sight

# Whether rays from origins (n, 3) along directions (n, 3) meet the body within a distance.
Hidden: TypeAlias = Callable[[Floats, Floats, float], Flags]
SIDE = 4
# The tangent of the light's half angle as seen from the body: a large lamp, whose shadows are soft.
LAMP = 0.10
# So far a place looks for what hides the sky, of the size of the body: in a room of its own everything would be dark.
AROUND = 0.2
# The mean over squares is taken so often: after one the places of the directions in their square still show at edges.
SMOOTHINGS = 2
LIFTED = 0.75  # pixels that rays begin above the surface, so that it does not hide itself
# Where the light falls at a slant below this cosine, shadows fade: shade begins there anyway, without an edge.
FADING = 0.25
# In which order squares are filled, so that each half of one has directions from all sides (Bayer 1973).
ORDER = np.array([[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]])


@dataclass(frozen=True)
class Shade:
    """The share of the key light, and of the sky, that reaches each place (m,)."""

    key: NDArray[np.float32]
    sky: NDArray[np.float32]


def shade_of(sight: Sight, size: float, hidden: Hidden) -> Shade:
    """The light that reaches what a picture's own sight meets, of a body of some size."""
    key, sky = (np.ones(len(sight.met), np.float32) for _ in range(2))
    if not len(sight.met):
        return Shade(key, sky)
    number = ORDER[sight.row % SIDE, sight.column % SIDE]
    lamp, slant = unit(KEY @ sight.view.axes), unit(sight.normals)
    towards = slant @ lamp
    points = sight.points_at(slice(None))
    points += LIFTED * sight.view.pixel_at(sight.depth)[:, None] * slant
    lit = np.flatnonzero(towards > 0)
    key[lit] -= hidden(points[lit], _to_lamp(lamp, number[lit]), np.inf)
    sky -= hidden(points, _to_sky(slant, number), AROUND * size)
    both = np.stack([key, sky])
    for _ in range(SMOOTHINGS):
        both = _means(sight, both, size)
    key, sky = both
    fading = np.clip(towards / FADING, 0.0, 1.0).astype(np.float32)
    return Shade(1 - (1 - key) * fading, sky)


def _to_lamp(lamp: Floats, number: Ints) -> Floats:
    """Unit directions to sixteen places of the lamp."""
    side, up = _across(lamp[None])
    disc = _disc(LAMP)
    ways = unit(lamp + disc[:, :1] * side + disc[:, 1:] * up)
    return np.asarray(ways[number])


def _to_sky(normals: Floats, number: Ints) -> Floats:
    """Unit directions over the tangent plane, more of them along the normal: the light of an even sky."""
    side, up = _across(normals)
    disc = _disc(0.98)[number]
    height = np.sqrt(1 - np.einsum("ij,ij->i", disc, disc))
    return np.asarray(height[:, None] * normals + disc[:, :1] * side + disc[:, 1:] * up)


def _across(normals: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors each across unit normals (n, 3), without a jump but at -z (Duff et al. 2017)."""
    x, y, z = normals.T
    sign = np.copysign(1.0, z)
    a = -1 / (sign + z)
    b = x * y * a
    side = np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=1)
    return side, np.stack([b, sign + y * y * a, -y], axis=1)


def _disc(radius: float) -> Floats:
    """Sixteen places (16, 2) spread evenly over a disc, one after the other far apart (Vogel 1979)."""
    number = np.arange(SIDE**2)
    angle = number * np.pi * (3 - np.sqrt(5.0))
    return np.asarray(radius * np.sqrt((number + 0.5) / SIDE**2)[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1))


def _means(sight: Sight, values: NDArray[np.float32], size: float) -> NDArray[np.float32]:
    """The means (k, m) of values over squares of pixels, of those on the same leaf and not far before or behind."""
    width, height = sight.view.size
    label, depth = (each.reshape(height, width) for each in (sight.labels, sight.depths))
    flat = np.zeros((len(values), height * width), np.float32)
    flat[:, sight.met] = values
    whole = flat.reshape(-1, height, width)
    total, count = np.zeros_like(whole), np.zeros((height, width), np.float32)
    for i in range(1 - SIDE // 2, SIDE // 2 + 1):
        for j in range(1 - SIDE // 2, SIDE // 2 + 1):
            here = np.s_[max(-i, 0) : height - max(i, 0), max(-j, 0) : width - max(j, 0)]
            there = np.s_[max(i, 0) : height + min(i, 0), max(j, 0) : width + min(j, 0)]
            with np.errstate(invalid="ignore"):
                near = (label[here] == label[there]) & (np.abs(depth[here] - depth[there]) < AROUND / 4 * size)
            count[here] += near
            total[(slice(None), *here)] += near * whole[(slice(None), *there)]
    return np.asarray(total.reshape(len(values), -1)[:, sight.met] / count.reshape(-1)[sight.met])
