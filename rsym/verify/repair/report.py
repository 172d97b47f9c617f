"""What a repair answers: candidates with their prices, and what was rejected."""

from __future__ import annotations

from dataclasses import dataclass

from rsym.model.shape import Shape
from rsym.verify.repair.anatomy import Verdict
from rsym.verify.repair.prices import Price
from rsym.verify.repair.wording import repair_html, repair_json, repair_text


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


@dataclass(frozen=True)
class Rejected:
    """A change that was tried in vain, and why it is no candidate."""

    move: str
    change: str
    reason: str


@dataclass(frozen=True, eq=False, repr=False)
class RepairReport:
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

    def __str__(self) -> str:
        return repair_text(self)

    def __repr__(self) -> str:
        return f"<RepairReport of a shape {self.before.verdict}: {len(self.candidates)} candidates>"

    def to_json(self) -> str:
        """The report for programs: JSON with stable keys, null where a number is unknown."""
        return repair_json(self)

    def _repr_html_(self) -> str:
        return repair_html(self)
