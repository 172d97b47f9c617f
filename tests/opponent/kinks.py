"""Functions of one variable with a kink of a known order at zero, in every dress."""

from __future__ import annotations

from random import Random

import sympy as sp
from sympy import Abs, Max, Min, Piecewise, sign, sqrt

import rsym
from rsym import R0, R1
from rsym.model.powers import absolute_power

Q = sp.Rational
ZERO = sp.Integer(0)
SYSTEMS = (
    R0,
    R1,
    rsym.RAlpha(Q(1, 2)),
    rsym.RAlpha(Q(-3, 4)),
    rsym.Rp(3),
    rsym.Rp(4),
    rsym.Rp(Q(5, 2)),
    rsym.R0m(1),
    rsym.R0m(2),
    rsym.Sardf(),
    rsym.Sardf(Q(1, 2)),
)


def kink(random: Random, t: sp.Expr, k: int) -> tuple[sp.Expr, sp.Rational, sp.Rational]:
    """(f, a, b) with f = a |t|^k + o for t < 0 and b t^k + o for t > 0, a polynomial on neither side of both."""
    one_sided = [
        (Max(t, 0) ** k, 0, 1),
        (Max(t, 0, evaluate=False) ** k, 0, 1),
        ((-Min(t, 0)) ** k, 1, 0),
        ((t + Abs(t)) ** k / 2**k, 0, 1),
        (Piecewise((t**k, t > 0), (0, True)), 0, 1),
        (Piecewise((0, t <= 0), (t**k, True)), 0, 1),
        (Piecewise((0, t < 0), (2 * t**k, True)), 0, 2),
        (R1.disjunction(t, ZERO) ** k, 0, 1),
        (R0.disjunction(t, ZERO) ** k, 0, 2**k),
        (R1.conjunction(t, ZERO) ** k, (-1) ** k, 0),
        ((1 + sign(t)) * t**k / 2, 0, 1),
        ((sqrt(t**2) + t) ** k, 0, 2**k),
    ]
    odd = [
        (Abs(t) ** k, 1, 1),
        (sqrt(t**2) ** k, 1, 1),
        (sqrt(t ** (2 * k)), 1, 1),
        (absolute_power(t, sp.Integer(k)), 1, 1),
        (Max(t, -t) ** k, 1, 1),
        (sign(t) * t**k, 1, 1),
        (sp.sin(Abs(t)) ** k, 1, 1),
        (Piecewise((t**k, t > 0), (-(t**k), True)), 1, 1),
        (t ** (k - 1) * Abs(t), 1, 1),
        ((t**2) ** Q(k, 2), 1, 1),
        (R0.conjunction(t, -t) ** k, -(sqrt(2) ** k), -(sqrt(2) ** k)),
    ]
    even = [
        (t ** (k - 1) * Abs(t), -1, 1),
        (sign(t) * t**k, -1, 1),
        (sqrt(t**2) * t ** (k - 1), -1, 1),
        (Piecewise((t**k, t > 0), (-(t**k), True)), -1, 1),
        (Piecewise((t**k, t > 0), (3 * t**k, True)), 3, 1),
    ]
    return random.choice([*one_sided, *(odd if k % 2 else even)])


def whole(random: Random, t: sp.Expr, k: int) -> sp.Expr:
    """t^k, or something analytic with this beginning, written with kinks that cancel."""
    even = [Abs(t) ** k, sqrt(t**2) ** k, sign(t) ** 2 * t**k, Max(t, -t) ** k, absolute_power(t, sp.Integer(k))]
    any_ = [
        Max(t, 0) ** k + (-1) ** k * (-Min(t, 0)) ** k,
        sign(t) * Abs(t) * t ** (k - 1),
        Piecewise((t**k, t > 0), (t**k + ZERO, True), evaluate=False),
        Piecewise((t**k, t > 0), ((-1) ** k * (-t) ** k, True), evaluate=False),
        t**k + Abs(t) - sqrt(t**2),
        t**k + Max(t, 0) - (t + Abs(t)) / 2,
        t**k + R0.conjunction(t, -2 * t) + R0.disjunction(-t, 2 * t),
        t**k * sp.cos(Abs(t)),
        t**k / (1 + sqrt(t**4)),
    ]
    return random.choice([*any_, *(even if k % 2 == 0 else [])])
