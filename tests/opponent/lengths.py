"""Offsets and shells of pieces whose distance is known in closed form: `python -m opponent.lengths --count N`.

Discs, rectangles, regular polygons, balls, boxes, cylinders and plates with a hole, alone or two far apart, in letters
or numbers, moved and turned, are shrunk, made shells, or grown. Edges stay sharp, so the truth is the least distance
from the faces plus what was asked for; where what has edges grows the true distance has to be told. The boundary is
found on random segments.
"""

import argparse
import warnings

import numpy as np
import sympy as sp

import rsym

FAR = 40
SEGMENTS, HALVINGS = 2000, 60


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


def complaint(seed):
    """What is silent and wrong about a case, or told without a reason; nothing if all is well."""
    random = np.random.default_rng(seed)
    dimension = 2 if random.random() < 0.7 else 3
    pieces = [piece(random, dimension) for _ in range(1 + (random.random() < 0.3))]
    steps = [(number * FAR,) + (0,) * (dimension - 1) for number in range(len(pieces))]
    shape = pieces[0][0]
    for (other, *_), step in zip(pieces[1:], steps[1:], strict=True):
        shape = shape | other.translate(*step)
    shape, back = moved(random, shape)
    sharp = any(edged for *_, edged, _ in pieces)
    way = ("shrunk", "shell", "grown")[random.integers(3)]
    share = random.uniform(0.1, 0.6) / (4 if way == "grown" else 1)
    distance = sp.Rational(max(1, round(100 * share * min(depth for _, _, depth, *_ in pieces))), 100)
    d = float(distance)
    text = f"{seed}: {' and '.join(one[-1] for one in pieces)} {way} by {distance}"
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", rsym.RsymWarning)
        grown = distance if way == "grown" else -distance
        made = rsym.shell(shape, distance) if way == "shell" else rsym.offset(shape, grown)
    told = any("instead of" in str(one.message) for one in caught)
    if told != (way == "grown" and sharp):
        return f"{text}: {'told without a reason' if told else 'sharp corners are farther away, and nothing says so'}"

    def truth(points):
        at = back(points)
        own = np.max([one[1](at - np.array(step)) for one, step in zip(pieces, steps, strict=True)], axis=0)
        return np.minimum(own, d - own) if way == "shell" else own + float(grown)

    middles = np.array(steps, float)[random.integers(len(steps), size=2 * SEGMENTS)]
    ends = middles + random.uniform(-7, 7, (2 * SEGMENTS, dimension))
    origin = back(np.zeros((1, dimension)))
    frame = back(np.eye(dimension)) - origin  # rows: the images of the axes
    low, high = np.split((ends - origin) @ np.linalg.inv(frame), 2)
    function = rsym.compile(made)

    def value(points):
        return function(*points.T)["value"]

    start = value(low) >= 0
    crossed = start != (value(high) >= 0)
    low, high, start = low[crossed], high[crossed], start[crossed]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        same = (value(middle) >= 0) == start
        low[same], high[~same] = middle[same], middle[~same]
    if len(low) < 20:
        return f"{text}: hardly any boundary is found"
    off = np.abs(truth(low)).max()
    return f"{text}: the boundary is off by {off}" if off > 1e-9 * FAR else ""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    found = [said for seed in range(asked.seed, asked.seed + asked.count) if (said := complaint(seed))]
    print(*found, f"{len(found)} of {asked.count} are wrong", sep="\n")


if __name__ == "__main__":
    main()
