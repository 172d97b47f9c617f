"""Triangles as bytes of binary PLY and STL, whole or some at a time: a header, then rows in their order."""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.arrays import Floats, Integers

# A cross product of two sides this short has no direction: a hundred times the spacing of float64 at 1.
NO_DIRECTION = 100 * np.finfo(np.float64).eps


def ply_header(vertices: int, faces: int) -> bytes:
    """What precedes so many float64 vertices and int32 faces, little-endian."""
    return (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n"
        f"element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    ).encode()


def ply_vertices(vertices: Floats) -> bytes:
    """Vertices (n, 3)."""
    return vertices.astype("<f8", copy=False).tobytes()


def ply_faces(faces: Integers) -> bytes:
    """Faces (m, 3)."""
    rows: Any = np.empty(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
    rows["count"], rows["corners"] = 3, faces
    return bytes(rows.tobytes())


def stl_header(faces: int) -> bytes:
    """What precedes so many triangles: 80 empty bytes and their number.

    Examples
    --------
    >>> stl_header(12)[80:].hex()
    '0c000000'
    """
    return bytes(80) + faces.to_bytes(4, "little")


def stl_faces(corners: Floats) -> bytes:
    """Triangles (m, 3, 3) in float32, each after its unit normal, zero where it has none."""
    rows: Any = np.zeros(len(corners), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attributes", "<u2")])
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 1]
    normal = np.cross(first, second)
    length = np.sqrt(normal[:, 0] ** 2 + normal[:, 1] ** 2 + normal[:, 2] ** 2)
    rows["normal"] = normal * np.where(length > NO_DIRECTION, 1 / np.maximum(length, NO_DIRECTION), 0)[:, None]
    rows["corners"] = corners
    return bytes(rows.tobytes())
