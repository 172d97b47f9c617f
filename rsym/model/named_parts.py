"""Parts by name: one taken out of a shape as a shape, or another put in its place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import is_
from typing import Any, TypeVar

import sympy as sp

from rsym.errors import RsymError
from rsym.model.equation import Equation, combine
from rsym.model.letters import Letters
from rsym.model.nodes import Fold, RealNode, ZeroWith
from rsym.model.requirements import require_shape
from rsym.model.rnodes import ROperation
from rsym.model.symbols import postorder, real_symbol, rebuild, symbols_of, with_arguments, with_operands
from rsym.model.systems import R0
from rsym.model.wording import listing, proposal

_IDEMPOTENT = (ROperation, sp.Min, sp.Max)
S = TypeVar("S", bound=Equation)


def part_of(shape: S, name: str) -> S:
    """The part of this name, several as one group; what `Shape.part` is.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> part_of(rsym.Shape(x, (x, y)).named("right") & rsym.Shape(y, (x, y)), "right").expression
    x
    """
    group = _group(shape, name)
    expression = group[0] if len(group) == 1 else R0.disjunction(*group)
    inside = Inside(*group)
    return replace(
        shape,
        expression=expression,
        letters=Letters({symbol.name: shape.letters[symbol.name] for symbol in _letters(shape, expression)}),
        definitions=(),
        parts=tuple(part for part in shape.parts if part[1] in inside),
    )


def with_part(shape: S, name: str, other: Equation) -> S:
    """The shape with another in the place of a part; what `Shape.with_part` is.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> corner = rsym.Shape(x, (x, y)).named("right") & rsym.Shape(y, (x, y))
    >>> with_part(corner, "right", rsym.Shape(1 - x, (x, y))).expression
    conjunction(1 - x, y)
    """
    require_shape(other)
    old = _group(shape, name)
    twins = list(dict.fromkeys(title for title, part in shape.parts if title != name and part in old))
    if twins and _uses(shape.expression, old) > 1:
        raise RsymError(
            f"{name!r} has the same formula as {listing(twins)}, which stands in several places: both would change",
            code="part",
            remedy="build the shape of parts that differ where one of them is to change",
        )
    swap = _Swap(old, other.expression, shape.expression)
    expression = swap.within(shape.expression)
    if lost := [part for part in old if part not in swap.found]:
        raise RsymError(
            f"{len(lost)} of {len(old)} parts named {name!r} cannot be found in the formula: it moves or bends them, "
            "or SymPy has merged them with what surrounds them",
            code="part",
            remedy="build the shape of parts that R-operations join, each made by shape.named(name)",
        )
    before, after = Inside(shape.expression), Inside(expression)
    parts: dict[tuple[str, sp.Expr], None] = {}
    for title, part in shape.parts:
        changed = (name, other.expression) if part in old else (title, swap.within(part))
        if changed[1] in after or part not in before:  # what was inside the old part has gone with it
            parts[changed] = None
    merged: S = combine(lambda *_: expression, shape, other)
    gone = set(_letters(shape, shape.expression)) - set(symbols_of(expression))
    return replace(
        shape,
        expression=expression,
        letters=Letters({title: one for title, one in merged.letters.items() if real_symbol(title) not in gone}),
        box=merged.box,
        definitions=(),
        parts=tuple(parts),
    )


def _group(shape: Equation, name: Any) -> tuple[sp.Expr, ...]:
    """The formulas of a name, but those that lie within another of the same name."""
    names = list(dict.fromkeys(title for title, _ in shape.parts))
    if name not in names:
        otherwise = 'give a part its name when you make it: shape.named("wheel")'
        remedy = proposal(name, names, "ask for one of these" if names else otherwise)
        raise RsymError(f"no part {name!r}; the shape has {listing(names)}", code="unknown-part", remedy=remedy)
    group = list(dict.fromkeys(part for title, part in shape.parts if title == name))
    inside = {part: Inside(part) for part in group}
    return tuple(part for part in group if not any(part != other and part in inside[other] for other in group))


def _letters(shape: Equation, expression: sp.Expr) -> list[sp.Symbol]:
    return [symbol for symbol in symbols_of(expression) if symbol.name in shape.letters]


class Inside:
    """What formulas have within them, signs and numbers before sums and folds apart; first operands of folds too."""

    def __init__(self, *expressions: sp.Expr) -> None:
        self._parts = set(postorder(*expressions))
        folds = [part for part in self._parts if isinstance(part, Fold)]
        self._parts |= {
            fold.func(*fold.parameters, *fold.operands[:count])
            for fold in folds
            for count in range(2, len(fold.operands))
        }

    def __contains__(self, part: sp.Expr) -> bool:
        inner = part.as_coeff_Mul()[1]
        plain = inner if inner.is_Add or isinstance(inner, Fold) else part
        return any(one in self._parts for one in (part, -part, plain, -plain))


def _operands(part: sp.Expr) -> tuple[sp.Expr, ...]:
    """Where operands of logic are looked for: within logic, and in the terms of a sum, as those of a blend."""
    if isinstance(part, Fold):
        return part.operands
    negated = part.is_Mul and len(part.args) == 2 and part.args[0].is_number
    return tuple(part.args) if negated or part.is_Add or _is_of_shapes(part) else ()


def _uses(whole: sp.Expr, formulas: Sequence[sp.Expr]) -> int:
    """How often some formulas are operands in another one, signs apart."""
    images = {image for formula in formulas for image in (formula, -formula)}
    return sum(operand in images for part in set(postorder(whole)) for operand in _operands(part))


def _is_of_shapes(part: sp.Expr) -> bool:
    """Whether operands are shapes: a coordinate among them is a half-plane, elsewhere it is a coordinate."""
    return isinstance(part, sp.Min | sp.Max | sp.Abs) or (isinstance(part, RealNode) and part.of_shapes)


class _Swap:
    """Some formulas for one: where they are operands of logic if they are, else wherever they stand in `whole`."""

    def __init__(self, old: Sequence[sp.Expr], new: sp.Expr, whole: sp.Expr) -> None:
        self.found: set[sp.Expr] = set()
        self._new = new
        self._images = {image: (part, sign) for part in old for sign, image in ((1, part), (-1, -part))}
        self._loose: list[sp.Expr] = []
        self.within(whole)
        # A bare coordinate is too little to be known by.
        self._loose = [part for part in old if part not in self.found and part.args and (-part).args]

    def within(self, expression: sp.Expr) -> sp.Expr:
        """The expression with the new formula in it."""
        done: dict[int, sp.Expr] = {}
        for part, operands in with_operands(expression, _operands):
            done[id(part)] = self._rebuilt(part, [done[id(operand)] for operand in operands]) if operands else part
        result = self._in_place_of(expression, done[id(expression)])
        return self._anywhere(result) if self._loose else result

    def _in_place_of(self, operand: sp.Expr, otherwise: sp.Expr) -> sp.Expr:
        """The new formula, if this operand is an old one or a multiple of it."""
        image = self._image(operand)
        if image is None and operand.is_Mul and len(operand.args) == 2 and operand.args[0].is_number:
            inner = self._image(operand.args[1])
            image = None if inner is None else operand.args[0] * inner
        return otherwise if image is None else image

    def _image(self, part: sp.Expr) -> sp.Expr | None:
        if part not in self._images:
            return None
        old, sign = self._images[part]
        self.found.add(old)
        return self._new if sign > 0 else -self._new

    def _head(self, part: Fold) -> int:
        """How many of the first operands are a formula to be replaced: conjunction(f, g) in conjunction(f, g, h)."""
        for old in (image for image in self._images if type(image) is type(part)):
            count = len(old.operands)
            if old.parameters == part.parameters and part.operands[:count] == old.operands:
                return count
        return 0

    def _rebuilt(self, part: sp.Expr, operands: list[sp.Expr]) -> sp.Expr:
        """The node of the new operands; a group in one conjunction or disjunction becomes one operand of it."""
        before = list(_operands(part))
        if _is_of_shapes(part):
            operands = list(map(self._in_place_of, before, operands))
        if isinstance(part, Fold) and (count := self._head(part)):
            head = self._image(part.func(*part.parameters, *before[:count]))
            operands = [*([] if head is None else [head]), *operands[count:]]
        if len(operands) == len(before) and all(map(is_, operands, before)):
            return part
        if isinstance(part, _IDEMPOTENT):
            images = (self._new, -self._new)
            operands = [one for k, one in enumerate(operands) if one not in images or one not in operands[:k]]
        if isinstance(part, Fold):
            return part.func(*part.parameters, *operands)
        return operands[0] if len(operands) == 1 < len(before) else with_arguments(part, tuple(operands))

    def _anywhere(self, expression: sp.Expr) -> sp.Expr:
        """Within sums and other formulas, of which an old part may be some of the terms or factors."""

        def image(part: sp.Expr) -> sp.Expr | None:
            for old in self._loose:
                if part in (old, -old):
                    return self._image(part)
                if part.func is old.func and (part.is_Add or part.is_Mul) and set(old.args) < set(part.args):
                    rest = [argument for argument in part.args if argument not in old.args]
                    return part.func(self._image(old), *rest)
            return None

        for node in postorder(expression):
            if isinstance(node, ZeroWith) and any(old in Inside(node) for old in self._loose):
                raise RsymError(
                    "the formula was made of derivatives, which would stay those of the old part",
                    code="part",
                    remedy="replace the part before normalise(shape)",
                )
        return rebuild(expression, image)
