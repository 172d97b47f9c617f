"""Still pictures for a notebook: small enough to stay in its file, drawn from the arrays alone.

A surface is seen by points spread evenly over it, a fixed number however many
triangles there are; of lines every so many vertices are kept.
"""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.backends.kernel import checked_threads, lasting_threads

WIDTH, HEIGHT = 112, 84  # pixels; 4 kB hold the page
POINTS = 32_000  # each covers four pixels, and each pixel is covered some twenty times
TRIANGLES = 50_000  # that are looked at
SHADES = 15  # and the empty sheet: four bits to a pixel
LEVEL, PIECE = 6, 1 << 20  # of a large picture: 6 halves what 1 leaves, for 20 ms; bytes that one processor packs
VERTICES, LINES = 300, 40  # of a picture of lines
# Where the eye is: the right, the up and the towards-the-eye direction of a view from the front, right and above.
VIEW = np.array([[0.82, 0.57, 0.0], [-0.21, 0.31, 0.93], [0.53, -0.76, 0.37]])
LIGHT = np.array([0.3, 0.5, 0.8])


def surface_picture(vertices: Floats, faces: NDArray[np.integer]) -> str:
    """A shaded surface as an HTML image.

    Examples
    --------
    >>> picture = surface_picture(np.eye(3), np.array([[0, 1, 2]]))
    >>> picture.startswith("<img "), len(picture) < 3500
    (True, True)
    """
    points, normals = _spread(vertices, faces)
    shades = np.zeros((HEIGHT, WIDTH), np.uint8)
    if len(points):
        seen = points @ VIEW.T
        low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
        room = np.array([WIDTH - 3, HEIGHT - 3])
        scale = float((room / np.maximum(high - low, 1e-300)).min())
        places = np.rint((seen[:, :2] - (low + high) / 2) * scale + room / 2 + 1).astype(np.int64)
        pixel = (HEIGHT - 1 - places[:, 1]) * WIDTH + places[:, 0]
        bright = np.abs(normals @ VIEW.T @ (LIGHT / np.linalg.norm(LIGHT)))
        order = np.argsort(seen[:, 2], kind="stable")  # the nearest come last, over all others
        square = np.array([0, 1, -WIDTH, 1 - WIDTH])
        tone = 1 + np.rint((0.25 + 0.75 * bright[order]) * (SHADES - 1)).astype(np.uint8)
        shades.reshape(-1)[pixel[order][:, None] + square] = tone[:, None]
    data = base64.b64encode(_png(shades)).decode()
    return f'<img alt="the surface" width="{2 * WIDTH}" height="{2 * HEIGHT}" src="data:image/png;base64,{data}">'


def _spread(vertices: Floats, faces: NDArray[np.integer]) -> tuple[Floats, Floats]:
    """Points evenly spread over triangles, and the unit normals there."""
    chosen = faces[:: -(-len(faces) // TRIANGLES) or 1]
    a, b, c = (vertices[chosen[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    areas = np.linalg.norm(across, axis=1)
    total = np.cumsum(areas)
    if not len(areas) or not 0 < total[-1] < np.inf:
        return np.empty((0, 3)), np.empty((0, 3))
    number = np.arange(POINTS)
    which = np.minimum(np.searchsorted(total, (number + 0.5) / POINTS * total[-1]), len(areas) - 1)
    # The plastic number's sequence fills a square evenly; folded along the diagonal, a triangle.
    u, v = (number * 0.7548776662466927) % 1, (number * 0.5698402909980532) % 1
    u, v = np.where(u + v > 1, 1 - u, u)[:, None], np.where(u + v > 1, 1 - v, v)[:, None]
    points = a[which] + u * (b[which] - a[which]) + v * (c[which] - a[which])
    return points, across[which] / areas[which][:, None]


def _png(shades: NDArray[np.uint8]) -> bytes:
    """Shades from 0, empty, to 15 as a PNG of four bits to a pixel."""
    packed = (shades[:, ::2] << 4) | shades[:, 1::2]
    rows = np.insert(packed, 0, 0, axis=1)  # a filter byte before each row: none
    grey = np.linspace([40, 52, 72], [222, 230, 240], SHADES).round().astype(np.uint8)
    palette = np.concatenate([np.array([[255, 255, 255]], np.uint8), grey]).tobytes()
    header = struct.pack(">IIBBBBB", shades.shape[1], shades.shape[0], 4, 3, 0, 0, 0)
    return _file_of(header, [(b"PLTE", palette), (b"tRNS", b"\0")], zlib.compress(rows.tobytes(), 9))


def png(pixels: NDArray[np.uint8]) -> bytes:
    """An (h, w, 3) or (h, w, 4) picture as a PNG; the same pixels give the same bytes.

    Examples
    --------
    >>> png(np.zeros((2, 3, 4), np.uint8))[1:4]
    b'PNG'
    """
    height, width, channels = pixels.shape
    flat = np.ascontiguousarray(pixels).reshape(height, -1)
    rows = np.full((height, 1 + flat.shape[1]), 2, np.uint8)  # a filter byte: what is added to the row above
    rows[0, 1:] = flat[0]
    np.subtract(flat[1:], flat[:-1], out=rows[1:, 1:])
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    return _file_of(header, [], _compressed(rows.tobytes()))


def _compressed(data: bytes) -> bytes:
    """A zlib stream made of pieces by all processors; where they end does not depend on how many there are."""
    pieces = [data[start : start + PIECE] for start in range(0, max(len(data), 1), PIECE)]

    def packed(number: int) -> bytes:
        packer = zlib.compressobj(LEVEL, zlib.DEFLATED, -15, 9)
        last = number == len(pieces) - 1
        return packer.compress(pieces[number]) + packer.flush(zlib.Z_FINISH if last else zlib.Z_SYNC_FLUSH)

    if len(pieces) == 1:
        body = [packed(0)]
    else:
        body = list(lasting_threads("rsym-png", checked_threads(None)).map(packed, range(len(pieces))))
    return b"\x78\x9c" + b"".join(body) + struct.pack(">I", zlib.adler32(data))


def _file_of(header: bytes, known: Sequence[tuple[bytes, bytes]], data: bytes) -> bytes:
    parts = [(b"IHDR", header), *known, (b"IDAT", data), (b"IEND", b"")]
    chunks = [
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in parts
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


def line_picture(lines: Sequence[Floats]) -> str:
    """Lines in the plane as an SVG, y upwards.

    Examples
    --------
    >>> line_picture([np.array([[0.0, 0.0], [1.0, 1.0]])]).count("<polyline")
    1
    """
    longest = sorted(lines, key=len, reverse=True)[:LINES]
    step = max(1, -(-sum(map(len, longest)) // (VERTICES - 2 * LINES)))
    drawn = [line[np.unique([*range(0, len(line), step), len(line) - 1])] for line in longest if len(line)]
    if not drawn:
        return ""
    every = np.concatenate(drawn)
    low, high = every.min(axis=0), every.max(axis=0)
    scale = float((np.array([2 * WIDTH, 2 * HEIGHT]) - 6).max() / max(float((high - low).max()), 1e-300))
    width, height = np.rint((high - low) * scale + 6).astype(int)
    texts = []
    for line in drawn:
        places = np.rint((line - low) * scale + 3).astype(int)
        texts.append(" ".join(f"{u},{height - v}" for u, v in places.tolist()))
    inside = "".join(f'<polyline points="{text}"/>' for text in texts)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" fill="none" stroke="currentColor">'
        f"{inside}</svg>"
    )
