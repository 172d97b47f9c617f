"""A compiled shape as text in another language."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from rsym.backends.c_source import c_source
from rsym.errors import RsymError
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.program.expansion import expand
from rsym.program.fields import checked_fields, program_of
from rsym.program.program import Program

LANGUAGES: dict[str, Callable[[Program, Mapping[str, float]], str]] = {"c": c_source}


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
