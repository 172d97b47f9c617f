"""Meridians and what they make about the axis: exact patches of surfaces of revolution, and the shape that they bound.

With u along the parallels and v along the meridian every coordinate is a product of 1, cos, sin or a straight line
in u with another in v. A blend that reproduces those gives the surface itself from its corner data, twists included.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.letters import Letter, Letters, as_letters
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import as_expression, real_symbol, x, y, z
from rsym.surfaces.blends.blending import HermiteBlend, part_of_pi
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.functions.formulas import exact as as_fraction
from rsym.surfaces.symbols import t

Pair: TypeAlias = tuple[Any, Any]
LetterMapping: TypeAlias = Mapping[Any, Letter | float] | None
QUARTER = (0, sp.pi / 2)
AROUND = 2 * sp.pi
# Bounds of a shape leave this share of its extent free on every side.
MARGIN = 0.1


class RevolutionPatch(BicubicCoons):
    """A patch of a surface of revolution; `surface` is the whole, with its `shape`."""

    surface: Revolution


@dataclass(frozen=True, init=False)
class Revolution:
    """The surface (sx rho cos theta, sy rho sin theta, z) of a meridian (rho, z), `scale` = (sx, sy).

    Parameters
    ----------
    meridian : Arc or Segment
        In the half-plane rho >= 0. Upwards, or counterclockwise, the normals p_u x p_v point outwards.
    scale : pair, optional
        Turns circles of latitude into ellipses.
    letters : mapping, optional
        Of the meridian and the scale.

    Examples
    --------
    >>> ball = Revolution(Arc((0, 0), (2, 2), -sp.pi / 2, sp.pi))
    >>> ball.shape.expression
    -x**2/4 - y**2/4 - z**2/4 + 1
    >>> len(ball.patches((4, 2))), (ball.patch(longitude=(0, 1))(0.5, 0.5).round(6) + 0).tolist()
    (8, [1.755165, 0.958851, 0.0])
    """

    meridian: Arc | Segment
    scale: Pair
    letters: Letters

    def __init__(self, meridian: Arc | Segment, *, scale: Pair = (1, 1), letters: LetterMapping = None) -> None:
        if not isinstance(meridian, Arc | Segment):
            raise RsymError(f"a meridian is an Arc or a Segment, got {type(meridian).__name__}", code="meridian")
        object.__setattr__(self, "meridian", meridian)
        object.__setattr__(self, "scale", tuple(positive(one, "a scale") for one in scale))
        object.__setattr__(self, "letters", as_letters(letters))

    def patch(
        self,
        longitude: Pair = QUARTER,
        *,
        blend_u: HermiteBlend | None = None,
        blend_v: HermiteBlend | None = None,
        exact: bool = True,
    ) -> RevolutionPatch:
        """The piece over the longitudes from a start over a span, with u along them and v along the meridian.

        Default blends are `HermiteBlend.class1(1, span)` for arcs and the cubic one for segments; `class2(mu, span)`
        is as exact for every mu. Any other blend is refused unless `exact=False`, which gives the patch of the
        corner data, twists included, as a cubic blend would have it.
        """
        blends = self._blends(span_of(longitude[1]), blend_u, blend_v, exact)
        return self._piece(longitude, self.meridian, *blends)

    def patches(
        self,
        pieces: tuple[int, int] = (4, 1),
        *,
        blend_u: HermiteBlend | None = None,
        blend_v: HermiteBlend | None = None,
        exact: bool = True,
    ) -> list[RevolutionPatch]:
        """The whole surface in equal pieces, along the parallels and along the meridian; meridian by meridian."""
        for count in pieces:
            if isinstance(count, bool) or not isinstance(count, int) or count < 1:
                raise RsymError(f"the numbers of pieces are positive integers, got {pieces!r}", code="pieces")
        span, count = AROUND / pieces[0], pieces[1]
        parts = [self.meridian.part(number, count) for number in range(count)]
        surface = Revolution(parts[0], scale=self.scale, letters=self.letters)
        blends = surface._blends(span, blend_u, blend_v, exact)
        return [self._piece((span * number, span), part, *blends) for number in range(pieces[0]) for part in parts]

    @property
    def shape(self) -> Shape:
        """The shape that the whole surface bounds, omega > 0 inside; cones and cylinders reach beyond their pieces."""
        rho = sp.sqrt((x / self.scale[0]) ** 2 + (y / self.scale[1]) ** 2)
        omega = sp.expand(self.meridian.inside(rho, z))
        return Shape(omega, (x, y, z), letters=self.letters, bounds=self._bounds())

    def _blends(
        self, span: sp.Expr, blend_u: HermiteBlend | None, blend_v: HermiteBlend | None, exact: bool
    ) -> tuple[HermiteBlend, HermiteBlend]:
        """Blends that are given must keep the surface, if that is wanted."""
        if exact:
            _check(blend_u, arc_functions(span), span, "u", self.letters)
            _check(blend_v, self.meridian.needed(), getattr(self.meridian, "span", None), "v", self.letters)
        return blend_u or arc_blend(span, self.letters), blend_v or self.meridian.blend(self.letters)

    def _piece(
        self, longitude: Pair, meridian: Arc | Segment, blend_u: HermiteBlend, blend_v: HermiteBlend
    ) -> RevolutionPatch:
        theta = angle(longitude[0]) + span_of(longitude[1]) * t
        rho, height = map(_end_data, meridian.point())
        turning = [_end_data(sp.cos(theta)), _end_data(sp.sin(theta)), [sp.Integer(k) for k in (1, 1, 0, 0)]]
        along = [[self.scale[0] * one for one in rho], [self.scale[1] * one for one in rho], height]
        matrix = [[[turning[c][a] * along[c][b] for c in range(3)] for b in range(4)] for a in range(4)]
        patch = RevolutionPatch(matrix, blend_u, blend_v, letters=self.letters)
        patch.surface = self
        return patch

    def _bounds(self) -> Bounds:
        """The box of the whole with the defaults of the letters."""
        values = {real_symbol(name): letter.default for name, letter in self.letters.items()}
        reach, low, high = (float(one.subs(values)) for one in self.meridian.extent())
        wide, deep = (float(one.subs(values)) * reach * (1 + MARGIN) for one in self.scale)
        room = MARGIN * max(high - low, reach)
        return (-wide, wide), (-deep, deep), (low - room, high + room)


def _end_data(function: sp.Expr) -> list[sp.Expr]:
    """(f(0), f(1), f'(0), f'(1)) of a function of t."""
    return [function.diff(t, order).subs(t, end) for order in (0, 1) for end in (0, 1)]


def _check(
    blend: HermiteBlend | None, needed: tuple[sp.Expr, ...], span: sp.Expr | None, name: str, letters: Letters
) -> None:
    """Refuse a blend that does not give back what the surface is made of."""
    if blend is None or (span is not None and blend.exact_angle is not None and blend.exact_angle == span):
        return
    values = {real_symbol(key): number(letter.default) for key, letter in letters.items()}
    for function in needed:
        answer = blend.reproduces(function.xreplace(values))
        if not answer:
            kept = "straight lines" if span is None else f"arcs of the angle {span}"
            others = "cubic()" if span is None else f"class1(1, {span}), HermiteBlend.class2(mu, {span}) with any mu"
            raise RsymError(
                f"the blend in {name} does not keep {kept}: {function} comes back off by {answer.worst:.3g}",
                code="not-exact",
                remedy=f"use HermiteBlend.{others}, or exact=False for the patch of the corner data",
            )


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
