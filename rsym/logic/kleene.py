"""Logic with three values: the sign of a formula of sheets, 0 on the boundary.

A conjunction has the smaller sign of its operands, a disjunction the larger, a product their product: Kleene's
strong logic, which is the sign of an R-operation where operands are zero too. Source: Kleene (1952), section 64.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import TypeAlias


@dataclass(frozen=True)
class Literal:
    """The sign of a leaf, times a sign."""

    leaf: int
    sign: int = 1


@dataclass(frozen=True)
class Connective:
    """A "min", "max" or "product" of formulas."""

    operation: str
    operands: tuple[Formula, ...]


Formula: TypeAlias = int | Literal | Connective  # a whole number is a sign that is known

RECURRING = 4096  # formulas of which it is kept what they depend on: neighbouring boxes have the same

_VALUES: dict[str, Callable[[list[int]], int]] = {"min": min, "max": max, "product": math.prod}


def ternary(formula: Formula, signs: Mapping[int, int]) -> int:
    """The sign of a formula, given those of its leaves.

    Examples
    --------
    >>> both = joined("min", Literal(1), Literal(2, -1))
    >>> ternary(both, {1: 1, 2: -1}), ternary(both, {1: 1, 2: 0})
    (1, 0)
    """
    if isinstance(formula, int):
        return formula
    if isinstance(formula, Literal):
        return formula.sign * signs[formula.leaf]
    return _VALUES[formula.operation]([ternary(operand, signs) for operand in formula.operands])


def joined(operation: str, *operands: Formula) -> Formula:
    """The formula of operands, without those whose known signs do not count.

    Examples
    --------
    >>> joined("min", 1, Literal(5)), joined("max", 1, Literal(5)), joined("product", -1, Literal(5))
    (Literal(leaf=5, sign=1), 1, Literal(leaf=5, sign=-1))
    """
    known = [operand for operand in operands if isinstance(operand, int)]
    open_ones = list(dict.fromkeys(operand for operand in operands if not isinstance(operand, int)))
    if operation == "product":
        sign = math.prod(known)
        rest = [operand for operand in operands if not isinstance(operand, int)]
        if not rest:
            return sign
        return signed(rest[0] if len(rest) == 1 else Connective("product", tuple(rest)), sign)
    absorbing = -1 if operation == "min" else 1
    if absorbing in known:
        return absorbing
    if not open_ones:
        return -absorbing
    return open_ones[0] if len(open_ones) == 1 else Connective(operation, tuple(open_ones))


def signed(formula: Formula, sign: int) -> Formula:
    """A formula times a sign; De Morgan moves it to the leaves."""
    if sign > 0:
        return formula
    if isinstance(formula, int):
        return -formula
    if isinstance(formula, Literal):
        return Literal(formula.leaf, -formula.sign)
    if formula.operation == "product":
        return Connective("product", (signed(formula.operands[0], -1), *formula.operands[1:]))
    dual = "max" if formula.operation == "min" else "min"
    return Connective(dual, tuple(signed(operand, -1) for operand in formula.operands))


def leaves_of(formula: Formula) -> tuple[int, ...]:
    """The leaves of a formula, in the order in which they are first met."""
    return tuple(dict.fromkeys(part.leaf for part in _parts(formula) if isinstance(part, Literal)))


def _parts(formula: Formula) -> Iterator[int | Literal]:
    """What a formula joins, each as often as it is met."""
    if isinstance(formula, Connective):
        for operand in formula.operands:
            yield from _parts(operand)
    else:
        yield formula


@lru_cache(RECURRING)
def essential(formula: Formula) -> tuple[int, ...]:
    """The leaves on which the sign of a formula depends anywhere, its zeros included.

    Examples
    --------
    >>> essential(joined("max", Literal(1), joined("min", Literal(1), Literal(2))))
    (1,)
    >>> essential(joined("max", joined("min", Literal(1), Literal(2)), joined("min", Literal(1), Literal(2, -1))))
    (1, 2)
    """
    leaves = leaves_of(formula)
    if len(leaves) == sum(1 for _ in _parts(formula)):
        return leaves  # each is met once, beside no known sign: the others can be such that it decides
    found = []
    for leaf in leaves:
        others = [other for other in leaves if other != leaf]
        for signs in product((-1, 0, 1), repeat=len(others)):
            known = dict(zip(others, signs, strict=True))
            if len({ternary(formula, {**known, leaf: sign}) for sign in (-1, 0, 1)}) > 1:
                found.append(leaf)
                break
    return tuple(found)


@lru_cache(RECURRING)
def as_gate(formula: Formula) -> tuple[str, tuple[int, ...]] | None:
    """The operation and the signs of one or two leaves that a formula joins by a "min" or "max"; None if it does not.

    They agree for leaves that are zero too: -|u| is zero on a sheet without a change of sign, and no leaf.

    Examples
    --------
    >>> as_gate(joined("max", Literal(1), Literal(2, -1))), as_gate(joined("max", Literal(1), Literal(1, -1)))
    (('max', (1, -1)), None)
    """
    leaves = leaves_of(formula)
    if not 1 <= len(leaves) <= 2:
        return None
    every = product((-1, 0, 1), repeat=len(leaves))
    table = {values: ternary(formula, dict(zip(leaves, values, strict=True))) for values in every}
    for operation, signs in product(("min", "max"), product((1, -1), repeat=len(leaves))):
        own = Connective(operation, tuple(Literal(place, sign) for place, sign in enumerate(signs)))
        if all(ternary(own, dict(enumerate(values))) == value for values, value in table.items()):
            return operation, signs
    return None


def replaced(formula: Formula, substitutes: Mapping[int, Formula]) -> Formula:
    """The formula with other formulas in the place of some leaves.

    Examples
    --------
    >>> replaced(joined("min", Literal(1), Literal(2, -1)), {2: Literal(3)})
    Connective(operation='min', operands=(Literal(leaf=1, sign=1), Literal(leaf=3, sign=-1)))
    """
    if isinstance(formula, int):
        return formula
    if isinstance(formula, Literal):
        return signed(substitutes.get(formula.leaf, Literal(formula.leaf)), formula.sign)
    return joined(formula.operation, *(replaced(operand, substitutes) for operand in formula.operands))


FEW = 6  # leaves of which all 3^6 combinations of signs are tried


def without_idle(formula: Formula) -> Formula:
    """The formula without leaves on which it does not depend, if it has few."""
    leaves = leaves_of(formula)
    needed = essential(formula) if len(leaves) <= FEW else leaves
    if needed == leaves:
        return formula
    return replaced(formula, {leaf: 1 for leaf in leaves if leaf not in needed})
