"""Offsets and shells of pieces whose distance is known in closed form: `python tests/opponent/hunt.py lengths`.

Discs, rectangles, regular polygons, balls, boxes, cylinders and plates with a hole, alone or two far apart, in letters
or numbers, moved and turned, are shrunk, made shells, or grown. Edges stay sharp, so the truth is the least distance
from the faces plus what was asked for; where what has edges grows the true distance has to be told. The boundary is
found on random segments.
"""

import warnings

import numpy as np
import sympy as sp

import rsym

FAR = 40
SEGMENTS, HALVINGS = {2: 1000, 3: 5000}, 60


def rational(random, low, high):
    return sp.Rational(int(random.integers(round(20 * low), round(20 * high) + 1)), 20)


def piece(random, dimension):
    """A shape, the least distance from its faces at points, its depth, whether it has edges, and a text."""
    letters = {}

    def length(low, high):
        value = rational(random, low, high)
        if random.random() < 0.3:
            name = sp.Symbol(f"a{random.integers(10**9)}", real=True)
            letters[name] = value
            return name, float(value)
        return value, float(value)

    kind = (("disc", "rectangle", "polygon", "holed"), ("ball", "box", "cylinder", "bored"))[dimension - 2][
        random.integers(4)
    ]
    (a, p), (b, q), (c, s) = length(4, 8), length(4, 8), length(4, 8)
    n, (r, h) = int(random.integers(3, 9)), length(0.5, 1)
    used = {"disc": (a,), "ball": (a,), "rectangle": (a, b), "polygon": (a,), "holed": (a, b, r), "box": (a, b, c)}
    used = {**used, "cylinder": (a, c), "bored": (a, b, c, r)}[kind]
    known = {name: value for name, value in letters.items() if name in used}

    def round_(points, radius):
        return radius - np.hypot(points[:, 0], points[:, 1])

    def flat(points, *sides):
        return np.min([side / 2 - np.abs(points[:, k]) for k, side in enumerate(sides)], axis=0)

    def polygon(points):
        angles = (2 * np.arange(n) + 1) * np.pi / n
        return p * np.cos(np.pi / n) - (points @ np.array([np.cos(angles), np.sin(angles)])).max(axis=1)

    shape, distance, depth = {
        "disc": lambda: (rsym.disc(a, letters=known), lambda at: round_(at, p), p),
        "ball": lambda: (rsym.sphere(a, letters=known), lambda at: p - np.linalg.norm(at, axis=1), p),
        "rectangle": lambda: (rsym.rectangle(a, b, letters=known), lambda at: flat(at, p, q), min(p, q) / 2),
        "polygon": lambda: (rsym.regular_polygon(n, a, letters=known), polygon, p * np.cos(np.pi / n)),
        "holed": lambda: (
            rsym.rectangle(a, b, letters=known) - rsym.disc(r, letters=known),
            lambda at: np.minimum(flat(at, p, q), -round_(at, h)),
            (min(p, q) / 2 - h) / 2,
        ),
        "box": lambda: (rsym.box(a, b, c, letters=known), lambda at: flat(at, p, q, s), min(p, q, s) / 2),
        "cylinder": lambda: (
            rsym.cylinder(a, c, letters=known),
            lambda at: np.minimum(round_(at, p), s / 2 - np.abs(at[:, 2])),
            min(p, s / 2),
        ),
        "bored": lambda: (
            rsym.box(a, b, c, letters=known) - rsym.cylinder(r, 40, letters=known),
            lambda at: np.minimum(flat(at, p, q, s), -round_(at, h)),
            min((min(p, q) / 2 - h) / 2, s / 2),
        ),
    }[kind]()
    text = f"{kind} {[str(known.get(one, one)) for one in used]}{' in letters' * bool(known)}"
    return shape, distance, depth, kind not in ("disc", "ball"), text


