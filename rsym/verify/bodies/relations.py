"""What leaves that are polynomials have in common: a factor, or an order that holds everywhere.

Faces of a model often lie in one plane, or touch along a line because one body lies inside another. No box, however
small, tells that from near misses; exact division does.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import cached_property

import sympy as sp

from rsym.program.lowering import lower
from rsym.verify.local import Model
from rsym.verify.polynomials import polynomial_of

HIGHEST, MOST = 8, 60  # degree and number of terms of a polynomial that is factored: a few milliseconds
MANY = 64  # leaves, beyond which pairs are not compared


class Relations:
    """Exact relations between leaves, each a node of the model."""

    def __init__(self, model: Model, leaves: Sequence[int]) -> None:
        self.model = model
        self.comparable = len(leaves) <= MANY
        self.leaves = tuple(dict.fromkeys(leaves)) if self.comparable else ()
        self.symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
        self.origins: dict[int, list[int]] = {}  # of a factor, the leaves that have it
        self._orders: dict[tuple[int, int], bool] = {}

    @cached_property
    def polynomials(self) -> dict[int, sp.Poly]:
        """The leaves that are polynomials of moderate size."""
        found: dict[int, sp.Poly] = {}
        for leaf in self.leaves:
            expression = polynomial_of(self.model, leaf)
            if expression is None:
                continue
            polynomial = sp.Poly(expression, *self.symbols, domain=sp.QQ)
            if 0 < polynomial.total_degree() <= HIGHEST and len(polynomial.terms()) <= MOST:
                found[leaf] = polynomial
        return found

    @cached_property
    def _factors(self) -> dict[int, tuple[sp.Rational, list[tuple[sp.Poly, int]]]]:
        return {leaf: polynomial.factor_list() for leaf, polynomial in self.polynomials.items()}

    @cached_property
    def _shared(self) -> set[sp.Poly]:
        """The irreducible factors of more than one leaf that is not just that factor itself."""
        counts = Counter(factor for _, factors in self._factors.values() for factor, _ in factors)
        reducible = {
            factor
            for _, factors in self._factors.values()
            for factor, power in factors
            if len(factors) > 1 or power > 1
        }
        same = {factor for factor, count in counts.items() if count > 1}
        return same & (reducible | {f for f in same if self._is_rescaled(f)})

    def _is_rescaled(self, factor: sp.Poly) -> bool:
        """Whether leaves are different multiples of one irreducible polynomial."""
        multiples = {constant for constant, factors in self._factors.values() if factors == [(factor, 1)]}
        return len(multiples) > 1

    def split(self, leaf: int) -> tuple[int, int] | None:
        """Nodes d, r such that the leaf has the sign of d*r; d is a factor that another leaf has too, r may be 1."""
        if leaf not in self.polynomials:
            return None
        constant, factors = self._factors[leaf]
        for factor, power in factors:
            if factor in self._shared and power % 2 == 1:
                powers = (f.as_expr() ** (p - 1 if f == factor else p) for f, p in factors)
                parts = [lower(self.model.builder, part) for part in (factor.as_expr(), sp.Mul(constant, *powers))]
                for part in parts:
                    self.origins.setdefault(part, []).append(leaf)
                return parts[0], parts[1]
        return None

    def is_never_less(self, f: int, g: int) -> bool:
        """Whether f >= g everywhere, by the factors of f - g."""
        if f == g:
            return True
        if f not in self.polynomials or g not in self.polynomials:
            return False
        if (f, g) not in self._orders:
            self._orders[f, g] = _is_nonnegative(self.polynomials[f] - self.polynomials[g])
        return self._orders[f, g]


def _is_nonnegative(polynomial: sp.Poly) -> bool:
    """Whether the factors of a polynomial show that it is never negative."""
    terms = polynomial.terms()
    highest = max(terms, key=lambda term: term[0])
    if highest[1] < 0 or any(power % 2 for power in highest[0]):
        return False  # along a ray it is negative far away, or on one side
    constant, factors = polynomial.factor_list()
    return constant >= 0 and all(power % 2 == 0 or _is_positive(factor) for factor, power in factors)


def _is_positive(factor: sp.Poly) -> bool:
    """Whether a polynomial of one variable has no real root, and a positive leading coefficient."""
    used = [symbol for symbol in factor.gens if factor.degree(symbol) > 0]
    if len(used) != 1:
        return False
    single = sp.Poly(factor.as_expr(), used[0], domain=sp.QQ)
    return bool(single.LC() > 0) and single.count_roots() == 0
