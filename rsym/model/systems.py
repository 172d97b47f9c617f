"""R-systems: logic written in real numbers.

The sign of an R-function depends only on the signs of its arguments, so a
formula built from R-functions is positive exactly where the logic says "true".
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any, ClassVar

import sympy as sp

from rsym.errors import RsymError
from rsym.model.nodes import Composition
from rsym.model.rnodes import (
    R0Conjunction,
    R0Disjunction,
    R0mConjunction,
    R0mDisjunction,
    R1Conjunction,
    R1Disjunction,
    RAlphaConjunction,
    RAlphaDisjunction,
    ROperation,
    RpConjunction,
    RpDisjunction,
)
from rsym.model.symbols import as_expression, rebuild


@dataclass(frozen=True)
class RSystem(ABC):
    """A pair of R-operations; negation is always -f.

    The parameter of a system is a number or a letter. It is never
    differentiated through; a letter outside the range of its system gives NaN.
    """

    keeps_sets: ClassVar[bool] = True  # whether the sets are exactly those that the logic says

    @property
    def parameters(self) -> tuple[sp.Expr, ...]:
        """alpha, m or p, of a system that has one."""
        return tuple(getattr(self, field.name) for field in fields(self))

    @abstractmethod
    def conjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Positive where every operand is."""

    @abstractmethod
    def disjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Positive where some operand is."""


@dataclass(frozen=True)
class RZero(RSystem):
    """System R_0: f + g -+ sqrt(f**2 + g**2).

    Analytic except where f = g = 0; keeps normalisation to order 1.
    Source: Rvachev (1982); Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Examples
    --------
    >>> from rsym import R0, x, y
    >>> R0.conjunction(x, y).doit()
    x + y - sqrt(x**2 + y**2)
    """

    def conjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return f + g - sqrt(f**2 + g**2), folded from the left."""
        return R0Conjunction(*operands)

    def disjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return f + g + sqrt(f**2 + g**2), folded from the left."""
        return R0Disjunction(*operands)


@dataclass(frozen=True)
class ROne(RSystem):
    """System R_1: min and max, not differentiable on f = g.

    Examples
    --------
    >>> from rsym import R1, x, y
    >>> R1.disjunction(x, y).subs({x: 2, y: 3}).evalf(3)
    3.00
    """

    def conjunction(self, *operands: sp.Expr) -> sp.Expr:
        """The smallest operand."""
        return R1Conjunction(*operands)

    def disjunction(self, *operands: sp.Expr) -> sp.Expr:
        """The largest operand."""
        return R1Disjunction(*operands)


@dataclass(frozen=True)
class RAlpha(RSystem):
    """System R_alpha, -1 < alpha <= 1: (f + g -+ sqrt(f**2 + g**2 - 2*alpha*f*g))/(1 + alpha).

    alpha = 0 is R_0, alpha = 1 is min and max. For alpha < 1 analytic except
    where f = g = 0; keeps normalisation to order 1: at f = 0 < g the conjunction
    has d/df = 1 and d2/df2 = -(1 - alpha)/g.

    Parameters
    ----------
    alpha : number or letter
        In (-1, 1].

    Raises
    ------
    RsymError
        For a number outside the range, or what is neither number nor letter.

    Source: Rvachev (1982).

    Examples
    --------
    >>> from rsym import RAlpha, conjunction, x, y
    >>> conjunction(x, y, system=RAlpha(0)).doit()
    x + y - sqrt(x**2 + y**2)
    """

    alpha: Any

    def __post_init__(self) -> None:
        object.__setattr__(self, "alpha", _parameter("alpha", self.alpha, "in (-1, 1]", lambda a: -1 < a <= 1))

    def conjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return (f + g - sqrt(f**2 + g**2 - 2*alpha*f*g))/(1 + alpha), folded from the left."""
        return RAlphaConjunction(self.alpha, *operands)

    def disjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return (f + g + sqrt(f**2 + g**2 - 2*alpha*f*g))/(1 + alpha), folded from the left."""
        return RAlphaDisjunction(self.alpha, *operands)


@dataclass(frozen=True)
class R0m(RSystem):
    """System R_0^m: (f + g -+ sqrt(f**2 + g**2))*(f**2 + g**2)**(m/2).

    m times continuously differentiable everywhere, corners f = g = 0 included
    (it is homogeneous of degree m + 1). It does not keep normalisation: on f = 0
    its derivative is |g|**m, so `normalise` the result.

    Parameters
    ----------
    m : integer or letter
        At least 1.

    Raises
    ------
    RsymError
        For a number that is no positive integer, or what is neither number nor letter.

    Source: Rvachev (1982).

    Examples
    --------
    >>> from rsym import R0m, conjunction, x, y
    >>> conjunction(x, y, system=R0m(2)).doit()
    (x**2 + y**2)*(x + y - sqrt(x**2 + y**2))
    """

    m: Any

    def __post_init__(self) -> None:
        object.__setattr__(self, "m", _parameter("m", self.m, "a positive integer", lambda m: m == int(m) >= 1))

    def conjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return (f + g - r)*r**m with r = sqrt(f**2 + g**2), folded from the left."""
        return R0mConjunction(self.m, *operands)

    def disjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return (f + g + r)*r**m with r = sqrt(f**2 + g**2), folded from the left."""
        return R0mDisjunction(self.m, *operands)


@dataclass(frozen=True)
class Rp(RSystem):
    """System R_p, p > 1: f + g -+ (|f|**p + |g|**p)**(1/p).

    p = 2 is R_0. For even p analytic except where f = g = 0, where it is only
    continuous; keeps normalisation to order p - 1.

    Parameters
    ----------
    p : number or letter
        Above 1; an even integer for smoothness across f = 0 and g = 0.

    Raises
    ------
    RsymError
        For a number that is not above 1, or what is neither number nor letter.

    Source: Rvachev (1982).

    Examples
    --------
    >>> from rsym import Rp, conjunction, x, y
    >>> conjunction(x, y, system=Rp(4)).doit()
    x + y - (x**4 + y**4)**(1/4)
    """

    p: Any

    def __post_init__(self) -> None:
        object.__setattr__(self, "p", _parameter("p", self.p, "a number above 1", lambda p: p > 1))

    def conjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return f + g - (|f|**p + |g|**p)**(1/p), folded from the left."""
        return RpConjunction(self.p, *operands)

    def disjunction(self, *operands: sp.Expr) -> sp.Expr:
        """Return f + g + (|f|**p + |g|**p)**(1/p), folded from the left."""
        return RpDisjunction(self.p, *operands)


