"""Pictures of patches: what is seen, what is hidden, and in which colours."""

import matplotlib as mpl

mpl.use("Agg")
import numpy as np
import pytest
import sympy as sp
from matplotlib import pyplot as plt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import proj3d
from oracles.closeness import assert_close

import rsym
from rsym import RsymError
from rsym.output.joins import plot_continuity
from rsym.output.parts import PALETTE
from rsym.output.patches import CURVE, NET, POINT, compare_patches, map_values, plot_patches, tessellations
from rsym.output.surfaces import ShadedMesh, plot_mesh
from rsym.output.tessellation import joined
from rsym.sampling.mesh import Mesh
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.meshes import mesh_patches
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.patch import Patch


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")


class Parabola(Patch):
    """z = a (x - 1)**2 over [low, high] x [0, 1]; a floor for a = 0."""

    domain = ((0.0, 1.0), (0.0, 1.0))

    def __init__(self, low=0.0, high=1.0, a=0.0, height=0.0):
        self.low, self.high, self.a, self.height = low, high, a, height

    def evaluate(self, u, v, orders, letters=None):
        u, v = np.broadcast_arrays(np.asarray(u, float), v)
        size, x = self.high - self.low, self.low + (self.high - self.low) * u - 1
        zero = np.zeros_like(u)
        known = {
            (0, 0): (x + 1, v, self.height + self.a * x**2),
            (1, 0): (zero + size, zero, 2 * self.a * x * size),
            (0, 1): (zero, zero + 1, zero),
            (2, 0): (zero, zero, zero + 2 * self.a * size**2),
        }
        return [np.stack(known.get(order, (zero, zero, zero)), axis=-1) for order in orders]


class Dome(Patch):
    """The upper half of the unit sphere, u the longitude, with a pole."""

    domain = ((0.0, 2 * np.pi), (0.0, np.pi / 2))
    closed = (True, False)

    def evaluate(self, u, v, orders, letters=None):
        u, v = np.broadcast_arrays(u, v)
        found = []
        for i, j in orders:
            flat, up = np.cos(v + j * np.pi / 2), np.sin(v + j * np.pi / 2) * (i == 0)
            found.append(np.stack([np.cos(u + i * np.pi / 2) * flat, np.sin(u + i * np.pi / 2) * flat, up], axis=-1))
        return found


def picture(patches, *, azimuth=-60.0, elevation=30.0, **options):
    """The image, a function from points in space to the darkest pixel there, the artist."""
    figure = Figure(figsize=(4, 4), dpi=150)
    axes = figure.add_axes((0, 0, 1, 1), projection="3d")
    axes.set_axis_off()
    artist = plot_patches(patches, ax=axes, azimuth=azimuth, elevation=elevation, **options)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = np.array(canvas.buffer_rgba())[::-1, :, :3] / 255.0

    def at(point):
        x, y = axes.transData.transform(proj3d.proj_transform(*point, axes.get_proj())[:2])
        around = image[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2].reshape(-1, 3)
        return around[around.sum(axis=1).argmin()]

    return image, at, artist


def rgb(colour):
    return np.array(mpl.colors.to_rgb(colour))


class Turned(Patch):
    """Another patch with u and v exchanged: the normal points the other way."""

    def __init__(self, patch):
        self.patch = patch

    domain = property(lambda self: self.patch.domain[::-1])

    def evaluate(self, u, v, orders, letters=None):
        return self.patch.evaluate(v, u, [order[::-1] for order in orders], letters)


EYE = np.array([np.cos(np.pi / 6) / 2, -np.cos(np.pi / 6) * np.sqrt(0.75), 0.5])


@pytest.mark.slow
def test_parameter_lines_are_drawn_where_asked_and_hidden_behind_the_surface():
    dome = Dome()
    places = [(u, v) for u in (1.6, 2.6, 4.4, 5.2) for v in (0.2, 0.5)]
    _, at, _ = picture(dome, lines=([u for u, _ in places], []), edges=False)
    _, bare, _ = picture(dome, lines=0, edges=False)
    facing = [float(dome.normal(*place) @ EYE) for place in places]
    assert min(map(abs, facing)) > 0.15
    assert sum(one > 0 for one in facing) == 4
    for (u, v), towards in zip(places, facing, strict=True):
        darker = bare(dome(u, v)).sum() - at(dome(u, v)).sum()
        assert darker > 0.3 if towards > 0 else abs(darker) < 1e-9, (u, v)
        if towards > 0:
            assert abs(bare(dome(u + 0.2, v)).sum() - at(dome(u + 0.2, v)).sum()) < 1e-9


