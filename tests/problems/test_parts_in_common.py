"""Conditions on parts that have leaves in common hold on each part alone."""

import numpy as np
import pytest

import rsym
from rsym.logic.faces import shape_faces
from rsym.logic.separation import separated

SQUARES = rsym.rectangle(1, 1).named("A") | rsym.rectangle(1, 1).translate(2, 0).named("B")
HEAT = "-laplacian(u) = 0"


def test_what_flows_into_one_of_two_squares_stays_there():
    found = rsym.solve(SQUARES, "-laplacian(u) + u = 0", {"A": rsym.neumann(0), "B": rsym.neumann(1)}, cells=12)
    assert found.integral() == pytest.approx(4, rel=1e-10)  # all that flows in through the four sides of B


def test_values_on_parts_that_do_not_meet_agree():
    found = rsym.solve(SQUARES, HEAT, {"A": 0, "B": 1}, cells=12)
    assert np.abs(found([0.1, 2.1], [0.2, 0.3]) - [0, 1]).max() < 2e-5  # the lift goes from one to the other
    between = rsym.interpolate(SQUARES, {"A": 0, "B": 1})
    assert rsym.compile(between)([0.2, 1.8], [0.5, 0.5])["value"].tolist() == [0, 1]


def test_slots_of_one_height_have_conditions_of_their_own():
    slots = [rsym.rectangle(0.4, 1).translate(1.2 * k, 0).named(f"slot {k}") for k in (-1, 0, 1)]
    plate = rsym.rectangle(4, 2).named("plate") - slots[0] - slots[1] - slots[2]
    insulated = rsym.neumann(0)
    given = {"plate": insulated, "slot -1": 0, "slot 0": insulated, "slot 1": 1}
    found = rsym.solve(plate, HEAT, given, cells=20)
    assert found.flux("slot 1") == pytest.approx(-found.flux("slot -1"), rel=1e-3)
    # The same with slots whose heights differ by a little, so that no leaf is in common.
    other = [slot.scale(1 + 1e-4 * k).named(f"slot {k - 1}") for k, slot in enumerate(slots)]
    apart = rsym.rectangle(4, 2).named("plate") - other[0] - other[1] - other[2]
    assert found.flux("slot 1") == pytest.approx(rsym.solve(apart, HEAT, given, cells=20).flux("slot 1"), rel=1e-3)


def test_a_section_of_two_equal_cells_is_twisted():
    def section(more):
        tube = rsym.rectangle(4, 2) - rsym.rectangle(1.4, 1).translate(-0.9, 0)
        return tube - rsym.rectangle(1.4, 1 + more).translate(0.9, 0)

    assert rsym.torsion(section(0), cells=32).rigidity == pytest.approx(6.0159, rel=5e-4)


def test_a_shape_whose_parts_have_nothing_in_common_stays_itself():
    ring = rsym.disc(2).named("rim") - rsym.disc(1).named("bore")
    assert separated(ring) is ring
    same = rsym.rectangle(1, 1).named("A") | rsym.rectangle(1, 1).translate(2, 0).named("A")
    assert separated(same) is same


def test_a_separated_shape_is_the_same_body_with_the_same_parts():
    given = (SQUARES - rsym.rectangle(0.5, 1).named("slot")) & rsym.rectangle(9, 1)
    found = separated(given)
    assert not shape_faces(found).shared
    assert [name for name, _ in found.parts] == ["A", "B", "slot"]
    x, y = np.random.default_rng(1).uniform(-1, 3, (2, 2000))
    assert (found.contains(x, y) == given.contains(x, y)).all()
    of = {name: float(value) for name, value in rsym.measure(given).parts.items() if name in "ABslot"}
    assert {name: float(value) for name, value in rsym.measure(found).parts.items() if name in of} == pytest.approx(of)
