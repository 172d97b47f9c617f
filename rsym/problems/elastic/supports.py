"""What holds or loads the boundary of an elastic body, as data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Value, condition_value
from rsym.errors import RsymError

EXAMPLES = 'for example {"wall": rsym.fixed(), "axis": rsym.roller(), "edge": {"x": 1}, "bore": rsym.pressure(2)}'


@dataclass(frozen=True)
class Displaced(BoundaryCondition):
    """Displacements along some coordinates, ``((name, value), ...)``; along the others no force acts."""

    components: tuple[tuple[str, Value], ...]

    @property
    def values(self) -> tuple[Value, ...]:
        """The displacements."""
        return tuple(value for _, value in self.components)


@dataclass(frozen=True)
class Fixed(BoundaryCondition):
    """No displacement at all."""


@dataclass(frozen=True)
class Roller(BoundaryCondition):
    """No displacement across the part, no force along it."""


@dataclass(frozen=True)
class Traction(BoundaryCondition):
    """The force on an area, along each coordinate."""

    force: tuple[Value, ...]

    @property
    def values(self) -> tuple[Value, ...]:
        """The components."""
        return self.force


@dataclass(frozen=True)
class Pressure(BoundaryCondition):
    """The force -pressure*n on an area, n being the outward normal."""

    pressure: Value


def displacement(components: Mapping[Any, Any]) -> Displaced:
    """The condition that a part of the boundary of an elastic body is displaced by given amounts.

    Parameters
    ----------
    components : mapping
        Coordinates, by name or symbol, to displacements along them: numbers, expressions, shapes or functions. Along a
        coordinate that is left out the part is free to move. Among conditions the mapping alone means it.

    Raises
    ------
    RsymError
        For what is no such mapping.

    Examples
    --------
    >>> import rsym
    >>> rsym.displacement({"x": 0.5})
    Displaced(components=(('x', 1/2),))
    """
    if not isinstance(components, Mapping) or not components:
        raise RsymError(
            f"a displacement is given by coordinates, got {components!r}",
            code="condition",
            remedy='for example rsym.displacement({"x": 0}), or rsym.fixed()',
        )
    return Displaced(tuple((str(name), condition_value(one, "the displacement")) for name, one in components.items()))


def fixed() -> Fixed:
    """The condition that a part of the boundary of an elastic body does not move.

    Examples
    --------
    >>> import rsym
    >>> rsym.fixed()
    Fixed()
    """
    return Fixed()


def roller() -> Roller:
    """The condition that a straight part of the boundary of an elastic body moves along itself only, without friction.

    It is also that of a plane of symmetry. The part must be parallel to an axis.

    Examples
    --------
    >>> import rsym
    >>> rsym.roller()
    Roller()
    """
    return Roller()


def traction(force: Any = (0, 0)) -> Traction:
    """The condition that a force acts on a part of the boundary of an elastic body; without one the part is free.

    Parameters
    ----------
    force : sequence
        By area, along each coordinate: numbers, expressions, shapes or functions.

    Raises
    ------
    RsymError
        For what is no sequence of such values.

    Examples
    --------
    >>> import rsym
    >>> rsym.traction((0, -rsym.x))
    Traction(force=(0, -x))
    """
    return Traction(vector(force, "a traction"))


def pressure(pressure: Any) -> Pressure:
    """The condition that a pressure acts on a part of the boundary of an elastic body, against the outward normal.

    Parameters
    ----------
    pressure : number, expression, Shape or function
        The force on an area; below 0 it is a pull.

    Raises
    ------
    RsymError
        For what is none of these.

    Examples
    --------
    >>> import rsym
    >>> rsym.pressure(2)
    Pressure(pressure=2)
    """
    return Pressure(condition_value(pressure, "the pressure"))


def vector(given: Any, what: str) -> tuple[Value, ...]:
    """The components of a vector."""
    parts = list(given) if isinstance(given, Sequence | sp.MatrixBase | sp.Tuple) and not isinstance(given, str) else []
    if len(parts) != 2:
        raise RsymError(f"{what} has a component for each coordinate, got {given!r}", code="vector", remedy="(0, -1)")
    return tuple(condition_value(one, f"a component of {what}") for one in parts)


def as_support(given: Any) -> BoundaryCondition:
    """A condition on an elastic body, or the displacement that a mapping means.

    Examples
    --------
    >>> as_support({"x": 1})
    Displaced(components=(('x', 1),))
    """
    if isinstance(given, Displaced | Fixed | Roller | Traction | Pressure):
        return given
    if isinstance(given, Mapping):
        return displacement(given)
    if isinstance(given, int | float | sp.Number) and given == 0:
        return Fixed()
    raise RsymError(f"no condition on an elastic body: {given!r}", code="condition", remedy=EXAMPLES)
