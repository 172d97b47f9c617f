"""Progress of a long computation, and the way to cancel it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from rsym.errors import RsymError

Progress: TypeAlias = Callable[[int, int], Any]


def report(progress: Progress | None, done: int, total: int) -> None:
    """Say how far a computation is; an answer of False cancels it."""
    if progress is not None and progress(done, total) is False:
        raise RsymError(f"cancelled after {done} of {total} steps", code="cancelled")


class Steps:
    """Counts the steps of a computation and reports each to ``progress(done, total)``; False cancels.

    Examples
    --------
    >>> steps = Steps(2, lambda done, total: print(done, "of", total))
    >>> steps.advance()
    1 of 2
    """

    def __init__(self, total: int, progress: Progress | None) -> None:
        self.total = total
        self.done = 0
        self._progress = progress

    def advance(self) -> None:
        """Report one more step as done; raise if the answer is False."""
        self.done += 1
        report(self._progress, self.done, self.total)
