"""Maps of curvature and zebra stripes: on arrays first, then in the picture."""

import matplotlib as mpl

mpl.use("Agg")
import numpy as np
import pytest
import sympy as sp
from matplotlib import pyplot as plt
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.output.paints import DARK, LIGHT, ROOM, STRIPES, Spots, coat_of, reflected_heights, robust_limits, stripes
from rsym.output.shading import decode, linear
from rsym.sampling.leaf_fields import LeafFields

ELLIPSOID = Shape(1 - x**2 / 9 - y**2 / 4 - z**2, (x, y, z), bounds=((-3.2, 3.2), (-2.2, 2.2), (-1.2, 1.2)))
CAPSULE = Shape(
    1 - y**2 - z**2 - sp.Max(sp.Abs(x) - 1, 0) ** 2, (x, y, z), bounds=((-2.2, 2.2), (-1.2, 1.2), (-1.2, 1.2))
)
CUBIC = Shape(1 - y**2 - z**2 - sp.Max(x - 1, 0) ** 3, (x, y, z))
CAPPED = Shape(sp.Min(1 - y**2 - z**2, 1 - x), (x, y, z))
LEFT_AND_UP = np.array([[0.8, 0.6, 0.0], [-0.3, 0.4, np.sqrt(0.75)], [0.6 * np.sqrt(0.75), -0.8 * np.sqrt(0.75), 0.5]])


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    plt.close("all")


@pytest.fixture(scope="module")
def coarse():
    return rsym.mesh(ELLIPSOID, 16)


def middles(mesh, turn=LEFT_AND_UP):
    """One sample in each triangle, not at its vertices."""
    count = len(mesh.faces)
    weights = np.tile([0.5, 0.3, 0.2], (count, 1))
    shifted = lambda rows, columns: weights + 1e-7 * np.array([rows, columns, -rows - columns])  # noqa: E731
    return Spots(np.arange(count), weights, shifted, np.ones(count, int), turn)


def on_ellipsoid(mesh):
    """The samples moved onto the ellipsoid along the gradient."""
    points = np.einsum("ij,ijk->ik", middles(mesh).weights, mesh.vertices[mesh.faces])
    squares = np.array([9.0, 4.0, 1.0])
    for _ in range(20):
        gradient = -2 * points / squares
        value = 1 - (points**2 / squares).sum(axis=1)
        points = points - (value / (gradient**2).sum(axis=1))[:, None] * gradient
    return points


def gauss(points):
    return 1 / (36 * (points**2 / [81.0, 16.0, 1.0]).sum(axis=1) ** 2)


def test_a_map_is_exact_inside_triangles(coarse):
    coat = coat_of(coarse, coarse.normals, "grey", "gaussian_curvature", ELLIPSOID, None)
    expected = gauss(on_ellipsoid(coarse))
    assert_close(coat.paint(middles(coarse)), decode(coat.scale.to_rgba(expected)[:, :3]), atol=0.03)
    between = gauss(coarse.vertices)[coarse.faces] @ [0.5, 0.3, 0.2]
    assert np.abs(between - expected).max() > 0.25  # what a map of the vertices alone would show
    assert coat.label == "Gaussian curvature $K$"
    assert coat.scale.get_cmap().name == "viridis"
    corners = coarse.vertices[coarse.faces]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    for limit, share in zip(coat.scale.get_clim(), (0.02, 0.98), strict=True):
        assert_close(areas[expected <= limit].sum() / areas.sum(), share, atol=0.005)


@pytest.mark.parametrize(("name", "column"), [("k1", 0), ("k2", 1)])
def test_maps_of_principal_curvatures_and_limits_about_zero(name, column):
    torus = Shape(1 - (sp.sqrt(x**2 + y**2) - 3) ** 2 - z**2, (x, y, z), bounds=((-4.2, 4.2), (-4.2, 4.2), (-1.2, 1.2)))
    mesh = rsym.mesh(torus, 24)
    coat = coat_of(mesh, mesh.normals, "grey", name, torus, None)
    low, high = coat.scale.get_clim()
    if column:
        assert low == -high
        assert coat.scale.get_cmap().name == "coolwarm"
    else:
        assert low < 1 < high  # constant: k1 = 1


