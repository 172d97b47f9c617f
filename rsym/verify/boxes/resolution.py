"""Resolution: the analytic function that a node is on one side of a switch, continued across it, and on its zeros.

Off the zeros of a switch u a node is one of two functions. Where u = 0 it may be a third: `sign` is 0 there, and a
`select` takes its last argument, whichever side that is. What is known of the two sides says nothing of the third:
y - 1 + sign(x)**2 is y on both sides of x = 0 and y - 1 on it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from rsym.logic.stripping import bare, factor
from rsym.program.builder import HALF, Builder
from rsym.program.expansion import SIMPLE
from rsym.program.operations import BRANCHING, CHOOSING, JUMPING
from rsym.verify.boxes.domains import switch_of
from rsym.verify.boxes.generators import is_square, root_order
from rsym.verify.boxes.local import Local, Model
from rsym.verify.boxes.locus import chosen
from rsym.verify.boxes.polynomials import multiplicity

DECIDED = CHOOSING | {"trimming", "atan2"}  # what a box may decide
OPEN = 2  # where it decides nothing: a choice of one function is decided though what it tests may be zero


@dataclass(frozen=True)
class Resolved:
    """What a node is around the zeros of a switch u.

    plus, minus: the functions that it is where u > 0 and where u < 0; contact: a lower bound of the order to which
    these agree where u = 0 (`contact`). thin: the function that has its values where u = 0, None where one of the
    sides is proved to have them too: then the node is continuous from that side, and from both if contact > 0.
    """

    plus: int
    minus: int
    contact: float
    thin: int | None

    @property
    def order(self) -> float:
        """The node is of class C^j for all whole j below this, all values on u = 0 included; 0 says nothing."""
        return self.contact if self.thin is None else 0


def resolved(local: Local, number: int, switch: int) -> Resolved:
    """The sides of a switch, how far they agree where it is zero, and the values there."""
    plus, minus = resolve(local, number, switch, 1), resolve(local, number, switch, -1)
    return Resolved(plus, minus, contact(local, number, switch), _thin(local, number, switch, {1: plus, -1: minus}))


def _thin(local: Local, number: int, switch: int, sides: dict[int, int]) -> int | None:
    """The node where the switch is zero; None if it is one of the sides there, as they are written or by division.

    What is continuous across the switch, |u| and the like, may be continued from either side.
    """
    builder = local.model.builder
    if not local.model.parts(number, JUMPING):
        return None
    for side, beside in sides.items():
        here = resolve(local, number, switch, side, on_zeros=True)
        if here == beside or multiplicity(local.model, builder.sub(here, beside), switch) > 0:
            return None
    return here


def resolve(local: Local, number: int, switch: int, side: int, *, on_zeros: bool = False) -> int:
    """The node with every branch decided: by the box where it decides, by the side (1 or -1) of the switch else.

    Where the switch has the sign of `side`, the result is equal to the node; it may be analytic on the whole box.
    With `on_zeros` it is equal to the node where the switch is zero: what jumps has the value that it has there, the
    rest is continued from the side.
    """
    known, key = local.model.resolutions, (number, switch, side, on_zeros, _decided(local, number))
    if key not in known:
        known[key] = _resolve(local, number, switch, side, on_zeros)
    return known[key]


def _decided(local: Local, number: int) -> tuple[int, ...]:
    """The signs by which a box decides operations that a node needs: all of the box that its resolutions depend on."""
    if number not in local.decided:
        local.decided[number] = tuple(_decision(local, part) for part in local.model.parts(number, DECIDED))
    return local.decided[number]


def _decision(local: Local, part: int) -> int:
    operation, arguments, _ = local.model.builder.nodes[part]
    if operation in {"trimming", "atan2"}:
        return local.sign(arguments[1])
    return OPEN if chosen(local, part) is None else local.sign(switch_of(local.model.builder, part))


def _resolve(local: Local, number: int, switch: int, side: int, on_zeros: bool) -> int:
    done: dict[int, int] = {}
    for part in local.model.order(number):
        jumps = on_zeros and local.model.builder.nodes[part].operation in JUMPING and not _sign(local, part, switch, 0)
        if jumps and _sign(local, part, switch, side):
            done[part] = _on_zeros(local, part, switch, done)
        else:
            done[part] = _resolved(local, part, switch, side, done)
    return done[number]


def _on_zeros(local: Local, part: int, switch: int, done: dict[int, int]) -> int:
    """A jump where what it compares is equal: neither is greater; on its cut atan2 is pi, as above it."""
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[part]
    if operation == "atan2":
        return _angle(builder, done[arguments[0]], done[arguments[1]], 1)
    return builder.const(0) if operation == "sign" else done[arguments[3]]


def _resolved(local: Local, part: int, switch: int, side: int, done: dict[int, int]) -> int:
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[part]
    inner = tuple(done[argument] for argument in arguments)
    sign = _sign(local, part, switch, side)
    if sign:
        if operation == "abs":
            return inner[0] if sign > 0 else builder.neg(inner[0])
        if operation == "sign":
            return builder.const(sign)
        if operation == "select":
            return inner[2 if sign > 0 else 3]
        if operation in {"min", "max"}:
            return inner[0 if (sign > 0) == (operation == "max") else 1]
        if operation == "atan2":
            return _angle(builder, inner[0], inner[1], sign)
        if operation == "trimming":
            return _trimming(builder, done[builder.nodes[arguments[0]].arguments[0]], inner[1], sign)
        return _power(builder, operation, inner[0], builder.value(arguments[1]) or Fraction(0), sign)
    return remade(builder, part, inner)


def remade(builder: Builder, part: int, inner: tuple[int, ...]) -> int:
    """A node with other arguments, simplified as the builder does."""
    operation, arguments, data = builder.nodes[part]
    if inner == arguments:
        return part
    if operation in SIMPLE:
        return SIMPLE[operation](builder, *inner)
    if operation == "powi":
        assert isinstance(data, int)
        return builder.powi(inner[0], data)
    if operation == "div":
        return builder.div(*inner)
    return builder.make(operation, *inner, data=data)


def put(model: Model, number: int, known: Mapping[int, int]) -> int:
    """A node with others in the place of some of its parts."""
    done: dict[int, int] = dict(known)
    for part in model.order(number):
        if part not in done:
            done[part] = remade(model.builder, part, tuple(done[a] for a in model.builder.nodes[part].arguments))
    return done[number]


def _power(b: Builder, operation: str, base: int, exponent: Fraction, sign: int) -> int:
    """A whole power is a polynomial on either side; a fractional one stays as it is, analytic on neither."""
    if exponent.denominator != 1:
        return b.make(operation, base, b.const(exponent))
    power = b.powi(base, int(exponent))
    even = exponent % 2 == 0
    return power if even == (operation == "absolute_power") or sign > 0 else b.neg(power)


def _sign(local: Local, part: int, switch: int, side: int) -> int:
    """The sign that decides an operation: the box's where it has one, else the side's if the switch is this one."""
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[part]
    if operation in BRANCHING:
        deciding = switch_of(builder, part)
        if operation != "sign" and chosen(local, part) is not None:
            return local.sign(deciding)
    elif operation in {"absolute_power", "signed_power"}:
        exponent = builder.value(arguments[1])
        if exponent is None or exponent <= 0:
            return 0
        deciding = arguments[0]
    elif operation == "atan2" and local.sign(arguments[1]) < 0:
        deciding = arguments[0]
    elif operation == "trimming" and is_square(builder, arguments[0]) and local.sign(arguments[1]) > 0:
        deciding = builder.nodes[arguments[0]].arguments[0]
    else:
        return 0
    return factor(builder, deciding) * side if bare(builder, deciding) == switch else 0


def _angle(b: Builder, sine: int, cosine: int, sign: int) -> int:
    """The polar angle of a point to the left, continued from above or below the cut: that of its opposite and pi."""
    opposite = b.make("atan2", b.neg(sine), b.neg(cosine))
    half_turn = b.make("const", data="pi")
    return b.add(opposite, half_turn) if sign > 0 else b.sub(opposite, half_turn)


def _trimming(b: Builder, f: int, t: int, sign: int) -> int:
    """sqrt(f**2 + gap**2) = |f| sqrt(1 + s**3/(4 (q + t)**2)) for t > 0, with s = f**2 and q = sqrt(t**2 + s**2)."""
    s = b.square(f)
    root = b.sqrt(b.add(b.square(t), b.square(s)))
    ratio = b.mul(b.const(HALF * HALF), b.div(b.powi(s, 3), b.square(b.add(root, t))))
    stretched = b.mul(f, b.sqrt(b.add(b.const(1), ratio)))
    return stretched if sign > 0 else b.neg(stretched)


def contact(local: Local, number: int, switch: int) -> float:
    """A lower bound of the order to which the two resolutions of a node agree on the zeros of the switch.

    With order k their difference is u**k times an analytic function, u the switch: the node is of class C^j across
    it for all whole j < k; a power |u|**k has its exponent as order, whole or not. The rules
    follow from a1 b1 - a2 b2 = a1 (b1 - b2) + (a1 - a2) b2; each node has the order of its difference and the order
    of its own zero on u = 0. Infinite where both are one analytic function. Of the values on u = 0 nothing is said
    (`Resolved`). Other generators must be excluded by the
    box. Where the resolutions are polynomials the order is also the multiplicity of u in their difference.
    """
    known, key = local.model.orders_of_contact, (number, switch, _decided(local, number))
    if key not in known:
        known[key] = _contact(local, number, switch)
    return known[key]


def _contact(local: Local, number: int, switch: int) -> float:
    orders: dict[int, tuple[float, float]] = {}
    for part in local.model.order(number):
        orders[part] = _orders(local, part, switch, orders)
    if orders[number][0] > 3:
        return orders[number][0]
    sides = resolve(local, number, switch, 1), resolve(local, number, switch, -1)
    return max(orders[number][0], multiplicity(local.model, local.model.builder.sub(*sides), switch))


def _orders(local: Local, part: int, switch: int, orders: dict[int, tuple[float, float]]) -> tuple[float, float]:
    """(order of the difference, order of the zero)."""
    builder = local.model.builder
    operation, arguments, data = builder.nodes[part]
    if bare(builder, part) == switch:
        return math.inf, 1
    if operation == "const":
        return math.inf, math.inf if builder.value(part) == 0 else 0
    inner = [orders[argument] for argument in arguments]
    if operation in CHOOSING and (branch := chosen(local, part)) is not None:
        return orders[branch[0]]
    if _sign(local, part, switch, 1):
        return _switched(builder, part, inner, orders)
    if not inner:
        return math.inf, 0
    if operation in {"sqrt", "pow"} and (exponent := root_order(builder, part)) is not None:
        if bare(builder, builder.nodes[arguments[0]].arguments[0]) == switch:
            return float(exponent), float(exponent)
    difference = min(own for own, _ in inner)
    zeros = [zero for _, zero in inner]
    if operation == "mul":
        return min(zeros[0] + inner[1][0], inner[0][0] + zeros[1]), zeros[0] + zeros[1]
    if operation == "powi":
        assert isinstance(data, int)
        return inner[0][0] + (data - 1) * zeros[0], data * zeros[0]
    if operation == "add":
        return difference, min(zeros)
    if operation == "neg":
        return difference, zeros[0]
    if operation == "div":
        return min(inner[0][0], zeros[0] + inner[1][0]), zeros[0]
    return difference, 0


def _switched(
    b: Builder, part: int, inner: list[tuple[float, float]], orders: dict[int, tuple[float, float]]
) -> tuple[float, float]:
    """An operation that the switch decides."""
    operation, arguments, _ = b.nodes[part]
    if operation in {"abs", "trimming"}:
        return 1, 1
    if operation in {"min", "max"}:
        return min(1, *(own for own, _ in inner)), min(zero for _, zero in inner)
    if operation in {"absolute_power", "signed_power"}:
        exponent = float(b.value(arguments[1]) or 0)
        return exponent, exponent
    if operation == "select":
        difference = b.sub(arguments[2], arguments[3])
        own = min(orders[arguments[2]][0], orders[arguments[3]][0])
        return min(own, _zero_order(b, difference, arguments, orders)), min(inner[2][1], inner[3][1])
    return 0, 0


def _zero_order(
    b: Builder, difference: int, arguments: tuple[int, ...], orders: dict[int, tuple[float, float]]
) -> float:
    """The order of the zero of the difference of two branches: known where they are one node or both vanish."""
    if b.value(difference) == 0:
        return math.inf
    return min(orders[arguments[2]][1], orders[arguments[3]][1])
