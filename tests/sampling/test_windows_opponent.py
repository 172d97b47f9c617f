"""Where shapes are looked at, against shapes whose boundary is known by construction."""

import numpy as np
import pytest
from opponent.windows import FAR, boundary_of, case

from rsym.errors import RsymError
from rsym.sampling.windows import bounds_or_extent


def complaint(seed):
    """What is wrong about the box of a case; nothing if all of the boundary lies in it, or it is refused rightly."""
    made = case(seed)
    points = boundary_of(made, seed)
    distance = np.abs(points).max(axis=1, initial=0.0)
    goes_on = bool((distance > FAR).any())
    try:
        box = np.array(bounds_or_extent(made.shape, None))
    except RsymError as error:
        wrong = {"unbounded": not goes_on, "empty": len(points) > 0}[error.code]
        return f"{error.code}: {made.text}" if wrong else ""
    slack = 1e-9 * distance.max(initial=0.0)
    outside = (points < box[:, 0] - slack) | (points > box[:, 1] + slack)
    return f"{points[outside.any(axis=1)][:1]} outside {box.tolist()}: {made.text}" if outside.any() else ""


@pytest.mark.random
@pytest.mark.parametrize("seed", range(100))
def test_all_of_the_boundary_is_looked_at_or_it_is_said_to_go_on(seed):
    assert complaint(seed) == ""
