"""Paths and patches of known smoothness against `continuity` and `continuity_report`; proofs with a step left out.

The numbers of the cases rotate with the seed of the run, `--seed` repeats them; ``RSYM_OPPONENT_COUNT=300`` asks for
more of them.
"""

import os
from dataclasses import replace

import pytest
import sympy as sp
from oracles import opponent_patches as opponent
from oracles.tiers import SEED, some

from rsym import Curve, continuity
from rsym.surfaces.joints import edge_report
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.proofs import pole_proofs, proving, specialised, stretches
from rsym.surfaces.symbols import u, v
from rsym.verify.continuity import continuity as paths
from rsym.verify.continuity import curves
from rsym.verify.continuity import interiors as curve_interiors

R = sp.Rational
t = sp.Symbol("t", real=True)
COUNT = int(os.environ.get("RSYM_OPPONENT_COUNT", "0"))


def numbers(fixed, few):
    """Some numbers that stay, and some that rotate with the seed."""
    return [*some(range(fixed), 2), *range(1000 * SEED, 1000 * SEED + (COUNT or len(some(range(few), 2))))]


@pytest.mark.slow
def test_no_path_is_judged_wrongly():
    said = []
    for number in numbers(8, 6):
        path, claim = opponent.path(number)
        wrong, _ = path.false(claim)
        said += [(number, path.name, claim, one) for one in wrong]
    assert said == []


@pytest.mark.slow
def test_no_patches_are_judged_wrongly():
    said = []
    for number in numbers(12, 10):
        patches = opponent.patches(number)
        wrong, _ = patches.false()
        said += [(number, patches.name, one) for one in wrong]
    assert said == []


# Below, each is false if a step of a proof is left out.
LINE = Curve((t, 0), t, -1, 0)
SHEET = ParametricSurface((u, v, 0))


def certified(*given, **options):
    return continuity(given, **options).verdict == "CERTIFIED"


def proved(*patches):
    meetings = continuity_report(patches, prove=True).meetings
    return all(one.verdict == "CERTIFIED" for one in meetings)  # whatever is doubted between the edges


def pole_proved(*patches):
    return any(pole.verdict == "CERTIFIED" for pole in continuity_report(patches, prove=True).poles)


def equal(level, *patches):
    edges = continuity_report(patches, prove=True).edges
    return any(edge.proof.levels[level].status == "equal" for edge in edges if edge.patches == (0, 1))


def raised(height):
    return ParametricSurface((u, -v, height))


def torn(at, height=0):
    return ParametricSurface((u, -v, sp.Piecewise((height, u < at), (height, u > at), (height + sp.sqrt(2), True))))


def turning(height):
    return ParametricSurface((v * sp.cos(u), v * sp.sin(u), height), ((0, 2 * sp.pi), (0, 1)))


def edge_proved(*patches):
    report = continuity_report(patches, prove=True)
    return any(edge.verdict == "CERTIFIED" for edge in report.edges)


def always(value):
    return lambda *given, **options: value


def nothing(*given, **options):
    return iter(())


MACHIN = 4 * sp.atan(R(1, 5)) - sp.atan(R(1, 239)) - sp.pi / 4
# So narrow that samples pass it by.
BUMP = sp.exp(-((10**4 * (u - R(13, 40))) ** 2)) / 100


def smoothed(curve, at_start):
    end = curves.end_of(curve, at_start)
    return replace(end, unbounded=False, curvature=end.curvature or (sp.Integer(0),) * len(end.point))


def facts_with(index):
    """All facts, one of them said to hold in any case."""

    def said(pair, levels):
        known = FACTS(pair, levels)
        vanishing = tuple(one or place <= index for place, one in enumerate(known.vanishing))
        return proving.Facts(vanishing, known.regular)

    return said


FACTS = proving.facts
VANISHING = pole_proofs._vanishing


def vanishing_with(*places):
    def said(*given):
        return tuple(known or place in places for place, known in enumerate(VANISHING(*given)))

    return said


