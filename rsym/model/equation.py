"""An equation: omega in coordinates and letters, with its bounds and its parts; the data of which shapes are made.

Whatever makes a shape of shapes is one of two: something else in the place of the coordinates (`substituted`: motions,
constructions), or a function of their expressions (`combine`: logic, blends).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self, TypeVar

import sympy as sp
from sympy.functions.elementary.piecewise import ExprCondPair

from rsym.errors import RsymError
from rsym.model.bounding import BoundingBox, Bounds, around, stated_box
from rsym.model.choices import Choice
from rsym.model.letters import Letter, Letters, as_letters, exact_number, mapping_of
from rsym.model.rewriting import in_known_functions
from rsym.model.symbols import as_expression, postorder, real_replacements, real_symbol, substitute, symbols_of

S = TypeVar("S", bound="Equation")

_NO_NUMBERS = (sp.oo, -sp.oo, sp.zoo, sp.I)


@dataclass(frozen=True, init=False, repr=False)
class Equation:
    """What a shape is given, checked; what can be asked of it and done with it says `Shape`."""

    expression: sp.Expr
    coordinates: tuple[sp.Symbol, ...]
    letters: Letters
    box: BoundingBox | None
    definitions: tuple[tuple[str, sp.Expr], ...] = field(compare=False)
    parts: tuple[tuple[str, sp.Expr], ...] = field(compare=False)

    def __init__(
        self,
        expression: Any,
        coordinates: Any,
        *,
        letters: Mapping[Any, Letter | float] | None = None,
        bounds: Any = None,
        box: BoundingBox | None = None,
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
        store(self, "box", box if bounds is None else stated_box(bounds, len(coordinates)))
        store(self, "definitions", definitions)
        parts = tuple((name, in_known_functions(part)) for name, part in parts)
        store(self, "parts", tuple((name, moved_part(part, real) if real else part) for name, part in parts))
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

    @property
    def bounds(self) -> Bounds | None:
        """The window that was stated, ((xmin, xmax), (ymin, ymax)[, (zmin, zmax)]), to the nearest floats; else None.

        Without it one looks at the whole boundary, in bounds that are proved at the values of the letters: `extent`.

        Examples
        --------
        >>> import rsym
        >>> rsym.disc(1).bounds, rsym.disc(1).replace(bounds=((-2, 2), (0, 2))).bounds
        (None, ((-2.0, 2.0), (0.0, 2.0)))
        """
        return None if self.box is None or self.box.exact is None else self.box.ends

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
        known = self.letters if letters is None else as_letters(letters)
        box = self.box if bounds is None else stated_box(bounds, self.dimension)
        if box is not None and box.exact is None:  # it was that of the expression and of the letters before
            moved = any(name in known and known[name].default != old.default for name, old in self.letters.items())
            box = None if moved else box if expression is None else box.likely
        return replace(
            self,
            expression=self.expression if expression is None else expression,
            letters=known,
            box=box,
            definitions=self.definitions if expression is None else (),
        )


def substituted(
    shape: S,
    places: Mapping[sp.Symbol, sp.Expr],
    *,
    coordinates: tuple[sp.Symbol, ...] | None = None,
    factor: Any = 1,
    letters: Mapping[Any, Letter | float] | None = None,
    box: BoundingBox | None = None,
) -> S:
    """Factor * omega(places), parts alike; letters are added to those of the shape, the box is the new one.

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
    expression = factor * substitute(shape.expression, places)
    return replace(
        shape,
        expression=expression,
        coordinates=coordinates,
        letters=shape.letters.merge(letters),
        box=box,
        definitions=(),
        parts=tuple(
            (name, expression if part == shape.expression else moved_part(part, places, factor))
            for name, part in shape.parts
        ),
    )


def moved_part(part: sp.Expr, places: Mapping[sp.Symbol, sp.Expr], factor: sp.Expr = sp.S.One) -> sp.Expr:
    """Factor * part(places), which stays found in the formula of the shape that is moved so.

    SymPy multiplies a sum out by a number, floats round then, and inside of the formula nothing is multiplied out. So
    the number stays before the sum.

    Examples
    --------
    >>> from rsym import x
    >>> moved_part(x - 0.1, {x: x - 0.5}, sp.Integer(3))
    3*(x - 0.6)
    """
    kept = part.is_Mul and len(part.args) == 2 and part.args[0].is_Number and part.args[1].is_Add
    times, inner = part.args if kept else (sp.S.One, part)
    moved, times = substitute(inner, places), times * factor
    if times.is_Number and times != 1 and moved.is_Add:
        return sp.Mul(times, moved, evaluate=False)
    return times * moved


def with_exact_letters(shape: S, letters: Mapping[Any, Any] | None) -> tuple[S, dict[str, Any]]:
    """The shape with the numbers that are no fractions in the place of their letters, and the changes of the others.

    Examples
    --------
    >>> import rsym
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> a, b = sp.symbols("a b", real=True)
    >>> made, changes = with_exact_letters(rsym.Shape(a * x - b * y, (x, y), letters={a: 1, b: sp.pi}), {b: sp.sqrt(2)})
    >>> made.expression, made.letters, changes
    (a*x - sqrt(2)*y, Letters({'a': 1}), {})
    """
    changes = {str(key): value for key, value in mapping_of(letters).items()}
    shape.letters.values_with({key: value for key, value in changes.items() if not isinstance(value, tuple | list)})
    given = {name: letter.default for name, letter in shape.letters.items()} | changes
    exact = {name: value for name, value in given.items() if isinstance(value, sp.Expr)}
    exact = {name: value for name, value in exact.items() if isinstance(exact_number(value, name), sp.Expr)}
    if not exact:
        return shape, changes
    moved = shape.with_letters(exact)
    places = {real_symbol(name): value for name, value in exact.items()}
    kept = Letters({name: letter for name, letter in moved.letters.items() if name not in exact})
    parts = tuple((name, moved_part(part, places)) for name, part in moved.parts)
    made = replace(
        moved, expression=substitute(moved.expression, places), letters=kept, definitions=(), box=moved.box, parts=parts
    )
    return made, {name: value for name, value in changes.items() if name not in exact}


def combine(
    function: Callable[..., sp.Expr],
    *operands: Any,
    box: Callable[[Sequence[BoundingBox | None]], BoundingBox | None] = around,
) -> Any:
    """Apply a function of expressions to shapes: same coordinates, letters and parts merged, the box made of theirs.

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
        box=box([operand.box if isinstance(operand, Equation) else None for operand in operands]),
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
