"""Shapes of pieces with and without boxes of which it is known by construction where their boundary lies.

Discs and bars, balls and blocks, half-spaces, formulas without a box, long tools and letters that are moved are
combined, and moved. What is inside is said of points by logic alone; points on the boundaries of pieces at which it
changes are points of the boundary, wherever they are.

    python tests/opponent/hunt.py windows --count 2000 --start 1
"""

from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.sampling.windows import bounds_or_extent

STEP = 1e-6  # across the boundary of a piece, relative to how far it is away
FAR = 1e6  # beyond all bounded pieces


@dataclass(frozen=True)
class Made:
    """A shape, what is inside of points, and the points and normals on the boundaries of its pieces."""

    shape: rsym.Shape
    inside: object
    edge: object
    text: str
    seed: int = 0

    def __str__(self):
        return self.text

    @property
    def family(self):
        """What is counted together."""
        return "space" if self.shape.dimension == 3 else "plane"


def rational(random, low, high):
    return sp.Rational(int(random.integers(round(100 * low), round(100 * high) + 1)), 100)


def on_sphere(random, count, dimension):
    found = random.normal(size=(count, dimension))
    return found / np.linalg.norm(found, axis=1)[:, None]


def ball(random, dimension, kind):
    radius, centre = rational(random, 0.3, 2), [rational(random, -3, 3) for _ in range(dimension)]
    r, c = float(radius), np.array(centre, float)
    coordinates = (x, y, z)[:dimension]
    squared = sum((one - place) ** 2 for one, place in zip(coordinates, centre, strict=True))
    if kind == "formula":
        shape = rsym.Shape(radius**2 - squared, coordinates)
    elif kind == "letter":
        a = sp.Symbol(f"a{random.integers(10**9)}", real=True)
        shape = (rsym.disc if dimension == 2 else rsym.sphere)(a, centre, letters={a: rational(random, 0.2, 4)})
        shape = shape.with_letters({a: radius})
    else:
        shape = (rsym.disc if dimension == 2 else rsym.sphere)(radius, centre)

    def edge(random):
        normals = on_sphere(random, 200, dimension)
        return c + r * normals, normals

    return Made(shape, lambda p: ((p - c) ** 2).sum(axis=1) <= r**2, edge, f"{kind} ball({radius}, {centre})")


def block(random, dimension, kind):
    sides = [rational(random, 0.5, 4) for _ in range(dimension)]
    if kind == "long":
        sides[int(random.integers(dimension))] *= 10 ** int(random.integers(2, 5))
    centre = [rational(random, -3, 3) for _ in range(dimension)]
    half, c = np.array(sides, float) / 2, np.array(centre, float)
    shape = (rsym.rectangle if dimension == 2 else rsym.box)(*sides, centre=centre)

    def edge(random):
        points, normals = random.uniform(-half, half, (300, dimension)), np.zeros((300, dimension))
        axis, sign, row = random.integers(dimension, size=300), random.choice([-1, 1], 300), np.arange(300)
        points[row, axis] = sign * half[axis]
        normals[row, axis] = sign
        return c + points, normals

    return Made(shape, lambda p: (abs(p - c) <= half).all(axis=1), edge, f"{kind} block({sides}, {centre})")


def half_space(random, dimension, kind):
    normal = [sp.Integer(int(value)) for value in random.integers(-3, 4, dimension)]
    normal[0] += 4 if not any(normal) else 0
    offset = rational(random, -3, 3)
    n, d = np.array(normal, float), float(offset)
    coordinates = (x, y, z)[:dimension]
    shape = rsym.Shape(sum(a * u for a, u in zip(normal, coordinates, strict=True)) - offset, coordinates)

    def edge(random):
        along = on_sphere(random, 400, dimension) * 10 ** random.uniform(-2, 9, 400)[:, None]
        foot = along - (along @ n - d)[:, None] * n / (n @ n)
        return foot, np.repeat(n[None] / np.linalg.norm(n), 400, axis=0)

    return Made(shape, lambda p: p @ n >= d, edge, f"half space({normal}, {offset})")


