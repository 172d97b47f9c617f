"""What is measured of shapes whose functions are steep, have kinks, poles, products and singular points."""

import math
import random
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from oracles.tiers import SEED

import rsym
from rsym import x, y, z
from rsym.sampling.rules.division import undivided
from rsym.sampling.rules.quadrature import prepared
from rsym.sampling.rules.refinement import _apart

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
        (rsym.Shape(sp.tanh(5 * sp.Piecewise((DISC, x > DISC), (x, True))), (x, y)), math.pi / 2, math.pi + 2),
        (rsym.Shape(2 - sp.exp(sp.Abs(x)) - sp.Abs(y), (x, y), bounds=WINDOW[:2]), 8 * math.log(2) - 4, None),
    ],
    ids=["pole", "chessboard", "lines", "even factors", "box", "conditions", "exponential"],
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


def test_a_sum_of_odd_powers_is_no_boundary_without_slopes():
    disc = DISC**3 + y**3 / 8  # in sign DISC + y/2
    found = rsym.measure(rsym.Shape(disc, (x, y), bounds=WINDOW[:2]))
    assert holds(found.area, math.pi * 17 / 16, 1e-13)
    assert holds(found.length, 2 * math.pi * math.sqrt(17 / 16), 1e-13)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.filterwarnings("ignore:the shape's own bounds", "ignore:the shape ends where")
def test_a_parabola_by_roots_touches_the_ends_of_their_domains(sign):
    found = rsym.measure(rsym.Shape(sign * (1 - sp.sqrt(x) - sp.sqrt(y)), (x, y), bounds=((-1, 2),) * 2))
    arc = 1 + math.log(1 + math.sqrt(2)) / math.sqrt(2)
    assert holds(found.area, 1 / 6 if sign > 0 else 4 - 1 / 6, 1e-12)
    assert holds(found.length, arc if sign > 0 else arc + 4, 1e-12)


def test_of_a_window_without_the_shape_all_is_0():
    found = rsym.measure(rsym.Shape(DISC, (x, y)), bounds=((5, 6), (5, 6)))
    assert (found.area, found.length) == (found.area.error, found.length.error) == (0, 0)
    assert str(found).startswith("Area 0, length 0, ")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:an integral is known to a relative error of about 1e-06")
def test_the_heart_has_a_volume_and_a_surface():
    round_ = x**2 + sp.Rational(9, 4) * y**2 + z**2 - 1
    found = rsym.measure(rsym.Shape(x**2 * z**3 + sp.Rational(9, 80) * y**2 * z**3 - round_**3, (x, y, z)))
    # The integral of sqrt(c**2 - 4*(x**2 + 9/4*y**2 - 1)), c the cube root of x**2 + 9/80*y**2, over where it is real.
    assert holds(found.volume, 3.345101518288572687)
    assert found.surface.error < 2e-6 * found.surface


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:an integral is known to a relative error of about [1-9]e-07")
def test_a_rounded_cup_whose_flush_faces_are_multiples_of_one_another():
    cup = rsym.cylinder(20, 40, system=rsym.Rho(3)) - rsym.cylinder(17, 40, system=rsym.Rho(3)).translate(0, 0, 3)
    found = rsym.measure(cup)

    def cut(radius):  # by Pappus: what a rounded edge lacks
        return 2 * math.pi * ((radius - 3) * 9 * (1 - math.pi / 4) + 4.5)

    assert holds(found.volume, math.pi * (400 * 40 - 289 * 37) - 2 * cut(20) + cut(17))
    assert holds(found.parts["20 - Abs(z)"], 289 * math.pi)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the shape's own bounds", "ignore:an integral is known to a relative")
