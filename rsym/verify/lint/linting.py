"""The lint: a shape with its leaves and terms at points of its bounds, and what keeps it from being normalised."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from rsym.analysis.contracts.leaves import is_logical, logical_parts
from rsym.analysis.contracts.orders import leaf_order
from rsym.analysis.contracts.promises import Order
from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.logic.faces import BETWEEN
from rsym.model.nodes import without_zeros
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.sampling.labels import Labeller
from rsym.sampling.windows import bounds_or_extent
from rsym.verify.lint.letter_findings import letter_findings
from rsym.verify.lint.logic import Logic, logic_of
from rsym.verify.lint.places import ModelPlace, places_of
from rsym.verify.lint.report import (
    COINCIDENT,
    LONE_SHEET,
    NOT_NORMALISED,
    SATURATES,
    UNDEFINED,
    ZERO_SHEET,
    Finding,
    LintReport,
)
from rsym.verify.lint.sheets import CommonFace, common_faces
from rsym.verify.lint.slopes import (
    CONSTANT,
    MUCH,
    breaks_normalisation,
    level,
    message_of,
    operands_of,
    remedy_of,
    terms_of,
)
from rsym.verify.lint.zeros import (
    SCATTERED,
    Box,
    Functions,
    Progress,
    Zeros,
    diagonal,
    functions_of,
    scattered,
    zeros_of,
)

MARGIN = 0.02  # of the diagonal of the bounds, around the zeros of omega that were met
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
      R-operation illegal, omega undefined or the shape empty; an open end of a range is infinite;
    - "without a value": leaves that have none in a part of the bounds: there the others decide, and what they leave
      open is outside.

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
        *_undefined(survey),
    ]
    silent = [leaf for leaf, order in survey.orders.items() if not order and not len(survey.slopes(leaf))]
    notes = tuple(f"no regular zero within the bounds, so nothing is said of {survey.place(leaf)}" for leaf in silent)
    return LintReport(tuple(found), len(survey.orders), survey.box, shape.letters.values_with(None), notes)


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
            tuple(survey.points(leaf)[np.argmax(off >= off.max() - CONSTANT)].tolist()),  # the first, but for rounding
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


def _undefined(survey: Survey) -> Iterator[Finding]:
    """Leaves that have no value in a part of the bounds."""
    values, _ = survey.functions(survey.cloud[: survey.functions.portion])
    for leaf in survey.orders:
        missing = np.isnan(values[survey._numbers[leaf]])
        if missing.any():
            share = float(missing.mean())
            yield Finding(
                UNDEFINED,
                (survey.place(leaf),),
                f"it has no value in {share:.0%} of the bounds: there the other parts decide, and what they leave open "
                "is outside",
                "cut it where it ends by a part of its own, or write it without the root or logarithm",
                tuple(survey.cloud[: len(missing)][missing][0].tolist()),
                (share, share),
            )


def face_findings(survey: Survey, faces: Sequence[CommonFace]) -> Iterator[Finding]:
    """A finding for each common face."""
    for kind in (COINCIDENT, ZERO_SHEET, LONE_SHEET):
        for face in faces:
            if face.kind == kind:
                point = face.points[len(face.points) // 2]
                where = dict.fromkeys((survey.places[face.first], survey.places[face.second]))
                message = _message(face) + (_of_parts(survey.shape, point) if kind == COINCIDENT else "")
                yield Finding(kind, tuple(where), message, _REMEDIES[kind], tuple(point.tolist()))


def _of_parts(shape: Shape, point: Floats) -> str:
    """Which parts have a face at a point, in words, where there are several."""
    (name,) = Labeller(shape).nearest(point[None]).each
    return f"; the face is one of {name.replace(BETWEEN, ' and ')}" if BETWEEN in name else ""


def _message(face: CommonFace) -> str:
    if face.kind != COINCIDENT:
        return _MESSAGES[face.kind]
    word, sign = ("conjunction", "-") if face.conjunction else ("disjunction", "+")
    return (
        f"the operands of this {word} are zero on the same face, which loses normalisation: "
        f"in R_0, f with itself gives (2 {sign} sqrt(2))*f"
    )


@dataclass(frozen=True)
class Survey:
    """A shape, its logic, and its leaves and terms at points.

    operations : the R-operations of the formula; orders : of its leaves, as far as algebra shows them;
    expressions : the leaves of the logic, then the other leaves, which blends, trimming and joining hide from it, then
    terms inside leaves; functions : these and omega, the last; zeros : points on their zero sets;
    near : such points in the box that holds the zeros of omega, and the diagonal of that box.
    """

    shape: Shape
    box: Box
    logic: Logic
    operations: tuple[sp.Expr, ...]
    orders: dict[sp.Expr, Order]
    expressions: tuple[sp.Expr, ...]
    places: tuple[ModelPlace, ...]
    functions: Functions
    cloud: Floats
    zeros: Zeros
    near: tuple[Zeros, float]

    def slopes(self, expression: sp.Expr) -> Floats:
        """The lengths of a gradient on its zero set."""
        slopes: Floats = self.zeros.slopes[self._of(expression)]
        return slopes

    def points(self, expression: sp.Expr) -> Floats:
        """Where these are."""
        points: Floats = self.zeros.points[self._of(expression)]
        return points

    def leaves_with(self, expression: sp.Expr) -> tuple[sp.Expr, ...]:
        """The leaves that R-operations join a leaf with, itself included; none for a term."""
        groups = (self.logic.leaves, tuple(self.orders))
        return next((leaves for leaves in groups if expression in leaves), ())

    def place(self, expression: sp.Expr) -> ModelPlace:
        """Where an expression stands in the model."""
        return self.places[self._numbers[expression]]

    def _of(self, expression: sp.Expr) -> Any:
        return self.zeros.which == self._numbers[expression]

    @cached_property
    def _numbers(self) -> Mapping[sp.Expr, int]:
        return {expression: number for number, expression in enumerate(self.expressions)}


def survey_of(shape: Shape, bounds: Any, progress: Progress | None = None) -> Survey:
    """Look at a shape.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> survey = survey_of(rsym.Shape(rsym.conjunction(x, 2 * y), (x, y)), ((-1, 1), (-1, 1)))
    >>> survey.orders[x], survey.orders[2 * y], survey.slopes(2 * y).max().item()
    (inf, 0, 2.0)
    """
    box = bounds_or_extent(shape, bounds)
    logic = logic_of(shape.expression)
    parts = logical_parts(shape.expression, operands_of)
    leaves = [part for part in parts if not is_logical(part)]
    terms = terms_of(leaves, shape.coordinates)
    expressions = tuple(dict.fromkeys([*logic.leaves, *leaves, *terms]))
    functions = functions_of(shape, [*expressions, shape.expression])
    cloud = scattered(box, SCATTERED[shape.dimension])
    zeros = zeros_of(functions, cloud, box, _half(progress, 0))
    return Survey(
        shape,
        box,
        logic,
        tuple(part for part in parts if is_logical(part)),
        {leaf: leaf_order(leaf, shape.coordinates) for leaf in leaves},
        expressions,
        places_of(shape, expressions),
        functions,
        cloud,
        zeros,
        _near(functions, zeros, box, _half(progress, 1)),
    )


def _half(progress: Progress | None, number: int) -> Progress | None:
    """The progress of the first or second of two equal tasks."""
    return None if progress is None else lambda done, total: progress(done + number * total, 2 * total)


def _near(functions: Functions, zeros: Zeros, box: Box, progress: Progress | None) -> tuple[Zeros, float]:
    """Zeros where the shape is: within generous bounds faces are few among those of their leaves."""
    points = zeros.points[zeros.which == functions.count - 1]
    if len(points):
        margin = MARGIN * diagonal(box)
        ends = zip(box, points.min(axis=0).tolist(), points.max(axis=0).tolist(), strict=True)
        box = tuple((max(low, least - margin), min(high, most + margin)) for (low, high), least, most in ends)
    cloud = scattered(box, SCATTERED[functions.dimension])
    return zeros_of(functions, cloud, box, progress), diagonal(box)
