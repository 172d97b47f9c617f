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
from typing import NamedTuple

import numpy as np
from scipy.special import ellipe, ellipeinc

import rsym

GRID = (3, 2)  # squares of side 2
PLATE = (6.4, 4.4)
WITHIN = 1.05  # from the middle of its square all of a feature lies
ON, OFF = 1e-6, 1e-3  # of an ellipse; of the length and the area


class Ellipse(NamedTuple):
    """An ellipse on the x axis, and what its arcs measure beyond their chords."""

    middle: float
    a: float
    b: float

    def beyond(self, line, outside):
        """Of the segments that end on it; outside where its inside is to their right."""
        x, y = (line - (self.middle, 0)).T / np.array([[self.a], [self.b]])
        on = np.abs(np.hypot(x, y) - 1) < ON
        on = on[1:] & on[:-1]
        turn = np.unwrap(np.arctan2(y, x))
        steps = np.diff(turn)[on]
        arcs = np.abs(np.diff(self._length(turn))[on]) - np.hypot(*np.diff(line, axis=0)[on].T)
        return arcs.sum(), (self.a * self.b / 2 * np.abs(steps - np.sin(steps))).sum() * (-1 if outside else 1)

    def _length(self, turn):
        """From turn 0 on."""
        return self.b * ellipeinc(turn, 1 - (self.a / self.b) ** 2)

    @property
    def length(self):
        """All around."""
        return 4 * self.b * ellipe(1 - (self.a / self.b) ** 2)

    @property
    def area(self):
        """Inside."""
        return math.pi * self.a * self.b


class Feature:
    """One thing in the square of side 2 around 0: a shape, and what its lines measure; `lines` None if they touch."""

    def __init__(self, chance):
        kind = chance.choice(["ring", "strip", "gap", "oval", "dot", "needle", "contact"])
        self.name, width = kind, 10 ** chance.uniform(-4, -1)
        self.shape, self.lines, self.length, self.area, *self.ellipses = getattr(self, f"_{kind}")(chance, width)
        self.turned = chance.uniform(0, 2 * math.pi)
        self.shape = self.shape.rotate(self.turned)

    def _ring(self, chance, width):
        radius = chance.uniform(0.3, 0.85)
        outer, inner = Ellipse(0, radius, radius), Ellipse(0, radius - width, radius - width)
        shape = rsym.disc(outer.a) - rsym.disc(inner.a)
        return shape, 2, outer.length + inner.length, outer.area - inner.area, outer, inner

    def _strip(self, chance, width):
        side = chance.uniform(0.3, 1.6)
        return rsym.rectangle(side, width), 1, 2 * (side + width), side * width

    def _gap(self, chance, width):
        side, high = chance.uniform(0.3, 1), chance.uniform(0.1, 0.5)
        across = (width + high) / 2
        both = rsym.rectangle(side, high, (0, across)) | rsym.rectangle(side, high, (0, -across))
        return both, 2, 4 * (side + high), 2 * side * high

    def _oval(self, chance, width):
        oval = Ellipse(0, chance.uniform(0.1, 0.85), width / 2)
        return rsym.ellipse(oval.a, oval.b), 1, oval.length, oval.area, oval

    def _dot(self, chance, width):
        dot = Ellipse(0, width, width)
        return rsym.disc(width), 1, dot.length, dot.area, dot

    def _needle(self, chance, width):
        long = chance.uniform(0.2, 0.8)
        shape = rsym.polygon([(-long, -width / 2), (long, 0), (-long, width / 2)])
        return shape, 1, width + 2 * math.hypot(2 * long, width / 2), long * width

    def _contact(self, chance, width):
        one, other = chance.uniform(0.1, 0.4), chance.uniform(0.1, 0.4)
        both = Ellipse(-one, one, one), Ellipse(other, other, other)
        shape = rsym.disc(one, (-one, 0)) | rsym.disc(other, (other, 0))
        return shape, None, sum(disc.length for disc in both), sum(disc.area for disc in both), *both

    def wrong(self, lines, sign):
        """What is wrong of lines around it, the area inside times the sign; chords are arcs where they end on one."""
        if self.lines is not None and len(lines) != self.lines:
            yield f"{len(lines)} lines for {self.lines}"
        cosine, sine = math.cos(self.turned), math.sin(self.turned)
        lines = [line @ np.array([[cosine, -sine], [sine, cosine]]) for line in lines]
        hole = self.ellipses[1] if self.name == "ring" else None
        arcs = [one.beyond(line, one is hole) for line in lines for one in self.ellipses]
        yield from unlike(lines, self.length, self.area, sign, *np.array(arcs).reshape(-1, 2).sum(axis=0))


def unlike(lines, length, area, sign, longer=0.0, larger=0.0):
    """How lines are unlike what is true, area times the sign."""
    if any(not np.array_equal(line[0], line[-1]) for line in lines):
        yield "lines end"
        return
    found = sum(np.hypot(*np.diff(line, axis=0).T).sum() for line in lines) + longer
    if abs(found - length) > OFF * length:
        yield f"length {found:.6g} for {length:.6g}"
    around = sum((line[:-1, 0] * np.diff(line[:, 1]) - line[:-1, 1] * np.diff(line[:, 0])).sum() / 2 for line in lines)
    found = sign * around + larger
    if abs(found - area) > OFF * area:
        yield f"area {found:.6g} for {area:.6g}"


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
        self.frame = self.scale * np.array(
            [[math.cos(turned), math.sin(turned)], [-math.sin(turned), math.cos(turned)]]
        )
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
        told = self.back(np.array(lines.status.places).reshape(-1, 2)) if said else []
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
            yield from ((None, f"plate: {one}") for one in unlike(own[None], 2 * sum(PLATE), math.prod(PLATE), 1))
        else:
            yield from ((tuple(line[0]), f"a line too many at {line[0]}") for line in own[None])
        for feature, place in zip(self.features, self.places, strict=True):
            lines = [line - place for line in own[place]]
            yield from ((place, f"{feature.name}: {one}") for one in feature.wrong(lines, -1 if self.holes else 1))


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
