"""Pictures straight from the equation: against closed forms, in parallel rays and in perspective."""

import dataclasses
import io

import numpy as np
import pytest
from matplotlib import image as readers
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.errors import RsymWarning
from rsym.output.axes3d import frame, project
from rsym.output.brushes import CAP, HATCH, hatched
from rsym.output.cameras import VIEWS, Camera
from rsym.output.edges import edges_of, inked, smoothed
from rsym.output.framing import framed
from rsym.output.parts import PALETTE
from rsym.output.rendering import SIGNAL, Scene
from rsym.output.shading import KEY, decode, linear
from rsym.output.shadows import LAMP, shade_of
from rsym.output.sights import Sight
from rsym.sampling.rays import Caster

BALL = rsym.Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z), bounds=((-3, 3),) * 3).named("ball")
BOX = rsym.box(4, 2, 1).replace(bounds=((-2.5, 2.5), (-1.5, 1.5), (-1, 1)))
TORUS = rsym.torus(2, 0.7).replace(bounds=((-3, 3), (-3, 3), (-1, 1)))
SMALL = (96, 72)


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    import matplotlib.pyplot

    matplotlib.pyplot.close("all")


def test_a_ball_in_parallel_rays_is_where_it_is():
    image = rsym.render(BALL, camera="front", size=SMALL)
    hit = image.leaf >= 0
    # The eye is at y > 0, and x runs to the left.
    px, py, pz = np.moveaxis(image.points, -1, 0)
    step = px[36, 41] - px[36, 40]
    assert step < 0
    columns, rows = np.meshgrid(np.arange(96) - 47.5, np.arange(72) - 35.5)
    assert_close(px[hit], step * columns[hit], atol=1e-12)
    assert_close(pz[hit], step * rows[hit], atol=1e-12)
    assert_close(py[hit], np.sqrt(4 - px[hit] ** 2 - pz[hit] ** 2), atol=1e-7)
    assert_close(image.depth[hit] + py[hit], np.full(hit.sum(), image.depth[36, 41] + py[36, 41]), atol=1e-12)
    assert_close(image.normal[hit], image.points[hit] / 2, atol=1e-9)
    assert_close(image.curvature[hit], np.full((hit.sum(), 2), 0.5), atol=1e-9)
    radius = np.hypot(step * columns, step * rows)
    assert (hit == (radius < 2))[np.abs(radius - 2) > 1e-3].all()
    assert np.isinf(image.depth[~hit]).all()
    assert np.isnan(image.normal[~hit]).all()


def test_a_ball_in_perspective_is_where_it_is():
    eye = Camera(0, 90, field_of_view=40, target=(0, 0, 0), distance=10)
    image = rsym.render(BALL, camera=eye, size=SMALL)
    slope = 2 * np.tan(np.radians(20)) / 72
    columns, rows = np.meshgrid(np.arange(96) - 47.5, np.arange(72) - 35.5)
    way = np.stack([-slope * columns, -np.ones_like(columns), -slope * rows], axis=-1)
    way /= np.linalg.norm(way, axis=-1)[..., None]
    middle = -10 * way[..., 1]  # along the ray, where it is nearest to the middle
    square = middle**2 - 96
    depth = np.where(square > 0, middle - np.sqrt(np.maximum(square, 0)), np.inf)
    clear = np.abs(square) > 1e-3
    assert (np.isinf(depth) == np.isinf(image.depth))[clear].all()
    hit = clear & (image.leaf >= 0)
    assert_close(image.depth[hit], depth[hit], atol=1e-6)
    origins, ways = image.rays
    assert_close(ways, way, atol=1e-12)
    assert_close(origins[hit], np.broadcast_to([0.0, 10.0, 0.0], (hit.sum(), 3)), atol=1e-12)


