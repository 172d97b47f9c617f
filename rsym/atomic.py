"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from rsym.errors import RsymError


def write_atomically(path: str | os.PathLike[str], data: bytes) -> Path:
    """Put data into a file by way of a temporary file in the same folder; a failure leaves no trace."""
    with atomic_file(path) as file:
        file.write(data)
    return Path(path)


@contextlib.contextmanager
def atomic_file(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """A temporary file in the same folder, to write to; it takes the name in the end, and a failure leaves no trace."""
    path = Path(path)
    target = target_of(path)
    temporary = target.parent / f".{secrets.token_hex(8)}.part"
    try:
        with writing(path):
            with temporary.open("xb") as file:
                yield file
                file.flush()
                os.fsync(file.fileno())
            if target.exists():
                shutil.copymode(target, temporary)
            os.replace(temporary, target)
    finally:
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)
    _sync_folder(target.parent)


def target_of(path: Path) -> Path:
    """The file that a path means: a link keeps pointing where it points, and its target is replaced."""
    target = Path(os.path.realpath(path))
    if not target.parent.is_dir():
        raise RsymError(
            f"there is no folder {str(target.parent)!r}", code="file-folder", where=str(path), remedy="make it first"
        )
    return target


@contextlib.contextmanager
def writing(path: Path) -> Iterator[None]:
    """Whatever the system says against writing for this path, said as an RsymError."""
    try:
        yield
    except OSError as error:
        raise RsymError(
            f"the file cannot be written: {error.strerror or error}",
            code="file-write",
            where=str(path),
            remedy="choose a folder with room and the right to write",
        ) from error


def _sync_folder(folder: Path) -> None:
    """Make the new name last through a power cut, where the system can; the file itself is whole either way."""
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
