"""The atlas of two letters: for which of their values the boundary is smooth."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.bounds.enclosures import Range, ranges_of
from rsym.errors import RsymError
from rsym.model.equation import with_exact_letters
from rsym.model.shape import Shape
from rsym.reports.document import CERTIFIED
from rsym.sampling.progress import Effort, Progress
from rsym.verify.atlas.dividing import divide
from rsym.verify.atlas.greatest import CurvatureMap, greatest_curvatures
from rsym.verify.atlas.judging import Rectangle, RectangleJudge, RectangleJudgement
from rsym.verify.atlas.report import SmoothnessAtlas
from rsym.verify.atlas.strips import thresholds_of
from rsym.verify.atlas.subjects import PlaneSubject
from rsym.verify.threshold import inward, range_of

TOLERANCE = 0.02  # of the ranges: a strip that is a fine line in a figure
BUDGET = 4_000  # rectangles: the body of Fig. 11 takes 550 at that tolerance
SHARPENING = 300  # boxes spent on the bound of the curvature of each certified rectangle
LATTICE = 16  # values of each letter at which the curvature is sampled, beside the corners of certified rectangles


def smoothness_atlas(
    shape: Shape,
    letter_a: Any,
    letter_b: Any,
    *,
    between: tuple[tuple[Any, Any] | None, tuple[Any, Any] | None] = (None, None),
    tolerance: float = TOLERANCE,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    budget: int = BUDGET,
    sharpening: int = SHARPENING,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> SmoothnessAtlas:
    """For which values of two letters is the curvature of the boundary continuous? Proved in rectangles of both.

    A rectangle is certified where `verify_smoothness` proves it with both letters as intervals; it is refuted where
    one joint of two arcs is followed over the rectangle and jumps for every value in it. What is undecided is divided,
    until it is a strip as narrow as wanted between both.

    Parameters
    ----------
    shape : Shape
        In the plane or in space, with bounds; a body of revolution is judged by its meridian, others take seconds
        for each rectangle.
    letter_a, letter_b : str or symbol
        The two letters.
    between : pair of pairs
        The range of each letter; None for its own, or half to twice its default.
    tolerance : float
        Rectangles are divided until through each undecided point a line along one of the letters crosses no more than
        this share of the letter's range that is undecided.
    bounds : sequence of pairs, optional
        The statements are about the boundary within these; by default the bounds of the shape.
    letters : mapping, optional
        Values of the others.
    budget : int
        The greatest number of rectangles to judge.
    sharpening : int
        Boxes spent on the bound of the curvature in each certified rectangle.
    timeout : float, optional
        Seconds after which no further rectangle is judged: what is undecided then stays so.
    progress : callable, optional
        ``progress(judged, budget)``, now and then; an answer of False cancels.

    Returns
    -------
    SmoothnessAtlas
        ``.rectangles`` with their ``.verdicts``, ``.thresholds`` and ``.curvature``.

    Raises
    ------
    RsymError
        Without bounds, for an unknown letter or one that is given twice, for an empty range, and for a tolerance that
        is not a share.

    Examples
    --------
    >>> import rsym
    >>> atlas = rsym.smoothness_atlas(
    ...     rsym.paper.skeleton_body(), "a2", "p1", between=((5.2, 5.4), (39, 41)), tolerance=0.5, sharpening=0
    ... )
    >>> atlas.verdict_at(5.22, 40), atlas.verdict_at(5.39, 40)
    ('REFUTED', 'CERTIFIED')
    >>> low, high = atlas.thresholds[0].between(40)
    >>> bool(low < 5 + 4 / 13 < high)
    True
    """
    names = _names(shape, letter_a, letter_b, letters)
    first, second = (float(shape.letters[name].default) for name in names)
    shape, letters = with_exact_letters(shape, {**(letters or {}), names[0]: first, names[1]: second})
    letters = {name: value for name, value in letters.items() if name not in names}
    _check(tolerance, budget, between)
    effort = Effort(timeout=timeout)
    region = (inward(*range_of(shape, names[0], between[0])), inward(*range_of(shape, names[1], between[1])))
    for name, (low, high) in zip(names, region, strict=True):
        if not low < high:
            raise RsymError(f"the range of {name} is empty or one value", code="number", remedy="(low, high)")
    judge = RectangleJudge(shape, names, region, bounds=bounds, letters=letters, sharpening=sharpening)
    judged: list[int] = []

    def counted(done: int, total: int) -> Any:
        judged.append(done)
        return True if progress is None else progress(done, total)

    parts = divide(judge, region, tolerance=tolerance, budget=budget, progress=counted, effort=effort)
    rectangles = np.array([part.rectangle for part in parts])
    verdicts = tuple(part.verdict for part in parts)
    ranges = {name: ends for name, ends in ranges_of(shape.letters, letters).items() if name not in names}
    return SmoothnessAtlas(
        letters=names,
        region=region,
        rectangles=rectangles,
        verdicts=verdicts,
        curvature_bounds=np.array([part.bound for part in parts]),
        thresholds=thresholds_of(rectangles, verdicts, names),
        curvature=_curvatures(judge, region, parts, ranges),
        defaults=(first, second),
        fixed={name: (float(low), float(high)) for name, (low, high) in ranges.items()},
        judged=len(judged),
    )


def _names(shape: Shape, first: Any, second: Any, letters: Mapping[Any, Any] | None) -> tuple[str, str]:
    if not isinstance(shape, Shape):
        raise RsymError(f"expected a Shape, got {type(shape).__name__}", code="shape")
    names = str(first), str(second)
    shape.letters.values_with({name: shape.letters[name].default if name in shape.letters else 0 for name in names})
    given = {str(name) for name in letters or {}} & set(names)
    if given or names[0] == names[1]:
        raise RsymError(
            f"the letter {min(given or names)!r} is given twice",
            code="letter-twice",
            remedy="name two letters, and give others in letters",
        )
    return names


def _check(tolerance: float, budget: int, between: Any) -> None:
    if not (isinstance(between, Sequence) and len(between) == 2):
        raise RsymError(
            f"between must be two ranges, one for each letter, got {between!r}",
            code="between",
            remedy="such as between=((5, 6), (20, 80)), with None for the range of the letter itself",
        )
    if not 0 < tolerance < 1:
        raise RsymError(
            f"the tolerance must be a share between 0 and 1, got {tolerance!r}",
            code="tolerance",
            remedy=f"such as {TOLERANCE}",
        )
    if isinstance(budget, bool) or not isinstance(budget, int) or budget < 1:
        raise RsymError(
            f"the budget must be a positive integer, got {budget!r}", code="budget", remedy=f"such as {BUDGET}"
        )


def _curvatures(
    judge: RectangleJudge, region: Rectangle, parts: Sequence[RectangleJudgement], ranges: Mapping[str, Range]
) -> CurvatureMap:
    """Sampled at corners and middles of certified rectangles, which crowd at a threshold, and on a lattice."""
    kept = [part for part in parts if part.verdict == CERTIFIED]
    certified = np.array([part.rectangle for part in kept]).reshape(-1, 2, 2)
    middles = certified.mean(axis=2)
    subject = judge.subject
    if not isinstance(subject, PlaneSubject):
        return _known(middles, np.array([part.greatest for part in kept]), certified)
    corners = [certified[:, [0, 1], [i, j]] for i in (0, 1) for j in (0, 1)]
    axes = (np.linspace(low, high, LATTICE) for low, high in region)
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 1, 2)
    inside = np.any(np.all((certified[..., 0] <= lattice) & (lattice <= certified[..., 1]), axis=2), axis=1)
    points = np.unique(np.concatenate([*corners, middles, lattice[inside, 0]]), axis=0)
    fixed = {name: float(low + high) / 2 for name, (low, high) in ranges.items()}
    body = subject.model.body
    return _known(
        points, greatest_curvatures(subject.shape, subject.bounds, judge.names, points, fixed, body=body), certified
    )


def _known(points: Floats, values: Floats, certified: Floats) -> CurvatureMap:
    known = values > 0
    return CurvatureMap(points[known], values[known], certified)
