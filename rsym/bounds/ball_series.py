"""Taylor series of nodes in balls: what a function of one parameter is on an interval, without its dependences.

Of f on [m - r, m + r] the coefficients c_k at m are known to the working precision, and the coefficient of the highest
order, taken over the whole interval, holds the remainder: f(m + h) lies in c_0 + ... + c_(n-1) h**(n-1) + R_n h**n.
A difference of equal functions so comes out as small as the precision allows, however wide the interval.

Source: Taylor models with a Lagrange remainder, after Moore (1966).
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, TypeAlias

from flint import arb_series

from rsym.bounds.ball_arithmetic import ONE, ZERO, arb, constant, ctx
from rsym.program.program import Node, live

__all__ = ["SeriesFunction", "arb", "series", "truncated"]

# A series of python-flint, which has no types.
Series: TypeAlias = Any


@contextmanager
def truncated(order: int, bits: int) -> Iterator[None]:
    """Series with coefficients of the orders 0 ... order, at a working precision.

    Examples
    --------
    >>> with truncated(2, 64):
    ...     print((1 / series(arb(1), 1)).coeffs())
    [1.00000000000000000, -1.00000000000000000, 1.00000000000000000]
    """
    before = ctx.prec, ctx.cap
    try:
        ctx.prec, ctx.cap = bits, order + 1
        yield
    finally:
        ctx.prec, ctx.cap = before


def series(*coefficients: Any) -> Series:
    """The series with these first coefficients and no others."""
    return arb_series(list(coefficients))


def first(value: Series) -> Any:
    """The coefficient of order 0."""
    return value[0]


def _power(a: Series, exponent: int) -> Series:
    return a**exponent


def _pow(a: Series, b: Series) -> Series | None:
    return (b * a.log()).exp() if first(a) > ZERO else None


def _root(a: Series) -> Series | None:
    return a.sqrt() if first(a) > ZERO else None


def _size(a: Series) -> Series | None:
    return a if first(a) > ZERO else -a if first(a) < ZERO else None


def _quotient(a: Series, b: Series) -> Series | None:
    return None if first(b).contains(ZERO) else a / b


def _angle(y: Series, x: Series) -> Series | None:
    return (y / x).atan() if first(x) > ZERO else None


def _normalised(f: Series, q: Series) -> Series | None:
    square = f * f + q
    return f / square.sqrt() if first(square) > ZERO else None


IMAGES: Mapping[str, Callable[..., Series | None]] = {
    "add": operator.add,
    "mul": operator.mul,
    "neg": operator.neg,
    "div": _quotient,
    "powi": _power,
    "pow": _pow,
    "sqrt": _root,
    "abs": _size,
    "sin": lambda a: a.sin(),
    "cos": lambda a: a.cos(),
    "exp": lambda a: a.exp(),
    "log": lambda a: a.log() if first(a) > ZERO else None,
    "atan2": _angle,
    "normalised": _normalised,
    "zero_with": lambda f, g: g,
}


class SeriesFunction:
    """Some nodes of a program of one input, made ready to be expanded at many places.

    ``function(place, order)`` gives the series of the outputs at a ball; None for an output that is not known to be
    analytic there, or is made with an operation that has no series.

    Examples
    --------
    >>> from rsym.program.builder import Builder
    >>> builder = Builder(("t",), ())
    >>> t = builder.input("t")
    >>> function = SeriesFunction(builder.nodes, [builder.sqrt(t), builder.div(builder.const(1), t)])
    >>> with truncated(2, 64):
    ...     root, inverse = function(arb(4))
    ...     [float(c) for c in root.coeffs()], function(arb(0, 1))
    ([2.0, 0.25, -0.015625], [None, None])
    """

    def __init__(self, nodes: Sequence[Node], outputs: Iterable[int]) -> None:
        self.outputs = tuple(outputs)
        self._steps = [(number, nodes[number]) for number in live(nodes, self.outputs)]

    def __call__(self, place: Any) -> list[Series | None]:
        """The series of the outputs at a ball, in the precision and to the order of `truncated`."""
        known: dict[int, Series | None] = {}
        parameter = series(place, ONE)
        for number, (operation, arguments, data) in self._steps:
            if operation == "input":
                known[number] = parameter
            elif operation == "const":
                known[number] = series(constant(data))
            else:
                operands = [known[argument] for argument in arguments]
                image = IMAGES.get(operation)
                extra = () if data is None else (data,)
                if image is None or any(one is None for one in operands):
                    known[number] = None
                else:
                    known[number] = image(*operands, *extra)
        return [known[number] for number in self.outputs]
