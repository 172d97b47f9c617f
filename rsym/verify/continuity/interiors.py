"""What lies between the ends of a parametric curve: where it is proved to be a regular analytic arc, and where not.

On a part of the curve on which all coordinates are analytic and the velocity is not zero, the curve is an analytic
function of arc length, so it is G^k for every k. Parts are enclosed by Taylor series in balls, whose remainder is taken
over the whole part. Beside an end where the derivatives up to p^(m-1) vanish exactly,

    p'(end + h) = h**(m-1) (m c_m + (m+1) c_(m+1) h + ...),

and what is in brackets is enclosed instead. A place inside at which the velocity vanishes is found by algebra; the
curve is divided there, and its two halves are compared as two curves are that meet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeAlias

import sympy as sp

from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import ball, exact
from rsym.program.builder import Builder
from rsym.program.lowering import lower_all
from rsym.verify.boxes.constants import BITS, enclosed, precise
from rsym.verify.continuity.curves import Curve, Vector, all_vanish, derivative_at, end_of, is_analytic_at

# A share of the curve's interval, from 0 at its start to 1 at its end.
Part: TypeAlias = tuple[Fraction, Fraction]
WHOLE: Part = (Fraction(0), Fraction(1))
ORDER = 12
# A zero of the velocity is shut in by a part of 2**-DEEPEST of the curve; so many parts are examined at most.
DEEPEST, MOST = 36, 1500
# Zeros of the velocity are sought among fractions so simple, and such multiples of pi.
SIMPLE = 10_000
# Zeros of a curve that are told apart; where there are more, nothing is said.
MOST_ZEROS = 24


@dataclass(frozen=True)
class CurveArc:
    """A part of a curve between two places where its velocity may vanish, and what of it is proved to be regular.

    proved : the shares of its interval on which it is a regular analytic arc; open : all others.

    Examples
    --------
    >>> t = sp.Symbol("t")
    >>> [arc.curve.end for arc in arcs_of(Curve((t**3, t**4), t, -1, 1))]
    [0, 1]
    """

    curve: Curve
    proved: tuple[Part, ...]
    open: tuple[Part, ...]

    @property
    def whole(self) -> bool:
        """Whether all of it is proved: nothing is open, and what is proved has the length of the whole."""
        return not self.open and self.accounted

    @property
    def accounted(self) -> bool:
        """Whether the parts proved and open cover the interval once."""
        parts = sorted((*self.proved, *self.open))
        ends = bool(parts) and (parts[0][0], parts[-1][1]) == WHOLE
        return ends and all(before[1] == after[0] for before, after in pairwise(parts))


def arcs_of(curve: Curve) -> list[CurveArc]:
    """The curve divided where its velocity vanishes, and what is proved of each part.

    Examples
    --------
    >>> t = sp.Symbol("t")
    >>> (arc,) = arcs_of(Curve((sp.cos(t), sp.sin(t)), t, 0, 2 * sp.pi))
    >>> arc.whole
    True
    >>> (broken,) = arcs_of(Curve((t, 1 / t), t, -1, 2))
    >>> broken.whole, len(broken.open)
    (False, 1)
    """
    arc = _examined(curve)
    found = sorted(set(_zeros(arc)), key=_place_in(curve)) if arc.open else []
    if not found or len(found) > MOST_ZEROS:
        return [arc]
    ends = [curve.start, *found, curve.end]
    return [_examined(Curve(curve.expressions, curve.parameter, *pair)) for pair in pairwise(ends)]


def _place_in(curve: Curve) -> Any:
    def share(place: sp.Expr) -> float:
        return float((place - curve.start) / (curve.end - curve.start))

    return share


class _Motion:
    """The velocity of a curve on parts of its interval, in balls."""

    def __init__(self, curve: Curve) -> None:
        self.curve = curve
        builder = Builder(("t",), ())
        renamed = [one.xreplace({curve.parameter: sp.Symbol("t")}) for one in curve.expressions]
        self.function = SeriesFunction(builder.nodes, lower_all(builder, renamed))
        with precise():
            self.ends: tuple[Any, Any] = enclosed(curve.start), enclosed(curve.end)
        # How often the derivatives vanish at the ends, as far as it is known exactly.
        self.orders = _order_at(curve, curve.start), _order_at(curve, curve.end)

    def place(self, share: Fraction) -> Any:
        """A ball for the parameter at a share of the interval."""
        low, high = self.ends
        return low if share == 0 else high if share == 1 else low + (high - low) * exact(share)

    def is_regular(self, part: Part) -> bool:
        """Whether the coordinates are analytic and the velocity is not zero on a part, but where it ends exactly."""
        low, high = map(self.place, part)
        standing = [end for end in (0, 1) if part[end] == end and self.orders[end] != 1]
        if len(standing) > 1:
            return False
        if standing:
            order, here = self.orders[standing[0]], self.place(part[standing[0]])
        else:
            order, here = 1, self.place((part[0] + part[1]) / 2)
        if order == 0:
            return False
        whole = ball(low, high)
        velocity = self._velocity(here, whole, order)
        return velocity is not None and bool(sum((one * one for one in velocity), arb(0)) > 0)

    def _velocity(self, here: Any, whole: Any, order: int) -> list[Any] | None:
        """Balls for p'(here + h)/h**(order - 1) where here + h lies in `whole`."""
        middle, rest = self._series(here), self._series(whole)
        if middle is None or rest is None:
            return None
        powers = [arb(1)]
        for _ in range(ORDER):
            powers.append(powers[-1] * (whole - here))
        return [
            sum(
                (k * one[k] * powers[k - order] for k in range(order, ORDER)),
                ORDER * other[ORDER] * powers[ORDER - order],
            )
            for one, other in zip(middle, rest, strict=True)
        ]

    def _series(self, place: Any) -> list[Any] | None:
        found = [one for one in self.function(place) if one is not None]
        whole = len(found) == self.curve.dimension
        return found if whole and all(one[k].is_finite() for one in found for k in range(ORDER + 1)) else None


