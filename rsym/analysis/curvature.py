"""Curvatures of the level sets of a shape in closed form, R-nodes kept.

With omega > 0 inside, every curvature is positive where the inside is convex.
Source: Goldman, Curvature formulas for implicit curves and surfaces, CAGD 22 (2005) 632-658.
"""

from __future__ import annotations

import sympy as sp

from rsym.analysis.differential import Matrix, gradient, hessian
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape


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
