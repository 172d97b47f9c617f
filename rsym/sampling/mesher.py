"""Method `sharp`: closed meshes with exact edges, again and again from the same kernels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from functools import cache, cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.codegen.kernel import checked_threads
from rsym.codegen.leaf_names import leaf_names
from rsym.codegen.program import live
from rsym.codegen.sign_form import surface_form
from rsym.codegen.surface_kernels import SurfaceKernels, padded, surface_kernels
from rsym.errors import RsymError
from rsym.model.shape import Bounds, Shape
from rsym.sampling.lattice import bounds_of, check_in_space, lattice_over
from rsym.sampling.manifolds import sides_of
from rsym.sampling.mesh import Ints, Mesh
from rsym.sampling.progress import Progress
from rsym.sampling.sharp.assembly import Assembly, assemble
from rsym.sampling.sharp.certificates import Form, certify
from rsym.sampling.sharp.finishing import finish
from rsym.sampling.sharp.flaws import find_flaws
from rsym.sampling.sharp.gates import gate_table
from rsym.sampling.sharp.leaves import CompiledLeaves
from rsym.sampling.sharp.strays import stray_vertices
from rsym.sampling.sharp.suspects import Suspect, suspects
from rsym.sampling.status import Findings

Floats: TypeAlias = NDArray[np.float64]

# A leaf with one of these inside may have a kink in its zero set.
_KINKED = frozenset("abs sign min max select joining equivalence absolute_power signed_power".split())


class Mesher:
    """Meshes of one shape: compiled once, for any letters, bounds and resolution.

    Parameters
    ----------
    shape : Shape
        A shape in space.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> r = sp.Symbol("r", real=True)
    >>> ball = rsym.Shape(r**2 - x**2 - y**2 - z**2, (x, y, z), letters={r: 1}, bounds=((-2.5, 2.5),) * 3)
    >>> mesher = rsym.Mesher(ball)
    >>> [round(mesher(64, letters={"r": radius}).status.volume, 1) for radius in (1, 2)]
    [4.2, 33.5]
    """

    def __init__(self, shape: Shape) -> None:
        check_in_space(shape)
        self.shape = shape
        self.form = surface_form(shape).capped()
        self._kernels = surface_kernels(self.form)
        self._smooth = np.array([not self._has_kinks(leaf) for leaf in self.form.leaves])

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """The names of the leaves, the sides of the bounds last."""
        return leaf_names(self.form, self.shape)

    def __call__(
        self,
        resolution: int | Sequence[int] = 128,
        *,
        bounds: Any = None,
        letters: Mapping[Any, float] | None = None,
        cap: bool = True,
        executor: Executor | None = None,
        progress: Progress | None = None,
    ) -> Mesh:
        """The surface for some letters; arguments as in `rsym.mesh`."""
        box = bounds_of(self.shape, bounds)
        lattice = lattice_over(box, resolution)
        kernels = self._kernels.copy()
        kernels.set(self.shape.letters.values_with(letters), box)
        array = np.array([*lattice.origin, *lattice.spacing])
        cells = [count - 1 for count in lattice.counts]
        assembly = assemble(kernels, self._smooth, array, cells, _threads())
        if not assembly.surface.crossings:
            raise _no_surface()
        return self._mesh(assembly, kernels, array, box, cap)

    def _mesh(self, made: Assembly, kernels: SurfaceKernels, lattice: Floats, box: Bounds, cap: bool) -> Mesh:
        flaws = find_flaws(made.faces, made.vertices.points, made.crossings.gradients, lattice, _threads())
        arrays = (made.vertices.points, made.surface.vertices, made.faces, made.crossings.leaf, flaws)
        triangles = finish(kernels, *arrays, lattice, _threads())
        sides = sides_of([symbol.name for symbol in self.shape.coordinates], box)
        first = len(self.form.leaves) - self.form.caps
        clipped = tuple(side.name for k, side in enumerate(sides) if (triangles.leaf == first + k).any())
        if clipped and not cap:
            triangles = triangles.some(triangles.leaf < first)
        findings = Findings(
            clipped_at=clipped,
            capped=cap,
            sides=sides,
            off_surface=stray_vertices(kernels, made.vertices.points, made.surface.vertices, lattice, _threads()),
            unresolved=self._suspects(made, kernels, lattice),
        )
        return Mesh(triangles.vertices, triangles.faces, _Outward(kernels), findings, triangles.leaf, self.leaves)

    def _suspects(self, made: Assembly, kernels: SurfaceKernels, lattice: Floats) -> tuple[Suspect, ...]:
        """What the lattice may have missed."""
        leaves = CompiledLeaves(kernels)
        form = Form(leaves, len(self.form.leaves), gate_table(self.form))
        unresolved = certify(form, lattice, made.blocks.corner, made.blocks.words, pool=_threads())
        return suspects(leaves, lattice, unresolved, self.leaves if len(unresolved) else ())

    def _has_kinks(self, leaf: int) -> bool:
        nodes = self.form.builder.nodes
        operations = {nodes[number].operation for number in live(nodes, [leaf])}
        return bool(operations & _KINKED) or any("junction" in operation for operation in operations)


class _Outward:
    """Minus the gradients of leaves at points, with the letters of one mesh."""

    def __init__(self, kernels: SurfaceKernels) -> None:
        self._kernels = kernels

    def __call__(self, leaf: Ints, points: Floats) -> Floats:
        count = len(points)
        places, gradient = np.zeros((3, padded(count))), np.zeros((3, padded(count)))
        which, value = np.full(places.shape[1], -1, np.int16), np.empty(places.shape[1])
        places[:, :count], which[:count] = points.T, leaf
        self._kernels.leaf(count, which, places, value, gradient)
        return -gradient[:, :count].T


def _no_surface() -> RsymError:
    return RsymError(
        "the surface does not meet the bounds",
        code="no-surface",
        remedy="check bounds and letters; take a higher resolution if the body is thin",
    )


@cache
def _threads() -> ThreadPoolExecutor:
    """Threads of all meshers of this process."""
    return ThreadPoolExecutor(checked_threads(None), thread_name_prefix="rsym-mesher")
