import xml.etree.ElementTree as ET

import ezdxf
import matplotlib.figure
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

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


@pytest.mark.parametrize("system", [rsym.R0, rsym.RAlpha(0.5), rsym.Rp(4)])
def test_corners_of_a_polygon_are_exact(system):
    """Half-planes at random; their corners by linear algebra, the area by the corners."""
    generator = np.random.default_rng(5)
    angles = np.sort(generator.uniform(0, 2 * np.pi, 7) + np.arange(7) * 0.05)
    normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    far = generator.uniform(0.8, 1.2, 7)
    planes = [sp.Float(d) - sp.Float(u) * x - sp.Float(v) * y for (u, v), d in zip(normals, far, strict=True)]
    body = Shape(rsym.conjunction(*planes, 1 - z**2, system=system), (x, y, z), bounds=((-4, 4), (-4, 4), (-2, 2)))
    crossings = [np.linalg.solve(normals[[i, j]], far[[i, j]]) for i in range(7) for j in range(i)]
    corners = np.array([p for p in crossings if (normals @ p <= far + 1e-12).all()])
    corners = corners[np.argsort(np.arctan2(*corners.T))]
    (section,) = rsym.sections(body, [0.3], resolution=40)
    (line,) = section.lines
    gaps = np.linalg.norm(line[:, None] - corners, axis=2)
    assert_close(gaps.min(axis=0), np.zeros(len(corners)), atol=1e-13)
    assert_close(abs(area(line)), abs(area(np.vstack([corners, corners[:1]]))), rtol=1e-13)
    assert (section.lines.status.kept, section.lines.status.unresolved_corners) == (0, 0)


def test_a_chamfer_of_less_than_a_cell_has_both_its_corners():
    body = Shape(rsym.conjunction(x, y, 1 - x, 1 - y, x + y - 0.01), (x, y, z), bounds=((-1, 2), (-1, 2), (0, 1)))
    (section,) = rsym.sections(body, [0.5], resolution=30)
    assert_close(abs(area(section.lines[0])), 1 - 0.01**2 / 2, rtol=1e-14)
    for corner in ((0.01, 0), (0, 0.01)):
        assert np.abs(section.lines[0] - corner).sum(axis=1).min() < 1e-15


def test_the_tip_of_a_wedge_is_found_cells_ahead():
    body = Shape(rsym.conjunction(y, x / 10 - y, 1 - x), (x, y, z), bounds=((-1, 2), (-1, 1), (0, 1)))
    (section,) = rsym.sections(body, [0.5], resolution=30)
    assert_close(abs(area(section.lines[0])), 0.05, rtol=1e-13)
    assert np.abs(section.lines[0]).sum(axis=1).min() < 1e-14


@pytest.mark.parametrize("height", [0.0, 1.0])
def test_a_plane_along_a_face_cuts_the_body_and_not_the_face(height):
    body = Shape(rsym.conjunction(1 - x**2, 1 - y**2, z * (1 - z)), (x, y, z), bounds=((-2, 2), (-2, 2), (0, 1)))
    (section,) = rsym.sections(body, [height], resolution=25)
    assert_close(abs(area(section.lines[0])), 4.0, rtol=1e-14)
    assert (section.lines.status.kept, section.lines.status.unresolved_corners) == (0, 0)


def test_a_gap_thinner_than_a_cell_is_there():
    square = x**2 + y**2
    discs = rsym.disjunction(1 - square, rsym.conjunction(square - sp.Rational(21, 20) ** 2, 2 - square))
    (section,) = rsym.sections(Shape(discs, (x, y, z), bounds=((-2, 2), (-2, 2), (0, 1))), [0.5], resolution=24)
    assert (section.lines.status.closed, section.lines.status.unresolved_corners) == (3, 0)


@pytest.mark.slow
def test_every_vertex_of_the_car_lies_on_it():
    car = rsym.paper.car()
    kernel = rsym.compile(car, ("value", "gradient"))
    for section in rsym.sections(car, [0.5, 2.0, 4.0, 6.0], resolution=200):
        status = section.lines.status
        assert (status.kept, status.unresolved_corners, status.open) == (0, 0, 0)
        found = kernel(*section.in_space(np.concatenate(section.lines.lines)).T)
        assert_close(found["value"], np.zeros(len(found["value"])), atol=1e-12)


