"""The pieces of shapes that a model file may call: the functions of Python themselves, a row for each, and their calls.

Whatever is told of pieces follows from here: calls in the language, the names of `rsym` and of `rsym.primitives`,
the table of the README (`python tests/stubs.py` writes these three). So a new primitive is its function, with its
docstring, in a module of `model/primitives`, and its name in a row below.
"""

from __future__ import annotations

import inspect
import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from operator import attrgetter
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.language.building import Built
from rsym.language.functions import named_system
from rsym.language.syntax import Call
from rsym.model.equation import moved_part
from rsym.model.letters import Letter
from rsym.model.named_parts import Inside
from rsym.model.nodes import RealNode
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol, substitute, symbols_of, x, y, z
from rsym.model.systems import RSystem

# What a formula grows with.
_MOST = {**dict.fromkeys(("order", "sides", "count", "counts", "starts"), 400), "terms": 100}
# Given by the model as a whole, not by a call.
_FROM_THE_MODEL = ("letters", "bounds", "coordinates")
_ANY_NUMBER = ("polyline", "graph")  # whose order need not be a whole number, so that it may be a letter


@dataclass(frozen=True)
class PieceRow:
    """A function that makes a shape, or an expression.

    home: its module in the package, where `Shape` stands for methods. family: what it is listed under.
    shapes: how many of its first arguments are shapes. plane: whether those are plane shapes even in a model of space.
    space: whether what it makes is in space. most: the largest number of what is counted by a parameter.
    """

    name: str
    home: str
    family: str
    shapes: int = 0
    plane: bool = False
    space: bool = False
    most: Mapping[str, int] = field(default_factory=lambda: _MOST)

    @property
    def is_method(self) -> bool:
        """Whether it is a method of `Shape`."""
        return self.home == "model.shape"

    @property
    def is_primitive(self) -> bool:
        """Whether it makes a shape of numbers, or of an expression: a name of `rsym.primitives`."""
        return self.home.startswith("model.primitives.") or self.name == "implicit"

    @property
    def function(self) -> Callable[..., Any]:
        """The function as its module has it now, imported when it is first called: the facade may put another there."""
        path = f"Shape.{self.name}" if self.is_method else self.name
        found: Callable[..., Any] = attrgetter(path)(import_module(f"rsym.{self.home}"))
        return found

    @cached_property
    def signature(self) -> inspect.Signature:
        """The parameters that a call in a model may give."""
        whole = inspect.signature(self.function)
        kept = [
            parameter.replace(name="shape") if name == "self" else parameter
            for name, parameter in whole.parameters.items()
            if name not in _FROM_THE_MODEL
        ]
        return whole.replace(parameters=kept)

    def takes(self, name: str) -> bool:
        """Whether the function has this parameter."""
        return name in inspect.signature(self.function).parameters


def _row(family: str, home: str, names: str, **more: Any) -> Iterator[tuple[str, PieceRow]]:
    return ((name, PieceRow(name, home, family, **more)) for name in names.split())


