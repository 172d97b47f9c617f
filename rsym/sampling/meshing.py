"""Meshes of omega = 0: the public function and its methods."""

from __future__ import annotations

import logging
import math
import os
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import lru_cache, partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar, overload

from rsym.atomic import target_of, writing
from rsym.errors import RsymError, warn
from rsym.garbage import uncollected
from rsym.logic.lifting import opened
from rsym.logic.sign_form import surface_form
from rsym.model.requirements import file_path, require_shape
from rsym.model.shape import Shape
from rsym.sampling.lattice import check_in_space, lattice_over
from rsym.sampling.memory import Demand
from rsym.sampling.mesh import Mesh, MeshRequest
from rsym.sampling.mesh_file import SUFFIXES, MeshFile
from rsym.sampling.progress import Progress
from rsym.sampling.smooth import smooth_mesh
from rsym.sampling.undefined import warn_undefined
from rsym.sampling.windows import bounds_or_extent

if TYPE_CHECKING:
    from rsym.sampling.mesher import SharpMesher

# Of method "smooth", measured on the car at 400 cells: three arrays of samples, and what the crossings take.
SAMPLES = Demand(memory=16.0, time=2e-7)

# The resolution that is looked for: cells along the longest side at first and at most, and the least that is worth a
# second mesh.
AUTOMATIC = "auto"
FIRST, MOST, LEAST_STEP = 128, 512, 1.25

logger = logging.getLogger(__name__)


@overload
def mesh(
    shape: Shape,
    resolution: int | Sequence[int] | str = ...,
    *,
    method: str = ...,
    bounds: Any = ...,
    letters: Mapping[Any, float] | None = ...,
    cap: bool = ...,
    executor: Executor | None = ...,
    progress: Progress | None = ...,
    force: bool = ...,
    into: None = ...,
    memory: float | str | None = ...,
    backend: str | None = ...,
) -> Mesh: ...


@overload
def mesh(
    shape: Shape,
    resolution: int | Sequence[int] | str = ...,
    *,
    method: str = ...,
    bounds: Any = ...,
    letters: Mapping[Any, float] | None = ...,
    cap: bool = ...,
    executor: Executor | None = ...,
    progress: Progress | None = ...,
    force: bool = ...,
    into: str | os.PathLike[str],
    memory: float | str | None = ...,
    backend: str | None = ...,
) -> MeshFile: ...


def mesh(
    shape: Shape,
    resolution: int | Sequence[int] | str = 128,
    *,
    method: str = "sharp",
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    cap: bool = True,
    executor: Executor | None = None,
    progress: Progress | None = None,
    force: bool = False,
    into: str | os.PathLike[str] | None = None,
    memory: float | str | None = None,
    backend: str | None = None,
) -> Mesh | MeshFile:
    """The surface omega = 0 of a shape in space as triangles, outward orientation.

    Parameters
    ----------
    shape : Shape
        A shape in space; revolve a plane one first.
    resolution : int, three ints or "auto"
        Cubical cells along the longest side, or cells along each axis. "auto": 128, and more where the mesh says that
        more would resolve something, up to 512 or to what the memory holds; ``.status.resolution`` tells how many, and
        what stays unresolved is told as ever.
    method : {"sharp", "smooth"}
        "sharp": adaptive, closed, exact edges and corners where two or three leaves of the sign form meet.
        "smooth": marching cubes on samples of omega, every crossing recomputed in float64; the reference, which does
        not look for what is thinner than a cell. Without the package numba "smooth" takes the place of "sharp".
    bounds, letters
        Override those of the shape. Without any bounds a box that provably holds the surface is found.
    cap : bool
        Whether a surface that leaves the bounds is closed there by flat caps; "smooth" leaves it open. ``.status``
        says where it leaves them.
    executor : concurrent.futures.Executor, optional
        Where pieces of the lattice are computed: threads, processes, or a cluster by
        ``dask.distributed.Client(...).get_executor()``; by default here, in threads. The bits do not depend on it.
    progress : callable, optional
        ``progress(done, total)`` after each step of the work; returning False cancels with an RsymError, and nothing
        of the mesh is kept.
    force : bool
        Whether to go on where the estimate says that there is not memory enough.
    into : path, optional
        Write the triangles to this file, ``.ply`` or ``.stl``, in pieces, so that they are never in memory as a whole:
        the same bytes as `rsym.write` of the mesh. The file appears whole or not at all. Until then the pieces that
        are done lie beside it in the folder ``NAME.parts``, up to the size of the file itself, and whoever asks for
        the same mesh again after a cancel or a kill goes on from there. Method "sharp", with caps, without an executor.
    memory : number of bytes or text, optional
        With `into`, what the process may take at its peak, as ``"2GB"``; by default what is free.
    backend : {"llvm", "tape"}, optional
        How "sharp" evaluates the shape; see `Mesher`.

    Returns
    -------
    Mesh, or MeshFile with `into`
        ``vertices`` (n, 3), ``faces`` (m, 3), ``normals`` (m, 3, 3), ``status``; in a file, ``path`` and ``status``.

    Raises
    ------
    RsymError
        For a plane shape, a surface that goes on without bounds, an undefined value, a surface that does not meet the
        bounds, more memory than there is, a worker that died, or a cancel.

    Warns
    -----
    RsymWarning
        Once, for a surface that the bounds clip, samples exactly on it, walls and gaps thinner than a cell, and
        pieces of less than three cells: in brief. ``.status`` keeps the facts, ``.status.remarks`` tells each. Once
        where omega has no value in some of the bounds: there the parts that have one decide.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.2, 1.2),) * 3)
    >>> result = rsym.mesh(ball, 48)
    >>> result.status.closed, round(result.status.volume, 2)
    (True, 4.18)
    """
    require_shape(shape)
    start = time.perf_counter()
    if method not in _METHODS:
        raise RsymError(f"no method {method!r}", code="unknown-method", remedy=f"choose from {', '.join(_METHODS)}")
    check_in_space(shape)
    if into is None and memory is not None:
        raise RsymError(
            "memory is bounded where the mesh goes into a file", code="memory", remedy='give into="name.ply", too'
        )
    if into is not None:
        _check_streamed(into, method, cap, executor)
        request = MeshRequest(128, bounds, letters, cap, None, progress, force, Path(into), memory, backend)
        return _told(_streamed(_sharp_of(shape, backend), request, resolution), request, shape, start)
    request = MeshRequest(128, bounds, letters, cap, executor, progress, force, backend=backend)
    result = _resolved(partial(_METHODS[method], shape), request, resolution)
    return _told(result, request, shape, start)


