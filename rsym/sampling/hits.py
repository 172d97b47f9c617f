"""What rays meet: depth, leaf, normal, and the fields of the leaf there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats, Shorts
from rsym.sampling.labels import Labels

Rays: TypeAlias = Callable[[], tuple[Floats, Floats]]


@dataclass(frozen=True)
class Seen:
    """What kernels say of rays: depth, leaf, doubt in arrays of their shape, of the normal three parts before that."""

    depth: Floats
    leaf: Shorts
    normal: Floats
    doubt: NDArray[np.uint8]

    def reshaped(self, shape: tuple[int, ...]) -> Seen:
        """The same for rays in an array."""
        normal = self.normal.reshape(3, *shape)
        return Seen(self.depth.reshape(shape), self.leaf.reshape(shape), normal, self.doubt.reshape(shape))


@dataclass(frozen=True)
class Hits:
    """Where rays meet a body first, in arrays of the shape of the rays.

    Attributes
    ----------
    depth : array of float
        The distance along the ray, whose direction has length 1; inf where nothing is met.
    leaf : array of int16
        The number of the leaf that is met (`Caster.leaves` names it), -1 where none is. Behind the leaves of the shape
        are the six sides of its bounds, and behind those the cuts.
    normal : array of float (..., 3)
        The outer unit normal of that leaf; NaN where none is met, and where the leaf has no gradient.
    undecided : array of bool
        Rays that reached a limit: what is said of them is not certain.
    """

    depth: Floats
    leaf: Shorts
    normal: Floats
    undecided: Flags
    rays_of: Rays = field(repr=False)
    fields_at: Callable[[tuple[str, ...], Shorts, Floats], Mapping[str, Floats]] = field(repr=False)
    called: Callable[[Floats, Shorts], Labels] = field(repr=False)

    @cached_property
    def rays(self) -> tuple[Floats, Floats]:
        """Origins and unit directions (..., 3)."""
        return self.rays_of()

    @property
    def met(self) -> Flags:
        """Where something is met."""
        return np.asarray(self.leaf >= 0)

    @cached_property
    def points(self) -> Floats:
        """The points that are met (..., 3), NaN where none is."""
        origins, directions = self.rays
        depth = np.where(self.met, self.depth, np.nan)
        return np.asarray(origins + depth[..., None] * directions)

    @cached_property
    def labels(self) -> Labels:
        """Which parts the points that are met belong to, in one row."""
        return self.called(self.points[self.met], self.leaf[self.met])

    def fields(self, *names: str) -> dict[str, Floats]:
        """Fields of the leaf that is met, as those of `compile`; NaN where none is.

        Curvatures are positive where the inside is convex.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y, z
        >>> from rsym.sampling.rays import Caster
        >>> ball = rsym.Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z), bounds=((-3, 3),) * 3)
        >>> hits = Caster(ball).cast([[5.0, 0.0, 0.0], [5.0, 0.0, 4.0]], [-1.0, 0.0, 0.0])
        >>> hits.fields("gaussian_curvature")["gaussian_curvature"].round(9).tolist()
        [0.25, nan]
        """
        met = self.met
        found = self.fields_at(names, self.leaf[met], self.points[met])
        result = {}
        for name in names:
            result[name] = np.full((*met.shape, *found[name].shape[1:]), np.nan)
            result[name][met] = found[name]
        return result
