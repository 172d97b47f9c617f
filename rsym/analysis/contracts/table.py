"""The table of promises, and walks that read it."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.analysis.contracts.elementary import ELEMENTARY, Least, Rule
from rsym.analysis.contracts.operations import OPERATIONS
from rsym.analysis.contracts.pieces import PIECES
from rsym.analysis.contracts.promises import Promise
from rsym.errors import RsymError
from rsym.model.nodes import written_out
from rsym.model.traversal import with_operands

PROMISES: dict[type[sp.Basic], Rule] = {**ELEMENTARY, **OPERATIONS, **PIECES}


def number_itself(exponent: sp.Expr) -> sp.Expr | None:
    """The value of a number; nothing is known of a letter."""
    return exponent if exponent.is_number and exponent.is_real else None


def promise(part: sp.Expr, least: Least = number_itself) -> Promise:
    """What the operation on top of an expression promises.

    least: the least value of an exponent that is a letter, None where it is not known.

    Raises
    ------
    RsymError
        For a function that is not in the table.

    Examples
    --------
    >>> from rsym import conjunction, x, y
    >>> found = promise(conjunction(x, y))
    >>> found.law, found.monotone, found.singular[0].equations
    ('positive where every operand is', (1, 1), (x, y))
    >>> found.order([3, 2])
    1
    """
    if not part.args:
        return Promise(())
    rule = PROMISES.get(type(part))
    if rule is not None:
        return rule(part, least)
    raise RsymError(
        f"nothing is promised of {type(part).__name__}",
        code="unsupported-function",
        remedy="write it with + - * / powers, sqrt, abs, min, max, Piecewise, elementary functions and R-operations",
    )


def known_compositions(expression: sp.Expr) -> sp.Expr:
    """The expression with every composition that promises nothing of its own written out."""
    return written_out(expression, PROMISES)


class Promises:
    """The promises of all parts of an expression, each made once."""

    def __init__(self, root: sp.Expr, least: Least = number_itself) -> None:
        self.root = known_compositions(root)
        self._least = least
        self._made: dict[int, tuple[sp.Expr, Promise]] = {}

    def __getstate__(self) -> dict[str, Any]:
        """What is made is known by the identity of its parts, which does not travel; it is made again."""
        return {"root": self.root, "_least": self._least, "_made": {}}

    def __getitem__(self, part: sp.Expr) -> Promise:
        if id(part) not in self._made:
            self._made[id(part)] = part, promise(part, self._least)  # the part is kept, so that its id is its own
        return self._made[id(part)][1]

    def inward(self, part: sp.Expr) -> tuple[sp.Expr, ...]:
        """The operands."""
        return self[part].operands

    def smooth_in(self, part: sp.Expr) -> tuple[sp.Expr, ...]:
        """What a part is smooth in off its singular sets."""
        made = self[part]
        return made.operands if made.through is None else made.through

    def parts(self, through: bool = False) -> list[sp.Expr]:
        """Every distinct part that counts, operands before their users."""
        inward = self.smooth_in if through else self.inward
        return [part for part, _ in with_operands(self.root, inward)]
