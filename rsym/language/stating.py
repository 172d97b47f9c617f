"""What a model says of a function on its shape: an equation with the formulas that it names, conditions by part."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import EllipsisType

import sympy as sp

from rsym.analysis import conditions as made
from rsym.analysis.conditions import BoundaryCondition
from rsym.language.assembly import builder_of, check_names, inlined
from rsym.language.building import symbol_part
from rsym.language.equations import UNKNOWN
from rsym.language.model import ModelFile
from rsym.language.syntax import ConditionStatement, EquationStatement, Expression, names_in
from rsym.model.letters import Letter
from rsym.model.symbols import symbols_of


@dataclass(frozen=True, eq=False, repr=False)
class WrittenEquation:
    """An equation as a model writes it, with what the names of formulas in it mean; `str` is its text."""

    text: str
    left: Expression
    right: Expression
    meanings: Mapping[str, sp.Expr]

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<WrittenEquation {self.text}>"


@dataclass(frozen=True, eq=False)
class Stated:
    """An equation if there is one, conditions by part with their statements, the letters that all of them need."""

    equation: WrittenEquation | None
    conditions: Mapping[str | EllipsisType, BoundaryCondition]
    statements: tuple[ConditionStatement, ...]
    letters: frozenset[str]


def stated(
    model: ModelFile,
    letters: Mapping[str, Letter],
    equation: EquationStatement | None,
    conditions: Iterable[ConditionStatement],
) -> Stated:
    """An equation and conditions in the words of a model, its coordinates, letters and formulas.

    Examples
    --------
    >>> from rsym.language.model import collect
    >>> from rsym.language.parser import parse
    >>> model = collect(parse("letter t = 3; omega = 1 - x^2 - y^2; equation -laplacian(u) = t*omega; on omega = t"))
    >>> found = stated(model, model.letters, model.equation, model.conditions)
    >>> str(found.equation), dict(found.conditions), sorted(found.letters)
    ('-laplacian(u) = t*omega', {'omega': Dirichlet(value=t)}, ['t'])
    """
    known, builder = inlined(model, letters), builder_of(model, letters)
    found: dict[str | EllipsisType, BoundaryCondition] = {}
    statements = tuple(conditions)
    for one in statements:
        for value in one.values:
            check_names(value, known, model)
        values = [builder.build(value, known).outer for value in one.values]
        found[... if one.part is None else one.part] = getattr(made, one.kind or "dirichlet")(*values)
    formulas = [value for one in found.values() for value in one.values if isinstance(value, sp.Expr)]
    written = None
    if equation is not None:
        if UNKNOWN in known:
            raise equation.place.refuse(
                f"'{UNKNOWN}' is the unknown function of equations, and a name of the model too",
                "redefinition",
                "rename",
            )
        for side in (equation.left, equation.right):
            check_names(side, {**known, UNKNOWN: symbol_part(UNKNOWN)}, model)
        names = {name.name for side in (equation.left, equation.right) for name in names_in(side)}
        meanings = {one.name: known[one.name].outer for one in model.assignments if one.name in names}
        written = WrittenEquation(equation.text, equation.left, equation.right, meanings)
        formulas += [*meanings.values(), *(known[name].outer for name in names if name in letters)]
    needed = frozenset(symbol.name for symbol in symbols_of(*formulas) if symbol.name in letters)
    return Stated(written, found, statements, needed)
