"""Pictures of verdicts on bodies: every curve has its colour where a camera of its own says that it is."""

import dataclasses
import itertools

import matplotlib as mpl
from oracles import body_reports

mpl.use("Agg")
import matplotlib.pyplot
import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.output.ink import draw_lines
from rsym.output.pictures import write_picture
from rsym.output.rasteriser import rasterise, snap
from rsym.output.singular import UNDECIDED, mark_boxes, mark_curves

ELEVATION, AZIMUTH = 25.0, -60.0
HIDDEN_CORNER = np.array([-1.0, 0.8, -0.6])  # of the box, at this view


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def camera(axes):
    """Where a point of space is in pixels: a pinhole ten units from the middle of the stretched box."""
    low, high = np.array([axes.get_xlim(), axes.get_ylim(), axes.get_zlim()]).T
    aspect = np.asarray(axes.get_box_aspect())
    up, round_ = np.radians(ELEVATION), np.radians(AZIMUTH)
    back = np.array([np.cos(up) * np.cos(round_), np.cos(up) * np.sin(round_), np.sin(up)])
    right = np.array([-np.sin(round_), np.cos(round_), 0.0])
    above = np.cross(back, right)

    def place(point):
        away = (np.asarray(point, float) - low) / (high - low) * aspect - aspect / 2 - 10 * back
        return axes.transData.transform(np.array([right @ away, above @ away]) / -(back @ away))

    return place


def shown(draw):
    """The picture that `draw(axes)` makes: its colour at a point of space, and what it drew."""
    figure = Figure(figsize=(4, 4), dpi=150)
    axes = figure.add_axes((0, 0, 1, 1), projection="3d")
    axes.set_axis_off()
    artist = draw(axes)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = np.array(canvas.buffer_rgba())[::-1, :, :3] / 255.0
    place = camera(axes)

    def at(point):
        column, row = place(point)
        return image[int(row), int(column)]

    return at, artist


def verdict(report, shape, **options):
    view = {"elevation": ELEVATION, "azimuth": AZIMUTH, "resolution": 24}
    return shown(lambda axes: rsym.plot_verdict(report, shape, ax=axes, **view, **options))[0]


def off(colour, wanted):
    """The largest difference of red, green or blue."""
    return np.abs(colour - np.asarray(wanted)).max()


def angle_colour(angle, low, high):
    return np.array(colormaps["plasma"](0.87 * (angle - low) / (high - low))[:3])


@pytest.mark.slow
def test_visible_edges_have_the_colour_of_their_angle_and_hidden_ones_do_not_shine_through():
    at = verdict(body_reports.box(), body_reports.BOX)
    wanted = angle_colour(90, 60, 120)
    hidden = 0
    for edge in body_reports.box_edges():
        # The hidden corner first: far from it a hidden edge passes behind one that is seen.
        first, last = sorted(edge.points, key=lambda end: np.linalg.norm(end - HIDDEN_CORNER))
        behind = bool((first == HIDDEN_CORNER).all())
        for share in (0.1, 0.2) if behind else (0.25, 0.5, 0.7):
            difference = off(at(first + share * (last - first)), wanted)
            assert difference > 0.25 if behind else difference < 0.03, (edge, share)
        hidden += behind
    assert hidden == 3


@pytest.mark.slow
def test_convex_and_concave_edges_have_the_ends_of_the_scale():
    at = verdict(body_reports.notched(), body_reports.NOTCHED)
    for point, angle in (((0, 0.3, 1), 90), ((0, -0.4, 0), 270)):
        assert off(at(point), angle_colour(angle, 90, 270)) < 0.03, angle


@pytest.mark.slow
def test_colours_follow_the_angle_along_an_edge():
    plain = body_reports.edge(np.linspace((0, -1, 1), (0, 1, 1), 3), [0, 0, 1], [1, 0, 0], ("top", "wall"))
    varying = dataclasses.replace(plain, tangent_jumps=np.array([150.0, 90.0, 30.0]))
    at = verdict(dataclasses.replace(body_reports.notched(), curves=(varying,)), body_reports.NOTCHED)
    for y_, angle in ((-0.75, 45), (-0.25, 75), (0.5, 120)):
        assert off(at((0, y_, 1)), angle_colour(angle, 30, 150)) < 0.04, y_


