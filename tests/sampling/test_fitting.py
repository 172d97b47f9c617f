"""Letters from measured points: against exact values, scipy on closed forms, and what noise does."""

import json

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.optimize import least_squares
from scipy.spatial import cKDTree

import rsym
from rsym import x, y, z
from rsym.program.by_letters import LENGTH
from rsym.sampling.boundary_distances import boundary_distances
from rsym.sampling.fitting import LOSSES
from rsym.sampling.silhouettes import lines_of_sight

a, b, c, p, r = sp.symbols("a b c p r", real=True)
SKELETON = {"a": 4.5, "a1": 7.6, "a2": 5.9, "p1": 36.0}
CAR = {"rb": 13.2, "ab": 1.7, "h3": 134.0, "ra": 2.9, "c3": 58.0, "z2": 5.2}
TURN = np.linspace(0, 2 * np.pi, 40, endpoint=False)
CIRCLE = np.stack([np.cos(TURN), np.sin(TURN)], axis=1)
MODELS = [
    (rsym.paper.skeleton_body(), ["a", "a1", "a2", "p1", "p2"]),
    (rsym.load("clip"), None),
    (rsym.paper.car(), list(CAR)),
    (rsym.Shape(rsym.joining(x - a, y * b), (x, y), letters={a: 0.3, b: 2}), ["a", "b"]),
    (rsym.superellipse(2, 1, p, letters={p: 3}), ["p"]),
    (rsym.superellipse(a, 1, p, letters={p: 2.5, a: 2}) & rsym.disc(b, letters={b: 1.5}), ["p", "a", "b"]),
]


def body():
    return rsym.paper.skeleton_body()


def on_body(n, seed=1, noise=0.0):
    found = rsym.sample(body().with_letters(SKELETON), n, over="boundary", rng=seed).points
    return found + np.random.default_rng(seed).normal(scale=noise, size=found.shape)


@pytest.mark.parametrize(("shape", "names"), MODELS, ids=lambda one: "" if isinstance(one, list) else None)
def test_derivatives_by_letters_are_those_of_differences(shape, names):
    names = names or list(shape.letters)
    box = np.array(shape.bounds or ((-3, 3),) * shape.dimension)
    points = np.random.default_rng(5).uniform(*box.T, (300, shape.dimension))
    distances = boundary_distances(shape, names, points, 10.0)
    at = np.array([float(shape.letters[name].default) for name in names])
    value, slopes = distances(at)
    assert np.isfinite(value).all()
    for k, step in enumerate(1e-6 * np.maximum(np.abs(at), 1)):
        moved = np.eye(len(at))[k] * step
        difference = (distances(at + moved)[0] - distances(at - moved)[0]) / (2 * step)
        # Between the two places another leaf may take over.
        wrong = np.abs(difference - slopes[:, k]) > 1e-5 * np.maximum(np.abs(slopes[:, k]), 1)
        assert wrong.mean() < 0.01


def test_a_larger_disc_ends_farther_out():
    points = np.array([[0.5, 2.0], [3.0, 1.0]])
    found = boundary_distances(rsym.disc(a, letters={a: 2}), ["a"], points, 1e6)(np.array([2.0]))[1]
    assert (found > 0).all()


def test_without_noise_the_letters_come_back():
    found = rsym.fit(body(), on_body(200), list(SKELETON))
    assert_close(list(found.letters.values()), list(SKELETON.values()), rtol=1e-11)
    assert found.converged
    assert found.rms < 1e-12
    assert found.shape.letters["p1"].default == found.letters["p1"]
    assert found.evaluations < 15


@pytest.mark.parametrize("seed", [1, 2])
def test_four_letters_of_the_body_from_500_noisy_points(seed):
    found = rsym.fit(body(), on_body(500, seed, 0.01), list(SKELETON))
    for name, value in SKELETON.items():
        assert abs(found.letters[name] - value) < 3 * found.standard_errors[name]
    assert 0.009 < found.rms < 0.011


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
def test_six_letters_of_the_car_from_5000_points_of_a_mesh():
    car = rsym.paper.car()
    vertices = rsym.mesh(car, 128, letters=CAR).vertices
    generator = np.random.default_rng(3)
    points = generator.choice(vertices, 5000, replace=False)
    found = rsym.fit(car, points, list(CAR))
    assert_close(list(found.letters.values()), list(CAR.values()), rtol=1e-10)
    noisy = rsym.fit(car, points + generator.normal(scale=0.01, size=points.shape), list(CAR))
    assert_close(list(noisy.letters.values()), list(CAR.values()), rtol=5e-3)
    assert noisy.converged
    assert 0.009 < noisy.rms < 0.011


