"""Formulas of blending functions: polynomials, and two families that keep arcs of circles.

Both families are derived for rsym; the thesis on Coons-type patches with shape parameters states their properties and
stops before the formulas. Everything about an arc of the angle alpha is said with two functions,

    C(t) = (1 - cos(alpha t))/alpha**2 = t**2/2 - ...,     S(t) = (alpha t - sin(alpha t))/alpha**3 = t**3/6 - ...,

which stay what they are as alpha goes to 0. So do all quotients below: none is one of vanishing numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple, TypeAlias

import sympy as sp

from rsym.model.abridging import symbol_names, weight
from rsym.model.symbols import symbols_of
from rsym.surfaces.symbols import t

LONGEST = 120  # parts of a formula that is written out
Functions: TypeAlias = tuple[sp.Expr, ...]
# S in float64 is off by eps/alpha**2 in closed form, by 1e-21 in ten terms of its series up to this alpha**2.
SERIES_BELOW, TERMS = sp.Integer(1), 10
HALF = sp.Rational(1, 2)
WAVE = t**2 * (1 - t) ** 2 * (2 * t - 1)
LINEAR: Functions = (1 - t, t)
CUBIC: Functions = (2 * t**3 - 3 * t**2 + 1, 3 * t**2 - 2 * t**3, t**3 - 2 * t**2 + t, t**3 - t**2)
QUINTIC: Functions = (
    1 - 10 * t**3 + 15 * t**4 - 6 * t**5,
    10 * t**3 - 15 * t**4 + 6 * t**5,
    t - 6 * t**3 + 8 * t**4 - 3 * t**5,
    -4 * t**3 + 7 * t**4 - 3 * t**5,
    (t**2 - 3 * t**3 + 3 * t**4 - t**5) / 2,
    (t**3 - 2 * t**4 + t**5) / 2,
)


class Named(sp.Function):  # type: ignore[misc]
    """A blending function in the formula of another, by its name; classes of a module travel between processes."""

    nargs = 1


class F_0(Named):
    """F0(t)."""


class F_1(Named):
    """F1(t)."""


class G_0(Named):
    """G0(t)."""


class G_1(Named):
    """G1(t)."""


F0, F1, G0, G1 = F_0, F_1, G_0, G_1


class BlendFamily(NamedTuple):
    """Where blending functions come from: the name of a family, its shape parameter, the angle of its arcs."""

    name: str
    parameter: sp.Expr
    alpha: sp.Expr


def class1(lam: sp.Expr, alpha: sp.Expr) -> tuple[Functions, Functions]:
    """(1 - lam) cubic + lam c, c the Hermite basis of span{1, t, cos(alpha t), sin(alpha t)}: as computed, as written.

    With x = alpha/2, j = (sin x - x cos x)/x**3, s = sin(x)/x,

        c_F1 = (2 s C(t) - 4 cos(x) S(t))/j,     c_G1 = (2 s S(t) - 4 S(1)/s C(t))/j.
    """
    x = alpha / 2
    sine, cosine = sp.sin(x), sp.cos(x)
    j = _stable(_series(x**2, 2) - _series(x**2, 3), (sine - x * cosine) / x**3, alpha)
    s = _stable(_series(x**2, 1), sine / x, alpha)
    of_c, of_s = versine(t, alpha), sine_excess(t, alpha)
    c_f1 = _constant(2 * s / j) * of_c - _constant(4 * cosine / j) * of_s
    c_g1 = _constant(2 * s / j) * of_s - _constant(4 * sine_excess(sp.Integer(1), alpha) / (s * j)) * of_c
    f1, g1 = (_mixed(lam, one, other) for one, other in ((CUBIC[1], c_f1), (CUBIC[3], c_g1)))
    return (1 - f1, f1, -g1.subs(t, 1 - t), g1), class1_formulas(lam, alpha)


def class1_formulas(lam: sp.Expr, alpha: sp.Expr) -> Functions:
    """The same as one would write it."""
    if alpha == 0 or lam == 0:
        return CUBIC
    sine, cosine = sp.sin(alpha), sp.cos(alpha)
    turned = sp.sin(alpha * (t - HALF)) + sp.sin(alpha / 2) - alpha * t * sp.cos(alpha / 2)
    excess, versed = alpha * t - sp.sin(alpha * t), 1 - sp.cos(alpha * t)
    c_f1 = turned / (2 * sp.sin(alpha / 2) - alpha * sp.cos(alpha / 2))
    c_g1 = ((1 - cosine) * excess - (alpha - sine) * versed) / (alpha * (2 * (1 - cosine) - alpha * sine))
    return 1 - F1(t), _mixed(lam, CUBIC[1], c_f1), -G1(1 - t), _mixed(lam, CUBIC[3], c_g1)


def class2(mu: sp.Expr, alpha: sp.Expr) -> tuple[Functions, Functions]:
    """F1 = 3t**2 - 2t**3 + mu t**2 (1-t)**2 (2t-1), completed so that arcs of the angle alpha are exact."""
    return symmetric(CUBIC[1] + mu * WAVE, alpha)


def trigonometric(nu: sp.Expr) -> tuple[Functions, Functions]:
    """F1 = (1 - nu) sin(pi t/2)**2 + nu (t - sin(2 pi t)/(2 pi)), completed for quarters of circles."""
    f1 = _mixed(nu, sp.sin(sp.pi * t / 2) ** 2, t - sp.sin(2 * sp.pi * t) / (2 * sp.pi))
    return symmetric(f1, sp.pi / 2)


def symmetric(f1: sp.Expr, alpha: sp.Expr) -> tuple[Functions, Functions]:
    """The completion of an F1 with F1(t) + F1(1 - t) = 1."""
    functions, (_, _, _, g1) = completed(f1, alpha)
    return functions, (1 - F1(t), f1, -G1(1 - t), g1)


def completed(f1: sp.Expr, alpha: sp.Expr) -> tuple[Functions, Functions]:
    """The one Hermite set with this F1 and F0 = 1 - F1 that reproduces cos(alpha t) and sin(alpha t).

    G1 = (F0 + cos(alpha) F1 - cos(alpha t))/(alpha sin(alpha)) = (C(t) - C(1) F1(t))/(sin(alpha)/alpha); G0 is its
    mirror image (C(1) F0(t) - C(1 - t))/(sin(alpha)/alpha).
    """
    whole, ratio = versine(sp.Integer(1), alpha), sine_ratio(alpha)
    g0 = (whole * (1 - f1) - versine(1 - t, alpha)) / ratio
    g1 = (versine(t, alpha) - whole * f1) / ratio
    if alpha == 0:
        return (1 - f1, f1, g0, g1), (1 - F1(t), f1, t - t**2 / 2 - F1(t) / 2, (t**2 - F1(t)) / 2)
    sine, cosine = sp.sin(alpha), sp.cos(alpha)
    written_g1 = (F0(t) + cosine * F1(t) - sp.cos(alpha * t)) / (alpha * sine)
    written_g0 = (sp.sin(alpha * t) - sine * F1(t)) / alpha - cosine * G1(t)
    return (1 - f1, f1, g0, g1), (1 - F1(t), f1, written_g0, written_g1)


def versine(at: sp.Expr, alpha: sp.Expr) -> sp.Expr:
    """C(t) = (1 - cos(alpha t))/alpha**2."""
    closed = 2 * sp.sin(alpha * at / 2) ** 2 / alpha**2
    return _stable(at**2 * _series(alpha**2 * at**2, 2), closed, alpha)


def sine_excess(at: sp.Expr, alpha: sp.Expr) -> sp.Expr:
    """S(t) = (alpha t - sin(alpha t))/alpha**3."""
    closed = (alpha * at - sp.sin(alpha * at)) / alpha**3
    return _stable(at**3 * _series(alpha**2 * at**2, 3), closed, alpha)


def sine_ratio(alpha: sp.Expr) -> sp.Expr:
    """sin(alpha)/alpha."""
    return _stable(_series(alpha**2, 1), sp.sin(alpha) / alpha, alpha)


def resolved(formulas: Sequence[sp.Expr]) -> Functions:
    """Formulas that speak of F_0, F_1, G_1 written out."""
    known = dict(zip((F0, F1, G0, G1), formulas, strict=False))
    while any(one.has(*known) for one in formulas):
        formulas = [
            one.replace(lambda part: part.func in known, lambda part: known[part.func].subs(t, part.args[0]))
            for one in formulas
        ]
    return tuple(formulas)


def _series(square: sp.Expr, first: int) -> sp.Expr:
    """1/first! - square/(first + 2)! + square**2/(first + 4)! - ..., in Horner's form."""
    total = sp.Integer(0)
    for term in reversed(range(TERMS)):
        total = (-1) ** term / sp.factorial(first + 2 * term) + square * total
    return total


