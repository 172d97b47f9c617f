"""Fields on meshes of their shapes, for other programs: what is known at each point, by name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np

from rsym.arrays import Floats
from rsym.errors import warn
from rsym.model.shape import Bounds, Shape
from rsym.problems.elastic.result import ElasticSolution, PlaneTensor
from rsym.problems.solution import Solution
from rsym.problems.spectra import Spectrum
from rsym.problems.splines.web import WebSplines
from rsym.problems.torsion import Torsion
from rsym.sampling.fillings import Filling, filling

Field: TypeAlias = Solution | ElasticSolution | Spectrum | Torsion
FIELDS = (Solution, ElasticSolution, Spectrum, Torsion)
# Cells along the longest side, by dimension.
RESOLUTIONS = {2: 160, 3: 32}
MOST_LOST = 0.03  # of the area or volume: chords lose less


def field_mesh(field: Field, resolution: int | Sequence[int] | None = None) -> tuple[Filling, dict[str, Floats]]:
    """The inside of a shape in cells, and a field at their points; nothing is beside the shape.

    Of a solution there are ``u`` (n,) and ``gradient`` (n, 3), of a spectrum ``mode_1`` (n,) and so on, of a shaft
    Prandtl's function ``u`` and the shear ``stress`` (n, 3), of an elastic body ``displacement`` (n, 3), ``stress``
    (n, 6) in the order of VTK, xx, yy, zz, xy, yz, xz, and ``von_mises`` (n,). What is infinite at a corner is NaN.
    Warned of are cells that have another area or volume than the shape.

    Examples
    --------
    >>> import rsym
    >>> cells, data = field_mesh(rsym.solve(rsym.disc(1), "-laplacian(u) = 1", 0, cells=8), 40)
    >>> {name: values.shape[1:] for name, values in data.items()}, len(data["u"]) == len(cells.points)
    ({'u': (), 'gradient': (3,)}, True)
    """
    first = solved_first(field)
    shape: Shape = first.shape
    made = filling(shape, _box(first.splines), RESOLUTIONS[shape.dimension] if resolution is None else resolution)
    lost = 1 - float(made.sizes.sum()) / float(first.rule.weights.sum())
    if abs(lost) > MOST_LOST:
        warn(
            f"the cells have {abs(lost):.0%} {'less' if lost > 0 else 'more'} than the shape, something of which is "
            "smaller than a cell; remedy: a larger resolution="
        )
    with np.errstate(all="ignore"):
        found = _data(field, made.points)
    return made, {name: np.where(np.isfinite(values), values, np.nan) for name, values in found.items()}


def solved_first(field: Field) -> Solution | ElasticSolution:
    """What knows the shape and the grid of splines."""
    if isinstance(field, Spectrum):
        return field.modes[0]
    return field.solution if isinstance(field, Torsion) else field


def _box(splines: WebSplines) -> Bounds:
    """The bounds of a grid."""
    return tuple(zip(splines.lower.tolist(), (splines.lower + splines.size * splines.counts).tolist(), strict=True))


def _data(field: Field, points: Floats) -> dict[str, Floats]:
    if isinstance(field, Spectrum):
        return {f"mode_{number}": mode.jets(points, 0)[0] for number, mode in enumerate(field.modes, 1)}
    if isinstance(field, Torsion):
        value, right, up = field.solution.jets(points, 1)
        return {"u": value, "stress": _vectors(up, -right)}
    if isinstance(field, Solution):
        found = field.jets(points, 1)
        return {"u": found[0], "gradient": _vectors(*found[1:])}
    xx, yy, xy, zz = stress = PlaneTensor(*field.stresses(points))
    nothing = np.zeros_like(xx)
    return {
        "displacement": _vectors(*field.jets(points)[:, 0]),
        "stress": np.stack([xx, yy, zz, xy, nothing, nothing], axis=1),
        "von_mises": stress.von_mises,
    }


def _vectors(*components: Any) -> Floats:
    """Vectors (n, 3) in space of components (n,) in the plane, or in space."""
    found = np.zeros((len(components[0]), 3))
    found[:, : len(components)] = np.stack(components, axis=1)
    return found
