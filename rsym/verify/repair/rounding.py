"""The move "round": a root that vanishes where the boundary is defective is kept from zero."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import combinations

import sympy as sp

from rsym.model.nodes import Trimming
from rsym.model.rnodes import R0mOperation, R0Operation, R1Operation, RAlphaOperation, ROperation
from rsym.model.shape import Shape
from rsym.verify.repair.anatomy import Anatomy, Culprit, Verdict, anatomy, troubles
from rsym.verify.repair.moves import (
    ROUNDS,
    Move,
    MoveFamily,
    Operation,
    Request,
    changed,
    folded,
    name_of,
    number_text,
    pair_of,
    short,
)


class Round(Move):
    """A root r is replaced by sqrt(r**2 + eps**2): |u|, sqrt(u), a trimming, the root of an R-operation.

    eps is a length times the slope of the root, so that the boundary moves by about this length; normalisation is
    lost there.
    """

    name = "round"

    def families(self, request: Request) -> list[MoveFamily]:
        """One family: all roots that vanish at the defects."""
        return [MoveFamily(self.name, "rounding of roots", request.scale(), rounded, ROUNDS)]


def rounded(shape: Shape, report: Verdict, size: Fraction) -> tuple[Shape, str] | None:
    """The shape with the roots rounded that vanish where the verdict finds it wrong.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> roof = rsym.Shape(1 - abs(x) - y, (x, y), bounds=((-2, 2), (-2, 2)))
    >>> found = rounded(roof, rsym.verify_smoothness(roof), Fraction(1, 10))
    >>> found[0].expression, found[1]
    (-y - sqrt(x**2 + 1/100) + 1, '|x| rounded by 0.1')
    """
    body, culprits = anatomy(shape, troubles(report, shape))
    levels: dict[sp.Expr, list[Culprit]] = {}
    for culprit in culprits:
        if _root(culprit) is not None:
            levels.setdefault(culprit.part, []).append(culprit)
    if not levels:
        return None
    changes, words = {}, []
    for part, found in levels.items():
        sizes = {culprit.level: _size(body, culprit, size) for culprit in found}
        changes[part] = _change(part, sizes)
        amounts = ", ".join(dict.fromkeys(map(number_text, sizes.values())))
        words.append(f"{_title(shape, part)} rounded by {amounts}")
    return changed(body.shape, changes), "; ".join(words)


def _size(body: Anatomy, culprit: Culprit, size: Fraction) -> Fraction:
    """Eps in the unit of the root."""
    slope = body.slope(_root(culprit), culprit.point)
    return short(float(size) * slope) if 0 < slope < float("inf") else size


def _title(shape: Shape, part: sp.Expr) -> str:
    if isinstance(part, sp.Abs):
        return f"|{name_of(shape, part.args[0])}|"
    return f"the root of {name_of(shape, part)}" if isinstance(part, ROperation) else name_of(shape, part)


def _root(culprit: Culprit) -> sp.Expr | None:
    """The root that vanishes at the culprit's point, None if there is none that this move can round."""
    part = culprit.part
    if isinstance(part, sp.Pow):
        return part.base if isinstance(part.base, sp.Abs) else sp.sqrt(part.base)
    if isinstance(part, sp.Max | sp.Min):
        return sum((sp.Abs(a - b) for a, b in combinations(part.args, 2)), sp.S.Zero)
    if not isinstance(part, ROperation):
        return part
    f, g = pair_of(part, culprit.level)
    if isinstance(part, R1Operation):
        return sp.Abs(f - g, evaluate=False)
    plain = isinstance(part, R0Operation | RAlphaOperation) and not isinstance(part, R0mOperation)
    return sp.sqrt(f**2 + g**2) if plain else None


def _change(part: sp.Expr, sizes: dict[int, Fraction]) -> Callable[[sp.Expr], sp.Expr]:
    if isinstance(part, ROperation):
        return lambda new: folded(new, {level: _operation(new, eps) for level, eps in sizes.items()})
    eps = sp.Rational(*sizes[0].as_integer_ratio())
    return lambda new: _rounded(new, eps)


def _operation(part: ROperation, size: Fraction) -> Operation:
    """The operation in plain arithmetic, its root rounded."""
    eps = sp.Rational(*size.as_integer_ratio())
    if isinstance(part, R1Operation):
        return lambda f, g: (f + g + part.sign * sp.sqrt((f - g) ** 2 + eps**2)) / 2
    alpha = part.parameters[0] if isinstance(part, RAlphaOperation) else sp.S.Zero
    return lambda f, g: (f + g + part.sign * sp.sqrt(f**2 + g**2 - 2 * alpha * f * g + eps**2)) / (1 + alpha)


def _rounded(part: sp.Expr, eps: sp.Rational) -> sp.Expr:
    """|u|, a power, a trimming, a minimum or maximum with its root rounded."""
    if isinstance(part, sp.Abs):
        return sp.sqrt(part.args[0] ** 2 + eps**2)
    if isinstance(part, sp.Pow):
        base = part.base
        return (sp.sqrt(base.args[0] ** 2 + eps**2) if isinstance(base, sp.Abs) else base + eps**2) ** part.exp
    if isinstance(part, Trimming):
        f, t = part.args
        return sp.sqrt(f**2 + ((sp.sqrt(t**2 + f**4) - t) / 2) ** 2 + eps**2)
    result, *rest = part.args
    sign = 1 if isinstance(part, sp.Max) else -1
    for operand in rest:
        result = (result + operand + sign * sp.sqrt((result - operand) ** 2 + eps**2)) / 2
    return result