def test_a_torus_is_hit_at_the_first_root_of_its_quartic():
    image = rsym.render(TORUS, camera="front-left", size=(32, 24))
    origins, ways = (array.reshape(-1, 3) for array in image.rays)
    depth = image.depth.ravel()
    for o, d, t in zip(origins[::7], ways[::7], depth[::7], strict=True):
        # (|p|^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + y^2)
        p = np.polynomial.Polynomial([o @ o + 4 - 0.49, 2 * o @ d, 1.0])
        flat = np.polynomial.Polynomial([o[:2] @ o[:2], 2 * o[:2] @ d[:2], d[:2] @ d[:2]])
        roots = (p**2 - 16 * flat).roots()
        real = np.sort(roots[np.abs(roots.imag) < 1e-9].real)
        if np.isfinite(t):
            assert np.abs(real - t).min() < 1e-6
        assert np.isinf(t) or len(real) == 0 or abs(real[0] - t) < 1e-6
        assert np.isfinite(t) or len(real) == 0
    hit = image.leaf >= 0
    px, py, pz = image.points[hit].T
    rho = np.hypot(px, py)
    middle = np.stack([2 * px / rho, 2 * py / rho, 0 * pz], axis=1)
    assert_close(image.normal[hit], (image.points[hit] - middle) / 0.7, atol=3e-5)


@pytest.mark.parametrize("name", VIEWS)
def test_a_place_and_its_ray_are_inverse_to_each_other(name):
    angles = VIEWS[name]
    for eye in (Camera(*angles), Camera(*angles, field_of_view=50, zoom=1.5), Camera(*angles, up=(1, 2, 3))):
        view = eye.frame(np.array([[-2.0, -1.0, -1.0], [3.0, 1.0, 1.0]]), (60, 40))
        columns, rows = np.array([0.0, 59.0, 17.25]), np.array([0.0, 39.0, 5.5])
        origins, ways = view.rays(columns, rows)
        places, depth = view.project(origins + np.array([[3.0], [4.0], [5.0]]) * ways)
        assert_close(places, np.stack([columns, rows], axis=1), atol=1e-9)
        assert_close(depth, np.array([3.0, 4.0, 5.0]), atol=1e-9)


@pytest.mark.parametrize(
    ("name", "seen", "right", "up"),
    [
        ("front", "+y", "-x", "+z"),
        ("rear", "-y", "+x", "+z"),
        ("left", "-x", "-y", "+z"),
        ("right", "+x", "+y", "+z"),
        ("top", "+z", "+x", "+y"),
        ("bottom", "-z", "+x", "-y"),
    ],
)
def test_names_say_from_where_a_body_that_drives_along_y_is_seen(name, seen, right, up):
    directions = {
        f"{sign}{axis}": s * np.eye(3)["xyz".index(axis)] for s, sign in ((1, "+"), (-1, "-")) for axis in "xyz"
    }
    assert_close(Camera.named(name).axes, np.array([directions[one] for one in (right, up, seen)]), atol=1e-12)


@pytest.mark.parametrize(("shape", "area"), [(BALL, lambda axes: 4 * np.pi), (BOX, lambda axes: None)])
def test_coverage_is_the_area_of_the_projection(shape, area):
    image = rsym.render(shape, camera=Camera(25, 40), size=(160, 120), lines=False, background=None)
    towards = image.view.axes[2]
    exact = area(image.view.axes) or float(np.abs(towards) @ [2, 4, 8])
    found = np.asarray(image)[..., 3].sum() / 255 * image.view.pixel**2
    counted = (image.leaf >= 0).sum() * image.view.pixel**2
    assert abs(found - exact) < 4e-4 * exact
    assert abs(counted - exact) < 5e-3 * exact


