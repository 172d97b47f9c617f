"""The named formulas of a model, one by one: what a page or a terminal shows of it."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import sympy as sp

from rsym.language.assembly import assemble
from rsym.language.loading import read_text
from rsym.language.model import collect
from rsym.language.parser import parse
from rsym.language.typesetting import typeset
from rsym.model.names import typeset_name


@dataclass(frozen=True)
class Definition:
    """One formula: its name, its expression in which other names are symbols, both as LaTeX, and what part it makes."""

    name: str
    expression: sp.Expr
    latex: str
    doc: str = ""


def definitions(source: str | PathLike[str], *, shape: str | None = None) -> tuple[Definition, ...]:
    r"""The chosen formula of a model and those that it needs, in the order of the file.

    Parameters
    ----------
    source : path or str
        A path object names a file; a str is the text of a model itself.
    shape : str, optional
        As for `loads`.

    Raises
    ------
    RsymError
        As for `load` and `loads`.

    Examples
    --------
    >>> for definition in definitions("f1 = 1 - x^2; g = y*3; omega = rfAND(f1, z)"):
    ...     print(definition.latex)
    f_{1} = 1 - x^{2}
    \omega = f_{1} \wedge_0 z
    """
    model = collect(parse(source if isinstance(source, str) else read_text(source)))
    written = {assignment.name: assignment for assignment in model.assignments}
    return tuple(
        Definition(
            name,
            expression,
            f"{typeset_name(name)} = {typeset(written[name].value, model.system)}",
            written[name].doc,
        )
        for name, expression in assemble(model, shape, None).definitions
    )
