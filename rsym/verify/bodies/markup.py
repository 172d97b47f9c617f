"""A verdict on a body in a notebook: a small table, readable without its colours."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from rsym.verify.bodies.groups import Group, groups
from rsym.verify.bodies.phrases import cut, place, short
from rsym.verify.bodies.wording import body_headline, curvatures_text, curves_effect, points_effect, undecided_text
from rsym.verify.markup import SIGNS, cell

if TYPE_CHECKING:
    from rsym.verify.bodies.report import BodyReport

HEADER = ("", "kind", "count", "definitions", "where", "what happens", "continuity", "proved", "traced")
PLACES, DIGITS = 3, 6  # points that a cell lists, and digits of their coordinates


def body_html(report: BodyReport) -> str:
    """A headline, a table of curves and points, and what the boxes prove.

    Examples
    --------
    >>> import math
    >>> import numpy as np
    >>> from rsym.verify.bodies.report import BodyCover, BodyReport
    >>> none = np.empty((0, 3, 2))
    >>> unbounded, cover = (-math.inf, math.inf), BodyCover(((-2, 2),) * 3, none, none, none, 1)
    >>> report = BodyReport("DEGENERATE", "broken", (), (), unbounded, (math.nan, math.nan), cover, {})
    >>> "<table" in body_html(report), "DEGENERATE" in body_html(report)
    (False, True)
    """
    sign, colour = SIGNS[report.verdict]
    word, _, rest = body_headline(report).partition(": ")
    title = f'<p><b style="color: {colour}">{sign} {word}</b>: {escape(rest)}.</p>'
    defects, joints = groups(report)
    rows = [_row(str(number), group) for number, group in enumerate(defects, 1)] + [_row("", one) for one in joints]
    head = "".join(cell("th", name) for name in HEADER)
    table = f"<table><tr>{head}</tr>{''.join(rows)}</table>" if rows else ""
    notes = [curvatures_text(report)]
    if len(report.undecided):
        notes.append(undecided_text(report))
    notes += [f"{'Proved' if proved else 'Not proved'}: {text}" for text, proved in report.statements]
    small = "".join(f"<br>{escape(note)}" for note in notes).removeprefix("<br>")
    return f'<div>{title}{table}<p style="font-size: smaller">{small}</p></div>'


def _row(label: str, group: Group) -> str:
    return f"<tr>{''.join(cell('td', text) for text in (label, *group_cells(group)))}</tr>"


def group_cells(group: Group) -> tuple[str, ...]:
    """What a row of a table tells of a group, under `HEADER` without its first column."""
    first = group.first
    names = " | ".join(dict.fromkeys(cut(name) for name in first.names if name))
    proved = "✓ yes" if first.proved else "✗ no"
    if group.curves:
        count, effect = len(group.curves), curves_effect(group.curves)
        where = f"length {short(sum(curve.length for curve in group.curves))}"
        traced = f"{sum(curve.traced for curve in group.curves)} of {count}"
    else:
        count, effect, traced = len(group.points), points_effect(group.points), ""
        where = ", ".join([place(one.point, DIGITS) for one in group.points[:PLACES]] + ["..."] * (count > PLACES))
    return first.kind, str(count), names, where, effect, first.continuity, proved, traced
