"""Pieces of curves as nodes: they stay whole in an expression, so that a skeleton can be asked where it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import sympy as sp

from rsym.model.arguments import Point
from rsym.model.nodes import Composition, Trimming
from rsym.model.powers import absolute_power
from rsym.model.symbols import substitute
from rsym.model.vectors import cross, dot, minus, norm, squared

PARAMETER: sp.Symbol = sp.Dummy("s", real=True)


@dataclass(frozen=True)
class CurvePath:
    """Where a curve runs: a point that depends on PARAMETER, from low to high, and the points at the two ends."""

    point: Point
    low: sp.Expr
    high: sp.Expr
    ends: tuple[Point, Point]

    def at(self, share: sp.Expr) -> Point:
        """The point that divides the range of PARAMETER so."""
        value = self.low + share * (self.high - self.low)
        return tuple(substitute(component, {PARAMETER: value}) for component in self.point)


class CurveField(Composition):
    """A field that is zero on a curve and positive elsewhere: coordinates, other vectors, then scalars."""

    noun: ClassVar[str]  # in model files and formulas
    vectors: ClassVar[int]  # with the coordinates, which are the first
    scalars: ClassVar[int]

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return (len(self.args) - self.scalars) // self.vectors

    def vector(self, position: int) -> Point:
        """One of the vectors; 0 is what stands for the coordinates, other expressions after a motion."""
        return tuple(self.args[position * self.dimension : (position + 1) * self.dimension])

    @property
    def numbers(self) -> Point:
        """The scalars."""
        return tuple(self.args[self.vectors * self.dimension :])

    def paths(self) -> tuple[CurvePath, ...]:
        """Where the curve runs, in its own coordinates; none if it has no ends and does not close."""
        raise NotImplementedError

    def _eval_is_nonnegative(self) -> bool:
        return True

    def _eval_is_extended_nonnegative(self) -> bool:
        return True

    def _groups(self, printer: Any) -> list[str]:
        groups = [*(self.vector(position) for position in range(self.vectors)), self.numbers]
        return [", ".join(printer._print(item) for item in group) for group in groups if group]

    def _latex(self, printer: Any, exp: str | None = None) -> str:
        name = rf"\mathrm{{{self.noun.lower()}}}"
        groups = r";\, ".join(self._groups(printer))
        text = rf"{name}\left({groups}\right)"
        return text if exp is None else f"{text}^{{{exp}}}"

    def _sympystr(self, printer: Any) -> str:
        return f"{self.noun.lower()}({'; '.join(self._groups(printer))})"


class SegmentField(CurveField):
    """From p to q: the line, trimmed by the disc that has the segment as its diameter."""

    noun, vectors, scalars = "Segment", 3, 0

    def composition(self) -> sp.Expr:
        """Trimming of the distance f to the line by t = (place - p).(q - place)/L."""
        place, start, end = (self.vector(k) for k in range(3))
        way = minus(end, start)
        length = norm(way)
        # Along a coordinate the sign of a letter must not stay in f: f**2 is then free of roots when it is revolved.
        straight = sum(not component.is_zero for component in way) == 1
        along = tuple(sp.Integer(not component.is_zero) if straight else component / length for component in way)
        offset = minus(place, start)
        line = offset[0] * along[1] - offset[1] * along[0] if self.dimension == 2 else norm(cross(offset, along))
        return Trimming(line, dot(offset, minus(end, place)) / length)

    def paths(self) -> tuple[CurvePath, ...]:
        """P + s (q - p) for s in [0, 1]."""
        start, end = self.vector(1), self.vector(2)
        point = tuple(a + PARAMETER * (b - a) for a, b in zip(start, end, strict=True))
        return (CurvePath(point, sp.S.Zero, sp.S.One, (start, end)),)


class CircleField(CurveField):
    """About a centre in the plane of two unit vectors, of a radius; the last number tells if distances are exact."""

    noun, vectors, scalars = "Circle", 4, 2

    def composition(self) -> sp.Expr:
        """The absolute value of (R**2 - r**2)/(2 R) or R - r; in space with the height over the plane."""
        line = self.line()
        return absolute_power(line, sp.S.One) if self.dimension == 2 else line

    def offset(self) -> Point:
        """The place seen from the centre."""
        return minus(self.vector(0), self.vector(1))

    def line(self) -> sp.Expr:
        """The whole circle: in the plane positive inside, in space zero on it and positive elsewhere."""
        offset, radius, exact = self.offset(), self.numbers[0], not self.numbers[-1].is_zero
        first, second = self.vector(2), self.vector(3)
        flat = norm((dot(offset, first), dot(offset, second)))
        inward = radius - flat if exact else (radius**2 - squared(offset)) / (2 * radius)
        return inward if self.dimension == 2 else norm((inward, dot(offset, cross(first, second))))

    def at(self, angle: sp.Expr) -> Point:
        """The point of the circle at an angle."""
        return self._from(sp.cos(angle), sp.sin(angle))

    def _from(self, cosine: sp.Expr, sine: sp.Expr) -> Point:
        radius = self.numbers[0]
        axes = zip(self.vector(1), self.vector(2), self.vector(3), strict=True)
        return tuple(c + radius * (a * cosine + b * sine) for c, a, b in axes)

    def path(self, start: sp.Expr, end: sp.Expr) -> CurvePath:
        """The arc between two angles, by the tangent s of half the angle from the middle."""
        middle, reach = (start + end) / 2, sp.tan((end - start) / 4)
        s, cosine, sine = PARAMETER, sp.cos(middle), sp.sin(middle)
        whole = 1 + s**2
        turned = (cosine * (1 - s**2) - 2 * sine * s) / whole, (sine * (1 - s**2) + 2 * cosine * s) / whole
        return CurvePath(self._from(*turned), -reach, reach, (self.at(start), self.at(end)))

    def paths(self) -> tuple[CurvePath, ...]:
        """Two halves."""
        return self.path(sp.S.Zero, sp.pi), self.path(sp.pi, 2 * sp.pi)


class ArcField(CircleField):
    """The circle from one angle on to another: trimmed by the circle that meets it at right angles at both ends."""

    noun, vectors, scalars = "Arc", 4, 4  # radius, start, end, exact

    def composition(self) -> sp.Expr:
        """Trimming by t = (2 R u - cos h (R**2 + r**2))/(2 R sin h): half the angle h, u along the middle."""
        radius, start, end, _ = self.numbers
        offset, middle, half = self.offset(), (start + end) / 2, (end - start) / 2
        along = dot(offset, self.vector(2)) * sp.cos(middle) + dot(offset, self.vector(3)) * sp.sin(middle)
        beyond = sp.cos(half) * (radius**2 + squared(offset))
        return Trimming(self.line(), (2 * radius * along - beyond) / (2 * radius * sp.sin(half)))

    def paths(self) -> tuple[CurvePath, ...]:
        """One."""
        return (self.path(self.numbers[1], self.numbers[2]),)


class HelixField(CurveField):
    """(R cos a, R sin a, p a/(2 pi)), endless, or for a from 0 to 2 pi n: coordinates, R, p and then n."""

    noun, vectors = "Helix", 1

    @property
    def scalars(self) -> int:  # type: ignore[override]
        """Two, or three with the number of turns."""
        return len(self.args) - 3

    def composition(self) -> sp.Expr:
        """The field of the endless one, trimmed by s (S - s)/S: s is the length of the curve, constant across it."""
        (a, b, c), (radius, pitch, *turns) = self.vector(0), self.numbers
        slope = 2 * sp.pi / pitch
        stretch = sp.sqrt(1 + slope**2 * radius**2)
        cosine, sine = sp.cos(slope * c), sp.sin(slope * c)
        cylinder = slope * (radius**2 - a**2 - b**2) / 2
        chord = (a - radius * cosine) ** 2 + (b - radius * sine) ** 2
        curve = sp.sqrt(cylinder**2 + chord + chord**2 / (12 * radius**2)) / stretch
        if not turns:
            return curve
        ahead, whole = self._ahead(cosine, sine), stretch * pitch * turns[0]
        length = stretch * c + slope * radius**2 * ahead / stretch
        return Trimming(curve, length * (whole - length) / whole)

    def _ahead(self, cosine: sp.Expr, sine: sp.Expr) -> sp.Expr:
        """The angle from the curve to the place, periodic: 4/3 sin - 1/6 sin(2) of it, and nowhere steeper."""
        (a, b, _), radius = self.vector(0), self.numbers[0]
        unit = 2 * radius / (radius**2 + a**2 + b**2)
        return unit * (b * cosine - a * sine) * (4 - unit * (a * cosine + b * sine)) / 3

    def paths(self) -> tuple[CurvePath, ...]:
        """One, by the height over that of the end."""
        radius, pitch, *turns = self.numbers
        if not turns:
            return ()

        def at(share: sp.Expr) -> Point:
            angle = 2 * sp.pi * turns[0] * share
            return radius * sp.cos(angle), radius * sp.sin(angle), pitch * turns[0] * share

        return (CurvePath(at(PARAMETER), sp.S.Zero, sp.S.One, (at(sp.S.Zero), at(sp.S.One))),)
