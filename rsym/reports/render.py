"""A document as text, as HTML for a notebook and as JSON for programs.

The schema of the JSON, version 1, for all reports:

=============  =========================================================================================
format         "rsym-" and the name of the report
version        1; raised when a key changes its meaning or goes, a key may be added without
verdict        "CERTIFIED", "REFUTED", "DEGENERATE", "UNDECIDED" or null
continuity     "unknown", "broken", "G0", "G1", "G2", "G3", "analytic" or null
headline       {"text", "proved"}: the first sentence
sentences      a list of {"text", "proved"}: those after it
statements     a list of {"text", "proved"}: clauses without a full stop
tables         a list of {"title", "header", "rows"}, all cells text
entries        a list of {"text", "proved", "defect"}: what the report lists
remarks        a list of {"text", "proved"}: remarks at the end
=============  =========================================================================================

Further keys are those of the report. `proved` is true or false, which says numerical. Every number is finite: null says
that it is unknown or, for a bound, that there is none.
"""

from __future__ import annotations

import json
import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from html import escape
from typing import Any

from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED, Document, Entry, Sentence, Tabular

VERSION = 1
# Okabe and Ito's colours, told apart by everybody; signs and words say the same.
SIGNS: Mapping[str, tuple[str, str]] = {
    CERTIFIED: ("✓", "#0072b2"),
    REFUTED: ("✗", "#d55e00"),
    DEGENERATE: ("∅", "#d55e00"),
    UNDECIDED: ("?", "#8a6100"),
}
COLOURS: Mapping[str, str] = {
    "broken": "#d55e00",
    "G0": "#e69f00",
    "G1": "#56b4e9",
    **dict.fromkeys(("G2", "G3", "analytic"), "#0072b2"),
}
CLASSES = {"class", "continuity"}  # columns whose words have colours
PROVED, NUMERICAL = "Proved", "Numerical, not proved"
BEST = "*"  # marks the best value of a column in plain text


class Report(ABC):
    """What has a document, and shows it."""

    @abstractmethod
    def document(self) -> Document:
        """All that the report says."""

    def __str__(self) -> str:
        return as_text(self.document())

    def to_json(self) -> str:
        """The report for programs: JSON with stable keys, null where a number is unknown or has no bound."""
        return as_json(self.document())

    def _repr_html_(self) -> str:
        return as_html(self.document())


def as_text(document: Document) -> str:
    """A paragraph, then the tables, a line for each entry, and the notes.

    Examples
    --------
    >>> entries = (Entry("a crack", True), Entry("a seam", False, label="also"))
    >>> print(as_text(Document("x", Sentence("Two places.", True), entries=entries)))
    Two places.
      1. a crack
      also a seam
    """
    paragraph = [document.headline.text, *(one.text for one in document.sentences)]
    for known, word in ((True, PROVED), (False, NUMERICAL)):
        said = [text.rstrip(".") for text, is_proved in document.statements if is_proved == known]
        paragraph += [f"{word}: {'; '.join(said)}."] if said else []
    lines = [" ".join(filter(None, paragraph))] if any(paragraph) else []
    for table in document.tables:
        lines += aligned(table) if table.told else []
    lines += _entry_lines(document)
    return "\n".join([*lines, *(remark.text for remark in document.remarks)])


def _entry_lines(document: Document, *, with_cells: bool = True) -> Iterator[str]:
    told = [(label, entry) for label, entry in _labelled(document) if entry.told and (with_cells or not entry.cells)]
    shown = told if document.most is None else told[: document.most]
    for label, entry in shown:
        text = entry.text.replace("\n", "\n  ")
        mark = f"{label}." if entry.label is None else entry.label
        yield f"  {f'{mark} ' if mark else ''}{text}"
    if len(told) > len(shown):
        yield f"  and {len(told) - len(shown)} more"


def _labelled(document: Document) -> list[tuple[str, Entry]]:
    """The entries with their numbers; those that have a label have none."""
    count, labelled = 0, list[tuple[str, Entry]]()
    for entry in document.entries:
        count += entry.label is None
        labelled.append((str(count) if entry.label is None else "", entry))
    return labelled


