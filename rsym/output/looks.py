"""How level lines look: levels, limits, colours, and what becomes of the outside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.colors import Normalize, TwoSlopeNorm
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.output.paints import beyond, checked_limits, checked_map
from rsym.sampling.lattice import Lattice

COLOUR_MAP, TWO_SIDED = "viridis", "RdBu_r"
# Singular spots reach any height; the colours span what lies between these shares of all samples.
ROBUST_RANGE = (0.02, 0.98)
SHARE_OF_SIZES = 0.995
BESIDE = 0.05  # of the size of the picture: what lies that near to a point without bound belongs to it
NEAR = 0.25  # of the span of what is usual: what has no singular spots is shown whole
LEVEL_COUNT, SIDE_COUNT = 14, 7
UNSEEN = 1e-3  # of the span of levels: what is beyond them by less is at their end, and no arrow says so
ROUNDING = 1e-9  # of the other side: a side below is none
# Fields whose sign says inside or outside: both are shown, however small the share of one is.
LOGICAL = ("value", "normalised", "normalised_2", "normalised_3")
OUTSIDES = {"mask": 1.0, "dim": 0.7}  # the share of white over what is outside


@dataclass(frozen=True)
class Look:
    """What a picture was asked to look like; None where the values choose.

    A field of both signs has two sides, each with its own round levels and colours of its own, 0 at the middle: so
    a body in a wide field is not one colour. A field of one sign has one.

    Examples
    --------
    >>> values = np.linspace(-30.0, 2.0, 1001)
    >>> levels = Look().levels_of(values)
    >>> int((levels < 0).sum()), int((levels > 0).sum()), Look().colours(levels)[0]
    (6, 7, 'RdBu_r')
    >>> Look(limits=(0.0, 2.0)).levels_of(values)[[0, -1]]
    array([0., 2.])
    """

    levels: Any = None
    limits: Any = None
    colour_map: str | None = None
    outside: str | None = None

    def __post_init__(self) -> None:
        if self.outside is not None and self.outside not in OUTSIDES:
            raise RsymError(
                f"outside is {' or '.join(map(repr, OUTSIDES))}, got {self.outside!r}",
                code="outside",
                remedy="outside='dim', or leave it out",
            )
        checked_map(self.colour_map)

    def of(self, field: str) -> Look:
        """The look of one field of several: its own levels and limits, where they are given by field."""
        own = [asked.get(field) if isinstance(asked, Mapping) else asked for asked in (self.levels, self.limits)]
        return Look(own[0], own[1], self.colour_map, self.outside)

    def levels_of(self, values: Floats, field: str = "", inside: NDArray[np.bool_] | None = None) -> Floats:
        """The levels for samples; those inside alone choose if the outside is not the matter of the picture."""
        if self.levels is not None:
            return checked_levels(self.levels)
        if self.limits is not None:
            return _between(*checked_limits(self.limits))
        # What is pale outside has its own side of a field that says what is outside.
        within = self.outside == "mask" or (self.outside == "dim" and field not in LOGICAL)
        if within and inside is not None and np.isfinite(values[inside]).any():
            values = values[inside]
        whole = self.outside == "mask"
        return robust_levels(values, whole=whole) if not _has_sides(values, field) else _two_sided(values, whole)

    def colours(self, levels: Floats) -> tuple[str, Normalize]:
        """The colour map and the scale for levels: of two sides where they lie on both sides of 0."""
        if levels[0] < 0 < levels[-1]:
            return self.colour_map or TWO_SIDED, TwoSlopeNorm(0.0, levels[0], levels[-1])
        return self.colour_map or COLOUR_MAP, Normalize(levels[0], levels[-1])

    def beyond(self, levels: Floats, values: Floats, omega: Floats | None = None) -> str:
        """At which ends of the levels there are values in the picture, what is hidden outside left out.

        Examples
        --------
        >>> values = np.arange(25.0).reshape(5, 5)
        >>> levels, look = np.array([6.0, 12.0]), Look(outside="mask")
        >>> look.beyond(levels, values), look.beyond(levels, values, np.where(values < 12, 1.0, -1.0))
        ('max', 'neither')
        """
        shown = values[..., 1:-1, 1:-1]  # what is beside the axes is not in the picture
        if self.outside == "mask" and omega is not None:
            shown = shown[omega[..., 1:-1, 1:-1] > 0]
        return beyond(shown, levels[0], levels[-1], UNSEEN)

    @property
    def veil(self) -> float:
        """The share of white over what is outside."""
        return OUTSIDES.get(self.outside or "", 0.0)


PLAIN = Look()


def snapped(levels: Floats, values: Floats, extend: str) -> Floats:
    """Values, those that are hardly beyond an end of levels at this end, for nothing is filled there.

    Examples
    --------
    >>> snapped(np.array([0.0, 1.0]), np.array([-1e-15, -1.0]), "neither").tolist()
    [0.0, -1.0]
    """
    low, high = levels[0], levels[-1]
    room = UNSEEN * high - UNSEEN * low
    if extend in ("neither", "max"):
        values = np.where((values < low) & (values >= low - room), low, values)
    if extend in ("neither", "min"):
        values = np.where((values > high) & (values <= high + room), high, values)
    return values


def robust_levels(values: Floats, *, whole: bool = False) -> Floats:
    """About fourteen round levels between low and high quantiles of the finite values.

    `whole`: between the least and the greatest, where these are near.

    Examples
    --------
    >>> import numpy as np
    >>> robust_levels(np.append(np.linspace(0, 1, 1000), 1e9)).max() <= 1.1
    np.True_
    >>> [bool(robust_levels(np.linspace(0, 1, 1000) ** 3, whole=whole).max() >= 1) for whole in (False, True)]
    [False, True]
    """
    finite = values[np.isfinite(values)]
    if not finite.size:
        raise RsymError("the field is undefined in all of the bounds", code="undefined", remedy="choose other bounds")
    low, high = np.quantile(finite, ROBUST_RANGE)
    if whole:
        low, high = _near(low, finite.min(), high - low), _near(high, finite.max(), high - low)
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        margin = max(abs(low), 1.0) * 0.5
        low, high = low - margin, high + margin
    return np.asarray(MaxNLocator(LEVEL_COUNT).tick_values(low, high))


def levels_of_sizes(
    look: Look, values: Floats, inside: NDArray[np.bool_], lattice: Lattice, unbounded: Floats
) -> Floats:
    """The levels of what is never negative, from 0 to its largest value inside.

    Where that lies beside a point (n, 2) at which there is no bound they end at what all but a few samples have.
    """
    known = inside & np.isfinite(values)
    if look.levels is not None or look.limits is not None or not known.any():
        return look.levels_of(values)
    largest = np.unravel_index(np.argmax(np.where(known, values, -np.inf)), values.shape)
    away = np.linalg.norm(np.reshape(unbounded, (-1, 2)) - lattice.points(np.array(largest)), axis=-1)
    near = BESIDE * float(np.max(np.array(values.shape) * lattice.spacing))
    high = float(np.quantile(values[known], SHARE_OF_SIZES) if (away < near).any() else values[largest])
    return np.asarray(MaxNLocator(LEVEL_COUNT).tick_values(0.0, high if high > 0 else 1.0))


def checked_levels(levels: Any) -> Floats:
    """Levels that somebody gave."""
    try:
        chosen = np.asarray(levels, np.float64)
    except (TypeError, ValueError):
        chosen = np.empty(0)
    if chosen.ndim != 1 or len(chosen) < 2 or not (np.isfinite(chosen).all() and (np.diff(chosen) > 0).all()):
        raise RsymError(
            f"levels must be two or more increasing numbers, got {levels!r}",
            code="levels",
            remedy="levels=[-1, 0, 1], or leave them out",
        )
    return chosen


def _has_sides(values: Floats, field: str) -> bool:
    """Whether a field has both signs, beyond singular spots unless its sign says what is inside."""
    finite = values[np.isfinite(values)]
    if not finite.size:
        return False
    low, high = (finite.min(), finite.max()) if field in LOGICAL else np.quantile(finite, ROBUST_RANGE)
    return bool(low < -ROUNDING * high and high > -ROUNDING * low)


def _near(end: float, last: float, span: float) -> float:
    """The last of some values in the place of their usual end, if it is near; never on the other side of 0."""
    near = last if abs(last - end) <= NEAR * span else end
    return float(near) if near * end > 0 else 0.0


def _two_sided(values: Floats, whole: bool = False) -> Floats:
    """Round levels on both sides of 0, each spread over what is usual there; each side has its own."""
    finite = values[np.isfinite(values)]
    low, high = (
        float(np.quantile(finite[side], share))
        for side, share in zip((finite < 0, finite > 0), ROBUST_RANGE, strict=True)
    )
    if whole:
        low, high = _near(low, finite.min(), -low), _near(high, finite.max(), high)
    return np.unique(np.concatenate([-_upto(-low), _upto(high)])) + 0.0  # never -0


def _between(low: float, high: float) -> Floats:
    """Round levels between two ends, the ends among them; 0 too if it lies between."""
    if low < 0 < high:
        inner = np.concatenate([-_upto(-low), _upto(high)])
    else:
        inner = np.asarray(MaxNLocator(LEVEL_COUNT).tick_values(low, high))
    return np.unique(np.concatenate([[low], inner[(inner > low) & (inner < high)], [high]])) + 0.0


def _upto(end: float) -> Floats:
    """From 0 in round steps past an end."""
    ticks = np.asarray(MaxNLocator(SIDE_COUNT).tick_values(0.0, end))
    return ticks[ticks >= 0]
