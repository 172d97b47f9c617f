"""Atlases of two letters, against thresholds that are known exactly."""

import json
from fractions import Fraction

import matplotlib.figure
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.verify.atlas.greatest import greatest_curvatures
from rsym.verify.atlas.grid import grid_of, narrowest
from rsym.verify.atlas.strips import chains
from rsym.verify.atlas.subjects import refuted_throughout

a, b = sp.symbols("a b", real=True)
BOX = ((-3, 3), (-3, 3))


@pytest.fixture(scope="module")
def nose():
    """The body of Fig. 11 in a window about its default letters."""
    return rsym.smoothness_atlas(
        rsym.paper.skeleton_body(), "a2", "p1", between=((5.2, 5.4), (38, 42)), tolerance=0.15, sharpening=20
    )


def by_verdict(atlas, verdict):
    return [tuple((Fraction(low), Fraction(high)) for low, high in sides) for sides in atlas.parts(verdict).tolist()]


def smooth_nose(p1):
    """5 + p1 p2/13 with the letters of Fig. 11."""
    return 5 + p1 * Fraction(1, 10) / 13


@pytest.mark.slow
def test_every_rectangle_lies_wholly_on_its_side_of_the_formula(nose):
    certified, refuted = by_verdict(nose, "CERTIFIED"), by_verdict(nose, "REFUTED")
    assert len(certified) > 3
    assert len(refuted) > 3
    assert all(a2[0] > smooth_nose(p1[1]) for a2, p1 in certified)
    assert all(a2[1] < smooth_nose(p1[0]) for a2, p1 in refuted)


@pytest.mark.slow
def test_the_rectangles_tile_the_region(nose):
    (u, v), (s, t) = nose.region
    assert (grid_of(nose.rectangles).owner >= 0).all()
    assert_close(np.diff(nose.rectangles, axis=2).prod(axis=(1, 2)).sum(), (v - u) * (t - s), atol=1e-12)
    assert_close(sum(nose.share.values()), 1.0, atol=1e-12)


@pytest.mark.slow
def test_the_threshold_is_enclosed_as_narrowly_as_wanted(nose):
    (curve,) = nose.thresholds
    assert curve.graph == "a2"
    assert curve.span == (38.0, 42.0)
    assert curve.share <= 0.15
    for p1 in np.linspace(38, 42, 33):
        low, high = curve.between(p1)
        assert low < smooth_nose(Fraction(p1)) < high
        assert high - low <= 0.15 * 0.2 * 2  # where two steps of the strip meet
    for line, side in [(curve.certified_side, 1), (curve.refuted_side, -1)]:
        for a2, p1 in np.concatenate(line):
            assert side * (a2 - 5 - p1 / 130) > 0
    assert_close(curve.middle[0][:, 0], 5 + curve.middle[0][:, 1] / 130, atol=0.15 * 0.2)
    assert curve.relative_width < 0.01
    with pytest.raises(rsym.RsymError, match="beyond the ends"):
        curve.between(50)


@pytest.mark.slow
def test_bounds_of_the_curvature_are_no_less_than_what_is_found(nose):
    for point, value in zip(nose.curvature.points, nose.curvature.values, strict=True):
        here = ((nose.rectangles[..., 0] <= point) & (point <= nose.rectangles[..., 1])).all(axis=1)
        certified = here & (np.array(nose.verdicts) == "CERTIFIED")
        assert value <= nose.curvature_bounds[certified].max()
    assert len(nose.curvature.values) > 20


@pytest.mark.slow
def test_the_record_is_complete(nose):
    record = json.loads(nose.to_json())
    assert len(record["rectangles"]) == len(nose.verdicts)
    assert record["thresholds"][0]["letter"] == "a2"
    assert record["greatest_curvature"]["proved"] is False
    assert "certified" in str(nose)
    assert nose.verdict_at(5.3, 40) in {"REFUTED", "UNDECIDED"}
    with pytest.raises(rsym.RsymError, match="outside the atlas"):
        nose.verdict_at(6, 40)


