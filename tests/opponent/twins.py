"""A shape against its twin, which says the same of what is inside in plain formulas: all that is asked of shapes.

What the twin has as its boundary is known by construction to bound the shape too, but for parts of it called `WALL`,
where the shape ends without a zero. Refusals are no faults, nor what is told with its error. Of each case `contains`
and two of the other questions are asked, dearer ones less often; a test that has one case for many days asks all.
"""

from __future__ import annotations

import math
import random
import warnings
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

import rsym
from rsym.backends.interpreter import interpret
from rsym.logic.faces import BETWEEN
from rsym.logic.sign_form import shape_form

WALL = "wall"
SIDE = 2.0  # of the window, from -SIDE to SIDE, a little aside: nothing that is made of eighths lies on its sides
WINDOW = (-SIDE - 0.013, SIDE + 0.017)
NEAR = 1e-7
CELLS = 24  # of meshes
LINES = 96  # cells of lines
SETTINGS = 8  # of the letters of one formula
FINE = 16  # vertices of a line
OFF, ACROSS, AROUND, TIPS = 1e-6, 1e-4, 128, 2  # how far, how far around, where; vertices at tips that nothing meets
TOLERANCE = {2: 1e-5, 3: 1e-2}  # finer takes minutes beside walls; the errors that are stated hold anyway
TOLD = 0.05  # around a place that is told, about a cell, nothing is asked
FEW = 0.01  # of rays, and of samples: those that pass an edge of the body
DECIDED = ("CERTIFIED", "REFUTED")


@dataclass(frozen=True)
class Twins:
    """A shape, its plain twin, and what is written."""

    shape: rsym.Shape
    plain: rsym.Shape
    text: str
    seed: int = 0

    def __str__(self):
        return self.text

    @property
    def family(self):
        """What is counted together."""
        return f"{'lettered, ' * bool(self.shape.letters)}{'space' if self.plain.dimension == 3 else 'plane'}"

    @property
    def bounds(self):
        """The window."""
        return (WINDOW,) * self.plain.dimension

    @property
    def walled(self):
        """Whether the twin has walls."""
        return any(name == WALL for name, _ in self.plain.parts)