def test_a_circle_is_that_of_its_closed_form():
    """ODR of a circle: scipy minimises |p - centre| - r itself."""
    points = 1.7 * CIRCLE + [0.4, -0.2] + np.random.default_rng(2).normal(scale=0.03, size=CIRCLE.shape)
    exact = least_squares(lambda v: np.hypot(*(points - v[:2]).T) - v[2], [0, 0, 1], "3-point", xtol=1e-15)
    disc = rsym.Shape(c - sp.sqrt((x - a) ** 2 + (y - b) ** 2), (x, y), letters={a: 0, b: 0, c: 1})
    found = rsym.fit(disc, points, [a, b, c], length=1e6)
    assert_close(list(found.letters.values()), exact.x, rtol=1e-7, atol=1e-7)
    variance = 2 * exact.cost / (len(points) - 3)
    assert_close(found.covariance, variance * np.linalg.inv(exact.jac.T @ exact.jac), rtol=1e-4, atol=1e-9)


def test_an_ellipse_is_within_second_order_of_the_nearest_one():
    """Orthogonal distances to a dense polygon of the ellipse, by numerical derivatives."""
    points = CIRCLE * [3, 1.2] + np.random.default_rng(4).normal(scale=0.01, size=CIRCLE.shape)
    dense = np.linspace(0, 2 * np.pi, 20_000)

    def distance(v):
        return cKDTree(np.stack([v[0] * np.cos(dense), v[1] * np.sin(dense)], axis=1)).query(points)[0]

    exact = least_squares(distance, [3.0, 1.2], diff_step=1e-4)
    oval = rsym.Shape(1 - x**2 / a**2 - y**2 / b**2, (x, y), letters={a: 2, b: 2})
    found = rsym.fit(oval, points, [a, b])
    assert_close(list(found.letters.values()), exact.x, rtol=3e-4)


@pytest.mark.slow
@pytest.mark.parametrize("loss", LOSSES)
def test_standard_errors_are_the_spread_of_many_fits(loss):
    disc = rsym.Shape(c - sp.sqrt((x - a) ** 2 + (y - b) ** 2), (x, y), letters={a: 0, b: 0, c: 1})
    generator = np.random.default_rng(6)
    found = [
        rsym.fit(disc, CIRCLE + generator.normal(scale=0.02, size=CIRCLE.shape), [a, b, c], loss=loss)
        for _ in range(150)
    ]
    spread = np.std([list(one.letters.values()) for one in found], axis=0)
    errors = np.mean([list(one.standard_errors.values()) for one in found], axis=0)
    assert (np.abs(errors / spread - 1) < 0.15).all()


@pytest.mark.parametrize("loss", ["huber", "soft_l1", "cauchy"])
def test_outliers_move_little_with_a_robust_loss(loss):
    points = on_body(300, noise=0.01)
    points[::10] += np.random.default_rng(3).uniform(-2, 2, points[::10].shape)
    plain = rsym.fit(body(), points, list(SKELETON))
    robust = rsym.fit(body(), points, list(SKELETON), loss=loss)
    away = [abs(one.letters["p1"] - SKELETON["p1"]) for one in (robust, plain)]
    assert away[0] < 0.6
    assert 0.005 < robust.scale < 0.02
    assert "M-estimates" in str(robust)


@pytest.mark.parametrize("loss", LOSSES)
def test_psi_is_the_derivative_of_the_loss_of_scipy(loss):
    """The cost of one point by scipy, differentiated numerically."""
    psi, slope = LOSSES[loss]
    u = np.array([-3.0, -0.7, 0.2, 0.9, 1.4, 5.0])

    def cost(v):
        return np.array([least_squares(lambda w: [w[0]], [one], loss=loss, max_nfev=1).cost for one in v])

    assert_close(psi(u), (cost(u + 1e-5) - cost(u - 1e-5)) / 2e-5, rtol=1e-6)
    assert_close(slope(u), (psi(u + 1e-5) - psi(u - 1e-5)) / 2e-5, rtol=1e-6, atol=1e-9)


