"""Screw symmetry: twisted bars, what is wound around an axis, the coil spring."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, number, positive
from rsym.model.equation import substituted
from rsym.model.nodes import Scaled
from rsym.model.primitives.formulas import box_around
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol, x, y, z
from rsym.model.symmetry.cyclic import checked_motif, cyclic
from rsym.model.symmetry.evenness import check_even
from rsym.model.symmetry.reflections import turned_box, turned_coordinates
from rsym.model.systems import R0, RSystem


def screw(shape: Shape, pitch: Any, *, starts: Any = 1, axis: Any = None, letters: LetterMapping = None) -> Shape:
    """A bar twisted about an axis: omega0(R(-k z)(x, y)), one turn every pitch h = 2 pi/k.

    omega0(x cos(k z) + y sin(k z), y cos(k z) - x sin(k z)[, z])

    A plane shape becomes an endless twisted bar with it as its section, a shape in space is
    twisted. Not an isometry: |grad omega|**2 = |grad omega0|**2 + k**2 (d omega0/d theta)**2, so
    the order of normalisation is lost away from the axis; `normalise` restores order 1. Smooth where omega0 is.

    Parameters
    ----------
    shape : Shape
        In the plane (x, y), or in space.
    pitch : number or expression
        h, in the unit of the coordinates; right-handed where it is positive, left-handed where it is negative.
    starts : integer
        Copies of the shape around the axis, as for `cyclic`; more than one need an even shape.
    axis : symbol, optional
        For a shape in space: the last coordinate by default.
    letters : mapping, optional
        Values of the letters in the pitch.

    Raises
    ------
    RsymError
        For a pitch of zero, a wrong axis, or what `cyclic` refuses.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> bar = screw(rsym.Shape(1 - x**2 / 4 - y**2, (x, y)), 8)
    >>> rsym.compile(bar)([2.0, 0.0], [0.0, 2.0], [0.0, 2.0])["value"].round(9)
    array([0., 0.])
    """
    h = number(pitch, "the pitch")
    if default(h, shape.letters.merge(letters), "the pitch") == 0:
        raise RsymError("the pitch must not be zero", code="pitch", remedy="an endless straight bar is an extrusion")
    if starts != 1:
        shape = cyclic(shape, starts, axis=axis)
    first, second = turned_coordinates(shape, axis)
    along = _third(shape, first, second)
    angle = 2 * sp.pi * along / h
    cosine, sine = sp.cos(angle, evaluate=False), sp.sin(angle, evaluate=False)
    places = {first: first * cosine + second * sine, second: second * cosine - first * sine}
    in_plane = shape.dimension == 2
    return substituted(
        shape,
        places,
        coordinates=(*shape.coordinates, along) if in_plane else shape.coordinates,
        letters=letters,
        box=None if in_plane else turned_box(shape, (first, second)),
    )


def wound(shape: Shape, radius: Any, pitch: Any, *, motif: str = "even", letters: LetterMapping = None) -> Shape:
    """A section wound around the axis z along a helix: omega0(rho - R, cos(alpha) mu(z - h theta/(2 pi))).

    rho, theta are polar coordinates of (x, y), tan(alpha) = h/(2 pi R), mu(t) = t - h round(t/h), for an even
    section the same as the triangle wave. The section lies outwards (x) and across the turns (y). Along the
    helix rho = R every order of normalisation is kept; elsewhere |grad omega| is off by a share up to
    sin(alpha)**2 |R**2/rho**2 - 1|/2, and `normalise` restores order 1. Kinks half-way between the turns,
    unless the boundary meets them at a right angle; singular on the axis. It has no end, and no bounds:
    intersect it with a slab.

    Parameters
    ----------
    shape : Shape
        The section in the plane, even in y (across the turns).
    radius, pitch : number or expression
        R > 0 and h > 0, in the unit of the coordinates; right-handed.
    motif : "even" or "any"
        Whether the section must be even; if not, the field jumps half-way between the turns.
    letters : mapping, optional
        Values of the letters in the numbers.

    Raises
    ------
    RsymError
        For a shape in space, a section that is not even where it must be, numbers that are not positive.

    Source: Maksimenko-Sheiko and Sheiko (2008).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> thread = wound(rsym.Shape(1 - abs(y) - x, (x, y)), 5, 3)
    >>> rsym.compile(thread)([5.5, -5.5], [0.0, 0.0], [0.0, 1.5])["value"].round(9)
    array([0.5, 0.5])
    """
    require_shape(shape)
    if shape.dimension != 2 or "z" in (symbol.name for symbol in shape.coordinates):
        raise RsymError("what is wound is a section in the plane (x, y)", code="coordinates")
    known = shape.letters.merge(letters)
    big, h = positive(radius, "the radius", known), positive(pitch, "the pitch", known)
    across, outwards = shape.coordinates[1], shape.coordinates[0]
    if checked_motif(motif, None):
        check_even(shape, across)
    distance, height, cosine = _helical(big, h)
    places = {outwards: distance - big, across: cosine * height}
    return substituted(shape, places, coordinates=(x, y, z), letters=letters)


def coil(
    radius: Any = 3,
    tube: Any = 1,
    pitch: Any = 4,
    turns: Any = None,
    *,
    system: RSystem = R0,
    letters: LetterMapping = None,
) -> Shape:
    """A coil spring around the axis z: a tube of radius r along a helix of radius R and pitch h, right-handed.

    f = r**2 - d**2 - m**2,   d = rho - R,   m = cos(alpha) mu(z - h theta/(2 pi)),   t = tan(alpha) = h/(2 pi R)
    omega = f/(2 r) sqrt((rho**2 + q) E/(rho**2 (r**2 + m**2 + e d**2) + q E + 2 t**2 R**2 m**2))

    with mu as for `wound`, e = 1 + 2 t**2, E = r**2 + e (d**2 + m**2), q = f**2/R**2. Normalised to order 1 on all of
    the surface, where the root is 2 r/|grad f|; elsewhere it is one of sums of squares, so nothing but f decides the
    sign. The section across the tube is a circle to first order in r/R. Kinks half-way between the turns, which the
    surface does not reach; singular on the axis. With turns the climb T = z - mu goes from -L/2 to L/2, L = turns h,
    and the ends are flat: conjunction with ((L**2/4 - T**2)/L) (2 pi rho/h), normalised there. For ground
    ends intersect the endless coil with a slab. `helix_tube` has a round section of any thickness, by the distance
    itself, at a higher cost.

    Parameters
    ----------
    radius, tube, pitch : number or expression
        R, r and h, in the unit of the coordinates; r < R and 2 r < h cos(alpha).
    turns : number or expression, optional
        How many turns between the ends; without it there is no end, and no bounds.
    system : RSystem
        Of the conjunction that cuts the ends.
    letters : mapping, optional
        Values of the letters in the numbers.

    Raises
    ------
    RsymError
        For numbers that are not positive, and turns that touch one another or the axis.

    Source: Maksimenko-Sheiko and Sheiko (2008), their f; the root from its gradient.

    Examples
    --------
    >>> import rsym
    >>> spring = coil(4, 1, 3)
    >>> rsym.compile(spring)([4.0, 5.5, -4.0], [0.0, 0.0, 0.0], [3.0, 0.0, 1.5])["value"].round(9)
    array([ 0.5  , -0.625,  0.5  ])
    """
    big, r = positive(radius, "the radius", letters), positive(tube, "the radius of the tube", letters)
    h = positive(pitch, "the pitch", letters)
    distance, height, cosine = _helical(big, h)
    _check_turns_apart(default(big, letters), default(r, letters), default(h * cosine, letters))
    out, across = distance - big, cosine * height
    f = r**2 - out**2 - across**2
    tangent, q = h / (2 * sp.pi * big), (f / big) ** 2
    weight = 1 + 2 * tangent**2
    both = r**2 + weight * (out**2 + across**2)
    lean = distance**2 * (r**2 + across**2 + weight * out**2) + q * both + 2 * (tangent * big * across) ** 2
    slope = sp.sqrt((distance**2 + q) * both / lean) / (2 * r)
    endless = Shape(Scaled(f, slope), (x, y, z), letters=letters)
    if turns is None:
        return endless
    length = positive(turns, "the turns", letters) * h
    climb = z - height
    window = Scaled((length / 2) ** 2 - climb**2, 2 * sp.pi * distance / (h * length))
    reach, top = (default(item, letters) for item in (big + r, r / cosine + length / 2))
    box = box_around([(-reach, -reach, -top), (reach, reach, top)])
    return Shape(system.conjunction(endless.expression, window), endless.coordinates, letters=endless.letters, box=box)


def _helical(radius: sp.Expr, pitch: sp.Expr) -> tuple[sp.Expr, sp.Expr, sp.Expr]:
    """Distance from the axis, height above the nearest turn of the helix, cosine of its slope.

    The height is the sawtooth of z - h theta/(2 pi); taken as the angle of a point turned back by the
    screw it knows no jump but the one half-way between the turns, which an even section does not feel.
    """
    turn = 2 * sp.pi * z / pitch
    sine, cosine = sp.sin(turn, evaluate=False), sp.cos(turn, evaluate=False)
    ahead = sp.atan2(x * sine - y * cosine, x * cosine + y * sine, evaluate=False)
    return sp.sqrt(x**2 + y**2), pitch / (2 * sp.pi) * ahead, 1 / sp.sqrt(1 + (pitch / (2 * sp.pi * radius)) ** 2)


def _check_turns_apart(radius: float, tube: float, gap: float) -> None:
    if tube >= radius or 2 * tube >= gap:
        raise RsymError(
            f"the turns must not touch: got a tube of radius {tube:g} on a radius of {radius:g}, "
            f"turns {gap:g} apart across",
            code="coil",
            remedy="choose a thinner tube or a larger pitch",
        )


def _third(shape: Shape, first: sp.Symbol, second: sp.Symbol) -> sp.Symbol:
    """The coordinate along the axis; a plane shape gets one."""
    others = [symbol for symbol in shape.coordinates if symbol not in (first, second)]
    free = [name for name in ("z", "x", "y") if name not in (first.name, second.name)]
    return others[0] if others else real_symbol(free[0])
