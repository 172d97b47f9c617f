"""Real constants: enclosed by balls, and proved to be zero where symbols can."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import sympy as sp

from rsym.bounds.balls import arb, ctx, enclose_nodes, root, square
from rsym.program.builder import Builder
from rsym.program.lowering import lower

# A zero that is no zero is told apart unless it is below 10^-70.
BITS = 256
# The minimal polynomial of a sum of four roots takes 0.2 s; sp.simplify and sp.trigsimp may take minutes.
MOST_ROOTS = 4
# Sines of larger multiples of an angle are polynomials of some thousand operations.
MOST_ANGLES = 12


def exact(expression: sp.Expr) -> sp.Expr:
    """The expression with every float replaced by its exact binary value.

    Examples
    --------
    >>> exact(sp.sympify(0.25) * sp.pi)
    pi/4
    """
    floats = expression.atoms(sp.Float)
    return expression.xreplace({number: sp.Rational(number) for number in floats})


def enclosed(constant: sp.Expr) -> Any | None:
    """A ball that holds a real constant; None where it is undefined, the whole line where nothing is known.

    Examples
    --------
    >>> ball = enclosed(sp.sin(sp.Rational(1, 3)) * sp.pi)
    >>> round(float(ball.mid()), 9), float(ball.rad()) < 1e-70
    (1.027912456, True)
    """
    if constant.has(sp.nan, sp.zoo, sp.oo, sp.I):
        return None
    with precise():
        builder = Builder((), ())
        number = lower(builder, constant)
        return enclose_nodes(builder.nodes, range(number + 1), {})[number]


@contextmanager
def precise() -> Iterator[None]:
    """Ball arithmetic with 256 bits.

    Examples
    --------
    >>> with precise():
    ...     digits = arb.pi().rel_accuracy_bits()
    >>> digits > 250
    True
    """
    before = ctx.prec
    try:
        ctx.prec = BITS
        yield
    finally:
        ctx.prec = before


def vanishes(constant: sp.Expr) -> bool | None:
    """Whether a real constant is zero, proved either way; None if it is not known.

    It is not zero if its ball excludes zero. It is zero if the numerator is, once expanded with sin^2 = 1 - cos^2, or
    if its minimal polynomial is x.

    Examples
    --------
    >>> vanishes(sp.sqrt(2) * sp.sqrt(3) - sp.sqrt(6)), vanishes(sp.sqrt(2) - sp.Rational(7, 5))
    (True, False)
    >>> vanishes(sp.cos(sp.pi / 7) ** 2 + sp.sin(sp.pi / 7) ** 2 - 1)
    True
    """
    if constant.is_Rational:
        return bool(constant == 0)
    ball = enclosed(constant)
    if ball is None:
        return None
    if not ball.contains(arb(0)):
        return False
    if not ball.is_finite():
        return None
    if _reduced(constant) == 0:
        return True
    numerator = sp.expand(constant)
    roots = numerator.atoms(sp.Function) | {power for power in numerator.atoms(sp.Pow) if not power.exp.is_Integer}
    if not numerator.is_algebraic or len(roots) > MOST_ROOTS:
        return None
    # A number that is zero has the minimal polynomial x.
    return True if sp.minimal_polynomial(numerator, polys=True).all_coeffs() == [1, 0] else None


def _reduced(constant: sp.Expr) -> sp.Expr:
    """The numerator of a finite constant, expanded; zero if the constant is zero by algebra and sin^2 + cos^2 = 1."""
    quotient = _in_one_angle(constant.replace(sp.tan, lambda angle: sp.sin(angle) / sp.cos(angle)))
    numerator = sp.expand(sp.together(quotient).as_numer_denom()[0])
    return sp.expand(
        numerator.replace(
            lambda part: part.is_Pow and isinstance(part.base, sp.sin) and part.exp.is_Integer and part.exp > 1,
            lambda part: (1 - sp.cos(part.base.args[0]) ** 2) ** (part.exp // 2) * part.base ** (part.exp % 2),
        )
    )


def _in_one_angle(constant: sp.Expr) -> sp.Expr:
    """The sines and cosines of rational numbers by those of their common measure, an indeterminate here."""
    turning = constant.atoms(sp.sin, sp.cos)
    angles = {part.args[0] for part in turning if part.args[0].is_Rational}
    if len(angles) < 2 or max(map(abs, angles)) > MOST_ANGLES * sp.gcd(list(angles)):
        return constant
    measure, angle = sp.gcd(list(angles)), sp.Dummy("angle", real=True)
    multiples = {part: part.func(part.args[0] / measure * angle) for part in turning if part.args[0] in angles}
    return sp.expand_trig(constant.xreplace(multiples))


def norm(vector: Sequence[sp.Expr]) -> Any | None:
    """A ball that holds the length of a vector of real constants.

    Examples
    --------
    >>> norm((sp.Integer(3), sp.Integer(4))) == 5
    True
    """
    balls = [ball for component in vector if (ball := enclosed(component)) is not None]
    if len(balls) < len(vector):
        return None
    with precise():
        return root(sum((square(ball) for ball in balls), arb(0)))


def measured(ball: Any | None) -> tuple[float, float]:
    """A float near what a ball holds and a bound of how far off it is; (nan, nan) where nothing is known.

    Examples
    --------
    >>> measured(enclosed(sp.Rational(1, 4)))
    (0.25, 0.0)
    """
    if ball is None or not ball.is_finite():
        return math.nan, math.nan
    middle = float(ball.mid())
    with precise():
        error = float(abs(ball - arb(middle)).upper())
    return middle, math.nextafter(error, math.inf) if error else 0.0