def test_weights_count_as_repetition():
    points, weights = on_body(60, noise=0.02), np.ones(60)
    weights[:20] = 2
    weighted = rsym.fit(body(), points, ["p1", "a2"], weights=7 * weights)
    repeated = rsym.fit(body(), np.concatenate([points, points[:20]]), ["p1", "a2"])
    assert_close(list(weighted.letters.values()), list(repeated.letters.values()), rtol=1e-8)
    nothing = rsym.fit(body(), points, ["p1", "a2"], weights=np.arange(60) < 30)
    half = rsym.fit(body(), points[:30], ["p1", "a2"], length=nothing.length)
    assert_close(list(nothing.letters.values()), list(half.letters.values()), rtol=1e-9)


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e3])
def test_the_unit_of_length_does_not_matter(unit):
    points = on_body(100, noise=0.01)
    scaled = body().scale(unit)
    found = rsym.fit(scaled, unit * points, ["a1", "p1"])
    plain = rsym.fit(body(), points, ["a1", "p1"])
    assert_close(list(found.letters.values()), list(plain.letters.values()), rtol=1e-8)
    assert_close(found.residuals, unit * plain.residuals, rtol=1e-6, atol=1e-12 * unit)


@pytest.mark.parametrize("size", [0.01, 0.3, 30])
@pytest.mark.parametrize("of", ["smooth", "edges"])
def test_a_start_far_off(size, of):
    low = {one: rsym.Letter(value, minimum=1e-4) for one, value in ((a, 2), (b, 1))}
    oval = rsym.Shape(1 - x**2 / a**2 - y**2 / b**2, (x, y), letters=low)
    shape, points = oval, CIRCLE * [1.3 * size, size]
    if of == "edges":
        shape = rsym.rectangle(2 * a, 2 * b, letters=low)
        points = rsym.sample(rsym.rectangle(2.6 * size, 2 * size), 60, over="boundary", rng=1).points
    found = rsym.fit(shape, points, [a, b])
    assert_close(list(found.letters.values()), [1.3 * size, size], rtol=1e-8)


def test_points_on_edges_and_corners_do_no_harm():
    box = rsym.box(2 * a, 2 * b, 2 * c, letters={a: 1.2, b: 0.8, c: 1})
    corners = np.array(np.meshgrid([-1, 1], [-0.5, 0.5], [-2, 2])).reshape(3, -1).T
    edges = np.stack([np.ones(9), np.full(9, 0.5), np.linspace(-1.9, 1.9, 9)], axis=1)
    sides = np.array([[1, 0, 0], [0, 0.5, 0], [0, 0, 2], [0.2, 0.1, -2]])
    found = rsym.fit(box, np.concatenate([corners, edges, sides]), [a, b, c])
    assert_close(list(found.letters.values()), [1, 0.5, 2], rtol=1e-9)
    assert not len(found.without_derivative)


def test_points_where_omega_is_undefined_are_left_out_and_said():
    shape = rsym.Shape(x**b + a - y, (x, y), letters={a: 1, b: 0.5})
    found = rsym.fit(shape, [[1, 2.5], [4, 3.5], [-1, 1], [2, sp.sqrt(2) + 1.5]], [a])
    assert found.left_out.tolist() == [2]
    assert np.isnan(found.residuals[2])
    assert_close(found.letters["a"], 1.5, rtol=1e-9)
    assert "Left out, for omega has no distance there: 1 point (2)." in str(found)


def test_points_that_lose_their_distance_on_the_way_pull_no_more():
    shape = rsym.Shape(sp.sqrt(x) + a - y, (x, y), letters={a: 1})  # near (-1/4, 1) it ends at a = 1 only
    found = rsym.fit(shape, [[1, 2.5], [4, 3.5], [-0.25, 1], [2, sp.sqrt(2) + 1.5]], [a], length=100)
    assert found.left_out.tolist() == [2]
    assert_close(found.residuals[[0, 1, 3]], [0, 0, 0], atol=1e-9)
    assert_close(found.letters["a"], 1.5, rtol=1e-9)


