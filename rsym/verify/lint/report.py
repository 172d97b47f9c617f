"""What the lint answers: findings, each with its place and its remedy."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from html import escape

from rsym.reports.render import plain
from rsym.reports.words import plural
from rsym.verify.lint.places import Place

FORMAT = "rsym-lint-report"
VERSION = 1

NOT_NORMALISED = "not normalised"
COINCIDENT = "coincident faces"
ZERO_SHEET = "zero sheet"
LONE_SHEET = "sheet without thickness"
SATURATES = "saturates"
LETTER_RANGE = "letter range"
KINDS = (NOT_NORMALISED, COINCIDENT, ZERO_SHEET, LONE_SHEET, SATURATES, LETTER_RANGE)


@dataclass(frozen=True)
class Finding:
    """One fault: of which kind, where in the model, what is wrong, what to do.

    places : the formulas that it is about, one or two; point : where it was seen, if it was at a point;
    range : the least and the greatest length of a gradient, or the share of the bounds that it speaks of.

    Examples
    --------
    >>> print(Finding("not normalised", (Place("2*x"),), "|grad| on its zero set is 2, not 1", "divide by 2"))
    not normalised: 2*x
      |grad| on its zero set is 2, not 1
      remedy: divide by 2
    """

    kind: str
    places: tuple[Place, ...]
    message: str
    remedy: str
    point: tuple[float, ...] = ()
    range: tuple[float, float] | None = None

    @property
    def where(self) -> str:
        """The places as text."""
        return " and ".join(map(str, self.places))

    def __str__(self) -> str:
        at = f"; at ({', '.join(f'{value:.4g}' for value in self.point)})" if self.point else ""
        return f"{self.kind}: {self.where}\n  {self.message}{at}\n  remedy: {self.remedy}"


@dataclass(frozen=True)
class LintReport:
    """The findings of `rsym.lint`, in the order of `KINDS`.

    findings : what was found; notes : what could not be looked at; leaves : how many leaves the shape has;
    bounds, letters : where it was looked at.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> report = rsym.lint(rsym.Shape(2 * x, (x, y), bounds=((-1, 1), (-1, 1))))
    >>> report.clean, [finding.kind for finding in report.findings]
    (False, ['not normalised'])
    >>> print(report.findings[0].remedy)
    divide by 2
    """

    findings: tuple[Finding, ...]
    leaves: int
    bounds: tuple[tuple[float, float], ...]
    letters: Mapping[str, float] = field(hash=False)
    notes: tuple[str, ...] = ()

    @property
    def clean(self) -> bool:
        """Whether nothing was found."""
        return not self.findings

    def of(self, kind: str) -> tuple[Finding, ...]:
        """The findings of one kind."""
        return tuple(finding for finding in self.findings if finding.kind == kind)

    def __str__(self) -> str:
        lines = [f"{number}. {finding}" for number, finding in enumerate(self.findings, 1)]
        return "\n".join([self._headline(), *lines, *(f"Note: {note}." for note in self.notes)])

    def _headline(self) -> str:
        of = f"in {plural(self.leaves, 'leaf', 'leaves')}"
        return f"{plural(len(self.findings), 'finding')} {of}." if self.findings else f"Clean: no finding {of}."

    def to_json(self) -> str:
        """The report for programs: JSON with stable keys, null where there is no number."""
        record = {
            "format": FORMAT,
            "version": VERSION,
            "clean": self.clean,
            "leaves": self.leaves,
            "bounds": plain(self.bounds),
            "letters": {name: plain(value) for name, value in self.letters.items()},
            "findings": [
                {
                    "kind": finding.kind,
                    "places": [vars(place) for place in finding.places],
                    "message": finding.message,
                    "remedy": finding.remedy,
                    "point": plain(finding.point),
                    "range": plain(finding.range),
                }
                for finding in self.findings
            ],
            "notes": list(self.notes),
        }
        return json.dumps(record, indent=2, allow_nan=False)

    def _repr_html_(self) -> str:
        head = "".join(f"<th>{name}</th>" for name in ("", "kind", "place", "what", "remedy"))
        rows = "".join(_row(number, finding) for number, finding in enumerate(self.findings, 1))
        table = f"<table><tr>{head}</tr>{rows}</table>" if self.findings else ""
        notes = "".join(f'<p style="font-size: smaller">{escape(note)}.</p>' for note in self.notes)
        return f"<div><p><b>{escape(self._headline())}</b></p>{table}{notes}</div>"


def located(report: LintReport, lines: Mapping[str, int]) -> LintReport:
    """The report with the lines of a model file: the line of every definition and letter by its name.

    Examples
    --------
    >>> report = LintReport((Finding("saturates", (Place("f", "", "g"),), "flat", "no"),), 1, ((0, 1), (0, 1)), {})
    >>> located(report, {"g": 7}).findings[0].where
    'line 7, g: f'
    """

    def found(place: Place) -> Place:
        return replace(place, line=lines.get(place.definition, 0))

    findings = (replace(one, places=tuple(map(found, one.places))) for one in report.findings)
    return replace(report, findings=tuple(findings))


def _row(number: int, finding: Finding) -> str:
    texts = (str(number), finding.kind, finding.where, finding.message, finding.remedy)
    cells = "".join(f'<td style="text-align: left">{escape(text)}</td>' for text in texts)
    return f"<tr>{cells}</tr>"
