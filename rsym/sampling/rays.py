"""Rays cast at the sign form of a shape: what they meet first, without a mesh and without a resolution."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Flags, Floats, Shorts
from rsym.backends.kernel import checked_threads
from rsym.errors import RsymError
from rsym.model.equation import checked_bounds
from rsym.model.shape import Bounds, Shape
from rsym.sampling.extent import extent
from rsym.sampling.hits import Hits
from rsym.sampling.leaf_fields import SIDES, LeafFields
from rsym.sampling.pencils import Cut, Pencil, as_cuts

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
        self._leaf_fields = LeafFields(shape)
        self.shape = shape
        self.threads = checked_threads(threads)
        self._bounds = None if bounds is None else checked_bounds(bounds, 3)
        self.letters: dict[str, float] = {}
        self.set(letters)

    def set(self, letters: Mapping[Any, float] | None = None) -> None:
        """Take letters, the others at their defaults."""
        self.letters = self.shape.letters.values_with(letters)
        self.__dict__.pop("bounds", None)

    @cached_property
    def bounds(self) -> Bounds:
        """The box that the body is cut off at, for the letters as they are."""
        return self._bounds or self.shape.bounds or extent(self.shape, self.letters)

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """The names of the leaves, the sides of the bounds last."""
        sides = [f"cap {name} {end}" for name in self.shape.coordinates for end in ("lower", "upper")]
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
        return self._hits(start, along, near, far, as_cuts(cuts), size)

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
        start, along = pencil.rays()
        near = max(near, 0.0) if pencil.eye is not None else near
        return self._hits(start, along, near, far, as_cuts(cuts), pencil.pixel)

    @property
    def _fine(self) -> tuple[float, float]:
        return FINE * float(np.linalg.norm([high - low for low, high in self.bounds])), 0.0

    def _hits(
        self,
        origins: Floats,
        directions: Floats,
        near: float,
        far: float,
        cuts: tuple[Cut, ...],
        pixel: tuple[float, float],
    ) -> Hits:
        shape = origins.shape[:-1]
        o, d = origins.reshape(-1, 3), directions.reshape(-1, 3)
        depth, leaf = self._cast(o, d, near, far, cuts)
        normal = self._normals(o, d, depth, leaf, cuts)
        return Hits(
            depth.reshape(shape),
            leaf.reshape(shape),
            normal.reshape(*shape, 3),
            np.zeros(shape, bool),
            lambda: (origins, directions),
            partial(self._fields_at, self.letters, cuts),
        )

    def _cast(self, o: Floats, d: Floats, near: float, far: float, cuts: tuple[Cut, ...]) -> tuple[Floats, Shorts]:
        """By dense sampling: slow, and blind for what is thin. To be replaced."""
        first, last, entry = self._within(o, d, near, far, cuts)
        depth, leaf = np.full(len(o), np.inf), np.full(len(o), -1, np.int16)
        fields = LeafFields(self.shape, (), self.letters)

        def inside(t: Floats, which: Any) -> Flags:
            values = fields._values(*(o[which] + t[:, None] * d[which]).T, letters=self.letters)
            from_leaves = [values[name] for name in fields._values.fields]
            from rsym.sampling.plane_leaves import active_leaf

            return np.asarray(active_leaf(fields.form.gates, from_leaves)[0] > 0)

        alive = np.flatnonzero(first < last)
        low, high = first.copy(), first.copy()
        capped = alive[inside(first[alive] + 1e-9, alive)]
        depth[capped], leaf[capped] = first[capped], entry[capped]
        alive = np.setdiff1d(alive, capped)
        for share in np.linspace(0, 1, 400)[1:]:
            t = first[alive] + share * (last[alive] - first[alive])
            met = inside(t, alive)
            depth[alive[met]] = high[alive[met]] = t[met]
            low[alive[~met]] = t[~met]
            alive = alive[~met]
        todo = np.flatnonzero(np.isfinite(depth) & (low < high))
        for _ in range(50):
            middle = (low[todo] + high[todo]) / 2
            met = inside(middle, todo)
            high[todo[met]], low[todo[~met]] = middle[met], middle[~met]
        depth[todo] = high[todo]
        bare = np.flatnonzero(np.isfinite(depth) & (leaf < 0))
        leaf[bare] = fields.active(o[bare] + depth[bare, None] * d[bare])
        return depth, leaf

    def _within(
        self, o: Floats, d: Floats, near: float, far: float, cuts: tuple[Cut, ...]
    ) -> tuple[Floats, Floats, Shorts]:
        """Where rays enter and leave the bounds and the cuts, and by which leaf they enter."""
        count = len(self._leaf_fields.form.leaves)
        first, last = np.full(len(o), near), np.full(len(o), far)
        entry = np.full(len(o), -1, np.int16)
        planes = []
        for axis, (low, high) in enumerate(self.bounds):
            unit = np.eye(3)[axis]
            planes += [(-unit, -low), (unit, high)]
        planes += [(np.array(cut.normal), cut.offset) for cut in cuts]
        with np.errstate(all="ignore"):
            for k, (normal, offset) in enumerate(planes):
                slope, room = d @ normal, offset - o @ normal
                at = room / slope
                enters = (slope < 0) & (at > first)
                first[enters], entry[enters] = at[enters], count + k
                last = np.where((slope > 0) & (at < last), at, last)
                last = np.where((slope == 0) & (room < 0), -np.inf, last)
        return first, last, entry

    def _normals(self, o: Floats, d: Floats, depth: Floats, leaf: Shorts, cuts: tuple[Cut, ...]) -> Floats:
        normal = np.full((len(o), 3), np.nan)
        met = np.flatnonzero(leaf >= 0)
        found = self._fields_at(self.letters, cuts, ("gradient",), leaf[met], o[met] + depth[met, None] * d[met])
        with np.errstate(all="ignore"):
            normal[met] = -found["gradient"] / np.linalg.norm(found["gradient"], axis=1)[:, None]
        return normal

    def _fields_at(
        self, letters: Mapping[str, float], cuts: tuple[Cut, ...], names: tuple[str, ...], leaf: Shorts, points: Floats
    ) -> dict[str, Floats]:
        """Fields of leaves; those of a cut are those of a side of the bounds, but for their directions."""
        fields = LeafFields(self.shape, names, letters, self._leaf_fields._kernels if not names else {})
        count = len(fields.form.leaves)
        known = np.where(leaf < count + SIDES, leaf, count).astype(np.int64)
        found = fields.at(known, points) if len(points) else fields.at(np.zeros(1, np.int64), np.zeros((1, 3)))
        result = {name: values[: len(points)] for name, values in found.items()}
        for k, cut in enumerate(cuts):
            result["gradient"][leaf == count + SIDES + k] = -np.array(cut.normal)
        return result


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
