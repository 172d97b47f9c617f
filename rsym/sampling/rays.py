"""Rays cast at the sign form of a shape: what they meet first, without a mesh and without a resolution."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cached_property, partial
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats, Ints, Shorts
from rsym.backends.kernel import checked_threads
from rsym.backends.registry import default_backend
from rsym.errors import RsymError
from rsym.model.bounding import checked_bounds
from rsym.model.recent import recently
from rsym.model.shape import Bounds, Shape
from rsym.sampling.form_signs import check_parameters
from rsym.sampling.hits import Hits, Rays, Seen
from rsym.sampling.labels import Labeller, Labels
from rsym.sampling.leaf_fields import SIDES, LeafFields
from rsym.sampling.pencils import Beams, Cut, Pencil, as_cuts
from rsym.sampling.ray_march import ArrayRays
from rsym.sampling.windows import bounds_or_extent

# Of the diagonal of the bounds: how fine rays look that are not those of a picture.
FINE = 1e-4


class Caster:
    """Casts rays at a shape in space; compiled once, for all letters.

    The body is cut off at its bounds, as meshes are: the sides are leaves too, and cuts likewise.

    Parameters
    ----------
    shape : Shape
        In space.
    letters : mapping, optional
        Values of letters; `set` changes them, and compiles nothing.
    bounds : sequence of pairs, optional
        Instead of those of the shape; without any its extent.
    threads : int, optional
        By default as many as there are processors; the bits do not depend on it.

    Raises
    ------
    RsymError
        For a shape in the plane, unknown letters, or a body without bounds that goes on for ever.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> half = rsym.Shape(rsym.conjunction((4 - x**2 - y**2 - z**2) / 4, z), (x, y, z), bounds=((-3, 3),) * 3)
    >>> caster = Caster(half)
    >>> hits = caster.cast([[0.0, 0.0, 5.0], [0.0, 0.0, -5.0], [4.0, 0.0, 0.0]], [[0, 0, -1], [0, 0, 1], [0, 1, 0]])
    >>> hits.depth.round(9).tolist(), hits.leaf.tolist()
    ([3.0, 5.0, inf], [0, 1, -1])
    >>> hits.normal[1].round(9).tolist()
    [-0.0, -0.0, -1.0]
    """

    def __init__(
        self,
        shape: Shape,
        letters: Mapping[Any, float] | None = None,
        *,
        bounds: Any = None,
        threads: int | None = None,
    ) -> None:
        self.shape = shape
        self.threads = checked_threads(threads)
        self._leaf_fields, self._kernels = _made(shape, default_backend())
        self._bounds = None if bounds is None else checked_bounds(bounds, 3)
        self.letters: dict[str, float] = {}
        self.set(letters)

    def set(self, letters: Mapping[Any, float] | None = None) -> None:
        """Take letters, the others at their defaults."""
        self.letters = self.shape.letters.values_with(letters)
        check_parameters(self._leaf_fields.form, self.letters)
        for name in ("bounds", "_constants"):
            self.__dict__.pop(name, None)

    @cached_property
    def bounds(self) -> Bounds:
        """The box that the body is cut off at, for the letters as they are."""
        return bounds_or_extent(self.shape, self._bounds, self.letters)

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """The names of the leaves, the sides of the bounds last."""
        sides = [f"cap {name} {end}" for name in self.shape.coordinates for end in ("lower", "upper")]
        with _naming:
            return (*self._leaf_fields.leaves, *sides)

    def cast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        *,
        near: float = 0.0,
        far: float = np.inf,
        cuts: Iterable[Cut] = (),
        pixel: tuple[float, float] | None = None,
    ) -> Hits:
        """What rays meet first between the distances `near` and `far`.

        Parameters
        ----------
        origins, directions : array_like (..., 3)
            They broadcast; directions may have any length, distances are in the unit of the coordinates.
        near, far : float
            Where the rays begin and end; a ray that begins inside the body meets it there.
        cuts : sequence of Cut
            Half-spaces that the body is cut by: cut k is leaf ``len(caster.leaves) + k``.
        pixel : (float, float), optional
            How fine to look: a pixel has the size ``pixel[0] + distance*pixel[1]``; what is far smaller may be missed.

        Raises
        ------
        RsymError
            For arrays that do not broadcast, or a direction without length.
        """
        start, along = _checked_rays(origins, directions)
        size = self._fine if pixel is None else pixel
        chosen = as_cuts(cuts)
        flat = start.reshape(-1, 3), along.reshape(-1, 3)
        seen = self._kernels.rays(*flat, (near, far), size, self._planes(chosen), self._constants, self.threads)
        return self._hits(seen.reshaped(start.shape[:-1]), lambda: (start, along), chosen)

    def look(self, pencil: Pencil, *, near: float = -np.inf, far: float = np.inf, cuts: Iterable[Cut] = ()) -> Hits:
        r"""What the rays of a picture meet first, in arrays (rows, columns); with an eye they begin at it.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y, z
        >>> ball = rsym.Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z), bounds=((-3, 3),) * 3)
        >>> pencil = Pencil((8, 4), (-4, 2, 9), (1, 0, 0), (0, -1, 0), direction=(0, 0, -1))
        >>> print("\n".join("".join("-#"[int(met)] for met in row) for row in Caster(ball).look(pencil).met))
        ---##---
        --####--
        --####--
        ---##---
        """
        chosen, begin = as_cuts(cuts), max(near, 0.0) if pencil.eye is not None else near
        seen = self._kernels.picture(pencil, begin, far, self._planes(chosen), self._constants, self.threads)
        return self._hits(seen, pencil.rays, chosen)

    def starts(
        self,
        pencil: Pencil,
        *,
        which: Ints | None = None,
        near: ArrayLike = -np.inf,
        far: ArrayLike = np.inf,
        cuts: Iterable[Cut] = (),
    ) -> Floats:
        """Where beams round the pixels of a pencil (rows, columns) may meet something; inf where nothing can be met.

        Proved by enclosures: no body, however thin, is in a pixel with inf.

        Parameters
        ----------
        which : (n,) array of int, optional
            Pixels by number, row by row; then an array (n,).
        near, far : array_like
            Where beams begin, and where they end: of each of these pixels.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y, z
        >>> needle = rsym.Shape(1e-6 - x**2 - y**2, (x, y, z), bounds=((-3, 3),) * 3)
        >>> pencil = Pencil((4, 1), (-2, 0.5, 9), (1, 0, 0), (0, -1, 0), direction=(0, 0, -1))
        >>> np.isfinite(Caster(needle).starts(pencil)).tolist(), Caster(needle).look(pencil).met.tolist()
        ([[False, True, True, False]], [[False, False, False, False]])
        """
        width, height = pencil.size
        pixels = np.arange(width * height) if which is None else which
        beams = Beams(pixels, *(np.broadcast_to(np.asarray(end, np.float64), pixels.shape) for end in (near, far)))
        planes = self._planes(as_cuts(cuts))
        found = self._kernels.starts(pencil, beams, planes, self._constants, self.threads)
        return found.reshape(height, width) if which is None else found

    @property
    def _fine(self) -> tuple[float, float]:
        return FINE * float(np.linalg.norm([high - low for low, high in self.bounds])), 0.0

    def _hits(self, seen: Seen, rays_of: Rays, cuts: tuple[Cut, ...]) -> Hits:
        return Hits(
            seen.depth,
            seen.leaf,
            np.moveaxis(seen.normal, 0, -1),
            seen.doubt > 0,
            rays_of,
            partial(self._fields_at, self.letters, cuts),
            partial(self._called, self.letters),
        )

    def _called(self, letters: Mapping[str, float], points: Floats, leaf: Shorts) -> Labels:
        """What points are called; on a cut they have no name."""
        known = np.where(leaf < len(self.leaves), leaf, -1)
        return Labeller(self.shape, letters, self.leaves[len(self._leaf_fields.form.leaves) :])(points, known)

    def _planes(self, cuts: tuple[Cut, ...]) -> Floats:
        """The half-spaces of the bounds and of the cuts: outer normal and offset."""
        planes = []
        for axis, (low, high) in enumerate(self.bounds):
            unit = np.eye(3)[axis]
            planes += [[*-unit, -low], [*unit, high]]
        return np.array([*planes, *([*cut.normal, cut.offset] for cut in cuts)])

    @cached_property
    def _constants(self) -> Any:
        return self._kernels.constants(self.letters, self.bounds)

    def _fields_at(
        self, letters: Mapping[str, float], cuts: tuple[Cut, ...], names: tuple[str, ...], leaf: Shorts, points: Floats
    ) -> dict[str, Floats]:
        """Fields of leaves; those of a cut are those of a side of the bounds, but for their directions."""
        fields = LeafFields(self.shape, names, letters) if names else replace(self._leaf_fields, letters=letters)
        count = len(fields.form.leaves)
        known = np.where(leaf < count + SIDES, leaf, count).astype(np.int64)
        found = fields.at(known, points) if len(points) else fields.at(np.zeros(1, np.int64), np.zeros((1, 3)))
        result = {name: values[: len(points)] for name, values in found.items()}
        for k, cut in enumerate(cuts):
            result["gradient"][leaf == count + SIDES + k] = -np.array(cut.normal)
        return result


class Kernels(Protocol):
    """What casts rays: `RayKernels`, or `ArrayRays` where there is no compiler."""

    def constants(self, letters: Mapping[str, float], bounds: Bounds) -> Any:
        """What is made of letters, once."""

    def picture(self, pencil: Pencil, near: float, far: float, planes: Floats, constants: Any, threads: int) -> Seen:
        """What the rays of a pencil meet within planes (n, 4), the sides of the bounds first."""

    def starts(self, pencil: Pencil, beams: Beams, planes: Floats, constants: Any, threads: int) -> Floats:
        """Where beams may meet something; inf where they cannot."""

    def rays(
        self,
        origins: Floats,
        directions: Floats,
        ends: tuple[float, float],
        pixel: tuple[float, float],
        planes: Floats,
        constants: Any,
        threads: int,
    ) -> Seen:
        """What rays (n, 3) meet."""


_naming = threading.Lock()  # names are made with the nodes of a form that casters share


@recently(32)
def _made(shape: Shape, backend: str) -> tuple[LeafFields, Kernels]:
    """What casters of a shape share."""
    fields = LeafFields(shape)
    fields.form.require_traced()
    return fields, _kernels(fields, backend)


def _kernels(fields: LeafFields, backend: str) -> Kernels:
    if backend != "llvm":
        return ArrayRays(fields)
    from rsym.sampling.kernels.ray_kernels import ray_kernels

    return ray_kernels(fields.form)


def _checked_rays(origins: ArrayLike, directions: ArrayLike) -> tuple[Floats, Floats]:
    """Origins and unit directions of one shape (..., 3)."""
    try:
        start, along = np.broadcast_arrays(np.asarray(origins, np.float64), np.asarray(directions, np.float64))
    except (TypeError, ValueError) as error:
        raise RsymError(
            "origins and directions of rays must be arrays (..., 3) that broadcast", code="array"
        ) from error
    if start.shape[-1:] != (3,):
        raise RsymError(f"origins and directions of rays are (..., 3), got {start.shape}", code="array")
    lengths = np.sqrt(np.einsum("...k,...k->...", along, along))
    if not ((lengths > 0) & np.isfinite(lengths)).all() or not np.isfinite(start).all():
        raise RsymError("the direction of a ray is finite and not 0, its origin finite", code="rays")
    return start, along / lengths[..., None]