class Drawn(random.Random):
    """Draws what is built; numbers as such, or as letters, and then their values."""

    def __init__(self, seed, lettered):
        super().__init__(seed)
        self.lettered, self.letters = lettered, {}

    def eighths(self, low, high):
        """One of the numbers low / 8 .. high / 8, or a letter for it."""
        if not self.lettered:
            return sp.Rational(self.randint(low, high), 8)
        letter = sp.Symbol(f"k{len(self.letters)}", real=True)
        self.letters[letter] = (low, high)
        return letter

    def shape(self, expression, coordinates):
        """A shape with the letters that it has."""
        own = sorted(sp.sympify(expression).free_symbols & set(self.letters), key=str)
        return rsym.Shape(expression, coordinates, letters={letter: 1 for letter in own})

    @staticmethod
    def settled(make, seed):
        """The twins of a seed: of a formula of its own, or one of some settings of letters."""
        if random.Random(seed // SETTINGS).random() < 0.25:
            return replace(make(seed, False)[1], seed=seed)
        chance, twins = make(seed // SETTINGS, True)
        drawn = random.Random(seed)
        values = {letter: sp.Rational(drawn.randint(*ends), 8) for letter, ends in chance.letters.items()}

        def at(shape):
            return shape.with_letters({one: value for one, value in values.items() if one.name in shape.letters})

        return Twins(at(twins.shape), at(twins.plain), f"{twins.text} at {values}", seed)


def asked(case):
    """What was asked, and what is said of the shape and is not so of its twin."""
    often = {measured: 3, sampled: 3, judged: 1, lines: 4}
    if case.plain.dimension == 3:
        often = {measured: 1, sampled: 3, judged: 2, meshed: 5, rays: 5}
    chance = random.Random(case.seed)
    first = chance.choices([*often], [*often.values()])[0]
    weights = {ask: weight for ask, weight in often.items() if ask is not first}
    asks = contained, first, chance.choices([*weights], [*weights.values()])[0]
    words, said = [], []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for ask in asks:
            words.append(ask.__name__)
            try:
                said += [f"{ask.__name__}: {fault}" for fault in ask(case, case.seed)]
            except rsym.RsymError as refusal:
                words[-1] = "refused"
                if refusal.code in {"kernel", "internal"}:
                    said.append(f"{ask.__name__}: {refusal}")
            except (ArithmeticError, LookupError, TypeError, AttributeError) as crash:
                said.append(f"{ask.__name__}: {type(crash).__name__}: {crash}")
    return " ".join(sorted(words[1:])), said


def _points(twins, seed, count=2000):
    return np.random.default_rng([seed, 7]).uniform(*WINDOW, (twins.plain.dimension, count))


def _off_boundary(twins, points):
    """Whether points are farther from all leaves of the twin than roundings."""
    steps = NEAR * np.concatenate([np.eye(twins.plain.dimension), -np.eye(twins.plain.dimension)])
    moved = twins.plain.contains(*(points[:, None] + steps.T[:, :, None]))
    return (moved == moved[0]).all(axis=0)


def contained(twins, seed):
    """The same points are inside."""
    points = _points(twins, seed)
    wrong = (twins.shape.contains(*points) != twins.plain.contains(*points)) & _off_boundary(twins, points)
    if wrong.any():
        yield f"{wrong.sum()} points, as {points[:, wrong][:, 0]}"


def _sums(found):
    return float(sum(value for name, value in found.parts.items() if not {WALL} & {*name.split(BETWEEN)}))


def measured(twins, seed):
    """Area and length, or volume and surface; walls bound, and do not count."""
    options = {"bounds": twins.bounds, "tolerance": TOLERANCE[twins.plain.dimension]}
    mine, other = (rsym.measure(one, **options) for one in (twins.shape, twins.plain))
    pairs = {"inside": (mine.volume, other.volume) if twins.plain.dimension == 3 else (mine.area, other.area)}
    size = mine.surface if twins.plain.dimension == 3 else mine.length
    theirs = other.surface if twins.plain.dimension == 3 else other.length
    error = math.fsum(value.error for value in other.parts.values()) if other.parts else theirs.error
    for name, (one, two) in pairs.items():
        if abs(one - two) > one.error + two.error + 1e-9:
            yield f"{name} {one} ± {one.error:.1g} for {two}"
    if twins.walled and _coincide(twins.plain):
        return  # a wall on a leaf, at these letters: whether it bounds there is not known of the twin
    if abs(size - _sums(other)) > size.error + error + 1e-8:
        yield f"boundary {size} ± {size.error:.1g} for {_sums(other)}"


def _coincide(plain):
    """Whether two leaves of a shape are multiples of one another."""
    points = np.random.default_rng(1).uniform(*WINDOW, (plain.dimension, 5))
    rows = _leaves(plain)(points)
    rows = rows / np.linalg.norm(rows, axis=1)[:, None]
    return bool((np.abs(np.triu(rows @ rows.T, 1)) > 1 - 1e-12).any())


def _leaves(plain):
    """The values (leaves, n) of the leaves of a shape at points (dimension, n)."""
    form = shape_form(plain)
    program = form.builder.program({f"{k}": leaf for k, leaf in enumerate(form.leaves)})
    names = [symbol.name for symbol in plain.coordinates]
    letters = plain.letters.values_with(None)

    def at(places):
        values = interpret(program, {**letters, **dict(zip(names, places, strict=True))})
        return np.array([np.broadcast_to(value, places.shape[1]) for value in values.values()])

    return at


def _off_it(twins, points):
    """Which points are not on the boundary of the twin: no leaf of it is zero there, or it has one sign around.

    Beside two leaves signs around say nothing: a wedge between them may be thinner.
    """
    at = _leaves(twins.plain)
    steps = [at(points + NEAR * row[:, None]) for row in np.eye(twins.plain.dimension)]
    slope = np.linalg.norm([(step - at(points)) / NEAR for step in steps], axis=0)
    near = np.array([np.count_nonzero(np.abs(at(points)) <= far * slope, axis=0) for far in (OFF, ACROSS)])
    directions = np.random.default_rng(5).normal(size=(AROUND, twins.plain.dimension))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    around = twins.plain.contains(*(points[:, None] + ACROSS * directions.T[:, :, None]))
    return (near[0] == 0) | ((near[1] < 2) & (around.all(axis=0) | ~around.any(axis=0)))


def sampled(twins, seed):
    """Points that are drawn lie inside, or on the boundary, off the walls."""
    inside = rsym.sample(twins.shape, 400, rng=seed, bounds=twins.bounds).points.T
    wrong = ~twins.plain.contains(*inside) & _off_boundary(twins, inside)
    if wrong.any():
        yield f"{wrong.sum()} of 400 points outside, as {inside[:, wrong][:, 0]}"
    finer = {"resolution": CELLS if twins.plain.dimension == 3 else LINES}
    on = rsym.sample(twins.shape, 300, over="boundary", rng=seed, bounds=twins.bounds, **finer).points.T
    away = _off_it(twins, on) & (np.abs(on) < min(map(abs, WINDOW)) - 1e-3).all(axis=0)
    if away.sum() > FEW * on.shape[1]:
        yield f"{away.sum()} of 300 points of the boundary off it, as {on[:, away][:, 0]}"


def judged(twins, seed):
    """Verdicts that are decided agree."""
    if twins.walled:
        return
    both = [rsym.verify_smoothness(one, bounds=twins.bounds) for one in (twins.shape, twins.plain)]
    if {one.verdict for one in both} <= {*DECIDED} and all(defect.proved for one in both for defect in one.defects):
        one, other = (f"{one.verdict} {one.continuity}" for one in both)
        if one != other:
            yield f"{one} for {other}"


def lines(twins, seed):
    """Lines lie on the boundary, and are as long."""
    mine, other = (rsym.level_lines(one, resolution=LINES, bounds=twins.bounds) for one in (twins.shape, twins.plain))
    if mine.status.kept or mine.status.unresolved_corners or other.status.unresolved_corners:
        return  # told
    if min(map(len, other), default=FINE) < FINE:
        return  # thinner than a cell
    points = np.concatenate([np.empty((0, 2)), *mine])
    for place in mine.status.places:
        points = points[np.abs(points - place).max(axis=1) > TOLD]
    points = points.T
    away = _off_it(twins, points)
    if away.sum() > TIPS:
        yield f"{away.sum()} vertices off the boundary, as {points[:, away][:, 0]}"
    if not twins.walled and abs(mine.length - other.length) > 0.02 * (1 + other.length):
        yield f"length {mine.length} for {other.length}"


def meshed(twins, seed):
    """Meshes hold as much."""
    mine, other = (rsym.mesh(one, CELLS, bounds=twins.bounds).status for one in (twins.shape, twins.plain))
    if mine.closed != other.closed or abs(mine.volume - other.volume) > 0.02 * (1 + other.volume):
        if not mine.unresolved:
            yield f"volume {mine.volume}, closed {mine.closed}, for {other.volume}, closed {other.closed}"


def rays(twins, seed):
    """Rays meet the same."""
    framed = rsym.render(twins.shape.replace(bounds=twins.bounds), size=(32, 24)).view
    camera = rsym.Camera(target=tuple(framed.middle.tolist()))
    images = [
        rsym.render(one.replace(bounds=twins.bounds), camera=camera, size=(32, 24))
        for one in (twins.shape, twins.plain)
    ]
    if images[0].view.pixel != images[1].view.pixel:
        return
    sure = ~(images[0].undecided | images[1].undecided)
    one, other = (image.view.front - image.depth for image in images)
    with np.errstate(invalid="ignore"):
        unlike = sure & ~(np.abs(one - other) < 1e-6)
    unlike &= np.isfinite(images[0].depth) | np.isfinite(images[1].depth)
    if unlike.sum() > FEW * unlike.size:
        yield f"{unlike.sum()} of {unlike.size} rays"
