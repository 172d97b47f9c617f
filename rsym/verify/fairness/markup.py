"""A report of fairness in a notebook: a headline and two small tables."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING

from rsym.reports.numbers import measured
from rsym.reports.render import SIGNS
from rsym.verify.fairness.wording import HEADER, bound_rows, place_text, sentences

if TYPE_CHECKING:
    from rsym.verify.fairness.report import Extremum, FairnessReport

PLACES = ("", "place", "kind", "of", "value", "proved")


def fairness_html(report: FairnessReport) -> str:
    """A headline, the bounds, the extrema."""
    sign, colour = SIGNS[report.verdict]
    head, *rest = sentences(report)
    word, _, about = head.partition(": ")
    title = f'<p><b style="color: {colour}">{sign} {word}</b>: {escape(about)}</p>'
    places = [_place(str(k), one) for k, one in enumerate((*report.extrema, *report.inflections), 1)]
    tables = table(HEADER, bound_rows(report)) + (table(PLACES, places) if places else "")
    return f'<div>{title}{tables}<p style="font-size: smaller">{escape(" ".join(rest))}</p></div>'


def _place(label: str, one: Extremum) -> Sequence[str]:
    value = "" if one.kind == "inflection" else measured(one.curvature, one.error)
    return label, place_text(one.point), one.kind, one.quantity, value, "✓ yes" if one.proved else "✗ no"


def table(header: Sequence[str], rows: Sequence[Sequence[str]], bold: frozenset[tuple[int, int]] = frozenset()) -> str:
    """An HTML table; the cells of `bold` are (row, column)."""
    head = "".join(_cell("th", name) for name in header)
    body = ""
    for i, row in enumerate(rows):
        body += f"<tr>{''.join(_cell('td', cell, (i, j) in bold) for j, cell in enumerate(row))}</tr>"
    return f"<table><tr>{head}</tr>{body}</table>"


def _cell(tag: str, text: str, bold: bool = False) -> str:
    inner = f"<b>{escape(text)}</b>" if bold else escape(text)
    return f'<{tag} style="text-align: left">{inner}</{tag}>'
