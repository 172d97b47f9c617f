"""Whether two edges meet where they are to be joined: distances beside the size of the patches."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.corrections import enough, greatest, sizes
from rsym.surfaces.joints.borders import Border, projected
from rsym.surfaces.joints.edges import PatchEdge
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Patch

# Coordinates far from the origin carry rounding of their own size.
ROUNDING = 1e-14
GRID = 9


def sample_grid(patch: Patch, letters: LetterValues = None) -> Floats:
    """Points (GRID, GRID, 3) of the whole patch."""
    with np.errstate(all="ignore"):
        points = patch.grid(*(np.linspace(*interval, GRID) for interval in patch.domain), letters=letters)
    if not np.isfinite(points).all():
        raise RsymError(f"{patch!r} is not finite everywhere", code="patch", remedy="leave its singular edge out")
    if not np.ptp(points.reshape(-1, 3), axis=0).any():
        raise RsymError(f"{patch!r} is a point, not a surface", code="patch", remedy="leave it out")
    return points


def extent(*grids: Floats) -> float:
    """The diagonal of the box round some points.

    Examples
    --------
    >>> extent(np.array([[0.0, 0.0, 0.0]]), np.array([[3.0, 4.0, 0.0]]))
    5.0
    """
    return float(np.linalg.norm(np.ptp(np.concatenate([grid.reshape(-1, 3) for grid in grids]), axis=0)))


def room_for(share: float, *grids: Floats) -> float:
    """The distance that counts as none: a share of the smallest of several patches, or rounding if that is more.

    Examples
    --------
    >>> room_for(1e-9, np.array([[0.0, 0.0, 0.0], [3.0, 4.0, 0.0]]), np.array([[1e8, 0.0, 0.0], [2e8, 0.0, 0.0]]))
    2e-06
    """
    return max(share * min(map(extent, grids)), ROUNDING * max(float(np.abs(grid).max()) for grid in grids))


def apart(first: PatchEdge, second: PatchEdge) -> tuple[float, float]:
    """The greatest distance of two edges, and the parameter of the second where it is.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> p, q = ParametricSurface((u, v, 0)), ParametricSurface((1 + u, v, v / 8))
    >>> apart(PatchEdge(p, "u1"), PatchEdge(q, "u0"))
    (0.125, 1.0)
    """
    (a, b), (c, d) = first.interval, second.interval

    def distance(t: Floats) -> Floats:
        return sizes(first.position(np.clip(a + (t - c) * ((b - a) / (d - c)), a, b)) - second.position(t))

    gap, (place,) = greatest(distance, second.interval)
    return gap, place


def require_meeting(first: PatchEdge, second: PatchEdge, tolerance: float) -> None:
    """Refuse edges that are farther apart than a share of the size of the smaller patch; rounding is allowed."""
    grids = [sample_grid(edge.patch, edge.letters) for edge in (first, second)]
    room = room_for(tolerance, *grids)
    gap, place = apart(first, second)
    if gap <= room:
        return
    share = gap / min(map(extent, grids))
    u, v = (float(one) for one in second.parameters(place))
    turned = replace(first, reverse=not first.reverse)
    border = Border(0, first, extent(grids[0]), room, room)
    along = projected(border, second.position(np.linspace(*second.interval, len(border.t))), room)[1]
    pace = ", though along one curve at another pace" if (along <= room).all() else ""
    raise RsymError(
        f"the edge {first.name} of p and the edge {second.name} of q do not meet: they are {gap:.3g} apart at "
        f"t = {place:.4g}, {share:.2g} of the size of the smaller patch{pace}",
        code="gap",
        where=f"(u, v) = ({u:.4g}, {v:.4g}) of q",
        remedy=f"reverse={turned.reverse}: the other way round they meet"
        if apart(turned, second)[0] <= room
        else f"tolerance={enough(share)} moves q there on purpose, and `correction` of the answer tells how far",
    )
