"""Meridians: the arc or the segment that turns about the axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.model.symbols import as_expression, real_symbol
from rsym.surfaces.blends.blending import HermiteBlend, part_of_pi
from rsym.surfaces.functions.entries import exact as as_fraction
from rsym.surfaces.symbols import t

Pair: TypeAlias = tuple[Any, Any]


@dataclass(frozen=True)
class Arc:
    """(rho, z) = centre + (a cos phi, c sin phi), phi from `start` over `span`: an arc of a circle or an ellipse.

    Numbers or letters; angles in radians, a float that is a simple part of pi is taken as that part. What lies left
    of the arc, run through towards growing phi, is inside.

    Examples
    --------
    >>> Arc((3, 0), (1, 1)).point()
    (cos(pi*t/2) + 3, sin(pi*t/2))
    """

    centre: Pair
    radii: Pair
    start: Any = 0
    span: Any = sp.pi / 2

    def __post_init__(self) -> None:
        object.__setattr__(self, "centre", pair(self.centre, "the centre of an arc"))
        object.__setattr__(
            self,
            "radii",
            tuple(positive(radius, "a radius of an arc") for radius in pair(self.radii, "the radii of an arc")),
        )
        object.__setattr__(self, "start", angle(self.start))
        object.__setattr__(self, "span", span_of(self.span))

    def point(self) -> Pair:
        """(rho, z) in t from 0 to 1."""
        phi = self.start + self.span * t
        return self.centre[0] + self.radii[0] * sp.cos(phi), self.centre[1] + self.radii[1] * sp.sin(phi)

    def needed(self) -> tuple[sp.Expr, ...]:
        """What a blend must reproduce."""
        return arc_functions(self.span)

    def blend(self, letters: Letters) -> HermiteBlend:
        """One that does."""
        return arc_blend(self.span, letters)

    def part(self, number: int, count: int) -> Arc:
        """One of equal parts."""
        return replace(self, start=self.start + self.span * sp.Rational(number, count), span=self.span / count)

    def inside(self, rho: sp.Expr, height: sp.Expr) -> sp.Expr:
        """Positive inside, a distance to first order for a circle."""
        (a, c), (rho0, z0) = self.radii, self.centre
        if a == c:
            return (a**2 - (rho - rho0) ** 2 - (height - z0) ** 2) / (2 * a)
        return (1 - ((rho - rho0) / a) ** 2 - ((height - z0) / c) ** 2) / 2

    def extent(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """The largest rho, the lowest and the highest z of what it bounds."""
        return self.centre[0] + self.radii[0], self.centre[1] - self.radii[1], self.centre[1] + self.radii[1]


@dataclass(frozen=True)
class Segment:
    """The straight line from one point (rho, z) to another; what lies left of it is inside.

    Examples
    --------
    >>> Segment((2, 0), (1, 5)).point()
    (2 - t, 5*t)
    """

    start: Pair
    end: Pair

    def __post_init__(self) -> None:
        object.__setattr__(self, "start", pair(self.start, "an end of a segment"))
        object.__setattr__(self, "end", pair(self.end, "an end of a segment"))
        if self.start == self.end:
            raise RsymError(f"a segment has two ends, got {self.start} twice", code="segment")

    def point(self) -> Pair:
        """(rho, z) in t from 0 to 1."""
        (rho0, z0), (rho1, z1) = self.start, self.end
        return rho0 + (rho1 - rho0) * t, z0 + (z1 - z0) * t

    def needed(self) -> tuple[sp.Expr, ...]:
        """What a blend must reproduce."""
        return sp.Integer(1), t

    def blend(self, letters: Letters) -> HermiteBlend:
        """One that does."""
        return HermiteBlend.cubic()

    def part(self, number: int, count: int) -> Segment:
        """One of equal parts."""
        low, high = (tuple(one.subs(t, sp.Rational(k, count)) for one in self.point()) for k in (number, number + 1))
        return Segment(low, high)

    def inside(self, rho: sp.Expr, height: sp.Expr) -> sp.Expr:
        """The distance to the line, positive on its left."""
        (rho0, z0), (rho1, z1) = self.start, self.end
        across = (rho1 - rho0) * (height - z0) - (z1 - z0) * (rho - rho0)
        return across / sp.sqrt((rho1 - rho0) ** 2 + (z1 - z0) ** 2)

    def extent(self) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
        """The largest rho, the lowest and the highest z."""
        heights = self.start[1], self.end[1]
        return sp.Max(self.start[0], self.end[0]), sp.Min(*heights), sp.Max(*heights)


def number(value: Any) -> sp.Expr:
    """A number, exact as it was written, or a formula of real letters."""
    if isinstance(value, float):
        return as_fraction(value)
    expression = as_expression(value)
    return expression.xreplace({symbol: real_symbol(symbol.name) for symbol in expression.free_symbols})


def pair(value: Any, what: str) -> Pair:
    """(rho, z)."""
    given = tuple(value) if isinstance(value, Sequence) and not isinstance(value, str) else ()
    if len(given) != 2:
        raise RsymError(f"{what} is a pair (rho, z), got {value!r}", code="pair", remedy="for example (3, 0)")
    return number(given[0]), number(given[1])


def angle(value: Any) -> sp.Expr:
    """An angle; a float that is a simple part of pi is that part."""
    return part_of_pi(value) if isinstance(value, float) else number(value)


def positive(value: Any, what: str) -> sp.Expr:
    """A number that must be positive, or a letter."""
    given = number(value)
    if given.is_number and not (given.is_real and given > 0):
        raise RsymError(f"{what} must be positive, got {given}", code="radius")
    return given


def span_of(value: Any) -> sp.Expr:
    """The angle of an arc, at most a full turn."""
    given = angle(value)
    if given.is_number and not (given.is_real and 0 < given <= 2 * sp.pi):
        raise RsymError(f"the span of an arc lies in (0, 2 pi], got {sp.N(given, 6)}", code="angle")
    return given


def arc_blend(span: sp.Expr, letters: Letters) -> HermiteBlend:
    """Exact for every span below a full turn."""
    return HermiteBlend.class1(1, span, letters={symbol: letters[symbol.name] for symbol in span.free_symbols})


def arc_functions(span: sp.Expr) -> tuple[sp.Expr, ...]:
    """What a blend must reproduce to keep arcs of a span."""
    return sp.Integer(1), sp.cos(span * t), sp.sin(span * t)
