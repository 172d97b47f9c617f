"""Derivatives of a shape and curvatures of its level sets, in closed form, R-nodes kept.

One rule a function, applied once to each shared part and without recursion.
|u| has the derivative u' u/|u|, those of sign and floor are 0, and min and max have piecewise
ones, undefined on the tie: never a Dirac impulse, whatever the order. On the border
of a Piecewise a formula is that of the branch taken there; kernels say NaN where
the branches differ.

With omega > 0 inside, every curvature is positive where the inside is convex.
Source: Goldman, Curvature formulas for implicit curves and surfaces, CAGD 22 (2005) 632-658.
"""

from __future__ import annotations

from typing import TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.choices import Choice
from rsym.model.nodes import Fold, written_out
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, real_symbol

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
    # Equal parts are often several objects; one of each is derived, and a derivative that is a part is that object:
    # SymPy compares objects at once, trees for ever.
    unique = {part: part for part in postorder(expression)}
    known: dict[sp.Basic, sp.Expr] = {}
    for part in unique:
        made = _rule(part, [known[argument] for argument in part.args], symbol)
        known[part] = unique.get(made, made)
    return known[expression]


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
    if isinstance(part, sp.floor):
        return sp.Piecewise((0, part.args[0] > part), (sp.S.NaN, True), evaluate=False)
    if isinstance(part, sp.Min | sp.Max):
        return _extremum(part, inner)
    if isinstance(part, Choice):
        return Choice(*part.args[:2], *inner[2:])
    if isinstance(part, Fold):
        return _fold(part, inner)
    if isinstance(part, sp.Function):
        return sp.Add(*(d * part.fdiff(k + 1) for k, d in enumerate(inner) if d != 0))
    raise RsymError(f"cannot differentiate {type(part).__name__}", code="unsupported-function")


def _fold(part: Fold, inner: list[sp.Expr]) -> sp.Expr:
    """The chain rule from operand to operand: one factor a pair, where `fdiff` has those of all pairs that follow."""
    count = part.parameter_count
    for k, d in enumerate(inner[:count]):
        if d != 0:
            part.fdiff(k + 1)  # refuses
    (first, *rest), (slope, *slopes) = part.operands, inner[count:]
    head = part.alone(first)
    made = slope if head == first else slope * head.fdiff()  # its absolute value, say
    for operand, d in zip(rest, slopes, strict=True):
        partials = part.partial(head, operand), part.partial(operand, head)
        made = sp.Add(*(one * partial for one, partial in zip((made, d), partials, strict=True) if one != 0))
        head = part.func(*part.parameters, head, operand)
    return made


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


def boundary_speed(shape: Shape, letter: str) -> sp.Expr:
    """How fast the boundary moves outwards when a letter grows: (d omega/d letter)/|grad omega|.

    omega(x(p), p) = 0 along a point that stays on the boundary, so d omega/dp + grad omega . dx/dp = 0, and the outer
    normal is -grad omega/|grad omega|. Where omega is not 0 it is the speed of the level set there.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> r = sp.Symbol("r", real=True)
    >>> boundary_speed(rsym.Shape(r**2 - x**2 - y**2, (x, y), letters={r: 2}), "r")
    2*r/sqrt(4*x**2 + 4*y**2)
    """
    slope = sp.Add(*(component**2 for component in gradient(shape)))
    return derivative(shape.expression, real_symbol(letter)) / sp.sqrt(slope)


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


def curvature(shape: Shape) -> sp.Expr:
    """The curvature of the level lines of a shape in the plane.

    kappa = -(w_xx w_y**2 - 2 w_xy w_x w_y + w_yy w_x**2)/|grad w|**3, the inverse of the radius of the osculating
    circle, undefined where the gradient vanishes.

    Raises
    ------
    RsymError
        For a shape that is not in the plane.

    Source: Goldman (2005).

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> ellipse = rsym.Shape(1 - x**2 / 9 - y**2 / 4, (x, y))
    >>> sp.simplify(rsym.curvature(ellipse).subs({x: 3, y: 0}))
    3/4
    """
    _require(shape, 2, "curvature", "in space use mean_curvature, gaussian_curvature or principal_curvatures")
    (p, q), second = gradient(shape), hessian(shape)
    bent = second[0, 0] * q**2 - 2 * second[0, 1] * p * q + second[1, 1] * p**2
    return -bent / (p**2 + q**2) ** sp.Rational(3, 2)


