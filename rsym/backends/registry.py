"""The backends by name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from numpy.typing import NDArray

from rsym.backends.numpy_backend import NumpyFunction
from rsym.errors import RsymError
from rsym.program.program import FLOAT64, Precision, Program


class CompiledFunction(Protocol):
    """What a backend makes of a program."""

    source: str
    block_size: int

    def __init__(self, program: Program, precision: Precision = FLOAT64) -> None: ...

    def run(
        self, coordinates: Sequence[NDArray[Any]], letters: Sequence[float], outputs: Sequence[NDArray[Any]]
    ) -> None:
        """Fill the outputs."""


def default_backend() -> str:
    """`llvm` where llvmlite can be imported, else `numpy`."""
    return "llvm" if _llvm_function() is not None else "numpy"


def _llvm_function() -> type[CompiledFunction] | None:
    try:
        from rsym.backends.llvm_code import LlvmFunction
    except (ImportError, OSError):  # OSError: the package is there, its library is not
        return None
    return LlvmFunction


def make_function(program: Program, backend: str, precision: Precision) -> CompiledFunction:
    """Compile an expanded program."""
    if backend == "numpy":
        return NumpyFunction(program, precision)
    if backend != "llvm":
        raise RsymError(f"no backend {backend!r}", code="unknown-backend", remedy="choose 'llvm' or 'numpy'")
    compiled = _llvm_function()
    if compiled is None:
        raise RsymError(
            "the backend 'llvm' needs the package llvmlite, which cannot be imported",
            code="missing-package",
            remedy="pip install llvmlite, or backend='numpy'",
        )
    return compiled(program, precision)
