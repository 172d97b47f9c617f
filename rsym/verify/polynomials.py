"""Nodes that are polynomials: for these, divisibility and singular points are decided exactly."""

from __future__ import annotations

import math
from fractions import Fraction

import sympy as sp

from rsym.verify.local import Model

LARGEST = 120  # nodes of a program that is written out as a polynomial
HIGHEST = 32  # degree, beyond which dividing takes longer than it is worth


def polynomial_of(
    model: Model, number: int, roots: dict[sp.Symbol, sp.Expr] | None = None, *, free: bool = False
) -> sp.Expr | None:
    """The node as a polynomial of the coordinates with rational coefficients, if it is one of moderate size.

    With `roots`, square roots may stand in it too, as symbols, to which their radicands are added there. If `free`,
    everything else may too, as symbols that know nothing of each other: cos(pi/7), sqrt(1 - x), a letter that ranges.
    """
    if len(model.order(number)) > LARGEST:
        return None
    parts: dict[int, sp.Expr] = {}
    for part in model.order(number):
        operation, arguments, data = model.builder.nodes[part]
        inner = [parts[argument] for argument in arguments]
        if operation == "const" and isinstance(data, Fraction):
            parts[part] = sp.Rational(data.numerator, data.denominator)
        elif operation == "input":
            value = _opaque(part) if free else _fixed(model, str(data))
            if value is None:
                return None
            parts[part] = value
        elif operation == "add":
            parts[part] = inner[0] + inner[1]
        elif operation == "mul":
            parts[part] = inner[0] * inner[1]
        elif operation == "neg":
            parts[part] = -inner[0]
        elif operation == "powi":
            parts[part] = inner[0] ** int(str(data))
        elif operation == "div" and inner[1].is_Rational and inner[1] != 0:
            parts[part] = inner[0] / inner[1]
        elif operation == "sqrt" and roots is not None:
            parts[part] = sp.Dummy(real=True)
            roots[parts[part]] = inner[0]
        elif free:
            parts[part] = _opaque(part)
        else:
            return None
    return parts[number]


def _opaque(part: int) -> sp.Expr:
    return sp.Symbol(f"node {part}", real=True)


def _fixed(model: Model, name: str) -> sp.Expr | None:
    """A coordinate as a symbol, a letter as its number; None for a letter that ranges."""
    if name in model.builder.coordinates:
        return sp.Symbol(name, real=True)
    low, high = model.letters[name]
    return sp.Rational(low.numerator, low.denominator) if low == high else None


def multiplicity(model: Model, number: int, divisor: int, most: int = 4) -> float:
    """How often one polynomial divides another, up to `most`, infinitely often where that is zero. Remembered.

    0 where they are no polynomials.
    """
    key = number, divisor
    if key not in model.multiplicities:
        model.multiplicities[key] = _multiplicity(model, number, divisor, most)
    return model.multiplicities[key]


def _multiplicity(model: Model, number: int, divisor: int, most: int) -> float:
    if model.builder.value(number) == 0:
        return math.inf
    written = polynomial_of(model, number)
    if written is None:
        return 0
    symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
    dividend = sp.Poly(written, *symbols, domain=sp.QQ)
    if dividend.is_zero:
        return math.inf
    divided_by = polynomial_of(model, divisor)
    if divided_by is None:
        return 0
    unit = sp.Poly(divided_by, *symbols, domain=sp.QQ)
    if unit.total_degree() < 1 or dividend.total_degree() > HIGHEST:
        return 0
    count = 0
    while count < most:
        dividend, remainder = sp.div(dividend, unit)
        if not remainder.is_zero:
            return count
        count += 1
    return most


def same_zeros(model: Model, a: int, b: int, *, free: bool = False) -> bool:
    """Whether two nodes are polynomials that are equal or opposite.

    If `free`, also polynomials of what is itself none: then they are so wherever both are defined.
    """
    p, q = polynomial_of(model, a, free=free), polynomial_of(model, b, free=free)
    return p is not None and q is not None and 0 in (sp.expand(p - q), sp.expand(p + q))
