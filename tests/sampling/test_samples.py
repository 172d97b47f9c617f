"""Random points of a shape: truly uniform, on the boundary to rounding, the same for the same seed."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy import integrate, special, stats

import rsym
from rsym import RsymError, x, y, z

LIKELY = 1e-3  # a p-value below this fails; seeds are fixed
RING = rsym.disc(2).named("rim") - rsym.disc(1).named("hole")
N = 20_000


def uniform(values, low=0.0, high=1.0):
    """The p-value of Kolmogorov and Smirnov of values that ought to be uniform."""
    return stats.kstest((np.asarray(values) - low) / (high - low), "uniform").pvalue


def angle(points):
    return (np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi)) % 1


# inside


def test_a_ring_inside():
    points = rsym.sample(RING, N, rng=1).points
    assert points.shape == (N, 2)
    assert RING.contains(*points.T).all()
    assert uniform((points**2).sum(axis=1), 1, 4) > LIKELY
    assert uniform(angle(points)) > LIKELY


def test_a_ball_inside_and_a_thin_shell():
    points = rsym.sample(rsym.sphere(1), N, rng=2).points
    radius = np.linalg.norm(points, axis=1)
    assert uniform(radius**3) > LIKELY
    assert uniform(points[:, 2] / radius, -1, 1) > LIKELY
    shell = rsym.sphere(1) - rsym.sphere(0.999)
    points = rsym.sample(shell, 2000, rng=2).points
    assert uniform(np.linalg.norm(points, axis=1) ** 3, 0.999**3, 1) > LIKELY


def test_cells_of_a_body_are_hit_in_proportion_to_their_volume():
    """Chi squared of a cuboid with a drilled hole, its cells measured by counting a fine grid of their own."""
    body = rsym.box(2, 2, 2) - rsym.cylinder(0.5)
    points = rsym.sample(body, N, rng=3, bounds=((-1.5, 1.5),) * 3).points
    fine = (np.arange(480) + 0.5) / 240 - 1
    free = (fine[:, None] ** 2 + fine**2 > 0.25).reshape(4, 120, 4, 120).sum(axis=(1, 3)).ravel()
    expected = np.repeat(free / free.sum(), 4) / 4 * N
    cell = np.floor((points + 1) * 2).astype(int)
    seen = np.bincount(cell[:, 0] * 16 + cell[:, 1] * 4 + cell[:, 2], minlength=64)
    assert stats.chisquare(seen, expected).pvalue > LIKELY


def test_bounds_clip_what_goes_on():
    half = rsym.Shape(x, (x, y))
    with pytest.raises(RsymError, match="goes on"):
        rsym.sample(half, 10)
    points = rsym.sample(half, 2000, bounds=((-1, 3), (0, 2)), rng=4).points
    assert uniform(points[:, 0], 0, 3) > LIKELY
    assert uniform(points[:, 1], 0, 2) > LIKELY


@pytest.mark.random
@pytest.mark.parametrize(
    ("shape", "said"),
    [
        (rsym.Shape(x**2 + y**2 - 1, (x, y)), "goes on without end"),
        (rsym.Shape(-1 - x**2 - y**2, (x, y)), "empty"),
        (rsym.Shape(-1 - x**2 - y**2, (x, y), bounds=((-1, 1), (-1, 1))), "empty"),
        (rsym.Shape(-(x**2) - y**2, (x, y), bounds=((-1, 1), (-1, 1))), r"no point|empty"),
        (rsym.Shape(sp.sqrt(-1 - x**2) + 0 * y, (x, y), bounds=((-1, 1), (-1, 1))), r"no point|empty"),
    ],
    ids=["complement", "empty", "empty in bounds", "a point", "undefined"],
)
def test_what_has_no_inside_is_refused(shape, said):
    with pytest.raises(RsymError, match=said):
        rsym.sample(shape, 10)


def test_letters():
    r = sp.Symbol("r", real=True)
    disc = rsym.Shape(r**2 - x**2 - y**2, (x, y), letters={r: 1})
    assert np.hypot(*rsym.sample(disc, 500, letters={"r": 3}, rng=1).points.T).max() > 2
    with pytest.warns(rsym.RsymWarning, match="leaves its bounds"):
        clipped = rsym.sample(disc.replace(bounds=((-1, 1), (-1, 1))), 500, letters={"r": 3}, rng=1).points
    assert uniform(clipped[:, 0], -1, 1) > LIKELY
    rim = rsym.sample(disc, 50, over="boundary", letters={"r": 3}, rng=1).points
    assert_close(np.hypot(*rim.T), np.full(50, 3.0), rtol=1e-12)
    ball = rsym.Shape(r**2 - x**2 - y**2 - z**2, (x, y, z), letters={r: 1})
    skin = rsym.sample(ball, 50, over="boundary", letters={r: 3}, rng=1, resolution=16).points
    assert_close(np.linalg.norm(skin, axis=1), np.full(50, 3.0), rtol=1e-12)


# the boundary in the plane


@pytest.mark.slow
@pytest.mark.parametrize("resolution", [8, 512])
def test_an_ellipse_by_arc_length_on_coarse_lattices_too(resolution):
    ellipse = rsym.Shape(1 - x**2 / 9 - y**2, (x, y))
    found = rsym.sample(ellipse, 20 * N, over="boundary", rng=5, resolution=resolution)
    assert_close(found.points[:, 0] ** 2 / 9 + found.points[:, 1] ** 2, np.ones(20 * N), atol=1e-12)
    slope = found.points * [1 / 9, 1]
    assert_close(found.normals, slope / np.hypot(*slope.T)[:, None], atol=1e-12)
    # Arc length from the end of the short axis: 3 E(t | 8/9).
    t = np.arctan2(found.points[:, 0] / 3, found.points[:, 1])
    assert uniform(special.ellipeinc(t, 8 / 9) / special.ellipe(8 / 9), -2, 2) > LIKELY


def test_sides_of_a_rectangle_and_parts_of_a_ring():
    found = rsym.sample(rsym.rectangle(3, 1), N, over="boundary", rng=6)
    upright = np.abs(found.normals[:, 0]) > 0.5
    assert_close(np.abs(found.points[upright, 0]), np.full(upright.sum(), 1.5), atol=1e-12)
    assert_close(np.abs(found.points[~upright, 1]), np.full((~upright).sum(), 0.5), atol=1e-12)
    assert stats.binomtest(int(upright.sum()), N, 1 / 4).pvalue > LIKELY
    assert uniform(found.points[~upright, 0], -1.5, 1.5) > LIKELY
    found = rsym.sample(RING, N, over="boundary", rng=6)
    assert stats.binomtest(int((found.parts == "rim").sum()), N, 2 / 3).pvalue > LIKELY
    rim = found.parts == "rim"
    assert_close(np.hypot(*found.points.T), np.where(rim, 2.0, 1.0), rtol=1e-12)
    assert_close(found.normals, found.points * np.where(rim, 0.5, -1)[:, None], atol=1e-12)
    assert uniform(angle(found.points[rim])) > LIKELY
    hole = rsym.sample(RING, 200, over="hole", rng=6)
    assert set(hole.parts.tolist()) == {"hole"}
    assert_close(np.hypot(*hole.points.T), np.ones(200), rtol=1e-12)


def test_a_boundary_that_leaves_the_bounds_ends_there():
    found = rsym.sample(rsym.Shape(y - x, (x, y)), N, over="boundary", bounds=((-1, 3), (0, 2)), rng=7)
    assert uniform(found.points[:, 0], 0, 2) > LIKELY
    assert_close(found.normals, np.full((N, 2), [1, -1]) / np.sqrt(2), atol=1e-12)


# the boundary in space


@pytest.mark.slow
def test_a_torus_by_area_on_a_coarse_mesh():
    found = rsym.sample(rsym.torus(1, 0.4), 5 * N, over="boundary", rng=8, resolution=24)
    ring = np.hypot(*found.points[:, :2].T)
    assert_close((ring - 1) ** 2 + found.points[:, 2] ** 2, np.full(5 * N, 0.16), atol=1e-10)
    assert uniform(angle(found.points)) > LIKELY
    t = np.arctan2(found.points[:, 2], ring - 1)  # the density is that of 1 + 0.4 cos t
    assert uniform(t + 0.4 * np.sin(t), -np.pi, np.pi) > LIKELY
    middle = found.points * (1 - 1 / ring)[:, None] * [1, 1, 0] + found.points * [0, 0, 1]
    assert_close(found.normals, middle / 0.4, atol=1e-9)


@pytest.mark.slow
def test_an_ellipsoid_by_area():
    body = rsym.Shape(1 - x**2 - y**2 - z**2 / 9, (x, y, z))
    points = rsym.sample(body, 5 * N, over="boundary", rng=9, resolution=12).points

    def zone(height):
        return np.sqrt(1 - height**2 / 9) * np.sqrt(1 + height**2 / (9 * (9 - height**2))) if height < 3 else 1 / 3

    area = integrate.quad(zone, 0, 3)[0]
    shares = [integrate.quad(zone, low, low + 0.5)[0] / area for low in np.arange(0, 3, 0.5)]
    seen = np.histogram(np.abs(points[:, 2]), np.arange(0, 3.1, 0.5))[0]
    assert stats.chisquare(seen, np.array(shares) * 5 * N).pvalue > LIKELY


def test_faces_of_a_drilled_box_by_area_and_nothing_in_the_hole():
    body = rsym.box(2, 2, 1).named("box") - rsym.cylinder(0.5).named("drill")
    found = rsym.sample(body, N, over="boundary", rng=10, resolution=24)
    wall = found.parts == "drill"
    areas = np.array([np.pi, 8 + 8 - np.pi / 2])
    # Rims are chords: of faces and wall the square of a cell is missing.
    assert stats.binomtest(int(wall.sum()), N, areas[0] / areas.sum()).pvalue > LIKELY
    assert_close(np.hypot(*found.points[wall, :2].T), np.full(wall.sum(), 0.5), atol=1e-12)
    lid = ~wall & (np.abs(found.normals[:, 2]) > 0.5)
    assert (np.hypot(*found.points[lid, :2].T) >= 0.5 - 1e-8).all()
    assert (np.abs(found.points[wall, 2]) <= 0.5 + 1e-8).all()
    drill = rsym.sample(body, 500, over="drill", rng=10, resolution=24)
    assert_close(drill.normals[:, :2], -2 * drill.points[:, :2], atol=1e-12)
    assert uniform(drill.points[:, 2], -0.5, 0.5) > LIKELY


# what is common


@pytest.mark.random
@pytest.mark.parametrize("over", ["inside", "boundary"])
@pytest.mark.parametrize("shape", [RING, rsym.torus(1, 0.4)], ids=["plane", "space"])
def test_the_same_seed_gives_the_same_points(shape, over):
    first, again, other = (rsym.sample(shape, 100, over=over, rng=seed, resolution=16).points for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    generator = np.random.default_rng(1)
    assert np.array_equal(rsym.sample(shape, 100, over=over, rng=generator, resolution=16).points, first)
    following = rsym.sample(shape, 100, over=over, rng=generator, resolution=16).points
    assert not np.array_equal(following, first)
    assert len(np.unique(rsym.sample(shape, 5, over=over, resolution=16).points, axis=0)) == 5


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "over"), [(RING, "inside"), (RING, "boundary"), (rsym.sphere(1), "inside")])
def test_stratified_points_have_the_same_density_and_vary_less(shape, over):
    means, plain = (
        np.array([rsym.sample(shape, 64, over=over, rng=k, stratified=s, resolution=64).points.mean(axis=0)
                  for k in range(80)])
        for s in (True, False)
    )  # fmt: skip
    assert (means.std(axis=0) < 0.7 * plain.std(axis=0)).all()
    assert (np.abs(means.mean(axis=0)) < 4 * means.std(axis=0) / np.sqrt(80)).all()
    many = rsym.sample(shape, 4000, over=over, rng=1, stratified=True).points
    half = (many[:2000, 0] > 0).sum()  # not in the order of the strata
    assert stats.binomtest(int(half), 2000, 0.5).pvalue > LIKELY
    assert len(np.unique(many, axis=0)) == 4000


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"n": 0}, "positive integer"),
        ({"n": 2.5}, "positive integer"),
        ({"n": 10**13}, "GB of memory.*rng="),
        ({"n": 10**12, "over": "boundary", "stratified": True}, "GB of memory.*rng="),
        ({"over": "rin"}, "did you mean 'rim'"),
        ({"over": "spout"}, "rim"),
        ({"over": None}, "over"),
        ({"rng": "dice"}, "seed"),
        ({"rng": -1}, "seed"),
        ({"letters": {"q": 1}}, "q"),
        ({"bounds": 3}, "bounds"),
        ({"over": "boundary", "resolution": "fine"}, "resolution"),
        ({"over": "boundary", "resolution": 0}, "resolution"),
        ({"over": "boundary", "resolution": np.array([8, 1])}, "resolution"),
    ],
    ids=str,
)
def test_wrong_wishes_are_refused(change, said):
    wishes = {"n": 10} | change
    with pytest.raises(RsymError, match=said):
        rsym.sample(RING, wishes.pop("n"), **wishes)


def test_a_part_that_is_hidden_has_no_boundary():
    shape = rsym.disc(2).named("whole") | rsym.disc(1).named("hidden")
    with pytest.raises(RsymError, match="'hidden' has nothing of the boundary"):
        rsym.sample(shape, 10, over="hidden")
