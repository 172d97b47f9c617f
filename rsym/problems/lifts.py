"""Lifts: functions with the values of u on the boundary, so that what is left to be found is 0 there."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Clamped, Dirichlet, Supported
from rsym.errors import RsymError
from rsym.logic.sign_form import shape_builder
from rsym.model.equation import Equation
from rsym.model.shape import Shape
from rsym.problems.pointwise import PointFormulas, compiled, with_derivatives
from rsym.program.lowering import lower


def values_on(conditions: tuple[BoundaryCondition | None, ...]) -> Mapping[int, sp.Expr]:
    """The value of u on each leaf that has one."""
    found = {}
    for leaf, condition in enumerate(conditions):
        if isinstance(condition, Dirichlet | Clamped | Supported):
            value = condition.value
            if isinstance(value, Equation):
                value = value.expression
            if not isinstance(value, sp.Expr):
                raise RsymError(
                    "the value of u on the boundary is a Python function: its derivatives are not known",
                    code="condition",
                    remedy="give an expression in the coordinates, or a Shape",
                )
            found[leaf] = value
    return found


def lift_of(shape: Shape, conditions: tuple[BoundaryCondition | None, ...]) -> PointFormulas | None:
    """The derivatives of a function that is u on the boundary; None where u is 0 there.

    Examples
    --------
    >>> import numpy as np, rsym
    >>> from rsym import x
    >>> lift_of(rsym.disc(1), (rsym.dirichlet(x),))(np.array([[0.5, 0.5]]))[:3].tolist()
    [[0.5], [1.0], [0.0]]
    """
    values = values_on(conditions)
    different = list(dict.fromkeys(values.values()))
    if not any(different):
        return None
    if len(different) > 1:
        raise RsymError("different values", code="condition")
    builder = shape_builder(shape)
    nodes = with_derivatives(builder, {"lift": lower(builder, different[0])}, builder.coordinates, 2)
    return compiled(shape, builder, nodes)