@pytest.mark.parametrize(
    ("values", "unit", "limits"),
    [
        ([-3e-17, 2e-17, 1e-16], 1.0, (-1, 1)),  # flat but for rounding
        ([-4.0, 3e-16, 3e-16], 1.0, (-3.84, 0)),
        ([0.5, 0.5, 0.5 + 1e-15], 1.0, (0.25, 0.75)),
        ([1e-20, 2e-20, 3e-20], 0.0, (1.04e-20, 2.96e-20)),
        ([-1.0, 0.0, np.nan, np.inf, 2.0], 0.0, (-1.92, 1.92)),
    ],
)
def test_limits_of_colours(values, unit, limits):
    assert_close(robust_limits(np.array(values), unit), limits, rtol=1e-9, atol=1e-30)


def test_values_of_vertices_are_interpolated_and_nan_is_grey_only_where_no_corner_is_known(coarse):
    values = coarse.vertices[:, 0].copy()
    coat = coat_of(coarse, coarse.normals, "grey", values, None, None)
    points = np.einsum("ij,ijk->ik", middles(coarse).weights, coarse.vertices[coarse.faces])
    assert_close(coat.paint(middles(coarse)), decode(coat.scale.to_rgba(points[:, 0])[:, :3]), atol=0.02)
    values[:] = np.nan
    values[coarse.faces[0, 0]] = 1.0
    painted = coat_of(coarse, coarse.normals, "grey", values, None, None).paint(middles(coarse))
    grey = (painted == linear("#9a9a9a")).all(axis=1)
    assert (grey == ~(coarse.faces == coarse.faces[0, 0]).any(axis=1)).all()


def test_zebra_stripes_are_those_of_the_exact_normals(coarse):
    """On a mesh so coarse that interpolated normals put the stripes elsewhere."""
    points = on_ellipsoid(coarse)
    normal = points / [9.0, 4.0, 1.0]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    facing = (normal @ LEFT_AND_UP.T)[:, 2]
    eye, up = LEFT_AND_UP[2], np.array([0.0, 0.0, 1.0])
    mirrored = 2 * facing[:, None] * normal - eye
    ends = coarse.vertices.min(axis=0), coarse.vertices.max(axis=0)
    room = ROOM * np.linalg.norm(ends[1] - ends[0]) / 2
    start = np.einsum("ij,ijk->ik", middles(coarse).weights, coarse.vertices[coarse.faces]) - sum(ends) / 2
    # Where the ray start + t mirrored meets the sphere, by the roots of a polynomial.
    far = [max(np.roots([1, 2 * a @ b, a @ a - room**2]).real) for a, b in zip(start, mirrored, strict=True)]
    heights = np.arcsin((start + np.array(far)[:, None] * mirrored) @ up / room) * 2 / np.pi
    exact = coat_of(coarse, coarse.normals, "grey", "zebra", ELLIPSOID, None).paint(middles(coarse))
    phase = STRIPES * heights
    clear = np.abs((phase * 2 + 0.5) % 1 - 0.5) > 0.1  # off the borders of stripes
    expected = np.where((phase % 1 < 0.5)[:, None], linear(LIGHT), linear(DARK))
    assert_close(exact[clear], expected[clear], atol=1e-6)
    smooth = coat_of(coarse, coarse.normals, "grey", "zebra", None, None).paint(middles(coarse))
    assert (np.abs(smooth - expected)[clear].max(axis=1) > 0.5).mean() > 0.05


def heights_across(shape, step):
    """Heights of reflections along a meridian across the joint (x, r) = (1, 1), at steps of about that length."""
    along = step * (np.arange(-20, 20) + 0.5)
    behind = along > 0
    length, radius = (1 + along, 1.0) if shape is not CAPPED else (np.where(behind, 1, 1 + along), 1 - along * behind)
    points = np.stack([length, radius * np.full(40, np.cos(0.7)), radius * np.full(40, np.sin(0.7))], axis=1)
    fields = LeafFields(shape)
    gradient = fields.at(fields.active(points), points, 0.1)["gradient"]
    return reflected_heights(-gradient, points / 4, LEFT_AND_UP)


def test_stripes_kink_where_the_curvature_jumps_and_break_where_the_normal_jumps():
    """Value and slope of the stripes' phase on both sides of the joint x = 1, and what they tend to."""
    for shape, jumps, kinks in ((CAPSULE, False, True), (CUBIC, False, False), (CAPPED, True, None)):
        gaps, bends = [], []
        for step in (1e-3, 1e-4):
            heights = heights_across(shape, step)
            slopes = np.diff(heights) / step
            gaps.append(abs(heights[20] - heights[19]))
            bends.append(abs(slopes[21] - slopes[17]))
        assert (gaps[1] > 0.1) == jumps
        if not jumps:
            assert gaps[1] < 0.2 * gaps[0] + 1e-12
        if kinks is not None:
            assert (bends[1] > 0.1) == kinks
            assert (bends[1] > 0.5 * bends[0]) == kinks


