"""The conjuncts of a sign form: what "and" joins at the top, a hole each, or a side."""

from __future__ import annotations

from collections.abc import Collection

from rsym.logic.sign_form import SignForm


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


def grouped(form: SignForm, leaves: Collection[int]) -> tuple[tuple[int, ...], ...]:
    """Some leaves by the conjuncts that they belong to."""
    groups = ([leaf for leaf in leaves_below(form, operand) if leaf in leaves] for operand in conjuncts(form))
    return tuple(tuple(group) for group in groups if group)
