"""Lifts: functions with the values of u on the boundary, so that what is left to be found is 0 there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Clamped, Dirichlet, Supported, UnknownLevel
from rsym.analysis.transfinite import OnPart, inverse_distances
from rsym.logic.weights import weight
from rsym.model.shape import Shape
from rsym.model.symbols import symbols_of
from rsym.problems.conditions import Name
from rsym.problems.interpolation import interpolate
from rsym.problems.parts import Parts, formula, parts_of
from rsym.program.raising import raised


def lift_of(shape: Shape, conditions: Mapping[Name, BoundaryCondition]) -> sp.Expr:
    """An expression that is u, and has the slopes of u, on the parts where these are given; 0 where they are 0.

    Of one value for all of these parts it is that; else, without slopes, the sum of u_i/w_i over that of 1/w_i, w_i the
    weights of the parts, which are positive inside: no power of them is as smooth. Where parts meet second derivatives
    are not bounded, and orders of convergence fall.

    Raises
    ------
    RsymError
        As `interpolate`: for parts that are not there, and values that differ where parts meet.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x
    >>> ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    >>> lift_of(ring, {"rim": rsym.dirichlet(x), ...: rsym.neumann()})
    x
    """
    data: dict[Name, tuple[sp.Expr, ...]] = {}
    for name, condition in conditions.items():
        if isinstance(condition, UnknownLevel):
            data[name] = (sp.S.Zero,)
        elif isinstance(condition, Dirichlet | Clamped | Supported):
            data[name] = tuple(_expression(shape, value, name) for value in condition.values)
    values = {given[0] for given in data.values()}
    if len(values) < 2:
        value = values.pop() if values else sp.S.Zero
        level = not set(symbols_of(value)) & set(shape.coordinates)
        if all(len(given) == 1 or (level and given[1] == 0) for given in data.values()):
            return value
    if any(len(given) > 1 for given in data.values()):
        return interpolate(shape, data).expression
    return lift_on(parts_of(shape, data), {name: given[0] for name, given in data.items()}, {})


def lift_on(parts: Parts, values: Mapping[Name, sp.Expr], factors: Mapping[Name, sp.Expr]) -> sp.Expr:
    """An expression with values on parts: the sum of u_i/w_i over that of 1/w_i; some weights have factors.

    These are 0 in points at most. Powers of the weights themselves, which they stand for, have gradients beyond all
    bounds where their parts meet others.
    """
    parts.require_all()
    parts.require_agreement({name: value for name, value in values.items() if name in parts.leaves})
    nodes = {name: weight(parts.form, leaves) for name, leaves in parts.leaves.items()}
    made = parts.form.builder.nodes
    pieces = [
        OnPart(values[name], factors.get(name, sp.S.One) * raised(made, node))
        for name, node in nodes.items()
        if node is not None
    ]
    return inverse_distances(pieces, 1) if pieces else sp.S.Zero


def _expression(shape: Shape, value: Any, name: Name) -> sp.Expr:
    return formula(value, shape, f"the value on {'the rest' if name is ... else repr(name)}")[0]