def test_points_that_become_defined_take_part():
    shape = rsym.Shape(sp.sqrt(x + a) - y, (x, y), letters={a: rsym.Letter(0, minimum=-1, maximum=5)})
    xs = np.linspace(-1.5, 3, 30)
    found = rsym.fit(shape, np.stack([xs, np.sqrt(xs + 2)], axis=1), [a])
    assert not len(found.left_out)
    assert_close(found.letters["a"], 2, rtol=1e-9)


def test_a_letter_at_its_bound_is_said():
    found = rsym.fit(rsym.disc(a, letters={a: rsym.Letter(1.2, minimum=1.1)}), CIRCLE, [a])
    assert found.letters == {"a": 1.1}
    assert found.at_bounds == ("a",)
    assert np.isnan(found.standard_errors["a"])
    assert "a ends at its bound" in str(found)
    assert json.loads(found.to_json())["standard_errors"]["a"] is None


def test_a_section_is_fitted_in_its_plane():
    ball = rsym.sphere(a, letters={a: 1.5})
    found = rsym.fit(ball, CIRCLE, [a], section={z: 0.75})
    assert_close(found.letters["a"], 1.25, rtol=1e-12)
    # In the plane the distance of a point is that of circles, not of balls.
    moved = rsym.fit(ball, CIRCLE + np.array([0.001, 0.0]), [a], section={z: 0.75})
    assert abs(np.abs(moved.residuals).max() - 0.001) < 1e-5
    assert moved.section == {"z": 0.75}


def test_a_silhouette_gives_the_axes_across_the_view_alone():
    oval = rsym.ellipsoid(a, b, c, letters={a: 2, b: 1.5, c: 1})
    found = rsym.fit(oval, CIRCLE * [2.4, 1.1], [a, b], silhouette=z)
    assert_close(list(found.letters.values()), [2.4, 1.1], rtol=1e-9)
    with pytest.raises(rsym.RsymError, match=r"do not determine c: no residual depends on it"):
        rsym.fit(oval, CIRCLE * [2.4, 1.1], [a, b, c], silhouette=z)


def test_a_silhouette_along_a_vector():
    """The outline of an ellipsoid along d, by linear algebra: q' (A - A d d' A/(d' A d)) q = 1 across d."""
    axes, d = np.array([2.2, 1.3, 0.9]), np.array([1.0, 2.0, -0.5])
    matrix = np.diag(1 / axes**2)
    outline = matrix - np.outer(matrix @ d, d @ matrix) / (d @ matrix @ d)
    u = np.cross(d, [0, 0, 1.0])
    frame = np.stack([u / np.linalg.norm(u), np.cross(d, u) / np.linalg.norm(np.cross(d, u))])
    values, vectors = np.linalg.eigh(frame @ outline @ frame.T)
    points = (CIRCLE / np.sqrt(values)) @ vectors.T @ frame
    oval = rsym.ellipsoid(a, b, c, letters={a: 2, b: 1.5, c: 1})
    found = rsym.fit(oval, points + np.linspace(-3, 3, len(points))[:, None] * d, [a, b, c], silhouette=d)
    assert_close(list(found.letters.values()), axes, rtol=1e-8)


def test_the_outline_of_an_edge():
    """The silhouette of a box along (1, 1, 0) is that of its edges: half its width (a + b)/sqrt(2)."""
    box = rsym.box(2 * a, 2, 2 * c, letters={a: 1.3, c: 0.8})
    side = np.array([1, -1, 0]) / np.sqrt(2)
    half = (1.0 + 1.0) / np.sqrt(2)
    heights = np.linspace(-0.9, 0.9, 7)
    rows = [s * half * side + [0, 0, h] for s in (-1, 1) for h in heights]
    rows += [t * side + [0, 0, s] for s in (-1, 1) for t in (-1, 0, 1)]
    found = rsym.fit(box, rows, [a, c], silhouette=(1, 1, 0))
    assert_close(list(found.letters.values()), [1, 1], rtol=1e-7)


