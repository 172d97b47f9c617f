"""Questions about blending functions, and answers that say how they are known.

What is true of the formulas by algebra, or by a theorem on their family, is proved; the rest is sampled.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters, as_letters
from rsym.model.symbols import as_expression, real_symbol
from rsym.reports.document import Document, Sentence
from rsym.reports.numbers import number
from rsym.reports.render import Report
from rsym.surfaces.blends.blend_families import BlendFamily, Functions, resolved
from rsym.surfaces.functions.formulas import CompiledFormulas, exact
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.symbols import t

# Sampled identities hold to this: a thousand times the rounding of blending functions.
TOLERANCE = 1e-12
SAMPLES = 1025
DIGITS = 6  # of what is found


class Blend(Protocol):
    """What has blending functions."""

    @property
    def functions(self) -> Functions:
        """As computed."""

    @property
    def formulas(self) -> Functions:
        """As written."""

    @property
    def letters(self) -> Letters:
        """The named parameters."""

    @property
    def family(self) -> BlendFamily | None:
        """Where they come from."""


@dataclass(frozen=True)
class Answer(Report):
    """Yes or no, and how that is known.

    Attributes
    ----------
    statement : str
        What was asked.
    holds : bool
        The answer; an Answer counts as true or false by it.
    proved : bool
        Whether it is proved, by algebra or a theorem; otherwise it was sampled.
    worst : float
        The largest violation that was found; 0 where there is none.
    where : float or None
        The parameter t of the largest violation.
    reason : str
        How it is known.

    Examples
    --------
    >>> print(Answer("F1 increases", False, False, 0.25, 0.5, "1025 places"))
    F1 increases: no, by 0.25 at t = 0.5; sampled (1025 places)
    """

    statement: str
    holds: bool
    proved: bool
    worst: float = 0.0
    where: float | None = None
    reason: str = ""

    def __bool__(self) -> bool:
        return self.holds

    def document(self) -> Document:
        """The statement, the answer and how it is known."""
        place = ""
        if not self.holds and self.where is not None:
            place = f", by {number(self.worst, DIGITS)} at t = {number(self.where, DIGITS)}"
        known = f"{'proved' if self.proved else 'sampled'} ({self.reason})"
        text = f"{self.statement}: {'yes' if self.holds else 'no'}{place}; {known}"
        data = {"statement": self.statement, "holds": self.holds, "worst": self.worst, "where": self.where}
        return Document("blend-answer", Sentence(text, self.proved), data=data)


def end_values(functions: Functions, letters: Letters, orders: int) -> Floats:
    """The derivatives of the functions at both ends, (orders, functions, 2)."""
    return _interpreted(functions, np.array([0.0, 1.0]), orders, letters.values_with(None))


def identity(blend: Blend, statement: str, residuals: Sequence[Any], letters: LetterValues) -> Answer:
    """Whether functions made of the blending functions vanish; each residual takes the functions and gives one.

    With `letters` for these values of them, without for all.
    """
    if all(is_zero(one(resolved(blend.formulas))) for one in residuals):
        return Answer(statement, True, True, reason="the formulas cancel")
    places, functions = np.linspace(0.0, 1.0, SAMPLES), [one(blend.functions) for one in residuals]
    tried = [blend.letters.values_with(letters)] if letters is not None else _several(blend.letters)
    found = np.array([_interpreted(functions, places, 1, values)[0] for values in tried])
    sample, _, column = np.unravel_index(np.nan_to_num(np.abs(found), nan=np.inf).argmax(), found.shape)
    worst = float(np.abs(found[sample, :, column]).max())
    reason = f"{SAMPLES} places{_with(tried[sample])}"
    return Answer(statement, worst <= TOLERANCE, False, worst, float(places[column]), reason)


def _several(letters: Letters) -> list[dict[str, float]]:
    """The defaults, and the letters at both ends of their ranges, or one off the default where there is none."""
    default = letters.values_with(None)
    if not default:
        return [default]
    low = {name: default[name] - 1 if one.minimum is None else float(one.minimum) for name, one in letters.items()}
    high = {name: default[name] + 1 if one.maximum is None else float(one.maximum) for name, one in letters.items()}
    return [default, low, high]


def partition_of_unity(blend: Blend, letters: LetterValues = None) -> Answer:
    """Whether F0 + F1 = 1: constants, and with them motions, pass through the patch."""
    return identity(blend, "F0 + F1 = 1", [lambda f: f[0] + f[1] - 1], letters)


def symmetry(blend: Blend, letters: LetterValues = None) -> Answer:
    """Whether the functions of one end are those of the other run backwards, with the sign of a derivative."""
    pairs = range(len(blend.functions) // 2)
    residuals = [lambda f, k=k: f[2 * k + 1] - (-1) ** k * f[2 * k].subs(t, 1 - t) for k in pairs]
    text = ", ".join(f"{'FGH'[k]}1(t) = {'-' * (k % 2)}{'FGH'[k]}0(1 - t)" for k in pairs)
    return identity(blend, text, residuals, letters)


def reproduction(blend: Blend, function: Any, letters: LetterValues = None) -> Answer:
    """Whether interpolating the ends of a function of t gives the function back."""
    given = as_expression(function)
    orders = len(blend.functions) // 2
    data = [given.diff(t, order).subs(t, end) for order in range(orders) for end in (0, 1)]

    def residual(f: Functions) -> sp.Expr:
        return sp.Add(*(value * one for value, one in zip(data, f, strict=True))) - given

    return identity(blend, f"{given} is reproduced", [residual], letters)


def monotonicity(blend: Blend, letters: LetterValues = None) -> Answer:
    """Whether F1 never decreases."""
    statement, values = "F1 never decreases", blend.letters.values_with(letters)
    slope, numbers = blend.functions[1].diff(t), _numbers(values)
    places = np.linspace(0.0, 1.0, SAMPLES)
    slopes = _interpreted([blend.functions[1]], places, 2, values)[1, 0]
    lowest = int(slopes.argmin())
    worst, where = max(0.0, -float(slopes[lowest])), float(places[lowest])
    polynomial = _polynomial(slope.xreplace(numbers))
    if polynomial is not None:
        holds = never_negative(polynomial)
        return Answer(statement, holds, True, 0.0 if holds else worst, where, f"roots of F1'{_with(values)}")
    if blend.family is not None and blend.family.name in RANGES:
        low, high = monotone_range(blend, letters)
        parameter = blend.family.parameter.xreplace(numbers)
        holds = bool(sp.And(low <= parameter, parameter <= high))
        value, least, most = (number(float(one), DIGITS) for one in (parameter, low, high))
        text = f"the parameter {value} in [{least}, {most}]"
        return Answer(statement, holds, True, 0.0 if holds else worst, where, text)
    return Answer(statement, worst <= TOLERANCE, False, worst, where, f"{SAMPLES} places{_with(values)}")


def _polynomial(expression: sp.Expr) -> sp.Poly | None:
    """The polynomial in t, if it is one with rational coefficients."""
    if not expression.is_polynomial(t):
        return None
    polynomial = sp.Poly(expression, t)
    return polynomial if all(one.is_Rational for one in polynomial.all_coeffs()) else None


def monotone_range(blend: Blend, letters: LetterValues = None, *, ribbons: bool = False) -> tuple[sp.Expr, sp.Expr]:
    """The shape parameters for which F1 never decreases; with `ribbons` moreover G1 <= 0 <= G0."""
    family = blend.family
    if family is None or family.name not in RANGES:
        raise RsymError(
            "only the families class1, class2 and trigonometric have a known monotone range",
            code="monotone-range",
            remedy="ask is_monotone() for one value of the parameter after the other",
        )
    alpha = family.alpha.xreplace(_numbers(blend.letters.values_with(letters)))
    low, high = RANGES[family.name](alpha)
    if not ribbons:
        return low, high
    if family.name == "class I" or alpha > sp.pi / 2:
        raise RsymError(
            f"the range of G1 <= 0 <= G0 is known for class2 and trigonometric up to the angle pi/2, got {family.name}"
            f" with {float(alpha):.6g}",
            code="monotone-range",
            remedy="leave ribbons out",
        )
    steepest = sp.Integer(1) if alpha == 0 else alpha**2 / (2 * (1 - sp.cos(alpha)))
    return low, sp.Rational(1, 2) if family.name == "trigonometric" else 3 - steepest


def is_zero(expression: sp.Expr) -> bool:
    """Whether an expression in polynomials, sines and cosines is zero by algebra.

    Examples
    --------
    >>> is_zero(sp.cos(2 * t) - 1 + 2 * sp.sin(t) ** 2)
    True
    """
    if sp.expand(expression) == 0:
        return True
    if expression.has(sp.Piecewise, sp.Abs, sp.Min, sp.Max):
        return False
    return bool(sp.expand(sp.numer(sp.together(expression.rewrite(sp.exp)))) == 0)


def never_negative(polynomial: sp.Poly) -> bool:
    """Whether a polynomial with rational coefficients is >= 0 on [0, 1], by counting its roots.

    Examples
    --------
    >>> never_negative(sp.Poly(t * (1 - t) * (2 * t - 1) ** 2, t)), never_negative(sp.Poly(t - sp.Rational(1, 9), t))
    (True, False)
    """
    changes = sp.Integer(1)
    for factor, multiplicity in polynomial.sqf_list()[1]:
        changes *= factor.as_expr() if multiplicity % 2 else 1
    odd = sp.Poly(changes, t)
    ends = sum(odd.eval(end) == 0 for end in (0, 1))
    if not odd.is_ground and odd.count_roots(0, 1) > ends:
        return False
    places = (sp.Rational(k, 2 * polynomial.degree() + 3) for k in range(1, 2 * polynomial.degree() + 3))
    return all(polynomial.eval(place) >= 0 for place in places)


def _class1_range(alpha: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """From the slopes of c_F1 and the cubic: log sinc is concave, so their quotient is extreme at ends and middle."""
    if alpha == 0:
        return -sp.oo, sp.oo
    below = 2 * sp.sin(alpha / 2) - alpha * sp.cos(alpha / 2)
    at_end = alpha**2 * sp.sin(alpha / 2) / (6 * below)
    in_middle = 4 * alpha * sp.sin(alpha / 4) ** 2 / (3 * below)
    return -1 / (in_middle - 1), 1 / (1 - at_end)


# F1' = 2w(3 - mu + 5 mu w) with w = t(1-t), and sin(pi t)((1-nu) pi/2 + 2 nu sin(pi t)).
RANGES: dict[str, Callable[[sp.Expr], tuple[sp.Expr, sp.Expr]]] = {
    "class I": _class1_range,
    "class II": lambda alpha: (sp.Integer(-12), sp.Integer(3)),
    "trigonometric": lambda alpha: (-sp.pi / (4 - sp.pi), sp.Integer(1)),
}


def _numbers(values: Mapping[str, float]) -> dict[sp.Symbol, sp.Expr]:
    return {real_symbol(name): exact(value) for name, value in values.items()}


def _with(values: Mapping[str, float]) -> str:
    return "".join(f", {name} = {number(value, DIGITS)}" for name, value in values.items())


def _interpreted(functions: Sequence[sp.Expr], places: Floats, orders: int, values: Mapping[str, float]) -> Floats:
    """Derivatives of expressions (orders, functions, places)."""
    formulas = CompiledFormulas(functions, (t.name,), as_letters(values), ((0.0, 1.0),))
    return formulas.interpreted(places, [(order,) for order in range(orders)], values)