M = TypeVar("M", Mesh, MeshFile)


def _told(result: M, request: MeshRequest, shape: Shape, start: float) -> M:
    """The mesh, after its findings were told."""
    warn_undefined(shape, request.bounds, request.letters)
    elapsed = time.perf_counter() - start
    if logger.isEnabledFor(logging.INFO):
        logger.info("mesh in %.2f s: %s", elapsed, result.status)
    if brief := result.findings.brief:
        more = " `.status.remarks` tells all." if len(result.findings.unresolved) > 1 else ""
        warn(" ".join(brief) + more)
    return result


def _resolved(make: Callable[[MeshRequest], M], request: MeshRequest, resolution: int | Sequence[int] | str) -> M:
    """The mesh at a resolution; at "auto" the first one of which no finer lattice has less to say."""
    if not isinstance(resolution, str):
        return make(replace(request, resolution=resolution))
    if resolution != AUTOMATIC:
        raise RsymError(
            f"a resolution is a number of cells, three numbers or {AUTOMATIC!r}, got {resolution!r}", code="resolution"
        )
    cells = FIRST
    result = make(replace(request, resolution=cells))
    while cells < MOST and (finer := result.findings.refinable):
        cells = min(MOST, math.ceil(max(finer, LEAST_STEP) * cells))
        try:
            result = make(replace(request, resolution=cells))
        except RsymError as error:
            if error.code != "memory":
                raise
            break
    return result


def _streamed(mesher: SharpMesher, request: MeshRequest, resolution: int | Sequence[int] | str) -> MeshFile:
    """The mesh in a file; at "auto" what is only tried lies beside it."""
    assert request.into is not None
    if not isinstance(resolution, str):
        return _resolved(mesher.stream, request, resolution)
    path = target_of(request.into)
    trial = path.with_name(f"{path.stem}.trial{path.suffix}")
    with writing(request.into):
        try:
            made = _resolved(mesher.stream, replace(request, into=trial), resolution)
            os.replace(trial, path)
        finally:
            trial.unlink(missing_ok=True)
    return replace(made, path=request.into)


def _check_streamed(into: Any, method: str, cap: bool, executor: Executor | None) -> None:
    """Refuse what cannot be streamed."""
    if file_path(into).suffix.lower() not in SUFFIXES:
        raise RsymError(
            f"meshes are streamed as {' or '.join(SUFFIXES)}, got {Path(into).name!r}",
            code="file-format",
            where=str(into),
            remedy=f"end the name with {' or '.join(SUFFIXES)}, or write(mesh(shape), path)",
        )
    if method != "sharp" or not cap or executor is not None:
        raise RsymError(
            "a mesh goes into a file by method sharp, with caps and without an executor",
            code="streamed",
            remedy="leave out method, cap and executor, or write(mesh(shape, ...), path)",
        )


