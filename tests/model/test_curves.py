"""Curves: zero on the curve alone, and as normalised on every side of it as they say."""

import math
from dataclasses import dataclass
from itertools import pairwise

import flint
import numpy as np
import pytest
import sympy as sp
from flint import arb, arb_series
from oracles.boundary_points import _in_order, _rotation
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.model.primitives.curves import arc, circle, graph, helix, polyline, segment, space_curve

BITS = 720  # some 216 digits: series beside a curve lose 7*18 of them, trimming another 72
BESIDE = arb(2) ** -60  # where one-sided limits are taken: what is not constant there is below every tolerance
A, R, T, L = sp.symbols("a r t L", real=True)
CORNERS = [(0, 0), (3, 1), (2, 3), (-1, 2)]
SPATIAL = [(0, 0, 0), (3, 1, -1), (2, 3, 1)]


@pytest.fixture(autouse=True)
def many_digits():
    before, flint.ctx.prec = flint.ctx.prec, BITS
    yield
    flint.ctx.prec = before


@dataclass(frozen=True)
class Case:
    """A shape, the order it states and the curve it shall be zero on: (point, tangent) at s from 0 to 1."""

    shape: Shape
    order: int
    curve: object


def vector(*components):
    return np.array([item if isinstance(item, arb) else ball(sp.Rational(item)) for item in components], object)


def ball(number):
    return arb(flint.fmpq(int(number.p), int(number.q)))


def along(*corners):
    """A polyline, each of its sides for an equal part of s."""
    sides = list(pairwise([vector(*corner) for corner in corners]))

    def curve(s):
        k = min(int(float(s) * len(sides)), len(sides) - 1)
        start, end = sides[k]
        return start + (s * len(sides) - k) * (end - start), end - start

    return curve


def around(centre, radius, start, end, first=(1, 0), second=(0, 1)):
    """An arc."""

    def curve(s):
        axes = [vector(*axis) for axis in (centre, first, second)]
        ends = vector(start, end)
        angle = ends[0] + s * (ends[1] - ends[0])
        cosine, sine = angle.cos(), angle.sin()
        return axes[0] + radius * (axes[1] * cosine + axes[2] * sine), axes[2] * cosine - axes[1] * sine

    return curve


def winding(radius, pitch, turns):
    """A helix."""

    def curve(s):
        angle = 2 * arb.pi() * turns * s
        cosine, sine = radius * angle.cos(), radius * angle.sin()
        return vector(cosine, sine, pitch * turns * s), vector(-sine, cosine, pitch / (2 * arb.pi()))

    return curve


TILTED = {"first": (1, 0, 0), "second": (0, sp.Rational(4, 5), -sp.Rational(3, 5))}  # about the axis (0, 3, 4)
CASES = {
    "segment": Case(segment((-1, 2), (3, 1)), 6, along((-1, 2), (3, 1))),
    "segment with letters": Case(segment((-A, 0), (A, R), letters={A: 2, R: 1}), 6, along((-2, 0), (2, 1))),
    "segment in space": Case(segment((-1, 2, 0), (3, 1, 2)), 6, along((-1, 2, 0), (3, 1, 2))),
    "polyline, order 1": Case(polyline(CORNERS, order=1), 1, along(*CORNERS)),
    "polyline": Case(polyline(CORNERS, closed=True), 2, along(*CORNERS, CORNERS[0])),
    "polyline in space, order 4": Case(polyline(SPATIAL, order=4), 4, along(*SPATIAL)),
    "graph": Case(graph(SPATIAL, [(1, 0), (2, 1), (0, 2)]), 2, along(*SPATIAL, SPATIAL[0])),
    "short arc": Case(arc(2, 1, sp.Rational(9, 5), (1, 2)), 1, around((1, 2), 2, 1, sp.Rational(9, 5))),
    "long arc": Case(arc(2, -2, 4, (1, 2)), 1, around((1, 2), 2, -2, 4)),
    "exact arc": Case(arc(R, -T, T, exact=True, letters={R: 2, T: 2}), 6, around((0, 0), 2, -2, 2)),
    "arc in space": Case(arc(2, 0, 4, (1, 0, 2), axis=(0, 3, 4)), 1, around((1, 0, 2), 2, 0, 4, **TILTED)),
    "exact arc in space": Case(
        arc(2, 1, 2, (1, 0, 2), axis=(0, 3, 4), exact=True), 6, around((1, 0, 2), 2, 1, 2, **TILTED)
    ),
    "circle": Case(circle(3, (1, 2)), 1, around((1, 2), 3, 0, math.tau)),
    "circle in space": Case(circle(2, (1, 0, 2), axis=(0, 3, 4)), 1, around((1, 0, 2), 2, 0, math.tau, **TILTED)),
    "helix": Case(helix(2, 1), 1, winding(2, 1, 2)),
    "helix with ends": Case(helix(1, R, 2, letters={R: 3}), 1, winding(1, 3, 2)),
    "circle where a sphere meets a plane": Case(
        space_curve(Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z)), (3 * y + 4 * z) / 5),
        1,
        around((0, 0, 0), 2, 0, math.tau, **TILTED),
    ),
}
CLOSED = {"circle", "circle in space", "circle where a sphere meets a plane", "helix"}


