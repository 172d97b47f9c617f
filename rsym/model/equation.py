"""An equation: omega in coordinates and letters, with its bounds and its parts; the data of which shapes are made.

Whatever makes a shape of shapes is one of two: something else in the place of the coordinates (`substituted`: motions,
constructions), or a function of their expressions (`combine`: logic, blends).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self, TypeAlias, TypeVar

import sympy as sp
from sympy.functions.elementary.piecewise import ExprCondPair

from rsym.errors import RsymError
from rsym.model.choices import Choice
from rsym.model.letters import Letter, Letters, as_letters
from rsym.model.rewriting import in_known_functions
from rsym.model.symbols import as_expression, postorder, real_replacements, substitute, symbols_of

Bounds: TypeAlias = tuple[tuple[float, float], ...]
S = TypeVar("S", bound="Equation")

_NO_NUMBERS = (sp.oo, -sp.oo, sp.zoo, sp.I)


@dataclass(frozen=True, init=False, repr=False)
class Equation:
    """What a shape is given, checked; what can be asked of it and done with it says `Shape`."""

    expression: sp.Expr
    coordinates: tuple[sp.Symbol, ...]
    letters: Letters
    bounds: Bounds | None
    definitions: tuple[tuple[str, sp.Expr], ...] = field(compare=False)
    parts: tuple[tuple[str, sp.Expr], ...] = field(compare=False)

    def __init__(
        self,
        expression: Any,
        coordinates: Any,
        *,
        letters: Mapping[Any, Letter | float] | None = None,
        bounds: Any = None,
        definitions: tuple[tuple[str, sp.Expr], ...] = (),
        parts: tuple[tuple[str, sp.Expr], ...] = (),
    ) -> None:
        expression = in_known_functions(as_expression(expression))
        coordinates = tuple(coordinates) if isinstance(coordinates, Iterable) else (coordinates,)
        if len(coordinates) not in (2, 3) or not all(isinstance(symbol, sp.Symbol) for symbol in coordinates):
            raise RsymError(
                f"a shape needs two or three coordinate symbols, got {coordinates}",
                code="coordinates",
                remedy="for example (x, y) or (x, y, z)",
            )
        _check_values(expression)
        real = real_replacements((expression, *coordinates))
        store = object.__setattr__
        store(self, "expression", substitute(expression, real) if real else expression)
        store(self, "coordinates", tuple(real.get(symbol, symbol) for symbol in coordinates))
        store(self, "letters", as_letters(letters))
        store(self, "bounds", None if bounds is None else checked_bounds(bounds, len(coordinates)))
        store(self, "definitions", definitions)
        parts = tuple((name, in_known_functions(part)) for name, part in parts)
        store(self, "parts", tuple((name, substitute(part, real) if real else part) for name, part in parts))
        self._check_symbols()

    def _check_symbols(self) -> None:
        names = [symbol.name for symbol in self.coordinates]
        if len(set(names)) != len(names) or self.letters.keys() & set(names):
            raise RsymError("coordinates and letters must have different names", code="coordinates")
        known = {*names, *self.letters}
        unknown = [symbol.name for symbol in symbols_of(self.expression) if symbol.name not in known]
        if unknown:
            raise RsymError(
                f"the expression contains {', '.join(unknown)}, neither coordinate nor letter",
                code="unknown-letter",
                remedy=f"give letters={{{unknown[0]}: value}}",
            )

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return len(self.coordinates)

    def with_letters(self, values: Mapping[Any, Any]) -> Self:
        """The same shape with other defaults: {name or symbol: number or Letter}.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> import sympy as sp
        >>> r = sp.Symbol("r", real=True)
        >>> rsym.Shape(r - x - y, (x, y), letters={r: 1}).with_letters({r: 2}).letters["r"].default
        2
        """
        named = {str(key): value for key, value in values.items()}
        self.letters.values_with({name: value for name, value in named.items() if not isinstance(value, Letter)})
        changed = {
            name: new if isinstance(new := named.get(name, old.default), Letter) else replace(old, default=new)
            for name, old in self.letters.items()
        }
        return self.replace(letters=changed)

    def replace(self, *, expression: Any = None, letters: Mapping[Any, Any] | None = None, bounds: Any = None) -> Self:
        """A copy with another expression, other letters or other bounds."""
        return replace(
            self,
            expression=self.expression if expression is None else expression,
            letters=self.letters if letters is None else as_letters(letters),
            bounds=self.bounds if bounds is None else bounds,
            definitions=self.definitions if expression is None else (),
        )


def substituted(
    shape: S,
    places: Mapping[sp.Symbol, sp.Expr],
    *,
    coordinates: tuple[sp.Symbol, ...] | None = None,
    factor: Any = 1,
    letters: Mapping[Any, Letter | float] | None = None,
    bounds: Any = None,
) -> S:
    """Factor * omega(places), parts alike; letters are added to those of the shape, bounds are the new ones.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> substituted(rsym.Shape(x + y, (x, y)), {x: y, y: x - 1}).expression
    x + y - 1
    """
    coordinates = shape.coordinates if coordinates is None else coordinates
    taken = shape.letters.keys() & {symbol.name for symbol in coordinates}
    if taken:
        raise RsymError(
            f"the letter {min(taken)!r} would become a coordinate", code="coordinates", remedy="rename the letter"
        )
    factor = sp.sympify(factor)
    return replace(
        shape,
        expression=factor * substitute(shape.expression, places),
        coordinates=coordinates,
        letters=shape.letters.merge(letters),
        bounds=bounds,
        definitions=(),
        parts=tuple((name, factor * substitute(part, places)) for name, part in shape.parts),
    )


def combine(function: Callable[..., sp.Expr], *operands: Any) -> Any:
    """Apply a function of expressions to shapes: same coordinates, letters and parts merged, bounds the box around all.

    Plain expressions among shapes take part as they are; without any shape the result is an expression.
    """
    shapes = [operand for operand in operands if isinstance(operand, Equation)]
    expressions = [
        operand.expression if isinstance(operand, Equation) else as_expression(operand) for operand in operands
    ]
    if not shapes:
        return function(*expressions)
    letters = Letters({})
    for shape in shapes:
        if [s.name for s in shape.coordinates] != [s.name for s in shapes[0].coordinates]:
            raise RsymError(
                f"shapes in {shapes[0].coordinates} and {shape.coordinates} cannot be combined",
                code="coordinates",
                remedy="revolve or extrude the plane shape first",
            )
        letters = letters.merge(shape.letters)
    return replace(
        shapes[0],
        expression=function(*expressions),
        letters=letters,
        bounds=hull([shape.bounds for shape in shapes if shape.bounds is not None]),
        definitions=(),
        # Two parts of one name stay two: their surfaces share the name.
        parts=tuple(dict.fromkeys(part for shape in shapes for part in shape.parts)),
    )


def _check_values(expression: sp.Expr) -> None:
    """Refuse what has no real value anywhere; a branch of a piecewise function may be undefined."""
    for part in (sp.Tuple(expression), *postorder(expression)):
        branches = isinstance(part, ExprCondPair | Choice)
        for argument in part.args:
            if argument in _NO_NUMBERS or (argument is sp.nan and not branches):
                raise RsymError(
                    f"the expression contains {argument}, which is not a real number",
                    code="number",
                    remedy="remove the division by zero or the root of a negative number that it came from",
                )


def checked_bounds(bounds: Any, dimension: int) -> Bounds:
    """Bounds as pairs of floats; what is not so many finite, increasing pairs is refused.

    Examples
    --------
    >>> checked_bounds([[0, 1], [-2, 2]], 2)
    ((0.0, 1.0), (-2.0, 2.0))
    """
    try:
        box = tuple((float(low), float(high)) for low, high in bounds)
    except (TypeError, ValueError) as error:
        raise RsymError(f"bounds must be pairs (low, high), got {bounds!r}", code="bounds") from error
    if len(box) != dimension or not all(math.isfinite(a) and math.isfinite(b) and a < b for a, b in box):
        raise RsymError(
            f"bounds must be {dimension} finite pairs with low < high, got {bounds!r}",
            code="bounds",
            remedy="for example ((-1, 1), (-1, 1))",
        )
    return box


def hull(boxes: Sequence[Bounds]) -> Bounds | None:
    """The box around boxes; None around none.

    Examples
    --------
    >>> hull([((0, 1), (0, 1)), ((-1, 0), (0, 2))])
    ((-1, 1), (0, 2))
    """
    if not boxes:
        return None
    return tuple((min(low for low, _ in axis), max(high for _, high in axis)) for axis in zip(*boxes, strict=True))
