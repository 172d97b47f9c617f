"""Index loops where they may be left to the interpreter: without numba they run as they stand, slowly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

F = TypeVar("F", bound=Callable[..., Any])

try:
    from rsym.sampling.sharp.loops import loop as loop
    from rsym.sampling.sharp.loops import step as step
except ImportError:

    def loop(function: F) -> F:
        """Leave a loop to the interpreter."""
        return function

    step = loop
