"""What a check of normalisation answers: a verdict, the worst places, and the bounds that are proved."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, Document, Sentence, Tabular
from rsym.reports.numbers import at_most, measured, number, point
from rsym.reports.render import Report, as_json
from rsym.reports.words import first_of, letters_text, plural, within

LISTED = 3  # singular places named in the text
COLUMNS = ("derivative", "worst deviation found", "at", "proved there", "proved bound")


@dataclass(frozen=True)
class NormalDerivative:
    """The deviation d omega/d nu - 1 (order 1) or d^k omega/d nu^k (order k) at a point of the boundary.

    Where `proved`, a point of the boundary at which the deviation is within `error` of `deviation` is proved to
    lie nearer to `point` than float64 can tell; else both are numbers of high precision, with nothing proved.
    """

    order: int
    deviation: float
    error: float
    point: tuple[float, ...]
    proved: bool


@dataclass(frozen=True, eq=False)
class NormalisationReport(Report):
    """The answer to the question whether a function is normalised to an order on its boundary.

    verdict : "CERTIFIED", the deviations of all orders are proved to be at most `tolerance` in size all along the
        boundary but at its corners and edges, where omega has no gradient; "REFUTED", one is proved to be larger;
        "DEGENERATE", it is proved that there is no boundary; "UNDECIDED", nothing of this.
    worst : the largest deviation found of each order, by sampling: larger ones are not excluded by that.
    proved_bounds : no deviation of an order is larger on the boundary in `covered`; NaN where no bound was sought.
    covered, uncovered : boxes (n, dim, 2) that hold all of the boundary within `bounds`.
    crossed : those of `covered` in which leaves may meet at corners or edges, to which no bound applies.
    singular : points (n, dim) of the boundary where omega has no gradient or a zero one, where normals break or
        where no bound could be proved however small the box: numerical places, one for a group.
    samples : how many points of the boundary were sampled.
    statements : sentences, each with whether it is proved.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> line = rsym.Shape(2 * x, (x, y), bounds=((-1, 1), (-1, 1)))
    >>> report = rsym.verify_normalisation(line, resolution=16)
    >>> report.verdict, report.worst[0].deviation
    ('REFUTED', 1.0)
    """

    verdict: str
    order: int
    tolerance: float
    worst: tuple[NormalDerivative, ...]
    proved_bounds: tuple[float, ...]
    covered: NDArray[np.float64]
    crossed: NDArray[np.float64]
    uncovered: NDArray[np.float64]
    singular: NDArray[np.float64]
    bounds: tuple[tuple[float, float], ...]
    letters: Mapping[str, tuple[float, float]]
    samples: int
    examined: int
    statements: tuple[tuple[str, bool], ...] = field(default=())

    def document(self) -> Document:
        """All that the report says."""
        boxes = {"covered": len(self.covered), "crossed": len(self.crossed), "uncovered": len(self.uncovered)}
        return Document(
            "normalisation-report",
            self._headline(),
            self.verdict,
            sentences=(*self._worst_found(), *self._boxes(), *self._places()),
            statements=tuple(Sentence(*statement) for statement in self.statements),
            tables=(Tabular(COLUMNS, tuple(self._rows()), told=False),) if self.worst else (),
            data={
                "order": self.order,
                "tolerance": self.tolerance,
                "letters": self.letters,
                "bounds": self.bounds,
                "worst": self.worst,
                "proved_bounds": self.proved_bounds,
                "singular": self.singular,
                "samples": self.samples,
                "boxes_examined": self.examined,
                "boxes_counted": boxes,
            },
        )

    def to_json(self, *, boxes: bool = False) -> str:
        """The report for programs, null where a number is unknown or has no bound; `boxes` lists all of the proof."""
        lists = {"covered": self.covered, "crossed": self.crossed, "uncovered": self.uncovered} if boxes else {}
        return as_json(self.document(), **lists)

    def _headline(self) -> Sentence:
        what = within("omega", self.bounds, letters_text(self.letters))
        limit = f"to order {self.order} within {number(self.tolerance)}"
        answers = {
            CERTIFIED: f"{what} is normalised {limit} all along its boundary{self._apart()}; this is proved",
            REFUTED: f"{what} is not normalised {limit}; this is proved",
            DEGENERATE: f"{what} has no boundary; this is proved",
        }
        undecided = f"whether {what} is normalised {limit} is neither proved nor refuted"
        return Sentence(f"{self.verdict}: {answers.get(self.verdict, undecided)}.", self.verdict in answers)

    def _corners(self) -> str:
        return "corners" if len(self.bounds) == 2 else "edges and corners"

    def _apart(self) -> str:
        return f" but at its {self._corners()}" if len(self.crossed) else ""

    def _worst_found(self) -> Iterator[Sentence]:
        for place in self.worst:
            how = "proved at a point enclosed" if place.proved else "numerical, not proved,"
            found = f"found at {plural(self.samples, 'point')} of the boundary"
            size = measured(place.deviation, place.error)
            text = f"The largest {_name(place.order)} {found} is {size}, {how} near {point(place.point)}."
            yield Sentence(text, place.proved)

    def _rows(self) -> Iterator[tuple[str, ...]]:
        for place, bound in zip(self.worst, self.proved_bounds, strict=True):
            size = measured(place.deviation, place.error)
            limit = at_most(bound) if math.isfinite(bound) else "none"
            yield _name(place.order), size, point(place.point), "yes" if place.proved else "no", limit

    def _boxes(self) -> Iterator[Sentence]:
        """What the boxes prove, and where they do not."""
        if self.examined and len(self.covered):
            bounds = zip(range(1, self.order + 1), self.proved_bounds, strict=True)
            limits = " and ".join(f"|{_name(k)}| <= {at_most(bound)}" for k, bound in bounds if math.isfinite(bound))
            boxes = plural(len(self.covered), "box", "boxes")
            yield Sentence(f"Proved: {limits} at all of the boundary in {boxes}.", True)
        if len(self.crossed):
            boxes = plural(len(self.crossed), "of these boxes holds", "of these boxes hold")
            yield Sentence(
                f"{boxes} the {self._corners()} at most, where leaves cross and omega has no gradient.", True
            )
        if self.examined and len(self.uncovered):
            boxes = plural(len(self.uncovered), "other box", "other boxes")
            yield Sentence(f"Nothing is proved in {boxes}.", False)

    def _places(self) -> Iterator[Sentence]:
        if len(self.singular):
            places = first_of([point(one) for one in self.singular], LISTED)
            yield Sentence(f"Places without a derivative or without a bound, numerical: {places}.", False)


def _name(order: int) -> str:
    return "d omega/d nu - 1" if order == 1 else f"d^{order} omega/d nu^{order}"
