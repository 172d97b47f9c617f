"""An opponent of lines: what is thinner than a cell, at random places, of random size and orientation.

Rings, slots, gaps, ovals, dots, needles and discs that touch, each in a square of its own: what they add to the number,
the length and the area of the lines is known in closed form. They are bodies of their own or holes in a plate.

    cd tests; python -m opponent.thin --count 2000 --seed 1
"""

from __future__ import annotations

import argparse
import math
import random
import warnings

import numpy as np
from scipy.special import ellipe

import rsym

GRID = (3, 2)  # squares of side 2
CHORDS = 2e-2  # of the length and the area, polygons of a coarse lattice instead of curves
SMALL = 0.2  # the same of what is smaller than a cell: a few chords for all of it


class Feature:
    """One thing in the square of side 2 around 0: a shape, and what its lines measure; `lines` None if they touch."""

    def __init__(self, chance):
        kind = chance.choice(["ring", "strip", "gap", "oval", "dot", "needle", "contact"])
        self.name, width = kind, 10 ** chance.uniform(-4, -1)
        self.shape, self.lines, self.length, self.area = getattr(self, f"_{kind}")(chance, width)
        self.small = kind in ("dot", "oval") and width < 0.1
        self.shape = self.shape.rotate(chance.uniform(0, 2 * math.pi))

    def _ring(self, chance, width):
        radius = chance.uniform(0.3, 0.85)
        inner = radius - width
        shape = rsym.disc(radius) - rsym.disc(inner)
        return shape, 2, 2 * math.pi * (radius + inner), math.pi * (radius**2 - inner**2)

    def _strip(self, chance, width):
        side = chance.uniform(0.3, 1.6)
        return rsym.rectangle(side, width), 1, 2 * (side + width), side * width

    def _gap(self, chance, width):
        side, high = chance.uniform(0.3, 1), chance.uniform(0.1, 0.5)
        across = (width + high) / 2
        both = rsym.rectangle(side, high, (0, across)) | rsym.rectangle(side, high, (0, -across))
        return both, 2, 4 * (side + high), 2 * side * high

    def _oval(self, chance, width):
        a, b = chance.uniform(0.1, 0.85), width / 2
        shape = rsym.ellipse(a, b)
        return shape, 1, 4 * a * ellipe(1 - (b / a) ** 2), math.pi * a * b

    def _dot(self, chance, width):
        return rsym.disc(width), 1, 2 * math.pi * width, math.pi * width**2

    def _needle(self, chance, width):
        long = chance.uniform(0.2, 0.8)
        shape = rsym.polygon([(-long, -width / 2), (long, 0), (-long, width / 2)])
        return shape, 1, width + 2 * math.hypot(2 * long, width / 2), long * width

    def _contact(self, chance, width):
        one, other = chance.uniform(0.1, 0.4), chance.uniform(0.1, 0.4)
        shape = rsym.disc(one, (-one, 0)) | rsym.disc(other, (other, 0))
        return shape, None, 2 * math.pi * (one + other), math.pi * (one**2 + other**2)


class Thin:
    """Some features in a plane, moved together, and what the lines around them measure."""

    def __init__(self, seed):
        chance = random.Random(seed)
        places = [(2 * i - 2, 2 * j - 1) for i in range(GRID[0]) for j in range(GRID[1])]
        chance.shuffle(places)
        self.features = [Feature(chance) for _ in range(chance.randint(1, 3))]
        body = None
        for feature, place in zip(self.features, places, strict=False):
            moved = feature.shape.translate(*place)
            body = moved if body is None else body | moved
        self.holes = chance.random() < 0.4
        counts = [feature.lines for feature in self.features]
        self.lines = None if None in counts else sum(counts)
        self.length, self.area = (sum(getattr(one, what) for one in self.features) for what in ("length", "area"))
        if self.holes:
            body = rsym.rectangle(6.4, 4.4) - body
            self.lines = self.lines and self.lines + 1
            self.length, self.area = self.length + 21.6, 6.4 * 4.4 - self.area
        self.turned, self.scale = chance.uniform(0, 2 * math.pi), 10 ** chance.uniform(-2, 2)
        self.moved = [self.scale * chance.uniform(-5, 5) for _ in range(2)]
        self.shape = body.rotate(self.turned).scale(self.scale).translate(*self.moved)
        self.length, self.area = self.scale * self.length, self.scale**2 * self.area
        self.resolution = chance.choice([24, 50, 100, 200])
        self.cut = chance.random() < 0.3

    def asked(self):
        """The lines, and what was warned of."""
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            if self.cut:
                (section,) = rsym.sections(rsym.extrude(self.shape, -1, 1), [0.25], resolution=self.resolution)
                lines = section.lines
            else:
                lines = rsym.level_lines(self.shape, resolution=self.resolution)
        return lines, [str(one.message) for one in said]


def faults(seed):
    """What is wrong without a word, and what is doubted though it is right."""
    case = Thin(seed)
    lines, told = case.asked()
    names = "+".join(feature.name for feature in case.features)
    where = f"{names}{' as holes' if case.holes else ''} at {case.resolution}{' cut' if case.cut else ''}"
    wrong = []
    if case.lines is not None and len(lines) != case.lines:
        wrong.append(f"{where}: {len(lines)} lines for {case.lines}")
    if any(not np.array_equal(line[0], line[-1]) for line in lines):
        wrong.append(f"{where}: lines end")
    else:
        for what in ("length", "area"):
            found, true = getattr(lines, what), getattr(case, what)
            allowed = CHORDS * true + SMALL * sum(
                getattr(one, what) for one in case.features if one.small
            ) * case.scale ** (1 if what == "length" else 2)
            if abs(found - true) > allowed:
                wrong.append(f"{where}: {what} {found:.6g} for {true:.6g}")
    touch = any(feature.name == "contact" for feature in case.features)
    return (wrong if not told else []), (told if not wrong and not touch else []), wrong if told else []


def main():
    """Ask many seeds, and say which are wrong."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    counts = [0, 0, 0]
    for seed in range(asked.seed, asked.seed + asked.count):
        for k, (word, said) in enumerate(zip(("SILENT", "needless", "told"), faults(seed), strict=True)):
            if said:
                counts[k] += 1
                print(seed, word, *said, sep="\n  ", flush=True)
    print(f"of {asked.count}: {counts[0]} wrong without a word, {counts[1]} right and doubted, {counts[2]} told")


if __name__ == "__main__":
    main()
