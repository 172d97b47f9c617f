"""What a check of a body answers: a verdict, the curves and points that decide it, and what is proved."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from rsym.arrays import Floats
from rsym.reports.document import Document, Entry, Sentence
from rsym.reports.numbers import interval, point, share, short
from rsym.reports.render import plain
from rsym.reports.words import plural
from rsym.verify.answers.report import Cover, Verdict, is_defect, level_of, yes_or_no
from rsym.verify.answers.singular import (
    Defect,
    SingularCurve,
    SingularPoint,
    curves_effect,
    curves_text,
    cut,
    points_effect,
    points_text,
)

COLUMNS = ("kind", "count", "definitions", "where", "what happens", "continuity", "proved", "traced")
PLACES, DIGITS = 3, 6  # points that a cell lists, and digits of their coordinates
One = TypeVar("One", SingularCurve, SingularPoint)


@dataclass(frozen=True, eq=False)
class BodyCover(Cover):
    """The boxes that a proof in space is made of, each (n, 3, 2): the boundary within `bounds` lies in them.

    certified: a regular surface of the class proved; joined: two analytic sheets that meet along a curve of the
    report, or three in a corner; undecided: nothing is proved.

    Examples
    --------
    >>> import rsym
    >>> cover = rsym.verify_smoothness(rsym.sphere(), method="space").cover
    >>> cover.certified.shape[1:], len(cover.undecided), cover.undecided_share
    ((3, 2), 0, 0.0)
    """

    @property
    def undecided_share(self) -> float:
        """The share of the boundary that is undecided, each box counted by the area of its side."""
        areas = [float(np.square(_widths(boxes)).sum()) for boxes in (self.undecided, self.certified, self.joined)]
        return areas[0] / sum(areas) if areas[0] else 0.0


def _widths(boxes: Floats) -> Floats:
    widths: Floats = (boxes[..., 1] - boxes[..., 0]).max(axis=1, initial=0)
    return widths


@dataclass(frozen=True, eq=False, repr=False)
class BodyReport(Verdict):
    """The answer to the question whether the curvature of the boundary of a body is continuous (G2).

    Attributes
    ----------
    verdict : str
        "CERTIFIED", proved; "REFUTED", the contrary is proved at `defects`; "DEGENERATE", there is no surface to speak
        of at some point (a node, no change of sign, no boundary); "UNDECIDED", neither proved.
    continuity : str
        What the boundary is everywhere, a word of ``CONTINUITIES``; proved to be no less if CERTIFIED, no more if
        REFUTED. "broken" if DEGENERATE, "unknown" if UNDECIDED.
    curves, points
        All that is singular: the proved ones first, of these the worst.
    curvatures : (low, high)
        No principal curvature on the certified boxes lies outside; infinite where there is no bound.
    attained : (low, high)
        The least and the largest principal curvature found at points of the boundary, which `curvatures` encloses;
        NaN where none was sought.
    statements : pairs
        Sentences, each with whether it is proved.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> corner = rsym.Shape(rsym.conjunction(x, y, z), (x, y, z), bounds=((-1, 1.1),) * 3)
    >>> report = rsym.verify_smoothness(corner)
    >>> report.verdict, report.continuity, len(report.curves), len(report.points)
    ('REFUTED', 'G0', 3, 1)
    """

    verdict: str
    continuity: str
    curves: tuple[SingularCurve, ...]
    points: tuple[SingularPoint, ...]
    curvatures: tuple[float, float]
    attained: tuple[float, float]
    cover: BodyCover
    letters: Mapping[str, tuple[float, float]]
    statements: tuple[tuple[str, bool], ...] = field(default=())

    @property
    def defects(self) -> tuple[Defect, ...]:
        """The curves and points below G2."""
        everything: tuple[Defect, ...] = (*self.curves, *self.points)
        return tuple(one for one in everything if is_defect(one))

    @property
    def curvature_bound(self) -> float:
        """No principal curvature on the certified boxes is larger in size."""
        return max(abs(end) for end in self.curvatures)

    @property
    def undecided_share(self) -> float:
        """The share of the boundary that is undecided, by area."""
        return self.cover.undecided_share

    def __repr__(self) -> str:
        found = f"{len(self.curves)} curves, {len(self.points)} points"
        return f"<BodyReport {self.verdict}, {self.continuity}, {found}>"

    def document(self) -> Document:
        """All that the report says."""
        sentences = [Sentence(self._curvatures_text(), True)]
        if len(self.undecided):
            boxes = plural(len(self.undecided), "box", "boxes")
            sentences.append(
                Sentence(f"Of the boundary {share(self.undecided_share)}, in {boxes}, is undecided.", True)
            )
        data = {
            "letters": self.letters,
            "curvatures": self.curvatures,
            "curvatures_attained": self.attained,
            "curves": [_curve_data(curve) for curve in self.curves],
            "points": self.points,
            "undecided_share": self.undecided_share,
            **self.cover.data,
        }
        return Document(
            "body-report",
            self.headline("the boundary", "surface", doubt=not all(defect.proved for defect in self.defects)),
            self.verdict,
            self.continuity,
            sentences=tuple(sentences),
            statements=tuple(Sentence(*statement) for statement in self.statements),
            entries=tuple(group.entry() for group in groups(self.curves, self.points)),
            columns=COLUMNS,
            data=data,
        )

    def _curvatures_text(self) -> str:
        """How many boxes were examined, and what they say of the curvatures."""
        if not (math.isfinite(self.curvature_bound) and len(self.cover.certified)):
            return f"{self.cover.told}."
        scale = max(self.curvature_bound, 2 / max(high - low for low, high in self.cover.bounds))
        proved = interval(*self.curvatures, scale)
        told = f"{self.cover.told}; where they prove the boundary regular, all principal curvatures lie in {proved}"
        if not all(map(math.isfinite, self.attained)):
            return f"{told}."
        low, high = (short(value, scale) for value in self.attained)
        found = f"all found are {low}" if low == high else f"those found go from {low} to {high}"
        return f"{told}; {found}."


def _curve_data(curve: SingularCurve) -> dict[str, Any]:
    """What was found, and what follows from it."""
    follows = {"closed": curve.closed, "length": curve.length, "dihedral_angles": curve.dihedral_angles}
    return {**plain(curve), **follows}


@dataclass(frozen=True)
class Group:
    """Curves, or points, that one line tells of: of one kind and class, between the same definitions."""

    curves: tuple[SingularCurve, ...] = ()
    points: tuple[SingularPoint, ...] = ()

    @property
    def first(self) -> Defect:
        """The worst, as a report has the worst first."""
        everything: tuple[Defect, ...] = (*self.curves, *self.points)
        return everything[0]

    @property
    def defect(self) -> bool:
        """Whether it is below G2."""
        return is_defect(self.first)

    @property
    def badness(self) -> tuple[bool, bool, int]:
        """A key that sorts the defects first, of these the proved and worst."""
        rank = level_of(self.first)
        return (False, not self.first.proved, rank) if self.defect else (True, False, 0)

    def entry(self) -> Entry:
        """The line and the row of a report; only defects have numbers."""
        first = self.first
        names = " | ".join(dict.fromkeys(cut(name) for name in first.names if name))
        if self.curves:
            text, count, effect = curves_text(self.curves), len(self.curves), curves_effect(self.curves)
            where = f"length {short(sum(curve.length for curve in self.curves))}"
            traced = f"{sum(curve.traced for curve in self.curves)} of {count}"
        else:
            text, count, effect, traced = points_text(self.points), len(self.points), points_effect(self.points), ""
            where = ", ".join([point(one.point, DIGITS) for one in self.points[:PLACES]] + ["..."] * (count > PLACES))
        row = first.kind, str(count), names, where, effect, first.continuity, yes_or_no(first.proved), traced
        return Entry(text, first.proved, row, self.defect, None if self.defect else "also")


def groups(curves: Sequence[SingularCurve], points: Sequence[SingularPoint]) -> list[Group]:
    """What is below G2 first, the proved and worst before the others."""
    found = [Group(curves=alike) for alike in _alike(curves)] + [Group(points=alike) for alike in _alike(points)]
    return sorted(found, key=lambda group: group.badness)


def _alike(found: Sequence[One]) -> list[tuple[One, ...]]:
    """Those of one kind and class between the same definitions, in the order of the first of each."""
    together: dict[object, list[One]] = {}
    for one in found:
        together.setdefault((one.kind, one.continuity, one.proved, frozenset(one.names)), []).append(one)
    return [tuple(group) for group in together.values()]
