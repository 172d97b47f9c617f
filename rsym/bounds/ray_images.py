"""The image of every operation on quadratic models: an R-operation has its own, as its row says.

What is monotone has the range through its values at the ends of its operands; where it is smooth, away from corners, it
is also composed of sums, products and roots of models, and the narrower of both is taken. A row without a rule of its
own is followed through its expansion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

from rsym.bounds.ray_functions import angle, exponential, logarithm, power, quotient, wave, whole_power
from rsym.bounds.ray_models import RayArithmetic, RayModel, RayRange
from rsym.program.builder import HALF, Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, live
from rsym.program.row import DOWN, UP_IN_SIZE

Operands: TypeAlias = Sequence[RayModel]
Rule: TypeAlias = Callable[[RayArithmetic, Node, Operands], RayModel]


def minimum(m: RayArithmetic, u: RayModel, v: RayModel) -> RayModel:
    """The smaller: u + min(0, v - u) or v + min(0, u - v), so that it moves as one of them does; of ranges a range."""
    b = m.b
    low, high = m.range(m.subtract(u, v))
    down_u, down_v = m.greater(high, m.zero), m.greater(b.neg(low), m.zero)
    wide_u, wide_v = (b.add(b.sub(w.high, w.low), down) for w, down in ((u, down_u), (v, down_v)))
    moved = m.chosen(wide_v, wide_u, m.lowered(u, down_u), m.lowered(v, down_v))
    flat = m.hull(m.lesser(u.low, v.low), m.lesser(u.high, v.high))
    return m.chosen(b.add(m.reach(u), m.reach(v)), m.zero, moved, flat)


def maximum(m: RayArithmetic, u: RayModel, v: RayModel) -> RayModel:
    """The greater."""
    return m.negative(minimum(m, m.negative(u), m.negative(v)))


def either(m: RayArithmetic, u: RayModel, v: RayModel) -> RayModel:
    """What contains both: u + [min(0, v - u), max(0, v - u)]."""
    low, high = m.range(m.subtract(v, u))
    down, up = m.greater(m.b.neg(low), m.zero), m.greater(high, m.zero)
    moved = m.negative(m.lowered(m.negative(m.lowered(u, down)), up))
    flat = m.hull(m.lesser(u.low, v.low), m.greater(u.high, v.high))
    return m.chosen(m.b.add(m.reach(u), m.reach(v)), m.zero, moved, flat)


def size(m: RayArithmetic, u: RayModel) -> RayModel:
    """|u|."""
    b, (low, high) = m.b, m.range(u)
    folded = m.hull(m.zero, m.greater(b.neg(low), high))
    return m.chosen(low, m.zero, u, m.chosen(m.zero, high, m.negative(u), folded))


def select(m: RayArithmetic, node: Node, operands: Operands, cautious: bool = False) -> RayModel:
    """`yes` where a > b; `cautious` where what is compared may be undefined, which makes it `no`."""
    first, second, yes, no = operands
    low, high = m.range(m.subtract(first, second))
    both = either(m, yes, no)
    return m.chosen(high, m.zero, both if cautious else m.chosen(low, m.zero, yes, both), no)


def _zero_with(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    f, g = operands
    low, high = m.range(f)
    with_zero = either(m, g, m.number(m.zero))
    return m.chosen(low, m.zero, g, m.chosen(m.zero, high, g, with_zero))


def _pow(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    """A negative base has values where the exponent may be whole: there nothing is known."""
    base, exponent = operands
    if exponent.low != exponent.high:
        low, _ = m.range(base)
        return m.chosen(low, m.zero, exponential(m, m.product(exponent, logarithm(m, base))), m.unknown())
    value = m.b.value(exponent.low)
    found = power(m, base, exponent.low)
    if value is not None:
        return found  # undefined below 0 unless it is whole, and then each base has its power
    low, _ = m.range(base)
    return m.chosen(m.zero, low, m.unknown(), found)


def _absolute_power(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    return _pow(m, node, (size(m, operands[0]), operands[1]))


def _signed_power(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    """sign(u)|u|**a; beyond all bounds at a pole."""
    u, exponent = operands
    low, high = m.range(u)
    upwards, downwards = (_pow(m, node, (one, exponent)) for one in (u, m.negative(u)))
    _, most = m.range(upwards)
    _, least = m.range(downwards)
    across = m.hull(m.b.neg(least), most)
    falls = m.unknown()
    exponents, _ = m.range(exponent)
    across = m.chosen(exponents, m.zero, across, falls)
    return m.chosen(low, m.zero, upwards, m.chosen(m.zero, high, m.negative(downwards), across))


def monotone(name: str, m: RayArithmetic, operands: Operands) -> RayRange:
    """The range of a monotone operation, by its row."""
    b, row = m.b, OPERATIONS[name]
    ranges = [m.range(u) for u in operands]
    for place, way in enumerate(row.grows):
        low, high = ranges[place]
        if way == UP_IN_SIZE:
            ranges[place] = RayRange(m.greater(low, b.neg(high), m.zero), m.greater(b.neg(low), high))
    for clause in row.domain:
        for kind, place in clause:
            if kind == "nonnegative":
                ranges[place] = RayRange(*(m.greater(end, m.zero) for end in ranges[place]))
    least = [u.high if way == DOWN else u.low for u, way in zip(ranges, row.grows, strict=True)]
    most = [u.low if way == DOWN else u.high for u, way in zip(ranges, row.grows, strict=True)]
    low, high = b.make(name, *least), b.make(name, *most)
    if row.rounding == "none":
        return RayRange(low, high)
    # Where numbers of both signs are added, what is lost is a share of them.
    over = b.add(m.one, least[-1]) if row.rounding == "sum over 1 + parameter" else m.one

    def lost(at: Sequence[int]) -> list[int]:
        return [b.div(b.abs(end), over) for end in at[:2]] if row.rounding.startswith("sum") else []

    found = RayRange(m.widened(low, low, *lost(least)).low, m.widened(high, high, *lost(most)).high)
    return RayRange(m.greater(found.low, m.zero), found.high) if row.nonnegative else found


def _elementary(function: Callable[..., RayModel]) -> Rule:
    return lambda m, node, operands: function(m, *operands)


class RayImages(dict[str, Rule]):
    """By operation; what has no rule and is monotone is left to its row, all else to its expansion."""

    def __missing__(self, name: str) -> Rule:
        return _by_its_row if OPERATIONS[name].grows else expanded


def _by_its_row(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    return m.hull(*monotone(node.operation, m, operands))


def narrower(composed: Callable[..., RayModel], name: str) -> Rule:
    """Composed where it is smooth, else the range by its row."""

    def rule(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
        return m.better(composed(m, *operands), *monotone(name, m, operands))

    return rule


def expanded(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    """Through the expansion of an operation into primitive ones."""
    expansion, inner = OPERATIONS[node.operation].expansion, Builder(tuple(f"{k}" for k in range(len(operands))), ())
    if expansion is None:
        return m.unknown()
    known: dict[int, RayModel] = {}
    arguments = []
    for name, u in zip(inner.coordinates, operands, strict=True):
        value = m.b.value(u.low) if u.low == u.high else None
        arguments.append(inner.input(name) if value is None else inner.const(value))
        known[arguments[-1]] = u
    result = expansion(inner, Node(node.operation, tuple(arguments), node.data))
    for number in live(inner.nodes, [result]):
        if number not in known:
            part = inner.nodes[number]
            known[number] = IMAGES[part.operation](m, part, [known[argument] for argument in part.arguments])
    return known[result]


def _branches(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    """A branch that is never defined leaves the other."""
    _, _, yes, no = operands
    if never(m, yes) or never(m, no):
        return no if never(m, yes) else yes
    return select(m, node, operands)


def never(m: RayArithmetic, u: RayModel) -> bool:
    """Whether a model stands for what is undefined."""
    return m.b.nodes[u.low].operation == "undefined"


def _radius(m: RayArithmetic, f: RayModel, g: RayModel) -> RayModel:
    return m.root(m.add(m.square(f), m.square(g)))


def _r0(sign: int) -> Callable[..., RayModel]:
    """F + g + sign*r."""

    def composed(m: RayArithmetic, f: RayModel, g: RayModel) -> RayModel:
        r = _radius(m, f, g)
        return m.add(m.add(f, g), r if sign > 0 else m.negative(r))

    return composed


def _r_alpha(sign: int) -> Callable[..., RayModel]:
    """(f + g + sign*r)/(1 + alpha), r**2 = (f - alpha g)**2 + (1 - alpha**2) g**2."""

    def composed(m: RayArithmetic, f: RayModel, g: RayModel, alpha: RayModel) -> RayModel:
        a, one = alpha.low, m.one
        rest = m.number(m.b.mul(m.b.sub(one, a), m.b.add(one, a)))
        sheared = m.subtract(f, m.product(g, alpha))
        r = m.root(m.add(m.square(sheared), m.product(m.square(g), rest)))
        total = m.add(m.add(f, g), r if sign > 0 else m.negative(r))
        return m.product(total, m.number(m.b.make("div", one, m.b.add(one, a))))

    return composed


def gap(m: RayArithmetic, s: RayModel, t: RayModel) -> RayModel:
    """(q - t)/2 with q = sqrt(t**2 + s**2), s**2/(2 (q + t)) for t > 0, where nothing cancels."""
    q, (low, _) = _radius(m, t, s), m.range(t)
    quotient_ = m.product(m.square(s), m.inverse(m.times(m.add(q, t), 2)))
    return m.chosen(low, m.zero, quotient_, m.times(m.subtract(q, t), HALF))


def _trimming(m: RayArithmetic, s: RayModel, t: RayModel) -> RayModel:
    excess = m.better(gap(m, s, t), *monotone("gap", m, (s, t)))
    return m.root(m.add(s, m.square(excess)))


def _normalised(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
    """f/sqrt(f**2 + q), of the sign of f and within [-1, 1]."""
    f, q = operands
    unit = m.product(f, m.inverse(m.root(m.add(m.square(f), q))))
    low, high = m.range(f)
    least, most = m.b.select(low, m.zero, m.zero, m.b.neg(m.one)), m.b.select(m.zero, high, m.zero, m.one)
    return m.better(unit, least, most)


def _norm(m: RayArithmetic, f: RayModel, g: RayModel, p: RayModel) -> RayModel:
    """(|f|**p + |g|**p)**(1/p)."""
    total = m.add(*(power(m, size(m, u), p.low) for u in (f, g)))
    return power(m, total, m.b.div(m.one, p.low))


def _within(m: RayArithmetic, u: RayModel, least: int) -> RayModel:
    """A share of 1."""
    return m.better(u, m.b.const(least), m.one)


def _rp(sign: int) -> Callable[..., RayModel]:
    """F + g + sign*n."""

    def composed(m: RayArithmetic, f: RayModel, g: RayModel, p: RayModel) -> RayModel:
        n = _norm(m, f, g, p)
        return m.add(m.add(f, g), n if sign > 0 else m.negative(n))

    return composed


def _joining(m: RayArithmetic, f: RayModel, g: RayModel, order: RayModel) -> RayModel:
    """|f||g|/n."""
    return quotient(m, m.product(size(m, f), size(m, g)), _norm(m, f, g, order))


def _r0m(sign: int) -> Rule:
    """The operation of R_0 times r**m."""
    plain, name = _r0(sign), "r0_conjunction" if sign < 0 else "r0_disjunction"

    def rule(m: RayArithmetic, node: Node, operands: Operands) -> RayModel:
        f, g, order = operands
        value = m.better(plain(m, f, g), *monotone(name, m, (f, g)))
        return m.product(value, power(m, _radius(m, f, g), order.low))

    return rule


IMAGES = RayImages(
    {
        "const": lambda m, node, operands: m.number(m.b.make("const", data=node.data)),
        "undefined": lambda m, node, operands: m.number(m.b.undefined()),
        "add": _elementary(RayArithmetic.add),
        "mul": _elementary(RayArithmetic.product),
        "square": _elementary(RayArithmetic.square),
        "neg": _elementary(RayArithmetic.negative),
        "div": _elementary(quotient),
        "inverse": _elementary(RayArithmetic.inverse),
        "powi": lambda m, node, operands: whole_power(m, operands[0], int(node.data)),  # type: ignore[arg-type]
        "sqrt": _elementary(RayArithmetic.root),
        "abs": _elementary(size),
        "min": _elementary(minimum),
        "max": _elementary(maximum),
        "select": _branches,
        "select_cautious": partial(select, cautious=True),
        "zero_with": _zero_with,
        "sin": _elementary(partial(wave, sine=True)),
        "cos": _elementary(partial(wave, sine=False)),
        "exp": _elementary(exponential),
        "log": _elementary(logarithm),
        "pow": _pow,
        "atan2": _elementary(angle),
        "absolute_power": _absolute_power,
        "signed_power": _signed_power,
        "normalised": _normalised,
        "r0_conjunction": narrower(_r0(-1), "r0_conjunction"),
        "r0_disjunction": narrower(_r0(1), "r0_disjunction"),
        "r_alpha_conjunction": narrower(_r_alpha(-1), "r_alpha_conjunction"),
        "r_alpha_disjunction": narrower(_r_alpha(1), "r_alpha_disjunction"),
        "r0m_conjunction": _r0m(-1),
        "r0m_disjunction": _r0m(1),
        "norm": narrower(_norm, "norm"),
        "rp_conjunction": narrower(_rp(-1), "rp_conjunction"),
        "rp_disjunction": narrower(_rp(1), "rp_disjunction"),
        "joining": narrower(_joining, "joining"),
        "norm_share": lambda m, node, operands: _within(m, quotient(m, operands[0], _norm(m, *operands)), -1),
        "gap_share": lambda m, node, operands: _within(m, quotient(m, gap(m, *operands), _radius(m, *operands)), 0),
        "gap": narrower(gap, "gap"),
        "trimming": narrower(_trimming, "trimming"),
    }
)
