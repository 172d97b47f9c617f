"""What is measured of shapes whose functions are steep, have kinks, poles, products and singular points."""

import math

import pytest
import sympy as sp

import rsym
from rsym import x, y, z

DISC, BALL = 1 - x**2 - y**2, 1 - x**2 - y**2 - z**2
WINDOW = ((-1.5, 1.5),) * 3


def holds(value, truth, most=1e-6):
    """An error below a relative one, and below the one that is stated."""
    error = abs(value - truth)
    return error <= most * abs(truth) and error <= value.error


@pytest.mark.parametrize(
    "steep", [sp.tanh(1000 * DISC), sp.atan(10**6 * DISC), sp.exp(300 * DISC) - 1, sp.erf(1000 * DISC)], ids=str
)
def test_what_rises_steeply_through_0_is_measured_as_what_it_rises_with(steep):
    found = rsym.measure(rsym.Shape(steep, (x, y), bounds=WINDOW[:2]))
    assert holds(found.area, math.pi, 1e-13)
    assert holds(found.length, 2 * math.pi, 1e-13)


def test_what_rises_steeply_through_0_is_meshed_as_what_it_rises_with():
    meshes = [rsym.mesh(rsym.Shape(steep, (x, y, z), bounds=WINDOW), 24) for steep in (BALL, sp.tanh(10**4 * BALL))]
    assert meshes[1].volume == pytest.approx(meshes[0].volume, rel=1e-9)


def box_distance(*sides):
    """The exact distance of a box of such half sides, positive inside."""
    beyond = [sp.Abs(place) - side for place, side in zip((x, y, z), sides, strict=False)]
    outside = sp.sqrt(sum(sp.Max(part, 0) ** 2 for part in beyond))
    return rsym.Shape(-outside - sp.Min(sp.Max(*beyond), 0), (x, y, z)[: len(sides)])


@pytest.mark.parametrize(
    ("shape", "area", "length"),
    [
        (rsym.Shape((x**2 + y**2 - 1) / x, (x, y), bounds=((-2, 2),) * 2), 8, 2 * math.pi + 8),
        (rsym.Shape(sp.sin(sp.pi * x) * sp.sin(sp.pi * y), (x, y), bounds=((-2, 2),) * 2), 8, 32),
        (rsym.Shape(x * y * (x - y), (x, y), bounds=((-1, 1),) * 2), 2, 4 + 2 * math.sqrt(2) + 4),
        (rsym.Shape(DISC * (x - 2) ** 2 * y**2, (x, y), bounds=WINDOW[:2]), math.pi, 2 * math.pi),
        (box_distance(1, 2), 8, 12),
        (rsym.Shape(2 - sp.exp(sp.Abs(x)) - sp.Abs(y), (x, y), bounds=WINDOW[:2]), 8 * math.log(2) - 4, None),
    ],
    ids=["pole", "chessboard", "lines", "even factors", "box", "exponential"],
)
@pytest.mark.filterwarnings("ignore:the shape's own bounds", "ignore:the shape ends where")
def test_products_quotients_and_choices_are_opened(shape, area, length):
    found = rsym.measure(shape)
    assert holds(found.area, area, 1e-12)
    assert length is None or holds(found.length, length, 1e-12)


@pytest.mark.filterwarnings("ignore:an integral is known to a relative error of about 1e-07")
def test_the_distance_of_a_line_is_two_arcs_that_touch_two_lines():
    distance = sp.sqrt((x - sp.Max(-1, sp.Min(1, x))) ** 2 + y**2)
    found = rsym.measure(rsym.Shape(1 - distance, (x, y), bounds=((-3, 3),) * 2))
    assert holds(found.area, math.pi + 4, 1e-12)
    assert holds(found.length, 2 * math.pi + 4, 1e-12)


def test_the_distance_of_a_box_is_six_planes():
    found = rsym.measure(box_distance(1, 2, 3))
    assert holds(found.volume, 48, 1e-12)
    assert holds(found.surface, 88, 1e-12)


def test_two_balls_by_a_minimum_whose_edge_runs_along_sides_of_cells():
    other = 1 - (x - sp.Rational(1, 2)) ** 2 - y**2 - z**2
    found = rsym.measure(rsym.Shape(sp.Min(BALL, other), (x, y, z), bounds=((-1.5, 2), (-1.5, 1.5), (-1.5, 1.5))))
    assert holds(found.volume, math.pi * 4.5 * 1.5**2 / 12, 1e-9)
    assert holds(found.surface, 3 * math.pi, 1e-9)
