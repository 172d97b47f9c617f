"""What lies nearer than a radius, and what lies between two places: fields of many primitives."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, number, shown


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


def between(place: sp.Expr, lower: Any, upper: Any, letters: LetterMapping = None) -> sp.Expr:
    """(b - s)*(s - a)/(b - a): positive between a and b, normalised to order 1.

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
    return (high - place) * (place - low) / (high - low)