def test_stripes_are_antialiased_to_grey():
    phase = np.linspace(-3, 3, 1001)
    assert_close(stripes(phase, np.full(1001, 20.0)), np.full(1001, 0.5), atol=0.03)
    sharp = stripes(phase, np.full(1001, 1e-6))
    assert set(sharp.round(3)) <= {0.0, 0.5, 1.0}
    window = np.linspace(-0.15, 0.15, 3001)
    averaged = [(((p + window) % 1) < 0.5).mean() for p in phase[::50]]
    assert_close(stripes(phase[::50], np.full(21, 0.3)), averaged, atol=1e-3)


def test_the_inside_of_an_open_surface_keeps_its_colour_only_without_a_map(coarse):
    spots = middles(coarse)
    inside = Spots(spots.faces, spots.weights, spots.shifted, -spots.side, spots.turn)
    plain = coat_of(coarse, coarse.normals, "#336699", None, None, None)
    assert_close(plain.paint(spots)[0], linear("#336699"), atol=1e-12)
    assert plain.paint(inside)[0, 0] > plain.paint(inside)[0, 2]
    assert plain.scale is None


@pytest.mark.slow
def test_a_figure_with_its_colour_bar_and_colours_in_the_picture():
    mesh = rsym.mesh(CAPSULE, 40)
    artist = rsym.plot_mesh(mesh, colour_by="k2", shape=CAPSULE, azimuth=-90.0, elevation=0.0)
    figure = artist.get_figure()
    assert [ax.get_ylabel() for ax in figure.axes[1:]] == ["smaller principal curvature $k_2$"]
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    bar = figure.axes[1].get_window_extent()
    image = np.asarray(canvas.buffer_rgba()).astype(int)[:, : int(bar.x0)]
    row = image[image.shape[0] // 2]
    (purple,), (yellow,) = np.nonzero(row[:, 2] > row[:, 1] + 20), np.nonzero(row[:, 0] > row[:, 2] + 60)
    left, right = yellow[yellow < purple.mean()], yellow[yellow > purple.mean()]
    assert min(len(purple), len(left), len(right)) > 50
    # Caps, cylinder, caps, with sharp borders, though a triangle is ten pixels wide.
    assert 0 < purple.min() - left.max() < 5
    assert 0 < right.min() - purple.max() < 5
    assert figure.bbox.x1 >= figure.axes[1].get_tightbbox().x1


def test_given_axes_get_no_colour_bar_and_its_scale_makes_one():
    mesh = rsym.mesh(ELLIPSOID, 12)
    figure = Figure()
    axes = figure.add_subplot(projection="3d")
    artist = rsym.plot_mesh(mesh, ax=axes, colour_by="mean_curvature", shape=ELLIPSOID)
    assert figure.axes == [axes]
    figure.colorbar(artist.scale, ax=axes)
    assert len(figure.axes) == 2


CAN = rsym.cylinder(2) & rsym.slab(-1, 1)
CAN_BOUNDS = ((-2.3, 2.3), (-2.3, 2.3), (-1.3, 1.3))


def test_the_scale_of_a_body_with_edges_is_that_of_its_faces():
    mesh = rsym.mesh(CAN, 24, bounds=CAN_BOUNDS)
    coat = coat_of(mesh, mesh.normals, "grey", "mean_curvature", CAN, None)
    assert_close(coat.scale.get_clim(), [0.0, 0.25], atol=1e-12)
    assert coat.scale.get_cmap().colorbar_extend == "neither"


def test_beside_an_edge_a_map_has_the_colour_of_its_face():
    mesh = rsym.mesh(CAN, 24, bounds=CAN_BOUNDS)
    coat = coat_of(mesh, mesh.normals, "grey", "mean_curvature", CAN, None)
    wall = np.abs(mesh.normals[:, 0, 2]) < 0.5
    expected = decode(coat.scale.to_rgba(np.where(wall, 0.25, 0.0))[:, :3])
    for corner in range(3):
        weights = np.full((len(mesh.faces), 3), 1e-14)
        weights[:, corner] = 1 - 2e-14
        spots = Spots(np.arange(len(mesh.faces)), weights, None, np.ones(len(mesh.faces), int), LEFT_AND_UP)
        assert_close(coat.paint(spots), expected, atol=1e-6)


def test_where_a_leaf_goes_on_as_another_the_seam_is_exact():
    """A wall that a quarter of a torus rounds off, by two leaves that touch: triangles end beside the seam."""
    ring = 1 - (sp.sqrt(x**2 + y**2) - 2) ** 2 - z**2
    low = rsym.conjunction(9 - x**2 - y**2, 1 + z, -z)
    body = Shape(rsym.disjunction(low, rsym.conjunction(ring, z + sp.Rational(1, 2))), (x, y, z))
    mesh = rsym.mesh(body, 24, bounds=((-3.3, 3.3), (-3.3, 3.3), (-1.3, 1.3)))
    mean = LeafFields(body, ("mean_curvature",)).on_faces(mesh)
    faces = np.repeat(np.arange(len(mesh.faces)), 20)
    weights = np.random.default_rng(4).dirichlet(np.ones(3), len(faces))
    found = mean(faces, weights)
    points, radius = found["point"], np.hypot(*found["point"][:, :2].T)
    outside = (radius > 2.9) & (np.abs(points[:, 2]) < 0.4) & (np.abs(points[:, 2]) > 1e-3)
    assert outside.sum() > 1000
    above = points[outside, 2] > 0
    around = 1 - 2 / radius[outside]
    assert_close(found["mean_curvature"][outside], np.where(above, (1 + around) / 2, 1 / 6), atol=1e-6)


def test_limits_that_are_given_are_the_ends_of_the_scale(coarse):
    artist = rsym.plot_mesh(coarse, colour_by="mean_curvature", shape=ELLIPSOID, limits=(0.2, 0.6))
    assert artist.scale.get_clim() == (0.2, 0.6)
    assert artist.scale.get_cmap().colorbar_extend == "both"
    artist = rsym.plot_mesh(coarse, colour_by=coarse.vertices[:, 0], limits=(-2, 2))
    assert artist.scale.get_clim() == (-2, 2)
    for limits in ((1, 1), (2, 1), (0, np.inf), 3, "ab", (1, 2, 3)):
        with pytest.raises(RsymError, match="the smaller first"):
            rsym.plot_mesh(coarse, colour_by="mean_curvature", shape=ELLIPSOID, limits=limits)


@pytest.mark.parametrize(
    ("colour_by", "shape", "words"),
    [
        ("k3", ELLIPSOID, "k1, k2, zebra"),
        ("k1", None, "shape="),
        (np.zeros(3), None, "each of the"),
        ("zebra", Shape(x, (x, y)), "revolve"),
        ("k1", Shape(x, (x, y)), "revolve"),
    ],
)
def test_refusals(coarse, colour_by, shape, words):
    with pytest.raises(RsymError, match=words):
        rsym.plot_mesh(coarse, ax=Figure().add_subplot(projection="3d"), colour_by=colour_by, shape=shape)


def test_planes_and_upright_cylinders_have_more_than_one_stripe():
    """In a room far away a plane mirrors one place, and an upright cylinder one height: pictures of one colour."""
    eye = np.array([0.8, 0.5, 0.33]) / np.linalg.norm([0.8, 0.5, 0.33])
    right = np.array([-eye[1], eye[0], 0.0]) / np.hypot(*eye[:2])
    turn = np.stack([right, np.cross(eye, right), eye])
    along = np.linspace(-0.6, 0.6, 200)
    plane = np.stack([along, 0.6 * along, np.full(200, 0.2)], axis=1)
    upright = np.stack([np.full(200, 0.2), np.full(200, 0.1), along], axis=1)
    for places, normal in ((plane, [0.0, 0.0, 1.0]), (upright, [1.0, 0.3, 0.0])):
        heights = reflected_heights(np.tile(normal, (200, 1)), places, turn)
        assert np.ptp(STRIPES * heights) > 1.5


@pytest.mark.slow
def test_a_map_of_one_value_says_so_on_its_scale():
    box = rsym.mesh(rsym.box(2, 1, 1), 16)
    flat = rsym.plot_mesh(box, colour_by="mean_curvature", shape=rsym.box(2, 1, 1))
    assert flat.scale_label == "mean curvature $H$, 0 everywhere"
    ball = rsym.sphere(2)
    assert rsym.plot_mesh(rsym.mesh(ball, 16), colour_by="k1", shape=ball).scale_label.endswith(", 0.5 everywhere")
    egg = rsym.plot_mesh(rsym.mesh(ELLIPSOID, 16), colour_by="mean_curvature", shape=ELLIPSOID)
    assert egg.scale_label == "mean curvature $H$"
