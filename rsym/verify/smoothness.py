"""Is the curvature of a boundary continuous? Proved, refuted, or honestly left open."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, TypeVar

from rsym.bounds.enclosures import ranges_of
from rsym.errors import RsymError
from rsym.logic.sign_form import decided, shape_form
from rsym.model.equation import with_exact_letters
from rsym.model.requirements import require_count, require_positive, require_shape
from rsym.model.shape import Shape
from rsym.program.lowering import lower
from rsym.sampling.progress import Effort, Progress
from rsym.sampling.windows import goes_beyond, holds_at_all, outer_bounds
from rsym.verify.answers.body_report import BodyReport
from rsym.verify.answers.report import SmoothnessReport
from rsym.verify.bodies import BUDGET as BODY_BUDGET
from rsym.verify.bodies import Study, report_body, study_body
from rsym.verify.fibres import report_over_ranges
from rsym.verify.plane import BUDGET, SMALLEST, Question, report_curve
from rsym.verify.revolution import find_meridian

METHODS = ("auto", "meridian", "space")
R = TypeVar("R", SmoothnessReport, BodyReport)


def verify_smoothness(
    shape: Shape,
    *,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    method: str = "auto",
    smallest: float = SMALLEST,
    budget: int | None = None,
    timeout: float | None = None,
    progress: Progress | None = None,
) -> SmoothnessReport | BodyReport:
    """Prove or refute that the boundary omega = 0 is a curve or a surface of continuous curvature (G2).

    Where a part of omega has no value beyond, or a pole, omega is not zero: of a union that end counts as boundary, and
    of others not; the report says which.

    The bounds are subdivided. A box is discarded where omega has no zero; it is certified where every generator of
    non-smoothness that is alive (the zero of a root, |.|, a tie, a denominator) and one component of grad omega
    exclude zero, so that the boundary there is a regular analytic arc; where exactly two analytic arcs meet, the
    point is enclosed by Krawczyk's operator and the jumps of tangent and curvature by evaluation in balls. What is
    left is classified numerically and called so.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    bounds : sequence of pairs, optional
        The statement is about the boundary within these; by default the bounds of the shape.
    letters : mapping, optional
        Values by name, each taken at its exact value. A pair (low, high) is a range: CERTIFIED then holds for every
        value in it, ends included, REFUTED and DEGENERATE for at least one. Of a body in space a statement names that
        value, and the curves and points are those at it.
    method : {"auto", "meridian", "space"}
        How a body is judged. "meridian": a body of revolution by its meridian; points of the report are (axis, radius).
        "space": any body, by boxes in space. "auto": by the meridian where the equation shows that there is one.
    smallest : float
        Boxes are divided down to this share of the extent.
    budget : int, optional
        The greatest number of boxes to examine.
    timeout : float, optional
        Seconds after which the search ends, a little later where a step is long: what is not settled by then counts as
        undecided, a statement says so, and the report holds what is proved. That much depends on the machine.
    progress : callable, optional
        ``progress(done, total)``, now and then; an answer of False cancels. One with a method ``describe(stage,
        undecided)`` is told before each call what is at work and which share of the boundary is undecided so far.

    Returns
    -------
    SmoothnessReport or BodyReport
        ``.verdict`` is "CERTIFIED", "REFUTED", "DEGENERATE" or "UNDECIDED"; the second for a body judged in space: its
        defects are curves and points, and ``.curvatures`` encloses both principal curvatures.

    Raises
    ------
    RsymError
        For an unknown letter or method, a size or budget that is not positive, without bounds in the plane, or by the
        meridian where there is none.

    Source: the criterion of curvature continuity; interval methods after Moore and Krawczyk.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> box = ((-2, 2), (-2, 2))
    >>> report = rsym.verify_smoothness(rsym.Shape(1 - x**2 - y**2, (x, y), bounds=box))
    >>> report.verdict, report.continuity, 1 <= report.curvature_bound < 1.1
    ('CERTIFIED', 'analytic', True)
    >>> report = rsym.verify_smoothness(rsym.Shape(rsym.conjunction(x, y), (x, y), bounds=box))
    >>> report.verdict, report.continuity, round(report.defects[0].tangent_jump, 9)
    ('REFUTED', 'G0', 90.0)
    """
    require_positive("smallest", smallest, f"for example {SMALLEST}")
    if budget is not None:
        require_count("budget", budget, f"leave it out, or for example {BUDGET}")
    effort = Effort(progress, timeout)
    require_shape(shape)
    shape, letters = with_exact_letters(shape, letters)
    if _in_space(shape, method):
        values = ranges_of(shape.letters, letters)
        if any(low != high for low, high in values.values()):
            box = outer_bounds(shape, bounds, values)
            return report_over_ranges(shape, box, values, effort, smallest=smallest, budget=budget or BODY_BUDGET)
        return _beyond(
            report_body(studied_in_space(shape, bounds, letters, smallest, budget, effort)), shape, bounds, values
        )
    study = Question(shape, bounds, letters).study(letters, smallest, budget or BUDGET, effort)
    return _beyond(report_curve(study), shape, bounds, study.values)


def _beyond(report: R, shape: Shape, bounds: Any, letters: Mapping[str, Any]) -> R:
    """The report, which says whether the boundary goes on beyond its window, and what it counts as boundary."""
    if any(low < high for low, high in letters.values()):
        beyond = False if holds_at_all(shape, outer_bounds(shape, bounds, letters), letters) else None
    else:
        beyond = goes_beyond(shape, bounds, {name: low for name, (low, _) in report.letters.items()})
    said = {
        True: "the boundary goes on beyond these bounds",
        False: "all of the boundary lies within these bounds",
        None: "whether the boundary goes on beyond these bounds is not known",
    }[beyond]
    return replace(report, statements=(*report.statements, (said, beyond is not None), *_of_ends(shape)))


def _of_ends(shape: Shape) -> Iterator[tuple[str, bool]]:
    """What a report says of a shape that may end where a part of it has no value beyond."""
    form = shape_form(shape)
    if form.ends:
        root = lower(form.builder, shape.expression)
        count = "that counts" if decided(form.builder, root) != root else "that does not count"
        yield f"where the shape ends for a part of omega has no value beyond, or a pole, {count} as boundary", True


def _in_space(shape: Any, method: str) -> bool:
    """Whether a shape is to be judged by boxes in space."""
    require_shape(shape)
    if method not in METHODS:
        raise RsymError(f"no method {method!r}", code="unknown-method", remedy=f"choose from {', '.join(METHODS)}")
    if shape.dimension == 2:
        if method == "auto":
            return False
        raise RsymError(
            f"method {method!r} is for bodies, this shape is plane", code="dimension", remedy="leave out the method"
        )
    return method == "space" or (method == "auto" and find_meridian(shape) is None)


def studied_in_space(
    shape: Shape,
    bounds: Any = None,
    letters: Mapping[Any, Any] | None = None,
    smallest: float = SMALLEST,
    budget: int | None = None,
    effort: Effort | None = None,
) -> Study:
    """What boxes in space say of a body; `rsym.verify.bodies.report_body` makes a report of it."""
    values = ranges_of(shape.letters, letters)
    box = outer_bounds(shape, bounds, values)
    return study_body(shape, box, values, smallest=smallest, budget=budget or BODY_BUDGET, effort=effort)


def verdict_of(
    shape: Shape, *, bounds: Any, letters: Mapping[Any, Any] | None, budget: int, effort: Effort | None = None
) -> str:
    """The verdict alone, without a sharp bound of the curvature."""
    return quick_report(shape, bounds=bounds, letters=letters, budget=budget, effort=effort).verdict


def quick_report(
    shape: Shape,
    *,
    bounds: Any,
    letters: Mapping[Any, Any] | None,
    budget: int,
    sharpening: int = 0,
    effort: Effort | None = None,
) -> SmoothnessReport | BodyReport:
    """The report with a bound of the curvature on which only so many boxes are spent, in the plane."""
    shape, letters = with_exact_letters(shape, letters)
    if _in_space(shape, "auto"):
        study = studied_in_space(shape, bounds, letters, SMALLEST, budget * BODY_BUDGET // BUDGET, effort)
        return report_body(study, sharpened=sharpening > 0)
    return Question(shape, bounds, letters).report(letters, budget=budget, sharpening=sharpening, effort=effort)
