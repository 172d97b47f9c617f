"""Terms that are linear in an unknown function u, numbers and vectors, and the product rule for them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import sympy as sp

from rsym.analysis.differential import derivative
from rsym.errors import RsymError
from rsym.model.symbols import symbols_of

Row = tuple[sp.Expr, ...]
# What a name stands for: an expression, or a vector or matrix of those.
Meaning: TypeAlias = "sp.Expr | tuple[Meaning, ...]"
SECOND = "what is solved has u, diff(u, x), laplacian(u), div(k*grad(u)), or bilaplacian(u), each times a coefficient"


@dataclass(frozen=True)
class ScalarTerm:
    """value + zero*u + first . grad u + div(second grad u) + fourth*bilaplacian(u)."""

    value: sp.Expr
    zero: sp.Expr
    first: Row
    second: tuple[Row, ...]
    fourth: sp.Expr

    @property
    def plain(self) -> bool:
        """Whether u is not in it."""
        return not (self.zero or any(self.first) or any(map(any, self.second)) or self.fourth)

    def scaled(self, k: sp.Expr, d: TermCalculus) -> ScalarTerm:
        """K times this: k div(A grad u) = div(k A grad u) - grad k . (A grad u)."""
        slope = d.gradient(k) if any(map(any, self.second)) else d.zeros
        lost = tuple(sum((slope[i] * self.second[i][j] for i in d.axes), sp.S.Zero) for j in d.axes)
        return ScalarTerm(
            k * self.value,
            k * self.zero,
            tuple(k * a - b for a, b in zip(self.first, lost, strict=True)),
            tuple(tuple(k * one for one in row) for row in self.second),
            k * self.fourth,
        )

    def plus(self, other: ScalarTerm) -> ScalarTerm:
        """The sum."""
        return ScalarTerm(
            self.value + other.value,
            self.zero + other.zero,
            added(self.first, other.first),
            tuple(map(added, self.second, other.second)),
            self.fourth + other.fourth,
        )


@dataclass(frozen=True)
class VectorTerm:
    """value + zero*u + matrix grad u + third*grad(laplacian(u))."""

    value: Row
    zero: Row
    matrix: tuple[Row, ...]
    third: sp.Expr

    @property
    def plain(self) -> bool:
        """Whether u is not in it."""
        return not (any(self.zero) or any(map(any, self.matrix)) or self.third)

    def scaled(self, k: sp.Expr, d: TermCalculus) -> VectorTerm:
        """K times this."""
        times = [tuple(k * one for one in row) for row in (self.value, self.zero, *self.matrix)]
        return VectorTerm(times[0], times[1], tuple(times[2:]), k * self.third)

    def plus(self, other: VectorTerm) -> VectorTerm:
        """The sum."""
        return VectorTerm(
            added(self.value, other.value),
            added(self.zero, other.zero),
            tuple(map(added, self.matrix, other.matrix)),
            self.third + other.third,
        )


@dataclass(frozen=True)
class MatrixTerm:
    """A matrix of coefficients, without u."""

    rows: tuple[Row, ...]

    def scaled(self, k: sp.Expr, d: TermCalculus) -> MatrixTerm:
        """K times this."""
        return MatrixTerm(tuple(tuple(k * one for one in row) for row in self.rows))

    def plus(self, other: MatrixTerm) -> MatrixTerm:
        """The sum."""
        return MatrixTerm(tuple(map(added, self.rows, other.rows)))

    def times(self, v: VectorTerm) -> VectorTerm:
        """The product with a vector of derivatives up to the first."""
        if v.third:
            raise too_high()
        columns = list(zip(*v.matrix, strict=True))
        matrix = tuple(zip(*(self._applied(column) for column in columns), strict=True))
        return VectorTerm(self._applied(v.value), self._applied(v.zero), matrix, sp.S.Zero)

    def _applied(self, row: Row) -> Row:
        return tuple(sum((a * b for a, b in zip(one, row, strict=True)), sp.S.Zero) for one in self.rows)


def added(one: Row, other: Row) -> Row:
    """The sum of two vectors."""
    return tuple(a + b for a, b in zip(one, other, strict=True))


@dataclass(frozen=True)
class TermCalculus:
    """Derivatives by the coordinates, on what has one."""

    coordinates: tuple[sp.Symbol, ...]
    opaque: frozenset[sp.Symbol]

    @property
    def axes(self) -> range:
        """The numbers of the coordinates."""
        return range(len(self.coordinates))

    @property
    def zeros(self) -> Row:
        """The vector 0."""
        return (sp.S.Zero,) * len(self.coordinates)

    @property
    def nothing(self) -> ScalarTerm:
        """0."""
        return ScalarTerm(sp.S.Zero, sp.S.Zero, self.zeros, (self.zeros,) * len(self.zeros), sp.S.Zero)

    def identity(self, k: sp.Expr) -> tuple[Row, ...]:
        """K on the diagonal."""
        return tuple(tuple(k if i == j else sp.S.Zero for j in self.axes) for i in self.axes)

    def slope(self, value: sp.Expr, axis: int) -> sp.Expr:
        """The derivative of a coefficient by a coordinate."""
        unknown = self.opaque.intersection(symbols_of(value))
        if unknown:
            raise RsymError(
                f"the equation needs the derivative of {sorted(map(str, unknown))[0]}, a Python function",
                code="equation",
                remedy="write -div(k*grad(u)) instead of -k*laplacian(u), or give the coefficient as an expression",
            )
        return derivative(value, self.coordinates[axis])

    def gradient(self, value: sp.Expr) -> Row:
        """The gradient of a coefficient."""
        return tuple(self.slope(value, axis) for axis in self.axes)

    def grad(self, s: ScalarTerm) -> VectorTerm:
        """The gradient of what holds u, or its Laplacian with a constant before it."""
        if any(s.first) or s.fourth:
            raise too_high()
        third = s.second[0][0]
        if s.second != self.identity(third) or any(self.gradient(third)):
            raise too_high()
        return VectorTerm(self.gradient(s.value), self.gradient(s.zero), self.identity(s.zero), third)

    def div(self, v: VectorTerm) -> ScalarTerm:
        """The divergence: div(b u) = b . grad u + u div b."""
        if any(self.gradient(v.third)):
            raise too_high()
        zero = sum((self.slope(v.zero[i], i) for i in self.axes), sp.S.Zero)
        value = sum((self.slope(v.value[i], i) for i in self.axes), sp.S.Zero)
        return ScalarTerm(value, zero, v.zero, v.matrix, v.third)

    def diff(self, s: ScalarTerm, axis: int) -> ScalarTerm:
        """The derivative by a coordinate: d(b . grad u) = (d b) . grad u + div(e b^T grad u), e the unit vector."""
        if any(map(any, s.second)) or s.fourth:
            raise too_high()
        # div(E grad u) with E_ij = e_i b_j is sum_j d_i(b_j d_j u): the whole of it.
        second = tuple(s.first if i == axis else self.zeros for i in self.axes)
        first = tuple(s.zero if i == axis else sp.S.Zero for i in self.axes)
        return ScalarTerm(self.slope(s.value, axis), self.slope(s.zero, axis), first, second, sp.S.Zero)


def too_high() -> RsymError:
    """The error for an order that is not offered."""
    return RsymError("the equation has derivatives of an order that is not offered", code="equation", remedy=SECOND)
