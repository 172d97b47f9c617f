"""Which corners of a shape have functions of their own beside splines: those where solutions are the least smooth."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.problems.corners.corner_functions import CornerFunctions, LocalFunctions, corner_functions, terms_at
from rsym.problems.corners.corners import PlaneCorner, surveyed_corners
from rsym.problems.corners.goursat import EdgeConditions, exponents
from rsym.problems.corners.growth import Growth
from rsym.problems.corners.wave_functions import STEEPEST, WaveFunctions, wave_functions

MOST = 4000  # functions; each meets what is near its corner alone
COUNTS = (7, 3), (4, 2), (3, 1), (1, 1)  # of rates and levels at each corner, fewer where there are many corners
# Splines of low degrees do as well as functions of higher rates, and want a factor that falls more slowly: measured on
# the drum of three squares, of degree 4 six functions are as good as 21, of degree 5 they are not.
LOW, LOW_RATE, LOW_LEVELS, LOW_POWER, POWER = 4, 2.5, 2, 5, 7
ON_AXIS = 1e-6  # of the size of a shape
SMOOTH = 5.0  # from this exponent on splines do as well


@dataclass(frozen=True, eq=False)
class CornerChoice:
    """The functions of some corners, the corners that need some and have none, and where corners were refused.

    Examples
    --------
    >>> import rsym
    >>> ell = rsym.rectangle(2, 2) - rsym.rectangle(1, 1).translate(0.5, 0.5)
    >>> chosen = chosen_corners(ell, (), lambda corners: [False] * len(corners))
    >>> [round(corner.angle / 3.14159265359, 9) for corner in chosen.corners], chosen.left
    ([1.5], ())
    >>> [error.code for error in chosen.refused]  # the sides x = 1 and y = 1 are those of both
    ['degenerate']
    """

    functions: CornerFunctions[LocalFunctions] | CornerFunctions[WaveFunctions]
    left: tuple[PlaneCorner, ...]
    refused: tuple[RsymError, ...]
    degree: int = LOW + 1

    @property
    def corners(self) -> tuple[PlaneCorner, ...]:
        """Those with functions, each once."""
        return tuple(part.corner for part in self.functions.parts)

    def component(self, axis: int) -> CornerChoice:
        """The same with one component of each function that has some."""
        parts = (part.component(axis) for part in self.functions.parts if isinstance(part, WaveFunctions))
        return replace(self, functions=CornerFunctions(tuple(parts)))

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why corners were refused, and where."""
        return tuple(f"{error.message}{f', {error.where}' if error.where else ''}" for error in self.refused)


def chosen_corners(
    shape: Shape,
    natural: Collection[int],
    loaded: Callable[[Sequence[PlaneCorner]], Sequence[bool]],
    *,
    most: int = MOST,
    axis: int = -1,
    degree: int = LOW + 1,
    marked: Callable[[Sequence[PlaneCorner]], Sequence[PlaneCorner]] = tuple,
    grown: Callable[[Sequence[PlaneCorner]], Sequence[Growth | None]] = lambda corners: [None] * len(corners),
) -> CornerChoice:
    """At most so many functions, fewer at each corner if there are many; corners with the least exponents come first.

    natural : the leaves on which nothing is prescribed.
    loaded : says of corners whether there is a load.
    axis : the coordinate along the axis of a body of revolution: corners on it have the exponents of cones, and none.
    degree : of the splines beside them.
    marked : says of which edges conditions are natural beside corners, and may add flat ones, where these change.
    grown : says of corners what factor their functions have.
    """
    surveyed, refused = surveyed_corners(shape)
    every = marked(surveyed)
    size = max((abs(value) for corner in every for value in corner.point), default=1.0)
    conical = [axis >= 0 and abs(corner.point[1 - axis]) <= ON_AXIS * size for corner in every]
    sharp = [corner for corner, cone in zip(every, conical, strict=True) if not (cone or corner.is_cusp)]
    needed = _rough(sharp, loaded(sharp), natural)
    low = degree <= LOW
    steepest = LOW_RATE if low else math.inf
    for terms, most_levels in COUNTS:
        levels = min(most_levels, LOW_LEVELS) if low else most_levels
        sizes = [
            len(terms_at(corner, natural, terms=terms, levels=levels, steepest=steepest, load=load))
            for corner, load in needed
        ]
        if sum(sizes) <= most:
            break
    count = int(np.searchsorted(np.cumsum(sizes), most, side="right"))
    kept = sorted(needed[:count], key=lambda one: one[0].point)
    places, loads = [corner for corner, _ in kept], [load for _, load in kept]
    power = LOW_POWER if low else POWER
    functions = corner_functions(
        shape,
        places,
        natural,
        terms=terms,
        levels=levels,
        steepest=steepest,
        load=loads,
        power=power,
        growths=grown(places),
    )
    bare = [one for one, cone in zip(every, conical, strict=True) if one.is_cusp or (cone and one.is_reentrant)]
    left = [*bare, *(corner for corner, _ in needed[count:])]
    return CornerChoice(functions, tuple(sorted(left, key=lambda corner: corner.point)), refused, degree)


def chosen_waves(
    shape: Shape,
    conditions: Callable[[PlaneCorner], EdgeConditions | None],
    *,
    most: int = MOST,
    degree: int = LOW + 1,
) -> CornerChoice:
    """At most so many functions of an elastic body or a plate, of corners with the least exponents first.

    conditions : of a corner what holds on its edges, None where that is not known.
    degree : of the splines beside them.

    Examples
    --------
    >>> from rsym.problems.corners.goursat import of_body
    >>> import rsym
    >>> pair = rsym.disc(1) | rsym.disc(1, (1, 0))
    >>> chosen = chosen_waves(pair, lambda corner: of_body(corner, [[False, False]] * 2, 2.0))
    >>> [round(part.terms[0].exponent, 4) for part in chosen.functions.parts], chosen.left
    ([0.6157, 0.6157], ())
    """
    surveyed, refused = surveyed_corners(shape)
    power = LOW_POWER if degree <= LOW else POWER
    known = [(corner, None if corner.is_cusp else conditions(corner)) for corner in surveyed]
    sharp = [(corner, own) for corner, own in known if own is not None]
    left = [corner for corner, own in known if own is None]
    # Logarithms beside double exponents are not among the functions.
    left += [corner for corner, own in sharp if not all(one.simple for one in exponents(own.rows, STEEPEST))]
    made = (wave_functions(shape, *one, power=power) for one in sharp)
    every = sorted((part for part in made if part), key=lambda part: (part.terms[0].exponent, part.corner.point))
    count = int(np.searchsorted(np.cumsum([len(part.terms) for part in every]), most, side="right"))
    left += [part.corner for part in every[count:] if part.corner not in left]
    kept = sorted(every[:count], key=lambda part: part.corner.point)
    functions = CornerFunctions(tuple(kept))
    return CornerChoice(functions, tuple(sorted(left, key=lambda corner: corner.point)), refused, degree)


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
