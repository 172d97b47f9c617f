"""Operators that interpolate at the crossings of lines and keep the means along them."""

import itertools
import math

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.integrate import quad

import rsym
from rsym import x, y
from rsym.surfaces.chords.domain_chords import roots_between
from rsym.surfaces.projections import ProjectionOperator
from rsym.surfaces.symbols import t

# Tangents of circles about the origin, turned by uneven angles: any two cross within 1.8 of it.
LINES = [(1, 0, 0.5), (0.3, 0.95, 0.45), (-0.8, 0.6, 0.5), (-0.8, -0.6, 0.55), (0.35, -0.9, 0.5)]
DISC = rsym.Shape((9 - x**2 - y**2) / 6, (x, y))
RECTANGLE = rsym.conjunction(4 - x**2, (sp.Rational(5, 2) - y) * (y + 2))
TRIANGLE = [(-2, -3), (6, -3), (-2, 5)]
UNIT = [(0, 0), (1, 0), (0, 1)]
SIDES = [y, x, x + y - 1]


def in_the_disc(px, py):
    return px**2 + py**2 <= 9


def in_the_rectangle(px, py):
    return abs(px) <= 2 and -2 <= py <= 2.5


def in_the_triangle(px, py):
    return px >= -2 and py >= -3 and px + py <= 3


DOMAINS = {
    "disc": (DISC, in_the_disc),
    "rectangle": (RECTANGLE, in_the_rectangle),
    "triangle": (TRIANGLE, in_the_triangle),
}


def chord(line, inside):
    """The ends of a chord by bisection along the line, from its point next to the origin."""
    a, b, c = line
    foot, step = np.array([a, b]) * c / (a * a + b * b), np.array([-b, a])

    def end(sign):
        low, high = 0.0, 20.0
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if inside(*(foot + sign * middle * step)) else (low, middle)
        return foot + sign * low * step

    return end(-1), end(1)


def mean(function, line, inside):
    start, end = chord(line, inside)
    return quad(lambda s: function(*((1 - s) * start + s * end)), 0, 1, epsabs=1e-13)[0]


def crossing(first, second):
    return np.linalg.solve([first[:2], second[:2]], [first[2], second[2]])


def f(px, py):
    return np.exp(px / 3) * np.cos(py) + px * py


@pytest.mark.random
@pytest.mark.parametrize("kind", ["auto", "squared"])
@pytest.mark.parametrize("count", [2, 3, 4, 5])
@pytest.mark.parametrize("name", DOMAINS)
def test_values_at_the_nodes_and_means_along_the_lines_are_met(name, count, kind):
    domain, inside = DOMAINS[name]
    lines = LINES[:count]
    found = ProjectionOperator(lines, domain, kind)(sp.exp(x / 3) * sp.cos(y) + x * y)
    value = sp.lambdify((x, y), found.expression)
    places = [crossing(a, b) for a, b in itertools.combinations(lines, 2)]
    assert_close([value(*place) for place in places], [f(*place) for place in places], atol=2e-13)
    means = [mean(f, line, inside) for line in lines]
    assert_close([mean(value, line, inside) for line in lines], means, atol=1e-12)
    px, py = np.meshgrid(np.linspace(-1, 1, 5), np.linspace(-1, 1, 4))
    assert_close(found(px, py), value(px, py), atol=1e-13)


def test_the_unit_triangle_has_the_closed_formula():
    f00, f10, f01, m_y, m_x, m_d = data = sp.symbols("f00 f10 f01 m_y m_x m_d", real=True)
    found = ProjectionOperator(SIDES, UNIT).of_data(data[:3], data[3:]).expression
    corners = (1 - x - y) * f00 + x * f10 + y * f01
    sides = (m_y - (f00 + f10) / 2) * x * (1 - x - y) + (m_x - (f00 + f01) / 2) * y * (1 - x - y)
    assert sp.expand(found - corners - 6 * (sides + (m_d - (f10 + f01) / 2) * x * y)) == 0
    letters = dict.fromkeys(map(str, data), 2)
    assert_close(ProjectionOperator(SIDES, UNIT).of_data(data[:3], data[3:])(0.2, 0.3, letters=letters), 2, atol=1e-14)


@pytest.mark.random
@pytest.mark.parametrize("kind", ["min", "squared"])
@pytest.mark.parametrize("count", [2, 3, 4])
def test_polynomials_up_to_the_degree_stated_are_reproduced_and_no_others(count, kind):
    operator = ProjectionOperator(LINES[:count], DISC, kind)
    assert operator.reproduces == (count - 1 if kind == "min" else count - 2)
    assert operator.degree == (count - 1 if kind == "min" else 2 * count - 2)
    for i, j in itertools.product(range(operator.reproduces + 1), repeat=2):
        if i + j <= operator.reproduces:
            assert sp.expand(operator(x**i * y**j).expression - x**i * y**j) == 0
    beyond = x ** (operator.reproduces + 1)
    assert sp.expand(operator(beyond).expression - beyond) != 0


