"""R-systems side by side: one logic in several systems, what each promises and what it costs."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.analysis.contracts.display import normalisation, smoothness
from rsym.analysis.contracts.promises import Order
from rsym.backends.kernel import compile
from rsym.errors import RsymError, RsymWarning
from rsym.language.functions import written_system
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.systems import R0, R1, R0m, Rp, RSystem
from rsym.program.fields import program_of
from rsym.reports.document import Document, Sentence, Tabular
from rsym.reports.render import Report
from rsym.sampling.boundaries import boundary
from rsym.sampling.meshing import mesh
from rsym.sampling.progress import Progress, report
from rsym.sampling.triangles import middles
from rsym.sampling.windows import bounds_or_extent

SYSTEMS: tuple[RSystem, ...] = (R0, R1, Rp(4), R0m(2))
HEADING = (
    "system",
    "omega is",
    "normalisation",
    "singular sets",
    "operations",
    "with gradient",
    "| |grad| - 1 | found",
)
NOTE = "  class and order are promised by the formula; the slope on the boundary, off corners, is measured"
RESOLUTION = 32  # of the mesh on which slopes are taken in space
STEPS = 8  # of Newton's method from a triangle to the surface
NEAR = 1e-9  # |omega|/|grad omega| over the extent: the point lies on the boundary
_INPUTS = ("const", "input")


@dataclass(frozen=True)
class SystemRow:
    """One shape in one R-system: what its contract promises, what it costs, and its slope on the boundary.

    continuity : k, omega is of class C^k at least; infinity for analytic
    order : the order to which omega is normalised; None where it is not shown
    corners : how many singular sets the formula has
    operations, gradient_operations : of the program of omega, and of omega with its gradient
    slope_error : the largest | |grad omega| - 1 | found on the boundary off its corners; NaN without a boundary

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> quadrant = rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=((-1, 1), (-1, 1)))
    >>> (row,) = rsym.compare_systems(quadrant, systems=(rsym.R0,)).rows
    >>> row.name, row.order, row.operations, row.slope_error < 1e-6
    ('R0', 1, 1, True)
    """

    name: str
    system: RSystem
    continuity: float
    order: Order
    corners: int
    operations: int
    gradient_operations: int
    slope_error: float

    def cells(self) -> tuple[str, ...]:
        """The row as text."""
        error = "no boundary" if math.isnan(self.slope_error) else f"{self.slope_error:.2g}"
        counts = (str(self.corners), str(self.operations), str(self.gradient_operations))
        return self.name, smoothness(self.continuity), normalisation(self.order), *counts, error


@dataclass(frozen=True, repr=False)
class SystemTable(Report):
    r"""R-systems in the order given, one row each.

    Class and order are promised by the contract; the slope is measured, at points of the boundary.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> quadrant = rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=((-1, 1), (-1, 1)))
    >>> found = rsym.compare_systems(quadrant, systems=(rsym.R0, rsym.Rp(4)))
    >>> print("\n".join(line[:44].rstrip() for line in str(found).splitlines()[:3]))
      system  omega is    normalisation
      R0      continuous  normalised to order 1
      Rp 4    continuous  normalised to order 3
    """

    rows: tuple[SystemRow, ...]

    def __repr__(self) -> str:
        return f"<SystemTable of {', '.join(row.name for row in self.rows)}>"

    def document(self) -> Document:
        """The table; for programs null says infinity of a class, and of a slope that there is no boundary."""
        rows = [
            {
                "system": row.name,
                "continuity": row.continuity,
                "order": row.order,
                "exact_distance": row.order == math.inf,
                "singular_sets": row.corners,
                "operations": row.operations,
                "gradient_operations": row.gradient_operations,
                "slope_error": row.slope_error,
            }
            for row in self.rows
        ]
        return Document(
            "system-table",
            Sentence("", True),
            tables=(Tabular(HEADING, tuple(row.cells() for row in self.rows)),),
            remarks=(Sentence(NOTE, False),),
            data={"systems": rows},
        )


def compare_systems(
    shape: Shape,
    systems: Iterable[RSystem] = SYSTEMS,
    *,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    progress: Progress | None = None,
) -> SystemTable:
    """The logic of one shape in several R-systems side by side.

    Each row is ``shape.with_system(system)``: the class and the order of normalisation that its contract promises, the
    operations of its program, and the largest | |grad omega| - 1 | on the boundary, off corners.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    systems : iterable of R-systems
        By default ``R0, R1, Rp(4), R0m(2)``.
    bounds : pairs, optional
        By default those of the shape, or of its boundary.
    letters : mapping, optional
        The values of letters, that of a parameter of a system among them.
    progress : callable, optional
        ``progress(done, total)`` of systems; an answer of False cancels.

    Raises
    ------
    RsymError
        For what is no shape or no R-system, without systems, and as `with_system` and `extent`.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> quadrant = rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=((-1, 1), (-1, 1)))
    >>> [(row.name, row.continuity, row.order) for row in rsym.compare_systems(quadrant).rows]
    [('R0', 0, 1), ('R1', 0, inf), ('Rp 4', 0, 3), ('R0m 2', 2, 0)]
    """
    require_shape(shape)
    if isinstance(systems, RSystem | str) or not isinstance(systems, Iterable):
        raise _no_systems(systems)
    chosen = tuple(systems)
    if not chosen:
        raise _no_systems(systems)
    given = {str(name): value for name, value in (letters or {}).items()}
    own = {name: value for name, value in given.items() if name in shape.letters}
    added = {name: value for name, value in given.items() if name not in shape.letters}
    changed = shape.with_letters(own)
    moved = [changed.with_system(system, letters=_needed(system, added)) for system in chosen]
    box = bounds_or_extent(changed, bounds)
    rows = []
    for done, (system, one) in enumerate(zip(chosen, moved, strict=True)):
        report(progress, done, len(chosen))
        promised = one.contract()
        small, large = _count(one, ("value",)), _count(one, ("value", "gradient"))
        error = boundary(one, box).deviation if one.dimension == 2 else _error_in_space(one, box)
        title, corners = written_system(system), len(promised.singular)
        rows.append(SystemRow(title, system, promised.continuity, promised.order, corners, small, large, error))
    report(progress, len(chosen), len(chosen))
    return SystemTable(tuple(rows))


def _no_systems(systems: Any) -> RsymError:
    return RsymError(f"expected several R-systems, got {systems!r}", code="system", remedy="systems=(R0, Rp(4))")


def _needed(system: Any, letters: Mapping[str, Any]) -> dict[str, Any]:
    symbols = {str(symbol) for parameter in getattr(system, "parameters", ()) for symbol in parameter.free_symbols}
    return {name: value for name, value in letters.items() if name in symbols}


def _count(shape: Shape, fields: tuple[str, ...]) -> int:
    return sum(node.operation not in _INPUTS for node in program_of(shape, fields).nodes)


def _error_in_space(shape: Shape, bounds: Any) -> float:
    """At the middles of triangles, moved onto the surface along the gradient."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)  # what a coarse mesh misses is not asked here
        surface = mesh(shape, RESOLUTION, bounds=bounds, cap=False)
    points = middles(surface.vertices, surface.faces)
    kernel = compile(shape, ("value", "gradient"))
    reach = NEAR * max(high - low for low, high in bounds)
    with np.errstate(all="ignore"):
        for _ in range(STEPS):
            found = kernel(*points.T)
            value, gradient = found["value"], found["gradient"]
            points = points - (value / np.einsum("ij,ij->i", gradient, gradient))[:, None] * gradient
        slope = np.linalg.norm(gradient, axis=1)
        known = slope[np.isfinite(slope) & (np.abs(value) <= reach * slope)]
    return float(np.abs(known - 1).max()) if len(known) else math.nan
