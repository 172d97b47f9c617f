"""An opponent of labels: bodies of aligned boxes and coaxial cylinders, whose parts have faces in common.

All coordinates lie on a small grid, so that lids, sides and radii are the same formulas again and again, at random
places, in random order, some parts of one name, some of none. The truth is counted cell by cell on the grid: a piece of
a face between a cell inside and one outside belongs to all boxes that end there. Measures, points drawn on
it, points inside and rays are asked; of a group that has a name boxes without one have it.

    python tests/opponent/hunt.py parted --count 2000 --start 1
"""

from __future__ import annotations

import collections
import functools
import itertools
import math
import operator
import random
import warnings

import numpy as np
import sympy as sp

import rsym
from rsym.logic.faces import BETWEEN
from rsym.sampling.rays import Caster

NAMES = ("A", "B", "C", "D")
GROUP = "E"  # of two of the boxes, of which those that have a name of their own keep it
SIDE = 6  # of the grid
WITHIN = 1e-9


class Bricks:
    """Boxes of a grid with names ("" of none), the first ones joined, the last ones cut out."""

    def __init__(self, chance, dimension):
        self.dimension = dimension
        self.joined, self.cut = chance.randint(2, 4), chance.randint(0, 2)
        self.boxes, self.names = [], []
        levels = [sorted(chance.sample(range(SIDE + 1), 4)) for _ in range(dimension)]  # few: ends coincide
        for number in range(self.joined + self.cut):
            self.boxes.append([tuple(sorted(chance.sample(levels[axis], 2))) for axis in range(dimension)])
            self.names.append(NAMES[number % 4] if chance.random() < 0.7 else chance.choice(("", "", "A")))
        self.own, self.grouped = [*self.names], chance.random() < 0.5
        if self.grouped:
            self.names[:2] = [name or GROUP for name in self.names[:2]]
        self.chance = chance

    def __str__(self):
        return " ".join(f"{name}{box}" for name, box in zip(self.names, self.boxes, strict=True))

    @property
    def window(self):
        """Room for all."""
        return ((-1, SIDE + 1),) * self.dimension

    def shape(self):
        """As rsym has it, in a random order."""
        made = [self._box(number) for number in range(len(self.boxes))]
        joined = made[: self.joined]
        if self.grouped:
            joined[:2] = [(joined[0] | joined[1]).named(GROUP)]
        self.chance.shuffle(joined)
        body = functools.reduce(operator.or_, joined)
        for number in range(self.joined, len(made)):
            body = body - made[number]
        return body

    def _box(self, number):
        sizes = [high - low for low, high in self.boxes[number]]
        middle = [(low + high) / 2 for low, high in self.boxes[number]]
        made = rsym.rectangle(*sizes) if self.dimension == 2 else rsym.box(*sizes)
        made = made.translate(*map(exact, middle))
        return made.named(self.own[number]) if self.own[number] else made

    def holds(self, number, cell):
        """Whether a cell lies in a box."""
        return all(low <= place < high for (low, high), place in zip(self.boxes[number], cell, strict=True))

    def inside(self, cell):
        """Whether a cell lies in the body."""
        return any(self.holds(k, cell) for k in range(self.joined)) and not any(
            self.holds(k, cell) for k in range(self.joined, len(self.boxes))
        )

    def faces(self):
        """The pieces of the boundary of size 1: middle, axis, and the names there."""
        for cell in itertools.product(range(-1, SIDE + 1), repeat=self.dimension):
            if not self.inside(cell):
                continue
            for axis, way in itertools.product(range(self.dimension), (-1, 1)):
                other = tuple(place + way * (k == axis) for k, place in enumerate(cell))
                if self.inside(other):
                    continue
                ends = [k for k in range(self.joined) if self.holds(k, cell)] if not self._united(other) else []
                ends += [k for k in range(self.joined, len(self.boxes)) if self.holds(k, other)]
                middle = [place + 0.5 * (1 + way * (k == axis)) for k, place in enumerate(cell)]
                names = frozenset().union(*map(self._called, ends))
                yield middle, axis, names - {GROUP} if self._inner(ends) else names

    def _called(self, number):
        """The names of a box: of one box twice it is not known which is meant, a name of its own before a group's."""
        own = self.boxes[number]
        names = {name for box, name in zip(self.boxes, self.names, strict=True) if box == own and name}
        if number >= self.joined and self.boxes[0] != self.boxes[1]:
            names -= {GROUP}  # what is cut out has the shape of a box of the group, and is none
        return names - {GROUP} or names

    def _inner(self, ends):
        """Whether a box of the group that has a name of its own is there: the group around it goes without saying."""
        return self.grouped and any(k < 2 and GROUP not in self._called(k) for k in ends)

    def _united(self, cell):
        return any(self.holds(k, cell) for k in range(self.joined))

    def truth(self):
        """Lengths or areas by the names there."""
        return collections.Counter(names for _, _, names in self.faces())

    def named_at(self, point):
        """The names at a point of the boundary, those of the nearest piece; None beside an edge."""
        near = [round(value) for value in point]
        on = [axis for axis, value in enumerate(point) if abs(value - near[axis]) < 1e-6]
        if len(on) != 1:
            return None
        (axis,) = on
        cell = [math.floor(value) for value in point]
        for middle, its, names in self.pieces:
            if its == axis and middle[axis] == near[axis]:
                if all(k == axis or math.floor(middle[k]) == cell[k] for k in range(self.dimension)):
                    return names
        return frozenset({"nothing"})

    @property
    def pieces(self):
        """The pieces, counted once."""
        if not hasattr(self, "_found"):
            self._found = [*self.faces()]
        return self._found