PIECES = (
    (ball, "plain", 3),
    (ball, "formula", 2),
    (ball, "letter", 1),
    (block, "plain", 2),
    (block, "long", 2),
    (half_space, "", 3),
)


def moved(random, made):
    dimension = made.shape.dimension
    shift = [rational(random, -4, 4) for _ in range(dimension)]
    turn = np.eye(dimension)
    shape = made.shape
    if random.random() < 0.5:
        angle = random.choice([sp.Rational(1, 2), sp.pi / 3, sp.pi / 2])
        shape = shape.rotate(angle) if dimension == 2 else shape.rotate(angle, z)
        cosine, sine = float(sp.cos(angle)), float(sp.sin(angle))
        turn[:2, :2] = [[cosine, -sine], [sine, cosine]]
    shape, s = shape.translate(*shift), np.array(shift, float)

    def edge(random):
        points, normals = made.edge(random)
        return points @ turn.T + s, normals @ turn.T

    return Made(shape, lambda p: made.inside((p - s) @ turn), edge, f"moved {made.text} by {shift}")


OPERATIONS = {
    "|": (lambda a, b: a | b, np.logical_or),
    "&": (lambda a, b: a & b, np.logical_and),
    "-": (lambda a, b: a - b, lambda f, g: f & ~g),
    "^": (lambda a, b: a ^ b, np.logical_xor),
}


def combined(one, other, sign):
    join, logic = OPERATIONS[sign]

    def edge(random):
        both = [made.edge(random) for made in (one, other)]
        return np.concatenate([points for points, _ in both]), np.concatenate([normals for _, normals in both])

    text = f"({one.text} {sign} {other.text})"
    return Made(join(one.shape, other.shape), lambda p: logic(one.inside(p), other.inside(p)), edge, text)


def case(seed):
    """A shape of two to four pieces."""
    random = np.random.default_rng(seed)
    dimension = int(random.integers(2, 4))
    weights = np.array([weight for *_, weight in PIECES], float)
    made = None
    for _ in range(int(random.integers(2, 5))):
        make, kind, _ = PIECES[random.choice(len(PIECES), p=weights / weights.sum())]
        piece = make(random, dimension, kind)
        if random.random() < 0.3:
            piece = moved(random, piece)
        if random.random() < 0.1:
            whole = piece
            piece = Made(~whole.shape, lambda p, whole=whole: ~whole.inside(p), whole.edge, f"~{whole.text}")
        made = piece if made is None else combined(made, piece, random.choice(list(OPERATIONS)))
    made = moved(random, made) if random.random() < 0.3 else made
    return replace(made, seed=seed)


def boundary_of(made, seed):
    """Points of the boundary, on which side of a piece they are being decided by logic."""
    points, normals = made.edge(np.random.default_rng(seed))
    step = STEP * np.maximum(1.0, np.linalg.norm(points, axis=1))[:, None] * normals
    return points[made.inside(points + step) != made.inside(points - step)]


def asked(case):
    """What was answered, and what is wrong of it: all of the boundary lies in the box, or it goes on."""
    points = boundary_of(case, case.seed)
    distance = np.abs(points).max(axis=1, initial=0.0)
    goes_on = bool((distance > FAR).any())
    try:
        box = np.array(bounds_or_extent(case.shape, None))
    except rsym.RsymError as error:
        wrong = {"unbounded": not goes_on, "empty": len(points) > 0}[error.code]
        return error.code, [error.code] if wrong else []
    slack = 1e-9 * distance.max(initial=0.0)
    outside = (points < box[:, 0] - slack) | (points > box[:, 1] + slack)
    return "box", [f"{points[outside.any(axis=1)][:1]} outside {box.tolist()}"] if outside.any() else []
