"""Where parts are and where they meet: corners, edges in space, points of contact; a part that is nowhere is none."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.logic.sign_form import shape_form
from rsym.problems.meetings import EPS, OFF, Places
from rsym.sampling.windows import bounds_or_extent

HALF = sp.Rational(1, 2)


def places(shape, *parts):
    form = shape_form(shape)
    every = parts or [(number,) for number in range(len(form.leaves))]
    return Places(shape, form, bounds_or_extent(shape, None), tuple(every))


def meeting(shape, *parts):
    """Points rounded, sorted."""
    points, doubt = places(shape, *parts).meeting(0, 1)
    assert doubt.shape == (len(points),)
    assert (doubt < 1e-7).all()
    return sorted(map(tuple, points.round(7).tolist()))


def test_corners_of_lines_and_circles():
    assert meeting(rsym.rectangle(2, 1)) == [(-1, -0.5), (-1, 0.5), (1, -0.5), (1, 0.5)]
    assert meeting(rsym.disc(1) & rsym.disc(1, (1, 0))) == [(0.5, -0.8660254), (0.5, 0.8660254)]
    assert meeting(rsym.disc(2) - rsym.disc(1)) == []


def test_common_zeros_off_the_boundary_do_not_count():
    cut = rsym.rectangle(2, 1) & rsym.half_plane((1, 0), 0)
    assert meeting(cut, (0,), (1,)) == [(1, -0.5), (1, 0.5)]
    union = rsym.rectangle(2, 1) | rsym.rectangle(1, 2)
    assert meeting(union, (0, 1), (2, 3)) == [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)]


@pytest.mark.parametrize("system", [rsym.R0, rsym.R1, rsym.Rp(4), rsym.R0m(2)], ids=str)
def test_the_system_does_not_matter(system):
    wedge = (rsym.disc(2) & rsym.half_plane((1, 0), 0)).with_system(system)
    assert meeting(wedge) == [(0, -2), (0, 2)]


@pytest.mark.parametrize(
    ("shape", "contact", "bend"),
    [
        (rsym.disc(2) - rsym.disc(HALF, (HALF * 3, 0)), (2, 0), 3 / 2),
        (rsym.sphere(1) - rsym.sphere(HALF, (HALF, 0, 0)), (1, 0, 0), 1),
    ],
)
def test_parts_that_touch(shape, contact, bend):
    """The difference of two curvatures is `bend`: v beside the contact two unit slopes are at an angle of bend*v.

    So errors e of values move the point by N = sqrt(2)*e/(bend*v) at most, where a step is v/2. Steps end at a point
    where the step is N or less, N with all of e = EPS*size: if values have an eighth of that error, v is there at least
    0.56*sqrt(c/bend), c = sqrt(2)*e, and N at most 1.8*sqrt(c/bend). The doubt is OFF*(step + N).
    """
    here = places(shape)
    points, doubt = here.meeting(0, 1)
    assert len(points) == 1
    assert np.linalg.norm(points[0] - contact) <= doubt[0]
    size = np.diff(here.box, axis=1).max()
    assert doubt[0] <= OFF * 2 * 1.8 * np.sqrt(np.sqrt(2) * EPS * size / bend)


def test_parts_that_nearly_touch_do_not_meet():
    assert meeting(rsym.disc(2) - rsym.disc(HALF, (sp.Rational(14999, 10000), 0))) == []


def test_corners_of_three_parts_and_a_line_through_corners():
    square = rsym.rectangle(2, 2) & rsym.half_plane((1, 1), 0)
    assert meeting(square, (0, 1), (2,)) == [(-1, 1), (1, -1)]
    assert meeting(square, (0,), (1,)) == [(-1, 1), (1, -1), (1, 1)]


def test_edges_in_space_are_seen_all_along():
    cap = rsym.sphere(1) & rsym.half_space((0, 0, 1), sp.Rational(3, 10))
    points, _ = places(cap).meeting(0, 1)
    angles = np.sort(np.arctan2(points[:, 1], points[:, 0]))
    assert np.abs(np.linalg.norm(points, axis=1) - 1).max() < 1e-14
    assert np.abs(points[:, 2] - 0.3).max() < 1e-14
    assert np.diff(angles, append=angles[0] + 2 * np.pi).max() < 0.2


def test_parts_that_coincide_are_seen_all_along():
    bounds = ((-1, 2), (-1, 2))
    twice = (
        rsym.Shape(x, (x, y), bounds=bounds) & rsym.Shape(x * (1 - x) * (3 + y), (x, y)) & rsym.Shape(1 - y**2, (x, y))
    )
    points, _ = places(twice).meeting(0, 1)
    assert np.abs(points[:, 0]).max() < 1e-12
    assert np.ptp(points[:, 1]) > 1.9


@pytest.mark.parametrize(
    ("hole", "there"),
    [
        (rsym.disc(HALF, (5, 0)), False),
        (rsym.disc(HALF, (2.500001, 0)), False),
        (rsym.disc(HALF, (2.4999, 0)), True),
        (rsym.disc(1e-5, (1.3, 0.1)), True),
        (rsym.disc(3), False),  # it takes all
        (rsym.half_plane((1, 0), 2.001), False),
        (rsym.half_plane((1, 0), 1.999), True),
    ],
)
def test_a_part_is_there_or_not(hole, there):
    assert (len(places(rsym.disc(2) - hole).of(1)) > 0) == there


def test_letters_have_their_defaults():
    r = sp.Symbol("r", real=True)
    shape = rsym.disc(2) - rsym.Shape(r**2 - (x - 3) ** 2 - y**2, (x, y), letters={r: 0.9})
    assert not len(places(shape).of(1))
    assert len(places(shape.with_letters({"r": 1.1})).of(1))


def test_boundaries_outside_of_the_bounds_are_not_there():
    shape = (rsym.disc(2) & rsym.half_plane((1, 0), 1)).replace(bounds=((-3, 0.5), (-3, 3)))
    assert not len(places(shape).of(1))
    box = rsym.box(2, 2, 2).replace(bounds=((-2, 2), (-2, 2), (-2, 0)))
    assert box.coordinates == (x, y, z)
    points, _ = places(box).meeting(0, 1)
    assert points[:, 2].max() < 1e-8