class Rods:
    """Cylinders of one radius about the z axis, with names, joined."""

    dimension = 3
    window = ((-2, 2), (-2, 2), (-1, SIDE + 1))

    def __init__(self, chance):
        self.radius = chance.choice((0.5, 1, 1.5))
        count = chance.randint(2, 4)
        self.ends = [tuple(sorted(chance.sample(range(SIDE + 1), 2))) for _ in range(count)]
        self.names = [NAMES[k] if chance.random() < 0.85 else "A" for k in range(count)]

    def __str__(self):
        return f"rods of {self.radius}: " + " ".join(map(str, zip(self.names, self.ends, strict=True)))

    def shape(self):
        """As rsym has it."""
        made = None
        for (low, high), name in zip(self.ends, self.names, strict=True):
            rod = rsym.cylinder(exact(self.radius), high - low, (0, 0, exact((low + high) / 2))).named(name)
            made = rod if made is None else made | rod
        return made

    def truth(self):
        """Areas by the names there."""
        found = collections.Counter()
        rods = [*zip(self.ends, self.names, strict=True)]
        inside = [{name for (low, high), name in rods if low <= k < high} for k in range(SIDE)]
        for k, names in enumerate(inside):
            if names:
                found[frozenset(names)] += 2 * math.pi * self.radius
                for other, end in ((k - 1, "low"), (k + 1, "high")):
                    if not 0 <= other < SIDE or not inside[other]:
                        at = k if end == "low" else k + 1
                        here = {name for ends, name in rods if at == ends[end == "high"]}
                        found[frozenset(here)] += math.pi * self.radius**2
        return found

    def named_at(self, point):
        """Nothing is asked at points."""
        return None


def exact(value):
    """Whole numbers and halves as they are written."""
    return sp.Rational(value)


def case(seed):
    """What a seed makes."""
    chance = random.Random(seed)
    kind = chance.choice(("plane", "plane", "plane", "space", "rods"))
    made = Rods(chance) if kind == "rods" else Bricks(chance, 2 if kind == "plane" else 3)
    made.family, made.seed = kind, seed
    return made


def known(names):
    """Names that were given; formulas are none."""
    return frozenset(names) if {*names} <= {*NAMES, GROUP} else frozenset()


def by_names(parts):
    """Measures by sets of names; formulas have none."""
    found = collections.Counter()
    for name, value in parts.items():
        names = name.split(BETWEEN)
        found[known(names)] += float(value)
    return found


def asked(case):
    """What was asked, and what is wrong, in words."""
    truth = case.truth()
    if not truth:
        return "nothing", []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rsym.RsymWarning)  # where boxes touch along an edge, or in a sheet
        try:
            shape = case.shape().replace(bounds=case.window)
            said = measured(shape, truth)
            if case.seed % 3 == 0:
                said += moved(case, shape, truth)
        except rsym.RsymError as error:
            return "refused", [str(error)]
        if isinstance(case, Bricks):
            said += drawn(case, shape) + held(case, shape) + met(case, shape)
        if case.dimension == 3 and case.seed % 4 == 0:
            said += meshed(shape, truth)
    return "asked", said


