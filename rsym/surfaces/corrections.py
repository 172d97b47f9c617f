"""What is meant to meet: how far it may miss, how far it did, and how far points were moved so that it meets."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.model.requirements import require_positive
from rsym.reports.document import Document, Sentence
from rsym.reports.numbers import number, point
from rsym.reports.render import Report
from rsym.surfaces.functions.univariate import Univariate
from rsym.surfaces.parameters import Interval

# Share of their size by which patches and curves may miss one another: rounding of data given to nine digits.
MEETING = 1e-9
# Samples along one parameter, along each of two; then so many closer ones round the greatest value, so many times.
SAMPLES = {1: 257, 2: 33}
CLOSER, ROUNDS = 9, 5


@dataclass(frozen=True)
class Correction(Report):
    """How far what had to meet was apart, and how far points were moved so that it meets.

    Parameters
    ----------
    gap : float
        The greatest distance of points that had to be the same.
    moved : float
        The greatest distance between points as given and as they are now.
    parameters : pair of float
        (u, v) of the point that was moved most.

    Examples
    --------
    >>> print(Correction(0.001, 0.0005, (0.0, 1.0)))
    a gap of 0.001 closed; points moved by 0.0005 at most, at (u, v) = (0, 1)
    """

    gap: float
    moved: float
    parameters: tuple[float, float]

    def document(self) -> Document:
        """How far what had to meet was apart, and how far points were moved; measured, not proved."""
        closed = f"a gap of {number(self.gap, 3)} closed" if self.gap else "no gap"
        moved = f"points moved by {number(self.moved, 3)} at most, at (u, v) = {point(self.parameters, 6)}"
        data = {"gap": self.gap, "moved": self.moved, "parameters": self.parameters}
        return Document("correction", Sentence(f"{closed}; {moved}", False), data=data)


def require_tolerance(given: Any) -> None:
    """Refuse what is no positive share.

    Examples
    --------
    >>> require_tolerance(0)
    Traceback (most recent call last):
    ...
    rsym.errors.RsymError: tolerance must be a positive number, got 0; remedy: a share of the size, 1e-3 for example
    """
    require_positive("tolerance", given, "a share of the size, 1e-3 for example")


def enough(share: float) -> str:
    """A share rounded up to two digits, so that as a tolerance it is enough.

    Examples
    --------
    >>> enough(0.02801), enough(2.0)
    ('0.029', '2')
    """
    step = 10.0 ** (math.floor(math.log10(share)) - 1)
    return f"{math.ceil(share / step * (1 - 1e-12)) * step:.2g}"


def greatest(distance: Callable[..., Floats], *intervals: Interval) -> tuple[float, tuple[float, ...]]:
    """The greatest value of a function of one or two parameters and where it is: samples, then closer ones round it.

    Examples
    --------
    >>> value, (place,) = greatest(lambda t: t * (1 - t), (0.0, 1.0))
    >>> round(value, 9), round(place, 3)
    (0.25, 0.5)
    """
    best, place = -math.inf, tuple(low for low, _ in intervals)
    around = list(intervals)
    for turn in range(ROUNDS + 1):
        axes = [np.linspace(*one, CLOSER if turn else SAMPLES[len(intervals)]) for one in around]
        places = np.meshgrid(*axes, indexing="ij")
        with np.errstate(all="ignore"):
            values = distance(*places)
        index = np.unravel_index(int(np.argmax(np.where(np.isnan(values), -np.inf, values))), values.shape)
        if values[index] > best:
            best, place = float(values[index]), tuple(float(one[index]) for one in places)
        steps = [axis[1] - axis[0] for axis in axes]
        around = [
            (max(at - step, low), min(at + step, high))
            for at, step, (low, high) in zip(place, steps, intervals, strict=True)
        ]
    return best, place


def longest(functions: Univariate, vectors: Floats) -> tuple[float, float]:
    """The greatest length of the sum of constant vectors (n, 3) times functions (n,), and the parameter where it is."""
    away, (place,) = greatest(lambda t: sizes(functions(t) @ vectors), functions.domain)
    return away, place


def sizes(vectors: Floats) -> Floats:
    """The lengths of vectors (..., 3).

    Examples
    --------
    >>> sizes(np.array([[3.0, 4.0, 0.0]])).tolist()
    [5.0]
    """
    return np.asarray(np.sqrt((vectors**2).sum(axis=-1)))
