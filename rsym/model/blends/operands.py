"""What a blend is given: two operands and more, the letters known of them, and the operation they are blended in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping
from rsym.model.bounding import combined
from rsym.model.equation import combine
from rsym.model.letters import Letters, as_letters
from rsym.model.parallels import in_lengths
from rsym.model.shape import Shape
from rsym.model.systems import RSystem

OPERATIONS = ("union", "intersection", "difference")


@dataclass(frozen=True)
class Operands:
    """Shapes and expressions, and all letters known of them."""

    items: tuple[Any, ...]
    letters: Letters

    @classmethod
    def of(cls, *items: Any, letters: LetterMapping = None) -> Operands:
        """The operands; the letters of numbers are told to the shapes among them.

        Examples
        --------
        >>> import sympy as sp
        >>> import rsym
        >>> from rsym import x, y
        >>> r = sp.Symbol("r", real=True)
        >>> Operands.of(rsym.Shape(x, (x, y)), y, letters={r: 2}).letters["r"].default
        2
        """
        known = as_letters(letters)
        for item in items:
            known = known.merge(item.letters) if isinstance(item, Shape) else known
        told = tuple(item.replace(letters=known) if isinstance(item, Shape) else item for item in items)
        return cls(told, known)

    def in_lengths(self) -> Operands:
        """The operands, shapes as far as their leaves know lengths."""
        measured = tuple(in_lengths(item) if isinstance(item, Shape) else item for item in self.items)
        return replace(self, items=measured)

    def combined(self, operation: str, system: RSystem, displacement: Callable[..., sp.Expr] | None = None) -> Any:
        """The operation on the first two, plus a displacement made of all."""
        if operation not in OPERATIONS:
            raise RsymError(f"operation must be one of {', '.join(OPERATIONS)}, got {operation!r}", code="operation")

        def function(f: sp.Expr, g: sp.Expr, *rest: sp.Expr) -> sp.Expr:
            if operation == "union":
                result = system.disjunction(f, g)
            else:
                result = system.conjunction(f, g if operation == "intersection" else -g)
            return result if displacement is None else result + displacement(f, g, *rest)

        return combine(function, *self.items, box=lambda boxes: combined(operation, exactly=False)(boxes[:2]))
