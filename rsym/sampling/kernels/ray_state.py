"""The state of eight rays that march together, as rows of memory."""

from __future__ import annotations

from enum import IntEnum

from rsym.backends.vector_code import Value
from rsym.sampling.kernels.routines import LANES, Routine


class Row(IntEnum):
    """The rows of the state of eight rays."""

    ORIGIN = 0
    DIRECTION = 3
    T = 6  # all before is negative
    STOP = 7
    STEP = 8
    STATUS = 9  # below
    LOW = 10  # the ends of the bracket
    HIGH = 11
    LEAF = 12
    START = 13
    ENTRY = 14  # the leaf by which the ray comes into the bounds, -1 without one
    NORMAL = 15
    FAILED = 18  # points in vain; then the leaf that is followed, -1 when it has been found
    DOUBT = 19  # 1 where what is said is not certain


ROWS = 20
GONE, MARCHING, MET, LOST = -1.0, 0.0, 1.0, 2.0


def get(r: Routine, row: int) -> Value:
    """A row of the state."""
    return r.value(r.load("%state", row * LANES))


def put(r: Routine, row: int, value: Value) -> None:
    """Change a row of the state."""
    r.store(value.name, "%state", row * LANES)


def least(a: Value, b: Value) -> Value:
    """The smaller."""
    return (a < b).choose(a, b)


def most(a: Value, b: Value) -> Value:
    """The larger."""
    return (a > b).choose(a, b)
