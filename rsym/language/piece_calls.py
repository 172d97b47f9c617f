"""Calls of pieces: the arguments of a model file given to the functions of Python, in Python's coordinates."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.language.parts import Built
from rsym.language.pieces import PIECES, Piece
from rsym.language.syntax import Call
from rsym.model.letters import Letter
from rsym.model.nodes import RealNode
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol, x, y, z
from rsym.model.systems import RSystem
from rsym.model.traversal import substitute, symbols_of


@dataclass(frozen=True)
class Calls:
    """What all calls of one model share."""

    coordinates: tuple[str, ...]
    letters: Mapping[str, Letter]
    system: RSystem

    def __call__(self, node: Call, parts: list[Built]) -> sp.Expr:
        """The formula that a piece makes.

        Raises
        ------
        RsymError
            For arguments that do not fit, at the place of the call.
        """
        piece = PIECES[node.function]
        given = [self._argument(part) for part in parts]
        first = len(given) - len(node.keywords)
        bound = _bound(piece, node, given[:first], dict(zip(node.keywords, given[first:], strict=True)))
        _check_switches(piece, node, bound)
        _check_counts(piece, node, bound)
        try:
            made = self._made(piece, bound)
        except RsymError as error:
            raise node.place.refuse(f"{node.function}: {error.message}", error.code, error.remedy) from None
        except (TypeError, ValueError, AttributeError, ArithmeticError) as error:
            raise node.place.refuse(
                f"{node.function} cannot be made of these arguments: {error}", "arity", _takes(piece)
            ) from None
        if isinstance(made, Shape) and made.dimension > len(self.coordinates):
            raise node.place.refuse(
                f"{node.function} makes a body, but the model is one of the plane", "coordinates", "coordinates x y z"
            )
        expression = made.expression if isinstance(made, Shape) else made
        expression = substitute(expression, self._names(back=True))
        return expression

    def _made(self, piece: Piece, bound: inspect.BoundArguments) -> Shape | sp.Expr:
        """The shape; formulas without the third coordinate may be plane shapes, if they do not fit as bodies."""
        rest, named = _given(piece, bound)
        shared, letters = self._shared(piece), self._own_letters()

        def made(dimension: int) -> Shape | sp.Expr:
            shapes = [Shape(value, (x, y, z)[:dimension], letters=letters) for value in bound.args[: piece.shapes]]
            result: Shape | sp.Expr = piece.function(*shapes, *rest, **named, **shared)
            return result

        whole = 2 if piece.plane else len(self.coordinates)
        try:
            return made(whole)
        except RsymError:
            if whole == 2 or not piece.shapes or z in symbols_of(*bound.args[: piece.shapes]):
                raise
        return made(2)

    def _names(self, back: bool = False) -> dict[sp.Symbol, sp.Symbol]:
        """Python's coordinates for those of the model, or the other way round."""
        pairs = [*zip(self.coordinates, "xyz", strict=False), *((name, _apart(name)) for name in self.letters)]
        names = ((there, here) if back else (here, there) for here, there in pairs if here != there)
        return {real_symbol(old): real_symbol(new) for old, new in names}

    def _argument(self, part: Built) -> Any:
        if part.text is not None:
            return part.text
        if part.items is not None:
            return tuple(map(self._argument, part.items))
        if part.exact is None and part.number is not None:
            return _turn(part.expression) or part.outer
        if part.exact is not None and part.exact.denominator == 1:
            return int(part.exact)
        return substitute(part.expression, self._names())

    def _shared(self, piece: Piece) -> dict[str, Any]:
        shared = {"letters": self._own_letters(), "system": self.system}
        return {name: value for name, value in shared.items() if piece.takes(name)}

    def _own_letters(self) -> dict[str, Letter]:
        return {_apart(name): letter for name, letter in self.letters.items()}


def _apart(letter: str) -> str:
    """The name of a letter; one called x, y or z in a model of other coordinates must not become a coordinate."""
    return f"{letter} (letter)" if letter in ("x", "y", "z") else letter


def _bound(piece: Piece, node: Call, given: list[Any], named: dict[str, Any]) -> inspect.BoundArguments:
    twice = [name for k, name in enumerate(node.keywords) if name in node.keywords[:k]]
    if twice:
        raise node.place.refuse(f"{node.function}: {twice[0]} is given twice", "arity", "remove one of the two")
    try:
        return piece.signature.bind(*given, **named)
    except TypeError as error:
        raise node.place.refuse(f"{node.function}: {error}", "arity", _takes(piece)) from None


def _check_switches(piece: Piece, node: Call, bound: inspect.BoundArguments) -> None:
    """Refuse what Python would take for true, such as "no"."""
    for name, value in bound.arguments.items():
        switch = piece.signature.parameters[name].annotation in (bool, "bool")
        if switch and not (isinstance(value, int) and value in (0, 1)):
            raise node.place.refuse(f"{node.function}: {name} must be 0 or 1, got {value}", "switch", "1 means yes")


def _check_counts(piece: Piece, node: Call, bound: inspect.BoundArguments) -> None:
    """Refuse what would make a formula without end."""
    for name, most in piece.most.items():
        given = bound.arguments.get(name)
        for count in given if isinstance(given, tuple) else (given,):
            if isinstance(count, int) and count > most:
                remedy = "take less, or build this shape in Python"
                raise node.place.refuse(f"{node.function}: {name} is {count}; {most} is the most", "too-large", remedy)


def _given(piece: Piece, bound: inspect.BoundArguments) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """What follows the shapes, by name where it has one: the model's own arguments may stand between."""
    kinds = {parameter.kind for parameter in piece.signature.parameters.values()}
    if inspect.Parameter.VAR_POSITIONAL in kinds:
        return bound.args[piece.shapes :], bound.kwargs
    names = list(piece.signature.parameters)[piece.shapes :]
    return (), {name: bound.arguments[name] for name in names if name in bound.arguments}


def _takes(piece: Piece) -> str:
    """The parameters, for a message."""
    parameters = piece.signature.parameters.values()
    return f"it takes {', '.join(str(one.replace(annotation=one.empty)) for one in parameters)}"


def _turn(expression: sp.Expr) -> sp.Expr | None:
    """A rational multiple of pi, of which SymPy knows sine and cosine; None for any other constant."""
    if not all(part.is_Rational or part is sp.pi for part in sp.preorder_traversal(expression) if not part.args):
        return None
    if not all(part.is_Add or part.is_Mul or (part.is_Pow and part.exp == -1) for part in _inner(expression)):
        return None
    value = expression.doit()
    return value if (value / sp.pi).is_Rational else None


def _inner(expression: sp.Expr) -> list[sp.Basic]:
    return [part for part in sp.preorder_traversal(expression) if part.args]


class NamedArgument(RealNode):
    """An argument by name, to be shown."""

    def _sympystr(self, printer: Any) -> str:
        return f"{printer._print(self.args[0])} = {printer._print(self.args[1])}"

    def _latex(self, printer: Any) -> str:
        return rf"\mathrm{{{self.args[0].name}}} = {printer._print(self.args[1])}"


def shown_call(node: Call, parts: list[Built]) -> sp.Expr:
    """The call as a function without meaning, for formulas in which names stand for one another."""
    first = len(parts) - len(node.keywords)
    named = [
        NamedArgument(sp.Symbol(name), part.outer) for name, part in zip(node.keywords, parts[first:], strict=True)
    ]
    return sp.Function(node.function, real=True)(*(part.outer for part in parts[:first]), *named)
