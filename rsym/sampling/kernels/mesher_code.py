"""The routines of the mesher as LLVM text, what it asks of a form over boxes, blocks, edges and points, and their code.

An array of points is three rows of a stated length. Every routine works on eight lanes at a time, and no lane depends
on another. A coordinate of the lattice is origin + spacing*index, rounded twice, whoever computes it; both steps are
monotone, so that what is proved on the corners of a box as they are rounded holds for every point of the lattice in it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any

from rsym.backends.caches import digest_of_rooms, keep_entry, read_entry
from rsym.backends.llvm_code import KEPT_FROM, VECTORS, declarations, entry_name, kept_machine_code, machine_code
from rsym.backends.vector_code import Value
from rsym.logic.sign_form import SignForm
from rsym.sampling.kernels.form_code import (
    ENDS,
    NAMED,
    WORD,
    LeafFormulas,
    better,
    form,
    leaf_outputs,
    named,
    value,
    with_bit,
)
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine

State = dict[str, Value]

# On the car 4 steps are the rule. Where the form has a kink at its root, false position crawls: from there on, halves.
PATIENCE = 12
# The halves that follow end at the last bit of t.
MOST_STEPS = 70
NEAR_ENOUGH = 2e-14

KIND = "forms"
# All that has a part in the text of a form.
ROOMS = ("model", "model/blends", "analysis", "program", "backends", "logic", "bounds", "sampling/kernels")


class FormCode:
    """Machine code of the routines of a form: made from formulas, or taken as it is from this machine's folder.

    To make the text takes three times as long as to read the code. What was made by the same source of all rooms that
    have a part in it, and was checked, is found by the key of the form.
    """

    def __init__(self, form: SignForm) -> None:
        self.formulas = LeafFormulas(form)
        rooms = digest_of_rooms(*ROOMS)
        self._name = entry_name(f"{rooms} {form.builder.letters} {form.key}") if rooms else ""
        self._enclose = ""  # the name by which it is kept, if it is

    @cached_property
    def _texts(self) -> tuple[str, ...]:
        return mesher_code(self.formulas)

    @cached_property
    def source(self) -> str:
        """All code as text."""
        return "\n".join(self._texts)

    @cached_property
    def _is_kept(self) -> bool:
        return bool(self._name) and len(self.source) >= KEPT_FROM

    def kept(self) -> tuple[int, list[Any]] | None:
        """How many constants there are, and the engines of all modules but the last."""
        index = read_entry(KIND, self._name) if self._name else None
        if index is None:
            return None
        constants, *names, enclose = index.decode().split()
        engines = [kept_machine_code(name) for name in names]
        if None in engines:
            return None
        self._enclose = enclose
        return int(constants), engines

    def made(self) -> tuple[int, list[Any]]:
        """The same, from the formulas."""
        engines = [machine_code(text, effort, kept=self._is_kept) for text, effort in self._modules()]
        return self.formulas.points.constants + self.formulas.bounds.constants, engines

    def keep(self) -> None:
        """Let others find what was made and is right."""
        if self._is_kept:
            constants = self.formulas.points.constants + self.formulas.bounds.constants
            names = [entry_name(*module) for module in (*self._modules(), (self._texts[-1], 2))]
            keep_entry(KIND, self._name, " ".join([str(constants), *names]).encode())

    def _modules(self) -> list[tuple[str, int]]:
        """The modules but the last, and the effort: what runs once for a choice of letters is not worth optimising."""
        return [(text, 2 if number else 0) for number, text in enumerate(self._texts[:-1])]

    def enclose(self) -> Any:
        """The engine of the last module."""
        engine = kept_machine_code(self._enclose) if self._enclose else None
        return machine_code(self._texts[-1], kept=self._is_kept) if engine is None else engine


def mesher_code(formulas: LeafFormulas) -> tuple[str, ...]:
    """The modules: first the constants, which run once for each choice of letters; last `enclose`."""
    nodes = [*formulas.points.program.nodes, *formulas.bounds.program.nodes]
    head = [
        *declarations(VECTORS["float64"], nodes),
        "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)",
        f"declare i{LANES} @llvm.cttz.i{LANES}(i{LANES}, i1)",
    ]
    constants = [formulas.points.constants_text("point_constants"), formulas.bounds.constants_text("box_constants")]
    bodies = [constants, *([routine(formulas).text for routine in module] for module in MODULES)]
    return tuple("\n".join([*head, *body]) for body in bodies)


def leaf(s: LeafFormulas) -> Routine:
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


def slide(s: LeafFormulas) -> Routine:
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


def enclose(s: LeafFormulas) -> Routine:
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


def each_leaf(s: LeafFormulas, r: Routine, case: Callable[[int, str, Value], None]) -> None:
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


def boxes(s: LeafFormulas) -> Routine:
    """Boxes, six rows of ends: which may hold a zero (a bit each), and which operands of gates do not matter there."""
    r = Routine(
        "boxes",
        {"count": "i64", "ends": "ptr", "stride": "i64", "constants": "ptr", "keep": "ptr", "skip": "ptr"},
    )
    with r.loop("0", "%count", LANES) as i:
        names = [f"{name}_{end}" for name in s.coordinates for end in ENDS]
        known = {name: r.load(r.row("%ends", "%stride", k), i) for k, name in enumerate(names)}
        memo = s.bounds.inputs(known)
        ends = [s.bounds.outputs(r, (f"leaf{k}_{end}" for end in ENDS), memo) for k in range(s.count)]
        words = ["zeroinitializer"] * s.words
        for number, (operation, first, second) in enumerate(s.gates):
            for position, operand in enumerate((first, second)):
                lower, upper = ends[operand]
                idle = lower > 0.0 if operation == "min" else upper < 0.0
                word, bit = divmod(2 * number + position, WORD)
                words[word] = with_bit(r, words[word], idle.name, bit)
            operands = zip(ends[first], ends[second], strict=True)
            ends.append([better(operation, a, b).choose(a, b) for a, b in operands])
        lower, upper = ends[-1]
        keep = r.emit(f"and <{LANES} x i1> {lower.compare('ole', 0.0).name}, {upper.compare('oge', 0.0).name}")
        r.store(r.mask(keep), "%keep", r.emit(f"lshr i64 {i}, 3"), "i8")
        for word, flags in enumerate(words):
            r.store(flags, r.row("%skip", "%stride", word), i, f"<{LANES} x i64>")
    r.do("ret void")
    return r


def signs(s: LeafFormulas) -> Routine:
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


def crossings(s: LeafFormulas) -> Routine:
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
            count = r.up_to(i, end, LANES)
            for k, place in enumerate(places):
                r.store_some(place.name, DOUBLES, real, r.place(r.row("%points", "%stride", k), "double", i), count)
            r.store_some(leaf, SHORTS, short, r.place("%leaf", "i16", i), count)
    r.do("ret void")
    return r


def _lattice_points(r: Routine, indices: Sequence[Value]) -> list[Value]:
    return [r.element("%lattice", k) + r.element("%lattice", 3 + k) * index for k, index in enumerate(indices)]


def _arguments(places: Sequence[Value], words: str) -> str:
    return ", ".join([*(f"{DOUBLES} {place.name}" for place in places), "ptr %constants", f"ptr {words}"])


def _call_form(r: Routine, places: Sequence[Value], words: str) -> Value:
    return r.value(r.emit(f"call {DOUBLES} @form({_arguments(places, words)})"))


def emit_root_search(r: Routine, function: Callable[[Value], Value]) -> Value:
    """T in [0, 1] where the function is zero; its signs at 0 and at 1 differ, 0 counting as positive.

    False position with the weights of Anderson and Bjoerck (1973), then bisection. A lane that has its root keeps it,
    whatever the others still do.
    """
    zero, one = r.number(0.0), r.number(1.0)
    fa, fb = function(zero), function(one)
    initial = {"a": zero, "fa": fa, "b": one, "fb": fb, "t": fa.compare("oeq", 0.0).choose(zero, one)}
    number = len(r.lines)
    before, head, step = f"%before{number}", f"search{number}", f"%step{number}"
    r.label(before[1:])
    r.label(head)
    first = len(r.lines)
    state = {name: r.value(f"%{name}{number}") for name in initial}
    r.lines += [""] * (len(state) + 1)
    new, done = _next(r, function, state, step)
    following = r.emit(f"add i64 {step}, 1")
    all_done = r.emit(f"icmp eq i{LANES} {r.mask(done.name)}, -1")
    stop = r.emit(f"or i1 {all_done}, {r.emit(f'icmp sgt i64 {following}, {MOST_STEPS}')}")
    r.label(f"again{number}")
    # The phi nodes of the loop name values that only exist by now.
    sources = [(DOUBLES, state[name].name, initial[name].name, new[name].name) for name in state]
    for line, (kind, name, old, next_) in enumerate([*sources, ("i64", step, "0", following)], first):
        r.lines[line] = f"  {name} = phi {kind} [ {old}, {before} ], [ {next_}, %again{number} ]"
    r.do(f"br i1 {stop}, label %found{number}, label %{head}")
    r.start(f"found{number}")
    return new["t"]


def _next(r: Routine, function: Callable[[Value], Value], state: State, step: str) -> tuple[State, Value]:
    """The bracket after one more step, and which lanes need none."""
    a, fa, b, fb = (state[name] for name in ("a", "fa", "b", "fb"))
    middle = (a + b) * 0.5
    guess = (a * fb - b * fa) / (fb - fa)
    low, high = (a < b).choose(a, b), (a < b).choose(b, a)
    inside = guess.compare("oge", low) & guess.compare("ole", high)
    patient = r.value(r.splat(r.emit(f"icmp slt i64 {step}, {PATIENCE}"), "i1"), "i1")
    s = (inside & patient).choose(guess, middle)
    fs = function(s)
    found = fa.compare("oeq", 0.0) | fb.compare("oeq", 0.0)
    weight = 1.0 - fs / fb
    weight = (weight > 0.0).choose(weight, 0.5)
    same = (fs * fb) > 0.0
    near = abs(s - b) < NEAR_ENOUGH
    hit = fs.compare("oeq", 0.0) | near
    new = {
        "a": same.choose(a, b),
        "fa": same.choose(weight * fa, fb),
        "b": s,
        "fb": hit.choose(0.0, fs),
        "t": s,
    }
    return {name: found.choose(state[name], value) for name, value in new.items()}, found | hit


# What calls nothing of each other: LLVM compiles one after the other, and between two of them whoever waits for it,
# as the import of numba does, has its turn.
MODULES = ((boxes,), (form, named, signs, crossings), (value,), (leaf, slide), (enclose,))
