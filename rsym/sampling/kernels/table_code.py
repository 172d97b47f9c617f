"""Routines of a large form: leaves by their kinds, and loops over what matters instead of branches around the rest.

A region is the form without its idle operands: entries in the order of evaluation, each a leaf with its row, or a gate
with the entries of its operands; `region_code` makes it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rsym.sampling.kernels.form_code import AXES, Parts, leaf_number, leaf_outputs
from rsym.sampling.kernels.ray_code import (
    ENDS,
    HUGE,
    NAMED,
    STRUCT,
    ModelCalls,
    RayFormulas,
    called,
    first_of_equals,
    idle_operands,
)
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine
from rsym.sampling.kernels.table_layout import FormTable, WorkRoom

OPERATIONS = ("min", "max")
# Entries of a region beside leaves: a gate with both operands, and one with none.
BOTH, NEITHER = (0, 1), (2, 3)
POINT = dict.fromkeys(AXES, DOUBLES)
MEMORY = dict.fromkeys(("constants", "words", "room"), "ptr")
WORDS = f"<{LANES} x i64>"
ENTRY = WorkRoom.ENTRY


def leaf_routines(s: RayFormulas) -> list[Routine]:
    """Model, value and gradient of a leaf of each kind, and of a leaf of any."""
    made: list[Routine] = []
    for number, kind in enumerate(s.kinds.kinds):
        r = Routine(f"model{number}", {"ends": "ptr", "constants": "ptr", "out": "ptr"}, internal=True)
        _load_ends(r)
        calls = ModelCalls(kind.rays, r)
        calls.known |= {len(AXES) + k: _kept(r, _shared_at(r, "%ends", k)) for k in range(len(s.kinds.shared))}
        _keep(r, "%out", calls.leaf(0, calls.known))
        r.do("ret void")
        made.append(r)
        if kind.points is None:
            continue
        known = kind.points.inputs(dict(zip(s.coordinates, ("%x", "%y", "%z"), strict=True)))
        r = Routine(f"value{number}", POINT | {"constants": "ptr"}, DOUBLES, internal=True)
        (value,) = kind.points.outputs(r, leaf_outputs(0)[:1], dict(known))
        r.do(f"ret {DOUBLES} {(value * r.element('%constants', 0)).name}")
        made.append(r)
        r = Routine(f"gradient{number}", POINT | {"constants": "ptr"}, STRUCT, internal=True)
        give(r, [part.name for part in kind.points.outputs(r, leaf_outputs(0), dict(known))])
        made.append(r)
    every = range(len(s.kinds.kinds))
    known_at_points = [number for number in every if s.kinds.kinds[number].points is not None]
    infinite = f"<{', '.join(['double 0x7FF0000000000000'] * LANES)}>"
    return [
        *made,
        *([shared(s)] if s.kinds.shared else []),
        _by_kind("model", {"ends": "ptr", "constants": "ptr", "out": "ptr"}, "void", every, ""),
        # A guard: at a point the leaves tell themselves where they are undefined.
        _by_kind("value", POINT | {"constants": "ptr"}, DOUBLES, known_at_points, infinite),
        _by_kind("gradient", POINT | {"constants": "ptr"}, STRUCT, known_at_points, "zeroinitializer"),
    ]


def shared(s: RayFormulas) -> Routine:
    """Make the models that leaves share, behind those of the coordinates."""
    r = Routine("shared", {"ends": "ptr", "constants": "ptr"}, internal=True)
    _load_ends(r)
    calls = ModelCalls(s.rays, r)
    calls.make(s.kinds.shared, calls.known)
    for k, number in enumerate(s.kinds.shared):
        _keep(r, _shared_at(r, "%ends", k), calls.known[number])
    r.do("ret void")
    return r


def _shared_at(r: Routine, ends: str, k: int) -> str:
    return r.place(ends, "double", (len(ENDS) + 4 * k) * LANES)


def _load_ends(r: Routine) -> None:
    for place, name in enumerate(ENDS):
        r.do(f"%{name} = load {DOUBLES}, ptr {r.place('%ends', 'double', place * LANES)}, align 8")


def _by_kind(name: str, parameters: Mapping[str, str], result: str, kinds: Sequence[int], rest: str) -> Routine:
    """The routine of a leaf whose kind comes first."""
    r = Routine(f"leaf_{name}", {"kind": "i64", **parameters}, result, internal=True)
    given = ", ".join(f"{type} %{parameter}" for parameter, type in parameters.items())
    cases = " ".join(f"i64 {number}, label %kind{number}" for number in kinds)
    r.do(f"switch i64 %kind, label %rest [ {cases} ]")
    for number in kinds:
        r.start(f"kind{number}")
        if result == "void":
            r.do(f"call void @{name}{number}({given})")
            r.do("ret void")
        else:
            r.do(f"ret {result} {r.emit(f'call {result} @{name}{number}({given})')}")
    r.start("rest")
    r.do(f"ret {result} {rest}".rstrip())
    return r


def give(r: Routine, parts: Sequence[str]) -> None:
    """Return four vectors."""
    value = "poison"
    for place, part in enumerate(parts):
        value = r.emit(f"insertvalue {STRUCT} {value}, {DOUBLES} {part}, {place}")
    r.do(f"ret {STRUCT} {value}")


def gradient_at(s: RayFormulas, r: Routine, leaf: str, point: Sequence[str]) -> list[str]:
    """Value and gradient of a leaf by its number, which may be any."""
    kind, row = (r.load(of_leaf(s, r, leaf), k, "i64") for k in range(2))
    given = ", ".join(f"{DOUBLES} {part}" for part in point)
    found = r.emit(f"call {STRUCT} @leaf_gradient(i64 {kind}, {given}, ptr {r.place('%constants', 'double', row)})")
    return [r.emit(f"extractvalue {STRUCT} {found}, {k}") for k in range(4)]


def of_leaf(s: RayFormulas, r: Routine, leaf: str) -> str:
    """Where the integers of a leaf lie."""
    place = r.emit(f"add i64 {r.emit(f'mul i64 {leaf}, {FormTable.LEAF}')}, {s.table.leaves}")
    return r.place("%constants", "double", place)


def of_gate(s: RayFormulas, r: Routine, gate: str) -> str:
    """Where the integers of a gate lie."""
    place = r.emit(f"add i64 {r.emit(f'mul i64 {gate}, {FormTable.GATE}')}, {s.table.gates}")
    return r.place("%constants", "double", place)


def _kept(r: Routine, pointer: str) -> Parts:
    return [r.load(pointer, k * LANES) for k in range(4)]


def _keep(r: Routine, pointer: str, parts: Parts) -> None:
    for k, part in enumerate(parts):
        r.store(part, pointer, k * LANES)


def _value(r: Routine, values: str, number: str) -> str:
    """Where the value of an entry lies."""
    return r.place(values, "double", r.emit(f"mul i64 {number}, {4 * LANES}"))


def _ends(s: RayFormulas, r: Routine) -> str:
    """The models of the coordinates in memory, and room for those that leaves share."""
    ends = r.emit(f"alloca [{len(ENDS) + 4 * len(s.kinds.shared)} x {DOUBLES}], align 64")
    for place, name in enumerate(ENDS):
        r.store(f"%{name}", ends, place * LANES)
    return ends


class _Entries:
    """A loop over the entries of the region `%words`: what a leaf does, then what a gate does, then what none does."""

    def __init__(self, s: RayFormulas, r: Routine, i: str) -> None:
        self.r, self.kinds, self.number = r, len(s.kinds.kinds), len(r.lines)
        entry = r.place("%words", "i64", r.emit(f"add i64 {r.emit(f'mul i64 {i}, {ENTRY}')}, 1"))
        self.what, self.first, self.second = (r.load(entry, k, "i64") for k in range(3))
        self.values = _values(s, r)
        self.out = _value(r, self.values, i)
        cases = [f"i64 {self.kinds + k}, label %entry{self.number}.{k}" for k in (*BOTH, *NEITHER)]
        r.do(f"switch i64 {self.what}, label %leaf{self.number} [ {' '.join(cases)} ]")

    def leaf(self) -> None:
        self.r.start(f"leaf{self.number}")

    def of(self, which: int) -> None:
        """Leave what is under way, and begin an entry of another sort."""
        self.r.do(f"br label %over{self.number}")
        self.r.start(f"entry{self.number}.{which}")

    def end(self) -> None:
        self.r.label(f"over{self.number}")

    def operands(self) -> tuple[str, str]:
        """Where the values of both operands lie."""
        return _value(self.r, self.values, self.first), _value(self.r, self.values, self.second)


def _values(s: RayFormulas, r: Routine) -> str:
    """Where the values of entries lie."""
    return r.place("%room", "double", s.room.values)


def _last(s: RayFormulas, r: Routine, count: str) -> str:
    return _value(r, _values(s, r), r.emit(f"sub i64 {count}, 1"))


def model(s: RayFormulas) -> Routine:
    """The model of a region on a segment of each lane."""
    r = Routine("model", dict.fromkeys(ENDS, DOUBLES) | MEMORY, STRUCT, True)
    ends, count = _ends(s, r), r.load("%words", 0, "i64")
    missing = r.emit("alloca i1, align 1")
    r.do(f"store i1 true, ptr {missing}")
    with r.loop("0", count, 1) as i:
        entry = _Entries(s, r, i)
        entry.leaf()
        if s.kinds.shared:  # for the first leaf: many a region has none
            r.do(f"br i1 {r.emit(f'load i1, ptr {missing}')}, label %share, label %on")
            r.start("share")
            r.do(f"call void @shared(ptr {ends}, ptr %constants)")
            r.do(f"store i1 false, ptr {missing}")
            r.label("on")
        row = r.place("%constants", "double", entry.first)
        r.do(f"call void @leaf_model(i64 {entry.what}, ptr {ends}, ptr {row}, ptr {entry.out})")
        for which, operation in zip(BOTH, OPERATIONS, strict=True):
            entry.of(which)
            a, b = (_kept(r, place) for place in entry.operands())
            _keep(r, entry.out, called(r, operation, [*a, *b], 4))
        for which, end in zip(NEITHER, (HUGE, -HUGE), strict=True):
            entry.of(which)
            _keep(r, entry.out, [r.number(end).name] * 2 + ["zeroinitializer"] * 2)
        entry.end()
    give(r, _kept(r, _last(s, r, count)))
    return r


def point(s: RayFormulas) -> Routine:
    """The value of a region at a point of each lane, and the number of its active leaf."""
    r = Routine("point", POINT | MEMORY, NAMED, True)
    tolerance, count = r.element("%constants", s.tolerance), r.load("%words", 0, "i64")

    def keep(place: str, value: str, leaf: str) -> None:
        r.store(value, place, 0)
        r.store(leaf, r.place(place, "double", LANES), 0, SHORTS)

    def kept(place: str) -> Parts:
        return [r.load(place, 0), r.load(r.place(place, "double", LANES), 0, SHORTS)]

    with r.loop("0", count, 1) as i:
        entry = _Entries(s, r, i)
        entry.leaf()
        row = r.place("%constants", "double", entry.first)
        given = ", ".join(f"{DOUBLES} %{axis}" for axis in AXES)
        value = r.emit(f"call {DOUBLES} @leaf_value(i64 {entry.what}, {given}, ptr {row})")
        keep(entry.out, value, r.splat(r.emit(f"trunc i64 {entry.second} to i16"), "i16"))
        for which, operation in zip(BOTH, OPERATIONS, strict=True):
            entry.of(which)
            a, b = (kept(place) for place in entry.operands())
            value, leaf = first_of_equals(r, operation, a, b, tolerance)
            keep(entry.out, value, leaf)
        for which, end in zip(NEITHER, ("inf", "-inf"), strict=True):
            entry.of(which)
            keep(entry.out, r.number(float(end)).name, leaf_number(0))
        entry.end()
    value, leaf = kept(_last(s, r, count))
    first = r.emit(f"insertvalue {NAMED} poison, {DOUBLES} {value}, 0")
    r.do(f"ret {NAMED} {r.emit(f'insertvalue {NAMED} {first}, {SHORTS} {leaf}, 1')}")
    return r


def survey(s: RayFormulas) -> Routine:
    """Which operands of gates do not matter on a segment of each lane: words, those of each lane a stride apart."""
    parameters = dict.fromkeys(ENDS, DOUBLES) | {"constants": "ptr", "words": "ptr", "stride": "i64", "room": "ptr"}
    r = Routine("survey", parameters, internal=True)
    leaves, gates = len(s.rays.leaves), len(s.gates)
    ends = _ends(s, r)
    if s.kinds.shared:
        r.do(f"call void @shared(ptr {ends}, ptr %constants)")
    values, marks = _values(s, r), r.place("%room", "i64", s.room.marks)
    with r.loop("0", f"{leaves}", 1) as i:
        kind, row = (r.load(of_leaf(s, r, i), k, "i64") for k in range(2))
        row = r.place("%constants", "double", row)
        r.do(f"call void @leaf_model(i64 {kind}, ptr {ends}, ptr {row}, ptr {_value(r, values, i)})")
    with r.loop("0", f"{s.words}", 1) as i:
        r.store("zeroinitializer", r.place(marks, "i64", r.emit(f"mul i64 {i}, {LANES}")), 0, WORDS)
    with r.loop("0", f"{gates}", 1) as i:
        number = len(r.lines)
        operation, *operands, known = (r.load(of_gate(s, r, i), k, "i64") for k in range(FormTable.GATE))
        a, b = (_kept(r, _value(r, values, operand)) for operand in operands)
        greater = r.emit(f"icmp ne i64 {operation}, 0")
        ranges, everywhere = [], []
        for position, parts in enumerate((a, b)):
            low, high = map(r.value, called(r, "range", parts, 2))
            pairs = ((-high, low), (-low, high))  # a max is a min of what is turned
            turned = [r.emit(f"select i1 {greater}, {DOUBLES} {p.name}, {DOUBLES} {q.name}") for p, q in pairs]
            ranges.append((r.value(turned[0]), r.value(turned[1])))
            one = r.emit(f"trunc i64 {r.emit(f'lshr i64 {known}, {position}')} to i1")
            everywhere.append(r.value(r.splat(one, "i1"), "i1"))
        bit = r.emit(f"shl i64 {i}, 1")
        place = r.emit(f"shl i64 {r.emit(f'lshr i64 {bit}, 6')}, {LANES.bit_length() - 1}")
        word = r.place(marks, "i64", place)
        yes = r.splat(r.emit(f"shl i64 1, {r.emit(f'and i64 {bit}, 63')}"), "i64")
        marked = r.load(word, 0, WORDS)
        for idle in idle_operands(ranges, everywhere):
            marked = r.emit(f"or {WORDS} {marked}, {r.select(idle.name, yes, 'zeroinitializer', WORDS)}")
            yes = r.emit(f"shl {WORDS} {yes}, splat (i64 1)")
        r.store(marked, word, 0, WORDS)
        out = _value(r, values, r.emit(f"add i64 {i}, {leaves}"))
        r.do(f"br i1 {greater}, label %max{number}, label %min{number}")
        for name in OPERATIONS:
            r.start(f"{name}{number}")
            _keep(r, out, called(r, name, [*a, *b], 4))
            r.do(f"br label %joined{number}")
        r.start(f"joined{number}")
    with r.loop("0", f"{s.words}", 1) as i:
        flags = r.load(r.place(marks, "i64", r.emit(f"mul i64 {i}, {LANES}")), 0, WORDS)
        for lane in range(LANES):
            one = r.emit(f"extractelement {WORDS} {flags}, i32 {lane}")
            r.store(one, "%words", r.emit(f"add i64 {r.emit(f'mul i64 %stride, {lane}')}, {i}"), "i64")
    r.do("ret void")
    return r