def test_leaves_that_meet_smoothly_or_jump_are_no_corners():
    tangent = Shape(rsym.disjunction(y, y - x**2), (x, y, z), bounds=((-1, 1),) * 3)
    (section,) = rsym.sections(tangent, [0.0], resolution=21)
    assert section.lines.status.unresolved_corners == 0
    step = Shape(sp.Piecewise((1, x > 0.1), (-1, True)) + 0 * y, (x, y, z), bounds=((-1, 1),) * 3)
    (section,) = rsym.sections(step, [0.0], resolution=20)
    assert section.lines.status.kept == 0
    assert_close(section.lines[0][:, 0], np.full(len(section.lines[0]), 0.1), atol=1e-15)


def test_holes_run_the_other_way_round():
    (section,) = rsym.sections(TUBE, [0.0], resolution=96)
    outer, inner = sorted((area(line) for line in section.lines), key=abs, reverse=True)
    assert outer * inner < 0
    assert_close([abs(outer), abs(inner)], [4 * np.pi, np.pi], rtol=2e-3)


@pytest.mark.parametrize("elevation", [30.0, -30.0])
def test_the_stack_is_drawn_from_the_far_end_with_its_holes_open(elevation):
    stack = rsym.sections(TUBE, [1, 0, -1.0, 5], resolution=48)
    ax = matplotlib.figure.Figure().add_subplot()
    with pytest.warns(rsym.RsymWarning, match="no boundary in the sections z = 5; .*z = -1 to 1"):
        drawn_stack = rsym.plot_sections(stack, ax=ax, elevation=elevation)
    assert len(drawn_stack.get_paths()) == 3
    heights = [path.vertices[:, 1].mean() for path in drawn_stack.get_paths()]
    assert heights == sorted(heights, reverse=elevation < 0)
    colours = {tuple(np.round(colour, 6)) for colour in drawn_stack.get_edgecolor()}
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


def test_dxf_is_read_back_layer_by_layer(tmp_path):
    stack = rsym.sections(TUBE, [-0.5, 0.25], axis=y, resolution=48)
    path = rsym.write_sections(stack, tmp_path / "tube.dxf", unit="in", scale=2.5)
    drawing = ezdxf.readfile(path)
    assert drawing.dxfversion == "AC1009"
    assert not drawing.audit().errors
    assert drawing.header["$INSUNITS"] == 1
    assert {"Y_-0P5", "Y_0P25"} <= {layer.dxf.name for layer in drawing.layers}
    read = {name: drawing.query(f'POLYLINE[layer=="{name}"]') for name in ("Y_-0P5", "Y_0P25")}
    for section, found in zip(stack, read.values(), strict=True):
        assert len(found) == len(section.lines) == 2
        for polyline, line in zip(found, section.lines, strict=True):
            places = np.array([tuple(vertex.dxf.location) for vertex in polyline.vertices])
            assert polyline.is_closed
            assert np.array_equal(places[:, :2], 2.5 * line[:-1])
            assert_close(places[:, 2], np.full(len(places), 2.5 * section.value), rtol=1e-15)
    assert_close(drawing.header["$EXTMAX"][:2], (2.5 * np.sqrt(4 - 0.25**2), 2.5 * np.sqrt(3)), atol=2e-2)
    assert path.read_bytes() == rsym.write_sections(stack, tmp_path / "again.dxf", unit="in", scale=2.5).read_bytes()


def test_lines_that_leave_the_bounds_stay_open(tmp_path):
    stack = rsym.sections(BALL, [0.0], bounds=((-3, 1), (-2.5, 2.5), (-2, 2)), resolution=32)
    assert " Z" not in rsym.write_sections(stack, tmp_path / "cut.svg").read_text()
    (line,) = ezdxf.readfile(rsym.write_sections(stack, tmp_path / "cut.dxf")).query("POLYLINE")
    assert not line.is_closed
    assert len(line) == len(stack[0].lines[0])
    artist = rsym.plot_sections(stack, ax=matplotlib.figure.Figure().add_subplot())
    filled, line = artist.get_paths()
    assert len(filled.vertices) == 0
    assert len(line.vertices) == len(stack[0].lines[0])
    assert artist.get_facecolor()[1, 3] == 0


