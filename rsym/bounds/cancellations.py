"""Slopes whose terms cancel, as those of an involute do: a - b is too wide where both go to infinity together.

With t = sqrt(A) the function c*atan(t/c) - t, as far from its zero as an involute is from its circle, has the slope

    w*c**2/(A + c**2) - w = -w*A/(A + c**2) = -n*t/(A + c**2),    w = n/t

whose left side knows nothing near t = 0, where w has no bound, and its right side is 0 there.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from fractions import Fraction
from functools import reduce

from rsym.program.builder import Builder


def cancelled(b: Builder, number: int) -> int | None:
    """A node equal to a sum, wherever that is defined, in which such terms have cancelled; None without any.

    Examples
    --------
    >>> b = Builder(("n", "A"), ())
    >>> n, A = b.input("n"), b.input("A")
    >>> w = b.div(n, b.sqrt(A))
    >>> found = cancelled(b, b.sub(b.div(b.mul(b.const(4), w), b.add(A, b.const(4))), w))
    >>> found == b.neg(b.div(b.mul(n, b.sqrt(A)), b.add(A, b.const(4))))
    True
    """
    terms = list(_terms(b, number))
    for whole, node in terms:
        if b.nodes[node].operation == "div":
            above, below = b.nodes[node].arguments
            ((factor, w), *more) = _terms(b, above, whole)
            for other in [one for one, same in terms if same == w and not more]:
                left = _left(b, below, w, factor, other)
                if left is not None:
                    rest = [pair for pair in terms if pair not in ((whole, node), (other, w))]
                    return reduce(b.add, (b.mul(*pair) for pair in [(other, left), *rest]))
    return None


def _terms(b: Builder, number: int, factor: int | None = None) -> Iterator[tuple[int, int]]:
    """What a node is the sum of, each a node and a factor that depends on letters alone."""
    open_terms = [(b.const(1) if factor is None else factor, number)]
    while open_terms:
        factor, node = open_terms.pop()
        operation, arguments, _ = b.nodes[node]
        uniform = [argument for argument in arguments if b.uniform[argument]]
        if operation == "add":
            open_terms += [(factor, argument) for argument in arguments]
        elif operation == "neg":
            open_terms.append((b.neg(factor), arguments[0]))
        elif operation == "mul" and len(uniform) == 1:
            (rest,) = set(arguments) - set(uniform)
            open_terms.append((b.mul(factor, uniform[0]), rest))
        else:
            yield factor, node


def _left(b: Builder, below: int, w: int, whole: int, other: int) -> int | None:
    """The node n*t/(A + C), A = t**2, where `whole`*w/(A + C) + `other`*w is `other` times it, w = n/t; else None."""
    if b.nodes[below].operation != "add" or b.nodes[w].operation != "div":
        return None
    n, t = b.nodes[w].arguments
    squares = {b.square(t), *(b.nodes[t].arguments if b.nodes[t].operation == "sqrt" else ())}
    for square, constant in (b.nodes[below].arguments, b.nodes[below].arguments[::-1]):
        if square in squares and _factors(b, b.neg(whole)) == _factors(b, other, constant):
            return b.div(b.mul(n, t), below)
    return None


def _factors(b: Builder, *numbers: int) -> tuple[Fraction, Counter[int]]:
    """The number and the other nodes that a product is made of, in whatever order."""
    value, nodes, rest = Fraction(1), list(numbers), Counter[int]()
    while nodes:
        number = nodes.pop()
        operation, arguments, _ = b.nodes[number]
        known = b.value(number)
        if operation in {"neg", "mul"}:
            value *= -1 if operation == "neg" else 1
            nodes += arguments
        elif known is not None:
            value *= known
        else:
            rest[number] += 1
    return value, rest
