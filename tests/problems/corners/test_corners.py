"""Corners of plane shapes against places and angles known by construction."""

import math

import numpy as np
import pytest
import sympy as sp
from numpy.testing import assert_allclose

import rsym
from rsym import x, y
from rsym.problems.corners.corners import corners


def half(angle, distance=0.0):
    return rsym.half_plane((math.cos(angle), math.sin(angle)), distance)


def wedge(opening, turn=0.0):
    """A sector of the unit disc with its tip at 0, from the direction `turn` on."""
    first, second = half(turn + math.pi / 2), half(turn + opening - math.pi / 2)
    return rsym.disc(1) & ((first & second) if opening < math.pi else (first | second))


def places(shape, **more):
    return [corner.point for corner in corners(shape, **more)]


@pytest.mark.parametrize(
    "opening", [0.01, 1.0, math.pi / 2, math.pi - 1e-4, math.pi + 1e-4, 3 * math.pi / 2, 2 * math.pi - 0.01]
)
def test_the_angle_the_edges_and_the_reach_of_a_tip(opening):
    found = corners(wedge(opening, 0.3))
    assert len(found) == 3
    corner = min(found, key=lambda corner: math.hypot(*corner.point))
    assert_allclose(corner.point, (0, 0), atol=1e-10)
    assert_allclose(corner.angle, opening, rtol=0, atol=1e-12)
    directions = [0.3, 0.3 + opening]
    assert_allclose(corner.edges, np.stack([np.cos(directions), np.sin(directions)], axis=1), atol=1e-12)
    assert corner.is_reentrant == (opening > math.pi)
    assert 0.97 < corner.reach <= 1


CUT = rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(-x, y))
OF_CUT = [(-1, -1), (-1, 1), (0, -1), (0, 0), (1, 0), (1, 1)]


@pytest.mark.parametrize("size", [1e-9, 1.0, 1e9])
def test_corners_of_a_square_with_a_quarter_cut_away_of_any_size(size):
    box = size**2 - x**2, size**2 - y**2
    shape = rsym.Shape(rsym.conjunction(*box, rsym.disjunction(-x, y)), (x, y))
    assert_allclose(np.array(places(shape)) / size, OF_CUT, atol=1e-12)
    assert_allclose([c.angle * 2 / math.pi for c in corners(shape)], [1, 1, 1, 3, 1, 1], rtol=1e-12)
    inner = next(corner for corner in corners(shape) if corner.is_reentrant)
    assert 0.97 * size < inner.reach <= size


@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_edges_of_strips_are_straight_to_their_other_sides(turn):
    """Leaves such as 1/4 - x**2 fold in the middle, where nothing is."""
    for corner in corners(rsym.rectangle(3, 1).rotate(turn)):
        assert corner.straight == (True, True)
        assert 0.97 < corner.reach <= 1
    leaf = x * ((2 * x - 3) ** 2 + 4 * y**2 - 1)  # 0 on a circle too, whose nearest point is (1, 0)
    found = corners(rsym.Shape(rsym.conjunction(leaf, y, 4 - x, 4 - y), (x, y)))
    corner = min(found, key=lambda corner: math.hypot(*corner.point))
    assert sorted(corner.straight) == [False, True]
    assert 0.97 < corner.reach <= 1
    assert not any(c.straight[0] or c.straight[1] for c in corners(rsym.disc(1) & rsym.half_plane((0, 1), 0)))


@pytest.mark.parametrize("system", [rsym.R1, rsym.R0m(2), rsym.Rp(4)])
def test_corners_are_the_same_in_all_systems_and_of_leaves_times_numbers(system):
    box = 1e6 * (1 - x**2), (1 - y**2) / 10**6
    shape = rsym.Shape(system.conjunction(*box, system.disjunction(-(10**6) * x, y)), (x, y))
    assert_allclose(places(shape), OF_CUT, atol=1e-14)
    assert_allclose([c.angle * 2 / math.pi for c in corners(shape)], [1, 1, 1, 3, 1, 1], rtol=1e-14)