def moved(random, shape):
    """The shape elsewhere, and what carries points back."""
    if random.random() < 0.3:
        return shape, lambda at: at
    angle, way = sp.Rational(int(random.integers(1, 60)), 20), [rational(random, -3, 3) for _ in range(shape.dimension)]
    cosine, sine = np.cos(float(angle)), np.sin(float(angle))
    turn = np.array([[cosine, -sine], [sine, cosine]])
    if shape.dimension == 2:
        shape = shape.rotate(angle)
    else:
        axis = int(random.integers(3))
        shape = shape.rotate(angle, axis=axis)
        whole, others = np.eye(3), [(axis + 1) % 3, (axis + 2) % 3]
        whole[np.ix_(others, others)] = turn
        turn = whole
    return shape.translate(*way), lambda at: (at - np.array(way, float)) @ turn


class Case:
    """A shape that is to be made smaller, hollow or larger, and its true distance."""

    def __init__(self, seed):
        self.random = random = np.random.default_rng(seed)
        self.dimension = 2 if random.random() < 0.7 else 3
        pieces = [piece(random, self.dimension) for _ in range(1 + (random.random() < 0.3))]
        self.steps = np.array([(number * FAR,) + (0,) * (self.dimension - 1) for number in range(len(pieces))], float)
        shape = pieces[0][0]
        for (other, *_), step in zip(pieces[1:], self.steps[1:], strict=True):
            shape = shape | other.translate(*map(int, step))
        self.shape, self.back = moved(random, shape)
        self.sharp = any(edged for *_, edged, _ in pieces)
        self.own = [one[1] for one in pieces]
        self.family = self.way = ("shrunk", "shell", "grown")[random.integers(3)]
        share = random.uniform(0.1, 0.6) / (4 if self.way == "grown" else 1)
        self.by = sp.Rational(max(1, round(100 * share * min(depth for _, _, depth, *_ in pieces))), 100)
        self.text = f"{' and '.join(one[-1] for one in pieces)} {self.way} by {self.by}"

    def __str__(self):
        return self.text

    def made(self):
        """What was asked for, as rsym has it."""
        if self.way == "shell":
            return rsym.shell(self.shape, self.by)
        return rsym.offset(self.shape, self.by if self.way == "grown" else -self.by)

    def truth(self, points):
        """The distance from the new boundary at points, of one sign inside."""
        at, by = self.back(points), float(self.by)
        own = np.max([one(at - step) for one, step in zip(self.own, self.steps, strict=True)], axis=0)
        return np.minimum(own, by - own) if self.way == "shell" else own + (by if self.way == "grown" else -by)

    def boundary(self, function):
        """Points of a boundary on random segments."""
        count = 2 * SEGMENTS[self.dimension]
        middles = self.steps[self.random.integers(len(self.steps), size=count)]
        ends = middles + self.random.uniform(-7, 7, (count, self.dimension))
        origin = self.back(np.zeros((1, self.dimension)))
        frame = self.back(np.eye(self.dimension)) - origin  # rows: the images of the axes
        low, high = np.split((ends - origin) @ np.linalg.inv(frame), 2)

        def inside(points):
            return function(*points.T)["value"] >= 0

        start = inside(low)
        crossed = start != inside(high)
        low, high, start = low[crossed], high[crossed], start[crossed]
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            same = inside(middle) == start
            low[same], high[~same] = middle[same], middle[~same]
        return low


case = Case


def asked(case):
    """A word, and what is silent and wrong, or told without a reason."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", rsym.RsymWarning)
        made = case.made()
    told = any("instead of" in str(one.message) for one in caught)
    word = "told" if told else "kept"
    if told != (case.way == "grown" and case.sharp):
        return word, ["told without a reason" if told else "sharp corners are farther away, and nothing says so"]
    points = case.boundary(rsym.compile(made))
    if len(points) < 20:
        return word, ["hardly any boundary is found"]
    off = np.abs(case.truth(points)).max()
    return word, [f"the boundary is off by {off}"] if off > 1e-9 * FAR else []
