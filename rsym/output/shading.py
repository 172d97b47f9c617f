"""Light on a surface: directions to colours, colours to an antialiased image, and one normal for each vertex.

All sums are taken in linear light; only the last step encodes for the screen.
Directions are those of the camera: x right, y up, z towards the eye.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeAlias

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.sampling.mesh import Mesh

Ints = NDArray[np.integer[Any]]
Light: TypeAlias = NDArray[np.floating[Any]]  # float64, or float32 where a picture has many pixels
# Blender and most viewers call an edge sharp from 30 degrees on; normals of triangles stand for a smooth surface below.
SHARP = np.cos(np.radians(30.0))
# Normals of leaves are exact: they differ where two leaves meet, and only there.
KINK = np.cos(np.radians(1.0))
# Where the eye stands, in degrees: above the xy-plane, and from x towards y. The front of the car is seen, which
# drives along y.
ELEVATION, AZIMUTH = 22.0, 48.0
# Above the camera's left shoulder, so that neighbouring faces of a box differ in brightness.
KEY = np.array([-0.38, 0.76, 0.53])
FILL = np.array([0.70, -0.35, 0.62])
KEY_STRENGTH, FILL_STRENGTH, AMBIENT, SKY = 0.84, 0.20, 0.20, 0.06
SHINE, SHINE_EXPONENT = 0.16, 36
# How much darker a place gets that lies this share of the body's depth behind its surroundings, and at most.
HOLLOW, HOLLOW_MOST = 9.0, 0.5
HOLLOW_RADIUS = 0.025  # of a picture's longer side
COARSER = 6  # samples of a radius that are enough for the mean over it
# Grazing surfaces lose this share of their light: a light body then keeps its outline on white paper.
RIM = 0.30
# A body, and the inside of its surface, seen where it is open.
BODY = "#8aa4c8"
INSIDE = "#b5764c"


def unit(vectors: Floats) -> Floats:
    """Scale vectors (last axis) to length one; zero stays zero."""
    length = np.sqrt(np.einsum("...i,...i->...", vectors, vectors))[..., None]
    result: Floats = vectors / np.where(length > 0, length, 1.0)
    return result


def linear(colour: str) -> Floats:
    """Decode a colour's name to linear red, green and blue.

    Examples
    --------
    >>> linear("#808080").round(4)
    array([0.2159, 0.2159, 0.2159])
    """
    try:
        encoded = np.array(to_rgb(colour))
    except ValueError as error:
        raise RsymError(
            f"a colour is a name or #rrggbb, got {colour!r}", code="colour", remedy=f"write for example '{BODY}'"
        ) from error
    return decode(encoded)


def decode(encoded: Floats) -> Floats:
    """Turn what a screen shows (sRGB) into linear light."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def encode(light: Floats) -> Floats:
    """Encode linear light for the screen (sRGB), clipped to [0, 1]."""
    light = np.clip(light, 0.0, 1.0)
    return np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def shade(normals: Floats, colours: Floats) -> Floats:
    """Return the linear light of points with unit normals (n, 3) and colours (n, 3)."""
    # A normal that turns away from the eye comes from interpolation: take the nearest one that does not.
    normals = normals.copy(order="K")
    normals[:, 2] = np.maximum(normals[:, 2], 0.0)
    diffuse, shine = lit(*unit(normals).T)
    return colours * diffuse[:, None] + shine[:, None]


def lit(
    right: Light, up: Light, towards: Light, key_share: Light | float = 1.0, sky_share: Light | float = 1.0
) -> tuple[Light, Light]:
    """Return the share of its colour that a place gives back and the highlight on it, for the parts of its unit normal.

    A key light that wraps round the body, a fill light from the other side, a sky that is brighter than the ground, and
    a soft highlight. The shares are those of the key light, and of all other light, that reach the place.
    """
    key, fill, gloss = (unit(way).tolist() for way in (KEY, FILL, unit(KEY) + np.array([0.0, 0.0, 1.0])))
    # Written out: sums by BLAS depend on how many there are. Powers make both lights fade out without a visible line.
    wrapped = ((key[0] * right + key[1] * up + key[2] * towards + 0.35) / 1.35).clip(0.0)
    wrapped *= np.sqrt(wrapped) * key_share
    filled = (0.5 + 0.5 * (fill[0] * right + fill[1] * up + fill[2] * towards)) ** 2
    diffuse = KEY_STRENGTH * wrapped + (FILL_STRENGTH * filled + AMBIENT + SKY * up) * sky_share
    diffuse *= 1 - RIM * (1 - towards) ** 2
    shine = _power((gloss[0] * right + gloss[1] * up + gloss[2] * towards).clip(0.0), SHINE_EXPONENT)
    return diffuse, SHINE * key_share * shine


