"""Lines on pictures: the nine edges of a box that one sees, and none that it hides."""

import matplotlib as mpl

mpl.use("Agg")
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import proj3d
from sampling.test_features import cube

import rsym
from rsym.output.ink import draw_lines
from rsym.output.rasteriser import rasterise, snap
from rsym.sampling.mesh import Mesh


def box(without=None):
    """A cube whose sides are leaves, one of them left out."""
    vertices, faces, leaf = cube(4)
    outward = np.kron(np.eye(3), [[-1], [1]])
    normals = outward[leaf][:, None].repeat(3, axis=1)
    names = ("left", "right", "front", "back", "bottom", "top")
    keep = leaf != (-1 if without is None else without)
    return Mesh(vertices, faces[keep], normals[keep], leaf=leaf[keep], leaves=names)


def pixels(mesh, dpi=150, **options):
    figure = Figure(figsize=(4, 4), dpi=dpi)
    axes = figure.add_axes((0, 0, 1, 1), projection="3d")
    axes.set_axis_off()
    artist = rsym.plot_mesh(mesh, ax=axes, azimuth=-60.0, elevation=25.0, **options)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = np.array(canvas.buffer_rgba())[::-1, :, :3] / 255.0

    def at(point):
        x, y = axes.transData.transform(proj3d.proj_transform(*point, axes.get_proj())[:2])
        around = image[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2]
        return around.sum(axis=2).min()

    return image, at, artist


CORNERS = [np.array([i, j, k], float) for i in (0, 1) for j in (0, 1) for k in (0, 1)]
EDGES = [(a, b) for a in CORNERS for b in CORNERS if (b - a).sum() == 1 == np.abs(b - a).sum()]
HIDDEN = np.array([0.0, 1.0, 0.0])  # the corner that is farthest from the eye at this view
DARK = BODY = 1.1  # the sum of the three colours: a line is darker, the darkest side lighter


@pytest.mark.slow
@pytest.mark.parametrize("dpi", [90, 220])
def test_visible_edges_are_dark_and_hidden_ones_are_not(dpi):
    _, at, _ = pixels(box(), dpi)
    assert len(EDGES) == 12
    for a, b in EDGES:
        hidden = (a == HIDDEN).all() or (b == HIDDEN).all()
        for share in (0.2, 0.3, 0.8):
            light = at(a + share * (b - a))
            assert light > BODY if hidden else light < DARK, (a, b, share)


@pytest.mark.slow
def test_without_features_no_line_is_drawn_and_the_angle_selects():
    plain, at, _ = pixels(box(), features=False)
    assert plain.sum(axis=2).min() > DARK
    assert at((0.5, 0.0, 1.0)) > BODY
    assert (pixels(box(), features=89.0)[0] == pixels(box())[0]).all()
    assert (pixels(box(), features=91.0)[0] == plain).all()


@pytest.mark.slow
def test_an_open_box_shows_the_edges_inside():
    _, at, _ = pixels(box(without=5))
    assert at((0.0, 1.0, 0.9)) < DARK


@pytest.mark.slow
def test_a_mesh_without_leaves_has_no_lines():
    known = box()
    unknown = Mesh(known.vertices, known.faces, known.shading)
    assert unknown.features == ()
    assert (pixels(unknown)[0] == pixels(known, features=False)[0]).all()


def test_a_line_is_as_wide_as_asked_and_keeps_its_light():
    for width in (0.5, 1.0, 3.0):
        samples = np.zeros((20, 200, 4), np.float32)
        wall = snap(np.array([[[-500.0, -50, 0], [700, -50, 0], [100, 500, 0]]]))
        draw_lines(samples, rasterise(wall, (20, 200)), wall, np.array([[[20.0, 8.3, 0.0], [180.0, 11.9, 0.0]]]), width)
        column = samples[:, 60:140, 3].sum(axis=0)
        assert column.mean() == pytest.approx(width, rel=0.12)
        assert np.ptp(column) < 0.25


def test_a_body_hides_the_edges_of_one_behind_it():
    front = box()
    eye = np.array([np.cos(np.radians(60)), -np.sin(np.radians(60)), np.tan(np.radians(25))])
    behind = 0.5 + 0.4 * (front.vertices - 0.5) - 1.5 * eye
    vertices, count = np.concatenate([front.vertices, behind]), len(front.vertices)
    faces, normals = np.concatenate([front.faces, front.faces + count]), np.concatenate([front.shading] * 2)
    images = [
        pixels(Mesh(vertices, faces, normals, leaf=np.concatenate([front.leaf, leaf]), leaves=front.leaves))[0]
        for leaf in (front.leaf, 0 * front.leaf)
    ]
    assert (images[0] == images[1]).all()
