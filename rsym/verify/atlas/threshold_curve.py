"""A threshold over two letters: the line at which smoothness is lost, enclosed."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.reports.numbers import number, share


@dataclass(frozen=True, eq=False, repr=False)
class ThresholdCurve:
    """Where a boundary of two letters goes over from refuted to certified.

    Attributes
    ----------
    letters : pair of str
        The letters along the first and the second axis.
    middle : tuple of (n, 2) arrays
        The lines in the middle of the strip; numerical.
    strip : (m, 2, 2) array
        The undecided rectangles that enclose the threshold, as ((low, high), (low, high)).
    certified_side, refuted_side : tuples of (k, 2) arrays
        The lines between which the strip lies: on one the boundary is proved to be smooth, on the other not to be.
    graph : str or None
        The letter of which there is one threshold for each value of the other one, if it is so.
    span : pair of float
        The values of the other letter for which there is one, else NaN.
    share : float
        Through every point of the strip a line along one of the letters crosses no more of it than this share of the
        letter's range.

    Examples
    --------
    >>> strip = np.array([[[1.0, 1.5], [0.0, 2.0]], [[1.5, 2.0], [2.0, 4.0]]])
    >>> curve = ThresholdCurve(("a", "b"), (), strip, (), (), "a", (0.0, 4.0), 0.1)
    >>> curve.between(1), curve.between(2)
    ((1.0, 1.5), (1.0, 2.0))
    >>> print(curve)
    a at its threshold for each b in [0, 4], enclosed in 2 rectangles, known to 34 % at worst
    """

    letters: tuple[str, str]
    middle: tuple[Floats, ...]
    strip: Floats
    certified_side: tuple[Floats, ...]
    refuted_side: tuple[Floats, ...]
    graph: str | None
    span: tuple[float, float]
    share: float

    def between(self, value: float) -> tuple[float, float]:
        """The two ends of the threshold of the letter `graph` at a value of the other one, proved.

        Raises
        ------
        RsymError
            Where the threshold is no graph, and beyond its ends.
        """
        if self.graph is None:
            raise RsymError(
                "this threshold is no function of one letter", code="no-graph", remedy="read its strip of rectangles"
            )
        axis = self.letters.index(self.graph)
        low, high = self.span
        if not low <= value <= high:
            raise RsymError(
                f"{self.letters[1 - axis]} = {float(value):g} is beyond the ends of the threshold",
                code="letter-range",
                remedy=f"choose a value in [{low:g}, {high:g}]",
            )
        along, ends = self.strip[:, 1 - axis], self.strip[:, axis]
        here = (along[:, 0] <= value) & (value <= along[:, 1])
        return float(ends[here, 0].min()), float(ends[here, 1].max())

    @property
    def relative_width(self) -> float:
        """The largest width of the enclosure as a share of the value itself; NaN where the threshold is no graph."""
        if self.graph is None:
            return math.nan
        lines = np.unique(self.strip[:, 1 - self.letters.index(self.graph)])
        places = (lines[1:] + lines[:-1]) / 2
        inner = places[(self.span[0] <= places) & (places <= self.span[1])]
        ends = np.array([self.between(place) for place in inner])
        return float(((ends[:, 1] - ends[:, 0]) / np.abs(ends).max(axis=1)).max())

    def __str__(self) -> str:
        count = f"enclosed in {len(self.strip)} rectangles"
        if self.graph is None:
            wide = f"{share(self.share)} of a range wide"
            return f"a line in the plane of {' and '.join(self.letters)}, {count}, {wide}"
        other, (low, high) = 1 - self.letters.index(self.graph), self.span
        ends = f"[{number(low, 6)}, {number(high, 6)}]"
        known = f"known to {share(self.relative_width)} at worst"
        return f"{self.graph} at its threshold for each {self.letters[other]} in {ends}, {count}, {known}"

    def __repr__(self) -> str:
        return f"<ThresholdCurve of {', '.join(self.letters)}: {len(self.strip)} rectangles>"
