"""A verdict in a notebook: a small table, readable without its colours."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING

from rsym.verify.wording import cover_text, headline, measured, number

if TYPE_CHECKING:
    from rsym.verify.report import Joint, SmoothnessReport

# Okabe and Ito's colours, told apart by everybody; the sign says the same.
SIGNS: Mapping[str, tuple[str, str]] = {
    "CERTIFIED": ("✓", "#0072b2"),
    "REFUTED": ("✗", "#d55e00"),
    "DEGENERATE": ("∅", "#d55e00"),
    "UNDECIDED": ("?", "#8a6100"),
}
HEADER = ("", "place", "kind", "continuity", "turn", "curvatures", "proved")


def report_html(report: SmoothnessReport) -> str:
    """A headline, a table of defects and joints, and what the boxes prove.

    Examples
    --------
    >>> import math
    >>> import numpy as np
    >>> from rsym.verify.report import Cover, SmoothnessReport
    >>> none = np.empty((0, 2, 2))
    >>> cover = Cover(((-2, 2), (-2, 2)), none, none, none, 1)
    >>> report = SmoothnessReport("DEGENERATE", "broken", (), (), math.inf, cover, {})
    >>> "<table" in report_html(report), "DEGENERATE" in report_html(report)
    (False, True)
    """
    sign, colour = SIGNS[report.verdict]
    word, _, rest = headline(report).partition(": ")
    title = f'<p><b style="color: {colour}">{sign} {word}</b>: {escape(rest)}.</p>'
    rows = [_row(str(place), joint) for place, joint in enumerate(report.defects, 1)]
    rows += [_row("", joint) for joint in report.joints]
    head = "".join(cell("th", name) for name in HEADER)
    table = f"<table><tr>{head}</tr>{''.join(rows)}</table>" if rows else ""
    notes = [cover_text(report)]
    notes += [f"{'Proved' if proved else 'Not proved'}: {text}" for text, proved in report.statements]
    small = "".join(f"<br>{escape(note)}" for note in notes).removeprefix("<br>")
    return f'<div>{title}{table}<p style="font-size: smaller">{small}</p></div>'


def _row(label: str, joint: Joint) -> str:
    turn = f"{measured(joint.tangent_jump, joint.tangent_jump_error)}°" if joint.tangent_jump > 0 else ""
    sides = [number(value) for value in joint.curvatures if not math.isnan(value)]
    proved = "✓ yes" if joint.proved else "✗ no"
    place = ", ".join(map(number, joint.point))
    cells = (label, f"({place})", joint.kind, joint.continuity, turn, " | ".join(sides), proved)
    return f"<tr>{''.join(cell('td', text) for text in cells)}</tr>"


def cell(tag: str, text: str) -> str:
    """A cell of a table, its text escaped."""
    return f'<{tag} style="text-align: left">{escape(text)}</{tag}>'
