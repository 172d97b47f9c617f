"""Progress of a long computation, the time allowed, and the way to cancel it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, wait
from time import monotonic
from typing import Any, Protocol, TypeAlias, TypeVar, runtime_checkable

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


@runtime_checkable
class Describing(Protocol):
    """A progress that also wants to know what is at work: `describe` is called before each call of the progress.

    `undecided` is the share of the boundary, found so far, on which nothing is proved yet; NaN where nobody knows.

    Examples
    --------
    >>> class Bar:
    ...     def describe(self, stage, undecided):
    ...         print(stage, undecided)
    ...
    ...     def __call__(self, done, total):
    ...         print(done, "of", total)
    >>> effort = Effort(Bar())
    >>> effort.begin("boxes", 500)
    boxes nan
    >>> effort.reach(0.5, undecided=0.5)
    boxes 0.5
    250 of 1000
    """

    def describe(self, stage: str, undecided: float) -> None:
        """Take note of the name of the stage at work and of what is undecided."""


def tell(progress: Progress | None, stage: str, done: int, total: int) -> None:
    """Say what is at work and how far it is, to a progress that may be `Describing`; False cancels.

    Examples
    --------
    >>> tell(lambda done, total: print(done, "of", total), "sampling", 1, 2)
    1 of 2
    """
    if isinstance(progress, Describing):
        progress.describe(stage, math.nan)
    report(progress, done, total)


class Effort:
    """The time that is left, if it is limited, and a progress in stages.

    Whoever computes asks `is_over` now and then, and stops where that is sound: with what is proved so far. Results
    under a time limit depend on the machine; that what they call proved is true does not.

    Parameters
    ----------
    progress : callable, optional
        ``progress(done, total)``, of `Stages.TOTAL` shares of the work; False cancels. It may be `Describing`.
    timeout : float, optional
        Seconds from now.

    Examples
    --------
    >>> effort = Effort(timeout=0)
    >>> effort.was_cut, effort.is_over, effort.was_cut
    (False, True, True)
    >>> Effort().left is None
    True
    """

    def __init__(self, progress: Progress | None = None, timeout: float | None = None) -> None:
        if timeout is not None and (
            isinstance(timeout, bool) or not isinstance(timeout, int | float) or not timeout >= 0
        ):
            raise RsymError(
                f"timeout must be a number of seconds, got {timeout!r}", code="number", remedy="for example 60, or None"
            )
        self._deadline = None if timeout is None else monotonic() + timeout
        self._listener = progress if isinstance(progress, Describing) else None
        self._stages = Stages(progress)
        self._stage, self._undecided = "", math.nan
        self.was_cut = False

    def again(self) -> Effort:
        """The same time for a question within this one, whose parts are not told; it may be cancelled all the same."""
        inner = Effort(lambda *_: self.reach(0.0))
        inner._deadline = self._deadline
        return inner

    @property
    def left(self) -> float | None:
        """The seconds that are left, at least 0; None where time is not limited."""
        return None if self._deadline is None else max(0.0, self._deadline - monotonic())

    @property
    def is_over(self) -> bool:
        """Whether the time has ended; that this was asked and answered so is remembered as `was_cut`."""
        over = self._deadline is not None and monotonic() >= self._deadline
        self.was_cut |= over
        return over

    def begin(self, stage: str, share: int) -> None:
        """The stage before is done; the next has a name and takes so many of `Stages.TOTAL` shares."""
        self._stage = self._stage or stage
        self._tell()
        self._stages.begin(share)
        self._stage = stage

    def reach(self, part: float, *, undecided: float | None = None) -> None:
        """A part of the stage is done; an answer of False to the report of it cancels."""
        self._undecided = self._undecided if undecided is None else undecided
        self._tell()
        self._stages.reach(part)

    def finish(self) -> None:
        """All is done."""
        self._tell()
        self._stages.finish()

    def _tell(self) -> None:
        if self._listener is not None and self._stage:
            self._listener.describe(self._stage, self._undecided)

    @property
    def statements(self) -> tuple[tuple[str, bool], ...]:
        """The sentence of a report that was cut short, with whether it is proved; none else."""
        return (("the time allowed ended before everything was looked at", False),) if self.was_cut else ()
