"""A shape as text in another language: one function, needing nothing but the language's own mathematics.

Only numbered names stand in the code; the names of a model appear in comments.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from rsym.backends.dialects import LANGUAGES, Language
from rsym.backends.languages import folded, statements
from rsym.backends.vm import vm_source
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.wording import documented, proposal
from rsym.program.expansion import expand
from rsym.program.fields import checked_fields, program_of
from rsym.program.program import Program

KNOWN = (*LANGUAGES, "vm")


@documented(languages=", ".join(f'"{name}"' for name in KNOWN))
def source(shape: Shape, language: str, fields: Sequence[str] = ("value",), *, letters: str | None = None) -> str:
    """The program that a kernel runs, as source text of another language.

    Parameters
    ----------
    shape : Shape
        What to evaluate.
    language : {{languages}}
        A file with one function ``rsym_kernel`` of coordinates, letters and outputs, all of them float64. The comment
        at its head lists the coordinates, the letters with their defaults, the outputs, and how to compile it. ``c``,
        ``fortran``, ``rust``, ``javascript``, ``julia`` and ``cuda`` fill arrays point by point, ``numpy`` and
        ``matlab`` (Octave too) return arrays. Where products and sums are not contracted they give the bits of the
        kernel for arithmetic, its NaN included. ``glsl`` (ES 3.00) computes one point in single precision.

        ``vm`` is the text of fidget and MPR: a line a name, an operation, its arguments; the first line is a comment,
        the last is the value. Inside is *negative* there. It holds the value alone, letters as constants; `load` reads
        it from a file.
    fields : sequence of str
        As for `compile`; a gradient is one output for each component, a Hessian one for each on or above the
        diagonal.
    letters : {"arguments", "constants"}, optional
        Letters are an argument of the function, by default, or their defaults stand in the text as numbers, and so
        does what is computed of them alone: for other values take ``shape.with_letters``. ``vm`` has constants.

    Raises
    ------
    RsymError
        For an unknown language, field or choice of letters, and for what the language cannot say.

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
    >>> print(rsym.source(rsym.Shape(x * y - 1, (x, y)), "vm"))
    # value of an R-function, inside is negative; x = var-x, y = var-y
    _0 const -1.0
    _1 var-x
    _2 var-y
    _3 mul _1 _2
    _4 add _0 _3
    _5 neg _4
    <BLANKLINE>
    """
    require_shape(shape)
    if not isinstance(language, str) or language not in KNOWN:
        raise RsymError(
            f"no language {language!r}",
            code="unknown-language",
            remedy=proposal(str(language), KNOWN, f"choose from {', '.join(map(repr, KNOWN))}"),
        )
    if letters not in (None, "arguments", "constants"):
        raise RsymError(
            f"letters must be 'arguments' or 'constants', got {letters!r}", code="letters", remedy="leave it out"
        )
    names = checked_fields(fields)
    defaults = {name: float(letter.default) for name, letter in shape.letters.items()}
    if language == "vm":
        if names != ("value",) or (letters == "arguments" and defaults):
            raise RsymError(
                "the format 'vm' holds a value alone, with letters as constants",
                code="language",
                remedy="leave out fields and letters, or choose another language",
            )
        return vm_source(program_of(shape, names), defaults)
    program = expand(program_of(shape, names, share=LANGUAGES[language].precision.rounding))
    return program_source(program, language, defaults, constants=letters == "constants")


def program_source(program: Program, language: str, defaults: Mapping[str, float], *, constants: bool = False) -> str:
    """The text of a file for an expanded program; `defaults` are the values of the letters, said or used."""
    row = LANGUAGES[language]
    uniform, varying, names = statements(program, language, known=folded(program, defaults) if constants else None)
    coordinates, outputs = range(len(program.coordinates)), range(len(program.outputs))
    places = {
        "coordinates": ", ".join(f"c{k}" for k in coordinates),
        "points": " + ".join(f"c{k}" for k in coordinates),
    }
    stores = [row.store.format(k=k, value=names[number], **places) for k, (_, number) in enumerate(program.outputs)]
    code = "\n".join(uniform + varying)
    said = "".join(f"{defaults[name]!r}, " for name in program.letters).rstrip()
    given = [row.given.format(defaults=said)] if row.given and not constants else []
    takes = [*(row.input.format(k=k) for k in coordinates), *given]
    gives = [row.output.format(k=k) for k in outputs]
    lists = {"inputs": takes, "outputs": gives, "parameters": [*takes, *gives, *([row.size] if row.size else [])]}
    places |= {name: ", ".join(parts) for name, parts in lists.items()}
    functions = [text for name, text in row.functions.items() if f"{name}(" in code]
    parameters = [*(f"c{k}" for k in coordinates), *(["letters"] if given else [])]
    unused = [row.unused.format(name=name) for name in parameters if row.unused and f"{name}[" not in code]
    inside = row.margin + (4 if row.loop else 0)
    lines = [
        *_head(program, row, defaults, constants),
        *row.preamble,
        *(
            [row.uniform.format(count=len(program.letters))]
            if row.uniform and program.letters and not constants
            else []
        ),
        *(() if row.below else functions),
        *(line.format(**places) for line in row.head),
        *(" " * row.margin + line for line in unused + uniform),
        *(line.format(**places) for line in row.loop),
        *(" " * inside + line for line in varying + stores),
        *(line.format(**places) for line in row.foot),
        *(functions if row.below else ()),
    ]
    return "".join(f"{_continued(line, row.width)}\n" for line in lines)


_UNSAFE = re.compile(r"[^A-Za-z0-9_ =.+-]")  # what could end a comment, or hide in one
_LETTER = re.compile(r"letters.\d+.")


def _head(program: Program, row: Language, defaults: Mapping[str, float], constants: bool) -> list[str]:
    """The comment that says what goes in and what comes out."""
    rows = [(f"c{k}", name) for k, name in enumerate(program.coordinates)]
    for k, name in enumerate(program.letters):
        places = ["constant"] if constants else _LETTER.findall(row.letter.format(k=k, k1=k + 1))
        rows.append((places[0], f"{name} = {defaults[name]!r}"))
    rows += [(f"out{k}", name) for k, (name, _) in enumerate(program.outputs)]
    said = [
        "An R-function, positive inside its shape, and functions derived from it.",
        "",
        *(f"{place:<12} {_UNSAFE.sub('_', meaning)}" for place, meaning in rows),
        "",
        *row.notes,
        "A derivative that does not exist is NaN.",
    ]
    opening, prefix, closing = row.comment
    lines = [f"{prefix}{line}".rstrip() for line in said]
    if opening:
        lines[0] = f"{opening}{said[0]}"
    return [*lines, *([closing] if closing else [])]


def _continued(line: str, width: int | None) -> str:
    """A line that is too long, in several: Fortran's, which take an ampersand."""
    parts = []
    while width is not None and len(line) > width and not line.startswith("!"):
        cut = line.rindex(", ", 0, width) + 1
        parts.append(f"{line[:cut]} &")
        line = f"        {line[cut:].lstrip()}"
    return "\n".join([*parts, line])
