import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.sampling.distances import distance_to_lines, distance_to_mesh


def test_distance_from_a_square_is_exact():
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1.0]])
    points = np.random.default_rng(1).uniform(-3, 3, (500, 2))
    outside = np.linalg.norm(np.maximum(np.abs(points) - 1, 0), axis=1)
    inside = np.maximum(1 - np.abs(points).max(axis=1), 0)
    assert_close(distance_to_lines(points, [square]), outside + inside, atol=1e-12)


@pytest.mark.slow
def test_distance_from_a_ball_and_a_box():
    ball = rsym.mesh(rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1.2, 1.2),) * 3), 80)
    points = np.random.default_rng(2).uniform(-1.2, 1.2, (2000, 3))
    assert_close(distance_to_mesh(points, ball), np.abs(np.linalg.norm(points, axis=1) - 1), atol=5e-4)
    slab = rsym.Shape(rsym.conjunction(1 - x**2, 1 - y**2, 1 - z**2), (x, y, z), bounds=((-1.2, 1.2),) * 3)
    box = rsym.mesh(slab, 60)
    near = points[np.abs(points).max(axis=1) < 0.9]
    assert_close(distance_to_mesh(near, box), 1 - np.abs(near).max(axis=1), atol=1e-3)
