"""Progress of a long computation, and the way to cancel it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, wait
from typing import Any, TypeAlias, TypeVar

from rsym.errors import RsymError

Progress: TypeAlias = Callable[[int, int], Any]
R = TypeVar("R")


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


class Stages:
    """Reports a computation in stages, each a share of `TOTAL`; what is done never falls.

    Examples
    --------
    >>> stages = Stages(lambda done, total: print(done, "of", total))
    >>> stages.begin(400)
    >>> stages.reach(0.5)
    200 of 1000
    >>> stages.begin(600)
    400 of 1000
    """

    TOTAL = 1000
    SECONDS = 0.1  # after which a report comes even if it says the same: its answer may cancel

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._from = self._to = self._done = 0
        self._time = time.monotonic()

    def begin(self, share: int) -> None:
        """The stage before is done; the next takes this share."""
        self.reach(1.0)
        self._from, self._to = self._to, min(self._to + share, self.TOTAL)

    def finish(self) -> None:
        """All is done."""
        self._to = self.TOTAL
        self.reach(1.0)

    def reach(self, part: float) -> None:
        """Report that a part of the stage is done; raise if the answer is False."""
        done = max(self._done, self._from + int(min(part, 1.0) * (self._to - self._from)))
        now = time.monotonic()
        if done > self._done or now > self._time + self.SECONDS:
            self._done, self._time = done, now
            report(self._progress, done, self.TOTAL)


class Crew(Executor):
    """Runs the loops of a computation in stages by a pool, or here without one, and reports them.

    A loop that does not end, for a cancel or an error, leaves nothing running.

    Examples
    --------
    >>> crew = Crew()
    >>> crew.stage(1000)
    >>> list(crew.map(abs, [-1, 2]))
    [1, 2]
    """

    def __init__(self, pool: Executor | None = None, progress: Progress | None = None) -> None:
        self.stages = Stages(progress)
        self._pool = pool
        self._loops = self._loop = 1

    def stage(self, share: int, loops: int = 1) -> None:
        """The next stage takes this share of all and has about so many loops."""
        self.stages.begin(share)
        self._loops, self._loop = loops, 0

    def map(self, call: Callable[..., R], *iterables: Any, **_: Any) -> Iterator[R]:  # type: ignore[override]
        """Answers in order."""
        tasks = list(zip(*iterables, strict=True))
        first, self._loop = self._loop, self._loop + 1
        for number, answer in enumerate(self._answers(call, tasks), 1):
            yield answer
            self.stages.reach((first + number / len(tasks)) / self._loops)

    def _answers(self, call: Callable[..., R], tasks: list[Any]) -> Iterator[R]:
        if self._pool is None:
            yield from (call(*task) for task in tasks)
            return
        futures = [self._pool.submit(call, *task) for task in tasks]
        try:
            for future in futures:
                yield future.result()
        finally:
            for future in futures:
                future.cancel()
            wait(futures)