@pytest.mark.slow
def test_the_figure(nose):
    figure = rsym.plot_atlas(nose)
    ax = figure.axes[0]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$a_{2}$", "$p_{1}$")
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert any("undecided" in text for text in labels)
    lines = [line.get_xydata() for line in ax.get_lines()]
    assert any(np.array_equal(line, nose.thresholds[0].middle[0]) for line in lines)
    assert any(np.array_equal(line, [[5.3, 40]]) for line in lines)
    panel = matplotlib.figure.Figure().add_subplot()
    assert rsym.plot_atlas(nose, ax=panel, rectangles=False) is panel.figure


@pytest.mark.slow
def test_the_same_bits_again():
    arguments = (rsym.paper.skeleton_body(), "a2", "p1")
    changes = {"between": ((5.2, 5.4), (38, 42)), "budget": 8, "sharpening": 0}
    first, second = (rsym.smoothness_atlas(*arguments, **changes) for _ in range(2))
    assert first.to_json() == second.to_json()
    assert first.judged == 7


@pytest.mark.slow
def test_a_threshold_that_is_no_graph():
    """A roof whose ridge at x = 4 - a**2 - b**2 is within the bounds where a**2 + b**2 > 1."""
    roof = 1 - y - sp.Abs(x - 4 + a**2 + b**2)
    shape = rsym.Shape(roof, (x, y), letters={a: 1, b: 1}, bounds=((-3, 3), (-6, 3)))
    atlas = rsym.smoothness_atlas(shape, a, b, between=((-1.5, 1.6), (-1.5, 1.6)), tolerance=0.15, sharpening=0)
    (curve,) = atlas.thresholds
    assert curve.graph is None
    assert np.isnan(curve.relative_width)
    (middle,) = curve.middle
    assert np.array_equal(middle[0], middle[-1])
    assert_close(np.hypot(*middle.T), np.ones(len(middle)), atol=0.25)
    certified, refuted = by_verdict(atlas, "CERTIFIED"), by_verdict(atlas, "REFUTED")
    assert certified
    assert refuted
    for (u, v), (s, t) in certified:
        assert max(u * u, v * v) + max(s * s, t * t) < 1
    for (u, v), (s, t) in refuted:
        nearest = [0 if low <= 0 <= high else min(low * low, high * high) for low, high in ((u, v), (s, t))]
        assert sum(nearest) > 1
    with pytest.raises(rsym.RsymError, match="no function"):
        curve.between(0)


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "verdict"),
    [
        (1 - (x / a) ** 2 - (y / b) ** 2, "CERTIFIED"),
        (b - sp.Abs(x - a) - y, "REFUTED"),  # a roof with its ridge at (a, b)
        (b - a * x * sp.Abs(x) - y, "REFUTED"),  # curvature jumps by 4 a
        (-a - b - x**2 - y**2, "DEGENERATE"),
    ],
)
def test_families_of_one_kind(expression, verdict):
    shape = rsym.Shape(expression, (x, y), letters={a: 1, b: 1.25}, bounds=BOX)
    atlas = rsym.smoothness_atlas(shape, "a", "b", sharpening=0)
    assert atlas.share[verdict] == 1.0
    assert not atlas.thresholds
    assert len(atlas.verdicts) < 8
    assert atlas.region == ((0.5, 2.0), (0.625, 2.5))


@pytest.mark.slow
def test_a_body_of_revolution_and_one_that_is_none():
    capsule = rsym.revolve(
        rsym.Shape(b**2 - y**2 - sp.Max(sp.Abs(x) - a, 0) ** 2, (x, y), letters={a: 1, b: 0.5}, bounds=BOX)
    )
    assert rsym.smoothness_atlas(capsule, a, b, between=((0.9, 1.1), (0.45, 0.55))).share["REFUTED"] == 1.0
    cut = rsym.conjunction(4 - x**2 - 2 * y**2 - z**2, x + a * y - b)
    lens = rsym.Shape(cut, (x, y, z), letters={a: 0.5, b: 0.25}, bounds=((-3, 3),) * 3)
    atlas = rsym.smoothness_atlas(lens, a, b, between=((0.45, 0.5), (0.2, 0.25)), sharpening=0)
    assert atlas.share["REFUTED"] == 1.0


