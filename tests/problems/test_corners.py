"""Corners of plane shapes against places and angles known by construction."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

import rsym
from rsym import x, y
from rsym.problems.corners import corners


def half(angle, distance=0.0):
    return rsym.half_plane((math.cos(angle), math.sin(angle)), distance)


def wedge(opening, turn=0.0):
    """A sector of the unit disc with its tip at 0, from the direction `turn` on."""
    first, second = half(turn + math.pi / 2), half(turn + opening - math.pi / 2)
    return rsym.disc(1) & ((first & second) if opening < math.pi else (first | second))


def tip(shape):
    return min(corners(shape), key=lambda corner: math.hypot(*corner.point))


@pytest.mark.parametrize(
    "opening",
    [0.01, 0.5, math.pi / 2, 3.0, math.pi - 1e-4, math.pi + 1e-4, 4.0, 3 * math.pi / 2, 6.0, 2 * math.pi - 0.01],
)
def test_the_angle_and_the_edges_of_a_tip(opening):
    found = corners(wedge(opening, 0.3))
    assert len(found) == 3
    corner = tip(wedge(opening, 0.3))
    assert_allclose(corner.point, (0, 0), atol=1e-10)
    assert_allclose(corner.angle, opening, rtol=0, atol=1e-12)
    directions = [0.3, 0.3 + opening]
    assert_allclose(corner.edges, np.stack([np.cos(directions), np.sin(directions)], axis=1), atol=1e-12)
    assert corner.is_reentrant == (opening > math.pi)