def test_the_faces_that_a_surface_with_four_nodes_touches_along_lines_have_no_area():
    cubic = rsym.Shape(1 - (x**2 + y**2 + z**2 - 2 * x * y * z), (x, y, z), bounds=((-1, 1),) * 3)
    found = rsym.measure(cubic)
    assert holds(found.volume, math.pi**2 / 2)
    assert holds(found.surface, 5 * math.pi)
    caps = [part for name, part in found.parts.items() if name.startswith("cap")]
    assert len(caps) == 6
    assert all(abs(cap) <= cap.error for cap in caps)


def test_of_leaves_that_are_multiples_of_one_another_one_sign_is_asked():
    """Of a and (s or not a and u) the sign does not hang on u where all three are open."""
    a, s, u = (rsym.Shape(leaf, (x, y)) for leaf in (y + x / 4, x - y / 8, 1 - 2 * x - (y - 1) ** 2))
    shape = a & (s | (~rsym.Shape(3 * y + sp.Rational(3, 4) * x, (x, y)) & u)) & rsym.disc(3)
    functions = prepared(shape, None, None).functions
    pieces = undivided(*np.array([[[-0.01], [-0.01]], [[0.01], [0.01]]]), np.array([0]), functions.count)
    value, gradient = functions.enclose(pieces.leaf, pieces.lower[:, pieces.piece], pieces.upper[:, pieces.piece])
    _, verdict, kept = functions.judge(replace(pieces, gradient=gradient), value)
    assert (verdict[0], kept.sum()) == (0, 3)


@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")  # the bounds cut it, and it ends where the root does
def test_a_root_whose_factor_changes_its_sign_is_measured():
    found = rsym.measure(rsym.Shape(sp.Rational(1, 4) + x * sp.sqrt(y), (x, y), bounds=((-1, 1),) * 2))
    assert holds(found.area, 23 / 16, 1e-12)


@pytest.mark.slow
def test_three_edges_that_meet_and_a_tip_are_measured():
    place = 1 / sp.sqrt(8)
    corners = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    balls = [1 - (x - a * place) ** 2 - (y - b * place) ** 2 - (z - c * place) ** 2 for a, b, c in corners]
    found = rsym.measure(rsym.Shape(sp.Min(*balls), (x, y, z), bounds=((-1, 1),) * 3), order=6)
    assert holds(found.volume, 8 * math.pi / 3 - 27 / 4 * math.acos(1 / 3) + math.sqrt(2) / 4)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:an integral is known")
def test_a_cone_by_its_distance_from_the_axis():
    found = rsym.measure(rsym.Shape(sp.Min(1 - z, z - sp.sqrt(x**2 + y**2)), (x, y, z), bounds=WINDOW))
    assert holds(found.volume, math.pi / 3)
    assert holds(found.surface, math.pi * (1 + math.sqrt(2)))


@pytest.mark.slow
def test_a_torus_is_known_to_more_than_six_digits():
    tube = sp.Rational(1, 4) - (sp.sqrt(x**2 + y**2) - 1) ** 2 - z**2
    found = rsym.measure(rsym.Shape(sp.atan(9 * tube), (x, y, z)), tolerance=1e-7)
    for value, truth in ((found.volume, math.pi**2 / 2), (found.surface, 2 * math.pi**2)):
        assert abs(value - truth) <= value.error < 1e-6 * truth


@pytest.mark.parametrize(("shape", "content"), [(rsym.sphere(1), 4 * math.pi / 3), (rsym.disc(2), 4 * math.pi)])
def test_when_the_time_is_up_what_boxes_tell_is_true(shape, content):
    with pytest.warns(rsym.RsymWarning, match="the time was up"):
        found = rsym.measure(shape, timeout=1e-9)
    assert abs(found.content - content) <= found.content.error < content
    assert all(abs(place) <= place.error for place in found.centroid)
    assert found.boundary.error == math.inf
    assert "unknown, estimated" in str(found)


def test_a_time_is_a_number_above_0_and_may_be_enough():
    with pytest.raises(rsym.RsymError, match="timeout"):
        rsym.measure(rsym.sphere(1), timeout=0)
    assert holds(rsym.measure(rsym.sphere(1), timeout=1e9).volume, 4 * math.pi / 3, 1e-12)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
