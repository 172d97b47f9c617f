"""A shape against its twin, which says the same of what is inside in plain formulas: all that is asked of shapes.

What the twin has as its boundary is known by construction to bound the shape too, but for parts of it called `WALL`,
where the shape ends without a zero. Refusals are no faults, nor what is told with its error.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import rsym
from rsym.backends.interpreter import interpret
from rsym.logic.faces import BETWEEN
from rsym.logic.sign_form import shape_form

WALL = "wall"
SIDE = 2.0  # of the window, from -SIDE to SIDE, a little aside: nothing that is made of eighths lies on its sides
WINDOW = (-SIDE - 0.013, SIDE + 0.017)
NEAR = 1e-7
CELLS = 48
FINE = 16  # vertices of a line
OFF, ACROSS, AROUND, TIPS = 1e-6, 1e-4, 128, 2  # how far, how far around, where; vertices at tips that nothing meets
FEW = 0.01  # of rays, and of samples: those that pass an edge of the body
DECIDED = ("CERTIFIED", "REFUTED")


@dataclass(frozen=True)
class Twins:
    """A shape, its plain twin, and what is written."""

    shape: rsym.Shape
    plain: rsym.Shape
    text: str

    @property
    def bounds(self):
        """The window."""
        return (WINDOW,) * self.plain.dimension

    @property
    def walled(self):
        """Whether the twin has walls."""
        return any(name == WALL for name, _ in self.plain.parts)


def faults(twins: Twins, seed: int) -> list[str]:
    """What is said of the shape, and is not so of its twin."""
    said = []
    space = twins.plain.dimension == 3
    asks = (contained, measured, sampled, judged, *((meshed, rays) if space else (lines,)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for ask in asks:
            try:
                said += [f"{ask.__name__}: {fault}" for fault in ask(twins, seed)]
            except rsym.RsymError as refusal:
                if refusal.code in {"kernel", "internal"}:
                    said.append(f"{ask.__name__}: {refusal}")
            except (ArithmeticError, LookupError, TypeError, AttributeError) as crash:
                said.append(f"{ask.__name__}: {type(crash).__name__}: {crash}")
    return said


def _points(twins, seed, count=2000):
    return np.random.default_rng([seed, 7]).uniform(*WINDOW, (twins.plain.dimension, count))


def _off_boundary(twins, points):
    """Whether points are farther from all leaves of the twin than roundings."""
    step = NEAR * np.eye(twins.plain.dimension)
    moved = [twins.plain.contains(*(points + side * row[:, None])) for row in step for side in (1, -1)]
    return np.all([one == moved[0] for one in moved], axis=0)


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
    mine, other = (rsym.measure(one, bounds=twins.bounds) for one in (twins.shape, twins.plain))
    pairs = {"inside": (mine.volume, other.volume) if twins.plain.dimension == 3 else (mine.area, other.area)}
    size = mine.surface if twins.plain.dimension == 3 else mine.length
    theirs = other.surface if twins.plain.dimension == 3 else other.length
    error = math.fsum(value.error for value in other.parts.values()) if other.parts else theirs.error
    for name, (one, two) in pairs.items():
        if abs(one - two) > one.error + two.error + 1e-9:
            yield f"{name} {one} ± {one.error:.1g} for {two}"
    if abs(size - _sums(other)) > size.error + error + 1e-8:
        yield f"boundary {size} ± {size.error:.1g} for {_sums(other)}"


def _off_it(twins, points):
    """Which points are not on the boundary of the twin: no leaf of it is zero there, or it has one sign around."""
    form = shape_form(twins.plain)
    program = form.builder.program({f"{k}": leaf for k, leaf in enumerate(form.leaves)})
    names = [symbol.name for symbol in twins.plain.coordinates]

    def at(places):
        values = interpret(program, dict(zip(names, places, strict=True)))
        return np.array([np.broadcast_to(value, places.shape[1]) for value in values.values()])

    steps = [at(points + NEAR * row[:, None]) for row in np.eye(len(names))]
    slope = np.linalg.norm([(step - at(points)) / NEAR for step in steps], axis=0)
    on = np.abs(at(points)).min(axis=0, where=np.abs(at(points)) <= OFF * slope, initial=np.inf) < np.inf
    directions = np.random.default_rng(5).normal(size=(AROUND, len(names)))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    around = np.array([twins.plain.contains(*(points + ACROSS * one[:, None])) for one in directions])
    return ~on | (around.all(axis=0) | ~around.any(axis=0))


def sampled(twins, seed):
    """Points that are drawn lie inside, or on the boundary, off the walls."""
    inside = rsym.sample(twins.shape, 400, rng=seed, bounds=twins.bounds).points.T
    wrong = ~twins.plain.contains(*inside) & _off_boundary(twins, inside)
    if wrong.any():
        yield f"{wrong.sum()} of 400 points outside, as {inside[:, wrong][:, 0]}"
    finer = {"resolution": 24} if twins.plain.dimension == 3 else {"resolution": 128}
    on = rsym.sample(twins.shape, 300, over="boundary", rng=seed, bounds=twins.bounds, **finer).points.T
    away = _off_it(twins, on) & (np.abs(on) < min(map(abs, WINDOW)) - 1e-3).all(axis=0)
    if away.sum() > FEW * on.shape[1]:
        yield f"{away.sum()} of 300 points of the boundary off it, as {on[:, away][:, 0]}"


def judged(twins, seed):
    """Verdicts that are decided agree."""
    if twins.walled:
        return
    one, other = (rsym.verify_smoothness(one, bounds=twins.bounds) for one in (twins.shape, twins.plain))
    if {one.verdict, other.verdict} <= {*DECIDED} and (one.verdict, one.continuity) != (
        other.verdict,
        other.continuity,
    ):
        yield f"{one.verdict} {one.continuity} for {other.verdict} {other.continuity}"


def lines(twins, seed):
    """Lines lie on the boundary, and are as long."""
    mine, other = (rsym.level_lines(one, resolution=256, bounds=twins.bounds) for one in (twins.shape, twins.plain))
    if mine.status.kept or mine.status.unresolved_corners or other.status.unresolved_corners:
        return  # told
    if min(map(len, other), default=FINE) < FINE:
        return  # thinner than a cell
    points = np.concatenate([np.empty((0, 2)), *mine]).T
    away = _off_it(twins, points)
    if away.sum() > TIPS:
        yield f"{away.sum()} vertices off the boundary, as {points[:, away][:, 0]}"
    if not twins.walled and abs(mine.length - other.length) > 0.02 * (1 + other.length):
        yield f"length {mine.length} for {other.length}"


def meshed(twins, seed):
    """Meshes hold as much."""
    mine, other = (rsym.mesh(one, CELLS // 2, bounds=twins.bounds).status for one in (twins.shape, twins.plain))
    if mine.closed != other.closed or abs(mine.volume - other.volume) > 0.02 * (1 + other.volume):
        if not mine.unresolved:
            yield f"volume {mine.volume}, closed {mine.closed}, for {other.volume}, closed {other.closed}"


def rays(twins, seed):
    """Rays meet the same."""
    images = [rsym.render(one.replace(bounds=twins.bounds), size=(40, 30)) for one in (twins.shape, twins.plain)]
    if any(image.view.pixel != images[0].view.pixel for image in images):
        return
    sure = ~(images[0].undecided | images[1].undecided)
    with np.errstate(invalid="ignore"):
        unlike = sure & ~(np.abs(images[0].depth - images[1].depth) < 1e-6)
    unlike &= np.isfinite(images[0].depth) | np.isfinite(images[1].depth)
    if unlike.sum() > FEW * unlike.size:
        yield f"{unlike.sum()} of {unlike.size} rays"


def hunt(made: Callable[[int], Twins], first: int, count: int) -> int:
    """Ask many seeds, and say which are wrong: how many."""
    wrong = 0
    for seed in range(first, first + count):
        twins = made(seed)
        said = faults(twins, seed)
        if said:
            wrong += 1
            print(seed, twins.text, *said, sep="\n  ", flush=True)
    print(f"{wrong} of {count} wrong")
    return wrong
