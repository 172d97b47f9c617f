"""Rows of the elementary functions, of smooth steps and ramps too: erf and softplus."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from rsym.model.functions import Softplus
from rsym.program.powers import log1p
from rsym.program.program import Node
from rsym.program.row import (
    UP,
    Given,
    Nodes,
    Operation,
    lipschitz,
    nonzero,
    of_power,
    positive,
    summed,
    unbounded,
    within,
)
from rsym.program.texts import call

TURN = Fraction(44, 7)  # a little more than 2 pi


def _jump_of_logarithm(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    (u,), (p,) = node.arguments, jumps
    return b.select(u, p, b.make("div", p, b.sub(u, p)), unbounded(b, number, node, jumps))


def _pow(b: Nodes, number: int, node: Node, d: Given) -> int:
    base, exponent = node.arguments
    lowered = b.make("pow", base, b.sub(exponent, b.const(1)))
    result = b.mul(b.mul(exponent, lowered), d[0])
    if b.value(d[1]) == 0:
        return result
    return b.add(result, b.mul(b.mul(number, b.make("log", base)), d[1]))


def _atan2(b: Nodes, number: int, node: Node, d: Given) -> int:
    u, v = node.arguments
    turn = _turn(b, u, v, d[0])
    if turn is not None:
        return turn
    return b.div(b.sub(b.mul(v, d[0]), b.mul(u, d[1])), b.add(b.square(u), b.square(v)))


def _turn(b: Nodes, u: int, v: int, slope: int) -> int | None:
    """The angle of (cos w, sin w) is w but for whole turns, that of (|cos w|, sin w) is w back and forth: no quotient.

    Over boxes a quotient of sums of squares would undo every bound.
    """
    folded = b.nodes[v].operation == "abs"
    cosine = b.nodes[v].arguments[0] if folded else v
    sine = b.nodes[u].arguments[0] if b.nodes[u].operation == "neg" else u
    pair = b.nodes[sine].operation, b.nodes[cosine].operation
    if pair != ("sin", "cos") or b.nodes[sine].arguments != b.nodes[cosine].arguments:
        return None
    inner = _without(b, slope, cosine)
    return b.mul(inner, b.div(cosine, v)) if folded and inner is not None else inner


def _without(b: Nodes, product: int, factor: int) -> int | None:
    """The other factor of a product, signs and constants kept."""
    if product == factor:
        return b.const(1)
    operation, arguments, _ = b.nodes[product]
    if b.value(product) == 0:
        return product
    if operation == "neg":
        rest = _without(b, arguments[0], factor)
        return None if rest is None else b.neg(rest)
    if operation != "mul":
        return None
    if factor in arguments:
        return arguments[1 - arguments.index(factor)]
    rest = _without(b, arguments[1], factor) if b.value(arguments[0]) is not None else None
    return None if rest is None else b.mul(arguments[0], rest)


def bearing(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """The turn of a vector whose end moves by j, off the cut: at most 2 j/r."""
    u, v = node.arguments
    total = summed(b, jumps)
    if b.value(total) == 0:
        return total
    return within(b, b.sqrt(b.add(b.square(u), b.square(v))), total, 7)


def _jump_of_angle(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """A whole turn on the cut u = 0, v < 0; where u or v cannot be negative there is none."""
    u, v = node.arguments
    turned = bearing(b, number, node, jumps)
    if b.nonnegative[u] or b.nonnegative[v]:
        return turned
    behind = b.select(v, jumps[1], b.const(0), b.const(TURN))
    return b.add(turned, b.select(b.abs(u), jumps[0], b.const(0), behind))


ELEMENTARY: dict[str, Operation] = {
    "sin": Operation(  # of jumps of its angle whole turns do not count: `jumps` bounds those of sine and cosine
        1,
        lambda np, u: np.sin(u),
        derivative=lambda b, number, node, d: b.mul(b.make("cos", node.arguments[0]), d[0]),
        formula=sp.sin,
        texts=call("sin", julia="rsym_sin"),
        analytic=(),
        strict=True,
        parity="odd",
        zeros=("0",),
    ),
    "cos": Operation(
        1,
        lambda np, u: np.cos(u),
        derivative=lambda b, number, node, d: b.neg(b.mul(b.make("sin", node.arguments[0]), d[0])),
        formula=sp.cos,
        texts=call("cos", julia="rsym_cos"),
        analytic=(),
        strict=True,
        parity="even",
    ),
    "exp": Operation(
        1,
        lambda np, u: np.exp(u),
        derivative=lambda b, number, node, d: b.mul(number, d[0]),
        jump=lambda b, number, node, jumps: b.mul(b.mul(number, b.make("exp", jumps[0])), jumps[0]),
        formula=sp.exp,
        texts=call("exp"),
        grows=(UP,),
        rounding="elementary",
        analytic=(),
        strict=True,
        nonnegative=True,
    ),
    "log": Operation(
        1,
        lambda np, u: np.log(u),
        derivative=lambda b, number, node, d: b.div(d[0], node.arguments[0]),
        jump=_jump_of_logarithm,
        formula=sp.log,
        texts=call("log", rust="ln", matlab="rsym_log", julia="rsym_log", vm="ln"),
        domain=(positive(0),),
        analytic=(positive(0),),
        strict=True,
    ),
    "pow": Operation(
        2,
        lambda np, u, a: np.float_power(u, a),
        derivative=_pow,
        jump=of_power,
        formula=lambda u, a: u**a,
        texts=call(
            "pow",
            2,
            numpy="power",
            # Its own gives NaN for these, where that of C, and NumPy's, is 1.
            javascript="{0} === 1 || ({0} === -1 && Math.abs({1}) === Infinity) ? 1 : Math.pow({0}, {1})",
            matlab="rsym_power",
            fortran="{} ** {}",
            rust="powf",
            julia="rsym_power",
            vm="",
        ),
        domain=(positive(0),),
        analytic=(positive(0),),
        zeros=("0+",),
    ),
    "atan2": Operation(
        2,
        lambda np, u, v: np.arctan2(u, v),
        derivative=_atan2,
        jump=_jump_of_angle,
        formula=sp.atan2,
        texts=call("atan2", 2, numpy="arctan2", julia="atan", glsl="atan"),
        analytic=((*nonzero(0), *positive(1)),),
        strict=True,
        jumping=True,
        zeros=("0+",),
    ),
}


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(map(float, text.split()))


# fdlibm (Sun Microsystems 1993, freely distributable): numerators and denominators for |u| below 27/32, below 5/4,
# below 20/7, and beyond.
_ERF_AT_1 = 8.45062911510467529297e-01  # rounded to float32: what follows is added to it
_ERF_NEAR = (
    _numbers("""1.28379167095512558561e-01 -3.25042107247001499370e-01 -2.84817495755985104766e-02
        -5.77027029648944159157e-03 -2.37630166566501626084e-05"""),
    _numbers("""1 3.97917223959155352819e-01 6.50222499887672944485e-02 5.08130628187576562776e-03
        1.32494738004321644526e-04 -3.96022827877536812320e-06"""),
)
_ERF_BESIDE = (
    _numbers("""-2.36211856075265944077e-03 4.14856118683748331666e-01 -3.72207876035701323847e-01
        3.18346619901161753674e-01 -1.10894694282396677476e-01 3.54783043256182359371e-02
        -2.16637559486879084300e-03"""),
    _numbers("""1 1.06420880400844228286e-01 5.40397917702171048937e-01 7.18286544141962662868e-02
        1.26171219808761642112e-01 1.36370839120290507362e-02 1.19844998467991074170e-02"""),
)
_ERF_WIDE = (
    _numbers("""-9.86494403484714822705e-03 -6.93858572707181764372e-01 -1.05586262253232909814e+01
        -6.23753324503260060396e+01 -1.62396669462573470355e+02 -1.84605092906711035994e+02
        -8.12874355063065934246e+01 -9.81432934416914548592e+00"""),
    _numbers("""1 1.96512716674392571292e+01 1.37657754143519042600e+02 4.34565877475229228821e+02
        6.45387271733267880336e+02 4.29008140027567833386e+02 1.08635005541779435134e+02
        6.57024977031928170135e+00 -6.04244152148580987438e-02"""),
)
_ERF_FAR = (
    _numbers("""-9.86494292470009928597e-03 -7.99283237680523006574e-01 -1.77579549177547519889e+01
        -1.60636384855821916062e+02 -6.37566443368389627722e+02 -1.02509513161107724954e+03
        -4.83519191608651397019e+02"""),
    _numbers("""1 3.03380607434824582924e+01 3.25792512996573918826e+02 1.53672958608443695994e+03
        3.19985821950859553908e+03 2.55305040643316442583e+03 4.74528541206955367215e+02
        -2.24409524465858183362e+01"""),
)


def _polynomial(b: Nodes, z: int, coefficients: Sequence[float]) -> int:
    """c0 + c1 z + c2 z**2 + ..., by Horner."""
    *lower, last = (b.const(Fraction(coefficient)) for coefficient in coefficients)
    value = last
    for coefficient in reversed(lower):
        value = b.make("add", coefficient, b.make("mul", z, value))
    return value


def _erf_expansion(b: Nodes, node: Node) -> int:
    """The formulas of fdlibm (Sun Microsystems 1993), below 2 ulp: u (1 + P/Q) near 0, then 1 - exp(-u**2 + P/Q)/u."""
    (u,) = node.arguments
    size, square, one = b.abs(u), b.make("mul", u, u), b.const(1)
    ratios = {name: _polynomial(b, at, above) for name, at, above, _ in _erf_pieces(b, size, square)}
    for name, at, _, below in _erf_pieces(b, size, square):
        ratios[name] = b.make("div", ratios[name], _polynomial(b, at, below))

    def tail(ratio: int) -> int:
        exponent = b.make("add", ratio, b.make("add", b.neg(square), b.const(Fraction(-9, 16))))
        return b.sub(one, b.make("div", b.make("exp", exponent), size))

    far = b.select(size, b.const(Fraction(20, 7)), tail(ratios["far"]), tail(ratios["wide"]))
    beside = b.make("add", b.const(Fraction(_ERF_AT_1)), ratios["beside"])
    near = b.make("add", size, b.make("mul", size, ratios["near"]))
    value = b.select(b.const(Fraction(5, 4)), size, beside, far)
    value = b.select(b.const(Fraction(27, 32)), size, near, value)
    return b.select(b.const(0), u, b.neg(value), value)


def _erf_pieces(b: Nodes, size: int, square: int) -> tuple[tuple[str, int, Sequence[float], Sequence[float]], ...]:
    """The variable, the numerator and the denominator of each range."""
    inverse = b.make("div", b.const(1), square)
    return (
        ("near", square, *_ERF_NEAR),
        ("beside", b.sub(size, b.const(1)), *_ERF_BESIDE),
        ("wide", inverse, *_ERF_WIDE),
        ("far", inverse, *_ERF_FAR),
    )


def _erf(b: Nodes, number: int, node: Node, d: Given) -> int:
    """2/sqrt(pi) exp(-u**2) u'."""
    scale = b.div(b.const(2), b.sqrt(b.make("const", data="pi")))
    return b.mul(b.mul(scale, b.make("exp", b.neg(b.square(node.arguments[0])))), d[0])


