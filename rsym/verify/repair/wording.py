"""A repair in words, in a notebook, and for programs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from html import escape
from typing import TYPE_CHECKING

from rsym.reports.numbers import at_most
from rsym.reports.render import SIGNS, plain
from rsym.reports.words import plural
from rsym.verify.repair.prices import price_words

if TYPE_CHECKING:
    from rsym.verify.repair.report import RepairReport

FORMAT = "rsym-repair-report"
VERSION = 1
HEADER = ("", "change", "verdict, proved", "boundary", "content", "curvature, proved", "normalisation")
NUMERICAL = "Distances, areas, volumes and normalisation are numerical, verdicts and bounds of curvature proved."


def repair_text(report: RepairReport) -> str:
    """A headline, then a line for each candidate, the smallest change first, and for each that was rejected.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> print(repair_text(rsym.repair(disc)))
    CERTIFIED, analytic, as it is: nothing to repair.
    """
    return "\n".join(_lines(report))


def _lines(report: RepairReport) -> Iterator[str]:
    yield _headline(report)
    for number, one in enumerate(report.candidates, 1):
        note = f" Proved: {one.note}." if one.note else ""
        yield f"  {number}. {one.change}: CERTIFIED, {one.report.continuity}; {one.price}.{note}"
    for other in report.rejected:
        yield f"  rejected: {other.change}: {other.reason}"
    if report.candidates:
        yield NUMERICAL


def _headline(report: RepairReport) -> str:
    before = report.before
    if not report.needed:
        return f"CERTIFIED, {before.continuity}, as it is: nothing to repair."
    lack = f"with {plural(len(before.defects), 'defect')}"
    if before.verdict == "CERTIFIED":
        lack = f"its curvature only bounded by {at_most(before.curvature_bound)}"
    found = f"{before.verdict}, {before.continuity}, {lack}"
    if not report.candidates:
        return f"{found}; no candidate was found."
    return f"{found}; {plural(len(report.candidates), 'certified candidate')}, the least moved first."


def repair_html(report: RepairReport) -> str:
    """A headline and a table of the candidates."""
    sign, colour = SIGNS[report.before.verdict]
    title = f'<p><b style="color: {colour}">{sign}</b> {escape(_headline(report))}</p>'
    rows = [
        (str(number), one.change, f"CERTIFIED, {one.report.continuity}", *price_words(one.price))
        for number, one in enumerate(report.candidates, 1)
    ]
    table = _row("th", HEADER) + "".join(_row("td", row) for row in rows)
    notes = [f"{one.change}: {one.note} (proved)" for one in report.candidates if one.note]
    notes += [f"rejected: {other.change}: {other.reason}" for other in report.rejected]
    notes += [NUMERICAL] if rows else []
    small = "<br>".join(map(escape, notes))
    shown = f"<table>{table}</table>" if rows else ""
    return f'<div>{title}{shown}<p style="font-size: smaller">{small}</p></div>'


def _row(tag: str, cells: tuple[str, ...]) -> str:
    left = '<{0} style="text-align: left">{1}</{0}>'
    return f"<tr>{''.join(left.format(tag, escape(cell)) for cell in cells)}</tr>"


def repair_json(report: RepairReport) -> str:
    """A repair as JSON text."""
    candidates = [
        {
            "move": one.move,
            "change": one.change,
            "verdict": one.report.verdict,
            "continuity": one.report.continuity,
            "expression": str(one.shape.expression),
            "letters": {name: float(letter.default) for name, letter in one.shape.letters.items()},
            "price": {name: plain(value) for name, value in asdict(one.price).items()},
            "note": one.note,
        }
        for one in report.candidates
    ]
    record = {
        "format": FORMAT,
        "version": VERSION,
        "before": {"verdict": report.before.verdict, "continuity": report.before.continuity},
        "needed": report.needed,
        "candidates": candidates,
        "rejected": [asdict(other) for other in report.rejected],
    }
    return json.dumps(record, indent=2, allow_nan=False)
