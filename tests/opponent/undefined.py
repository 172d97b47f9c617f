"""An opponent of what is said beside parts without a value: trees of leaves that have one only where something holds.

A leaf p(u) - c, p a root, a logarithm, an arc, a power, is true where u is above a number and in the domain of p, false
below it there, and elsewhere unknown. Kleene's logic carries both sets through a tree; the twin is the set that is
surely true, of plain leaves. What bounds a domain is a wall. As a rule the numbers are letters, of which some settings
are asked one after the other: what is compiled is compiled once.

    python tests/opponent/hunt.py undefined --count 2000 --start 1
"""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

import rsym
from opponent.twins import WALL, Drawn, Twins, asked
from rsym import x, y, z

__all__ = ["asked", "case"]

WHOLE = ("shielded", "gated", "arc")


def plain_leaf(chance, coordinates):
    """A leaf with a value everywhere, of the size of 1."""
    a, b, c = (chance.eighths(-8, 8) + sp.Rational(1, 16) for _ in range(3))
    others = coordinates[2:]
    square = sum((one - place) ** 2 for one, place in zip(coordinates, (a, b, c), strict=False))
    return chance.choice(
        [
            lambda: coordinates[0] - a,
            lambda: b - coordinates[1],
            lambda: coordinates[0] + 2 * coordinates[1] - a,
            lambda: sp.Rational(9, 8) ** 2 - square,
            lambda: square - sp.Rational(5, 8) ** 2,
            lambda: sp.Rational(3, 2) - square + sum(others),
            lambda: coordinates[-1] - a * coordinates[0] - b,
        ]
    )()


def _partial(chance, u):
    """A leaf p(u) - c, and where it is true, false, of u, as plain leaves, and what of these are walls."""
    c = chance.eighths(1, 7)
    k = chance.choice((1, 2, sp.Rational(1, 2)))
    kind = chance.choice(("sqrt", "log", "asin", "acos", "root", "power", "letterless", "piece", "difference", *WHOLE))
    upper = None
    if kind in WHOLE:  # true wherever it has a value
        leaf, *ends = {
            "shielded": (sp.sqrt(u * (1 + u**2)) + c, u),
            "gated": (sp.sqrt(sp.Min(u, 2 - u)) + c, u, 2 - u),
            "arc": (sp.acos(u**2) + c, 1 - u, 1 + u),
        }[kind]
        return leaf, [(end, True) for end in ends], [(-1 - u**2, False)]
    if kind == "asin":
        leaf, level, upper = sp.asin(u / 2) - c, 2 * sp.sin(c), 2
        lower = -2
    elif kind == "acos":  # falls: true below
        leaf, level, upper, lower = c - sp.acos(u / 2), 2 * sp.cos(c), 2, -2
    elif kind == "log":
        leaf, level, lower = k * sp.log(u) - c, sp.exp(c / k), 0
    elif kind == "piece":  # no value where no condition holds
        leaf, level, lower = sp.Piecewise((u - c, u > 0)), c, 0
    elif kind == "difference":
        leaf, level, lower = sp.sqrt(u) - sp.sqrt(2 * u) + c, c**2 / (sp.sqrt(2) - 1) ** 2, 0
        return leaf, [(u, True), (level - u, False)], [(u - level, False), (u, True)]
    else:
        power = {"sqrt": sp.Rational(1, 2), "root": sp.Rational(1, 3), "power": sp.Rational(3, 2)}.get(kind, sp.sqrt(2))
        leaf, level, lower = k * u**power - c, (c / k) ** (1 / power), 0
    true, false = [(u - level, False)], [(level - u, False), (u - lower, True)]
    if upper is not None:
        true.append((upper - u, True))
    return leaf, true, false


def _meet(chance, leaves, coordinates):
    """The set where all of some leaves are positive."""
    made = None
    for leaf, wall in leaves:
        one = chance.shape(leaf, coordinates)
        one = one.named(WALL) if wall else one
        made = one if made is None else made & one
    return made


def _tree(chance, depth, coordinates):
    """An expression, where it is surely true, where surely false, and its text."""
    if depth == 0:
        u = plain_leaf(chance, coordinates)
        if chance.random() < 0.45:
            one = chance.shape(u, coordinates)
            return u, one, ~one
        leaf, true, false = _partial(chance, u)
        sign = chance.choice((1, 1, -1))
        both = _meet(chance, true, coordinates), _meet(chance, false, coordinates)
        return sign * leaf, *(both if sign > 0 else both[::-1])
    (one, yes, no), (other, more, less) = (_tree(chance, depth - 1, coordinates) for _ in range(2))
    system = chance.choice((rsym.R0, rsym.R1))
    if chance.random() < 0.5:
        return rsym.conjunction(one, other, system=system), yes & more, no | less
    return rsym.disjunction(one, other, system=system), yes | more, no & less


@lru_cache(maxsize=2)
def tree(seed, lettered):
    """A tree with its numbers still to be drawn, cut off by a ball, which is whole."""
    chance = Drawn(seed, lettered)
    coordinates = (x, y) if chance.random() < 0.85 else (x, y, z)
    expression, true, _ = _tree(chance, chance.choice((1, 1, 2)), coordinates)
    ball = sp.Rational(25, 16) * 2 - sum(one**2 for one in coordinates)
    shape = chance.shape(rsym.conjunction(expression, ball), coordinates)
    return chance, Twins(shape, true & chance.shape(ball, coordinates), str(expression))


def case(seed):
    """What a seed makes."""
    return Drawn.settled(tree, seed)
