"""What a formula says on a thin set alone: where a switch is zero, between the two sides that were compared.

The truth is known by construction: `below`, `at` and `above` are put together in every way that a formula can be,
and the boundary is whole where `at` is zero on x = 0 at the same points as the limits of the other two.
"""

import pytest
import sympy as sp
from numpy.testing import assert_allclose

import rsym
from rsym import x, y, z

DISC = 1 - x**2 - y**2
BALL = DISC - z**2
SQUARE = ((-2, 2),) * 2
CUBE = ((-1.5, 1.5),) * 3
Piecewise, And, Or, Not, sign = sp.Piecewise, sp.And, sp.Or, sp.Not, sp.sign

FORMS = {
    "three": lambda b, a, c, u: Piecewise((b, u < 0), (c, u > 0), (a, True)),
    "and": lambda b, a, c, u: Piecewise((a, And(u <= 0, u >= 0)), (b, u < 0), (c, True)),
    "nested": lambda b, a, c, u: Piecewise((b, u < 0), (Piecewise((c, u > 0), (a, True)), True)),
    "steps": lambda b, a, c, u: Piecewise((b, u < 0), (a, u <= 0), (c, True)),
    "not": lambda b, a, c, u: Piecewise((b, Not(u >= 0)), (c, Not(u <= 0)), (a, True)),
    "or": lambda b, a, c, u: Piecewise((Piecewise((b, u < 0), (c, True)), Or(u < 0, u > 0)), (a, True)),
    "scaled": lambda b, a, c, u: Piecewise((b, -3 * u > 0), (c, 2 * u > 0), (a, True)),
    "sign": lambda b, a, c, u: (b + c) / 2 + sign(u) * (c - b) / 2 + (1 - sign(u) ** 2) * (a - (b + c) / 2),
    "modulus": lambda b, a, c, u: sp.Abs(sign(u)) * Piecewise((b, u < 0), (c, True)) + (1 - sp.Abs(sign(u))) * a,
    "cube": lambda b, a, c, u: Piecewise((b, u < 0), (c, True)) + (1 - sign(2 * u) * sign(u)) * (a - c),
}

# Sides and what stands between them, where the boundary misses points or has more of them.
BROKEN = {
    "line, a step up": (y, y - 1, y),
    "line, a step down": (y, y + 1, y),
    "line, nothing": (y, sp.Integer(1), y),
    "line, all zero": (y, sp.Integer(0), y),
    "curve, a step": (y - x**4, y - 1, y),
    "slit disc": (DISC, sp.Integer(-1), DISC),
    "bridge": (DISC, sp.Integer(1), DISC),
    "other disc": (DISC, DISC - sp.Rational(1, 2), DISC),
    "a point far from the line": (y - 5, y, y - 5),
}

# The same zeros on x = 0, though not always the same values.
WHOLE = {
    "line": (y, y + x, y),
    "curve": (y - x**4, y, y + x**4),
    "twice": (y, 2 * y, y),
    "cubes": (y, y**3 + y, y),
    "disc": (DISC, DISC + x, DISC),
    "flat": (DISC, (DISC + x) * (2 + x), DISC),
}


def plane(expression, bounds=SQUARE, **options):
    return rsym.verify_smoothness(rsym.Shape(expression, (x, y), bounds=bounds), **options)


def space(expression, bounds=CUBE, **options):
    return rsym.verify_smoothness(rsym.Shape(expression, (x, y, z), bounds=bounds), method="space", **options)


@pytest.mark.parametrize("form", FORMS)
def test_every_form_has_the_value_that_it_was_given(form):
    """The oracle of this file is SymPy's own substitution."""
    whole = FORMS[form](y - x**4, y - 1, y + 2 * x, x)
    assert sp.expand(whole.subs(x, 0)) == y - 1
    assert sp.expand(whole.subs(x, -1)) == y - 1
    assert sp.expand(whole.subs(x, 1)) == y + 2


@pytest.mark.random
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", BROKEN)
def test_a_boundary_that_breaks_on_a_line_is_degenerate(form, name):
    report = plane(FORMS[form](*BROKEN[name], x))
    assert report.verdict == "DEGENERATE", str(report)
    assert report.continuity == "broken"
    assert {defect.kind for defect in report.defects if defect.proved} <= {"end", "isolated point"}


