import xml.etree.ElementTree as ET

import matplotlib.figure
import numpy as np
import pytest
from closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y, z

BOX = ((-3, 3), (-2.5, 2.5), (-2, 2))
BALL = Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z), bounds=BOX)
TUBE = rsym.difference(BALL, Shape((1 - x**2 - y**2) / 2, (x, y, z)))
SVG = "{http://www.w3.org/2000/svg}"


def area(line):
    u, v = line.T
    return float(u[:-1] @ v[1:] - v[:-1] @ u[1:]) / 2


def test_a_section_is_reported_and_can_be_cancelled():
    ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    seen = []
    with pytest.raises(RsymError) as caught:
        rsym.sections(ball, [0, 0.1, 0.2], resolution=16, progress=lambda *step: seen.append(step) or len(seen) < 2)
    assert caught.value.code == "cancelled"
    assert seen == [(1, 3), (2, 3)]


def test_sections_of_a_ball_are_circles_of_the_right_radius():
    for section in rsym.sections(BALL, [-1.5, 0, 1], resolution=64):
        (circle,) = section.lines
        assert_close(np.hypot(*circle.T), np.full(len(circle), np.sqrt(4 - section.value**2)), atol=1e-9)


@pytest.mark.parametrize(("axis", "free"), [("x", (1, 2)), ("y", (0, 2)), (z, (0, 1))])
def test_an_axis_keeps_its_place_in_space(axis, free):
    (section,) = rsym.sections(BALL, [0.5], axis=axis, resolution=32)
    assert section.coordinates == tuple("xyz"[k] for k in free)
    points = section.in_space(section.lines[0])
    assert_close(np.linalg.norm(points, axis=1), np.full(len(points), 2.0), atol=1e-9)
    assert_close(points[:, "xyz".index(str(axis))], np.full(len(points), 0.5), atol=1e-15)


def test_holes_run_the_other_way_round():
    (section,) = rsym.sections(TUBE, [0.0], resolution=96)
    outer, inner = sorted((area(line) for line in section.lines), key=abs, reverse=True)
    assert outer * inner < 0
    assert_close([abs(outer), abs(inner)], [4 * np.pi, np.pi], rtol=2e-3)


@pytest.mark.parametrize("elevation", [30.0, -30.0])
def test_the_stack_is_drawn_from_the_far_end_with_its_holes_open(elevation):
    stack = rsym.sections(TUBE, [1, 0, -1.0, 5], resolution=48)
    ax = matplotlib.figure.Figure().add_subplot()
    patches = rsym.plot_sections(stack, ax=ax, elevation=elevation)
    assert len(patches) == 3
    heights = [patch.get_path().vertices[:, 1].mean() for patch in patches]
    assert heights == sorted(heights, reverse=elevation < 0)
    colours = {tuple(np.round(patch.get_edgecolor(), 6)) for patch in patches}
    assert len(colours) == 3
    figure = matplotlib.figure.Figure(figsize=(2, 2), dpi=50)
    rsym.plot_sections(rsym.sections(TUBE, [0.0], resolution=48), ax=figure.add_axes((0, 0, 1, 1)))
    image = drawn(figure)
    assert (image[50, 50, :3] == 255).all(), "the hole is filled"
    assert image[50, 15, :3].min() < 255, "the material is not"
    assert ax.get_aspect() == 1


def drawn(figure):
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())


def test_svg_is_true_to_scale_with_one_group_for_each_layer(tmp_path):
    stack = rsym.sections(TUBE, [0.0, 1.0, 1.6], resolution=64)
    path = rsym.write_sections(stack, tmp_path / "tube.svg", unit="cm", scale=0.5)
    root = ET.parse(path).getroot()
    left, top, width, height = map(float, root.get("viewBox").split())
    assert (root.get("width"), root.get("height")) == (f"{width:.9g}cm", f"{height:.9g}cm")
    assert_close([left, top, width, height], [-1, -1, 2, 2], atol=2e-3)
    layers = root.find(f"{SVG}g").findall(f"{SVG}g")
    assert [layer.get("id") for layer in layers] == ["z=0", "z=1", "z=1.6"]
    paths = [layer.findall(f"{SVG}path") for layer in layers]
    assert [len(part) for part in paths] == [2, 2, 2]
    text = paths[1][0].get("d")
    assert text.endswith("Z")
    points = np.array([pair.split() for pair in text[1:-2].split(" L")], float)
    radii = np.hypot(*points.T)
    assert min(abs(radii[0] - 0.5), abs(radii[0] - np.sqrt(3) / 2)) < 1e-8
    assert np.ptp(radii) < 1e-8
    assert path.read_bytes() == rsym.write_sections(stack, tmp_path / "again.svg", unit="cm", scale=0.5).read_bytes()


def test_lines_that_leave_the_bounds_stay_open(tmp_path):
    stack = rsym.sections(BALL, [0.0], bounds=((-3, 1), (-2.5, 2.5), (-2, 2)), resolution=32)
    assert " Z" not in rsym.write_sections(stack, tmp_path / "cut.svg").read_text()
    (patch,) = rsym.plot_sections(stack, ax=matplotlib.figure.Figure().add_subplot())
    assert len(patch.get_path().vertices) == 0


@pytest.mark.parametrize(
    "call",
    [
        lambda: rsym.sections(BALL, []),
        lambda: rsym.sections(BALL, [float("nan")]),
        lambda: rsym.sections(BALL, [0], axis="w"),
        lambda: rsym.sections(rsym.paper.skeleton_body(), [0], axis=x),
        lambda: rsym.plot_sections(rsym.sections(BALL, [4.0], resolution=16)),
        lambda: rsym.write_sections(rsym.sections(BALL, [0.0], resolution=16), "a.png"),
        lambda: rsym.write_sections(rsym.sections(BALL, [0.0], resolution=16), "a.svg", unit="ell"),
        lambda: rsym.write_sections(rsym.sections(BALL, [0.0], resolution=16), "a.svg", scale=0),
        lambda: rsym.write_sections(
            rsym.sections(BALL, [0.0], resolution=16) + rsym.sections(BALL, [0.0], axis=x, resolution=16), "a.svg"
        ),
    ],
)
def test_refusals(call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RsymError):
        call()
    assert not list(tmp_path.iterdir())
