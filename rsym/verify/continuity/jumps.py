"""How much two ends of curves differ, by balls."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeAlias

import sympy as sp

from rsym.bounds.ball_arithmetic import degrees
from rsym.bounds.balls import arb, root, square
from rsym.verify.boxes.constants import enclosed, measured, norm, precise
from rsym.verify.continuity.curves import End, all_vanish, determinant, dot, minors

Balls: TypeAlias = Sequence[Any] | None


def turn(before: End, after: End) -> Any | None:
    """The angle between the tangents of two ends in degrees, from its sine and cosine.

    Examples
    --------
    >>> zero, one = sp.Integer(0), sp.Integer(1)
    >>> round(float(turn(End((), (one, zero)), End((), (zero, one))).mid()), 12)
    90.0
    """
    if before.tangent is None or after.tangent is None:
        return None
    sine, cosine = norm(minors(before.tangent, after.tangent)), enclosed(dot(before.tangent, after.tangent))
    if sine is None or cosine is None:
        return None
    return degrees(sine, cosine)


def bend(end: End, flat: bool) -> Balls:
    """The signed curvature in the plane, the curvature vector in space; None where there is none.

    Examples
    --------
    >>> bend(End((), (sp.Integer(2), sp.Integer(0)), (sp.Integer(0), sp.Integer(-3))), flat=True)[0] == -3
    True
    """
    if end.tangent is None or end.curvature is None:
        return None
    if not flat:
        return _balls(end.curvature)
    area, speed = _balls(minors(end.tangent, end.curvature)), norm(end.tangent)
    return None if area is None or speed is None else [area[0] / speed]


def slope(end: End, flat: bool) -> Balls:
    """dkappa/ds in the plane, p_sss in space; None where there is none.

    Examples
    --------
    >>> zero, two = sp.Integer(0), sp.Integer(2)
    >>> slope(End((), (two, zero), (zero, zero), (zero, two)), flat=True)[0] == 1
    True
    """
    if end.tangent is None or end.rate is None:
        return None
    if flat:
        return _balls([minors(end.tangent, end.rate)[0] / dot(end.tangent, end.tangent)])
    rate, speed = _balls(end.rate), norm(end.tangent)
    return None if rate is None or speed is None else [component / speed for component in rate]


def _balls(vector: Sequence[sp.Expr]) -> Balls:
    found = [enclosed(component) for component in vector]
    return None if None in found else found


def distance(a: Balls, b: Balls) -> Any | None:
    """The length of the difference of two vectors; None if one of them is not known.

    Examples
    --------
    >>> distance([arb(0), arb(3)], [arb(4), arb(0)]) == 5
    True
    """
    if a is None or b is None:
        return None
    return root(sum((square(v - u) for u, v in zip(a, b, strict=True)), arb(0)))


def curvature(end: End, flat: bool) -> float:
    """The curvature as a float, signed in the plane; infinite where it is unbounded, NaN where it is not known.

    Examples
    --------
    >>> curvature(End((), unbounded=True), flat=True)
    inf
    """
    if end.unbounded:
        return math.inf
    with precise():
        found = bend(end, flat)
    if found is None:
        return math.nan
    return measured(found[0] if flat else norm(end.curvature or ()))[0]


def torsion(end: End) -> float:
    """det(p_s, p_ss, p_sss)/kappa^2 as a float; NaN where the curve is straight, and in the plane.

    Examples
    --------
    >>> from rsym.verify.continuity.curves import Curve, end_of
    >>> t = sp.Symbol("t")
    >>> torsion(end_of(Curve((sp.cos(t), sp.sin(t), t), t, 0, 1), at_start=True))
    0.5
    """
    if len(end.point) == 2 or end.tangent is None or end.curvature is None or end.rate is None:
        return math.nan
    if all_vanish(end.curvature) is not False:
        return math.nan
    volume = determinant(end.tangent, end.curvature, end.rate)
    return measured(enclosed(volume / dot(end.tangent, end.tangent) / dot(end.curvature, end.curvature)))[0]