def aligned(table: Tabular) -> list[str]:
    """A table in plain text.

    Examples
    --------
    >>> aligned(Tabular(("", "least"), (("a", "1"), ("long", "2")), frozenset({(1, 1)})))
    ['        least', '  a     1', '  long  2*']
    """
    cells = [[cell + BEST * ((i, j) in table.best) for j, cell in enumerate(row)] for i, row in enumerate(table.rows)]
    rows: list[Sequence[str]] = [table.header, *cells]
    widths = [max(len(row[k]) for row in rows) for k in range(len(table.header))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return [*([table.title] if table.title else []), *(f"  {line}" for line in lines)]


def as_html(document: Document) -> str:
    """A headline, small tables, and what else is said; readable without its colours.

    Examples
    --------
    >>> as_html(Document("x", Sentence("REFUTED: 1 < 2.", True), "REFUTED"))
    '<div><p><b style="color: #d55e00">✗ REFUTED</b>: 1 &lt; 2.</p></div>'
    """
    tables = [html_table(table) for table in document.tables]
    shown = [(label, entry) for label, entry in _labelled(document) if entry.cells]
    numbered = any(label for label, _ in shown)
    rows = tuple((label, *entry.cells) if numbered else entry.cells for label, entry in shown)
    tables += [html_table(Tabular(("", *document.columns) if numbered else document.columns, rows))] if rows else []
    notes = [one.text for one in document.sentences]
    notes += [f"{PROVED if known else NUMERICAL}: {text.rstrip('.')}." for text, known in document.statements]
    notes += [line.strip() for line in _entry_lines(document, with_cells=False)]
    notes += [one.text.strip() for one in document.remarks]
    small = f'<p style="font-size: smaller">{"<br>".join(map(escape, notes))}</p>' if notes else ""
    return f"<div>{_title(document)}{''.join(tables)}{small}</div>"


def _title(document: Document) -> str:
    text, verdict = document.headline.text, document.verdict
    if verdict is not None and text.startswith(verdict):
        sign, colour = SIGNS[verdict]
        return f'<p><b style="color: {colour}">{sign} {verdict}</b>{escape(text.removeprefix(verdict))}</p>'
    own = COLOURS.get(document.continuity or "")
    style = f' style="color: {own}"' if own else ""
    return f"<p><b{style}>{escape(text)}</b></p>" if text else ""


def html_table(table: Tabular) -> str:
    """A table; classes have their colours, the best of a column is bold.

    Examples
    --------
    >>> html_table(Tabular(("class",), (("G1",),)))
    '<table><tr><th style="text-align: left">class</th></tr><tr>\
<td style="text-align: left; border-left: 4px solid #56b4e9">G1</td></tr></table>'
    """
    head = "".join(_cell("th", name) for name in table.header)
    body = ""
    for i, row in enumerate(table.rows):
        cells = ""
        for j, text in enumerate(row):
            colour = COLOURS.get(text, "") if table.header[j] in CLASSES else ""
            cells += _cell("td", text, colour, bold=(i, j) in table.best)
        body += f"<tr>{cells}</tr>"
    caption = f"<caption>{escape(table.title)}</caption>" if table.title else ""
    return f"<table>{caption}<tr>{head}</tr>{body}</table>"


def _cell(tag: str, text: str, colour: str = "", *, bold: bool = False) -> str:
    border = f"; border-left: 4px solid {colour}" if colour else ""
    inner = "<br>".join(map(escape, text.split("\n")))
    inner = f"<b>{inner}</b>" if bold else inner
    return f'<{tag} style="text-align: left{border}">{inner}</{tag}>'


def as_json(document: Document, **more: Any) -> str:
    """A document as JSON text by the schema of this module; `more` are further fields of the report."""
    return json.dumps(as_record(document) | plain(more), indent=2, allow_nan=False)


def as_record(document: Document) -> dict[str, Any]:
    """What JSON says of a document.

    Examples
    --------
    >>> record = as_record(Document("x-report", Sentence("All is well.", True), data={"size": math.inf}))
    >>> record["format"], record["version"], record["headline"], record["size"]
    ('rsym-x-report', 1, {'text': 'All is well.', 'proved': True}, None)
    """
    tables = [{"title": one.title, "header": one.header, "rows": one.rows} for one in document.tables]
    return {
        "format": f"rsym-{document.name}",
        "version": VERSION,
        "verdict": document.verdict,
        "continuity": document.continuity,
        "headline": _sentence(document.headline),
        "sentences": [_sentence(one) for one in document.sentences],
        "statements": [_sentence(one) for one in document.statements],
        "tables": plain(tables),
        "entries": [{"text": one.text, "proved": one.proved, "defect": one.defect} for one in document.entries],
        "remarks": [_sentence(one) for one in document.remarks],
        **plain(document.data),
    }


def _sentence(one: Sentence) -> dict[str, Any]:
    return {"text": one.text, "proved": one.proved}


def plain(value: Any) -> Any:
    """What JSON can say: lists for arrays and tuples, the fields of a dataclass by name, null for what is not finite.

    Examples
    --------
    >>> plain({"a": (1, math.nan), "b": Sentence("so", True)})
    {'a': [1, None], 'b': ['so', True]}
    """
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, Mapping):
        return {name: plain(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if is_dataclass(value):
        return {part.name: plain(getattr(value, part.name)) for part in fields(value)}
    return None if isinstance(value, float) and not math.isfinite(value) else value
