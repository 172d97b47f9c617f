"""The account of a search: everything that it found is in its report, or the report says UNDECIDED.

A finding that was proved and then lost on its way to the report is a false verdict. So a report is made in two steps.
The first says what follows from the findings. The second sets the raw findings against what was said: every box that
was opened is closed, every place that was found has an answer. The two steps share no filter; what the first one
drops without a right to, the second one misses.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

from rsym.reports.document import UNDECIDED
from rsym.reports.numbers import point
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import BROKEN, CONTINUITIES, UNKNOWN, SmoothnessReport, is_defect, level_of


class Located(Protocol):
    """A place known to within a radius, what the boundary is there at most, and whether that is proved."""

    @property
    def point(self) -> tuple[float, ...]:
        """Within `radius` of the truth."""

    @property
    def radius(self) -> float:
        """How far the truth may be away."""

    @property
    def continuity(self) -> str:
        """One of `CONTINUITIES`."""

    @property
    def proved(self) -> bool:
        """Whether it is."""


P = TypeVar("P", bound=Located)
V = TypeVar("V", bound=SmoothnessReport | BodyReport)


def answers(said: Located, found: Located, near: float = 0.0) -> bool:
    """Whether what is said of one place makes what was found at another one superfluous for the verdict.

    They may be one place, nothing better is said than was found, and no doubt is silenced: what was found without a
    proof is answered by a doubt, or by a proof that the boundary is not G2 there.
    """
    if math.dist(said.point, found.point) > said.radius + found.radius + near:
        return False
    if level_of(said) > max(level_of(found), CONTINUITIES.index(BROKEN)):
        return False
    return said.proved == found.proved or (said.proved and is_defect(said))


def distinct(places: Sequence[P], worst_first: Callable[[P], Any], near: float = 0.0) -> list[P]:
    """Each place once: neighbouring boxes, and the boxes of a range of letters, find the same one.

    `near` is a distance below which two places count as one whatever their radii.
    """
    result: list[P] = []
    for place in sorted(places, key=worst_first):
        if not any(answers(said, place, near) for said in result):
            result.append(place)
    return result


@dataclass(frozen=True)
class Balance:
    """How many boxes a subdivision made, and how many of them it settled in some way; the two are equal."""

    made: int
    closed: int


def missing(
    found: Iterable[Located], said: Sequence[Located], balance: Balance, *, near: float = 0.0, boxes: int = 0
) -> list[str]:
    """What is wrong with an account, in words; nothing if it balances.

    `boxes` is how many of the boxes that hold something the report does not list.
    """
    result = []
    if balance.made != balance.closed:
        result.append(f"{balance.made} boxes were made and {balance.closed} settled")
    if boxes:
        result.append(f"{boxes} boxes that hold something are not listed")
    for place in found:
        if not any(answers(one, place, near) for one in said):
            result.append(f"what was found at {point(place.point, 6)} is not listed")
    return result


def audited(draft: V, wrong: Sequence[str]) -> V:
    """A report whose account balances as it is; of another nothing is said but what is wrong."""
    if not wrong:
        return draft
    complaint = f"the account of the search does not balance, which is a defect of rsym to report: {'; '.join(wrong)}"
    return replace(draft, verdict=UNDECIDED, continuity=UNKNOWN, statements=(*draft.statements, (complaint, False)))
