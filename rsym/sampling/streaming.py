"""Meshes larger than memory: pieces to disk, and from there into the file, the same bytes as of the uncut mesh.

A piece is a box of the lattice. Boxes that do not fit into what is left of the memory are cut along their first axis
that has several blocks, so that pieces follow each other in the order of the surface. Pieces that are done lie in the
folder ``NAME.parts`` beside the file until it is whole: whoever comes again goes on from there. Flaws are mended where
all pieces are known (`sharp.mending`); then vertices and faces are written one after the other.
"""

from __future__ import annotations

import hashlib
import json
import math
import shutil
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.atomic import target_of, writing
from rsym.errors import RsymError
from rsym.sampling.memory import Budget, TooLarge, resident, size_of
from rsym.sampling.mesh_writer import MeshWriter, Streamed
from rsym.sampling.progress import Crew
from rsym.sampling.sharp.assembly import BESIDE_BYTES, USUAL_BYTES, Assembly, Job, assemble
from rsym.sampling.sharp.certificates import joined
from rsym.sampling.sharp.mending import mend, to_mend
from rsym.sampling.sharp.pieces import Piece, own_piece
from rsym.sampling.sharp.signs import BLOCK, Blocks, inside
from rsym.sampling.sharp.stored import StoredPiece, Surface, keep
from rsym.version import __version__

# For what does not grow with a piece: loops in threads, batches of boxes to certify, rows on their way to the file.
RESERVE = 1.2e8
# The least that a piece needs to get anywhere: a few hundred blocks.
LEAST = 5e7
# Larger pieces save nothing, and more is lost with one.
MOST = 4e9
# A piece that is cut out holds two thirds of what it took to compute it.
BESIDE = 0.25
# Of what is free, what a piece may take that is foretold: how many blocks there are is known within a twentieth.
FILL = 0.92
LAYOUT = 2  # of the folder


def key_of(job: Job, letters: Any, box: Any) -> str:
    """A hash of all that the triangles depend on."""
    form = job.kernels.form
    program = form.builder.program({"value": form.value}).digest
    parts = (__version__, LAYOUT, program, form.leaves, form.gates, form.caps, sorted(letters.items()), box, job.cells)
    return hashlib.sha256(f"{parts}{job.lattice.tobytes().hex()}".encode()).hexdigest()


def stream(job: Job, path: Path, key: str, crew: Crew, pool: Executor, memory: float) -> Streamed | None:
    """The surface of a job into a file; None where there is no surface."""
    budget = Budget(min(_free(memory), MOST))
    try:
        return _streamed(job, path, key, crew, pool, budget)
    except TooLarge as error:
        raise RsymError(
            f"a piece needs about {size_of(error.need)} of memory, {size_of(error.free)} are left for it",
            code="memory",
            remedy=f'give memory="{math.ceil((memory + error.need - error.free) / 1e8) / 10:.1f}GB" or more',
        ) from None


def _streamed(job: Job, path: Path, key: str, crew: Crew, pool: Executor, budget: Budget) -> Streamed | None:
    with writing(path):
        folder = _opened(path, key)
        crew.stage(800)
        with ThreadPoolExecutor(1, "rsym-pieces") as beside:
            found = list(_Pieces(job, folder, crew, pool, budget, beside).all())
        pieces = [StoredPiece(one, box) for one, box in found]
        surface = Surface(pieces, job.extent)
        notes = joined([piece.notes for piece in pieces]) if pieces else None
        if not surface.crossings or notes is None:
            shutil.rmtree(folder, ignore_errors=True)
            return None
        crew.stage(20)
        changes = mend(job.kernels, surface, job.lattice, crew, budget)
        crew.stage(180)
        writer = MeshWriter(job, surface, changes, crew, pool)
        writer.into(path)
        shutil.rmtree(folder, ignore_errors=True)
    return writer.found(notes)


def parts_of(path: Path) -> Path:
    """The folder of the pieces of a file."""
    target = target_of(path)
    return target.with_name(target.name + ".parts")


def _opened(path: Path, key: str) -> Path:
    """The folder of the pieces, without those of another surface."""
    folder = parts_of(path)
    sign = folder / "surface.json"
    if folder.exists():
        if not sign.is_file() and any(folder.iterdir()):
            raise RsymError(
                f"the folder {folder.name!r} holds something else",
                code="file-folder",
                where=str(folder),
                remedy="move it away, or choose another name for the file",
            )
        if sign.is_file() and _key_in(sign) == key:
            return folder
        shutil.rmtree(folder)
    folder.mkdir()
    draft = folder / "surface.draft"
    draft.write_text(json.dumps({"layout": LAYOUT, "key": key}))
    draft.rename(sign)
    return folder


def _key_in(sign: Path) -> str:
    try:
        return str(json.loads(sign.read_text())["key"])
    except (ValueError, KeyError, TypeError):
        return ""


def _free(memory: float) -> float:
    """What pieces may take of the memory, as the process stands."""
    taken = resident()
    free = memory - taken - RESERVE
    if free < LEAST:
        raise RsymError(
            f"{size_of(memory)} of memory are too little: {size_of(taken)} are taken already",
            code="memory",
            remedy=f'give memory="{math.ceil((taken + RESERVE + 2 * LEAST) / 1e8) / 10:.1f}GB" or more',
        )
    return free


@dataclass(frozen=True)
class _Shared(Budget):
    """A budget of which some is taken until a piece is finished; whoever wants more than is left waits for that."""

    finished: Callable[[], None] = lambda: None

    def claim(self, need: float, expected: float = 0.0) -> None:
        """As of any budget."""
        if need > BESIDE * self.free:
            self.finished()
        super().claim(need, expected)