def in_system(expression: sp.Expr, system: RSystem) -> sp.Expr:
    """The expression with every conjunction and disjunction in another system; blends stay.

    Examples
    --------
    >>> from rsym import R1, conjunction, disjunction, x, y
    >>> in_system(conjunction(x, disjunction(y, -x)), R1)
    conjunction(x, disjunction(y, -x, system=R1), system=R1)
    """

    def moved(part: sp.Basic) -> sp.Basic | None:
        if not isinstance(part, ROperation) or isinstance(part, Composition):
            return None
        return (system.conjunction if part.sign < 0 else system.disjunction)(*part.operands)

    return rebuild(expression, moved)


def _parameter(name: str, value: Any, wanted: str, accepts: Callable[[Any], bool]) -> sp.Expr:
    """The parameter as SymPy has it, a whole number as an integer."""
    try:
        parameter = as_expression(value)
    except RsymError as error:
        raise RsymError(f"{name} must be {wanted} or a letter, got {value!r}", code="parameter") from error
    if parameter.is_Symbol:
        return parameter
    if not (parameter.is_number and parameter.is_finite and parameter.is_real and accepts(parameter)):
        raise RsymError(f"{name} must be {wanted} or a letter, got {parameter}", code="parameter")
    whole = parameter.is_Float and parameter == int(parameter)
    return sp.Integer(int(parameter)) if whole else parameter


R0: RSystem = RZero()
R1: RSystem = ROne()
