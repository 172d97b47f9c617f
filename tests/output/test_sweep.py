import matplotlib.figure
import matplotlib.pyplot
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Letter, RsymError, Shape, x, y, z
from rsym.output.surfaces import ShadedMesh

r, d = sp.symbols("r d", real=True)
LETTERS = {r: Letter(1, minimum=0.25, maximum=4, unit="mm"), d: 0}
DISC = Shape((r**2 - (x - d) ** 2 - y**2) / (2 * r), (x, y), letters=LETTERS, bounds=((-2, 2), (-1.5, 1.5)))
BALL = Shape(r**2 - (x - d) ** 2 - y**2 - z**2, (x, y, z), letters=LETTERS, bounds=((-2, 2),) * 3)


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def panels(figure):
    return [ax for ax in figure.axes if ax.get_title()]


def test_panels_of_a_plane_shape_differ_in_the_letter_alone():
    radii = [1.25, 1.0, 0.5]
    figure = rsym.plot_sweep(DISC, r, radii, resolution=48, letters={"d": 0.25})
    axes = panels(figure)
    assert [ax.get_title() for ax in axes] == ["$r = 1.25$ mm", "$r = 1$ mm", "$r = 0.5$ mm"]
    contours = []
    for ax, radius in zip(axes, radii, strict=True):
        (boundary,) = [one for one in ax.collections if type(one).__name__ == "LineCollection"]
        points = np.concatenate(boundary.get_segments())
        assert_close(np.hypot(points[:, 0] - 0.25, points[:, 1]), np.full(len(points), radius), atol=1e-9)
        contours.append(next(one for one in ax.collections if type(one).__name__ == "QuadContourSet"))
    assert {tuple(one.levels) for one in contours} == {tuple(contours[0].levels)}
    assert {one.get_clim() for one in contours} == {contours[0].get_clim()}
    assert {ax.get_xlim() for ax in axes} == {axes[0].get_xlim()}
    # In the corner (-2, 1.5) omega is -2.3 for the first radius and -7 for the last: the common levels span all panels.
    assert contours[0].levels.min() < -3
    assert len(figure.axes) == 4  # three panels and one colour bar


def test_bodies_share_the_box_and_the_camera():
    radii = [0.5, 1.0, 1.5, 1.25]
    figure = rsym.plot_sweep(BALL, "r", radii, resolution=24, azimuth=30)
    bodies = [artist for ax in figure.axes for artist in ax.artists if isinstance(artist, ShadedMesh)]
    assert_close([body.mesh.status.volume for body in bodies], 4 / 3 * np.pi * np.array(radii) ** 3, atol=0.1)
    cameras = [body.axes.get_proj() for body in bodies]
    for camera in cameras[1:]:
        assert_close(camera, cameras[0], atol=1e-12)
    limits = np.array([body.axes.get_zlim() for body in bodies])
    assert_close(limits, np.tile([-1.53, 1.53], (4, 1)), atol=0.02)
    assert bodies[0].axes.azim == 30
    row_by_row = sorted(figure.subfigs, key=lambda part: (-part.bbox.y0, part.bbox.x0))
    texts = [text.get_text() for part in row_by_row for text in part.texts]
    assert texts == ["$r = 0.5$ mm", "$r = 1$ mm", "$r = 1.5$ mm", "$r = 1.25$ mm"]
    places = [body.axes.figure.bbox.bounds for body in bodies]
    assert [place[0] for place in places] == [0, places[1][0], 0, places[1][0]]  # two columns


def test_a_section_and_the_number_of_columns():
    figure = rsym.plot_sweep(BALL, r, [1, 1.25, 1.5], resolution=32, section={z: 0.6}, columns=1)
    axes = panels(figure)
    assert axes[0].get_subplotspec().get_gridspec().get_geometry() == (3, 1)
    (boundary,) = [one for one in axes[0].collections if type(one).__name__ == "LineCollection"]
    assert_close(np.hypot(*np.concatenate(boundary.get_segments()).T).max(), 0.8, atol=1e-9)


@pytest.mark.slow
def test_progress_counts_panels_and_cancels():
    for shape in (DISC, BALL):
        seen = []
        rsym.plot_sweep(shape, r, [1, 1.5], resolution=16, progress=lambda *state, seen=seen: seen.append(state))
        assert seen == [(0, 2), (1, 2), (2, 2)]
        with pytest.raises(RsymError, match="cancelled"):
            rsym.plot_sweep(shape, r, [1, 1.5], resolution=16, progress=lambda done, total: done < 1)
    with pytest.raises(RsymError, match="cancelled"):
        rsym.plot_fields(DISC, resolution=16, progress=lambda done, total: done < 2)


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ({"letter": "q", "values": [1]}, "no letter 'q'"),
        ({"letter": r, "values": [1, 5]}, r"\[0.25, 4\]"),
        ({"letter": r, "values": []}, "at least one"),
        ({"letter": r, "values": [np.nan]}, "finite"),
        ({"letter": r, "values": [1], "columns": 0}, "columns"),
        ({"letter": d, "values": [0, 100]}, "d = 100: the surface does not meet the bounds"),
    ],
)
def test_bad_input(arguments, word):
    with pytest.raises(RsymError, match=word):
        rsym.plot_sweep(BALL, resolution=16, **arguments)


def test_a_warning_says_at_which_value():
    with pytest.warns(rsym.RsymWarning, match=r"^r = 1\.7: .*bounds") as caught:
        rsym.plot_sweep(BALL.replace(bounds=((-1.6, 1.6),) * 3), r, [1, 1.7], resolution=24)
    assert len(caught) == 1
    assert caught[0].filename == __file__
