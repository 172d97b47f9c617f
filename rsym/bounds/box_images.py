"""The images of nodes over a box, as nodes of another builder: of the elementary operations, then of all."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fractions import Fraction
from functools import partial

from rsym.bounds.interval_arithmetic import (
    ELEMENTARY,
    Interval,
    clipped,
    constant,
    corners,
    hull,
    negative,
    nonnegative,
    nothing,
    only_nonnegative,
    outward,
    product,
    quotient,
    root,
    size_power,
    sizes,
    square,
    total,
    whole_power,
    within_domain,
)
from rsym.bounds.interval_monotone import ROOT_IMAGES, SYSTEM_IMAGES, Rule, cosine, monotone, norm_share, versine
from rsym.bounds.relations import relation
from rsym.program.builder import HALF, Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, live

# Below this a constant that float64 does not hold loses more than a share of 2**-53 when it is rounded.
_SUBNORMAL = Fraction(1, 2**1000)


def scaled(b: Builder, factor: Fraction, u: Interval) -> Interval:
    """A constant times u, rounding of the constant included."""
    if abs(factor) < _SUBNORMAL:
        return product(b, constant(b, factor), u)
    turned = u if factor > 0 else Interval(u.upper, u.lower)
    return outward(b, turned.each(lambda end: b.mul(b.const(factor), end)))


def _powi(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    assert isinstance(node.data, int)
    return whole_power(b, operands[0], node.data)


def _pow(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """A negative base has powers with integer exponents: where those may occur nothing is known."""
    base, exponent = operands
    if base.nonnegative:
        return size_power(b, base, exponent)
    value = b.value(exponent.lower)
    if exponent.lower == exponent.upper and value is not None and value.denominator > 1:
        return size_power(b, within_domain(b, base), exponent)
    return size_power(b, only_nonnegative(b, base), exponent)


def _log(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    return outward(b, within_domain(b, operands[0]).each(lambda end: b.make("log", end)), ELEMENTARY)


def _wave(name: str) -> Rule:
    """Sin and cos: a peak lies inside where the slope turns from rising to falling; from a width of 3 on, all."""

    def rule(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
        (u,) = operands
        zero, one = b.const(0), b.const(1)
        slopes = [b.make("cos", end) if name == "sin" else b.neg(b.make("sin", end)) for end in u[:2]]
        plain = corners(b, lambda end: b.make(name, end), u, error=ELEMENTARY)
        width = b.sub(u.upper, u.lower)

        def turning(first: tuple[int, int], last: tuple[int, int], extreme: int, otherwise: int) -> int:
            inside = b.select(*first, b.select(*last, extreme, otherwise), otherwise)
            return b.select(width, b.const(3), extreme, inside)

        rising, falling = (slopes[0], zero), (zero, slopes[1])
        upper = turning(rising, falling, one, plain.upper)
        lower = turning((zero, slopes[0]), (slopes[1], zero), b.const(-1), plain.lower)
        return clipped(b, Interval(lower, upper), -1, 1)

    return rule


def _atan2(b: Builder, node: Node, operands: Sequence[Interval], turning: bool = False) -> Interval:
    """Monotone in each alone, but for the cut u = 0, v <= 0; a u that is not negative only touches the cut.

    `turning`: whole turns do not count, so that on the cut the angle goes on beyond pi.
    """
    u, v = operands
    plain = corners(b, lambda *ends: b.make("atan2", *ends), u, v, error=ELEMENTARY)
    if u.nonnegative:
        return plain
    zero, spread = b.const(0), b.sub(plain.upper, plain.lower)
    # A little above pi; NaN where an end of u or v is, which must not look like the cut.
    turn = b.select(b.abs(spread), b.const(-1), b.const(Fraction(22, 7)), b.undefined())

    ends = Interval(b.neg(turn), turn)
    if turning:
        opposite = (negative(b, side) for side in operands)
        around = corners(b, lambda *ends: b.make("atan2", *ends), *opposite, error=ELEMENTARY)
        beyond = total(b, constant(b, "pi"), around)
        ends = Interval(
            b.select(zero, v.upper, beyond.lower, ends.lower), b.select(zero, v.upper, beyond.upper, ends.upper)
        )

    def unless_cut(end: int, extreme: int) -> int:
        right = b.select(v.lower, zero, end, extreme)
        return b.select(u.lower, zero, end, b.select(zero, u.upper, end, right))

    return Interval(unless_cut(plain.lower, ends.lower), unless_cut(plain.upper, ends.upper))


def chosen(b: Builder, operands: Sequence[Interval], decisive: bool) -> Interval:
    """`yes` where a > b, `no` where not, both where that is open.

    `decisive`: no value at all comes of an undefined a or b, so a > b over the box leaves `yes` alone;
    otherwise an undefined a or b gives `no`.
    """
    first, second, yes, no = operands
    both = hull(b, yes, no)
    reach = b.sub(first.upper, second.lower)  # not above 0: never a > b

    def end(sure: int, refused: int, either: int) -> int:
        known = b.select(b.abs(reach), b.const(-1), refused, either)
        maybe = b.select(reach, b.const(0), either, known)
        return b.select(first.lower, second.upper, sure, maybe) if decisive else maybe

    return Interval(end(yes.lower, no.lower, both.lower), end(yes.upper, no.upper, both.upper))


def _zero_with(b: Builder, node: Node, operands: Sequence[Interval]) -> Interval:
    """The image of g, with 0 where f may be."""
    f, g = operands
    zero = b.const(0)
    both = hull(b, g, Interval(zero, zero))

    def end(own: int, wider: int) -> int:
        return b.select(f.lower, zero, own, b.select(zero, f.upper, own, wider))

    return Interval(end(g.lower, both.lower), end(g.upper, both.upper))


class IntervalImages(dict[str, Rule]):
    """By operation, or by the name of a relation; what is monotone is left to its row."""

    def __missing__(self, name: str) -> Rule:
        if not OPERATIONS[name].grows:
            raise KeyError(name)
        return partial(monotone, name)


IMAGES = IntervalImages(
    {
        "const": lambda b, node, operands: constant(b, node.data),
        "undefined": lambda b, node, operands: nothing(b),
        "add": lambda b, node, operands: total(b, *operands),
        "mul": lambda b, node, operands: product(b, *operands),
        "div": lambda b, node, operands: quotient(b, *operands),
        "neg": lambda b, node, operands: negative(b, *operands),
        "powi": _powi,
        "pow": _pow,
        "sqrt": lambda b, node, operands: root(b, *operands),
        "abs": lambda b, node, operands: sizes(b, *operands),
        "sin": _wave("sin"),
        "cos": _wave("cos"),
        "log": _log,
        "atan2": _atan2,
        "zero_with": _zero_with,
        **ROOT_IMAGES,
        **SYSTEM_IMAGES,
        # Products and quotients of related operands.
        "square": lambda b, node, operands: square(b, *operands),
        "direction": partial(monotone, "sign"),
        "share": lambda b, node, operands: cosine(b, *operands),
        "norm_share": norm_share,
        # half the versine of (t, s)
        "gap_share": lambda b, node, operands: scaled(b, HALF, versine(b, node, operands[::-1])),
    }
)


class BoxImages:
    """The image of each node of `source` over a box, made in `target` when it is asked for.

    `sides` gives intervals of inputs; an input ``x`` that it does not name has the ends ``x_lower``, ``x_upper``.
    """

    def __init__(
        self, source: Builder, target: Builder, sides: Mapping[str, Interval] | None = None, strict: bool = False
    ) -> None:
        self.source = source
        self.target = target
        self.sides = dict(sides or {})
        self.strict = strict
        self.images: dict[int, Interval] = {}
        self._definedness = Definedness((), [])
        self._examined = 0

    def __getitem__(self, number: int) -> Interval:
        if number not in self.images:
            self.make([number])
        return self.images[number]

    def make(self, numbers: Iterable[int]) -> None:
        """The images of these nodes and of all that they need."""
        for number in live(self.source.nodes, numbers):
            if number not in self.images:
                image = self._image(number, self.source.nodes[number])
                known = self.source.nonnegative[number] and not image.nonnegative
                self.images[number] = nonnegative(self.target, image) if known else image

    def side(self, name: str) -> Interval:
        """The interval of an input."""
        if name not in self.sides:
            lower, upper = ends_of([name])
            self.sides[name] = Interval(self.target.input(lower), self.target.input(upper))
        return self.sides[name]

    def _image(self, number: int, node: Node) -> Interval:
        b, operands = self.target, [self.images[argument] for argument in node.arguments]
        if node.operation == "input":
            return self.side(str(node.data))
        if node.operation == "mul":
            factor = self.source.value(node.arguments[0])
            if factor is not None:
                return scaled(b, factor, operands[1])
        if node.operation == "select":
            return self._select(node, operands)
        name, arguments = relation(self.source.nodes, number) or (node.operation, node.arguments)
        operands = [self.images[argument] for argument in arguments]
        if name in {"sin", "cos"}:
            operands = [self._angle(arguments[0], Fraction(1))]
        elif name in {"square", "abs"} and self.source.nodes[arguments[0]].operation == "atan2":  # even: without a cut
            u, v = (self.images[argument] for argument in self.source.nodes[arguments[0]].arguments)
            operands = [_atan2(b, node, [sizes(b, u), v])]
        if self.strict and (name in {"sqrt", "log"} or (name == "pow" and self._is_root(arguments[1]))):
            operands[0] = only_nonnegative(b, operands[0])
        return IMAGES[name](b, node, operands)

    def _angle(self, number: int, factor: Fraction) -> Interval:
        """The image of an angle that counts `factor` times, of which whole turns do not count."""
        b, (operation, arguments, _) = self.target, self.source.nodes[number]
        if operation == "neg":
            return negative(b, self._angle(arguments[0], factor))
        if operation == "add":
            return total(b, *(self._angle(argument, factor) for argument in arguments))
        value = self.source.value(arguments[0]) if operation == "mul" else None
        if value is not None:
            return scaled(b, value, self._angle(arguments[1], factor * value))
        if operation == "atan2" and factor.denominator == 1:
            return _atan2(b, self.source.nodes[number], [self.images[argument] for argument in arguments], turning=True)
        return self.images[number]

    def _is_root(self, exponent: int) -> bool:
        """Whether a power with this exponent has no value for a negative base."""
        value = self.source.value(exponent)
        return value is not None and value.denominator > 1

    def _select(self, node: Node, operands: list[Interval]) -> Interval:
        """A branch that is never defined leaves the other."""
        never = [self.source.nodes[argument].operation == "undefined" for argument in node.arguments]
        if never[2] or never[3]:
            return operands[3] if never[2] else operands[2]
        return chosen(self.target, operands, is_decisive(self._definedness_of_all(), node))

    def _definedness_of_all(self) -> Definedness:
        if self._examined < len(self.source.nodes):
            self._examined = len(self.source.nodes)
            self._definedness = Definedness(tuple(self.source.nodes), self.source.nonnegative)
        return self._definedness


def ends_of(names: Sequence[str]) -> tuple[str, ...]:
    """The names of the ends of inputs or outputs.

    Examples
    --------
    >>> ends_of(["x"])
    ('x_lower', 'x_upper')
    """
    return tuple(f"{name}_{end}" for name in names for end in ("lower", "upper"))


class Definedness:
    """What the form of a program says of undefined values, by node."""

    def __init__(self, nodes: tuple[Node, ...], nonnegative: list[bool]) -> None:
        self._nodes = nodes
        self._nonnegative = nonnegative
        self._total: list[bool] = []
        for operation, arguments, _ in nodes:
            defined = OPERATIONS[operation].total or (operation == "sqrt" and nonnegative[arguments[0]])
            self._total.append(defined and all(self._total[argument] for argument in arguments))

    def causes(self, number: int) -> tuple[int, ...]:
        """Nodes of which one is undefined wherever this node is, as far down as that can be followed."""
        found: dict[int, None] = {}
        seen: set[int] = set()
        stack = [number]
        while stack:
            part = stack.pop()
            if part in seen or self._total[part]:
                continue
            seen.add(part)
            if self._passes_on(part):
                stack.extend(self._nodes[part].arguments)
            else:
                found[part] = None
        return tuple(found)

    def _passes_on(self, number: int) -> bool:
        """Whether a node is undefined where an argument is, and only there."""
        operation, arguments, _ = self._nodes[number]
        if operation == "sqrt":
            return self._nonnegative[arguments[0]]
        row = OPERATIONS[operation]
        return row.total and row.strict

    def fails_with(self, number: int, cause: int) -> bool:
        """Undefined wherever the node `cause` is."""
        known: dict[int, bool] = {}
        for k in live(self._nodes, [number]):
            operation, arguments, _ = self._nodes[k]
            fails = [known[argument] for argument in arguments]
            if k == cause or operation == "undefined":
                known[k] = True
            elif operation == "select":
                known[k] = fails[3] and any(fails[:3])
            else:
                known[k] = OPERATIONS[operation].strict and any(fails)
        return known[number]


def is_decisive(definedness: Definedness, node: Node) -> bool:
    """Whether a select has no value where what it compares is undefined."""
    first, second, _, no = node.arguments
    causes = [cause for u in (first, second) for cause in definedness.causes(u)]
    return all(definedness.fails_with(no, cause) for cause in causes)
