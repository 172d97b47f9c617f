"""Exponential, logarithm and power on vectors of float64: fdlibm's polynomials without branches."""

from __future__ import annotations

from rsym.backends.vector_code import Value, polynomial

SMALLEST_NORMAL = 2.0**-1022
# log 2 in a piece of 32 bits and a rest.
_LOG2 = (0.6931471803691238, 1.9082149292705877e-10)
_LOG2_WHOLE = 0.6931471805599453
# The same, the upper part of half the bits.
_LOG2_UPPER, _LOG2_LOWER = 6.93147182464599609375e-01, -1.90465429995776804525e-09
# 2/(3 log 2) and log2(3/2), in two parts.
_SCALE, _SCALE_UPPER, _SCALE_LOWER = 9.61796693925975554329e-01, 9.61796700954437255859e-01, -7.02846165095275826516e-09
_LOG2_OF_1_5 = (5.84962487220764160156e-01, 1.35003920212974897128e-08)
# u (exp u + 1)/(exp u - 1) = 2 + u**2 E(u**2) on |u| <= log(2)/2, below 2**-59.
_EXP = (
    1.66666666666666019037e-01,
    -2.77777777770155933842e-03,
    6.61375632143793436117e-05,
    -1.65339022054652515390e-06,
    4.13813679705723846039e-08,
)
# (log(1 + s) - log(1 - s) - 2 s)/s = s**2 L(s**2) on |s| <= 0.1716, below 2**-58.
_LOG = (
    6.666666666666735130e-01,
    3.999999999940941908e-01,
    2.857142874366239149e-01,
    2.222219843214978396e-01,
    1.818357216161805012e-01,
    1.531383769920937332e-01,
    1.479819860511658591e-01,
)
# 3/2 log((1 + s)/(1 - s)) = 3 s + s**3 + s**5 P(s**2), for powers.
_POW = (
    5.99999999999994648725e-01,
    4.28571428578550184252e-01,
    3.33333329818377432918e-01,
    2.72728123808534006489e-01,
    2.30660745775561754067e-01,
    2.06975017800338417784e-01,
)


def _scaled(value: Value, exponent: Value) -> Value:
    """The value times 2**exponent in two steps, so that subnormal results are rounded once."""
    half = (exponent * 0.5).rounded
    return value * half.power_of_two * (exponent - half).power_of_two


def _clamped(value: Value, low: float, high: float) -> Value:
    """Within the range; NaN stays."""
    value = (value < low).choose(low, value)
    return (value > high).choose(high, value)


def exp(x: Value) -> Value:
    """Exponential, below 1 ulp."""
    x = _clamped(x, -750.0, 710.0)  # beyond: 0 and infinity
    k = (x * (1 / _LOG2_WHOLE)).rounded
    return _scaled(_exp_of_difference(x - k * _LOG2[0], k * _LOG2[1]), k)


def _exp_of_difference(high: Value, low: Value) -> Value:
    """exp(high - low) for |high| <= log(2)/2."""
    u = high - low
    z = u * u
    c = u - z * polynomial(z, _EXP)
    return 1.0 - ((low - (u * c) / (2.0 - c)) - high)


def log(x: Value) -> Value:
    """Natural logarithm, below 1 ulp."""
    tiny = x < SMALLEST_NORMAL
    scaled = tiny.choose(x * 2.0**54, x)
    mantissa, exponent = _split(scaled, 0x3FE6A09E_00000000)
    k = exponent - tiny.choose(54.0, 0.0)
    f = mantissa - 1.0
    s, half_square = f / (f + 2.0), f * 0.5 * f
    z = s * s
    series = z * polynomial(z, _LOG)
    value = s * (half_square + series) + k * _LOG2[1] - half_square + f + k * _LOG2[0]
    value = x.compare("oeq", float("inf")).choose(x, value)
    value = x.compare("oeq", 0.0).choose(float("-inf"), value)
    return x.compare("ult", 0.0).choose(float("nan"), value)


def _split(x: Value, start: int) -> tuple[Value, Value]:
    """The mantissa, between the real with the bits `start` and twice that, and the exponent."""
    above = x.bits - start
    mantissa = x.bits - (above & ~(2**52 - 1))
    return mantissa.real, (above >> 52).integer_to_real


def _upper(value: Value) -> Value:
    """The upper half of the bits: products of two such numbers are exact."""
    return (value.bits & -(2**32)).real


def pow(x: Value, y: Value) -> Value:
    """Below 1 ulp. 2**(y log2 x), the logarithm in two parts, for normal x > 0 and |y| < 2**60."""
    high, low = _log2_in_two(x)
    upper = _upper(y)
    rest, product = (y - upper) * high + y * low, upper * high
    inside = abs(product + rest) < 1100.0
    product, rest = inside.choose(product, _clamped(product, -1100.0, 1100.0)), inside.choose(rest, 0.0)
    k = (product + rest).rounded
    product = product - k
    t = _upper(rest + product)
    u, v = t * _LOG2_UPPER, (rest - (t - product)) * _LOG2_WHOLE + t * _LOG2_LOWER
    high = u + v
    return _scaled(_exp_of_difference(high, (high - u) - v), k)


def _log2_in_two(x: Value) -> tuple[Value, Value]:
    """log2 x = high + low to some 2**-68, high with 21 bits free: by s = (m - b)/(m + b), b = 1 or 3/2."""
    m, n = _split(x, 0x3FEBB67A_00000000)
    close = m < 1.224744871391589
    b = close.choose(1.0, 1.5)
    u, v = m - b, 1.0 / (m + b)
    s = u * v
    s_high = _upper(s)
    t_high = _upper(m + b)
    s_low = v * ((u - s_high * t_high) - s_high * (m - (t_high - b)))
    z = s * s
    series = z * z * polynomial(z, _POW) + s_low * (s_high + s)
    z = s_high * s_high
    t_high = _upper(z + 3.0 + series)
    t_low = series - ((t_high - 3.0) - z)
    u, v = s_high * t_high, s_low * t_high + t_low * s
    p_high = _upper(u + v)
    p_low = v - (p_high - u)
    offset = [close.choose(0.0, part) for part in _LOG2_OF_1_5]
    z_high, z_low = p_high * _SCALE_UPPER, p_high * _SCALE_LOWER + p_low * _SCALE + offset[1]
    high = _upper(((z_high + z_low) + offset[0]) + n)
    return high, z_low - (((high - n) - offset[0]) - z_high)


def not_plain(x: Value, y: Value) -> Value:
    """What `pow` leaves to libm: x that is not a normal positive number, and a y out of all proportion."""
    return x.compare("ult", SMALLEST_NORMAL) | x.compare("oeq", float("inf")) | abs(y).compare("uge", 2.0**60)