def _order_at(curve: Curve, place: sp.Expr) -> int:
    """The order of the first derivative that does not vanish at a place, by proof; 0 if it is not known."""
    end = end_of(curve, at_start=place == curve.start)
    return end.order


def _examined(curve: Curve) -> CurveArc:
    """The curve on ever smaller parts, those that are not proved regular divided."""
    with truncated(ORDER, BITS):
        motion = _Motion(curve)
        waiting: list[tuple[Part, int]] = [(WHOLE, 0)]
        proved, left, examined = [], [], 0
        while waiting:
            part, depth = waiting.pop()
            examined += 1
            if motion.is_regular(part):
                proved.append(part)
            elif depth == DEEPEST or examined > MOST:
                left.append(part)
            else:
                middle = (part[0] + part[1]) / 2
                waiting += [((middle, part[1]), depth + 1), ((part[0], middle), depth + 1)]
    return CurveArc(curve, tuple(sorted(proved)), tuple(_merged(left)))


def _merged(parts: Sequence[Part]) -> Iterator[Part]:
    """Parts that go on from one another, as one."""
    last: Part | None = None
    for part in sorted(parts):
        if last is not None and last[1] == part[0]:
            last = (last[0], part[1])
            continue
        if last is not None:
            yield last
        last = part
    if last is not None:
        yield last


def _zeros(arc: CurveArc) -> Iterator[sp.Expr]:
    """The places inside the open parts at which the velocity vanishes, exactly."""
    curve = arc.curve
    roots = list(_roots(curve))
    for part in arc.open:
        ends = [curve.start + sp.Rational(str(share)) * (curve.end - curve.start) for share in part]
        for place in (*roots, *_guesses(*ends)):
            if _is_inside(place, curve, ends) and is_analytic_at(curve, place) and _stands(curve, place):
                yield place
                break


def _roots(curve: Curve) -> Iterator[sp.Expr]:
    """The real roots that the numerators of the velocity have in common, where radicals give them."""
    numerators = [sp.together(sp.diff(one, curve.parameter)).as_numer_denom()[0] for one in curve.expressions]
    if all(one.is_polynomial(curve.parameter) for one in numerators):
        common = sp.gcd_list([sp.expand(one) for one in numerators])
        if common != 0 and common.has(curve.parameter):
            for factor, _ in sp.factor_list(common, curve.parameter)[1]:
                if sp.degree(factor, curve.parameter) <= 2:
                    yield from (root for root in sp.roots(factor, curve.parameter) if root.is_real)


def _guesses(low: sp.Expr, high: sp.Expr) -> Iterator[sp.Expr]:
    """The simplest fraction between two numbers, and the simplest multiple of pi."""
    middle = Fraction(str(sp.Rational(sp.N((low + high) / 2, 40))))
    yield sp.Rational(str(middle.limit_denominator(SIMPLE)))
    turns = Fraction(str(sp.Rational(sp.N((low + high) / 2 / sp.pi, 40))))
    yield sp.Rational(str(turns.limit_denominator(SIMPLE))) * sp.pi


def _is_inside(place: sp.Expr, curve: Curve, part: Sequence[sp.Expr]) -> bool:
    """Whether a place lies inside the curve and in a part of it, its ends included."""
    inside = (place - curve.start) * (curve.end - place), (place - part[0]) * (part[1] - place)
    balls = [enclosed(one) for one in inside]
    return balls[0] is not None and bool(balls[0] > 0) and balls[1] is not None and not balls[1] < 0


def _stands(curve: Curve, place: sp.Expr) -> bool:
    velocity: Vector = derivative_at(curve, place, 1)
    return all_vanish(velocity) is True
