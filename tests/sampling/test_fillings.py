"""The inside in cells: as large as the polygons of the outline or as known bodies, each face of two cells, or outer."""

from functools import reduce
from operator import or_

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, x, y
from rsym.sampling.fillings import filling

BOX = ((-1.1, 1.1), (-1.1, 1.1))
RING = rsym.disc(1) - rsym.disc(0.4)
TURNED = rsym.rectangle(1.6, 0.8).rotate(0.3) - rsym.disc(0.2)
STAR = rsym.regular_polygon(3, 1) | rsym.regular_polygon(3, 1).rotate(np.pi)
CROSS = rsym.rectangle(2, 0.1) | rsym.rectangle(0.1, 2)  # thinner than two cells
PAIR = rsym.rectangle(1, 1).translate(-0.51, -0.51) | rsym.rectangle(1, 1).translate(0.51, 0.51)
L = rsym.rectangle(2, 2) - rsym.rectangle(2, 2).translate(1, 1)


def faces_of(made):
    """The faces of cells and how many cells have each."""
    every = np.concatenate([np.delete(made.cells, k, axis=1) for k in range(made.cells.shape[1])])
    return np.unique(np.sort(every, axis=1), axis=0, return_counts=True)


def assert_fits(made):
    """No cell is turned over, none overlaps its neighbour, and every point is used."""
    assert (made.sizes > 0).all()
    faces, count = faces_of(made)
    assert count.max() == 2
    assert np.array_equal(np.unique(made.cells), np.arange(len(made.points)))
    return faces[count == 1]


@pytest.mark.parametrize(
    ("shape", "area", "around"),
    [
        (TURNED, 1.28 - np.pi * 0.04, 4.8 + np.pi * 0.4),
        (STAR, np.sqrt(3), 4 * np.sqrt(3)),
        (CROSS, 0.39, 8),
        (L, 3, 8),
        (RING, np.pi * 0.84, np.pi * 2.8),
    ],
    ids=["turned", "star", "cross", "L", "ring"],
)
def test_triangles_fill_a_plane_shape_up_to_its_corners(shape, area, around):
    made = filling(shape, BOX, 37)
    rim = assert_fits(made)
    curved = shape in (RING, TURNED)
    # Chords of a circle lose the square of the cell; straight sides and corners nothing.
    assert_close(made.sizes.sum(), area, rtol=4e-3 if curved else 1e-12)
    length = np.linalg.norm(np.diff(made.points[rim], axis=1)[:, 0], axis=1).sum()
    assert_close(length, around, rtol=4e-3 if curved else 1e-12)
    on = np.unique(rim)
    assert_close(rsym.compile(shape)(*made.points[on].T)["value"], np.zeros(len(on)), atol=1e-12)


def test_a_square_of_the_lattice_with_two_pieces_of_an_outline():
    for shift in np.linspace(0, 0.06, 5):  # of a cell
        made = filling(PAIR.translate(shift, shift), ((-1.1, 1.1), (-1.1, 1.1)), 37)
        assert_fits(made)
        assert_close(made.sizes.sum(), 2, rtol=1e-12)


@pytest.mark.parametrize("resolution", [9, 14, 25])
def test_the_tip_of_a_notch_reaches_into_squares_that_its_edges_do_not_cross(resolution):
    notch = rsym.Shape(y + 6 * x + 0.3, (x, y)) & rsym.Shape(y - 6 * x + 0.3, (x, y))
    made = filling((rsym.rectangle(1.4, 1.4) - notch).rotate(0.2), BOX, resolution)
    assert_fits(made)
    assert_close(made.sizes.sum(), 1.96 - 1 / 6, rtol=1e-12)


def test_an_outline_finer_than_the_lattice_turns_no_cell_over():
    bars = [rsym.rectangle(0.9, 0.06).rotate(0.4 * k).translate(0.1 * k, 0.05) for k in range(5)]
    for resolution in (17, 29):
        assert_fits(filling(reduce(or_, bars, rsym.disc(0.3)), BOX, resolution))


def test_triangles_are_not_flat():
    made = filling(TURNED, BOX, 60)
    corners = made.points[made.cells]
    longest = np.max(np.sum((corners - np.roll(corners, 1, axis=1)) ** 2, axis=2), axis=1)
    shares = made.sizes / longest
    assert shares.min() > 1e-5
    assert np.quantile(shares, 0.02) > 0.05


@pytest.mark.parametrize(
    ("shape", "bounds", "volume", "euler"),
    [
        (rsym.sphere(1), ((-1.1, 1.1),) * 3, 4 / 3 * np.pi, 2),
        (rsym.torus(1, 0.4), ((-1.5, 1.5), (-1.5, 1.5), (-0.5, 0.5)), 2 * np.pi**2 * 0.16, 0),
    ],
    ids=["ball", "ring"],
)
def test_tetrahedra_fill_a_body(shape, bounds, volume, euler):
    made = filling(shape, bounds, 20)
    rim = assert_fits(made)
    assert_close(made.sizes.sum(), volume, atol=0.02 * volume)
    on = np.unique(rim)
    assert_close(rsym.compile(shape)(*made.points[on].T)["value"], np.zeros(len(on)), atol=1e-12)
    edges = np.unique(np.sort(np.concatenate([rim[:, [0, 1]], rim[:, [1, 2]], rim[:, [0, 2]]]), axis=1), axis=0)
    assert len(on) - len(edges) + len(rim) == euler


def test_what_is_thinner_than_a_cell_is_refused():
    with pytest.raises(RsymError, match=r"nothing inside.*resolution="):
        filling(rsym.rectangle(2, 0.001), BOX, 8)
    with pytest.raises(RsymError, match="not closed"):
        filling(rsym.disc(1.2), ((-1, 1), (-1, 1)), 8)
