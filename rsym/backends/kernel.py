"""Kernels: compiled programs that take broadcasting arrays and give named fields."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.backends.interpreter import check
from rsym.backends.registry import CompiledFunction, default_backend, make_function
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol
from rsym.model.wording import documented, within
from rsym.program.calculus import LISTED
from rsym.program.expansion import expand
from rsym.program.fields import checked_fields, gather, program_of
from rsym.program.program import FLOAT64, Precision, Program, precision_named


@dataclass(frozen=True, repr=False)
class Kernel:
    """A compiled shape: ``kernel(x, y[, z], letters=None)`` gives a dictionary of arrays.

    Coordinates broadcast; `letters` overrides defaults by name and never recompiles.
    ``kernel.source`` is the generated code, ``kernel.program`` what it was made from.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> kernel = rsym.compile(rsym.Shape(x * y, (x, y)), backend="numpy")
    >>> kernel([1.0, 2.0], [[3.0], [4.0]])["value"].tolist()
    [[3.0, 6.0], [4.0, 8.0]]
    >>> print(kernel.source)
    def kernel(c0, c1):
        v0 = c0 * c1
        return v0,
    <BLANKLINE>
    """

    program: Program
    fields: tuple[str, ...]
    letters: Letters
    backend: str
    dtype: str
    threads: int
    function: CompiledFunction

    def __repr__(self) -> str:
        return f"Kernel({', '.join(f'{name}: {text}' for name, text in self._described().items())})"

    def _repr_html_(self) -> str:
        cell = '<td style="text-align: left">{}</td>'
        rows = [f"<tr>{cell.format(name)}{cell.format(escape(text))}</tr>" for name, text in self._described().items()]
        return f"<table>{''.join(rows)}</table>"

    def _described(self) -> dict[str, str]:
        letters = [f"{name} = {float(letter.default):g}" for name, letter in self.letters.items()]
        return {
            "coordinates": ", ".join(self.program.coordinates),
            "fields": ", ".join(self.fields),
            "letters": ", ".join(within(letters, 1000)) or "none",
            "nodes": str(len(self.program)),
            "backend": self.backend,
            "dtype": self.dtype,
            "threads": str(self.threads),
        }

    def __reduce__(self) -> tuple[Callable[..., Kernel], tuple[Any, ...]]:
        """Pickle the program and the letters; whoever reads them compiles."""
        return _remade, (self.program, self.fields, self.letters, self.backend, self.dtype, self.threads)

    @property
    def source(self) -> str:
        """The generated code."""
        return self.function.source

    def __call__(self, *coordinates: ArrayLike, letters: Mapping[Any, float] | None = None) -> dict[str, NDArray[Any]]:
        """Evaluate the fields; shapes: scalars (...), gradient (..., dim), hessian (..., dim, dim)."""
        values = self.letters.values_with(letters)
        names = self.program.coordinates
        if len(coordinates) != len(names):
            raise RsymError(
                f"this kernel takes {len(names)} coordinates ({', '.join(names)}), got {len(coordinates)}",
                code="arity",
            )
        arrays = real_arrays(coordinates)
        out = np.empty((len(self.program.outputs), *arrays[0].shape), self.dtype)
        run_in_blocks(self.function, arrays, [values[name] for name in self.program.letters], out, self.threads)
        parts = dict(zip((name for name, _ in self.program.outputs), out, strict=True))
        return gather(parts, self.fields, len(names))


def _remade(
    program: Program, fields: tuple[str, ...], letters: Letters, backend: str, dtype: str, threads: int
) -> Kernel:
    """The kernel of what has travelled; checked as that of a shape without bounds."""
    shape = Shape(0, [real_symbol(name) for name in program.coordinates], letters=letters)
    precision = precision_named(dtype)
    return compile_program(program, fields, shape, backend=backend, precision=precision, threads=threads)


def run_in_blocks(
    function: CompiledFunction,
    arrays: Sequence[NDArray[Any]],
    letters: Sequence[float],
    out: NDArray[Any],
    threads: int,
) -> None:
    """Fill `out`, whose first axis is that of the outputs, at arrays of one shape; the bits depend on neither.

    The outputs may lie anyhow in memory: side by side, ``np.moveaxis(points, -1, 0)``, they are put in their places
    block by block, while they are in the cache.
    """

    def work(block: tuple[slice, ...]) -> None:
        with np.errstate(over="ignore"):  # a coordinate outside the range of float32 is infinite
            inputs = [np.ascontiguousarray(array[block], out.dtype).reshape(-1) for array in arrays]
        places = out[:, *block]
        whole, shape = places[:1].flags.c_contiguous, (len(out), inputs[0].size)
        lines = places.reshape(shape) if whole else np.empty(shape, out.dtype)
        function.run(inputs, letters, lines)
        if not whole:
            places[...] = lines.reshape(places.shape)

    if not arrays[0].ndim:
        arrays, out = [array.reshape(1) for array in arrays], out.reshape(-1, 1)
    blocks = list(blocks_of(arrays[0].shape, _size(arrays[0].size, function.block_size, threads)))
    if threads > 1 and len(blocks) > 1:
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(work, blocks))
    else:
        for block in blocks:
            work(block)


@documented(**LISTED)
def compile(
    shape: Shape,
    fields: Sequence[str] = ("value",),
    *,
    backend: str | None = None,
    dtype: str = "float64",
    threads: int | None = None,
    at_corners: str = "nan",
) -> Kernel:
    """Compile fields of a shape to a fast function of arrays.

    Parameters
    ----------
    shape : Shape
        What to evaluate.
    fields : sequence of str
        ``{plain}``; of omega normalised to order 1
        ``{normalised}``, and likewise to orders 2
        and 3: ``normalised_2``, ``normalised_3_gradient``; ``normalised_2_keep_sign`` and so on are the form of
        `normalise` with `keep_sign`. They are 0 where omega is, at corners too, where their gradients are NaN.
        {others}; in space also
        ``principal_curvatures`` (..., 2), the larger first, and ``principal_directions`` (..., 2, 3), orthogonal
        unit tangent vectors. Curvatures are positive where the inside is convex.
    backend : {"llvm", "numpy", "tape"}, optional
        ``llvm`` where it can be imported, else ``numpy``. ``tape`` compiles nothing, for what is asked a few times: it
        has the bits of ``llvm`` at half its speed. All give the same bits for arithmetic. In sin, cos, exp,
        log, pow and atan2 ``numpy`` may differ in the last place: those of ``llvm`` are right to 1 ulp, atan2 to 2.
    dtype : {"float64", "float32"}
        Precision of arithmetic, coordinates and results. In float32 the error of a value is a small multiple of
        2**-24 times the largest node of the program at that point: below 1 on the car, 3 as a rule and at most 32
        on random trees of nine leaves. The surface is displaced by that divided by the length of the gradient. Signs
        of R-operations stay right. Letters, and what depends on them alone, are computed in float64 and rounded once.
    threads : int, optional
        Threads over blocks of points; by default as many as there are processors. The bits do not depend on it.
    at_corners : {"nan", "one-sided"}
        Where ``gradient, gradient_squared, singular`` and those of ``normalised`` have no two-sided value they are
        NaN (``singular``: True), or those of one side: of an R-operation the limit along f = g > 0, for R_0
        (1 - 1/sqrt(2)) (grad f + grad g); of abs that of positive operands, of a tie of min or max the first operand's,
        of a `Piecewise` that of its value. ``normalised_gradient`` then has length 1 where omega is 0, unless both
        sides cancel as in f ^ g. Tips of cones, vertical tangents, curves of positive sides (`trimming`, `segment`),
        corners of `Sardf` have no such side, second derivatives none at any corner: they stay NaN.

    Raises
    ------
    RsymError
        For an unknown field, backend, dtype or choice at corners, a formula that a program cannot hold, or a curvature
        that belongs to another number of coordinates.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> kernel = rsym.compile(rsym.Shape(rsym.conjunction(x, y), (x, y)), ("value", "gradient"))
    >>> kernel(3.0, [4.0, -4.0])["value"].tolist()
    [2.0, -6.0]
    >>> kernel(3.0, 4.0)["gradient"].round(12).tolist()
    [0.4, 0.2]

    The bisector is the side from which a corner is looked at:

    >>> inward = rsym.compile(rsym.Shape(rsym.conjunction(x, y), (x, y)), "normalised_gradient", at_corners="one-sided")
    >>> inward(0.0, 0.0)["normalised_gradient"].round(12).tolist()
    [0.707106781187, 0.707106781187]
    """
    names = checked_fields(fields)
    require_shape(shape)
    precision = precision_named(dtype)
    if at_corners not in ("nan", "one-sided"):
        raise RsymError(f"at_corners must be 'nan' or 'one-sided', got {at_corners!r}", code="corners")
    program = program_of(shape, names, share=precision.rounding, one_sided=at_corners == "one-sided")
    return compile_program(program, names, shape, backend=backend, precision=precision, threads=threads)


def compile_program(
    program: Program,
    fields: tuple[str, ...],
    shape: Shape,
    *,
    backend: str | None = None,
    precision: Precision = FLOAT64,
    threads: int | None = None,
) -> Kernel:
    """The kernel of a program whose outputs make up the fields."""
    name = backend or default_backend()
    function = compiled(program, name, precision, lambda made: check(program, made, precision, shape))
    return Kernel(program, fields, shape.letters, name, precision.name, checked_threads(threads), function)


logger = logging.getLogger(__name__)

_CACHE: dict[tuple[str, str, str], CompiledFunction] = {}
_CACHE_LOCK = threading.Lock()
_CACHE_SIZE = 256


def compiled(
    program: Program, backend: str, precision: Precision, check: Callable[[CompiledFunction], None]
) -> CompiledFunction:
    """Compiled once in a process; checked before it is handed out."""
    key = (backend, precision.name, program.digest)
    with _CACHE_LOCK:
        function = _CACHE.get(key)
    if function is None:
        start = time.perf_counter()
        logger.info("%s: compiling %d nodes", backend, len(program.nodes))
        function = make_function(expand(program), backend, precision)
        check(function)
        logger.debug("%s: %d nodes compiled in %.3f s", backend, len(program.nodes), time.perf_counter() - start)
        with _CACHE_LOCK:
            while len(_CACHE) >= _CACHE_SIZE:
                _CACHE.pop(next(iter(_CACHE)))
            _CACHE[key] = function
    return function


def _size(count: int, most: int, threads: int) -> int:
    """The size of blocks of at most so many points, as many for each thread where one block does not hold all.

    Examples
    --------
    >>> _size(100, 100, 2), _size(101, 100, 2), _size(450, 100, 2)
    (100, 51, 75)
    """
    rounds = -(-count // (most * threads))
    return -(-count // (rounds * threads)) if count > most else most


def blocks_of(shape: tuple[int, ...], size: int) -> Iterator[tuple[slice, ...]]:
    """Boxes of an array, each contiguous in memory and of at most about `size` elements.

    Examples
    --------
    >>> list(blocks_of((3, 4), 8))
    [(slice(0, 2, None),), (slice(2, 3, None),)]
    """
    inner = int(np.prod(shape[1:]))
    if inner > size and len(shape) > 1:
        for index in range(shape[0]):
            for rest in blocks_of(shape[1:], size):
                yield (slice(index, index + 1), *rest)
        return
    step = max(1, size // max(inner, 1))
    for start in range(0, shape[0], step):
        yield (slice(start, min(start + step, shape[0])),)


def _as_real(array: ArrayLike) -> NDArray[Any]:
    try:
        given = np.asarray(array)
        if given.dtype.kind not in "biuf":  # None would be NaN, 1j would lose its imaginary part
            given = np.array([_real(item) for item in given.flat]).reshape(given.shape)
        return given if given.dtype == np.float32 else given.astype(np.float64, copy=False)
    except (TypeError, ValueError) as error:
        kind = type(array).__name__
        raise RsymError(
            f"coordinates must be real arrays, got {kind}", code="array", remedy="give numbers or arrays of them"
        ) from error


def _real(item: Any) -> float:
    """An exact number, of SymPy say, as a float; what is no real number raises."""
    if isinstance(item, str | bytes | complex | np.complexfloating):
        raise TypeError
    return float(item)


def real_arrays(coordinates: Sequence[ArrayLike]) -> Sequence[NDArray[Any]]:
    """Coordinates as real arrays of one shape.

    Examples
    --------
    >>> [array.tolist() for array in real_arrays((1, [0.5, 2]))]
    [[1.0, 1.0], [0.5, 2.0]]
    """
    arrays = [_as_real(array) for array in coordinates]
    try:
        return np.broadcast_arrays(*arrays)
    except ValueError as error:
        shapes = ", ".join(str(array.shape) for array in arrays)
        raise RsymError(
            f"coordinates of the shapes {shapes} do not broadcast", code="array", remedy="use np.meshgrid or [:, None]"
        ) from error


def checked_threads(threads: int | None) -> int:
    """The number of threads; by default as many as there are processors."""
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise RsymError(f"threads must be a positive integer, got {threads!r}", code="threads")
    return threads


@cache
def lasting_threads(name: str, count: int) -> ThreadPoolExecutor:
    """So many threads of this process for work of a name, that nothing else waits for.

    Who works in them hands nothing to them: all might wait for what none is left to do.
    """
    return ThreadPoolExecutor(count, thread_name_prefix=name)


# A forked process has none of the threads of its parent.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=lasting_threads.cache_clear)