def test_edges_are_those_of_open_directions_and_none_at_a_pole():
    (part,) = tessellations({"dome": Dome()}, 4, 30, None)
    edges = part.edges()
    assert_close(np.linalg.norm(edges[..., :2], axis=-1), np.ones((len(edges), 2)), atol=1e-12)
    assert_close(edges[..., 2], np.zeros((len(edges), 2)), atol=1e-15)
    assert {0.0, np.pi / 2, np.pi, 3 * np.pi / 2} <= set(part.u)  # four lines in a closed direction


def curvature(x, a):
    """Half that of z = a (x - 1)**2: the mean curvature of the cylinder over it."""
    return a / (1 + (2 * a * (x - 1)) ** 2) ** 1.5


@pytest.mark.slow
def test_where_patches_meet_each_shows_its_own_curvature():
    parts = tessellations({"left": Parabola(0, 1, 0.5), "right": Parabola(1, 3, -0.25)}, 0, 20, None)
    mesh, values = joined(parts), map_values(parts, "mean_curvature")
    x = mesh.vertices[mesh.faces][..., 0]
    assert_close(values, curvature(x, np.array([0.5, -0.25])[mesh.leaf][:, None]), atol=1e-13)
    assert_close(map_values(parts, "k1")[mesh.leaf == 1], np.zeros((800, 3)), atol=1e-13)
    _, at, artist = picture({"left": Parabola(0, 1, 0.5), "right": Parabola(1, 3, -0.25)}, colour_by="mean_curvature")
    low, high = artist.scale.get_clim()
    assert low == -high
    assert 0.45 < high <= 0.5
    red, _, blue = at((0.95, 0.3, 0.00125))
    assert red > blue + 0.2
    red, _, blue = at((1.05, 0.3, -0.000625))
    assert blue > red + 0.1


def test_a_mesh_of_patches_knows_their_curvatures():
    parts = [Parabola(0, 1, 0.5), Parabola(1, 3, -0.25)]
    mesh = mesh_patches(parts, 12)
    x = mesh.vertices[mesh.faces][..., 0]
    expected = curvature(x, np.array([0.5, -0.25])[mesh.leaf][:, None])
    assert_close(mesh.curvatures("mean_curvature"), expected, atol=1e-13)
    assert_close(mesh.curvatures("principal_curvatures")[..., 0], np.maximum(2 * expected, 0), atol=1e-13)
    figure = Figure()
    artist = plot_mesh(mesh, ax=figure.add_subplot(projection="3d"), colour_by="k2")
    low, high = artist.scale.get_clim()
    assert -0.5 <= low < -0.4
    assert high == 0
    with pytest.raises(RsymError, match="needs the equation"):
        plot_mesh(Mesh(mesh.vertices, mesh.faces), ax=figure.add_subplot(projection="3d"), colour_by="k2")


def test_values_at_corners_of_faces_may_jump_where_vertices_are_shared():
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    shared = Mesh(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    figure = Figure(figsize=(3, 3), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1), projection="3d")
    axes.set_axis_off()
    plot_mesh(shared, ax=axes, colour_by=[[0.0] * 3, [1.0] * 3], elevation=90, azimuth=-90)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = np.array(canvas.buffer_rgba())[:, :, :3].reshape(-1, 3)
    colours, counts = np.unique(image, axis=0, return_counts=True)
    flat = colours[counts > 0.05 * len(image)]
    assert len(flat) == 3  # the paper and one colour for each face


@pytest.mark.slow
def test_what_hides_a_net_leaves_it_pale():
    net = np.array([[[x, y, z] for y in (0.5, 0.8)] for x, z in ((0.2, 0.2), (0.5, -0.1), (0.8, 0.2))])
    _, at, artist = picture(Parabola(), net=net, lines=0, edges=False)
    assert_close(at(net[0, 0]), rgb(NET), atol=0.02)
    between = (net[0, 0] + net[0, 1]) / 2
    assert_close(at(between), rgb(NET), atol=0.3)
    hidden = at(net[1, 0])
    assert hidden.sum() > rgb(NET).sum() + 0.4
    assert artist.low[2] == -0.1
    assert artist.high[2] == 0.2
    bare = picture(Parabola(low=0.3, high=0.7), lines=0, points=net)[1]
    assert_close(bare(net[0, 0]), rgb(POINT), atol=0.02)


