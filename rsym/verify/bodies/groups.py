"""Curves and points that one line of a report tells of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from rsym.verify.report import CONTINUITIES

if TYPE_CHECKING:
    from rsym.verify.bodies.report import BodyReport, Defect, SingularCurve, SingularPoint

One = TypeVar("One", "SingularCurve", "SingularPoint")


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


def groups(report: BodyReport) -> tuple[list[Group], list[Group]]:
    """What is below G2, the proved and worst first, and what is not."""
    below = {id(one) for one in report.defects}
    found = [Group(curves=alike) for alike in _alike(report.curves)]
    found += [Group(points=alike) for alike in _alike(report.points)]
    worst = sorted((group for group in found if id(group.first) in below), key=_rank)
    return worst, [group for group in found if id(group.first) not in below]


def _alike(found: Sequence[One]) -> list[tuple[One, ...]]:
    """Those of one kind and class between the same definitions, in the order of the first of each."""
    together: dict[object, list[One]] = {}
    for one in found:
        together.setdefault((one.kind, one.continuity, one.proved, frozenset(one.names)), []).append(one)
    return [tuple(group) for group in together.values()]


def _rank(group: Group) -> tuple[bool, int]:
    return not group.first.proved, CONTINUITIES.index(group.first.continuity)
