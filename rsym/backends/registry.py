"""The backends by name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Protocol

from numpy.typing import NDArray

from rsym.arrays import Arrays
from rsym.backends.numpy_backend import NumpyFunction
from rsym.errors import RsymError
from rsym.program.program import FLOAT64, Precision, Program


class CompiledFunction(Protocol):
    """What a backend makes of a program."""

    block_size: int

    @property
    def source(self) -> str:
        """The generated code."""

    def __init__(self, program: Program, precision: Precision = FLOAT64) -> None: ...

    def run(self, coordinates: Sequence[NDArray[Any]], letters: Sequence[float], outputs: Arrays) -> None:
        """Fill the outputs."""


def default_backend() -> str:
    """`llvm` where llvmlite can be imported, else `numpy`."""
    return "llvm" if _llvm_function() is not None else "numpy"


def ready_backend() -> str:
    """The one that compiles nothing for what is asked a few times: `tape` where llvmlite can be imported."""
    return "tape" if _tape_function() is not None else "numpy"


def _llvm_function() -> type[CompiledFunction] | None:
    try:
        from rsym.backends.llvm_code import LlvmFunction
    except (ImportError, OSError):  # OSError: the package is there, its library is not
        return None
    return LlvmFunction


def _tape_function() -> type[CompiledFunction] | None:
    try:
        from rsym.backends.tape import TapeFunction
    except (ImportError, OSError):
        return None
    return TapeFunction


_BACKENDS: dict[str, Callable[[], type[CompiledFunction] | None]] = {
    "llvm": _llvm_function,
    "numpy": lambda: NumpyFunction,
    "tape": _tape_function,
}


def make_function(program: Program, backend: str, precision: Precision) -> CompiledFunction:
    """Compile an expanded program."""
    if backend not in _BACKENDS:
        choices = ", ".join(map(repr, _BACKENDS))
        raise RsymError(f"no backend {backend!r}", code="unknown-backend", remedy=f"choose from {choices}")
    made = _BACKENDS[backend]()
    if made is None:
        raise RsymError(
            f"the backend {backend!r} needs the package llvmlite, which cannot be imported",
            code="missing-package",
            remedy="pip install llvmlite, or backend='numpy'",
        )
    return made(program, precision)
