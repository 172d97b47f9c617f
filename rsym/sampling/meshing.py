"""Meshes of omega = 0: the public function and its methods."""

from __future__ import annotations

import logging
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from typing import Any, TypeAlias

from rsym.errors import RsymError, RsymWarning
from rsym.model.shape import Shape
from rsym.sampling.lattice import Lattice, bounds_of, lattice_over
from rsym.sampling.mesh import Mesh
from rsym.sampling.progress import Progress
from rsym.sampling.smooth import smooth_mesh

Mesher: TypeAlias = Callable[[Shape, Lattice, Mapping[Any, float] | None, Executor | None, Progress | None], Mesh]

logger = logging.getLogger(__name__)

# Another method is one more line here and one module beside `smooth`.
METHODS: dict[str, Mesher] = {"smooth": smooth_mesh}


def mesh(
    shape: Shape,
    resolution: int | Sequence[int] = 128,
    *,
    method: str = "smooth",
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> Mesh:
    """The surface omega = 0 of a shape in space as triangles, outward orientation.

    Parameters
    ----------
    shape : Shape
        A shape in space; revolve a plane one first.
    resolution : int or three ints
        Cubical cells along the longest side, or cells along each axis.
    method : {"smooth"}
        Marching cubes on samples, every crossing recomputed in float64 on omega.
    bounds, letters
        Override those of the shape. The surface is cut where it leaves the bounds, and ``.status`` says so.
    executor : concurrent.futures.Executor, optional
        Where slabs of samples are computed; by default here, in threads.
    progress : callable, optional
        ``progress(done, total)`` after each slab of samples and each stage of the work on vertices;
        returning False cancels with an RsymError, and nothing of the mesh is kept.

    Returns
    -------
    Mesh
        ``vertices`` (n, 3), ``faces`` (m, 3), ``normals`` (m, 3, 3), ``status``.

    Raises
    ------
    RsymError
        For a plane shape, no bounds, an undefined value, a surface that does not meet the bounds, or a cancel.

    Warns
    -----
    RsymWarning
        For a surface that the bounds clip, samples exactly on it, walls and gaps thinner than a cell, and
        pieces of less than three cells. ``.status`` keeps the facts.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.2, 1.2),) * 3)
    >>> result = rsym.mesh(ball, 48)
    >>> result.status.closed, round(result.status.volume, 2)
    (True, 4.18)
    """
    if shape.dimension != 3:
        raise RsymError(
            "mesh needs a shape in space, got one in the plane", code="dimension", remedy="use revolve(shape) first"
        )
    if method not in METHODS:
        raise RsymError(f"no method {method!r}", code="unknown-method", remedy=f"choose from {', '.join(METHODS)}")
    lattice = lattice_over(bounds_of(shape, bounds), resolution)
    start = time.perf_counter()
    result = METHODS[method](shape, lattice, letters, executor, progress)
    elapsed = time.perf_counter() - start
    if logger.isEnabledFor(logging.INFO):
        logger.info("mesh on %s samples in %.2f s: %s", lattice.counts, elapsed, result.status)
    for remark in result.findings.remarks:
        warnings.warn(remark, RsymWarning, stacklevel=2)
    return result
