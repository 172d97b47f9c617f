"""What an atlas of two letters says."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.reports.render import plain
from rsym.reports.words import plural
from rsym.verify.atlas.grid import Floats
from rsym.verify.atlas.levels import CurvatureMap
from rsym.verify.atlas.threshold_curve import ThresholdCurve

FORMAT = "rsym-smoothness-atlas"
# Raised when a key changes its meaning or goes; a key may be added without.
VERSION = 1
MEANINGS = {
    CERTIFIED: "certified",
    REFUTED: "refuted",
    DEGENERATE: "without a boundary",
    UNDECIDED: "undecided",
}


@dataclass(frozen=True, eq=False, repr=False)
class SmoothnessAtlas:
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

    def __str__(self) -> str:
        ranges = " and ".join(
            f"{name} in [{a:g}, {b:g}]" for name, (a, b) in zip(self.letters, self.region, strict=True)
        )
        shares = [f"{100 * part:.1f} % {MEANINGS[word]}" for word, part in self.share.items() if part > 0]
        text = f"Atlas of {ranges}, {plural(len(self.rectangles), 'rectangle', 'rectangles')}: {', '.join(shares)}."
        if self.thresholds:
            text += f" {plural(len(self.thresholds), 'threshold', 'thresholds')}: "
            text += "; ".join(map(str, self.thresholds)) + "."
        if len(self.curvature.values):
            low, high = self.curvature.values.min(), self.curvature.values.max()
            text += f" Where it is smooth the greatest curvature found is {low:.3g} to {high:.3g}; this is no proof."
        return text

    def __repr__(self) -> str:
        first, second = self.letters
        return f"<SmoothnessAtlas of {first}, {second}: {len(self.rectangles)} rectangles>"

    def to_json(self) -> str:
        """The atlas for programs: JSON with stable keys, null where a number has no bound."""
        parts = zip(self.rectangles, self.verdicts, self.curvature_bounds, strict=True)
        record: dict[str, Any] = {
            "format": FORMAT,
            "version": VERSION,
            "letters": list(self.letters),
            "region": plain(self.region),
            "defaults": plain(self.defaults),
            "fixed": {name: plain(ends) for name, ends in self.fixed.items()},
            "share": self.share,
            "rectangles": [
                {"sides": plain(sides), "verdict": verdict, "curvature_bound": plain(float(bound))}
                for sides, verdict, bound in parts
            ],
            "thresholds": [_threshold(curve) for curve in self.thresholds],
            "greatest_curvature": {
                "proved": False,
                "points": plain(self.curvature.points),
                "values": plain(self.curvature.values),
            },
            "judged": self.judged,
        }
        return json.dumps(record, indent=2, allow_nan=False)


def _threshold(curve: ThresholdCurve) -> dict[str, Any]:
    return {
        "letter": curve.graph,
        "span": plain(curve.span),
        "share": curve.share,
        "relative_width": plain(curve.relative_width),
        "strip": plain(curve.strip),
        "certified_side": [plain(line) for line in curve.certified_side],
        "refuted_side": [plain(line) for line in curve.refuted_side],
        "middle": {"proved": False, "lines": [plain(line) for line in curve.middle]},
    }
