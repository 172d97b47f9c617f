"""Corner functions as expressions, for print: in the two leaves, whose letters stay."""

from __future__ import annotations

import math
from fractions import Fraction

import sympy as sp

from rsym.logic.sign_form import shape_form
from rsym.model.shape import Shape
from rsym.problems.corners.corner_functions import CornerFunctions, LocalFunctions, Term
from rsym.problems.corners.growth import MOST, Growth
from rsym.problems.corners.leaf_jets import Bend, StraightEdge
from rsym.program.raising import raised

LARGEST = 24  # denominator of a part of pi that an angle is taken for
SAME = 1e-12


def formulas(shape: Shape, functions: CornerFunctions[LocalFunctions]) -> tuple[sp.Expr, ...]:
    """The functions as expressions in the coordinates and letters of their shape.

    They are 0 on both edges for other letters too, but where a tangent stands for a leaf; angle, place, radius and
    lengths of gradients are those numbers that the functions were made with.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.problems.corners.corners import corners
    >>> from rsym.problems.corners.corner_functions import corner_functions
    >>> shape = rsym.Shape(rsym.conjunction(x, y, 1 - x, 1 - y), (x, y))
    >>> (first, *_) = formulas(shape, corner_functions(shape, corners(shape)[:1], levels=1, highest=2.0))
    >>> first.subs({x: sp.Rational(3, 10), y: 0}), round(first.subs({x: 0.1, y: 0.2}), 6)
    (0, 0.006687)
    """
    form = shape_form(shape)
    u, v = shape.coordinates
    found = []
    for part in functions.parts:
        first, second = (
            raised(form.builder.nodes, form.leaves[leaf]) if line is None else _tangent(line, u, v)
            for leaf, line in zip(part.corner.leaves, part.corner.lines, strict=True)
        )
        away = u - _number(part.corner.point[0]), v - _number(part.corner.point[1])
        if part.jets.bends:
            first, second = (
                leaf * _bend(bend, *away) for leaf, bend in zip((first, second), part.jets.bends, strict=True)
            )
        grown = sp.S.One if part.growth is None else _growth(part.growth, *away)
        found += _of_corner(part, first, second, away[0] ** 2 + away[1] ** 2, grown)
    return tuple(found)


def _bend(bend: Bend, x: sp.Expr, y: sp.Expr) -> sp.Expr:
    s = _number(bend.slope[0]) * x + _number(bend.slope[1]) * y
    return 1 + s / sp.sqrt(1 + 4 * s**2)


def _growth(growth: Growth, x: sp.Expr, y: sp.Expr) -> sp.Expr:
    (p, q), (xx, xy, yy) = (map(_number, numbers) for numbers in (growth.slope, growth.bend))
    log = p * x + q * y + (xx * x**2 + 2 * xy * x * y + yy * y**2) / 2
    return sp.exp(log / sp.sqrt(1 + (log / sp.Rational(MOST)) ** 2))


def _of_corner(part: LocalFunctions, first: sp.Expr, second: sp.Expr, away: sp.Expr, grown: sp.Expr) -> list[sp.Expr]:
    corner, alpha = part.corner, _angle(part.corner.angle)
    v, w = (leaf / _number(math.hypot(*slope)) for leaf, slope in zip((first, second), corner.gradients, strict=True))
    u = second if corner.is_flat else (w + v * sp.cos(alpha)) / sp.sin(alpha)
    squared = u**2 + v**2
    half = alpha / 2
    theta = half + sp.atan2(v * sp.cos(half) - u * sp.sin(half), u * sp.cos(half) + v * sp.sin(half))
    factor = (1 - squared / _number(part.radius) ** 2) ** part.power
    inside = [(squared, _number(part.radius) ** 2), (away, _number(corner.reach) ** 2)]
    if not corner.alone:
        inside += [(-theta, 0), (theta, alpha)]
    found = []
    for term in part.terms:
        value = grown * factor * _term(term, alpha, squared, v, alpha - theta if part.turned else theta, theta)
        for small, large in inside:
            value = sp.Piecewise((value, small < large), (0, True))
        found.append(value)
    return found


def _tangent(line: StraightEdge, u: sp.Expr, v: sp.Expr) -> sp.Expr:
    (a, b), (p, q) = line
    return _number(p) * (u - _number(a)) + _number(q) * (v - _number(b))


def _term(term: Term, alpha: sp.Expr, squared: sp.Expr, v: sp.Expr, angle: sp.Expr, theta: sp.Expr) -> sp.Expr:
    if term.kind == "log":
        imaginary = squared * (sp.log(squared) / 2 * sp.sin(2 * theta) + theta * sp.cos(2 * theta))
        return squared ** round((term.exponent - 2) / 2) * (-(v**2) / 2 - imaginary / (2 * alpha))
    rate = sp.Rational(round(2 * term.rate * float(alpha) / math.pi), 2) * sp.pi / alpha
    wave = sp.sin if term.kind == "sin" else sp.cos
    return squared ** ((rate + round(term.exponent - term.rate)) / 2) * wave(rate * angle)


def _angle(angle: float) -> sp.Expr:
    """An angle, exactly if it is a simple part of pi."""
    share = Fraction(angle / math.pi).limit_denominator(LARGEST)
    return sp.Rational(share) * sp.pi if abs(share * math.pi - angle) < SAME else _number(angle)


def _number(value: float) -> sp.Expr:
    """A number, exactly if it is whole."""
    return sp.Integer(round(value)) if value == round(value) else sp.Float(value, 17)
