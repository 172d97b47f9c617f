"""A report on edges in words and, for a notebook, as a table."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from html import escape
from typing import TYPE_CHECKING

from rsym.reports.numbers import measured, number
from rsym.reports.words import plural
from rsym.surfaces.joints.proof_wording import proof_text, verdict_text

if TYPE_CHECKING:
    from rsym.surfaces.joints.edge_report import EdgeReport, Extreme, Meeting

# Okabe and Ito's colours, told apart by everybody; the words say the same.
COLOURS: Mapping[str, str] = {"broken": "#d55e00", "G0": "#e69f00", "G1": "#56b4e9", "G2": "#0072b2"}
NUMERICAL = "Numerical: decided by samples, not proved"
PROOF = "proof"
HEADER = ("", "patches", "class", "gap", "angle", "curvature jump", "worst at", "parameters")
# Lines and names beyond these are counted, not shown: the report has them all.
LINES, NAMES = 20, 12
# Digits of a place that a reader looks up; the report has them all.
DIGITS = 6


def report_text(report: EdgeReport) -> str:
    """A paragraph, then a line for each meeting that is less than G2, the worst first."""
    lines = [" ".join(_sentences(report))]
    lines += [f"  {place}. {meeting_text(one)}" for place, one in enumerate(report.defects[:LINES], 1)]
    more = len(report.defects) - LINES
    return "\n".join([*lines, f"  and {more} more"] if more > 0 else lines)


def meeting_text(meeting: Meeting) -> str:
    """One edge or pole in a line."""
    jump = _amount(meeting.curvature_jump, meeting.tolerances.curvature)
    parts = {
        "broken": f"gap {_amount(meeting.gap, meeting.tolerances.gap)}",
        "G0": f"the normals differ by {_amount(meeting.angle, meeting.tolerances.angle)} degrees",
        "G1": f"the curvature across jumps by {jump}",
        "G2": f"curvature continuous within {jump}",
    }
    effect = parts[meeting.continuity]
    if math.isnan(meeting.worst.value):
        effect = f"nothing is known of the {'normals' if meeting.continuity == 'G0' else 'curvatures'}"
    notes = [f"{plural(meeting.undefined, 'sample')} without a normal"] if meeting.undefined else []
    notes += ["normals to different sides"] if getattr(meeting, "flipped", False) else []
    notes += [proof_text(meeting.proof)] if meeting.proof else []
    at = f"worst at {_point(meeting.worst.point)}, {_parameters(meeting.worst)}"
    return "; ".join([f"{_who(meeting)}: {meeting.continuity}", effect, at, *notes])


def report_html(report: EdgeReport) -> str:
    """A headline, a table of the meetings, and what is free."""
    headline, *rest = _sentences(report)
    head = "".join(_cell("th", name) for name in (*HEADER, *([PROOF] if report.verdict else [])))
    rows = "".join(_row(place, one) for place, one in enumerate(report.meetings, 1))
    table = f"<table><tr>{head}</tr>{rows}</table>" if rows else ""
    colour = COLOURS.get(report.continuity or "", "inherit")
    title = f'<p><b style="color: {colour}">{escape(headline)}</b></p>'
    return f'<div>{title}{table}<p style="font-size: smaller">{escape(" ".join(rest))}</p></div>'


def _sentences(report: EdgeReport) -> Iterator[str]:
    patches = plural(report.patches, "patch", "patches")
    if report.continuity is None:
        yield f"{patches}: nothing meets."
    else:
        kinds = Counter(one.continuity for one in report.meetings)
        classes = ", ".join(f"{kinds[name]} {name}" for name in COLOURS if kinds[name])
        poles = f" and {plural(len(report.poles), 'pole')}" if report.poles else ""
        yield f"{patches}, {plural(len(report.edges), 'common edge')}{poles}: {report.continuity} ({classes})."
        smooth = [one for one in report.meetings if one.continuity == "G2"]
        if smooth:
            names = ("gap", "angle", "curvature_jump")
            gap, angle, jump = (max(getattr(one, name).at_most for one in smooth) for name in names)
            yield f"Where G2, gaps are at most {gap:.1e}, angles {angle:.1e} degrees, jumps of curvature {jump:.1e}."
    free = [f"{one.patch} {one.edge}" for one in report.free]
    shown = ", ".join(free[:NAMES]) + (f" and {len(free) - NAMES} more" if len(free) > NAMES else "")
    yield f"Free: {shown}." if free else "No edge is free."
    yield f"{NUMERICAL}; size {number(float(f'{report.size:.4g}'))}."
    if report.verdict:
        yield verdict_text(report)


def _row(place: int, meeting: Meeting) -> str:
    amounts = [
        _amount(meeting.gap, meeting.tolerances.gap),
        f"{_amount(meeting.angle, meeting.tolerances.angle)}°",
        _amount(meeting.curvature_jump, meeting.tolerances.curvature),
    ]
    who = [_cell("td", str(place)), _cell("td", _who(meeting))]
    who += [_cell("td", meeting.continuity, f"; border-left: 4px solid {COLOURS[meeting.continuity]}")]
    places = [_point(meeting.worst.point), _parameters(meeting.worst)]
    proof = [f"{meeting.verdict}: {proof_text(meeting.proof)}"] if meeting.proof else []
    cells = [_cell("td", cell) for cell in (*amounts, *places, *proof)]
    return f"<tr>{''.join(who + cells)}</tr>"


def _who(meeting: Meeting) -> str:
    sides = [f"{index} {edge}" for index, edge in zip(meeting.patches, meeting.edges, strict=True)]
    return f"pole of {', '.join(sides)}" if hasattr(meeting, "point") else " - ".join(sides)


def _amount(extreme: Extreme, room: float) -> str:
    """A value with its error; in two digits where it is far below what counts."""
    if math.isnan(extreme.value):
        return "unknown"
    if extreme.at_most < 1e-2 * room:
        return f"{extreme.value:.1e}" if extreme.value else "0"
    shown = f"{extreme.value:.{DIGITS}g}"
    return shown if extreme.error < 10.0**-DIGITS * extreme.value else measured(extreme.value, extreme.error)


def _point(point: tuple[float, ...]) -> str:
    # What is rounding beside the greatest coordinate is shown as zero.
    least = 1e-9 * max(map(abs, point))
    return f"({', '.join(f'{value:.{DIGITS}g}' if abs(value) > least else '0' for value in point)})"


def _parameters(extreme: Extreme) -> str:
    return f"(u, v) = {' and '.join(_point(pair) for pair in extreme.parameters)}"


def _cell(tag: str, text: str, style: str = "") -> str:
    return f'<{tag} style="text-align: left{style}">{escape(text)}</{tag}>'
