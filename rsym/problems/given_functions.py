"""Values that a Python function has on the boundary, as formulas: polynomials that are its values there.

Formulas are asked for derivatives all over the shape, and a function is known where it was given: the polynomial is
fitted to what it says at points of the boundary, with coefficients as small as can be, those of high degrees before
all. At other points of the boundary it is asked how far off that is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from functools import reduce
from itertools import product
from typing import Any, NamedTuple

import numpy as np
import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Clamped, Dirichlet, Supported, Switched
from rsym.arrays import Flags, Floats
from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.model.equation import Equation
from rsym.model.shape import Shape
from rsym.problems.conditions import Name, assigned
from rsym.problems.corners.corners import surveyed_corners
from rsym.problems.pointwise import first_place, require_numbers, values_of
from rsym.problems.problem import vanished
from rsym.sampling.rules.quadrature import prepared

CELLS, ORDER = {2: 32, 3: 8}, 4  # of the rule whose points on the boundary are asked, every other one in the fit
DEGREES = {2: (4, 8, 12, 16, 20, 24, 32), 3: (2, 4, 6, 8, 10)}
ENOUGH = 1e-11  # of the largest value
SINGULAR = 1e-14  # of the largest singular value, below which others are left out
AT_CORNERS = 1e3  # times as much as other points: data of parts have to agree there
INNER, INSIDE = 1000, 0.01  # points inside, which keep a polynomial tame where the function is smooth, and their weight
LESS = 0.5  # of the error: what more terms have to be worth
TAME = 10.0  # times the largest value on the boundary, inside: what is beyond tells nothing of the function
MOST = 0.01  # of the largest value: what is further off than so is no function that polynomials have to do with


def as_formulas(
    shape: Shape, conditions: Mapping[Name, BoundaryCondition]
) -> tuple[dict[Name, BoundaryCondition], float]:
    """Conditions whose values are formulas, and how far off these are at most, as a share of the largest value.

    Raises
    ------
    RsymError
        For functions that are not defined on the boundary, or that jump there, or have kinks or waves beyond measure.

    Examples
    --------
    >>> import rsym
    >>> found, off = as_formulas(rsym.disc(1), {...: rsym.dirichlet(lambda x, y: x / (x**2 + y**2))})
    >>> places = dict(zip(rsym.disc(1).coordinates, (0.6, 0.8)))
    >>> abs(found[...].value.subs(places) - 0.6) < 1e-9, off < 1e-9
    (True, True)
    """
    found, off = dict(conditions), [0.0]

    def formula_on(name: Name) -> Callable[[Any], Any]:
        def of(value: Any) -> Any:
            if isinstance(value, BoundaryCondition):
                return _with_values(value, of)
            if not callable(value) or isinstance(value, sp.Basic | Equation):
                return value
            made, error = _fitted(shape, value, name, conditions)
            off.append(error)
            return made

        return of

    for name, condition in conditions.items():
        found[name] = _with_values(condition, formula_on(name))
    return found, max(off)


def _with_values(condition: BoundaryCondition, of: Callable[[Any], Any]) -> BoundaryCondition:
    """The same condition with other values; fluxes and coefficients stay."""
    if not isinstance(condition, Dirichlet | Clamped | Supported | Switched):
        return condition
    given = {
        one.name: getattr(condition, one.name) for one in fields(condition) if one.name not in ("where", "letters")
    }
    made = {name: of(value) for name, value in given.items()}
    return replace(condition, **made) if any(made[name] is not given[name] for name in given) else condition


def _fitted(shape: Shape, function: Callable[..., Any], name: Name, names: Mapping[Name, Any]) -> tuple[sp.Expr, float]:
    """A polynomial with the values of a function on a part, and how far it is off."""
    called = f"on {'the rest' if name is ... else repr(name)}"
    points, weights = _places(shape, name, names)
    with np.errstate(all="ignore"):
        values = values_of(called, function, list(np.ascontiguousarray(points.T)))
    required = weights == 1
    require_numbers(f"the function {called}", values[required], points[required])
    known = np.isfinite(values)  # at corners polar functions may jump, inside others have poles
    points, weights, values = points[known], weights[known], values[known]
    inside = weights < 1
    largest = float(np.abs(values[~inside]).max())
    if np.ptp(values[~inside]) == 0:
        return sp.Float(values[0]), 0.0
    middle, half = (points.max(axis=0) + points.min(axis=0)) / 2, float(np.ptp(points, axis=0).max()) / 2
    best: _Polynomial | None = None
    alone = [(k,) for k in range(shape.dimension)]  # along a straight part one coordinate is enough
    for axes, degree, chosen in product(
        [*alone, range(shape.dimension)], DEGREES[shape.dimension], (inside | True, ~inside)
    ):
        powers = [one for one in product(*(range(degree * (k in axes) + 1) for k in range(shape.dimension)))]
        powers = [one for one in powers if sum(one) <= degree]
        made = _polynomial(powers, (points - middle) / half, values, np.where(chosen, weights, 0), ~inside)
        best = made if best is None or made.off < LESS * best.off else best
        if best.off <= ENOUGH * largest:
            break
    assert best is not None
    if best.off > MOST * largest:
        raise RsymError(
            f"the function {called} jumps, or has kinks or many waves: polynomials are off by {best.off:.2g} of "
            f"{largest:.4g} at {first_place(points, best.away == best.off)}",
            code="function",
            remedy="give it as an expression, or name parts so that these places are their ends",
        )
    places = [(one - sp.Float(at)) / sp.Float(half) for one, at in zip(shape.coordinates, middle, strict=True)]
    return _horner(dict(zip(best.powers, best.coefficients.tolist(), strict=True)), places), best.off / largest


class _Polynomial(NamedTuple):
    """Coefficients by powers, and how far it is off at points of the boundary, 0 at others."""

    powers: list[tuple[int, ...]]
    coefficients: Floats
    away: Floats

    @property
    def off(self) -> float:
        return float(self.away.max())


def _polynomial(
    powers: list[tuple[int, ...]], points: Floats, values: Floats, weights: Floats, on: Flags
) -> _Polynomial:
    """The fit at every other one of points (n, dim)."""
    table = np.prod([points[:, k, None] ** np.array(powers)[:, k] for k in range(points.shape[1])], axis=0)
    sizes = 1.0 / (1.0 + np.sum(powers, axis=1)) ** 2
    some = (weights > 0) & ((weights > 1) | (np.arange(len(points)) % 2 == 0))
    rows = weights[some, None] * table[some] * sizes
    solved = np.linalg.lstsq(rows, weights[some] * values[some], rcond=SINGULAR)[0] * sizes
    found = table @ solved
    wild = max(0.0, float(np.abs(found).max()) - TAME * float(np.abs(values[on]).max()))
    return _Polynomial(powers, solved, np.where(on, np.abs(found - values) + wild, 0))


def _places(shape: Shape, name: Name, names: Mapping[Name, Any]) -> tuple[Floats, Floats]:
    """Points (n, dim) of a part and weights of them, those inside the shape and corners of the plane among them."""
    rule = prepared(shape, None, None).rule(CELLS[shape.dimension], ORDER, None)
    if name is ...:
        leaves = [leaf for leaf, one in enumerate(assigned(shape, list(names))) if one is ...]
    else:
        leaves = [leaf for leaf, parts in enumerate(shape_leaf_parts(shape)) if name in parts]
    points = rule.boundary.points[np.isin(rule.boundary.leaves, leaves)]
    if not len(points):
        raise vanished(str(name))
    corners = surveyed_corners(shape)[0] if shape.dimension == 2 else ()
    ends = np.array([one.point for one in corners if {*one.leaves} & {*leaves}]).reshape(-1, shape.dimension)
    within = rule.points[:: max(1, len(rule.points) // INNER)]
    weights = [np.full(len(some), weight) for some, weight in ((points, 1.0), (ends, AT_CORNERS), (within, INSIDE))]
    return np.vstack([points, ends, within]), np.concatenate(weights)


def _horner(terms: Mapping[tuple[int, ...], float], places: Sequence[sp.Expr]) -> sp.Expr:
    """A polynomial by the powers of its terms, in the first of some expressions with coefficients in the others."""
    if not places:
        return sp.Float(terms[()])
    inner: dict[int, dict[tuple[int, ...], float]] = {}
    for (power, *rest), value in terms.items():
        inner.setdefault(power, {})[tuple(rest)] = value
    return reduce(
        lambda high, power: high * places[0] + _horner(inner[power], places[1:]), sorted(inner)[::-1], sp.S.Zero
    )
