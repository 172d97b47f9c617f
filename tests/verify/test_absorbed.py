"""Leaves that the logic absorbs: their domains still count."""

import pytest
import sympy as sp

import rsym
from rsym import conjunction, disjunction, x, y, z


@pytest.mark.slow
@pytest.mark.parametrize("second", [sp.sqrt(y) + 1, sp.log(y) + 9])
def test_the_sheet_ends_where_an_absorbed_leaf_has_no_value(second):
    """For y < 0 true and unknown is unknown: the sheet ends in a line. True or unknown is true: there it goes on."""
    sheet, bounds = x + z**3 / 5, ((-1, 1),) * 3
    ends = rsym.Shape(conjunction(sheet, second), (x, y, z), bounds=bounds)
    assert rsym.verify_smoothness(ends, method="space", budget=4_000).verdict != "CERTIFIED"
    goes_on = rsym.Shape(conjunction(sheet, disjunction(sheet, second)), (x, y, z), bounds=bounds)
    assert rsym.verify_smoothness(goes_on, method="space", budget=4_000).verdict == "CERTIFIED"


def test_an_absorbed_leaf_that_is_defined_everywhere_leaves_nothing():
    sheet = x + z**3 / 5
    body = rsym.Shape(conjunction(sheet, disjunction(sheet, sp.sqrt(y**2 + 1))), (x, y, z), bounds=((-1, 1),) * 3)
    assert rsym.verify_smoothness(body, method="space").verdict == "CERTIFIED"
