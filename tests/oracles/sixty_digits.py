"""An oracle for programs: real values straight from the textbook formulas; None where undefined.

So many digits are carried that sixty are left after what the formulas cancel.
"""

import mpmath
from mpmath import mpf

from rsym.program.program import Program

# The textbook formulas cancel: nests of R_0**m reach 1e230 beside numbers near 1, and lose as many digits squared.
DIGITS = 600


def _root(f, g):
    return mpmath.sqrt(f * f + g * g)


def _norm(f, g, p):
    large = max(abs(f), abs(g))
    return large if large == 0 else large * ((abs(f) / large) ** p + (abs(g) / large) ** p) ** (1 / p)


def _r_alpha(sign):
    def meaning(f, g, alpha):
        if not -1 < alpha <= 1:
            return None
        return (f + g + sign * mpmath.sqrt(max(f * f + g * g - 2 * alpha * f * g, mpf(0)))) / (1 + alpha)

    return meaning


def _r0m(sign):
    return lambda f, g, m: (f + g + sign * _root(f, g)) * _root(f, g) ** m if m >= 1 else None


def _rp(sign):
    return lambda f, g, p: f + g + sign * _norm(f, g, p) if p > 1 else None


def _joining(f, g, m):
    if m < 1:
        return None
    return mpf(0) if f * g == 0 else abs(f) * abs(g) / _norm(f, g, m)


def _r0m_partial(f, g, m):
    r = _root(f, g)
    if m < 1 or r == 0:
        return None if m < 1 else mpf(0)
    return (1 - f / r) * r**m + m * f * (f + g - r) * r ** (m - 2)


def _monomial(f, g, m, powers):
    (a, b, c), r = powers, _root(f, g)
    if r == 0:
        return mpf(0) if m + a + b + c > 0 else None
    return f**a * g**b * r ** (m + c)


def _gap(s, t):
    return (mpmath.sqrt(t * t + s * s) - t) / 2


def _power(u, a):
    if u == 0:
        return None if a < 0 else u**a
    if u < 0 and a != int(a):
        return None
    return u**a


def _signed_power(u, a):
    if u == 0:
        return mpf(0) if a > 0 else None
    return mpmath.sign(u) * abs(u) ** a


def _versine(f, g):
    return 1 - f / _root(f, g) if f or g else None


def _rp_versine(f, g, p):
    if p <= 1 or not (f or g):
        return None
    return 1 - mpmath.sign(f) * (abs(f) / _norm(f, g, p)) ** (p - 1)


def _normalised(f, q):
    return f / mpmath.sqrt(f * f + q) if f * f + q > 0 else None


def _trimming(s, t):
    square = s + _gap(s, t) ** 2
    return mpmath.sqrt(square) if square >= 0 else None


MEANINGS = {
    "undefined": lambda: None,
    "add": lambda u, v: u + v,
    "mul": lambda u, v: u * v,
    "div": lambda u, v: u / v if v else None,
    "neg": lambda u: -u,
    "powi": lambda u, n: u**n,
    "pow": _power,
    "sqrt": lambda u: mpmath.sqrt(u) if u >= 0 else None,
    "abs": abs,
    "sign": mpmath.sign,
    "min": min,
    "max": max,
    "sin": mpmath.sin,
    "cos": mpmath.cos,
    "exp": mpmath.exp,
    "erf": mpmath.erf,
    "asinh": mpmath.asinh,
    "floor": mpmath.floor,
    "softplus": lambda u: max(u, 0) + mpmath.log1p(mpmath.exp(-abs(u))),
    "log": lambda u: mpmath.log(u) if u > 0 else None,
    "atan2": lambda u, v: mpmath.atan2(u, v) if u or v else mpf(0),
    "r0_conjunction": lambda f, g: f + g - _root(f, g),
    "r0_disjunction": lambda f, g: f + g + _root(f, g),
    "versine": _versine,
    "r_alpha_conjunction": _r_alpha(-1),
    "r_alpha_disjunction": _r_alpha(1),
    "r0m_conjunction": _r0m(-1),
    "r0m_disjunction": _r0m(1),
    "r0m_partial": _r0m_partial,
    "monomial": _monomial,
    "norm": _norm,
    "rp_conjunction": _rp(-1),
    "rp_disjunction": _rp(1),
    "rp_versine": _rp_versine,
    "equivalence": lambda f, g, m: None if m < 1 else mpmath.sign(f) * mpmath.sign(g) * _joining(f, g, m),
    "joining": _joining,
    "absolute_power": lambda u, a: _power(abs(u), a),
    "signed_power": _signed_power,
    "gap": _gap,
    "trimming": _trimming,
    "normalised": _normalised,
    "zero_with": lambda f, g: g if f else f,
}


def _select(a, b, yes, no):
    return yes if a is not None and b is not None and a > b else no


def _constant(data):
    if isinstance(data, str):
        return {"pi": mpmath.pi, "e": mpmath.e}[data] + 0
    return mpf(data.numerator) / data.denominator


def values(program: Program, inputs: dict[str, float], digits: int = DIGITS) -> dict[str, mpf | None]:
    """The outputs at a point whose coordinates and letters are exact."""
    with mpmath.workdps(digits):
        known = []
        for operation, arguments, data in program.nodes:
            operands = [known[argument] for argument in arguments]
            if operation in ("const", "input"):
                known.append(_constant(data) if operation == "const" else mpf(inputs[data]))
            elif operation == "select":
                known.append(_select(*operands))
            elif None in operands:
                known.append(None)
            else:
                known.append(MEANINGS[operation](*operands, *([] if data is None else [data])))
        return {name: known[number] for name, number in program.outputs}
