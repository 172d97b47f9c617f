"""Bodies of revolution: the meridian decides.

Off the axis a body is as smooth as its meridian. On the axis, which the meridian F(x, r) crosses at a right angle,
the body is the graph of g(sqrt(y**2 + z**2)), of class C^k exactly where the even continuation of g to negative r
is. So the meridian is studied with its mirror image, r of either sign; F = F(x, r**2) with F smooth is smooth
there, evenness alone is not enough: 1 - |r| - x**2 is even and revolves into a cone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.model.symbols import rebuild, symbols_of


def meridian(shape: Shape) -> tuple[Shape, int]:
    """The meridian of a body of revolution in (axis, radius), and which coordinate is the axis.

    The radius keeps the name of the first coordinate across the axis.

    Raises
    ------
    RsymError
        If the equation is not seen to depend on two coordinates through the sum of their squares alone.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> body = rsym.revolve(rsym.Shape(4 - x**2 - 2 * y**2, (x, y)))
    >>> meridian(body)[0].expression
    -x**2 - 2*y**2 + 4
    """
    found = find_meridian(shape)
    if found is None:
        raise RsymError(
            "the body is to be judged by its meridian, and it is not seen to be a body of revolution",
            code="dimension",
            remedy='give the plane profile, a body made by rsym.revolve(profile), or method="space"',
        )
    return found


def find_meridian(shape: Shape) -> tuple[Shape, int] | None:
    """The meridian and the axis as above; None if the equation does not show them."""
    for axis in range(3):
        along = shape.coordinates[axis]
        first, second = (symbol for symbol in shape.coordinates if symbol != along)
        expression = in_radius(shape.expression, first, second)
        if expression is not None:
            box = shape.box and shape.box.mapped(partial(_profile, axis))
            return Shape(expression, (along, first), letters=shape.letters, box=box), axis
    return None


def _profile(axis: int, ends: Any) -> Any:
    """A box in space as one of the meridian: up to the edges, which are the farthest from the axis."""
    reach = math.hypot(*(max(map(abs, ends[k])) for k in range(3) if k != axis))
    return ends[axis], (-reach, reach)


def in_radius(expression: sp.Expr, first: sp.Symbol, second: sp.Symbol) -> sp.Expr | None:
    """The expression with c*y**2 + c*z**2 replaced by c*r**2, r written as the first symbol; None if more is left."""
    radius = sp.Dummy("r", real=True)

    def collected(part: sp.Basic) -> sp.Basic | None:
        return _collected(part.args, first, second, radius) if part.is_Add else None

    result = rebuild(expression, collected)
    if {first, second} & set(symbols_of(result)):
        return None
    return rebuild(result, lambda part: first if part == radius else None)


def _collected(terms: Sequence[sp.Expr], first: sp.Symbol, second: sp.Symbol, radius: sp.Symbol) -> sp.Expr | None:
    coefficients: dict[sp.Symbol, list[sp.Expr]] = {first: [], second: []}
    rest = []
    for term in terms:
        for symbol, found in coefficients.items():
            coefficient = term / symbol**2
            if not {first, second} & coefficient.free_symbols:
                found.append(coefficient)
                break
        else:
            rest.append(term)
    if not coefficients[first] or set(coefficients[first]) != set(coefficients[second]):
        return None
    return sp.Add(*rest, *(coefficient * radius**2 for coefficient in coefficients[first]))
