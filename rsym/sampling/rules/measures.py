"""Area or volume, length or surface, centroid and moments of a shape, from its equation."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.reports.document import Document, Sentence, Tabular
from rsym.reports.numbers import measured
from rsym.reports.render import Report
from rsym.sampling.labels import labels_of
from rsym.sampling.rules.deadlines import deadline
from rsym.sampling.rules.portions import RulePortion
from rsym.sampling.rules.quadrature import ORDER, prepared
from rsym.sampling.rules.refinement import ROUNDING, Integral, Refined, Sums, boundary_rounding, refined

NOTHING = 1e-9  # of a boundary, a part that is none but for rounding
WORDS = {2: ("area", "length"), 3: ("volume", "surface")}


@dataclass(frozen=True, eq=False, repr=False)
class MeasureReport(Report):
    """What a shape measures; every number is an `Integral`, a float with `.error`, an estimate.

    Attributes
    ----------
    coordinates : tuple of str
        Their names.
    content, boundary : Integral
        Area and length, or volume and surface; so called too.
    parts : {name: Integral}
        The length or surface of each part that there is of the boundary.
    centroid : tuple of Integral
        Of the inside.
    second_moments : tuple of tuples of Integral
        About the centroid, M_ij = integral of (x_i - c_i)(x_j - c_j).
    cells, order : int
        Of the finer rule.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> print(rsym.measure(rsym.Shape(rsym.conjunction(x, y, 1 - x - y), (x, y))))
    Area 0.5, length 3.41421356237, estimated by two rules.
                      value
      centroid        0.333333333333, 0.333333333333
      second moments  xx 0.0277777777778, xy -0.0138888888889, yy 0.0277777777778
      x               1
      y               1
      -x - y + 1      1.41421356237
    """

    coordinates: tuple[str, ...]
    content: Integral
    boundary: Integral
    parts: Mapping[str, Integral]
    centroid: tuple[Integral, ...]
    second_moments: tuple[tuple[Integral, ...], ...]
    cells: int
    order: int

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return len(self.coordinates)

    @property
    def area(self) -> Integral:
        """Of a shape in the plane."""
        return self._of(2, self.content, "area", "surface")

    @property
    def length(self) -> Integral:
        """Of the boundary in the plane."""
        return self._of(2, self.boundary, "length", "surface")

    @property
    def volume(self) -> Integral:
        """Of a shape in space."""
        return self._of(3, self.content, "volume", "area")

    @property
    def surface(self) -> Integral:
        """The area of the boundary in space."""
        return self._of(3, self.boundary, "surface", "length")

    @property
    def inertia(self) -> Floats:
        """About the centroid, of density 1: the tensor trace(M) 1 - M in space, ((Ix, -Ixy), (-Ixy, Iy)) in the plane.

        In the plane Ix = integral of (y - c_y)**2, and the polar moment is the trace.
        """
        moments = np.array([[float(entry) for entry in row] for row in self.second_moments])
        found: Floats = np.trace(moments) * np.eye(self.dimension) - moments
        return found

    def _of(self, dimension: int, value: Integral, name: str, other: str) -> Integral:
        if dimension != self.dimension:
            where = "space" if self.dimension == 3 else "the plane"
            raise RsymError(f"a shape in {where} has no {name}", code="arity", remedy=f"ask for its {other}")
        return value

    def __repr__(self) -> str:
        size, edge = WORDS[self.dimension]
        return f"<MeasureReport: {size} {self.content}, {edge} {self.boundary}>"

    def document(self) -> Document:
        """Measures with the digits that are known."""
        size, edge = WORDS[self.dimension]
        names = self.coordinates
        content, boundary = (_told_size(value, value) for value in (self.content, self.boundary))
        text = f"{size.capitalize()} {content}, {edge} {boundary}, estimated by two rules."
        moments = [
            f"{names[i]}{names[j]} {_told(self.second_moments[i][j])}"
            for i in range(self.dimension)
            for j in range(i, self.dimension)
        ]
        rows = [
            ("centroid", ", ".join(map(_told, self.centroid))),
            ("second moments", ", ".join(moments)),
            *((name, _told_size(value, self.boundary)) for name, value in self.parts.items()),
        ]
        data = {
            "content": float(self.content),
            "boundary": float(self.boundary),
            "parts": {name: float(value) for name, value in self.parts.items()},
            "centroid": [float(value) for value in self.centroid],
            "second_moments": [[float(value) for value in row] for row in self.second_moments],
            "errors": {"content": self.content.error, "boundary": self.boundary.error},
        }
        return Document("measure", Sentence(text, False), tables=(Tabular(("", "value"), tuple(rows)),), data=data)


def _told(value: Integral) -> str:
    return measured(float(value), value.error) if math.isfinite(value.error) else "unknown"


def _told_size(value: Integral, whole: Integral) -> str:
    """A size, which is not negative: unknown where it is off by more than it is, but for rounding."""
    return "unknown" if 0 < value.error >= max(float(value), NOTHING * whole) else _told(value)


class _MoreNames(Exception):
    """Faces coincide whose names were not known together."""

    def __init__(self, names: list[str]) -> None:
        self.names = names


def measure(
    shape: Shape,
    *,
    tolerance: float | None = None,
    cells: int | None = None,
    order: int = ORDER,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    threads: int | None = None,
    timeout: float | None = None,
) -> MeasureReport:
    """Area or volume, length or surface, whole and by part, centroid and second moments of a shape.

    They are integrals by `quadrature`, so of the equation and not of facets; errors and parameters as in `integrate`.
    After a `timeout` in seconds what is known by then is returned, at least what boxes tell of the inside, with an
    infinite error where that is nothing; the report says unknown of what is off by more than it is.

    Examples
    --------
    >>> import math, rsym
    >>> found = rsym.measure(rsym.sphere(3))
    >>> round(found.volume / math.pi, 12), round(found.surface / math.pi, 12)
    (36.0, 36.0)
    """
    until = deadline(timeout)
    made = prepared(shape, bounds, letters)
    names = list(labels_of((), made.parts).names)
    dimension = shape.dimension
    rows = [(i, j) for i in range(dimension) for j in range(i, dimension)]
    middle = np.array([[low / 2 + high / 2] for low, high in made.box])

    def quantities(portion: RulePortion) -> Sums:
        rule, lost = portion.rule, portion.unresolved
        away = rule.points - middle
        labels = made.labels(rule)
        if more := [name for name in labels.names if name not in names]:
            raise _MoreNames(more)
        columns = np.array([*map(names.index, labels.names)], np.int64)
        parts = np.bincount(columns[labels.number], rule.edge_weights, len(names))
        moments = [rule.weights @ (away[i] * away[j]) for i, j in rows]
        values = np.array([rule.weights.sum(), parts.sum(), *parts, *(away @ rule.weights), *moments])
        reach = float(np.abs(away).max(initial=0.0))

        def like(content: float, boundary: float, shared: float = 0.0) -> Floats:
            edges = boundary, *[boundary + shared] * len(names)
            first, second = [reach * content] * dimension, [reach**2 * content]
            return np.array([content, *edges, *first, *second * len(rows)])

        rounding = made.resolution * values[1], boundary_rounding(made, values[1]), lost.shared
        return Sums(values, like(values[0], values[1]), like(lost.content, lost.boundary), like(*rounding))

    while True:
        try:
            found = refined(
                made, quantities, tolerance=tolerance, cells=cells, order=order, threads=threads, until=until
            )
            break
        except _MoreNames as met:  # added up again from the start, in a column of their own
            names.extend(met.names)
    first = 2 + len(names)
    lengths = {name: found.integral(2 + k) for k, name in enumerate(names) if found.found.values[2 + k] > 0}
    centre, pairs = _central(found, first, rows, middle.ravel())
    axes = range(dimension)
    return MeasureReport(
        tuple(symbol.name for symbol in shape.coordinates),
        found.integral(0),
        found.integral(1),
        lengths,
        centre,
        tuple(tuple(pairs[min(i, j), max(i, j)] for j in axes) for i in axes),
        found.cells,
        found.order,
    )


def _central(
    found: Refined, first: int, rows: list[tuple[int, int]], middle: Floats
) -> tuple[tuple[Integral, ...], dict[tuple[int, int], Integral]]:
    """Centroid and second moments about it, from sums about the middle of the box."""
    values, errors, dimension = found.found.values, found.errors, len(middle)
    content, off = values[0], errors[0]
    with np.errstate(invalid="ignore", divide="ignore"):  # of nothing there is no centroid
        away = values[first : first + dimension] / content
        astray = (errors[first : first + dimension] + np.abs(away) * off) / max(content - off, 0.0)
    rounded = ROUNDING * np.abs(middle)
    centre = tuple(map(Integral, (middle + away).tolist(), (astray + rounded).tolist()))
    second = {}
    for k, (i, j) in enumerate(rows, first + dimension):
        most, known = (abs(away[i]) + astray[i]) * (abs(away[j]) + astray[j]), abs(away[i] * away[j])
        error = errors[k] + off * most + content * (most - known)
        second[i, j] = Integral(float(values[k] - content * away[i] * away[j]), float(error))
    return centre, second
