import io
import itertools

import matplotlib as mpl

mpl.use("Agg")
import numpy as np
import pytest
import trimesh
from matplotlib import pyplot as plt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import proj3d

from rsym.errors import RsymError
from rsym.output.shading import AZIMUTH, ELEVATION, encode, hollows, linear, reduce
from rsym.output.surfaces import plot_mesh
from rsym.sampling.mesh import Mesh


def as_mesh(vertices, faces, normals=None):
    vertices, faces = np.array(vertices, float), np.array(faces, np.int64)
    if normals is None:
        a, b, c = vertices[faces].transpose(1, 0, 2)
        flat = np.cross(b - a, c - a)
        normals = np.repeat((flat / np.linalg.norm(flat, axis=1, keepdims=True))[:, None], 3, axis=1)
    return Mesh(vertices, faces, normals)


def ball(subdivisions=4):
    sphere = trimesh.creation.icosphere(subdivisions=subdivisions)
    vertices, faces = np.array(sphere.vertices), np.array(sphere.faces)
    return as_mesh(vertices, faces, vertices[faces])


def brick(*extents):
    solid = trimesh.creation.box(extents=extents)
    return as_mesh(solid.vertices, solid.faces)


def bare_axes(size=4.0):
    """Axes without lines on a transparent ground: alpha is then what the body covers."""
    figure = Figure(figsize=(size, size))
    figure.patch.set_alpha(0)
    axes = figure.add_axes((0, 0, 1, 1), projection="3d")
    axes.patch.set_alpha(0)
    axes.set_axis_off()
    return axes


def pixels(artist):
    figure = artist.get_figure()
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.array(canvas.buffer_rgba()) / 255.0


def drawn(mesh, **options):
    return pixels(plot_mesh(mesh, ax=bare_axes(), **options))


@pytest.fixture(autouse=True)
def no_window(monkeypatch):
    monkeypatch.setattr(plt, "show", lambda: pytest.fail("show was called"))
    yield
    plt.close("all")


@pytest.mark.parametrize("dpi", [60, 130])
def test_a_ball_covers_a_disc_of_the_right_area(dpi):
    axes = bare_axes()
    axes.get_figure().set_dpi(dpi)
    axes.set_proj_type("ortho")
    image = pixels(plot_mesh(ball(), ax=axes, azimuth=30.0))
    right = np.array([-np.sin(np.radians(30)), np.cos(np.radians(30)), 0])
    ends = [
        axes.transData.transform(proj3d.proj_transform(*point, axes.get_proj())[:2]) for point in (0 * right, right)
    ]
    radius = np.linalg.norm(ends[1] - ends[0])
    assert radius > 50 * dpi / 60
    assert image[..., 3].sum() == pytest.approx(np.pi * radius**2, rel=0.01)
    rows, columns = np.nonzero(image[..., 3] > 0.5)
    middle = (columns.mean() + 0.5, image.shape[0] - rows.mean() - 0.5)
    np.testing.assert_allclose(middle, ends[0], atol=0.6)