# name: (what is replaced, by what), and something false that is then said.
MUTATIONS = {
    "curves: what lies between the ends": (
        (paths, "_uncovered", nothing),
        lambda: certified(LINE, Curve((t, t**3 / (3 * t - 1)), t, 0, 1)),
    ),
    "curves: division where they stand still": (
        (curve_interiors._Motion, "is_regular", always(True)),
        lambda: certified(LINE, Curve((t - 3 * t**2 / 4, 0), t, 0, 1)),
    ),
    "curves: the free ends": (
        (paths, "_free_ends", nothing),
        lambda: certified(
            Curve((t**2, t**3), t, 0, 1), Curve((1 + 2 * t + t**2, 1 + 3 * t + 3 * t**2 + t**3), t, 0, 1)
        ),
    ),
    "curves: the remainder of the series": (
        (
            curve_interiors._Motion,
            "_velocity",
            lambda self, here, whole, order: [one[order] for one in self._series(here)],
        ),
        lambda: certified(LINE, Curve((t - t**2, 0), t, 0, R(3, 4))),
    ),
    "ends: zero is proved": (
        (paths, "all_vanish", lambda vector: curves.all_vanish(vector) is not False),
        lambda: certified(LINE, Curve((t, MACHIN * t), t, 0, 1)),
    ),
    "ends: tangents in one direction": (
        (paths, "dot", lambda a, b: abs(curves.dot(a, b))),
        lambda: certified(LINE, Curve((-t, 0), t, 0, 1)),
    ),
    "ends: fractional powers below the second": (
        (paths, "end_of", smoothed),
        lambda: certified(Curve((t, 0), t, -1, 0), Curve((t**3, t**5), t, 0, 1)),
    ),
    "edges: places where pieces meet": (
        (stretches, "check_unbroken", always(None)),
        lambda: proved(SHEET, torn(R(1, 3))),
    ),
    "edges: places where pieces meet, beside an end": (
        (specialised, "BESIDE", R(0)),
        lambda: edge_proved(ParametricSurface((u, v, sp.sin(u))), torn(R(1, 2), sp.sin(u))),
    ),
    "edges: the cover": (
        (proving, "survey", always(None)),
        lambda: proved(SHEET, ParametricSurface((u, -v, v * BUMP))),
    ),
    "edges: points agree": ((proving, "facts", facts_with(2)), lambda: equal(0, SHEET, raised(u * (1 - u) / 10**20))),
    "edges: normals agree": ((proving, "facts", facts_with(2)), lambda: equal(1, SHEET, raised(v * u / 10**20))),
    "edges: curvatures agree": ((proving, "facts", facts_with(2)), lambda: proved(SHEET, raised(v**2 * BUMP))),
    "edges: normals beside a pole": (
        (proving, "regular_end", always(True)),
        lambda: edge_proved(SHEET, ParametricSurface((u, -v * u**2, v**3))),
    ),
    "edges: all meetings count": (
        (edge_report.EdgeReport, "meetings", property(lambda report: report.edges)),
        lambda: proved(turning(v**2 * (1 + sp.sin(2 * u) ** 2))),
    ),
    "poles: the point": (
        (pole_proofs, "_vanishing", vanishing_with(0, 2)),
        lambda: pole_proved(turning(v**2 + sp.sin(u) / 10**10)),
    ),
    "poles: the normals": (
        (pole_proofs, "_vanishing", vanishing_with(1, 2)),
        lambda: pole_proved(turning(v / 10**12 + v**2)),
    ),
    "poles: the curvatures": (
        (pole_proofs, "_vanishing", vanishing_with(2)),
        lambda: pole_proved(turning(v**2 * (1 + sp.sin(2 * u) ** 2))),
    ),
    "poles: that directions turn": (
        (pole_proofs, "_turns", always(True)),
        lambda: pole_proved(ParametricSurface((v * sp.cos(u**3), v * sp.sin(u**3), v**3 * u), ((-1, 1), (0, 1)))),
    ),
}


@pytest.mark.parametrize("name", sorted(MUTATIONS))
def test_a_step_of_a_proof_that_is_left_out_is_noticed(name, monkeypatch):
    (owner, attribute, other), is_said = MUTATIONS[name]
    assert not is_said()
    monkeypatch.setattr(owner, attribute, other)
    assert is_said()
