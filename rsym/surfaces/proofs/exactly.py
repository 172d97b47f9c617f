"""What vanishes all along an edge, by exact arithmetic, and a bound of the difference of curvatures."""

from __future__ import annotations

from dataclasses import dataclass

from rsym.surfaces.proofs.enclosures import Pair
from rsym.surfaces.proofs.exact_values import exact_values
from rsym.surfaces.proofs.field_bounds import greatest
from rsym.surfaces.proofs.sides import Side, difference, dot, linkage, sides
from rsym.surfaces.proofs.specialised import NoProof


@dataclass(frozen=True)
class Facts:
    """Which of gap, angle and jump vanish identically, and whether both patches have normals.

    `standing` are the patches, 0 and 1, whose derivative across the edge vanishes identically.
    `linkage` bounds the difference II1(D2, D2) - II2(D2, D2) times |N1|**3, where the angle vanishes; None if unknown.
    """

    vanishing: tuple[bool, bool, bool] = (False, False, False)
    regular: bool = True
    linkage: float | None = None
    standing: tuple[int, ...] = ()


def facts(pair: Pair, levels: int) -> Facts:
    """What exact arithmetic says of the first so many levels on a part of an edge."""
    try:
        first, second = sides(exact_values(pair.nodes, pair.outputs))
        met = all(one.is_zero for one in difference(first.point, second.point))
        if levels < 2:
            return Facts((met, False, False))
        normals = first.normal, second.normal
        if any(all(one.is_zero for one in normal) for normal in normals):
            still = tuple(k for k, side in enumerate((first, second)) if all(one.is_zero for one in side.out))
            return Facts(regular=False, standing=still)
        flat = met and dot(normals[0], second.out).is_zero
        return _of_curvature(pair, first, second) if flat and levels > 2 else Facts((met, flat, False))
    except NoProof:
        return Facts()


def _of_curvature(pair: Pair, first: Side, second: Side) -> Facts:
    """The third level, where the first two vanish: by one axis if it vanishes, bounded by all three if not."""
    axes = [k for _, k in sorted((len(one.above), k) for k, one in enumerate(first.normal) if not one.is_zero)]
    try:
        if linkage(first, second, axes[:1]).is_zero:
            return Facts((True, True, True))
        return Facts((True, True, False), linkage=greatest(linkage(first, second), pair.part))
    except NoProof:
        return Facts((True, True, False))