def test_samples_change_pixels_beside_edges_alone():
    once, four = (rsym.render(BOX, size=SMALL, lines=False, samples=count) for count in (1, 4))
    caster = Caster(BOX)
    sight = Sight.of_pixels(once.view, once.hits)
    edges = edges_of(sight, (72, 96), Scene(caster, once.view, ()).look)
    changed = np.flatnonzero((np.asarray(once) != np.asarray(four)).any(axis=-1))
    assert changed.size > 50
    assert np.isin(changed, edges.pixels).all()
    sixteen = rsym.render(BOX, size=SMALL, lines=False, samples=16, background=None)
    exact = float(np.abs(once.view.axes[2]) @ [2, 4, 8])
    assert abs(np.asarray(sixteen)[..., 3].sum() / 255 * once.view.pixel**2 - exact) < 2e-3 * exact


def test_the_number_of_threads_changes_nothing():
    one, two = (np.asarray(rsym.render(TORUS, size=SMALL, colour_by="zebra", threads=count)) for count in (1, 2))
    assert (one == two).all()


def test_edges_of_a_box_lie_on_its_edges():
    view = framed(Caster(BOX), Camera(25, 40), (160, 120))
    caster = Caster(BOX)
    scene = Scene(caster, view, ())
    sight = Sight.of_pixels(view, caster.look(view.pencil))
    edges = edges_of(sight, (120, 160), scene.look)
    row, column = np.divmod(edges.first, 160)
    right = edges.second == edges.first + 1
    places = np.stack([column + right * edges.place, row + ~right * edges.place], axis=1)
    corners = np.array([[sx * 2, sy * 1, sz * 0.5] for sx in (-1, 1) for sy in (-1, 1) for sz in (-1, 1)])
    projected, _ = view.project(corners)
    nearest = np.full(len(places), np.inf)
    for a in range(8):
        for b in range(a):
            if (corners[a] != corners[b]).sum() == 1:
                way = projected[b] - projected[a]
                share = np.clip((places - projected[a]) @ way / (way @ way), 0, 1)
                nearest = np.minimum(nearest, np.linalg.norm(places - projected[a] - share[:, None] * way, axis=1))
    assert len(places) > 500
    assert np.quantile(nearest, 0.9) < 1 / 8
    # A ray meets what it passes within a quarter of a pixel; at a corner three edges meet between two pixels.
    assert np.quantile(nearest, 0.98) < 1 / 4
    assert nearest.max() < 1 / 2
    assert np.quantile(nearest, 0.2) < 1e-4  # where faces meet, tangent planes do


def test_ink_is_a_line_of_its_width_about_the_edge():
    image = rsym.render(BALL, camera="top", size=(160, 120))
    radius = 2 / image.view.pixel
    columns, rows = np.meshgrid(np.arange(160) - 79.5, np.arange(120) - 59.5)
    away = np.abs(np.hypot(columns, rows) - radius)
    bare = rsym.render(BALL, camera="top", size=(160, 120), lines=False)
    darker = np.asarray(bare).astype(int)[..., 2] - np.asarray(image)[..., 2]
    assert darker[away < 0.2].min() > 40
    assert not darker[away > 1.2].any()
    scene = Scene(Caster(BALL), image.view, ())
    edges = edges_of(Sight.of_pixels(image.view, image.hits), (120, 160), scene.look)
    for width in (1.0, 2.0, 3.0):
        _, share = inked(edges, width)
        assert abs(share.sum() - 2 * np.pi * radius * width) < 0.02 * 2 * np.pi * radius * width


def test_an_edge_across_two_pixels_shares_them():
    edges = dataclasses.replace(
        edges_of(Sight.of_pixels(*_nothing()), (1, 3), None),
        first=np.array([0]),
        second=np.array([1]),
        place=np.array([0.2], np.float32),
    )
    light = np.array([[1, 1, 1, 1], [0, 0, 0, 0], [0, 0, 0, 0]], np.float32)
    pixels, shown = smoothed(edges, light)
    assert pixels.tolist() == [0]
    assert_close(shown[0].astype(float), np.full(4, 0.7), atol=1e-6)


def _nothing():
    view = Camera().frame(np.array([[90.0, 90, 90], [91, 91, 91]]), (3, 1))
    return view, Caster(BALL).look(view.pencil)


