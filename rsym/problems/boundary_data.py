"""Values on the boundary whose formula is rough inside: kept to where they are given.

x/(x**2 + y**2) is smooth on the unit circle, and has a pole in the middle, where nobody gave it. What goes on inside is
a matter of choice: instead of the value v stands v (1 - (w/d)**2)**6 within the distance d of the boundary, w being its
normalised weight, and 0 beyond. On the boundary nothing changes; d is half of how near to it v is rough.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import sympy as sp

from rsym.analysis.differential import derivative
from rsym.analysis.transfinite import zero_with
from rsym.arrays import Flags, Floats
from rsym.backends.kernel import compile
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, symbols_of
from rsym.problems.conditions import Name
from rsym.problems.parts import parts_of

# Third derivatives inside, by the size of the shape and how large values are, against those on the boundary: what is
# smooth on it is steeper than so only where it has a pole, a root or a jump.
ROUGH, LEAST = 30.0, 1e3
LATTICE = 48  # places along each axis
SHARE, POWER = 1.0, 6
NEAREST = 0.02  # of the size of the shape


def kept_to_boundary(shape: Shape, data: Mapping[Name, sp.Expr]) -> dict[Name, sp.Expr]:
    """The data, those that are rough inside made 0 there.

    Raises
    ------
    RsymError
        For data that are rough beside the boundary, and smooth on it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> kept_to_boundary(rsym.disc(1), {...: sp.exp(x)})[...]
    exp(x)
    >>> pole = kept_to_boundary(rsym.disc(1), {...: x / (x**2 + y**2)})[...]
    >>> pole.subs({x: 0, y: 1}), pole.subs({x: 0.1, y: 0.1})
    (0, 0)
    """
    doubtful = {name: value for name, value in data.items() if _is_doubtful(value, shape)}
    if not doubtful:
        return dict(data)
    parts = parts_of(shape, data)
    weight = parts.smooth_weights().of([leaf for leaves in parts.leaves.values() for leaf in leaves])
    size = float(np.diff(parts.box, axis=1).max())
    axes = [np.linspace(low, high, LATTICE + 1)[:-1] + (high - low) / (2.3 * LATTICE) for low, high in parts.box]
    places = np.stack([axis.ravel() for axis in np.meshgrid(*axes)], axis=1)
    away = _values(shape, weight, places)
    inside = _values(shape, shape.expression, places) > 0
    found = dict(data)
    for name, value in doubtful.items():
        if name not in parts.leaves:
            continue
        bad = inside & _rough(shape, value, places, parts.points(name), size)
        if not bad.any():
            continue
        near = float(away[bad].min())
        if near < NEAREST * size:
            continue  # on the boundary itself: these are data with corners of their own
        reach = sp.Float(SHARE * near)
        ends = sp.Max(0, 1 - (weight / reach) ** 2) ** POWER
        found[name] = zero_with(ends, value * ends)
    return found


def _is_doubtful(value: sp.Expr, shape: Shape) -> bool:
    """Whether a formula may have poles, roots or jumps: it has more than sums, products and entire functions."""
    if not {*symbols_of(value)} & {*shape.coordinates}:
        return False
    plain = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh)
    return any(
        not (isinstance(part, plain) or (part.is_Pow and part.exp.is_Integer and part.exp > 0))
        for part in postorder(value)
        if isinstance(part, sp.Function | sp.Pow) and not part.is_number
    )


def _values(shape: Shape, expression: sp.Expr, places: Floats) -> Floats:
    with np.errstate(all="ignore"):
        return np.asarray(compile(shape.replace(expression=expression), backend="numpy")(*places.T)["value"])


def _rough(shape: Shape, value: sp.Expr, places: Floats, on: Floats, size: float) -> Flags:
    """Where third derivatives are far beyond those at points of the boundary, or there are none."""
    usual, most, third = np.abs(_values(shape, value, on)).max(), 0.0, np.zeros(len(places))
    for symbol in shape.coordinates:
        steeper = shape.replace(expression=derivative(value, symbol))
        kernel = compile(steeper, ("hessian",), backend="numpy")
        with np.errstate(all="ignore"):
            most = max(most, np.abs(kernel(*on.T)["hessian"]).max())
            third = np.maximum(third, np.abs(kernel(*places.T)["hessian"]).max(axis=(1, 2)))
    if not np.isfinite(most):
        return np.zeros(len(places), np.bool_)
    rough: Flags = ~(third * size**3 <= max(ROUGH * most * size**3, LEAST * usual))
    return rough
