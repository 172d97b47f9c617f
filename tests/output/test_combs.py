"""Curvature combs: places, lengths, breaks, colours."""

import matplotlib.figure
import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, disjunction, x, y, z
from rsym.sampling.combs import combs

WIDE = ((-4, 4), (-3, 3))
CIRCLE = Shape(4 - x**2 - y**2, (x, y), bounds=WIDE)
ELLIPSE = Shape(1 - x**2 / 9 - y**2 / 4, (x, y), bounds=WIDE)
STADIUM = Shape(1 - y**2 - sp.Max(sp.Abs(x) - 1, 0) ** 2, (x, y), bounds=WIDE)
SQUARE = Shape(conjunction(1 - x**2, 1 - y**2), (x, y), bounds=WIDE)
RING = Shape((4 - x**2 - y**2) * (x**2 + y**2 - 1), (x, y), bounds=WIDE)


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def drawn(shape, **options):
    ax = matplotlib.figure.Figure().add_subplot()
    teeth = rsym.plot_curvature_comb(shape, ax=ax, resolution=96, **options)
    return teeth, teeth.envelopes, teeth.lines


def test_teeth_of_an_ellipse_are_evenly_spaced_and_exact():
    (comb,) = combs(ELLIPSE, teeth=120, resolution=128)
    cosine, sine = comb.points[:, 0] / 3, comb.points[:, 1] / 2
    assert_close(np.hypot(cosine, sine), np.ones(len(sine)), atol=1e-10)
    assert_close(comb.curvature, 6 / (9 * sine**2 + 4 * cosine**2) ** 1.5, rtol=1e-9)
    outwards = np.stack([cosine / 3, sine / 2], axis=1)
    assert_close(comb.normals, outwards / np.hypot(*outwards.T)[:, None], atol=1e-9)
    teeth = comb.points[comb.teeth]
    assert len(teeth) == 121
    assert (teeth[0] == teeth[-1]).all()
    distances = np.hypot(*np.diff(teeth, axis=0).T)
    assert distances.max() < 1.02 * distances.min()
    assert not comb.breaks.any()


def test_a_jump_of_the_curvature_is_resolved_and_is_no_break():
    (comb,) = combs(STADIUM, teeth=100, resolution=64)
    assert not comb.breaks.any()
    straight = np.abs(comb.points[:, 0]) < 1
    assert_close(comb.curvature, np.where(straight, 0.0, 1.0), atol=1e-8)
    ahead = np.abs(comb.points[:-1, 0]) - 1
    jumps = np.flatnonzero(np.diff(straight))
    assert len(jumps) == 4
    assert np.abs(ahead[jumps]).max() < 1e-3  # a tooth's distance is a tenth


@pytest.mark.parametrize(
    ("shape", "corners"),
    [
        (SQUARE, [[-1, -1], [-1, 1], [1, -1], [1, 1]]),
        (
            Shape(disjunction(1 - (x - 1 / 2) ** 2 - y**2, 1 - (x + 1 / 2) ** 2 - y**2), (x, y), bounds=WIDE),
            [[0, -np.sqrt(3) / 2], [0, np.sqrt(3) / 2]],
        ),
    ],
)
def test_a_corner_is_a_break(shape, corners):
    (comb,) = combs(shape, teeth=100, resolution=64)
    found = comb.points[:-1][comb.breaks]
    nearest = np.linalg.norm(found[:, None] - np.array(corners), axis=2)
    assert sorted(nearest.argmin(axis=1)) == list(range(len(corners)))
    assert nearest.min(axis=1).max() < 1e-3


def test_the_inner_line_of_a_ring_is_concave():
    inner, outer = sorted(combs(RING, teeth=80, resolution=64), key=lambda comb: comb.curvature.mean())
    assert_close(inner.curvature, np.full(len(inner.curvature), -1.0), atol=1e-9)
    assert_close(outer.curvature, np.full(len(outer.curvature), 0.5), atol=1e-9)
    assert_close(inner.normals, -inner.points, atol=1e-9)


def test_sections_levels_and_letters():
    radius = sp.Symbol("R", real=True)
    ball = Shape(radius**2 - x**2 - y**2 - z**2, (x, y, z), letters={radius: 1}, bounds=((-3, 3),) * 3)
    (comb,) = combs(ball, 1.0, teeth=20, resolution=32, letters={"R": 2}, section={y: 1.0})
    assert_close(comb.curvature, np.full(len(comb.curvature), 1 / np.sqrt(2)), atol=1e-9)
    for options in ({}, {"section": {"x": 1, "y": 1}}):
        with pytest.raises(RsymError, match="plane"):
            combs(ball, **options)


