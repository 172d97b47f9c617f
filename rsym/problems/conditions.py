"""Conditions by the names of parts, brought to the leaves of a shape."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from types import EllipsisType
from typing import Any, TypeAlias

import sympy as sp

from rsym.analysis.conditions import BoundaryCondition, Switched, UnknownLevel, as_condition
from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.model.arguments import default
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, symbols_of
from rsym.model.wording import listing, proposal

Name: TypeAlias = str | EllipsisType  # of a part, ... for the rest


def resolved(shape: Shape, conditions: Any, apart: Collection[sp.Expr] = ()) -> tuple[BoundaryCondition | None, ...]:
    """The condition of each leaf of ``surface_form(shape)``, in its order; None where nothing is said.

    Parameters
    ----------
    shape : Shape
        Whose parts have names, by ``shape.named(name)``.
    conditions : mapping, or one condition for all of the boundary
        Names of parts to conditions, a bare value being a Dirichlet condition; the key ``...`` is the rest. Where parts
        lie in one another that of the smallest named here holds. A leaf of no part is called as meshes call it, by its
        formula.
    apart : formulas
        Of leaves whose parts are told apart by their places.

    Raises
    ------
    RsymError
        For a name that nothing has, a part of which smaller ones named here take all, a value with unknown symbols, a
        part that has its formula in common with one of which something else is said.

    Examples
    --------
    >>> import rsym
    >>> ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    >>> resolved(ring, {"bore": 1, ...: rsym.neumann(0)})
    (Robin(coefficient=0, flux=0), Dirichlet(value=1))
    """
    require_shape(shape)
    given = given_by_name(shape, conditions)
    on_leaves = tuple(given.get(name) for name in assigned(shape, given))
    _require_told_apart(shape, given, apart)
    return on_leaves


def _require_told_apart(shape: Shape, given: Mapping[Name, BoundaryCondition], apart: Collection[sp.Expr]) -> None:
    """Refuse a condition on one of two parts of one formula, which are one leaf, where the other has another.

    A formula that stands in one place alone has two names of one thing.
    """
    names: dict[sp.Expr, str] = {}
    for name, expression in shape.parts:
        if expression in apart:
            continue
        other = names.setdefault(expression, name)
        differ = given.get(name, given.get(...)) != given.get(other, given.get(...))
        if differ and sum(expression in node.args for node in postorder(shape.expression)) > 1:
            raise RsymError(
                f"{other!r} and {name!r} have one formula: what is said of one would hold on the other too",
                code="ambiguous-part",
                remedy="give both one name, or say the same of both by ...",
            )


def require_part(name: Any, parts: Sequence[Sequence[str]], otherwise: str) -> None:
    """Refuse what names no part of a boundary whose leaves have these names; `otherwise` where no name is near it."""
    known = list(dict.fromkeys(name for names_of_leaf in parts for name in names_of_leaf))
    if name not in known:
        raise RsymError(
            f"no part {name!r} on the boundary; it has {listing(known)}",
            code="unknown-part",
            remedy=proposal(str(name), known, otherwise),
        )


def assigned(shape: Shape, names: Collection[Name]) -> tuple[Name, ...]:
    """Which of some names of parts each leaf of ``surface_form(shape)`` goes by, ``...`` for the rest.

    Examples
    --------
    >>> import rsym
    >>> assigned(rsym.disc(2).named("rim") - rsym.disc(1).named("bore"), ["bore"])
    (Ellipsis, 'bore')
    """
    parts = shape_leaf_parts(shape)
    for name in names:
        if name is not ...:
            require_part(name, parts, 'a part gets its name when it is made, shape.named("rim"); ... is the rest')
    chosen = [next((name for name in names_of_leaf if name in names), ...) for names_of_leaf in parts]
    for name in names:
        if name is not ... and name not in chosen:
            smaller = listing(dict.fromkeys(str(one) for one, all_ in zip(chosen, parts, strict=True) if name in all_))
            raise RsymError(
                f"what is said of {name!r} would hold nowhere: all of that part belongs to {smaller}, named too",
                code="unknown-part",
                remedy="leave one of them out",
            )
    return tuple(chosen)


def with_letters_of(shape: Shape, conditions: Any) -> Shape:
    """The shape with the letters, too, of shapes that tell where its conditions change."""
    given = conditions.values() if isinstance(conditions, Mapping) else [conditions]
    more = {name: letter for one in given if isinstance(one, Switched) for name, letter in one.letters.items()}
    return shape.replace(letters={**more, **shape.letters}) if more.keys() - shape.letters.keys() else shape


def given_by_name(
    shape: Shape, conditions: Any, read: Callable[[Any], BoundaryCondition] = as_condition
) -> dict[Name, BoundaryCondition]:
    """The conditions by name, symbols checked; `read` makes one of what is given."""
    if not isinstance(conditions, Mapping):
        conditions = {...: conditions}
    known = {*(symbol.name for symbol in shape.coordinates), *shape.letters}
    given = {name: read(value) for name, value in conditions.items()}
    for name, condition in given.items():
        formulas = [value for value in condition.values if isinstance(value, sp.Expr)]
        for symbol in symbols_of(*formulas):
            if symbol.name not in known:
                place = "the rest" if name is ... else repr(name)
                raise RsymError(
                    f"the condition on {place} contains {symbol}, neither coordinate nor letter",
                    code="unknown-letter",
                    remedy=f"shape.replace(letters={{**shape.letters, '{symbol}': 1}}) gives the shape that letter",
                )
        if isinstance(condition, UnknownLevel):
            default(condition.flow, shape.letters, "the flow through a part at an unknown level")
    return given
