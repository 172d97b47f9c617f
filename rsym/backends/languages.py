"""Programs as statements of other languages, from the texts of the operations and the row of the language.

Only numbered names stand in a text: c0 for a coordinate, u3 for what is the same for all points, v3 for what is not.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from rsym.backends.dialects import LANGUAGES, Language
from rsym.backends.interpreter import interpret_nodes
from rsym.errors import RsymError
from rsym.program.operations import OPERATIONS
from rsym.program.program import Precision, Program, constant_value


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
    precision: Precision | None = None,
) -> Statements:
    """The statements that compute the nodes of an expanded program, in order; what depends on no input is a number.

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
    precision : Precision, optional
        The format that numbers are for, by default that of the language.

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
    row, given, known = LANGUAGES[language], inputs or {}, {**folded(program), **(known or {})}
    needed = _needed(program, known)
    result = Statements([], [], [])
    for number, node in enumerate(program.nodes):
        name = known.get(number)
        if name is None and node.operation in ("const", "undefined"):
            name = math.nan if node.operation == "undefined" else constant_value(node.data, precision or row.precision)
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


def folded(program: Program, letters: Mapping[str, float] | None = None) -> dict[int, float]:
    """The numbers of the nodes, no constants, that depend on no input, or on these letters alone.

    Examples
    --------
    >>> from rsym.program.program import Node
    >>> nodes = (Node("input", (), "a"), Node("neg", (0,)))
    >>> folded(Program(nodes, ("x",), ("a",), (("value", 1),)), {"a": 2.0})
    {0: 2.0, 1: -2.0}
    """
    given = letters or {}
    values = interpret_nodes(program, {**dict.fromkeys((*program.coordinates, *program.letters), 0.0), **given})
    fixed: list[bool] = []
    for node in program.nodes:
        fixed.append(node.data in given if node.operation == "input" else all(fixed[k] for k in node.arguments))
    constant = ("const", "undefined")
    return {k: float(values[k]) for k, node in enumerate(program.nodes) if fixed[k] and node.operation not in constant}


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
        return row.coordinate.format(k=k, k1=k + 1)
    k = program.letters.index(name)
    return row.letter.format(k=k, k1=k + 1)
