"""The table of promises: what R-operations, blends, choices and waves promise, and walks that read all rules.

Blends, choices and waves stand for a formula and know more than it shows.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import sympy as sp

from rsym.analysis.contracts import ends
from rsym.analysis.contracts.elementary import ELEMENTARY, Least, Rule, below
from rsym.analysis.contracts.promises import Ends, Order, Promise, Signs, Singularity, weakest
from rsym.errors import RsymError
from rsym.model import rnodes
from rsym.model.blends.displacement import BoundedDisplacement
from rsym.model.blends.rho import (
    CircularConjunction,
    CircularDisjunction,
    CubicConjunction,
    CubicDisjunction,
    RhoOperation,
)
from rsym.model.blends.sardf import SardfConjunction, SardfDisjunction, SardfOperation
from rsym.model.choices import Choice
from rsym.model.nodes import Fold, Trimming, written_out
from rsym.model.rnodes import Equivalence, Joining, ROperation
from rsym.model.symbols import with_operands
from rsym.model.symmetry.waves import SawtoothWave, TriangleWave, Wave

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

    def image(*operands: Ends) -> Ends:
        return ends.rising(lambda *values: Joining(m, *values))(*map(ends.size, operands))

    return Promise(
        part.operands,
        law="zero where some operand is, positive elsewhere",
        truth=lambda signs: abs(math.prod(signs)),
        singular=(*kinks, *corners),
        order=lambda orders: weakest(_at_least_one(m), *orders),
        monotone=tuple(1 if operand.is_nonnegative else None for operand in part.operands),
        image=image,
    )


def _trimming(part: Trimming, least: Least) -> Promise:
    """A function of f**2 and t: its singular set is its own zero set, the kept part with its ends."""
    f, t = part.args

    def image(first: Ends, second: Ends) -> Ends:
        low, high = ends.size(first)
        return Trimming(low, second[1]), Trimming(high, second[0])

    return Promise(
        part.args,
        through=(f**2, t),
        law="zero where f = 0 <= t, positive elsewhere",
        truth=lambda signs: int(not (signs[0] == 0 and signs[1] >= 0)),
        singular=(Singularity((part,), 0, "trimming"),),
        order=lambda orders: weakest(_TRIMMED, orders[0]),
        monotone=(1 if f.is_nonnegative else None, -1),
        image=image,
    )


def declared(part: rnodes.ROperation, least: Least) -> Promise:
    """The promise of an operation whose class says what order it keeps."""
    kept = part.kept or 0
    return _operation(lambda parameter: kept, _corner)(part, least)


OPERATIONS: dict[type[sp.Basic], Rule] = {
    **dict.fromkeys((rnodes.R0Conjunction, rnodes.R0Disjunction), _operation(lambda parameter: 1, _corner)),
    **dict.fromkeys((rnodes.R1Conjunction, rnodes.R1Disjunction), _operation(lambda parameter: math.inf, _tie)),
    **dict.fromkeys(
        (rnodes.RAlphaConjunction, rnodes.RAlphaDisjunction),
        _operation(lambda parameter: math.inf if parameter == 1 else 1, _alpha),
    ),
    **dict.fromkeys((rnodes.RpConjunction, rnodes.RpDisjunction), _operation(_kept, _p)),
    **dict.fromkeys((rnodes.R0mConjunction, rnodes.R0mDisjunction), _r0m),
    Equivalence: _equivalence,
    Joining: _joining,
    Trimming: _trimming,
}


_CLASS = {CircularConjunction: 1, CircularDisjunction: 1, CubicConjunction: 2, CubicDisjunction: 2}
_ON_FACES = "it holds on the faces; of the fillet nothing is promised"


def _rho(part: RhoOperation, least: Least) -> Promise:
    """Inside the tube the edge is rounded: a conjunction is less there than the sharp one, a disjunction more."""
    meet, parameters = part.sign < 0, part.parameters

    def truth(signs: Signs) -> int | None:
        if meet:
            return -1 if min(signs) < 0 else None
        return 1 if max(signs) > 0 else None

    tubes = tuple(part.func(*parameters, *pair).tube for pair in pairs(part))
    return Promise(
        part.operands,
        law="positive only where every operand is" if meet else "positive at least where some operand is",
        truth=truth,
        singular=tuple(Singularity((tube,), _CLASS[type(part)], "rho-blend") for tube in tubes),
        order=lambda orders: weakest(1, *orders),
        exception=_ON_FACES,
        monotone=(1,) * len(part.operands),
        image=ends.rising(lambda *values: part.func(*parameters, *values)),
    )


def _sardf(part: SardfOperation, least: Least) -> Promise:
    """Near its own boundary it is one of its operands."""
    meet, parameters = part.sign < 0, part.parameters
    reach = 1 + parameters[0]
    lost = []
    for f, g in pairs(part):
        # Zero where one operand is zero and the other past it.
        beyond = [sp.sqrt(f**2 + g**2) - part.sign * other for other in (f, g)]
        lost.append(Singularity((f, g), 0, "SARDF"))
        lost += [Singularity((edge,), 1, "SARDF") for edge in (reach * f - g, reach * g - f, *beyond)]
    return Promise(
        part.operands,
        law="positive where every operand is" if meet else "positive where some operand is",
        truth=min if meet else max,
        singular=tuple(lost),
        order=lambda orders: weakest(*orders),
        monotone=(1,) * len(part.operands),
        image=ends.rising(lambda *values: part.func(*parameters, *values)),
    )


def _choice(part: Choice, least: Least) -> Promise:
    """Nothing is known of how the two formulas meet."""
    a, b, yes, no = part.args
    return Promise(
        (yes, no),
        law="the sign of both formulas where they agree",
        truth=lambda signs: signs[0] if signs[0] == signs[1] else None,
        singular=(Singularity((a - b,), -1, "choice of a formula"),),
        monotone=(None, None),
        image=ends.hull,
    )


def _bounded(part: BoundedDisplacement, least: Least) -> Promise:
    """Between 0 and its height; where the edge f = g = 0 leaves the solid h > 0 it jumps."""
    f, g, h = part.args[4:]

    def image(tall: Ends, *others: Ends) -> Ends:
        return ends.least(sp.S.Zero, tall[0]), ends.greatest(sp.S.Zero, tall[1])

    return Promise(
        part.args,
        law="zero outside the bounding solid, inside it the sign of the height",
        truth=lambda signs: 0 if signs[-1] <= 0 else signs[0],
        singular=(Singularity((h,), 5, "bounded displacement"), Singularity((f, g, h), -1, "bounded displacement")),
        monotone=(None,) * len(part.args),
        image=image,
    )


def _wave(part: Wave, least: Least) -> Promise:
    """Kinks, or jumps, half-way between the cells."""
    t, period = part.args
    triangle = isinstance(part, TriangleWave)

    def image(place: Ends, width: Ends) -> Ends:
        return (ends.triangle if triangle else ends.sawtooth)(place, width[0], part.func)

    return Promise(
        part.args,
        law="",
        singular=(Singularity((sp.cos(sp.pi * t / period),), 0 if triangle else -1, part.word.replace("_", " ")),),
        monotone=(None, None),
        image=image,
    )


_PIECES: dict[type[sp.Basic], Rule] = {
    **dict.fromkeys(_CLASS, _rho),
    SardfConjunction: _sardf,
    SardfDisjunction: _sardf,
    Choice: _choice,
    BoundedDisplacement: _bounded,
    TriangleWave: _wave,
    SawtoothWave: _wave,
}
PROMISES: dict[type[sp.Basic], Rule] = {**ELEMENTARY, **OPERATIONS, **_PIECES}


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
    if rule is None and isinstance(part, ROperation) and part.kept is not None:
        rule = declared
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
