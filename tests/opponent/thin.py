"""An opponent of lines: what is thinner than a cell, at random places, of random size and orientation.

Rings, slots, gaps, ovals, dots, needles and discs that touch, each in a square of its own: the number, the
length and the area of the lines around each are known in closed form. They are bodies of their own or holes in a plate.
What is wrong of one is told if a warning names a place in its square.

    python tests/opponent/hunt.py thin --count 2000 --start 1
"""

from __future__ import annotations

import math
import random
import warnings

import numpy as np
from scipy.special import ellipe

import rsym

GRID = (3, 2)  # squares of side 2
PLATE = (6.4, 4.4)
WITHIN = 1.05  # from the middle of its square all of a feature lies
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
    """Some features in a plane, moved together, and what the lines around each of them measure."""

    def __init__(self, seed):
        chance = random.Random(seed)
        places = [(2 * i - 2, 2 * j - 1) for i in range(GRID[0]) for j in range(GRID[1])]
        chance.shuffle(places)
        self.features = [Feature(chance) for _ in range(chance.choice((1, 1, 2, 2, 3)))]
        self.places = places[: len(self.features)]
        body = None
        for feature, place in zip(self.features, self.places, strict=True):
            moved = feature.shape.translate(*place)
            body = moved if body is None else body | moved
        self.holes = chance.random() < 0.4
        if self.holes:
            body = rsym.rectangle(*PLATE) - body
        turned, self.scale = chance.uniform(0, 2 * math.pi), 10 ** chance.uniform(-2, 2)
        self.moved = np.array([self.scale * chance.uniform(-5, 5) for _ in range(2)])
        self.frame = self.scale * np.array([[math.cos(turned), math.sin(turned)], [-math.sin(turned), math.cos(turned)]])
        self.shape = body.rotate(turned).scale(self.scale).translate(*self.moved)
        self.resolution = chance.choice([16, 24, 24, 50, 100])
        self.cut = chance.random() < 0.15
        self.family = f"{'cut' if self.cut else 'lines'} at {self.resolution}"

    def __str__(self):
        names = "+".join(feature.name for feature in self.features)
        return f"{names}{' as holes' if self.holes else ''} at {self.resolution}{' cut' if self.cut else ''}"

    def lines(self):
        """The lines, where something is told to be unresolved, as it stood before it was moved, and what was said."""
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            if self.cut:
                (section,) = rsym.sections(rsym.extrude(self.shape, -1, 1), [0.25], resolution=self.resolution)
                lines = section.lines
            else:
                lines = rsym.level_lines(self.shape, resolution=self.resolution)
        told = [self.back(np.array([lines.status.place]))[0]] if said and lines.status.place else []
        return [self.back(line) for line in lines], told, [str(one.message) for one in said]

    def back(self, points):
        """Points where the features are made."""
        return (points - self.moved) @ np.linalg.inv(self.frame)

    def wrong(self, lines):
        """What is wrong of lines, by the place of the feature, None for the plate."""
        own = {place: [] for place in [*self.places, None]}
        for line in lines:
            away = [np.abs(line - place).max() for place in self.places]
            within = min(away) <= WITHIN
            own[self.places[int(np.argmin(away))] if within else None].append(line)
        if self.holes:
            plate = 1, 2 * sum(PLATE), math.prod(PLATE)
            yield from ((None, f"plate: {fault}") for fault in unlike(own[None], plate, 1, CHORDS, CHORDS))
        else:
            yield from ((tuple(line[0]), f"a line too many at {line[0]}") for line in own[None])
        for feature, place in zip(self.features, self.places, strict=True):
            truth, off = (feature.lines, feature.length, feature.area), SMALL if feature.small else CHORDS
            for fault in unlike(own[place], truth, -1 if self.holes else 1, off, off):
                yield place, f"{feature.name}: {fault}"


def unlike(lines, truth, sign, *off):
    """How lines are unlike what is true, area times the sign."""
    count, *sizes = truth
    if count is not None and len(lines) != count:
        yield f"{len(lines)} lines for {count}"
    if any(not np.array_equal(line[0], line[-1]) for line in lines):
        yield "lines end"
        return
    steps = [np.diff(line, axis=0) for line in lines]
    length = sum(np.hypot(*step.T).sum() for step in steps)
    area = sign * sum(
        (line[:-1, 0] * step[:, 1] - line[:-1, 1] * step[:, 0]).sum() / 2 for line, step in zip(lines, steps, strict=True)
    )
    for what, found, true, part in zip(("length", "area"), (length, area), sizes, off, strict=True):
        if abs(found - true) > part * true:
            yield f"{what} {found:.6g} for {true:.6g}"


case = Thin


def asked(case):
    """Whether all is right, or right and doubted, or told; and what is wrong and not told there."""
    lines, places, said = case.lines()
    wrong = [*case.wrong(lines)]
    silent = [
        fault
        for place, fault in wrong
        if place is None or not any(np.abs(told - place).max() <= WITHIN for told in places)
    ]
    touch = any(feature.name == "contact" for feature in case.features)
    word = "told" if wrong else "right" if not said else "a contact" if touch else "doubted"
    return word, silent + (said if silent else [])