_PLANE, _CURVES, _SPACE = "in the plane", "curves, zero on them", "in space"
_PERIODIC, _ANY, _MOVED = "along a screw, in all directions", "any expression", "moved"
_SWEPT, _REPEATED, _BLENDED = "of another dimension or thickness", "repeated", "blended"
# Families and homes may stand in several rows; a piece stands in one.
PIECES: Mapping[str, PieceRow] = dict(
    (
        *_row(_PLANE, "model.primitives.plane", "half_plane strip line disc ellipse superellipse rectangle"),
        *_row(_PLANE, "model.primitives.polygons", "polygon regular_polygon"),
        *_row(_CURVES, "model.primitives.curves", "segment polyline graph"),
        *_row(_CURVES, "model.primitives.curves", "circle arc"),
        *_row(_CURVES, "model.primitives.curves", "helix", space=True),
        *_row(_CURVES, "model.primitives.curves", "space_curve", shapes=2, space=True),
        *_row(_SPACE, "model.primitives.space", "half_space slab sphere box cylinder capsule", space=True),
        *_row(_SPACE, "model.primitives.space", "cone frustum nappe double_cone", space=True),
        *_row(_SPACE, "model.primitives.quadrics", "ellipsoid torus", space=True),
        *_row(_SPACE, "model.primitives.quadrics", "quadric"),
        *_row(_PERIODIC, "model.primitives.helical", "helicoid helix_tube", space=True),
        *_row(_PERIODIC, "model.symmetry.screws", "coil", space=True),
        *_row(_PERIODIC, "model.primitives.periodic", "gyroid schwarz_p schwarz_d neovius lidinoid", space=True),
        *_row(_ANY, "analysis.normalisation", "implicit", shapes=1),
        # To order 3 a hundred terms take seconds, a car for ever.
        *_row(_ANY, "analysis.normalisation", "normalise", shapes=1, most={"order": 2}),
        *_row(_MOVED, "model.shape", "translate rotate scale mirror shear", shapes=1),
        *_row(_MOVED, "analysis.transformations", "transform", shapes=1),
        *_row(_SWEPT, "model.constructions", "extrude revolve product sweep", shapes=1, plane=True, space=True),
        *_row(_SWEPT, "model.constructions", "section", shapes=1, space=True),
        *_row(_SWEPT, "model.constructions", "offset shell", shapes=1),
        *_row(_REPEATED, "model.symmetry.cyclic", "cyclic", shapes=1),
        *_row(_REPEATED, "model.symmetry.rows", "row grid", shapes=1),
        *_row(_REPEATED, "model.symmetry.mirrors", "mirrored kaleidoscope mirror_group", shapes=1),
        *_row(_REPEATED, "model.symmetry.screws", "screw", shapes=1, space=True),
        *_row(_REPEATED, "model.symmetry.screws", "wound", shapes=1, plane=True, space=True),
        *_row(_REPEATED, "model.symmetry.waves", "triangle_wave"),
        *_row(_BLENDED, "model.blends.fillets", "fillet", shapes=2),
        *_row(_BLENDED, "model.blends.displacement", "displacement_blend", shapes=2),
        *_row(_BLENDED, "model.blends.displacement", "bounded_blend", shapes=3),
        *_row(_BLENDED, "model.skeletons", "blend_on_skeleton", shapes=2),
    )
)
# Those whose mention makes a model one of space.
SPACE = frozenset(name for name, piece in PIECES.items() if piece.space)


@dataclass(frozen=True)
class Calls:
    """What all calls of one model share, and the formulas so far: a call moves those inside of what it moves.

    `named` are their names and themselves, `moved` the same elsewhere, `left` those that were moved from there.
    """

    coordinates: tuple[str, ...]
    letters: Mapping[str, Letter]
    system: RSystem
    named: list[tuple[str, sp.Expr]] = field(default_factory=list)
    moved: list[tuple[str, sp.Expr]] = field(default_factory=list)
    left: set[tuple[str, sp.Expr]] = field(default_factory=set)

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
        self._decide(piece, bound)
        _check_switches(piece, node, bound)
        _check_counts(piece, node, bound)
        try:
            if "system" in bound.arguments:
                bound.arguments["system"] = named_system(bound.arguments["system"], self._known)
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
        return substitute(made.expression if isinstance(made, Shape) else made, self._names(back=True))

    def name(self, name: str, formula: sp.Expr, is_title: bool) -> None:
        """Know a formula; one that a call has moved gets a new name by a title, as `Shape.named` gives it."""
        self.named.append((name, formula))
        if is_title:
            self.moved[:] = [part for part in self.moved if part[1] != formula]

    def kept(self, name: str, inside: Inside) -> list[sp.Expr]:
        """The formulas of a name: moved along, and where they were if that is inside too."""
        return [
            formula
            for title, formula in (*self.named, *self.moved)
            if title == name and ((title, formula) not in self.left or formula in inside)
        ]

    def _renamed(self, parts: Iterable[tuple[str, sp.Expr]], back: bool = False) -> list[tuple[str, sp.Expr]]:
        names = self._names(back)
        return [(name, moved_part(part, names) if names else part) for name, part in parts]

    @property
    def _known(self) -> dict[str, Letter]:
        """The letters as pieces know them."""
        return {_apart(name): letter for name, letter in self.letters.items()}

    def _decide(self, piece: PieceRow, bound: inspect.BoundArguments) -> None:
        """Where a whole number stands, letters count with their defaults: they decide how long the formula is."""
        values = {real_symbol(name): sp.sympify(letter.default) for name, letter in self._known.items()}

        def decided(value: Any) -> Any:
            if isinstance(value, tuple):
                return tuple(map(decided, value))
            found = substitute(value, values) if isinstance(value, sp.Expr) else value
            return int(found) if isinstance(found, sp.Integer) else value

        for name in piece.most if piece.name not in _ANY_NUMBER else ():
            if name in bound.arguments:
                bound.arguments[name] = decided(bound.arguments[name])

    def _made(self, piece: PieceRow, bound: inspect.BoundArguments) -> Shape | sp.Expr:
        """The shape; formulas without the third coordinate may be plane shapes, if they do not fit as bodies."""
        rest, named = _given(piece, bound)
        letters = self._known
        given = {"letters": letters, "system": self.system}
        shared = {name: value for name, value in given.items() if piece.takes(name) and name not in named}

        values = bound.args[: piece.shapes]
        every = self._renamed((*self.named, *self.moved)) if values else []
        inside = [tuple(part for part in every if part[1] in formulas) for formulas in map(Inside, values)]

        def made(dimension: int) -> Shape | sp.Expr:
            shapes = [
                Shape(value, (x, y, z)[:dimension], letters=letters, parts=parts)
                for value, parts in zip(values, inside, strict=True)
            ]
            result: Shape | sp.Expr = piece.function(*shapes, *rest, **named, **shared)
            if isinstance(result, Shape) and any(inside):
                moved = self._renamed(result.parts, back=True)
                self.left.update({*self._renamed(itertools.chain(*inside), back=True)} - {*moved})
                self.moved.extend(part for part in moved if part not in (*self.named, *self.moved))
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


