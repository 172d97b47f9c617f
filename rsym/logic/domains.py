"""Where a leaf has a value: a leaf with roots or logarithms is the minimum of what must be positive and a total leaf.

Kleene's logic says what is known where a leaf has no value: true or unknown is true, false and unknown is false. The
points that are surely inside are those of the form with each leaf f as min(d, f~): d is the domain, 9 - x**2 of
sqrt(9 - x**2) - y, and f~ is f with roots and logarithms of absolute values, which has a value everywhere and is f
where d > 0. So the domain is a leaf like others, a *wall*: there the body ends, though omega is not zero. Where f ends
at a wall it is there a formula without the root, its *limit*: the end is a common zero of that and of the domain.
A leaf k*sqrt(u) + w needs no root: with m = -w/k, sqrt(u) > m where m < 0 or u > m**2, and so for logarithms.
Source: Kleene (1952), section 64.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from fractions import Fraction
from functools import partial, reduce

import sympy as sp

from rsym.logic.stripping import formal_sign, scaled, sign_gate, unscaled
from rsym.program.builder import Builder
from rsym.program.program import live
from rsym.program.raising import raised

INFINITE = Fraction(10**9)  # no bound
MOST_ROOTS, MOST_PARTS = 7, 32
ROOTS = ("sqrt", "log", "pow")
_OWN = {
    "neg",
    "add",
    "mul",
    "div",
    "sqrt",
    "abs",
    "select",
    "normalised",
    "zero_with",
    "absolute_power",
    "signed_power",
}


def bounded(builder: Builder, leaf: int, guards: Collection[int] = ()) -> int:
    """A leaf as the minimum of its walls and of a leaf that has a value everywhere; the leaf itself if it has one.

    What `guards` say is positive where the leaf counts is no wall.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> made = bounded(b, b.sub(b.sqrt(x), b.make("sin", b.sqrt(y))))
    >>> b.nodes[made].operation, sorted(b.walls) == [x, y]
    ('min', True)
    >>> bounded(b, b.sub(b.make("log", x), y)) == b.sub(x, b.make("exp", y))
    True
    """
    ends = ends_of(builder, leaf)
    if not ends:
        return leaf
    known = {unscaled(builder, guard) for guard in guards}

    def walled(domain: int, made: int, total: int, limit: int | None, free: int | None = None) -> int:
        if (value := builder.value(made)) is not None and value <= 0:
            return builder.const(-1)
        if unscaled(builder, domain) in known:
            return made
        builder.walls.setdefault(domain, {})[total] = limit
        return ended(builder, domain if free is None else builder.make("max", domain, free), made)

    if (solved := _solved(builder, leaf, ends, walled)) is not None:
        return solved
    every = {part: domain for domain, parts in ends.items() for part in parts}
    total = replaced(builder, leaf, every, within=True)
    made = total
    for domain, parts in ends.items():
        wall = replaced(builder, domain, every, within=True)
        made = walled(wall, made, total, _limit(builder, leaf, parts, ends), _free(builder, parts))
    return made


def ended(builder: Builder, domain: int, made: int) -> int:
    """The minimum of a domain and what counts in it, for the sign alone; the builder knows that it ends there.

    So it does where that is positive everywhere: the minimum of the domain and 1.
    """
    value = builder.value(made)
    gate = builder.make("min", domain, made if value is None else builder.const(1))
    simple = sign_gate(builder, "min", domain, made)
    if simple not in {gate, domain} or (value is None and simple == domain):
        return simple
    builder.ending[gate] = domain
    return gate


def keep_walls(
    builder: Builder, leaves: Sequence[int], ends: Sequence[int], stripped: Callable[[int], Sequence[int]]
) -> None:
    """Know the limits at walls of the leaves of a form again: positive factors are stripped, and some have gates."""
    places = {unscaled(builder, leaf): leaf for leaf in leaves}
    walls = {unscaled(builder, leaves[end]): leaves[end] for end in ends}
    for domain, limits in [*builder.walls.items()]:
        kept = {places.get(unscaled(builder, leaf), leaf): limit for leaf, limit in limits.items()}
        for wall in stripped(domain):
            builder.walls.setdefault(walls.get(unscaled(builder, wall), wall), {}).update(kept)


def ends_of(builder: Builder, number: int) -> dict[int, list[int]]:
    """What must not be negative where a node has a value, and the roots and logarithms in it for which that is so."""
    ends: dict[int, list[int]] = {}
    for part in live(builder.nodes, [number]):
        domain = _domain(builder, part)
        if domain is not None:
            ends.setdefault(domain, []).append(part)
    return ends


def _solved(
    builder: Builder, leaf: int, ends: Mapping[int, Sequence[int]], walled: Callable[[int, int, int, int | None], int]
) -> int | None:
    """A leaf k*p(u) + w, p a root or logarithm, the only one in it, without that; None of others."""
    b, parts = builder, [part for some in ends.values() for part in some]
    terms = terms_of(b, leaf)
    own = [(number, times) for number, times in terms if number in parts]
    if len(parts) != 1 or len(own) != 1 or sum(parts[0] in live(b.nodes, [number]) for number, _ in terms) != 1:
        return None
    ((number, times),) = own
    operation, (u, *exponent), _ = b.nodes[number]
    over = b.const(0)  # p(u) is above it where the leaf is positive, for a positive factor
    for other, factor_of in terms:
        if other != number:
            over = b.add(over, b.mul(b.const(-factor_of / times), other))
    above = times > 0
    if operation == "log":
        found = b.sub(u, b.make("exp", over))
        return found if above else walled(u, b.neg(found), b.neg(found), None)
    power = Fraction(1, 2) if operation == "sqrt" else b.value(exponent[0])
    if power is None or not 0 < power < 1 or power.denominator > MOST_ROOTS:
        return None
    found = b.sub(b.powi(u, power.numerator), b.powi(over, power.denominator))
    found = found if above else b.neg(found)
    if power.denominator % 2:
        return walled(u, found, found, over)
    if above:
        below = b.neg(over)
        walls = walled(u, below, found, over)
        return walls if formal_sign(b, below) > 0 else sign_gate(b, "max", walls, found)
    return walled(u, sign_gate(b, "min", over, found), found, over)


def terms_of(builder: Builder, number: int) -> list[tuple[int, Fraction]]:
    """The terms of a sum, with the rational numbers that they are multiplied by.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> terms_of(b, b.sub(b.mul(b.const(3), b.input("x")), b.input("y"))) == [(b.input("y"), -1), (b.input("x"), 3)]
    True
    """
    found: list[tuple[int, Fraction]] = []
    stack = [(number, Fraction(1))]
    while stack:
        part, times = stack.pop()
        part, more = scaled(builder, part)
        operation, arguments, _ = builder.nodes[part]
        if operation == "add":
            stack.extend((argument, times * more) for argument in arguments)
        else:
            found.append((part, times * more))
    return found


def _domain(builder: Builder, part: int) -> int | None:
    """The node that is not negative where an operation has a value; None where that is everywhere, or for letters."""
    operation, arguments, _ = builder.nodes[part]
    if operation == "pow" and (builder.value(arguments[1]) or Fraction(1, 2)).denominator == 1:
        return None
    if operation not in ROOTS or builder.uniform[arguments[0]]:
        return None
    proved = lowest(builder, arguments[0]) >= 0 or _is_square(builder, arguments[0]) or _chooses(builder, arguments[0])
    return None if proved else arguments[0]


def _free(builder: Builder, parts: Sequence[int]) -> int | None:
    """What is positive for letters at which powers have values for all bases; None if it depends on no letters."""
    chosen = [_whole(builder, part, builder.const(-1), builder.const(1)) for part in parts]
    whole = [one for one in chosen if one is not None]
    return reduce(partial(builder.make, "min"), whole) if len(whole) == len(parts) else None


def _whole(builder: Builder, part: int, no: int, yes: int) -> int | None:
    """One of two nodes by whether the exponent of a power is whole, as that of a letter may be; None of others."""
    operation, arguments, _ = builder.nodes[part]
    if operation != "pow" or not builder.uniform[arguments[1]] or not _has_letter(builder, arguments[1]):
        return None
    return builder.select(arguments[1], builder.make("floor", arguments[1]), no, yes)


def _has_letter(builder: Builder, number: int) -> bool:
    return any(builder.nodes[part].operation == "input" for part in live(builder.nodes, [number]))


def _chooses(builder: Builder, number: int) -> bool:
    """Whether a node is one of a blend, which chooses formulas by where they have values."""
    parts = live(builder.nodes, [number])
    return any(builder.nodes[part].operation == "select" and part not in builder.steps for part in parts)


def _is_square(builder: Builder, number: int) -> bool:
    """Whether a node is a square, of a polynomial of few terms that is written otherwise."""
    parts = live(builder.nodes, [number])
    kinds = {builder.nodes[part].operation for part in parts}
    if len(parts) > MOST_PARTS or not kinds <= {"const", "input", "add", "neg", "mul", "powi"}:
        return False
    expression = raised(builder.nodes, number)
    if not expression.is_polynomial():
        return False
    leading, factors = sp.sqf_list(expression)
    return bool(leading > 0) and all(power % 2 == 0 for _, power in factors)


def _limit(builder: Builder, leaf: int, parts: Collection[int], ends: Mapping[int, Collection[int]]) -> int | None:
    """What the leaf is on a wall; None where it has no limit."""
    zero: dict[int, int] = {}
    for part in parts:
        operation, arguments, _ = builder.nodes[part]
        if operation == "log" or (operation == "pow" and (builder.value(arguments[1]) or 0) < 0):
            return None
        zero[part] = builder.const(0)
    others = {part: domain for domain, rest in ends.items() for part in rest if part not in zero}
    return replaced(builder, replaced(builder, leaf, zero), others, within=True)


def replaced(builder: Builder, number: int, substitutes: Mapping[int, int], *, within: bool = False) -> int:
    """A node with others in the place of some parts; `within`, with their sizes as first arguments of these parts."""
    made: dict[int, int] = {}
    for part in live(builder.nodes, [number]):
        operation, arguments, data = builder.nodes[part]
        inner = [made[argument] for argument in arguments]
        if part in substitutes and not within:
            made[part] = substitutes[part]
            continue
        if part in substitutes:
            size = builder.abs(inner[0])
            chosen = _whole(builder, part, size, inner[0])
            inner[0] = size if chosen is None else chosen
        if tuple(inner) == arguments:
            made[part] = part
        elif operation == "powi":
            assert isinstance(data, int)
            made[part] = builder.powi(inner[0], data)
        elif operation in _OWN:
            made[part] = getattr(builder, "step" if part in builder.steps else operation)(*inner)
        else:
            made[part] = builder.make(operation, *inner, data=data)
    return made[number]


def lowest(builder: Builder, number: int) -> Fraction:
    """A number below which a node never is, by its form, where it has a value.

    Examples
    --------
    >>> b = Builder(("x",), ())
    >>> x = b.input("x")
    >>> lowest(b, b.add(b.square(x), b.const(-3))), lowest(b, b.sub(b.const(1), b.make("cos", x)))
    (Fraction(-3, 1), Fraction(0, 1))
    """
    ranges: dict[int, tuple[Fraction, Fraction]] = {}
    for part in live(builder.nodes, [number]):
        low, high = _range(builder, part, ranges)
        least = Fraction(0) if builder.nonnegative[part] else -INFINITE
        ranges[part] = max(low, least), min(high, INFINITE)
    low = ranges[number][0]
    return low


def _range(builder: Builder, part: int, ranges: Mapping[int, tuple[Fraction, Fraction]]) -> tuple[Fraction, Fraction]:
    operation, arguments, _ = builder.nodes[part]
    inner = [ranges[argument] for argument in arguments]
    value = builder.value(part)
    if value is not None:
        return value, value
    if operation in {"sin", "cos", "erf"}:
        return Fraction(-1), Fraction(1)
    if operation == "neg":
        return -inner[0][1], -inner[0][0]
    if operation in {"min", "max"}:
        choose = min if operation == "min" else max
        return choose(inner[0][0], inner[1][0]), choose(inner[0][1], inner[1][1])
    if operation == "exp" or any(max(map(abs, ends)) >= INFINITE for ends in inner):
        half_open = operation == "add" and inner[0][0] > -INFINITE and inner[1][0] > -INFINITE
        low = inner[0][0] + inner[1][0] if half_open else -INFINITE
        if operation == "add" and inner[0][1] < INFINITE and inner[1][1] < INFINITE:
            return low, inner[0][1] + inner[1][1]
        positive = operation in {"mul", "div"} and all(ends[0] >= 0 for ends in inner)
        return (Fraction(0) if positive or operation == "exp" else low), INFINITE
    if operation == "add":
        return inner[0][0] + inner[1][0], inner[0][1] + inner[1][1]
    if operation == "mul":
        products = [a * b for a in inner[0] for b in inner[1]]
        return min(products), max(products)
    return -INFINITE, INFINITE
