"""Routines on the lattice: boxes, blocks of points, and edges.

A coordinate is origin + spacing*index, rounded twice, whoever computes it; both steps are monotone, so that what is
proved on the corners of a box as they are rounded holds for every point of the lattice in it.
"""

from __future__ import annotations

from collections.abc import Sequence

from rsym.backends.vector_code import Value
from rsym.sampling.kernels.form_code import NAMED, better
from rsym.sampling.kernels.root_search import emit_root_search
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine
from rsym.sampling.kernels.surface_formulas import ENDS, WORD, SurfaceFormulas


def boxes(s: SurfaceFormulas) -> Routine:
    """Boxes on the lattice: which may hold a zero (a bit each), and which operands of gates do not matter there."""
    r = Routine(
        "boxes",
        {"count": "i64", "corner": "ptr", "stride": "i64", "size": "double", "lattice": "ptr"}
        | {"constants": "ptr", "keep": "ptr", "skip": "ptr"},
    )
    size = r.value(r.splat("%size"))
    with r.loop("0", "%count", LANES) as i:
        known: dict[str, str] = {}
        for k, name in enumerate(s.coordinates):
            index = r.value(r.load(r.row("%corner", "%stride", k), i))
            origin, spacing = r.element("%lattice", k), r.element("%lattice", 3 + k)
            known[f"{name}_lower"] = (origin + spacing * index).name
            known[f"{name}_upper"] = (origin + spacing * (index + size)).name
        memo = s.bounds.inputs(known)
        ends = [s.bounds.outputs(r, (f"leaf{k}_{end}" for end in ENDS), memo) for k in range(s.count)]
        words = ["zeroinitializer"] * s.words
        for number, (operation, first, second) in enumerate(s.gates):
            for position, operand in enumerate((first, second)):
                lower, upper = ends[operand]
                idle = lower > 0.0 if operation == "min" else upper < 0.0
                word, bit = divmod(2 * number + position, WORD)
                words[word] = _with_bit(r, words[word], idle.name, bit)
            ends.append([_extreme(operation, a, b) for a, b in zip(ends[first], ends[second], strict=True)])
        lower, upper = ends[-1]
        keep = r.emit(f"and <{LANES} x i1> {lower.compare('ole', 0.0).name}, {upper.compare('oge', 0.0).name}")
        r.store(r.mask(keep), "%keep", r.emit(f"lshr i64 {i}, 3"), "i8")
        for word, flags in enumerate(words):
            r.store(flags, r.row("%skip", "%stride", word), i, f"<{LANES} x i64>")
    r.do("ret void")
    return r


def signs(s: SurfaceFormulas) -> Routine:
    """Blocks from first to below last: a bit for each of their points, and whether one of them is undefined."""
    r = Routine(
        "signs",
        {"first": "i64", "last": "i64", "corner": "ptr", "stride": "i64", "words": "ptr", "lattice": "ptr"}
        | {
            "offsets": "ptr",
            "points": "i64",
            "constants": "ptr",
            "bits": "ptr",
            "bytes": "i64",
            "undefined": "ptr",
        },
    )
    with r.loop("%first", "%last", 1) as block:
        corner = [r.element(r.row("%corner", "%stride", k), block) for k in range(3)]
        words = r.place("%words", "i64", r.emit(f"mul i64 {block}, {s.words}"))
        target = r.place("%bits", "i8", r.emit(f"mul i64 {block}, %bytes"))
        with r.loop("0", "%points", LANES) as i:
            offset = [r.value(r.load(r.row("%offsets", "%points", k), i)) for k in range(3)]
            places = _lattice_points(r, [a + b for a, b in zip(corner, offset, strict=True)])
            value = _call_form(r, places, words)
            r.store(r.mask(value.compare("oge", 0.0).name), target, r.emit(f"lshr i64 {i}, 3"), "i8")
            bad = r.mask(value.compare("uno", 0.0).name)
            before = r.load("%undefined", block, "i8")
            r.store(r.emit(f"or i8 {bad}, {before}"), "%undefined", block, "i8")
    r.do("ret void")
    return r


def crossings(s: SurfaceFormulas) -> Routine:
    """Where lattice edges along one axis, listed block by block, cross the surface, and on which leaf."""
    r = Routine(
        "crossings",
        {"first": "i64", "last": "i64", "starts": "ptr", "words": "ptr", "edges": "ptr", "edge_stride": "i64"}
        | {"axis": "ptr", "lattice": "ptr", "constants": "ptr", "points": "ptr", "stride": "i64", "leaf": "ptr"},
    )
    real = r.emit(f"alloca {DOUBLES}, align 64")
    short = r.emit(f"alloca {SHORTS}, align 16")
    steps = [r.element("%axis", k) for k in range(3)]
    with r.loop("%first", "%last", 1) as block:
        words = r.place("%words", "i64", r.emit(f"mul i64 {block}, {s.words}"))
        begin = r.load("%starts", block, "i64")
        end = r.load("%starts", r.emit(f"add i64 {block}, 1"), "i64")
        with r.loop(begin, end, LANES) as i:
            floats = [r.load(r.row("%edges", "%edge_stride", k, "float"), i, f"<{LANES} x float>") for k in range(3)]
            low = [r.value(r.emit(f"fpext <{LANES} x float> {f} to {DOUBLES}")) for f in floats]

            def at(t: Value, low: Sequence[Value] = low) -> list[Value]:
                return _lattice_points(r, [a + t * step for a, step in zip(low, steps, strict=True)])

            root = emit_root_search(r, lambda t: _call_form(r, at(t), words))
            places = at(root)
            both = r.emit(f"call {NAMED} @named({_arguments(places, words)})")
            leaf = r.emit(f"extractvalue {NAMED} {both}, 1")
            left = r.emit(f"sub i64 {end}, {i}")
            few = r.emit(f"icmp slt i64 {left}, {LANES}")
            count = r.emit(f"select i1 {few}, i64 {left}, i64 {LANES}")
            for k, place in enumerate(places):
                r.store_some(place.name, DOUBLES, real, r.place(r.row("%points", "%stride", k), "double", i), count)
            r.store_some(leaf, SHORTS, short, r.place("%leaf", "i16", i), count)
    r.do("ret void")
    return r


def _extreme(operation: str, a: Value, b: Value) -> Value:
    return better(operation, a, b).choose(a, b)


def _with_bit(r: Routine, word: str, truths: str, bit: int) -> str:
    words = f"<{LANES} x i64>"
    number = (1 << bit) - (1 << WORD if bit == WORD - 1 else 0)
    yes = f"<{', '.join([f'i64 {number}'] * LANES)}>"
    return r.emit(f"or {words} {word}, {r.select(truths, yes, 'zeroinitializer', words)}")


def _lattice_points(r: Routine, indices: Sequence[Value]) -> list[Value]:
    return [r.element("%lattice", k) + r.element("%lattice", 3 + k) * index for k, index in enumerate(indices)]


def _arguments(places: Sequence[Value], words: str) -> str:
    return ", ".join([*(f"{DOUBLES} {place.name}" for place in places), "ptr %constants", f"ptr {words}"])


def _call_form(r: Routine, places: Sequence[Value], words: str) -> Value:
    return r.value(r.emit(f"call {DOUBLES} @form({_arguments(places, words)})"))
