"""What the lint answers: findings, each with its place and its remedy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from rsym.reports.document import Document, Entry, Sentence
from rsym.reports.numbers import SHORT, point
from rsym.reports.render import Report
from rsym.reports.words import plural
from rsym.verify.lint.places import ModelPlace

NOT_NORMALISED = "not normalised"
COINCIDENT = "coincident faces"
ZERO_SHEET = "zero sheet"
LONE_SHEET = "sheet without thickness"
SATURATES = "saturates"
LETTER_RANGE = "letter range"
UNDEFINED = "without a value"
KINDS = (NOT_NORMALISED, COINCIDENT, ZERO_SHEET, LONE_SHEET, SATURATES, LETTER_RANGE, UNDEFINED)


@dataclass(frozen=True)
class Finding:
    """One fault: of which kind, where in the model, what is wrong, what to do.

    places : the formulas that it is about, one or two; point : where it was seen, if it was at a point;
    range : the least and the greatest length of a gradient, or the share of the bounds that it speaks of.

    Examples
    --------
    >>> print(Finding("not normalised", (ModelPlace("2*x"),), "|grad| on its zero set is 2, not 1", "divide by 2"))
    not normalised: 2*x
      |grad| on its zero set is 2, not 1
      remedy: divide by 2
    """

    kind: str
    places: tuple[ModelPlace, ...]
    message: str
    remedy: str
    point: tuple[float, ...] = ()
    range: tuple[float, float] | None = None

    @property
    def where(self) -> str:
        """The places as text."""
        return " and ".join(map(str, self.places))

    def __str__(self) -> str:
        at = f"; at {point(self.point, SHORT)}" if self.point else ""
        return f"{self.kind}: {self.where}\n  {self.message}{at}\n  remedy: {self.remedy}"


@dataclass(frozen=True)
class LintReport(Report):
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

    def document(self) -> Document:
        """All that the lint says."""
        entries = [
            Entry(str(one), False, (one.kind, one.where, one.message, one.remedy), defect=True) for one in self.findings
        ]
        data = {
            "clean": self.clean,
            "leaves": self.leaves,
            "bounds": self.bounds,
            "letters": self.letters,
            "findings": self.findings,
            "notes": self.notes,
        }
        of = f"in {plural(self.leaves, 'leaf', 'leaves')}."
        found = f"{plural(len(self.findings), 'finding')} {of}" if self.findings else f"Clean: no finding {of}"
        return Document(
            "lint-report",
            Sentence(found, False),
            entries=tuple(entries),
            columns=("kind", "place", "what", "remedy"),
            remarks=tuple(Sentence(f"Note: {note}.", False) for note in self.notes),
            data=data,
        )


def located(report: LintReport, lines: Mapping[str, int]) -> LintReport:
    """The report with the lines of a model file: the line of every definition and letter by its name.

    Examples
    --------
    >>> report = LintReport((Finding("saturates", (ModelPlace("f", "", "g"),), "flat", "no"),), 1, ((0, 1), (0, 1)), {})
    >>> located(report, {"g": 7}).findings[0].where
    'line 7, g: f'
    """

    def found(place: ModelPlace) -> ModelPlace:
        return replace(place, line=lines.get(place.definition, 0))

    findings = (replace(one, places=tuple(map(found, one.places))) for one in report.findings)
    return replace(report, findings=tuple(findings))
