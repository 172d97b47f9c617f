"""Leaves that jump, as gates: where a condition decides between two formulas its own zeros are the boundary.

A leaf that is f where c > 0 and g where c < 0 has there the sign of max(min(c, f), min(-c, g), min(f, g)): the last
term keeps it positive on c = 0 where both are. So sign(f) is the leaf f, and a Piecewise of 1 and -1 its condition.
Choices that are continuous stay in their leaf, which is one surface then.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Collection, Sequence
from functools import partial
from typing import Any

import sympy as sp

from rsym.backends.interpreter import interpret
from rsym.logic.domains import MOST_PARTS, ROOTS, bounded, ended, lowest, replaced
from rsym.logic.poles import without_pole
from rsym.logic.stripping import formal_sign, sign_gate
from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import live
from rsym.program.raising import raised

MOST_STEPS = 8  # within each other: each may double a leaf
POINTS, HALVINGS = 256, 60
BESIDE = 1e-13  # of a segment, how far beyond a zero its other side is: on the zero others may be zero too
CONTINUOUS = 1e-9  # of its size, a step that rounding may make
SIZES = (1.0, 10.0, 0.1, 100.0)
DIGITS, EXACT, FINE = 60, 1e-40, 10**6  # of numbers, what is nothing beside terms that cancel, places in a unit
KINKS = (sp.Abs, sp.Min, sp.Max, sp.Piecewise, sp.sign, sp.floor, sp.ceiling, sp.Float)


def parted(builder: Builder, leaf: int, guards: Collection[int], whole: Callable[[int, Collection[int]], int]) -> int:
    """A leaf as gates of leaves that do not jump and have a value everywhere; `whole` does that for what has gates.

    What `guards` say is positive where the leaf counts.
    """
    step = next(_steps(builder, leaf), None) if len(guards) < MOST_STEPS else None
    if step is None:
        made = without_pole(builder, leaf, lambda node: whole(node, guards))
        return bounded(builder, leaf, guards) if made is None else made
    operation, arguments, _ = builder.nodes[step]
    if operation == "sign":
        condition, yes, no = arguments[0], builder.const(1), builder.const(-1)
    else:
        over, under, yes, no = arguments
        condition = builder.sub(over, under)
    other = builder.neg(condition)
    sides: list[tuple[int, int | None]] = []
    for guard, branch in ((condition, yes), (other, no)):
        chosen = replaced(builder, leaf, {step: branch})
        sides.append((guard, None if _is_undefined(builder, chosen) else chosen))
    for guard, only in sides:
        if formal_sign(builder, guard) > 0 and only is not None:
            return whole(only, guards)
    kept = [(guard, chosen) for guard, chosen in sides if chosen is not None]
    if not kept:
        return builder.const(-1)
    if len(kept) == 1:  # beyond the condition there is no value
        ((guard, chosen),) = kept
        builder.walls.setdefault(guard, {})
        return ended(builder, whole(guard, ()), whole(chosen, guards))
    sided = [whole(chosen, (*guards, guard)) for guard, chosen in kept]
    return chosen_gate(builder, [whole(guard, ()) for guard, _ in kept], sided)


def chosen_gate(builder: Builder, conditions: Sequence[int], values: Sequence[int]) -> int:
    """max(min(c, f), min(-c, g), min(f, g)) of c and -c, f and g, for the sign alone."""
    join = partial(sign_gate, builder)
    first, second = (join("min", *pair) for pair in zip(conditions, values, strict=True))
    return join("max", join("max", first, second), join("min", *values))


def has_steps(builder: Builder, leaf: int) -> bool:
    """Whether a leaf jumps, from one side of a condition to the other: not on the condition alone."""
    return any(True for _ in _steps(builder, leaf, across=True))


def is_between(builder: Builder, leaf: int) -> bool:
    """Whether a leaf is between its sides where its conditions are zero, by its form: linear in all its signs.

    A choice has the value of a side there, `sign` has one of its own.
    """
    stepped: set[int] = set()
    parts = live(builder.nodes, [leaf])
    for part in parts:
        operation, arguments, _ = builder.nodes[part]
        found = [argument in stepped for argument in arguments]
        if operation == "sign" and not builder.uniform[part] and not any(found):
            stepped.add(part)
        elif any(found):
            once = (operation == "mul" and not all(found)) or (operation == "div" and not found[1])
            if not once and operation not in {"add", "neg"}:
                return False
            stepped.add(part)
    return not stepped or builder.steps.isdisjoint(parts)


def _steps(builder: Builder, leaf: int, *, across: bool = False) -> Any:
    """The choices in a leaf at which it jumps or whose sides are defined on their own, those of the outside first."""
    for part in reversed(live(builder.nodes, [leaf])):
        operation, arguments, _ = builder.nodes[part]
        if operation == "sign" and not builder.uniform[part]:
            if _jumps(builder, leaf, part, arguments[0], builder.const(1), builder.const(-1), across):
                yield part
        elif operation == "select" and part in builder.steps:
            condition, (yes, no) = builder.sub(*arguments[:2]), arguments[2:]
            if builder.uniform[condition] or (across and formal_sign(builder, condition) > 0):
                continue
            if is_partial(builder, yes, no) or _jumps(builder, leaf, part, condition, yes, no, across):
                yield part


def is_partial(builder: Builder, *numbers: int) -> bool:
    """Whether one of some nodes may have no value somewhere, beside where its conditions have none."""
    for part in live(builder.nodes, [_unchecked(builder, number) for number in numbers]):
        operation, arguments, _ = builder.nodes[part]
        if operation == "undefined":
            return True
        if operation in ROOTS and lowest(builder, arguments[0]) < 0:
            return True
    return False


def _unchecked(builder: Builder, number: int) -> int:
    """The node without the choices whose conditions hold wherever they have a value."""
    checks: dict[int, int] = {}
    for part in live(builder.nodes, [number]):
        operation, arguments, _ = builder.nodes[part]
        if operation == "select" and part in builder.steps and formal_sign(builder, builder.sub(*arguments[:2])) > 0:
            checks[part] = replaced(builder, arguments[2], checks)
    return replaced(builder, number, checks)


def _is_undefined(builder: Builder, number: int) -> bool:
    """Whether a node has no value anywhere."""
    found: dict[int, bool] = {}
    for part in live(builder.nodes, [number]):
        operation, arguments, _ = builder.nodes[part]
        strict = OPERATIONS[operation].strict and any(found[argument] for argument in arguments)
        found[part] = operation == "undefined" or strict
    return found[number]


def _jumps(builder: Builder, leaf: int, step: int, condition: int, yes: int, no: int, across: bool) -> bool:
    """Whether a leaf jumps where a condition in it changes its sign, by algebra, or else as points show.

    So too if none of these is found. What the condition decides is compared in one point, or `across` it, each on its
    side, which hides thin sets.
    """
    if builder.value(condition) is not None:
        return True
    one, other = (replaced(builder, leaf, {step: chosen}) for chosen in (yes, no))
    if (proved := _divides(builder, condition, _unchecked(builder, builder.sub(one, other)))) is not None:
        return not proved
    program = builder.program({"condition": condition, "0": one, "1": other})
    chance = random.Random(20130605)
    inputs = [[[chance.uniform(-1, 1) for _ in range(POINTS)] for _ in builder.coordinates] for _ in range(2)]
    for rows in inputs:
        for row in rows:
            row[:] = [SIZES[k % len(SIZES)] * value for k, value in enumerate(row)]
    letters = {name: [chance.uniform(0.5, 1.5)] * POINTS for name in builder.letters}

    def at(shares: list[float]) -> Any:
        places = [
            [(1 - t) * a + t * b for t, a, b in zip(shares, *pair, strict=True)] for pair in zip(*inputs, strict=True)
        ]
        return interpret(program, {**dict(zip(builder.coordinates, places, strict=True)), **letters})

    low, high = [0.0] * POINTS, [1.0] * POINTS
    start, end = at(low)["condition"] + [0.0] * POINTS, at(high)["condition"] + [0.0] * POINTS
    crossed = [bool(min(a, b) < 0 < max(a, b)) for a, b in zip(start, end, strict=True)]  # products overflow
    for _ in range(HALVINGS):
        middle = [(a + b) / 2 for a, b in zip(low, high, strict=True)]
        value = at(middle)["condition"] + [0.0] * POINTS
        for k, (first, now) in enumerate(zip(start, value, strict=True)):
            (low if (first > 0 and now > 0) or (first < 0 and now < 0) else high)[k] = middle[k]
    near = at(low)
    far = at([min(1.0, share + BESIDE) for share in high]) if across else near
    ups, downs = (
        [here if (first > 0) == upper else there for first, here, there in zip(start, *ends, strict=True)]
        for upper, ends in ((k == "0", [found[k] + [0.0] * POINTS for found in (near, far)]) for k in "01")
    )
    gaps = [
        abs(up - down) > CONTINUOUS * (1 + abs(up) + abs(down))
        for cross, up, down in zip(crossed, ups, downs, strict=True)
        if cross and abs(up) + abs(down) < float("inf")
    ]
    return any(gaps) or not gaps


def _divides(builder: Builder, condition: int, difference: int) -> bool | None:
    """Whether a difference is zero where a condition is, as its multiple by a polynomial; None if that is not known.

    Of absolute values, minima and maxima each side is asked. Of polynomials a remainder is a proof that it is not zero
    there, but where the condition has no zeros, or a factor without any; then gates are no harm.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> _divides(b, x, b.mul(x, b.abs(y))), _divides(b, x, b.make("max", x, b.input("y"))), _divides(b, x, b.sqrt(y))
    (True, False, False)
    """
    if len(live(builder.nodes, [condition, difference])) > MOST_PARTS:
        return None
    divisor, _ = sp.fraction(sp.together(raised(builder.nodes, condition)))
    alone = divisor.is_polynomial()
    for branch in _branches(builder, difference):
        dividend, _ = sp.fraction(sp.together(raised(builder.nodes, branch)))
        if dividend.is_number:
            if dividend == 0:
                continue
            return False if alone else None
        try:
            (_, rest), whole = sp.reduced(dividend, [divisor]), sp.Poly(dividend)
            sizes = [abs(number) for number in sp.Poly(rest, *{*whole.gens, *sp.Poly(divisor).gens}).coeffs()]
            divides = bool(max(sizes) <= CONTINUOUS * max(abs(number) for number in whole.coeffs()))
        except (sp.PolynomialError, sp.polys.polyerrors.BasePolynomialError, TypeError):
            divides = False
        if divides:
            continue
        if alone and dividend.is_polynomial():
            return False
        vanishes = _vanishes(dividend, divisor, [sp.Symbol(name, real=True) for name in builder.coordinates])
        if not vanishes:
            return vanishes
    return True


def _vanishes(function: sp.Expr, condition: sp.Expr, coordinates: Sequence[sp.Symbol]) -> bool | None:
    """Whether an analytic function is zero where a condition that is linear in a coordinate is; None of others.

    It is not, if that shows at one point, as small as it may be there.

    Examples
    --------
    >>> x, y = sp.symbols("x y", real=True)
    >>> [_vanishes(f, x, (x, y)) for f in (sp.exp(x) - 1, x + sp.exp(-(10**9) * y**2), sp.Abs(y))]
    [True, False, None]
    """
    if function.has(*KINKS):
        return None
    for across in coordinates:
        if not condition.is_polynomial(across) or sp.degree(condition, across) != 1:
            continue
        slope, rest = sp.Poly(condition, across).all_coeffs()
        inputs = sorted(function.free_symbols | condition.free_symbols - {across}, key=str)
        terms = sp.Add.make_args(function.subs(across, -rest / slope))
        chance, seen = random.Random(20130605), 0
        for size in SIZES * 3:
            place = {symbol: sp.Rational(chance.randint(-FINE, FINE), FINE) * sp.Rational(size) for symbol in inputs}
            values = [sp.N(term.subs(place), DIGITS) for term in terms]
            if not all(value.is_Float or value.is_Integer for value in values):
                continue
            seen += 1
            if abs(sum(values)) > EXACT * sum(map(abs, values)):
                return False
        return True if seen else None
    return None


def _branches(builder: Builder, number: int) -> list[int]:
    """The node with each of the sides of its absolute values, minima and maxima, a few at most."""
    found = [number]
    for _ in range(MOST_STEPS):
        kinks = [(one, part) for one in found for part in live(builder.nodes, [one]) if _sides(builder, part)]
        if not kinks:
            break
        one, part = kinks[0]
        found.remove(one)
        found += [replaced(builder, one, {part: side}) for side in _sides(builder, part)]
    return found


def _sides(builder: Builder, part: int) -> tuple[int, ...]:
    operation, arguments, _ = builder.nodes[part]
    if operation == "abs":
        return arguments[0], builder.neg(arguments[0])
    return arguments if operation in {"min", "max"} else ()
