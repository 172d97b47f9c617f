import numpy as np
import pytest

from rsym import RsymError, Shape, x, y
from rsym.sampling.lattice import lattice_over
from rsym.sampling.windows import bounds_or_extent

BOX = ((-1.0, 3.0), (0.0, 1.0), (-2.0, 1.0))


def test_cells_are_cubical_and_cover_the_bounds():
    lattice = lattice_over(BOX, 40)
    assert lattice.spacing == (0.1, 0.1, 0.1)
    for k, (low, high) in enumerate(BOX):
        axis = lattice.axis(k)
        assert low - 0.1 < axis[0] < low
        assert high < axis[-1] < high + 0.1


def test_cells_along_each_axis():
    lattice = lattice_over(BOX, (10, 20, 30))
    assert lattice.spacing == (0.4, 0.05, 0.1)
    assert lattice.counts == (12, 22, 32)


def test_a_symmetric_box_is_not_sampled_on_its_own_plane():
    for resolution in (2, 3, 10, 101, 512):
        assert (lattice_over(((-1.0, 1.0),) * 3, resolution).axis(1) != 0).all()


def test_a_coordinate_does_not_depend_on_who_computes_it():
    lattice = lattice_over(BOX, 37)
    index = np.array([[3, 5, 7], [0, 0, 0]])
    points = lattice.points(index)
    assert [points[0, k] == lattice.axis(k)[index[0, k]] for k in range(3)] == [True] * 3


@pytest.mark.parametrize("resolution", [0, 1, -3, 2.5, True, "9", (3, 4), 100_000])
def test_bad_resolutions(resolution):
    with pytest.raises(RsymError) as caught:
        lattice_over(BOX, resolution)
    assert caught.value.code == "resolution"


def test_bounds_are_needed_where_the_boundary_has_no_end():
    with pytest.raises(RsymError) as caught:
        bounds_or_extent(Shape(x, (x, y)), None)
    assert caught.value.code == "unbounded"