@pytest.mark.parametrize("body", ["round", "edges"])
def test_derivatives_along_lines_of_sight_are_those_of_differences(body):
    letters = {a: 2, b: 0.5}
    shape = rsym.torus(a, b, letters=letters) if body == "round" else rsym.box(2 * a, 2 * b, 3, letters=letters)
    rows = np.random.default_rng(1).uniform(-2, 2, (50, 3))
    sights = lines_of_sight(rows, (0.3, 1, 0.4), ((-3, 3),) * 3, ("x", "y", "z"))
    distances = boundary_distances(shape, ["a", "b"], rows, 5.0, sights)
    at = np.array([2.0, 0.5])
    slopes = distances(at)[1]
    for k in range(2):
        moved = 1e-5 * np.eye(2)[k]
        difference = (distances(at + moved)[0] - distances(at - moved)[0]) / 2e-5
        allowed = (1e-6 if body == "round" else 3e-5) * np.maximum(1, np.abs(slopes[:, k]))
        assert np.mean(np.abs(difference - slopes[:, k]) < allowed) > 0.95


def test_on_the_boundary_the_derivative_is_the_speed():
    """Where omega is 0 to the last bit, at a corner too."""
    at = np.array([2.0])
    value, slopes = boundary_distances(rsym.disc(r, letters={r: 2}), ["r"], 2 * np.eye(2), 1e3)(at)
    assert value.tolist() == [0, 0]
    assert slopes.ravel().tolist() == [1, 1]
    square = rsym.rectangle(2 * r, 2 * r, letters={r: 2})
    value, slopes = boundary_distances(square, ["r"], np.array([[2.0, 2.0], [2.0, 0.5], [-2.0, 2.0]]), 1e3)(at)
    assert value.tolist() == [0, 0, 0]
    assert slopes.ravel().tolist() == [1, 1, 1]


REFUSED = [
    ({"letters": "a"}, "letters"),
    ({"letters": ["q"]}, "unknown-letter"),
    ({"letters": []}, "unknown-letter"),
    ({"points": CIRCLE[:0]}, "points"),
    ({"points": None}, "points"),
    ({"points": [[1, 2, 3]]}, "points"),
    ({"points": [[np.nan, 0], [1, 0]]}, "points"),
    ({"points": CIRCLE[:1], "letters": [a, b]}, "too-few-points"),
    ({"points": CIRCLE + 100}, "far"),
    ({"weights": [1]}, "weights"),
    ({"weights": np.zeros(40)}, "weights"),
    ({"weights": -np.ones(40)}, "weights"),
    ({"loss": "l1"}, "loss"),
    ({"scale": -1}, "scale"),
    ({"length": 0}, "length"),
    ({"silhouette": z}, "silhouette"),
]


@pytest.mark.parametrize(("given", "code"), REFUSED)
def test_what_is_refused(given, code):
    call = {"points": CIRCLE, "letters": [a], **given}
    disc = rsym.Shape((a + b - 1) ** 2 - x**2 - y**2, (x, y), letters={a: rsym.Letter(1.2, maximum=9), b: 1})
    with pytest.raises(rsym.RsymError) as raised:
        rsym.fit(disc, call.pop("points"), call.pop("letters"), **call)
    assert raised.value.code == code
    assert raised.value.remedy


def test_letters_that_only_count_together_are_named():
    disc = rsym.Shape(a * b - x**2 - y**2, (x, y), letters={a: 2, b: 1})
    with pytest.raises(rsym.RsymError, match=r"moved together, a by .* and b by .*, they change no residual"):
        rsym.fit(disc, CIRCLE, [a, b])
    assert_close(rsym.fit(disc, CIRCLE, [a]).letters["a"], 1, rtol=1e-9)


def test_the_parameter_of_an_operation_is_refused():
    shape = rsym.Shape(1 - rsym.conjunction(x, y * c, system=rsym.Rp(p)), (x, y), letters={p: 3, c: 1})
    with pytest.raises(rsym.RsymError, match="'p' is the parameter"):
        boundary_distances(shape, ["p"], CIRCLE, 1.0)


def test_letters_compile_nothing_and_other_points_neither(caplog):
    points = on_body(50)
    rsym.fit(body(), points, ["p1"])
    with caplog.at_level("INFO", logger="rsym.backends.kernel"):
        rsym.fit(body().with_letters({"p1": 30}), 0.999 * points[:30], ["p1"])
    assert not caplog.records
    assert LENGTH not in body().letters