def test_a_picture_shows_something():
    """Red proof: one flat colour is caught."""

    def lively(pixels):
        return len(np.unique(pixels[..., :3].reshape(-1, 3), axis=0)) > 40

    assert lively(np.asarray(rsym.render(BALL, size=SMALL)))
    assert not lively(np.full((72, 96, 4), 255, np.uint8))


def test_a_transparent_picture_has_no_background():
    image = rsym.render(BALL, size=SMALL, background=None)
    alpha = np.asarray(image)[..., 3]
    assert alpha[0, 0] == 0
    assert alpha[36, 48] == 255
    inside = image.leaf >= 0
    assert (alpha[inside] > 0).all()
    white = np.asarray(rsym.render(BALL, size=SMALL))
    full = alpha == 255
    assert (np.asarray(image)[full] == white[full]).all()
    assert (white[..., 3] == 255).all()
    black = np.asarray(rsym.render(BALL, size=SMALL, background="black"))
    assert (black[0, 0] == [0, 0, 0, 255]).all()


@pytest.mark.slow
def test_parts_have_the_colours_of_meshes():
    both = (BALL | rsym.box(1, 1, 6).named("post")).replace(bounds=((-3, 3), (-3, 3), (-4, 4)))
    image = rsym.render(both, camera="front", size=SMALL, colour_by="part", lines=False)
    assert image.parts == dict(zip(("ball", "post"), PALETTE, strict=False))
    assert [name for name in image.parts] == list(rsym.plot_mesh(rsym.mesh(both, 16), colour_by="part").parts)
    places, _ = image.view.project(np.array([[1.0, 1.0, 0.0], [0.0, 0.5, 2.8]]))
    for (column, row), name in zip(np.rint(places).astype(int), ("ball", "post"), strict=True):
        assert list(image.parts)[image.part[row, column]] == name
        light = decode(np.asarray(image)[row, column, :3] / 255)
        # Light scales a colour and adds a white highlight: the ratio of differences is that of the part.
        own = linear(image.parts[name])
        assert abs((light[0] - light[2]) / (light[1] - light[2]) - (own[0] - own[2]) / (own[1] - own[2])) < 0.15
    assert image.part[0, 0] == -1
    assert image.leaves[image.leaf[36, 48]] == "ball"


def test_a_section_is_flat_hatched_and_faces_the_eye():
    image = rsym.render(BALL, camera=Camera(0, 20), size=SMALL, section={x: 0.5}, lines=False)
    cap = image.leaf == len(image.leaves) - 1
    assert image.leaves[-1] == "section x = 0.5"
    assert cap.sum() > 200
    assert_close(image.points[cap][:, 0], np.full(cap.sum(), 0.5), atol=1e-9)
    assert (np.linalg.norm(image.points[cap], axis=1) < 2 + 1e-9).all()
    assert_close(image.normal[cap], np.broadcast_to([1.0, 0.0, 0.0], (cap.sum(), 3)), atol=1e-9)
    # What is kept lies behind the plane; the cut is a disc.
    assert image.points[image.leaf >= 0][:, 0].max() < 0.5 + 1e-9
    area = np.pi * (4 - 0.25) * np.cos(np.radians(20))
    assert abs(cap.sum() * image.view.pixel**2 - area) < 0.02 * area
    colours = decode(np.asarray(image)[cap][:, :3] / 255)
    way = linear(HATCH) - linear(CAP)
    share = (colours - linear(CAP)) @ way / (way @ way)
    inner = np.abs(colours - linear(CAP) - share[:, None] * way).max(axis=1) < 0.01
    assert inner.mean() > 0.95  # all but those on the rim
    assert share.min() < 0.02
    assert share.max() > 0.6
    assert image.part[cap].max() == -1
    behind = rsym.render(BALL, camera=Camera(0, 200), size=SMALL, section={"x": 0.5})
    assert behind.points[behind.leaf >= 0][:, 0].min() > 0.5 - 1e-9


