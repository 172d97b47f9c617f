"""A compiled shape as text in another language: C99, one function over arrays, needing nothing but libm.

Only numbered names stand in the code; the names of a model appear in comments.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence

from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.program.expansion import expand
from rsym.program.fields import checked_fields, program_of
from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, Program, constant_value


def source(shape: Shape, language: str, fields: Sequence[str] = ("value",)) -> str:
    """The program that a kernel runs, as source text of another language.

    Parameters
    ----------
    shape : Shape
        What to evaluate.
    language : {"c"}
        ``c``: a C99 file with one function ``rsym_kernel(coordinates, letters, outputs, n)``, all arrays of double.
        Its comments list coordinates, letters with their defaults, and outputs. Compiled with
        ``-ffp-contract=off`` it gives the bits of the kernel for arithmetic.
    fields : sequence of str
        As for `compile`; a gradient is one output for each component, a Hessian one for each on or above the
        diagonal.

    Raises
    ------
    RsymError
        For an unknown language or field.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> text = rsym.source(rsym.Shape(x * y - 1, (x, y)), "c")
    >>> print(text[text.index("    for") :])
        for (size_t i = 0; i < n; ++i) {
            const double v1 = c0[i];
            const double v2 = c1[i];
            const double v3 = v1 * v2;
            const double v4 = (-1.0) + v3;
            out0[i] = v4;
        }
    }
    <BLANKLINE>
    """
    require_shape(shape)
    if not isinstance(language, str) or language not in LANGUAGES:
        raise RsymError(
            f"no language {language!r}",
            code="unknown-language",
            remedy=f"choose from {', '.join(map(repr, LANGUAGES))}",
        )
    program = expand(program_of(shape, checked_fields(fields)))
    return LANGUAGES[language](program, {name: float(letter.default) for name, letter in shape.letters.items()})


_UNSAFE = re.compile(r"[^A-Za-z0-9_ =.+-]")  # what could end a comment, or hide in one

_HEAD = """\
/* An R-function, positive inside its shape, and functions derived from it.
 *
{contents}
 *
 * n points are evaluated; no array may overlap an output. A derivative that does not exist is NaN.
 *
 *     cc -O3 -march=native -fno-math-errno -ffp-contract=off -c kernel.c
 *
 * -fno-math-errno lets the compiler take square roots in vectors. With -ffp-contract=off arithmetic gives the same
 * bits on every machine. -ffast-math breaks NaN and signs: never use it.
 */
#include <math.h>
#include <stddef.h>

#if !defined(__GNUC__) || defined(__clang__) /* gcc knows the option only */
#pragma STDC FP_CONTRACT OFF
#endif
"""


def c_source(program: Program, defaults: Mapping[str, float]) -> str:
    """The text of a C file for an expanded program; `defaults` are the values of the letters."""
    uniform, varying, names = _statements(program)
    stores = [f"out{k}[i] = {names[number]};" for k, (_, number) in enumerate(program.outputs)]
    unused = [name for name in _parameters(program) if not any(f"{name}[" in line for line in uniform + varying)]
    lines = [
        _HEAD.format(contents="\n".join(f" * {line}".rstrip() for line in _contents(program, defaults))),
        _signature(program),
        "{",
        *(f"    (void){name};" for name in unused),
        *(f"    {line}" for line in uniform),
        "    for (size_t i = 0; i < n; ++i) {",
        *(f"        {line}" for line in varying + stores),
        "    }",
        "}",
    ]
    return "\n".join(lines) + "\n"


def _contents(program: Program, defaults: Mapping[str, float]) -> list[str]:
    rows = [(f"c{k}", name) for k, name in enumerate(program.coordinates)]
    rows += [(f"letters[{k}]", f"{name} = {defaults[name]!r}") for k, name in enumerate(program.letters)]
    rows += [(f"out{k}", name) for k, (name, _) in enumerate(program.outputs)]
    return [f"{place:<12} {_UNSAFE.sub('_', meaning)}" for place, meaning in rows]


def _parameters(program: Program) -> list[str]:
    return [*(f"c{k}" for k in range(len(program.coordinates))), "letters"]


def _signature(program: Program) -> str:
    inputs = [f"const double *restrict {name}" for name in _parameters(program)]
    outputs = [f"double *restrict out{k}" for k in range(len(program.outputs))]
    return f"void rsym_kernel({', '.join([*inputs, *outputs, 'size_t n'])})"


def _statements(program: Program) -> tuple[list[str], list[str], list[str]]:
    """What is computed once, what is computed for each point, and the name or number of each node."""
    uniform: list[str] = []
    varying: list[str] = []
    names: list[str] = []
    for number, node in enumerate(program.nodes):
        if node.operation in ("const", "undefined"):
            names.append(_number(node))
            continue
        block, letter = (uniform, "u") if program.uniform[number] else (varying, "v")
        names.append(f"{letter}{number}")
        block.append(f"const double {names[-1]} = {_value(program, node, names)};")
    return uniform, varying, names


def _value(program: Program, node: Node, names: Sequence[str]) -> str:
    if node.operation != "input":
        return OPERATIONS[node.operation].texts["c"].format(*(names[argument] for argument in node.arguments))
    name = str(node.data)
    if name in program.coordinates:
        return f"c{program.coordinates.index(name)}[i]"
    return f"letters[{program.letters.index(name)}]"


def _number(node: Node) -> str:
    value = math.nan if node.operation == "undefined" else constant_value(node.data)
    if math.isnan(value):
        return "NAN"
    return repr(value) if math.copysign(1, value) > 0 else f"({value!r})"


LANGUAGES: dict[str, Callable[[Program, Mapping[str, float]], str]] = {"c": c_source}
