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
    sums = _Sums(builder)
    if operation == "select":
        return sums.of_condition(number, sign_like)
    for part, times in multiples(builder, number)[0].items():
        operation = builder.nodes[part].operation
        if operation in {"abs", "sqrt"} and times and not builder.uniform[part]:
            both = (sums.beside_size if operation == "abs" else sums.beside_root)(number, part, times)
            if both:
                return builder.make("max" if times > 0 else "min", *both)
    return None


class _Sums:
    """Nodes as polynomials of those in them that are none; these are symbols, named by a node."""

    def __init__(self, builder: Builder) -> None:
        self.builder = builder
        self._symbols: dict[tuple[object, ...], sp.Symbol] = {}

    def of_condition(self, number: int, sign_like: Callable[[int], Signed]) -> int | None:
        """The minimum or maximum that a choice by a condition is."""
        builder = self.builder
        condition, *values = sides(builder, number)
        pairs = [(values[0], values[1]), (sign_like(values[0]).made(builder), sign_like(values[1]).made(builder))]
        for above, below in dict.fromkeys(pairs):
            compared = (sign_like(part).made(builder) for part in (builder.sub(above, below), condition))
            ratio = _ratio(*(self._expanded(part) for part in compared))
            if ratio and not is_partial(builder, condition, above, below):
                return builder.make("max" if ratio > 0 else "min", above, below)
        return None

    def beside_size(self, number: int, part: int, times: Fraction) -> tuple[int, int] | None:
        """The two sums of which rest + times*|inside| is the larger or the smaller one, if terms cancel in both."""
        builder, (inside,) = self.builder, self.builder.nodes[part].arguments
        beside = [one for one in multiples(builder, number)[0] if one != part]
        if all(builder.uniform[one] for one in {*live(builder.nodes, beside)} & {*live(builder.nodes, [inside])}):
            return None
        rest, size = self._without(number, part, times), sp.Rational(times) * self._expanded(inside)
        both = [sp.expand(rest + size), sp.expand(rest - size)]
        terms = {**rest.as_coefficients_dict(), **sp.expand(size).as_coefficients_dict()}
        if max(len(one.as_coefficients_dict()) for one in both) >= len(terms) or is_partial(builder, number):
            return None
        symbols = set().union(*(one.free_symbols for one in both)) & {*self._symbols.values()}
        nodes = {symbol: raised(builder.nodes, int(symbol.name)) for symbol in symbols}
        first, second = lower_all(builder, [one.xreplace(nodes) for one in both])
        return first, second

    def beside_root(self, number: int, part: int, times: Fraction) -> tuple[int, int] | None:
        """The a and b of a + b + times*root; the square of that product is a*a + b*b - 2*alpha*a*b, -1 < alpha <= 1.

        It less (a + b)**2 is -2*(1 + alpha)*a*b: the sum has the sign of max(a, b), the difference that of min(a, b).
        """
        builder = self.builder
        terms, constant = multiples(builder, builder.nodes[part].arguments[0])
        squares = {one: base for one in sorted(terms) if (base := _squared(builder, one)) is not None}
        sizes = [_rational_root(times**2 * terms[one]) for one in squares]
        bases = list(squares.values())
        if len(sizes) != 2 or not all(sizes) or is_partial(builder, *bases):
            return None
        crossed = sp.Rational(constant) + sum(
            sp.Rational(share) * self._expanded(one) for one, share in terms.items() if one not in squares
        )
        rest, polynomials = self._without(number, part, times), [self._expanded(base) for base in bases]
        for signs in product((1, -1), repeat=2):
            shares = [sign * size for sign, size in zip(signs, sizes, strict=True)]
            first, second = (sp.Rational(share) * one for share, one in zip(shares, polynomials, strict=True))
            if sp.expand(rest - first - second) == 0:
                ratio = _ratio(sp.expand(sp.Rational(times) ** 2 * crossed), sp.expand(first * second))
                made = (builder.mul(builder.const(share), base) for share, base in zip(shares, bases, strict=True))
                return None if ratio is None or not -2 <= ratio < 2 else (next(made), next(made))
        return None

    def _without(self, number: int, part: int, times: Fraction) -> sp.Expr:
        """A sum without so many times a part of it."""
        return sp.expand(self._expanded(number) - sp.Rational(times) * self._expanded(part))

    def _expanded(self, number: int) -> sp.Expr:
        nodes = self.builder.nodes
        made: dict[int, sp.Expr] = {}
        degrees: dict[int, int] = {}
        for part in live(nodes, [number]):
            operation, arguments, data = nodes[part]
            inner, below = [degrees[argument] for argument in arguments], [made[argument] for argument in arguments]
            degrees[part] = HIGHEST + 1
            if operation in {"const", "input", "add", "neg"}:
                degrees[part] = max(inner, default=int(operation == "input"))
            elif operation == "mul":
                degrees[part] = sum(inner)
            elif operation == "powi" and isinstance(data, int) and data > 0:
                degrees[part] = inner[0] * data
            if degrees[part] <= HIGHEST:
                made[part] = raised_node(nodes[part], below)
            else:  # the same of the same, however that is written
                same = (operation, data, *map(sp.expand, below))
                made[part], degrees[part] = self._symbols.setdefault(same, sp.Symbol(str(part))), 1
        return sp.expand(made[number])


def _ratio(one: sp.Expr, other: sp.Expr) -> sp.Rational | None:
    """How many times a sum is another one; None if it is no multiple."""
    leading, times = sp.Add.make_args(other)[0].as_coeff_Mul()[::-1]
    ratio = one.as_coefficients_dict()[leading] / times if times else None
    return ratio if ratio is not None and sp.expand(one - ratio * other) == 0 else None


def _squared(builder: Builder, number: int) -> int | None:
    """What a node is the square of by its form; SymPy squares the values of a choice."""
    operation, arguments, data = builder.nodes[number]
    if operation == "select":
        first, second = (_squared(builder, value) for value in arguments[2:])
        return None if first is None or second is None else builder.step(arguments[0], arguments[1], first, second)
    is_square = (operation == "mul" and arguments[0] == arguments[1]) or (operation == "powi" and data == 2)
    return arguments[0] if is_square else number if operation == "undefined" else None


def _rational_root(square: Fraction) -> Fraction:
    """The root of the square of a rational number; 0 of any other."""
    root = Fraction(isqrt(max(square.numerator, 0)), isqrt(square.denominator))
    return root if root * root == square else Fraction(0)
