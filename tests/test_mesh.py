import numpy as np
import pytest
from closeness import assert_close

from rsym import RsymError
from rsym.sampling.mesh import examine, signed_volume

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


def test_a_tetrahedron():
    status = examine(CORNERS, FACES)
    assert status.closed
    assert (status.components, status.euler_characteristic) == (1, 2)
    assert_close(status.volume, 1 / 6, rtol=1e-14)
    assert_close(signed_volume(CORNERS + 1e6, FACES[:, ::-1]), -1 / 6, rtol=1e-8)


def test_a_missing_triangle_is_open_or_clipped():
    assert "open" in str(examine(CORNERS, FACES[1:]))
    assert "clipped" in str(examine(CORNERS, FACES[1:], sides={"the floor": np.ones(4, bool)}))
    assert not examine(CORNERS, FACES[1:], sides={"the floor": np.array([True, True, False, True])}).clipped


def test_a_turned_triangle_is_seen():
    turned = FACES.copy()
    turned[0] = turned[0, ::-1]
    status = examine(CORNERS, turned)
    assert not status.closed
    assert status.repeated_edges == 3


def test_two_pieces():
    status = examine(np.vstack([CORNERS, CORNERS + 5]), np.vstack([FACES, FACES + 4]))
    assert (status.components, status.euler_characteristic, status.closed) == (2, 4, True)
    assert "2 pieces" in str(status)


def test_unresolved_and_zeros_are_told():
    text = str(examine(CORNERS, FACES, nudged_zeros=3, unresolved=2))
    assert "unresolved" in text
    assert "3 samples lay exactly" in text
    assert examine(CORNERS, FACES, nudged_zeros=1).remarks[0].startswith("1 sample lay")


def test_nothing_is_refused():
    with pytest.raises(RsymError):
        examine(CORNERS, FACES[:0])
