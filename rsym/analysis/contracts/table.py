"""The table of promises: what blends, choices and waves promise, the rules of all nodes, and walks that read them.

Blends, choices and waves stand for a formula and know more than it shows.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.analysis.contracts import ends
from rsym.analysis.contracts.elementary import ELEMENTARY, Least, Rule
from rsym.analysis.contracts.operations import OPERATIONS, declared, pairs
from rsym.analysis.contracts.promises import Ends, Promise, Signs, Singularity, weakest
from rsym.errors import RsymError
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
from rsym.model.nodes import written_out
from rsym.model.rnodes import ROperation
from rsym.model.symmetry.waves import SawtoothWave, TriangleWave, Wave
from rsym.model.traversal import with_operands

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
