"""Formulas that many primitives share: of distances, by Rvachev's theorem, of powers; and the box around them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, number, positive, shown
from rsym.model.bounding import BoundingBox
from rsym.model.powers import absolute_power
from rsym.model.shape import Shape
from rsym.model.vectors import minus, squared


def within(squared: sp.Expr, radius: sp.Expr, exact: bool = False) -> sp.Expr:
    """(R**2 - d**2)/(2 R), of the square of a distance d; exact R - d.

    Normalised to order 1 without a root; exact to every order where d is a distance.

    Examples
    --------
    >>> from rsym import x, y
    >>> within(x**2 + y**2, 2), within(x**2 + y**2, 2, exact=True)
    (-x**2/4 - y**2/4 + 1, 2 - sqrt(x**2 + y**2))
    """
    return radius - sp.sqrt(squared) if exact else (radius**2 - squared) / (2 * radius)


def between(place: sp.Expr, lower: Any, upper: Any, letters: LetterMapping = None, exact: bool = False) -> sp.Expr:
    """(b - s)*(s - a)/(b - a): positive between a and b, normalised to order 1; exact (b - a)/2 - |s - (a + b)/2|.

    Raises
    ------
    RsymError
        Unless a < b.

    Examples
    --------
    >>> from rsym import z
    >>> between(z, 0, 2)
    z*(2 - z)/2
    """
    low, high = number(lower, "the lower end"), number(upper, "the upper end")
    sizes = default(low, letters, "the lower end"), default(high, letters, "the upper end")
    if sizes[0] >= sizes[1]:
        raise RsymError(
            f"the lower end must be below the upper one, got {shown(low, sizes[0])} and {shown(high, sizes[1])}",
            code="interval",
            remedy="exchange the two",
        )
    if exact:
        return (high - low) / 2 - sp.Abs(place - (low + high) / 2)
    return (high - place) * (place - low) / (high - low)


# Of the largest extent: meshers want the boundary inside the box, not on it.
ROOM = 0.1


def box_around(points: Iterable[Sequence[float]], *, solid: bool = True) -> BoundingBox:
    """The box that holds points, a tenth of its largest side wider everywhere.

    Examples
    --------
    >>> box_around([(0, 0), (2, 1)]).ends
    ((-0.2, 2.2), (-0.2, 1.2))
    """
    ends = [(min(axis), max(axis)) for axis in zip(*points, strict=True)]
    room = ROOM * max(high - low for low, high in ends)
    return BoundingBox(tuple((low - room, high + room) for low, high in ends), solid=solid, known=True)


def centred(centre: Point, halves: Point, letters: LetterMapping) -> BoundingBox:
    """The same for centre -+ halves where letters have their defaults."""
    middle = [default(component, letters, "the centre") for component in centre]
    reach = [default(half, letters) for half in halves]
    return box_around([[m + side * h for m, h in zip(middle, reach, strict=True)] for side in (-1, 1)])


def normalised(function: sp.Expr, squared: sp.Expr, length: Any = 1) -> sp.Expr:
    """L u/sqrt(u**2 + L**2 |grad u|**2): normalised to order 1 where u = 0 and grad u is not; at most L in size.

    `squared` is |grad u|**2 as a sum of terms that are visibly not negative;
    then a program holds the quotient as one operation.
    Source: Rvachev (1982).

    Examples
    --------
    >>> from rsym import x, y
    >>> normalised(x - y**2, 1 + 4 * y**2)
    (x - y**2)/sqrt(4*y**2 + (x - y**2)**2 + 1)
    """
    # In this order: SymPy would multiply a number into a sum that is not yet divided, and u would stand there no more.
    return length * (function / sp.sqrt(function**2 + length**2 * squared))


def by_differentiation(function: sp.Expr, coordinates: tuple[sp.Symbol, ...], length: Any = 1) -> sp.Expr:
    """The same of an analytic function, the gradient taken by SymPy.

    Examples
    --------
    >>> from rsym import x, y
    >>> by_differentiation(3 * x, (x, y))
    3*x/sqrt(9*x**2 + 9)
    """
    return normalised(function, squared(sp.diff(function, symbol) for symbol in coordinates), length)


def superquadric(
    coordinates: tuple[sp.Symbol, ...],
    axes: Point,
    exponent: sp.Expr,
    centre: Point,
    length: Any,
    letters: LetterMapping,
) -> Shape:
    """L*u/sqrt(u**2 + L**2*|grad u|**2) with u = 1 - |x/a|**n - |y/b|**n - ..., L by default the least semi-axis.

    Examples
    --------
    >>> from rsym import x, y
    >>> superquadric((x, y), (sp.Integer(1),) * 2, sp.Integer(2), (sp.Integer(0),) * 2, None, None).expression
    (-x**2 - y**2 + 1)/sqrt(4*x**2 + 4*y**2 + (-x**2 - y**2 + 1)**2)
    """
    least = min(axes, key=lambda axis: default(axis, letters))
    unit = least if length is None else positive(length, "the length", letters)
    ratios = [part / axis for part, axis in zip(minus(coordinates, centre), axes, strict=True)]
    function = 1 - sp.Add(*(absolute_power(ratio, exponent) for ratio in ratios))
    slopes = (
        (exponent / axis) ** 2 * absolute_power(ratio, 2 * exponent - 2)
        for ratio, axis in zip(ratios, axes, strict=True)
    )
    expression = normalised(function, sp.Add(*slopes), unit)
    return Shape(expression, coordinates, letters=letters, box=centred(centre, axes, letters))
