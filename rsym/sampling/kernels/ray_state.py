"""The state of eight rays that march together, as rows of memory."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
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
    DOUBT = 19  # where a wall may first have been passed; then 1 where what is said is not certain
    MOVED = 20  # how far the last step of Newton's method went


ROWS = 21
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


@contextmanager
def turns(r: Routine, todo: str, rows: str, row: int) -> Iterator[tuple[str, Value, str]]:
    """One turn for each number in a row, of the lanes whose bits are left: it, its lanes, and where to go on."""
    number = len(r.lines)
    r.label(f"next{number}")
    left = r.load(todo, 0, f"i{LANES}")
    lane = r.emit(f"call i{LANES} @llvm.cttz.i{LANES}(i{LANES} {left}, i1 false)")
    some = r.emit(f"icmp ne i{LANES} {left}, 0")
    r.do(f"br i1 {some}, label %turn{number}, label %over{number}")
    r.start(f"turn{number}")
    place = r.emit(f"zext i{LANES} {lane} to i64")
    one = r.load(r.place(rows, "double", row * LANES), place, "double")
    same = r.value(r.load(rows, row * LANES)).compare("oeq", r.value(r.splat(one)))
    waiting = r.emit(f"bitcast i{LANES} {left} to <{LANES} x i1>")
    mine = r.value(waiting, "i1") & same
    rest = r.emit(f"xor i{LANES} {left}, {r.mask(mine.name)}")
    r.store(rest, todo, 0, f"i{LANES}")
    yield r.emit(f"fptosi double {one} to i64"), mine, f"next{number}"
    r.start(f"over{number}")
