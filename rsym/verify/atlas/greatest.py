"""The greatest curvature of a boundary, for many values of letters at once, by following it with short steps.

A map of it over the plane of two letters has level lines: for figures, not proved.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CloughTocher2DInterpolator

from rsym.arrays import Flags, Floats, Ints
from rsym.backends.registry import CompiledFunction, make_function
from rsym.model.shape import Bounds, Shape
from rsym.program.expansion import expand
from rsym.program.fields import program_of
from rsym.program.program import FLOAT64
from rsym.sampling.isolines import isolines

PIXELS = 400  # along each letter, of the map from which level lines are read
DECADE = (1.0, 2.0, 5.0)  # levels in each
FEWEST = 4  # points that make a map
CELLS = 48  # along the longer side, of the lattice on whose edges the boundary is met
TURN = 0.1  # of the normal in one step: a smooth maximum is met to half a hundredth
SHORTEST = 1e-6  # of a cell: where shorter steps are needed there is a corner
REACH = 4.0  # cells that are followed from each point: past the neighbours, and around what is finer than a cell
STEPS, NEWTON_STEPS = 400, 5
ON_LEVEL = 1e-8  # of a cell
BATCH = 64  # pairs of letters whose lattices are in memory together


def greatest_curvatures(
    plane: Shape, bounds: Bounds, names: Sequence[str], points: Floats, fixed: Mapping[str, float], *, body: bool
) -> Floats:
    """The greatest size of a curvature of the boundary in the bounds for each row of letters; NaN if none is met.

    Of a body of revolution, given by its meridian, those of its circles of latitude count too.

    Examples
    --------
    >>> from rsym import x, y
    >>> import sympy as sp
    >>> a, b = sp.symbols("a b", real=True)
    >>> ellipse = Shape(1 - (x / a) ** 2 - (y / b) ** 2, (x, y), letters={a: 1, b: 2})
    >>> box, points = ((-3, 3), (-3, 3)), np.array([[2.0, 1.0], [2.5, 0.5]])
    >>> found = greatest_curvatures(ellipse, box, ("a", "b"), points, {}, body=False)
    >>> (found / [2, 10]).round(2)
    array([1., 1.])
    """
    field = _Field(plane, names, fixed, body)
    result = np.full(len(points), np.nan)
    for start in range(0, len(points), BATCH):
        part = slice(start, start + BATCH)
        result[part] = _greatest(field, bounds, points[part])
    return result


class _Field:
    """omega, its gradient and curvatures at points (n, 2) with letters (n, 2)."""

    def __init__(self, plane: Shape, names: Sequence[str], fixed: Mapping[str, float], body: bool) -> None:
        program = program_of(plane, ("value", "gradient", "curvature"), share=None).varying(names)
        self.letters = [fixed[name] for name in program.letters]
        self.outputs = [name for name, _ in program.outputs]
        self.function: CompiledFunction = make_function(expand(program), "numpy", FLOAT64)
        self.body = body

    def at(self, points: Floats, letters: Floats) -> tuple[Floats, Floats, Floats]:
        """Value (n,), gradient (n, 2), greatest curvature (n,)."""
        out = np.empty((len(self.outputs), len(points)))
        columns = [np.ascontiguousarray(column) for column in (*points.T, *letters.T)]
        with np.errstate(all="ignore"):
            self.function.run(columns, self.letters, list(out))
            value, gx, gy, curvature = out
            size = np.abs(curvature)
            if self.body:
                across = np.abs(gy / (points[:, 1] * np.hypot(gx, gy)))
                size = np.fmax(size, np.where(points[:, 1] != 0, across, np.nan))
        return value, np.column_stack([gx, gy]), size


@dataclass(frozen=True)
class _Walkers:
    """Points on boundaries, the letters they belong to, their normals, and what is left of their way and step."""

    points: Floats
    letters: Floats
    owner: Ints
    normals: Floats
    step: Floats
    left: Floats

    def only(self, which: Flags) -> _Walkers:
        return _Walkers(*(getattr(self, name)[which] for name in self.__dataclass_fields__))


def _greatest(field: _Field, bounds: Bounds, letters: Floats) -> Floats:
    cell = max(high - low for low, high in bounds) / CELLS
    starts, owner = _met(field, bounds, letters, cell)
    best = np.full(len(letters), -np.inf)
    points, normals, sizes, good = _on_boundary(field, starts, letters[owner], cell)
    many = np.full(len(starts), cell)
    walkers = _Walkers(points, letters[owner], owner, normals, many / 4, many * REACH).only(good)
    np.maximum.at(best, owner[good], sizes[good])
    for _ in range(STEPS):
        if not len(walkers.owner):
            break
        walkers = _stepped(field, walkers, best, cell, bounds)
    return np.where(best > 0, best, np.nan)


def _met(field: _Field, bounds: Bounds, letters: Floats, cell: float) -> tuple[Floats, Ints]:
    """Points (n, 2) beside the boundary, on the edges of a lattice where omega changes its sign, and whose they are."""
    axes = [np.linspace(low, high, max(2, round((high - low) / cell)) + 1) for low, high in bounds]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    size = lattice[..., 0].size
    values, _, _ = field.at(np.tile(lattice.reshape(-1, 2), (len(letters), 1)), np.repeat(letters, size, axis=0))
    values = values.reshape(len(letters), *lattice.shape[:2])
    found, owner = [], []
    for axis in (0, 1):
        first, second = (np.take(values, range(k, values.shape[axis + 1] - 1 + k), axis=axis + 1) for k in (0, 1))
        whose, i, j = np.nonzero((first > 0) != (second > 0))
        one, other = first[whose, i, j], second[whose, i, j]
        share = np.clip(one / (one - other), 0, 1)[:, None]
        here, there = lattice[i, j], lattice[i + (axis == 0), j + (axis == 1)]
        good = np.isfinite(share[:, 0])
        found.append((here + share * (there - here))[good])
        owner.append(whose[good])
    return np.concatenate(found), np.concatenate(owner)


def _on_boundary(field: _Field, points: Floats, letters: Floats, cell: float) -> tuple[Floats, Floats, Floats, Flags]:
    """The points moved onto the boundary, their inward normals and curvatures, and which of them arrived."""
    for _ in range(NEWTON_STEPS):
        value, gradient, _ = field.at(points, letters)
        with np.errstate(all="ignore"):
            points = points - (value / np.einsum("ij,ij->i", gradient, gradient))[:, None] * gradient
    value, gradient, sizes = field.at(points, letters)
    with np.errstate(all="ignore"):
        slope = np.hypot(*gradient.T)
        good = (np.abs(value) <= ON_LEVEL * cell * slope) & np.isfinite(sizes)
        return points, gradient / slope[:, None], sizes, good


def _stepped(field: _Field, walkers: _Walkers, best: Floats, cell: float, bounds: Bounds) -> _Walkers:
    """One step of each with the inside on its left; who turned too far or went astray tries again with half a step."""
    tangents = np.column_stack([walkers.normals[:, 1], -walkers.normals[:, 0]])
    aim = walkers.points + walkers.step[:, None] * tangents
    points, normals, sizes, arrived = _on_boundary(field, aim, walkers.letters, cell)
    with np.errstate(invalid="ignore"):
        cross = walkers.normals[:, 0] * normals[:, 1] - walkers.normals[:, 1] * normals[:, 0]
        turn = np.abs(np.arctan2(cross, np.einsum("ij,ij->i", walkers.normals, normals)))
        astray = np.hypot(*(points - aim).T) > walkers.step / 4
    good = arrived & ~astray & (turn <= TURN)
    low, high = np.array(bounds).T
    inside = good & ((low <= points) & (points <= high)).all(axis=1)
    np.maximum.at(best, walkers.owner[inside], sizes[inside])
    easy = turn < TURN / 2
    step = np.where(good, np.where(easy, 2 * walkers.step, walkers.step), walkers.step / 2)
    left = np.where(good, walkers.left - walkers.step, walkers.left)
    moved = _Walkers(
        np.where(good[:, None], points, walkers.points),
        walkers.letters,
        walkers.owner,
        np.where(good[:, None], normals, walkers.normals),
        np.minimum(step, cell / 2),
        left,
    )
    return moved.only((left > 0) & (step > SHORTEST * cell) & (inside | ~good))


@dataclass(frozen=True, eq=False)
class CurvatureMap:
    """The greatest size of a curvature of the boundary at pairs of letters; numerical.

    points (n, 2) and values (n,) are what was found, `certified` (m, 2, 2) where the map between them holds.

    Examples
    --------
    >>> points = np.array([[0, 0], [1, 0], [0, 1], [1, 1.0]])
    >>> shown = CurvatureMap(points, 3 / (1 + points[:, 0]), np.array([[[0, 1], [0, 1.0]]]))
    >>> shown.on((np.array([0.25]), np.array([0.5]))).round(6)
    array([[2.4]])
    >>> ((level, (line,)),) = shown.level_lines()
    >>> level, bool(abs(line[:, 0] - 0.5).max() < 1e-3)
    (2.0, True)
    """

    points: Floats
    values: Floats
    certified: Floats

    def on(self, axes: tuple[Floats, Floats]) -> Floats:
        """The map on a lattice; NaN where smoothness is not certified.

        Between the points the radius is interpolated: towards a corner it falls to zero, as a rule in proportion.
        """
        result = np.full((len(axes[0]), len(axes[1])), np.nan)
        if len(self.values) < FEWEST:
            return result
        low, width = self.points.min(axis=0), np.ptp(self.points, axis=0)
        smooth = CloughTocher2DInterpolator((self.points - low) / width, 1 / self.values)
        places = np.meshgrid(*((axis - low[k]) / width[k] for k, axis in enumerate(axes)), indexing="ij")
        values = 1 / np.clip(smooth(*places), 1 / self.values.max(), 1 / self.values.min())
        for sides in self.certified:
            inside = np.ix_(*((low <= axis) & (axis <= high) for axis, (low, high) in zip(axes, sides, strict=True)))
            result[inside] = values[inside]
        return result

    def lattice(self) -> tuple[Floats, Floats]:
        """The coordinates of a fine lattice over all certified rectangles."""
        low, high = self.certified[..., 0].min(axis=0), self.certified[..., 1].max(axis=0)
        return np.linspace(low[0], high[0], PIXELS), np.linspace(low[1], high[1], PIXELS)

    def level_lines(self, levels: Sequence[float] | None = None) -> list[tuple[float, list[Floats]]]:
        """The lines of each level of the greatest curvature, by default of 1, 2, 5, 10, ... as far as they occur."""
        if len(self.values) < FEWEST:
            return []
        if levels is None:
            levels = round_levels(float(self.values.min()), float(self.values.max()))
        axes = self.lattice()
        heights = np.log(self.on(axes))
        return [(float(level), isolines(heights, float(np.log(level)), axes)) for level in levels]


def round_levels(low: float, high: float) -> list[float]:
    """The numbers 1, 2, 5, 10, ... from low to high.

    Examples
    --------
    >>> round_levels(0.4, 10)
    [0.5, 1.0, 2.0, 5.0, 10.0]
    """
    powers = range(math.floor(math.log10(low)), math.floor(math.log10(high)) + 1)
    return [level for power in powers for step in DECADE if low <= (level := step * 10.0**power) <= high]
