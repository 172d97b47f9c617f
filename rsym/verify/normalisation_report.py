"""What a check of normalisation answers: a verdict, the worst places, and the bounds that are proved."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from html import escape

import numpy as np
from numpy.typing import NDArray

from rsym.reports.numbers import at_most, measured, number
from rsym.reports.render import SIGNS, plain
from rsym.reports.words import letters_text, plural, within

FORMAT = "rsym-normalisation-report"
VERSION = 1
LISTED = 3  # singular places named in the text


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
class NormalisationReport:
    """The answer to the question whether a function is normalised to an order on its boundary.

    verdict : "CERTIFIED", the deviations of all orders are proved to be at most `tolerance` in size all along the
        boundary; "REFUTED", one is proved to be larger; "DEGENERATE", it is proved that there is no boundary;
        "UNDECIDED", nothing of this.
    worst : the largest deviation found of each order, by sampling: larger ones are not excluded by that.
    proved_bounds : no deviation of an order is larger on the boundary in `covered`; NaN where no bound was sought.
    covered, uncovered : boxes (n, dim, 2) that hold all of the boundary within `bounds`.
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
    uncovered: NDArray[np.float64]
    singular: NDArray[np.float64]
    bounds: tuple[tuple[float, float], ...]
    letters: Mapping[str, tuple[float, float]]
    samples: int
    examined: int
    statements: tuple[tuple[str, bool], ...] = field(default=())

    def __str__(self) -> str:
        return " ".join(_sentences(self))

    def to_json(self, *, boxes: bool = False) -> str:
        """The report for programs: JSON with stable keys, null where a number is unknown or has no bound."""
        record = {
            "format": FORMAT,
            "version": VERSION,
            "verdict": self.verdict,
            "order": self.order,
            "tolerance": self.tolerance,
            "letters": {name: plain(ends) for name, ends in self.letters.items()},
            "bounds": plain(self.bounds),
            "worst": [{name: plain(value) for name, value in vars(place).items()} for place in self.worst],
            "proved_bounds": plain(self.proved_bounds),
            "singular": plain(self.singular),
            "samples": self.samples,
            "statements": [{"text": text, "proved": proved} for text, proved in self.statements],
            "boxes_examined": self.examined,
            "boxes_counted": {"covered": len(self.covered), "uncovered": len(self.uncovered)},
        }
        lists = {"covered": plain(self.covered), "uncovered": plain(self.uncovered)} if boxes else {}
        return json.dumps(record | lists, indent=2, allow_nan=False)

    def _repr_html_(self) -> str:
        sign, colour = SIGNS[self.verdict]
        word, _, rest = _headline(self).partition(": ")
        title = f'<p><b style="color: {colour}">{sign} {word}</b>: {escape(rest)}.</p>'
        rows = [("derivative", "worst deviation found", "at", "proved there", "proved bound")]
        for place, bound in zip(self.worst, self.proved_bounds, strict=True):
            size = measured(place.deviation, place.error)
            limit = at_most(bound) if math.isfinite(bound) else "none"
            rows.append((_name(place.order), size, _point(place.point), "yes" if place.proved else "no", limit))
        cells = ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows]
        table = f"<table>{''.join(f'<tr>{row}</tr>' for row in cells)}</table>" if self.worst else ""
        notes = "<br>".join(escape(sentence) for sentence in [*_boxes(self), *_remarks(self)])
        return f'<div>{title}{table}<p style="font-size: smaller">{notes}</p></div>'


def _sentences(report: NormalisationReport) -> Iterator[str]:
    yield f"{_headline(report)}."
    for place in report.worst:
        how = "proved at a point enclosed" if place.proved else "numerical, not proved,"
        yield (
            f"The largest {_name(place.order)} found at {plural(report.samples, 'point', 'points')} of the boundary is "
            f"{measured(place.deviation, place.error)}, {how} near {_point(place.point)}."
        )
    yield from _boxes(report)
    yield from _remarks(report)


def _headline(report: NormalisationReport) -> str:
    what = within("omega", report.bounds, letters_text(report.letters))
    limit = f"to order {report.order} within {number(report.tolerance)}"
    answers = {
        "CERTIFIED": f"{what} is normalised {limit} all along its boundary; this is proved",
        "REFUTED": f"{what} is not normalised {limit}; this is proved",
        "DEGENERATE": f"{what} has no boundary; this is proved",
    }
    undecided = f"whether {what} is normalised {limit} is neither proved nor refuted"
    return f"{report.verdict}: {answers.get(report.verdict, undecided)}"


def _boxes(report: NormalisationReport) -> Iterator[str]:
    """What the boxes prove, and where they do not."""
    if not report.examined:
        return
    if len(report.covered):
        bounds = zip(range(1, report.order + 1), report.proved_bounds, strict=True)
        limits = " and ".join(f"|{_name(k)}| <= {at_most(bound)}" for k, bound in bounds if math.isfinite(bound))
        yield f"Proved: {limits} at all of the boundary in {plural(len(report.covered), 'box', 'boxes')}."
    if len(report.uncovered):
        yield f"Nothing is proved in {plural(len(report.uncovered), 'other box', 'other boxes')}."


def _remarks(report: NormalisationReport) -> Iterator[str]:
    if len(report.singular):
        places = ", ".join(_point(point) for point in report.singular[:LISTED])
        more = f" and {len(report.singular) - LISTED} more" if len(report.singular) > LISTED else ""
        yield f"Places without a derivative or without a bound, numerical: {places}{more}."
    for sentence, proved in report.statements:
        text = sentence.rstrip(".")
        yield f"Proved: {text}." if proved else f"{text[0].upper()}{text[1:]}."


def _name(order: int) -> str:
    return "d omega/d nu - 1" if order == 1 else f"d^{order} omega/d nu^{order}"


def _point(point: NDArray[np.float64] | tuple[float, ...]) -> str:
    return f"({', '.join(number(float(c)) for c in point)})"
