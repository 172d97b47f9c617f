"""Meshes to files: the format by suffix, the file whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

import numpy as np
import trimesh

from rsym.errors import RsymError
from rsym.sampling.mesh import Mesh

# float32 keeps 7 digits: below this ratio of size to distance from the origin fewer than 3 of them describe the body.
SMALLEST_RATIO = 1e-4


def write(mesh: Mesh, path: str | os.PathLike[str]) -> Path:
    """Write a mesh to a file, in the format that the suffix names (``.stl``, binary).

    The file appears whole or not at all: an older one stays as it is until
    the new one is safe on the disk. The same mesh gives the same bytes.

    Parameters
    ----------
    mesh : Mesh
        The triangles, in the order and with the orientation of ``mesh.faces``.
    path : str or path-like
        Where to; the folder must exist.

    Returns
    -------
    Path
        The path of the file.

    Raises
    ------
    RsymError
        If the suffix is unknown, the folder is missing or cannot be written, or
        the format cannot hold the coordinates.

    Examples
    --------
    >>> import tempfile
    >>> from rsym.sampling.mesh import examine
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    >>> faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    >>> mesh = Mesh(corners, faces, np.zeros((4, 3, 3)), examine(corners, faces))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write(mesh, Path(folder, "corner.stl")).stat().st_size
    284
    """
    path = Path(path)
    encode = FORMATS.get(path.suffix.lower())
    if encode is None:
        raise RsymError(
            f"a mesh is written as {', '.join(FORMATS)}, got the suffix {path.suffix!r}",
            code="file-format",
            where=str(path),
            remedy=f"end the name with one of: {', '.join(FORMATS)}",
        )
    return write_atomically(path, encode(mesh))


def write_atomically(path: str | os.PathLike[str], data: bytes) -> Path:
    """Put data into a file by way of a temporary file in the same folder; a failure leaves no trace."""
    path = Path(path)
    # A link keeps pointing where it points: its target is replaced, not the link.
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise RsymError(
            f"there is no folder {str(target.parent)!r}", code="file-folder", where=str(path), remedy="make it first"
        )
    temporary = target.parent / f".{secrets.token_hex(8)}.part"
    try:
        _write_safely(temporary, data)
        if target.exists():
            shutil.copymode(target, temporary)
        os.replace(temporary, target)
    except OSError as error:
        raise RsymError(
            f"the file cannot be written: {error.strerror or error}",
            code="file-write",
            where=str(path),
            remedy="choose a folder with room and the right to write",
        ) from error
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
    _sync_folder(target.parent)
    return path


def _write_safely(path: Path, data: bytes) -> None:
    with path.open("xb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())


def _sync_folder(folder: Path) -> None:
    """Make the new name last through a power cut, where the system can; the file itself is whole either way."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _stl(mesh: Mesh) -> bytes:
    """Encode as binary STL, 80 empty bytes and the triangles in float32."""
    _require_float32(mesh)
    data: bytes = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).export(file_type="stl")
    return data


def _require_float32(mesh: Mesh) -> None:
    """Refuse coordinates that float32 cannot tell apart, axis by axis."""
    corners = mesh.vertices[np.unique(mesh.faces)]
    extent, offset = np.ptp(corners, axis=0), np.abs(corners).max(axis=0)
    limits = np.finfo(np.float32)
    far = (extent > 0) & (extent < SMALLEST_RATIO * offset)
    if far.any():
        axis = int(np.argmax(far))
        raise RsymError(
            f"STL keeps 7 digits, too few for a body {extent[axis]:.3g} wide at {'xyz'[axis]} = {offset[axis]:.6g}",
            code="stl-precision",
            remedy="move the body to the origin",
        )
    if offset.max() > limits.max or extent.max() < limits.tiny / SMALLEST_RATIO:
        raise RsymError(
            f"STL holds numbers from {limits.tiny:.1g} to {limits.max:.1g}, the body is {extent.max():.3g} wide",
            code="stl-range",
            remedy="scale the body",
        )


FORMATS: Mapping[str, Callable[[Mesh], bytes]] = MappingProxyType({".stl": _stl})
