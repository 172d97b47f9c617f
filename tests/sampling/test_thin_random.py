"""The opponent of lines: what is thinner than a cell at random, two cases a day and twenty in a whole run."""

import os

import pytest
from opponent.thin import faults

SEED = int(os.environ.get("RSYM_TEST_SEED", "0"))


@pytest.mark.random
@pytest.mark.parametrize("number", range(20))
def test_thin_lines_are_there_or_told(number):
    silent, _, _ = faults(1000 * SEED + number)
    assert silent == []
