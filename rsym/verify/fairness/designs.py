"""Designs side by side: one shape at several choices of its letters, judged alike."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED, Document, Sentence, Tabular
from rsym.reports.numbers import number
from rsym.reports.render import BEST, Report, as_record
from rsym.sampling.progress import Progress, report
from rsym.verify.answers.report import CONTINUITIES
from rsym.verify.fairness.fairness import BUDGET, fairness
from rsym.verify.fairness.report import MEASURES, Extremum, FairnessReport, Peak

NOTE = f"  {BEST} the best of its column. Curvature 1/length, variation 1/length**2: proved; measures: numerical."
VERDICTS = (DEGENERATE, REFUTED, UNDECIDED, CERTIFIED)  # from the worst to the best
DIGITS = 5


@dataclass(frozen=True, eq=False)
class Design:
    """One choice of letters with what is said of it."""

    name: str
    letters: Mapping[str, float]
    report: FairnessReport

    def peak(self, which: str) -> Peak:
        """The "least" or the "greatest" curvature, its "size" or its "variation"; of two curvatures the larger."""
        peaks: list[Peak] = [getattr(bounds, which) for bounds in self.report.curvatures]
        choose = min if which == "least" else max
        return choose(peaks, key=lambda peak: peak.bound)


@dataclass(frozen=True)
class Column:
    """A column of the table: its heading, a cell's text, and how good a value is: the largest merit is the best."""

    heading: str
    text: Callable[[Design], str]
    merit: Callable[[Design], float] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class DesignTable(Report):
    """Designs in the order given, one row each; the best value of each column is marked.

    A bound of the curvature is proved; measures are numerical. Sizes (length, area, volume) have no best.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> a = sp.Symbol("a", real=True)
    >>> oval = rsym.Shape(1 - x**2 / a**2 - y**2, (x, y), letters={a: 2}, bounds=((-4, 4), (-2, 2)))
    >>> table = compare_designs(oval, {"round": {"a": 1.25}, "long": {"a": 3}}, tolerance=0.1)
    >>> [line.split()[:3] for line in str(table).splitlines()[1:3]]
    [['round', 'CERTIFIED', 'analytic'], ['long', 'CERTIFIED', 'analytic']]
    """

    designs: tuple[Design, ...]

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns after the name."""
        sizes = [name for name in MEASURES if any(name in design.report.measures for design in self.designs)]
        return (
            Column("verdict", lambda d: d.report.verdict, lambda d: VERDICTS.index(d.report.verdict)),
            Column("continuity", lambda d: d.report.continuity, lambda d: CONTINUITIES.index(d.report.continuity)),
            _bound("|curvature| <=", "size"),
            _bound("curvature >=", "least"),
            _bound("curvature <=", "greatest"),
            _bound("variation <=", "variation"),
            _places("extrema"),
            _places("inflections"),
            *map(_measure, sizes),
            *map(_letter, self.differing),
        )

    @property
    def differing(self) -> tuple[str, ...]:
        """The letters that are not the same in all designs."""
        names = dict.fromkeys(name for design in self.designs for name in design.letters)
        return tuple(name for name in names if len({design.letters.get(name) for design in self.designs}) > 1)

    def rows(self) -> list[tuple[str, ...]]:
        """The cells as text, the name first."""
        return [(d.name, *(column.text(d) for column in self.columns)) for d in self.designs]

    def best(self) -> frozenset[tuple[int, int]]:
        """The cells (row, column) with the best value of their column; none where all are alike."""
        found = set()
        for j, column in enumerate(self.columns, 1):
            if column.merit is None:
                continue
            merits = [column.merit(design) for design in self.designs]
            known = [merit for merit in merits if not math.isnan(merit)]
            if known and min(merits) != max(known):
                found |= {(i, j) for i, merit in enumerate(merits) if merit == max(known)}
        return frozenset(found)

    def __repr__(self) -> str:
        return f"<DesignTable of {', '.join(design.name for design in self.designs)}>"

    def document(self) -> Document:
        """The table, and each design with its letters and its report."""
        header = ("design", *(column.heading for column in self.columns))
        rows = [
            {"name": design.name, "letters": design.letters, "report": as_record(design.report.document())}
            for design in self.designs
        ]
        return Document(
            "design-table",
            Sentence("", True),
            tables=(Tabular(header, tuple(self.rows()), self.best()),),
            remarks=(Sentence(NOTE, True),),
            data={"differing": self.differing, "designs": rows},
        )


def compare_designs(
    shape: Shape,
    designs: Mapping[str, Mapping[Any, float]],
    *,
    bounds: Any = None,
    tolerance: float = 0.01,
    budget: int = BUDGET,
    progress: Progress | None = None,
) -> DesignTable:
    """Judge one shape at several choices of its letters, each by `fairness`.

    Parameters
    ----------
    shape : Shape
        In the plane, or a body of revolution.
    designs : mapping
        Names to letters; letters that are left out have their defaults.
    bounds, tolerance, budget
        As for `fairness`.
    progress : callable, optional
        ``progress(done, total)`` of designs; an answer of False cancels.

    Raises
    ------
    RsymError
        Without designs; for a letter of any of them that is unknown or out of range, before any work; as `fairness`,
        with the name of the design.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y
    >>> a = sp.Symbol("a", real=True)
    >>> oval = rsym.Shape(1 - x**2 / a**2 - y**2, (x, y), letters={a: 2}, bounds=((-4, 4), (-2, 2)))
    >>> found = compare_designs(oval, {"round": {"a": 1.25}, "long": {"a": 3}}, tolerance=0.1)
    >>> found.designs[1].peak("greatest").attained, found.differing
    (3.0, ('a',))
    """
    require_shape(shape)
    if not designs or not isinstance(designs, Mapping):
        raise RsymError("a comparison needs at least one design", code="designs", remedy='such as {"thin": {"a": 5}}')
    letters = {}
    for name, given in designs.items():
        with named(name):
            letters[name] = shape.letters.values_with(given)
    rows = []
    for done, (name, given) in enumerate(designs.items()):
        report(progress, done, len(designs))
        with named(name):
            judged = fairness(shape, bounds=bounds, letters=given, tolerance=tolerance, budget=budget)
        rows.append(Design(name, letters[name], judged))
    report(progress, len(designs), len(designs))
    return DesignTable(tuple(rows))


@contextmanager
def named(name: str) -> Iterator[None]:
    """Say in which design, or in which file, an error is."""
    try:
        yield
    except RsymError as error:
        where = f"{name}, {error.where}" if error.where else name
        raise RsymError(error.message, code=error.code, where=where, remedy=error.remedy) from error


def _bound(heading: str, which: str) -> Column:
    """A proved bound; a smaller one is better, of the least curvature a larger one."""
    up = which != "least"

    def text(design: Design) -> str:
        return design.peak(which).told(up=up)

    def merit(design: Design) -> float:
        return -design.peak(which).bound if up else design.peak(which).bound

    return Column(heading, text, merit)


def _places(heading: str) -> Column:
    """How many extrema or inflections; one that may have more has no merit."""

    def count(design: Design) -> int:
        found: tuple[Extremum, ...] = getattr(design.report, heading)
        return len(found)

    def text(design: Design) -> str:
        return "constant" if all(design.report.constant) else f"{count(design)}{'' if design.report.complete else '+'}"

    return Column(heading, text, lambda design: -count(design) if design.report.complete else math.nan)


def _measure(name: str) -> Column:
    """A measure; of energies a smaller one is better, of sizes none."""

    def value(design: Design) -> float:
        found = design.report.measures.get(name)
        return math.nan if found is None else found.value

    def text(design: Design) -> str:
        return "" if math.isnan(value(design)) else f"{value(design):.{DIGITS}g}"

    return Column(MEASURES[name], text, (lambda design: -value(design)) if name.endswith("energy") else None)


def _letter(name: str) -> Column:
    return Column(name, lambda design: number(design.letters[name]))
