"""The routines that run tapes, called by name, and how many tapes are written at once."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats, Ints
from rsym.backends.llvm_code import machine_code
from rsym.backends.tape import aligned
from rsym.sampling.kernels.routines import LANES
from rsym.sampling.regions.region_code import region_code
from rsym.sampling.regions.region_tapes import Codes
from rsym.sampling.regions.regions import Regions

_POINTER, _INTEGER = ctypes.c_void_p, ctypes.c_int64
_TAPES = [_POINTER] * 8
_SIGNATURES: dict[str, Sequence[Any]] = {
    "boxes": (*[_INTEGER] * 2, _POINTER, *[_INTEGER] * 2, *_TAPES, *[_POINTER] * 3),
    "signs": (_INTEGER, _INTEGER, _POINTER, _INTEGER, *[_POINTER] * 2, _INTEGER, _POINTER, _INTEGER, _POINTER, *_TAPES),
    "fill": (
        _INTEGER, _INTEGER, _POINTER, _INTEGER, *[_POINTER] * 2, _INTEGER, _POINTER, _INTEGER, _POINTER, *_TAPES,
    ),
    "crossings": (
        *[_INTEGER] * 2, *[_POINTER] * 2, _INTEGER, *[_POINTER] * 3, _INTEGER, _POINTER, *_TAPES, *[_POINTER] * 4,
    ),
    "values": (_INTEGER, _INTEGER, *[_POINTER] * 2, _INTEGER, *[_POINTER] * 2, *_TAPES, *[_POINTER] * 4),
    "leaves": (_INTEGER, _INTEGER, *[_POINTER] * 2, *[_INTEGER] * 3, *[_POINTER] * 2, *_TAPES),
    "slide": (_INTEGER, _INTEGER, *[_POINTER] * 2, *[_INTEGER] * 2, _POINTER, *_TAPES),
}  # fmt: skip
# Entries whose tapes are written at once: a few megabytes.
ENTRIES = 2**14


@cache
def _functions() -> tuple[Any, Mapping[str, Callable[..., None]]]:
    engine = machine_code(region_code())
    made = {
        name: ctypes.CFUNCTYPE(None, *kinds)(engine.get_function_address(name)) for name, kinds in _SIGNATURES.items()
    }
    return engine, made


def call(name: str, *arguments: Any) -> None:
    """Run a routine; of arrays it is given the address."""
    _functions()[1][name](*(a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments))


def tapes_of(codes: Codes, room: NDArray[np.uint8]) -> Sequence[NDArray[Any]]:
    """Tapes as routines take them."""
    return codes.rows, codes.uniform, codes.row, codes.number, codes.count, codes.above, codes.result, room


def portions(sizes: Ints) -> list[tuple[int, int]]:
    """First and last of regions whose tapes are written at once, by how many entries they have.

    Examples
    --------
    >>> portions(np.array([ENTRIES // 2, ENTRIES // 4, ENTRIES // 2, 5]))
    [(0, 2), (2, 4)]
    """
    cuts = np.flatnonzero(np.diff(np.cumsum(sizes) // ENTRIES)) + 1
    return [(a, b) for a, b in pairwise([0, *cuts.tolist(), len(sizes)]) if b > a]


def bounds_of(regions: Regions, codes: Codes, ends: Floats) -> Floats:
    """The bounds (entries, 2, 8) of the entries of regions, of each over eight boxes with these ends, one a column."""
    bounds, given = np.empty((int(regions.start[-1]), 2, LANES)), np.ascontiguousarray(ends)
    listed = (regions.start, np.diff(regions.start), bounds)
    call("boxes", 0, len(regions), given, *given.shape, *tapes_of(codes, aligned(codes.memory)), *listed)
    return bounds
