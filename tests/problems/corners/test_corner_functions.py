"""Singular functions at corners: 0 on both edges, against derivatives in 30 digits, and what they are for."""

import math

import mpmath as mp
import numpy as np
import pytest
import scipy.linalg as la
import sympy as sp
from numpy.polynomial import legendre
from numpy.testing import assert_allclose

import rsym
from rsym import x, y
from rsym.problems.corners.corner_functions import corner_functions
from rsym.problems.corners.corners import corners
from rsym.problems.corners.formulas import formulas
from rsym.problems.corners.growth import Growth

ELL = rsym.Shape(rsym.conjunction(1 - x, 1 + x, 1 - y, 1 + y, rsym.disjunction(-x, y)), (x, y))
LENS = rsym.disc(1) & rsym.disc(1, (1, 0))
BOTH = rsym.disc(1) | rsym.disc(1, (1, 0))
CAP = rsym.disc(1) & rsym.half_plane((0, 1), 0.25)


def unit(x, y):
    return (1 - x * x - y * y) / 2


def moved(x, y):
    return unit(x - 1, y)


LEAVES = {
    LENS: (unit, moved),
    BOTH: (unit, moved),
    CAP: (unit, lambda x, y: y - mp.mpf(1) / 4),
    ELL: (*(lambda x, y: None,) * 4, lambda x, y: -x, lambda x, y: y),
}


def inner():
    return next(corner for corner in corners(ELL) if corner.is_reentrant)


