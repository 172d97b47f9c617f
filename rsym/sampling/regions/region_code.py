"""The mesher's routines as loops that run tapes, as LLVM text that knows no model: compiled once on a machine.

They ask what those of `mesher_code` ask, by the same steps. `run` works on the points of a block in one go, `run_one`
on eight.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rsym.backends.llvm_code import VECTORS
from rsym.backends.tape_code import ROW_VECTORS, head, run_routines
from rsym.backends.vector_code import Value
from rsym.program.tape import WIDTH
from rsym.sampling.kernels.form_code import better
from rsym.sampling.kernels.mesher_code import emit_root_search
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine
from rsym.sampling.regions.region_tapes import STEP, VECTOR
from rsym.sampling.regions.regions import MAX, MIN

AT_ONCE = ROW_VECTORS * LANES  # points
# Of the tapes: rows, uniform numbers, and arrays of where the own of each begin, how many numbers, where they go.
TAPES = dict.fromkeys(("rows", "uniform", "row", "number", "count", "above", "result", "memory"), "ptr")


class TapeRoutine(Routine):
    """A routine that runs the tapes of regions, or of leaves."""

    def take(self, tape: str) -> tuple[str, str]:
        """The rows of a tape, its numbers brought in place, and where its result lies."""
        rows = self.place("%rows", "i32", self.emit(f"mul i64 {self.load('%row', tape, 'i64')}, {WIDTH}"))
        given = self.place("%uniform", "double", self.load("%number", tape, "i64"))
        above = self.place("%memory", "i8", self.load("%above", tape, "i64"))
        with self.loop("0", self.load("%count", tape, "i64"), 1) as k:
            number = self.splat(self.load(given, k, "double"))
            self.store(number, self.place(above, "i8", self.emit(f"mul i64 {k}, {VECTOR}")), 0)
        return rows, self.place("%memory", "i8", self.load("%result", tape, "i64"))

    def put(self, values: Sequence[str], step: int) -> None:
        """Vectors into the first registers."""
        for k, value in enumerate(values):
            self.store(value, self.place("%memory", "i8", k * step), 0)

    def run_one(self, rows: str) -> None:
        """Work out a tape on the first vector of each register."""
        self.do(f"call void @run_one(ptr {rows}, ptr %memory)")

    def run_some(self, rows: str, points: str) -> None:
        """Work out a tape on the first vector where that has all points, else on all."""
        number = len(self.lines)
        one = self.emit(f"icmp sle i64 {points}, {LANES}")
        self.do(f"br i1 {one}, label %one{number}, label %all{number}")
        self.start(f"one{number}")
        self.run_one(rows)
        self.do(f"br label %ran{number}")
        self.start(f"all{number}")
        self.do(f"call void @run(ptr {rows}, ptr %memory)")
        self.do(f"br label %ran{number}")
        self.start(f"ran{number}")

    def lattice_points(self, indices: Sequence[Value]) -> list[Value]:
        """The coordinates of places on the lattice."""
        return [
            self.element("%lattice", k) + self.element("%lattice", 3 + k) * index for k, index in enumerate(indices)
        ]


def region_code() -> str:
    """The module."""
    kind = VECTORS["float64"]
    routines = (boxes(), signs(), fill(), crossings(), values(), leaves(), slide())
    return "\n".join([*head(kind), *run_routines(kind), *(routine.text for routine in routines)])


def boxes() -> Routine:
    """Bounds of the entries of regions from first to below last over eight boxes each, region by region."""
    r = TapeRoutine(
        "boxes",
        {"first": "i64", "last": "i64", "ends": "ptr", "ins": "i64", "stride": "i64"}
        | TAPES
        | {"places": "ptr", "entries": "ptr", "bounds": "ptr"},
    )
    with r.loop("%first", "%last", 1) as tape:
        rows, _ = r.take(tape)
        at = r.emit(f"mul i64 {tape}, {LANES}")
        with r.loop("0", "%ins", 1) as k:
            end = r.load(r.place("%ends", "double", r.emit(f"mul i64 {k}, %stride")), at)
            r.store(end, r.place("%memory", "i8", r.emit(f"mul i64 {k}, {VECTOR}")), 0)
        r.run_one(rows)
        keep_bounds(r, tape)
    r.do("ret void")
    return r


def keep_bounds(r: Routine, tape: str) -> None:
    """Copy the bounds of all entries of a region."""
    target = r.place("%bounds", "double", r.emit(f"mul i64 {r.load('%places', tape, 'i64')}, {2 * LANES}"))
    size = r.emit(f"mul i64 {r.load('%entries', tape, 'i64')}, {2 * VECTOR}")
    source = r.place("%memory", "i8", r.emit(f"mul i64 %ins, {VECTOR}"))
    r.do(f"call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {size}, i1 false)")


def signs() -> Routine:
    """Blocks from first to below last: a bit for each of their points, and whether one of them is undefined."""
    r = TapeRoutine(
        "signs",
        {"first": "i64", "last": "i64", "corner": "ptr", "stride": "i64", "lattice": "ptr"}
        | {"offsets": "ptr", "points": "i64", "bits": "ptr", "bytes": "i64", "undefined": "ptr"}
        | TAPES,
    )
    with r.loop("%first", "%last", 1) as block:
        rows, result = r.take(block)
        target = r.place("%bits", "i8", r.emit(f"mul i64 {block}, %bytes"))
        with lattice_parts(r, block, rows) as (i, some):
            with r.loop("0", some, LANES) as v:
                value = r.value(r.load(result, v))
                at = r.emit(f"lshr i64 {r.emit(f'add i64 {i}, {v}')}, 3")
                r.store(r.mask(value.compare("oge", 0.0).name), target, at, "i8")
                bad = r.mask(value.compare("uno", 0.0).name)
                r.store(r.emit(f"or i8 {bad}, {r.load('%undefined', block, 'i8')}"), "%undefined", block, "i8")
    r.do("ret void")
    return r


@contextmanager
def lattice_parts(r: TapeRoutine, block: str, rows: str) -> Iterator[tuple[str, str]]:
    """The body for parts of the points of a block: the first of each and how many, on which the tape has been run."""
    corner = [r.element(r.row("%corner", "%stride", k), block) for k in range(3)]
    with r.loop("0", "%points", AT_ONCE) as i:
        some = r.up_to(i, "%points", AT_ONCE)
        with r.loop("0", some, LANES) as v:
            at = r.emit(f"add i64 {i}, {v}")
            offset = [r.value(r.load(r.row("%offsets", "%points", k), at)) for k in range(3)]
            for k, place in enumerate(r.lattice_points([a + b for a, b in zip(corner, offset, strict=True)])):
                r.store(place.name, r.place("%memory", "i8", k * STEP), v)
        r.do(f"call void @run(ptr {rows}, ptr %memory)")
        yield i, some


def fill() -> Routine:
    """The form at the points of blocks, NaN where it is infinite: rows of `LANES` of an array from ``starts[k]`` on."""
    r = TapeRoutine(
        "fill",
        {"first": "i64", "last": "i64", "corner": "ptr", "stride": "i64", "lattice": "ptr"}
        | {"offsets": "ptr", "points": "i64", "starts": "ptr", "width": "i64", "value": "ptr"}
        | TAPES,
    )
    with r.loop("%first", "%last", 1) as block:
        rows, result = r.take(block)
        target = r.place("%value", "double", r.load("%starts", block, "i64"))
        with lattice_parts(r, block, rows) as (i, some):
            with r.loop("0", some, LANES) as v:
                value = r.value(r.load(result, v))
                finite = (value - value).compare("oeq", 0.0)
                row = r.emit(f"lshr i64 {r.emit(f'add i64 {i}, {v}')}, {LANES.bit_length() - 1}")
                known = r.select(finite.name, value.name, r.number(math.nan).name, DOUBLES)
                r.store(known, target, r.emit(f"mul i64 {row}, %width"))
    r.do("ret void")
    return r


def crossings() -> Routine:
    """Where lattice edges along one axis, listed block by block, cross the surface, and on which leaf."""
    r = TapeRoutine(
        "crossings",
        {"first": "i64", "last": "i64", "starts": "ptr", "edges": "ptr", "edge_stride": "i64"}
        | {"axis": "ptr", "lattice": "ptr", "points": "ptr", "stride": "i64", "leaf": "ptr"}
        | TAPES
        | {"places": "ptr", "entries": "ptr", "listed": "ptr", "names": "ptr"},
    )
    real, short = r.emit(f"alloca {DOUBLES}, align 64"), r.emit(f"alloca {SHORTS}, align 16")
    steps = [r.element("%axis", k) for k in range(3)]
    with r.loop("%first", "%last", 1) as block:
        begin = r.load("%starts", block, "i64")
        end = r.load("%starts", r.emit(f"add i64 {block}, 1"), "i64")
        with some_of(r, begin, end):
            rows, result = r.take(block)
            with r.loop(begin, end, LANES) as i:
                rows_of = [r.row("%edges", "%edge_stride", k, "float") for k in range(3)]
                floats = [r.load(row, i, f"<{LANES} x float>") for row in rows_of]
                low = [r.value(r.emit(f"fpext <{LANES} x float> {f} to {DOUBLES}")) for f in floats]

                def at(t: Value, low: Sequence[Value] = low) -> list[Value]:
                    return r.lattice_points([a + t * step for a, step in zip(low, steps, strict=True)])

                def form(t: Value, rows: str = rows, result: str = result) -> Value:
                    r.put([place.name for place in at(t)], STEP)
                    r.run_one(rows)
                    return r.value(r.load(result, 0))

                root = emit_root_search(r, form)
                places = at(root)
                r.put([place.name for place in places], STEP)
                r.run_one(rows)
                leaf = active_leaf(r, block, "0")
                count = r.up_to(i, end, LANES)
                for k, place in enumerate(places):
                    r.store_some(place.name, DOUBLES, real, r.place(r.row("%points", "%stride", k), "double", i), count)
                r.store_some(leaf, SHORTS, short, r.place("%leaf", "i16", i), count)
    r.do("ret void")
    return r


@contextmanager
def some_of(r: Routine, begin: str, end: str) -> Iterator[None]:
    """The body where there is something between."""
    number = len(r.lines)
    some = r.emit(f"icmp slt i64 {begin}, {end}")
    r.do(f"br i1 {some}, label %some{number}, label %none{number}")
    r.start(f"some{number}")
    yield
    r.label(f"none{number}")


def active_leaf(r: Routine, region: str, vector: str) -> str:
    """The number of the active leaf at a vector of points, by the values of the entries, which have been run."""
    entries = r.place("%listed", "i32", r.emit(f"mul i64 {r.load('%places', region, 'i64')}, 3"))
    count = r.load("%entries", region, "i64")
    with r.loop("0", count, 1) as i:
        number = len(r.lines)
        entry = r.place(entries, "i32", r.emit(f"mul i64 {i}, 3"))
        parts = [r.emit(f"load i32, ptr {r.place(entry, 'i32', k)}, align 4") for k in range(3)]
        what, *operands = (r.emit(f"sext i32 {part} to i64") for part in parts)
        own = r.place("%names", "i16", r.emit(f"mul i64 {i}, {LANES}"))
        joins = r.emit(f"icmp sge i64 {what}, {MAX}")
        joins = r.emit(f"and i1 {joins}, {r.emit(f'icmp slt i64 {what}, 0')}")
        r.do(f"br i1 {joins}, label %gate{number}, label %leaf{number}")
        r.start(f"leaf{number}")
        none = r.emit(f"icmp slt i64 {what}, 0")
        one = r.emit(f"select i1 {none}, i64 0, i64 {what}")
        r.store(r.splat(r.emit(f"trunc i64 {one} to i16"), "i16"), own, 0, SHORTS)
        r.do(f"br label %on{number}")
        r.start(f"gate{number}")
        values = [entry_value(r, operand, vector) for operand in operands]
        known = [r.place("%names", "i16", r.emit(f"mul i64 {operand}, {LANES}")) for operand in operands]
        names = [r.load(place, 0, SHORTS) for place in known]
        least, most = (better(operation, values[0], values[1]).name for operation in ("min", "max"))
        smaller = r.emit(f"icmp eq i64 {what}, {MIN}")
        take = r.emit(f"select i1 {smaller}, <{LANES} x i1> {least}, <{LANES} x i1> {most}")
        r.store(r.select(take, names[0], names[1], SHORTS), own, 0, SHORTS)
        r.do(f"br label %on{number}")
        r.start(f"on{number}")
    last = r.emit(f"sub i64 {count}, 1")
    return r.load(r.place("%names", "i16", r.emit(f"mul i64 {last}, {LANES}")), 0, SHORTS)


def entry_value(r: Routine, entry: str, vector: str) -> Value:
    """The value of an entry at a vector of points."""
    register = r.emit(f"add i64 {r.emit(f'mul i64 {entry}, {STEP}')}, {3 * STEP}")
    return r.value(r.load(r.place("%memory", "i8", register), r.emit(f"mul i64 {vector}, {LANES}")))


def values() -> Routine:
    """The form at points and its active leaf, for each region at points of its own, whole vectors."""
    r = TapeRoutine(
        "values",
        {"first": "i64", "last": "i64", "begin": "ptr", "points": "ptr", "stride": "i64"}
        | {"value": "ptr", "leaf": "ptr"}
        | TAPES
        | {"places": "ptr", "entries": "ptr", "listed": "ptr", "names": "ptr"},
    )
    with r.loop("%first", "%last", 1) as region:
        rows, result = r.take(region)
        begin = r.load("%begin", region, "i64")
        end = r.load("%begin", r.emit(f"add i64 {region}, 1"), "i64")
        with r.loop(begin, end, AT_ONCE) as i:
            some = r.up_to(i, end, AT_ONCE)
            size = r.emit(f"shl i64 {some}, 3")
            for k in range(3):
                source = r.place(r.row("%points", "%stride", k), "double", i)
                target = r.place("%memory", "i8", k * STEP)
                r.do(f"call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {size}, i1 false)")
            r.run_some(rows, some)
            with r.loop("0", some, LANES) as v:
                at = r.emit(f"add i64 {i}, {v}")
                vector = r.emit(f"lshr i64 {v}, {LANES.bit_length() - 1}")
                r.store(active_leaf(r, region, vector), "%leaf", at, SHORTS)
                r.store(r.load(result, v), "%value", at)
    r.do("ret void")
    return r


def leaves() -> Routine:
    """Outputs of leaves, each at points of its own from ``begin[k]`` to below ``begin[k + 1]``, whole vectors."""
    r = TapeRoutine(
        "leaves",
        {"first": "i64", "last": "i64", "begin": "ptr", "inputs": "ptr", "ins": "i64", "outs": "i64"}
        | {"stride": "i64", "outputs": "ptr", "ends": "ptr"}
        | TAPES,
    )
    with r.loop("%first", "%last", 1) as leaf:
        rows, _ = r.take(leaf)
        begin = r.load("%begin", leaf, "i64")
        end = r.load("%begin", r.emit(f"add i64 {leaf}, 1"), "i64")
        registers = r.place("%ends", "i64", r.emit(f"mul i64 {leaf}, %outs"))
        with r.loop(begin, end, AT_ONCE) as i:
            some = r.emit(f"shl i64 {r.up_to(i, end, AT_ONCE)}, 3")

            def copy(target: str, source: str, some: str = some) -> None:
                r.do(f"call void @llvm.memcpy.p0.p0.i64(ptr {target}, ptr {source}, i64 {some}, i1 false)")

            def at(array: str, k: str, i: str = i) -> str:
                return r.place(r.place(array, "double", r.emit(f"mul i64 %stride, {k}")), "double", i)

            with r.loop("0", "%ins", 1) as k:
                copy(r.place("%memory", "i8", r.emit(f"mul i64 {k}, {STEP}")), at("%inputs", k))
            r.do(f"call void @run(ptr {rows}, ptr %memory)")
            with r.loop("0", "%outs", 1) as k:
                copy(at("%outputs", k), r.place("%memory", "i8", r.load(registers, k, "i64")))
    r.do("ret void")
    return r


def slide() -> Routine:
    """Newton steps along the gradient onto leaves, each with points of its own, whole vectors."""
    r = TapeRoutine(
        "slide",
        {"first": "i64", "last": "i64", "begin": "ptr", "points": "ptr", "stride": "i64", "steps": "i64", "ends": "ptr"}
        | TAPES,
    )
    with r.loop("%first", "%last", 1) as leaf:
        rows, _ = r.take(leaf)
        begin = r.load("%begin", leaf, "i64")
        end = r.load("%begin", r.emit(f"add i64 {leaf}, 1"), "i64")
        registers = r.place("%ends", "i64", r.emit(f"mul i64 {leaf}, 4"))
        with r.loop(begin, end, LANES) as i:
            lines = [r.row("%points", "%stride", axis) for axis in range(3)]
            with r.loop("0", "%steps", 1):
                places = [r.load(line, i) for line in lines]
                r.put(places, STEP)
                r.run_one(rows)
                f, *g = (r.value(r.load(r.place("%memory", "i8", r.load(registers, k, "i64")), 0)) for k in range(4))
                share = f / (g[0] * g[0] + g[1] * g[1] + g[2] * g[2] + 1e-300)
                for line, place, slope in zip(lines, places, g, strict=True):
                    r.store((r.value(place) - share * slope).name, line, i)
    r.do("ret void")
    return r
