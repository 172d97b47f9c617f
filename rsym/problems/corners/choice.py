"""Which corners of a shape have functions of their own beside splines: those where solutions are the least smooth."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.problems.corners.corner_functions import CornerFunctions, corner_functions, terms_at
from rsym.problems.corners.corners import PlaneCorner, surveyed_corners

MOST = 400  # functions, each of which meets all others
COUNTS = (7, 3), (4, 2), (3, 1), (1, 1)  # of rates and levels at each corner, fewer where there are many corners
SMOOTH = 5.0  # from this exponent on splines do as well


@dataclass(frozen=True, eq=False)
class CornerChoice:
    """The functions of some corners, the corners that need some and have none, and where corners were refused.

    Examples
    --------
    >>> import rsym
    >>> ell = rsym.rectangle(2, 2) - rsym.rectangle(1, 1).translate(0.5, 0.5)
    >>> chosen = chosen_corners(ell, (), lambda corners: [False] * len(corners))
    >>> [(corner.point, corner.is_reentrant) for corner in chosen.corners], chosen.left
    ([((0.0, 0.0), True)], ())
    >>> len(chosen_corners(ell, (), lambda corners: [True] * len(corners)).corners)
    6
    """

    functions: CornerFunctions
    left: tuple[PlaneCorner, ...]
    refused: tuple[RsymError, ...]

    @property
    def corners(self) -> tuple[PlaneCorner, ...]:
        """Those with functions, each once."""
        return tuple(part.corner for part in self.functions.parts)


def chosen_corners(
    shape: Shape,
    natural: Collection[int],
    loaded: Callable[[Sequence[PlaneCorner]], Sequence[bool]],
    most: int = MOST,
) -> CornerChoice:
    """At most so many functions, fewer at each corner if there are many; corners with the least exponents come first.

    natural : the leaves on which nothing is prescribed.
    loaded : says of corners whether there is a load.
    """
    every, refused = surveyed_corners(shape)
    sharp = [corner for corner in every if not corner.is_cusp]
    needed = _rough(sharp, loaded(sharp), natural)
    for terms, levels in COUNTS:
        sizes = [len(terms_at(corner, natural, terms=terms, levels=levels, load=load)) for corner, load in needed]
        if sum(sizes) <= most:
            break
    count = int(np.searchsorted(np.cumsum(sizes), most, side="right"))
    kept = sorted(needed[:count], key=lambda one: one[0].point)
    places, loads = [corner for corner, _ in kept], [load for _, load in kept]
    functions = corner_functions(shape, places, natural, terms=terms, levels=levels, load=loads)
    left = [corner for corner in every if corner.is_cusp] + [corner for corner, _ in needed[count:]]
    return CornerChoice(functions, tuple(sorted(left, key=lambda corner: corner.point)), refused)


def _rough(
    corners: Sequence[PlaneCorner], loads: Sequence[bool], natural: Collection[int]
) -> list[tuple[PlaneCorner, bool]]:
    """Corners where solutions are not smooth, and whether there is a load, the roughest first."""
    found = []
    for corner, load in zip(corners, loads, strict=True):
        own = terms_at(corner, natural, load=load)
        if own and own[0].exponent < SMOOTH:
            found.append((own[0].exponent, corner.point, (corner, load)))
    return [one for _, _, one in sorted(found, key=lambda one: one[:2])]