def test_undefined_points_end_a_comb():
    """The circle with a gap |y| < 1/5 where omega is not real."""
    shape = Shape((1 - x**2 - y**2) * (1 + sp.sqrt(y**2 - sp.Rational(1, 25))), (x, y), bounds=((-2, 2), (-2, 2)))
    left, right = combs(shape, teeth=50, resolution=128)
    for comb in (left, right):
        known = np.isfinite(comb.curvature)
        assert known[comb.teeth].mean() > 0.9
        assert_close(comb.curvature[known], np.ones(known.sum()), atol=1e-7)
        assert comb.breaks[~(known[1:] & known[:-1])].all()
        assert np.abs(comb.points[known][:, 1]).min() > 0.2


def test_teeth_of_a_circle_are_as_long_as_scale_over_radius():
    teeth, (envelope,), _ = (
        c if k == 0 else c.get_segments() for k, c in enumerate(drawn(CIRCLE, scale=0.6, teeth=40))
    )
    segments = np.array(teeth.get_segments())
    assert segments.shape == (40, 2, 2)
    assert_close(np.hypot(*segments[:, 0].T), np.full(40, 2.0), atol=1e-9)
    assert_close(np.hypot(*segments[:, 1].T), np.full(40, 2.3), atol=1e-9)  # outside, 0.6/2 long
    assert_close(np.hypot(*envelope.T), np.full(len(envelope), 2.3), atol=1e-9)
    assert_close(teeth.get_array(), np.full(40, 0.5), atol=1e-9)
    assert teeth.axes.get_aspect() == 1


@pytest.mark.slow
def test_an_envelope_is_open_at_corners_and_steps_at_jumps():
    shape = Shape(disjunction(1 - (x - 1 / 2) ** 2 - y**2, 1 - (x + 1 / 2) ** 2 - y**2), (x, y), bounds=WIDE)
    _, envelope, _ = drawn(shape, scale=1)
    ends = np.array([run[[0, -1]] for run in envelope.get_segments()])
    assert len(ends) >= 2
    assert max(np.hypot(*np.diff(run, axis=0).T).max() for run in envelope.get_segments()) < 0.2
    _, (run,), _ = (collection.get_segments() for collection in drawn(STADIUM, scale=1))
    assert_close(np.sort(np.hypot(*np.diff(run, axis=0).T))[-4:], np.ones(4), atol=0.01)


def test_colours_tell_the_sign():
    one, both, hollow = (drawn(shape)[0] for shape in (ELLIPSE, RING, Shape(-CIRCLE.expression, (x, y), bounds=WIDE)))
    assert one.get_clim()[0] == 0
    assert_close(both.get_clim(), (-1, 1), atol=1e-9)
    assert both.get_cmap().name == "coolwarm"
    assert hollow.get_clim()[1] == 0


def test_a_needle_does_not_shrink_the_other_teeth():
    needle = Shape(1 - x**2 / 9 - 16 * y**2, (x, y), bounds=((-4, 4), (-1, 1)))
    teeth, envelope, _ = drawn(needle, teeth=1000)
    lengths = np.hypot(*np.diff(np.array(teeth.get_segments()), axis=1)[:, 0].T)
    curvature, (_, high) = np.asarray(teeth.get_array()), teeth.get_clim()
    assert curvature.max() > 3 * high
    assert_close(lengths, curvature.clip(None, high) * lengths.min() / curvature.min(), rtol=1e-6)
    assert_close(high * lengths.min() / curvature.min(), 0.25 * np.hypot(6, 0.5), rtol=1e-3)
    assert len(envelope.get_segments()) in {2, 3}  # open at both tips, and at most where the closed line starts


def test_new_figure_with_a_colour_bar_and_given_axes_without():
    teeth = rsym.plot_curvature_comb(ELLIPSE, resolution=64)
    assert [ax.get_ylabel() for ax in teeth.axes.figure.axes] == ["$y$", r"curvature $\kappa$"]
    before = matplotlib.pyplot.get_fignums()
    assert len(drawn(ELLIPSE)[0].axes.figure.axes) == 1
    assert matplotlib.pyplot.get_fignums() == before


def test_a_polygon_has_teeth_of_no_length():
    teeth, _, _ = drawn(SQUARE)
    segments = np.array(teeth.get_segments())
    assert_close(segments[:, 1], segments[:, 0], atol=1e-9)


@pytest.mark.parametrize("options", [{"teeth": 0}, {"teeth": 2.5}, {"scale": 0}, {"scale": -1}, {"level": 99}])
def test_refusals(options):
    with pytest.raises(RsymError):
        drawn(CIRCLE, **options)
