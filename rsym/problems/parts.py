"""Parts of the boundary with what is said of them: that they are there, and that they agree where they meet."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import combinations
from typing import Any

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.backends.kernel import compile
from rsym.errors import RsymError
from rsym.logic.sign_form import SignForm, shape_form
from rsym.logic.weights import Weights
from rsym.model.arguments import number, positive
from rsym.model.equation import Equation
from rsym.model.letters import Letters
from rsym.model.shape import Bounds, Shape
from rsym.problems.conditions import Name, assigned
from rsym.problems.meetings import Places
from rsym.sampling.windows import bounds_or_extent

AGREEMENT = 1e-9  # of the size of data
NEAR = 1e-6  # of the box: points that are one
ASIDE, LOOSELY = 1e-8, 1e-3  # where data are undefined where they meet: of the box, and of their size
UNIT = 1e-6  # how far the gradient of a normalised weight may be from 1 in length
# Of half the box: how far from corners weights have no first order. Of a square with a round hole, u = 0 and 1, errors
# on 48 cells are 4e-6 with none, 5e-8 for 0.1, 3e-9 for 0.25 and 0.5, 5e-8 for 1.
SOFT = 0.25
LATTICE = 5  # points along each axis that tell the size of data


@dataclass(frozen=True)
class Parts:
    """Sets of leaves of a shape by name, those that nothing is said of left out; `between` as of `Places`."""

    shape: Shape
    leaves: Mapping[Name, Sequence[int]]
    form: SignForm
    box: Bounds
    between: Mapping[tuple[int, int], int] = field(default_factory=dict)

    @cached_property
    def _places(self) -> Places:
        return Places(self.shape, self.form, self.box, tuple(map(tuple, self.leaves.values())), self.between)

    def points(self, name: Name) -> Floats:
        """Some points (n, dim) of a part."""
        return self._places.of(list(self.leaves).index(name))

    def meeting(self, one: Name, other: Name) -> tuple[Floats, Floats]:
        """Points (n, dim) where two parts meet, and (n,) how far off they may be."""
        if (one, other) not in self._met:
            numbers = list(self.leaves)
            self._met[one, other] = self._places.meeting(numbers.index(one), numbers.index(other))
        return self._met[one, other]

    @cached_property
    def _met(self) -> dict[tuple[Name, Name], tuple[Floats, Floats]]:
        return {}

    def require_all(self) -> None:
        """Refuse a part that has nothing of the boundary where letters have their defaults."""
        for name in self.leaves:
            if not len(self.points(name)):
                values = ", ".join(f"{title} = {float(one.default):g}" for title, one in self.shape.letters.items())
                raise RsymError(
                    f"{_called(name)} has nothing of the boundary{values and f' where {values}'}",
                    code="vanished-part",
                    remedy="leave it out, or change the letters, the shape or its bounds so that it is there",
                )

    def require_slopes(self, weights: Mapping[Name, sp.Expr]) -> None:
        """Refuse a part on which its weight is not normalised, for there the gradient of its formula is 0."""
        for name, expression in weights.items():
            points = self.points(name)
            kernel = compile(self.shape.replace(expression=expression), ("gradient",), backend="numpy")
            lengths = np.linalg.norm(kernel(*points.T)["gradient"], axis=1)
            if not (np.abs(lengths - 1) < UNIT).any():
                raise RsymError(
                    f"{_called(name)} has no slopes: the gradient of its formula is zero or undefined on it",
                    code="singular-part",
                    remedy="give it a formula that changes its sign with a slope, or values alone",
                )

    def require_agreement(self, data: Mapping[Name, sp.Expr], jumping: Sequence[Sequence[float]] = ()) -> None:
        """Refuse values of two parts that differ where these meet, letters at their defaults, but `jumping` points."""
        near = NEAR * float(np.diff(self.box, axis=1).max())
        for (one, f), (other, g) in combinations(data.items(), 2):
            if f == g:
                continue
            points, doubt = self.meeting(one, other)
            for corner in jumping:
                away = np.hypot(*(points - np.array(corner)).T) > near
                points, doubt = points[away], doubt[away]
            if not len(points):
                continue
            compared = _Compared(self.shape, f, g, self.box)
            if (k := compared.worst(points, doubt)) is not None:
                place = ", ".join(f"{value:.6g}" for value in points[k])
                both = compared.at(points[k : k + 1])[:, 0]
                first, second = ("what is undefined" if np.isnan(value) else f"{value:.10g}" for value in both)
                raise RsymError(
                    f"{_called(one)} and {_called(other)} meet at ({place}), where one is given {first}, the other "
                    f"{second}",
                    code="contradiction",
                    remedy="give data that agree where parts meet",
                )

    def weights(self, order: int, length: Any) -> Weights:
        """What weighs them, normalised to an order with a length: by default half the box, nearly."""
        unit = self._unit if length is None else positive(length, "the length", self.shape.letters)
        return Weights(self.shape, self.form, order, unit)

    def smooth_weights(self) -> Weights:
        """The same to the first order but near corners, where they are as smooth as leaves."""
        return Weights(self.shape, self.form, 1, self._unit, SOFT * float(self._unit))

    @property
    def _unit(self) -> sp.Integer:
        """The power of 2 next to half the box."""
        return sp.Integer(2) ** round(math.log2(float(np.diff(self.box, axis=1).max()) / 2))


def parts_of(shape: Shape, names: Iterable[Name]) -> Parts:
    """The parts of these names, ``...`` being the rest."""
    wanted = list(names)
    leaves: dict[Name, list[int]] = {name: [] for name in wanted}
    for leaf, name in enumerate(assigned(shape, wanted)):
        if name in leaves:
            leaves[name].append(leaf)
    there = {name: numbers for name, numbers in leaves.items() if numbers}
    return Parts(shape, there, shape_form(shape), bounds_or_extent(shape, None))


def _called(name: Name) -> str:
    return "the rest" if name is ... else f"the part {name!r}"


@dataclass(frozen=True)
class _Compared:
    """Two data on a shape."""

    shape: Shape
    one: sp.Expr
    other: sp.Expr
    box: Bounds

    def at(self, points: Floats) -> Floats:
        """Both at points (n, dim), NaN where undefined."""
        with np.errstate(all="ignore"):
            rows = np.array([kernel(*points.T)["value"] for kernel in self._kernels])
        return np.where(np.isfinite(rows), rows, np.nan)

    @cached_property
    def _kernels(self) -> list[Any]:
        return [compile(self.shape.replace(expression=data), backend="numpy") for data in (self.one, self.other)]

    @cached_property
    def _size(self) -> float:
        axes = np.meshgrid(*(np.linspace(low, high, LATTICE + 2)[1:-1] for low, high in self.box))
        sizes = np.abs(self.at(np.stack([axis.ravel() for axis in axes], axis=1)))
        return float(max((np.median(row[~np.isnan(row)]) for row in sizes if not np.isnan(row).all()), default=0.0))

    def worst(self, points: Floats, doubt: Floats) -> int | None:
        """Which of the points has the largest difference of those where it is too large, if any."""
        here = self._difference(points)
        side = float(np.diff(self.box, axis=1).max())
        around = np.array([self._difference(points + way * doubt[:, None]) for way in _ways(points.shape[1])])
        with np.errstate(invalid="ignore"):
            moved = np.nan_to_num(np.abs(around - here)).max(axis=0)
        size = np.maximum(np.nan_to_num(np.abs(self.at(points))).max(axis=0), self._size)
        excess = np.abs(here) - moved - AGREEMENT * size
        lost = np.isnan(here)
        if lost.any():
            beside = [np.abs(self._difference(points[lost] + ASIDE * side * way)) for way in _ways(points.shape[1])]
            nearest = np.nan_to_num(np.array(beside), nan=np.inf).min(axis=0)
            excess[lost] = nearest - LOOSELY * size[lost]  # undefined all about too, they are refused
        k = int(excess.argmax())
        return k if excess[k] > 0 else None

    def _difference(self, points: Floats) -> Floats:
        one, other = self.at(points)
        difference: Floats = one - other
        return difference


def _ways(dimension: int) -> Floats:
    return np.concatenate([np.eye(dimension), -np.eye(dimension)])


def formula(value: Any, shape: Shape, what: str) -> tuple[sp.Expr, Letters]:
    """A value as an expression in the coordinates of a shape, and the letters that it brings.

    Raises
    ------
    RsymError
        For a function, of which there is no formula, or a shape in other coordinates.
    """
    if isinstance(value, Equation):
        if [one.name for one in value.coordinates] != [one.name for one in shape.coordinates]:
            raise RsymError(
                f"{what} is a shape in {value.coordinates}, on one in {shape.coordinates}", code="coordinates"
            )
        return value.expression, value.letters
    if callable(value) and not isinstance(value, sp.Basic):
        raise RsymError(
            f"{what} is a function, of which there is no formula",
            code="formula",
            remedy="write it as an expression, such as sympy.sin(x) + y; solve takes functions too",
        )
    return number(value, what), Letters({})
