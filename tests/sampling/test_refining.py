"""`resolution="auto"`: bars with a gap between them are two pieces, and what no lattice resolves is told."""

import numpy as np
import pytest

import rsym
from rsym import RsymError, RsymWarning
from rsym.sampling import mesher, meshing

LENGTH, SIDE = 8, 0.25


def bars(gap):
    """Two bars in a line of 8, with a gap between them: at 128 cells one is 1/16 wide."""
    half = (LENGTH - gap) / 2
    middle = (gap + half) / 2
    return rsym.box(half, SIDE, SIDE, (middle, 0, 0)) | rsym.box(half, SIDE, SIDE, (-middle, 0, 0))


def test_a_gap_is_resolved_where_128_cells_bridge_it():
    body = bars(0.04)
    with pytest.warns(RsymWarning):
        coarse = rsym.mesh(body)
    assert (coarse.status.resolution, coarse.status.components) == (128, 1)
    fine = rsym.mesh(body, "auto")
    assert 2 / 0.04 * LENGTH <= fine.status.resolution <= 512
    assert (fine.status.components, fine.status.euler_characteristic, fine.status.remarks) == (2, 4, ())


def test_what_128_cells_show_takes_no_more():
    body = bars(1)
    found, given = rsym.mesh(body, "auto"), rsym.mesh(body)
    assert found.status.resolution == 128
    assert np.array_equal(found.vertices, given.vertices)
    assert np.array_equal(rsym.Mesher(body)("auto").vertices, given.vertices)


def test_what_512_cells_do_not_show_is_told():
    with pytest.warns(RsymWarning, match="gap"):
        found = rsym.mesh(bars(1e-3), "auto")
    assert found.status.resolution == 512


def test_what_no_lattice_shows_asks_for_none():
    with pytest.warns(RsymWarning, match="touch"):
        found = rsym.mesh(rsym.sphere(1) | rsym.sphere(1, (2, 0, 0)), "auto")
    assert found.status.resolution == 128


def test_a_file_in_pieces_has_the_same_bytes_and_no_other_stays(tmp_path):
    body = bars(0.04)
    made = rsym.mesh(body, "auto", into=tmp_path / "bars.ply")
    rsym.write(rsym.mesh(body, made.status.resolution), tmp_path / "whole.ply")
    assert made.path.read_bytes() == (tmp_path / "whole.ply").read_bytes()
    assert {path.name for path in tmp_path.iterdir()} == {"bars.ply", "whole.ply"}


def test_what_the_memory_does_not_hold_leaves_the_mesh_before(monkeypatch):
    real, asked = mesher.SharpMesher.__call__, []

    def narrow(self, request):
        asked.append(request.resolution)
        if len(asked) > 1:
            raise RsymError("too large", code="memory")
        return real(self, request)

    monkeypatch.setattr(mesher.SharpMesher, "__call__", narrow)
    with pytest.warns(RsymWarning, match="gap"):
        found = rsym.mesh(bars(0.04), "auto")
    assert (found.status.resolution, len(asked)) == (128, 2)


def test_a_word_that_is_none_is_refused():
    with pytest.raises(RsymError, match="'auto'"):
        rsym.mesh(bars(1), "fine")
    assert meshing.AUTOMATIC == "auto"


@pytest.mark.slow
def test_the_car_is_five_pieces():
    with pytest.warns(RsymWarning, match="taper"):  # no resolution resolves these
        found = rsym.mesh(rsym.load("car"), "auto").status
    assert (found.components, found.euler_characteristic, found.closed, found.finer) == (5, 0, True, None)


def test_a_gap_is_called_by_those_beside_it(tmp_path):
    """Three boxes with two gaps on planes that are one leaf twice, as x and 1 - x are of A and of C."""
    left, right = rsym.box(1, 1, 1).named("left"), rsym.box(1, 1, 1, (1.01, 0, 0)).named("right")
    far = rsym.box(1, 1, 1, (0, 0, 3)).named("far")
    with pytest.warns(RsymWarning, match="gap"):
        found = rsym.mesh(left | right | far, 64)
    with pytest.warns(RsymWarning, match="gap"):
        streamed = rsym.mesh(left | right | far, 64, into=tmp_path / "boxes.ply")
    (gap,) = (one for one in found.status.unresolved if one.kind == "gap")
    assert set(gap.names) == {"left", "right"}
    assert [one.names for one in streamed.status.unresolved] == [one.names for one in found.status.unresolved]