def test_the_net_of_a_closed_patch_goes_round():
    ring = np.array([[[np.cos(a), np.sin(a), z] for z in (0, 1)] for a in np.arange(4) * np.pi / 2])
    for patch, count in ((Dome(), 4 + 8), (Parabola(), 4 + 6)):
        artist = plot_patches(patch, ax=Figure().add_subplot(projection="3d"), net=ring, lines=0, edges=False)
        assert len(artist.strokes[0].pieces) == count


def test_curves_are_polylines_or_curves_over_their_interval():
    from rsym.surfaces.functions.univariate import Formula
    from rsym.surfaces.symbols import t

    arc = Formula((t, t * 0 + 0.5, 0.4 - (t - 0.5) ** 2), domain=(0, 1))
    _, at, _ = picture(Parabola(), curves=[arc, [[0, 0.1, 0.1], [1, 0.1, 0.1]]], lines=0)
    for point in ((0.25, 0.5, 0.3375), (0.7, 0.1, 0.1)):
        assert_close(at(point), rgb(CURVE), atol=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("colour_by", [None, "patch", "zebra", "gaussian_curvature"])
def test_both_sides_look_alike(colour_by):
    bent = Parabola(0, 2, 0.4)
    first, _, _ = picture(bent, colour_by=colour_by)
    second, _, _ = picture(Turned(bent), colour_by=colour_by)
    different = (np.abs(first - second).max(axis=2) > 0.03).mean()
    assert different < 2e-3


def test_patches_have_colours_and_names():
    _, at, artist = picture({"floor": Parabola(), "roof": Parabola(1, 2, height=0.5)}, colour_by="patch")
    assert dict(artist.parts) == {"floor": PALETTE[0], "roof": PALETTE[1]}
    red, _, blue = at((0.45, 0.45, 0.0))
    assert blue > red
    red, _, blue = at((1.45, 0.45, 0.5))
    assert red > blue


@pytest.mark.slow
def test_edges_have_the_colour_of_their_class_and_the_legend_counts_them():
    u, v = sp.symbols("u v", real=True)
    sides = [(0, 0), (1, 0), (-1, 0), (0, 1)]  # beside the first: a jump of the curvature, a kink, nothing
    bends = {(1, 0): (u - 1) ** 2, (-1, 0): u / 5}
    patches = [ParametricSurface((u, v, bends.get(at, 0)), ((at[0], at[0] + 1), (at[1], at[1] + 1))) for at in sides]
    figure = Figure(figsize=(4, 4), dpi=150)
    axes = figure.add_axes((0, 0, 1, 1), projection="3d")
    axes.set_axis_off()
    artist = plot_continuity(patches, ax=axes, elevation=60, resolution=20)
    assert dict(artist.parts) == {"G0: 1": "#e69f00", "G1: 1": "#56b4e9", "G2: 1": "#0072b2"}
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    image = np.array(canvas.buffer_rgba())[::-1, :, :3] / 255.0
    for colour, point in (("#e69f00", (0, 0.5, 0)), ("#56b4e9", (1, 0.5, 0)), ("#0072b2", (0.5, 1, 0))):
        x, y = axes.transData.transform(proj3d.proj_transform(*point, axes.get_proj())[:2])
        assert_close(image[int(y), int(x)], rgb(colour), atol=0.01)


def test_the_worst_place_of_a_broken_edge_is_marked_and_an_alien_report_is_drawn_as_given():
    u, v = sp.symbols("u v", real=True)
    floors = [Parabola(), ParametricSurface((1 + u, v, v * (2 - v) / 1000))]
    report = continuity_report(floors)
    figure = Figure()
    artist = plot_continuity(floors, report, ax=figure.add_subplot(projection="3d"), resolution=8)
    assert dict(artist.parts) == {"broken: 1": "#d55e00"}
    dots = [stroke.pieces for stroke in artist.strokes if (stroke.pieces[:, 0] == stroke.pieces[:, 1]).all()]
    assert_close(dots[-1][0, 0], [1.0, 1.0, 0.0005], atol=6e-4)


@pytest.mark.slow
def test_an_exploration_follows_the_letters_of_all_patches_in_one_box():
    pytest.importorskip("ipywidgets")
    u, v, k, m = sp.symbols("u v k m", real=True)
    slopes = [
        ParametricSurface((u, v, k * u), letters={k: rsym.Letter(1, minimum=0, maximum=2)}),
        ParametricSurface((u + 1, v, k + m * u), letters={k: rsym.Letter(1, minimum=0, maximum=2), m: 0.5}),
    ]
    widget = rsym.explore_patches(slopes, resolution=6)
    assert list(widget.letters) == ["k", "m"]
    (body,) = widget.figure.axes[0].artists
    assert_close(body.high, [2, 1, 1.5], atol=1e-12)
    widget.set_letters({"k": 2, "m": 0})
    widget.colours.value = "zebra"
    (body,) = widget.figure.axes[0].artists
    assert_close(body.high, [2, 1, 2], atol=1e-12)
    first, picture = widget.figure.axes[0].get_zlim(), widget.picture.value
    widget.letters["k"].value = 0.5
    assert widget.figure.axes[0].get_zlim() == first  # the box of what was drawn before
    assert widget.picture.value != picture
    assert widget.message.value == ""
    with pytest.raises(RsymError, match="no letter 'n'"):
        widget.set_letters({"n": 1})


def test_letters_reach_the_patches_that_have_them():
    u, v, k = sp.symbols("u v k", real=True)
    patches = [ParametricSurface((u, v, k * u), letters={k: 1}), Parabola()]
    artist = plot_patches(patches, ax=Figure().add_subplot(projection="3d"), letters={"k": 3}, resolution=4)
    assert artist.high[2] == 3
    with pytest.raises(RsymError, match="no letter 'n'"):
        plot_patches(patches, ax=Figure().add_subplot(projection="3d"), letters={"n": 3})


def test_a_comparison_has_one_scale_for_each_row_and_one_column_for_each_surface():
    surfaces = {"flat": Parabola(0, 2, 0.1), "bent": Parabola(0, 2, 1.0)}
    figure = compare_patches(surfaces, colour_by=("mean_curvature", "zebra"), resolution=30, figure=Figure())
    bodies = [artist for ax in figure.axes for artist in ax.artists if isinstance(artist, ShadedMesh)]
    limits = [body.scale.get_clim() for body in bodies if body.scale is not None]
    assert len(bodies) == 4
    assert len(limits) == 2
    assert limits[0] == limits[1]
    assert 0.9 < limits[0][1] <= 1.0
    assert [text.get_text() for text in figure.texts] == ["flat", "bent"]
    figure.canvas.draw()
    boxes = [body.get_window_extent() for body in bodies]
    assert not any(a.overlaps(b) for a in boxes for b in boxes if a is not b)
    assert all(box.y1 < text.get_window_extent().y0 for box in boxes for text in figure.texts)


def test_one_map_is_given_by_its_name():
    figure = compare_patches(
        {"flat": Parabola(), "bent": Parabola(a=0.5)}, colour_by="zebra", resolution=8, figure=Figure()
    )
    assert len([artist for ax in figure.axes for artist in ax.artists if isinstance(artist, ShadedMesh)]) == 2
    with pytest.raises(RsymError, match="no map 'stripes'"):
        compare_patches({"flat": Parabola()}, colour_by="stripes", resolution=8, figure=Figure())


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"colour_by": "twist"}, "no map 'twist'"),
        ({"lines": ([0.5], [1.5])}, r"parameters in \[0, 1\]"),
        ({"net": [[0, 0, 0], [1, 0, 0]]}, r"a net is an array of the shape \(r, s, 3\), got \(2, 3\)"),
        ({"points": [1.0, 2.0]}, "points is an array"),
        ({"curves": [[[0, 0, np.nan], [1, 0, 0]]]}, "a curve must be finite"),
    ],
)
def test_refusals(options, words):
    with pytest.raises(RsymError, match=words):
        plot_patches(Parabola(), ax=Figure().add_subplot(projection="3d"), **options)


def test_what_is_no_patch_is_refused():
    for given in ([], {}, [Parabola(), 3]):
        with pytest.raises(RsymError, match="expected a Patch or several"):
            plot_patches(given)
    u, v = sp.symbols("u v", real=True)
    with pytest.raises(RsymError, match="patch 2 is not finite"):
        plot_patches([Parabola(), ParametricSurface((u, v, 1 / u))])
    with pytest.raises(RsymError, match="3D axes"):
        plot_patches(Parabola(), ax=Figure().add_subplot())
