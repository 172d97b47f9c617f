"""Where the curves of a skeleton run: read off its expression, whatever motions it went through."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import sympy as sp
from sympy.solvers.solveset import NonlinearError

from rsym.errors import RsymError
from rsym.model.arguments import Point, default
from rsym.model.equivalences import Joining
from rsym.model.letters import Letter
from rsym.model.nodes import Trimming
from rsym.model.primitives.curve_nodes import PARAMETER, CurveField, CurvePath
from rsym.model.traversal import substitute, symbols_of


def paths(expression: sp.Expr, coordinates: tuple[sp.Symbol, ...], letters: Mapping[str, Letter]) -> list[CurvePath]:
    """The ways of the curves whose joined field this is.

    Segments, arcs, circles and helices with ends, also moved, scaled and joined; and lines that are trimmed:
    trimming(f, t) with the square of f of degree 2 and t concave on the line.

    Raises
    ------
    RsymError
        For anything else.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> [way.ends for way in paths(rsym.trimming(y, 4 - x**2), (x, y), {})]
    [((-2, 0), (2, 0))]
    """
    return [way for curve in _curves(expression, coordinates) for way in _ways(curve, coordinates, letters)]


def _curves(expression: sp.Expr, coordinates: tuple[sp.Symbol, ...]) -> Iterator[sp.Expr]:
    """The curves that are joined, without factors that do not vary."""
    if isinstance(expression, sp.Mul):
        varying = [factor for factor in expression.args if set(coordinates) & factor.free_symbols]
        if len(varying) == 1:
            yield from _curves(varying[0], coordinates)
            return
    if isinstance(expression, Joining):
        for operand in expression.operands:
            yield from _curves(operand, coordinates)
    else:
        yield expression


def _ways(curve: sp.Expr, coordinates: tuple[sp.Symbol, ...], letters: Mapping[str, Letter]) -> list[CurvePath]:
    try:
        if isinstance(curve, CurveField) and curve.paths():
            return [_moved(way, curve.vector(0), coordinates) for way in curve.paths()]
        if isinstance(curve, Trimming):
            f, t = curve.args
            return [_trimmed(f, t, coordinates, letters)]
    except (NonlinearError, sp.PolynomialError) as error:
        raise _unknown(curve) from error
    raise _unknown(curve)


def _unknown(curve: sp.Expr) -> RsymError:
    return RsymError(
        f"it is not known where the curve {sp.sstr(curve)[:80]} runs",
        code="no-condition",
        remedy="build the skeleton of segments, arcs, circles and helices with ends, moved and joined; "
        "a profile without coordinates is positive on every curve where it is positive",
    )


def _moved(way: CurvePath, places: Point, coordinates: tuple[sp.Symbol, ...]) -> CurvePath:
    """The way in the coordinates, where the curve knows it in places = A coordinates - shift."""
    if places == coordinates:
        return way
    matrix, shift = sp.linear_eq_to_matrix(list(places), *coordinates)
    inverse = matrix.adjugate() / sp.simplify(matrix.det())

    def back(point: Point) -> Point:
        return tuple(inverse * (sp.Matrix(point) + shift))

    return CurvePath(back(way.point), way.low, way.high, (back(way.ends[0]), back(way.ends[1])))


def _trimmed(f: sp.Expr, t: sp.Expr, coordinates: tuple[sp.Symbol, ...], letters: Mapping[str, Letter]) -> CurvePath:
    """The part of the line f = 0 where t >= 0: f**2 is of degree 2, and its gradient is zero on the line."""
    square = sp.Poly(f**2, *coordinates)
    slopes = [square.diff(symbol).as_expr() for symbol in coordinates]
    matrix, right = sp.linear_eq_to_matrix(slopes, *coordinates)
    (line,) = sp.linsolve((matrix, right), *coordinates)
    free = set(coordinates) & set(symbols_of(*line))
    inside = sp.Poly(substitute(t, dict(zip(coordinates, line, strict=True))), *free)
    if len(free) != 1 or inside.degree() != 2:
        raise _unknown(Trimming(f, t))
    (along,) = free
    a, b, c = inside.all_coeffs()
    root = sp.sqrt(sp.factor(b**2 - 4 * a * c))
    if default(a, letters) >= 0 or default(b**2 - 4 * a * c, letters) <= 0:
        raise _unknown(Trimming(f, t))
    first, last = (
        tuple(sp.simplify(substitute(item, {along: (-b + sign * root) / (2 * a)})) for item in line) for sign in (1, -1)
    )
    point = tuple(p + PARAMETER * (q - p) for p, q in zip(first, last, strict=True))
    return CurvePath(point, sp.S.Zero, sp.S.One, (first, last))