def test_two_sections_leave_a_quarter():
    image = rsym.render(BALL, camera=Camera(20, 40), size=SMALL, section={x: 0, y: 0})
    seen = image.points[image.leaf >= 0]
    assert seen[:, :2].max() < 1e-9
    assert {"section x = 0", "section y = 0"} <= {image.leaves[leaf] for leaf in np.unique(image.leaf) if leaf >= 0}


def test_lines_of_a_hatch_are_as_far_apart_everywhere():
    rows, columns = np.mgrid[:200.0, :300.0]
    light = hatched(columns.ravel(), rows.ravel(), (300, 200)).reshape(200, 300, 3)
    assert (light[1:, :-1] == light[:-1, 1:]).all()
    assert 0.1 < (light[..., 2].mean() - linear(CAP)[2]) / (linear(HATCH)[2] - linear(CAP)[2]) < 0.3


@pytest.mark.slow
def test_shadows_are_where_the_lamp_is_hidden():
    stone, table = rsym.sphere(0.5, (0, 0, 1.5)), rsym.box(6, 6, 0.4)
    shape = (stone | table).replace(bounds=((-3.1, 3.1), (-3.1, 3.1), (-0.3, 2.1)))
    image = rsym.render(shape, camera="top", size=(120, 120))
    sight = Sight.of_pixels(image.view, image.hits)
    scene = Scene(Caster(shape), image.view, ())
    shade = shade_of(sight, 6.2, scene._hidden)
    points = sight.points_at(slice(None))
    flat = np.abs(points[:, 2] - 0.2) < 1e-6
    lamp = KEY @ image.view.axes
    lamp /= np.linalg.norm(lamp)
    to_stone = np.array([0, 0, 1.5]) - points
    distance = np.linalg.norm(to_stone, axis=1)
    angle = np.arccos(np.clip(to_stone @ lamp / distance, -1, 1))
    radius, width = np.arcsin(np.minimum(0.5 / distance, 1.0)), np.arctan(LAMP) + 0.06
    dark, clear = flat & (angle + width < radius), flat & (angle > radius + width)
    assert dark.sum() > 20
    assert clear.sum() > 5000
    # The mean reaches four pixels beyond the shadow's border.
    assert shade.key[dark].max() < 0.05
    assert shade.key[clear].min() > 0.9
    assert 0 < shade.sky[flat].min() < 0.95
    lit, shaded = (np.asarray(rsym.render(shape, camera="top", size=(120, 120), shadows=on)) for on in (False, True))
    place = sight.met[np.flatnonzero(dark)[0]]
    assert shaded.reshape(-1, 4)[place, 0] < lit.reshape(-1, 4)[place, 0] - 20


def test_a_ball_alone_has_no_shadow():
    image = rsym.render(BALL, size=(48, 36))
    shade = shade_of(Sight.of_pixels(image.view, image.hits), 4.0, Scene(Caster(BALL), image.view, ())._hidden)
    assert shade.key.min() == shade.sky.min() == 1


def test_maps_have_the_colours_of_their_values():
    image = rsym.render(TORUS, camera="top", size=SMALL, colour_by="gaussian_curvature", lines=False)
    assert image.scale_label.startswith("Gaussian")
    low, high = image.scale.get_clim()
    assert low == -high
    k1, k2 = np.moveaxis(image.curvature, -1, 0)
    curvature = k1 * k2
    red = np.asarray(image)[..., 0].astype(int) - np.asarray(image)[..., 2]
    assert (red[curvature > 0.4 * high] > 0).all()
    assert (red[curvature < -0.4 * high] < 0).all()
    normal = np.asarray(rsym.render(BALL, camera="top", size=SMALL, colour_by="normal", lines=False))
    assert np.abs(normal[36, 48, :3] - np.array([128, 128, 255.0])).max() < 6


