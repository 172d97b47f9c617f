"""Bodies made to deceive: each has a defect, or none, that a verdict might miss."""

import pytest
import sympy as sp

import rsym
from rsym import Shape, x, y, z
from rsym.verify.bodies import report_body, study_body

Q = sp.Rational
SQUARES = x**2 + y**2 + z**2
BALL = 1 - SQUARES
WINDOW = ((-1.61, 1.6), (-1.6, 1.62), (-1.59, 1.6))


def body(expression, bounds=WINDOW, budget=5_000):
    return report_body(study_body(Shape(expression, (x, y, z), bounds=bounds), bounds, {}, budget=budget))


# A choice may jump across zero where neither of its branches vanishes: a cut ball, its flat side without a zero, which
# is the boundary all the same and meets the sphere in an edge.
JUMPS = {
    "choice of signs": rsym.conjunction(BALL, sp.Piecewise((1, x > Q(1, 10)), (-1, True))),
    "choice of a sheet": sp.Piecewise((BALL, x > Q(1, 10)), (-1, True)),
    "choice beyond an edge": rsym.conjunction(BALL, sp.Piecewise((1, y > Q(3, 10)), (x + Q(1, 10), True))),
}


@pytest.mark.random
@pytest.mark.parametrize("name", JUMPS)
def test_a_jump_across_zero_is_no_smooth_boundary(name):
    report = body(JUMPS[name])
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert any(curve.proved for curve in report.curves)


# 1 where u > 0 and -1 elsewhere, written so that a sign might have a value of its own on u = 0: this stays a choice.
STEP = sp.sign(x - Q(1, 10)) + sp.sign(x - Q(1, 10)) ** 2 - 1


@pytest.mark.parametrize("omega", [rsym.conjunction(BALL, STEP), BALL * (STEP + 1) / 2 + (STEP - 1) / 2])
def test_a_jump_that_stays_in_its_leaf_is_left_open(omega):
    report = body(omega)
    assert report.verdict in ("REFUTED", "UNDECIDED", "DEGENERATE")
    assert len(report.cover.undecided)


# omega is 0 on the inner sphere, and positive on both of its sides.
INNER = Q(1, 4) - SQUARES
CRACKS = {
    "two operands": rsym.disjunction(INNER, -INNER),
    "three operands": rsym.disjunction(INNER, -INNER, -(INNER**2)),
}


@pytest.mark.parametrize("name", CRACKS)
def test_a_zero_within_a_body_is_no_smooth_boundary(name):
    report = body(rsym.conjunction(BALL, CRACKS[name]))
    assert report.verdict in ("DEGENERATE", "UNDECIDED")
    assert len(report.cover.undecided)


def test_two_halves_of_a_body_that_share_a_face_are_cracked():
    report = body(rsym.disjunction(INNER, -INNER))
    assert (report.verdict, report.continuity) == ("DEGENERATE", "broken")


def test_a_sheet_without_a_change_of_sign_is_not_regular_however_its_two_sides_are_written():
    """-|f| beside a ball: the constant is irrational, so that no polynomial shows that one side is minus the other."""
    sheet = rsym.conjunction(y + x**2 / 3 + sp.pi / 9, -y - x**2 / 3 - sp.pi / 9)
    ball = Q(1, 16) - (x - Q(1, 2)) ** 2 - (y - Q(1, 2)) ** 2 - (z - Q(1, 3)) ** 2
    report = body(rsym.disjunction(sheet, ball), ((-1, 1.1), (-1.2, 1), (-1.1, 1.2)), budget=20_000)
    assert report.verdict in ("DEGENERATE", "UNDECIDED")
    assert len(report.cover.undecided)
