"""Bounds of principal curvatures: they hold at every point of a sheet, and are tight where the extremes are."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.optimize import minimize

import rsym
from rsym import x, y, z
from rsym.bounds.enclosures import ranges_of
from rsym.sampling.windows import outer_bounds
from rsym.verify.bodies import study_body
from rsym.verify.boxes.local import Model
from rsym.verify.cover.bending import bending, bent, contraction
from rsym.verify.cover.forming import formation
from rsym.verify.cover.images import Images
from rsym.verify.cover.simplest import simplest


def bending_of(shape):
    letters = ranges_of(shape.letters, None)
    study = study_body(shape, outer_bounds(shape, None, letters), letters)
    return bending(study.images, study.found)


def images_of(expression):
    model = Model(rsym.Shape(expression, (x, y, z)), {})
    return Images(model, formation(model, lambda number: True), {}), model.root


def principal(expression):
    """The principal curvatures (n, 2), rising, of level surfaces at points (n, 3), from derivatives taken by SymPy."""
    slopes = [sp.lambdify((x, y, z), sp.diff(expression, a)) for a in (x, y, z)]
    bends = [[sp.lambdify((x, y, z), sp.diff(expression, a, b)) for b in (x, y, z)] for a in (x, y, z)]

    def at(points):
        zero = np.zeros(len(points))
        gradient = np.stack([slope(*points.T) + zero for slope in slopes], axis=1)
        hessian = np.stack([np.stack([bend(*points.T) + zero for bend in row], axis=1) for row in bends], axis=1)
        length = np.linalg.norm(gradient, axis=1)
        basis = np.linalg.svd(gradient[:, None])[2][:, 1:]
        return np.linalg.eigvalsh(-basis @ hessian @ basis.transpose(0, 2, 1) / length[:, None, None])

    return at


def crossings(value, start, stop):
    """Zeros on the segments from start to stop (n, 3) at whose ends the signs differ, by bisection."""
    own = value(start) * value(stop) < 0
    start, stop = start[own], stop[own]
    for _ in range(60):
        middle = (start + stop) / 2
        same = (value(middle) * value(start) > 0)[:, None]
        start, stop = np.where(same, middle, start), np.where(same, stop, middle)
    return start, own


def assert_encloses(found, low, high, share=0.1, flat=0.0):
    """The enclosure contains the exact extremes and exceeds them by at most this share."""
    (least, most), (below, above) = (low, high), found.enclosure
    assert below <= least
    assert most <= above
    assert least - below <= max(share * abs(least), flat)
    assert above - most <= max(share * abs(most), flat)
    assert_close(found.attained, (least, most), atol=max(0.02 * abs(most), flat))


@pytest.mark.random
@pytest.mark.parametrize(
    ("shape", "low", "high"),
    [
        (rsym.sphere(1), 1, 1),
        (rsym.ellipsoid(3, 2, 1), 1 / 9, 3),
        (rsym.torus(2, sp.Rational(1, 2)), -1 / 1.5, 2),
        (rsym.box(2, 3, 1), 0, 0),
    ],
)
def test_extremes(shape, low, high):
    assert_encloses(bending_of(shape), low, high, share=0.051, flat=1e-12)


@pytest.mark.slow
def test_a_range_of_letters():
    r = sp.Symbol("r", real=True)
    shape = rsym.Shape(r**2 - x**2 - y**2 - z**2, (x, y, z), letters={r: 1}, bounds=((-1.6, 1.61),) * 3)
    study = study_body(shape, shape.bounds, ranges_of(shape.letters, {"r": (1, sp.Rational(5, 4))}))
    low, high = bending(study.images, study.found).enclosure
    assert 0.7 < low <= 0.8
    assert 1 <= high < 1.15


def test_quartic():
    expression = 1 - x**4 - y**4 - z**4
    found = bending_of(rsym.Shape(expression, (x, y, z), bounds=((-2.1, 2.05),) * 3))
    curvatures = principal(expression)

    def least(direction):
        return -curvatures((direction / np.linalg.norm(direction, 4))[None])[0, 1]

    directions = np.random.default_rng(3).normal(size=(2000, 3))
    best = curvatures(directions / np.linalg.norm(directions, 4, axis=1)[:, None])[:, 1].argsort()[-3:]
    high = -min(minimize(least, directions[k], method="Nelder-Mead").fun for k in best)
    assert_encloses(found, 0, high, share=0.051, flat=0.01)


def skeleton_curvatures(letters):
    """Curvatures of the meridian and of the parallels of omega = -f_o + (a1 - x)(a2 + x)/p1 - p2 turned about x."""
    a, a1, a2, p1, p2 = (letters[name] for name in ("a", "a1", "a2", "p1", "p2"))
    inner = (a**2 - x**2) / (2 * a)
    trimmed = sp.sqrt(y**2 + ((sp.sqrt(inner**2 + y**4) - inner) / 2) ** 2)
    omega = -trimmed + (a1 - x) * (a2 + x) / p1 - p2
    parts = [omega, *(sp.diff(omega, v) for v in (x, y)), *(sp.diff(omega, *v) for v in ((x, x), (x, y), (y, y)))]
    value, *derivatives = (sp.lambdify((x, y), part) for part in parts)
    angle = np.pi * np.linspace(1e-4, 1, 20_001)[:-1]
    far = 9 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points, _ = crossings(lambda at: value(*at.T), np.broadcast_to([1.0, 1e-9], far.shape), far)
    u, v, uu, uv, vv = (derivative(*points.T) for derivative in derivatives)
    length = np.hypot(u, v)
    return -(uu * v**2 - 2 * uv * u * v + vv * u**2) / length**3, -v / (length * points[:, 1])


@pytest.mark.slow
def test_body_of_revolution():
    plane = rsym.paper.skeleton_body().with_letters({"a2": 6})
    found = bending_of(rsym.revolve(plane))
    meridian, parallels = skeleton_curvatures(
        {name: sp.Rational(low) for name, (low, _) in ranges_of(plane.letters, None).items()}
    )
    assert len(meridian) == 20_000
    assert_encloses(found, min(meridian.min(), parallels.min()), max(meridian.max(), parallels.max()))


def random_polynomial(rng, degree):
    powers = [(i, j, k) for i in range(degree + 1) for j in range(degree + 1 - i) for k in range(degree + 1 - i - j)]
    numbers = rng.integers(-20, 21, len(powers)) * (rng.uniform(size=len(powers)) < 6 / len(powers) + 0.2)
    return sum(sp.Rational(int(n), 16) * x**i * y**j * z**k for n, (i, j, k) in zip(numbers, powers, strict=True))


@pytest.mark.random
@pytest.mark.parametrize(("seed", "degree"), [(1, 2), (2, 2), (3, 2), (4, 3), (5, 4)])
def test_no_point_of_a_sheet_is_out_of_bounds(seed, degree):
    rng = np.random.default_rng(seed)
    expression = random_polynomial(rng, degree)
    value = sp.lambdify((x, y, z), expression)
    around, _ = crossings(lambda at: value(*at.T), *rng.uniform(-2, 2, (2, 3000, 3)))
    widths = 10 ** rng.uniform(-5, -0.3, (200, 3)) * rng.uniform(0.2, 1, (200, 1))
    low = around[:200] - widths * rng.uniform(0, 1, (200, 3))
    boxes = np.stack([low, low + widths], axis=-1)
    images, node = images_of(expression)
    ends = low[:, None] + widths[:, None] * rng.uniform(0, 1, (2, 200, 80, 3))
    points, own = crossings(lambda at: value(*at.T), *ends.reshape(2, -1, 3))
    place = np.repeat(np.arange(200), 80)[own]
    assert np.bincount(place, minlength=200).mean() > 20
    known = principal(expression)(points)
    found = bent(images, node, boxes)
    assert len(found.boxes) == 200, "a box with the sheet was left out"
    low, high, kept = found.low[place], found.high[place], found.boxes[place]
    slack = 1e-9 * np.abs(known).max(axis=1)
    assert (low - slack <= known[:, 0]).all()
    assert (known[:, 1] <= high + slack).all()
    assert (np.isfinite(low) & np.isfinite(high)).mean() > 0.3
    assert (kept[..., 0] - 1e-12 <= points).all()
    assert (points <= kept[..., 1] + 1e-12).all()


def test_excess_is_of_the_order_of_the_square_of_the_width():
    axes = np.array([[1, 2, 2], [2, 1, -2], [2, -2, 1]]) / 3
    u, v, w = (sum(int(3 * n) * c for n, c in zip(axis, (x, y, z), strict=True)) / 3 for axis in axes)
    images, node = images_of(1 - u**2 / 9 - v**2 / 4 - w**2)
    for tip, exact, end in ((3 * axes[0], 3.0, "high"), (axes[2], 1 / 9, "low")):
        widths = 0.01 / 2.0 ** np.arange(4)
        boxes = np.array([[(c - w / 2, c + w / 2) for c in tip] for w in widths])
        excess = np.abs(getattr(bent(images, node, boxes), end) - exact)
        assert_close(np.log2(excess[:-1] / excess[1:]), [2, 2, 2], atol=0.15)


def test_bounds_hold_where_the_curvature_jumps():
    """y = x|x| bends by 2 on one side of its kink and by -2 on the other; its third derivative is 0 on both."""
    images, node = images_of(y - x**2 * sp.sign(x))
    found = bent(images, node, np.array([[(-0.1, 0.2), (-0.1, 0.1), (-0.1, 0.1)]]))
    assert found.low[0] <= -2
    assert found.high[0] >= 2


def test_boxes_without_the_sheet_are_left_out():
    images, node = images_of(1 - x**2 - y**2 - z**2)
    beside = np.array([[(0.8, 0.9), (0.8, 0.9), (0.8, 0.9)], [(0.52, 0.64), (0.52, 0.64), (0.52, 0.64)]])
    assert contraction(images, node, beside)[1].tolist() == [False, True]


@pytest.mark.slow
def test_poles_of_curvature_come_to_an_end():
    found = bending_of(rsym.double_cone(sp.pi / 6).replace(bounds=((-2.1, 2.05),) * 3))
    assert found.attained[1] > 1e3
    assert found.enclosure[1] >= found.attained[1]


def dressed(body):
    fillet = rsym.conjunction(x, y, system=rsym.Rho(sp.Rational(1, 2), "G2"))
    return {
        "kinks": body * (2 + sp.Abs(x - sp.Rational(1, 3))),
        "normalised": rsym.normalise(rsym.Shape(body, (x, y, z))).expression,
        "conjunction": rsym.conjunction(body, 2 - x, system=rsym.R0),
        "outside": -rsym.disjunction(-body, x - 2, system=rsym.R0),
        "branches": body + sp.Abs(x) / 2 + sp.Min(y, z) + sp.sign(z + y),
        "fillet": fillet,
    }


@pytest.mark.random
@pytest.mark.parametrize("name", dressed(x))
def test_the_simplest_function_has_the_same_signs(name):
    body = 1 - x**2 / 4 - y**2 - z**2
    expression = dressed(body)[name]
    images, node = images_of(expression)
    rng = np.random.default_rng(7)
    low = rng.uniform(-1.2, 1.2, (400, 3))
    boxes = np.stack([low, low + 0.1], axis=-1)
    found = dict(simplest(images, node, boxes))
    assert sorted(np.concatenate(list(found.values()))) == list(range(400))
    assert min(found, key=lambda number: len(images.model.order(number))) != node
    value = rsym.compile(rsym.Shape(expression, (x, y, z)))
    for number, places in found.items():
        points = low[places] + rng.uniform(0, 0.1, (len(places), 3))
        (signs,) = images.signs([number], np.stack([points, points], axis=-1))
        known = np.sign(value(*points.T)["value"])
        assert ((signs == known) | (signs == 0)).all()
        assert (signs != 0).mean() > 0.9
