"""Rows of arithmetic and of choices."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import sympy as sp

from rsym.model.nodes import ZeroWith
from rsym.model.rnodes import R1Conjunction, R1Disjunction
from rsym.program.powers import whole_power
from rsym.program.program import Node
from rsym.program.row import (
    HALF,
    NOWHERE,
    SWITCH,
    UP,
    Far,
    Given,
    Nodes,
    Operation,
    Rule,
    aligned,
    apart,
    homogeneous,
    lipschitz,
    nonnegative,
    nonzero,
    positive,
    raised,
    unbounded,
)
from rsym.program.texts import call, choice, infix

Parts = Sequence[Far]


def _far_sum(b: Nodes, node: Node, parts: Parts) -> Far:
    (u, v), degree = aligned(b, parts)
    return Far(b.add(u, v), degree)


def _mul(b: Nodes, number: int, node: Node, d: Given) -> int:
    u, v = node.arguments
    if u == v:
        return b.mul(b.const(2), b.mul(u, d[0]))
    for first, second, slope in ((u, v, d[0]), (v, u, d[1])):
        if b.nodes[second] == ("abs", (first,), None):
            return b.mul(b.const(2), b.mul(second, slope))  # w|w| has a derivative at w = 0 too
        if b.nodes[second].operation == "sqrt" and (n := _exponent(b, first, b.nodes[second].arguments[0])):
            return b.mul(b.const(1 + Fraction(1, 2 * n)), b.mul(second, slope))  # and so has w**n sqrt(w)
    return b.add(b.mul(d[0], v), b.mul(u, d[1]))


def _exponent(b: Nodes, power: int, base: int) -> int:
    """The n of c*base**n, c a number; 0 for what is no such power."""
    operation, arguments, data = b.nodes[power]
    if power == base:
        return 1
    if operation == "mul" and arguments == (base, base):
        return 2
    if operation == "mul" and b.value(arguments[0]) is not None:
        return _exponent(b, arguments[1], base)
    return data if operation == "powi" and arguments == (base,) and isinstance(data, int) else 0


def _jump_of_product(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    (u, v), (p, q) = node.arguments, jumps
    return b.add(b.add(b.mul(b.abs(u), q), b.mul(b.abs(v), p)), b.mul(p, q))


def _far_product(b: Nodes, node: Node, parts: Parts) -> Far:
    u, v = parts
    return Far(b.mul(u.node, v.node), u.degree + v.degree)


def _jump_of_quotient(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """(j_u + |u/v| j_v)/(|v| - j_v) for j_v < |v|."""
    p, q = jumps
    size = b.abs(node.arguments[1])
    near = b.make("div", b.add(p, b.mul(b.abs(number), q)), b.sub(size, q))
    return b.select(size, q, near, unbounded(b, number, node, jumps))


def _far_quotient(b: Nodes, node: Node, parts: Parts) -> Far:
    u, v = parts
    return Far(b.div(u.node, v.node), u.degree - v.degree)


def _powi(b: Nodes, number: int, node: Node, d: Given) -> int:
    assert isinstance(node.data, int)
    return b.mul(b.mul(b.const(node.data), b.powi(node.arguments[0], node.data - 1)), d[0])


def _multiplied(b: Nodes, node: Node) -> int:
    assert isinstance(node.data, int)
    return whole_power(b, node.arguments[0], node.data)


def _jump_of_whole_power(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """||u| + j|**n - |u|**n <= n (|u| + j)**(n - 1) j."""
    assert isinstance(node.data, int)
    reach = b.add(b.abs(node.arguments[0]), jumps[0])
    return b.mul(b.const(node.data), b.mul(b.powi(reach, node.data - 1), jumps[0]))


def _far_whole_power(b: Nodes, node: Node, parts: Parts) -> Far:
    assert isinstance(node.data, int)
    return Far(b.powi(parts[0].node, node.data), parts[0].degree * node.data)


def _jump_of_root(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """|sqrt(u + j) - sqrt(u)| <= j/sqrt(u), and sqrt(j)."""
    near = b.make("div", jumps[0], number)
    return b.select(number, b.const(0), near, b.sqrt(jumps[0]))


def _far_root(b: Nodes, node: Node, parts: Parts) -> Far:
    """An odd degree is raised to an even one first."""
    degree = parts[0].degree + parts[0].degree % 2
    return Far(b.sqrt(raised(b, parts[0], degree)), degree // 2)


def _sign(b: Nodes, number: int, node: Node, d: Given) -> int:
    return b.const(0)


def _chosen_sign(b: Nodes, node: Node) -> int:
    """1, -1, or the argument itself: 0 stays 0 and NaN stays NaN."""
    (u,) = node.arguments
    return b.select(u, b.const(0), b.const(1), b.select(b.const(0), u, b.const(-1), u))


def _extremum(sign: int) -> Rule:
    """The derivative of the operand that decides; NaN on a tie."""

    def rule(b: Nodes, number: int, node: Node, d: Given) -> int:
        u, v = node.arguments
        first, second = ((v, u), (u, v))[::-sign]
        return b.select(*first, d[0], b.select(*second, d[1], b.undefined()))

    return rule


def _select(b: Nodes, number: int, node: Node, d: Given) -> int:
    return b.select(node.arguments[0], node.arguments[1], d[2], d[3])


def _jump_of_choice(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """On the border both branches count. A border on which the value is undefined, or without points, is none."""
    first, second, yes, no = node.arguments
    shift = b.add(jumps[0], jumps[1])
    apart_by = b.select(first, second, jumps[2], jumps[3])
    if shift == b.const(0) and _is_no_border(b, node):
        return apart_by
    both = b.add(b.abs(b.sub(yes, no)), b.add(jumps[2], jumps[3]))
    return b.select(b.abs(b.sub(first, second)), shift, apart_by, both)


def _is_no_border(b: Nodes, node: Node) -> bool:
    """The same all over the plane or space, or undefined where the two operands are equal."""
    first, second, _, no = node.arguments
    if b.uniform[first] and b.uniform[second]:
        return True
    operation, arguments, _ = b.nodes[no]
    back = operation == "select" and arguments[:2] == (second, first)
    return b.nodes[arguments[3] if back else no].operation == "undefined"


def _far_choice(b: Nodes, node: Node, parts: Parts) -> Far:
    compared, _ = aligned(b, parts[:2])
    branches, degree = aligned(b, parts[2:])
    return Far(b.select(*compared, *branches), degree)


def _zero_with(b: Nodes, number: int, node: Node, d: Given) -> int:
    """That of the second, defined or not."""
    return d[1]


def _chosen_zero(b: Nodes, node: Node) -> int:
    f, g = node.arguments
    return b.select(b.abs(f), b.const(0), g, f)


def _jump_of_zero(b: Nodes, number: int, node: Node, jumps: Given) -> int:
    """That of the second; where the first is 0 and does not jump, the value is 0 on all sides."""
    (f, g), (p, q), zero = node.arguments, jumps, b.const(0)
    return b.select(b.abs(f), p, q, b.select(p, zero, b.add(b.abs(g), q), zero))


def _far_zero(b: Nodes, node: Node, parts: Parts) -> Far:
    f, g = parts
    return Far(b.zero_with(f.node, g.node), g.degree)


def _order_texts(before: str, name: str) -> dict[str, str]:
    """The first operand if it comes before the second or is NaN: so NaN is passed on, whichever operand it is.

    GLSL's own function may drop NaN, which its numbers need not have at all, and is one instruction.
    """
    test = f"({{0}} {before} {{1}}) | ({{0}} != {{0}})"
    own = f"{name}({{0}}, {{1}})"
    fortran = f"merge({{0}}, {{1}}, {{0}} {before} {{1}} .or. {{0}} /= {{0}})"
    return choice(test, "{0}", "{1}", fortran=fortran, matlab=f"rsym_{own}", glsl=own, vm=f"{name} {{0}} {{1}}")


def _order(sign: int) -> Operation:
    """Min and max: not SymPy's, of which old versions print that of a number and an array as one of a ragged list."""
    return Operation(
        2,
        (lambda np, a, b: np.minimum(a, b)) if sign < 0 else (lambda np, a, b: np.maximum(a, b)),
        derivative=_extremum(sign),
        jump=lipschitz(1),
        far=homogeneous,
        formula=R1Conjunction if sign < 0 else R1Disjunction,
        texts=_order_texts("<", "min") if sign < 0 else _order_texts(">", "max"),
        grows=(UP, UP),
        rounding="none",
        analytic=(apart(SWITCH),),
        strict=True,
        symmetric=True,
        homogeneous=True,
        branching=True,
        logic="and" if sign < 0 else "or",
        zeros=("00", "0+", "+0") if sign < 0 else ("00", "0-", "-0"),
    )


