"""An opponent of steps: bodies of plain leaves, each of them written with a jump that changes nothing of its sign.

sign, Heaviside, Piecewise, floor and sums with them say the same of what is inside as the leaf itself, which the twin
has; a few jump where their sign does not change.

    python tests/opponent/hunt.py steps --count 2000 --start 1
"""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

import rsym
from opponent.twins import Drawn, Twins, asked
from opponent.undefined import plain_leaf
from rsym import x, y, z

__all__ = ["asked", "case"]

LARGEST = 64  # no leaf is larger in the window
HALF = sp.Rational(1, 2)


def stepped(chance, u, coordinates):
    """The leaf u with a jump, of its sign."""
    k = sp.Rational(chance.randint(8, 24), 8)
    place = coordinates[0] - chance.eighths(-8, 8) - sp.Rational(1, 32)
    even = 1 + coordinates[1] ** 2
    return chance.choice(
        [
            lambda: sp.sign(u),
            lambda: sp.Heaviside(u) - HALF,
            lambda: 2 * sp.Heaviside(u) - 1,
            lambda: sp.Piecewise((1, u > 0), (-1, True)),
            lambda: sp.Piecewise((-2, u <= 0), (3, True)),
            lambda: u + k * sp.sign(u),
            lambda: sp.sign(u) * even,
            lambda: sp.Piecewise((u, u > 0), (-even, True)),
            lambda: sp.Piecewise((even, u > 0), (u, True)),
            lambda: sp.Piecewise((u, place > 0), (u * even, True)),
            lambda: sp.Piecewise((k * u, place > 0), (u, True)),
            lambda: u * (2 + sp.sign(place)),
            lambda: sp.Piecewise((k + even, sp.And(u > 0, place > 0)), (-1, u <= 0), (k, True)),
            lambda: sp.Piecewise((sp.Piecewise((u, u > k / 8), (k, True)), u > 0), (-k, True)),
            lambda: sp.floor(u / LARGEST) + HALF,
            lambda: sp.Piecewise((sp.sign(u), place > 0), (sp.Heaviside(u) - HALF, True)),
            lambda: sp.atan(u) + k * sp.sign(u) ** 3,
            lambda: u,
        ]
    )()


def _tree(chance, depth, coordinates):
    if depth == 0:
        u = plain_leaf(chance, coordinates)
        return stepped(chance, u, coordinates), chance.shape(u, coordinates)
    (one, plain), (other, more) = (_tree(chance, depth - 1, coordinates) for _ in range(2))
    system = chance.choice((rsym.R0, rsym.R1))
    if chance.random() < 0.5:
        return rsym.conjunction(one, other, system=system), plain & more
    return rsym.disjunction(one, other, system=system), plain | more


@lru_cache(maxsize=2)
def tree(seed, lettered):
    """A tree with its numbers still to be drawn, cut off by a ball, which may have a jump too."""
    chance = Drawn(seed, lettered)
    coordinates = (x, y) if chance.random() < 0.85 else (x, y, z)
    expression, plain = _tree(chance, chance.choice((0, 1, 1, 2)), coordinates)
    ball = sp.Rational(25, 16) * 2 - sum(one**2 for one in coordinates)
    cut = stepped(chance, ball, coordinates) if chance.random() < 0.3 else ball
    shape = chance.shape(rsym.conjunction(expression, cut), coordinates)
    return chance, Twins(shape, plain & chance.shape(ball, coordinates), str(shape.expression))


def case(seed):
    """What a seed makes."""
    return Drawn.settled(tree, seed)
