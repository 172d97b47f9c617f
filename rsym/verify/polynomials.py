"""Nodes that are polynomials: for these, divisibility and singular points are decided exactly."""

from __future__ import annotations

from fractions import Fraction

import sympy as sp

from rsym.verify.local import Model

LARGEST = 120  # nodes of a program that is written out as a polynomial
HIGHEST = 32  # degree, beyond which dividing takes longer than it is worth


def polynomial_of(model: Model, number: int) -> sp.Expr | None:
    """The node as a polynomial of the coordinates with rational coefficients, if it is one of moderate size."""
    if len(model.order(number)) > LARGEST:
        return None
    parts: dict[int, sp.Expr] = {}
    for part in model.order(number):
        operation, arguments, data = model.builder.nodes[part]
        inner = [parts[argument] for argument in arguments]
        if operation == "const" and isinstance(data, Fraction):
            parts[part] = sp.Rational(data.numerator, data.denominator)
        elif operation == "input":
            value = _fixed(model, str(data))
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
        else:
            return None
    return parts[number]


def _fixed(model: Model, name: str) -> sp.Expr | None:
    """A coordinate as a symbol, a letter as its number; None for a letter that ranges."""
    if name in model.builder.coordinates:
        return sp.Symbol(name, real=True)
    low, high = model.letters[name]
    return sp.Rational(low.numerator, low.denominator) if low == high else None


def multiplicity(model: Model, number: int, divisor: int, most: int = 4) -> int:
    """How often one polynomial divides another, up to `most`; 0 where they are no polynomials. Remembered."""
    key = number, divisor
    if key not in model.multiplicities:
        model.multiplicities[key] = _multiplicity(model, number, divisor, most)
    return model.multiplicities[key]


def _multiplicity(model: Model, number: int, divisor: int, most: int) -> int:
    if model.builder.value(number) == 0:
        return most
    pair = polynomial_of(model, number), polynomial_of(model, divisor)
    if pair[0] is None or pair[1] is None:
        return 0
    symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
    dividend, unit = (sp.Poly(expression, *symbols, domain=sp.QQ) for expression in pair)
    if unit.total_degree() < 1 or dividend.total_degree() > HIGHEST:
        return 0
    count = 0
    while count < most and not dividend.is_zero:
        dividend, remainder = sp.div(dividend, unit)
        if not remainder.is_zero:
            return count
        count += 1
    return most


def same_zeros(model: Model, a: int, b: int) -> bool:
    """Whether two nodes are polynomials that are equal or opposite."""
    p, q = polynomial_of(model, a), polynomial_of(model, b)
    return p is not None and q is not None and 0 in (sp.expand(p - q), sp.expand(p + q))
