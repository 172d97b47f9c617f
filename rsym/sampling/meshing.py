"""Meshes of omega = 0: the public function and its methods."""

from __future__ import annotations

import logging
import sys
import time
import warnings
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from importlib.util import find_spec
from typing import Any

from rsym.errors import RsymError, RsymWarning
from rsym.model.shape import Shape
from rsym.sampling.lattice import bounds_of, check_in_space, lattice_over
from rsym.sampling.mesh import Mesh
from rsym.sampling.progress import Progress
from rsym.sampling.smooth import smooth_mesh

logger = logging.getLogger(__name__)


def mesh(
    shape: Shape,
    resolution: int | Sequence[int] = 128,
    *,
    method: str = "sharp",
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    cap: bool = True,
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
    method : {"sharp", "smooth"}
        "sharp": adaptive, closed, exact edges and corners where two or three leaves of the sign form meet.
        "smooth": marching cubes on samples of omega, every crossing recomputed in float64; the reference. Without
        the package numba "smooth" takes the place of "sharp".
    bounds, letters
        Override those of the shape.
    cap : bool
        Whether a surface that leaves the bounds is closed there by flat caps; "smooth" leaves it open. ``.status``
        says where it leaves them.
    executor : concurrent.futures.Executor, optional
        Where pieces of the lattice are computed: threads, processes, or a cluster by
        ``dask.distributed.Client(...).get_executor()``; by default here, in threads. The bits do not depend on it.
    progress : callable, optional
        ``progress(done, total)`` after each step of the work; returning False cancels with an RsymError, and nothing
        of the mesh is kept.

    Returns
    -------
    Mesh
        ``vertices`` (n, 3), ``faces`` (m, 3), ``normals`` (m, 3, 3), ``status``.

    Raises
    ------
    RsymError
        For a plane shape, no bounds, an undefined value, a surface that does not meet the bounds, more memory than
        is free (the remedy names a resolution that fits), a worker that died, or a cancel.

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
    start = time.perf_counter()
    if method == "sharp" and find_spec("numba") is None:
        warnings.warn("without the package numba edges are not sharp: pip install numba", RsymWarning, stacklevel=2)
        method = "smooth"
    if method == "sharp":
        if "rsym.sampling.mesher" not in sys.modules:
            _compile_ahead(shape)
        from rsym.sampling.mesher import Mesher

        result = Mesher(shape)(
            resolution, bounds=bounds, letters=letters, cap=cap, executor=executor, progress=progress
        )
    elif method == "smooth":
        check_in_space(shape)
        result = smooth_mesh(shape, lattice_over(bounds_of(shape, bounds), resolution), letters, executor, progress)
    else:
        raise RsymError(f"no method {method!r}", code="unknown-method", remedy="choose from sharp, smooth")
    elapsed = time.perf_counter() - start
    if logger.isEnabledFor(logging.INFO):
        logger.info("mesh in %.2f s: %s", elapsed, result.status)
    for remark in result.findings.remarks:
        warnings.warn(remark, RsymWarning, stacklevel=2)
    return result


def _compile_ahead(shape: Shape) -> None:
    """Start the compiler: it takes as long as importing the mesher, numba above all."""
    from rsym.codegen.sign_form import surface_form
    from rsym.codegen.surface_kernels import compile_ahead

    check_in_space(shape)
    compile_ahead(surface_form(shape).capped())
