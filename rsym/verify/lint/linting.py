"""The lint: what keeps a shape from being normalised, with place and remedy."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import sympy as sp

from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.sampling.extent import bounds_or_extent
from rsym.verify.lint.faces import face_findings
from rsym.verify.lint.functions import Array, Functions, functions_of
from rsym.verify.lint.letter_findings import letter_findings
from rsym.verify.lint.logic import Logic, logic_of
from rsym.verify.lint.places import places_of
from rsym.verify.lint.report import NOT_NORMALISED, SATURATES, Finding, LintReport
from rsym.verify.lint.saturation import MUCH, level, terms_of
from rsym.verify.lint.sheets import common_faces
from rsym.verify.lint.slopes import message_of, remedy_of
from rsym.verify.lint.zeros import SCATTERED, Box, Progress, Zeros, diagonal, scattered, zeros_of


@dataclass(frozen=True)
class Survey:
    """A shape, its logic, and its leaves and terms at points.

    expressions : the leaves and then terms inside them; functions : these and omega, the last.
    """

    shape: Shape
    box: Box
    logic: Logic
    expressions: tuple[sp.Expr, ...]
    functions: Functions
    cloud: Array
    zeros: Zeros

    @property
    def size(self) -> float:
        """The diagonal of the bounds."""
        return diagonal(self.box)

    def slopes(self, number: int) -> Array:
        """The lengths of a gradient on its zero set."""
        slopes: Array = self.zeros.slopes[self.zeros.which == number]
        return slopes


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

    - "not normalised": leaves with |grad f| != 1 on their zero set within the bounds, off singular points;
    - "coincident faces": operands of an R-operation that are zero on a common face with the same orientation:
      in R_0 the conjunction of f with itself is (2 - sqrt 2) f, the disjunction (2 + sqrt 2) f;
    - "zero sheet": a union of sets that share a face: f or -f is sqrt(2)|f|, zero inside the shape;
    - "sheet without thickness": an intersection of such sets, -sqrt(2)|f|;
    - "saturates": leaves and terms that are nearly constant over a third of the bounds or more, while what they are
      joined with or added to is not: f/sqrt(f**2 + |grad f|**2) never exceeds 1;
    - "letter range": letters whose value or range makes a divisor zero, a radicand negative, the parameter of an
      R-operation illegal, or omega undefined.

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
    if not isinstance(shape, Shape):
        raise RsymError(f"expected a Shape, got {type(shape).__name__}", code="shape")
    if not tolerance > 0:
        raise RsymError(f"the tolerance must be positive, got {tolerance}", code="tolerance", remedy="use 1e-3")
    shape = shape.with_letters(letters or {})
    survey = _survey(shape, bounds, progress)
    found = [
        *_not_normalised(survey, tolerance),
        *face_findings(shape, survey.logic, common_faces(survey.logic, survey.functions, survey.zeros, survey.size)),
        *_saturated(survey),
        *letter_findings(shape, survey.cloud),
    ]
    values, notes = shape.letters.values_with(None), tuple(_notes(survey))
    return LintReport(tuple(found), len(survey.logic.leaves), survey.box, values, notes)


def _survey(shape: Shape, bounds: Any, progress: Progress | None) -> Survey:
    box = bounds_or_extent(shape, bounds)
    logic = logic_of(shape.expression)
    expressions = (*logic.leaves, *terms_of(logic.leaves, shape.coordinates))
    functions = functions_of(shape, [*expressions, shape.expression])
    cloud = scattered(box, SCATTERED[shape.dimension])
    zeros = zeros_of(functions, cloud, box, progress)
    return Survey(shape, box, logic, expressions, functions, cloud, zeros)


def _not_normalised(survey: Survey, tolerance: float) -> Iterator[Finding]:
    leaves = survey.logic.leaves
    for number, place in enumerate(places_of(survey.shape, leaves)):
        slopes = survey.slopes(number)
        if number not in survey.logic.bare or not len(slopes) or np.abs(slopes - 1).max() <= tolerance:
            continue
        worst = survey.zeros.points[survey.zeros.which == number][np.argmax(np.abs(slopes - 1))]
        yield Finding(
            NOT_NORMALISED,
            (place,),
            message_of(slopes),
            remedy_of(leaves[number], slopes, survey.shape.coordinates),
            tuple(worst.tolist()),
            (float(slopes.min()), float(slopes.max())),
        )


def _saturated(survey: Survey) -> Iterator[Finding]:
    """Leaves that are joined with others, and terms that are added to others."""
    first = 0 if len(survey.logic.leaves) > 1 else 1
    values, gradients = survey.functions(survey.cloud[: survey.functions.portion])
    places = places_of(survey.shape, survey.expressions)
    side = max(high - low for low, high in survey.box)
    for number in range(first, len(survey.expressions)):
        slopes = survey.slopes(number)
        if not len(slopes):
            continue
        greatest, share = level(values[number], gradients[number], float(np.median(slopes)))
        if share < MUCH:
            continue
        what = "joined with" if number < len(survey.logic.leaves) else "added to"
        yield Finding(
            SATURATES,
            (places[number],),
            f"nearly constant, its size above {0.9 * greatest:.3g} and flat, in {share:.0%} of the bounds, "
            f"where what it is {what} is not",
            f"normalise with the size of the model: f/sqrt(f^2/L^2 + |grad f|^2), L = {side:.3g}; "
            "rsym.normalise(f, length=L)",
            range=(share, share),
        )


def _notes(survey: Survey) -> Iterator[str]:
    leaves = survey.logic.leaves
    without = [number for number in range(len(leaves)) if not len(survey.slopes(number))]
    for place in places_of(survey.shape, [leaves[number] for number in without]):
        yield f"no regular zero within the bounds, so nothing is said of {place}"
