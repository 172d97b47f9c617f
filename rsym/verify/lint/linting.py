"""The lint: what keeps a shape from being normalised, with place and remedy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from rsym.errors import RsymError
from rsym.model.nodes import without_zeros
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.verify.lint.letter_findings import letter_findings
from rsym.verify.lint.places import places_of
from rsym.verify.lint.report import COINCIDENT, LONE_SHEET, NOT_NORMALISED, SATURATES, ZERO_SHEET, Finding, LintReport
from rsym.verify.lint.saturation import MUCH, level
from rsym.verify.lint.sheets import CommonFace, common_faces
from rsym.verify.lint.slopes import CONSTANT, breaks_normalisation, message_of, remedy_of
from rsym.verify.lint.survey import Survey, survey_of
from rsym.verify.lint.zeros import Progress


def lint(
    shape: Shape,
    *,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    tolerance: float = 1e-3,
    progress: Progress | None = None,
) -> LintReport:
    """Look for what keeps omega from being normalised, and for other faults of its formula.

    A *leaf* is a maximal part of the formula without an R-operation on top. Found are

    - "not normalised": leaves with |grad f| != 1 on their zero set within the bounds, off singular points, and
      those whose `contract` shows it at other letters; operations of R_0^m;
    - "coincident faces": operands of an R-operation that are zero on a common face with the same orientation:
      in R_0 the conjunction of f with itself is (2 - sqrt 2) f, the disjunction (2 + sqrt 2) f;
    - "zero sheet": a union of sets that share a face: f or -f is sqrt(2)|f|, zero inside the shape;
    - "sheet without thickness": an intersection of such sets, -sqrt(2)|f|;
    - "saturates": leaves and terms that are nearly constant over a third of the bounds or more, while what they are
      joined with or added to is not: f/sqrt(f**2 + |grad f|**2) never exceeds 1;
    - "letter range": letters whose value or range makes a divisor zero, a radicand negative, the parameter of an
      R-operation illegal, omega undefined or the shape empty; an open end of a range is infinite.

    Faces are common where omega shows it: a face that lies inside another operand is no fault.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    bounds : pairs, optional
        Where to look; by default the bounds of the shape, else its `extent`.
    letters : mapping, optional
        Override the defaults.
    tolerance : float
        The greatest deviation of |grad f| from 1 that counts as normalised.
    progress : callable, optional
        ``progress(done, total)``.

    Returns
    -------
    LintReport
        ``.findings``, ``.clean``; ``str(report)`` lists them. All but the letters is measured at 800 points of each
        zero set, always the same: a face of less than a hundredth of a leaf may be overlooked.

    Raises
    ------
    RsymError
        For what is no shape, an unbounded shape without bounds, or letters out of their range.

    Source: Rvachev (1982); Lisin, Maksimenko-Sheiko and Sheiko (2013).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> def square(left):
    ...     return rsym.Shape((left + 1 - x) * (x - left), (x, y)) & rsym.Shape(y * (1 - y), (x, y))
    >>> report = rsym.lint(square(0) | square(1))
    >>> [finding.kind for finding in report.findings]
    ['zero sheet']
    >>> rsym.lint(square(0)).clean
    True
    """
    require_shape(shape)
    if not tolerance > 0:
        raise RsymError(f"the tolerance must be positive, got {tolerance}", code="tolerance", remedy="use 1e-3")
    shape = shape.with_letters(letters or {})
    if (bare := without_zeros(shape.expression)) is not shape.expression:
        shape = shape.replace(expression=bare)
    survey = survey_of(shape, bounds, progress)
    found = [
        *_not_normalised(survey, tolerance),
        *face_findings(survey, common_faces(survey.logic, survey.functions, *survey.near)),
        *_saturated(survey),
        *letter_findings(shape, survey.cloud),
    ]
    values, notes = shape.letters.values_with(None), tuple(_notes(survey))
    return LintReport(tuple(found), len(survey.orders), survey.box, values, notes)


def _not_normalised(survey: Survey, tolerance: float) -> Iterator[Finding]:
    """Leaves; where algebra shows that one is normalised nothing is measured."""
    for leaf, order in survey.orders.items():
        slopes = survey.slopes(leaf)
        off = np.abs(slopes - 1)
        # What is normalised at these letters by chance is told too.
        by_chance = order == 0 and leaf.free_symbols.difference(survey.shape.coordinates)
        if order or not len(slopes) or not (off.max() > tolerance or (by_chance and off.max() < CONSTANT)):
            continue
        yield Finding(
            NOT_NORMALISED,
            (survey.place(leaf),),
            message_of(slopes),
            remedy_of(leaf, slopes, survey.shape.coordinates),
            tuple(survey.points(leaf)[np.argmax(off)].tolist()),
            (float(slopes.min()), float(slopes.max())),
        )
    lost = [operation for operation in survey.operations if breaks_normalisation(operation)]
    for place in places_of(survey.shape, lost):
        message = "an operation of R_0^m is not normalised: on f = 0 its gradient has the length |g|^m"
        yield Finding(NOT_NORMALISED, (place,), message, "normalise the result, or take R_0")


def _saturated(survey: Survey) -> Iterator[Finding]:
    """Leaves that are joined with others, and terms that are added to others."""
    values, gradients = survey.functions(survey.cloud[: survey.functions.portion])
    lengths = np.linalg.norm(gradients, axis=2)
    side = max(high - low for low, high in survey.box)
    for number, expression in enumerate(survey.expressions):
        leaves, slopes = survey.leaves_with(expression), survey.slopes(expression)
        if len(leaves) == 1 or not len(slopes):
            continue
        greatest, share = level(values[number], lengths[number], float(np.median(slopes)))
        if share < MUCH:
            continue
        yield Finding(
            SATURATES,
            (survey.places[number],),
            f"its size is above {0.9 * greatest:.3g} and hardly changes in {share:.0%} of the bounds, "
            f"while what it is {'joined with' if leaves else 'added to'} goes on growing",
            f"normalise with the size of the model: f/sqrt(f^2/L^2 + |grad f|^2), L = {side:.3g}; "
            "rsym.normalise(f, length=L)",
            range=(share, share),
        )


def _notes(survey: Survey) -> Iterator[str]:
    for leaf, order in survey.orders.items():
        if not order and not len(survey.slopes(leaf)):
            yield f"no regular zero within the bounds, so nothing is said of {survey.place(leaf)}"


# Common faces in words.
_MESSAGES = {
    ZERO_SHEET: "the sets that this disjunction joins share a face: omega is zero there, inside the shape",
    LONE_SHEET: "the sets of this conjunction have only a face in common: a shape without thickness, omega <= 0",
}
_REMEDIES = {
    ZERO_SHEET: "let the sets overlap, or join them before they are cut: build both from one common primitive",
    LONE_SHEET: "let the sets overlap, or leave the conjunction out",
    COINCIDENT: "leave one of the two out, move one face off the other, or normalise the result",
}


def face_findings(survey: Survey, faces: Sequence[CommonFace]) -> Iterator[Finding]:
    """A finding for each common face."""
    for kind in (COINCIDENT, ZERO_SHEET, LONE_SHEET):
        for face in faces:
            if face.kind == kind:
                point = face.points[len(face.points) // 2]
                where = dict.fromkeys((survey.places[face.first], survey.places[face.second]))
                yield Finding(kind, tuple(where), _message(face), _REMEDIES[kind], tuple(point.tolist()))


def _message(face: CommonFace) -> str:
    if face.kind != COINCIDENT:
        return _MESSAGES[face.kind]
    word, sign = ("conjunction", "-") if face.conjunction else ("disjunction", "+")
    return (
        f"the operands of this {word} are zero on the same face, which loses normalisation: "
        f"in R_0, f with itself gives (2 {sign} sqrt(2))*f"
    )
