"""Leaves that are singular along curves by their form alone, as others of the same sign that are not.

An odd power rises with what it is a power of, so u**n + c*v**n, with c not negative, has the sign of u + c**(1/n)*v:
along u = v = 0, where all slopes of the first vanish, the second has some. A root is infinitely steep where its domain
ends, so that next to a curve that touches that end nothing is a graph: a + b*r with r = sqrt(w) needs no root, for

    a + b*r > 0  where two of a, b and d are positive, or a, d and -b, or -a, b and -d,  d = a**2 - b**2*w.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping
from fractions import Fraction
from typing import NamedTuple, TypeAlias

from rsym.logic.stripping import Signed, sum_terms
from rsym.program.builder import Builder
from rsym.program.program import live

MOST_POWER = 4  # of a sum with roots that is multiplied out
Expanded: TypeAlias = Mapping[frozenset[int], int]  # by the roots that are factors


def odd_powers(builder: Builder, number: int) -> Signed | None:
    """What has the sign of a sum u**n + c*v**n with an odd n: u + c**(1/n)*v; else None.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> u, v = b.input("x"), b.input("y")
    >>> odd_powers(b, b.sub(b.mul(b.const(2), b.powi(v, 3)), b.powi(u, 3))) == Signed(
    ...     b.sub(u, b.mul(b.make("pow", b.const(2), b.const(Fraction(1, 3))), v)), -1
    ... )
    True
    """
    found = sum_terms(builder, number)
    if found is None or found[1] or len(found[0]) < 2:
        return None
    terms = {term: (times, _factors(builder, term)) for term, times in found[0].items()}
    for term, (times, own) in terms.items():
        (base, n), *more = own.items()
        if more or n % 2 == 0 or n == 1:
            continue
        others = [(share / times, factors) for part, (share, factors) in terms.items() if part != term]
        shared = [v for v in others[0][1] if all(factors[v] >= n for _, factors in others)]
        for v in shared:
            for sign in (1, -1):
                c = _sum(builder, [(sign * share, factors - Counter({v: n})) for share, factors in others])
                if builder.nonnegative[c]:
                    root = builder.make("pow", c, builder.const(Fraction(1, n)))
                    turn = builder.add if sign > 0 else builder.sub
                    return Signed(turn(base, builder.mul(root, v)), 1 if times > 0 else -1)
    return None


def _factors(builder: Builder, number: int) -> Counter[int]:
    """A product as powers of its factors."""
    found: Counter[int] = Counter()
    stack = [(number, 1)]
    while stack:
        part, times = stack.pop()
        operation, arguments, data = builder.nodes[part]
        if operation == "mul":
            stack += [(argument, times) for argument in arguments]
        elif operation == "powi" and isinstance(data, int) and data > 0:
            stack.append((arguments[0], times * data))
        else:
            found[part] += times
    return found


def _sum(builder: Builder, terms: list[tuple[Fraction, Counter[int]]]) -> int:
    total = builder.const(0)
    for times, factors in terms:
        part = builder.const(times)
        for factor, power in factors.items():
            part = builder.mul(part, builder.powi(factor, power))
        total = builder.add(total, part)
    return total


class Parted(NamedTuple):
    """Nodes a, b and d = a**2 - b**2*w of a node a + b*sqrt(w)."""

    plain: int
    factor: int
    square: int


def root_parted(builder: Builder, number: int, walls: Collection[int]) -> Parted | None:
    """A node by a root that ends at one of the walls, where it is a polynomial of such roots; else None.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> made = root_parted(b, b.sub(b.sqrt(b.abs(x)), y), {x})
    >>> made == Parted(b.neg(y), b.const(1), b.sub(b.square(y), x))
    True
    """
    roots = {}
    for part in live(builder.nodes, [number]):
        operation, arguments, _ = builder.nodes[part]
        if operation == "sqrt" and builder.nodes[arguments[0]].operation == "abs":
            (wall,) = builder.nodes[arguments[0]].arguments
            if wall in walls:
                roots[part] = wall
    if any(roots.keys() & set(live(builder.nodes, [wall])) for wall in roots.values()):
        return None
    found = _expanded(builder, number, roots) if roots else None
    if found is None or not (present := sorted(frozenset().union(*found))):
        return None
    root = present[0]
    plain = {key: part for key, part in found.items() if root not in key}
    factor = {key - {root}: part for key, part in found.items() if root in key}
    less: Expanded = {frozenset(): builder.neg(roots[root])}
    square = _times(builder, roots, factor, _times(builder, roots, factor, less))
    square = _plus(builder, _times(builder, roots, plain, plain), square)
    return Parted(*(_contracted(builder, part) for part in (plain, factor, square)))


def _expanded(builder: Builder, number: int, roots: Mapping[int, int]) -> Expanded | None:
    """A node as a polynomial of roots whose squares are known; None where it is none, or of a high power."""
    operation, arguments, data = builder.nodes[number]
    if number in roots:
        return {frozenset({number}): builder.const(1)}
    if not roots.keys() & set(live(builder.nodes, [number])):
        return {frozenset(): number}
    if operation not in {"neg", "add", "mul", "powi"} or (isinstance(data, int) and data > MOST_POWER):
        return None
    parts = [_expanded(builder, argument, roots) for argument in arguments]
    inner = [part for part in parts if part is not None]
    if len(inner) < len(parts):
        return None
    if operation == "neg":
        return {key: builder.neg(part) for key, part in inner[0].items()}
    if operation == "add":
        return _plus(builder, *inner)
    made = inner[0]
    for other in inner[1:] if operation == "mul" else inner * (int(data) - 1 if isinstance(data, int) else 0):
        made = _times(builder, roots, made, other)
    return made


def _plus(builder: Builder, one: Expanded, other: Expanded) -> Expanded:
    zero = builder.const(0)
    return {key: builder.add(one.get(key, zero), other.get(key, zero)) for key in {**one, **other}}


def _times(builder: Builder, roots: Mapping[int, int], one: Expanded, other: Expanded) -> Expanded:
    made: dict[frozenset[int], int] = {}
    for first, a in one.items():
        for second, b in other.items():
            part = builder.mul(a, b)
            for root in sorted(first & second):
                part = builder.mul(part, roots[root])
            key = first ^ second
            made[key] = builder.add(made[key], part) if key in made else part
    return made


def _contracted(builder: Builder, parts: Expanded) -> int:
    total = builder.const(0)
    for key, part in parts.items():
        for root in sorted(key):
            part = builder.mul(part, root)
        total = builder.add(total, part)
    return total
