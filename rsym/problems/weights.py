"""Weights: functions that vanish on parts of the boundary, to the first order, and are positive inside.

The gates "and" at the top of the sign form join *conjuncts*; the weight is the product of those that hold a part with a
condition. Inside a conjunct "or" is the disjunction of R_0, f + g + sqrt(f**2 + g**2), so the weight is analytic but at
re-entrant corners; at convex ones a conjunction of R_0 would have unbounded second derivatives.
"""

from __future__ import annotations

from collections.abc import Collection
from functools import reduce

from rsym.errors import RsymError
from rsym.logic.leaf_names import leaf_names
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Shape


def conjuncts(form: SignForm) -> tuple[int, ...]:
    """The operands, leaves or gates by their numbers, of all that "and" joins at the top of a form.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.logic.sign_form import shape_form
    >>> conjuncts(shape_form(rsym.disc(1) & (rsym.Shape(x, (x, y)) | rsym.Shape(y, (x, y)))))
    (0, 3)
    """
    count = len(form.leaves)
    found: dict[int, None] = {}
    stack = [count + len(form.gates) - 1 if form.gates else 0]
    while stack:
        operand = stack.pop()
        if operand >= count and form.gates[operand - count].operation == "min":
            stack += form.gates[operand - count][:0:-1]
        else:
            found[operand] = None
    return tuple(found)


def leaves_below(form: SignForm, operand: int) -> tuple[int, ...]:
    """The leaves that an operand joins."""
    count, stack, found = len(form.leaves), [operand], set()
    while stack:
        top = stack.pop()
        if top < count:
            found.add(top)
        else:
            stack += form.gates[top - count][1:]
    return tuple(sorted(found))


def weighing(form: SignForm, shape: Shape, leaves: Collection[int]) -> tuple[int, ...]:
    """The conjuncts that hold these leaves; a conjunct of others too is refused: they meet at a re-entrant corner."""
    found = []
    for operand in conjuncts(form):
        below = leaves_below(form, operand)
        held = [leaf for leaf in below if leaf in leaves]
        if held and len(held) < len(below):
            names = leaf_names(form, shape)
            other = next(names[leaf] for leaf in below if leaf not in leaves)
            raise RsymError(
                f"{names[held[0]]} has a value, {other} has none, and they meet at a re-entrant corner",
                code="condition",
                remedy="give both a value, or none",
            )
        if held:
            found.append(operand)
    return tuple(found)


def operand_node(form: SignForm, operand: int, power: int = 0) -> int:
    """The node of an operand, its gates those of R_0, times (f**2 + g**2)**(power/2) where it is an "or"."""
    b, count = form.builder, len(form.leaves)
    made = list(form.leaves)
    for gate in form.gates[: max(0, operand - count + 1)]:
        f, g = made[gate.first], made[gate.second]
        if gate.operation == "min":
            made.append(b.make("r0_conjunction", f, g))
            continue
        node = b.make("r0_disjunction", f, g)
        if power:
            node = b.mul(node, b.powi(b.sqrt(b.add(b.square(f), b.square(g))), power))
        made.append(node)
    return made[operand]


def product_node(form: SignForm, operands: Collection[int], power: int = 0) -> int:
    """The product of some conjuncts; 1 of none."""
    b = form.builder
    nodes = [operand_node(form, operand, power) for operand in operands]
    return reduce(b.mul, nodes) if nodes else b.const(1)