@pytest.mark.random
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", WHOLE)
def test_a_boundary_that_goes_on_through_a_line_is_certified(form, name):
    report = plane(FORMS[form](*WHOLE[name], x))
    assert report.verdict == "CERTIFIED", str(report)
    assert report.continuity in {"G2", "G3", "analytic"}


THIN = {u: 1 - sign(u) ** 2 for u in (x, y, z, x - y, x + 2 * y)}  # 1 where u is 0, else 0
THIRD = sp.Rational(1, 3)
RIGHT = (sign(x) + sign(x) ** 2) / 2  # 1 where x > 0, else 0; no gate, as sign might have a value of its own there


@pytest.mark.parametrize(
    ("expression", "kinds"),
    [
        (y - 1 + sign(x) ** 2, {((0, 0), "end"), ((0, 1), "isolated point")}),
        (DISC - 3 * (1 - sign(x - THIRD) ** 2), {((1 / 3, r), "end") for r in (-(8**0.5) / 3, 8**0.5 / 3)}),
        (
            DISC + sp.Rational(5, 4) * THIN[x],
            {((0, -1), "end"), ((0, 1), "end"), ((0, -1.5), "isolated point"), ((0, 1.5), "isolated point")},
        ),
        (y - RIGHT, {((0, 0), "end"), ((0, 1), "end")}),
        (DISC * (1 - RIGHT) - RIGHT, {((0, -1), "end"), ((0, 1), "end")}),
        (DISC * (1 - RIGHT) + RIGHT, {((0, -1), "end"), ((0, 1), "end")}),
        (y - 5 + 5 * THIN[x], {((0, 0), "isolated point")}),
    ],
)
def test_where_a_boundary_breaks_is_proved_and_located(expression, kinds):
    report = plane(expression)
    proved = [defect for defect in report.defects if defect.proved]
    assert report.verdict == "DEGENERATE"
    assert proved
    for defect in proved:
        near = [kind for point, kind in kinds if sp.Point(*point).distance(sp.Point(*defect.point)) < 1e-9]
        assert near == [defect.kind]


@pytest.mark.parametrize(
    ("expression", "corners"),
    [
        (y - Piecewise((0, x < 0), (1, True)), {(0, 0), (0, 1)}),
        (Piecewise((DISC, x < 0), (-1, True)), {(0, -1), (0, 1)}),
        (Piecewise((DISC, x <= 0), (1, True)), {(0, -1), (0, 1)}),
        (y + sign(x - THIRD) / 8, {(THIRD, -0.125), (THIRD, 0.125)}),
    ],
)
def test_a_boundary_goes_on_along_a_jump_over_zero(expression, corners):
    """The inside ends at the jump, on a straight line that meets the arcs at right angles."""
    report = plane(expression)
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert all(one.kind == "corner" and one.proved for one in report.defects)
    assert_allclose([one.tangent_jump for one in report.defects], 90, atol=1e-9)
    found = sorted(one.point for one in report.defects)
    assert_allclose(found, sorted([float(part) for part in corner] for corner in corners), atol=1e-9)


@pytest.mark.parametrize(
    "expression", [Piecewise((DISC, x < 1.5), (1, True)), Piecewise((1, x < 0), (-1, True)), sign(x), sign(DISC)]
)
def test_a_jump_over_zero_along_a_smooth_line_is_certified(expression):
    """A disc and, apart from it, a half-plane; a half-plane; a disc."""
    report = plane(expression)
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")


@pytest.mark.random
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize(
    "sides", [(DISC, -1, 2 * DISC), (-DISC, 1, -2 * DISC), (2 * DISC, -1, 3 - 3 * x**2 - 3 * y**2)]
)
def test_a_jump_with_a_value_of_its_own_is_not_certified(form, sides):
    """The two sides have one sign, and differ: the leaf jumps, and on the line between them it has the other sign."""
    report = plane(FORMS[form](*map(sp.sympify, sides), x), budget=4000)
    assert report.verdict in {"DEGENERATE", "UNDECIDED"}, str(report)


