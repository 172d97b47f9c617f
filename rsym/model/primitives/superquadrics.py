"""Ellipses, ellipsoids and their kin: 1 less the powers of the coordinates over semi-axes."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.model.arguments import LetterMapping, Point, default, positive
from rsym.model.powers import absolute_power
from rsym.model.primitives.extents import centred
from rsym.model.primitives.theorem import normalised
from rsym.model.shape import Shape
from rsym.model.vectors import minus


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
    return Shape(expression, coordinates, letters=letters, bounds=centred(centre, axes, letters))
