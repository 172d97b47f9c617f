"""Sine, cosine and the angle of a point on vectors of float64: fdlibm's polynomials without branches."""

from __future__ import annotations

from rsym.backends.vector_code import Value, polynomial, two_sum

# Where the reduction modulo pi/2 ends: multiples up to 2**20 of a number of 33 bits are exact.
TRIGONOMETRIC_BOUND = 2.0**20 * 1.5
# pi/2 in three pieces of 33 bits and a rest.
_HALF_PI = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487111665e-21, 8.478427660368899e-32)
# pi/2, atan(1/2) and pi/4 to 106 bits.
_RIGHT_ANGLE = (1.5707963267948966, 6.123233995736766e-17)
_ATAN_HALF = (0.4636476090008061, 2.2698777452961687e-17)
_ATAN_ONE = (0.7853981633974483, 3.061616997868383e-17)

# sin u = u + u**3 S(u**2), cos u = 1 - u**2/2 + u**4 C(u**2) on |u| <= pi/4, below 2**-58.
_SIN = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
_COS = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
# atan t = t - t**3 A(t**2) on |t| <= 7/16.
_ATAN = (
    3.33333333333329318027e-01,
    -1.99999999998764832476e-01,
    1.42857142725034663711e-01,
    -1.11111104054623557880e-01,
    9.09088713343650656196e-02,
    -7.69187620504482999495e-02,
    6.66107313738753120669e-02,
    -5.83357013379057348645e-02,
    4.97687799461593236017e-02,
    -3.65315727442169155270e-02,
    1.62858201153657823623e-02,
)


def _reduced(x: Value) -> tuple[Value, Value, Value]:
    """The argument modulo pi/2 as a sum of two, and how many times pi/2 was taken off (Cody and Waite)."""
    k = (x * 0.6366197723675814).rounded
    first = x - k * _HALF_PI[0]
    second, lost = two_sum(first, -(k * _HALF_PI[1]))
    third, lost_too = two_sum(second, -(k * _HALF_PI[2]))
    rest = (lost + lost_too) - k * _HALF_PI[3]
    high = third + rest
    return high, rest - (high - third), k.integer_bits


def _sin_cos(x: Value, quarter_turns: int) -> Value:
    """sin(x + quarter_turns*pi/2)."""
    high, low, k = _reduced(x)
    turns = k + quarter_turns
    z = high * high
    cube = z * high
    sine = high - ((z * (low * 0.5 - cube * polynomial(z, _SIN[1:])) - low) - cube * _SIN[0])
    half = z * 0.5
    near = 1.0 - half
    cosine = near + (((1.0 - near) - half) + (z * (z * polynomial(z, _COS)) - high * low))
    value = (turns & 1).compare("eq", 0).choose(sine, cosine)
    return (value.bits ^ ((turns & 2) << 62)).real


def sin(x: Value) -> Value:
    """Sine, below 1 ulp."""
    return (abs(x) < 2.0**-27).choose(x, _sin_cos(x, 0))  # keeps the sign of zero


def cos(x: Value) -> Value:
    """Cosine, below 1 ulp."""
    return _sin_cos(x, 1)


def far(x: Value) -> Value:
    """Where the reduction modulo pi/2 ends."""
    return abs(x) > TRIGONOMETRIC_BOUND


def atan2(y: Value, x: Value) -> Value:
    """Below 2 ulp: base + atan(t), t the tangent of what the smaller angle exceeds 0, atan(1/2) or pi/4 by."""
    small, large = _sorted_sizes(y, x)
    steep = abs(y) > abs(x)
    near, middle = small * 16.0 < large * 7.0, small * 16.0 < large * 11.0
    numerator = near.choose(small, middle.choose(small * 2.0 - large, small - large))
    denominator = near.choose(large, middle.choose(large * 2.0 + small, small + large))
    t = numerator / denominator
    z = t * t
    excess = t - t * (z * polynomial(z, _ATAN))
    base = [near.choose(0.0, middle.choose(half, one)) for half, one in zip(_ATAN_HALF, _ATAN_ONE, strict=True)]
    high, low, excess = _turned(steep, _RIGHT_ANGLE, (base[0], base[1], excess))
    behind = x.bits < 0
    high, low, excess = _turned(behind, tuple(2 * part for part in _RIGHT_ANGLE), (high, low, excess))
    angle = high + (excess + low)
    signed = (angle.bits | (y.bits & -(2**63))).real
    return x.compare("uno", y).choose(x + y, signed)


def _sorted_sizes(y: Value, x: Value) -> tuple[Value, Value]:
    """The smaller and the larger size, scaled by the same power of two away from the end of the range."""
    a, b = abs(y), abs(x)
    small, large = (a > b).choose(b, a), (a > b).choose(a, b)
    infinite, zero = small.compare("oeq", float("inf")), large.compare("oeq", 0.0)
    small, large = infinite.choose(1.0, small), infinite.choose(1.0, zero.choose(1.0, large))
    scale = (large > 2.0**1020).choose(2.0**-4, 1.0)
    return small * scale, large * scale


def _turned(
    condition: Value, angle: tuple[float, ...], parts: tuple[Value, Value, Value]
) -> tuple[Value, Value, Value]:
    """Where the condition holds, angle - (high + low + excess), in the same three parts."""
    high, low, excess = parts
    total, lost = two_sum(-high, angle[0])
    turned = (total, lost + (angle[1] - low), -excess)
    new = [condition.choose(one, other) for one, other in zip(turned, parts, strict=True)]
    return new[0], new[1], new[2]
