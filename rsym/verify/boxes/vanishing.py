"""Which nodes of a program are known exactly at a point: rational numbers, and zeros that no ball could prove.

A ball around a value that is 0 contains 0 and proves nothing. Zero is known where it was given (the point is the
common zero of two nodes), where the value follows in rational arithmetic, or by the zeros of the operations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence, Set
from fractions import Fraction

from rsym.bounds.balls import arb, ctx, exact
from rsym.logic.stripping import bare
from rsym.program.operations import CHOOSING, OPERATIONS
from rsym.verify.boxes.domains import is_legal
from rsym.verify.boxes.local import PRECISE, Local, Model
from rsym.verify.boxes.locus import chosen

AROUND = 2.0**-120  # half the width of the neighbourhood on which branches are decided
SIMPLE = 10_000  # a fraction with a smaller denominator that agrees with a point is tried in its place
_BITS = 4096  # rational numbers longer than this only cost time
_STEEP = 64  # of powers
ZERO = Fraction(0)


def _root(value: Fraction) -> Fraction | None:
    if value < 0:
        return None
    root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
    return root if root * root == value else None


def _power(base: Fraction, exponent: Fraction) -> Fraction | None:
    """|u|**a where that is rational; of square roots no others are looked for."""
    size = abs(base)
    if exponent > 0 and size in (0, 1):
        return size
    root = size if exponent.denominator == 1 else _root(size) if exponent.denominator == 2 else None
    return root**exponent.numerator if root is not None and 0 < exponent.numerator < _STEEP else None


_RATIONAL: dict[str, Callable[..., Fraction | None]] = {
    "add": lambda a, b: a + b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b if b else None,
    "neg": lambda a: -a,
    "sqrt": _root,
    "abs": abs,
    "absolute_power": _power,
    "sign": lambda a: Fraction((a > 0) - (a < 0)),
    "min": min,
    "max": max,
}


class Exact:
    """The exact values known at one point, which lies in the box of `local`.

    `coordinates` are rational or None; `zeros` are nodes that vanish at the point, which others must have proved.
    """

    def __init__(self, local: Local, coordinates: Mapping[str, Fraction | None], zeros: frozenset[int]) -> None:
        self.local = local
        builder = local.model.builder
        self.zeros = zeros | {bare(builder, number) for number in zeros}
        self.inputs = {**{name: low for name, (low, _) in local.model.letters.items()}, **coordinates}
        self.values: dict[int, Fraction | None] = {}

    def value(self, number: int) -> Fraction | None:
        """The value of a node, None if it is not known exactly."""
        for part in self.local.model.order(number):
            if part not in self.values:
                self.values[part] = self._value(part)
        return self.values[number]

    def vanishes(self, *numbers: int) -> bool:
        """Whether all these nodes are known to be zero at the point."""
        return all(self.value(number) == 0 for number in numbers)

    def _value(self, part: int) -> Fraction | None:
        operation, arguments, data = self.local.model.builder.nodes[part]
        if part in self.zeros:
            return ZERO
        if operation == "const":
            return data if isinstance(data, Fraction) else None
        if operation == "input":
            return self.inputs[str(data)]
        inner = [self.values[argument] for argument in arguments]
        if operation in CHOOSING and (branch := chosen(self.local, part)) is not None:
            taken = self.values[branch[0]]
            return None if taken is None else taken * branch[1]
        known = [value for value in inner if value is not None]
        if len(known) == len(inner) and all(_length(value) < _BITS for value in known):
            if operation == "powi" and isinstance(data, int):
                return known[0] ** data if _length(known[0]) * data < _BITS else None
            if operation in _RATIONAL:
                return _RATIONAL[operation](*known)
        if operation in {"exp", "cos"} and inner[0] == 0:
            return Fraction(1)
        return ZERO if self._is_zero(part, operation, arguments) else None

    def sign(self, number: int) -> int | None:
        """1, 0 or -1, None if unknown."""
        value = self.values[number]
        if value is not None:
            return (value > 0) - (value < 0)
        return self.local.sign(number) or None

    def _is_zero(self, part: int, operation: str, arguments: tuple[int, ...]) -> bool:
        signs = [self.sign(argument) for argument in arguments]
        if any(all(map(_fits, wanted, signs)) for wanted in OPERATIONS[operation].zeros):
            return is_legal(self.local, part)
        return operation == "log" and self.values[arguments[0]] == 1


def _fits(wanted: str, sign: int | None) -> bool:
    """Whether a sign is 0, + or - as a row of the table writes it, * for any."""
    return wanted == "*" or sign == {"0": 0, "+": 1, "-": -1}[wanted]


def _length(value: Fraction) -> int:
    return max(value.numerator.bit_length(), value.denominator.bit_length())


def vanishes_with(local: Local, given: Sequence[int], wanted: int) -> bool:
    """Whether a node is exactly zero at the point where given nodes have their only common zero in the box.

    A rational point of the box is tried, at which the given nodes must vanish too; then it is that point.
    """
    names = local.model.builder.coordinates
    if len(local.sides) > len(names):
        return False  # letters that range have no exact value
    place = dict(zip(names, map(simplest, local.sides), strict=True))
    if Exact(local, place, frozenset()).vanishes(*given, wanted):
        return True
    return Exact(local, dict.fromkeys(names), frozenset(given)).vanishes(wanted)


def simplest(value: arb) -> Fraction:
    """A simple fraction in a ball; where there is none, its middle."""
    fraction = as_fraction(value).limit_denominator(SIMPLE)
    return fraction if value.contains(exact(fraction)) else as_fraction(value)


def as_fraction(value: arb) -> Fraction:
    """The exact middle of a ball."""
    mantissa, exponent = value.mid().man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def exact_at(
    model: Model, point: Sequence[arb], coordinates: Mapping[str, Fraction | None], zeros: Set[int] = frozenset()
) -> Exact:
    """What is known exactly at a point, with all branches decided on a tiny box around it."""
    with ctx.workprec(PRECISE):
        return Exact(model.on([part + arb(0, AROUND) for part in point]), coordinates, frozenset(zeros))