ARITHMETIC: dict[str, Operation] = {
    "const": Operation(0, lambda np: None, analytic=()),  # data: Fraction, "pi" or "e"
    "input": Operation(0, lambda np: None, analytic=()),  # data: the name
    "undefined": Operation(
        0,
        lambda np: np.float64(np.nan),
        derivative=lambda b, number, node, d: b.undefined(),
        formula=lambda: sp.S.NaN,
        domain=NOWHERE,
    ),
    "add": Operation(
        2,
        lambda np, a, b: np.add(a, b),
        derivative=lambda b, number, node, d: b.add(d[0], d[1]),
        jump=lipschitz(1),
        far=_far_sum,
        formula=lambda a, b: a + b,
        texts=infix("{} + {}", "fadd {type} {0}, {1}", "add {} {}"),
        analytic=(),
        strict=True,
        symmetric=True,
        zeros=("00",),
    ),
    "mul": Operation(
        2,
        lambda np, a, b: np.multiply(a, b),
        derivative=_mul,
        jump=_jump_of_product,
        far=_far_product,
        formula=lambda a, b: a * b,
        texts=infix("{} * {}", "fmul {type} {0}, {1}", "mul {} {}", matlab="{} .* {}"),
        analytic=(),
        strict=True,
        symmetric=True,
        zeros=("0*", "*0"),
    ),
    "div": Operation(
        2,
        lambda np, a, b: np.divide(a, b),
        derivative=lambda b, number, node, d: b.div(b.sub(d[0], b.mul(number, d[1])), node.arguments[1]),
        jump=_jump_of_quotient,
        far=_far_quotient,
        formula=lambda a, b: a / b,
        texts=infix("{} / {}", "fdiv {type} {0}, {1}", "div {} {}", matlab="{} ./ {}"),
        domain=(nonzero(1),),
        analytic=(apart(1),),
        strict=True,
        zeros=("0+", "0-"),
    ),
    "neg": Operation(
        1,
        lambda np, a: np.negative(a),
        derivative=lambda b, number, node, d: b.neg(d[0]),
        jump=lipschitz(1),
        far=lambda b, node, parts: Far(b.neg(parts[0].node), parts[0].degree),
        formula=lambda a: -a,
        texts=infix("-{}", "fneg {type} {0}", "neg {}"),
        analytic=(),
        strict=True,
        zeros=("0",),
    ),
    "powi": Operation(  # data: the exponent, at least 3
        1,
        lambda np, a, exponent: np.float_power(a, float(exponent)),
        _multiplied,
        _powi,
        _jump_of_whole_power,
        _far_whole_power,
        lambda a, exponent: a**exponent,
        analytic=(),
        strict=True,
        zeros=("0",),
    ),
    "sqrt": Operation(
        1,
        lambda np, a: np.sqrt(a),
        derivative=lambda b, number, node, d: b.div(b.mul(b.const(HALF), d[0]), number),
        jump=_jump_of_root,
        far=_far_root,
        formula=sp.sqrt,
        texts=call("sqrt", llvm="call {type} @llvm.sqrt.{suffix}({type} {0})", matlab="rsym_sqrt", julia="rsym_sqrt"),
        domain=(nonnegative(0),),
        analytic=(positive(0),),
        strict=True,
        nonnegative=True,
        zeros=("0",),
    ),
    "abs": Operation(
        1,
        lambda np, a: np.abs(a),
        # u' u/|u|: NaN at 0
        derivative=lambda b, number, node, d: b.mul(d[0], b.div(node.arguments[0], number)),
        jump=lipschitz(1),
        far=lambda b, node, parts: Far(b.abs(parts[0].node), parts[0].degree),
        formula=sp.Abs,
        texts=call("abs", llvm="call {type} @llvm.fabs.{suffix}({type} {0})", c="fabs", cuda="fabs"),
        analytic=(apart(SWITCH),),
        strict=True,
        nonnegative=True,
        homogeneous=True,
        parity="even",
        branching=True,
        zeros=("0",),
    ),
    "sign": Operation(
        1,
        lambda np, a: np.sign(a),
        _chosen_sign,
        _sign,
        lambda b, number, node, jumps: b.select(b.abs(node.arguments[0]), jumps[0], b.const(0), b.const(2)),
        formula=sp.sign,
        grows=(UP,),
        rounding="none",
        analytic=(apart(SWITCH),),
        strict=True,
        parity="odd",
        branching=True,
        jumping=True,
        zeros=("0",),
    ),
    "min": _order(-1),
    "max": _order(1),
    "select": Operation(  # `yes` where a > b, elsewhere `no`
        4,
        lambda np, a, b, yes, no: np.where(a > b, yes, no),
        derivative=_select,
        jump=_jump_of_choice,
        far=_far_choice,
        formula=lambda a, b, yes, no: sp.Piecewise((yes, a > b), (no, True)),
        # GLSL: a choice by ? and : may become a branch, and hundreds of those in a loop take some compilers for ever.
        texts=choice("{0} > {1}", "{2}", "{3}", glsl="mix({3}, {2}, {0} > {1})"),
        analytic=(apart(SWITCH),),
        branching=True,
        jumping=True,
    ),
    "zero_with": Operation(  # g, which goes to 0 where f does; 0 where f is, even if g is undefined
        2,
        lambda np, f, g: np.where(np.abs(f) > 0, g, f),
        _chosen_zero,
        _zero_with,
        _jump_of_zero,
        _far_zero,
        ZeroWith,
        analytic=(nonzero(0),),
        zeros=("0*", "*0"),
    ),
}
