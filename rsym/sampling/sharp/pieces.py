"""A surface in pieces: the lattice cut into boxes of blocks, each computed on its own, whatever computes it.

A piece computes the blocks of its box and a halo of one block around them. That is enough:

- A vertex of its own needs the crossings of its cell's edges, whose lower ends lie in its own block or the next.
- A crossing of its own needs the vertices of the four cells around it: its own, or cells of the last layer before the
  box. Such a cell's edges end in the halo or the box, and so do the cells beside it, which decide how its ambiguous
  faces are paired (a pairing depends on the two cells beside a face alone).

Blocks are kept, and their points, crossings and vertices found, by rules that know nothing but the lattice, so each
piece gets the bits of the uncut run.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from rsym.arrays import Ints
from rsym.errors import RsymError
from rsym.sampling.memory import Budget, free_memory
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.assembly import Job, Unfinished, assemble
from rsym.sampling.sharp.octree import BLOCK, Blocks
from rsym.sampling.sharp.welding import Piece, inside, own_piece, weld

# Enough pieces to share among a few workers; the halo of a piece of 90x90 blocks costs 5 %, and such a piece of the
# car takes a fifth of a second, which is what a cancel waits for. Pieces below 64 blocks cost more than they share.
PIECES, LEAST, MOST = 16, 64, 8192

T = TypeVar("T")
R = TypeVar("R")

TICK = 0.1  # seconds between looks at the executor
# What still runs after a cancel or an error is waited for so long; pieces take a fraction of it.
LAST = 1.0
# A scheduler that has no workers waits for new ones for ever; one that is replaced takes a few seconds.
WITHOUT_WORKERS = 15.0


@dataclass(frozen=True)
class PieceTask:
    """A piece to compute: (2, 3) the first cells of its box, and those past its last."""

    job: Job
    box: Ints


def compute(task: PieceTask) -> Piece:
    """The piece of a task; run by whatever executor, in whatever process."""
    job, crew = task.job, Crew()
    budget = Budget(free_memory())
    blocks = job.blocks(crew, budget, task.box)
    made = assemble(job, blocks, crew, budget)
    return own_piece(made, task.box, job.extent, job.notes(_of(task.box, blocks), crew))


def in_pieces(job: Job, executor: Executor, crew: Crew, budget: Budget) -> Unfinished:
    """The surface, its pieces computed by an executor; the same bits as `whole`."""
    crew.stage(20, loops=6)
    tasks = [PieceTask(job, box) for box in cut(job.blocks(crew, budget).corner)]
    crew.stage(880)

    def arrived(pieces: Sequence[Piece]) -> None:
        # Once as pieces, once as a whole.
        need = 2 * sum(piece.size for piece in pieces)
        if pieces:
            budget.claim(need, need * len(tasks) / len(pieces))
        crew.stages.reach(len(pieces) / len(tasks))

    pieces = spread(compute, tasks, executor, lambda task: job.place(task.box), arrived)
    crew.stage(50)
    return weld(pieces)


def cut(corner: Ints) -> list[Ints]:
    """Boxes (2, 3) of cells that hold about equally many of these blocks, and every one.

    Examples
    --------
    >>> [box.tolist() for box in cut(np.array([[0, 8, 8], [0, 0, 8], [0, 0, 0]]))]
    [[[0, 0, 0], [16, 16, 8]]]
    """
    most = min(max(LEAST, -(-corner.shape[1] // PIECES)), MOST)
    return list(_cut(corner, most)) if corner.size else []


def _cut(corner: Ints, most: int) -> Iterator[Ints]:
    box = np.stack([corner.min(axis=1), corner.max(axis=1) + BLOCK])
    if corner.shape[1] <= most:
        yield box
        return
    axis = int((box[1] - box[0]).argmax())
    middle = np.median(corner[axis])
    # A plane of blocks that holds the median and all below goes to the other side.
    below = corner[axis] < middle if (corner[axis] < middle).any() else corner[axis] <= middle
    yield from _cut(corner[:, below], most)
    yield from _cut(corner[:, ~below], most)


def _of(box: Ints, blocks: Blocks) -> Blocks:
    own = inside(blocks.corner, box)
    return Blocks(np.ascontiguousarray(blocks.corner[:, own]), blocks.words[own], blocks.visited)


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
