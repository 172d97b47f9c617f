"""Method `sharp`: closed meshes with exact edges, again and again from the same kernels."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, TypeAlias

import numpy as np

from rsym.arrays import Floats, Integers
from rsym.backends.kernel import checked_threads, lasting_threads
from rsym.errors import RsymError
from rsym.logic.leaf_names import leaf_names
from rsym.logic.lifting import lifted, opened, origins
from rsym.logic.sign_form import SignForm, has_kinks, surface_form
from rsym.model.shape import Bounds, Shape
from rsym.sampling.blanks import where_it_lies
from rsym.sampling.kernels.mesher_kernels import MesherKernels, backend_for, mesher_kernels
from rsym.sampling.labels import Labeller, Labels
from rsym.sampling.lattice import lattice_over, sides_of
from rsym.sampling.memory import SURE, Budget, TooLarge, bytes_of, free_memory, refusal, scaled
from rsym.sampling.mesh import Mesh, MeshRequest
from rsym.sampling.mesh_file import FileStatus, MeshFile
from rsym.sampling.progress import Crew
from rsym.sampling.regions.region_kernels import region_kernels
from rsym.sampling.regions.regions import Regions, whole_form
from rsym.sampling.sharp.assembly import MOST_BLOCKS, USUAL_BYTES, Job, Unfinished, claim_whole, whole
from rsym.sampling.sharp.certificates import Form, Unresolved, certify, joined
from rsym.sampling.sharp.corners import stray_vertices
from rsym.sampling.sharp.crossings import CompiledLeaves
from rsym.sampling.sharp.finishing import Finished, finish
from rsym.sampling.sharp.pieces import in_pieces
from rsym.sampling.sharp.signs import Blocks
from rsym.sampling.sharp.suspects import suspects
from rsym.sampling.status import Findings, Suspect
from rsym.sampling.streaming import key_of, stream
from rsym.sampling.windows import bounds_or_extent

Resolution: TypeAlias = int | Sequence[int]

# Along a side: the names of vertices are 64-bit integers, and indices pass through float32.
MOST_CELLS = 2**20

# Bytes for what does not grow with the surface: batches of boxes to certify, and of points in the loops.
RESERVE = 1e8
# A trial tells whether a smaller resolution fits; with more than this it takes longer than somebody waits for an error.
TRIAL = 5e8
PACE = 96  # cells along a side of the mesh that tells how long blocks take

# Of cells: the fourth power of a side is a number.
LEAST = 1e-70


class SharpMesher:
    """What stands behind `rsym.Mesher`; arguments as there, and the form of the shape where that is known."""

    def __init__(self, shape: Shape, backend: str | None = None, form: SignForm | None = None) -> None:
        self.shape = shape
        self.form = opened(surface_form(shape)).capped() if form is None else form
        self.form.require_traced()
        by_tapes = backend_for(self.form, backend) == "tape"
        self._kernels: Any = region_kernels(self.form) if by_tapes else mesher_kernels(self.form)
        self._region = whole_form(self.form)
        self._smooth = np.array([not has_kinks(self.form.builder, leaf) for leaf in self.form.leaves])

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """The names of the leaves, the sides of the bounds last."""
        return leaf_names(self.form, self.shape)

    @cached_property
    def _origins(self) -> Integers:
        """The leaves of the shape that those of the form come from, the sides of the bounds behind them."""
        own = surface_form(self.shape)
        large = [lifted(own.builder, leaf) for leaf in own.leaves]
        found = origins(own, large, opened(own))
        return np.array([*found, *range(len(own.leaves), len(own.leaves) + self.form.caps)])

    def __call__(self, request: MeshRequest) -> Mesh:
        """The surface for some letters."""
        box = self._box(request)
        job = self._job(request.resolution, box, request.letters)
        crew = Crew(_threads(), request.progress)
        surface = self._surface(job, request, crew)
        if not len(surface.faces):
            missed = self._suspects(surface.notes, surface.blocks, job, request.letters)
            raise _no_surface(missed, "" if missed else where_it_lies(self.shape, request.letters))
        crew.stage(50, loops=20)
        triangles = finish(job.kernels, surface, job.lattice, crew)
        mesh = self._mesh(triangles, surface, job, box, request)
        if request.progress is not None:
            crew.stage(250, loops=1)
            mesh.findings  # noqa: B018 - who watches the progress waits for these too
        crew.stages.finish()
        return mesh

    def stream(self, request: MeshRequest) -> MeshFile:
        """The surface into a file, in pieces."""
        assert request.into is not None
        box = self._box(request)
        job = self._job(request.resolution, box, request.letters)
        crew, memory = Crew(_threads(), request.progress), bytes_of(request.memory)
        key = key_of(job, self.shape.letters.values_with(request.letters), box)
        made = stream(job, request.into, key, crew, _threads(), memory)
        if made is None:
            missed = self._suspects(job.notes(job.blocks(crew, Budget()), crew), None, job, request.letters)
            raise _no_surface(missed, "" if missed else where_it_lies(self.shape, request.letters))
        missed = self._suspects((made.unresolved,), None, job, request.letters)
        sides = sides_of([symbol.name for symbol in self.shape.coordinates], box)
        first = len(self.form.leaves) - self.form.caps
        status = FileStatus(
            clipped_at=tuple(side.name for k, side in enumerate(sides) if made.leaves[first + k]),
            capped=request.cap,
            sides=sides,
            resolution=request.resolution,
            off_surface=made.strays,
            unresolved=missed,
            vertices=made.vertices,
            triangles=made.faces,
            unpaired=made.unpaired,
            volume=made.volume,
            area=made.area,
            bounds=tuple(zip(made.low.tolist(), made.high.tolist(), strict=True)),
            pieces=made.pieces,
            memory=memory,
        )
        crew.stages.finish()
        return MeshFile(request.into, status)

    def _box(self, request: MeshRequest) -> Bounds:
        return bounds_or_extent(self.shape, request.bounds, request.letters)

    def _job(self, resolution: Resolution, box: Bounds, letters: Mapping[Any, float] | None) -> Job:
        lattice = lattice_over(box, resolution, math.inf)
        cells = tuple(count - 1 for count in lattice.counts)
        if max(cells) > MOST_CELLS:
            raise RsymError(
                f"resolution {resolution} has {max(cells)} cells along a side",
                code="resolution",
                remedy=f"take at most {MOST_CELLS}",
            )
        if not LEAST < min(lattice.spacing) <= max(lattice.spacing) < 1 / LEAST:
            raise RsymError(
                f"cells have sides from {min(lattice.spacing):.3g} to {max(lattice.spacing):.3g}; the square of the "
                f"area of a triangle is a number only between {LEAST:g} and {1 / LEAST:g}",
                code="size",
                remedy="take another unit: shape.scale(k), then mesh.vertices/k",
            )
        kernels = self._kernels.copy()
        kernels.set(self.shape.letters.values_with(letters), box)
        corner = np.array([*lattice.origin, *lattice.spacing])
        return Job(kernels, self._smooth, corner, cells, partial(_unresolved, self._region))

    def _surface(self, job: Job, request: MeshRequest, crew: Crew) -> Unfinished:
        """The surface of a job, here or by an executor; what has no memory is refused, and what fits is named."""
        budget = Budget() if request.force else Budget(max(0.0, free_memory() - RESERVE))
        try:
            return (
                whole(job, crew, budget) if request.executor is None else in_pieces(job, request.executor, crew, budget)
            )
        except TooLarge as error:
            made = partial(self._job, box=self._box(request), letters=request.letters)
            fits = _fitting(made, request.resolution, error, budget.free)
            seconds = _seconds(made(PACE), error.need)
            raise refusal(request.resolution, fits, error.need, seconds, error.free) from None

    def _mesh(self, triangles: Finished, surface: Unfinished, job: Job, box: Bounds, request: MeshRequest) -> Mesh:
        """The triangles with what is known of them; what takes a second look at the lattice waits until it is asked."""
        sides = sides_of([symbol.name for symbol in self.shape.coordinates], box)
        first = len(self.form.leaves) - self.form.caps
        clipped = tuple(side.name for k, side in enumerate(sides) if (triangles.leaf == first + k).any())
        if clipped and not request.cap:
            triangles = triangles.some(triangles.leaf < first)
        known = Findings(clipped_at=clipped, capped=request.cap, sides=sides, resolution=request.resolution)
        find = partial(self._findings, known, triangles.vertices, surface.notes, surface.blocks, job, request.letters)
        return Mesh(
            triangles.vertices,
            triangles.faces,
            _Outward(job.kernels),
            find,
            triangles.leaf,
            self.leaves,
            called=partial(self._labels, request.letters),
        )

    def _labels(self, letters: Mapping[Any, float] | None, points: Floats, leaf: Integers) -> Labels:
        """What points on leaves are called."""
        first = len(self.form.leaves) - self.form.caps
        return Labeller(self.shape, letters, self.leaves[first:])(points, self._origins[leaf])

    def _findings(
        self,
        known: Findings,
        vertices: Floats,
        notes: tuple[Unresolved, ...],
        blocks: Blocks | None,
        job: Job,
        letters: Mapping[Any, float] | None,
    ) -> Findings:
        """What is known, and what only a second look at the lattice and the vertices tells."""
        strays = stray_vertices(job.kernels, vertices, job.lattice, _threads())
        return replace(known, off_surface=strays, unresolved=self._suspects(notes, blocks, job, letters))

    def _suspects(
        self,
        notes: tuple[Unresolved, ...],
        blocks: Blocks | None,
        job: Job,
        letters: Mapping[Any, float] | None,
    ) -> tuple[Suspect, ...]:
        """What the lattice may have missed."""
        unresolved = joined(notes if blocks is None else job.notes(blocks, Crew(_threads())))
        found = suspects(CompiledLeaves(job.kernels), job.lattice, unresolved, self.leaves if len(unresolved) else ())
        labeller, cell = Labeller(self.shape, letters), float(job.lattice[3:].max())

        def called(one: Suspect) -> tuple[str, ...]:
            return tuple(labeller.there(name, np.array([one.place]), one.thickness * cell) for name in one.names)

        return tuple(replace(one, names=called(one)) for one in found)


def _unresolved(region: Regions, kernels: MesherKernels, blocks: Blocks, lattice: Floats, pool: Executor) -> Unresolved:
    """The cells of blocks that have no certificate."""
    form = Form(CompiledLeaves(kernels), len(kernels.form.leaves), region)
    return certify(form, lattice, blocks.corner, blocks.words, pool=pool)


class _Outward:
    """Minus the gradients of leaves at points, with the letters of one mesh."""

    def __init__(self, kernels: MesherKernels) -> None:
        self._kernels = kernels

    def __call__(self, leaf: Integers, points: Floats) -> Floats:
        _, gradient = CompiledLeaves(self._kernels).evaluate(leaf.astype(np.int16), points.T)
        return -gradient.T


def _fitting(job: Callable[[Resolution], Job], resolution: Resolution, refused: TooLarge, free: float) -> Resolution:
    """A smaller resolution that fits: as a trial tells, or where that takes long as surfaces grow."""
    share = refused.share
    if free > TRIAL:
        most = min(free, MOST_BLOCKS * USUAL_BYTES)
        return scaled(resolution, SURE * math.sqrt(most / refused.need))
    while True:
        resolution = scaled(resolution, min(share, SURE))
        try:
            claim_whole(job(resolution), Budget(SURE * free))
        except TooLarge as error:
            if np.max(resolution) <= 2:
                raise
            share = error.share
        else:
            return resolution


def _seconds(small: Job, need: float) -> float:
    """How long a surface of so many bytes takes, as a small one tells."""
    for _ in range(2):  # the first loads the loops
        start = time.perf_counter()
        blocks = whole(small, Crew(_threads()), Budget()).blocks
        elapsed = time.perf_counter() - start
    return elapsed * need / (USUAL_BYTES * max(1, 0 if blocks is None else blocks.corner.shape[1]))


def _no_surface(missed: Sequence[Suspect], there: str) -> RsymError:
    """No lattice point is inside; what the lattice may have missed is said."""
    return RsymError(
        " ".join(["the surface does not meet a lattice line in the bounds.", *(one.remark for one in missed[:3])])
        if missed
        else "the surface does not meet the bounds",
        code="no-surface",
        remedy="take a higher resolution" if missed else there or "check bounds and letters",
    )


def _threads() -> ThreadPoolExecutor:
    """Threads of all meshers of this process."""
    return lasting_threads("rsym-mesher", checked_threads(None))