def _smoothly(shape: Shape, request: MeshRequest) -> Mesh:
    """Marching cubes on samples of omega."""
    box = bounds_or_extent(shape, request.bounds, request.letters)
    lattice = lattice_over(box, request.resolution, math.inf)
    SAMPLES.check(request.resolution, lattice.counts, force=request.force)
    result = smooth_mesh(shape, lattice, request.letters, request.executor, request.progress)
    return replace(result, found=replace(result.findings, resolution=request.resolution, examined=False))


def _sharply(shape: Shape, request: MeshRequest) -> Mesh:
    """What the mesher of the shape makes of the request; marching cubes where numba is missing."""
    try:
        mesher = _sharp_of(shape, request.backend)
    except RsymError as error:
        if error.code != "missing-package":
            raise
        warn(f"edges are not sharp: {error}")
        return _smoothly(shape, request)
    return mesher(request)


def _sharp_of(shape: Shape, backend: str | None) -> SharpMesher:
    return _mesher(shape, shape.parts, backend)._sharp


_METHODS = MappingProxyType({"sharp": _sharply, "smooth": _smoothly})


class Mesher:
    """Meshes of one shape by method "sharp": compiled once, for any letters, bounds and resolution.

    Parameters
    ----------
    shape : Shape
        A shape in space.
    backend : {"llvm", "tape"}, optional
        ``llvm`` compiles the whole shape: the fastest for small ones. ``tape`` compiles nothing and evaluates at each
        place what matters there, leaves that are the same but for numbers as one: what a mesh costs hardly grows with
        the number of parts. By default ``tape`` for shapes of more than 64 operations "and" or "or", or of more than
        2 000 operations in all: LLVM compiles these longer than many meshes take.

    Raises
    ------
    RsymError
        For a plane shape, an unknown backend, or where the package numba is missing.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> r = sp.Symbol("r", real=True)
    >>> ball = rsym.Shape(r**2 - x**2 - y**2 - z**2, (x, y, z), letters={r: 1}, bounds=((-2.5, 2.5),) * 3)
    >>> mesher = rsym.Mesher(ball)
    >>> [round(mesher(64, letters={"r": radius}).status.volume, 1) for radius in (1, 2)]
    [4.2, 33.5]
    """

    def __init__(self, shape: Shape, *, backend: str | None = None) -> None:
        require_shape(shape)
        check_in_space(shape)
        self.shape = shape
        with uncollected():
            self._sharp = _sharp(shape, backend)

    @property
    def leaves(self) -> tuple[str, ...]:
        """The names of the leaves, the sides of the bounds last."""
        return self._sharp.leaves

    def __call__(
        self,
        resolution: int | Sequence[int] | str = 128,
        *,
        bounds: Any = None,
        letters: Mapping[Any, float] | None = None,
        cap: bool = True,
        executor: Executor | None = None,
        progress: Progress | None = None,
        force: bool = False,
    ) -> Mesh:
        """The surface for some letters; arguments as in `rsym.mesh`.

        What the lattice may have missed is looked for when ``.findings`` or ``.status`` are asked for, which takes
        half as long again; `rsym.mesh` asks at once, and warns.
        """
        request = MeshRequest(128, bounds, letters, cap, executor, progress, force)
        return _resolved(self._sharp, request, resolution)


def _sharp(shape: Shape, backend: str | None) -> SharpMesher:
    form = None
    try:
        if "rsym.sampling.mesher" not in sys.modules:
            # The compiler takes as long as importing the mesher, and numba above all.
            from rsym.sampling.kernels.mesher_kernels import compile_ahead

            form = opened(surface_form(shape)).capped()
            if compile_ahead(form, backend):
                form = None
        from rsym.sampling.mesher import SharpMesher
    except (ImportError, OSError) as error:  # OSError: the package is there, its library is not
        raise RsymError(
            "sharp meshes need the package numba, which cannot be imported",
            code="missing-package",
            remedy='pip install numba, or method="smooth"',
        ) from error
    return SharpMesher(shape, backend, form)


@lru_cache(maxsize=4)
def _mesher(shape: Shape, parts: Any, backend: str | None) -> Mesher:
    """Kept for sweeps and sliders; parts, which equal shapes may call otherwise, name the leaves."""
    return Mesher(shape, backend=backend)
