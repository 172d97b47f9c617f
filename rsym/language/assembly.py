"""A model to a shape: one assignment chosen, every formula built once, names kept for display."""

from __future__ import annotations

import math
from collections.abc import Mapping

import sympy as sp

from rsym.errors import RsymError
from rsym.language.building import Built, FormulaBuilder, Verbatim, symbol_part
from rsym.language.extent import Extent
from rsym.language.functions import in_quotes, operations
from rsym.language.model import ModelFile
from rsym.language.pieces import Calls, shown_call
from rsym.language.syntax import Assignment, Expression, Name, names_in
from rsym.model.letters import Letter
from rsym.model.named_parts import Inside
from rsym.model.shape import Shape
from rsym.model.symbols import real_symbol, symbols_of
from rsym.model.wording import listing, proposal


def assemble(model: ModelFile, shape: str | None, variant: str | None) -> Shape:
    """The chosen shape of a model with the chosen letters."""
    chosen, letters = _chosen(model, shape), _letters(model, variant)
    calls, needed = Calls(model.coordinates, letters, model.system), _needed(model, chosen)
    known = inlined(model, letters, calls)
    expression = known[chosen].outer
    used = {symbol.name for symbol in symbols_of(expression)}
    return Shape(
        expression,
        tuple(map(real_symbol, model.coordinates)),
        letters={name: letter for name, letter in letters.items() if name in used or model.verbatim},
        bounds=model.bounds,
        definitions=_definitions(model, needed),
        parts=_given_parts(model, letters, known)
        if model.parts or model.verbatim
        else _parts(needed, expression, calls),
    )


def _chosen(model: ModelFile, shape: str | None) -> str:
    names = [assignment.name for assignment in model.assignments]
    if not names:
        raise RsymError(
            "the model has no formula",
            code="empty",
            where="line 1, column 1",
            remedy="add one, such as omega = 1 - x^2",
        )
    if shape is None:
        return "omega" if "omega" in names else names[-1]
    if shape not in names:
        remedy = proposal(shape, names, "ask for one of these names")
        raise RsymError(f"no shape {shape!r}; the model has {listing(names)}", code="unknown-shape", remedy=remedy)
    return shape


def _letters(model: ModelFile, variant: str | None) -> dict[str, Letter]:
    if variant is None:
        return dict(model.letters)
    if variant not in model.variants:
        remedy = proposal(variant, model.variants, "ask for one of these, or for none")
        known = listing(model.variants)
        raise RsymError(f"no variant {variant!r}; the model has {known}", code="unknown-variant", remedy=remedy)
    return {**model.letters, **model.variants[variant]}


def inlined(model: ModelFile, letters: Mapping[str, Letter], calls: Calls | None = None) -> dict[str, Built]:
    """Every formula with the others written into it; a part that is used twice is one object, and `calls` know it."""
    calls = calls or Calls(model.coordinates, letters, model.system)
    builder, known = builder_of(model, letters, calls), _given(model)
    told = any(assignment.doc for assignment in model.assignments)
    whole = _chosen(model, None) if model.assignments else ""
    for assignment in model.assignments:
        check_names(assignment.value, known, model, assignment.name)
        known[assignment.name] = built = builder.build(assignment.value, known)
        is_title = bool(assignment.doc) if told else assignment.name != whole
        calls.name(assignment.name, built.outer, is_title)
    return known


def builder_of(model: ModelFile, letters: Mapping[str, Letter], calls: Calls | None = None) -> FormulaBuilder:
    """What builds the formulas of a model."""
    kind = Verbatim if model.verbatim else FormulaBuilder
    calls = calls or Calls(model.coordinates, letters, model.system)
    return kind(operations(model.system), calls, frozenset(map(real_symbol, model.coordinates)))


def _given_parts(
    model: ModelFile, letters: Mapping[str, Letter], known: Mapping[str, Built]
) -> tuple[tuple[str, sp.Expr], ...]:
    """What the part statements say, in their order."""
    builder = builder_of(model, letters)
    for statement in model.parts:
        check_names(statement.value, known, model)
    return tuple((statement.name, builder.build(statement.value, known).outer) for statement in model.parts)


def _needed(model: ModelFile, chosen: str) -> list[Assignment]:
    """The chosen formula and those that it needs, in the order of the file."""
    needed, assigned = {chosen}, {assignment.name for assignment in model.assignments}
    for assignment in reversed(model.assignments):
        if assignment.name in needed:
            needed.update(name.name for name in names_in(assignment.value) if name.name in assigned)
    return [assignment for assignment in model.assignments if assignment.name in needed]


def _definitions(model: ModelFile, needed: list[Assignment]) -> tuple[tuple[str, sp.Expr], ...]:
    """The formulas, each in terms of the others' names."""
    builder = (Verbatim if model.verbatim else FormulaBuilder)(operations(model.system), shown_call)
    known = {**_given(model), **{assignment.name: symbol_part(assignment.name) for assignment in model.assignments}}
    return tuple((assignment.name, builder.build(assignment.value, known).outer) for assignment in needed)


def _parts(needed: list[Assignment], expression: sp.Expr, calls: Calls) -> tuple[tuple[str, sp.Expr], ...]:
    """The formulas whose text says what they are; where none has one, every formula by its name."""
    told = [assignment for assignment in needed if assignment.doc]
    named = [one for one in told or needed if one.doc or not one.inner]
    inside = Inside(expression)
    return tuple((one.doc or one.name, part) for one in named for part in calls.kept(one.name, inside))


def _given(model: ModelFile) -> dict[str, Built]:
    """What formulas may speak of before the first assignment."""
    names = (*model.coordinates, *model.letters)
    given = {name: symbol_part(name) for name in names}
    if model.verbatim:
        return {**given, "pi": Built(sp.pi, Extent()), "nan": Built(sp.nan, Extent())}
    return {**given, "pi": Built(sp.pi, Extent(), None, math.pi)}


def check_names(value: Expression, known: Mapping[str, Built], model: ModelFile, own: str = "") -> None:
    """Refuse names that mean nothing yet; `own` is that of the formula itself."""
    for name in names_in(value):
        if name.name not in known:
            raise _unknown(name, own, known, model)


def _unknown(name: Name, own: str, known: Mapping[str, Built], model: ModelFile) -> Exception:
    later = {other.name: other.place for other in model.assignments}
    if name.name == own:
        remedy = "a formula may use earlier names only; rename"
        return name.place.refuse(f"'{name.name}' is defined by itself", "unknown-name", remedy)
    if name.name in later:
        remedy = "move its definition up"
        return name.place.refuse(f"'{name.name}' is defined later, at {later[name.name]}", "unknown-name", remedy)
    remedy = in_quotes(name.name) or proposal(name.name, known, f"declare it, for example: letter {name.name} = 1")
    return name.place.refuse(f"unknown name '{name.name}'", "unknown-name", remedy)
