"""Integrals over a shape, its boundary, or a part of that."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.backends.kernel import compile
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.reports.numbers import point
from rsym.sampling.labels import BOUNDARY, labels_of
from rsym.sampling.rules.portions import RulePortion
from rsym.sampling.rules.quadrature import ORDER, prepared
from rsym.sampling.rules.refinement import Integral, Sums, boundary_rounding, refined

INSIDE = "inside"


def integrate(
    f: Any,
    shape: Shape,
    over: str = INSIDE,
    *,
    tolerance: float | None = None,
    cells: int | None = None,
    order: int = ORDER,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    near: ArrayLike | None = None,
    threads: int | None = None,
) -> Integral:
    """The integral of a function over a shape, its boundary, or a part of the boundary.

    Rules of rising order are compared on the same cells, and cells are halved at last, until two rules agree. Unless f
    is a number, a rule on cells of an eighth of the side, in space half of it, must agree with them: a peak narrower
    than its points lie apart may be missed all the same, so give `near` where there is one.

    Parameters
    ----------
    f : number, SymPy expression, Shape or function
        An expression of the coordinates and letters of the shape; a shape stands for its omega; a function takes the
        arrays of the coordinates.
    shape : Shape
        What to integrate over, as in `quadrature`.
    over : str
        ``inside``, ``boundary`` (sides of bounds that cap the shape included), or the name of a part.
    tolerance : float, optional
        Of the error, relative to the integral of |f|; by default 1e-12 in the plane and 1e-10 in space.
    cells : int, optional
        To begin with, along the longest side.
    order, bounds, letters, near, threads
        As in `quadrature`. At a corner where f is singular `near` saves digits.

    Returns
    -------
    Integral
        A float with `.error`, an estimate: the difference of the last two rules, some ten times it where differences
        fall slowly, as of singular functions, rounding, and what is not resolved of the shape, as next to its cusps.

    Raises
    ------
    RsymError
        For an unknown part, a function that is undefined at a point of the rule, and as in `quadrature`.

    Warns
    -----
    RsymWarning
        Where the tolerance was not met.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> half = rsym.disc(1).named("rim") & rsym.Shape(y, (x, y)).named("cut")
    >>> round(rsym.integrate(y, half), 12), round(rsym.integrate(x**2, half, "cut"), 12)
    (0.666666666667, 0.666666666667)
    >>> length = rsym.integrate(1, half, over="rim")
    >>> round(length, 12), bool(length.error < 1e-12)
    (3.14159265359, True)
    """
    require_shape(shape)
    made = prepared(shape, bounds, letters)
    labels_of((), made.parts).require(over, INSIDE, BOUNDARY)
    function = _function(f, shape, letters)

    def quantities(portion: RulePortion) -> Sums:
        rule, lost = portion.rule, portion.unresolved.content
        rounding = made.resolution * rule.edge_weights.sum()
        if over == INSIDE:
            points, weights = rule.points, rule.weights
        else:
            some, lost = made.labels(rule).on(over), portion.unresolved.boundary
            points, weights = rule.edge_points[:, some], rule.edge_weights[some]
            shared = 0.0 if over == BOUNDARY else portion.unresolved.shared
            rounding = boundary_rounding(made, weights.sum()) + shared
        values = function(points.T)
        size = np.abs(values).max(initial=0.0)
        return Sums(*np.array([[weights @ values], [weights @ np.abs(values)], [lost * size], [rounding * size]]))

    found = refined(
        made,
        quantities,
        tolerance=tolerance,
        cells=cells,
        order=order,
        near=near,
        threads=threads,
        peaks=not isinstance(f, Real),
    )
    return found.integral(0)


def _function(f: Any, shape: Shape, letters: Mapping[Any, float] | None) -> Callable[[Floats], Floats]:
    """A function of points (n, dim) with finite values (n,)."""
    given: Callable[..., Any]
    if isinstance(f, Real):
        given = lambda *_: float(f)  # noqa: E731
    elif isinstance(f, Shape) or hasattr(f, "free_symbols") or not callable(f):
        field = f if isinstance(f, Shape) else Shape(f, shape.coordinates, letters=shape.letters)
        if field.coordinates != shape.coordinates:
            raise RsymError(
                f"the function has the coordinates {field.coordinates}, the shape {shape.coordinates}",
                code="coordinates",
            )
        kernel = compile(field)
        values = shape.letters.values_with(letters)
        own = {name: value for name, value in values.items() if name in field.letters}
        given = lambda *places: kernel(*places, letters=own)["value"]  # noqa: E731
    else:
        given = f

    def function(points: Floats) -> Floats:
        found = np.broadcast_to(np.asarray(given(*points.T), np.float64), len(points))
        bad = np.flatnonzero(~np.isfinite(found))
        if len(bad):
            raise RsymError(
                f"the function to integrate is {found[bad[0]]} at {point(points[bad[0]])}",
                code="undefined",
                remedy="integrate over a part where it is defined",
            )
        return found

    return function
