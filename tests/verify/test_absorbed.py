"""Leaves that the logic absorbs: their domains still count."""

import pytest
import sympy as sp

import rsym
from rsym import conjunction, disjunction, x, y, z


@pytest.mark.slow
@pytest.mark.parametrize("second", [sp.sqrt(y) + 1, sp.log(y) + 9])
def test_an_absorbed_leaf_takes_its_domain_along(second):
    """For y < 0 omega is not defined: the sheet ends in a line, whatever the logic of the second leaf."""
    sheet = x + z**3 / 5
    body = rsym.Shape(conjunction(sheet, disjunction(sheet, second)), (x, y, z), bounds=((-1, 1),) * 3)
    assert rsym.verify_smoothness(body, method="space", budget=4_000).verdict != "CERTIFIED"


def test_an_absorbed_leaf_that_is_defined_everywhere_leaves_nothing():
    sheet = x + z**3 / 5
    body = rsym.Shape(conjunction(sheet, disjunction(sheet, sp.sqrt(y**2 + 1))), (x, y, z), bounds=((-1, 1),) * 3)
    assert rsym.verify_smoothness(body, method="space").verdict == "CERTIFIED"
