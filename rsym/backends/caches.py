"""Compiled code kept on this machine: private folders in the user's cache, entries whole or not at all.

An entry is code that will be run: its name is a digest of everything it was made of, it is read only where nobody else
can have written it, and what cannot be read or written, or is damaged, is made again. The folders may be deleted at any
time.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import sys
import tempfile
from functools import cache
from pathlib import Path

logger = logging.getLogger(__name__)
DIGEST = hashlib.sha256().digest_size
MOST_ENTRIES = 1024  # of a folder: machine code of models takes 5 to 100 kB each


def cache_folder(kind: str) -> Path:
    """Where this user's caches are kept, by the custom of the system."""
    if sys.platform == "win32":
        place = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
    elif sys.platform == "darwin":
        place = Path.home() / "Library" / "Caches"
    else:
        place = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(place) / "rsym" / kind


def read_entry(kind: str, name: str) -> bytes | None:
    """Read an entry that is whole and that nobody else can have written."""
    try:
        entry = cache_folder(kind) / name
        stored = entry.read_bytes() if _is_ours(entry.parent) and _is_ours(entry) else b""
        payload = stored[DIGEST:]
        if not payload or stored[:DIGEST] != _digest(name, payload):
            return None
        with contextlib.suppress(OSError):  # of a folder that is only to be read
            os.utime(entry)  # what is used stays
    except (OSError, RuntimeError):  # Path.home() raises RuntimeError where there is no home
        return None
    return payload


def keep_entry(kind: str, name: str, payload: bytes) -> None:
    """Keep an entry, whole or not at all: another process may be reading or writing the same one."""
    try:
        folder = cache_folder(kind)
        folder.mkdir(parents=True, exist_ok=True)
        folder.chmod(0o700)
        with tempfile.TemporaryDirectory(dir=folder) as aside:
            whole = Path(aside) / name
            whole.write_bytes(_digest(name, payload) + payload)
            os.replace(whole, folder / name)
        _forget(folder)
    except (OSError, RuntimeError) as reason:
        logger.info("compiled code is not kept: %s", reason)


def _digest(name: str, payload: bytes) -> bytes:
    """Of an entry under its name: whole, and not another one."""
    return hashlib.sha256(name.encode() + b" " + payload).digest()


@cache
def digest_of_rooms(*rooms: str) -> str:
    """A digest of the source of rooms of this package, empty where that cannot be read.

    In the name of an entry it stands for everything that these rooms do: what has changed makes another entry.
    """
    digest, count = hashlib.sha256(), 0
    try:
        for room in rooms:
            for module in sorted((Path(__file__).parents[1] / room).glob("*.py")):
                digest.update(f"{room}/{module.name} ".encode() + module.read_bytes())
                count += 1
    except OSError:
        return ""
    return digest.hexdigest() if count else ""


def _forget(folder: Path) -> None:
    """Delete the entries that were not used for the longest time, where there are too many."""
    with os.scandir(folder) as listed:  # asks no entry for its state: some hundred are kept for one model
        entries = [entry for entry in listed if entry.is_file()]
    if len(entries) > MOST_ENTRIES:
        entries.sort(key=lambda entry: entry.stat().st_mtime)
        for entry in entries[: len(entries) - MOST_ENTRIES * 3 // 4]:
            Path(entry).unlink(missing_ok=True)


def _is_ours(path: Path) -> bool:
    """Entries are code: nobody else may own or write them, or the folder that holds them."""
    state = path.stat()
    return not hasattr(os, "getuid") or (state.st_uid == os.getuid() and not state.st_mode & 0o022)