def shares(random, count, name):
    """Places on a curve, away from ends and corners."""
    sides = {"polyline, order 1": 3, "polyline": 4, "polyline in space, order 4": 2, "graph": 3}.get(name, 1)
    clear = 0 if name in CLOSED else 0.05
    return map(float, (random.integers(sides, size=count) + clear + (1 - 2 * clear) * random.random(count)) / sides)


def normal(tangent, random):
    """A unit vector at right angles, on one of two sides or in any direction."""
    if len(tangent) == 2:
        way = vector(-tangent[1], tangent[0]) * int(random.choice([-1, 1]))
    else:
        free = vector(*map(float, random.normal(size=3)))
        way = free - tangent * ((free @ tangent) / (tangent @ tangent))
    return way / (way @ way).sqrt()


def in_motion(shape, random):
    """The shape turned and moved at random, and the same motion for points and for directions."""
    rows = _rotation(shape.dimension, random)
    move = [sp.Rational(int(item), 10) for item in random.integers(-30, 31, shape.dimension)]
    back = sp.Matrix(rows).T * (sp.Matrix(shape.coordinates) - sp.Matrix(move))
    expression = shape.expression.xreplace(dict(zip(shape.coordinates, back, strict=True)))
    turn = np.array([[ball(entry) for entry in row] for row in rows], object)
    return Shape(expression, shape.coordinates, letters=shape.letters), turn, vector(*map(ball, move))


class Along:
    """The series of a shape in s at place + s*way, from its formula in plain roots."""

    def __init__(self, shape):
        values = {sp.Symbol(name, real=True): letter.default for name, letter in shape.letters.items()}
        root = shape.expression.doit().xreplace({symbol: sp.sympify(value) for symbol, value in values.items()})
        parts = [*shape.coordinates, *(part for part in _in_order(root) if part not in shape.coordinates)]
        number = {part: k for k, part in enumerate(parts)}
        steps = [(k, part, [number[item] for item in part.args]) for part, k in number.items()]
        self.steps = [step for step in steps[shape.dimension :] if step[1].free_symbols]
        self.root, self.known = number[root], [None] * len(parts)
        for k, part, arguments in steps:
            if not part.free_symbols:
                self.known[k] = self.value(part, [self.known[a] for a in arguments])

    def __call__(self, place, way, order):
        """Derivatives up to an order."""
        known = [arb_series([c, d], prec=order + 1) for c, d in zip(place, way, strict=True)]
        known += self.known[len(known) :]
        for k, part, arguments in self.steps:
            known[k] = self.value(part, [known[a] for a in arguments])
        return [known[self.root][k] * math.factorial(k) for k in range(order + 1)]

    def value(self, part, inner):
        if part.is_Rational or part is sp.pi:
            return arb.pi() if part is sp.pi else ball(part)
        if part.is_Add:
            return sum(inner[1:], inner[0])
        if part.is_Mul:
            return math.prod(inner[1:], start=inner[0])
        if part.is_Pow:
            return self.power(inner[0], part.exp)
        if isinstance(part, sp.Abs):
            return inner[0] if inner[0][0] > 0 else -inner[0]  # of a series
        return inner[0].sin() if isinstance(part, sp.sin) else inner[0].cos()

    def power(self, base, exponent):
        for _ in range(int(exponent.q).bit_length() - 1):
            base = base.sqrt()
        base = base if exponent > 0 else 1 / base
        return math.prod([base] * (abs(int(exponent.p)) - 1), start=base)


