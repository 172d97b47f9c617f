"""Opponents of parts without a value and of steps: shapes against plain twins, a few of each a day."""

import os

import pytest
from opponent import steps, undefined
from opponent.twins import faults

SEED = int(os.environ.get("RSYM_TEST_SEED", "0"))


@pytest.mark.random
@pytest.mark.parametrize("number", range(10))
@pytest.mark.parametrize("opponent", [undefined, steps], ids=["undefined", "steps"])
def test_what_is_said_of_a_shape_is_what_is_said_of_its_twin(opponent, number):
    twins = opponent.made(1000 * SEED + number)
    assert faults(twins, number) == [], twins.text
