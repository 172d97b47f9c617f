"""R-systems: logic written in real numbers.

The sign of an R-function depends only on the signs of its arguments, so a
formula built from R-functions is positive exactly where the logic says "true".
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import sympy as sp

from rsym.model.rnodes import R0Conjunction, R0Disjunction, R1Conjunction, R1Disjunction


class RSystem(ABC):
    """A pair of R-operations; negation is always -f."""

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


R0: RSystem = RZero()
R1: RSystem = ROne()
