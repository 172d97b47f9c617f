"""Edges of patches: what a patch is along one side of its rectangle of parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.errors import RsymError
from rsym.surfaces.forms import SECOND, dot, limit_forms
from rsym.surfaces.parameters import Interval, LetterValues
from rsym.surfaces.patch import Patch

NAMES = ("u0", "u1", "v0", "v1")
# An edge whose points spread over less than this share of the patch is a point: coordinates are known to 1e-16 of
# their size, and edges that are meant to be short are longer by far.
POINT = 1e-9
SPREAD_SAMPLES = 17


@dataclass(frozen=True, eq=False)
class PatchEdge:
    """One side of a patch as a function of the parameter t that runs along it.

    On "u0" and "u1" (u at its lower, its upper end) t is v; on "v0" and "v1" it is u. A reversed edge is walked from
    the other end: t then stands for low + high - t. Derivatives across the edge are taken outwards.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> edge = PatchEdge(ParametricSurface((u, v, u * v)), "u1", reverse=True)
    >>> edge.position(0.25).tolist(), edge.tangent(0.25).tolist(), edge.outward(0.25).tolist()
    ([1.0, 0.75, 0.75], [-0.0, -1.0, -1.0], [1.0, 0.0, 0.75])
    """

    patch: Patch
    name: str
    reverse: bool = False
    letters: LetterValues = None

    def __post_init__(self) -> None:
        if self.name not in NAMES:
            raise RsymError(
                f"an edge is one of {', '.join(NAMES)}, got {self.name!r}",
                code="edge",
                remedy='"u0" is where u is at its lower end',
            )

    @property
    def across(self) -> int:
        """Which parameter is constant on the edge: 0 for u, 1 for v."""
        return "uv".index(self.name[0])

    @property
    def upper(self) -> bool:
        """Whether the constant parameter is at its upper end."""
        return self.name[1] == "1"

    @property
    def interval(self) -> Interval:
        """The interval of t."""
        return self.patch.domain[1 - self.across]

    @property
    def anticlockwise(self) -> bool:
        """Whether t runs as the boundary of the rectangle does, with the patch on the left."""
        return (self.name in {"v0", "u1"}) != self.reverse

    def parameters(self, t: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The pair (u, v) that stands for t."""
        along = np.asarray(t, np.float64)
        if self.reverse:
            along = sum(self.interval) - along
        constant = np.full(along.shape, self.patch.domain[self.across][int(self.upper)])
        return (constant, along) if self.across == 0 else (along, constant)

    def derivatives(self, t: ArrayLike, orders: Sequence[tuple[int, int]]) -> list[NDArray[np.float64]]:
        """Derivatives of order (i, j): i times along the edge as t runs, j times outwards."""
        turned = [order[::-1] if self.across == 0 else order for order in orders]
        place = self.parameters(t)
        known: dict[tuple[int, int], NDArray[np.float64]] = {}
        # Patches compile a kernel for each set of orders: so only three sets are asked for, whatever is wanted.
        for group in (((0, 0),), SECOND, [order for order in turned if sum(order) > 2]):
            if any(order in group for order in turned):
                known |= zip(group, self.patch.derivatives(*place, group, letters=self.letters), strict=True)
        found = [known[order] for order in turned]
        forwards, outwards = -1.0 if self.reverse else 1.0, 1.0 if self.upper else -1.0
        return [forwards**i * outwards**j * one for (i, j), one in zip(orders, found, strict=True)]

    def position(self, t: ArrayLike) -> NDArray[np.float64]:
        """Points (..., 3)."""
        return self.derivatives(t, ((0, 0),))[0]

    def tangent(self, t: ArrayLike) -> NDArray[np.float64]:
        """The derivative along the edge."""
        return self.derivatives(t, ((1, 0),))[0]

    def outward(self, t: ArrayLike) -> NDArray[np.float64]:
        """The derivative across the edge, out of the patch."""
        return self.derivatives(t, ((0, 1),))[0]

    def bend(self, t: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """The unit normal, the outer unit conormal, and the normal curvature in the direction of the conormal.

        The conormal lies in the tangent plane, perpendicular to the edge: in the basis (p_across, p_along) it is
        p_across - (F/G) p_along over its length. At poles the limits are taken; what does not exist is NaN.
        """
        forms = limit_forms(self.patch, *self.parameters(t), self.letters)
        _, E, F, G, L, M, N = forms
        if self.across == 1:
            E, G, L, N = G, E, N, L
        with np.errstate(all="ignore"):
            slope = F / G
            curvature = (L - 2 * slope * M + slope**2 * N) / (E - slope * F)
            side = np.cross(self.tangent(t), forms.normal)
            conormal = (1.0 if self.anticlockwise else -1.0) * side / np.sqrt(dot(side, side))[..., None]
        return forms.normal, conormal, curvature

    def is_point(self, size: float | None = None) -> bool:
        """Whether the edge is one point, as at a pole, beside the size of the patch."""
        points = self.position(np.linspace(*self.interval, SPREAD_SAMPLES))
        if size is None:
            other = PatchEdge(self.patch, self.name[0] + "10"[int(self.upper)], letters=self.letters)
            size = float(np.ptp(np.concatenate([points, other.position(np.array(self.interval))]), axis=0).max())
        return bool(np.ptp(points, axis=0).max() <= POINT * size)


def edges_of(patch: Patch, letters: LetterValues = None) -> tuple[PatchEdge, ...]:
    """The four edges of a patch, "u0", "u1", "v0", "v1"."""
    return tuple(PatchEdge(patch, name, letters=letters) for name in NAMES)
