"""Light on a surface: directions to colours, colours to an antialiased image, and one normal for each vertex.

All sums are taken in linear light; only the last step encodes for the screen.
Directions are those of the camera: x right, y up, z towards the eye.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.sampling.mesh import Mesh

Ints = NDArray[np.integer[Any]]
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
    """Return the linear light of points with unit normals (n, 3) and colours (n, 3).

    A key light that wraps round the body, a fill light from the other side,
    a sky that is brighter than the ground, and a soft highlight.
    """
    key, fill = unit(KEY), unit(FILL)
    # A normal that turns away from the eye comes from interpolation: take the nearest one that does not.
    normals = normals.copy(order="K")
    normals[:, 2] = np.maximum(normals[:, 2], 0.0)
    normals = unit(normals)
    # Powers make both lights fade out without a visible line.
    wrapped = ((normals @ key + 0.35) / 1.35).clip(0.0) ** 1.5
    filled = (0.5 + 0.5 * (normals @ fill)) ** 2
    diffuse = KEY_STRENGTH * wrapped + FILL_STRENGTH * filled + AMBIENT + SKY * normals[:, 1]
    diffuse *= 1 - RIM * (1 - normals[:, 2]) ** 2
    shine = SHINE * (normals @ unit(key + np.array([0.0, 0.0, 1.0]))).clip(0.0) ** SHINE_EXPONENT
    return colours * diffuse[:, None] + shine[:, None]


def hollows(depth: Floats, radius: int) -> Floats:
    """Return factors that darken what lies behind its surroundings, so that recesses and openings read as such.

    `depth` is (h, w) with NaN where there is nothing. The depth is compared with
    its mean over the surroundings (Luft, Colditz, Deussen 2006).
    """
    there = np.isfinite(depth)
    known = np.where(there, depth, 0.0)
    span = max(float(np.ptp(depth[there])), np.finfo(float).tiny) if there.any() else 1.0
    weight, total = (_blur(_blur(part, radius), radius) for part in (there.astype(float), known))
    mean = np.divide(total, weight, out=np.zeros_like(total), where=weight > 1e-6)
    behind = (np.where(there, known - mean, 0.0) / span).clip(0.0)
    return 1 - HOLLOW_MOST * (1 - np.exp(-HOLLOW * behind))


def _blur(values: Floats, radius: int) -> Floats:
    """Average over squares of 2*radius + 1 samples, zero outside."""
    for axis in (0, 1):
        pad = [(radius + 1, radius) if axis == k else (0, 0) for k in (0, 1)]
        total = np.cumsum(np.pad(values, pad), axis=axis)
        ends = np.arange(values.shape[axis])
        values = (total.take(ends + 2 * radius + 1, axis) - total.take(ends, axis)) / (2 * radius + 1)
    return values


def mean_depth(depth: Floats, factor: int) -> Floats:
    """Average the depths of factor x factor samples, NaN left out, NaN where there is no other."""
    height, width = depth.shape[0] // factor, depth.shape[1] // factor
    blocks = depth.reshape(height, factor, width, factor)
    there = np.isfinite(blocks)
    count = there.sum(axis=(1, 3))
    mean: Floats = np.where(there, blocks, 0.0).sum(axis=(1, 3)) / np.where(count, count, np.nan)
    return mean


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