@pytest.mark.parametrize("domain", [DISC, TRIANGLE])
def test_an_operator_applied_twice_is_the_operator(domain):
    operator = ProjectionOperator(LINES[:4], domain)
    once = operator(x**3 * y - 3 * x**5 + y)
    assert sp.expand(operator(once).expression - once.expression) == 0


@pytest.mark.slow
def test_the_means_of_a_disc_are_the_integrals_of_sympy():
    """Exact, though the ends of the chords are roots."""
    s = sp.Symbol("s")
    operator = ProjectionOperator([x - 1, x + 2 * y], DISC)
    half = sp.sqrt(8)
    assert operator.chords[0].mean(x**2 * y**4) == sp.simplify(sp.integrate(s**4, (s, -half, half)) / (2 * half))
    assert all(one.is_Rational for one in sp.Poly(operator(x**2 * y**4).expression, x, y).coeffs())
    assert sp.simplify(operator.chords[1].length - 6) == 0


def test_an_affine_map_of_everything_maps_the_result():
    u, v = 2 * x - y / 3 + 1, x / 2 + 3 * y - 2
    change = sp.Matrix([u.diff(x), u.diff(y)]), sp.Matrix([v.diff(x), v.diff(y)])
    corners = [tuple(sp.Matrix.hstack(*change).T.solve(sp.Matrix([a - 1, b + 2]))) for a, b in TRIANGLE]
    both = {x: u, y: v}
    equations = [sp.nsimplify(a) * x + sp.nsimplify(b) * y - sp.nsimplify(c) for a, b, c in LINES[:4]]
    function = x**4 - y**3 + x * y
    here = ProjectionOperator(equations, TRIANGLE)
    there = ProjectionOperator([one.subs(both, simultaneous=True) for one in equations], corners)
    assert here.kinds == there.kinds
    mapped = here(function).expression.subs(both, simultaneous=True)
    assert sp.expand(mapped - there(function.subs(both, simultaneous=True)).expression) == 0


def test_where_a_mean_is_zero_the_square_takes_its_place():
    """Innocent lines: on x = 0 the nodes 0, 1 and -1/4 and the square's ends."""
    lines, square = (
        [x, y, x + y - 1, x - 2 * y - sp.Rational(1, 2)],
        rsym.conjunction((x + 1) * (2 - x), (y + 1) * (2 - y)),
    )
    with pytest.raises(rsym.RsymError, match=r"along y = 0 .* mean 0.*remedy: kind='auto'"):
        ProjectionOperator(lines, square, "min")
    found = ProjectionOperator(lines, square)
    assert found.kinds[1] == "squared"
    assert "min" in found.kinds
    interpolant = found(x**5 * y + y**4)
    for one, chord_found in zip(interpolant.means, found.chords, strict=True):
        assert sp.simplify(one - chord_found.mean(interpolant.expression)) == 0


def test_functions_integrals_and_names_of_nodes():
    operator = ProjectionOperator(SIDES, UNIT)
    called, written = operator(f), operator(sp.exp(x / 3) * sp.cos(y) + x * y)
    px, py = np.array([0.1, 0.4]), np.array([0.5, 0.2])
    assert_close(called(px, py), written(px, py), atol=1e-13)
    lengths = [1, 1, math.sqrt(2)]
    integrals = [float(one) * length for one, length in zip(written.means, lengths, strict=True)]
    values = dict(reversed(list(written.values.items())))
    assert_close(operator.of_data(values, integrals=integrals)(px, py), written(px, py), atol=1e-13)
    points = [(sp.Point(0, 0), sp.Point(1, 0)), ((0, 0), (0, 2)), sp.Eq(x + y, 1)]
    assert ProjectionOperator(points, [sp.Point(*one) for one in UNIT]).nodes == operator.nodes


def test_the_graph_is_a_patch():
    patch = ProjectionOperator(SIDES, UNIT)(x**2 - y**2 + x * y).graph(((0, 1), (0, 1)))
    assert_close(patch(0.5, 0.25), [0.5, 0.25, 0.3125], atol=1e-15)
    # K = det(Hessian)/(1 + |gradient|**2)**2 of z = x**2 - y**2 + x*y at the origin.
    assert_close(patch.gaussian_curvature(0, 0), -5, atol=1e-12)
    assert patch.grid([0, 1], [0, 0.5, 1]).shape == (2, 3, 3)


BUMP = sp.exp(1) - sp.exp(x**2 / 4 + y**2)  # the ellipse x**2/4 + y**2 = 1, not a polynomial
LENS = rsym.conjunction(2 - x**2 - y**2, sp.Rational(5, 2) - (x - 1) ** 2 - y**2, system=rsym.Rp(4))


