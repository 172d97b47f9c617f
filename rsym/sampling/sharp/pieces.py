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

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.sampling.kernels.surface_kernels import SurfaceKernels
from rsym.sampling.memory import Budget, free_memory
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.assembly import USUAL_BYTES, assemble, claim_only
from rsym.sampling.sharp.octree import BLOCK, Blocks, find_blocks
from rsym.sampling.sharp.spread import spread
from rsym.sampling.sharp.welding import Piece, Surface, inside, own_piece, weld

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]
# What else to find out about blocks: a module's function, so that a process can be told its name.
Inspect: TypeAlias = Callable[[SurfaceKernels, Blocks, Floats, Executor], Any]

HALO = 1  # blocks
# Enough pieces to share among a few workers; the halo of a piece of 90x90 blocks costs 5 %, and such a piece of the
# car takes a fifth of a second, which is what a cancel waits for. Pieces below 64 blocks cost more than they share.
PIECES, LEAST, MOST = 16, 64, 8192
# Of boxes of the octree: corners, twice, words and what is kept.
BOX_BYTES = 100
# So many boxes of a level of the octree, not much more than four times those before it, foretell those of the last
# within a tenth on the paper's models, and those of one where little could be discarded yet within some tens: where
# they would need this many times what is free nobody need wait for them.
SETTLED, GROWTH, DOUBT, GREAT_DOUBT = 1000, 4.6, 2.0, 64.0


@dataclass(frozen=True)
class Job:
    """A surface to compute: kernels with their letters, which leaves are smooth, lattice, and cells along each axis."""

    kernels: SurfaceKernels
    smooth: NDArray[np.bool_]
    lattice: Floats
    cells: tuple[int, ...]
    inspect: Inspect | None = None

    @property
    def extent(self) -> tuple[int, int, int]:
        """Blocks along each axis."""
        i, j, k = (-(-count // BLOCK) for count in self.cells)
        return i, j, k

    def blocks(self, crew: Crew, budget: Budget, box: Ints | None = None) -> Blocks:
        """The blocks that the surface may meet, or those of a box and beside it."""
        region = None
        if box is not None:
            region = np.maximum(box[0] - HALO * BLOCK, 0), np.minimum(box[1] + HALO * BLOCK, self.cells)

        before = 0

        def claim(kept: int, size: int) -> None:
            nonlocal before
            expected = kept * (size // BLOCK) ** 2 * USUAL_BYTES
            budget.claim(8 * kept * BOX_BYTES, expected)
            if kept >= SETTLED:
                budget.claim(expected / (DOUBT if kept < GROWTH * before else GREAT_DOUBT), expected)
            before = kept

        return find_blocks(self.kernels, self.lattice, self.cells, crew, region, claim)

    def claim(self, budget: Budget) -> None:
        """Claim what `whole` would take."""
        claim_only(self.kernels, self.lattice, self.blocks(Crew(), budget), Crew(), budget)

    def whole(self, crew: Crew, budget: Budget) -> Surface:
        """The surface in one piece; its blocks are not inspected yet."""
        crew.stage(20, loops=6)
        blocks = self.blocks(crew, budget)
        made = assemble(self.kernels, self.smooth, self.lattice, blocks, crew, budget)
        return Surface(made.points, made.surface.vertices, made.faces, made.leaf, made.flaws, blocks=blocks)

    def notes(self, blocks: Blocks, crew: Crew) -> tuple[Any, ...]:
        """What `inspect` says of blocks."""
        return () if self.inspect is None else (self.inspect(self.kernels, blocks, self.lattice, crew),)

    def place(self, box: Ints) -> str:
        """The words for a box, its cells and coordinates."""
        low, high = self.lattice[:3] + self.lattice[3:] * box
        ends = ", ".join(f"{a:.4g}..{b:.4g}" for a, b in zip(low, high, strict=True))
        return f"cells {box[0].tolist()} to {(box[1] - 1).tolist()}, coordinates {ends}"


@dataclass(frozen=True)
class Task:
    """A piece to compute: (2, 3) the first cells of its box, and those past its last."""

    job: Job
    box: Ints


def compute(task: Task) -> Piece:
    """The piece of a task; run by whatever executor, in whatever process."""
    job, crew = task.job, Crew()
    budget = Budget(free_memory())
    blocks = job.blocks(crew, budget, task.box)
    made = assemble(job.kernels, job.smooth, job.lattice, blocks, crew, budget)
    return own_piece(made, task.box, job.extent, job.notes(_of(task.box, blocks), crew))


def in_pieces(job: Job, executor: Executor, crew: Crew, budget: Budget) -> Surface:
    """The surface, its pieces computed by an executor; the same bits as `Job.whole`."""
    crew.stage(20, loops=6)
    tasks = [Task(job, box) for box in cut(job.blocks(crew, budget).corner)]
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
