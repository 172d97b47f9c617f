"""Programs as statements of other languages: a row for each language, beside the texts of the operations.

Only numbered names stand in a text: c0 for a coordinate, u3 for what is the same for all points, v3 for what is not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from rsym.errors import RsymError
from rsym.program.operations import OPERATIONS
from rsym.program.program import Program, constant_value


@dataclass(frozen=True)
class Language:
    """One language.

    Attributes
    ----------
    suffix : str
        What names of files end in.
    statement : str
        Gives a ``{name}`` the value ``{text}``.
    coordinate, letter : str
        The place of an input, for its number ``{k}``, or ``{k1}`` counted from 1.
    number : callable
        A finite number that is not negative, as it is written.
    nan, infinity : str
        What is no such number.
    comment : tuple of str
        What opens a comment of several lines, what begins each line, and what ends it.
    head, store, foot : tuple of str, str, tuple of str
        The lines that begin the function, up to the statements that are the same for all points; the statement that
        puts a ``{value}`` in its place; the lines that end it. ``{inputs}``, ``{outputs}`` and ``{parameters}`` are
        lists of what a function takes, its ``{parameters}`` all of them.
    loop : tuple of str
        The lines that begin the loop over points; where there are none, arrays are computed with or one point is.
    margin : int
        By how many blanks the statements outside of the loop are moved in, and those inside once more.
    input, output, size : str
        How a coordinate, an output and what else is needed are declared, of a parameter `letters` that is `given`.
    notes : tuple of str
        What to know before it is compiled or called.
    functions : mapping of str to str
        What stands above or below, by name, where a statement calls it.
    below : bool
        Whether these functions stand below.
    """

    suffix: str
    statement: str
    coordinate: str
    letter: str
    head: tuple[str, ...]
    store: str
    foot: tuple[str, ...]
    input: str
    output: str
    given: str
    size: str = ""
    loop: tuple[str, ...] = ()
    margin: int = 4
    number: Callable[[float], str] = repr
    nan: str = "NaN"
    infinity: str = "Infinity"
    comment: tuple[str, str, str] = ("", "// ", "")
    notes: tuple[str, ...] = ()
    functions: Mapping[str, str] = field(default_factory=dict)
    below: bool = False

    def literal(self, value: float) -> str:
        """A number; in parentheses if it has a sign."""
        if math.isnan(value):
            return self.nan
        text = self.infinity if math.isinf(value) else self.number(abs(value))
        return text if math.copysign(1, value) > 0 else f"(-{text})"


class Statements(NamedTuple):
    """What is computed once, what is computed for each point, and the name or number of each node."""

    uniform: list[str]
    varying: list[str]
    names: list[str]


def statements(
    program: Program,
    language: str,
    *,
    inputs: Mapping[str, str] | None = None,
    known: Mapping[int, str | float] | None = None,
) -> Statements:
    """The statements that compute the nodes of an expanded program, in order.

    Parameters
    ----------
    program : Program
        Of primitive operations.
    language : str
        A name of `LANGUAGES`.
    inputs : mapping of str to str, optional
        Texts for inputs by name; the others stand in the places that the language's row gives.
    known : mapping of int to str or float, optional
        Nodes that need no statement: names that hold them already, or their numbers. What only they need is
        left out.

    Raises
    ------
    RsymError
        For an operation that the language lacks.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.program.expansion import expand
    >>> from rsym.program.fields import program_of
    >>> program = expand(program_of(rsym.Shape(x * y - 1, (x, y)), ["value"]))
    >>> statements(program, "glsl", inputs={"x": "p.x", "y": "p.y"}).varying
    ['float v1 = p.x;', 'float v2 = p.y;', 'float v3 = v1 * v2;', 'float v4 = (-1.0) + v3;']
    >>> statements(program, "javascript", known={3: "w"}).varying
    ['const v4 = (-1.0) + w;']
    """
    row, given, known = LANGUAGES[language], inputs or {}, known or {}
    needed = _needed(program, known)
    result = Statements([], [], [])
    for number, node in enumerate(program.nodes):
        name = known.get(number)
        if name is None and node.operation in ("const", "undefined"):
            name = math.nan if node.operation == "undefined" else constant_value(node.data)
        if name is not None or number not in needed:
            result.names.append(name if isinstance(name, str) else "" if name is None else row.literal(name))
            continue
        if node.operation == "input":
            text = given.get(str(node.data)) or _place(row, program, str(node.data))
        else:
            text = text_of(node.operation, language).format(*(result.names[argument] for argument in node.arguments))
        block, letter = (result.uniform, "u") if program.uniform[number] else (result.varying, "v")
        result.names.append(f"{letter}{number}")
        block.append(row.statement.format(name=result.names[-1], text=text))
    return result


def frontier(program: Program) -> list[int]:
    """The nodes that are the same for all points, and are used where something is not, or are outputs; no constants.

    Examples
    --------
    >>> from rsym.program.program import Node
    >>> nodes = (Node("input", (), "x"), Node("input", (), "a"), Node("neg", (1,)), Node("mul", (0, 2)))
    >>> frontier(Program(nodes, ("x",), ("a",), (("value", 3),)))
    [2]
    """
    used = {number for _, number in program.outputs}
    for number, node in enumerate(program.nodes):
        if not program.uniform[number]:
            used.update(node.arguments)
    constant = ("const", "undefined")
    return sorted(n for n in used if program.uniform[n] and program.nodes[n].operation not in constant)


def text_of(operation: str, language: str) -> str:
    """How an operation is written."""
    text = OPERATIONS[operation].texts.get(language)
    if text is None:
        raise RsymError(
            f"the language {language!r} has no {operation!r}",
            code="language",
            remedy="choose another language, or a formula without it",
        )
    return text


def _needed(program: Program, known: Mapping[int, str | float]) -> set[int]:
    seen: set[int] = set()
    stack = [number for _, number in program.outputs]
    while stack:
        number = stack.pop()
        if number not in seen and number not in known:
            seen.add(number)
            stack.extend(program.nodes[number].arguments)
    return seen


def _place(row: Language, program: Program, name: str) -> str:
    if name in program.coordinates:
        k = program.coordinates.index(name)
        return row.coordinate.format(k=k, k1=k + 1, axis="xyz"[min(k, 2)])
    k = program.letters.index(name)
    return row.letter.format(k=k, k1=k + 1)


def _single(value: float) -> str:
    """A number of GLSL, which has 32 bits; what they cannot hold is the largest of them."""
    return repr(float(str(np.float32(min(value, np.finfo(np.float32).max)))))


LANGUAGES: dict[str, Language] = {
    "javascript": Language(
        suffix=".mjs",
        statement="const {name} = {text};",
        coordinate="c{k}[i]",
        letter="letters[{k}]",
        head=("export function rsym_kernel({parameters}) {{",),
        loop=("    for (let i = 0; i < out0.length; ++i) {{",),
        store="out{k}[i] = {value};",
        foot=("    }}", "}}"),
        input="c{k}",
        output="out{k}",
        given="letters",
    ),
    "glsl": Language(
        suffix=".glsl",
        statement="float {name} = {text};",
        coordinate="point.{axis}",
        letter="letters[{k}]",
        number=_single,
        nan="uintBitsToFloat(0x7fc00000u)",
        infinity="uintBitsToFloat(0x7f800000u)",
        head=("void rsym_kernel({parameters}) {{",),
        store="out{k} = {value};",
        foot=("}}",),
        input="",
        output="out float out{k}",
        given="uniform float letters[{count}];",
    ),
}
