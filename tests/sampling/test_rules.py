"""Rules of integration on shapes in the plane: areas, lengths, moments against exact values."""

import math

import numpy as np
import pytest
from scipy.special import ellipe

import rsym
from rsym import x, y


def test_ellipse_has_its_area_and_length():
    rule = rsym.quadrature(rsym.Shape(1 - x**2 / 4 - y**2, (x, y)))
    assert abs(rule.weights.sum() / (2 * math.pi) - 1) < 1e-15
    assert abs(rule.boundary.weights.sum() / (8 * ellipe(3 / 4)) - 1) < 1e-14
    assert rule.unresolved == 0


@pytest.mark.parametrize("cells", [4, 8, 11])
def test_sides_along_the_grid_are_counted_once(cells):
    shape = rsym.Shape(
        rsym.disjunction(rsym.conjunction(x, y, 2 - x, 1 - y), rsym.conjunction(x, y, 1 - x, 2 - y)), (x, y)
    )
    rule = rsym.quadrature(shape, cells=cells, bounds=((0, 2), (0, 2)), near=[(1, 1)])
    assert abs(rule.weights.sum() - 3) < 1e-14
    lengths = [rule.boundary.of(part).weights.sum() for part in rule.parts[:6]]
    assert np.allclose(lengths, [2, 2, 1, 1, 1, 1], atol=1e-14)
    assert abs(rule.boundary.weights.sum() - 8) < 1e-14


def test_parts_that_do_not_exist_are_refused():
    rule = rsym.quadrature(rsym.Shape(1 - x**2 - y**2, (x, y)).named("disc"), cells=4)
    assert rule.boundary.of("disc").weights.sum() == rule.boundary.weights.sum()
    with pytest.raises(rsym.RsymError, match="disc"):
        rule.boundary.of("rim")
