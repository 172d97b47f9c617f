"""Formulas for a paper: fields of a shape and any expression as LaTeX in named common parts."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from typing import Any

import sympy as sp

from rsym.analysis.differential import curvature, gaussian_curvature, gradient, hessian, laplacian, mean_curvature
from rsym.analysis.normalisation import normalise
from rsym.errors import RsymError, RsymWarning
from rsym.model import showing
from rsym.model.nodes import without_zeros
from rsym.model.shape import Shape
from rsym.model.symbols import as_expression
from rsym.model.wording import listing, proposal

FORMULAS = ("value", "gradient", "hessian", "laplacian", "normalised", "normalised_2", "normalised_3")
CURVATURES = {"curvature": curvature, "mean_curvature": mean_curvature, "gaussian_curvature": gaussian_curvature}
_SIGNS = {"curvature": r"\kappa", "mean_curvature": "H", "gaussian_curvature": "K"}


def latex(what: Any, field: str = "value") -> str:
    r"""The LaTeX of a shape, of one of its fields, or of an expression, in named common parts.

    A short formula is one line. A longer one is an ``aligned`` environment: parts that stand in several places,
    and those of a line too long to read, are written once, ``p_{1} &:= ...``, and called by name from then on;
    names of a model file are kept. The work grows with the distinct parts of the formula.

    Parameters
    ----------
    what : Shape, SymPy expression or matrix
        What to write.
    field : str
        Of a shape: ``value``, ``gradient``, ``hessian``, ``laplacian``, ``normalised`` (omega_n of `normalise`),
        ``normalised_m`` (of order m), ``curvature``, ``mean_curvature``, ``gaussian_curvature``.

    Returns
    -------
    str
        Without dollar signs.

    Raises
    ------
    RsymError
        For what is neither shape, expression nor matrix, an unknown field, or one that `what` has not.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> corner = rsym.Shape(rsym.conjunction(x, y), (x, y))
    >>> print(rsym.latex(corner))
    \omega\left(x, y\right) = x \wedge_0 y
    >>> for line in rsym.latex(corner, "gradient").split(r"\\ "):
    ...     print(line)
    \begin{aligned}p_{1} &:= \frac{1}{\sqrt{x^{2} + y^{2}}}
    \frac{\partial \omega}{\partial x} &= - p_{1} x + 1
    \frac{\partial \omega}{\partial y} &= - p_{1} y + 1\end{aligned}
    """
    if isinstance(what, Shape):
        if field == "value":
            return showing.latex(what)
        sides, known = field_formulas(what, field)
        return showing.written(sides, known, what.letters)
    if field != "value":
        raise RsymError(f"only a Shape has the field {field!r}, got {type(what).__name__}", code="shape")
    if isinstance(what, sp.MatrixBase):
        rows, columns = what.shape
        entries = {rf"a_{{{i + 1},{j + 1}}}": what[i, j] for i in range(rows) for j in range(columns)}
        return showing.written(entries)
    return showing.written({"f": as_expression(what)})


def field_lines(shape: Shape, field: str) -> list[str]:
    """A field of a shape in lines for an environment that breaks pages, which ``aligned`` does not."""
    sides, known = field_formulas(shape, field)
    return showing.lines_of(sides, known, shape.letters)


def field_formulas(shape: Shape, field: Any) -> tuple[Mapping[str, sp.Expr], Mapping[str, sp.Expr]]:
    """What stands on the left and on the right of a field's equations, and the names of the model file."""
    return _sides(shape, field), showing.known_parts(shape)


def _sides(shape: Shape, field: Any) -> Mapping[str, sp.Expr]:
    names = [showing.printed(symbol) for symbol in shape.coordinates]
    if field == "gradient":
        left = r"\frac{{\partial \omega}}{{\partial {}}}"
        return {left.format(name): d for name, d in zip(names, gradient(shape), strict=True)}
    if field == "hessian":
        matrix, size = hessian(shape), range(shape.dimension)
        return {_second(names[i], names[j]): matrix[i, j] for i in size for j in size if i <= j}
    if field == "laplacian":
        return {r"\Delta \omega": laplacian(shape)}
    if field in CURVATURES:
        return {_SIGNS[field]: CURVATURES[field](shape)}
    order = re.fullmatch(r"normalised(?:_([1-9]))?", field) if isinstance(field, str) else None
    if order is None:
        known = [*FORMULAS, *CURVATURES]
        raise RsymError(
            f"{field!r} is no field with a formula; there are: {listing(known)}",
            code="unknown-field",
            remedy=proposal(field, known, "use one of these"),
        )
    number = int(order.group(1) or 1)
    name = r"\omega_{n}" if number == 1 else rf"\omega_{{n}}^{{({number})}}"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RsymWarning)  # a formula is printed, where it serves is not asked
        return {name: without_zeros(normalise(shape, number).expression)}


def _second(first: str, second: str) -> str:
    below = rf"\partial {first}^{{2}}" if first == second else rf"\partial {first}\, \partial {second}"
    return rf"\frac{{\partial^{{2}} \omega}}{{{below}}}"
