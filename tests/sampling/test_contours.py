import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, x, y, z

a = sp.Symbol("a", real=True)
DISC = Shape((a**2 - x**2 - y**2) / (2 * a), (x, y), letters={a: 1}, bounds=((-2, 2), (-2, 2)))


def test_every_vertex_is_on_the_level():
    lines = rsym.level_lines(DISC, resolution=40)
    assert_close(np.hypot(*lines[0].T), np.ones(len(lines[0])), atol=1e-13)
    assert (len(lines), lines.status.closed, lines.status.kept) == (1, 1, 0)
    assert "closed" in str(lines.status)


def test_level_field_letters_and_bounds():
    (line,) = rsym.level_lines(DISC, 0.375, resolution=64, letters={"a": 2}, bounds=((-3, 3), (-3, 3)))
    assert_close(np.hypot(*line.T), np.full(len(line), np.sqrt(2.5)), atol=1e-12)
    (line,) = rsym.level_lines(DISC, 0.25, field="gradient_squared", resolution=64)
    assert_close(np.hypot(*line.T), np.full(len(line), 0.5), atol=1e-12)


def test_a_section_of_a_body():
    ball = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1, 1),) * 3)
    (line,) = rsym.level_lines(ball, section={z: 0.6}, resolution=64)
    assert_close(np.hypot(*line.T), np.full(len(line), 0.8), atol=1e-13)
    (other,) = rsym.level_lines(ball, section={"y": 0.6}, resolution=64)
    assert_close(np.hypot(*other.T), np.full(len(other), 0.8), atol=1e-13)


def test_the_gradient_of_a_normalised_field_is_one_on_the_boundary_of_the_papers_body():
    body = rsym.paper.skeleton_body()
    tip = np.array([-4.992121, 0])
    lines = rsym.level_lines(body, resolution=300)
    points = np.concatenate(list(lines))
    points = points[np.hypot(*(points - tip).T) > 0.001 * 17]
    assert len(points) > 300
    squared = rsym.compile(body, ("normalised_gradient_squared",))(*points.T)["normalised_gradient_squared"]
    assert_close(np.sqrt(squared), np.ones(len(points)), atol=1e-9)


@pytest.mark.filterwarnings("ignore:omega has no value:rsym.RsymWarning")
def test_lines_are_cut_where_the_field_is_undefined():
    half = Shape(sp.sqrt(x) - 1 + y**2, (x, y), bounds=((-1, 2), (-2, 2)))
    lines = rsym.level_lines(half, resolution=60)
    assert lines.status.undefined_samples > 0
    assert lines.status.open >= 1
    assert "undefined" in str(lines.status)
    points = np.concatenate(list(lines))
    assert (points[:, 0] >= 0).all()


def test_a_jump_is_on_the_zeros_of_its_condition():
    step = Shape(sp.Piecewise((1, x > 0.1), (-1, True)) + 0 * y, (x, y), bounds=((-1, 1), (-1, 1)))
    (line,) = rsym.level_lines(step, resolution=20)
    assert_close(line[:, 0], np.full(len(line), 0.1), atol=1e-15)
    (circle,) = rsym.level_lines(Shape(sp.sign(1 - x**2 - y**2), (x, y), bounds=((-2, 2), (-2, 2))), resolution=40)
    assert_close(np.hypot(*circle.T), np.ones(len(circle)), atol=1e-13)


@pytest.mark.filterwarnings("ignore:omega has no value:rsym.RsymWarning")
@pytest.mark.parametrize("partial", [sp.sqrt(x - 2), sp.log(x - 2), sp.asin(x - 4), (x - 2) ** sp.Rational(1, 3)])
@pytest.mark.parametrize("system", [rsym.R0, rsym.R1])
def test_a_part_without_a_value_leaves_its_partners(partial, system):
    part, box = Shape(partial - y, (x, y)), ((-3, 5), (-3, 3))
    lines = rsym.level_lines(rsym.disjunction(rsym.disc(1), part, system=system), resolution=80, bounds=box)
    (circle,) = [line for line in lines if (line[0] == line[-1]).all()]
    assert_close(np.hypot(*circle.T), np.ones(len(circle)), atol=1e-13)
    assert lines.status.kept == lines.status.unresolved_corners == 0
    assert "undefined" in str(lines.status)
    assert (
        len(rsym.level_lines(rsym.disc(1) - part, resolution=40, bounds=box)) == 0
    )  # nothing is known to be left of it


@pytest.mark.filterwarnings("ignore:omega has no value:rsym.RsymWarning")
@pytest.mark.parametrize("resolution", [31, 64])
def test_a_curve_runs_to_the_end_of_its_domain(resolution):
    half = Shape(sp.sqrt(9 - x**2) - y, (x, y), bounds=((-4, 4), (-1, 4)))
    (line,) = rsym.level_lines(half, resolution=resolution)
    assert_close(np.hypot(*line.T), np.full(len(line), 3.0), atol=1e-12)
    assert_close(line[[0, -1]], [[3, 0], [-3, 0]], atol=1e-14)
    root = Shape(x ** sp.Rational(1, 3) - y, (x, y), bounds=((-1, 8), (-1, 3)))
    (line,) = rsym.level_lines(root, resolution=resolution)
    assert_close(line[[0, -1]], [[8, 2], [0, 0]], atol=1e-12)


def test_a_corner_is_met_from_both_sides():
    corner = Shape(conjunction(x, y), (x, y), bounds=((-1, 1), (-1, 1)))
    points = np.concatenate(list(rsym.level_lines(corner, resolution=50)))
    assert np.abs(np.minimum(*points.T)).max() < 1e-2
    assert (np.abs(np.minimum(*points.T)) < 1e-14).mean() > 0.9


