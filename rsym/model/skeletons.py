"""Blending on a skeleton: a body around curves, as thick as a profile says."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import sympy as sp
from sympy.logic.boolalg import Boolean
from sympy.solvers.solveset import NonlinearError

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, number
from rsym.model.bounding import BoundingBox
from rsym.model.equation import combine
from rsym.model.letters import Letter, Letters
from rsym.model.nodes import Trimming
from rsym.model.positivity import positive_polynomial
from rsym.model.primitives.curve_nodes import PARAMETER, CurveField, CurvePath
from rsym.model.rnodes import Joining
from rsym.model.shape import Shape
from rsym.model.symbols import substitute, symbols_of

ROOM = (
    2  # times the profile, free around a skeleton: enough for four curves that meet, and for profiles up to slope 1/2
)
SAMPLES = 4  # parts of a curve, at the ends of which its profile is looked at


def blend_on_skeleton(skeleton: Shape, profile: Any, *, letters: LetterMapping = None) -> Shape:
    """The body around a skeleton: omega = h - f_o, f_o the field of the skeleton and h the profile.

    Where h is a number the boundary is the level line, or surface, f_o = h: an offset body. It is analytic where it
    does not meet the skeleton, `analytic_condition`, and the gradient of omega is not zero; not normalised.
    Its bounds are those of the skeleton with twice the largest profile on it free all around, which is an estimate:
    `extent` proves bounds.
    Source: Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Parameters
    ----------
    skeleton : Shape
        Zero on curves and positive elsewhere: `segment`, `polyline`, `graph`, `arc`, `circle`, `helix`,
        `space_curve` or what `joining` makes of them.
    profile : Shape, expression or number
        About how thick the body is: half its width.
    letters : mapping, optional
        The values of letters in the profile that are not in the skeleton.

    Raises
    ------
    RsymError
        For a skeleton that is no shape, or letters without value.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x
    >>> from rsym.model.primitives.curves import segment
    >>> rod = segment((-5, 0), (5, 0))
    >>> fish = blend_on_skeleton(rod, (8 - x) * (6 + x) / 40)
    >>> float(rsym.compile(fish)(-6.0, 0.0)["value"])
    -1.1
    >>> rsym.verify_smoothness(fish).verdict
    'CERTIFIED'
    """
    thickness = _profile(skeleton, profile, letters)
    body: Shape = combine(lambda f, h: h - f, skeleton, thickness)
    box = _box(skeleton, thickness.expression, body.letters)
    return Shape(body.expression, body.coordinates, letters=body.letters, box=box, parts=body.parts)


def analytic_condition(skeleton: Shape, profile: Any, *, letters: LetterMapping = None) -> Boolean:
    """What letters must fulfil for the boundary of `blend_on_skeleton` to keep off its skeleton: h > 0 all along it.

    The field of a skeleton is analytic off the skeleton. So, with a profile that is a polynomial or a quotient of
    polynomials, the boundary is analytic under this condition wherever the gradient of omega is not zero, which
    `verify_smoothness` proves at values of the letters. Where a curve meets h = 0 the body ends in a tip.

    The profile is a polynomial along segments, up to degree 3 if it has letters, as far as what their ranges settle
    (a concave profile is positive if it is at both ends); along arcs, by the tangent of half the angle, its degree
    is twice as high, half of that if it is even about their middle. Without letters any degree is decided.

    Returns
    -------
    Boolean
        Inequalities between expressions in letters; true or false without letters.

    Raises
    ------
    RsymError
        ``no-condition`` for a profile or a skeleton of another kind.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x
    >>> from rsym.model.primitives.curves import segment
    >>> a, r = sp.symbols("a r", real=True)
    >>> rod = segment((-a, 0), (a, 0), letters={a: 5})
    >>> analytic_condition(rod, r - x / 10, letters={r: 1})
    (-a/10 + r > 0) & (a/10 + r > 0)
    """
    thickness = _profile(skeleton, profile, letters)
    coordinates, h = skeleton.coordinates, thickness.expression
    if not set(coordinates) & set(symbols_of(h)):
        return h > 0
    merged = skeleton.letters.merge(thickness.letters)
    ways = paths(skeleton.expression, coordinates, merged)
    return sp.And(*(_along(way, h, coordinates, merged) for way in ways))


def _profile(skeleton: Any, profile: Any, letters: LetterMapping) -> Shape:
    if not isinstance(skeleton, Shape):
        raise RsymError(
            f"a skeleton must be a shape, got {type(skeleton).__name__} {skeleton!r}",
            code="skeleton",
            remedy="for example rsym.primitives.segment((-1, 0), (1, 0))",
        )
    if isinstance(profile, Shape):
        return profile
    known = skeleton.letters.merge(letters)
    return Shape(number(profile, "the profile"), skeleton.coordinates, letters=known)


def _box(skeleton: Shape, h: sp.Expr, letters: Letters) -> BoundingBox | None:
    """Room for the body: where curves meet, and beyond ends, it is thicker than the profile."""
    varies = bool(set(skeleton.coordinates) & set(symbols_of(h)))
    if skeleton.box is None:
        return None
    places = []
    if varies:
        try:
            ways = paths(skeleton.expression, skeleton.coordinates, letters)
        except RsymError:
            return None
        shares = [sp.Rational(k, SAMPLES) for k in range(SAMPLES + 1)]
        places = [way.at(share) for way in ways for share in shares]
    values = [substitute(h, dict(zip(skeleton.coordinates, place, strict=True))) for place in places] or [h]
    room = ROOM * max(0.0, *(default(value, letters, "the profile") for value in values))
    grown = skeleton.box.mapped(lambda ends: tuple((low - room, high + room) for low, high in ends), stated=False)
    return replace(grown.likely, solid=True)


def _along(way: CurvePath, h: sp.Expr, coordinates: tuple[sp.Symbol, ...], letters: Mapping[str, Letter]) -> Boolean:
    """That h is positive along a way."""

    def at(place: tuple[sp.Expr, ...]) -> sp.Expr:
        return substitute(h, dict(zip(coordinates, place, strict=True)))

    first, last = (at(place) for place in way.ends)
    if any(value.has(sp.zoo, sp.nan, sp.oo) for value in (first, last)):
        return sp.false
    try:
        polynomial = _signed_alike(at(way.point), way)
    except sp.PolynomialError as error:
        raise RsymError(
            f"the profile {h} is no polynomial along the skeleton",
            code="no-condition",
            remedy="take a polynomial, or a quotient of polynomials, in the coordinates; or ask verify_smoothness",
        ) from error
    return positive_polynomial(polynomial, way.low, way.high, letters, (first, last))


def _signed_alike(value: sp.Expr, way: CurvePath) -> sp.Poly:
    """A polynomial with the sign of a quotient: what may change its sign below stands above."""
    top, bottom = sp.fraction(sp.together(sp.trigsimp(value) if value.has(sp.cos, sp.sin) else value))
    for factor in sp.Mul.make_args(bottom):
        base, exponent = factor.as_base_exp()
        size = sp.cancel(base / (1 + PARAMETER**2))  # what quotients by the tangent of half an angle have below
        if not size.has(PARAMETER):
            top = top / size**exponent
        elif not factor.has(PARAMETER):
            top = top / factor
        else:
            top = top * (_sign(sp.Poly(base, PARAMETER), way) ** exponent or factor)
    return sp.Poly(top, PARAMETER)


def _sign(polynomial: sp.Poly, way: CurvePath) -> int:
    """1 or -1 if that is its sign all along the way whatever the letters; else 0."""
    if symbols_of(*polynomial.coeffs(), way.low, way.high):
        return 0
    signs = (sign for sign in (1, -1) if positive_polynomial(sign * polynomial, way.low, way.high) == sp.true)
    return next(signs, 0)


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
