"""Conditions on the boundary, as data: what a function must meet on a part of it, n being the outward normal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import number
from rsym.model.equation import Equation
from rsym.model.letters import Letters
from rsym.model.shape import Shape

# A number or an expression in coordinates and letters; a shape, for omega; or, for those who can use one, a function.
Value: TypeAlias = sp.Expr | Equation | Callable[..., Any]


@dataclass(frozen=True)
class BoundaryCondition:
    """What a function u must meet on a part of the boundary; `dirichlet`, `robin` and the others make one."""

    @property
    def values(self) -> tuple[Value, ...]:
        """What it is made of."""
        return tuple(getattr(self, one.name) for one in fields(self))


@dataclass(frozen=True)
class Dirichlet(BoundaryCondition):
    """u = value."""

    value: Value


@dataclass(frozen=True)
class Robin(BoundaryCondition):
    """du/dn + coefficient*u = flux; Neumann's condition is that with the coefficient 0."""

    coefficient: Value
    flux: Value


@dataclass(frozen=True)
class UnknownLevel(BoundaryCondition):
    """u is the same all over the part, how much is not known; the flow through it in all is."""

    flow: sp.Expr


@dataclass(frozen=True)
class Clamped(BoundaryCondition):
    """u = value and du/dn = slope."""

    value: Value
    slope: Value


@dataclass(frozen=True)
class Supported(BoundaryCondition):
    """u = value, and no moment across the boundary: what a plate that lies on its edge meets."""

    value: Value


@dataclass(frozen=True)
class Switched(BoundaryCondition):
    """One condition where an expression is positive, another elsewhere on the part; `letters`: those of a shape."""

    where: sp.Expr
    inside: BoundaryCondition
    outside: BoundaryCondition
    letters: Letters = field(default_factory=lambda: Letters({}), repr=False)

    @property
    def values(self) -> tuple[Value, ...]:
        """What both are made of, and the expression."""
        return (self.where, *self.inside.values, *self.outside.values)


def dirichlet(value: Any) -> Dirichlet:
    """The condition u = value on a part of the boundary; a bare number or expression means it too.

    Parameters
    ----------
    value : number, expression, Shape or function
        In coordinates and letters; of a shape it is omega. A function takes arrays of coordinates of points of the
        part; `solve` and `elasticity` put polynomials in its place, and state how far these are off. Where a formula
        is asked for, as `interpolate` and `solution_structure` do, it is refused.

    Raises
    ------
    RsymError
        For what is none of these.

    Examples
    --------
    >>> import rsym
    >>> rsym.dirichlet(0.5)
    Dirichlet(value=1/2)
    """
    return Dirichlet(condition_value(value, "the value"))


def neumann(flux: Any = 0) -> Robin:
    """The condition du/dn = flux, n being the outward normal.

    Parameters
    ----------
    flux : number, expression, Shape or function
        As for `dirichlet`.

    Raises
    ------
    RsymError
        For what is none of these.

    Examples
    --------
    >>> import rsym
    >>> rsym.neumann(rsym.x)
    Robin(coefficient=0, flux=x)
    """
    return Robin(sp.S.Zero, condition_value(flux, "the flux"))


def robin(coefficient: Any, flux: Any = 0) -> Robin:
    """The condition du/dn + coefficient*u = flux, n being the outward normal.

    A body that loses heat to air of temperature T by the coefficient c has ``robin(c, c*T)``.

    Parameters
    ----------
    coefficient, flux : number, expression, Shape or function
        As for `dirichlet`.

    Raises
    ------
    RsymError
        For what is none of these.

    Examples
    --------
    >>> import rsym
    >>> rsym.robin(2, 1)
    Robin(coefficient=2, flux=1)
    """
    return Robin(condition_value(coefficient, "the coefficient"), condition_value(flux, "the flux"))


