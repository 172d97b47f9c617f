"""The rays of a picture, and the half-spaces that cut a body: what is asked of a caster of rays.

A pencil has one ray through the middle of each pixel of a rectangle in space: from one eye, or all along one direction.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError

Vector: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class Pencil:
    """The rays through the pixels of a rectangle.

    Pixel (row j, column i) has its middle at ``corner + (i + 1/2) across + (j + 1/2) down``.

    Parameters
    ----------
    size : (int, int)
        Columns and rows.
    corner, across, down : triples
        The corner of the first pixel, and the steps from a column or row to the next.
    eye : triple, optional
        Where all rays begin, in perspective. Without one they begin in the rectangle.
    direction : triple, optional
        The direction of all rays, without an eye.

    Examples
    --------
    >>> flat = Pencil((4, 2), (0, 0, 5), (0.5, 0, 0), (0, -0.5, 0), direction=(0, 0, -2))
    >>> origins, directions = flat.rays()
    >>> origins.shape, origins[1, 3].tolist(), directions[1, 3].tolist()
    ((2, 4, 3), [1.75, -0.75, 5.0], [0.0, 0.0, -1.0])
    >>> Pencil((4, 2), (-1, 1, 4), (0.5, 0, 0), (0, -1, 0), eye=(0, 0, 5)).pixel
    (0.0, 0.5)
    """

    size: tuple[int, int]
    corner: Vector
    across: Vector
    down: Vector
    eye: Vector | None = None
    direction: Vector | None = None

    def __post_init__(self) -> None:
        for name in ("corner", "across", "down", "eye", "direction"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, vector(value, f"the {name} of a pencil"))
        if (self.eye is None) == (self.direction is None):
            raise RsymError("a pencil of rays has an eye or a direction, one of them", code="pencil")
        if min(self.size) < 1:
            raise RsymError(
                f"a picture of {self.size} pixels has none", code="pencil", remedy="for example (1600, 1200)"
            )

    @property
    def forward(self) -> Vector:
        """The unit vector of all rays, without an eye."""
        assert self.direction is not None
        x, y, z = np.array(self.direction) / np.linalg.norm(self.direction)
        return float(x), float(y), float(z)

    @property
    def pixel(self) -> tuple[float, float]:
        """The size of a pixel at distance 0, and how much it grows with the distance, by its shorter side."""
        step = min(float(np.linalg.norm(self.across)), float(np.linalg.norm(self.down)))
        if self.eye is None:
            return step, 0.0
        normal = np.cross(self.across, self.down)
        away = abs(np.dot(np.subtract(self.corner, self.eye), normal)) / np.linalg.norm(normal)
        return 0.0, float(step / away)

    def part(self, begin: Sequence[float] | Floats, side: float, size: tuple[int, int]) -> Pencil:
        """So many columns and rows from a place on, with pixels that have `side` times the side of these.

        Examples
        --------
        >>> flat = Pencil((4, 2), (0, 0, 5), (0.5, 0, 0), (0, -0.5, 0), direction=(0, 0, -2))
        >>> flat.part((1, 1), 0.5, (2, 2)).corner, flat.part((1, 1), 0.5, (2, 2)).across
        ((0.5, -0.5, 5.0), (0.25, 0.0, 0.0))
        """
        across, down = np.array(self.across), np.array(self.down)
        corner = vector(np.array(self.corner) + begin[0] * across + begin[1] * down, "a corner")
        steps = {"across": vector(side * across, "a step"), "down": vector(side * down, "a step")}
        return replace(self, size=size, corner=corner, **steps)

    def rays(self, columns: ArrayLike | None = None, rows: ArrayLike | None = None) -> tuple[Floats, Floats]:
        """Origins and unit directions (..., 3), at places counted in pixels from the corner, which broadcast.

        Without places the middles of all pixels, (rows, columns, 3); with a place 0.25 to the right of the middle of
        the first pixel ``rays(0.75, 0.5)``.
        """
        width, height = self.size
        i = np.arange(width) + 0.5 if columns is None else np.asarray(columns, np.float64)
        j = (np.arange(height) + 0.5)[:, None] if rows is None else np.asarray(rows, np.float64)
        i, j = np.broadcast_arrays(i, j)
        places = np.array(self.corner) + i[..., None] * np.array(self.across) + j[..., None] * np.array(self.down)
        if self.eye is None:
            return places, np.broadcast_to(np.array(self.forward), places.shape)
        along = places - np.array(self.eye)
        lengths = np.sqrt(np.einsum("...k,...k->...", along, along))
        return np.broadcast_to(np.array(self.eye), places.shape), along / lengths[..., None]


class Beams(NamedTuple):
    """Beams round some pixels of a pencil: the numbers of these, row by row, and where each begins and ends."""

    which: Ints
    near: Floats
    far: Floats


@dataclass(frozen=True)
class Cut:
    """The half-space ``normal . p <= offset``, which a section keeps of a body.

    Examples
    --------
    >>> Cut((2, 0, 0), 3.0)
    Cut(normal=(1.0, 0.0, 0.0), offset=1.5)
    """

    normal: Vector
    offset: float

    def __post_init__(self) -> None:
        given = vector(self.normal, "the normal of a cut")
        length = float(np.linalg.norm(given))
        if length == 0 or not np.isfinite(self.offset):
            raise RsymError("a cut has a normal that is not 0, and a finite offset", code="section")
        x, y, z = (part / length for part in given)
        object.__setattr__(self, "normal", (x, y, z))
        object.__setattr__(self, "offset", float(self.offset) / length)


def vector(value: Any, what: str) -> Vector:
    """Three finite numbers as floats."""
    try:
        x, y, z = (float(part) for part in value)
    except (TypeError, ValueError) as error:
        raise RsymError(f"{what} must be three numbers, got {value!r}", code="vector") from error
    if not np.isfinite([x, y, z]).all():
        raise RsymError(f"{what} must be three finite numbers, got {value!r}", code="vector")
    return x, y, z


def as_cuts(cuts: Iterable[Cut]) -> tuple[Cut, ...]:
    """Cuts, each checked to be one."""
    found = tuple(cuts)
    for cut in found:
        if not isinstance(cut, Cut):
            raise RsymError(f"expected a Cut, got {type(cut).__name__}", code="section", remedy="Cut((1, 0, 0), 0.0)")
    return found
