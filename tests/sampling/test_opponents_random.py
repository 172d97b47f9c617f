"""The opponents of labels, windows, parts without a value, steps, thin lines, pictures, measures, fields, bodies."""

import os

import pytest
from opponent import (
    elastic,
    fields,
    lengths,
    measures,
    parted,
    pictures,
    plates,
    ranging,
    solids,
    steps,
    thin,
    typings,
    undefined,
    windows,
)

SEED = int(os.environ.get("RSYM_TEST_SEED", "0"))
OPPONENTS = {
    one.__name__.rpartition(".")[2]: one
    for one in (
        elastic,
        fields,
        lengths,
        measures,
        parted,
        pictures,
        plates,
        ranging,
        steps,
        thin,
        typings,
        undefined,
        windows,
    )
}


@pytest.mark.random
@pytest.mark.parametrize("number", range(20))
@pytest.mark.parametrize("kind", OPPONENTS)
def test_nothing_is_silent_and_wrong(kind, number):
    case = OPPONENTS[kind].case(1000 * SEED + number)
    assert OPPONENTS[kind].asked(case)[1] == [], case


@pytest.mark.parametrize("seed", [6027, 80208, 80257, 83019], ids=["wedges", "contact", "needles", "tip"])
def test_what_is_below_a_cell_is_right_or_told(seed):
    assert thin.asked(thin.case(seed))[1] == []


@pytest.mark.parametrize("seed", [0, 9, 14, 23], ids=["ring", "triangle", "L", "hexagon"])
def test_parts_that_overlap_by_little_are_one(seed):
    assert typings.asked(typings.case(seed))[1] == []


@pytest.mark.parametrize("seed", [3, 10, 32, 44, 61], ids=["cylinder", "box", "bored", "cubed", "step"])
def test_solutions_in_space_are_within_what_is_said_of_them(seed):
    assert solids.asked(solids.case(seed))[1] == []


@pytest.mark.parametrize("seed", [910007, 910045, 910013])
def test_bodies_whose_displacements_are_given_are_within_what_is_said_of_them(seed):
    """Forces that end beside what is held, and a lift that is the solution."""
    assert elastic.asked(elastic.case(seed))[1] == []