def constant(flow: Any = 0) -> UnknownLevel:
    """The condition that u has one value all over the part, which is not known; the integral of k du/dn over it is.

    Of a twisted shaft, -laplacian(u) = 2, the flow of a hole is twice its area. The curves that a part is made of have
    a level each, and this flow each; in space the leaves. `Solution.levels` tells them.

    Parameters
    ----------
    flow : number or expression
        In letters; outwards, as `Solution.flux` has it.

    Raises
    ------
    RsymError
        For what is none of these.

    Examples
    --------
    >>> import rsym
    >>> ring = rsym.disc(1).named("rim") - rsym.disc(0.5).named("bore")
    >>> u = rsym.solve(ring, "-laplacian(u) = 2", {"rim": 0, "bore": rsym.constant(2 * 0.7853981633974483)}, cells=16)
    >>> u([0, 0.5], [0.5, 0]).round(6).tolist(), round(u.flux("bore"), 5), [name for name, level in u.levels]
    ([0.375, 0.375], 1.5708, ['bore'])
    """
    return UnknownLevel(number(flow, "the flow"))


def clamped(value: Any = 0, slope: Any = 0) -> Clamped:
    """The conditions u = value and du/dn = slope, n being the outward normal: a plate held fast.

    Parameters
    ----------
    value, slope : number, expression, Shape or function
        As for `dirichlet`.

    Raises
    ------
    RsymError
        For what is none of these.

    Examples
    --------
    >>> import rsym
    >>> rsym.clamped()
    Clamped(value=0, slope=0)
    """
    return Clamped(condition_value(value, "the value"), condition_value(slope, "the slope"))


def supported(value: Any = 0) -> Supported:
    """The condition u = value of a plate that lies on its edge and can turn there: no moment across it.

    Parameters
    ----------
    value : number, expression, Shape or function
        As for `dirichlet`.

    Raises
    ------
    RsymError
        For what is none of these.

    Examples
    --------
    >>> import rsym
    >>> rsym.supported()
    Supported(value=0)
    """
    return Supported(condition_value(value, "the value"))


def switched(where: Any, inside: Any, outside: Any) -> Switched:
    """One condition inside of a shape, another outside of it: `solve` knows what solutions do where they change.

    Parameters
    ----------
    where : Shape or expression
        Positive where the first holds. It may cut an edge anywhere but along it. The sign alone matters: where it is
        steep, as tanh(100*x), straight lines through the same places stand for it. Letters of a shape that are not
        letters of that which is solved on become letters there.
    inside, outside : values, ``rsym.robin(c, h)`` or ``rsym.neumann(h)``
        Both for parts of the boundary of a shape in the plane.

    Raises
    ------
    RsymError
        For other conditions.

    Examples
    --------
    >>> import rsym
    >>> rsym.switched(rsym.half_plane((-1, 0), 0), 0, rsym.neumann())
    Switched(where=-x, inside=Dirichlet(value=0), outside=Robin(coefficient=0, flux=0))
    """
    both = as_condition(inside), as_condition(outside)
    expression = where.expression if isinstance(where, Equation) else number(where, "where conditions change")
    letters = where.letters if isinstance(where, Shape) else Letters({})
    for one in both:
        if not isinstance(one, Dirichlet | Robin):
            raise RsymError(
                f"conditions that change on an edge are values and fluxes, got {one}",
                code="condition",
                remedy="rsym.switched(half, 0, rsym.neumann())",
            )
    return Switched(expression, *both, letters)


def as_condition(given: Any) -> BoundaryCondition:
    """A condition, or the Dirichlet condition that a bare value means.

    Examples
    --------
    >>> as_condition(2), as_condition(neumann(1))
    (Dirichlet(value=2), Robin(coefficient=0, flux=1))
    """
    return given if isinstance(given, BoundaryCondition) else dirichlet(given)


def condition_value(given: Any, what: str) -> Value:
    """What stands in a condition, checked: a function stays one, a number or an expression becomes SymPy's.

    Examples
    --------
    >>> condition_value(0.5, "the value")
    1/2
    """
    # A symbol is callable, a class of SymPy functions too.
    if isinstance(given, Equation) or (callable(given) and not isinstance(given, sp.Basic | type)):
        return given
    try:
        return number(given, what)
    except RsymError as error:
        raise RsymError(
            f"{what} of a condition must be a number, an expression, a shape or a function, got {given!r}",
            code="condition",
            remedy='for example {"rim": 0, "bore": rsym.robin(2, 1), ...: rsym.neumann(0)}',
        ) from error
