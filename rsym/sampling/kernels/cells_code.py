"""What matters of a form where rays are: of a beam in stretches, of a large form in the cells of its bounds.

Whatever rays there are, beside each other or not, the words of the cell that a ray is in say what matters to it until
it leaves that. Cells overlap a little, so that a ray may be taken for one in the next cell as rounding has it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

from rsym.backends.vector_code import Value
from rsym.sampling.kernels.form_code import AXES
from rsym.sampling.kernels.ray_code import ENDS, NAMED, STRUCT, RayFormulas
from rsym.sampling.kernels.ray_state import Row, get, least, most, turns
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine
from rsym.sampling.kernels.table_layout import WorkRoom

# What comes before the cells, the limits of a march: corner, width and number along the axes, and how far beyond its
# sides what is known of a cell holds. Then for each cell where that lies, words or a region.
CORNER, WIDTH, NUMBER, MARGIN, HEAD = 0, 3, 6, 9, 16
# Of the margin: how far ahead it is asked which cell a ray is in, which must not lie behind the side that it came by;
# how wide beams may be that march by cells.
AHEAD, THIN = 2.0**-10, 1 - 2.0**-7


class InCells(NamedTuple):
    """Eight rays in cells of their own, those that are asked for."""

    numbers: Value
    asked: Value
    cells: str
    room: str


Known: TypeAlias = str | InCells  # words, or what lies in cells


def stretch_of(s: RayFormulas, r: Routine, t: Value) -> tuple[Value, Value]:
    """The number of the stretch of the beam in which t lies, and where that ends; the last one has no end.

    Of a large form the cell of its bounds.
    """
    if s.celled:
        return cell_of(r, t, "%limits")
    limit = r.element("%limits", 0)
    inside = t < limit
    return inside.choose(0.0, r.number(1.0)), inside.choose(limit, float("inf"))


def words_for(s: RayFormulas, r: Routine, asked: Value, number: Value) -> Known:
    """The words of the stretch in which all rays that are asked for lie, else those that hold for all of the beam."""
    if s.celled:
        return InCells(number, asked, "%limits", "%words")
    largest = asked.choose(number, float("-inf"))
    # The greatest of the lanes, and whether it is that of all.
    top = r.value(r.splat(r.emit(f"call double @llvm.vector.reduce.fmax.v{LANES}f64({DOUBLES} {largest.name})")))
    differs = r.emit(f"icmp ne i{LANES} {r.mask((asked & (number < top)).name)}, 0")
    known = most(top, r.number(0.0))
    one = r.emit(f"fptosi double {r.emit(f'extractelement {DOUBLES} {known.name}, i32 0')} to i64")
    chosen = r.emit(f"select i1 {differs}, i64 1, i64 {one}")
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


def among(known: Known, asked: Value) -> Known:
    """The same for fewer rays."""
    return known._replace(asked=asked) if isinstance(known, InCells) else known


def asking(s: RayFormulas, r: Routine, name: str, given: str, known: Known) -> str:
    """The call of `model` or `point` with what is known where eight rays are."""
    if not isinstance(known, InCells):
        return f"{name}({given}, ptr %constants, ptr {known})"
    places = f"{DOUBLES} {known.numbers.name}, i{LANES} {r.mask(known.asked.name)}, ptr {known.cells}"
    return f"{name}_in_cells({given}, {places}, ptr %constants, ptr {known.room})"


def cell_routines(s: RayFormulas) -> list[Routine]:
    """The form where each ray is in a cell of its own, and what is known of cells."""
    model = _in_cells(s, "model", dict.fromkeys(ENDS, DOUBLES), STRUCT, [DOUBLES] * 4)
    point = _in_cells(s, "point", dict.fromkeys(AXES, DOUBLES), NAMED, [DOUBLES, SHORTS])
    return [model, point, cells(s), *([regions(s)] if s.tabled else [])]


def _in_cells(s: RayFormulas, name: str, places: dict[str, str], result: str, types: Sequence[str]) -> Routine:
    """One turn for each cell among the rays that are asked for."""
    memory = {"numbers": DOUBLES, "asked": f"i{LANES}", "cells": "ptr", "constants": "ptr", "room": "ptr"}
    r = Routine(f"{name}_in_cells", places | memory, result, True)
    todo, numbers = r.emit(f"alloca i{LANES}, align 8"), r.emit(f"alloca {DOUBLES}, align 64")
    found = [r.emit(f"alloca {type}, align 64") for type in types]
    for type, place in zip(types, found, strict=True):
        r.store("zeroinitializer", place, 0, type)
    r.store("%numbers", numbers, 0)
    r.store("%asked", todo, 0, f"i{LANES}")
    given = ", ".join(f"{type} %{place}" for place, type in places.items())
    with turns(r, todo, numbers, 0) as (cell, mine, again):
        known = r.place("%cells", "i64", r.load(r.place("%cells", "i64", HEAD), cell, "i64"))
        room = ", ptr %room" if s.tabled else ""
        value = r.emit(f"call {result} @{name}({given}, ptr %constants, ptr {known}{room})")
        for k, (type, place) in enumerate(zip(types, found, strict=True)):
            part = r.emit(f"extractvalue {result} {value}, {k}")
            r.store(r.select(mine.name, part, r.load(place, 0, type), type), place, 0, type)
        r.do(f"br label %{again}")
    value = "poison"
    for k, (type, place) in enumerate(zip(types, found, strict=True)):
        value = r.emit(f"insertvalue {result} {value}, {type} {r.load(place, 0, type)}, {k}")
    r.do(f"ret {result} {value}")
    return r


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


def regions(s: RayFormulas) -> Routine:
    """The regions of words, for cells from `first` to below `last`: their sizes, or where there is a target, these."""
    parameters = {"first": "i64", "last": "i64"} | dict.fromkeys(("words", "constants", "places", "target"), "ptr")
    r = Routine("regions", parameters | {"room": "ptr"})
    measured = r.emit("icmp eq ptr %target, null")
    made = r.place("%room", "i64", s.room.region)
    with r.loop("%first", "%last", 1) as i:
        number = len(r.lines)
        words = r.place("%words", "i64", r.emit(f"mul i64 {i}, {s.words}"))
        r.do(f"call void @region(ptr {words}, ptr %constants, ptr %room)")
        entries = r.load(made, 0, "i64")
        size = r.emit(f"add i64 {r.emit(f'mul i64 {entries}, {WorkRoom.ENTRY}')}, 1")
        r.do(f"br i1 {measured}, label %measure{number}, label %keep{number}")
        r.start(f"measure{number}")
        r.store(size, "%places", i, "i64")
        r.do(f"br label %done{number}")
        r.start(f"keep{number}")
        kept = r.place("%target", "i64", r.load("%places", i, "i64"))
        bytes_ = r.emit(f"shl i64 {size}, 3")
        r.do(f"call void @llvm.memcpy.p0.p0.i64(ptr {kept}, ptr {made}, i64 {bytes_}, i1 false)")
        r.label(f"done{number}")
    r.do("ret void")
    return r