def test_what_is_undecided_is_painted_and_told():
    body = rsym.sphere(1) - rsym.sphere(1 - 1e-13)  # a wall of roundings
    with pytest.warns(RsymWarning, match="undecided, painted magenta"):
        image = rsym.render(body, camera="top", size=SMALL)
    assert image.undecided[36, 48]
    assert np.abs(decode(np.asarray(image)[36, 48, :3] / 255) - linear(SIGNAL)).max() < 0.01
    assert f"{image.undecided.sum()} rays undecided" in image.status


def test_nothing_in_sight_warns():
    away = rsym.sphere(1, (9, 9, 9)).replace(bounds=((-1, 1),) * 3)
    with pytest.warns(rsym.RsymWarning, match="nothing of the body"):
        image = rsym.render(away, size=(16, 12))
    assert np.isinf(image.depth).all()


def test_a_picture_is_written_whole_and_reads_back(tmp_path):
    image = rsym.render(BALL, size=SMALL)
    path = rsym.write(image, tmp_path / "ball.png")
    read = np.rint(255 * readers.imread(path)).astype(np.uint8)
    assert (read == np.asarray(image)[..., : read.shape[-1]]).all()
    assert image.save(tmp_path / "again.png").read_bytes() == path.read_bytes()
    clear = rsym.render(BALL, size=SMALL, background=None)
    again = np.rint(255 * readers.imread(io.BytesIO(clear._repr_png_()))).astype(np.uint8)
    assert (again == np.asarray(clear)).all()
    with pytest.raises(rsym.RsymError, match=r"\.png"):
        rsym.write(image, tmp_path / "ball.stl")
    with pytest.raises(rsym.RsymError, match="a picture takes no options, got unit"):
        rsym.write(image, tmp_path / "ball.png", unit="mm")
    assert np.array(image, np.float32).dtype == np.float32


def test_a_drawn_picture_stands_in_the_coordinates_of_the_model():
    image = rsym.render(BALL, camera="front", size=SMALL)
    artist = rsym.plot_image(image)
    left, right, low, high = artist.get_extent()
    assert artist.axes.get_xlabel() == "$x$"
    assert artist.axes.get_ylabel() == "$z$"
    assert left > 2 > -2 > right
    assert low < -2 < 2 < high
    column = np.flatnonzero((image.leaf >= 0).any(axis=0))[0]
    assert abs(left + (column + 0.5) * (right - left) / 96 - 2) < image.view.pixel
    slanted = rsym.plot_image(rsym.render(BALL, size=SMALL, colour_by="mean_curvature"))
    assert not slanted.axes.axison
    assert len(slanted.figure.axes) == 2
    named = rsym.plot_image(rsym.render(BALL, size=SMALL, colour_by="part"))
    assert [text.get_text() for text in named.figure.legends[0].get_texts()] == ["ball"]
    with pytest.raises(rsym.RsymError, match="Image"):
        rsym.plot_image(np.zeros((3, 3)))