def test_what_is_refuted_throughout_is_refuted_at_every_value():
    """A corner (l, 0) that moves out of the bounds, and one that becomes smooth."""
    roof = rsym.Shape(1 - y - sp.Abs(x - a), (x, y), letters={a: 0}, bounds=BOX)
    defects = rsym.verify_smoothness(roof, letters={"a": 2.8}).defects
    assert refuted_throughout(roof, {"a": (2.7, 2.9)}, defects) is not None
    assert refuted_throughout(roof, {"a": (2.7, 3.0)}, defects) is None
    bend = rsym.Shape(1 - y - a * x * sp.Abs(x), (x, y), letters={a: 1}, bounds=BOX)
    defects = rsym.verify_smoothness(bend).defects
    found = refuted_throughout(bend, {"a": (0.5, 1.5)}, defects)
    assert abs(found.curvature_jump - 4) < found.curvature_jump_error  # 2 to 6
    assert refuted_throughout(bend, {"a": (0, 2)}, defects) is None


def test_the_greatest_curvature_of_a_needle():
    """x**2/a**2 + y**2/b**2 = 1 has a/b**2 at its tips: 400 here, finer than a cell of the lattice by far."""
    shape = rsym.Shape(1 - (x / a) ** 2 - (y / b) ** 2, (x, y), letters={a: 1, b: 1})
    points = np.array([[2.0, 0.1], [2.5, 2.0], [1.0, 0.05]])
    found = greatest_curvatures(shape, BOX, ("a", "b"), points, {}, body=False)
    assert_close(found / [200, 2.5 / 4, 400], np.ones(3), atol=0.01)


def test_the_greatest_curvature_of_a_body_counts_its_circles():
    oval = rsym.Shape(1 - (x / a) ** 2 - (y / b) ** 2, (x, y), letters={a: 1, b: 1})
    found = greatest_curvatures(oval, BOX, ("a", "b"), np.array([[2.0, 1.0], [1.0, 2.0]]), {}, body=True)
    assert_close(found, [2.0, 2.0], atol=0.02)


def test_a_run_between_cells_of_one_kind_is_an_island():
    kinds = np.array([[1], [0], [-1], [0], [-1]])
    crossing, island = narrowest(kinds, (np.full(5, 0.01), np.ones(1)))[[1, 3], 0]
    assert_close(crossing, 0.01, atol=1e-12)
    assert_close(island, 0.16, atol=1e-12)


def test_lines_that_touch_in_a_corner_are_closed_each_by_itself():
    square = [((0, 0), (0, 1)), ((0, 1), (1, 1)), ((1, 1), (1, 0)), ((1, 0), (0, 0))]
    other = [tuple((i + 1, j + 1) for i, j in edge) for edge in square]
    found = chains(square + other)
    assert sum(len(line) - 1 for line in found) == 8
    assert all(line[0] == line[-1] for line in found)


@pytest.mark.parametrize(
    ("arguments", "changes", "code"),
    [
        (("a", "c"), {}, "unknown-letter"),
        (("a", "a"), {}, "letter-twice"),
        (("a", "b"), {"letters": {"a": 1}}, "letter-twice"),
        (("a", "b"), {"between": ((1, 1), None)}, "number"),
        (("a", "b"), {"tolerance": 0}, "tolerance"),
        (("a", "b"), {"budget": 0}, "budget"),
    ],
)
def test_bad_input_is_refused(arguments, changes, code):
    shape = rsym.Shape(a - b * x**2 - y**2, (x, y), letters={a: 1, b: 1}, bounds=BOX)
    with pytest.raises(rsym.RsymError) as error:
        rsym.smoothness_atlas(shape, *arguments, **changes)
    assert error.value.code == code


@pytest.mark.slow
def test_a_cancelled_atlas_says_so():
    with pytest.raises(rsym.RsymError, match="cancelled"):
        rsym.smoothness_atlas(rsym.paper.skeleton_body(), "a2", "p1", progress=lambda done, total: False)