@pytest.mark.slow
def test_light_comes_from_above_and_the_left_wherever_one_stands():
    for azimuth in (-55.0, 90.0, 170.0):
        image = drawn(ball(), azimuth=azimuth)
        brightness = np.where(image[..., 3] == 1, image[..., :3].sum(axis=2), np.nan)
        row, column = np.unravel_index(np.nanargmax(brightness), brightness.shape)
        rows, columns = np.nonzero(image[..., 3] == 1)
        assert row < rows.mean() - 20
        assert column < columns.mean() - 5
        assert np.nanmin(brightness) > 0.25
        height = np.ptp(rows)
        assert np.nanmean(brightness[: rows.min() + height // 4]) > 1.3 * np.nanmean(
            brightness[rows.max() - height // 4 :]
        )


@pytest.mark.slow
def test_an_open_surface_shows_its_inside_in_a_warmer_colour():
    whole = ball()
    half = whole.vertices[whole.faces].mean(axis=1)[:, 0] < 0.3
    bowl = Mesh(whole.vertices, whole.faces[half], whole.normals[half])
    for azimuth, seen in ((0.0, True), (180.0, False)):
        image = drawn(bowl, azimuth=azimuth, elevation=0.0)
        body = image[..., 3] > 0.9
        warm = body & (image[..., 0] > image[..., 2])
        assert (warm.sum() > 0.7 * body.sum()) == seen
        assert warm.any() == seen
        # Light from above falls on the lower part of a hollow and on the upper part of a bulge.
        rows = np.nonzero(body)[0]
        brightness = image[..., :3].sum(axis=2)[body]
        quarter = np.ptp(rows) / 4
        upper, lower = rows < rows.min() + quarter, rows > rows.max() - quarter
        assert (brightness[lower].mean() > 1.2 * brightness[upper].mean()) == seen


def test_mirrored_axes_do_not_turn_a_body_inside_out():
    axes = bare_axes()
    artist = plot_mesh(brick(2, 1, 1), ax=axes)
    before = pixels(artist)
    axes.invert_xaxis()
    after = pixels(artist)
    body = after[..., 3] > 0.9
    assert after[..., 3].sum() == pytest.approx(before[..., 3].sum(), rel=0.1)
    assert (after[..., 2] >= after[..., 0])[body].all()
    # A mirrored brick shows three faces in three shades, like the brick itself.
    assert after[body][:, :3].std() > 0.5 * before[before[..., 3] > 0.9][:, :3].std()


@pytest.mark.parametrize("extents", [(16, 33.5, 13), (11, 2, 2), (1, 1, 1)])
def test_one_unit_is_as_long_on_every_axis(extents):
    axes = plot_mesh(brick(*extents)).axes
    limits = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()])
    np.testing.assert_allclose(
        np.ptp(limits, axis=1) / axes.get_box_aspect(), np.ptp(limits[0]) / axes.get_box_aspect()[0]
    )
    assert (limits[:, 0] <= -np.array(extents) / 2).all()
    assert (limits[:, 1] >= np.array(extents) / 2).all()


@pytest.mark.random
@pytest.mark.parametrize("extents", [(16, 33.5, 13), (11, 2, 2), (2, 2, 11), (1, 1, 1)])
@pytest.mark.parametrize(("elevation", "azimuth"), [(22, -55), (22, 55), (35, 200), (-25, 20)])
def test_labels_stay_inside_the_figure_clear_of_each_other(extents, elevation, azimuth):
    artist = plot_mesh(brick(*extents), elevation=elevation, azimuth=azimuth)
    figure, axes = artist.get_figure(), artist.axes
    pixels(artist)
    renderer = figure.canvas.get_renderer()
    three = (axes.xaxis, axes.yaxis, axes.zaxis)
    assert [axis.get_label_text() for axis in three] == ["x", "y", "z"]
    labels = [axis.label for axis in three]
    labels += [tick.label1 for axis in three for tick in axis.get_major_ticks() if tick.label1.get_text()]
    boxes = [label.get_window_extent(renderer) for label in labels]
    for box in boxes:
        assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
        assert figure.bbox.y0 <= box.y0 < box.y1 <= figure.bbox.y1
    for (one, first), (two, second) in itertools.combinations(zip(labels, boxes, strict=True), 2):
        assert not first.overlaps(second), (one.get_text(), two.get_text())
    body = artist.get_window_extent(renderer)
    assert max(body.width / figure.bbox.width, body.height / figure.bbox.height) > 0.6


def test_given_axes_are_used_and_pyplot_is_left_alone():
    axes = bare_axes()
    artist = plot_mesh(ball(1), ax=axes)
    assert artist.axes is axes
    assert artist in axes.artists
    assert plt.get_fignums() == []


def test_two_meshes_share_the_limits():
    axes = bare_axes()
    plot_mesh(brick(4, 1, 1), ax=axes)
    plot_mesh(brick(1, 6, 1), ax=axes)
    assert np.ptp(axes.get_xlim()) >= 4
    assert np.ptp(axes.get_ylim()) >= 6


def test_flat_axes_and_unknown_colours_are_refused():
    with pytest.raises(RsymError, match="projection"):
        plot_mesh(ball(1), ax=Figure().add_subplot())
    with pytest.raises(RsymError, match="blurple"):
        plot_mesh(ball(1), ax=bare_axes(), colour="blurple")