@pytest.mark.slow
def test_a_jump_of_the_curvature_is_dashed():
    at = verdict(body_reports.capsule(), body_reports.CAPSULE)
    wanted = np.array(colormaps["viridis"](0.3)[:3])
    turns = np.radians(np.linspace(AZIMUTH - 50, AZIMUTH + 50, 200))  # of the half that faces the eye
    rim = [(0.5 * np.cos(turn), 0.5 * np.sin(turn), body_reports.LONG) for turn in turns]
    inked = np.array([off(at(point), wanted) < 0.03 for point in rim])
    assert 0.4 < inked.mean() < 0.85  # the ends of dashes are round
    assert (np.diff(inked.astype(int)) != 0).sum() > 6


@pytest.mark.random
@pytest.mark.parametrize(
    ("make", "shape", "label", "limits"),
    [
        (body_reports.box, body_reports.BOX, "dihedral angle in degrees", (60, 120)),
        (body_reports.notched, body_reports.NOTCHED, "dihedral angle in degrees", (90, 270)),
        (body_reports.capsule, body_reports.CAPSULE, "jump of normal curvature, dashed", (0, 2)),
    ],
)
def test_a_figure_has_a_colour_bar_with_its_limits(make, shape, label, limits):
    figure = rsym.plot_verdict(make(), shape, resolution=16)
    (bar,) = figure.axes[1:]
    assert bar.get_ylabel() == label
    assert_close(bar.get_ylim(), limits, atol=1e-12)
    assert figure.get_suptitle().startswith("REFUTED: ")


@pytest.mark.slow
def test_several_bars_stand_side_by_side():
    report = dataclasses.replace(
        body_reports.box(), curves=(*body_reports.box().curves, *body_reports.capsule().curves)
    )
    figure = rsym.plot_verdict(report, body_reports.BOX, colour_by="mean_curvature", resolution=16)
    figure.canvas.draw()
    boxes = [one.get_tightbbox() for one in figure.axes[1:]]
    assert len(boxes) == 3
    for left, right in itertools.pairwise(sorted(boxes, key=lambda box: box.x0)):
        assert left.x1 < right.x0
    assert max(box.x1 for box in boxes) <= figure.bbox.x1


def test_a_body_without_singular_curves_has_neither_bar_nor_legend():
    figure = rsym.plot_verdict(body_reports.ball({"r": (1.0, 2.0)}), body_reports.BALL, resolution=16)
    assert len(figure.axes) == 1
    assert figure.legends == []
    assert figure.get_suptitle() == "CERTIFIED: analytic, proved, for every r in [1, 2]"


def test_the_legend_tells_what_the_bars_do_not():
    report = body_reports.box()
    joint = dataclasses.replace(body_reports.capsule().curves[0], kind="smooth joint", continuity="G2")
    doubtful = dataclasses.replace(joint, kind="unresolved", continuity="unknown")
    place = dataclasses.replace(doubtful, points=np.array([[1.0, 0.0, 0.0]]))
    figure = rsym.plot_verdict(
        dataclasses.replace(
            report,
            curves=(*report.curves, joint, doubtful, doubtful, place),
            points=(*report.points, *body_reports.double_cone().points),
            cover=body_reports.undecided().cover,
        ),
        body_reports.BOX,
        resolution=16,
    )
    texts = {text.get_text() for text in figure.legends[0].get_texts()}
    assert texts == {"smooth joint", "2 unresolved places", "unresolved place", "8 corners", "undecided: 2 boxes"}
    assert [text.get_text().strip() for text in figure.axes[0].texts] == ["node"]


def test_undecided_boxes_are_outlined():
    at = verdict(body_reports.undecided(), body_reports.BALL)
    colour = np.array(mpl.colors.to_rgb(UNDECIDED))
    # An edge of the box about (1, 0, 0), outside the ball.
    assert off(at((1.25, -0.25, 0.1)), colour) < 0.35
    assert off(at((1.25, -0.12, 0.1)), colour) > 0.5


