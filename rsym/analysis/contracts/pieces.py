"""What blends, choices and waves promise: nodes that stand for a formula and know more than it shows."""

from __future__ import annotations

import sympy as sp

from rsym.analysis.contracts import ends
from rsym.analysis.contracts.elementary import Least, Rule
from rsym.analysis.contracts.operations import pairs
from rsym.analysis.contracts.promises import Ends, Promise, Signs, Singularity, weakest
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
from rsym.model.symmetry.waves import SawtoothWave, TriangleWave, Wave

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


PIECES: dict[type[sp.Basic], Rule] = {
    **dict.fromkeys(_CLASS, _rho),
    SardfConjunction: _sardf,
    SardfDisjunction: _sardf,
    Choice: _choice,
    BoundedDisplacement: _bounded,
    TriangleWave: _wave,
    SawtoothWave: _wave,
}