def test_corners_of_what_is_normalised_turned_and_moved():
    shape = rsym.normalise(rsym.Shape(CUT, (x, y)).rotate(0.7).translate((3, 4)))
    c, s = math.cos(0.7), math.sin(0.7)
    assert_allclose(places(shape), sorted((3 + c * u - s * v, 4 + s * u + c * v) for u, v in OF_CUT), atol=1e-13)


def test_corners_follow_letters():
    a = sp.Symbol("a", real=True)
    shape = rsym.Shape(CUT.subs(x, x - a), (x, y), letters={a: 0})
    assert_allclose(places(shape, letters={"a": 0.25}), np.add(OF_CUT, (0.25, 0)), atol=1e-14)
    notch = rsym.Shape(rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(a - x, y)), (x, y), letters={a: 0})
    (inner,) = (c for c in corners(notch, {"a": 0.999}) if c.is_reentrant)
    assert_allclose(inner.point, (0.999, 0), atol=1e-13)
    assert 0.97e-3 < inner.reach < 1e-3
    assert not any(c.is_reentrant for c in corners(notch, {"a": 1.5}))


def test_curved_edges_and_the_names_of_their_parts():
    lens = rsym.disc(1).named("left") & rsym.disc(1, (1, 0)).named("right")
    lower, upper = corners(lens)
    assert_allclose([lower.point, upper.point], [(0.5, -math.sqrt(0.75)), (0.5, math.sqrt(0.75))], rtol=1e-14)
    assert_allclose([lower.angle, upper.angle], 2 * math.pi / 3, rtol=1e-14)
    assert (lower.parts, upper.parts) == (("left", "right"), ("right", "left"))
    # The edges go to the other tip, sqrt(3) away; leaf coordinates fold before.
    assert 0.5 < upper.reach < math.sqrt(3)


def test_two_lines_that_cross_at_a_tiny_angle_have_their_corner():
    for angle in (1e-3, 1e-5):
        found = corners(rsym.disc(1) & half(math.pi / 2) & half(math.pi / 2 - angle))
        assert_allclose([c.angle for c in found if math.hypot(*c.point) < 0.5], math.pi - angle, rtol=0, atol=1e-12)


def test_a_chamfer_however_small_has_two_corners_that_know_of_each_other():
    for size in (1e-6, 1e-10):
        shape = rsym.disc(1) & rsym.Shape(rsym.conjunction(x, y, x + y - size), (x, y))
        first, second = (corner for corner in corners(shape) if corner.reach < 0.1)
        assert_allclose([first.point, second.point], [(0, size), (size, 0)], rtol=0, atol=1e-14)
        assert 0.9 * size < first.reach < math.sqrt(2) * size


def test_leaves_that_go_on_as_each_other_make_no_corner():
    stadium = rsym.disc(1) | rsym.rectangle(2, 2, (1, 0))
    assert_allclose(places(stadium), [(2, -1), (2, 1)], atol=1e-14)
    assert corners(rsym.disc(1) | rsym.disc(0.5, (1.5, 0))) == ()
    assert corners(rsym.disc(1) - rsym.disc(0.4)) == ()


def test_cusps_are_named_and_have_no_reach():
    found = corners(rsym.disc(1) - rsym.disc(0.5, (0.5, 0)))
    assert [(c.angle, c.is_cusp, c.reach) for c in found] == [(0.0, True, 0.0)] * 2
    outward = rsym.Shape(rsym.conjunction(rsym.disjunction(-y, y - x**2, -x), 1 - x**2 - y**2), (x, y))
    (cusp,) = (c for c in corners(outward) if c.is_cusp)
    assert cusp.angle == 2 * math.pi
    assert_allclose(cusp.point, (0, 0), atol=1e-8)
    # So near to each other, but not touching.
    assert corners(rsym.disc(1) - rsym.disc(0.5, (0.5 - 1e-7, 0))) == ()
    assert len(corners(rsym.disc(1) - rsym.disc(0.5, (0.5 + 1e-7, 0)))) == 2