class _Pieces:
    """The pieces of a job, each computed unless it is there.

    What is left to do for one in a single thread, cutting it out and writing it, is done `beside` the first steps for
    the next, which take little memory.
    """

    def __init__(
        self, job: Job, folder: Path, crew: Crew, pool: Executor, budget: Budget, beside: ThreadPoolExecutor
    ) -> None:
        self._job, self._folder, self._crew, self._pool, self._beside = job, folder, crew, pool, beside
        self._budget = _Shared(budget.free, self._finished)
        self._last: Future[None] | None = None

    def all(self) -> Iterator[tuple[Path, Ints]]:
        """Folder and box of each, in order; those there are when all have been asked for."""
        extent = np.array(self._job.extent)
        yield from self._of(np.stack([np.zeros(3, np.int64), extent * BLOCK]), 0.0, 1.0)
        self._finished()

    def _finished(self) -> None:
        """Wait until the piece before is there."""
        if self._last is not None:
            self._last.result()

    def _of(self, box: Ints, begin: float, end: float) -> Iterator[tuple[Path, Ints]]:
        """The pieces of a box; it takes the progress from one share to another."""
        folder = self._folder / "-".join(map(str, box.ravel()))
        cut = folder.with_suffix(".cut")
        if not folder.is_dir():
            if not cut.is_file():
                try:
                    self._compute(box, folder, begin, end)
                except TooLarge as error:
                    draft = folder.with_suffix(".draft")
                    draft.write_text(json.dumps(self._places(box, error)))
                    draft.rename(cut)
            if cut.is_file():
                boxes = _cut(box, json.loads(cut.read_text()))
                ends = begin + (end - begin) * np.arange(len(boxes) + 1) / len(boxes)
                for one, (low, high) in zip(boxes, pairwise(ends.tolist()), strict=True):
                    yield from self._of(one, low, high)
                return
        self._crew.stages.reach(end)
        yield folder, box

    def _places(self, box: Ints, error: TooLarge) -> list[int]:
        """The layers of a box, along the axis that it is cut along, at which a piece begins that fits."""
        axis = _axis(box)
        if axis is None:
            raise error
        blocks = self._job.layers(Crew(self._pool), self._budget, box, axis)
        blocks *= max(1.0, error.need / max(1.0, USUAL_BYTES * float(blocks.sum())))
        return places(USUAL_BYTES * blocks[1:-1], BESIDE_BYTES * blocks, FILL * error.free)

    def _compute(self, box: Ints, folder: Path, begin: float, end: float) -> None:
        job, outer = self._job, self._crew

        def reached(done: int, total: int) -> None:
            outer.stages.reach(begin + (end - begin) * done / total)

        crew = Crew(self._pool, reached)
        blocks = job.blocks(crew, self._budget, box)
        made = assemble(job, blocks, crew, self._budget, box)
        self._finished()
        own = inside(blocks.corner, box)
        own_blocks = Blocks(np.ascontiguousarray(blocks.corner[:, own]), blocks.words[own], blocks.visited)
        piece = self._beside.submit(_cut_out, job, made, box)
        del made, blocks
        self._last = self._beside.submit(_keep, folder, piece, job.notes(own_blocks, crew))


def _cut_out(job: Job, made: Assembly, box: Ints) -> tuple[Piece, Ints]:
    """The piece of a box, and its crossings to mend."""
    piece = own_piece(made, box, job.extent)
    return piece, to_mend(job.kernels, piece)


def _keep(folder: Path, made: Future[tuple[Piece, Ints]], notes: tuple[Any, ...]) -> None:
    piece, seeds = made.result()
    keep(folder, replace(piece, surface=replace(piece.surface, notes=notes)), seeds)


def _axis(box: Ints) -> int | None:
    """The first axis of a box along which it has several blocks."""
    several = np.flatnonzero(box[1] - box[0] > BLOCK)
    return int(several[0]) if len(several) else None


def places(own: Floats, beside: Floats, free: float) -> list[int]:
    """The layers, but for the first, at which pieces begin that need no more than is free.

    `own` is what each layer needs, ``beside[1:-1]`` what it needs where it is beside a piece, as the two at its ends
    are. Of a layer that needs more a piece is made all the same, and there are two pieces at least.

    Examples
    --------
    >>> places(np.ones(6), np.ones(8), 5.0)
    [3]
    >>> places(np.array([1.0, 1, 9, 1, 1, 1]), np.zeros(8), 4.0)
    [2, 3]
    """
    count, found = len(own), list[int]()
    before = np.cumsum([0.0, *own])
    begin = 0
    while True:
        need = before[begin + 1 :] - before[begin] + beside[begin] + beside[begin + 2 :]
        begin += max(1, int(np.flatnonzero(need <= free).max(initial=-1)) + 1)
        if begin >= count:
            return found or [min(max(1, int(np.searchsorted(before, before[-1] / 2))), count - 1)]
        found.append(begin)


def _cut(box: Ints, places: Sequence[int]) -> list[Ints]:
    """A box cut at layers along its first axis of several blocks."""
    axis = _axis(box)
    assert axis is not None
    ends = [box[0, axis], *(box[0, axis] + BLOCK * np.array(places)), box[1, axis]]
    boxes = []
    for low, high in pairwise(ends):
        one = box.copy()
        one[:, axis] = low, high
        boxes.append(one)
    return boxes
