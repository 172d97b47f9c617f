"""Normalisation: from any equation of a boundary to one that measures distance near it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy as sp

from rsym.analysis.contracts.promises import Singularity
from rsym.analysis.contracts.summary import singularities
from rsym.analysis.contracts.table import Promises
from rsym.analysis.differential import derivative, gradient
from rsym.analysis.tensors import indices, partials, unit_index, weight
from rsym.errors import RsymError, warn
from rsym.model.arguments import LetterMapping, positive
from rsym.model.letters import as_letters
from rsym.model.nodes import ZeroWith
from rsym.model.primitives.formulas import normalised
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import as_expression, symbols_of, x, y, z
from rsym.model.vectors import squared

_LOGIC = frozenset({"conjunction", "disjunction", "equivalence", "joining", "SARDF"})


def normalise(shape: Shape, order: int = 1, length: Any = 1, *, keep_sign: bool = False) -> Shape:
    """The same boundary by a function omega_m that is the distance from it, up to terms of order m + 1.

    omega_1 = omega/sqrt(omega**2/L**2 + |grad omega|**2), and for m = 2, 3, ...

        omega_m = omega_(m-1) - omega_(m-1)**m * D_m omega_(m-1) / m!

    D_m f is the tensor of the m-th derivatives of f contracted m times with g = grad omega_(m-1), the sum over
    i1..im of (d^m f/dx_i1..dx_im)*g_i1*...*g_im; the operator g . grad applied m times would differentiate g
    as well, and is not meant. With the inner normal nu, on the boundary omega_m = 0, d omega_m/d nu = 1 and
    d^k omega_m/d nu^k = 0 for k = 2..m, wherever omega is smooth enough and grad omega is not zero. From m = 2 on
    the Laplacian there is minus the curvature of the boundary, in space minus twice its mean curvature.
    At the corners of R-operations, where derivatives do not exist, a compiled omega_m is 0, its limit.
    Far away omega_1 tends to the length L in absolute value; L = 1 is the form of the source. From order 2 on
    omega_m may vanish, and change its sign, where the correction is no longer small: at a distance from a smooth
    boundary, but from a corner on, for there the derivatives grow as it comes near. That is warned of. Remedies:
    `keep_sign`; or leaves of order m, distances for one, joined in ``Rp(p)`` with an even p > m, keep that order:
    half-planes in ``shape.with_system(Rp(4))`` are of order 3 (the strips of a rectangle are of order 1 only).

    With `keep_sign` the correction is damped by its own size. With r = omega_(m-1)**(m-1) * D_m omega_(m-1) / m!

        omega_m = omega_(m-1) * (1 - r/(1 + r**2))

    Sign: |r/(1 + r**2)| <= 1/2, so omega_m lies between omega_(m-1)/2 and 3/2 of it, and has the sign of omega
    everywhere. Order: it differs from the form above by omega_(m-1)*r**3/(1 + r**2), of order 3*m - 2 > m in
    omega_(m-1), so the derivatives to order m are the same on the boundary. Smoothness: 1 + r**2 is not zero, so it is
    of the class of the form above, C^(k-m) where omega_(m-1) is C^k, and analytic where that is.

    Parameters
    ----------
    shape : Shape
        A shape whose gradient does not vanish on its boundary.
    order : int
        m >= 1. omega_1 takes first derivatives of omega, and the step to order m takes m more.
    length : number or expression
        L > 0, in the unit of the coordinates.
    keep_sign : bool
        Whether omega_m has the sign of omega everywhere. No change at order 1, which always has it.

    Returns
    -------
    Shape
        The closed form, R-nodes kept, equal parts shared as objects but not by SymPy's printers: what is printed,
        expanded or simplified grows beyond use. Distinct parts at orders 1, 2, 3: an ellipse 20, 74, 1 200;
        the body of Fig. 11 59, 310, 36 000 (8 s); the car at order 2 8 200 (5 s), at order 3 out of reach. For numbers
        the fields ``normalised_2``, ``normalised_3``, ``normalised_2_keep_sign`` and so on of `compile` are the same
        functions with L = 1, derived in the program: with their gradients 1.5 to 15 times smaller (the car at order 2
        takes 62 000 operations).

    Warns
    -----
    RsymWarning
        For an order of 2 or more, without `keep_sign`, of a shape whose contract shows edges of R-operations.

    Raises
    ------
    RsymError
        For an order that is not a positive integer, or a length that is not positive.

    Source: Rvachev (1982); Shapiro and Suplin (1), (8); Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> rsym.normalise(rsym.Shape(3 * x, (x, y))).expression
    3*x/sqrt(9*x**2 + 9)
    >>> disc = rsym.Shape((1 - x**2 - y**2) / 2, (x, y))
    >>> unit = rsym.compile(rsym.normalise(disc, order=2), ("gradient_squared", "laplacian"))(0.6, 0.8)
    >>> round(float(unit["gradient_squared"]), 12), round(float(unit["laplacian"]), 12)
    (1.0, -1.0)
    >>> square = rsym.normalise(rsym.rectangle(2, 2), order=2, keep_sign=True)
    >>> square.contains([0.99, 1.01, 1.5], [0.99, 0.0, 1.5]).tolist()
    [True, False, False]
    """
    require_shape(shape)
    if isinstance(order, bool) or not isinstance(order, int) or order < 1:
        raise RsymError(f"the order must be a positive integer, got {order!r}", code="order", remedy="use order=1")
    unit = as_expression(length)
    if unit.is_number and not unit.is_positive:
        raise RsymError(f"the length must be positive, got {length}", code="length")
    corners = _corners(shape)
    if order > 1 and not keep_sign and any(len(corner.equations) == 2 for corner in corners):
        warn(_warning(order, len(corners)))
    result = normalised(shape.expression, squared(gradient(shape)), unit)
    for step in range(2, order + 1):
        result = _next_order(result, step, shape.coordinates, keep_sign=keep_sign)
    made = shape.replace(expression=ZeroWith(shape.expression, result) if corners else result)
    return replace(made, box=shape.box) if order == 1 or keep_sign else made  # of order 1 it has the same sign


def _corners(shape: Shape) -> list[Singularity]:
    """Where two operands of an R-operation vanish together or, of min and max, are equal."""
    lost = singularities(Promises(shape.expression), shape.coordinates, shape.letters)
    return [item for item in lost if item.operation in _LOGIC]


def _warning(order: int, count: int) -> str:
    places = "where operands of an R-operation vanish together" + (f", in {count} places of the formula" * (count > 1))
    return (
        f"the shape has corners or edges ({places}): normalised to order {order} omega may change its sign inside, "
        f"beginning at them; remedy: normalise(..., keep_sign=True), or make the shape of leaves of order {order} and "
        f"take shape.with_system(Rp({order + 1 + (order + 1) % 2})), which keeps their order"
    )


def _next_order(lower: sp.Expr, order: int, coordinates: tuple[sp.Symbol, ...], *, keep_sign: bool) -> sp.Expr:
    """omega_m from omega_(m-1)."""
    size = len(coordinates)
    found = partials(lower, order, coordinates, derivative)
    slopes = [found[unit_index(size, axis)] for axis in range(size)]
    terms = []
    for index in indices(size, order):
        share = weight(index)
        powers = (slope**count for slope, count in zip(slopes, index, strict=True))
        terms.append(sp.Mul(sp.Rational(share.numerator, share.denominator), found[index], *powers))
    correction = lower**order * sp.Add(*terms)
    if keep_sign:
        correction /= 1 + (lower ** (order - 1) * sp.Add(*terms)) ** 2
    return lower - correction


def implicit(
    expression: Any,
    coordinates: Any = None,
    length: Any = 1,
    *,
    letters: LetterMapping = None,
    bounds: Any = None,
) -> Shape:
    """Where an expression is positive: L*u/sqrt(u**2 + L**2*|grad u|**2), Rvachev's theorem for any u.

    Normalised to order 1 wherever u is differentiable and its gradient is not zero on the boundary. It has one
    derivative less than u, and nothing is gained at corners of u, where it keeps its value 0 but has no gradient.
    Far away it tends to L in absolute value.

    Parameters
    ----------
    expression : SymPy expression or Shape
        u; R-nodes are kept. A shape brings its coordinates, letters and bounds.
    coordinates : sequence of symbols, optional
        By default (x, y, z) if z is in the expression and no letter, else (x, y).
    length : number or expression
        L > 0, in the unit of the coordinates.
    letters : mapping, optional
        ``{symbol or name: number or Letter}`` for every other symbol.
    bounds : sequence of pairs, optional
        The box that holds what is of interest.

    Raises
    ------
    RsymError
        For an expression without coordinates, coordinates given for a shape, or a length that is not positive.

    Source: Rvachev (1982).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> rsym.implicit(y - x**2).expression
    (-x**2 + y)/sqrt(4*x**2 + (-x**2 + y)**2 + 1)
    >>> rsym.implicit(z * x - 1).coordinates
    (x, y, z)
    """
    if isinstance(expression, Shape):
        if coordinates is not None:
            raise RsymError("a shape has coordinates of its own", code="coordinates", remedy="leave coordinates out")
        shape = expression.replace(letters=expression.letters.merge(letters), bounds=bounds)
    else:
        shape = _shape(expression, coordinates, letters, bounds)
    if not set(symbols_of(shape.expression)) & set(shape.coordinates):
        raise RsymError(f"the expression {shape.expression} has no coordinate in it", code="implicit")
    return normalise(shape, 1, positive(length, "the length", shape.letters))


def _shape(expression: Any, coordinates: Any, letters: LetterMapping, bounds: Any) -> Shape:
    expression = as_expression(expression)
    if coordinates is None:
        in_space = z.name in {symbol.name for symbol in symbols_of(expression)} - as_letters(letters).keys()
        coordinates = (x, y, z) if in_space else (x, y)
    return Shape(expression, coordinates, letters=letters, bounds=bounds)