def _stable(series: sp.Expr, closed: sp.Expr, alpha: sp.Expr) -> sp.Expr:
    """The series for small alpha, the closed form for others; for a letter both."""
    below = alpha**2 < SERIES_BELOW
    if below in (sp.true, sp.false):
        return series if below == sp.true else closed
    return sp.Piecewise((series, below), (closed, True))


@lru_cache(maxsize=256)  # the same angle comes back with every patch
def _constant(value: sp.Expr) -> sp.Expr:
    """A number in its shortest form, so that the formulas of a patch can be read."""
    return sp.radsimp(sp.cancel(value)) if value.is_number else value


def _mixed(share: sp.Expr, one: sp.Expr, other: sp.Expr) -> sp.Expr:
    return one if share == 0 else other if share == 1 else (1 - share) * one + share * other


def blend_latex(formulas: Sequence[sp.Expr]) -> str:
    r"""One line for each function; a function may speak of those already known.

    Examples
    --------
    >>> from rsym.surfaces.blends.blend_families import LINEAR
    >>> print(blend_latex(LINEAR))
    $\displaystyle \begin{aligned} F_{0}(t) &= 1 - t \\ F_{1}(t) &= t \end{aligned}$
    """
    text = r" \\ ".join(blend_lines(formulas))
    return rf"$\displaystyle \begin{{aligned}} {text} \end{{aligned}}$"


def blend_lines(formulas: Sequence[sp.Expr], mark: str = "") -> list[str]:
    """The definition of each function, its name marked if there are others of that name."""
    names = [f"{mark}{letter}_{{{end}}}(t)" for letter in "FGH" for end in (0, 1)]
    return [f"{name} &= {_written(formula, mark)}" for name, formula in zip(names, formulas, strict=False)]


def _written(formula: sp.Expr, mark: str) -> str:
    if weight(formula, LONGEST) > LONGEST:
        return r"\dots"
    marks = {call: sp.Dummy(mark + _called(call)) for call in formula.atoms(F0, F1, G0, G1)}
    marked = formula.xreplace(marks)
    names = {**symbol_names(symbols_of(marked)), **{mark: mark.name for mark in marks.values()}}
    text: str = sp.latex(marked, symbol_names=names)
    return text


def _called(call: sp.Expr) -> str:
    letter, end = call.func.__name__.split("_")
    return f"{letter}_{{{end}}}({sp.latex(call.args[0])})"
