"""The opponents of fields: one body typed in two ways, and known solutions against what is said of their errors."""

import os

import pytest
from opponent import fields, typings

SEED = int(os.environ.get("RSYM_TEST_SEED", "0"))
OPPONENTS = {"fields": fields, "typings": typings}


@pytest.mark.random
@pytest.mark.parametrize("number", range(20))
@pytest.mark.parametrize("kind", OPPONENTS)
def test_nothing_is_silent_and_wrong(kind, number):
    case = OPPONENTS[kind].case(1000 * SEED + number)
    assert OPPONENTS[kind].asked(case)[1] == [], case


@pytest.mark.parametrize("seed", [0, 9, 14, 23], ids=["ring", "triangle", "L", "hexagon"])
def test_parts_that_overlap_by_little_are_one(seed):
    assert typings.asked(typings.case(seed))[1] == []