@pytest.mark.random
@pytest.mark.parametrize(
    "expression",
    [
        DISC * sign(x) ** 2,
        DISC + 3 * THIN[x + 2 * y],
        DISC - THIN[x - y],
        rsym.conjunction(DISC, y + 5 - 9 * THIN[x]),
        rsym.disjunction(DISC, 18 * THIN[x] - 9),
        sp.Min(DISC, 5 - 9 * THIN[x]),
        sp.Max(DISC, 9 * THIN[x] - 5),
        rsym.conjunction(DISC, 1 - 2 * THIN[x], system=rsym.RAlpha(THIRD)),
        sp.sqrt(2 + sign(x) ** 2) - sp.sqrt(3) + DISC,
        DISC - THIN[x] * sp.exp(y),
        sp.sin(y) - THIN[x],
        y - 1 + sign(x**2) ** 2,
        y - 1 + sign(x**3) ** 2,
        y - 1 + sign(x**2 + y**2) ** 2,
        y - Piecewise((0, x**2 > 0), (1, True)),
        y - Piecewise((0, sp.Abs(x) > 0), (1, True)),
        y - Piecewise((0, x > y), (0, y > x), (1, True)),
        DISC - 1 + sign(DISC) ** 2,
        Piecewise((DISC, DISC > 0), (DISC, DISC < 0), (1, True)),
        Piecewise((DISC, x < 0), (DISC, x > 0)),
        DISC.subs(x, x + THIN[x]),
        DISC + (1 + sign(x)) * (1 - sign(x)),
        Piecewise((DISC, Or(x < 0, y > 1)), (DISC, Or(x > 0, y < 1)), (-1, True)),
        Piecewise((DISC, Not(And(x <= 0, x >= 0, y > 0))), (-1, True)),
    ],
)
def test_nothing_thin_is_overlooked(expression):
    report = plane(expression, budget=4000)
    assert report.verdict in {"DEGENERATE", "UNDECIDED"}, str(report)


@pytest.mark.random
@pytest.mark.parametrize(
    "expression",
    [
        DISC * (1 + THIN[x]),
        DISC / (1 + THIN[x]),
        DISC * sp.exp(-THIN[x]),
        DISC + x * THIN[x],
        rsym.conjunction(DISC, y + 5 - 2 * THIN[x]),
        rsym.disjunction(DISC, 2 * THIN[x] - 9),
        sp.sin(y) * (1 + THIN[x]),
        y + x * sign(x) ** 2,
        y + x**3 * sign(x),
        y - sp.Max(x, 0) ** 3,
        y - x**2 * sp.Abs(x),
        DISC.subs(x, x * sign(x) ** 2),
        Piecewise((DISC, x < 0), (DISC, True)),
        Piecewise((DISC, x <= 0), (DISC, x > 0)),
        Piecewise((y, x < 0), (y - x**4, True)),
        Piecewise((y, x <= 0), (y - x**4, True)),
        Piecewise((DISC, Not(And(x <= 0, x >= 0, y > 2))), (-1, True)),
    ],
)
def test_what_is_whole_stays_certified(expression):
    assert plane(expression).verdict == "CERTIFIED"


def test_a_corner_between_three_functions_is_refuted():
    report = plane(Piecewise((y - x, x < 0), (y + x, x > 0), (2 * y, True)))
    assert report.verdict == "REFUTED"
    assert [(one.kind, one.point, round(one.tangent_jump, 9)) for one in report.defects] == [("corner", (0, 0), 90)]


@pytest.mark.slow
def test_a_letter_may_have_a_thin_set_too():
    """For one value of the letter in the range there is no boundary."""
    a = sp.Symbol("a", real=True)
    thin = Piecewise((DISC, a < 1), (DISC, a > 1), (-1, True))
    shape = rsym.Shape(thin, (x, y), letters={a: 1}, bounds=SQUARE)
    for letters in ({"a": (0.5, 1.5)}, {"a": (1, 2)}, {"a": (0, 1)}, {"a": 1}):
        assert rsym.verify_smoothness(shape, letters=letters, budget=2000).verdict in {"DEGENERATE", "UNDECIDED"}
    assert rsym.verify_smoothness(shape, letters={"a": (1.25, 2)}).verdict == "CERTIFIED"
    moved = rsym.Shape(DISC - 2 * (1 - sign(x - a) ** 2), (x, y), letters={a: 0}, bounds=SQUARE)
    assert rsym.verify_smoothness(moved, letters={"a": (-0.25, 0.25)}, budget=4000).verdict == "DEGENERATE"


