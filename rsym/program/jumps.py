"""Where the two sides of a switch differ: at such a point a derivative does not exist.

A program differentiates each branch of a choice on its own, which is right wherever no choice is on its border. At a
point of a border let a node have the values v_s on the sides s, each side a formula that is smooth there. Here every
node u gets a companion J(u), also a node of the program, with

    |v_s - v| <= J(u) on all sides s, v the value that the program computes,

and J(u) = 0 where no choice below u is on its border. If J(f) = 0 and J(D) = 0 for the formula D = df/dx, then all
f_s(p + h) = f(p) + h D + o(h), whichever side p + h lies on: df/dx exists and is D. Where J(f) > 0 the function jumps,
where J(D) > 0 it has a kink. The argument repeats for D in the place of f, to any order.

J follows from bounds of the slopes of the operations: what is bounded times what vanishes has no jump, so
x**2 sign(x) has the gradient 0 at 0, and no second derivative.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction

from rsym.program.builder import Builder
from rsym.program.program import Node, live

TURN = Fraction(44, 7)  # a little more than 2 pi

Companions = Sequence[int]
Rule = Callable[[Builder, int, Node, Companions], int]


class Jumps:
    """The companions J of nodes, made when they are asked for; the constant 0 where no choice matters.

    Examples
    --------
    >>> builder = Builder(("x",), ())
    >>> x, zero = builder.input("x"), builder.const(0)
    >>> positive = builder.select(x, zero, x, zero)
    >>> jumps = Jumps(builder)
    >>> builder.value(jumps[x]), builder.value(jumps[positive])
    (Fraction(0, 1), None)
    """

    def __init__(self, builder: Builder) -> None:
        self.builder = builder
        self._known: dict[int, int] = {}

    def __getitem__(self, number: int) -> int:
        b = self.builder
        zero = b.const(0)
        for part in live(b.nodes, [number]):
            if part not in self._known:
                node = b.nodes[part]
                inner = [self._known[argument] for argument in node.arguments]
                smooth = node.operation not in SWITCHES and all(jump == zero for jump in inner)
                self._known[part] = zero if smooth or b.uniform[part] else self._companion(part, node, inner)
        return self._known[number]

    def _companion(self, number: int, node: Node, inner: Companions) -> int:
        if node.operation in {"sin", "cos"}:
            return self._without_turns(node.arguments[0], Fraction(1))
        return RULES.get(node.operation, _unbounded)(self.builder, number, node, inner)

    def _without_turns(self, number: int, factor: Fraction) -> int:
        """J of an angle of which whole turns do not count: the cut of atan2, times a whole number, is none."""
        b = self.builder
        operation, arguments, _ = b.nodes[number]
        if operation == "neg":
            return self._without_turns(arguments[0], factor)
        if operation == "add":
            return b.add(*(self._without_turns(argument, factor) for argument in arguments))
        value = b.value(arguments[0]) if operation == "mul" else None
        if value is not None:
            return b.mul(b.const(abs(value)), self._without_turns(arguments[1], factor * value))
        if operation == "atan2" and factor.denominator == 1:
            return _bearing(b, number, b.nodes[number], [self[argument] for argument in arguments])
        return self[number]

    def borders(self, number: int) -> int:
        """A node that is positive where a choice below a node is on its border, else 0."""
        b = self.builder
        total = b.const(0)
        for part in live(b.nodes, [number]):
            operation, arguments, _ = b.nodes[part]
            if operation in SWITCHES and self[part] != b.const(0):
                apart = b.sub(*arguments[:2]) if operation == "select" else arguments[0]
                total = b.add(total, b.select(b.abs(apart), b.const(0), b.const(0), b.const(1)))
        return total


def _sum(b: Builder, jumps: Companions) -> int:
    total = b.const(0)
    for jump in jumps:
        total = b.add(total, jump)
    return total


def _lipschitz(factor: int) -> Rule:
    """An operation of which no partial derivative is larger in size."""
    return lambda b, number, node, jumps: b.mul(b.const(factor), _sum(b, jumps[:2]))


def _infinite(b: Builder) -> int:
    return b.make("exp", b.const(10**5))


def _unbounded(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """Nothing is known of the other sides where an argument jumps."""
    return b.select(_sum(b, jumps), b.const(0), _infinite(b), b.const(0))


def _mul(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    (u, v), (p, q) = node.arguments, jumps
    return b.add(b.add(b.mul(b.abs(u), q), b.mul(b.abs(v), p)), b.mul(p, q))


def _powi(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """||u| + j|**n - |u|**n <= n (|u| + j)**(n - 1) j."""
    assert isinstance(node.data, int)
    reach = b.add(b.abs(node.arguments[0]), jumps[0])
    return b.mul(b.const(node.data), b.mul(b.powi(reach, node.data - 1), jumps[0]))


def _div(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """(j_u + |u/v| j_v)/(|v| - j_v) for j_v < |v|."""
    p, q = jumps
    size = b.abs(node.arguments[1])
    near = b.make("div", b.add(p, b.mul(b.abs(number), q)), b.sub(size, q))
    return b.select(size, q, near, _unbounded(b, number, node, jumps))


def _sqrt(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """|sqrt(u + j) - sqrt(u)| <= j/sqrt(u), and sqrt(j)."""
    near = b.make("div", jumps[0], number)
    return b.select(number, b.const(0), near, b.sqrt(jumps[0]))


def _exp(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    return b.mul(b.mul(number, b.make("exp", jumps[0])), jumps[0])


def _log(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    (u,), (p,) = node.arguments, jumps
    return b.select(u, p, b.make("div", p, b.sub(u, p)), _unbounded(b, number, node, jumps))


def _power(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """A (|u| + j)**(a - 1) j for a constant exponent a >= 1, 2 j**a for 0 < a < 1."""
    base, exponent = node.arguments
    value = b.value(exponent)
    if value is None or value <= 0:
        return _unbounded(b, number, node, jumps)
    if value < 1:
        return b.mul(b.const(2), b.absolute_power(jumps[0], exponent))
    reach = b.absolute_power(b.add(b.abs(base), jumps[0]), b.sub(exponent, b.const(1)))
    return b.mul(b.mul(exponent, reach), jumps[0])


def _r_alpha(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """No partial derivative is larger than 2/(1 + alpha)."""
    return b.div(b.mul(b.const(2), _sum(b, jumps[:2])), b.add(b.const(1), node.arguments[2]))


def _r0m(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """No partial derivative is larger than (2 + 3 m) r**m."""
    f, g, order = node.arguments
    total = _sum(b, jumps[:2])
    size = b.add(b.sqrt(b.add(b.square(f), b.square(g))), total)
    slope = b.mul(b.add(b.const(2), b.mul(b.const(3), order)), b.absolute_power(size, order))
    return b.mul(slope, total)


def _versine(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """No partial derivative of 1 - f/r is larger than 1/r; the values lie in [0, 2]."""
    f, g = node.arguments
    return _within(b, b.sqrt(b.add(b.square(f), b.square(g))), _sum(b, jumps), 2)


def _normalised(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """f/r, r**2 = f**2 + q: for j_f < r/4 and j_q < r**2/4 r stays above half of it, and J <= 2 j_f/r + 2 j_q/r**2."""
    (f, q), (p, s) = node.arguments, jumps
    size = b.sqrt(b.add(b.square(f), q))
    return _within(b, size, b.add(p, b.make("div", s, size)), 2)


def _zero_with(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """That of the second; where the first is 0 and does not jump, the value is 0 on all sides."""
    (f, g), (p, q), zero = node.arguments, jumps, b.const(0)
    return b.select(b.abs(f), p, q, b.select(p, zero, b.add(b.abs(g), q), zero))


def _within(b: Builder, size: int, total: int, most: int) -> int:
    """4 total/size where that is below 1, else `most` where there is a jump at all."""
    wide = b.mul(b.const(4), total)
    some = b.select(total, b.const(0), b.const(most), b.const(0))
    return b.select(size, wide, b.make("div", wide, size), some)


def _bearing(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """The turn of a vector whose end moves by j, off the cut: at most 2 j/r."""
    u, v = node.arguments
    total = _sum(b, jumps)
    if b.value(total) == 0:
        return total
    return _within(b, b.sqrt(b.add(b.square(u), b.square(v))), total, 7)


def _atan2(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """A whole turn on the cut u = 0, v < 0; where u or v cannot be negative there is none."""
    u, v = node.arguments
    bearing = _bearing(b, number, node, jumps)
    if b.nonnegative[u] or b.nonnegative[v]:
        return bearing
    behind = b.select(v, jumps[1], b.const(0), b.const(TURN))
    return b.add(bearing, b.select(b.abs(u), jumps[0], b.const(0), behind))


def _sign(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    return b.select(b.abs(node.arguments[0]), jumps[0], b.const(0), b.const(2))


def _select(b: Builder, number: int, node: Node, jumps: Companions) -> int:
    """On the border both branches count. A border on which the value is undefined, or without points, is none."""
    first, second, yes, no = node.arguments
    shift = b.add(jumps[0], jumps[1])
    apart = b.select(first, second, jumps[2], jumps[3])
    if shift == b.const(0) and _is_no_border(b, node):
        return apart
    both = b.add(b.abs(b.sub(yes, no)), b.add(jumps[2], jumps[3]))
    return b.select(b.abs(b.sub(first, second)), shift, apart, both)


def _is_no_border(b: Builder, node: Node) -> bool:
    """The same all over the plane or space, or undefined where the two operands are equal."""
    first, second, _, no = node.arguments
    if b.uniform[first] and b.uniform[second]:
        return True
    operation, arguments, _ = b.nodes[no]
    back = operation == "select" and arguments[:2] == (second, first)
    return b.nodes[arguments[3] if back else no].operation == "undefined"


SWITCHES = frozenset({"select", "sign", "atan2"})
RULES: dict[str, Rule] = {
    **dict.fromkeys("add neg abs min max gap norm joining equivalence".split(), _lipschitz(1)),
    **dict.fromkeys("r0_conjunction r0_disjunction rp_conjunction rp_disjunction".split(), _lipschitz(2)),
    **dict.fromkeys("pow absolute_power signed_power".split(), _power),
    **dict.fromkeys(["r_alpha_conjunction", "r_alpha_disjunction"], _r_alpha),
    **dict.fromkeys(["r0m_conjunction", "r0m_disjunction"], _r0m),
    "mul": _mul,
    "powi": _powi,
    "div": _div,
    "sqrt": _sqrt,
    "exp": _exp,
    "log": _log,
    "versine": _versine,
    "normalised": _normalised,
    "zero_with": _zero_with,
    "atan2": _atan2,
    "sign": _sign,
    "select": _select,
}


def doubt(b: Builder, jump: int, size: int, share: Fraction) -> int:
    """1 where a jump is more than this share of the size, or unknown, else 0: what is less is rounding."""
    zero, one = b.const(0), b.const(1)
    if jump == zero:
        return zero
    unknown = b.select(jump, b.const(-1), zero, one)
    return b.select(b.mul(b.const(share), size), jump, zero, b.select(jump, zero, one, unknown))


def unless(b: Builder, doubts: int, value: int) -> int:
    """The value, or NaN where there is a doubt."""
    return value if b.value(doubts) == 0 else b.select(doubts, b.const(0), b.undefined(), value)
