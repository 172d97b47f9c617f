"""What an atlas of two letters says, its thresholds among it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED, Document, Sentence, Tabular
from rsym.reports.numbers import number, share, tenths
from rsym.reports.render import Report
from rsym.reports.words import plural
from rsym.verify.atlas.greatest import CurvatureMap

MEANINGS = {
    CERTIFIED: "certified",
    REFUTED: "refuted",
    DEGENERATE: "without a boundary",
    UNDECIDED: "undecided",
}


@dataclass(frozen=True, eq=False, repr=False)
class SmoothnessAtlas(Report):
    """A rectangle of two letters in rectangles, each with what is proved of every value in it.

    Attributes
    ----------
    letters : pair of str
        The letters along the first and the second axis.
    region : ((low, high), (low, high))
        The whole.
    rectangles : (n, 2, 2) array
        Its parts, as ((low, high), (low, high)).
    verdicts : tuple of str
        For every value in each part: "CERTIFIED", the curvature of the boundary is continuous; "REFUTED", it is not;
        "DEGENERATE", there is no boundary within the bounds; "UNDECIDED", none of these is proved.
    curvature_bounds : (n,) array
        For every value in a certified part no curvature of the boundary is larger in size; infinite without a bound.
    thresholds : tuple of ThresholdCurve
        The undecided strips between certified and refuted parts.
    curvature : CurvatureMap
        The greatest curvature at single values; numerical.
    defaults : pair of float
        The values of the two letters in the shape.
    fixed : mapping
        The other letters, each with its range.
    judged : int
        How many rectangles were examined.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> wall = rsym.Shape(y - abs(x - 1) + 2, (x, y), letters={"a": 1, "b": 2}, bounds=((-3, 3), (-4, 3)))
    >>> print(rsym.smoothness_atlas(wall, "a", "b"))
    Atlas of a in [0.5, 2] and b in [1, 4], 1 rectangle: 100.0 % refuted.
    """

    letters: tuple[str, str]
    region: tuple[tuple[float, float], tuple[float, float]]
    rectangles: Floats
    verdicts: tuple[str, ...]
    curvature_bounds: Floats
    thresholds: tuple[ThresholdCurve, ...]
    curvature: CurvatureMap
    defaults: tuple[float, float]
    fixed: Mapping[str, tuple[float, float]]
    judged: int

    @property
    def share(self) -> dict[str, float]:
        """The share of the area of each verdict."""
        areas = np.diff(self.rectangles, axis=2).prod(axis=(1, 2))
        return {
            word: float(areas[self._which(word)].sum() / areas.sum())
            for word in (CERTIFIED, REFUTED, DEGENERATE, UNDECIDED)
        }

    def parts(self, verdict: str) -> Floats:
        """The rectangles (m, 2, 2) of one verdict."""
        return self.rectangles[self._which(verdict)]

    def verdict_at(self, first: float, second: float) -> str:
        """What is known at a pair of values, on a line between rectangles from the one that says most.

        Raises
        ------
        RsymError
            Outside the region.
        """
        low, high = self.rectangles[..., 0], self.rectangles[..., 1]
        here = ((low <= (first, second)) & ((first, second) <= high)).all(axis=1)
        if not here.any():
            ends = " and ".join(f"[{a:g}, {b:g}]" for a, b in self.region)
            raise RsymError(
                f"({first:g}, {second:g}) is outside the atlas", code="letter-range", remedy=f"choose from {ends}"
            )
        words = {self.verdicts[number] for number in np.flatnonzero(here)}
        return next(word for word in (CERTIFIED, REFUTED, DEGENERATE, UNDECIDED) if word in words)

    def _which(self, verdict: str) -> NDArray[np.bool_]:
        return np.array([word == verdict for word in self.verdicts])

    def __repr__(self) -> str:
        first, second = self.letters
        return f"<SmoothnessAtlas of {first}, {second}: {len(self.rectangles)} rectangles>"

    def document(self) -> Document:
        """All that the atlas says."""
        parts = zip(self.rectangles, self.verdicts, self.curvature_bounds, strict=True)
        rectangles = [
            {"sides": sides, "verdict": verdict, "curvature_bound": float(bound)} for sides, verdict, bound in parts
        ]
        greatest = {"proved": False, "points": self.curvature.points, "values": self.curvature.values}
        data = {
            "letters": self.letters,
            "region": self.region,
            "defaults": self.defaults,
            "fixed": self.fixed,
            "share": self.share,
            "rectangles": rectangles,
            "thresholds": [_threshold(curve) for curve in self.thresholds],
            "greatest_curvature": greatest,
            "judged": self.judged,
        }
        counts = [(word, sum(one == word for one in self.verdicts), part) for word, part in self.share.items()]
        rows = [(word, str(count), tenths(part, up=word == UNDECIDED)) for word, count, part in counts if count]
        return Document(
            "smoothness-atlas",
            self._headline(),
            sentences=tuple(self._sentences()),
            tables=(Tabular(("verdict", "rectangles", "share"), tuple(rows), told=False),),
            data=data,
        )

    def _headline(self) -> Sentence:
        ranges = " and ".join(
            f"{name} in [{number(a)}, {number(b)}]" for name, (a, b) in zip(self.letters, self.region, strict=True)
        )
        shares = [f"{tenths(part, up=word == UNDECIDED)} {MEANINGS[word]}" for word, part in self.share.items() if part]
        count = plural(len(self.rectangles), "rectangle")
        return Sentence(f"Atlas of {ranges}, {count}: {', '.join(shares)}.", True)

    def _sentences(self) -> Iterator[Sentence]:
        if self.thresholds:
            count = plural(len(self.thresholds), "threshold")
            yield Sentence(f"{count}: {'; '.join(map(str, self.thresholds))}.", True)
        if len(self.curvature.values):
            low, high = (number(end, 3) for end in (self.curvature.values.min(), self.curvature.values.max()))
            found = f"the greatest curvature found is {low} to {high}"
            yield Sentence(f"Where it is smooth {found}; this is no proof.", False)


def _threshold(curve: ThresholdCurve) -> dict[str, Any]:
    return {
        "letter": curve.graph,
        "span": curve.span,
        "share": curve.share,
        "relative_width": curve.relative_width,
        "strip": curve.strip,
        "certified_side": curve.certified_side,
        "refuted_side": curve.refuted_side,
        "middle": {"proved": False, "lines": curve.middle},
    }


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
