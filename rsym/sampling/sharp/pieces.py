"""A surface in pieces: the lattice cut into boxes of blocks, each computed on its own, whatever computes it.

A piece computes the blocks of its box and a halo of one block around them. That is enough:

- A vertex of its own needs the crossings of its cell's edges, whose lower ends lie in its own block or the next.
- A crossing of its own needs the vertices of the four cells around it: its own, or cells of the last layer before the
  box. Such a cell's edges end in the halo or the box, and so do the cells beside it, which decide how its ambiguous
  faces are paired (a pairing depends on the two cells beside a face alone).

Blocks are kept, and their points, crossings and vertices found, by rules that know nothing but the lattice, so each
piece gets the bits of the uncut run. Only the numbers of vertices and crossings differ. Their names do not: they are
integers that ascend along the uncut surface, so a number there is the rank of a name among all names,
``np.searchsorted(names, names_of_a_piece)``, and pieces weld to that surface.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, CancelledError, Executor, Future, wait
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.sampling.kernels.mesher_kernels import padded
from rsym.sampling.memory import Budget, free_memory
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.assembly import Assembly, Job, Unfinished, assemble
from rsym.sampling.sharp.finishing import mark, renumber
from rsym.sampling.sharp.signs import BLOCK, Blocks, Numbers, inside, list_places
from rsym.sampling.sharp.topology import Topology

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
    made = assemble(job, blocks, crew, budget, task.box)
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


CELLS = 512  # of a block
PATCHES = 4  # of a cell, at most


def vertex_places(surface: Topology) -> Numbers:
    """Place, 512*block + 64*i + 8*j + k, of the cell of each vertex."""
    return np.repeat(surface.place, np.diff(surface.start))


def crossing_places(surface: Topology) -> Numbers:
    """Place, 512*block + 64*i + 8*j + k, of the lower end of each crossing."""
    place = np.empty(surface.crossings, np.int32)
    for axis in range(3):
        list_places(surface.edges[axis], surface.edges_before[axis], place)
    return place


def vertex_names(surface: Topology, extent: tuple[int, int, int], which: Ints | None = None) -> Ints:
    """(Block, cell, patch) of each vertex, or of some, as one integer, on a lattice of extent blocks."""
    which = np.arange(surface.vertices) if which is None else which
    cell = np.searchsorted(surface.start, which, "right") - 1
    return np.asarray(_names(surface, extent, surface.place[cell]) * PATCHES + which - surface.start[cell])


def crossing_names(surface: Topology, extent: tuple[int, int, int]) -> Ints:
    """(Axis, block, lattice edge) of each crossing as one integer, on a lattice of extent blocks."""
    axis = np.repeat(np.arange(3), np.diff(surface.axes))
    return axis * (CELLS * extent[0] * extent[1] * extent[2]) + _names(surface, extent, crossing_places(surface))


def blocks_of_names(names: Ints, extent: tuple[int, int, int]) -> Ints:
    """The blocks (n, 3) that vertices of these names lie in."""
    return np.stack(np.unravel_index(names // (PATCHES * CELLS), extent), axis=1)


def _names(surface: Topology, extent: tuple[int, int, int], place: Numbers) -> Ints:
    i, j, k = surface.corner >> 3
    block = (i * extent[1] + j) * extent[2] + k
    return np.asarray(block[place >> 9] * CELLS + (place & CELLS - 1), np.int64)


@dataclass(frozen=True)
class Piece:
    """The part of a surface that belongs to the blocks of a box.

    Blocks: ``corner`` (3, n), in lexicographic order; ``vertices`` (n,) and ``crossings`` (3, n) tell how many each
    has. Arrays of the surface are in the order of the whole surface. Faces count the piece's own vertices and, after
    them, the `strangers`: names of vertices of other pieces, ``stranger_points`` (3, s) where they are. ``rim`` are the
    names of those own vertices that others may touch, ``rim_number`` which ones they are.
    """

    corner: Ints
    vertices: Numbers
    crossings: Numbers
    surface: Unfinished
    strangers: Ints
    stranger_points: Floats
    rim: Ints
    rim_number: Numbers

    @property
    def size(self) -> int:
        """Bytes of its surface."""
        return self.surface.points.nbytes + self.surface.faces.nbytes + self.surface.leaf.nbytes


def own_piece(made: Assembly, box: Ints, extent: tuple[int, int, int], notes: tuple[Any, ...] = ()) -> Piece:
    """What belongs to a box, from the surface of its blocks and their neighbours.

    `box` (2, 3): its first cells, and those past its last.
    """
    surface = made.surface
    own = inside(surface.corner, box)
    first, begin = surface.start[surface.cells_before[:, 0]], surface.edges_before[:, :, 0]
    vertices, per_axis = np.diff(first), np.diff(begin, axis=1)
    mine = np.repeat(own, vertices)
    # Blocks of a box follow each other in stretches, one where it is cut across the first axis alone.
    ends = np.flatnonzero(np.diff(own, prepend=False, append=False)).reshape(-1, 2)
    of_vertices = [slice(*pair) for pair in first[ends].tolist()]
    of_crossings = [slice(*pair) for axis in begin for pair in axis[ends].tolist()]

    # Others touch the cells on the upper sides of the box: the crossings of a cell's lower ends are around it.
    near = own & (surface.corner + BLOCK == box[1, :, None]).any(axis=0)
    cells = np.flatnonzero(np.repeat(near, np.diff(surface.cells_before[:, 0])))
    place = surface.place[cells]
    cell = surface.corner[:, place >> 9] + np.stack([place >> 6 & 7, place >> 3 & 7, place & 7])
    cells = cells[(cell == box[1, :, None] - 1).any(axis=0)]
    counts = surface.start[cells + 1] - surface.start[cells]
    rim = np.repeat(surface.start[cells] - np.cumsum(counts) + counts, counts) + np.arange(counts.sum())
    number = np.cumsum(mine, dtype=np.int32) - np.int32(1)
    count = int(vertices[own].sum())
    faces = _stretches(made.faces.reshape(-1, 6), of_crossings).reshape(-1, 3)
    used = np.zeros(len(mine), np.bool_)
    mark(faces, used)
    strange = np.flatnonzero(used & ~mine)
    number[strange] = count + np.arange(len(strange))
    renumber(faces, number)
    points = np.concatenate([made.points[:, :0], *(made.points[:, part] for part in of_vertices)], axis=1)
    leaf, flaws = _stretches(made.leaf, of_crossings), _stretches(made.flaws, of_crossings)
    return Piece(
        np.ascontiguousarray(surface.corner[:, own]),
        vertices[own],
        np.ascontiguousarray(per_axis[:, own]),
        Unfinished(points, count, faces, leaf, flaws, notes),
        vertex_names(surface, extent, strange),
        np.ascontiguousarray(made.points[:, strange]),
        vertex_names(surface, extent, rim),
        number[rim],
    )


def _stretches(rows: Any, parts: Sequence[slice]) -> Any:
    """Some stretches of rows, one after the other."""
    return np.concatenate([rows[:0], *(rows[part] for part in parts)])


def weld(pieces: list[Piece]) -> Unfinished:
    """The whole surface, as if it had never been cut; pieces leave the list as they are used up."""
    order = np.lexsort(np.concatenate([piece.corner for piece in pieces], axis=1)[::-1])
    first = _ranks([piece.vertices[None] for piece in pieces], order)
    begin = _ranks([piece.crossings for piece in pieces], order)
    numbers = [_numbers(*ends) for ends in zip(first, (piece.vertices[None] for piece in pieces), strict=True)]
    rim = np.concatenate([piece.rim for piece in pieces])
    rim_number = np.concatenate([number[piece.rim_number] for number, piece in zip(numbers, pieces, strict=True)])
    by_name = np.argsort(rim)

    total = sum(len(number) for number in numbers)
    points = np.empty((3, padded(total)))
    leaf = np.empty(sum(len(piece.surface.leaf) for piece in pieces), np.int16)
    flaws = np.empty(len(leaf), np.uint8)
    faces = np.empty((len(leaf), 6), np.int32)
    notes: list[Any] = []
    for number, starts in zip(numbers, begin, strict=True):
        piece = pieces.pop(0)
        strangers = rim_number[by_name[np.searchsorted(rim, piece.strangers, sorter=by_name)]]
        place = _numbers(starts, piece.crossings)
        points[:, number] = piece.surface.points
        leaf[place], flaws[place] = piece.surface.leaf, piece.surface.flaws
        faces[place] = np.concatenate([number, strangers])[piece.surface.faces].reshape(-1, 6)
        notes += piece.surface.notes
    return Unfinished(points, total, faces.reshape(-1, 3), leaf, flaws, tuple(notes))


def _ranks(counts: list[Numbers], order: Ints) -> list[Ints]:
    """The number of the first of each (row, block), row by row, in each row block by block in this order."""
    all_ = np.concatenate(counts, axis=1).astype(np.int64)
    ranked = all_[:, order]
    first = np.empty_like(all_)
    first[:, order] = (np.cumsum(ranked) - ranked.ravel()).reshape(ranked.shape)
    return np.split(first, np.cumsum([count.shape[1] for count in counts])[:-1], axis=1)


def _numbers(first: Ints, counts: Numbers) -> Numbers:
    """Number of each member of a piece, from that of the first of each (row, block)."""
    here = np.cumsum(counts) - counts.ravel()
    total = int(counts.sum())
    return np.asarray(np.repeat(first.ravel() - here, counts.ravel()) + np.arange(total), np.int32)
