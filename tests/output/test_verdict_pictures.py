"""Pictures of verdicts: what is proved has its colour, what is wrong is marked and magnified."""

import dataclasses
import itertools
import math

import matplotlib.pyplot
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Annotation
from oracles import reports
from oracles.closeness import assert_close

import rsym
from rsym import x, y
from rsym.output.certificates import CERTIFICATES, branches_at, certificates_of, window_size
from rsym.output.pictures import write_picture
from rsym.output.verdicts import plot_verdict
from rsym.verify.answers.report import Cover, Joint, SmoothnessReport

DISC = rsym.Shape(1 - x**2 - y**2, (x, y), bounds=((-2, 2), (-2, 2)))


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    matplotlib.pyplot.close("all")


def polygon(count):
    """A regular polygon about the unit circle, with its corners as hand-made defects."""
    turns = 2 * np.pi * np.arange(count) / count
    sides = [1 - float(np.cos(turn)) * x - float(np.sin(turn)) * y for turn in turns]
    shape = rsym.Shape(rsym.conjunction(*sides, system=rsym.R1), (x, y), bounds=((-2, 2), (-2, 2)))
    middle, radius = turns + np.pi / count, 1 / np.cos(np.pi / count)
    corners = tuple(
        Joint((radius * math.cos(angle), radius * math.sin(angle)), 0.0, "corner", "G0", tangent_jump=360 / count)
        for angle in middle
    )
    cover = Cover(shape.bounds, reports.ring(1.0), reports.NONE, reports.NONE, 100)
    return shape, SmoothnessReport("REFUTED", "G0", corners, (), 0.0, cover, {})


def numbers(figure):
    return [text.get_text() for text in figure.axes[0].texts if isinstance(text, Annotation)]


@pytest.mark.slow
@pytest.mark.parametrize(("count", "windows"), [(0, 0), (4, 4), (12, 4)])
def test_the_worst_defects_have_windows_and_all_have_marks(count, windows):
    shape, report = (DISC, reports.undecided_disc()) if not count else polygon(count)
    figure = plot_verdict(report, shape, resolution=100)
    assert len(figure.axes) == 1 + windows
    assert numbers(figure) == [str(k + 1) for k in range(windows)]
    marks = [line for line in figure.axes[0].lines if line.get_marker() == "o"]
    assert_close(
        np.reshape([line.get_xydata()[0] for line in marks], (-1, 2)),
        np.reshape([j.point for j in report.defects], (-1, 2)),
        atol=1e-12,
    )
    assert len(plot_verdict(report, shape, magnified=1, resolution=100).axes) == 1 + min(1, count)


def test_parts_of_the_boundary_have_the_colour_of_their_boxes():
    """Hand-made boxes: the right half certified, a strip of it undecided, nothing on the left."""
    half = np.array([[[0.0, 2.0], [-2.0, 2.0]]])
    strip = np.array([[[0.0, 2.0], [-0.1, 0.1]]])
    report = SmoothnessReport("UNDECIDED", "G0", (), (), math.inf, Cover(DISC.bounds, half, reports.NONE, strip, 2), {})
    ax = Figure().add_subplot()
    assert plot_verdict(report, DISC, ax=ax, comb=False, resolution=200) is ax.figure
    for name, wanted in (
        ("certified", lambda p: (p[:, 0] > -0.05) & (abs(p[:, 1]) > 0.1)),
        ("undecided", lambda p: (p[:, 0] > 0) & (abs(p[:, 1]) < 0.1)),
        ("", lambda p: p[:, 0] < -0.03),
    ):
        (strokes,) = [one for one in ax.collections if one.get_label() == CERTIFICATES[name].label]
        middles = np.concatenate([(s[1:] + s[:-1]) / 2 for s in strokes.get_segments()])
        assert wanted(middles).all(), name
        assert len(middles) > 5


def test_certificates_of_points_against_a_plain_loop():
    random = np.random.default_rng(3)
    corners = random.uniform(-1, 1, (40, 2))
    boxes = np.stack([corners, corners + random.uniform(0, 0.3, (40, 2))], axis=2)
    cover = Cover(((-1, 1), (-1, 1)), boxes[:30], boxes[30:38], boxes[38:], 40)
    points = random.uniform(-1, 1, (400, 2))

    def distance(point, box):
        return max(max(low - c, c - high, 0) for c, (low, high) in zip(point, box, strict=True))

    seen = set()
    for point, name in zip(points, certificates_of(points, cover), strict=True):
        far = {part: min(distance(point, box) for box in getattr(cover, part)) for part in CERTIFICATES if part}
        least = min(far.values())
        weakest = next(part for part in ("undecided", "joined", "certified") if far[part] == least)
        assert name == (weakest if least < 0.02 else "")
        seen.add(str(name))
    assert seen == set(CERTIFICATES)


