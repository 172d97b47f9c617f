"""Kernels: compiled programs that take broadcasting arrays and give named fields."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.codegen.expansion import expand
from rsym.codegen.fields import checked_fields, gather, program_of
from rsym.codegen.interpreter import interpret_nodes
from rsym.codegen.numpy_backend import NumpyFunction
from rsym.codegen.program import Program
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.model.shape import Shape

CHECK_POINTS = 32
# An error above this share of the largest node value means wrong code, not rounding: rounding stays below 1e-16 of it
# on the six fields of the car and of the skeleton body.
CHECK_TOLERANCE = 1e-10


class CompiledFunction(Protocol):
    """What a backend makes of a program."""

    source: str
    block_size: int

    def __init__(self, program: Program) -> None: ...

    def run(
        self,
        coordinates: Sequence[NDArray[np.float64]],
        letters: Sequence[float],
        outputs: Sequence[NDArray[np.float64]],
    ) -> None:
        """Fill the outputs."""


@dataclass(frozen=True)
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
    threads: int
    function: CompiledFunction

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
        arrays = _broadcast([_as_float64(array) for array in coordinates])
        out = np.empty((len(self.program.outputs), *arrays[0].shape))
        self._fill(arrays, [values[name] for name in self.program.letters], out)
        parts = dict(zip((name for name, _ in self.program.outputs), out, strict=True))
        return gather(parts, self.fields, len(names))

    def _fill(self, arrays: Sequence[NDArray[np.float64]], letters: list[float], out: NDArray[np.float64]) -> None:
        def work(block: tuple[slice, ...]) -> None:
            inputs = [np.ascontiguousarray(array[block]).reshape(-1) for array in arrays]
            self.function.run(inputs, letters, [component[block].reshape(-1) for component in out])

        if not arrays[0].ndim:
            arrays, out = [array.reshape(1) for array in arrays], out.reshape(-1, 1)
        blocks = list(blocks_of(arrays[0].shape, self.function.block_size))
        if self.threads > 1 and len(blocks) > 1:
            with ThreadPoolExecutor(self.threads) as pool:
                list(pool.map(work, blocks))
        else:
            for block in blocks:
                work(block)


def compile(
    shape: Shape,
    fields: Sequence[str] = ("value",),
    *,
    backend: str | None = None,
    dtype: str = "float64",
    threads: int | None = None,
) -> Kernel:
    """Compile fields of a shape to a fast function of arrays.

    Parameters
    ----------
    shape : Shape
        What to evaluate.
    fields : sequence of str
        ``value, gradient, hessian, gradient_squared, laplacian, normalised, normalised_gradient_squared,
        normalised_laplacian, singular``.
    backend : {"llvm", "numpy"}, optional
        ``llvm`` where it can be imported, else ``numpy``. Both give the same bits for arithmetic.
    dtype : {"float64"}
        Precision of all arithmetic.
    threads : int, optional
        Threads over blocks of points; by default as many as there are processors. The bits do not depend on it.

    Raises
    ------
    RsymError
        For an unknown field, backend or dtype, or a formula that a program cannot hold.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> kernel = rsym.compile(rsym.Shape(rsym.conjunction(x, y), (x, y)), ("value", "gradient"))
    >>> kernel(3.0, [4.0, -4.0])["value"].tolist()
    [2.0, -6.0]
    >>> kernel(3.0, 4.0)["gradient"].round(12).tolist()
    [0.4, 0.2]
    """
    names = checked_fields(fields)
    _check_shape(shape)
    if dtype != "float64":
        raise RsymError(f"dtype must be 'float64', got {dtype!r}", code="dtype")
    return compile_program(program_of(shape, names), names, shape, backend=backend, threads=threads)


def compile_program(
    program: Program, fields: tuple[str, ...], shape: Shape, *, backend: str | None = None, threads: int | None = None
) -> Kernel:
    """The kernel of a program whose outputs make up the fields."""
    name = backend or default_backend()
    function = _compiled(program, name, shape)
    return Kernel(program, fields, shape.letters, name, _checked_threads(threads), function)


def default_backend() -> str:
    """`llvm` where llvmlite can be imported, else `numpy`."""
    return "llvm" if _llvm_function() is not None else "numpy"


def _llvm_function() -> type[CompiledFunction] | None:
    try:
        from rsym.codegen.llvm_backend import LlvmFunction
    except (ImportError, OSError):  # OSError: the package is there, its library is not
        return None
    return LlvmFunction


_CACHE: dict[tuple[str, str], CompiledFunction] = {}
_CACHE_LOCK = threading.Lock()
_CACHE_SIZE = 256


def _compiled(program: Program, backend: str, shape: Shape) -> CompiledFunction:
    """Compiled once in a process; checked against the interpreter before it is handed out."""
    key = (backend, program.digest)
    with _CACHE_LOCK:
        function = _CACHE.get(key)
    if function is None:
        function = _make_function(expand(program), backend)
        _check(program, function, shape)
        with _CACHE_LOCK:
            while len(_CACHE) >= _CACHE_SIZE:
                _CACHE.pop(next(iter(_CACHE)))
            _CACHE[key] = function
    return function


def _make_function(program: Program, backend: str) -> CompiledFunction:
    if backend == "numpy":
        return NumpyFunction(program)
    if backend != "llvm":
        raise RsymError(f"no backend {backend!r}", code="unknown-backend", remedy="choose 'llvm' or 'numpy'")
    compiled = _llvm_function()
    if compiled is None:
        raise RsymError(
            "the backend 'llvm' needs the package llvmlite, which cannot be imported",
            code="missing-package",
            remedy="pip install llvmlite, or backend='numpy'",
        )
    return compiled(program)


def _check(program: Program, function: CompiledFunction, shape: Shape) -> None:
    """Compare with the interpreter at 32 points: a miscompiled formula must never leave this module."""
    generator = np.random.default_rng(20130605)
    box = shape.bounds or ((-1.0, 1.0),) * shape.dimension
    points = [generator.uniform(low, high, CHECK_POINTS) for low, high in box]
    letters = [float(shape.letters[name].default) for name in program.letters]
    inputs: dict[str, Any] = dict(zip((*program.coordinates, *program.letters), [*points, *letters], strict=True))
    nodes = interpret_nodes(program, inputs)
    outputs = [np.empty(CHECK_POINTS) for _ in program.outputs]
    function.run(points, letters, outputs)
    with np.errstate(all="ignore"):
        sizes = np.array([np.broadcast_to(np.abs(node), CHECK_POINTS) for node in nodes])
        scale = np.where(np.isfinite(sizes), sizes, 0).max(axis=0)
        for (name, number), got in zip(program.outputs, outputs, strict=True):
            expected = np.broadcast_to(nodes[number], CHECK_POINTS)
            wrong = np.isfinite(expected) & ~(np.abs(got - expected) <= CHECK_TOLERANCE * scale)
            if wrong.any():
                raise RsymError(
                    f"the compiled {name!r} differs from its formula at {int(wrong.sum())} of {CHECK_POINTS} points",
                    code="miscompiled",
                    remedy="use backend='numpy' and report the model",
                )


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


def _as_float64(array: ArrayLike) -> NDArray[np.float64]:
    try:
        return np.asarray(array, np.float64)
    except (TypeError, ValueError) as error:
        raise RsymError(f"coordinates must be real arrays, got {type(array).__name__}", code="array") from error


def _broadcast(arrays: list[NDArray[np.float64]]) -> Sequence[NDArray[np.float64]]:
    try:
        return np.broadcast_arrays(*arrays)
    except ValueError as error:
        shapes = ", ".join(str(array.shape) for array in arrays)
        raise RsymError(
            f"coordinates of the shapes {shapes} do not broadcast", code="array", remedy="use np.meshgrid or [:, None]"
        ) from error


def _check_shape(shape: Any) -> None:
    if not isinstance(shape, Shape):
        raise RsymError(
            f"expected a Shape, got {type(shape).__name__}", code="shape", remedy="Shape(expression, (x, y))"
        )


def _checked_threads(threads: int | None) -> int:
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise RsymError(f"threads must be a positive integer, got {threads!r}", code="threads")
    return threads
