"""Refinement: twice the cells, and up to two degrees more, until the estimate of an error is small enough."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import NamedTuple, TypeVar

from rsym.errors import RsymError, warn
from rsym.model.requirements import require_positive
from rsym.reports.numbers import measured, short
from rsym.sampling.progress import Progress, report

T = TypeVar("T")

TOLERANCE = 1e-8
FIRST_CELLS = 8
STEPS = 6
HIGHEST_DEGREE = 6
MORE = 2  # degrees
FEWER = 0.75  # of the cells, for what is compared with
# Twice the cells make four or eight times the unknowns: more than so many are not begun.
MOST_UNKNOWNS = {2: 60_000, 3: 20_000}
# Functions at corners make a grid of so many unknowns take half a minute, four times that of the one before: it is
# begun only if the order observed promises the tolerance there. Where something is left that they do not span, the
# error falls by a sixth each time, and six digits in ten seconds are worth more than seven in five minutes.
MOST_UNPROMISED = 12_000


def last_degree(degree: int, cells: int | None) -> int:
    """The degree of a last grid, where the first or, of a number of cells, the only one is of a degree.

    Examples
    --------
    >>> last_degree(3, 8), last_degree(3, None), last_degree(6, None)
    (3, 5, 6)
    """
    return degree if cells is not None else max(degree, min(degree + MORE, HIGHEST_DEGREE))


class Grade(NamedTuple):
    """One step of a refinement: cells along the longest side, degree, unknowns, and the estimate of the error."""

    cells: int
    degree: int
    unknowns: int
    estimate: float


def on_fewer(attempt: Callable[[int], T], cells: int, share: float = FEWER) -> T:
    """What is found on a share of some cells, to compare with; on all of them where so few resolve no gap.

    On the same cells two degrees have errors in common.

    Examples
    --------
    >>> on_fewer(lambda cells: cells, 16)
    12
    """
    try:
        return attempt(max(1, round(share * cells)))
    except RsymError as error:
        if error.code != "cells":
            raise
        return attempt(cells)


def graded_alone(cells: int, degree: int, unknowns: int, error: Callable[[], float], wanted: bool) -> tuple[Grade, ...]:
    """The one grade of what was found on given cells; none where no estimate is wanted, or there is nothing to compare.

    Examples
    --------
    >>> graded_alone(8, 4, 96, lambda: 1e-4, True), graded_alone(8, 4, 96, lambda: 1e-4, False)
    ((Grade(cells=8, degree=4, unknowns=96, estimate=0.0001),), ())
    """
    if wanted and degree > 1:
        with suppress(RsymError):
            return (Grade(cells, degree, unknowns, error()),)
    return ()


def told(value: float, grades: Sequence[Grade]) -> str:
    """A value in as many digits as its estimate leaves, which is a share of it; few where there is none.

    Examples
    --------
    >>> told(1.333972, [Grade(8, 4, 96, 1e-4)]), told(1.333972, [])
    ('1.3340 ± 0.0002', '1.334')
    """
    return measured(value, grades[-1].estimate * abs(value)) if grades else short(value)


def observed_order(grades: Sequence[Grade]) -> float | None:
    """The order in the size of cells by which the last two estimates fell; the degree may have been raised between.

    Examples
    --------
    >>> observed_order([Grade(8, 4, 96, 1e-4), Grade(16, 4, 300, 3.125e-6)]), observed_order([])
    (5.0, None)
    """
    known = [grade for grade in grades if 0 < grade.estimate < math.inf]
    if len(known) < 2:
        return None
    before, last = known[-2:]
    return math.log(before.estimate / last.estimate) / math.log(last.cells / before.cells)


def _promised(grades: Sequence[Grade], tolerance: float) -> bool:
    """Whether twice the cells would do, by the order observed."""
    order = observed_order(grades)
    return order is None or grades[-1].estimate <= tolerance * 2**order


def refined(
    attempt: Callable[[int, int], tuple[T, int, float]],
    dimension: int,
    degree: int,
    tolerance: float | None,
    progress: Progress | None,
    *,
    beside: bool = False,
    why: Callable[[T], str] = lambda _: "",
) -> tuple[T, tuple[Grade, ...]]:
    """What ``attempt(cells, degree)`` answers, with its unknowns and the estimate of its error, on the last grid.

    beside : whether there are functions of corners beside splines.

    Examples
    --------
    >>> found, grades = refined(lambda cells, degree: (cells, 100, 1 / cells), 2, 4, 0.1, None)
    >>> found, [grade.degree for grade in grades]
    (16, [4, 5])
    >>> import warnings
    >>> slow = lambda cells, degree: (cells, 2 * cells**2, 1 / cells**2)
    >>> with warnings.catch_warnings(action="ignore"):
    ...     [refined(slow, 2, 4, 1e-5, None, beside=beside)[0] for beside in (False, True)]
    [128, 64]
    """
    tolerance = TOLERANCE if tolerance is None else tolerance
    require_positive("tolerance", tolerance, "for example tolerance=1e-6")
    grades: list[Grade] = []
    best: T | None = None
    for step in range(STEPS):
        report(progress, step, STEPS)
        cells, p = FIRST_CELLS * 2**step, max(degree, min(degree + min(step, MORE), HIGHEST_DEGREE))
        try:
            best, unknowns, estimate = attempt(cells, p)
        except RsymError as error:
            if error.code != "cells" or step == STEPS - 1:
                raise
            continue
        grades.append(Grade(cells, p, unknowns, estimate))
        following = 2**dimension * unknowns
        if estimate <= tolerance or following > MOST_UNKNOWNS[dimension]:
            break
        if beside and following > MOST_UNPROMISED and not _promised(grades, tolerance):
            break
    assert best is not None
    report(progress, STEPS, STEPS)
    if grades[-1].estimate > tolerance:
        warn(
            f"the estimate of the error is {short(grades[-1].estimate)}, above the tolerance of {short(tolerance)}"
            f"{why(best)}; give the number of cells, or a larger tolerance"
        )
    return best, tuple(grades)
