"""Functions of finite class: powers of |u| and several switches on one box, with truths derived by hand."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from itertools import product

import mpmath
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.verify.boxes.classes import pieces
from rsym.verify.boxes.folding import folded
from rsym.verify.boxes.local import Model
from rsym.verify.cleaning import cleaned

BOX = ((-1.5, 1.5),) * 3
R = sp.Rational


def _shape(expression, bounds=BOX):
    return rsym.Shape(expression, (x, y, z), bounds=bounds)


def _norm(exponent, other=None):
    return 1 - sp.Abs(x) ** exponent - sp.Abs(y) ** (other or exponent) - sp.Abs(z) ** exponent


# The level sets of sums of |u|**p: three switches, any two of which cross on the boundary.
NORMS = {
    "3": (_norm(3), "G2"),
    "5/2": (_norm(R(5, 2)), "G2"),
    "7/2": (_norm(R(7, 2)), "G3"),
    "5": (_norm(5), "G3"),
    "3 and 5/2": (_norm(3, R(5, 2)), "G2"),
    "two": (1 - sp.Abs(x) ** R(5, 2) - sp.Abs(y) ** 3 - z**2, "G2"),
    "max": (1 - z - x**2 - sp.Max(x - y, 0) ** 3 - sp.Abs(x + y) ** R(5, 2), "G2"),
    "root": (1 - sp.sqrt(sp.Abs(x) ** 5) - x**2 * sp.sqrt(sp.Abs(y) ** 5) - sp.Abs(y) ** 3 - z**2, "G2"),
}


@pytest.mark.random
@pytest.mark.parametrize("name", NORMS)
def test_a_sum_of_powers_is_as_smooth_as_its_worst(name):
    expression, continuity = NORMS[name]
    report = rsym.verify_smoothness(_shape(expression), method="space")
    assert (report.verdict, report.continuity) == ("CERTIFIED", continuity)


@pytest.mark.slow
def test_motions_change_nothing():
    body = _shape(_norm(3)).rotate(R(1, 2), axis=z).translate(R(1, 3), R(1, 7), R(1, 11))
    report = rsym.verify_smoothness(body, method="space")
    assert (report.verdict, report.continuity) == ("CERTIFIED", "G2")


# Kinks and jumps of curvature that a careless rule for several switches would overlook.
ROUGH = {
    "square times kink": z - x**2 * sp.Abs(y),
    "kinks together": z - (sp.Abs(x) + sp.Abs(y)) ** 3,
    "larger": z - sp.Max(x, y, 0) ** 3,
    "jump of curvature": z - x * sp.Abs(x) - sp.Abs(y) ** 3,
    "product": z - sp.Abs(x) * sp.Abs(y),
    "3/2": 1 - sp.Abs(x) ** R(3, 2) - sp.Abs(y) ** 3 - z**2,
    "half a jump": z - sp.Max(x, 0) ** 2 - sp.Max(y, 0) ** 3,
    "value on a plane": z - sp.Abs(x) ** 3 - sp.Piecewise((0, y < 0), (0, y > 0), (1, True)) * sp.Abs(y + 1) ** 3,
}


@pytest.mark.random
@pytest.mark.parametrize("name", ROUGH)
def test_what_is_not_curved_continuously_is_not_certified(name):
    report = rsym.verify_smoothness(_shape(ROUGH[name]), method="space", budget=8_000)
    assert report.verdict != "CERTIFIED"


@pytest.mark.parametrize(
    ("expression", "count", "order"),
    [
        (sp.Abs(x) ** 3 * sp.Abs(y) ** 3, 2, 3),  # |x*y|**3
        (sp.Max(x - y, 0) ** 3 + sp.Abs(x) ** 3, 4, 3),
        (x**2 * sp.Abs(y) ** R(5, 2) + sp.Abs(x) ** 3, 2, 2.5),
        (sp.Max(sp.Abs(x) ** 3, -1) + z, 2, 3),
        (sp.Abs(x) * sp.Abs(y), 0, 0),
        (sp.Abs(sp.Abs(x) - sp.Abs(y)) ** 3, 0, 0),  # |x| and |y| have kinks where their difference is not zero
        (sp.sign(x) * x**4 + sp.Abs(y) ** 3, 0, 0),  # a value of its own on x = 0
        (sp.Piecewise((x**3, x < 0), (2 * x**3, True)) + sp.Abs(y) ** 3, 4, 3),
        (sp.Piecewise((x**3, x < 0), (2 * x**3, x > 0), (1, True)) + sp.Abs(y) ** 3, 0, 0),
        (sp.Piecewise((0, x + sp.Max(y, 0) ** 3 < 0), (1, True)) + sp.Abs(y) ** 3, 0, 0),  # a test with a kink
        (sp.Min(x, R(1, 2)) + sp.Max(x - R(1, 2), 0), 1, math.inf),
        (sp.Max(x, y) + sp.Min(x, y), None, math.inf),
        (sp.sqrt(sp.Abs(x)) * x**4 + sp.Abs(y) ** 3, 2, 3),
    ],
)
def test_pieces_and_their_order(expression, count, order):
    model = Model(_shape(cleaned(expression)), {})
    found = pieces(model.over(((-1, 1),) * 3), model.root)
    assert found.order == order
    assert count is None or len(found.nodes) == count


FORMS = (x, y, z, x - y, x + 2 * z, y - z + 1, x + y + z)


def _random_function(chance):
    """A polynomial of |l|**a, max(l, 0)**a and x, y, z, in which orders are lost and won."""
    total = sp.S.Zero
    for _ in range(chance.randint(1, 3)):
        term = sp.Integer(chance.choice([1, -2, 3]))
        for _ in range(chance.randint(1, 3)):
            form, power = chance.choice(FORMS), chance.choice([1, 2, 3, 3, 4, R(5, 2), R(7, 2)])
            kind = chance.randrange(4)
            term *= (sp.Abs(form), sp.Max(form, 0), form, sp.Abs(form))[kind] ** (int(power) if kind == 2 else power)
        total += term
    return total + z


def _jumps(expression, order, form, chance):
    """Whether a derivative of this order across a plane is seen to jump, at 60 digits, by one-sided differences."""
    normal = [sp.diff(form, symbol) for symbol in (x, y, z)]
    with mpmath.workdps(120):
        free = {symbol: R(chance.randint(-700, 700), 997) for symbol in (x, y, z)}
        size = sum(part**2 for part in normal)
        foot = [free[symbol] - form.subs(free) * part / size for symbol, part in zip((x, y, z), normal, strict=True)]
        function = sp.lambdify((x, y, z), expression, "mpmath")

        def along(t):
            return function(*(mpmath.mpf(p.p) / p.q + t * int(n) for p, n in zip(foot, normal, strict=True)))

        step = mpmath.mpf(10) ** -20
        sides = []
        for side in (1, -1):
            terms = [(-1) ** (order - k) * mpmath.binomial(order, k) * along(side * step * k) for k in range(order + 1)]
            sides.append(mpmath.fsum(terms) / (side * step) ** order)
        return abs(sides[0] - sides[1]) > mpmath.mpf(10) ** -6


@pytest.mark.random
@pytest.mark.parametrize("seed", range(12))
def test_no_derivative_below_the_order_jumps(seed):
    chance = random.Random(seed)
    for _ in range(3):
        expression = _random_function(chance)
        model = Model(_shape(cleaned(expression)), {})
        found = pieces(model.over(((-1.0, 1.0),) * 3), model.root)
        smooth = [k for k in range(1, 5) if k < found.order]
        assert not any(_jumps(expression, k, form, chance) for k, form in product(smooth, FORMS))


def test_the_oracle_sees_jumps():
    chance = random.Random(1)
    assert _jumps(sp.Abs(x) ** 3 + y, 3, x, chance)
    assert not _jumps(sp.Abs(x) ** 3 + y, 2, x, chance)


def test_powers_of_moduli_are_gathered_and_equal():
    for expression, written in (
        (x**2 * sp.Abs(x), "|x|**3"),
        (sp.Abs(x) ** R(5, 2), "|x|**(5/2)"),
        (x**3 * sp.Abs(x) * y, "y*sign(x)*|x|**4"),
        (sp.sqrt(2) * x**2 * sp.Abs(x) / 2, "sqrt(2)*|x|**3/2"),
        (x * sp.Abs(x), "x*Abs(x)"),
        (x**2 / sp.Abs(x), "x**2/Abs(x)"),  # not defined at x = 0
    ):
        found = cleaned(expression)
        assert str(found) == written
        for place in (Fraction(-7, 5), Fraction(3, 11)):
            values = {x: R(place.numerator, place.denominator), y: R(2, 7)}
            assert abs(sp.N((found.doit() - expression).subs(values))) < 1e-14


def _ball(centre, radius):
    return radius**2 - sum((symbol - place) ** 2 for symbol, place in zip((x, y, z), centre, strict=True))


FIFTH = rsym.Sardf(R(1, 5))


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "verdict", "curves"),
    [
        (FIFTH.conjunction(x, y), "REFUTED", 1),
        (FIFTH.conjunction(1 - x**2, 1 - y**2, 1 - z**2), "REFUTED", 12),
        (-2 * FIFTH.disjunction(_ball((0, 0, 0), R(1, 2)), _ball((R(1, 2), R(1, 7), 0), R(1, 2))), "REFUTED", 1),
        (FIFTH.disjunction(_ball((-R(1, 2), 0, 0), R(1, 3)), _ball((R(1, 2), 0, 0), R(1, 3))), "CERTIFIED", 0),
        (rsym.R0.conjunction(FIFTH.disjunction(x, y - 3), z + 3), "CERTIFIED", 0),
    ],
)
def test_the_zero_set_of_sardf_is_that_of_min_and_max(expression, verdict, curves):
    report = rsym.verify_smoothness(_shape(expression), method="space")
    assert (report.verdict, len(report.curves)) == (verdict, curves)


def test_the_values_of_sardf_count_inside_other_operations():
    # The level line of a fifth is rounded: its curvature jumps where the arc ends, though the zero set has a corner.
    shape = rsym.Shape(FIFTH.conjunction(x, y) - R(1, 2), (x, y), bounds=((-2, 2), (-2, 2)))
    report = rsym.verify_smoothness(shape)
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")


def test_overlapping_balls_of_a_row_have_an_edge():
    ball = rsym.Shape(_ball((0, 0, 0), R(1, 2)), (x, y, z), bounds=((-R(3, 4), R(3, 4)),) * 3)
    for count in (2, 3):
        report = rsym.verify_smoothness(rsym.row(ball, R(4, 5), count=count))
        assert (report.verdict, report.continuity) == ("REFUTED", "G0")
        assert len(report.defects) == count - 1
        # Half the distance of the centres is 2/5: the edge has the radius 3/10, and turns by 2 asin(4/5).
        assert all(abs(one.point[1] - 0.3) < 1e-12 for one in report.defects)
        assert all(abs(one.tangent_jump - 106.26020470831196) < 1e-9 for one in report.defects)


SUM = sp.Max(x, y, z) + sp.Min(x, y, z) + sp.Max(sp.Min(x, y), sp.Min(y, z), sp.Min(x, z))


@pytest.mark.parametrize(
    ("expression", "polynomial"),
    [
        (SUM, x + y + z),
        (sp.Min(x, R(1, 2)) + sp.Max(x - R(1, 2), 0), x),
        (sp.Abs(x - y) ** 2 + z, (x - y) ** 2 + z),
        (sp.Max(x, y) * sp.Min(x, y) - z, x * y - z),
        (SUM + sp.Max(x, y), None),
        (sp.Max(x, y) + 2 * sp.Min(x, y), None),
        (sp.Abs(x) + sp.Abs(y), None),
        (sp.Max(x, y, z) ** 2 + sp.Min(x, y, z) ** 2, None),
        (x + sp.sign(y) ** 2, None),  # x + 1 but where y = 0
        (x + sp.Piecewise((0, y < 0), (0, y > 0), (1, True)), None),
    ],
)
def test_folds_that_cancel_leave_a_polynomial(expression, polynomial):
    model = Model(_shape(expression), {})
    found = folded(model.over(((-1, 1),) * 3), model.root)
    assert (found is None) == (polynomial is None)
    if polynomial is not None:
        assert sp.expand(found.as_expr() - polynomial) == 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_what_folds_to_a_polynomial_has_its_values(seed):
    chance = random.Random(seed)
    for _ in range(10):
        first, second, third = (sum(chance.randint(-2, 2) * one for one in (x, y, z, 1)) for _ in range(3))
        low, high = sp.Min(first, second), sp.Max(first, second)
        k = chance.choice([1, 2])
        total = low**k + high**k + chance.choice([0, 0, 1]) * sp.Max(high, third) + chance.choice([0, 1]) * low * high
        model = Model(_shape(total + z), {})
        found = folded(model.over(((-1, 1),) * 3), model.root)
        for _ in range(5 if found is not None else 0):
            place = {symbol: R(chance.randint(-99, 99), 100) for symbol in (x, y, z)}
            assert (total + z - found.as_expr()).subs(place) == 0


@pytest.mark.slow
def test_a_ball_in_all_chambers_is_analytic_on_a_mirror_and_has_edges_beside_one():
    def balls(*centre):
        ball = rsym.Shape(_ball(centre, R(1, 3)), (x, y, z), bounds=BOX)
        return rsym.mirror_group(ball, "tetrahedral").replace(bounds=BOX)

    report = rsym.verify_smoothness(balls(1, 1, 1), method="space")
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
    report = rsym.verify_smoothness(balls(1, R(9, 10), 0), method="space", budget=6_000)
    assert report.verdict != "CERTIFIED"


@pytest.mark.random
@pytest.mark.parametrize("count", [None, 3])
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize(("radius", "verdict"), [("2/5", "CERTIFIED"), ("3/5", "REFUTED")])
def test_rows_of_any_motif_are_decided_where_the_field_is_cut(count, dimension, radius, verdict):
    ball = rsym.Shape(sp.Rational(radius) ** 2 - sum(c**2 for c in (x, y, z)[:dimension]), (x, y, z)[:dimension])
    body = rsym.row(ball, 1, count=count, motif="any").replace(bounds=((-1.7, 1.6), *((-0.8, 0.8),) * (dimension - 1)))
    assert rsym.verify_smoothness(body).verdict == verdict


@pytest.mark.slow
@pytest.mark.parametrize("order", [2, 3, 5, 6])
def test_fans_of_any_motif_are_decided_where_the_field_is_cut(order):
    disc = rsym.Shape(sp.Rational(1, 16) - (x - sp.Rational(1, 8)) ** 2 - (y - sp.Rational(1, 5)) ** 2, (x, y))
    fan = rsym.cyclic(disc, order, radius=2, motif="any").replace(bounds=((-2.7, 2.7),) * 2)
    assert rsym.verify_smoothness(fan).verdict == "CERTIFIED"


@pytest.mark.slow
@pytest.mark.parametrize("order", [5, 6])
def test_a_fan_whose_motif_is_cut_ends_at_the_border(order):
    disc = rsym.Shape(1 - (x - sp.Rational(1, 8)) ** 2 - (y - sp.Rational(3, 4)) ** 2, (x, y))
    fan = rsym.cyclic(disc, order, radius=2, motif="any").replace(bounds=((-3.7, 3.7),) * 2)
    report = rsym.verify_smoothness(fan)
    ends = [one for one in report.defects if one.proved]
    assert report.verdict == "DEGENERATE"
    assert {one.kind for one in ends} == {"end"}
    angles = [math.atan2(one.point[1], one.point[0]) * order / math.pi for one in ends]
    assert all(abs(angle - round(angle)) < 1e-6 and round(angle) % 2 == 1 for angle in angles)


def test_the_border_of_a_finite_row_of_any_motif_belongs_to_the_cell_before_it():
    slope = rsym.row(rsym.Shape(x, (x, y)), 2, count=3, motif="any")
    assert rsym.compile(slope)([1.0, 3.0, 5.0], 0.0)["value"].tolist() == [1.0, 1.0, 1.0]
