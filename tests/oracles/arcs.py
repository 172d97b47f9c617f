"""Areas and lengths of trees of discs, ellipses and half-planes, exactly to 40 digits: Green's theorem along arcs.

Each curve is cut at its crossings with all others, roots of polynomials of degree 4 at most. An arc bounds the region
if the tree at its middle is true with the curve's own leaf and false without. Shares no code with rsym.
"""

import itertools
import random
from dataclasses import dataclass

import mpmath as mp
import sympy as sp

import rsym

DIGITS = 40
START = 0.7
x, y = rsym.x, rsym.y


@dataclass(frozen=True)
class Oval:
    """An ellipse: centre, half-axes, direction of the first; sign -1: its outside."""

    centre: tuple
    axes: tuple
    turn: tuple  # a Pythagorean triple
    sign: int

    @property
    def direction(self):
        """Cosine and sine of the turn."""
        p, q, size = self.turn
        return mp.mpf(p) / size, mp.mpf(q) / size

    def value(self, px, py):
        """Positive where the leaf is true."""
        (cx, cy), (a, b), (c, s) = self.centre, self.axes, self.direction
        u, v = c * (px - cx) + s * (py - cy), c * (py - cy) - s * (px - cx)
        return self.sign * (1 - u * u / a**2 - v * v / b**2)

    def point(self, t):
        """The point at an angle."""
        (cx, cy), (a, b), (c, s) = self.centre, self.axes, self.direction
        u, v = a * mp.cos(t), b * mp.sin(t)
        return cx + c * u - s * v, cy + s * u + c * v

    def crossings(self, other):
        """The angles at which it meets another curve."""
        (cx, cy), (a, b), (c, s) = self.centre, self.axes, self.direction

        def along(w):  # times (1 + w**2)**2, w the tangent of half the angle from a start where nothing happens
            d = 1 + w * w
            cosine, sine = (1 - w * w) / d, 2 * w / d
            u, v = (
                a * (cosine * mp.cos(START) - sine * mp.sin(START)),
                b * (cosine * mp.sin(START) + sine * mp.cos(START)),
            )
            return other.value(cx + c * u - s * v, cy + s * u + c * v) * d**2

        return [START + 2 * mp.atan(root) for root in real_roots(along, 4)]

    def arcs(self, angles):
        """Arcs between angles, all the way round."""
        turns = sorted(angles) or [mp.mpf(0)]
        return list(zip(turns, [*turns[1:], turns[0] + 2 * mp.pi], strict=True))

    def green(self, start, end):
        """Half the integral of x dy - y dx, the true side to the left."""
        (x0, y0), (x1, y1) = self.point(start), self.point(end)
        (cx, cy), (a, b) = self.centre, self.axes
        return self.sign * (a * b * (end - start) + cx * (y1 - y0) - cy * (x1 - x0)) / 2

    def length(self, start, end):
        """Of an arc."""
        a, b = self.axes
        if a == b:
            return a * (end - start)
        parts = mp.linspace(start, end, 9)
        return mp.quad(lambda t: mp.sqrt((a * mp.sin(t)) ** 2 + (b * mp.cos(t)) ** 2), parts)


@dataclass(frozen=True)
class Side:
    """A half-plane: a point of its edge and the inner normal."""

    at: tuple
    normal: tuple

    def value(self, px, py):
        """Positive where the leaf is true."""
        return self.normal[0] * (px - self.at[0]) + self.normal[1] * (py - self.at[1])

    def point(self, t):
        """The point at a place, the true side to the left of the way."""
        return self.at[0] + t * self.normal[1], self.at[1] - t * self.normal[0]

    def crossings(self, other):
        """The places at which it meets another curve."""
        degree = 1 if isinstance(other, Side) else 2
        return real_roots(lambda t: other.value(*self.point(t)), degree)

    def arcs(self, places):
        """Arcs between places; what lies beyond is outside."""
        return list(itertools.pairwise(sorted(places)))

    def green(self, start, end):
        """Half the integral of x dy - y dx."""
        (x0, y0), (x1, y1) = self.point(start), self.point(end)
        return (x0 * y1 - x1 * y0) / 2

    def length(self, start, end):
        """Of a piece."""
        return (end - start) * mp.hypot(*self.normal)


