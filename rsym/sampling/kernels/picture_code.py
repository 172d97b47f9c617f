"""The routines of a caster as LLVM text: a picture tile by tile, beams first, and rays one by one.

A beam runs around the rays of a tile of pixels: how far it is negative all rays are, and what does not matter on its
rest matters to none of them. At a large form beams only say where rays begin: what matters is known of cells.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from rsym.backends.llvm_code import VECTORS, declarations
from rsym.backends.vector_code import Value
from rsym.program.program import Node
from rsym.sampling.kernels import table_code
from rsym.sampling.kernels.cells_code import MARGIN, THIN, InCells, cell_of, cell_routines
from rsym.sampling.kernels.march_code import clip, first_root, march, model_on, segment, settle
from rsym.sampling.kernels.ray_code import NAMED, STRUCT, RayFormulas, library, model, point, survey
from rsym.sampling.kernels.ray_state import GONE, MARCHING, ROWS, Row, get, least, most, put
from rsym.sampling.kernels.region_code import region
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine
from rsym.sampling.kernels.table_code import leaf_routines
from rsym.sampling.ray_steps import MOST_BEAM_STEPS, NEAR

BLOCK = (4, 2)  # columns and rows of the eight pixels that march together
FIRST_STEP, LEAST_STEP = 4.0, 2.0**-10  # of the side of a tile; of what is left of a beam: at an eye tiles are points
# What matters is asked for the first stretch of a beam, so many sides of a tile long, for there most rays end, and for
# all of its rest: on the car, of 38 gates, one more takes more than it saves.
NEAR_DEPTH, STRETCHES = 12.0, 2
WORDS = f"<{LANES} x i64>"
# What a camera is, as numbers in a row.
VECTORS_OF_CAMERA = ("corner", "across", "down", "eye")
NUMBERS_OF_CAMERA = ("perspective", "near", "far", "pixel", "growth", "radius", "spread", "reach")


def place_of(name: str) -> int:
    """Where a part of a camera begins."""
    if name in VECTORS_OF_CAMERA:
        return 3 * VECTORS_OF_CAMERA.index(name)
    return 3 * len(VECTORS_OF_CAMERA) + NUMBERS_OF_CAMERA.index(name)


class Picture(Routine):
    """A routine that makes rays of a camera."""

    def part(self, name: str, axis: int = 0) -> Value:
        """A number of the camera, in every lane."""
        return self.element("%camera", place_of(name) + axis)

    def scalar(self, name: str) -> str:
        """The same as a scalar."""
        return self.load("%camera", place_of(name), "double")

    def rays(self, column: Value, row: Value) -> None:
        """The rays through places counted in pixels, from near to far."""
        far_away = self.part("perspective") > 0.0
        places = [
            self.part("corner", axis) + column * self.part("across", axis) + row * self.part("down", axis)
            for axis in range(3)
        ]
        along = [place - self.part("eye", axis) for axis, place in enumerate(places)]
        length = self.root(along[0] * along[0] + along[1] * along[1] + along[2] * along[2])
        for axis, place in enumerate(places):
            put(self, Row.ORIGIN + axis, far_away.choose(self.part("eye", axis), place))
            put(self, Row.DIRECTION + axis, far_away.choose(along[axis] / length, self.part("eye", axis)))
        put(self, Row.T, self.part("near"))
        put(self, Row.STOP, self.part("far"))

    def march(self, limits: str, words: str, pixel: str, growth: str) -> None:
        """Cast the rays that are made."""
        given = f"ptr %state, ptr %constants, ptr {limits}, ptr {words}"
        self.do(f"call void @march({given}, double {pixel}, double {growth})")
        self.do(f"call void @settle({given}, ptr %planes, i64 %cuts, double {pixel}, double {growth})")


def _started(name: str, parameters: dict[str, str]) -> Picture:
    r = Picture(name, parameters)
    r.do(f"%state = alloca [{ROWS * LANES} x double], align 64")
    return r


TILES = dict.fromkeys(("starts", "limits", "marks"), "ptr")
COMMON = {"first": "i64", "last": "i64", "camera": "ptr", "planes": "ptr", "cuts": "i64", "constants": "ptr"}
ROOM = {"room": "ptr"}
CELLS = {**ROOM, "starts": "ptr"}


def beams(s: RayFormulas) -> Routine:
    """For the tiles in `which`, eight at a time, between their ends: where a beam may meet something, what matters.

    For a large form cells tell what matters, as long as the beam is so thin that it stays in what is known of one.
    """
    of_all = CELLS if s.celled else {"nothing": "ptr", **TILES}
    r = _started("beams", {**COMMON, "columns": "i64", "which": "ptr", "begins": "ptr", "ends": "ptr", **of_all})
    if s.celled:
        _cells(s, r)
    radius, spread = r.part("radius"), r.part("spread")

    def reach(t: Value, step: Value) -> Value:
        return radius + spread * (abs(t) + step)

    with r.loop("%first", "%last", LANES) as i:
        numbers = [r.load("%which", r.emit(f"add i64 {i}, {lane}"), "i64") for lane in range(LANES)]
        places = []
        for operation in ("urem", "udiv"):
            vector = "poison"
            for lane, number in enumerate(numbers):
                one = r.emit(f"sitofp i64 {r.emit(f'{operation} i64 {number}, %columns')} to double")
                vector = r.emit(f"insertelement {DOUBLES} {vector}, double {one}, i32 {lane}")
            places.append(r.value(vector) * float(s.tile) + s.tile / 2)
        r.rays(*places)
        begins = r.value(r.load("%begins", i))
        put(r, Row.T, most(get(r, Row.T), begins))
        put(r, Row.STOP, least(get(r, Row.STOP), r.value(r.load("%ends", i))))
        r.do(f"call void @clip(ptr %state, ptr %planes, i64 %cuts, double {r.scalar('reach')})")
        rest = get(r, Row.STOP) - get(r, Row.T)
        size = (r.part("pixel") + r.part("growth") * abs(get(r, Row.T))) * (s.tile * FIRST_STEP)
        narrower = begins > float("-inf")  # than a beam that ended there: what may be met is near
        put(r, Row.STEP, narrower.choose(most(size, rest * LEAST_STEP), rest * 0.5))
        with r.loop("0", f"{MOST_BEAM_STEPS}", 1, lambda: get(r, Row.STATUS).compare("oeq", MARCHING)):
            t, stop, status = get(r, Row.T), get(r, Row.STOP), get(r, Row.STATUS)
            cell, end = cell_of(r, t, "%cells") if s.celled else (t, stop)
            step = least(get(r, Row.STEP), (least(end, stop) if s.celled else stop) - t)
            half = step * 0.5
            known = InCells(cell, status.compare("oeq", MARCHING), "%cells", "%room") if s.celled else "%nothing"
            _, high, linear, quadratic = model_on(s, r, t, step, known, reach(t, step))
            upper = first_root(r, high + (quadratic - linear), linear, quadratic)
            out = upper > 2.0
            begin = t + upper * half
            live = status.compare("oeq", MARCHING)
            if s.celled:
                thin = reach(t, step) < r.element("%cells", MARGIN) * THIN
                out, begin, step = out & thin, thin.choose(begin, t), thin.choose(step, 0.0)
            size = (r.part("pixel") + r.part("growth") * abs(t)) * (s.tile * NEAR)
            put(r, Row.T, live.choose(out.choose(t + step, begin), t))
            put(r, Row.STEP, out.choose(step * 2.0, least(t + step - begin, half)))
            ended = live & (out ^ 1) & (step < size)
            put(r, Row.STATUS, ended.choose(1.0, status))
            gone = live & get(r, Row.T).compare("oge", stop)
            put(r, Row.STATUS, gone.choose(GONE, get(r, Row.STATUS)))
        t, stop = get(r, Row.T), get(r, Row.STOP)
        gone = get(r, Row.STATUS).compare("oeq", GONE)
        r.store(gone.choose(float("inf"), t).name, "%starts", i)
        if not s.celled:
            _stretches(s, r, i, (t, gone.choose(0.0, stop - t), stop), reach)
    r.do("ret void")
    return r


Reach: TypeAlias = Callable[[Value, Value], Value]


def _stretches(s: RayFormulas, r: Picture, i: str, ends: tuple[Value, Value, Value], reach: Reach) -> None:
    """What matters to eight beams in the first stretch, and in the rest, from where they begin up to their ends."""
    t, rest, stop = ends
    size = (r.part("pixel") + r.part("growth") * abs(t)) * (s.tile * NEAR_DEPTH)
    limit = t + size
    r.store(limit.name, "%limits", i)
    for stretch, length in enumerate((most(least(limit, stop) - t, r.number(0.0)) * 1.001, rest)):
        given = ", ".join(f"{DOUBLES} {part}" for part in segment(r, t, length, reach(t, length)))
        first = r.emit(f"mul i64 {i}, {STRETCHES * s.words}")
        target = r.place("%marks", "i64", r.emit(f"add i64 {first}, {stretch * s.words}"))
        r.do(f"call void @survey({given}, ptr %constants, ptr {target}, i64 {STRETCHES * s.words})")


def picture(s: RayFormulas) -> Routine:
    """From tile `first` to below `last` what each pixel shows; `stride` is the length of a row of pixels."""
    outputs = {"depth": "ptr", "leaf": "ptr", "normal": "ptr", "doubt": "ptr", "stride": "i64", "plane": "i64"}
    r = _started("picture", {**COMMON, "columns": "i64", **(CELLS if s.celled else TILES), **outputs})
    if s.celled:
        _cells(s, r)
    pixel, growth = r.scalar("pixel"), r.scalar("growth")
    wide, high = BLOCK
    across, down = (
        r.value(f"<{', '.join(f'double {number:.1f}' for number in numbers)}>")
        for numbers in ([lane % wide + 0.5 for lane in range(LANES)], [lane // wide + 0.5 for lane in range(LANES)])
    )
    with r.loop("%first", "%last", 1) as tile:
        column, row = (r.emit(f"{operation} i64 {tile}, %columns") for operation in ("urem", "udiv"))
        x0, y0 = (r.emit(f"mul i64 {number}, {s.tile}") for number in (column, row))
        start = r.element("%starts", tile)
        limits, words = "%cells", "%room"
        if not s.celled:
            words = r.place("%marks", "i64", r.emit(f"mul i64 {tile}, {STRETCHES * s.words}"))
            limits = r.place("%limits", "double", tile)
        with r.loop("0", f"{s.tile}", high) as j, r.loop("0", f"{s.tile}", wide) as i:
            x, y = r.emit(f"add i64 {x0}, {i}"), r.emit(f"add i64 {y0}, {j}")
            left, top = (r.value(r.splat(r.emit(f"sitofp i64 {number} to double"))) for number in (x, y))
            put(r, Row.STATUS, r.number(GONE))
            put(r, Row.DOUBT, r.number(0.0))
            with r.where(start < float("inf")):
                r.rays(left + across, top + down)
                r.do("call void @clip(ptr %state, ptr %planes, i64 %cuts, double 0.0)")
                t = get(r, Row.T)
                put(r, Row.T, (start > t).choose(start, t))
                size = r.part("pixel") + r.part("growth") * abs(get(r, Row.T))
                put(r, Row.STEP, size * (s.tile * FIRST_STEP))
                r.march(limits, words, pixel, growth)
            for half in range(high):
                below = r.emit(f"mul i64 {r.emit(f'add i64 {y}, {half}')}, %stride")
                place = r.emit(f"add i64 {below}, {x}")
                _write(r, place, "%plane", range(half * wide, half * wide + wide))
    r.do("ret void")
    return r


def _cells(s: RayFormulas, r: Picture) -> None:
    r.do(f"%cells = getelementptr double, ptr %constants, i64 {s.cells}")


def rays(s: RayFormulas) -> Routine:
    """Rays from `first` to below `last`: rows of origins and directions in, what they meet out."""
    outputs = {"depth": "ptr", "leaf": "ptr", "normal": "ptr", "doubt": "ptr", "stride": "i64"}
    of_all = ROOM if s.celled else {"limits": "ptr", "nothing": "ptr"}
    r = _started("rays", {**COMMON, "given": "ptr", **of_all, **outputs})
    limits, words = ("%cells", "%room") if s.celled else ("%limits", "%nothing")
    if s.celled:
        _cells(s, r)
    with r.loop("%first", "%last", LANES) as i:
        for row in range(6):
            put(r, Row.ORIGIN + row, r.value(r.load(r.row("%given", "%stride", row), i)))
        put(r, Row.T, r.part("near"))
        put(r, Row.STOP, r.part("far"))
        r.do("call void @clip(ptr %state, ptr %planes, i64 %cuts, double 0.0)")
        put(r, Row.STEP, (get(r, Row.STOP) - get(r, Row.T)) * 0.25)
        r.march(limits, words, r.scalar("pixel"), r.scalar("growth"))
        _write(r, i, "%stride", range(LANES))
    r.do("ret void")
    return r


def probe(s: RayFormulas) -> Routine:
    """The model of the form on eight segments, nine rows, and its value and leaf in their middles; for checks."""
    parameters = dict.fromkeys(("given", "constants", "words", "found"), "ptr")
    r = Routine("probe", {**parameters, **(ROOM if s.celled else {})})
    words = "%words"
    if s.tabled:
        r.do("call void @region(ptr %words, ptr %constants, ptr %room)")
        words = f"{r.place('%room', 'i64', s.room.region)}, ptr %room"
    ends = [r.value(r.load("%given", row * LANES)) for row in range(9)]
    given = ", ".join(f"{DOUBLES} {end.name}" for end in ends)
    value = r.emit(f"call {STRUCT} @model({given}, ptr %constants, ptr {words})")
    for k in range(4):
        r.store(r.emit(f"extractvalue {STRUCT} {value}, {k}"), "%found", k * LANES)
    places = ", ".join(f"{DOUBLES} {((ends[3 * k] + ends[3 * k + 1]) * 0.5).name}" for k in range(3))
    both = r.emit(f"call {NAMED} @point({places}, ptr %constants, ptr {words})")
    r.store(r.emit(f"extractvalue {NAMED} {both}, 0"), "%found", 4 * LANES)
    leaf = r.emit(f"sitofp {SHORTS} {r.emit(f'extractvalue {NAMED} {both}, 1')} to {DOUBLES}")
    r.store(leaf, "%found", 5 * LANES)
    r.do("ret void")
    return r


def _write(r: Routine, place: str, stride: str, lanes: range) -> None:
    """Store what some lanes have met."""
    met = get(r, Row.STATUS) > MARCHING
    count = len(lanes)
    chosen = f"<{count} x i32> <{', '.join(f'i32 {lane}' for lane in lanes)}>"

    def some(value: str, element: str) -> str:
        whole = f"<{LANES} x {element}>"
        return r.emit(f"shufflevector {whole} {value}, {whole} poison, {chosen}") if count < LANES else value

    def store(value: str, element: str, pointer: str) -> None:
        r.store(some(value, element), pointer, place, f"<{count} x {element}>")

    store(met.choose(get(r, Row.T), float("inf")).name, "double", "%depth")
    leaf = r.emit(f"fptosi {DOUBLES} {met.choose(get(r, Row.LEAF), -1.0).name} to {SHORTS}")
    store(leaf, "i16", "%leaf")
    for axis in range(3):
        normal = met.choose(get(r, Row.NORMAL + axis), float("nan"))
        store(normal.name, "double", r.row("%normal", stride, axis))
    doubt = r.emit(f"fptosi {DOUBLES} {get(r, Row.DOUBT).name} to <{LANES} x i8>")
    store(doubt, "i8", "%doubt")


def caster_code(s: RayFormulas) -> str:
    """The module."""
    nodes: list[Node] = [*s.points.program.nodes]
    for function in s.rays.library.values():
        nodes += function.program.nodes
    head = [
        *declarations(VECTORS["float64"], nodes),
        f"declare i{LANES} @llvm.cttz.i{LANES}(i{LANES}, i1)",
        f"declare double @llvm.vector.reduce.fmax.v{LANES}f64({DOUBLES})",
        *(["declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)"] if s.tabled else []),
    ]
    walks = (model, survey, point) if not s.tabled else (table_code.model, table_code.survey, table_code.point)
    parts = [part(s) for part in (*walks, clip, march, settle, beams, picture, rays, probe)]
    if s.tabled:
        parts += [*leaf_routines(s), region(s)]
    if s.celled:
        parts += cell_routines(s)
    return "\n".join([*head, *library(s), *(part.text for part in parts)])