@pytest.mark.slow
@pytest.mark.parametrize("form", ["three", "sign"])
def test_bodies_that_break_on_a_plane(form):
    slit = space(FORMS[form](BALL, sp.Integer(-1), BALL, x))
    assert slit.verdict == "DEGENERATE"
    (point,) = [point for point in slit.points if point.proved]
    assert point.kind == "end"
    assert abs(point.point[0]) < 1e-12
    assert abs(sum(part**2 for part in point.point) - 1) < 1e-12
    assert space(FORMS[form](z - x**4, z - 1, z, x)).verdict == "DEGENERATE"
    whole = space(FORMS[form](z - x**4, z, z + x**4, x))
    assert (whole.verdict, whole.continuity) == ("CERTIFIED", "G3")


@pytest.mark.slow
@pytest.mark.parametrize("expression", [z * sign(x) ** 2, BALL * sign(x - y) ** 2, BALL - 1 + sign(x**2 + y**2) ** 2])
def test_planes_and_lines_on_which_a_body_is_zero(expression):
    assert space(expression, budget=20_000).verdict in {"DEGENERATE", "UNDECIDED"}


@pytest.mark.slow
def test_a_curve_that_belongs_to_no_sheet():
    """On x = 0 the boundary has the line z = 1/2 besides; around it omega is positive."""
    report = space(z + 1 - (1 - sign(x) ** 2) * sp.Rational(3, 2), bounds=((-0.9, 0.9),) * 3)
    assert report.verdict == "DEGENERATE"
    assert [point.kind for point in report.points if point.proved] == ["no sign change"]


@pytest.mark.random
@pytest.mark.parametrize("form", ["three", "and", "nested", "sign"])
def test_meridians(form):
    def body(*parts):
        shape = rsym.Shape(FORMS[form](*parts, z), (x, y, z), bounds=CUBE)
        return rsym.verify_smoothness(shape, method="meridian").verdict

    assert body(BALL, sp.Integer(-1), BALL) == "DEGENERATE"
    assert body(BALL, BALL - sp.Rational(1, 2), BALL) == "DEGENERATE"
    assert body(BALL, BALL + z, BALL) == "CERTIFIED"


@pytest.mark.slow
def test_the_axis_of_a_body_is_a_thin_set():
    """Without its poles a ball is no body with a boundary; whatever a formula says where the radius is negative."""
    for omega in (BALL - 1 + sign(x**2 + y**2) ** 2, Piecewise((BALL, x**2 + y**2 > 0), (-1, True))):
        shape = rsym.Shape(omega, (x, y, z), bounds=CUBE)
        for method in ("meridian", "space"):
            assert rsym.verify_smoothness(shape, method=method).verdict in {"DEGENERATE", "UNDECIDED"}


def test_curves_with_pieces_are_judged_by_their_pieces_or_refused():
    t = sp.Symbol("t", real=True)
    for jump in (Piecewise((0, t < 1), (0, t > 1), (1, True)), 1 - sign(t - 1) ** 2):
        with pytest.raises(rsym.RsymError):
            rsym.continuity([rsym.Curve((t, jump), t, 0, 1), rsym.Curve((t, sp.Integer(0)), t, 1, 2)])


@pytest.mark.random
@pytest.mark.parametrize(
    "expression",
    [
        DISC * (1 - RIGHT.subs(x, x - 1.5)) + RIGHT.subs(x, x - 1.5),
        Piecewise((DISC, x < 0), (DISC, x > 0), (DISC**2 + 1, True)),
        Piecewise((DISC, Or(x < 0, x > 0, y > 0.5, y < -0.5)), (-1, True)),
        1 - 2 * RIGHT,
        sign(x) * (1 + sign(x)) - 1,
    ],
)
def test_a_leap_over_zero_is_not_certified(expression):
    """Omega changes its sign where it is not zero, or on a thin set alone."""
    report = plane(expression, budget=4000)
    assert report.verdict in {"UNDECIDED", "DEGENERATE"}, str(report)


@pytest.mark.slow
@pytest.mark.parametrize("form", ["three", "and", "sign"])
def test_the_inside_of_a_thin_set_counts(form):
    """On x = 0 omega is zero where its limits are, but of the other sign."""
    assert plane(FORMS[form](DISC, -DISC, DISC, x), budget=4000).verdict == "UNDECIDED"


@pytest.mark.slow
def test_a_leap_in_space():
    late = RIGHT.subs(x, x - sp.Rational(5, 4))
    report = space(BALL * (1 - late) + late)
    assert report.verdict == "UNDECIDED"
    assert any("jumps over zero" in sentence for sentence, proved in report.statements if proved)
