"""Pictures of fits and of speeds."""

import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import rsym
from rsym import y, z
from rsym.output.fits import DOT

pytestmark = pytest.mark.slow

a, b, c, r = sp.symbols("a b c r", real=True)
TURN = np.linspace(0, 2 * np.pi, 24, endpoint=False)
CIRCLE = np.stack([np.cos(TURN), np.sin(TURN)], axis=1)


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def pixels_of(artist):
    canvas = FigureCanvasAgg(artist.get_figure())
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].astype(int)


def test_points_have_the_colours_of_their_residuals():
    points = CIRCLE * np.where(np.arange(24) % 2, 1.05, 0.95)[:, None]
    drawn = rsym.plot_fit(rsym.fit(rsym.disc(r, letters={r: 1.2}), points, [r]))
    colours = drawn.to_rgba(drawn.get_array())
    assert (colours[0::2, 0] > colours[0::2, 2]).all()  # inside red
    assert (colours[1::2, 2] > colours[1::2, 0]).all()
    assert len(drawn.figure.axes) == 2
    assert drawn.axes.get_title() == "r from 24 points"


def test_points_without_a_residual_are_grey_crosses():
    shape = rsym.Shape(rsym.x**b + a - y, (rsym.x, y), letters={a: 1, b: 0.5})
    found = rsym.fit(shape, [[1, 2.5], [4, 3.6], [-1, 1], [2, 3]], [a])
    with pytest.warns(rsym.RsymWarning, match="omega has no value in 26 % of the bounds"):
        drawn = rsym.plot_fit(found, resolution=32)
    assert len(drawn.get_array()) == 3
    assert any(len(one.get_offsets()) == 1 for one in drawn.axes.collections)


def test_a_section_is_drawn_in_its_plane():
    found = rsym.fit(rsym.sphere(r, letters={r: 1.5}), CIRCLE, [r], section={y: 0.5})
    ax = Figure().add_subplot()
    rsym.plot_fit(found, ax=ax, resolution=32)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("$x$", "$z$")


def test_a_body_with_its_points_and_a_silhouette_from_where_it_was_seen():
    oval = rsym.ellipsoid(a, b, c, letters={a: 2, b: 1.5, c: 1})
    points = rsym.sample(oval.with_letters({a: 2.2}), 40, over="boundary", rng=1, resolution=24).points
    body = rsym.plot_fit(rsym.fit(oval, points, [a]), resolution=16, limits=(-0.1, 0.1))
    assert [len(one.pieces) for one in body.strokes if one.width == DOT] == [40]
    assert pixels_of(body).min() < 128
    outline = rsym.plot_fit(rsym.fit(oval, CIRCLE * [2.2, 1.1], [a, c], silhouette=y), resolution=16)
    assert (round(outline.axes.elev), round(outline.axes.azim)) == (0, 90)


def test_teeth_go_where_the_boundary_goes():
    ring = rsym.disc(2) - rsym.disc(r, letters={r: 1})
    teeth = rsym.plot_sensitivity(rsym.sensitivity(ring, r, resolution=64))
    ends = np.array(teeth.get_segments())
    start, end = np.hypot(*ends[:, 0].T), np.hypot(*ends[:, 1].T)
    inner = start < 1.5
    # A larger hole: its boundary moves outwards of the hole, into the ring.
    assert (end[inner] - start[inner] > 0.3).all()
    assert np.abs(end[~inner] - start[~inner]).max() < 1e-9


def test_a_surface_is_coloured_by_its_speed():
    can = rsym.cylinder(r, letters={r: 1}) & rsym.slab(-1, 1)
    body = rsym.plot_sensitivity(rsym.sensitivity(can, r, resolution=16))
    assert np.allclose(body.scale.get_clim(), (0, 1))
    assert body.scale_label == "speed outwards to a unit of r"
    assert pixels_of(body).min() < 128


@pytest.mark.parametrize("draw", [rsym.plot_fit, rsym.plot_sensitivity])
def test_what_is_no_report(draw):
    with pytest.raises(rsym.RsymError, match=r"expected a \w+, got int"):
        draw(3)


def test_axes_of_the_wrong_dimension():
    ball = rsym.sensitivity(rsym.sphere(r, letters={r: 1}), r, resolution=12)
    with pytest.raises(rsym.RsymError):
        rsym.plot_sensitivity(ball, ax=Figure().add_subplot())
    with pytest.raises(rsym.RsymError):
        rsym.plot_fit(rsym.fit(rsym.sphere(r, letters={r: 1}), [*np.eye(3), *-np.eye(3)], [r]), ax=z, resolution=12)
