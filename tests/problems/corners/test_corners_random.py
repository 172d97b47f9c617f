"""Corners of random trees of polygons and discs, against shapely and against their own boundary."""

import math

import numpy as np
import pytest
import shapely
from numpy.testing import assert_allclose

import rsym
from rsym.problems.corners.corner_functions import corner_functions
from rsym.problems.corners.corners import corners
from rsym.sampling.level_lines import dense_outline
from rsym.sampling.plane_leaves import leaves_of

BOX = ((-3, 3), (-3, 3))


def convex(generator):
    """A random convex polygon as a shape of half planes, and for shapely."""
    while True:
        angles = np.sort(generator.uniform(0, 2 * math.pi, generator.integers(3, 6)))
        if max(np.diff([*angles, angles[0] + 2 * math.pi])) < 2.9:
            break
    centre = generator.uniform(-0.6, 0.6, 2)
    shape, polygon = None, shapely.box(-10, -10, 10, 10)
    for angle, distance in zip(angles, generator.uniform(0.3, 1, len(angles)), strict=True):
        normal = np.array([math.cos(angle), math.sin(angle)])
        along, offset = np.array([-normal[1], normal[0]]), normal @ centre - distance
        half = rsym.half_plane(tuple(normal), offset)
        shape = half if shape is None else shape & half
        foot = normal * offset
        ends = [foot + 50 * along, foot - 50 * along, foot - 50 * along + 50 * normal, foot + 50 * along + 50 * normal]
        polygon = polygon.intersection(shapely.Polygon(ends))
    return shape, polygon


def turns(polygon):
    """Its vertices and the angles inside."""
    for part in getattr(polygon, "geoms", [polygon]):
        part = shapely.geometry.polygon.orient(part)
        for ring in (part.exterior, *part.interiors):
            points = np.array(ring.coords)[:-1]
            for before, here, after in zip(
                np.roll(points, 1, axis=0), points, np.roll(points, -1, axis=0), strict=True
            ):
                first, second = (math.atan2(*(other - here)[::-1]) for other in (after, before))
                angle = (second - first) % (2 * math.pi)
                if abs(angle - math.pi) > 1e-6:
                    yield (*here, angle)


@pytest.mark.random
@pytest.mark.parametrize("seed", range(20))
def test_corners_of_random_polygons_are_those_of_shapely(seed):
    generator = np.random.default_rng(seed)
    shape, polygon = convex(generator)
    for _ in range(generator.integers(1, 4)):
        other, more = convex(generator)
        if generator.random() < 0.5:
            shape, polygon = shape | other, polygon.union(more)
        else:
            shape, polygon = shape - other, polygon.difference(more)
    found = np.array(
        [(*corner.point, corner.angle) for corner in corners(shape, bounds=((-12, 12), (-12, 12)))]
    ).reshape(-1, 3)
    expected = np.array(list(turns(polygon))).reshape(-1, 3)
    assert len(found) == len(expected)
    apart = np.abs(found[:, None] - expected).max(axis=2)
    assert_allclose(apart.min(axis=0, initial=9 if len(found) else 0), 0, atol=1e-9)


@pytest.mark.random
@pytest.mark.parametrize("seed", range(20))
def test_functions_of_random_shapes_vanish_on_all_of_the_boundary(seed):
    generator = np.random.default_rng(seed)
    shape, _ = convex(generator)
    for _ in range(generator.integers(1, 4)):
        disc = rsym.disc(float(generator.uniform(0.3, 0.8)), tuple(map(float, generator.uniform(-0.7, 0.7, 2))))
        other = disc if generator.random() < 0.6 else convex(generator)[0]
        shape = shape | other if generator.random() < 0.5 else shape - other
    found = corner_functions(shape, corners(shape, bounds=BOX))
    points = np.concatenate([np.empty((0, 2)), *dense_outline(shape, 200, BOX)])
    leaves = leaves_of(shape.replace(bounds=BOX), (0, 1), {})
    points = leaves.slide(points, leaves.distance(points)[1])
    away = [np.hypot(*(points - corner.point).T) > 1e-6 for corner in found.corners]
    points = points[(leaves.distance(points)[0] < 1e-13) & np.logical_and.reduce(away)]
    size = np.array([min(part.radius, 1) ** term.exponent for part in found.parts for term in part.terms])
    assert len(points) > 100
    assert_allclose(found.derivatives(points, 0)[0] / size[:, None], 0, atol=1e-12)
