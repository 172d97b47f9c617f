"""Curvatures of a surface at points on it or near it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.codegen.fields import surface_program
from rsym.codegen.kernel import Kernel, compile_program
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.sampling.mesh import Mesh

Floats = NDArray[np.float64]

CURVATURES = ("mean_curvature", "gaussian_curvature", "principal_curvatures", "principal_directions")


def vertex_curvatures(mesh: Mesh, shape: Shape, *, letters: Mapping[Any, float] | None = None) -> dict[str, Floats]:
    """The exact curvatures at the vertices of a mesh, from the equation and not from the triangles.

    Parameters
    ----------
    mesh : Mesh
        A mesh of the shape.
    shape, letters
        What the mesh was made of.

    Returns
    -------
    dict
        ``mean_curvature`` (n,), ``gaussian_curvature`` (n,), ``principal_curvatures`` (n, 2), the larger first,
        ``principal_directions`` (n, 2, 3), unit vectors; NaN where the equation has no second derivatives, as on edges.

    Raises
    ------
    RsymError
        For a shape in the plane.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(4 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2.2, 2.2),) * 3)
    >>> curvatures = rsym.vertex_curvatures(rsym.mesh(ball, 8), ball)
    >>> bool(abs(curvatures["principal_curvatures"] - 0.5).max() < 1e-12)
    True
    """
    found = NearSurface(shape, CURVATURES, letters).kernel(*mesh.vertices.T, letters=letters)
    return {name: found[name] for name in CURVATURES}


@dataclass(frozen=True)
class NearSurface:
    """Fields of a shape in space at points near its surface, moved onto it first."""

    shape: Shape
    fields: Sequence[str]
    letters: Mapping[Any, float] | None = None

    def __post_init__(self) -> None:
        if self.shape.dimension != 3:
            raise RsymError(
                "a surface needs a shape in space, got one in the plane",
                code="dimension",
                remedy="use revolve(shape) first",
            )

    @cached_property
    def kernel(self) -> Kernel:
        """The fields with value and gradient."""
        names = tuple(dict.fromkeys(("value", "gradient", *self.fields)))
        return compile_program(surface_program(self.shape, names), names, self.shape)

    def at(self, points: Floats, reach: float) -> dict[str, Floats]:
        """The fields at points (n, 3) after one Newton step, which must not be longer than `reach`.

        A step takes a point of a triangle from the square of the triangle's size to its fourth power.
        """
        found = self.kernel(*points.T, letters=self.letters)
        with np.errstate(all="ignore"):
            squared = np.einsum("ij,ij->i", found["gradient"], found["gradient"])
            step = (found["value"] / squared)[:, None] * found["gradient"]
            short = np.einsum("ij,ij->i", step, step) <= reach**2
        return self.kernel(*np.where(short[:, None], points - step, points).T, letters=self.letters)
