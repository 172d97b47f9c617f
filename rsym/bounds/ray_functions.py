"""Elementary functions of quadratic models: by Taylor's formula where they are smooth, else by their range."""

from __future__ import annotations

from fractions import Fraction

from rsym.bounds.ray_models import RayArithmetic, RayModel, RayRange
from rsym.program.builder import HALF

# A sixth of the greatest third derivative: of sine and cosine 1, of the arc tangent 2.
WAVE_BOUND, ATAN_BOUND = Fraction(1, 6), Fraction(1, 3)


def quotient(m: RayArithmetic, u: RayModel, v: RayModel) -> RayModel:
    """U/v."""
    return m.product(u, m.inverse(v))


def wave(m: RayArithmetic, u: RayModel, *, sine: bool) -> RayModel:
    """The sine or cosine: within the distance from the middle, and within [-1, 1]."""
    b, c = m.b, m.centre(u)
    s, co = b.make("sin", c), b.make("cos", c)
    f, g = (s, co) if sine else (co, b.neg(s))
    distance = b.add(m.reach(u), m.radius(u, c))
    ends = m.widened(b.sub(f, distance), b.add(f, distance), b.abs(c))
    smooth = m.composed(u, (f, g, b.mul(b.const(-HALF), f)), b.const(WAVE_BOUND))
    return m.better(smooth, m.greater(ends.low, b.neg(m.one)), m.lesser(ends.high, m.one))


def exponential(m: RayArithmetic, u: RayModel) -> RayModel:
    """exp(u)."""
    b = m.b
    most = b.const(m.rounding.largest_exponent)
    low, high = (m.lesser(m.greater(end, b.neg(most)), most) for end in m.range(u))
    c = m.lesser(m.centre(u), most)
    e, top = b.make("exp", c), b.make("exp", high)
    ends = m.widened(b.make("exp", low), top, b.mul(b.make("exp", low), b.abs(low)), b.mul(top, b.abs(high)))
    smooth = m.composed(u, (e, e, b.mul(b.const(HALF), e)), b.mul(b.const(WAVE_BOUND), top))
    return m.better(smooth, m.greater(ends.low, m.zero), ends.high)


def logarithm(m: RayArithmetic, u: RayModel) -> RayModel:
    """log(u) over the part of its range that is positive."""
    b, (low, high) = m.b, m.range(u)
    least = b.select(low, m.tiny, low, m.one)
    c = m.greater(m.centre(u), least)
    inverse = b.make("div", m.one, c)
    h = b.mul(b.const(-HALF), b.square(inverse))
    bound = b.mul(b.const(ATAN_BOUND), b.powi(b.make("div", m.one, least), 3))
    top = b.make("log", m.greater(high, m.tiny))
    ends = m.widened(b.make("log", least), top)
    smooth = m.better(m.composed(u, (b.make("log", c), inverse, h), bound), *ends)
    return m.chosen(low, m.tiny, smooth, m.hull(b.neg(m.huge), ends.high))


def angle(m: RayArithmetic, u: RayModel, v: RayModel) -> RayModel:
    """atan2(u, v): by the arc tangent of u/v or of -v/u, where one of them is away from 0."""
    b = m.b
    (u_low, u_high), (v_low, _) = m.range(u), m.range(v)
    right, up, down = (v_low, m.zero), (u_low, m.zero), (m.zero, u_high)
    above = m.chosen(*right, u, m.negative(v))
    below = m.chosen(*right, v, m.chosen(*up, u, m.chosen(*down, u, m.number(m.one))))
    ratio = quotient(m, above, below)
    c = m.centre(ratio)
    f, slope = b.make("atan2", c, m.one), b.make("div", m.one, b.add(m.one, b.square(c)))
    h = b.neg(b.mul(c, b.square(slope)))
    distance = b.add(m.reach(ratio), m.radius(ratio, c))
    quarter = b.const(Fraction(11, 7))  # a little above pi/2
    ends = m.widened(b.sub(f, distance), b.add(f, distance))
    ends = RayRange(m.greater(ends.low, b.neg(quarter)), m.lesser(ends.high, quarter))
    arc = m.better(m.composed(ratio, (f, slope, h), b.const(ATAN_BOUND)), *ends)
    turn = b.mul(b.const(HALF), b.make("const", data="pi"))
    turn = b.select(*right, m.zero, b.select(*up, turn, b.neg(turn)))
    half = b.const(Fraction(22, 7))
    known = m.add(arc, m.number(turn))  # pi as rounded: less than the slack of a quarter turn away
    everywhere = m.hull(b.neg(half), half)
    return m.chosen(*right, known, m.chosen(*up, known, m.chosen(*down, known, everywhere)))


def power(m: RayArithmetic, u: RayModel, exponent: int) -> RayModel:
    """u**exponent over the part of the range that is not negative; the exponent is a number."""
    b = m.b
    value = b.value(exponent)
    if value is not None and value.denominator == 1 and abs(value) <= 64:
        whole = whole_power(m, u, abs(int(value)))
        return m.inverse(whole) if value < 0 else whole
    if value == HALF:
        return m.root(u)
    low, high = m.range(u)
    least, most = b.select(low, m.tiny, low, m.one), m.greater(high, m.tiny)
    c = m.greater(m.centre(u), least)
    f, bottom, top = (b.make("pow", base, exponent) for base in (c, least, most))
    less, less_still = b.sub(exponent, m.one), b.sub(exponent, b.const(2))
    g = b.mul(exponent, b.make("div", f, c))
    h = b.mul(b.const(HALF), b.mul(less, b.make("div", g, c)))
    third = b.abs(b.mul(b.mul(exponent, less), less_still))
    steepest = m.greater(*(b.make("div", value, b.powi(base, 3)) for value, base in ((bottom, least), (top, most))))
    bound = b.mul(b.const(WAVE_BOUND), b.mul(third, steepest))
    rising = (exponent, m.zero)
    ends = m.widened(b.select(*rising, bottom, top), b.select(*rising, top, bottom))
    ends = RayRange(m.greater(ends.low, m.zero), ends.high)
    smooth = m.better(m.composed(u, (f, g, h), bound), *ends)
    near = m.hull(b.select(*rising, m.zero, ends.low), b.select(*rising, ends.high, m.huge))
    return m.chosen(low, m.tiny, smooth, near)


def whole_power(m: RayArithmetic, u: RayModel, exponent: int) -> RayModel:
    """u**exponent for a whole exponent, 0 or above."""
    if exponent < 3:
        return (m.number(m.one), u, m.square(u))[exponent]
    b, (low, high), c = m.b, m.range(u), m.centre(u)
    farthest, nearest = m.greater(b.neg(low), high), m.greater(low, b.neg(high), m.zero)
    inner = b.powi(c, exponent - 2)
    taylor = (
        b.powi(c, exponent),
        b.mul(b.const(exponent), b.mul(inner, c)),
        b.mul(b.const(Fraction(exponent * (exponent - 1), 2)), inner),
    )
    third = Fraction(exponent * (exponent - 1) * (exponent - 2), 6)
    bound = b.mul(b.const(third), b.powi(farthest, exponent - 3))
    # A middle loses its bits n times over.
    scale = b.mul(b.const(exponent), b.powi(farthest, exponent))
    if exponent % 2:
        ends = m.widened(b.powi(low, exponent), b.powi(high, exponent), scale)
    else:
        ends = m.widened(b.powi(nearest, exponent), b.powi(farthest, exponent), scale)
        ends = RayRange(m.greater(ends.low, m.zero), ends.high)
    return m.better(m.outward(m.composed(u, taylor, bound), scale), *ends)