def measured(shape, truth, size=1.0):
    """Measures by names, of a body of that size."""
    found = {names: value / size for names, value in by_names(rsym.measure(shape).parts).items()}
    return [
        f"measure of {sorted(names)}: {found.get(names, 0):.12g} for {truth[names]:.12g}, size {size:.6g}"
        for names in {*truth, *found}
        if abs(found.get(names, 0) - truth[names]) > WITHIN * (1 + truth[names])
    ]


def moved(case, shape, truth):
    """What is enlarged, turned and mirrored has the same names."""
    chance = random.Random(case.seed)
    size = chance.choice((2, 3, sp.Rational(1, 2), sp.Rational(7, 10), sp.Rational(1, 6), 10, 0.1, 25.4, 1 / 3))
    ways = [
        lambda one: one.scale(size),
        lambda one: one.rotate(chance.choice((sp.pi / 4, sp.pi / 6, sp.Rational(3, 10), 0.7))),
        lambda one: one.translate(
            *[chance.choice((1, sp.Rational(-3, 7), 0.3, -1 / 7)) for _ in range(case.dimension)]
        ),
    ]
    chance.shuffle(ways)
    for way in ways:
        shape = way(shape)
    return measured(shape.replace(bounds=None), truth, float(size) ** (case.dimension - 1))


def held(case, shape):
    """The middles of cells lie inside where a box says so."""
    cells = [*itertools.product(range(-1, SIDE + 1), repeat=case.dimension)]
    inside = shape.contains(*(np.array(cells).T + 0.5))
    wrong = [cell for cell, found in zip(cells, inside.tolist(), strict=True) if found != case.inside(cell)]
    return [f"contains at {cell}" for cell in wrong[:3]]


def met(case, shape):
    """Rays along the axes through cells, from both sides, meet the face that is first, and its names."""
    if case.dimension == 2:
        return []
    rays, wanted = [], []
    for axis, way in itertools.product(range(3), (-1, 1)):
        first = {}
        for middle, its, names in case.pieces:
            row = tuple(value for k, value in enumerate(middle) if k != axis)
            if its == axis and (row not in first or (middle[axis] - first[row][0][axis]) * way < 0):
                first[row] = middle, names
        for middle, names in first.values():
            rays.append(([value - 20 * way * (k == axis) for k, value in enumerate(middle)], way * np.eye(3)[axis]))
            wanted.append(names)
    hits = Caster(shape).cast(*map(np.array, zip(*rays, strict=True)))
    if not (hits.met.all() and np.allclose(hits.depth, 20, rtol=0, atol=1e-9)):
        return [f"{np.count_nonzero(~np.isclose(hits.depth, 20, rtol=0, atol=1e-9))} rays miss"]
    found = zip(hits.points.tolist(), hits.labels.each.tolist(), wanted, strict=True)
    return [
        f"ray at {np.round(point, 6).tolist()}: {name} for {sorted(names)}"
        for point, name, names in found
        if known(name.split(BETWEEN)) != names
    ][:3]


def drawn(case, shape):
    """Points that are drawn on each part lie there."""
    said = []
    on = rsym.sample(shape, 200, over="boundary", rng=case.seed, resolution=32 if case.dimension == 2 else 16)
    for point, name in zip(on.points.tolist(), on.parts.tolist(), strict=True):
        names = case.named_at(point)
        if names is not None and known(name.split(BETWEEN)) != names:
            said.append(f"sample at {np.round(point, 6).tolist()}: {name} for {sorted(names)}")
    return said[:3]


def meshed(shape, truth):
    """The areas of a mesh by names, to its cells."""
    mesh = rsym.mesh(shape, 48)
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    sizes = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    found = by_names({name: sizes[mesh.part == k].sum() for k, name in enumerate(mesh.parts)})
    return [
        f"mesh of {sorted(names)}: {found[names]:.4g} for {truth[names]:.4g}"
        for names in {*truth, *found}
        if abs(found[names] - truth[names]) > 1 + 0.15 * truth[names]
    ]