@pytest.mark.random
@pytest.mark.parametrize("name", CASES)
def test_a_curve_is_normalised_to_its_order_on_every_side_and_not_beyond(name):
    """One-sided limits of gradients and of higher derivatives along normals, at 200 places in two motions."""
    case, random = CASES[name], np.random.default_rng(7)
    sizes, higher, beyond = [], [], []
    for _ in range(2):
        shape, turn, shift = in_motion(case.shape, random)
        series = Along(shape)
        for share in shares(random, 100, name):
            place, tangent = case.curve(arb(share))
            way = turn @ normal(tangent, random)
            beside = turn @ place + shift + BESIDE * way
            value, slope, *rest = series(beside, way, case.order + 1)
            assert abs(float(value / BESIDE) - 1) < 1e-15
            gradient = [series(beside, vector(*axis), 1)[1] for axis in np.eye(shape.dimension)]
            sizes.extend([float(slope), float(sum(item**2 for item in gradient).sqrt())])
            higher.extend(map(float, rest[:-1]))
            beyond.append(abs(float(rest[-1])))
    assert_close(sizes, np.ones(400), atol=1e-15)
    assert_close(higher, np.zeros(200 * (case.order - 1)), atol=1e-12)
    assert max(beyond) > 1e-3, "it is normalised to a higher order than it says"


@pytest.mark.parametrize("exact", [False, True])
def test_an_exact_circle_is_a_distance(exact):
    shape = circle(3, (1, 2), exact=exact)
    points = np.random.default_rng(0).uniform(-6, 6, (2, 100))
    radii = np.hypot(points[0] - 1, points[1] - 2)
    truth = abs(3 - radii) if exact else abs(9 - radii**2) / 6
    assert_close(rsym.compile(shape)(*points)["value"], truth, atol=1e-13)


@pytest.mark.random
@pytest.mark.parametrize("name", CASES)
def test_a_curve_is_positive_off_itself(name):
    """Also where what was trimmed off would go on; never less than a tenth of the distance, near it about as much."""
    case, random = CASES[name], np.random.default_rng(3)
    curve, box = case.curve, (case.shape.box and case.shape.box.ends) or ((-3, 3), (-3, 3), (-3, 3))
    if name == "helix":
        curve, box = winding(2, 1, 6), ((-3, 3), (-3, 3), (2, 4))
    dense = np.array([curve(k / 800)[0] for k in range(801)], float)
    points = np.array([random.uniform(*side, 400) for side in box])
    distances = np.sqrt(((points.T[:, None, :] - dense) ** 2).sum(-1)).min(axis=1)
    values = rsym.compile(case.shape)(*points)["value"]
    assert (values[distances > 0.05] > 0.1 * distances[distances > 0.05]).all()
    near = distances < 0.1
    assert (values[near] < 3 * distances[near]).all()
    if case.shape.box:
        assert (np.array(box)[:, 0] < dense.min(axis=0)).all()
        assert (np.array(box)[:, 1] > dense.max(axis=0)).all()


def test_what_goes_on_beyond_the_ends_is_cut_off():
    """On the line and on the circle, outside the kept part."""
    assert (rsym.compile(segment((-1, 0), (1, 0)))([1.01, 2, -5.0], [0.0, 0, 0])["value"] > [0.009, 0.9, 3.9]).all()
    for start, end in ((0.2, 1.0), (-2.0, 4.0)):
        angles = np.linspace(end, start + 2 * np.pi, 22)[1:-1]
        values = rsym.compile(arc(2, start, end))(2 * np.cos(angles), 2 * np.sin(angles))["value"]
        ends = np.minimum(angles - end, start + 2 * np.pi - angles)
        assert (values > ends / 2).all()


@pytest.mark.random
@pytest.mark.parametrize("name", sorted(CASES.keys() - CLOSED - {"polyline", "graph"}))
def test_beyond_an_end_the_field_begins_as_the_distance(name):
    """Straight on, and also across: what trims the curve is at right angles to it."""
    kernel, step, random = rsym.compile(CASES[name].shape), 1e-6, np.random.default_rng(5)
    for end, way in ((0, -1), (1, 1)):
        place, tangent = CASES[name].curve(arb(end))
        ahead = np.array(tangent, float) / np.linalg.norm(np.array(tangent, float)) * way
        across = np.array([normal(tangent, random) for _ in range(6)], float)
        points = np.array(place, float) + step * np.vstack([ahead, across])
        assert_close(kernel(*points.T)["value"], np.full(7, step), rtol=1e-3)


