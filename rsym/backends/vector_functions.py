"""Sine, cosine, exponential, logarithm, power and angle on vectors: below 1 ulp, the angle below 2.

Reductions and polynomials are those of fdlibm (Sun Microsystems 1993, freely
distributable), without branches and without fused operations, so a lane gives
the same bits on every processor and whatever stands beside it. Arguments that
the reduction does not hold go to libm, lane by lane.

No library takes this place. libmvec of glibc is right to 4 ulp, on Linux alone.
SVML (package intel-cmplr-lib-rt) is for x86 alone, under Intel's licence, and
chooses its code by the processor, so the bits would depend on it. SLEEF has no
package that llvmlite could link.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from rsym.backends.vector_code import Block, Value, polynomial, two_sum

ARITIES = {"sin": 1, "cos": 1, "exp": 1, "log": 1, "pow": 2, "atan2": 2}


def definitions(operations: Iterable[str], lanes: int) -> list[str]:
    """LLVM functions `rsym_<operation>` on vectors of that many lanes."""
    return [_definition(operation, lanes) for operation in operations]


def _definition(operation: str, lanes: int) -> str:
    formula, beyond = _FORMULAS[operation]
    block = Block(lanes)
    arguments = [Value(block, f"%x{k}", "double") for k in range(ARITIES[operation])]
    vector = block.type_of("double")
    value = formula(*arguments)
    if beyond is None:
        lines = [*block.lines, f"  ret {vector} {value.name}"]
    else:
        lines = _with_libm(operation, block, arguments, value, beyond(*arguments))
    parameters = ", ".join(f"{vector} {argument.name}" for argument in arguments)
    return "\n".join([f"define internal {vector} @rsym_{operation}({parameters}) {{", "entry:", *lines, "}"])


def _with_libm(operation: str, block: Block, arguments: list[Value], value: Value, beyond: Value) -> list[str]:
    """The value, but that of libm in the lanes beyond the reach of the formula."""
    vector, lanes = block.type_of("double"), block.lanes
    lines = [
        *block.lines,
        f"  %mask = bitcast <{lanes} x i1> {beyond.name} to i{lanes}",
        f"  %any = icmp ne i{lanes} %mask, 0",
        "  br i1 %any, label %slow, label %done",
        "slow:",
    ]
    result = value.name
    for lane in range(lanes):
        for k, argument in enumerate(arguments):
            lines.append(f"  %a{lane}.{k} = extractelement {vector} {argument.name}, i32 {lane}")
        scalars = ", ".join(f"double %a{lane}.{k}" for k in range(len(arguments)))
        lines.append(f"  %r{lane} = call double @{operation}({scalars})")
        lines.append(f"  %m{lane} = insertelement {vector} {result}, double %r{lane}, i32 {lane}")
        result = f"%m{lane}"
    return [
        *lines,
        f"  %mixed = select <{lanes} x i1> {beyond.name}, {vector} {result}, {vector} {value.name}",
        "  br label %done",
        "done:",
        f"  %result = phi {vector} [ {value.name}, %entry ], [ %mixed, %slow ]",
        f"  ret {vector} %result",
    ]


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


# The formula, and where libm takes over.
_FORMULAS: dict[str, tuple[Callable[..., Value], Callable[..., Value] | None]] = {
    "sin": (sin, far),
    "cos": (cos, far),
    "exp": (exp, None),
    "log": (log, None),
    "pow": (pow, not_plain),
    "atan2": (atan2, None),
}
