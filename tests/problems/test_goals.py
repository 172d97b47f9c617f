"""Numbers that are asked for, points, fluxes and others, and their estimates."""

import math

import pytest

import rsym
from rsym import x, y

HEAT = "-laplacian(u) = 0"
RING = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
SHIFTED = rsym.disc(2).named("rim") - rsym.disc(1, (0.5, 0)).named("bore")
# Between circles one in the other, by the conformal map that makes them concentric.
FLUX = 2 * math.pi / math.acosh((4 + 1 - 0.25) / 4)
GIVEN = {"rim": 1, "bore": 0}


@pytest.mark.parametrize(
    ("goal", "of", "truth"),
    [
        ("rim", lambda u: u.flux("rim"), FLUX),
        (lambda u: u.flux("bore"), lambda u: u.flux("bore"), -FLUX),
    ],
)
def test_a_flux_is_asked_for(goal, of, truth):
    u = rsym.solve(SHIFTED, HEAT, GIVEN, goal=goal, tolerance=1e-6)
    error = abs(of(u) / truth - 1)
    assert error < 3 * u.report.goal < 3e-6
    assert u.report.grades[-1].estimate == u.report.goal
    assert "asked for" in str(u.report)


@pytest.mark.parametrize("cells", [8, 12])
def test_points_and_slopes_of_given_cells_have_estimates(cells):
    value = rsym.solve(RING, HEAT, GIVEN, goal=(1.5, 0), cells=cells)
    slope = rsym.solve(RING, HEAT, GIVEN, goal=lambda u: u.gradient(0, 1.2)[1], cells=cells)
    assert abs(value(1.5, 0) / math.log2(1.5) - 1) < 3 * value.report.goal < 1e-2
    assert abs(slope.gradient(0, 1.2)[1] * 1.2 * math.log(2) - 1) < 3 * slope.report.goal < 1e-1


def test_forms_and_bodies_have_goals_too():
    u = rsym.solve_form(RING, lambda u, v, w: u.grad @ v.grad, lambda v, w: 0 * v, GIVEN, goal="rim", tolerance=1e-5)
    assert abs(u.flux("rim") * math.log(2) / (2 * math.pi) - 1) < 3 * u.report.goal < 3e-5
    quarter = RING & rsym.half_plane((1, 0), 0).named("left") & rsym.half_plane((0, 1), 0).named("below")
    held = {"bore": rsym.pressure(1), "left": rsym.roller(), "below": rsym.roller()}
    body = rsym.elasticity(quarter, held, young=1, poisson=0.3, goal=lambda b: b.stress(1, 0).yy, tolerance=1e-5)
    assert abs(body.stress(1, 0).yy * 3 / 5 - 1) < 3 * body.report.goal < 3e-5


@pytest.mark.parametrize(
    ("goal", "code"), [(3, "goal"), ((1, 2, 3), "goal"), ({}, "goal"), ("top", "goal"), ("nowhere", "unknown-part")]
)
def test_what_is_no_goal_is_refused(goal, code):
    plate = rsym.rectangle(1, 1) & rsym.Shape(0.5 - y + 0 * x, (x, y)).named("top")
    with pytest.raises(rsym.RsymError) as raised:
        rsym.solve(plate, HEAT, {"top": 1, ...: 0}, goal=goal, cells=8)
    assert raised.value.code == code
