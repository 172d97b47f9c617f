"""Gaps thinner than cells, of known places and widths, are refused; notches, contacts and ways around are not."""

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
    ("shape", "width", "enough"),
    [
        (DISC - slot(0.04), 0.04, 55),
        (DISC - slot(1e-5), 1e-5, None),
        (DISC - rsym.disc(0.6) - slot(0.1), 0.1, 24),
        (discs(0.05), 0.05, 85),
        (rsym.rectangle(2, 1) - rsym.rectangle(1.6, 0.05), 0.05, 42),
    ],
)
def test_a_gap_is_found_with_its_width_until_cells_are_as_small(shape, width, enough, turn):
    gap = found(shape.rotate(turn), 8)
    assert width * (1 - 1e-9) <= gap.width < 1.02 * width
    assert enough is None or found(shape.rotate(turn), math.ceil(1.45 * enough)) is None


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
    assert found(shape, cells) is None


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
