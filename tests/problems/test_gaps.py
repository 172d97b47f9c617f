"""Gaps thinner than cells, of known places and widths, are refused; notches, contacts and ways around are not.

On both sides of a wider gap are answers of their own: exact ones that jump across it.
"""

import math

import numpy as np
import pytest

import rsym
from rsym import x, y, z
from rsym.problems.places import rule_on
from rsym.sampling.rules.gaps import thin_gap
from rsym.sampling.rules.quadrature import prepared

DISC = rsym.disc(1).named("rim")


def wedge(opening, turned):
    """What is cut from the disc by a notch from its middle, by the angle of the notch."""
    half = math.radians(opening) / 2
    sides = [(math.sin(half + turned), -math.cos(half + turned)), (math.sin(half - turned), math.cos(half - turned))]
    return rsym.half_plane(sides[0], 0) & rsym.half_plane(sides[1], 0)


def slot(width, begin=0):
    upper, lower = (
        rsym.half_plane((0, -1), -width / 2).named("upper"),
        rsym.half_plane((0, 1), -width / 2).named("lower"),
    )
    return upper & lower & rsym.half_plane((1, 0), begin)


def discs(apart, radius=1):
    return rsym.disc(1, (-1 - apart / 2, 0)).named("left") | rsym.disc(radius, (radius + apart / 2, 0)).named("right")


def ball(centre):
    return rsym.Shape(1 - (x - centre) ** 2 - y**2 - z**2, (x, y, z))


def found(shape, cells):
    made = prepared(shape, rsym.extent(shape), None)
    return thin_gap(made.functions, made.rule(cells, 6))


@pytest.mark.parametrize("turn", [0, 0.3, 2.1])
@pytest.mark.parametrize(
    ("shape", "width"),
    [
        (DISC - slot(0.04), 0.04),
        (DISC - slot(1e-5), 1e-5),
        (DISC - rsym.disc(0.6) - slot(0.1), 0.1),
        (discs(0.05), 0.05),
        (rsym.rectangle(2, 1) - rsym.rectangle(1.6, 0.05), 0.05),
    ],
)
def test_a_gap_is_found_with_its_width_until_no_cell_holds_both_sides(shape, width, turn):
    turned = shape.rotate(turn)
    gap = found(turned, 8)
    assert width * (1 - 1e-9) <= gap.width < 1.02 * width
    askew = abs(math.cos(turn)) + abs(math.sin(turn))
    assert abs(gap.side / gap.width - 1 / askew) < 0.15
    longest = max(high - low for low, high in rsym.extent(turned))
    assert width < 0.01 or found(turned, math.ceil(longest / width * askew * 1.02)) is None


def test_a_gap_askew_that_single_cells_hold_both_sides_of_is_found():
    turned = (DISC - slot(0.1)).rotate(math.pi / 4)
    assert found(turned, 24).width >= 2 / 24  # wider than a cell
    with pytest.raises(rsym.RsymError, match=r"within single cells, askew, of .*ask for (28|29) cells"):
        rsym.torsion(turned, cells=24)
    assert found(turned, 29) is None


@pytest.mark.parametrize("cells", [8, 21])
@pytest.mark.parametrize(
    "shape",
    [
        DISC - wedge(90, 0.3),
        DISC - wedge(30, 0.8),
        DISC - wedge(10, 2),
        discs(-0.01),
        discs(0, 0.5),
        DISC - rsym.disc(0.5, (0.5, 0)),
        DISC - rsym.disc(0.03, (0.3, 0.2)),
        DISC - slot(0.02, 0.85),
        (rsym.rectangle(2, 2) - rsym.rectangle(2, 2, (1, 1))).rotate(0.5),
        rsym.rectangle(2, 0.02),
    ],
    ids=["90", "30", "10", "overlap", "contact", "crescent", "hole", "short", "L", "thin"],
)
def test_sides_that_meet_are_not_kept_apart(shape, cells):
    gap = found(shape, cells)
    assert gap is None or gap.width == 0


@pytest.mark.parametrize("shape", [discs(0), discs(0, 0.5)], ids=["discs", "unlike"])
@pytest.mark.parametrize("turn", [0, 0.4])
def test_a_contact_is_told_where_cells_hold_both_sides(shape, turn):
    gap = found(shape.rotate(turn), 25)
    assert (gap.width, gap.parts) == (0, ("left", "right"))
    np.testing.assert_allclose(gap.point, 0, atol=1e-6)
    with pytest.warns(rsym.RsymWarning, match="touches itself at .*'left' and 'right', within a cell"):
        rule_on(shape.rotate(turn), [...], 25, 6)


