"""Boundary value problems in their weak forms, written as functions: the public `solve_form`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rsym.analysis.conditions import Robin, Switched, neumann
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.problems.conditions import given_by_name, with_letters_of
from rsym.problems.estimates import goal_of
from rsym.problems.plates import require_edges
from rsym.problems.posing import posed
from rsym.problems.problem import Problem
from rsym.problems.solution import Solution
from rsym.problems.solving import answered, lettered, turned_about
from rsym.problems.weak.reading import weak_form
from rsym.sampling.progress import Progress


def solve_form(
    shape: Shape,
    a: Any,
    l: Any,  # noqa: E741
    conditions: Any = None,
    *,
    degree: int = 4,
    cells: int | None = None,
    tolerance: float | None = None,
    letters: Mapping[Any, Any] | None = None,
    axis: Any = None,
    corners: bool = True,
    estimate: bool = True,
    goal: Any = None,
    progress: Progress | None = None,
) -> Solution:
    """The u, with given values on parts of the boundary, for which a(u, v) = l(v) for all v that are 0 there.

    Parameters
    ----------
    shape, degree, cells, tolerance, axis, corners, estimate, goal, progress
        As in `solve`; integrals about an axis have the radius in them already.
    a, l : functions, or mappings of places to functions
        ``a(u, v, w)`` and ``l(v, w)`` are what is integrated, as users of scikit-fem write it; its decorators and
        helpers may be used (`dot`, `grad`, `mul`, `ddot`, `dd`). u and v have `.grad`, `.hess`, `.laplacian` and
        derivatives by the names of coordinates, ``u.x``; w has `.x`, the coordinates, `.h`, the size of cells, on
        the boundary `.n`, the outward normal, and letters, ``w.k`` or ``w["k"]``. They are called once and become
        formulas: of numbers, of expressions in ``rsym.x`` and letters, of NumPy's or SymPy's functions. In a mapping
        ``"inside"`` is integrated over the shape, a name of a part over that part of the boundary, where parts lie in
        one another that of the smallest named, ``...`` over the rest, as conditions of `solve` hold, a and l by
        themselves; ``"boundary"`` over all of it, besides. Robin's condition u_n + c*u = h is
        ``{"inside": a, "rim": lambda u, v, w: c * u * v}`` and ``{"inside": l, "rim": lambda v, w: h * v}``.
    conditions : mapping, or one condition for all of the boundary, optional
        Values as in `solve`: numbers, expressions, ``rsym.constant(flow)``, where second derivatives are in the form
        ``rsym.clamped()``. Where nothing is said the form says what holds, as it does where
        ``rsym.switched(where, 0, rsym.neumann())`` holds no value.
    letters : mapping, optional
        As in `solve`: numbers, expressions, shapes, Python functions, vectors and matrices of these; a function that
        is no formula goes in here.

    Returns
    -------
    Solution
        As of `solve`, of the same compiled system; it pickles if the functions among the letters do.

    Raises
    ------
    RsymError
        For a form that is not linear in u or v or no formula, and as `solve`; it warns as that.

    Examples
    --------
    >>> import numpy as np
    >>> import rsym
    >>> ring = rsym.disc(1).named("rim") - rsym.disc(0.5).named("bore")
    >>> a = {"inside": lambda u, v, w: u.grad @ v.grad + 2 * u.x * v, "rim": lambda u, v, w: w.c * u * v}
    >>> u = rsym.solve_form(ring, a, lambda v, w: np.exp(w.x[0]) * v, {"bore": 1}, cells=16, letters={"c": 3})
    >>> v = rsym.solve(
    ...     ring, "-laplacian(u) + 2*diff(u, x) = exp(x)", {"bore": 1, "rim": rsym.robin(3)}, cells=16
    ... )
    >>> u(0.75, 0) == v(0.75, 0), u.with_letters({"c": 5})(0.75, 0) < u(0.75, 0)
    (np.True_, np.True_)
    """
    require_shape(shape)
    seams, named = lettered(with_letters_of(shape, conditions), letters, divisible=False)
    shape = seams.shape
    turned = turned_about(shape, axis)
    form = weak_form(shape, a, l, named, None if turned < 0 else turned)
    values = given_by_name(shape, {} if conditions is None else conditions)
    for name, condition in values.items():
        both = (condition.inside, condition.outside) if isinstance(condition, Switched) else (condition,)
        # Beside values that change on an edge, that nothing flows says that the form says what holds.
        silent = isinstance(condition, Switched)
        if any(isinstance(one, Robin) and not (silent and one == neumann()) for one in both):
            place = "the rest" if name is ... else repr(name)
            raise RsymError(
                f"the condition on {place} is one on the flux, which forms have in themselves",
                code="condition",
                remedy='write it as a form on the part: a = {"inside": a, "rim": lambda u, v, w: c * u * v}',
            )
    problem = posed(Problem(shape, form, values, (), turned, seams=seams))
    require_edges(problem, single=False)
    return answered(problem, degree, cells, tolerance, corners, progress, estimate, goal_of(goal, shape.dimension))