def test_a_tolerance_is_met_or_a_warning_tells(tolerance):
    two = rsym.disc(1) & rsym.disc(1, (1, 0))
    area, length, *_ = lens(1, 1, 1)
    found = rsym.measure(two, tolerance=tolerance, order=2)
    for value, truth in ((found.area, area), (found.length, length)):
        assert abs(value - truth) <= value.error <= tolerance * value
    few, many = (rsym.measure(two, tolerance=given, order=2).order for given in (1e-2, 1e-9))
    assert few < many


def test_cells_are_as_many_as_are_asked_for_or_a_multiple():
    assert {rsym.measure(rsym.disc(1), cells=cells, tolerance=1e-3).cells for cells in (3, 5)} == {3, 5}
    assert rsym.measure(rsym.sphere(1), cells=3, tolerance=1e-2).cells == 3


# The opponent: bodies with areas and volumes in closed form, typed in ways that hide their kinks, at any place.


def lens(distance, first, second):
    """The area and the length of what two discs have in common, or the volume and the surface of two balls."""
    one = (distance**2 + first**2 - second**2) / (2 * distance)
    sides = [(first, one), (second, distance - one)]
    area = sum(r**2 * math.acos(a / r) - a * math.sqrt(r**2 - a**2) for r, a in sides)
    length = sum(2 * r * math.acos(a / r) for r, a in sides)
    volume = sum(math.pi / 3 * (r - a) ** 2 * (2 * r + a) for r, a in sides)
    surface = sum(2 * math.pi * r * (r - a) for r, a in sides)
    return area, length, volume, surface


def hidden(chance, first, second):
    """A formula that is positive where both are."""
    kinds = [
        lambda: sp.Min(first, second),
        lambda: (first + second - sp.Abs(first - second)) / 2,
        lambda: sp.tanh(50 * sp.Min(first, second)),
        lambda: sp.exp(30 * sp.Min(first, second)) - 1,
        lambda: sp.Min(first, second) * (3 + sp.cos(x)) ** 2,
        lambda: sp.Min(sp.atan(9 * first), second**3),
    ]
    return chance.choice(kinds)()


def number(chance, low, high):
    return sp.Rational(chance.randint(int(1000 * low), int(1000 * high)), 1000)


@pytest.mark.random
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize("seed", range(40))
def test_stated_errors_hold_in_the_plane(seed):
    chance = random.Random(f"{SEED} {seed}")
    u, v = x - number(chance, -0.5, 0.5), y - number(chance, -0.5, 0.5)
    kind = chance.randrange(4)
    first, second = number(chance, 0.5, 1), number(chance, 0.5, 1)
    if kind == 0:  # two discs
        distance = number(chance, abs(first - second) + 0.05, float(first + second) - 0.05)
        formula = hidden(chance, first**2 - u**2 - v**2, second**2 - (u - distance) ** 2 - v**2)
        area, length, *_ = lens(*map(float, (distance, first, second)))
    elif kind == 1:  # a rectangle by its distance
        beyond = [sp.Abs(u) - first, sp.Abs(v) - second]
        formula = -sp.sqrt(sum(sp.Max(part, 0) ** 2 for part in beyond)) - sp.Min(sp.Max(*beyond), 0)
        area, length = 4 * first * second, 4 * (first + second)
    elif kind == 2:  # a rhomb
        formula = hidden(chance, 1 - sp.Abs(u) / first - sp.Abs(v) / second, 9 - u**2)
        area, length = 2 * first * second, 4 * math.hypot(first, second)
    else:  # a ring by a product
        formula = -((first + 1) ** 2 - u**2 - v**2) * (second**2 / 4 - u**2 - v**2)
        area = math.pi * ((first + 1) ** 2 - second**2 / 4)
        length = 2 * math.pi * (first + 1 + second / 2)
    found = rsym.measure(rsym.Shape(formula, (x, y), bounds=((-3, 3),) * 2))
    assert holds(found.area, float(area)), formula
    assert holds(found.length, float(length)), formula


