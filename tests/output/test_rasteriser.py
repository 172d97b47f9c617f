import numpy as np
import pytest

from rsym.output import rasteriser
from rsym.output.rasteriser import rasterise, snap


def random_triangles(count, size, seed, spread):
    rng = np.random.default_rng(seed)
    middle = rng.uniform(0, size, (count, 1, 2))
    flat = middle + rng.normal(0, spread, (count, 3, 2))
    return np.concatenate([flat, rng.uniform(-3, 5, (count, 3, 1))], axis=2)


def by_brute_force(corners, size):
    """Every pixel against every triangle, in floating point on the snapped corners."""
    height, width = size
    y, x = np.mgrid[:height, :width] + 0.5
    best = np.full(size, np.inf)
    nearest = np.full(size, -1)
    for name, corner in enumerate(corners):
        (ax, ay), (bx, by), (cx, cy) = np.round(corner[:, :2] * 256) / 256
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0:
            continue
        u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area
        v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area
        depth = u * corner[0, 2] + v * corner[1, 2] + (1 - u - v) * corner[2, 2]
        wins = (u >= 0) & (v >= 0) & (u + v <= 1) & (depth < best)
        best[wins], nearest[wins] = depth[wins], name
    return nearest


@pytest.mark.parametrize("spread", [1.5, 12.0, 200.0])
def test_the_nearest_triangle_of_each_pixel_equals_brute_force(spread):
    corners = random_triangles(60, 50, seed=7, spread=spread)
    found, expected = rasterise(snap(corners), (45, 60)), by_brute_force(corners, (45, 60))
    assert (found >= 0).sum() > 50
    np.testing.assert_array_equal(found, expected)


def test_the_area_of_a_large_triangle():
    corners = np.array([[[10.3, 20.1, 0], [990.7, 100.9, 0], [400.2, 780.4, 0]]])
    (ax, ay), (bx, by), (cx, cy) = corners[0, :, :2]
    exact = ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
    assert (rasterise(snap(corners), (800, 1000)) >= 0).sum() == pytest.approx(exact, rel=1e-3)


def test_a_triangulated_square_has_no_hole_and_no_overhang():
    rng = np.random.default_rng(1)
    grid = np.stack(np.meshgrid(np.linspace(5, 95, 40), np.linspace(5, 95, 40), indexing="ij"), axis=-1)
    grid[1:-1, 1:-1] += rng.uniform(-0.7, 0.7, (38, 38, 2))
    a, b, c, d = (part.reshape(-1, 2) for part in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, :-1], grid[1:, 1:]))
    flat = np.concatenate([np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)])
    corners = np.concatenate([flat, np.zeros((*flat.shape[:2], 1))], axis=2)
    expected = np.zeros((100, 100), bool)
    expected[5:95, 5:95] = True
    np.testing.assert_array_equal(rasterise(snap(corners), (100, 100)) >= 0, expected)


def test_neither_order_nor_chunks_nor_winding_change_the_picture():
    corners = random_triangles(400, 80, seed=3, spread=8.0)
    picture = rasterise(snap(corners), (80, 80))
    order = np.random.default_rng(0).permutation(len(corners))
    shuffled = rasterise(snap(corners[order]), (80, 80))
    np.testing.assert_array_equal(np.where(shuffled < 0, -1, order[shuffled]), picture)
    for budget in (1, 57, 1000):
        np.testing.assert_array_equal(rasterise(snap(corners), (80, 80), budget=budget), picture)
    np.testing.assert_array_equal(rasterise(snap(corners[:, ::-1]), (80, 80)), picture)


def test_of_equal_depths_the_lowest_index_wins():
    corner = [[0, 0, 2.0], [9, 0, 2.0], [0, 9, 2.0]]
    picture = rasterise(snap(np.array([corner, corner, corner])), (9, 9))
    assert set(np.unique(picture)) == {-1, 0}


def test_degenerate_and_undefined_triangles_are_left_out():
    line = [[0, 0, 0], [5, 5, 0], [9, 9, 0]]
    undefined = [[0, 0, 0], [np.nan, 5, 0], [9, 0, 0]]
    good = [[0, 0, 1], [9, 0, 1], [0, 9, 1]]
    triangles = snap(np.array([line, undefined, good], float))
    assert triangles.facing.tolist() == [0, 0, 1]
    assert set(np.unique(rasterise(triangles, (9, 9)))) == {-1, 2}


def test_a_triangle_far_larger_than_the_picture_fills_it():
    corners = np.array([[[-1e7, -1e7, 0], [1e7, -1e7, 0], [0, 1e7, 0.0]]])
    assert (rasterise(snap(corners), (30, 40)) == 0).all()


def test_nothing_to_draw_gives_an_empty_picture():
    assert (rasterise(snap(np.zeros((0, 3, 3))), (4, 5)) == -1).all()


def test_weights_give_back_the_middle_of_the_pixel():
    corners = random_triangles(50, 40, seed=5, spread=15.0)
    triangles = snap(corners)
    picture = rasterise(triangles, (40, 40))
    rows, columns = np.nonzero(picture >= 0)
    faces = picture[rows, columns]
    weights = triangles.weights(faces, rows, columns)
    assert weights.min() >= 0
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-12)
    there = np.einsum("ij,ijk->ik", weights, corners[faces, :, :2])
    np.testing.assert_allclose(there, np.stack([columns, rows], axis=1) + 0.5, atol=1 / rasteriser.SUBPIXELS)


def test_distances_to_the_nearest_edge_of_a_known_triangle():
    triangles = snap(np.array([[[0.0, 0, 0], [8, 0, 0], [0, 6, 0]]]))
    found = triangles.distances(np.array([0, 0]), np.array([0, 2]), np.array([3, 2]))
    # To y = 0, and to the hypotenuse 3x + 4y = 24 from (2.5, 2.5).
    np.testing.assert_allclose(found, [0.5, (24 - 17.5) / 5])
