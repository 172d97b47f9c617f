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
from rsym.logic.stripping import Signed, multiples
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
    terms, _ = multiples(builder, number)
    for part, times in terms.items():
        operation, arguments, _ = builder.nodes[part]
        if operation in {"abs", "sqrt"} and times and not builder.uniform[part]:
            both = (_beside_size if operation == "abs" else _beside_root)(builder, number, part, times, arguments[0])
            if both:
                return builder.make("max" if times > 0 else "min", *both)
    return None


def _of_condition(builder: Builder, number: int, sign_like: Callable[[int], Signed]) -> int | None:
    condition, *values = sides(builder, number)
    for above, below in (values, [sign_like(value).made(builder) for value in values]):
        compared = (sign_like(part).made(builder) for part in (builder.sub(above, below), condition))
        ratio = _ratio(*(_expanded(builder, part) for part in compared))
        if ratio and not is_partial(builder, condition, above, below):
            return builder.make("max" if ratio > 0 else "min", above, below)
    return None


def _beside_size(builder: Builder, number: int, part: int, times: Fraction, inside: int) -> tuple[int, int] | None:
    """The two sums of which rest + times*|inside| is the larger or the smaller one, if terms cancel in both."""
    beside = [one for one in multiples(builder, number)[0] if one != part]
    if all(builder.uniform[one] for one in {*live(builder.nodes, beside)} & {*live(builder.nodes, [inside])}):
        return None
    rest, size = _without(builder, number, part, times), sp.Rational(times) * _expanded(builder, inside)
    both = [sp.expand(rest + size), sp.expand(rest - size)]
    terms = {**rest.as_coefficients_dict(), **sp.expand(size).as_coefficients_dict()}
    if max(len(one.as_coefficients_dict()) for one in both) >= len(terms) or is_partial(builder, number):
        return None
    symbols = sorted(set().union(*(one.free_symbols for one in both)), key=str)
    nodes = {symbol: raised(builder.nodes, int(symbol.name)) for symbol in symbols if symbol.name.isdigit()}
    first, second = lower_all(builder, [one.xreplace(nodes) for one in both])
    return first, second


def _beside_root(builder: Builder, number: int, part: int, times: Fraction, inside: int) -> tuple[int, int] | None:
    """The a and b of a + b + times*root, where the square of times*root is a*a + b*b - 2*alpha*a*b, -1 < alpha <= 1.

    That less (a + b)**2 is -2*(1 + alpha)*a*b: the sum has the sign of max(a, b), the difference that of min(a, b).
    """
    terms, _ = multiples(builder, inside)
    squares = {base: terms[one] for one in sorted(terms) if (base := _squared(builder, one)) is not None}
    sizes = [_rational_root(times**2 * square) for square in squares.values()]
    if len(sizes) != 2 or not all(sizes) or is_partial(builder, *squares):
        return None
    rest = _without(builder, number, part, times)
    for signs in product((1, -1), repeat=2):
        shares = [sign * size for sign, size in zip(signs, sizes, strict=True)]
        first, second = (
            sp.Rational(share) * _expanded(builder, base) for share, base in zip(shares, squares, strict=True)
        )
        if sp.expand(rest - first - second) == 0:
            square = sp.Rational(times) ** 2 * _expanded(builder, inside)
            ratio = _ratio(sp.expand(square - first**2 - second**2), sp.expand(first * second))
            legal = ratio is not None and -2 <= ratio < 2
            one, other = (builder.mul(builder.const(share), base) for share, base in zip(shares, squares, strict=True))
            return (one, other) if legal else None
    return None


def _ratio(one: sp.Expr, other: sp.Expr) -> sp.Rational | None:
    """How many times a sum is another one; None if it is no multiple."""
    leading, times = sp.Add.make_args(other)[0].as_coeff_Mul()[::-1]
    ratio = one.as_coefficients_dict()[leading] / times if times else None
    return ratio if ratio is not None and sp.expand(one - ratio * other) == 0 else None


def _without(builder: Builder, number: int, part: int, times: Fraction) -> sp.Expr:
    """A sum without so many times a part of it."""
    return sp.expand(_expanded(builder, number) - sp.Rational(times) * sp.Symbol(str(part)))


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


def _squared(builder: Builder, number: int) -> int | None:
    operation, arguments, data = builder.nodes[number]
    is_square = (operation == "mul" and arguments[0] == arguments[1]) or (operation == "powi" and data == 2)
    return arguments[0] if is_square else None


def _rational_root(square: Fraction) -> Fraction:
    """The root of the square of a rational number; 0 of any other."""
    root = Fraction(isqrt(max(square.numerator, 0)), isqrt(square.denominator))
    return root if root * root == square else Fraction(0)
