"""Blending functions: what a patch weighs its edges, ribbons and second ribbons with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache, cached_property
from math import pi
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letter, Letters, as_letters
from rsym.model.symbols import as_expression, real_symbol
from rsym.surfaces.blends import blend_families as families
from rsym.surfaces.blends import blending_checks as checks
from rsym.surfaces.blends.blend_families import BlendFamily, Functions, blend_latex
from rsym.surfaces.blends.blending_checks import Answer
from rsym.surfaces.functions.formulas import exact, real_expressions
from rsym.surfaces.functions.univariate import PARAMETERS, Formula
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.symbols import t

# Formulas whose numbers are given to ten digits pass, and so does rounding times a shape parameter of a million.
HERMITE_TOLERANCE = 1e-9
# The completion divides by sin(alpha), and c(t; alpha) has no G at a full turn.
END_OF_ALPHA = {"class I": 2 * sp.pi, "class II": sp.pi}


@dataclass(frozen=True, init=False)
class HermiteBlend:
    """Blending functions F0, F1 (class 1), with G0, G1 (class 2), with H0, H1 (class 3), on [0, 1].

    In the order F0, F1, G0, G1, H0, H1 function number 2k + i has at the end j in {0, 1} the derivatives

        (d/dt)**l = 1 if (k, i) == (l, j) else 0,     l = 0 ... order - 1,

    so that F weighs positions, G first and H second derivatives. Shape parameters may be numbers or letters
    (`letters={symbol: number or Letter}`), which change without compiling anew. A float that is a simple part of pi
    is taken as that part.

    Parameters
    ----------
    functions : sequence of sympy.Expr
        Two, four or six functions of `rsym.surfaces.symbols.t`.
    letters : mapping, optional
        ``{symbol or name: number or Letter}``.

    Raises
    ------
    RsymError
        For another number of functions, an unknown symbol, or a condition that does not hold, with its value.

    Examples
    --------
    >>> HermiteBlend.cubic().functions[1]
    -2*t**3 + 3*t**2
    >>> HermiteBlend.class2(1, sp.pi / 2)(0.5).round(6).tolist()
    [0.5, 0.5, 0.131848, -0.131848]
    >>> mu = sp.Symbol("mu")
    >>> HermiteBlend.class2(mu, sp.pi / 2, letters={mu: 0})(0.25, letters={"mu": 3})[1].round(6)
    np.float64(0.103516)
    >>> HermiteBlend((1 - t, t**2 + t))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: the blending function F1 must have the value 1 at t = 1, got 2; remedy: ...
    """

    functions: Functions
    letters: Letters
    family: BlendFamily | None
    formulas: Functions = field(compare=False)

    def __init__(
        self,
        functions: Sequence[Any],
        letters: Mapping[Any, Letter | float] | None = None,
        *,
        family: BlendFamily | None = None,
        formulas: Sequence[sp.Expr] | None = None,
    ) -> None:
        given = [as_expression(one) for one in functions] if isinstance(functions, Iterable) else []
        if len(given) not in (2, 4, 6):
            raise RsymError(
                f"a blend has 2, 4 or 6 functions, got {len(given)}",
                code="blend",
                remedy="in the order F0, F1, G0, G1, H0, H1",
            )
        real, known = real_expressions(given, t, PARAMETERS, as_letters(letters), "a blending function")
        store = object.__setattr__
        store(self, "functions", tuple(real))
        store(self, "letters", known)
        store(self, "family", family)
        store(self, "formulas", tuple(real if formulas is None else formulas))
        self._check_conditions()

    @property
    def order(self) -> int:
        """1, 2 or 3: the class of the patches that it makes; derivatives up to order - 1 are interpolated."""
        return len(self.functions) // 2

    @cached_property
    def curve(self) -> Formula:
        """The functions as one function of t with values of the shape (2 order,), compiled."""
        return Formula(self.functions, self.letters, what="a blending function")

    def __call__(self, t: ArrayLike, order: int = 0, *, letters: LetterValues = None) -> Floats:
        """The values of all functions, or their derivatives of an order, (..., 2 order)."""
        return self.curve(t, order, letters=letters)

    def with_letters(self, values: Mapping[Any, Any]) -> HermiteBlend:
        """The same blend with other defaults of its letters; names that it does not have are left out."""
        own = {
            name: value for name, value in ((str(key), value) for key, value in values.items()) if name in self.letters
        }
        return HermiteBlend(self.functions, self.letters.changed(own), family=self.family, formulas=self.formulas)

    @staticmethod
    @cache
    def linear() -> HermiteBlend:
        """Class 1: F0 = 1 - t, F1 = t."""
        return HermiteBlend(families.LINEAR)

    @staticmethod
    @cache
    def cubic() -> HermiteBlend:
        """Class 2: the cubic Hermite functions (Ferguson 1964), F1 = 3t**2 - 2t**3."""
        return HermiteBlend(families.CUBIC)

    @staticmethod
    @cache
    def quintic() -> HermiteBlend:
        """Class 3: the quintic Hermite functions, F1 = 6t**5 - 15t**4 + 10t**3."""
        return HermiteBlend(families.QUINTIC)

    @staticmethod
    def class1(lam: Any, alpha: Any, *, letters: Mapping[Any, Letter | float] | None = None) -> HermiteBlend:
        """Class 2, our class I: (1 - lam) cubic + lam c(t; alpha), c the Hermite basis of 1, t, cos and sin of alpha t.

        lam = 0 is the cubic blend; lam = 1 keeps arcs of the angle alpha exact, 0 <= alpha < 2 pi. Smooth down to
        alpha = 0, where c is the cubic too.
        """
        return _of_family("class I", families.class1, lam, alpha, letters)

    @staticmethod
    def class2(mu: Any, alpha: Any, *, letters: Mapping[Any, Letter | float] | None = None) -> HermiteBlend:
        """Class 2, our class II: F1 = 3t**2 - 2t**3 + mu t**2 (1-t)**2 (2t-1); arcs of alpha are exact for every mu.

        F0 = 1 - F1; G0 and G1 are the only ones that keep arcs of the angle alpha exact, 0 <= alpha < pi.
        """
        return _of_family("class II", families.class2, mu, alpha, letters)

    @staticmethod
    def trigonometric(nu: Any, *, letters: Mapping[Any, Letter | float] | None = None) -> HermiteBlend:
        """Class 2, ours: F1 = (1-nu) sin(pi t/2)**2 + nu (t - sin(2 pi t)/(2 pi)); quarters of circles are exact."""
        parameter = _parameter(nu)
        functions, formulas = families.trigonometric(parameter)
        family = BlendFamily("trigonometric", parameter, sp.pi / 2)
        return HermiteBlend(functions, letters, family=family, formulas=formulas)

    @staticmethod
    def from_smoothstep(f1: Any, alpha: Any, *, letters: Mapping[Any, Letter | float] | None = None) -> HermiteBlend:
        """Class 2, ours: the only completion of a smoothstep F1 that keeps arcs of the angle alpha exact.

        F1 is 0 at 0, 1 at 1, with derivatives 0; F0 = 1 - F1 and, 0 <= alpha < pi,

            G1 = (F0 + cos(alpha) F1 - cos(alpha t))/(alpha sin(alpha)),
            G0 = (sin(alpha t) - sin(alpha) F1)/alpha - cos(alpha) G1.
        """
        (step,), _ = real_expressions([as_expression(f1)], t, PARAMETERS, as_letters(letters), "a smoothstep")
        angle = _angle(alpha, as_letters(letters), "class II")
        functions, formulas = families.completed(step, angle)
        return HermiteBlend(functions, letters, family=BlendFamily("smoothstep", step, angle), formulas=formulas)

    @property
    def exact_angle(self) -> sp.Expr | None:
        """The angle of the arcs that this blend keeps exact by its construction; None for the others."""
        if self.family is None or (self.family.name == "class I" and self.family.parameter != 1):
            return None
        return self.family.alpha

    def is_partition_of_unity(self, *, letters: LetterValues = None) -> Answer:
        """Whether F0 + F1 = 1: then a patch moves as its data do.

        Examples
        --------
        >>> print(HermiteBlend.cubic().is_partition_of_unity())
        F0 + F1 = 1: yes; proved (the formulas cancel)
        """
        return checks.partition_of_unity(self, letters)

    def is_symmetric(self, *, letters: LetterValues = None) -> Answer:
        """Whether F1(t) = F0(1-t), G1(t) = -G0(1-t), H1(t) = H0(1-t): then no end is preferred."""
        return checks.symmetry(self, letters)

    def is_monotone(self, *, letters: LetterValues = None) -> Answer:
        """Whether F1 never decreases, with these letters.

        Examples
        --------
        >>> print(HermiteBlend.class2(4, 1).is_monotone())
        F1 never decreases: no, by 0.0249974 at t = 0.0253906; proved (roots of F1')
        """
        return checks.monotonicity(self, letters)

    def monotone_range(self, *, letters: LetterValues = None, ribbons: bool = False) -> tuple[sp.Expr, sp.Expr]:
        """The range of the shape parameter in which F1 never decreases; with `ribbons` moreover G1 <= 0 <= G0.

        Examples
        --------
        >>> [round(float(end), 2) for end in HermiteBlend.class1(1, sp.pi / 2).monotone_range()]
        [-94.13, 23.88]
        """
        return checks.monotone_range(self, letters, ribbons=ribbons)

    def reproduces(self, function: Any, *, letters: LetterValues = None) -> Answer:
        """Whether interpolating the ends of a function of t gives it back.

        Examples
        --------
        >>> print(HermiteBlend.cubic().reproduces(sp.cos(sp.pi * t / 2)))
        cos(pi*t/2) is reproduced: no, by 0.0107907 at t = 0.480469; sampled (1025 places)
        """
        return checks.reproduction(self, function, letters)

    def __repr__(self) -> str:
        if self.family is None:
            return f"HermiteBlend({self.formulas})"
        name, parameter, alpha = self.family
        return f"HermiteBlend(of {name}, {parameter}, with the angle {alpha})"

    def _repr_latex_(self) -> str:
        return blend_latex(self.formulas)

    def _check_conditions(self) -> None:
        found = checks.end_values(self.functions, self.letters, self.order)
        wanted = np.eye(2 * self.order).reshape(self.order, 2, 2 * self.order).transpose(0, 2, 1)
        wrong = ~(abs(found - wanted) <= HERMITE_TOLERANCE)
        for number, order, end in np.argwhere(wrong.transpose(1, 0, 2)).tolist():
            name = f"{'FGH'[number // 2]}{number % 2}"
            what = ("value", "derivative", "second derivative")[order]
            must, got = wanted[order, number, end], found[order, number, end]
            raise RsymError(
                f"the blending function {name} must have the {what} {must:g} at t = {end}, got {got:.6g}",
                code="hermite",
                remedy="give F0, F1[, G0, G1[, H0, H1]] in this order, or complete F1: .from_smoothstep(f1, alpha)",
            )


def _of_family(name: str, formulas: Any, parameter: Any, alpha: Any, letters: Mapping[Any, Any] | None) -> HermiteBlend:
    shape = _parameter(parameter)
    angle = _angle(alpha, as_letters(letters), name)
    functions, written = formulas(shape, angle)
    return HermiteBlend(functions, letters, family=BlendFamily(name, shape, angle), formulas=written)


def _parameter(value: Any) -> sp.Expr:
    """A number as the decimal that it was written as; a symbol or formula with real letters."""
    if isinstance(value, float):
        return exact(value)
    expression = as_expression(value)
    return expression.xreplace({symbol: real_symbol(symbol.name) for symbol in expression.free_symbols})


def _angle(value: Any, letters: Letters, family: str) -> sp.Expr:
    """The angle, a float near a simple part of pi as that part; of a letter the default is looked at."""
    angle = part_of_pi(value) if isinstance(value, float) else _parameter(value)
    size = angle.xreplace({real_symbol(name): as_expression(letter.default) for name, letter in letters.items()})
    if size.is_number and not (size.is_real and 0 <= size < END_OF_ALPHA[family]):
        raise RsymError(
            f"the angle of {family} must lie in [0, {END_OF_ALPHA[family]}), got {sp.N(size, 6)}",
            code="angle",
            remedy="use shorter pieces" + (", or class1(1, alpha)" if family == "class II" else ""),
        )
    return angle


def part_of_pi(value: float) -> sp.Expr:
    """The number p pi/q, q <= 360, that is this float64; else the shortest decimal that is.

    Examples
    --------
    >>> part_of_pi(1.5707963267948966), part_of_pi(1.5)
    (pi/2, 3/2)
    """
    decimal = exact(value)
    share = Fraction(value / pi).limit_denominator(360)
    near = float(share) * pi
    return sp.Rational(share) * sp.pi if value and abs(near - value) <= 4e-16 * abs(value) else decimal


OF_CLASS = {1: HermiteBlend.linear, 2: HermiteBlend.cubic, 3: HermiteBlend.quintic}


def blend_of_class(given: HermiteBlend | None, order: int, name: str) -> HermiteBlend:
    """The blend that somebody gave for a patch of a class in one parameter, cut down to it; by default its own."""
    if order not in OF_CLASS:
        raise RsymError(f"the class of a Coons patch is 1, 2 or 3, got {order!r}", code="class", remedy="order=2")
    blend = OF_CLASS[order]() if given is None else given
    if not isinstance(blend, HermiteBlend) or blend.order < order:
        got = f"one of class {blend.order}" if isinstance(blend, HermiteBlend) else type(blend).__name__
        raise RsymError(
            f"a patch of class {order} needs a blend of class {order} or higher in {name}, got {got}",
            code="blend",
            remedy=f"HermiteBlend.{OF_CLASS[order].__name__}(), or order={getattr(blend, 'order', order)}",
        )
    if blend.order == order:
        return blend
    count = 2 * order  # the first functions of a higher class are a blend of the lower
    return HermiteBlend(blend.functions[:count], blend.letters, formulas=blend.formulas[:count])
