"""Choices that are a minimum or a maximum, however they are written.

Where a condition has the sign of the difference of the values that it chooses from, as in Piecewise((a, a < b), (b,
True)), the choice is min(a, b). So is half of a + b - |a - b|, and a + b - sqrt(a**2 + b**2) for the sign. As they
stand, bounds of a and of b are lost in them, and the sign where both are small.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import product
from math import isqrt

import sympy as sp

from rsym.logic.steps import is_partial
from rsym.logic.stripping import Signed, multiples, total
from rsym.program.builder import Builder
from rsym.program.lowering import lower_all
from rsym.program.program import live
from rsym.program.raising import raised, raised_node

MOST_PARTS = 256  # of what is multiplied out: some hundredths of a second
HIGHEST = 12  # degree of a polynomial


def sides(builder: Builder, choice: int) -> tuple[int, int, int]:
    """What decides a choice, and what it is where that is positive and where it is negative.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> sides(b, b.make("min", x, y)) == (b.sub(x, y), y, x)
    True
    """
    operation, (first, *rest), _ = builder.nodes[choice]
    if operation == "abs":
        return first, first, builder.neg(first)
    condition = builder.sub(first, rest[0])
    if operation == "select":
        return condition, rest[1], rest[2]
    return (condition, first, rest[0]) if operation == "max" else (condition, rest[0], first)


def chosen_by_size(builder: Builder, number: int, sign_like: Callable[[int], Signed]) -> Signed | None:
    """The minimum or maximum of the sign and the zeros of a node that is written as a choice or a sum; else None.

    What `sign_like` gives of a node has its sign and its zeros.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> least = Signed(b.make("min", x, y))
    >>> chosen_by_size(b, b.select(y, x, x, y), Signed) == least
    True
    >>> root = b.sqrt(b.add(b.square(x), b.square(y)))
    >>> chosen_by_size(b, b.sub(root, b.add(x, y)), Signed) == Signed(b.make("max", *map(b.neg, (x, y))))
    True
    >>> made = chosen_by_size(b, b.sub(b.add(x, y), b.abs(b.sub(x, y))), Signed)
    >>> made == Signed(b.make("min", *(b.mul(b.const(2), one) for one in (y, x))))
    True
    """
    if number not in builder.chosen:
        builder.chosen[number] = _chosen(builder, number, sign_like)
    made = builder.chosen[number]
    return None if made is None else Signed(made)


def _chosen(builder: Builder, number: int, sign_like: Callable[[int], Signed]) -> int | None:
    operation = builder.nodes[number].operation
    if operation not in {"select", "add"} or len(live(builder.nodes, [number])) > MOST_PARTS:
        return None
    if operation == "select":
        return _of_condition(builder, number, sign_like)
    terms, constant = multiples(builder, number)
    for part, times in terms.items():
        operation, arguments, _ = builder.nodes[part]
        if operation not in {"abs", "sqrt"} or not times or builder.uniform[part]:
            continue
        rest = total(builder, {one: share for one, share in terms.items() if one != part}, constant)
        both = (_beside_size if operation == "abs" else _beside_root)(builder, rest, times, arguments[0])
        if both and not is_partial(builder, *both, rest):
            return builder.make("max" if times > 0 else "min", *both)
    return None


def _of_condition(builder: Builder, number: int, sign_like: Callable[[int], Signed]) -> int | None:
    condition, *values = sides(builder, number)
    for above, below in (values, [sign_like(value).made(builder) for value in values]):
        ratio = _ratio(builder, *(sign_like(part).made(builder) for part in (builder.sub(above, below), condition)))
        if ratio and not is_partial(builder, condition, above, below):
            return builder.make("max" if ratio > 0 else "min", above, below)
    return None


def _beside_size(builder: Builder, rest: int, times: Fraction, inside: int) -> tuple[int, int] | None:
    """The two sums of which rest + times*|inside| is one, if terms cancel in both."""
    shared = {*live(builder.nodes, [rest])} & {*live(builder.nodes, [inside])}
    if all(builder.uniform[part] for part in shared):
        return None
    beside, size = (_expanded(builder, part) for part in (rest, builder.mul(builder.const(times), inside)))
    both = [beside + size, beside - size]
    terms = {**beside.as_coefficients_dict(), **size.as_coefficients_dict()}
    if max(len(one.as_coefficients_dict()) for one in both) >= len(terms):
        return None
    first, second = _lowered(builder, *both)
    return first, second


def _beside_root(builder: Builder, rest: int, times: Fraction, inside: int) -> tuple[int, int] | None:
    """The a and b of a rest a + b beside the root of a*a + b*b - 2*alpha*a*b with -1 < alpha <= 1.

    What is under the root less the square of the rest is -2*(1 + alpha)*a*b: the sum has the sign of max(a, b), the
    difference that of min(a, b).
    """
    terms, _ = multiples(builder, inside)
    squares = {base: terms[part] for part in sorted(terms) if (base := _squared(builder, part)) is not None}
    sizes = [_rational_root(times**2 * square) for square in squares.values()]
    if len(sizes) != 2 or not all(sizes):
        return None
    bases = [builder.mul(builder.const(size), base) for size, base in zip(sizes, squares, strict=True)]
    for signs in product((1, -1), repeat=2):
        first, second = (Signed(base, sign).made(builder) for base, sign in zip(bases, signs, strict=True))
        if _expanded(builder, builder.sub(rest, builder.add(first, second))) == 0:
            squared = builder.add(builder.mul(first, first), builder.mul(second, second))
            crossed = builder.sub(builder.mul(builder.const(times**2), inside), squared)
            ratio = _ratio(builder, crossed, builder.mul(first, second))
            return None if ratio is None or not -2 <= ratio < 2 else (first, second)
    return None


def _ratio(builder: Builder, one: int, other: int) -> sp.Rational | None:
    """How many times a node is another one; None if it is no multiple."""
    first, second = (_expanded(builder, part) for part in (one, other))
    leading, times = sp.Add.make_args(second)[0].as_coeff_Mul()[::-1]
    ratio = first.as_coefficients_dict()[leading] / times if times else None
    return ratio if ratio is not None and sp.expand(first - ratio * second) == 0 else None


def _expanded(builder: Builder, number: int) -> sp.Expr:
    """A node as a polynomial of those in it that are none themselves, or of a high degree, as symbols."""
    made: dict[int, sp.Expr] = {}
    degrees: dict[int, int] = {}
    for part in live(builder.nodes, [number]):
        node = builder.nodes[part]
        inner = [degrees[argument] for argument in node.arguments]
        degrees[part] = HIGHEST + 1
        if node.operation in {"const", "input", "add", "neg"}:
            degrees[part] = max(inner, default=int(node.operation == "input"))
        elif node.operation == "mul":
            degrees[part] = sum(inner)
        elif node.operation == "powi" and isinstance(node.data, int) and node.data > 0:
            degrees[part] = inner[0] * node.data
        if degrees[part] <= HIGHEST:
            made[part] = raised_node(node, [made[argument] for argument in node.arguments])
        else:
            made[part], degrees[part] = sp.Symbol(str(part)), 1
    return sp.expand(made[number])


def _lowered(builder: Builder, *polynomials: sp.Expr) -> list[int]:
    """The nodes of polynomials of nodes."""
    symbols = sorted(set().union(*(one.free_symbols for one in polynomials)), key=str)
    nodes = {symbol: raised(builder.nodes, int(symbol.name)) for symbol in symbols if symbol.name.isdigit()}
    return lower_all(builder, [one.xreplace(nodes) for one in polynomials])


def _squared(builder: Builder, number: int) -> int | None:
    operation, arguments, data = builder.nodes[number]
    is_square = (operation == "mul" and arguments[0] == arguments[1]) or (operation == "powi" and data == 2)
    return arguments[0] if is_square else None


def _rational_root(square: Fraction) -> Fraction:
    """The root of the square of a rational number; 0 of any other."""
    root = Fraction(isqrt(max(square.numerator, 0)), isqrt(square.denominator))
    return root if root * root == square else Fraction(0)