def test_many_small_boxes_become_a_few_marks_that_can_be_seen():
    random = np.random.default_rng(1)
    boxes = body_reports.cubes(random.uniform(0, 0.05, (500, 3)), 1e-9)
    (stroke,) = mark_boxes(boxes, 2.0).strokes
    assert len(stroke.pieces) <= 12 * 8
    assert_close(
        np.linalg.norm(np.diff(stroke.pieces, axis=1), axis=2), np.full((len(stroke.pieces), 1), 0.028), rtol=1e-6
    )


@pytest.mark.slow
@pytest.mark.parametrize("colour_by", ["zebra", "mean_curvature"])
def test_maps_have_the_singular_curves_on_them(colour_by):
    at, artist = shown(
        lambda axes: rsym.plot_mesh(
            rsym.mesh(body_reports.BOX, 24),
            ax=axes,
            colour_by=colour_by,
            shape=body_reports.BOX,
            curves=body_reports.box().curves,
            elevation=ELEVATION,
            azimuth=AZIMUTH,
        )
    )
    assert off(at((0.3, -0.8, 0.6)), angle_colour(90, 60, 120)) < 0.03
    assert off(at((0.3, -0.3, 0.6)), angle_colour(90, 60, 120)) > 0.25
    assert [bar.label for bar in artist.bars] == ["dihedral angle in degrees"]


def test_features_of_a_mesh_are_coloured_like_the_curves_of_a_report():
    features = rsym.mesh(body_reports.NOTCHED, 16).features
    (bar,) = mark_curves(features, 2.0).bars
    assert bar.scale.get_clim() == (90, 270)
    assert bar.ticks == (90, 120, 150, 180, 210, 240, 270)


def test_lines_of_one_stroke_have_their_own_colours():
    wall = snap(np.array([[[0.0, 0, 1], [400, 0, 1], [0, 40, 1]]]))
    samples = np.zeros((20, 200, 4), np.float32)
    lines = np.array([[[20.0, 8.0, 0.0], [90.0, 8.0, 0.0]], [[110.0, 8.0, 0.0], [180.0, 8.0, 0.0]]])
    colours = np.array([[0.5, 0.0, 0.0], [0.0, 0.25, 1.0]])
    draw_lines(samples, rasterise(wall, (20, 200)), wall, lines, 5.0, colours)
    for column, colour in ((50, colours[0]), (150, colours[1])):
        assert_close(samples[8, column], [*colour, 1.0], atol=1e-5)
    assert (samples[8, 100] == 0).all()


def test_without_a_surface_the_bounds_and_the_points_are_shown(tmp_path):
    report = body_reports.double_cone()
    shape = rsym.Shape(-(x**2) - y**2 - z**2, (x, y, z), bounds=body_reports.BOUNDS)
    path = write_picture(rsym.plot_verdict(report, shape, resolution=8), tmp_path / "point.png", dpi=50)
    assert path.stat().st_size > 3000


@pytest.mark.slow
def test_the_same_report_gives_the_same_bytes(tmp_path):
    first, second = (
        write_picture(
            rsym.plot_verdict(body_reports.box(), body_reports.BOX, resolution=8), tmp_path / f"{k}.png", dpi=60
        )
        for k in "ab"
    )
    assert first.read_bytes() == second.read_bytes()


def test_plane_axes_are_refused():
    with pytest.raises(rsym.RsymError) as caught:
        rsym.plot_verdict(body_reports.ball(), body_reports.BALL, ax=Figure().add_subplot())
    assert caught.value.code == "axes"


def test_singular_curves_are_written_as_polylines(tmp_path):
    text = rsym.write_features(body_reports.box().curves, tmp_path / "edges.dxf", scale=10.0).read_text()
    assert text.count("POLYLINE\n") == 12
    assert "BACK-TOP" in text
    values = [float(line) for line in text.split("ENTITIES")[1].splitlines() if "." in line]
    assert {abs(value) for value in values} == {0.0, 6.0, 8.0, 10.0}
    with pytest.raises(rsym.RsymError) as caught:
        rsym.write_features((), tmp_path / "none.dxf")
    assert caught.value.code == "no-features"