def _softplus_expansion(b: Nodes, node: Node) -> int:
    """max(u, 0) + log(1 + exp(-|u|)), which neither overflows nor loses what is small."""
    (u,) = node.arguments
    small = b.make("exp", b.neg(b.make("abs", u)))
    return b.make("add", b.make("max", u, b.const(0)), log1p(b, small))


def _asinh_expansion(b: Nodes, node: Node) -> int:
    """sign(u) log(1 + |u| + u**2/(1 + sqrt(1 + u**2))): no digit is lost near 0, none below it."""
    (u,) = node.arguments
    size = b.abs(u)
    square = b.make("mul", u, u)
    root = b.sqrt(b.make("add", b.const(1), square))
    near = log1p(b, b.make("add", size, b.make("div", square, b.make("add", b.const(1), root))))
    # The square of what is large overflows.
    far = b.make("add", b.make("log", size), b.make("log", b.const(2)))
    value = b.select(size, b.const(2**28), far, near)
    return b.select(b.const(0), u, b.neg(value), value)


def _floor(b: Nodes, number: int, node: Node, d: Given) -> int:
    """0, and nothing at a step."""
    return b.select(node.arguments[0], number, b.const(0), b.undefined())


def _jump_of_floor(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """Further than j from every integer there is none, else at most 1 + j."""
    above = b.sub(node.arguments[0], number)
    gap = b.make("min", above, b.sub(b.const(1), above))
    return b.select(gap, jumps[0], b.const(0), b.add(b.const(1), jumps[0]))


STEPS: dict[str, Operation] = {
    "floor": Operation(
        1,
        lambda np, u: np.floor(u),
        derivative=_floor,
        jump=_jump_of_floor,
        formula=sp.floor,
        texts=call(
            "floor",
            llvm="call {type} @llvm.floor.{suffix}({type} {0})",
            fortran="aint({0}) - merge(1d0, 0d0, aint({0}) > {0})",
        ),
        grows=(UP,),
        at=lambda u: u.floor(),
        rounding="none",
        strict=True,
        zeros=("0",),
    ),
}


SMOOTH_STEPS: dict[str, Operation] = {
    "erf": Operation(
        1,
        lambda np, u: np.vectorize(math.erf, otypes=[np.float64])(u),
        _erf_expansion,
        _erf,
        lipschitz(2),
        formula=sp.erf,
        grows=(UP,),
        at=lambda u: u.erf(),
        rounding="elementary",
        analytic=(),
        strict=True,
        parity="odd",
        zeros=("0",),
    ),
    "asinh": Operation(
        1,
        lambda np, u: np.arcsinh(u),
        _asinh_expansion,
        lambda b, number, node, d: b.div(d[0], b.sqrt(b.add(b.const(1), b.square(node.arguments[0])))),
        lipschitz(1),
        formula=sp.asinh,
        grows=(UP,),
        at=lambda u: u.asinh(),
        rounding="elementary",
        analytic=(),
        strict=True,
        parity="odd",
        zeros=("0",),
    ),
    "softplus": Operation(
        1,
        lambda np, u: np.logaddexp(0.0, u),
        _softplus_expansion,
        # u'/(1 + exp(-u)): exp(-u) overflows, and its derivatives with it
        lambda b, number, node, d: b.mul(b.make("exp", b.neg(b.make("softplus", b.neg(node.arguments[0])))), d[0]),
        lipschitz(1),
        formula=Softplus,
        grows=(UP,),
        at=lambda u: u + (-u).exp().log1p() if u > 0 else u.exp().log1p(),
        rounding="elementary",
        analytic=(),
        strict=True,
        nonnegative=True,
    ),
}
