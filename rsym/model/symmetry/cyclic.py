"""Cyclic symmetry: a motif repeated around a point of the plane or an axis in space."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, number, whole
from rsym.model.bounding import BoundingBox
from rsym.model.choices import Choice
from rsym.model.equation import substituted
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symmetry.copies import apart
from rsym.model.symmetry.evenness import check_even
from rsym.model.symmetry.reflections import farthest, turned_box, turned_coordinates, within_half_a_sector
from rsym.model.symmetry.waves import SawtoothWave, triangle_wave

MOTIFS = ("even", "any")
# A gear of 24 teeth meshes in 1.5 times the time of the formula with angles, one of 60 in 2.5 times.
MOST_IN_A_FAN = 48


def cyclic(
    shape: Shape,
    order: Any,
    *,
    radius: Any = 0,
    axis: Any = None,
    terms: Any = None,
    motif: str = "even",
    letters: LetterMapping = None,
) -> Shape:
    """A motif n times around a circle: omega0(r cos mu - r0, r sin mu), mu a wave of the polar angle theta.

    even motif: mu = (2/n) asin(sin(n theta/2)), mirrored from sector to sector, which an even motif does not feel
    any motif: mu = theta - (2 pi/n) round(n theta/(2 pi)), the field jumps on the borders of the sectors

    Up to n = 48 the same function is written without an angle. For even n and an even motif with E and O the largest
    components of (x, y) along every second border: r cos mu = (E + O)/(2 cos(pi/n)), r sin mu = (E - O)/(2 sin(pi/n)).
    For odd n and an even motif |mu| serves as well: the fold of `kaleidoscope`.
    For any motif (x, y) is turned back by the angle of its sector, whose sine and cosine are chosen by the borders.
    Elsewhere the angle jumps on a border; a mesh says that it proves nothing of the cells there.

    A motif without letters that provably lies within its sector is copied: omega is the largest of the n copies, the
    same near the boundary, and does not jump.

    The motif is moved outwards by the radius along the first coordinate; what
    of it lies within the sector |theta| <= pi/n counts. Exact inside the
    sectors: every order of normalisation is kept; on the borders theta = (2k + 1) pi/n there
    is a kink unless the boundary meets them at a right angle, and the centre is a
    singular point. With N terms of the series of mu the field is analytic off
    the centre, but the boundary moves by a share of 1/N**2 and the order is lost.

    Parameters
    ----------
    shape : Shape
        The motif, in the plane or in space, even in its second coordinate (about z: in y).
    order : integer
        n >= 1.
    radius : number or expression
        r0, in the unit of the coordinates.
    axis : symbol, optional
        The coordinate of a shape in space about which to turn; the last by default. The angle is
        measured from the coordinate that follows it, x before y before z before x.
    terms : integer, optional
        N, for the series instead of the exact wave.
    motif : "even" or "any"
        Whether the motif must be even.
    letters : mapping, optional
        Values of the letters in the radius.

    Raises
    ------
    RsymError
        For a motif that is not even where it must be, an order that is not a positive integer, a wrong axis.

    Source: Maksimenko-Sheiko and Sheiko (2008).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> ring = cyclic(rsym.Shape((1 - x**2 - y**2) / 2, (x, y)), 5, radius=4)
    >>> rsym.compile(ring)([4.0, 0.0, -4.0], [0.0, 0.0, 0.0])["value"].round(6)
    array([ 0.5     , -7.5     , -2.555728])
    """
    require_shape(shape)
    n = whole(order, "the order", 1)
    first, second = turned_coordinates(shape, axis)
    outset = number(radius, "the radius")
    reach = default(outset, shape.letters.merge(letters), "the radius")
    if checked_motif(motif, terms):
        check_even(shape, second)
    box = turned_box(shape, (first, second), reach)
    if motif == "any" and (made := _apart(shape, first, second, n, outset, box)) is not None:
        return made
    folded = _mirrored_fan(first, second, n) if motif == "even" and terms is None else None
    chosen = _chosen_turn(first, second, n) if motif == "any" else None
    outwards, across = folded or chosen or _turned_back(first, second, n, terms, motif)
    return substituted(shape, {first: outwards - outset, second: across}, letters=letters, box=box)


def _apart(
    shape: Shape, first: sp.Symbol, second: sp.Symbol, n: int, outset: sp.Expr, box: BoundingBox | None
) -> Shape | None:
    """The copies, if the motif lies between the borders of its sector."""

    def placed(along: sp.Expr, across: sp.Expr) -> dict[sp.Symbol, sp.Expr]:
        return {first: along - outset, second: across}

    turns = [(sp.cos(angle), sp.sin(angle)) for angle in (2 * sp.pi * k / n for k in range(n))]
    copies = [placed(c * first + s * second, c * second - s * first) for c, s in turns]
    c, s = sp.cos(sp.pi / n), sp.sin(sp.pi / n)
    sides = [placed(c * first + s * second, way * (s * first - c * second)) for way in (1, -1)]
    return apart(shape, copies, sides, second, box)


def _mirrored_fan(first: sp.Symbol, second: sp.Symbol, n: int) -> tuple[sp.Expr, sp.Expr] | None:
    """(r cos mu, r sin mu) without an angle, for an order that is not too large; for odd orders (r cos mu, r |sin mu|).

    On each sector of an even order the two largest components of the point along its borders are
    E = r cos(mu - pi/n) and O = r cos(mu + pi/n), E over every second border and O over the others.
    No angle jumps anywhere, and boxes of points have tight images.
    """
    if n > MOST_IN_A_FAN:
        return None
    if n <= 2:
        return sp.Abs(first) if n == 2 else first, second
    if n % 2:
        return within_half_a_sector(first, second, n)
    even, odd = (farthest(first, second, n // 2, sp.Rational(side, n)) for side in (1, -1))
    half = sp.pi / n
    return (even + odd) / (2 * sp.cos(half)), (even - odd) / (2 * sp.sin(half))


def _chosen_turn(first: sp.Symbol, second: sp.Symbol, n: int) -> tuple[sp.Expr, sp.Expr] | None:
    """(r cos mu, r sin mu) by a turn of whole sectors, for an order that is not too large.

    The first border line leaves half of the borders on either side, each of which is then told by the line along it.
    For odd n the first line runs through the middle of a sector too, where both sides take the same turn.
    """
    if n > MOST_IN_A_FAN:
        return None
    if n == 1:
        return first, second

    def chosen(low: int, high: int, value: Callable[[int], sp.Expr]) -> sp.Expr:
        """By the borders between the sectors from low to high."""
        if low == high:
            return value(low)
        after = (low + high) // 2 + 1
        border = sp.pi * (2 * after - 1) / n
        beyond = second * sp.cos(border) - first * sp.sin(border)
        return Choice(beyond, sp.S.Zero, chosen(after, high, value), chosen(low, after - 1, value))

    def turn(value: Callable[[int], sp.Expr]) -> sp.Expr:
        along = second * sp.cos(sp.pi / n) - first * sp.sin(sp.pi / n)
        half = (n + 1) // 2  # the last sector that begins within half a turn of the first border
        return Choice(along, sp.S.Zero, chosen(1, half, value), chosen(half + 1 - n % 2, n, value))

    cosine = turn(lambda k: sp.cos(2 * sp.pi * k / n))
    sine = turn(lambda k: sp.sin(2 * sp.pi * k / n))
    return first * cosine + second * sine, second * cosine - first * sine


def _turned_back(first: sp.Symbol, second: sp.Symbol, n: int, terms: Any, motif: str) -> tuple[sp.Expr, sp.Expr]:
    """(r cos mu, r sin mu); the jump of the angle lies on a border between sectors, never within one."""
    shift = sp.Integer(0) if n % 2 else sp.pi / n
    cosine, sine = sp.cos(shift), sp.sin(shift)
    angle = shift + sp.atan2(second * cosine - first * sine, first * cosine + second * sine, evaluate=False)
    sector = 2 * sp.pi / n
    wave = triangle_wave(angle, sector, terms) if motif == "even" else SawtoothWave(angle, sector)
    distance = sp.sqrt(first**2 + second**2)
    return distance * sp.cos(wave, evaluate=False), distance * sp.sin(wave, evaluate=False)


def checked_motif(motif: str, terms: Any) -> bool:
    """Whether the motif is to be even; the series exists for even motifs alone."""
    if str(motif) not in MOTIFS:
        raise RsymError(f'the motif must be "even" or "any", got {motif!r}', code="motif")
    if str(motif) == "any" and terms is not None:
        raise RsymError(
            "the series of the sawtooth does not converge on the borders",
            code="terms",
            remedy='give terms with motif="even" only',
        )
    return str(motif) == "even"
