"""Tasks spread over the workers of an executor: answers in order, no wait without end, nothing left behind."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from typing import TypeVar

from rsym.errors import RsymError

T = TypeVar("T")
R = TypeVar("R")

TICK = 0.1  # seconds between looks at the executor
# What still runs after a cancel or an error is waited for so long; pieces take a fraction of it.
LAST = 1.0
# A scheduler that has no workers waits for new ones for ever; one that is replaced takes a few seconds.
WITHOUT_WORKERS = 15.0


def spread(
    call: Callable[[T], R],
    tasks: Sequence[T],
    executor: Executor,
    place: Callable[[T], str],
    arrived: Callable[[Sequence[R]], None],
) -> list[R]:
    """The answers to all tasks, in order.

    `arrived` is told the answers so far, a few times a second, and may raise; `place` says what a task is, for the
    error when its worker dies. Exceptions of a task arrive as they are. Whatever is raised, tasks that still wait are
    cancelled.
    """
    futures: list[Future[R]] = []
    try:
        for task in tasks:
            futures.append(executor.submit(call, task))
        _wait_for(futures, executor, arrived)
        return [future.result() for future in futures]
    except (BrokenExecutor, CancelledError, NoWorkers) as error:
        raise _died(error, tasks, futures, place) from error
    except Exception as error:
        # What dask raises when workers have died of a task, again and again.
        if type(error).__name__ == "KilledWorker":
            raise _died(error, tasks, futures, place) from error
        raise
    finally:
        for future in futures:
            future.cancel()
        wait(futures, timeout=LAST)


def _wait_for(futures: list[Future[R]], executor: Executor, arrived: Callable[[Sequence[R]], None]) -> None:
    waiting, deadline = set(futures), time.monotonic() + WITHOUT_WORKERS
    while waiting:
        done, waiting = wait(waiting, timeout=TICK, return_when=FIRST_COMPLETED)
        arrived([future.result() for future in futures if future not in waiting])
        now = time.monotonic()
        if done or now > deadline:
            deadline = now + WITHOUT_WORKERS
            if not done and _has_no_workers(executor):
                raise NoWorkers


class NoWorkers(Exception):
    """Nobody is left to compute anything."""


def _has_no_workers(executor: Executor) -> bool:
    """Whether dask says so; other executors say that they are broken."""
    count = getattr(getattr(executor, "_client", None), "nthreads", None)
    return count is not None and not count()


def _died(
    error: BaseException, tasks: Sequence[T], futures: Sequence[Future[R]], place: Callable[[T], str]
) -> RsymError:
    """Name the first task without an answer: executors start them in order."""
    lost = [k for k in range(len(tasks)) if k >= len(futures) or not _answered(futures[k])]
    return RsymError(
        f"a worker died ({type(error).__name__}) and {len(lost)} of {len(tasks)} pieces are lost, the first of them"
        f" {place(tasks[lost[0]])}",
        code="worker-died",
        remedy="start the executor again; give its workers more memory if they ran out of it",
    )


def _answered(future: Future[R]) -> bool:
    return future.done() and not future.cancelled() and future.exception() is None
