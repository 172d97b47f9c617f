"""The march along rays: where the form is first not negative, by enclosures, and the root on the active leaf there.

On a segment the form has a quadratic model, so an upper and a lower bound, both parabolas. Before the first root of the
upper one the form is negative; behind the first root of the lower one it is not. Where both lie close together the
segment between them holds the crossing; where only the upper one has a root the rest of the segment is halved, and when
it is a small part of a pixel a point decides. A segment without a root doubles the next one.

Eight rays march together; no lane depends on another. Their state is rows of memory.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from rsym.backends.vector_code import Value
from rsym.sampling.kernels.cells_code import Known, among, asking, stretch_of, words_for
from rsym.sampling.kernels.form_code import leaf_outputs
from rsym.sampling.kernels.ray_code import NAMED, STRUCT, RayFormulas
from rsym.sampling.kernels.ray_state import GONE, LOST, MARCHING, MET, Row, get, least, most, put, turns
from rsym.sampling.kernels.routines import DOUBLES, LANES, SHORTS, Routine
from rsym.sampling.kernels.table_code import gradient_at
from rsym.sampling.ray_steps import (
    CROSSING,
    HALVINGS,
    LONGER,
    MOST_STEPS,
    NARROWER,
    PATIENCE,
    ROUNDED_AWAY,
    SETTLED,
    SHORTEST,
    TOO_OFTEN,
)

ROUNDED = 2.0**-51  # of the terms of a point on a ray
# Rounds of Newton's method on the active leaf, and steps in each: where the leaf changes between the ends of a bracket
# the next round takes the other one. Before the last one what has not come to a root is halved, by signs.
ROUNDS, STEPS = 5, 5
BLOCK = ("state", "constants", "limits", "words")  # the first parameters of what works on eight rays


def segment(r: Routine, t: Value, step: Value, radius: Value | None = None) -> list[str]:
    """The models of the coordinates on a segment: low, high, linear of each."""
    half = step * 0.5
    middle = t + half
    parts: list[str] = []
    for axis in range(3):
        o, d = get(r, Row.ORIGIN + axis), get(r, Row.DIRECTION + axis)
        centre = o + d * middle
        wide = (abs(o) + abs(d) * (abs(t) + step)) * ROUNDED
        wide = wide if radius is None else wide + radius
        parts += [(centre - wide).name, (centre + wide).name, (d * half).name]
    return parts


def model_on(
    s: RayFormulas, r: Routine, t: Value, step: Value, known: Known, radius: Value | None = None
) -> list[Value]:
    """The model of the form on a segment."""
    given = ", ".join(f"{DOUBLES} {part}" for part in segment(r, t, step, radius))
    value = r.emit(f"call {STRUCT} @{asking(s, r, 'model', given, known)}")
    return [r.value(r.emit(f"extractvalue {STRUCT} {value}, {k}")) for k in range(4)]


def place_at(r: Routine, t: Value) -> list[Value]:
    """The point of each ray at t."""
    return [get(r, Row.ORIGIN + axis) + get(r, Row.DIRECTION + axis) * t for axis in range(3)]


def form_at(s: RayFormulas, r: Routine, t: Value, known: Known) -> tuple[Value, Value]:
    """The value of the form at t, and the number of its active leaf."""
    given = ", ".join(f"{DOUBLES} {part.name}" for part in place_at(r, t))
    both = r.emit(f"call {NAMED} @{asking(s, r, 'point', given, known)}")
    value, leaf = (r.emit(f"extractvalue {NAMED} {both}, {k}") for k in range(2))
    return r.value(value), r.value(r.emit(f"sitofp {SHORTS} {leaf} to {DOUBLES}"))


def first_root(r: Routine, end: Value, linear: Value, quadratic: Value) -> Value:
    """The smallest w = s + 1 >= 0 at which a parabola with these coefficients of s and s**2 is 0; beyond 2 if none.

    `end` is its value at w = 0; where that is not negative, w is 0.
    """
    slope = linear - quadratic * 2.0
    discriminant = slope * slope - quadratic * end * 4.0
    root = r.root(most(discriminant, r.number(0.0)))
    rising = slope.compare("oge", 0.0)
    near = (end * -2.0) / (slope + root)
    far = (root - slope) / (quadratic * 2.0)
    opens = quadratic > 0.0
    found = rising.choose(near, opens.choose(far, 3.0))
    found = discriminant.compare("oge", 0.0).choose(found, 3.0)
    found = found.compare("oge", 0.0).choose(found, 3.0)  # 0/0 where there is none
    return (end < 0.0).choose(found, 0.0)


def march(s: RayFormulas) -> Routine:
    """Until each ray has met the form, is gone or lost."""
    r = Routine("march", dict.fromkeys(BLOCK, "ptr") | {"pixel": "double", "growth": "double"}, internal=True)
    pixel, growth = (r.value(r.splat(name)) for name in ("%pixel", "%growth"))
    with r.loop("0", f"{MOST_STEPS}", 1, lambda: get(r, Row.STATUS).compare("oeq", MARCHING)):
        t, stop, status = get(r, Row.T), get(r, Row.STOP), get(r, Row.STATUS)
        live = status.compare("oeq", MARCHING)
        number, end = stretch_of(s, r, t)
        step = least(get(r, Row.STEP), least(end, stop) - t)
        half = step * 0.5
        words = words_for(s, r, live, number)
        low, high, linear, quadratic = model_on(s, r, t, step, words)
        bend = quadratic - linear
        upper = first_root(r, high + bend, linear, quadratic)
        lower = first_root(r, low + bend, linear, quadratic)
        out = upper > 2.0
        begin = t + upper * half
        width = most((lower - upper) * half, r.number(0.0))
        size = pixel + growth * abs(t)
        failed = get(r, Row.FAILED)
        doublings = (failed * (1.0 / PATIENCE) - 0.5).rounded
        shortest = most(size * SHORTEST, _rounding(r, t))
        shortest = shortest * most(least(doublings, r.number(60.0)), r.number(0.0)).power_of_two
        certain = lower.compare("ole", 2.0)
        crosses = certain & (width < size * CROSSING)
        short = step.compare("ole", shortest * 1.01)
        narrow = live & (out ^ 1) & (crosses | (short & (certain ^ 1)))
        following = most(least(certain.choose(width, t + step - begin), half), shortest)
        put(r, Row.T, live.choose(out.choose(t + step, begin), t))
        put(r, Row.STEP, live.choose(out.choose(step * 2.0, following), step))
        with r.where(narrow):
            end = crosses.choose(begin + width, t + step)
            value, leaf = form_at(s, r, end, among(words, narrow))
            # Enclosures know better than a value whose sign is rounded; what is undefined is not inside.
            inside = (crosses & value.compare("ord", value)) | (value > 0.0)
            met = narrow & inside
            failing = narrow & (inside ^ 1)
            put(r, Row.STATUS, met.choose(MET, status))
            put(r, Row.LOW, met.choose(begin, get(r, Row.LOW)))
            put(r, Row.HIGH, met.choose(end, get(r, Row.HIGH)))
            put(r, Row.LEAF, met.choose(leaf, get(r, Row.LEAF)))
            put(r, Row.T, failing.choose(crosses.choose(most(end, begin + shortest), end), get(r, Row.T)))
            put(r, Row.STEP, failing.choose(shortest, get(r, Row.STEP)))
            put(r, Row.FAILED, failing.choose(failed + 1.0, failed))
            # Between two points outside of the body there may be a wall of it that is thinner than their distance. Of
            # that the range is small; a range that is the same on longer segments is a jump, or rounding.
            jumped = failing & (crosses ^ 1)
            with r.where(jumped):
                wide = model_on(s, r, t, shortest * LONGER, among(words, jumped))
                shrinks = _width(low, high, linear, quadratic) * NARROWER < _width(*wide)
                put(r, Row.DOUBT, (jumped & shrinks).choose(least(t, get(r, Row.DOUBT)), get(r, Row.DOUBT)))
        status = get(r, Row.STATUS)
        gone = status.compare("oeq", MARCHING) & get(r, Row.T).compare("oge", stop)
        put(r, Row.STATUS, gone.choose(GONE, status))
    status = get(r, Row.STATUS)
    put(r, Row.STATUS, status.compare("oeq", MARCHING).choose(LOST, status))
    r.do("ret void")
    return r


def _width(low: Value, high: Value, linear: Value, quadratic: Value) -> Value:
    """How far apart two values of a model may be."""
    return high - low + (abs(linear) + abs(quadratic)) * 2.0


def _rounding(r: Routine, t: Value) -> Value:
    """How close two points of a ray near t can be for their difference to say anything."""
    size = abs(t)
    for axis in range(3):
        size = size + abs(get(r, Row.ORIGIN + axis))
    return size * ROUNDED_AWAY


def settle(s: RayFormulas) -> Routine:
    """The root on the active leaf within the bracket of each ray, and the normal there."""
    camera = {"planes": "ptr", "cuts": "i64", "pixel": "double", "growth": "double"}
    r = Routine("settle", dict.fromkeys(BLOCK, "ptr") | camera, internal=True)
    todo = r.emit(f"alloca i{LANES}, align 8")
    status, tolerance = get(r, Row.STATUS), r.element("%constants", s.tolerance)
    lost, met = status.compare("oeq", LOST), status.compare("oeq", MET)
    put(r, Row.T, met.choose(get(r, Row.HIGH), get(r, Row.T)))
    at = met.choose(get(r, Row.HIGH), get(r, Row.T))
    if s.celled:  # the cell that the march was in when it met the form; the end of the bracket may lie in the next one
        at = met.choose((get(r, Row.LOW) + get(r, Row.HIGH)) * 0.5, at)
    words = words_for(s, r, met | lost, stretch_of(s, r, at)[0])
    begins = met & get(r, Row.LOW).compare("ole", get(r, Row.START))
    with r.where(begins | lost):
        # Inside already where the ray begins: a cap, unless the surface lies in it; of what is lost the nearest leaf.
        at = lost.choose(get(r, Row.T), get(r, Row.START))
        value, leaf = form_at(s, r, at, words)
        pinned = lost | (begins & (value > tolerance))
        entry = get(r, Row.ENTRY)
        capped = pinned & (lost ^ 1) & entry.compare("oge", 0.0)
        for row in (Row.T, Row.LOW, Row.HIGH):
            put(r, row, pinned.choose(at, get(r, row)))
        put(r, Row.LEAF, pinned.choose(capped.choose(entry, leaf), get(r, Row.LEAF)))
    # What may have been a wall right before the surface was the surface.
    pixel, growth = (r.value(r.splat(name)) for name in ("%pixel", "%growth"))
    passed, high = get(r, Row.DOUBT), get(r, Row.HIGH)
    room = most((pixel + growth * abs(high)) * SHORTEST, _rounding(r, high)) * LONGER
    wall = (passed < float("inf")) & ((met & ((high - passed) < room)) ^ 1)
    put(r, Row.DOUBT, (lost | wall | (get(r, Row.FAILED) > TOO_OFTEN)).choose(1.0, r.number(0.0)))
    put(r, Row.FAILED, get(r, Row.LEAF))
    put(r, Row.MOVED, r.number(float("inf")))
    with r.loop("0", f"{ROUNDS}", 1, lambda: _open(s, r)) as turn:
        ended = r.value(r.splat(r.emit(f"icmp eq i64 {turn}, {ROUNDS - 1}"), "i1"), "i1")
        with r.where(_open(s, r) & ended), r.loop("0", f"{HALVINGS}", 1):
            halved = _open(s, r) & ended
            middle = (get(r, Row.LOW) + get(r, Row.HIGH)) * 0.5
            value, leaf = form_at(s, r, middle, words)
            inside = value > 0.0
            put(r, Row.HIGH, (halved & inside).choose(middle, get(r, Row.HIGH)))
            put(r, Row.LOW, (halved & (inside ^ 1)).choose(middle, get(r, Row.LOW)))
            # The number of the leaf stands twice, for it is still to be followed.
            put(r, Row.FAILED, (halved & inside).choose(leaf, get(r, Row.FAILED)))
            put(r, Row.LEAF, (halved & inside).choose(leaf, get(r, Row.LEAF)))
            put(r, Row.T, halved.choose(get(r, Row.HIGH), get(r, Row.T)))
        r.store(r.mask(_open(s, r).name), todo, 0, f"i{LANES}")
        _by_leaf(s, r, todo)
        value, leaf = form_at(s, r, get(r, Row.T), words)
        mine, t = _open(s, r), get(r, Row.T)
        same = leaf.compare("oeq", get(r, Row.LEAF))
        near = get(r, Row.MOVED).compare("ole", most((pixel + growth * abs(t)) * SETTLED, _rounding(r, t)))
        other = mine & ((same & near) ^ 1) & (ended ^ 1)
        inside = value > 0.0
        put(r, Row.HIGH, (other & inside).choose(t, get(r, Row.HIGH)))
        put(r, Row.LOW, (other & (inside ^ 1)).choose(t, get(r, Row.LOW)))
        put(r, Row.T, (other & same).choose((get(r, Row.LOW) + get(r, Row.HIGH)) * 0.5, t))
        put(r, Row.LEAF, other.choose(leaf, get(r, Row.LEAF)))
        put(r, Row.FAILED, mine.choose(other.choose(leaf, -1.0), get(r, Row.FAILED)))
    _normals(s, r)
    r.do("ret void")
    return r


def _open(s: RayFormulas, r: Routine) -> Value:
    """The rays whose leaf is still to be followed."""
    status, leaf = get(r, Row.STATUS), get(r, Row.LEAF)
    return (status > MARCHING) & (leaf < float(s.count)) & get(r, Row.FAILED).compare("oeq", leaf)


def _by_leaf(s: RayFormulas, r: Routine, todo: str) -> None:
    """One turn for each leaf among the rays that are left."""
    with turns(r, todo, "%state", Row.LEAF) as (which, mine, again):
        if s.tabled:
            _newton(r, lambda places: gradient_at(s, r, which, places), mine)
            r.do(f"br label %{again}")
            return
        number = again.removeprefix("next")
        cases = " ".join(f"i64 {k}, label %leaf{number}.{k}" for k in range(s.count))
        r.do(f"switch i64 {which}, label %{again} [ {cases} ]")
        for k in range(s.count):
            r.start(f"leaf{number}.{k}")
            _newton(r, partial(_gradient, s, r, k), mine)
            r.do(f"br label %{again}")


def _gradient(s: RayFormulas, r: Routine, k: int, places: Sequence[str]) -> list[str]:
    known = s.points.inputs(dict(zip(s.coordinates, places, strict=True)))
    return [part.name for part in s.points.outputs(r, leaf_outputs(k), known)]


def _newton(r: Routine, gradient_of: Callable[[Sequence[str]], list[str]], mine: Value) -> None:
    """Steps along the ray onto a leaf, within the bracket; of the last one the gradient."""
    with r.loop("0", f"{STEPS}", 1):
        t = get(r, Row.T)
        f, *gradient = (r.value(part) for part in gradient_of([place.name for place in place_at(r, t)]))
        along = [part * get(r, Row.DIRECTION + axis) for axis, part in enumerate(gradient)]
        moved = t - f / (along[0] + along[1] + along[2])
        within = least(most(moved, get(r, Row.LOW)), get(r, Row.HIGH))
        known = mine & moved.compare("ord", moved)
        put(r, Row.T, known.choose(within, t))
        put(r, Row.MOVED, mine.choose(abs(moved - t), get(r, Row.MOVED)))
        for axis, part in enumerate(gradient):
            put(r, Row.NORMAL + axis, mine.choose(part, get(r, Row.NORMAL + axis)))


def _normals(s: RayFormulas, r: Routine) -> None:
    """Outer unit normals, from gradients, of what is cut off from the planes."""
    normal = [get(r, Row.NORMAL + axis) for axis in range(3)]
    length = r.root(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2])
    for axis, part in enumerate(normal):
        put(r, Row.NORMAL + axis, -(part / length))
    leaf = get(r, Row.LEAF)
    with r.where((get(r, Row.STATUS) > MARCHING) & leaf.compare("oge", float(s.count))), r.loop("0", "%cuts", 1) as j:
        index = r.emit(f"sitofp i64 {j} to double")
        mine = get(r, Row.LEAF).compare("oeq", r.value(r.splat(index)) + float(s.count))
        for axis in range(3):
            part = r.element(r.place("%planes", "double", r.emit(f"mul i64 {j}, 4")), axis)
            put(r, Row.NORMAL + axis, mine.choose(part, get(r, Row.NORMAL + axis)))


def clip(s: RayFormulas) -> Routine:
    """Where rays come into the half-spaces and leave them: normal . p <= offset, four numbers each."""
    r = Routine("clip", {"state": "ptr", "planes": "ptr", "cuts": "i64", "room": "double"}, internal=True)
    room = r.value(r.splat("%room"))
    put(r, Row.ENTRY, r.number(-1.0))
    with r.loop("0", "%cuts", 1) as j:
        plane = r.place("%planes", "double", r.emit(f"mul i64 {j}, 4"))
        normal = [r.element(plane, axis) for axis in range(3)]
        slopes = [part * get(r, Row.DIRECTION + axis) for axis, part in enumerate(normal)]
        away = [part * get(r, Row.ORIGIN + axis) for axis, part in enumerate(normal)]
        slope = slopes[0] + slopes[1] + slopes[2]
        left = room + r.element(plane, 3) - (away[0] + away[1] + away[2])
        at = left / slope
        enters = (slope < 0.0) & (at > get(r, Row.T))
        number = r.value(r.splat(r.emit(f"sitofp i64 {j} to double"))) + float(s.count)
        put(r, Row.T, enters.choose(at, get(r, Row.T)))
        put(r, Row.ENTRY, enters.choose(number, get(r, Row.ENTRY)))
        stop = get(r, Row.STOP)
        put(r, Row.STOP, ((slope > 0.0) & (at < stop)).choose(at, stop))
        beside = slope.compare("oeq", 0.0) & (left < 0.0)
        put(r, Row.STOP, beside.choose(float("-inf"), get(r, Row.STOP)))
    put(r, Row.START, get(r, Row.T))
    put(r, Row.FAILED, r.number(0.0))
    put(r, Row.DOUBT, r.number(float("inf")))
    put(r, Row.STATUS, (get(r, Row.T) < get(r, Row.STOP)).choose(MARCHING, r.number(GONE)))
    r.do("ret void")
    return r
