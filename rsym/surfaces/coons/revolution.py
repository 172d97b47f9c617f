"""Surfaces of revolution of an arc or a segment: exact patches of them, and the shape that they bound.

With u along the parallels and v along the meridian every coordinate is a product of 1, cos, sin or a straight line
in u with another in v. A blend that reproduces those gives the surface itself from its corner data, twists included.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import sympy as sp

from rsym.errors import RsymError
from rsym.model.letters import Letter, Letters, as_letters
from rsym.model.shape import Bounds, Shape
from rsym.model.symbols import real_symbol, x, y, z
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.meridians import Arc, Pair, Segment, angle, arc_blend, arc_functions, number, positive, span_of
from rsym.surfaces.symbols import t

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
