"""What the R-operations, equivalence, joining and trimming promise."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import sympy as sp

from rsym.analysis.contracts import ends
from rsym.analysis.contracts.elementary import Least, Rule, below
from rsym.analysis.contracts.promises import Ends, Order, Promise, Signs, Singularity, weakest
from rsym.model import rnodes
from rsym.model.equivalences import Equivalence, Joining
from rsym.model.folds import Fold
from rsym.model.nodes import Trimming

_TRIMMED = 6  # trimming = |f| + |f|**7/(32 t**2) + ...


def pairs(part: Fold) -> Iterator[tuple[sp.Expr, sp.Expr]]:
    """The two operands of every step of a left fold.

    Examples
    --------
    >>> from rsym import conjunction, x, y, z
    >>> list(pairs(conjunction(x, y, z)))
    [(x, y), (conjunction(x, y), z)]
    """
    head = part.operands[0]
    for operand in part.operands[1:]:
        yield head, operand
        head = part.func(*part.parameters, head, operand)


def _operation(
    limit: Callable[[sp.Expr | None], Order],
    lost: Callable[[sp.Expr | None, sp.Expr, sp.Expr, str], list[Singularity]],
) -> Rule:
    """A conjunction or disjunction, monotone in every operand, that keeps orders up to a limit."""

    def rule(part: rnodes.ROperation, least: Least) -> Promise:
        meet, parameters = part.sign < 0, part.parameters
        name = "conjunction" if meet else "disjunction"
        parameter = parameters[0] if parameters else None
        return Promise(
            part.operands,
            law="positive where every operand is" if meet else "positive where some operand is",
            truth=min if meet else max,
            singular=tuple(s for f, g in pairs(part) for s in lost(parameter, f, g, name)),
            order=lambda orders: weakest(limit(parameter), *orders),
            monotone=(1,) * len(part.operands),
            image=ends.rising(lambda *values: part.func(*parameters, *values)),
        )

    return rule


def _corner(parameter: sp.Expr | None, f: sp.Expr, g: sp.Expr, name: str) -> list[Singularity]:
    return [Singularity((f, g), 0, name)]


def _tie(parameter: sp.Expr | None, f: sp.Expr, g: sp.Expr, name: str) -> list[Singularity]:
    return [Singularity((f - g,), 0, name)]


def _alpha(parameter: sp.Expr | None, f: sp.Expr, g: sp.Expr, name: str) -> list[Singularity]:
    """A letter may be 1, where the operations are min and max; the tie holds the corner too."""
    assert parameter is not None
    return _corner(parameter, f, g, name) if parameter.is_number and parameter < 1 else _tie(parameter, f, g, name)


def _p(parameter: sp.Expr | None, f: sp.Expr, g: sp.Expr, name: str) -> list[Singularity]:
    """|f|**p has a break in a derivative at f = 0 unless p is even."""
    assert parameter is not None
    even = parameter.is_Integer and parameter % 2 == 0
    breaks = [] if even else [Singularity((operand,), _kept(parameter), name) for operand in (f, g)]
    return [*_corner(parameter, f, g, name), *breaks]


def _kept(parameter: sp.Expr | None) -> int:
    """The class of |f|**p and the order that R_p keeps: a letter p is only known to be above 1."""
    return below(parameter) if parameter is not None and parameter.is_number else 1


def _at_least_one(parameter: sp.Expr) -> int:
    """A whole number m; a letter is only known to be 1 or more."""
    return int(parameter) if parameter.is_Integer else 1


def _r0m(part: rnodes.R0mOperation, least: Least) -> Promise:
    """Not monotone: the image is that of R_0 times that of r**m, step by step."""
    (m,) = part.parameters
    meet = part.sign < 0
    r0 = rnodes.R0Conjunction if meet else rnodes.R0Disjunction

    def step(f: Ends, g: Ends) -> Ends:
        low, high = (sp.sqrt(u**2 + v**2) ** m for u, v in zip(ends.size(f), ends.size(g), strict=True))
        return ends.product(ends.rising(r0)(f, g), (low, high))

    def image(first: Ends, *others: Ends) -> Ends:
        for other in others:
            first = step(first, other)
        return first

    name = "conjunction" if meet else "disjunction"
    return Promise(
        part.operands,
        law="positive where every operand is" if meet else "positive where some operand is",
        truth=min if meet else max,
        singular=tuple(Singularity((f, g), _at_least_one(m), name) for f, g in pairs(part)),
        order=lambda orders: 0,
        monotone=(None,) * len(part.operands),
        image=image,
    )


def _equivalence(part: Equivalence, least: Least) -> Promise:
    """Near f = 0 it is f*(1 - |f/g|**m/m + ...) up to sign: of class C^m there unless m is even."""
    (m,) = part.parameters
    even = m.is_Integer and m % 2 == 0
    lost = [Singularity(pair, 0, "equivalence") for pair in pairs(part)]
    if not even:
        lost += [Singularity((operand,), _at_least_one(m), "equivalence") for operand in part.operands]

    def image(first: Ends, *others: Ends) -> Ends:
        for other in others:
            first = ends.at_corners(lambda f, g: Equivalence(m, f, g))(first, other)
        return first

    return Promise(
        part.operands,
        law="positive where the signs agree: the product of the signs",
        truth=math.prod,
        singular=tuple(lost),
        order=lambda orders: weakest(_at_least_one(m), *orders),
        monotone=(None,) * len(part.operands),
        image=image,
    )


def _joining(part: Joining, least: Least) -> Promise:
    (m,) = part.parameters
    kinks = [Singularity((operand,), 0, "joining") for operand in part.operands if not operand.is_nonnegative]
    corners = [Singularity(pair, 0, "joining") for pair in pairs(part)]

    def truth(signs: Signs) -> int:
        return abs(math.prod(signs))

    def image(*operands: Ends) -> Ends:
        return ends.rising(lambda *values: Joining(m, *values))(*map(ends.size, operands))

    return Promise(
        part.operands,
        law="zero where some operand is, positive elsewhere",
        truth=truth,
        singular=(*kinks, *corners),
        order=lambda orders: weakest(_at_least_one(m), *orders),
        monotone=tuple(1 if operand.is_nonnegative else None for operand in part.operands),
        image=image,
    )


def _trimming(part: Trimming, least: Least) -> Promise:
    """A function of f**2 and t: its singular set is its own zero set, the kept part with its ends."""
    f, t = part.args

    def truth(signs: Signs) -> int:
        return int(not (signs[0] == 0 and signs[1] >= 0))

    def image(first: Ends, second: Ends) -> Ends:
        low, high = ends.size(first)
        return Trimming(low, second[1]), Trimming(high, second[0])

    return Promise(
        part.args,
        through=(f**2, t),
        law="zero where f = 0 <= t, positive elsewhere",
        truth=truth,
        singular=(Singularity((part,), 0, "trimming"),),
        order=lambda orders: weakest(_TRIMMED, orders[0]),
        monotone=(1 if f.is_nonnegative else None, -1),
        image=image,
    )


def _exact(parameter: sp.Expr | None) -> Order:
    return math.inf


def _first(parameter: sp.Expr | None) -> Order:
    return 1


def _alpha_order(parameter: sp.Expr | None) -> Order:
    return math.inf if parameter == 1 else 1


def declared(part: rnodes.ROperation, least: Least) -> Promise:
    """The promise of an operation whose class says what order it keeps."""
    kept = part.kept or 0
    return _operation(lambda parameter: kept, _corner)(part, least)


OPERATIONS: dict[type[sp.Basic], Rule] = {
    **dict.fromkeys((rnodes.R0Conjunction, rnodes.R0Disjunction), _operation(_first, _corner)),
    **dict.fromkeys((rnodes.R1Conjunction, rnodes.R1Disjunction), _operation(_exact, _tie)),
    **dict.fromkeys((rnodes.RAlphaConjunction, rnodes.RAlphaDisjunction), _operation(_alpha_order, _alpha)),
    **dict.fromkeys((rnodes.RpConjunction, rnodes.RpDisjunction), _operation(_kept, _p)),
    **dict.fromkeys((rnodes.R0mConjunction, rnodes.R0mDisjunction), _r0m),
    Equivalence: _equivalence,
    Joining: _joining,
    Trimming: _trimming,
}
