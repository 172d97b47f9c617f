"""A sign form along rays: a sequence of calls of image functions, for a processor and for a page alike.

Each operation of the leaves, not expanded, is one call. What a call does is a small program of its own in the
`library`: printed once in some language it is a function of models (four numbers) and numbers that gives a model. So
the text of a form stays short, and compiles fast. What depends on letters alone is a program of its own, computed once
in float64.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

import numpy as np

from rsym.arrays import Floats
from rsym.backends.interpreter import interpret
from rsym.bounds.box_images import Definedness, is_decisive
from rsym.bounds.ray_images import IMAGES
from rsym.bounds.ray_models import RayArithmetic, RayModel
from rsym.bounds.relations import relation
from rsym.logic.gates import Gate
from rsym.logic.sign_form import SignForm
from rsym.program.builder import Builder
from rsym.program.expansion import expand
from rsym.program.operations import OPERATIONS
from rsym.program.program import FLOAT64, Data, Node, Precision, Program, live
from rsym.program.row import SELF

MODEL, LINE, NUMBER = "model", "line", "number"
PARTS = RayModel._fields


class RayValue(NamedTuple):
    """The model of this number (the coordinates, then the calls in order), or the uniform number of this number."""

    kind: str
    number: int


class RayCall(NamedTuple):
    """A function of the library, and what it is called with."""

    function: str
    arguments: tuple[RayValue, ...]


@dataclass(frozen=True)
class RayFunction:
    """An image function.

    Attributes
    ----------
    name : str
        An identifier.
    parameters : tuple of str
        "model", "line" or "number", in order; a line is a model without its quadratic part, which is 0.
    program : Program
        Expanded. Its coordinates are `inputs`, its outputs ``low``, ``high``, ``linear``, ``quadratic``.
    """

    name: str
    parameters: tuple[str, ...]
    program: Program

    @property
    def inputs(self) -> tuple[str, ...]:
        """The names of the numbers that it takes: ``a_low`` to ``a_quadratic`` of a model, ``b`` of a number."""
        return tuple(name for k, kind in enumerate(self.parameters) for name in input_names(k, kind))

    @property
    def gives_line(self) -> bool:
        """Whether the quadratic part of what it gives is 0."""
        return self.program.nodes[dict(self.program.outputs)["quadratic"]] == Node("const", (), Fraction(0))


def input_names(place: int, kind: str) -> tuple[str, ...]:
    """The inputs of a parameter.

    Examples
    --------
    >>> input_names(0, "model"), input_names(1, "number")
    (('a_low', 'a_high', 'a_linear', 'a_quadratic'), ('b',))
    """
    letter = "abcdefgh"[place]
    return (letter,) if kind == NUMBER else tuple(f"{letter}_{part}" for part in PARTS[: 3 if kind == LINE else 4])


@dataclass(frozen=True)
class RayForm:
    """The models of a sign form along a segment of a ray.

    Attributes
    ----------
    coordinates : tuple of str
        Their models are numbers 0, 1, 2.
    calls : tuple of RayCall
        Call k makes the model with the number 3 + k.
    leaves : tuple of RayValue
        The leaves of the sign form, in its order.
    gates : tuple of Gate
        As in the sign form; the functions are ``min`` and ``max`` of the library.
    uniforms : Program
        Letters to what calls need of them, expanded; output ``k`` is the uniform number k.
    library : mapping of str to RayFunction
        What is called.
    precision : Precision
        The one that the library rounds for.
    guards : int
        How many of the last leaves are none of the sign form, but what must not be negative for it to have a value.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import shape_form
    >>> form = ray_form(shape_form(rsym.Shape(1 - x**2 - 2 * y, (x, y, z))))
    >>> for call in form.calls:
    ...     print(call.function, *(f"{kind} {number}" for kind, number in call.arguments))
    square model 0
    neg model 3
    mul_number model 1 number 0
    add_number model 4 number 1
    add model 5 model 6
    """

    coordinates: tuple[str, ...]
    calls: tuple[RayCall, ...]
    leaves: tuple[RayValue, ...]
    gates: tuple[Gate, ...]
    uniforms: Program
    library: Mapping[str, RayFunction]
    precision: Precision = FLOAT64
    guards: int = 0

    def uniform_values(self, letters: Mapping[str, float]) -> Floats:
        """The uniform numbers for letters, in float64."""
        found = interpret(self.uniforms, dict(letters))
        return np.array([float(found[name]) for name, _ in self.uniforms.outputs])

    @cached_property
    def literals(self) -> Mapping[int, Data]:
        """The uniform numbers that are constants: a printer may write these out."""
        nodes = self.uniforms.nodes
        return {
            k: nodes[number].data
            for k, (_, number) in enumerate(self.uniforms.outputs)
            if nodes[number].operation == "const"
        }


def ray_form(form: SignForm, precision: Precision = FLOAT64, *, lines: bool = False, guards: bool = False) -> RayForm:
    """The models of a sign form.

    With `lines` what is linear along rays has functions of its own, which do less. With `guards` the form is negative
    where it has no value: where something under a root or a logarithm is.
    """
    if not guards:
        return _Calls(form, precision, lines).form()
    whole = guarded(form)
    made = _Calls(whole, precision, lines).form()
    return replace(made, guards=len(whole.leaves) - len(form.leaves))


def guarded(form: SignForm) -> SignForm:
    """The form and, as more leaves, what must not be negative for its leaves to have a value.

    Examples
    --------
    >>> import sympy as sp, rsym
    >>> from rsym import x, y, z
    >>> from rsym.logic.sign_form import SignForm, shape_builder
    >>> from rsym.program.lowering import lower
    >>> shape = rsym.Shape(sp.sqrt(1 - x) - sp.sqrt(1 + y**2), (x, y, z))
    >>> builder = shape_builder(shape)
    >>> guarded(SignForm(builder, (lower(builder, shape.expression),), ())).gates
    (Gate(operation='min', first=0, second=1),)
    """
    b, count = form.builder, len(form.leaves)
    found: dict[int, None] = {}
    seen: set[int] = set()
    stack = list(form.leaves)
    while stack:
        number = stack.pop()
        node = b.nodes[number]
        row = OPERATIONS[node.operation]
        # Only what is undefined wherever an argument is passes that on.
        if number in seen or b.uniform[number] or not row.strict:
            continue
        seen.add(number)
        stack.extend(node.arguments)
        for clause in row.domain:
            (kind, place), *others = clause or (("", SELF),)
            if kind in {"nonnegative", "positive"} and place >= 0 and not others:
                argument = node.arguments[place]
                if not b.nonnegative[argument] and not b.uniform[argument]:
                    found[argument] = None
    gates = [Gate(op, *(a + len(found) * (a >= count) for a in operands)) for op, *operands in form.gates]
    last = count + len(found) + len(gates) - 1 if gates else 0
    for k in range(len(found)):
        gates.append(Gate("min", last, count + k))
        last = count + len(found) + len(gates) - 1
    return replace(form, leaves=(*form.leaves, *found), gates=tuple(gates))


# Operations whose last operand is a parameter: as a constant it is part of the function.
_PARAMETERS = {"pow", "absolute_power", "signed_power"}


class _Calls:
    def __init__(self, form: SignForm, precision: Precision, lines: bool) -> None:
        self.source, self.precision, self.lines = form, precision, lines
        self.straight: set[int] = set(range(len(form.builder.coordinates)))  # models without a quadratic part
        self.b = form.builder
        self.values: dict[int, RayValue] = {}
        self.calls: list[RayCall] = []
        self.made: dict[RayCall, RayValue] = {}
        self.library: dict[str, RayFunction] = {}
        self.functions: dict[tuple[str, tuple[str, ...], Fraction | None, Data], RayFunction] = {}
        self.uniforms: dict[int, int] = {}
        self.definedness = Definedness(tuple(self.b.nodes), self.b.nonnegative)

    def form(self) -> RayForm:
        names = self.b.coordinates
        nodes = live(self.b.nodes, self.source.leaves)
        inputs = {str(self.b.nodes[n].data): n for n in nodes if self.b.nodes[n].operation == "input"}
        self.values = {inputs[name]: RayValue(MODEL, k) for k, name in enumerate(names) if name in inputs}
        for number in nodes:
            if number not in self.values and not self.b.uniform[number]:
                self.values[number] = self._varying(number)
        leaves = tuple(self._value(leaf) for leaf in self.source.leaves)
        for gate in ("min", "max"):
            self._function(gate, (MODEL, MODEL))
        outputs = {f"{k}": number for number, k in self.uniforms.items()}
        uniforms = expand(self.b.program(outputs))
        return RayForm(names, tuple(self.calls), leaves, self.source.gates, uniforms, self.library, self.precision)

    def _value(self, number: int) -> RayValue:
        if self.b.uniform[number]:
            return RayValue(NUMBER, self.uniforms.setdefault(number, len(self.uniforms)))
        return self.values[number]

    def _varying(self, number: int) -> RayValue:
        node = self.b.nodes[number]
        if node.operation == "select":
            never = [self.b.nodes[argument].operation == "undefined" for argument in node.arguments]
            if never[2] or never[3]:
                return self._value(node.arguments[3 if never[2] else 2])
            name = "select" if is_decisive(self.definedness, node) else "select_cautious"
            return self._call(name, node.arguments)
        name, arguments = relation(self.b.nodes, number) or (node.operation, node.arguments)
        if name == "direction":
            return self._call("sign", arguments)
        if name == "square" and self.b.nodes[arguments[0]].operation == "atan2":  # even, so without a cut
            u, v = (self._value(argument) for argument in self.b.nodes[arguments[0]].arguments)
            if u.kind == MODEL:
                return self._called("square", [self._called("atan2", [self._called("abs", [u]), v])])
        if name == "share":  # f/sqrt(f**2 + g**2)
            f, g = (self._value(argument) for argument in arguments)
            return self._called("normalised", [f, self._called("square", [g])])
        if name == "div" and self.b.uniform[arguments[0]]:
            inverse = self._call("inverse", arguments[1:])
            top = self.b.value(arguments[0])
            return inverse if top == 1 else self._called("mul", [inverse, self._value(arguments[0])])
        return self._call(name, arguments, node.data)

    def _call(self, name: str, arguments: Sequence[int], data: Data = None) -> RayValue:
        operands: list[RayValue | Fraction] = [self._value(argument) for argument in arguments]
        constant = self.b.value(arguments[-1])
        if constant is not None and (name in _PARAMETERS or len(arguments) == 3):
            operands[-1] = constant
        return self._called(name, operands, data)

    def _called(self, name: str, operands: Sequence[RayValue | Fraction], data: Data = None) -> RayValue:
        given = [operand for operand in operands if isinstance(operand, RayValue)]
        if name in {"add", "mul", "min", "max"}:
            given.sort(key=lambda value: value.kind)  # models first
        kinds = tuple(LINE if self._is_line(value) else value.kind for value in given)
        constant = next((operand for operand in operands if isinstance(operand, Fraction)), None)
        call = RayCall(self._function(name, kinds, constant, data), tuple(given))
        if call not in self.made:
            self.calls.append(call)
            made = self.made[call] = RayValue(MODEL, len(self.b.coordinates) + len(self.calls) - 1)
            if self.library[call.function].gives_line:
                self.straight.add(made.number)
        return self.made[call]

    def _is_line(self, value: RayValue) -> bool:
        return self.lines and value.kind == MODEL and value.number in self.straight

    def _function(
        self, operation: str, kinds: tuple[str, ...], constant: Fraction | None = None, data: Data = None
    ) -> str:
        key = (operation, kinds, constant, data)
        if key not in self.functions:
            function = self.functions[key] = image_function(*key, self.precision)
            self.library[function.name] = function
        return self.functions[key].name


def image_function(
    operation: str,
    kinds: tuple[str, ...],
    constant: Fraction | None = None,
    data: Data = None,
    precision: Precision = FLOAT64,
) -> RayFunction:
    """The image of an operation whose operands are models or numbers, the last one maybe a constant.

    Examples
    --------
    >>> image_function("pow", ("model",), Fraction(3, 2)).name, image_function("powi", ("model",), data=3).name
    ('pow_3over2', 'powi_3')
    """
    words = [operation]
    if {NUMBER, LINE} & set(kinds):
        words += [NUMBER] if kinds == (MODEL, NUMBER) else kinds
    words += [_word(part) for part in ([] if constant is None else [constant])]
    words += [_word(part) for part in (data if isinstance(data, tuple) else (data,)) if isinstance(part, int)]
    inputs = [input_names(k, kind) for k, kind in enumerate(kinds)]
    b = Builder(tuple(name for names in inputs for name in names), ())
    arithmetic = RayArithmetic(b, precision)
    operands = [
        arithmetic.number(b.input(names[0])) if kind == NUMBER else RayModel(*parts_of(b, names))
        for kind, names in zip(kinds, inputs, strict=True)
    ]
    if constant is not None:
        operands.append(arithmetic.constant(constant))
    node = Node(operation, tuple(range(len(operands))), data)
    program = b.program(IMAGES[operation](arithmetic, node, operands)._asdict())
    return RayFunction("_".join(words), kinds, _defined(expand(program)))


def parts_of(b: Builder, names: Sequence[str]) -> list[int]:
    """The four numbers of a model, the quadratic one 0 where it has no name."""
    return [*map(b.input, names), *[b.const(0)] * (len(PARTS) - len(names))]


def _defined(program: Program) -> Program:
    """Without the checks of parameters, which are legal once a form has its letters."""
    b = Builder(program.coordinates, program.letters)
    known: list[int] = []
    for operation, arguments, data in program.nodes:
        inner = tuple(known[argument] for argument in arguments)
        never = [b.nodes[argument].operation == "undefined" for argument in inner]
        if operation == "select" and (never[2] or never[3]):
            known.append(inner[3 if never[2] else 2])
        else:
            known.append(b.make(operation, *inner, data=data))
    return b.program({name: known[number] for name, number in program.outputs})


def _word(number: Fraction | int) -> str:
    """A rational number in an identifier."""
    return str(number).replace("-", "minus").replace("/", "over")