@pytest.mark.parametrize("scale", [1, 1000, sp.Rational(1, 1000)])
@pytest.mark.parametrize("k", range(4))
def test_what_touches_a_side_of_a_cell_belongs_to_one_of_both(k, scale):
    # A hole as wide as two cells about a corner of cells; rounding gave its tip to both, 1e-9 of the length.
    middle, cell = (sp.Rational(3 + 7 * k, 10), sp.Rational(11 + 5 * k, 50)), scale * sp.Rational(4536 + 17 * k, 10000)
    u, v = x - scale * middle[0], y - scale * middle[1]
    radii = float(3 * cell), float(cell)
    ring = rsym.conjunction(9 * cell**2 - u**2 - v**2, u**2 + v**2 - cell**2)
    bounds = [(scale * place - 4 * cell, scale * place + 4 * cell) for place in middle]
    found = rsym.measure(rsym.Shape(ring, (x, y), bounds=bounds))
    assert holds(found.length, 2 * math.pi * sum(radii), 1e-13)
    assert holds(found.area, math.pi * (radii[0] ** 2 - radii[1] ** 2), 1e-13)


def test_a_hole_that_touches_inside_of_a_side_belongs_to_one_of_both():
    # Four places were found of one, two of them at the end of halving.
    cell, corner = sp.Rational(63, 160), (sp.Rational(8127, 4000), sp.Rational(-3717, 4000))
    u, v = x - corner[0] - 9 * cell / 2, y - corner[1] - 4 * cell
    wide = sp.Rational(79, 20) * cell
    sides = [wide - sign * place for place in (u + cell / 2, v) for sign in (1, -1)]
    bounds = [(low, low + 8 * cell) for low in corner]
    found = rsym.measure(
        rsym.Shape(rsym.conjunction((u / (2 * cell)) ** 2 + (v / (2 * cell)) ** 2 - 1, *sides), (x, y), bounds=bounds)
    )
    assert holds(found.length, float(8 * wide + 4 * sp.pi * cell), 1e-13)
    assert holds(found.area, float(4 * wide**2 - 4 * sp.pi * cell**2), 1e-13)


def test_small_differences_after_slow_ones_are_chance():
    # Of a cone whose tip is a kink of heights; the last sum was 4e-11 off.
    steps = np.array([[1.5e-11], [5.4e-10], [2.5e-8], [7.7e-8]])
    assert _apart(steps, 1.25)[0] > 4e-11
    assert _apart(steps[:, [0, 0]] * [[1e-4], [1e-2], [1e2], [1e6]], 1.25)[1] == pytest.approx(1.5e-15)


@pytest.mark.slow
@pytest.mark.random
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize("seed", range(20))
def test_stated_errors_hold_in_space(seed):
    chance = random.Random(f"{SEED} {seed}")
    u, v, w = (place - number(chance, -0.4, 0.4) for place in (x, y, z))
    first, second = number(chance, 0.5, 1), number(chance, 0.5, 1)
    if seed % 2:  # two balls
        distance = number(chance, abs(first - second) + 0.1, float(first + second) - 0.1)
        across = u**2 + v**2
        formula = hidden(chance, first**2 - across - w**2, second**2 - across - (w - distance) ** 2)
        *_, volume, surface = lens(*map(float, (distance, first, second)))
    else:  # a cone
        formula = hidden(chance, first - w, w - second * sp.sqrt(u**2 + v**2))
        radius = float(first / second)
        volume = math.pi / 3 * radius**2 * float(first)
        surface = math.pi * radius * (radius + math.hypot(radius, first))
    found = rsym.measure(rsym.Shape(formula, (x, y, z), bounds=((-3, 3),) * 3))
    assert holds(found.volume, float(volume)), formula
    assert holds(found.surface, float(surface)), formula