def test_an_arc_of_a_large_circle_is_a_segment():
    radius = sp.Integer(10) ** 6
    bow, rod = arc(radius, sp.pi / 2 - 1 / radius, sp.pi / 2 + 1 / radius, (0, -radius)), segment((-1, 0), (1, 0))
    points = np.random.default_rng(1).uniform(-2, 2, (2, 50))
    assert_close(rsym.compile(bow)(*points)["value"], rsym.compile(rod)(*points)["value"], atol=1e-3)


@pytest.mark.slow
def test_trimming_begins_with_f_and_its_seventh_power():
    """f + f**7/(32 t**2) + ...; for a segment with the t of its disc, t_0 - f**2/L, too."""
    f, t, length = sp.symbols("f t L", positive=True)
    for kept in (t, t - f**2 / length):  # of squares, which differ by 2 f times what the roots differ by
        square = sp.series(sp.expand(rsym.trimming(f, kept).doit() ** 2), f, 0, 9).removeO()
        assert sp.expand(square - (f + f**7 / (32 * t**2)) ** 2).as_poly(f).monoms()[-1][0] > 8
    disc = rsym.trimming(f, t - f**2 / length).doit()
    rod = segment((0, 0), (L, 0), letters={L: 5}).expression.doit().subs(L, length)
    assert sp.simplify((rod - disc.subs(t, x * (length - x) / length)).subs(y, f)) == 0


@pytest.mark.random
@pytest.mark.parametrize("order", [1, 2, 4])
def test_joining_is_associative(order):
    """As an identity, to fifty digits and as a program."""
    f, g, h = sp.symbols("f g h", positive=True)
    left = rsym.joining(rsym.joining(f, g, order=order), h, order=order)
    right = rsym.joining(f, rsym.joining(g, h, order=order), order=order)
    assert left != right
    for grouped in (left, right):
        assert sp.simplify((grouped.doit() ** -order) - (f**-order + g**-order + h**-order)) == 0
    numbers = {f: sp.Rational(3, 7), g: sp.Rational(11, 5), h: sp.Rational(1, 9)}
    values = [grouped.subs(numbers).evalf(50) for grouped in (left, right)]
    assert abs(values[0] - values[1]) < sp.Float(10) ** -49
    points = np.random.default_rng(2).uniform(0.1, 3, (3, 100))
    spatial = [Shape(grouped.subs({f: x, g: y, h: z}), (x, y, z)) for grouped in (left, right)]
    first, second = (rsym.compile(shape)(*points)["value"] for shape in spatial)
    assert_close(first, second, rtol=1e-14)
    assert_close(first, (points**-order).sum(axis=0) ** (-1 / order), rtol=1e-13)


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: segment((0, 0), (0, 0)), "points"),
        (lambda: segment((0, 0), (1, 0, 0)), "point"),
        (lambda: segment((0, 0), (A, 0)), "unknown-letter"),
        (lambda: polyline([(0, 0)]), "points"),
        (lambda: polyline(3), "points"),
        (lambda: polyline([(0, 0), (1, 0)], order=0), "order"),
        (lambda: graph([(0, 0), (1, 0)], [(0, 2)]), "edges"),
        (lambda: graph([(0, 0), (1, 0)], [(0, 1.5)]), "integer"),
        (lambda: graph([(0, 0), (1, 0)], []), "edges"),
        (lambda: arc(-1, 0, 1), "positive"),
        (lambda: arc(1, 1, 0), "angles"),
        (lambda: arc(1, 0, 2 * sp.pi), "angles"),
        (lambda: arc(1, 0, 1, (0, 0, 0), axis=(0, 0, 0)), "direction"),
        (lambda: arc(1, 0, 1, axis=(0, 0, 1)), "axis"),
        (lambda: space_curve(Shape(x, (x, y)), z), "coordinates"),
        (lambda: helix(1, 0), "positive"),
    ],
)
def test_what_is_no_curve_is_refused(make, code):
    with pytest.raises(RsymError) as caught:
        make()
    assert caught.value.code == code