def _power(values: Light, exponent: int) -> Light:
    """A whole power by squares: pow takes ten times as long."""
    square, result = values, np.ones_like(values)
    while exponent:
        if exponent % 2:
            result = result * square
        square, exponent = square * square, exponent // 2
    return result


def hollows(depth: Light, radius: int) -> Light:
    """Return factors that darken what lies behind its surroundings, so that recesses and openings read as such.

    `depth` is (h, w) with NaN where there is nothing. The depth is compared with
    its mean over the surroundings (Luft, Colditz, Deussen 2006).
    """
    span = _span(depth)
    there, mean = np.isfinite(depth), surroundings(depth, radius)
    return _darkened(np.where(there, depth - mean, 0.0) / span)


def hollows_at(depth: Light, radius: int) -> Light:
    """The factors of `hollows` where there is something, in order, for a picture of many pixels.

    The mean over the surroundings is smooth: it is taken on a coarser picture.
    """
    factor = max(radius // COARSER, 1)
    height, width = (-(-side // factor) * factor for side in depth.shape)
    padded = np.full((height, width), np.nan, depth.dtype)
    padded[: depth.shape[0], : depth.shape[1]] = depth
    mean = surroundings(mean_depth(padded, factor), max(radius // factor, 1)).astype(depth.dtype)
    rows, columns = (_mixing(side, factor, depth.dtype) for side in depth.shape)
    there = np.isfinite(depth)
    across = mean[:, columns[0]] * (1 - columns[1]) + mean[:, columns[0] + 1] * columns[1]
    whole = across[rows[0]] * (1 - rows[1])[:, None] + across[rows[0] + 1] * rows[1][:, None]
    return np.asarray(_darkened((depth[there] - whole[there]) / _span(depth)))


def _mixing(count: int, factor: int, kind: Any) -> tuple[Ints, Light]:
    """Between which coarse samples fine ones lie, and how far from the first to the second."""
    place = (np.arange(count) + 0.5) / factor - 0.5
    first = np.floor(place).astype(np.int64).clip(0, max(-(-count // factor) - 2, 0))
    return first, (place - first).clip(0.0, 1.0).astype(kind)


def _span(depth: Light) -> float:
    there = depth[np.isfinite(depth)]
    span = float(np.ptp(there)) if there.size else 1.0
    rounding = 16 * float(np.finfo(depth.dtype).eps) * float(np.abs(there).max(initial=0.0))
    return span if span > rounding else np.inf  # a plane square to the eye has no hollows


def _darkened(behind: Light) -> Light:
    """The light that is left at places so far behind their surroundings."""
    return np.asarray(1 - HOLLOW_MOST * (1 - np.exp(-HOLLOW * behind.clip(0.0))))


def surroundings(depth: Light, radius: int) -> Floats:
    """The mean depth round each sample, NaN left out, 0 where there is no other."""
    there = np.isfinite(depth)
    weight, total = (_blur(_blur(part, radius), radius) for part in (there.astype(float), np.where(there, depth, 0.0)))
    mean: Floats = np.divide(total, weight, out=np.zeros_like(total), where=weight > 1e-6)
    return mean


def _blur(values: Floats, radius: int) -> Floats:
    """Average over squares of 2*radius + 1 samples, zero outside."""
    for axis in (0, 1):
        pad = [(radius + 1, radius) if axis == k else (0, 0) for k in (0, 1)]
        total = np.cumsum(np.pad(values, pad), axis=axis)
        ends = np.arange(values.shape[axis])
        values = (total.take(ends + 2 * radius + 1, axis) - total.take(ends, axis)) / (2 * radius + 1)
    return values


def mean_depth(depth: Light, factor: int) -> Light:
    """Average the depths of factor x factor samples, NaN left out, NaN where there is no other."""
    height, width = depth.shape[0] // factor, depth.shape[1] // factor
    blocks = depth.reshape(height, factor, width, factor)
    there = np.isfinite(blocks)
    count = there.sum(axis=(1, 3))
    mean = np.where(there, blocks, 0.0).sum(axis=(1, 3)) / np.where(count, count, np.nan)
    return np.asarray(mean)


@lru_cache(maxsize=1)
def _encoded() -> NDArray[np.uint8]:
    """What a screen shows of 2**16 shares of light: half a level off at most beside the step between two levels."""
    return np.rint(255 * encode(np.linspace(0.0, 1.0, 1 << 16))).astype(np.uint8)


def levels(light: Light) -> NDArray[np.uint8]:
    """Encode linear light for the screen in 256 levels, clipped, by a table: ten times as fast.

    Examples
    --------
    >>> levels(np.array([-0.1, 0.2159, 1.0, 2.0])).tolist()
    [0, 128, 255, 255]
    """
    return np.asarray(_encoded()[np.rint(light.clip(0.0, 1.0) * ((1 << 16) - 1)).astype(np.uint16)])


def reduce(samples: NDArray[np.float32], factor: int) -> NDArray[np.uint8]:
    """Average (h*factor, w*factor, 4) samples of light and coverage, light times coverage, to an (h, w, 4) image."""
    height, width = samples.shape[0] // factor, samples.shape[1] // factor
    parts = [samples[row::factor, column::factor] for row in range(factor) for column in range(factor)]
    mean = np.add.reduce([part[:height, :width] for part in parts], dtype=np.float64) / factor**2
    coverage = mean[..., 3:]
    # White where there is nothing: some formats do not know what shows through.
    colour = np.where(coverage > 0, encode(mean[..., :3] / np.where(coverage > 0, coverage, 1.0)), 1.0)
    image: NDArray[np.uint8] = np.rint(255 * np.concatenate([colour, coverage], axis=-1)).astype(np.uint8)
    return image


@dataclass(frozen=True)
class ShadedVertices:
    """Vertices (k, 3) with a unit normal (k, 3) each, the faces (m, 3) among them, and whose copies they are (k,)."""

    vertices: Floats
    normals: Floats
    faces: Ints
    source: Ints


def split_sharp(mesh: Mesh) -> ShadedVertices:
    """Copy each vertex once for every direction its corners face, so that smooth shading keeps sharp edges crisp.

    Corners of one vertex share a copy where their normals lie within 30 degrees
    of the first, on one leaf and within one degree if the faces know their leaves;
    the copy takes their mean. Vertices of no face are left out.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> len(split_sharp(Mesh(corners, faces)).vertices)
    12
    """
    vertex = mesh.faces.ravel().astype(np.int64)
    corner = vertex if mesh.leaf is None else vertex * (int(mesh.leaf.max()) + 1) + np.repeat(mesh.leaf, 3)
    limit = SHARP if mesh.leaf is None else KINK
    normals = mesh.normals.reshape(-1, 3)
    copy = np.zeros(len(corner), np.int64)
    left = np.arange(len(corner))
    while left.size:
        names, first = np.unique(corner[left], return_index=True)
        seeds = normals[left[first]][np.searchsorted(names, corner[left])]
        apart = np.einsum("ij,ij->i", seeds, normals[left]) < limit
        # The seeds themselves stay whatever rounding says, so each round has fewer corners left.
        apart[first] = False
        left = left[apart]
        copy[left] += 1
    _, first, faces = np.unique(corner * (copy.max() + 1) + copy, return_index=True, return_inverse=True)
    sums: Floats = np.stack([np.bincount(faces, normals[:, k]) for k in range(3)], axis=1).astype(np.float64)
    source = vertex[first]
    return ShadedVertices(mesh.vertices[source], unit(sums), faces.reshape(-1, 3).astype(np.int64), source)


def developed(canvas: NDArray[np.float32], background: str | None) -> NDArray[np.uint8]:
    """What a screen shows, (h*w, 4)."""
    behind = np.ones(3) if background is None else linear(background)
    one = np.array([*levels(behind), 0 if background is None else 255], np.uint8)
    pixels = np.full(len(canvas), one.view(np.uint32)[0]).view(np.uint8).reshape(-1, 4)
    there = np.flatnonzero(canvas[:, 3] > 0)
    light, coverage = canvas[there, :3], canvas[there, 3:]
    if background is None:
        pixels[there, :3] = levels(light / coverage)
        pixels[there, 3] = np.rint(255 * coverage[:, 0])
    else:
        pixels[there, :3] = levels(light + (1 - coverage) * behind.astype(np.float32))
    return pixels
