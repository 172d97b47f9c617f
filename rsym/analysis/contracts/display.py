"""A contract in words: text for a terminal, a table for a notebook."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import accumulate
from typing import Any

import sympy as sp

from rsym.analysis.contracts.leaves import Leaf, is_logical
from rsym.analysis.contracts.promises import Order, Singularity
from rsym.model.abridging import symbol_names, weight
from rsym.model.symbols import real_symbol, symbols_of
from rsym.reports.document import Document, Entry, Sentence

_SHOWN = 6  # singular sets of one kind, leaves of one order: a car has 38 and 31
_IN_A_TABLE = 4  # of them: LaTeX takes longer than text
_DEEP = 2  # R-operations within one another that are still written out
_LONG = 40  # parts of a leaf that is still written out
ROOM, CELL = 3800, 1500  # characters of a table, and of what one cell lists

Names = Mapping[sp.Expr, str]


def smoothness(continuity: float) -> str:
    """The class in words.

    Examples
    --------
    >>> smoothness(math.inf), smoothness(0), smoothness(2), smoothness(-1)
    ('analytic', 'continuous', 'of class C^2', 'not continuous')
    """
    if continuity == math.inf:
        return "analytic"
    return {-1: "not continuous", 0: "continuous"}.get(int(continuity), f"of class C^{continuity}")


def normalisation(order: Order) -> str:
    """The order in words."""
    if order is None:
        return "normalisation not shown"
    return {math.inf: "the exact distance", 0: "not normalised"}.get(order, f"normalised to order {order:g}")


def shortened(expression: sp.Expr, names: Names, depth: int = _DEEP) -> sp.Expr:
    """What has a name by its name, what is deep or long by dots."""
    if expression in names:
        return real_symbol(names[expression])
    if not is_logical(expression):
        return expression if weight(expression, _LONG) <= _LONG else real_symbol("...")
    if depth == 0:
        return real_symbol("...")
    return expression.func(
        *(shortened(argument, names, depth - 1) if argument.free_symbols else argument for argument in expression.args)
    )


def _text(singularity: Singularity, names: Names) -> str:
    return " = ".join([*(sp.sstr(shortened(equation, names)) for equation in singularity.equations), "0"])


def _latex(singularity: Singularity, names: Names) -> str:
    parts = [shortened(equation, names) for equation in singularity.equations]
    printed = symbol_names(symbols_of(*parts)) | {real_symbol("..."): r"\dots"}
    return " = ".join([*(sp.latex(part, symbol_names=printed) for part in parts), "0"])


def kinds(singular: Sequence[Singularity]) -> dict[tuple[int, str], list[Singularity]]:
    """The singular sets by class and operation, the roughest first."""
    groups: dict[tuple[int, str], list[Singularity]] = {}
    for item in sorted(singular, key=lambda item: item.continuity):
        groups.setdefault((item.continuity, item.operation), []).append(item)
    return groups


def _counted(shown: Sequence[str], count: int, between: str, room: int) -> str:
    kept = [text for text, used in zip(shown, accumulate(map(len, shown)), strict=True) if used <= room] or shown[:1]
    more = [f"and {count - len(kept)} more"] if count > len(kept) else []
    return between.join([*kept, *more])


def _called(leaf: Leaf) -> str:
    title = leaf.name or (sp.sstr(leaf.expression) if weight(leaf.expression, _LONG) <= _LONG else "a leaf")
    return f"{title} ({leaf.part})" if leaf.part and leaf.part != title else title


def by_order(leaves: Sequence[Leaf]) -> dict[Order, list[Leaf]]:
    """The leaves by order, those not normalised first."""
    groups: dict[Order, list[Leaf]] = {}
    for leaf in sorted(leaves, key=lambda leaf: 0.5 if leaf.order is None else leaf.order):
        groups.setdefault(leaf.order, []).append(leaf)
    return groups


def contract_document(
    continuity: float,
    order: str,
    singular: Sequence[Singularity],
    leaves: Sequence[Leaf],
    names: Names,
    data: Mapping[str, Any],
) -> Document:
    """The contract in sentences, all of them proved by the formula alone; in a notebook equations are LaTeX."""
    sets, orders = kinds(singular), by_order(leaves)
    room = ROOM // max(1, len(sets) + len(orders))
    entries = []
    for (rank, operation), group in sets.items():
        told = _counted([_text(item, names) for item in group[:_SHOWN]], len(group), "; ", CELL)
        shown = _counted([f"${_latex(item, names)}$" for item in group[:_IN_A_TABLE]], len(group), "\n", room)
        title = smoothness(rank)
        entries.append(Entry(f"{title} ({operation}) where {told}", True, (f"{title}: {operation}", shown), label=""))
    for kind, alike in orders.items():
        called = [_called(leaf) for leaf in alike[: max(_SHOWN, _IN_A_TABLE)]]
        told = _counted(called[:_SHOWN], len(alike), "; ", CELL)
        shown = _counted(called[:_IN_A_TABLE], len(alike), "\n", room)
        title = normalisation(kind)
        entries.append(Entry(f"leaves, {title}: {told}", True, (f"leaves: {title}", shown), label=""))
    return Document(
        "contract",
        Sentence(f"omega is {smoothness(continuity)}; {order}", True),
        entries=tuple(entries),
        columns=("what", "where"),
        data=data,
    )
