"""Level lines as curves round regions: which side is which, areas, lengths, polygons."""

import sys

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, x, y, z

BOX = ((-2, 2), (-2, 2))
RING = rsym.disc(1.5) - rsym.disc(0.5)  # a region with a hole
TARGET = (rsym.disc(1.8) - rsym.disc(1.2)) | (rsym.disc(0.8) - rsym.disc(0.3).translate(0.2, 0))


def on_the_left(lines, field, level, step):
    """Whether the field exceeds the level to the left of the middle of segments, and not to the right.

    But for one beside a tip of two lines that touch.
    """
    for line in lines:
        along = np.diff(line, axis=0)
        length = np.linalg.norm(along, axis=1)
        kept = length > 1e-6 * length.max()
        middle, along = (line[1:] + line[:-1])[kept] / 2, along[kept] / length[kept][:, None]
        left = step * np.stack([-along[:, 1], along[:, 0]], axis=1)
        assert (field(middle + left) > level).mean() > 0.98
        assert (field(middle - left) < level).mean() > 0.98


@pytest.mark.parametrize("level", [0.0, 0.1, -0.1])
@pytest.mark.parametrize("shape", [RING, TARGET, ~RING], ids=["ring", "target", "complement"])
def test_the_region_is_to_the_left_round_holes_too(shape, level):
    lines = rsym.level_lines(shape, level, resolution=120, bounds=BOX)
    kernel = rsym.compile(shape)
    assert lines.status.closed == len(lines) >= 2
    on_the_left(lines, lambda points: kernel(*points.T)["value"], level, 0.004)


def test_the_region_is_to_the_left_of_lines_that_end_and_of_other_fields():
    saddle = rsym.Shape(x**2 - y**2 - 1, (x, y), bounds=BOX)
    lines = rsym.level_lines(saddle, resolution=60)
    assert lines.status.open == 2
    on_the_left(lines, lambda points: points[:, 0] ** 2 - points[:, 1] ** 2 - 1, 0, 0.01)
    lines = rsym.level_lines(saddle, 4.0, field="gradient_squared", resolution=60)
    on_the_left(lines, lambda points: 4 * (points**2).sum(axis=1), 4, 0.01)


@pytest.mark.parametrize("axis", [x, y, z])
def test_sections_have_the_body_to_the_left_in_their_plane(axis):
    body = rsym.sphere(1.5) - rsym.sphere(0.8)
    (section,) = rsym.sections(body, [0.3], axis=axis, resolution=80, bounds=((-2, 2),) * 3)
    radii = np.sqrt(1.5**2 - 0.09), np.sqrt(0.64 - 0.09)
    assert len(section.lines) == 2
    on_the_left(
        section.lines,
        lambda points: np.minimum(radii[0] - np.hypot(*points.T), np.hypot(*points.T) - radii[1]),
        0,
        0.02,
    )
    assert_close(section.lines.area, np.pi * (radii[0] ** 2 - radii[1] ** 2), rtol=2e-3)
    lines = rsym.level_lines(body, section={axis: 0.3}, resolution=80, bounds=((-2, 2),) * 3)
    assert_close(lines.area, section.lines.area, rtol=1e-3)


def test_areas_and_lengths_take_holes_into_account():
    lines = rsym.level_lines(RING, resolution=400, bounds=BOX)
    assert_close(lines.area, 2 * np.pi, rtol=1e-4)
    assert_close(lines.length, 4 * np.pi, rtol=1e-4)
    assert_close(rsym.level_lines(~RING, resolution=400, bounds=BOX).area, -2 * np.pi, rtol=1e-4)
    errors = [2.25 * np.pi - rsym.level_lines(rsym.disc(1.5), resolution=n, bounds=BOX).area for n in (50, 100)]
    assert errors[0] > 3 * errors[1] > 0
    (square,) = (section.lines for section in rsym.sections(rsym.box(2, 1, 3), [0], resolution=50))
    assert_close(square.area, 2, rtol=1e-12)
    assert_close(square.length, 6, rtol=1e-12)


def test_lines_that_end_bound_no_area():
    lines = rsym.level_lines(rsym.Shape(x, (x, y), bounds=BOX), resolution=40)
    assert_close(lines.length, np.ptp(lines[0][:, 1]), rtol=1e-12)
    assert_close(lines.length, 4, rtol=1e-12)
    for ask in (lambda: lines.area, lines.to_shapely):
        with pytest.raises(RsymError, match=r"1 of 1 lines end.*remedy.*bounds"):
            ask()


def test_no_lines_measure_nothing():
    lines = rsym.level_lines(rsym.disc(1), 9.0, resolution=40, bounds=BOX)
    assert len(lines) == 0
    assert (lines.area, lines.length) == (0.0, 0.0)