def test_a_window_shows_the_corner_with_its_turn():
    figure = plot_verdict(reports.refuted_corner(), rsym.paper.skeleton_body(), resolution=100)
    window = figure.axes[1]
    assert "corner, 40" in window.get_title()
    assert "turn 144.811726903°, proved" in window.get_xlabel()
    assert [text.get_text() for text in window.texts] == ["144.8°"]
    (carried, _) = window.lines
    # The tangent of one arc carried on: as steep as the arcs, on the other side of the tip.
    slope = math.radians((180 - 144.811726903428) / 2)
    assert_close(np.abs(np.arctan(np.divide(*carried.get_xydata()[1][::-1]))), slope, atol=2e-3)
    assert carried.get_xydata()[1][0] < 0


def test_branches_are_read_with_their_tangent_and_curvature():
    """Arcs of circles of radius 1/2 and 1/4 that leave one point in known directions."""
    arcs = []
    for direction, curvature in ((0.3, 2.0), (2.5, -4.0), (-3.0, 0.0)):
        s = np.linspace(0, 0.3, 200)
        steps = np.exp(1j * (direction + curvature * s)) * s[1]
        z = np.append(0, np.cumsum((steps[1:] + steps[:-1]) / 2))
        arcs.append(np.stack([z.real + 5, z.imag + 7], axis=1))
    found = sorted(branches_at(arcs, (5.0, 7.0), 0.5), key=lambda branch: branch.direction)
    assert_close([branch.direction for branch in found], [-3.0, 0.3, 2.5], atol=2e-3)
    assert_close([branch.bend for branch in found], [0.0, 2.0, -4.0], atol=5e-2)
    centre = np.array([-math.sin(found[1].direction), math.cos(found[1].direction)]) / found[1].bend
    assert_close(np.hypot(*(found[1].before(0.4) - centre).T), np.full(60, 1 / found[1].bend), atol=1e-9)


def test_windows_of_near_defects_do_not_show_each_other():
    report = dataclasses.replace(
        reports.stadium(),
        defects=tuple(Joint((k * 1e-2, 0.0), 0.0, "curvature jump", "G1", curvatures=(0.0, 1.0)) for k in range(3)),
    )
    for first, second in itertools.combinations(report.defects, 2):
        assert window_size(report, first, 4.0) < math.dist(first.point, second.point)


def test_a_body_of_revolution_is_its_meridian_with_the_mirror_image():
    profile = rsym.Shape(1 - x**2 / 4 - y**2, (x, y), bounds=((-3, 3), (-2, 2)))
    cover = Cover(((-3.0, 3.0), (-0.1, 2.0)), np.array([[[-3.0, 3.0], [-0.1, 2.0]]]), reports.NONE, reports.NONE, 1)
    report = SmoothnessReport("CERTIFIED", "analytic", (), (), 2.0, cover, {}, body=True)
    ax = plot_verdict(report, rsym.revolve(profile), resolution=100).axes[0]
    (strokes,) = [one for one in ax.collections if one.get_label() == CERTIFICATES["certified"].label]
    points = np.concatenate(strokes.get_segments())
    assert_close([points.min(), points[:, 1].min(), points[:, 1].max()], [-2, -1, 1], atol=1e-3)
    assert not [one for one in ax.collections if one.get_label() == CERTIFICATES[""].label]


def test_a_shape_without_a_boundary_is_an_empty_picture():
    report = dataclasses.replace(reports.degenerate_lemniscate(), defects=())
    with pytest.warns(rsym.RsymWarning, match="lines may be missing"):
        figure = plot_verdict(report, rsym.Shape(-((x**2 + y**2 - 1) ** 2), (x, y), bounds=((-2, 2), (-2, 2))))
    assert figure.axes[0].get_title() == "DEGENERATE: no boundary to speak of"


@pytest.mark.slow
def test_the_same_report_gives_the_same_bytes(tmp_path):
    first, second = (
        write_picture(plot_verdict(reports.undecided_disc(), DISC, resolution=60), tmp_path / f"{k}.png") for k in "ab"
    )
    assert first.read_bytes() == second.read_bytes()
    assert first.read_bytes().startswith(b"\x89PNG")