def test_a_gap_in_space():
    assert 0.05 <= found(ball(-1.025) | ball(1.025), 12).width < 0.06


def test_what_is_refused_is_told_with_a_remedy_that_does():
    shape = discs(0.2)
    for ask in (
        lambda n: rsym.solve(shape, "-laplacian(u) = 1", 0, cells=n),
        lambda n: rsym.modes(shape, 1, cells=n),
        lambda n: rsym.elasticity(shape, {"left": 0, "right": 0}, young=1, poisson=0.3, loads=(1, 0), cells=n),
    ):
        with pytest.raises(
            rsym.RsymError, match=r"0\.2\d* wide at \(0, .*'left' and 'right'.*ask for 22 cells"
        ) as caught:
            ask(12)
        assert caught.value.code == "cells"
        ask(22)
    with pytest.raises(rsym.RsymError, match=r"0\.05 wide .*'lower' and 'upper'"):
        rsym.torsion(DISC - slot(0.05), cells=8)


def test_a_tolerance_refines_through_a_gap():
    found = rsym.solve(
        discs(0.2, 0.5), "-laplacian(u) = f", 0, tolerance=1e-3, letters={"f": lambda x, y: np.where(x < 0, 1.0, 3.0)}
    )
    assert [grade.cells for grade in found.report.grades] == [32]
    exact = np.array([0.25 - 0.09 / 4, 3 * (0.25 - 0.01) / 4])
    assert abs(found([-1.4, 0.7], 0) - exact).max() < 1e-3


def test_the_rule_of_a_problem_looks_for_gaps():
    with pytest.raises(rsym.RsymError, match="thinner than the cells"):
        rule_on(discs(0.01), [...], 8, 6)


def around(x, y):
    """The angle from the axis of x, from 0 to a whole turn."""
    return np.mod(np.arctan2(y, x), 2 * math.pi)


@pytest.mark.parametrize(("width", "degree"), [(1.2, 4), (2.5, 4), (1.2, 2)])
def test_a_slit_ring_knows_the_angle_on_both_sides(width, degree):
    """The angle is smooth within the ring and jumps by a whole turn across the slit, which is so many cells wide."""
    gap = width * 2 / 16
    ring = DISC - rsym.disc(0.5).named("bore") - slot(gap)
    flux = x / (x**2 + y**2)
    conditions = {"upper": rsym.neumann(-flux), "lower": rsym.neumann(flux), ...: rsym.neumann(0)}
    u = rsym.solve(ring, "-laplacian(u) + u = f", conditions, cells=16, degree=degree, letters={"f": around})
    points = np.random.default_rng(0).uniform(-1, 1, (2, 1000))
    assert np.nanmax(abs(u(*points) - around(*points))) < {4: 3e-5, 2: 1e-2}[degree]


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_discs_apart_have_answers_of_their_own(turn):
    left, right = -1.06, 1.06
    both = (rsym.disc(1, (left, 0)) | rsym.disc(1, (right, 0))).rotate(turn)
    normal = math.cos(turn), math.sin(turn)

    def load(x, y):
        return np.where(normal[0] * x + normal[1] * y < 0, 1.0, -3.0)

    u = rsym.solve(both, "-laplacian(u) = f", rsym.robin(1), cells=40, letters={"f": load})
    along, across = np.random.default_rng(1).uniform(-2, 2, (2, 1000))
    points = normal[0] * along - normal[1] * across, normal[1] * along + normal[0] * across
    exact = load(*points) * ((1 - (abs(along) - right) ** 2 - across**2) / 4 + 0.5)
    assert np.nanmax(abs(u(*points) - exact)) < 1e-9


def test_balls_apart_have_answers_of_their_own():
    both = ball(-1.2) | ball(1.2)

    def load(x, y, z):
        return np.where(x < 0, 1.0, 3.0)

    u = rsym.solve(both, "-laplacian(u) = f", rsym.robin(1), cells=13, degree=2, letters={"f": load})
    points = np.random.default_rng(1).uniform(-2, 2, (3, 1000))
    exact = load(*points) * ((1 - (abs(points[0]) - 1.2) ** 2 - points[1] ** 2 - points[2] ** 2) / 6 + 1 / 3)
    assert np.nanmax(abs(u(*points) - exact)) < 1e-5


def test_a_part_by_itself_with_too_few_cells_is_refused():
    with pytest.raises(rsym.RsymError, match=r"of a part of the shape by itself, about \(1\.[3-5]\d*, .*too few"):
        rsym.solve(rsym.disc(1) | rsym.disc(0.1, (1.4, 0)), "-laplacian(u) = 1", 0, cells=10)