@pytest.mark.parametrize(
    "call",
    [
        lambda: rsym.sections(BALL, []),
        lambda: rsym.sections(BALL, [float("nan")]),
        lambda: rsym.sections(BALL, [0], axis="w"),
        lambda: rsym.sections(Shape(sp.sqrt(-1 - x**2) + y + z, (x, y, z), bounds=BOX), [0.0], resolution=8),
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


@pytest.mark.slow
def test_features_are_read_back_from_dxf(tmp_path):
    names = ("x", "y", "z")
    solid = [
        rsym.Shape(1 - v**2, (x, y, z)).named(f"sides of {name}") for v, name in zip((x, y, z), names, strict=True)
    ]
    cube = rsym.mesh(solid[0] & solid[1] & solid[2], 16)
    path = rsym.write_features(cube, tmp_path / "cube.dxf", unit="in", scale=2.5)
    drawing = ezdxf.readfile(path)
    assert not drawing.audit().errors
    assert drawing.header["$INSUNITS"] == 1
    assert drawing.header["$EXTMIN"] == (-2.5,) * 3
    lines = list(drawing.query("POLYLINE"))
    assert len(lines) == 12
    assert {line.dxf.layer for line in lines} == {f"SIDES_OF_{a}-SIDES_OF_{b}".upper() for a, b in ("xy", "xz", "yz")}
    for line, feature in zip(lines, cube.features, strict=True):
        assert line.is_3d_polyline
        assert [tuple(vertex.dxf.location) for vertex in line.vertices] == [tuple(2.5 * p) for p in feature.points]
    assert path.read_bytes() == rsym.write_features(cube, tmp_path / "b.dxf", unit="in", scale=2.5).read_bytes()
    for wrong in (
        lambda: rsym.write_features(cube, tmp_path / "cube.svg"),
        lambda: rsym.write_features(cube, tmp_path / "cube.dxf", unit="ell"),
        lambda: rsym.write_features(rsym.mesh(solid[0] & solid[1] & solid[2], 16, method="smooth"), "a.dxf"),
    ):
        with pytest.raises(RsymError):
            wrong()


@pytest.mark.parametrize("values", [0.5, None])
def test_one_value_alone_is_refused_with_the_remedy(values):
    with pytest.raises(RsymError, match=r"several values.*\[0.5\]|several values.*None"):
        rsym.sections(rsym.sphere(1), values)


def test_lines_end_at_the_bounds_on_the_surface():
    ball = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 0.5), (-2, 0.75), (-2, 2)))
    (section,) = rsym.sections(ball, [0.1], resolution=40)
    (line,) = section.lines
    radius = np.sqrt(0.99)
    expected = [(-np.sqrt(0.99 - 0.75**2), 0.75), (0.5, -np.sqrt(0.99 - 0.25))]
    assert_close(sorted(map(tuple, line[[0, -1]])), expected, atol=1e-12)
    assert (line[:, 0].max(), line[:, 1].max()) == (0.5, 0.75)
    assert_close(np.hypot(*line.T), np.full(len(line), radius), atol=1e-12)
    assert (section.lines.status.open, section.lines.status.vertices) == (1, len(line))


def test_leaves_that_do_not_meet_have_no_corner():
    """Two circles 0.046 apart, in cells of 0.078: every vertex on one of them, and the gap is there."""
    both = rsym.disjunction(64 - x**2 - y**2, 0.04 - (x + 8) ** 2 - (y - 2) ** 2)
    body = rsym.Shape(rsym.conjunction(both, 1 - z**2), (x, y, z), bounds=((-10, 10), (-10, 10), (-2, 2)))
    (section,) = rsym.sections(body, [0.5], resolution=256)
    u, v = np.concatenate(section.lines).T
    off = np.minimum(abs(np.hypot(u, v) - 8), abs(np.hypot(u + 8, v - 2) - 0.2))
    assert off.max() < 1e-12
    assert (section.lines.status.closed, section.lines.status.unresolved_corners) == (2, 0)
