"""Boundaries and sections of shapes of many leaves: by what matters where, with the signs of kernels that see all."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.many_balls import many_balls
from oracles.undefined import without_value

import rsym
from rsym import x, y, z
from rsym.sampling.boundaries import boundary
from rsym.sampling.extent import proved_signs
from rsym.sampling.form_signs import FormBounds
from rsym.sampling.plane import PlaneSampler, plane_sampler
from rsym.sampling.plane_regions import PlaneForm
from rsym.sampling.regions.region_signs import TapedBounds


@pytest.fixture(scope="module")
def discs():
    return many_balls(70, 2)


@pytest.fixture(scope="module")
def balls():
    return many_balls(80, 3)


def dense(sampler):
    """The same, looked at everywhere by one kernel."""
    made = replace(sampler)
    made.__dict__["large"] = None
    return made


@pytest.fixture
def asked(monkeypatch):
    """How many points dense kernels are asked for."""
    counts = []
    plain = PlaneSampler._call

    def counted(self, u, v):
        counts.append(np.broadcast(u, v).size)
        return plain(self, u, v)

    monkeypatch.setattr(PlaneSampler, "_call", counted)
    return counts


def test_signs_of_many_discs_and_what_is_inside_are_those_of_the_value(discs):
    sampler = plane_sampler(discs[0], "value", resolution=100)
    assert sampler.large is not None
    np.testing.assert_array_equal(sampler.signs(), dense(sampler).signs())
    points = np.random.default_rng(5).uniform(-1.2, 1.2, (3000, 2))
    inside = sampler.inside(points)
    np.testing.assert_array_equal(inside, dense(sampler).inside(points))
    distances = np.linalg.norm(points[:, None] - discs[1], axis=2)
    np.testing.assert_array_equal(inside, (distances < discs[2]).any(axis=1))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_signs_of_a_section_of_many_balls_are_those_of_the_value(balls, axis):
    section = {(x, y, z)[axis]: 0.3}
    sampler = plane_sampler(balls[0], "value", resolution=70, section=section)
    assert sampler.large is not None
    signs = sampler.signs()
    np.testing.assert_array_equal(signs, dense(sampler).signs())
    assert (signs == 1).any()


def test_where_omega_is_undefined_signs_are_so_too(discs):
    root = rsym.Shape(without_value(sp.Rational(1, 2) - x) - 2, (x, y))  # no form knows its domain
    sampler = plane_sampler((discs[0] | root).replace(bounds=discs[0].box.ends), "value", resolution=40)
    assert sampler.large is not None
    signs = sampler.signs()
    assert np.isnan(signs).any()
    np.testing.assert_array_equal(signs, dense(sampler).signs())


def test_beyond_the_domain_of_a_part_signs_are_those_of_the_others(discs):
    shape = (discs[0] | rsym.Shape(sp.sqrt(x - 0.5) - 1, (x, y))).replace(bounds=discs[0].box.ends)  # at most 0.85 - 1
    signs = plane_sampler(shape, "value", resolution=40).signs()
    alone = plane_sampler(discs[0], "value", resolution=40).signs()
    assert {-1, 1} <= set(alone.ravel().tolist())
    np.testing.assert_array_equal(signs, alone)


def test_the_boundary_of_many_discs_is_found_by_looking_once_at_the_lattice(discs, asked):
    shape, _, radii = discs
    found = boundary(shape, shape.box.ends, 64)
    assert asked == [66**2, len(found.points)]
    assert found.closed
    assert len(found.lines) == len(radii)
    assert found.area() == pytest.approx(np.pi * (radii**2).sum(), rel=1e-7)
    assert found.deviation == pytest.approx(1 - 2 * radii.min(), abs=1e-3)


def test_sections_of_many_balls_are_circles_and_compile_nothing(balls, monkeypatch):
    def refuse(*_):
        raise AssertionError("a kernel of all leaves")

    monkeypatch.setattr("rsym.sampling.plane._kernel", refuse)
    monkeypatch.setattr("rsym.sampling.plane_leaves._all_leaves", refuse)
    shape, centres, radii = balls
    met = np.abs(centres[:, 0] + 0.37) < radii
    (found,) = rsym.sections(shape, [-0.37], axis=x, resolution=80)
    assert len(found.lines) == met.sum() > 3
    assert found.lines.status.closed == len(found.lines)
    area = np.pi * (radii[met] ** 2 - (centres[met, 0] + 0.37) ** 2).sum()
    assert found.lines.area == pytest.approx(area, rel=0.03)
    for line in found.lines:
        off = np.linalg.norm(found.in_space(line)[:, None] - centres, axis=2) - radii
        assert np.abs(off).min(axis=0).min() < 1e-13
        assert np.abs(off).min(axis=1).max() < 1e-13


def test_sections_along_a_face_and_with_corners_are_those_of_kernels_of_all_leaves(balls, monkeypatch):
    shape = (balls[0] | rsym.Shape(0.13 - abs(x), (x, y, z))) & rsym.Shape(z - 0.25, (x, y, z))
    shape = shape.replace(bounds=balls[0].box.ends)
    own = rsym.sections(shape, [0.25, 0.5], resolution=60)
    monkeypatch.setattr("rsym.sampling.plane_regions.backend_for", lambda form: "llvm")
    for one, other in zip(own, rsym.sections(shape, [0.25, 0.5], resolution=60), strict=True):
        assert one.lines.status == other.lines.status
        assert len(one.lines) == len(other.lines) > 3
        for line, same in zip(one.lines, other.lines, strict=True):
            np.testing.assert_allclose(line, same, atol=1e-13)


def test_points_on_the_boundary_of_many_discs_lie_on_their_circles(discs):
    shape, centres, radii = discs
    found = rsym.sample(shape, 300, over="boundary", resolution=80, rng=1)
    off = np.abs(np.linalg.norm(found.points[:, None] - centres, axis=2) - radii)
    assert off.min(axis=1).max() < 1e-13
    nearest = centres[off.argmin(axis=1)]
    outwards = (found.points - nearest) / np.linalg.norm(found.points - nearest, axis=1)[:, None]
    np.testing.assert_allclose(found.normals, outwards, atol=1e-9)


SLOW = ["gear", "car", "spring", "solids", "vase", "lattice", "jack", "gyroid", "snowflake"]


@pytest.mark.filterwarnings("ignore:.*Unresolved in")  # the middle plane of the car touches the holes of its headlights
@pytest.mark.parametrize("model", ["bracket", *(pytest.param(model, marks=pytest.mark.slow) for model in SLOW)])
def test_sections_and_extents_have_the_same_bits_by_tapes(model, monkeypatch):
    """Or, where bounds by tapes are not as narrow and more cells are looked at, the same lines with more vertices."""

    def looked_at(look):
        shape = rsym.load(model)
        # With a letter of its own it does not share what was made for the first look.
        shape = shape.replace(letters={**shape.letters, look: 0})
        if shape.dimension == 2:
            shape = rsym.extrude(shape, 0, 1)
        (low, high), axis = (shape.bounds or rsym.extent(shape))[2], shape.coordinates[2]
        heights = [0.0, 0.7 * low + 0.3 * high, (low + high) / 2]
        sampler = plane_sampler(shape, "value", resolution=20, section={axis: heights[1]})
        found = rsym.sections(shape, heights, axis=axis, resolution=100)
        return found, extent_or_words(shape), (sampler.large, type(proved_signs(shape).bounds))

    sections, extent, (large, bounds) = looked_at("compiled")
    assert (large, bounds) == (None, FormBounds)
    for where in ("rsym.sampling.plane_regions", "rsym.sampling.kernels.mesher_kernels"):
        monkeypatch.setattr(f"{where}.backend_for", lambda form: "tape")
    same, same_extent, (large, bounds) = looked_at("taped")
    assert (type(large), bounds) == (PlaneForm, TapedBounds)
    assert same_extent == extent
    for one, other in zip(sections, same, strict=True):
        vertices = [found.lines.status.vertices for found in (one, other)]
        assert replace(one.lines.status, vertices=vertices[1]) == other.lines.status
        for line, again in zip(one.lines, other.lines, strict=True):
            if vertices[0] == vertices[1]:
                np.testing.assert_array_equal(line, again)
        assert_close(other.lines.length, one.lines.length, rtol=1e-4)
        assert_close(other.lines.area, one.lines.area, rtol=1e-4)
    assert any(len(one.lines) for one in sections)


def extent_or_words(shape):
    try:
        return rsym.extent(shape)
    except rsym.RsymError as error:
        return str(error)