def real_roots(function, degree):
    """The real roots of a polynomial that is known as a function."""
    places = [mp.mpf(k) - degree / mp.mpf(2) for k in range(degree + 1)]
    matrix = mp.matrix([[place**k for k in range(degree, -1, -1)] for place in places])
    coefficients = list(mp.lu_solve(matrix, mp.matrix([function(place) for place in places])))
    while coefficients and abs(coefficients[0]) < mp.mpf(10) ** (8 - DIGITS):
        coefficients.pop(0)
    if len(coefficients) < 2:
        return []
    roots = mp.polyroots(coefficients, maxsteps=500, extraprec=400)
    return [mp.re(root) for root in roots if abs(mp.im(root)) < mp.mpf(10) ** (-DIGITS // 2)]


def holds(tree, truths):
    """Whether a tree is true: a number of a leaf, or (operation, tree, tree)."""
    if isinstance(tree, int):
        return truths[tree]
    operation, first, second = tree
    one, other = holds(first, truths), holds(second, truths)
    return {"and": one and other, "or": one or other, "minus": one and not other}[operation]


def exact(leaves, tree):
    """Area, and the length on each leaf."""
    with mp.workdps(DIGITS):
        area, lengths = mp.mpf(0), [mp.mpf(0)] * len(leaves)
        for number, leaf in enumerate(leaves):
            cuts = [t for other in leaves if other is not leaf for t in leaf.crossings(other)]
            for start, end in leaf.arcs(cuts):
                middle = leaf.point((start + end) / 2)
                truths = [other.value(*middle) > 0 for other in leaves]
                with_it, without = (
                    holds(tree, [truth if k != number else own for k, truth in enumerate(truths)])
                    for own in (True, False)
                )
                if with_it != without:
                    area += leaf.green(start, end) * (1 if with_it else -1)
                    lengths[number] += leaf.length(start, end)
        return area, lengths


def random_tree(seed, count=6):
    """Leaves, the last a disc that bounds all, and a tree."""
    chance = random.Random(seed)

    def fraction(low, high):
        return mp.mpf(round(chance.uniform(low, high) * 256)) / 256

    leaves = []
    for _ in range(count):
        kind, at = chance.choice(("disc", "oval", "side")), (fraction(-1, 1), fraction(-1, 1))
        turn = chance.choice(((3, 4, 5), (5, 12, 13), (8, 15, 17), (-3, 4, 5), (12, -5, 13), (1, 0, 1)))
        if kind == "side":
            leaves.append(Side(at, turn[:2]))
        else:
            first = fraction(0.3, 1.2)
            axes = (first, first if kind == "disc" else fraction(0.2, 1))
            leaves.append(Oval(at, axes, turn, chance.choice((1, 1, -1))))
    trees = list(range(count))
    while len(trees) > 1:
        one, other = trees.pop(chance.randrange(len(trees))), trees.pop(chance.randrange(len(trees)))
        trees.append((chance.choice(("and", "or", "minus")), one, other))
    leaves.append(Oval((mp.mpf(0), mp.mpf(0)), (mp.mpf(2), mp.mpf(2)), (1, 0, 1), 1))
    return leaves, ("and", trees[0], count)


def shape_of(leaves, tree, system=None):
    """The same as a shape; leaf k is called after its number."""
    parts = [rsym.Shape(formula(leaf), (x, y)).named(f"leaf {number}") for number, leaf in enumerate(leaves)]

    def joined(branch):
        if isinstance(branch, int):
            return parts[branch]
        operation, first, second = branch
        one, other = joined(first), joined(second)
        if operation == "minus":
            one, other, operation = one, ~other, "and"
        join = rsym.conjunction if operation == "and" else rsym.disjunction
        return join(one, other) if system is None else join(one, other, system=system)

    return joined(tree)


def formula(leaf):
    """The equation of a leaf: its numbers are short binary fractions."""
    if isinstance(leaf, Side):
        (px, py), (nx, ny) = map(rational, leaf.at), leaf.normal
        return nx * (x - px) + ny * (y - py)
    (cx, cy), (a, b), (p, q, size) = map(rational, leaf.centre), map(rational, leaf.axes), leaf.turn
    u, v = p * (x - cx) + q * (y - cy), p * (y - cy) - q * (x - cx)
    return leaf.sign * (1 - u**2 / (a * size) ** 2 - v**2 / (b * size) ** 2)


def rational(value):
    """A binary fraction as it is."""
    return sp.Rational(*float(value).as_integer_ratio())