def _apart(letter: str) -> str:
    """The name of a letter; one called x, y or z in a model of other coordinates must not become a coordinate."""
    return f"{letter} (letter)" if letter in ("x", "y", "z") else letter


def _bound(piece: PieceRow, node: Call, given: list[Any], named: dict[str, Any]) -> inspect.BoundArguments:
    twice = [name for k, name in enumerate(node.keywords) if name in node.keywords[:k]]
    if twice:
        raise node.place.refuse(f"{node.function}: {twice[0]} is given twice", "arity", "remove one of the two")
    try:
        return piece.signature.bind(*given, **named)
    except TypeError as error:
        raise node.place.refuse(f"{node.function}: {error}", "arity", _takes(piece)) from None


def _check_switches(piece: PieceRow, node: Call, bound: inspect.BoundArguments) -> None:
    """Refuse what Python would take for true, such as "no"."""
    for name, value in bound.arguments.items():
        switch = piece.signature.parameters[name].annotation in (bool, "bool")
        if switch and not (isinstance(value, int) and value in (0, 1)):
            raise node.place.refuse(f"{node.function}: {name} must be 0 or 1, got {value}", "switch", "1 means yes")


def _check_counts(piece: PieceRow, node: Call, bound: inspect.BoundArguments) -> None:
    """Refuse what would make a formula without end."""
    for name, most in piece.most.items():
        given = bound.arguments.get(name)
        for count in given if isinstance(given, tuple) else (given,):
            if isinstance(count, int) and count > most:
                remedy = "take less, or build this shape in Python"
                raise node.place.refuse(f"{node.function}: {name} is {count}; {most} is the most", "too-large", remedy)


def _given(piece: PieceRow, bound: inspect.BoundArguments) -> tuple[tuple[Any, ...], dict[str, Any]]:
    """What follows the shapes, by name where it has one: the model's own arguments may stand between."""
    kinds = {parameter.kind for parameter in piece.signature.parameters.values()}
    if inspect.Parameter.VAR_POSITIONAL in kinds:
        return bound.args[piece.shapes :], bound.kwargs
    names = list(piece.signature.parameters)[piece.shapes :]
    return (), {name: bound.arguments[name] for name in names if name in bound.arguments}


def _takes(piece: PieceRow) -> str:
    """The parameters, for a message, points and directions as models have them."""
    parameters = (str(one.replace(annotation=one.empty)) for one in piece.signature.parameters.values())
    return f"it takes {', '.join(parameters).translate(str.maketrans('()', '[]'))}"


def _turn(expression: sp.Expr) -> sp.Expr | None:
    """A rational multiple of pi, of which SymPy knows sine and cosine; None for any other constant."""
    if not all(part.is_Rational or part is sp.pi for part in sp.preorder_traversal(expression) if not part.args):
        return None
    inner = [part for part in sp.preorder_traversal(expression) if part.args]
    if not all(part.is_Add or part.is_Mul or (part.is_Pow and part.exp == -1) for part in inner):
        return None
    value = expression.doit()
    return value if (value / sp.pi).is_Rational else None


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
