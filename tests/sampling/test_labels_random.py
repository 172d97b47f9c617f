"""The opponent of labels: parts with faces in common at random, two cases a day and twenty in a whole run."""

import os
import warnings

import pytest
from opponent.parted import faults

import rsym

SEED = int(os.environ.get("RSYM_TEST_SEED", "0"))


@pytest.mark.random
@pytest.mark.parametrize("number", range(20))
def test_faces_have_the_names_of_the_parts_that_end_there(number):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rsym.RsymWarning)  # where boxes touch along an edge, or in a sheet
        assert faults(1000 * SEED + number) == []
