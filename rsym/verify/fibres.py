"""Letters that range: a verdict on a body for every value, or the refutation at one of them.

At single values (on a fibre of the ranges) a body is judged like any other, and what is proved there refutes the
ranges. For every value speak boxes with sides along the letters too. They certify only: on such a box a curve or a
corner has another place for each value, perhaps beyond the bounds, so that a jump on it counts as undecided.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import islice

from rsym.model.shape import Bounds, Shape
from rsym.reports.document import CERTIFIED, DEGENERATE, REFUTED, UNDECIDED
from rsym.sampling.progress import Effort
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.bodies import BUDGET, SMALLEST, Study, report_body, study_body
from rsym.verify.boxes.local import Box, Interval
from rsym.verify.cover.subdivision import Subdivision

MOST_FIBRES = 5  # values tried where boxes are left, besides the middle
Values = Mapping[str, Fraction]


def report_over_ranges(
    shape: Shape,
    bounds: Bounds,
    ranges: Mapping[str, Interval],
    effort: Effort | None = None,
    *,
    smallest: float = SMALLEST,
    budget: int = BUDGET,
) -> BodyReport:
    """The report on a body of which letters range: certified for every value, else refuted at one, or undecided.

    Curves and points are those at the value that a statement names.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> c = sp.Symbol("c", real=True)
    >>> shape = rsym.Shape(c - x**2 - y**2 - z**2, (x, y, z), letters={c: 1})
    >>> box = ((-2, 2.1), (-2, 2.2), (-2, 2.3))
    >>> report_over_ranges(shape, box, {"c": (Fraction(1), Fraction(11, 10))}).verdict
    'CERTIFIED'
    >>> report = report_over_ranges(shape, box, {"c": (Fraction(0), Fraction(2))})
    >>> report.verdict, report.statements[0]
    ('DEGENERATE', ('what follows is said of c = 0', True))
    """
    middle = {name: simplest_between(*_inner(low, high)) for name, (low, high) in ranges.items()}
    effort = effort or Effort()
    first = _on_fibre(shape, bounds, ranges, middle, effort, smallest, budget)
    if first.verdict in {REFUTED, DEGENERATE}:
        return first
    study = study_body(shape, bounds, ranges, smallest=smallest, budget=budget, effort=effort)
    report = report_body(study)
    if report.verdict != UNDECIDED:
        return replace(report, curves=first.curves, points=first.points) if first.verdict == CERTIFIED else report
    for values in islice(_suspicious(study, ranges, middle), MOST_FIBRES):
        if effort.is_over:
            break
        found = _on_fibre(shape, bounds, ranges, values, effort, smallest, budget)
        if found.verdict in {REFUTED, DEGENERATE}:
            return found
    return report


def _inner(low: Fraction, high: Fraction) -> Interval:
    """A part beside the middle: what is special in a range is often there, and a fibre is to be like most others."""
    return (35 * low + 29 * high) / 64, (33 * low + 31 * high) / 64


def simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """The fraction with the smallest denominator between two, ends included; of several the nearest to zero.

    By the Stern-Brocot tree, that is by the continued fractions of the ends.

    Examples
    --------
    >>> simplest_between(Fraction(7, 10), Fraction(4, 5)), simplest_between(Fraction(-1, 9), Fraction(1, 8))
    (Fraction(3, 4), Fraction(0, 1))
    """
    if low <= 0 <= high:
        return Fraction(0)
    if high < 0:
        return -simplest_between(-high, -low)
    whole = low.__ceil__()
    if whole <= high:
        return Fraction(whole)
    whole -= 1
    return whole + 1 / simplest_between(1 / (high - whole), 1 / (low - whole))


def _on_fibre(
    shape: Shape,
    bounds: Bounds,
    ranges: Mapping[str, Interval],
    values: Values,
    effort: Effort,
    smallest: float,
    budget: int,
) -> BodyReport:
    """What is found at single values, said of the ranges."""
    fixed = {name: (value, value) for name, value in values.items()}
    study = study_body(shape, bounds, fixed, smallest=smallest, budget=budget, effort=effort.again())
    report = report_body(study, sharpened=False)
    at = ", ".join(f"{name} = {value}" for name, value in values.items() if ranges[name][0] != ranges[name][1])
    return replace(
        report,
        letters={name: (float(low), float(high)) for name, (low, high) in ranges.items()},
        statements=((f"what follows is said of {at}", True), *report.statements),
    )


def _suspicious(study: Study, ranges: Mapping[str, Interval], middle: Values) -> Iterator[Values]:
    """Single values at which a defect may be found: in what is left over, where most boxes are, then the ends."""
    names = study.images.model.axes[3:]
    counted: Counter[tuple[Fraction, ...]] = Counter()
    for box in _undecided(study.found):
        sides = (_within(ranges[name], side) for name, side in zip(names, box[3:], strict=True))
        counted[tuple(simplest_between(*side) for side in sides)] += 1
    tried = [tuple(middle[name] for name in names)]
    ends = [tuple(ranges[name][end] for name in names) for end in (0, 1)]
    for values in [*(values for values, _ in counted.most_common()), *ends]:
        if values not in tried:
            tried.append(values)
            yield {**middle, **dict(zip(names, values, strict=True))}


def _undecided(found: Subdivision) -> Sequence[Box]:
    """The boxes on which nothing is proved for all values, and those with sheets that meet."""
    met = (box for groups in found.joined.values() for group in groups for box in group.tolist())
    corners = (box for box, _ in found.corners)
    return [*(box for box, _ in found.left), *(tuple(map(tuple, box)) for box in met), *corners]


def _within(ends: Interval, side: tuple[float, float]) -> Interval:
    """The part of a side, rounded outward, that the range holds."""
    return max(ends[0], Fraction(side[0])), min(ends[1], Fraction(side[1]))
