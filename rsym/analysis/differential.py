"""Derivatives of a shape in closed form, R-nodes kept.

One rule a function, applied once to each shared part and without recursion.
|u| has the derivative u' u/|u|, that of sign is 0, and min and max have piecewise
ones, undefined on the tie: never a Dirac impulse, whatever the order. On the border
of a Piecewise a formula is that of the branch taken there; kernels say NaN where
the branches differ.
"""

from __future__ import annotations

from typing import TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.choices import Choice
from rsym.model.nodes import written_out
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.traversal import postorder

Matrix: TypeAlias = sp.ImmutableDenseMatrix


def derivative(expression: sp.Expr, symbol: sp.Symbol) -> sp.Expr:
    """The derivative of an expression with respect to one symbol.

    Examples
    --------
    >>> from rsym import conjunction, x, y
    >>> derivative(abs(x) * y, x)
    x*y/Abs(x)
    >>> derivative(conjunction(x, y), y)
    -y/sqrt(x**2 + y**2) + 1
    """
    expression = written_out(expression)
    known: dict[int, sp.Expr] = {}
    for part in postorder(expression):
        known[id(part)] = _rule(part, [known[id(argument)] for argument in part.args], symbol)
    return known[id(expression)]


def _rule(part: sp.Basic, inner: list[sp.Expr], symbol: sp.Symbol) -> sp.Expr:
    """The chain rule for one part, given the derivatives of its arguments."""
    if part.is_Symbol:
        return sp.S.One if part == symbol else sp.S.Zero
    if isinstance(part, sp.Piecewise):
        pairs = [(d, pair.cond) for d, pair in zip(inner, part.args, strict=True)]
        return sp.Piecewise(*pairs, evaluate=False)
    if part.is_Add:
        return sp.Add(*inner)
    if isinstance(part, sp.functions.elementary.piecewise.ExprCondPair):
        return inner[0]
    if all(d == 0 for d in inner) or not isinstance(part, sp.Expr):
        return sp.S.Zero
    if part.is_Mul:
        return sp.Add(*(d * sp.Mul(*part.args[:k], *part.args[k + 1 :]) for k, d in enumerate(inner) if d != 0))
    if part.is_Pow:
        return _power(part, *inner)
    if isinstance(part, sp.Abs):
        return inner[0] * part.args[0] / part
    if isinstance(part, sp.sign):
        u = part.args[0]
        return sp.Piecewise((0, u > 0), (0, u < 0), (sp.S.NaN, True), evaluate=False)
    if isinstance(part, sp.Min | sp.Max):
        return _extremum(part, inner)
    if isinstance(part, Choice):
        return Choice(*part.args[:2], *inner[2:])
    if isinstance(part, sp.Function):
        return sp.Add(*(d * part.fdiff(k + 1) for k, d in enumerate(inner) if d != 0))
    raise RsymError(f"cannot differentiate {type(part).__name__}", code="unsupported-function")


def _power(part: sp.Pow, base: sp.Expr, exponent: sp.Expr) -> sp.Expr:
    u, p = part.args
    result = p * u ** (p - 1) * base
    return result if exponent == 0 else result + part * sp.log(u) * exponent


def _extremum(part: sp.Expr, inner: list[sp.Expr]) -> sp.Expr:
    """The derivative of the argument that is strictly ahead of all others; undefined on a tie."""
    ahead = sp.StrictLessThan if isinstance(part, sp.Min) else sp.StrictGreaterThan
    branches = []
    for k, (argument, d) in enumerate(zip(part.args, inner, strict=True)):
        others = [other for j, other in enumerate(part.args) if j != k]
        branches.append((d, sp.And(*(ahead(argument, other) for other in others))))
    return sp.Piecewise(*branches, (sp.S.NaN, True), evaluate=False)


def gradient(shape: Shape) -> Matrix:
    """The column of first derivatives with respect to the coordinates, letters symbolic.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.gradient(rsym.Shape(x**2 * y, (x, y)))
    Matrix([
    [2*x*y],
    [ x**2]])
    """
    require_shape(shape)
    return Matrix([derivative(shape.expression, symbol) for symbol in shape.coordinates])


def hessian(shape: Shape) -> Matrix:
    """The symmetric matrix of second derivatives.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.hessian(rsym.Shape(x**2 * y, (x, y)))
    Matrix([
    [2*y, 2*x],
    [2*x,   0]])
    """
    require_shape(shape)
    first = gradient(shape)
    size = shape.dimension
    rows = {(i, j): derivative(first[i], shape.coordinates[j]) for i in range(size) for j in range(i, size)}
    return Matrix(size, size, lambda i, j: rows[min(i, j), max(i, j)])


def laplacian(shape: Shape) -> sp.Expr:
    """The sum of the unmixed second derivatives.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.laplacian(rsym.Shape(x**2 * y, (x, y)))
    2*y
    """
    require_shape(shape)
    first = gradient(shape)
    return sp.Add(*(derivative(d, symbol) for d, symbol in zip(first, shape.coordinates, strict=True)))