@pytest.mark.parametrize(
    ("options", "code"),
    [
        ({"field": "gradient"}, "unknown-field"),
        ({"section": {"w": 1}}, "section"),
        ({"section": {"x": 1}}, "section"),
        ({"level": float("nan")}, "number"),
        ({"bounds": ((0, 1),)}, "bounds"),
    ],
)
def test_bad_input(options, code):
    with pytest.raises(RsymError) as caught:
        rsym.level_lines(DISC, **options)
    assert caught.value.code == code


def test_a_body_without_section_is_refused():
    with pytest.raises(RsymError) as caught:
        rsym.level_lines(Shape(x + y + z, (x, y, z), bounds=((-1, 1),) * 3))
    assert caught.value.code == "section"


@pytest.mark.filterwarnings("ignore:Unresolved")  # 0.5 is the maximum, a point
def test_several_levels_are_sampled_once_and_answered_in_their_order():
    one_by_one = [rsym.level_lines(DISC, level, resolution=48) for level in (0.5, -0.25, 0.0)]
    together = rsym.level_lines(DISC, [0.5, -0.25, 0.0], resolution=48)
    assert isinstance(together, tuple)
    assert [lines.level for lines in together] == [0.5, -0.25, 0.0]
    for lines, alone in zip(together, one_by_one, strict=True):
        assert [line.tobytes() for line in lines] == [line.tobytes() for line in alone]
    assert len(rsym.level_lines(DISC, np.array([0.5]), resolution=48)) == 1


@pytest.mark.parametrize("level", [[], [0.0, None], "0", [[0.0]], np.zeros((2, 2))])
def test_levels_that_are_none(level):
    with pytest.raises(RsymError):
        rsym.level_lines(DISC, level, resolution=16)


def test_straight_parts_have_no_vertices_and_bends_keep_theirs():
    lines = rsym.level_lines(rsym.rectangle(4, 2) - rsym.disc(0.5), resolution=128)
    sizes = sorted(map(len, lines))
    assert sizes[0] == 5
    assert sizes[1] > 100
    (box,) = rsym.sections(rsym.box(4, 2, 1), [0.2], resolution=64)
    np.testing.assert_allclose(sorted(box.lines[0][:-1].tolist()), [[-2, -1], [-2, 1], [2, -1], [2, 1]], atol=1e-12)


@pytest.mark.parametrize("level", [0.25, -0.1])
def test_at_every_level_a_minimum_has_its_corners(level):
    lines = rsym.level_lines(rsym.rectangle(2, 2, system=rsym.R1), level, resolution=50)
    half = np.sqrt(1 - 2 * level)  # the leaves are (1 - x**2)/2 and (1 - y**2)/2
    np.testing.assert_allclose(np.abs(lines[0]), half, rtol=1e-12)
    assert len(lines[0]) == 5
    assert lines.level == level


def test_sums_of_absolute_values_have_their_corners_at_other_levels():
    diamond = rsym.Shape(1 - sp.Abs(x) - sp.Abs(y), (x, y), bounds=((-2, 2), (-2, 2)))
    (line,) = rsym.level_lines(diamond, 0.3, resolution=50)
    np.testing.assert_allclose(sorted(line[:-1].tolist()), [[-0.7, 0], [0, -0.7], [0, 0.7], [0.7, 0]], atol=1e-12)


CORNERED = {
    "diamond": (1 - abs(x) - abs(y), 2),
    "square": (1 - sp.Max(abs(x), abs(y)), 4),
    "diamond turned": (1 - abs(3 * x + 4 * y) / 5 - abs(4 * x - 3 * y) / 5, 2),
    "square turned": (1 - sp.Max(abs(3 * x + 4 * y), abs(4 * x - 3 * y)) / 5, 4),
    "octagon": (sp.Rational(3, 2) - sp.Max(abs(x), abs(y)) - abs(x) / 2 - abs(y) / 2, 3),
    "within each other": (1 - abs(abs(x) - sp.Rational(1, 2)) - abs(y), 3.5),
    "relu": (1 - sum(sp.Max(side, 0) for side in (x, y, -x, -y)), 2),
    "piecewise": (1 - sp.Piecewise((x, x > 0), (-2 * x, True)) - abs(y), 1.5),
    "in a power": (1 - sp.Max(abs(x), abs(y)) ** 3, 4),
    "in a product": ((2 + x**2) * (1 - abs(x)) - (2 + x**2) * abs(y), 2),
}


@pytest.mark.parametrize("name", CORNERED)
def test_corners_within_a_leaf_are_exact(name):
    omega, area = CORNERED[name]
    shape = rsym.Shape(omega, (x, y), bounds=((-2, 2), (-2, 2)))
    for resolution in (37, 64):
        lines = rsym.level_lines(shape, resolution=resolution)
        assert lines.area == pytest.approx(area, rel=1e-12)
        assert not lines.status.unresolved_corners


@pytest.mark.parametrize("level", [0, 0.3])
def test_corners_that_are_cut_off_are_counted(level):
    rooted = rsym.Shape(1 - sp.sqrt(abs(x) + y**2), (x, y), bounds=((-2, 2), (-2, 2)))
    assert rsym.level_lines(rooted, level, resolution=50).status.unresolved_corners == 2
    assert rsym.level_lines(rsym.disc(1), 0.3, resolution=50).status.unresolved_corners == 0
