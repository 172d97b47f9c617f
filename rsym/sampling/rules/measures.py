"""Area or volume, length or surface, centroid and moments of a shape, from its equation."""

from __future__ import annotations

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
from rsym.sampling.rules.integrals import TOLERANCE
from rsym.sampling.rules.quadrature import ORDER, Quadrature, prepared
from rsym.sampling.rules.refinement import Integral, refined

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
    >>> print(rsym.measure(rsym.Shape(1 - x**2 / 4 - y**2, (x, y)).named("oval")))
    Area 6.28318530718, length 9.68844822055, estimated by two rules.
      centroid        0 ± 7e-16, 0 ± 4e-16
      second moments  xx 6.28318530718, xy 0 ± 3e-15, yy 1.57079632679
      oval            9.68844822055
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
        text = f"{size.capitalize()} {_told(self.content)}, {edge} {_told(self.boundary)}, estimated by two rules."
        moments = [
            f"{names[i]}{names[j]} {_told(self.second_moments[i][j])}"
            for i in range(self.dimension)
            for j in range(i, self.dimension)
        ]
        rows = [
            ("centroid", ", ".join(map(_told, self.centroid))),
            ("second moments", ", ".join(moments)),
            *((name, _told(value)) for name, value in self.parts.items()),
        ]
        data = {
            "content": float(self.content),
            "boundary": float(self.boundary),
            "parts": {name: float(value) for name, value in self.parts.items()},
            "centroid": [float(value) for value in self.centroid],
            "second_moments": [[float(value) for value in row] for row in self.second_moments],
            "errors": {"content": self.content.error, "boundary": self.boundary.error},
        }
        return Document("measure", Sentence(text, False), tables=(Tabular(("", ""), tuple(rows)),), data=data)


def _told(value: Integral) -> str:
    return measured(float(value), value.error)


def measure(
    shape: Shape,
    *,
    tolerance: float = TOLERANCE,
    cells: int | None = None,
    order: int = ORDER,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    threads: int | None = None,
) -> MeasureReport:
    """Area or volume, length or surface, whole and by part, centroid and second moments of a shape.

    They are integrals by `quadrature`, so of the equation and not of facets; errors and parameters as in `integrate`.

    Examples
    --------
    >>> import math, rsym
    >>> found = rsym.measure(rsym.torus(2, 0.5))
    >>> round(found.volume / math.pi**2, 12), round(found.surface / math.pi**2, 12)
    (1.0, 4.0)
    """
    made = prepared(shape, bounds, letters)
    names = tuple(dict.fromkeys(made.parts))
    rows = [(i, j) for i in range(shape.dimension) for j in range(i, shape.dimension)]

    def quantities(rule: Quadrature) -> tuple[Floats, Floats]:
        content, boundary = rule.weights.sum(), rule.boundary.weights.sum()
        parts = [rule.boundary.of(name).weights.sum() for name in names]
        centroid = (rule.weights[:, None] * rule.points).sum(axis=0) / content
        away = rule.points - centroid
        moments = [(rule.weights * away[:, i] * away[:, j]).sum() for i, j in rows]
        reach = float(np.abs(np.array(made.box)).max())
        spread = float((rule.weights * (away**2).sum(axis=1)).sum())
        lost = rule.unresolved ** (1 - 1 / shape.dimension)
        values = np.array([content, boundary, *parts, *centroid, *moments])
        edges, middles = [boundary + lost] * (1 + len(names)), [reach] * shape.dimension
        return values, np.array([content + rule.unresolved, *edges, *middles, *[spread] * len(rows)])

    found = refined(made, quantities, tolerance=tolerance, cells=cells, order=order, threads=threads)
    first = 2 + len(names)
    lengths = {name: found.integral(2 + k) for k, name in enumerate(names) if found.values[2 + k] > 0}
    pairs = {pair: found.integral(first + shape.dimension + k) for k, pair in enumerate(rows)}
    axes = range(shape.dimension)
    return MeasureReport(
        tuple(symbol.name for symbol in shape.coordinates),
        found.integral(0),
        found.integral(1),
        lengths,
        tuple(found.integral(first + k) for k in axes),
        tuple(tuple(pairs[min(i, j), max(i, j)] for j in axes) for i in axes),
        found.cells,
        found.rule.order,
    )
