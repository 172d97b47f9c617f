"""A report of fairness in words: one paragraph, a table of bounds, a line for each extremum."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from typing import TYPE_CHECKING

from rsym.reports.numbers import measured, number
from rsym.reports.words import letters_text, plural, within
from rsym.verify.report import UNKNOWN

if TYPE_CHECKING:
    from rsym.verify.fairness.report import Extremum, FairnessReport, Peak

MEASURES: Mapping[str, str] = {
    "length": "length",
    "area": "area",
    "volume": "volume",
    "bending_energy": "bending energy",
    "variation_energy": "variation energy",
}
HEADER = ("", "proved", "attained", "at")
LISTED = 24  # places; the report has them all
SHOWN = 5  # digits of a bound, and more of what is attained


def fairness_text(report: FairnessReport) -> str:
    """The whole report."""
    lines = [" ".join(sentences(report)), *aligned([HEADER, *bound_rows(report)])]
    places = (*report.extrema, *report.inflections)
    lines += [f"  {place}. {one}" for place, one in enumerate(places[:LISTED], 1)]
    lines += [f"  and {len(places) - LISTED} more"] if len(places) > LISTED else []
    return "\n".join(lines)


def sentences(report: FairnessReport) -> Iterator[str]:
    """The paragraph at the beginning."""
    yield f"{headline(report)}."
    for bounds, constant in zip(report.curvatures, report.constant, strict=True):
        if constant:
            yield f"The {bounds.name} is constant{between(report)}; this is proved."
    yield extrema_sentence(report)
    if report.measures:
        told = [f"{MEASURES[name]} {measured(one.value, one.error)}" for name, one in report.measures.items()]
        yield f"Numerically: {', '.join(told)}."
    for proved, word in ((True, "Proved"), (False, "Not proved")):
        said = [sentence for sentence, status in report.statements if status == proved]
        if said:
            yield f"{word}: {'; '.join(said)}."


def headline(report: FairnessReport) -> str:
    """The verdict on smoothness, and of what."""
    smoothness = report.smoothness
    letters = letters_text(smoothness.letters)
    what = {"curve": "the boundary", "body": "the surface"}.get(report.kind, "the surface of revolution")
    about = within(what, smoothness.cover.bounds, letters)
    known = report.continuity != UNKNOWN
    count = plural(len(smoothness.defects), "place")
    places = f", {'broken' if known else 'in doubt'} at {count}" if smoothness.defects else ""
    if known:
        return f"{report.verdict}: {about} is {report.continuity}{places}"
    return f"{report.verdict}: how smooth {about} is, is not known{places}"


def between(report: FairnessReport) -> str:
    """Where the bounds hold."""
    return " between the defects" if report.smoothness.defects else ""


def extrema_sentence(report: FairnessReport) -> str:
    """How many there are, and whether these are all."""
    if all(report.constant):
        return "Every point is an extremum of the curvature."
    counts = Counter(one.kind for one in report.extrema)
    words = [plural(counts[kind], kind, many) for kind, many in KINDS.items() if counts[kind]]
    if report.kind != "body":
        words.append(plural(len(report.inflections), "inflection") if report.inflections else "no inflection")
    words = words or ["no isolated extremum"]
    what = "curvature has" if len(report.curvatures) == 1 else "curvatures have"
    all_of_them = "these are all, which is proved" if report.complete else "there may be more"
    smooth = not (report.smoothness.defects or getattr(report.smoothness, "joints", ()))
    return f"{'The' if smooth else 'Between joints the'} {what} {_listed(words)}; {all_of_them}."


KINDS: Mapping[str, str] = {"maximum": "maxima", "minimum": "minima"}


def _listed(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


def bound_rows(report: FairnessReport) -> list[tuple[str, ...]]:
    """The rows of the table of bounds."""
    rows = []
    for bounds in report.curvatures:
        rows += [
            peak_row(f"least {bounds.name}", bounds.least, up=False),
            peak_row(f"greatest {bounds.name}", bounds.greatest),
            peak_row(f"variation of the {bounds.name}", bounds.variation),
        ]
    return rows


def peak_row(name: str, peak: Peak, *, up: bool = True) -> tuple[str, ...]:
    """Name, bound, value attained, place."""
    bound = "none" if not peak.proved or not math.isfinite(peak.bound) else directed(peak.bound, up=up)
    sign = "" if bound == "none" else "<= " if up else ">= "
    attained = "unknown" if math.isnan(peak.attained) else f"{peak.attained + 0.0:.{SHOWN + 3}g}"
    return name, sign + bound, attained, place_text(peak.point)


def place_text(point: Sequence[float]) -> str:
    """A point; what is below rounding is 0."""
    size = max(map(abs, point), default=0.0)
    return f"({', '.join(number(round_off(value, size)) for value in point)})" if point else ""


def round_off(value: float, size: float) -> float:
    """The value, 0 where it is below the rounding of a number of the size."""
    return 0.0 if abs(value) < 1e-14 * size else value


def directed(value: float, digits: int = SHOWN, *, up: bool) -> str:
    """A bound in few digits that is still a bound.

    Examples
    --------
    >>> directed(4.42601, 3, up=True), directed(4.42601, 3, up=False), directed(-0.33339, 3, up=False)
    ('4.43', '4.42', '-0.334')
    """
    rounding = ROUND_CEILING if up else ROUND_FLOOR
    return f"{float(Context(digits, rounding).create_decimal(value)) + 0.0:.{digits}g}"


def extremum_text(one: Extremum) -> str:
    """One place in a line."""
    proved = "proved" if one.proved else "numerical"
    if one.kind == "inflection":
        return f"inflection, the {one.quantity} changes its sign, at {place_text(one.point)}; {proved}"
    flat = " without changing its sign" if one.flat else ""
    value = f"{measured(one.curvature, one.error)}{flat}"
    return f"{one.kind} of the {one.quantity} at {place_text(one.point)}: {value}; {proved}"


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """A table in plain text."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return [
        "  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
