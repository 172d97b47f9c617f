"""Rules of integration on shapes in space: volumes and surfaces against exact values."""

import math

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import conjunction, disjunction, x, y, z
from rsym.sampling.rules.quadrature import prepared


def space(expression, **more):
    return rsym.Shape(expression, (x, y, z), **more)


def off(shape, volume, surface, **more):
    """Relative errors of volume and surface."""
    rule = rsym.quadrature(shape, **more)
    assert rule.weights.min() >= 0
    assert rule.boundary.weights.min() >= 0
    found = rule.boundary
    flux = (found.weights * (found.points * found.normals).sum(axis=1)).sum() / 3  # the volume by Gauss's theorem
    assert abs(flux / volume - 1) < 1e-7
    return abs(rule.weights.sum() / volume - 1), abs(found.weights.sum() / surface - 1)


def test_ball_and_torus():
    assert max(off(space(1 - x**2 - y**2 - z**2), 4 * math.pi / 3, 4 * math.pi, cells=8, order=9)) < 1e-11
    assert max(off(rsym.torus(1, 0.4), 0.32 * math.pi**2, 1.6 * math.pi**2, cells=8, order=12)) < 1e-10


def test_bead_has_a_volume_by_its_height_alone():
    height, hole = 1.6, 0.6
    bead = space(conjunction(1 - x**2 - y**2 - z**2, x**2 + y**2 - hole**2))
    surface = 2 * math.pi * height + 2 * math.pi * hole * height
    assert max(off(bead, math.pi * height**3 / 6, surface, cells=8, order=10)) < 1e-10


@pytest.mark.parametrize("cells", [5, 8])
def test_intersection_of_cylinders(cells):
    both = space(conjunction(1 - x**2 - z**2, 1 - y**2 - z**2))
    assert max(off(both, 16 / 3, 16, cells=cells)) < 1e-10


@pytest.mark.parametrize("cells", [3, 4])
def test_boxes_on_the_grid_and_off_it(cells):
    box = space(conjunction(x, y, z, 1 - x, 1 - y, 1 - z))
    assert max(off(box, 1, 6, cells=cells, order=3)) < 1e-14
    rule = rsym.quadrature(box, cells=4, order=3, bounds=((0, 1),) * 3)
    assert abs(rule.boundary.weights.sum() - 6) < 1e-14
    assert len(rule.full) == 64
    step = space(disjunction(conjunction(x, y, z, 1 - x, 1 - y, 1 - z), conjunction(x - 1, 2 - x, y, 1 - y, z, 2 - z)))
    assert max(off(step, 3, 14, cells=cells, order=3, bounds=((0, 2),) * 3)) < 1e-14


def test_parts_of_a_turned_cylinder():
    rod = space(1 - x**2 - y**2).named("rim") & space(z).named("foot") & space(1.5 - z).named("top")
    rule = rsym.quadrature(rod.rotate(0.3, axis=x), cells=6, order=6)
    areas = [rule.boundary.of(part).weights.sum() for part in ("rim", "foot", "top")]
    assert np.allclose(areas, [3 * math.pi, math.pi, math.pi], rtol=1e-7)
    assert abs(rule.weights.sum() / (1.5 * math.pi) - 1) < 1e-9


@pytest.mark.parametrize(
    ("shape", "content", "boundary", "order"),
    [
        ((rsym.box(2, 2, 2) - rsym.box(1, 1, 1, (0.5, 0, 0))).rotate(0.3, (1, 2, 3)), 7, 28, 3),
        (rsym.sphere(1) & rsym.Shape(2 - 2 * sp.sqrt(x**2 + y**2 + z**2), (x, y, z)), 4 * math.pi / 3, 4 * math.pi, 8),
        (rsym.sphere(1) - rsym.sphere(1), 0, 0, 3),
    ],
    ids=["flush boxes", "a ball twice", "nothing"],
)
def test_two_leaves_on_one_surface_are_one(shape, content, boundary, order):
    """Cells were divided between them without end."""
    rule = rsym.quadrature(shape, cells=2, order=order, bounds=((-2, 2),) * 3)
    assert abs(rule.weights.sum() - content) < 1e-6
    assert abs(rule.boundary.weights.sum() - boundary) < 1e-5
    assert rule.unresolved < 1e-12


BALL = rsym.sphere(1)
CORNER = rsym.box(1, 1, 1) - rsym.box(0.5, 0.5, 0.5, (0.25, 0.25, 0.25))
ALONG, ACROSS = (3 * x + 4 * y) / 5, (3 * y - 4 * x) / 5
# A plane that touches the cylinder along a line.
TOUCHED = rsym.Shape(sp.Min(1 - ALONG**2 - z**2, 1 - (3 * ALONG + 4 * z) / 5, 1 - ACROSS**2), (x, y, z))
ROW = rsym.box(1, 1, 1) | rsym.box(1, 1, 1, (1, 0.25, 0.3))


@pytest.mark.parametrize(
    ("shape", "volume", "surface", "order", "relative"),
    [
        (BALL - rsym.sphere(0.99), 4 * math.pi / 3 * (1 - 0.99**3), 4 * math.pi * (1 + 0.99**2), 8, 1e-7),
        # Viviani's body: a cylinder that touches the ball within.
        (BALL & rsym.cylinder(0.5, centre=(0.5, 0, 0)), 2 * math.pi / 3 - 8 / 9, 2 * math.pi, 6, 1e-4),
        (TOUCHED, 2 * math.pi, 6 * math.pi, 4, 1e-5),
        (CORNER.rotate(0.37).rotate(0.21, x).rotate(0.53, y), 7 / 8, 6, 2, 1e-13),
        (ROW.rotate(0.37).rotate(0.21, x).rotate(0.53, y), 2, 10.95, 2, 1e-13),
    ],
)
def test_thin_tangent_and_turned_bodies_are_resolved_by_few_points(shape, volume, surface, order, relative):
    """Nothing was known of shells and tangent bodies, and turned boxes were parted into thousands of pieces a cell."""
    rule = rsym.quadrature(shape, cells=4, order=order)
    assert rule.unresolved < 1e-12
    assert abs(rule.weights.sum() / volume - 1) < relative
    assert abs(rule.boundary.weights.sum() / surface - 1) < relative
    assert len(rule.weights) < 5000 * order**3


@pytest.mark.parametrize("fold", [z - sp.Rational(1, 7), x**2 + y**2 + z**2 - sp.Rational(1, 4)])
def test_rules_end_and_begin_on_folds_which_bound_nothing(fold):
    rule = prepared(space(1 - x**2 - y**2 - z**2), ((-1.01, 1.01),) * 3, None, (fold,)).rule(4, 8)
    inner = sp.lambdify((x, y, z), fold)(*rule.points.T) < 0
    wanted = math.pi / 6 if fold.has(x) else math.pi * (2 / 3 + 1 / 7 - 1 / 7**3 / 3)
    assert abs(rule.weights[inner].sum() / wanted - 1) < 1e-8
    assert abs(rule.weights.sum() / (4 * math.pi / 3) - 1) < 1e-8
    assert abs(rule.boundary.weights.sum() / (4 * math.pi) - 1) < 1e-8
