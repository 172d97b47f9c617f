"""Routines of single leaves: each point, or box, has a leaf of its own."""

from __future__ import annotations

from collections.abc import Callable

from rsym.backends.vector_code import Value
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine
from rsym.sampling.kernels.surface_formulas import ENDS, SurfaceFormulas, leaf_outputs


def leaf(s: SurfaceFormulas) -> Routine:
    """Value and gradient of one leaf for each point; where its number is negative nothing is written."""
    r = Routine(
        "leaf",
        {"count": "i64", "leaf": "ptr", "points": "ptr", "stride": "i64", "constants": "ptr"}
        | {"value": "ptr", "gradient": "ptr", "gradient_stride": "i64"},
    )
    rows = ["%value", *(r.row("%gradient", "%gradient_stride", k) for k in range(3))]

    def case(k: int, i: str, mine: Value) -> None:
        outputs = s.points.outputs(r, leaf_outputs(k), s.at(r, "%points", "%stride", i))
        for row, output in zip(rows, outputs, strict=True):
            r.store(r.select(mine.name, output.name, r.load(row, i), DOUBLES), row, i)

    each_leaf(s, r, case)
    return r


def slide(s: SurfaceFormulas) -> Routine:
    """Newton steps along the gradient onto one leaf for each point; where its number is negative it stays."""
    r = Routine(
        "slide",
        {"count": "i64", "leaf": "ptr", "points": "ptr", "stride": "i64", "constants": "ptr", "steps": "i64"},
    )

    def case(k: int, i: str, mine: Value) -> None:
        rows = [r.row("%points", "%stride", axis) for axis in range(3)]
        with r.loop("0", "%steps", 1):
            places = [r.load(row, i) for row in rows]
            known = s.points.inputs(dict(zip(s.coordinates, places, strict=True)))
            f, *g = s.points.outputs(r, leaf_outputs(k), known)
            share = f / (g[0] * g[0] + g[1] * g[1] + g[2] * g[2] + 1e-300)
            for row, place, slope in zip(rows, places, g, strict=True):
                moved = r.value(place) - share * slope
                r.store(r.select(mine.name, moved.name, place, DOUBLES), row, i)

    each_leaf(s, r, case)
    return r


def enclose(s: SurfaceFormulas) -> Routine:
    """Bounds of value and gradient of one leaf over each box: rows value lower, upper, then each derivative's."""
    r = Routine(
        "enclose",
        {"count": "i64", "leaf": "ptr", "lower": "ptr", "upper": "ptr", "stride": "i64", "constants": "ptr"}
        | {"bounds": "ptr", "bounds_stride": "i64"},
    )

    def case(k: int, i: str, mine: Value) -> None:
        ends = {
            f"{name}_{end}": r.load(r.row(f"%{end}", "%stride", axis), i)
            for axis, name in enumerate(s.coordinates)
            for end in ENDS
        }
        names = [f"{output}_{end}" for output in leaf_outputs(k) for end in ENDS]
        outputs = s.bounds.outputs(r, names, s.bounds.inputs(ends))
        for number, output in enumerate(outputs):
            row = r.row("%bounds", "%bounds_stride", number)
            r.store(r.select(mine.name, output.name, r.load(row, i), DOUBLES), row, i)

    each_leaf(s, r, case)
    return r


def each_leaf(s: SurfaceFormulas, r: Routine, case: Callable[[int, str, Value], None]) -> None:
    """Eight points at a time, one turn for each leaf among their `%leaf`; then the routine returns."""
    with r.loop("0", "%count", LANES) as i:
        which = r.load("%leaf", i, SHORTS)
        valid = r.emit(f"icmp sge {SHORTS} {which}, zeroinitializer")
        everyone = r.mask(valid)
        number = len(r.lines)
        r.label(f"turns{number}")
        r.do(f"%none{number} = icmp eq i{LANES} {everyone}, 0")
        r.do(f"br i1 %none{number}, label %over{number}, label %turn{number}")
        r.start(f"turn{number}")
        todo = f"%todo{number}"
        r.do(f"{todo} = phi i{LANES} [ {everyone}, %turns{number} ], [ %rest{number}, %turned{number} ]")
        lane = r.emit(f"call i{LANES} @llvm.cttz.i{LANES}(i{LANES} {todo}, i1 true)")
        one = r.emit(f"extractelement {SHORTS} {which}, i{LANES} {lane}")
        mine = r.value(r.emit(f"icmp eq {SHORTS} {which}, {r.splat(one, 'i16')}"), "i1")
        targets = " ".join(f"i16 {k}, label %leaf{k}.{number}" for k in range(s.count))
        r.do(f"switch i16 {one}, label %turned{number} [ {targets} ]")
        for k in range(s.count):
            r.start(f"leaf{k}.{number}")
            case(k, i, mine)
            r.do(f"br label %turned{number}")
        r.start(f"turned{number}")
        others = r.emit(f"xor i{LANES} {r.mask(mine.name)}, -1")
        r.do(f"%rest{number} = and i{LANES} {todo}, {others}")
        r.do(f"%last{number} = icmp eq i{LANES} %rest{number}, 0")
        r.do(f"br i1 %last{number}, label %over{number}, label %turn{number}")
        r.start(f"over{number}")
    r.do("ret void")
