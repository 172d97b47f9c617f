"""What a repair answers: candidates with their prices, and what was rejected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED, Document, Entry, Sentence
from rsym.reports.numbers import at_most
from rsym.reports.render import Report
from rsym.reports.words import plural
from rsym.verify.repair.anatomy import Verdict
from rsym.verify.repair.prices import Price

COLUMNS = ("change", "verdict, proved", "boundary", "content", "curvature, proved", "normalisation", "note, proved")
NUMERICAL = "Distances, areas, volumes and normalisation are numerical, verdicts and bounds of curvature proved."


@dataclass(frozen=True, eq=False)
class Candidate:
    """A changed shape whose boundary is proved to be curvature-continuous.

    Attributes
    ----------
    shape : Shape
        The changed shape.
    move : str
        The name of the move.
    change : str
        What was changed, with numbers: "a2 from 5.3 to 5.3077".
    report : SmoothnessReport or BodyReport
        Its verdict, CERTIFIED.
    price : Price
        What it costs.
    note : str
        What is proved of smaller changes of this kind; empty if nothing is.
    """

    shape: Shape
    move: str
    change: str
    report: Verdict
    price: Price
    note: str = ""

    def __repr__(self) -> str:
        return f"<Candidate: {self.change}>"

    def entry(self) -> Entry:
        """The candidate in a report."""
        note = f" Proved: {self.note}." if self.note else ""
        verdict = f"CERTIFIED, {self.report.continuity}"
        row = self.change, verdict, *self.price.words, self.note
        return Entry(f"{self.change}: {verdict}; {self.price}.{note}", True, row)

    @property
    def data(self) -> dict[str, Any]:
        """What programs read of it."""
        return {
            "move": self.move,
            "change": self.change,
            "verdict": self.report.verdict,
            "continuity": self.report.continuity,
            "expression": str(self.shape.expression),
            "letters": {name: float(letter.default) for name, letter in self.shape.letters.items()},
            "price": self.price,
            "note": self.note,
        }


@dataclass(frozen=True)
class Rejected:
    """A change that was tried in vain, and why it is no candidate."""

    move: str
    change: str
    reason: str


@dataclass(frozen=True, eq=False, repr=False)
class RepairReport(Report):
    """Candidates for the repair of a shape, those that move the boundary least first. The shape itself is not changed.

    Attributes
    ----------
    shape : Shape
        The shape as it is, with the letters that were given.
    before : SmoothnessReport or BodyReport
        Its verdict.
    candidates : tuple of Candidate
        Every one is proved to be curvature-continuous; their prices are numerical but for the bound of the curvature.
    rejected : tuple of Rejected
        What was tried in vain.
    needed : bool
        Whether anything was to be repaired; if so, and without candidates, the repair has failed.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> print(rsym.repair(disc))
    CERTIFIED, analytic, as it is: nothing to repair.
    >>> roof = rsym.Shape(1 - abs(x) - y, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> report = rsym.repair(roof, moves=["round"], radius=0.1)
    >>> report.candidates
    (<Candidate: |x| rounded by 0.1>,)
    """

    shape: Shape
    before: Verdict
    candidates: tuple[Candidate, ...]
    rejected: tuple[Rejected, ...]
    needed: bool = True

    def __repr__(self) -> str:
        return f"<RepairReport of a shape {self.before.verdict}: {len(self.candidates)} candidates>"

    def document(self) -> Document:
        """All that the report says: the candidates, the smallest change first, and what was rejected."""
        entries = [one.entry() for one in self.candidates]
        entries += [Entry(f"{one.change}: {one.reason}", False, label="rejected:") for one in self.rejected]
        return Document(
            "repair-report",
            Sentence(self._headline(), True),
            self.before.verdict,
            self.before.continuity,
            entries=tuple(entries),
            columns=COLUMNS,
            remarks=(Sentence(NUMERICAL, True),) if self.candidates else (),
            data={
                "before": {"verdict": self.before.verdict, "continuity": self.before.continuity},
                "needed": self.needed,
                "candidates": [one.data for one in self.candidates],
                "rejected": self.rejected,
            },
        )

    def _headline(self) -> str:
        before = self.before
        if not self.needed:
            return f"CERTIFIED, {before.continuity}, as it is: nothing to repair."
        lack = f"with {plural(len(before.defects), 'defect')}"
        if before.verdict == CERTIFIED:
            lack = f"its curvature only bounded by {at_most(before.curvature_bound)}"
        found = f"{before.verdict}, {before.continuity}, {lack}"
        if not self.candidates:
            return f"{found}; no candidate was found."
        return f"{found}; {plural(len(self.candidates), 'certified candidate')}, the least moved first."