@pytest.mark.parametrize(
    ("domain", "half"),
    [
        (rsym.Shape(BUMP, (x, y), bounds=((-3, 3), (-3, 3))), math.sqrt(3) / 2),
        (1 - x**4 / 16 - y**4, (1 - 1 / 16) ** 0.25),
        (rsym.conjunction(LENS, x + 1, 3 - x), 1.0),
        (rsym.conjunction(-2 * (x - 1) * (x + 3), 1 - y**2, system=rsym.R1), 1.0),
    ],
)
def test_chords_end_on_the_boundary_whatever_it_is_written_with(domain, half):
    """The line x = 1 or, where that is a side, along the side."""
    operator = ProjectionOperator([(1, 0, 1), y - sp.Rational(1, 4)], domain)
    (start, end) = np.array(operator.chords[0].ends, float)
    assert_close(sorted([start[1], end[1]]), [-half, half], atol=2e-15)
    assert_close([start[0], end[0]], [1, 1], atol=1e-15)


WEDGE = rsym.disjunction(rsym.conjunction(1 - x**2, 9 - y**2), rsym.conjunction(9 - x**2, 1 - y**2))


@pytest.mark.parametrize(
    ("lines", "domain", "said"),
    [
        ([x], DISC, "at least two lines, got 1"),
        ([x, (0, 0, 1)], DISC, r"lines\[1\]: a line needs a or b"),
        ([x, x * y - 1], DISC, r"lines\[1\]: expected a line, got x\*y - 1"),
        ([x, "y = 1"], DISC, r"expected a line, got 'y = 1'"),
        ([x, y, 2 * x - 3], DISC, r"lines\[0\] and lines\[2\]: the lines x = 0 and 2\*x = 3 are parallel"),
        ([x, y, x - y], DISC, r"lines\[0\], lines\[1\] and lines\[2\]: three lines go through one point, \(0, 0\)"),
        ([x, y - 4], DISC, r"lines\[1\]: the line y = 4 misses the domain"),
        ([x, y - 3], DISC, "misses the domain"),
        ([x, (1, 2, 3, 4)], DISC, r"expected a line, got \(1, 2, 3, 4\)"),
        ([x, ((0, 0), (1, sp.oo))], DISC, "must be a finite real number"),
        ([x - 2, y - 1, x + y - 4], DISC, r"cross outside the domain, at \(3, 1\)"),
        ([x, y + x, y - x - 2.2], WEDGE, "in several pieces: it is not convex"),
        ([x, y], rsym.conjunction(x + 1, 1 - y**2), "does not end along y = 0"),
        ([x, y], rsym.Shape(BUMP, (x, y), bounds=((-1, 1), (-1.5, 1.5))), "does not end along y = 0"),
        ([x, y], [(0, 0), (1, 1), (1, 0), (0, 1)], "not those of a convex polygon"),
        ([x, y], "disc", "expected a domain, got 'disc'"),
        ([x, y], rsym.Shape(1 - x**2 - y**2 - rsym.z**2, (x, y, rsym.z)), "in the plane"),
    ],
)
def test_what_is_refused(lines, domain, said):
    with pytest.raises(rsym.RsymError, match=said):
        ProjectionOperator(lines, domain)


def test_data_that_are_refused():
    operator = ProjectionOperator(SIDES, UNIT)
    with pytest.raises(rsym.RsymError, match="no kind 'cubed'; remedy: choose from auto, min, squared"):
        ProjectionOperator(SIDES, UNIT, "cubed")
    with pytest.raises(rsym.RsymError, match=r"3 values at the nodes and 3 projections .* got 3 and 2"):
        operator.of_data([1, 2, 3], [1, 2])
    with pytest.raises(rsym.RsymError, match="either the means"):
        operator.of_data([1, 2, 3])
    with pytest.raises(rsym.RsymError, match=r"the value where lines\[0\] and lines\[2\] cross depends on x or y"):
        operator.of_data([1, x, 3], [1, 2, 3])
    with pytest.raises(rsym.RsymError, match="with a in it; remedy: put numbers"):
        operator(sp.sin(sp.Symbol("a") * x + y))
    with pytest.raises(rsym.RsymError, match="quadrature"):
        operator(lambda px, py: 1 / (px - 0.3) ** 2)


@pytest.mark.parametrize(("shift", "kind"), [(0.117, "squared"), (0.119, "min")])
def test_auto_takes_min_where_the_mean_is_a_fifth_of_the_root_mean_square(shift, kind):
    """On y = 0, -1 <= x <= 1, the mean of x - d is -d and its mean square 1/3 + d**2: a fifth at d = 0.1179."""
    operator = ProjectionOperator([y, x - shift], rsym.conjunction(1 - x**2, (y + 1) * (3 - y)))
    assert operator.kinds == (kind, "min")


@pytest.mark.slow
def test_all_roots_of_a_function_are_found():
    roots, sign = roots_between(sp.sin(60 * t) + sp.cos(t) / 10, 0.0, 3.0)
    grid = np.linspace(0, 3, 20001)
    values = np.sin(60 * grid) + np.cos(grid) / 10
    crossed = np.flatnonzero(values[:-1] * values[1:] < 0)
    assert len(roots) == len(crossed) == 57
    assert_close([float(root) for root in roots], grid[crossed] + 7.5e-5, atol=7.6e-5)
    assert [sign(0.02), sign(0.07)] == [1, -1]
