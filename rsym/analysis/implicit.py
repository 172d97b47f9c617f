"""Any equation as a shape."""

from __future__ import annotations

from typing import Any

from rsym.analysis.normalisation import normalise
from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, positive
from rsym.model.letters import as_letters
from rsym.model.shape import Shape
from rsym.model.symbols import as_expression, x, y, z
from rsym.model.traversal import symbols_of


def implicit(
    expression: Any,
    coordinates: Any = None,
    length: Any = 1,
    *,
    letters: LetterMapping = None,
    bounds: Any = None,
) -> Shape:
    """Where an expression is positive: L*u/sqrt(u**2 + L**2*|grad u|**2), Rvachev's theorem for any u.

    Normalised to order 1 wherever u is differentiable and its gradient is not zero on the boundary. It has one
    derivative less than u, and nothing is gained at corners of u, where it keeps its value 0 but has no gradient.
    Far away it tends to L in absolute value.

    Parameters
    ----------
    expression : SymPy expression or Shape
        u; R-nodes are kept. A shape brings its coordinates, letters and bounds.
    coordinates : sequence of symbols, optional
        By default (x, y, z) if z is in the expression and no letter, else (x, y).
    length : number or expression
        L > 0, in the unit of the coordinates.
    letters : mapping, optional
        ``{symbol or name: number or Letter}`` for every other symbol.
    bounds : sequence of pairs, optional
        The box that holds what is of interest.

    Raises
    ------
    RsymError
        For an expression without coordinates, coordinates given for a shape, or a length that is not positive.

    Source: Rvachev (1982).

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> rsym.implicit(y - x**2).expression
    (-x**2 + y)/sqrt(4*x**2 + (-x**2 + y)**2 + 1)
    >>> rsym.implicit(z * x - 1).coordinates
    (x, y, z)
    """
    if isinstance(expression, Shape):
        if coordinates is not None:
            raise RsymError("a shape has coordinates of its own", code="coordinates", remedy="leave coordinates out")
        shape = expression.replace(letters=expression.letters.merge(letters), bounds=bounds)
    else:
        shape = _shape(expression, coordinates, letters, bounds)
    if not set(symbols_of(shape.expression)) & set(shape.coordinates):
        raise RsymError(f"the expression {shape.expression} has no coordinate in it", code="implicit")
    return normalise(shape, 1, positive(length, "the length", shape.letters))


def _shape(expression: Any, coordinates: Any, letters: LetterMapping, bounds: Any) -> Shape:
    expression = as_expression(expression)
    if coordinates is None:
        in_space = z.name in {symbol.name for symbol in symbols_of(expression)} - as_letters(letters).keys()
        coordinates = (x, y, z) if in_space else (x, y)
    return Shape(expression, coordinates, letters=letters, bounds=bounds)