REFUSED = {
    "plane": (lambda: rsym.render(rsym.disc()), "dimension", "revolve"),
    "view": (lambda: rsym.render(BALL, camera="frnt"), "camera", "front"),
    "camera": (lambda: rsym.render(BALL, camera=3), "camera", "front-left"),
    "colouring": (lambda: rsym.render(BALL, colour_by="curvature"), "colour-by", "curvature"),
    "size": (lambda: rsym.render(BALL, size=(0, 10)), "size", "1600"),
    "one side": (lambda: rsym.render(BALL, size=300), "size", "1600"),
    "half a pixel": (lambda: rsym.render(BALL, size=(10.5, 10)), "size", "1600"),
    "too many": (lambda: rsym.render(BALL, size=(10**5, 10**5)), "size", "smaller"),
    "section": (lambda: rsym.render(BALL, section={x: 4}), "section", "x: 0"),
    "coordinate": (lambda: rsym.render(BALL, section={"t": 0}), "section", ""),
    "no mapping": (lambda: rsym.render(BALL, section=0), "section", "x: 0"),
    "samples": (lambda: rsym.render(BALL, samples=3), "samples", "4"),
    "background": (lambda: rsym.render(BALL, background="paper"), "colour", ""),
    "letter": (lambda: rsym.render(BALL, letters={"r": 1}), "unknown-letter", ""),
    "field of view": (lambda: Camera(field_of_view=200), "camera", "field_of_view"),
    "distance": (lambda: Camera(distance=3), "camera", "field_of_view"),
    "zoom": (lambda: Camera(zoom=0), "camera", "zoom"),
    "up": (lambda: Camera(90, 0, up=(0, 0, 1)), "camera", "up"),
    "target": (lambda: Camera(target=(0, 0)), "camera", "target"),
    "elevation": (lambda: Camera("high"), "camera", "elevation"),
    "axes with a target": (lambda: rsym.plot_mesh(BALL, camera=Camera(target=(0, 0, 0))), "camera", "render"),
    "edges of a shape": (lambda: rsym.plot_mesh(BALL, edges=True), "mesh", "rsym.mesh"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_makes_no_picture_is_refused(case):
    call, code, remedy = REFUSED[case]
    with pytest.raises(rsym.RsymError) as caught:
        call()
    assert caught.value.code == code
    assert remedy in caught.value.remedy


def test_without_bounds_the_extent_is_found():
    image = rsym.render(rsym.sphere(2), size=SMALL)
    assert abs((image.leaf >= 0).sum() * image.view.pixel**2 - 4 * np.pi) < 0.1
    with pytest.raises(rsym.RsymError, match="goes on"):
        rsym.render(rsym.cylinder(1), size=SMALL)


@pytest.mark.random
@pytest.mark.parametrize("eye", [None, "front-left", Camera(20, 30, field_of_view=50), Camera(20, 30, up=(0, 1, 1))])
def test_a_shape_on_axes_is_where_the_axes_have_it(eye):
    """The projection of mplot3d, asked itself, is the oracle."""

    from rsym.output.castings import view_of

    artist = rsym.plot_mesh(BOX, camera=eye)
    axes = artist.axes
    view = view_of(axes, artist.points, (100, 80), np.array([7, 13]), 2.0)
    points = np.random.default_rng(1).uniform(-1, 1, (6, 3))
    expected = (project(axes, points)[:, :2] - axes.bbox.min) * 2.0 - [7, 13] - 0.5
    expected[:, 1] = 79 - expected[:, 1]
    assert_close(view.project(points)[0], expected, atol=1e-9)
    if isinstance(eye, Camera):
        assert_close(view.axes, eye.axes, atol=1e-9)
    _, pixels = artist._picture(axes, 1.0, 1.0)
    assert pixels[..., 3].max() == 255


@pytest.mark.slow
def test_a_shape_and_its_mesh_look_alike():
    pictures = []
    for body in (BALL - rsym.cylinder(1), rsym.mesh(BALL - rsym.cylinder(1), 48)):
        figure = Figure(figsize=(2, 2), dpi=80)
        axes = figure.add_subplot(projection="3d")
        rsym.plot_mesh(body, ax=axes, features=False)
        frame(axes, np.full(3, -2.0), np.full(3, 2.0), 20, 40)
        axes.set_axis_off()
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        pictures.append(np.asarray(canvas.buffer_rgba())[..., :3].astype(float))
    difference = np.abs(pictures[0] - pictures[1]).max(axis=-1)
    assert np.median(difference[pictures[0].min(axis=-1) < 250]) < 3
    assert (difference > 40).mean() < 0.01


def test_a_shape_shows_itself_in_a_notebook():
    assert BALL._repr_html_().startswith("<img")
    assert len(BALL._repr_html_()) < 25_000
    assert not rsym.cylinder(2)._repr_html_().startswith("<img")  # without bounds none is looked for
    assert not rsym.disc()._repr_html_().startswith("<img")
