"""The root of a function on a bracket, eight lanes at a time, as LLVM text."""

from __future__ import annotations

from collections.abc import Callable

from rsym.backends.vector_code import Value
from rsym.sampling.kernels.routines import DOUBLES, LANES, Routine

State = dict[str, Value]

# On the car 4 steps are the rule. Where the form has a kink at its root, false position crawls: from there on, halves.
PATIENCE = 12
# The halves that follow end at the last bit of t.
MOST_STEPS = 70
NEAR_ENOUGH = 2e-14


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
