"""Offsets and shells against pieces whose distance is known by construction."""

import pytest
from opponent.lengths import complaint


@pytest.mark.random
@pytest.mark.parametrize("seed", range(24))
def test_lengths_are_kept_or_told(seed):
    assert complaint(seed) == ""