def test_a_turned_camera_gives_a_new_picture_and_the_old_view_the_old_one():
    artist = plot_mesh(brick(3, 2, 1), ax=bare_axes())
    first = pixels(artist)
    artist.axes.view_init(elev=50, azim=20)
    turned = pixels(artist)
    artist.axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    assert np.abs(turned - first).max() > 0.2
    np.testing.assert_array_equal(pixels(artist), first)


@pytest.mark.slow
def test_edges_are_dark_lines_and_those_behind_are_hidden():
    axes = bare_axes()
    axes.set_proj_type("ortho")
    cube = brick(1, 1, 1)
    plain = drawn(cube, azimuth=0.0, elevation=0.0)
    lines = pixels(plot_mesh(cube, ax=axes, azimuth=0.0, elevation=0.0, edges=True))
    body = lines[..., 3] > 0.99
    rows, columns = np.nonzero(body)
    inner = np.s_[rows.min() + 3 : rows.max() - 2, columns.min() + 3 : columns.max() - 2]
    flat = np.median(lines[inner][..., :3].sum(axis=2))
    dark = lines[inner][..., :3].sum(axis=2) < 0.9 * flat
    side = dark.shape[0]
    # One diagonal of the face in front and no other line.
    assert 0.5 * side < dark.sum() < 4 * side
    across, along = np.nonzero(dark)
    assert abs(np.corrcoef(across, along)[0, 1]) > 0.99
    assert not (plain[..., :3].sum(axis=2)[inner] < 0.8 * flat).any()


def test_normals_that_are_undefined_leave_no_black_or_missing_spots():
    mesh = ball(3)
    normals = mesh.normals.copy()
    normals[::7] = np.nan
    normals[3::11, 1] = 0
    whole, broken = drawn(mesh), drawn(Mesh(mesh.vertices, mesh.faces, normals))
    np.testing.assert_array_equal(whole[..., 3], broken[..., 3])
    assert np.abs(whole - broken).max() < 0.2


@pytest.mark.slow
@pytest.mark.parametrize(("suffix", "mark"), [("png", b"\x89PNG"), ("svg", b"<image"), ("pdf", b"/Subtype /Image")])
def test_pictures_can_be_saved_trimmed(suffix, mark):
    figure = plot_mesh(ball(2)).get_figure()
    buffer = io.BytesIO()
    figure.savefig(buffer, format=suffix, bbox_inches="tight")
    assert mark in buffer.getvalue()


def test_a_trimmed_picture_is_no_larger_than_the_figure():
    figure = plot_mesh(brick(11, 2, 2)).get_figure()
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", bbox_inches="tight", pad_inches=0, dpi=100)
    buffer.seek(0)
    height, width = plt.imread(buffer).shape[:2]
    assert width <= 100 * figure.get_figwidth() + 2
    assert height <= 100 * figure.get_figheight() + 2


def test_light_is_averaged_as_light_and_colour_does_not_fade_at_the_rim():
    samples = np.zeros((2, 4, 4), np.float32)
    samples[:, 0] = (*linear("#8aa4c8"), 1)
    samples[:, 2] = 1
    samples[:, 3] = (0, 0, 0, 1)
    image = reduce(samples, 2)
    np.testing.assert_array_equal(image[0, 0], [0x8A, 0xA4, 0xC8, 128])
    # Half black, half white is 188 of 255, not 128.
    np.testing.assert_array_equal(image[0, 1], [188, 188, 188, 255])
    np.testing.assert_allclose(encode(linear("#123456")) * 255, [0x12, 0x34, 0x56])


def test_hollows_darken_a_recess_but_not_a_slope():
    slope = np.add.outer(np.linspace(0, 1, 80), np.linspace(0, 2, 80))
    np.testing.assert_allclose(hollows(slope, 8)[20:-20, 20:-20], 1, atol=0.03)
    pit = np.zeros((80, 80))
    pit[38:42, 38:42] = 1
    factors = hollows(pit, 8)
    assert factors[40, 40] < 0.6
    assert factors[5, 5] == 1
    assert np.isfinite(hollows(np.full((9, 9), np.nan), 2)).all()
