"""What matters of a form where rays are: of a beam in stretches, of a large form in the cells of its bounds.

Whatever rays there are, beside each other or not, the words of the cell that a ray is in say what matters to it until
it leaves that. Cells overlap a little, so that a ray may be taken for one in the next cell as rounding has it.
"""

from __future__ import annotations

from rsym.backends.vector_code import Value
from rsym.sampling.kernels.ray_code import RayFormulas, WorkRoom
from rsym.sampling.kernels.ray_state import Row, get, least, most
from rsym.sampling.kernels.routines import DOUBLES, LANES, Routine

# What comes before the words of cells, the limits of a march: corner, width and number along the axes, and how far
# beyond its sides what is known of a cell holds.
CORNER, WIDTH, NUMBER, MARGIN, HEAD = 0, 3, 6, 9, 16
# Of the margin: how far ahead it is asked which cell a ray is in, which must not lie behind the side that it came by;
# how wide beams may be that march by cells.
AHEAD, THIN = 2.0**-10, 1 - 2.0**-7


def stretch_of(s: RayFormulas, r: Routine, t: Value) -> tuple[Value, Value]:
    """The number of the stretch of the beam in which t lies, and where that ends; the last one has no end.

    Of a large form the cell of its bounds.
    """
    if s.celled:
        return cell_of(r, t, "%limits")
    number, end = r.number(float(s.slabs)), r.number(float("inf"))
    for k in reversed(range(s.slabs)):
        limit = r.element("%limits", k)
        inside = t < limit
        number, end = inside.choose(float(k), number), inside.choose(limit, end)
    return number, end


def words_for(s: RayFormulas, r: Routine, asked: Value, number: Value) -> str:
    """The words of the stretch in which all rays that are asked for lie, else those that hold for all of the beam."""
    largest = asked.choose(number, float("-inf"))
    # The greatest of the lanes, and whether it is that of all.
    top = r.value(r.splat(r.emit(f"call double @llvm.vector.reduce.fmax.v{LANES}f64({DOUBLES} {largest.name})")))
    if s.celled:
        return words_of_cells(s, r, asked.choose(number, most(top, r.number(0.0))), "%limits", "%words")
    differs = r.emit(f"icmp ne i{LANES} {r.mask((asked & (number < top)).name)}, 0")
    known = most(top, r.number(0.0))
    one = r.emit(f"fptosi double {r.emit(f'extractelement {DOUBLES} {known.name}, i32 0')} to i64")
    chosen = r.emit(f"select i1 {differs}, i64 {s.slabs}, i64 {one}")
    return r.place("%words", "i64", r.emit(f"mul i64 {chosen}, {s.words}"))


def cell_of(r: Routine, t: Value, limits: str) -> tuple[Value, Value]:
    """The number of the cell in which t lies, and where the ray leaves it; the outer ones have no end."""
    ahead = r.element(limits, MARGIN) * AHEAD
    number, end = r.number(0.0), r.number(float("inf"))
    for axis in range(3):
        corner, width, count = (r.element(limits, part + axis) for part in (CORNER, WIDTH, NUMBER))
        origin, along = get(r, Row.ORIGIN + axis), get(r, Row.DIRECTION + axis)
        place = (origin + along * (t + ahead) - corner) / width
        one = (least(most(place, r.number(0.5)), count - 0.5) - 0.5).rounded
        number = number * count + one
        upwards, downwards = (along > 0.0) & (one < count - 1.0), (along < 0.0) & (one > 0.0)
        side = corner + upwards.choose(one + 1.0, one) * width
        leaves = (upwards | downwards).choose((side - origin) / along, float("inf"))
        end = least(leaves, end)
    return number, most(end, t + ahead * 2.0)


def words_of_cells(s: RayFormulas, r: Routine, numbers: Value, limits: str, room: str) -> str:
    """What matters in any of eight cells: the words, or the region of these."""
    r.do(f"call void @matter({DOUBLES} {numbers.name}, ptr {limits}, ptr %constants, ptr {room})")
    return r.place(room, "i64", s.room.region if s.tabled else s.room.words)


def matter(s: RayFormulas) -> Routine:
    """Put the words of cells, and their region, into the room; it stays while rays are where they were."""
    r = Routine("matter", {"numbers": DOUBLES, "limits": "ptr", "constants": "ptr", "room": "ptr"}, internal=True)
    numbers = r.value("%numbers")
    moved = numbers.compare("une", r.value(r.load("%room", WorkRoom.LAST)))
    with r.where(moved):
        r.store("%numbers", "%room", WorkRoom.LAST)
        target = r.place("%room", "i64", s.room.words)
        cells = []
        for lane in range(LANES):
            number = r.emit(f"fptosi double {r.emit(f'extractelement {DOUBLES} %numbers, i32 {lane}')} to i64")
            place = r.emit(f"add i64 {r.emit(f'mul i64 {number}, {s.words}')}, {HEAD}")
            cells.append(r.place("%limits", "i64", place))
        with r.loop("0", f"{s.words}", 1) as i:
            word = r.load(cells[0], i, "i64")
            for cell in cells[1:]:
                word = r.emit(f"and i64 {word}, {r.load(cell, i, 'i64')}")
            r.store(word, target, i, "i64")
        if s.tabled:
            r.do(f"call void @region(ptr {target}, ptr %constants, ptr %room)")
    r.do("ret void")
    return r


def begin(r: Routine) -> None:
    """No rays have been in any cell."""
    r.store(r.number(-1.0).name, "%room", WorkRoom.LAST)


def cells(s: RayFormulas) -> Routine:
    """What does not matter in cells `first` to below `last`: models of the coordinates in, nine rows, words out."""
    parameters = {"first": "i64", "last": "i64"} | dict.fromkeys(("given", "constants", "words", "room"), "ptr")
    r = Routine("cells", parameters | {"stride": "i64"})
    with r.loop("%first", "%last", LANES) as i:
        ends = [r.load(r.row("%given", "%stride", row), i) for row in range(9)]
        given = ", ".join(f"{DOUBLES} {end}" for end in ends)
        target = r.place("%words", "i64", r.emit(f"mul i64 {i}, {s.words}"))
        room = ", ptr %room" if s.tabled else ""
        r.do(f"call void @survey({given}, ptr %constants, ptr {target}, i64 {s.words}{room})")
    r.do("ret void")
    return r
