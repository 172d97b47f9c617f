"""Separation: a leaf that stands in several parts made into several functions, for what asks for functions.

Weights and lifts vanish on a part because a function does. Two boxes of one height have one function for their lids, so
no function of it vanishes on one lid alone. Multiplied by a number, the terms of a sum are another formula of the same
zeros and signs: each part that has a leaf in common with another one takes its own multiple, as steep as it was.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import sympy as sp

from rsym.logic.faces import shape_faces
from rsym.model.blends.folds import BlendOperation
from rsym.model.nodes import Fold
from rsym.model.recent import placed, recently
from rsym.model.rnodes import ROperation
from rsym.model.shape import Shape
from rsym.model.symbols import with_arguments, with_operands

LITTLE = sp.Rational(1, 1 << 20)  # from one multiple to the next


class _Scaled(NamedTuple):
    """A formula, and which multiple of its leaves is wanted."""

    expression: sp.Expr
    times: int


@recently(16, placed)
def separated(shape: Shape) -> Shape:
    """The same body, of which no two parts have a leaf in common; the shape itself where none have.

    Of parts whose formulas are equal, at one place, none is told from the other.

    Examples
    --------
    >>> import rsym
    >>> pair = rsym.rectangle(1, 1).named("A") | rsym.rectangle(1, 1).translate(2, 0).named("B")
    >>> len(shape_faces(pair).form.leaves), len(shape_faces(separated(pair)).form.leaves)
    (3, 4)
    """
    faces = shape_faces(shape)
    first = {face.parts[:1] for face in faces.faces if face.leaf in faces.shared}
    names = [parts[0] for parts in sorted(first) if parts]
    times = {name: k + 1 for k, name in enumerate(names, () in first)}
    at: dict[sp.Expr, int] = {}
    for name, part in shape.parts:
        for image in (part, -part):
            at.setdefault(image, times.get(name, 1))
    return _rewritten(shape, _Multiples(at)) if names else shape


@recently(16, placed)
def separated_gates(shape: Shape) -> Shape:
    """The same body, of which no two conjunctions or disjunctions have a leaf in common, with names or without.

    Examples
    --------
    >>> import rsym
    >>> pair = rsym.rectangle(1, 1) | rsym.rectangle(1, 1).translate(2, 0)
    >>> len(shape_faces(pair).form.leaves), len(shape_faces(separated_gates(pair)).form.leaves)
    (3, 4)
    """
    return _rewritten(shape, _Multiples({}, defaultdict(dict)))


def _rewritten(shape: Shape, multiples: _Multiples) -> Shape:
    expression = multiples.within(shape.expression)
    parts = tuple((name, multiples.within(part)) for name, part in shape.parts)
    return replace(shape, expression=expression, parts=parts, definitions=())


@dataclass(frozen=True)
class _Multiples:
    """Which multiples leaves are replaced by: those `at` formulas of parts, or, with `gates`, another in each gate."""

    at: Mapping[sp.Expr, int]
    gates: defaultdict[sp.Expr, dict[sp.Expr, int]] | None = None

    def within(self, expression: sp.Expr) -> sp.Expr:
        """A formula with the multiples in it."""
        done: dict[_Scaled, sp.Expr] = {}
        root = _Scaled(expression, 1)
        for item, below in with_operands(root, self._operands, lambda item: item):
            part, made = item.expression, [done[one] for one in below]
            if not below:
                done[item] = multiple(part, self.at.get(part, item.times))
            elif isinstance(part, Fold):
                done[item] = part.func(*part.parameters, *made)
            elif part.is_Mul:
                done[item] = part.args[0] * made[0]
            else:
                done[item] = with_arguments(part, tuple(made))
        return done[root]

    def _operands(self, item: _Scaled) -> Sequence[_Scaled]:
        """What gates join; the first operands of a flat one may be a part."""
        part, times = item.expression, self.at.get(item.expression, item.times)
        if part.is_Mul and len(part.args) == 2 and part.args[0].is_number and isinstance(part.args[1], Fold):
            return [_Scaled(part.args[1], times)]
        if isinstance(part, sp.Min | sp.Max):
            return [_Scaled(one, self._times(part, one, times)) for one in part.args]
        if not isinstance(part, ROperation) or isinstance(part, BlendOperation):
            return ()
        own = [times] * len(part.operands)
        for count in range(len(part.operands) - 1, 1, -1):
            head = self.at.get(part.func(*part.parameters, *part.operands[:count]))
            if head is not None:
                own[:count] = [head] * count
        return [_Scaled(one, self._times(part, one, k)) for one, k in zip(part.operands, own, strict=True)]

    def _times(self, gate: sp.Expr, operand: sp.Expr, times: int) -> int:
        if self.gates is None:
            return times
        known = self.gates[min(operand, -operand, key=sp.default_sort_key)]
        return known.setdefault(gate, 1 + len(known))


def multiple(leaf: sp.Expr, times: int) -> sp.Expr:
    """Another formula of the zeros and signs of a leaf.

    Examples
    --------
    >>> from rsym import x, y
    >>> multiple(x + y, 1), multiple(x + y, 2) == (1 + LITTLE) * x + (1 + LITTLE) * y
    (x + y, True)
    """
    if times == 1:
        return leaf
    more = (times - 1) * LITTLE
    if leaf.is_Add:
        return sp.Add(*((1 + more) * term for term in leaf.args))
    return leaf + more * leaf**3  # a multiple would be taken for the leaf