def within(corner, radius, count=5):
    """Points between the edges of a corner, in leaf coordinates about so far away at most."""
    generator = np.random.default_rng(7)
    first = math.atan2(*corner.edges[0][::-1])
    angle = first + corner.angle * generator.uniform(0.02, 0.98, count)
    distance = radius * generator.uniform(0.05, 0.7, count)
    return corner.point + distance[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def formula(part, term, f, g):
    """The function of the docstring, written down once more."""
    corner, (p, q) = part.corner, (mp.hypot(*slope) for slope in part.corner.gradients)
    alpha, radius = mp.mpf(corner.angle), mp.mpf(part.radius)

    bends = [bend.slope for bend in part.jets.bends] or [(0, 0), (0, 0)]

    def bent(leaf, slope, x, y):
        s = slope[0] * (x - corner.point[0]) + slope[1] * (y - corner.point[1])
        return leaf(x, y) * (1 + s / mp.sqrt(1 + 4 * s * s))

    def function(x, y):
        v, w = bent(f, bends[0], x, y) / p, bent(g, bends[1], x, y) / q
        u = (w + v * mp.cos(alpha)) / mp.sin(alpha)
        r, theta = mp.hypot(u, v), mp.atan2(v, u)
        theta += 2 * mp.pi if theta < alpha / 2 - mp.pi else 0
        cut = (1 - (r / radius) ** 2) ** part.power
        if term.kind == "log":
            imaginary = mp.im(mp.mpc(u, v) ** 2 * mp.mpc(mp.log(r), theta))
            return cut * r ** mp.mpf(term.exponent - 2) * (-(v**2) / 2 - imaginary / (2 * alpha))
        wave = mp.sin if term.kind == "sin" else mp.cos
        return cut * r ** mp.mpf(term.exponent) * wave(term.rate * (alpha - theta if part.turned else theta))

    return function


@pytest.mark.parametrize(
    ("shape", "natural"),
    [(ELL, ()), (ELL, (4, 5)), (ELL, (4,)), (ELL, (5,)), (LENS, ()), (BOTH, ()), (BOTH, (0,)), (CAP, ())],
)
def test_values_gradients_and_laplacians_against_30_digits(shape, natural):
    corner = inner() if shape is ELL else corners(shape)[-1]
    found = corner_functions(shape, [corner], natural, terms=4, levels=2, highest=5.0)
    (part,) = found.parts
    points = within(corner, part.radius)
    values, gradients, laplacians = found.at(points)
    with mp.workdps(30):
        for k, term in enumerate(found.terms):
            function = formula(part, term, *(LEAVES[shape][leaf] for leaf in corner.leaves))
            for n, place in enumerate(points):
                point = tuple(map(mp.mpf, place))
                size = abs(float(function(*point)))
                r = float(np.hypot(*(place - corner.point)))
                assert_allclose(values[n, k], float(function(*point)), rtol=0, atol=1e-12 * size)
                slopes = [float(mp.diff(function, point, order)) for order in ((1, 0), (0, 1))]
                assert_allclose(gradients[n, :, k], slopes, rtol=0, atol=1e-12 * max(size / r, *map(abs, slopes)))
                second = [float(mp.diff(function, point, order)) for order in ((2, 0), (0, 2))]
                assert_allclose(laplacians[n, k], sum(second), rtol=0, atol=1e-12 * max(size / r**2, *map(abs, second)))


@pytest.mark.parametrize("shape", [ELL, LENS, BOTH, CAP])
def test_they_are_zero_on_both_edges_however_curved(shape):
    corner = inner() if shape is ELL else corners(shape)[-1]
    found = corner_functions(shape, [corner])
    distance = np.geomspace(1e-12, 0.4, 40)[:, None]
    for edge, leaf in zip(corner.edges, corner.leaves, strict=True):
        points = corner.point + distance * edge
        if LEAVES[shape][leaf] in (unit, moved):  # onto its circle
            centre = np.array([float(LEAVES[shape][leaf] is moved), 0.0])
            points = centre + (points - centre) / np.hypot(*(points - centre).T)[:, None]
        values, _, _ = found.at(points)
        exponents = np.array([term.exponent for term in found.terms])
        r = np.hypot(*(points - corner.point).T)[:, None]
        # What a rounding error of the point across the edge makes, and no more.
        assert (np.abs(values) <= 1e-14 * r ** (exponents - 1)).all()
        assert np.abs(found.at(points[20:] + 1e-3)[0]).max() > 1e-5


def test_on_straight_edges_they_are_exactly_zero_and_harmonic():
    corner = inner()
    found = corner_functions(ELL, [corner], levels=1, power=7)
    distance = np.geomspace(1e-150, 2.0, 100)
    zero = np.zeros(100)
    for points in (np.stack([zero, -distance], axis=1), np.stack([distance, zero], axis=1)):
        assert not found.at(points)[0].any()
    # r**2 so small that the factor is 1: what is left of the Laplacian is rounding of terms of size r**(lambda - 2).
    points = within(corner, 1e-9)
    _, gradients, laplacians = found.at(points)
    r = np.hypot(*points.T)[:, None]
    harmonic = [k for k, term in enumerate(found.terms) if term.kind == "sin"]
    assert (np.abs(laplacians) <= 1e-12 * np.hypot(*gradients.transpose(1, 0, 2)) / r)[:, harmonic].all()
    loaded = [k for k, term in enumerate(found.terms) if term.kind == "log"]
    assert_allclose(laplacians[:, loaded], -1, rtol=1e-12)


@pytest.mark.parametrize("shape", [BOTH, CAP, rsym.disc(1) & (rsym.half_plane((0, 1), 0) | rsym.disc(0.5, (0.25, 0)))])
def test_at_curved_edges_they_are_harmonic_but_for_two_orders_more(shape):
    """Leaf coordinates alone stretch in all directions alike but for one."""
    for corner in corners(shape):
        found = corner_functions(shape, [corner], terms=2, levels=1, load=False)
        exponents = np.array([term.exponent for term in found.terms])
        across = np.array([-corner.edges[0][1], corner.edges[0][0]])
        ways = [math.cos(t) * corner.edges[0] + math.sin(t) * across for t in np.linspace(0.2, 0.8, 4) * corner.angle]
        far, near = (np.abs(found.at(corner.point + r * np.array(ways))[2]).max(axis=0) for r in (1e-3, 1e-5))
        assert (near <= 1.2 * 100.0**-exponents * far).all()


@pytest.mark.parametrize("growth", [Growth((1.0, -3.0), (0.5, 2.0, -1.0))])
def test_a_factor_has_its_derivatives(growth):
    points = np.random.default_rng(5).uniform(-2, 2, (6, 2))

    def function(x, y):
        (p, q), (xx, xy, yy) = growth.slope, growth.bend
        log = p * x + q * y + (xx * x * x + 2 * xy * x * y + yy * y * y) / 2
        return mp.exp(log / mp.sqrt(1 + log**2 / 16))

    wanted = [
        [mp.diff(function, (mp.mpf(u), mp.mpf(v)), order) if any(order) else function(u, v) for u, v in points]
        for order in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
    ]
    assert_allclose(growth.at(points, 2), np.array(wanted, float), rtol=1e-9, atol=1e-9)
    assert_allclose(growth.at(points, 1), np.array(wanted, float)[:3], rtol=1e-9, atol=1e-9)


def test_beyond_their_radius_and_reach_there_is_nothing():
    for shape in (ELL, LENS, BOTH, CAP):
        for corner in corners(shape):
            found = corner_functions(shape, [corner])
            generator = np.random.default_rng(3)
            points = corner.point + generator.uniform(-3, 3, (2000, 2))
            beyond = np.hypot(*(points - corner.point).T) >= corner.reach
            assert not any(part[beyond].any() for part in found.at(points))
            # Up to the reach they end by themselves: nothing jumps there.
            around = np.linspace(0, 2 * math.pi, 3000)
            circle = corner.point + 0.99999 * corner.reach * np.stack([np.cos(around), np.sin(around)], axis=1)
            assert np.abs(found.at(circle)[0]).max() < 1e-12


def test_natural_conditions_have_no_slope_across_edges():
    corner = inner()
    by_leaf = dict(zip(corner.leaves, corner.edges, strict=True))
    for natural in ((4, 5), (4,), (5,)):
        found = corner_functions(ELL, [corner], natural)
        for leaf, edge in by_leaf.items():
            values, gradients, _ = found.at(0.3 * edge[None])
            across = np.array([-edge[1], edge[0]]) @ gradients[0]
            assert np.abs(across if leaf in natural else values).max() < 1e-14
            assert np.abs(values if leaf in natural else across).max() > 1e-3


def test_a_wedge_of_another_sector_is_left_alone():
    first, second = corners(CROSS)
    points = np.array([[-0.2, 0.3], [0.2, -0.3]])
    for corner in (first, second):
        own = np.array([corner.edges.sum(axis=0) @ point > 0 for point in points])
        values = corner_functions(CROSS, [corner]).at(points)[0]
        assert values[own].any()
        assert not values[~own].any()


def test_letters_move_the_functions():
    a = rsym.model.symbols.real_symbol("a")
    shape = rsym.Shape(rsym.conjunction(4 - x**2, 4 - y**2, rsym.disjunction(a - x, y)), (x, y), letters={a: 0})
    (corner,) = (c for c in corners(shape, {"a": 0.5}) if c.is_reentrant)
    found = corner_functions(shape, [corner], letters={"a": 0.5})
    assert not found.at(np.array([[0.5, -0.25], [0.75, 0.0]]))[0].any()
    assert found.at(np.array([[0.25, 0.25]]))[0].any()


CROSS = rsym.Shape(rsym.exclusive_or(x, y), (x, y), bounds=((-1, 1), (-1, 1)))


@pytest.mark.parametrize(("shape", "natural"), [(ELL, ()), (BOTH, (0,)), (CROSS, ())])
def test_as_expressions_they_have_the_same_values_and_derivatives(shape, natural):
    chosen = corners(shape)[-3:]
    growths = [None, *[Growth((1.0, -2.0), (0.5, 0.25, -1.0))] * (len(chosen) - 1)]
    found = corner_functions(shape, chosen, natural, terms=3, levels=2, growths=growths)
    points = np.random.default_rng(1).uniform(-1, 1, (300, 2))
    values = found.derivatives(points, 2)
    expressions = formulas(shape, found)
    assert len(expressions) == len(found)
    for k in {0, len(found) // 2, len(found) - 1}:
        kernel = rsym.compile(shape.replace(expression=expressions[k]), ("value", "gradient", "hessian"))
        fields = kernel(*points.T)
        assert np.abs(values[0, k]).max() > 1e-6
        assert_allclose(fields["value"], values[0, k], rtol=0, atol=1e-14)
        assert_allclose(fields["gradient"].T, values[1:3, k], rtol=0, atol=1e-13)
        assert_allclose(fields["hessian"][:, [0, 0, 1], [0, 1, 1]].T, values[3:, k], rtol=0, atol=1e-11)


def test_of_strips_they_are_those_of_half_planes():
    halves = rsym.Shape(rsym.conjunction(1 - x, x, y, 1 - y), (x, y))
    strips = rsym.Shape(rsym.conjunction(x * (1 - x), y * (1 - y)), (x, y))
    points = np.random.default_rng(1).uniform(0, 1, (300, 2))
    for one, other in zip(corners(strips), corners(halves), strict=True):
        assert_allclose(one.point, other.point, rtol=0, atol=1e-15)
        both = [corner_functions(shape, [corner], levels=2) for shape, corner in ((strips, one), (halves, other))]
        found, wanted = (made.derivatives(points, 2) for made in both)
        assert np.abs(wanted[0]).max() > 1e-6
        assert_allclose(found, wanted, rtol=0, atol=2e-2 * np.abs(wanted).max())  # of reaches that are bounds
        ((expression, *_),) = [formulas(strips, both[0])]
        kernel = rsym.compile(strips.replace(expression=expression))
        assert_allclose(kernel(*points.T)["value"], found[0, 0], rtol=0, atol=1e-14)


def test_as_expressions_they_are_zero_on_edges_for_other_letters_too():
    a = sp.Symbol("a", real=True)
    shape = rsym.Shape(rsym.conjunction(4 - x**2 - y**2, rsym.disjunction(a - x, y - a * x)), (x, y), letters={a: 0})
    (corner,) = (c for c in corners(shape) if c.is_reentrant)
    for expression in formulas(shape, corner_functions(shape, [corner], terms=2, levels=1)):
        inside = expression.subs({x: -sp.Rational(1, 5), y: sp.Rational(1, 5), a: sp.Rational(1, 10)})
        assert abs(float(inside)) > 1e-6
        on_edges = [{x: a, y: -sp.Rational(1, 5)}, {x: sp.Rational(1, 2), y: a / 2}]
        assert [expression.subs(place).subs(a, sp.Rational(1, 10)) for place in on_edges] == [0, 0]


def test_cusps_are_refused():
    crescent = rsym.disc(1) - rsym.disc(0.5, (0.5, 0))
    with pytest.raises(rsym.RsymError, match="touch") as error:
        corner_functions(crescent, corners(crescent))
    assert error.value.code == "cusp"


def graded(levels, order):
    """Gauss points and weights on three unit squares, graded towards the corner at 0."""
    t, w = legendre.leggauss(order)
    t, w, points, weights = (t + 1) / 2, w / 2, [], []
    for level in range(levels):
        h = 2.0 ** -(level + 1)
        for a, b in [(h, 0), (0, h), (h, h), *([(0, 0)] if level == levels - 1 else [])]:
            points.append(np.stack(np.meshgrid(a + h * t, b + h * t), axis=-1).reshape(-1, 2))
            weights.append(np.outer(w, w).ravel() * h * h)
    points, weights = np.concatenate(points), np.concatenate(weights)
    return np.concatenate([points * side for side in ((-1, 1), (-1, -1), (1, 1))]), np.tile(weights, 3)


def weighted(points, degree):
    """Values and derivatives of (1 - x**2)(1 - y**2)(r + y - x) times polynomials."""
    u, v = points.T
    r = np.hypot(u, v)
    a, b, c = 1 - u * u, 1 - v * v, r + v - u
    w = a * b * c
    wx, wy = -2 * u * b * c + a * b * (u / r - 1), -2 * v * a * c + a * b * (v / r + 1)
    one = np.eye(degree + 1)
    p, q = (legendre.legvander(t, degree) for t in (u, v))
    dp, dq = (legendre.legval(t, legendre.legder(one)).T for t in (u, v))
    i, j = np.array([(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]).T
    basis, bx, by = p[:, i] * q[:, j], dp[:, i] * q[:, j], p[:, i] * dq[:, j]
    return w[:, None] * basis, wx[:, None] * basis + w[:, None] * bx, wy[:, None] * basis + w[:, None] * by


def lowest(weights, parts):
    """Ritz's value of a basis."""
    values, slope_x, slope_y = (
        np.concatenate(part, axis=1) * np.sqrt(weights)[:, None] for part in zip(*parts, strict=True)
    )
    size = np.sqrt(np.einsum("nk,nk->k", values, values))
    (triangle,) = la.qr(values / size, mode="r")
    _, sizes, vectors = la.svd(triangle[: len(size)])
    kept = sizes > 1e-11 * sizes[0]
    change = (vectors[kept] / sizes[kept, None]).T / size[:, None]
    slopes = [slope @ change for slope in (slope_x, slope_y)]
    return la.eigh(sum(slope.T @ slope for slope in slopes), eigvals_only=True)[0]


def test_the_lowest_eigenvalue_of_three_unit_squares():
    points, weights = graded(24, 10)
    assert_allclose(weights.sum(), 3, rtol=1e-14)
    plain = weighted(points, 16)
    values, gradients, _ = corner_functions(ELL, [inner()]).at(points)
    exact = 9.639723844021941
    without = lowest(weights, [plain]) / exact - 1
    with_them = lowest(weights, [plain, (values, gradients[:, 0], gradients[:, 1])]) / exact - 1
    assert without > 3e-3
    assert 0 < with_them < 1e-6
