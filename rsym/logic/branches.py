"""Leaves as gates of leaves without kinks, nodes and poles: the branches of choices, and the factors of products.

For its sign a product is max(min(a, b), min(-a, -b)), and so is a quotient: beyond a pole the body ends, too. A leaf
with a choice c = max(a, b) somewhere inside is where a > b the leaf with a for c, elsewhere that with b, so in sign

    max(min(a - b, f), min(b - a, g), min(f, g)),

the last so that it is positive on a = b where both are; so is one with a choice by a condition at which it does not
jump. The outermost choice is opened first, and what it decides is remembered: where max(u, v) < 0 so are u and v. The
distance of a box, sqrt(max(u, 0)**2 + max(v, 0)**2) + min(max(u, v), 0) with u = |x| - a and v = |y| - b, comes out as
four straight leaves.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial, reduce
from types import MappingProxyType

from rsym.logic.choices import sides
from rsym.logic.domains import replaced
from rsym.logic.gates import gate_of
from rsym.logic.lifting import CHOICES, TURNED, choices_in, lifted
from rsym.logic.radicals import Parted, odd_powers, root_parted
from rsym.logic.sign_form import stripped
from rsym.logic.steps import chosen_gate
from rsym.logic.stripping import constant_sign, even_root, sign_gate, unscaled
from rsym.program.builder import Builder
from rsym.program.program import live

MOST_CHOICES = 6  # that sums let through; each may double the leaves
MOST_LEAVES = 12  # that one is opened to; each choice may double them
Known = Mapping[int, int]  # signs of nodes, by what is left of these without factors


class _TooMany(Exception):
    """A leaf has more branches than can be told apart."""


def opened_leaf(builder: Builder, leaf: int) -> int:
    """A node of the sign of a leaf, but where it is zero without a change of sign, as gates of simpler leaves.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> made = opened_leaf(b, b.mul(x, y))
    >>> [b.nodes[number].operation for number in (made, *b.nodes[made].arguments)]
    ['max', 'min', 'min']
    >>> opened_leaf(b, b.sub(x, y)) == b.sub(x, y)
    True
    """
    # Under roots absolute values stand for what has no value beyond the walls.
    walls = {wall for wall, ends in builder.walls.items() if leaf in ends}
    opening = _Opening(builder, walls)
    try:
        made = opening.opened(leaf, 1, MappingProxyType({}))
    except _TooMany:
        return lifted_whole(builder, leaf)
    return leaf if builder.value(made) is not None else made


def lifted_whole(builder: Builder, leaf: int) -> int:
    """A leaf with all its choices on top that sums let through: a sum lifts those of one of its terms at a time."""
    for _ in range(MOST_CHOICES):
        number = lifted(builder, leaf, few=0)
        if number == leaf:
            break
        leaf = number
    return leaf


class _Opening:
    """One leaf being opened, and how many leaves came out."""

    def __init__(self, builder: Builder, walls: Collection[int]) -> None:
        self.builder, self.walls, self.count = builder, walls, 0

    def opened(self, number: int, sign: int, known: Known) -> int:
        """A node times 1 or -1 as gates, where some signs are known."""
        b = self.builder
        number, sign = stripped(b, number, sign)
        if certain := self._sign(number, known):
            return b.const(sign * certain)
        if (plain := odd_powers(b, number)) is not None:
            return self.opened(plain.number, sign * plain.sign, known)
        operation, arguments, _ = b.nodes[number]
        if kind := gate_of(operation, sign):
            return sign_gate(self.builder, kind, *(self.opened(argument, sign, known) for argument in arguments[:2]))
        if operation in {"mul", "div"} and not any(b.uniform[argument] for argument in arguments):
            return self._product(arguments, sign, known)
        decided = self._decided(number, known)
        if decided != number:
            return self.opened(decided, sign, known)
        choices = self._choices(number)
        if choices and self._lifts(top := lifted_whole(b, number)):
            return self.opened(top, sign, known)
        if (parted := root_parted(b, number, self.walls)) is not None:
            return self._without_root(parted, sign, known)
        if not choices:
            self.count += 1
            if self.count > MOST_LEAVES:
                raise _TooMany
            return number if sign > 0 else b.neg(number)
        return self._branches(number, choices[0], sign, known)

    def _sign(self, number: int, known: Known) -> int:
        """The sign that a node has almost everywhere, 0 where that is open."""
        b = self.builder
        value = b.value(number)
        if value is not None:
            return 1 if value > 0 else -1  # what is zero is not inside
        if b.nonnegative[number] and not b.uniform[number]:
            return 1
        inner, sign = unscaled(b, number)
        return known.get(inner, 0) * sign

    def _product(self, arguments: tuple[int, ...], sign: int, known: Known) -> int:
        for one, other in (arguments, arguments[::-1]):
            if self.builder.nonnegative[one] or even_root(self.builder, one) is not None:
                return self.opened(other, sign, known)
        return sign_gate(
            self.builder,
            "max",
            *(
                sign_gate(self.builder, "min", self.opened(one, side, known), self.opened(other, sign * side, known))
                for side in (1, -1)
            ),
        )

    def _without_root(self, parted: Parted, sign: int, known: Known) -> int:
        plain, factor, square = (
            partial(self.opened, part, known=known) for part in (parted.plain, parted.factor, parted.square)
        )
        rises = constant_sign(self.builder, parted.factor) * sign
        if rises:
            return sign_gate(self.builder, "max" if rises > 0 else "min", plain(sign), square(-rises))
        pairs = [(plain(sign), factor(sign)), (plain(sign), square(1)), (factor(sign), square(-1))]
        every = (sign_gate(self.builder, "min", *pair) for pair in pairs)
        return reduce(partial(sign_gate, self.builder, "max"), every)

    def _decided(self, number: int, known: Known) -> int:
        """The node without the choices whose sides are known."""
        while True:
            for choice in self._choices(number):
                condition, above, below = sides(self.builder, choice)
                if side := self._sign(condition, known):
                    number = replaced(self.builder, number, {choice: above if side > 0 else below})
                    break
            else:
                return number

    def _choices(self, number: int) -> list[int]:
        """The choices inside a node, first that which is made of most others: its side tells most of theirs.

        At those by a condition the leaf does not jump: else the form was parted before.
        """
        b = self.builder
        inside = [
            part
            for part in live(b.nodes, [number])
            if (b.nodes[part].operation in CHOICES or (b.nodes[part].operation == "select" and part in b.steps))
            and not b.uniform[part]
            and b.nodes[part].arguments[0] not in self.walls
        ]
        return sorted(inside, key=partial(choices_in, b), reverse=True)

    def _lifts(self, number: int) -> bool:
        """Whether a node is made of gates on top, and of nothing with choices below these."""
        tops = [number]
        while tops:
            part = tops.pop()
            operation, arguments, _ = self.builder.nodes[part]
            if operation in TURNED:
                tops += arguments
            elif part == number or self._choices(part):
                return False
        return True

    def _branches(self, number: int, choice: int, sign: int, known: Known) -> int:
        condition, *values = sides(self.builder, choice)
        made = []
        for side, value in zip((1, -1), values, strict=True):
            believed = MappingProxyType({**known, **self._implied(condition, side)})
            made.append(self.opened(replaced(self.builder, number, {choice: value}), sign, believed))
        conditions = [self.opened(condition, side, known) for side in (1, -1)]
        return chosen_gate(self.builder, conditions, made)

    def _implied(self, condition: int, sign: int) -> dict[int, int]:
        """What has a sign where a node has one: of a maximum below 0 both operands."""
        b = self.builder
        found: dict[int, int] = {}
        stack = [(condition, sign)]
        while stack:
            number, side = stack.pop()
            number, side = stripped(b, number, side)
            inner, sign_of = unscaled(b, number)
            found[inner] = side * sign_of
            top = number if b.nodes[number].operation in TURNED else lifted_whole(b, number)
            operation, arguments, _ = b.nodes[top]
            if operation in TURNED and (operation == "min") == (side > 0):
                stack += [(argument, side) for argument in arguments]
        return found