def test_three_leaves_through_a_point():
    # The one in the middle does not matter: what is inside is that between the others.
    shape = rsym.disc(1) & half(0.3) & half(0.9) & half(1.5)
    (tip,) = (corner for corner in corners(shape) if math.hypot(*corner.point) < 1e-9)
    assert_allclose(tip.angle, math.pi - 1.2, rtol=1e-12)
    assert not tip.alone
    star = rsym.disc(1) & rsym.disjunction(
        *(half(t + math.pi / 2) & half(t + 0.4 - math.pi / 2) for t in (0, 1.1, 2.5))
    )
    tips = [corner for corner in corners(star) if math.hypot(*corner.point) < 1e-9]
    assert_allclose([corner.angle for corner in tips], 0.4, rtol=1e-12)
    assert all(corner.reach > 0.9 for corner in tips)


def test_a_leaf_through_a_corner_that_comes_back_between_its_edges_ends_the_reach():
    shape = rsym.disc(1) & rsym.Shape(rsym.conjunction(x, y, x + y - 2 * x**2), (x, y))
    (tip,) = (corner for corner in corners(shape) if math.hypot(*corner.point) < 1e-9)
    assert_allclose(tip.angle, math.pi / 2, rtol=1e-12)
    # The parabola comes back to the first edge in (1/2, 0); on its way it stays outside.
    assert 0.45 < tip.reach <= 0.5


def test_a_cusp_cut_through_its_tip_is_one_cusp_whichever_way_it_is_turned():
    for turn in (0.0, 0.7, 2.9):
        crescent = (rsym.disc(1) - rsym.disc(0.5, (0.5, 0))) & rsym.half_plane((0, 1), 0)
        tip = math.cos(turn), math.sin(turn)
        found = [c for c in corners(crescent.rotate(turn)) if math.dist(c.point, tip) < 1e-6]
        assert [c.angle for c in found] == [0.0]
        outward = rsym.Shape(rsym.conjunction(rsym.disjunction(-y, y - x**2, -x), 1 - x**2 - y**2), (x, y))
        (cusp,) = (c for c in corners(outward.rotate(turn)) if c.is_cusp)
        assert cusp.angle == 2 * math.pi


def test_of_two_leaves_on_one_line_that_which_bounds_the_shape_is_the_edge():
    upper = rsym.disc(1) & half(math.pi / 2) & half(0)
    # The second half plane has the same line, and is elsewhere cut off by x <= -1/2.
    other = half(math.pi / 2 - 1e-17 + math.pi * 2) & half(math.pi, 0.5)
    shape = (upper | (rsym.disc(1) & other)).named("all")
    (corner,) = (c for c in corners(shape) if math.hypot(*c.point) < 1e-9)
    assert_allclose(corner.angle, math.pi / 2, rtol=1e-12)
    assert corner.reach > 0.45


def test_corners_on_the_bounds_are_corners_and_bounds_make_none():
    assert len(corners(rsym.rectangle(1, 1), bounds=((-0.5, 0.5), (-0.5, 0.5)))) == 4
    assert places(rsym.rectangle(1, 1), bounds=((0, 0.5), (0, 0.5))) == [(0.5, 0.5)]
    assert corners(rsym.half_plane(), bounds=((-1, 1), (-1, 1))) == ()


@pytest.mark.parametrize(
    ("expression", "place"), [(1 - sp.Abs(x) - y**2, "0, -1"), (x * y + 0 * x, "0, 0"), (y**2 - x**3, "0, 0")]
)
def test_kinks_and_double_points_inside_of_a_leaf_are_refused(expression, place):
    with pytest.raises(rsym.RsymError, match="a kink or no gradient") as error:
        corners(rsym.Shape(expression, (x, y), bounds=((-2, 2), (-2, 2))))
    assert error.value.code == "singular-leaf"
    found = [float(value) for value in error.value.where.strip("()").split(",")]
    assert_allclose(found, [float(value) for value in place.split(",")], atol=1e-8)


def test_leaves_along_each_other_are_refused():
    one, other = 1 - x**2 - y**2, (1 - sp.sqrt(x**2 + y**2)) * 2
    with pytest.raises(rsym.RsymError, match="vanish along the same piece") as error:
        corners(rsym.Shape(rsym.disjunction(one, other), (x, y), bounds=((-2, 2), (-2, 2))))
    assert error.value.code == "degenerate"
    with pytest.raises(rsym.RsymError, match="in the plane"):
        corners(rsym.sphere(1))