def mean_curvature(shape: Shape) -> sp.Expr:
    """The mean of the principal curvatures of the level surfaces.

    H = (g^T Hs g - |g|**2 tr Hs)/(2 |g|**3) with the gradient g and the Hessian Hs: 1/R on a ball of radius R.

    Raises
    ------
    RsymError
        For a shape that is not in space.

    Source: Goldman (2005), with the sign that makes convex bodies positive.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> sp.simplify(rsym.mean_curvature(rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z))))
    1/sqrt(x**2 + y**2 + z**2)
    """
    _require_space(shape, "mean_curvature")
    first, second = gradient(shape), hessian(shape)
    squared = first.dot(first)
    return (first.dot(second * first) - squared * second.trace()) / (2 * squared ** sp.Rational(3, 2))


def gaussian_curvature(shape: Shape) -> sp.Expr:
    """The product of the principal curvatures of the level surfaces.

    K = g^T adj(Hs) g/|g|**4 with the gradient g and the adjugate of the Hessian Hs.

    Raises
    ------
    RsymError
        For a shape that is not in space.

    Source: Goldman (2005).

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> sp.simplify(rsym.gaussian_curvature(rsym.Shape(x**2 + y**2 - z, (x, y, z))).subs({x: 0, y: 0}))
    4
    """
    _require_space(shape, "gaussian_curvature")
    first, second = gradient(shape), hessian(shape)
    rows = [second.row(k) for k in range(3)]
    adjugate = Matrix.vstack(*(rows[(k + 1) % 3].cross(rows[(k + 2) % 3]) for k in range(3)))
    return first.dot(adjugate * first) / first.dot(first) ** 2


def principal_curvatures(shape: Shape) -> tuple[sp.Expr, sp.Expr]:
    """The principal curvatures k1 >= k2 of the level surfaces.

    k = H +- |T|/(2 sqrt(2) |g|**4) with T = G^T G Hs G + (G^T G Hs G)^T, where G v = g x v turns and projects tangent
    vectors and |T|**2 is the sum of the squares of the elements. |T|**2/(8 |g|**8) = H**2 - K, but a sum of squares
    cannot become negative by rounding: at an umbilic, where T = 0 and k1 = k2, nothing is imaginary.

    Raises
    ------
    RsymError
        For a shape that is not in space.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> cylinder = rsym.Shape(4 - x**2 - y**2, (x, y, z))
    >>> [k.subs({x: 2, y: 0, z: 7}) for k in rsym.principal_curvatures(cylinder)]
    [1/2, 0]
    """
    _require_space(shape, "principal_curvatures")
    first, second = gradient(shape), hessian(shape)
    turning = Matrix([first.cross(Matrix.eye(3).col(k)).T for k in range(3)]).T
    product = turning.T * turning * second * turning
    difference = product + product.T
    size = sp.sqrt(sp.Add(*(element**2 for element in difference)))
    radius = size / (2 * sp.sqrt(2) * first.dot(first) ** 2)
    middle = mean_curvature(shape)
    return middle + radius, middle - radius


def _require_space(shape: Shape, name: str) -> None:
    _require(shape, 3, name, "in the plane use curvature")


def _require(shape: Shape, dimension: int, name: str, remedy: str) -> None:
    require_shape(shape)
    if shape.dimension != dimension:
        names = ", ".join(symbol.name for symbol in shape.coordinates)
        raise RsymError(
            f"{name} needs a shape with {dimension} coordinates, got one with {names}", code="dimension", remedy=remedy
        )