def test_polygons_have_their_holes():
    shapely = pytest.importorskip("shapely")
    lines = rsym.level_lines(TARGET, resolution=200, bounds=BOX)
    region = lines.to_shapely()
    assert isinstance(region, shapely.MultiPolygon)
    assert region.is_valid
    assert sorted(len(one.interiors) for one in region.geoms) == [1, 1]
    assert_close(region.area, lines.area, rtol=1e-12)
    assert_close(region.length, lines.length, rtol=1e-12)
    points = np.random.default_rng(3).uniform(-2, 2, (500, 2))
    clear = np.abs(rsym.compile(TARGET)(*points.T)["value"]) > 0.01
    inside = shapely.contains_xy(region, *points[clear].T)
    assert inside.tolist() == TARGET.contains(*points[clear].T).tolist()
    assert rsym.level_lines(TARGET, 9.0, resolution=40, bounds=BOX).to_shapely().is_empty


def test_a_region_outside_its_lines_is_no_polygon():
    pytest.importorskip("shapely")
    with pytest.raises(RsymError, match="outside of its lines"):
        rsym.level_lines(~rsym.disc(1), resolution=40, bounds=BOX).to_shapely()


def test_without_shapely_the_remedy_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "shapely", None)
    with pytest.raises(RsymError, match="pip install shapely"):
        rsym.level_lines(RING, resolution=40, bounds=BOX).to_shapely()


def random_region(generator):
    """Discs, rectangles and ellipses, two to five of them, joined, cut and crossed at random."""

    def piece():
        kind, size, turn = generator.integers(3), generator.uniform(0.2, 1.3, 2), generator.uniform(0, 3)
        one = (rsym.disc(size[0]), rsym.rectangle(*2 * size), rsym.ellipse(*size))[kind]
        return one.rotate(turn).translate(*generator.uniform(-1.3, 1.3, 2))

    shape = piece()
    for _ in range(generator.integers(1, 5)):
        other = piece()
        shape = (shape | other, shape - other, shape & other, shape ^ other)[generator.integers(4)]
    return shape


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:Unresolved in . cell")
def test_random_regions_are_valid_polygons_whatever_the_lattice_misses():
    shapely = pytest.importorskip("shapely")
    generator = np.random.default_rng(4)
    told = 0
    for _ in range(40):
        lines = rsym.level_lines(random_region(generator), resolution=60, bounds=((-3, 3), (-3, 3)))
        region = lines.to_shapely()
        assert isinstance(region, shapely.MultiPolygon)
        assert region.is_valid
        assert abs(region.area - lines.area) < 0.02
        told += lines.status.unseen > 0
    assert told <= 2


@pytest.mark.parametrize("resolution", [16, 77, (40, 23)])
def test_lines_end_at_the_bounds_on_the_level(resolution):
    disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 0.5), (-2, 0.75)))
    (line,) = rsym.level_lines(disc, resolution=resolution)
    ends = sorted(map(tuple, line[[0, -1]]))
    assert_close(ends, sorted([(-np.sqrt(7) / 4, 0.75), (0.5, -np.sqrt(0.75))]), atol=1e-12)
    assert (line[:, 0].max(), line[:, 1].max()) == (0.5, 0.75)
    assert_close(np.hypot(*line.T), np.ones(len(line)), atol=1e-12)


def test_a_line_through_the_bounds_is_as_long_as_they_are_wide_and_pieces_outside_go():
    (flat,) = rsym.level_lines(rsym.Shape(y, (x, y), bounds=((-1, 1), (-1, 1))), resolution=32)
    assert flat[[0, -1]].tolist() == [[-1, 0], [1, 0]]
    disc, square = rsym.Shape(1 - x**2 - y**2, (x, y)), ((-0.9, 0.9), (-0.9, 0.9))
    arcs = rsym.level_lines(disc, resolution=64, bounds=square)  # closed on the lattice, four arcs in the bounds
    assert (len(arcs), arcs.status.closed, arcs.status.kept) == (4, 0, 0)
    assert_close(arcs.length, 2 * np.pi - 8 * np.arccos(0.9), rtol=1e-3)
    on_the_left(arcs, lambda points: 1 - (points**2).sum(axis=1), 0, 0.01)


def test_what_touches_the_bounds_stays_closed():
    disc = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-1, 1), (-1, 1)))
    lines = rsym.level_lines(disc, resolution=50)
    assert (lines.status.closed, lines.status.open) == (1, 0)
    assert_close(lines.area, np.pi, rtol=1e-3)
