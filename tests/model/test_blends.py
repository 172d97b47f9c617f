"""Blends against their formulas as books have them: circle, class, order, monotonicity, stability, intervals."""

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import R0, RsymError, Shape, conjunction, disjunction, x, y
from rsym.model.blends.displacement import bounded_blend, displacement_blend
from rsym.model.blends.rho import LARGEST_COEFFICIENT, Rho
from rsym.model.blends.sardf import Sardf
from rsym.model.nodes import written_out

FIFTH, THIRD = sp.Rational(1, 5), sp.Rational(1, 3)
BOX = ((-1, 1), (-1, 1))
SYSTEMS = [
    Rho(FIFTH),
    Rho(FIFTH, cosine=THIRD),
    Rho(FIFTH, "G2"),
    Rho(FIFTH, "G2", cosine=-THIRD, coefficient=sp.Rational(1, 2)),
    Sardf(),
    Sardf(2),
]


def book_conjunction(system, f, g):
    """The definition, at the precision of the arguments, with no care for rounding."""
    if isinstance(system, Sardf):
        ratio = mp.mpf(system.ratio.p) / system.ratio.q
        if f <= 0 and g <= 0:
            return -mp.hypot(f, g)
        low, high = min(f, g), max(f, g)
        if high >= (1 + ratio) * low:
            return low
        # |(f, g) - (1 + ratio)*c*(1, 1)| = ratio*c, the larger c.
        leading, linear = 2 * (1 + ratio) ** 2 - ratio**2, (1 + ratio) * (f + g)
        return (linear + mp.sqrt(linear**2 - leading * (f * f + g * g))) / leading
    rho, cosine, *rest = (mp.mpf(parameter.p) / parameter.q for parameter in system.parameters)
    reach = rho * (1 - cosine)
    square = f * f + g * g - 2 * cosine * f * g
    s = square - reach**2
    lift = rest[0] * max(-s, 0) ** 3 / reach**4 if rest else s * (s - abs(s)) / (8 * reach**2)
    return (f + g - mp.sqrt(square + lift)) / (1 + cosine)


def book_carried(system, f, g):
    """What a third operand is blended with: of circles the distance from the rounded edge."""
    if not isinstance(system, Rho) or system.continuity == "G2":
        return book_conjunction(system, f, g)
    rho, cosine = (mp.mpf(parameter.p) / parameter.q for parameter in system.parameters)
    u, v = rho - f, rho - g
    if u > cosine * v and v > cosine * u:
        return rho - mp.sqrt((u * u + v * v - 2 * cosine * u * v) / (1 - cosine**2))
    return min(f, g)


def book(system, sign, *values):
    """The left fold, the disjunction by duality."""
    head, *rest, last = (-sign * value for value in values)
    for value in rest:
        head = book_carried(system, head, value)
    return -sign * book_conjunction(system, head, last)


@pytest.fixture
def random():
    return np.random.default_rng(20)


@pytest.mark.random
@pytest.mark.parametrize("system", SYSTEMS, ids=str)
@pytest.mark.parametrize(("operation", "sign"), [(conjunction, -1), (disjunction, 1)])
def test_every_route_gives_the_formula(system, operation, sign, random):
    points = random.uniform(-0.6, 0.8, (2, 300))
    expression = operation(x, y, 1 - x - y, system=system)
    shape = Shape(expression, (x, y), bounds=BOX)
    with mp.workdps(40):
        expected = [float(book(system, sign, mp.mpf(a), mp.mpf(b), 1 - mp.mpf(a) - mp.mpf(b))) for a, b in points.T]
    for function in (rsym.compile(shape), rsym.compile(shape, backend="numpy"), rsym.lambdify(shape)):
        assert_close(function(*points)["value"], expected, atol=6e-15)
    # Point by point: old versions of SymPy print a minimum of a number and an array as one of a ragged list.
    plain = sp.lambdify((x, y), expression.doit())
    assert_close([plain(*point) for point in points.T], expected, atol=4e-14)
    exact = expression.subs(dict(zip((x, y), map(sp.Rational, points[:, 0]), strict=True))).evalf(30)
    assert float(exact) == expected[0]


@pytest.mark.random
@pytest.mark.parametrize("system", SYSTEMS, ids=str)
def test_derivatives_are_those_of_the_formula_at_the_edge_too(system):
    shape = Shape(conjunction(x, y, system=system), (x, y))
    points = [(0.3, 0.05), (0.05, 0.07), (0.004, -0.003), (-0.1, 0.02), (-0.3, -0.4), (0.4, 0.5), (0.09, 0.09)]
    if isinstance(system, Rho):
        points.append((0.0, 0.0))
    got = rsym.compile(shape, ("gradient", "hessian"))(*np.transpose(points))
    symbolic = sp.lambdify((x, y), list(rsym.gradient(shape)))
    for k, point in enumerate(points):
        with mp.workdps(40):

            def function(f, g):
                return book_conjunction(system, f, g)

            first = [float(mp.diff(function, point, order)) for order in ((1, 0), (0, 1))]
            second = [float(mp.diff(function, point, order)) for order in ((2, 0), (1, 1), (0, 2))]
        assert_close(got["gradient"][k], first, atol=2e-14)
        assert_close(got["hessian"][k][[0, 0, 1], [0, 1, 1]], second, atol=2e-12)
        if any(point):
            with np.errstate(invalid="ignore"):
                assert_close(symbolic(*map(np.float64, point)), first, atol=2e-14)


@pytest.mark.parametrize("continuity", ["G1", "G2"])
def test_derivatives_exist_where_the_fillet_ends(continuity):
    """In binary exactly on the end: max would have no derivative there."""
    kernel = rsym.compile(Shape(conjunction(x, y, system=Rho(sp.Rational(1, 4), continuity)), (x, y)), ("gradient",))
    assert_close(kernel([0.25, 0.0], [0.0, 0.25])["gradient"], [[0, 1], [1, 0]], atol=1e-16)


@pytest.mark.parametrize("system", SYSTEMS, ids=str)
def test_signs_of_small_operands_are_kept(system):
    kernel = rsym.compile(Shape(conjunction(x, y, system=system), (x, y)))
    assert_close(kernel([1e-20, -1e-20, 1e-300], [1.0, 1.0, 2.0])["value"], [1e-20, -1e-20, 1e-300], rtol=1e-15)


@pytest.mark.random
@pytest.mark.parametrize("system", SYSTEMS, ids=str)
@pytest.mark.parametrize("operation", [conjunction, disjunction])
def test_intervals_contain_the_values_and_are_sharp(system, operation, random):
    shape = Shape(operation(x, y, system=system), (x, y))
    corner = random.uniform(-0.5, 0.5, (400, 2))
    boxes = np.stack([corner, corner + 0.01], -1)
    bounds = rsym.enclose(shape, boxes)["value"]
    places = corner + 0.01 * random.uniform(0, 1, (50, 400, 2))
    values = rsym.compile(shape)(places[..., 0], places[..., 1])["value"]
    assert (values >= bounds[:, 0]).all()
    assert (values <= bounds[:, 1]).all()
    # Monotone operations take their extremes in corners.
    low, high = (rsym.compile(shape)(*boxes[..., end].T)["value"] for end in (0, 1))
    assert np.max((bounds[:, 1] - bounds[:, 0]) / (high - low)) < 4
    assert np.median((bounds[:, 1] - bounds[:, 0]) / (high - low)) < 1 + 1e-7


@pytest.mark.slow
def test_the_fillet_is_a_circle_whatever_the_angle():
    """Planes with unit normals (1, 0) and (c, s): the circle about the point at distance rho from both divides."""
    rho, c, s, p, q = sp.symbols("rho c s p q", real=True)
    f, g = p, c * p + s * q
    written = Rho(rho, cosine=c).conjunction(x, y).doit()
    inside = written.replace(sp.Abs, lambda u: -u).subs({x: f, y: g})
    (root,) = (part for part in sp.preorder_traversal(inside) if part.is_Pow and part.exp == sp.Rational(1, 2))
    product = sp.expand((f + g) ** 2 - root.base)
    height = rho * (1 - c) / s
    circle = sp.expand(rho**2 - (p - rho) ** 2 - (q - height) ** 2)
    t = sp.Symbol("t", real=True)
    angle = {c: (1 - t**2) / (1 + t**2), s: 2 * t / (1 + t**2)}
    quotient, rest = sp.div(sp.together(product.subs(angle)), sp.together(circle.subs(angle)), p, q)
    assert sp.simplify(quotient) != 0
    assert sp.simplify(rest) == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("angle", "operation", "sign"), [(sp.pi / 2, disjunction, -1), (sp.pi / 3, conjunction, 1), (2, disjunction, -1)]
)
def test_planes_at_any_angle_get_the_radius_and_the_field_stays_normalised(angle, operation, sign):
    faces = x, y * sp.sin(angle) - x * sp.cos(angle)
    shape = Shape(operation(*faces, system=Rho(FIFTH, cosine=-sp.cos(angle))), (x, y), bounds=BOX)
    report = rsym.verify_smoothness(shape)
    assert (report.verdict, report.continuity) == ("REFUTED", "G1")
    assert_close([joint.curvature_jump for joint in report.defects], [5, 5], rtol=1e-12)
    half = float(angle) / 2
    middle = 0.2 * (1 / np.sin(half) - 1) * sign
    fields = rsym.compile(shape, ("value", "gradient", "curvature"))(middle * np.sin(half), middle * np.cos(half))
    assert_close(fields["value"], 0, atol=1e-16)
    assert_close(np.hypot(*fields["gradient"]), 1, rtol=1e-14)
    assert_close(fields["curvature"], 5 * sign, rtol=1e-13)


@pytest.mark.slow
@pytest.mark.parametrize(("cosine", "operation"), [(0, conjunction), (THIRD, disjunction)])
def test_the_cubic_is_proved_to_have_continuous_curvature(cosine, operation):
    system = Rho(FIFTH, "G2", cosine=cosine)
    report = rsym.verify_smoothness(Shape(operation(x, y, system=system), (x, y), bounds=BOX))
    assert (report.verdict, report.continuity) == ("CERTIFIED", "G2")


def test_the_cubic_leaves_the_sharp_operation_in_third_order():
    """On the face, at distance e inside the tube, the difference is k*(2 e/rho)**3*rho**2/(2 rho) + ..."""
    system = Rho(2, "G2")
    with mp.workdps(80):
        near = mp.mpf(10) ** -20
        difference = conjunction(x, y, system=R0) - conjunction(x, y, system=system)
        value = difference.subs({x: 0, y: 2 - sp.Rational(1, 10**20)}).evalf(40)
        assert_close(float(value / sp.Float(str(near**3), 40)), 4 / 5 / 2**2, rtol=1e-12)


def fillet_of(coefficient):
    """Curvatures (times rho) and lengths of the gradient along the fillet of perpendicular lines."""
    radius = 2.0
    shape = Shape(conjunction(x, y, system=Rho(2, "G2", coefficient=coefficient)), (x, y))
    kernel = rsym.compile(shape, ("value", "gradient", "curvature"))
    angle = np.linspace(1e-3, np.pi / 2 - 1e-3, 2001)
    low, high = np.zeros_like(angle), np.full_like(angle, radius)
    for _ in range(60):
        middle = (low + high) / 2
        inside = kernel(middle * np.cos(angle), middle * np.sin(angle))["value"] > 0
        low, high = np.where(inside, low, middle), np.where(inside, middle, high)
    fields = kernel(high * np.cos(angle), high * np.sin(angle))
    return radius * fields["curvature"], np.linalg.norm(fields["gradient"], axis=1)


@pytest.mark.slow
def test_the_default_coefficient_bends_least():
    """The figures beside the constant: its own, those of its neighbours, and where convexity ends."""
    curvature, size = fillet_of(FIFTH)
    assert_close(curvature.max(), 1.29405, rtol=1e-5)
    assert_close([size.min(), size.max()], [0.9933, 1.0274], rtol=1e-4)
    assert_close([fillet_of(k)[0].max() for k in (0.16, 0.182, 0.25)], [1.347, 1.2783, 1.4007], rtol=1e-3)
    assert fillet_of(sp.Rational(59, 100))[0].min() > -1e-9
    assert fillet_of(sp.Rational(61, 100))[0].min() < -1e-3


@pytest.mark.slow
@pytest.mark.parametrize("cosine", [0, THIRD, -THIRD])
def test_operations_are_monotone_up_to_the_largest_coefficient(cosine):
    angle, radius = np.meshgrid(np.linspace(-np.pi, np.pi, 181), np.linspace(1e-3, 1.5, 151))
    points = radius * np.cos(angle), radius * np.sin(angle)
    largest = LARGEST_COEFFICIENT - sp.Rational(1, 10**9)
    for system in (Rho(1, cosine=cosine), Rho(1, "G2", cosine, largest), Sardf(FIFTH), Sardf(3)):
        partials = rsym.compile(Shape(conjunction(x, y, system=system), (x, y)), ("gradient",))(*points)["gradient"]
        assert partials.min() > -1e-12
    if cosine == 0:
        edge = -np.sqrt(0.2)
        kernel = rsym.compile(Shape(conjunction(x, y, system=Rho(1, "G2", 0, largest)), (x, y)), ("gradient",))
        assert_close(kernel(edge, 0.0)["gradient"][0], 0, atol=1e-8)


def test_sardf_arcs_touch_their_level_lines_and_stay_near_the_distance():
    ratio = sp.Symbol("ratio", positive=True)
    level, t = sp.symbols("level t", positive=True)
    # A point of the arc about (1 + ratio)*level*(1, 1), with a rational parametrisation of the circle.
    centre, radius = (1 + ratio) * level, ratio * level
    along, across = (1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)
    system = Sardf(ratio)
    arc = system.conjunction(x, y)._arc(centre - radius * along, centre - radius * across)
    assert_close(float(arc.subs({ratio: 0.7, level: 3, t: 0.4})), 3, rtol=1e-14)
    diagonal = {THIRD * 3 / 4: 0.068, THIRD * 3 / 2: 0.1277, sp.Integer(1): 0.2265}
    for value, short in diagonal.items():
        kernel = rsym.compile(Shape(conjunction(x, y, system=Sardf(value)), (x, y)))
        turn = np.linspace(0, np.pi / 2, 1001)
        point = np.cos(turn), np.sin(turn)
        lost = 1 - kernel(*point)["value"] / np.minimum(*point).clip(1e-300)
        assert_close(lost[1:-1].max(), short, atol=6e-4)
        assert_close(kernel(-3.0, -4.0)["value"], -5, rtol=1e-15)
        twice = kernel(2 * point[0], 2 * point[1])["value"]
        assert_close(twice, 2 * kernel(*point)["value"], atol=1e-15)


def test_sardf_has_a_continuous_gradient_and_is_its_argument_beside_its_boundary(random):
    shape = Shape(conjunction(x, y, system=Sardf()), (x, y))
    kernel = rsym.compile(shape, ("value", "gradient"))
    for slope in (np.arctan(1.5), np.arctan(1 / 1.5), np.pi, -np.pi / 2):
        sides = [kernel(np.cos(slope + e), np.sin(slope + e))["gradient"] for e in (-1e-9, 1e-9)]
        assert_close(sides[0], sides[1], atol=1e-7)
    distance, along = random.uniform(-0.2, 0.2, 100), random.uniform(0.5, 2, 100)
    assert (kernel(distance, along)["value"] == distance).all()


def test_displacement_is_the_formula_and_makes_the_boundary_analytic():
    blend = displacement_blend(x, y, -FIFTH, THIRD, 2, operation="intersection")
    shape = Shape(blend, (x, y), bounds=BOX)
    a, b = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 8))
    expected = a + b - np.hypot(a, b) - 0.2 / (1 + (3 * a) ** 2 + (b / 2) ** 2)
    assert_close(rsym.compile(shape)(a, b)["value"], expected, atol=1e-15)
    report = rsym.verify_smoothness(shape)
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")


@pytest.mark.slow
def test_a_bounded_blend_acts_within_its_solid_alone_and_joins_smoothly():
    solid = sp.Rational(1, 2) - x**2 - y**2
    blend = bounded_blend(x, y, solid, FIFTH, THIRD, 1, 2, operation="union")
    shape = Shape(blend, (x, y), bounds=BOX)
    kernel = rsym.compile(shape, ("value", "gradient"))
    a, b = np.meshgrid(np.linspace(-1, 1, 20), np.linspace(-1, 1, 21))
    r1, r2 = (3 * a) ** 2 + b**2, np.maximum(0.5 - a**2 - b**2, 0) ** 2 / 4
    r = np.where(r2 > 0, r1 / np.where(r2 > 0, r1 + r2, 1), 1)
    assert_close(kernel(a, b)["value"], a + b + np.hypot(a, b) + 0.2 * (1 - r) ** 3 / (1 + r), atol=1e-15)
    assert_close(kernel(0.0, 0.0)["value"], 0.2, rtol=1e-15)
    outside = Shape(bounded_blend(x, y, -1 - x**2, FIFTH), (x, y))
    assert rsym.compile(outside)(0.0, 0.0)["value"] == 0
    report = rsym.verify_smoothness(shape)
    assert (report.verdict, report.continuity) == ("CERTIFIED", "G3")


def test_letters_are_parameters_and_out_of_range_undefined():
    r, c, k = sp.symbols("r c k", real=True)
    letters = {r: 0.2, c: 0.25, k: 0.5}
    blend = conjunction(x, y, system=Rho(r, "G2", c, k))
    kernel = rsym.compile(Shape(blend, (x, y), letters=letters), ("value", "gradient"))
    fixed = conjunction(x, y, system=Rho(FIFTH, "G2", sp.Rational(1, 4), sp.Rational(1, 2)))
    points = np.linspace(-0.3, 0.4, 8), np.linspace(0.2, -0.1, 8)
    for name, values in rsym.compile(Shape(fixed, (x, y)), ("value", "gradient"))(*points).items():
        assert_close(kernel(*points)[name], values, rtol=1e-14)
    for illegal in ({"r": 0}, {"r": -1}, {"c": 1}, {"c": -1}, {"k": 0}, {"k": 2}):
        assert np.isnan(kernel(*points, letters=illegal)["value"]).all()
    ratio = rsym.compile(Shape(conjunction(x, y, system=Sardf(r)), (x, y), letters={r: 1}))
    assert np.isnan(ratio(1.0, 1.0, letters={"r": 0})["value"])


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: Rho(0), "parameter"),
        (lambda: Rho("1"), "number"),
        (lambda: Rho(1, "G3"), "continuity"),
        (lambda: Rho(1, cosine=1), "parameter"),
        (lambda: Rho(1, coefficient=FIFTH), "parameter"),
        (lambda: Rho(1, "G2", coefficient=2), "parameter"),
        (lambda: Sardf(-1), "parameter"),
        (lambda: displacement_blend(x, y, 1, 0), "positive"),
        (lambda: displacement_blend(x, y, 1, operation="xor"), "operation"),
        (lambda: bounded_blend(x, y, x, 1, a3=-1), "positive"),
    ],
)
def test_what_is_refused(make, code):
    with pytest.raises(RsymError) as caught:
        make()
    assert caught.value.code == code


def test_names_for_people():
    blend = disjunction(x, -y, system=Rho(FIFTH, "G2", THIRD))
    assert str(blend) == 'disjunction(x, -y, system=Rho(1/5, "G2", cosine=1/3))'
    assert sp.latex(conjunction(x, y, system=Rho(sp.Symbol("rho")))) == r"\left(x \wedge_{\rho} y\right)"
    assert sp.latex(conjunction(x, y, system=Sardf(2))) == r"\left(x \wedge_{\lambda=2} y\right)"
    assert str(displacement_blend(x, y, 1)) == "displacement(1, 1, 1, x, y) + disjunction(x, y)"
    bound = bounded_blend(x, y, 1 - x, 1) - disjunction(x, y)
    assert sp.latex(bound) == r"\operatorname{disp}_{1, 1, 1, 1}\left(x, y, 1 - x\right)"


def test_blends_nest_and_share_what_they_have_in_common():
    """Nested blends stay a graph: its size grows with the depth, not with two to its power."""
    body = x
    for k in range(1, 13):
        body = conjunction(y - k, body + k * x, system=Rho(FIFTH, "G2"))
    shape = Shape(body, (x, y))
    assert len(set(sp.preorder_traversal(body))) < 100
    a, b = np.array([0.3, 1.0]), np.array([12.2, 14.0])
    with mp.workdps(40):
        expected = []
        for p, q in zip(map(mp.mpf, a), map(mp.mpf, b), strict=True):
            value = p
            for k in range(1, 13):
                value = book_conjunction(Rho(FIFTH, "G2"), q - k, value + k * p)
            expected.append(float(value))
    assert_close(rsym.compile(shape)(a, b)["value"], expected, rtol=1e-13)
    assert not isinstance(written_out(body), type(body))


@pytest.mark.random
@pytest.mark.parametrize("family", [Rho, Sardf, lambda r: Rho(r, "G2")])
def test_intervals_stay_sharp_in_nests_with_letters(family, random):
    """Not so where a comparison asks for what may be undefined anywhere: then both sides of every choice count."""
    r = sp.Symbol("r", real=True)
    shape = Shape(conjunction(x, y, 1 - x - y, system=family(r)), (x, y), letters={r: 0.2})
    corner = random.uniform(-0.8, 0.8, (400, 2))
    boxes = np.stack([corner, corner + 1e-3], -1)
    gradient = rsym.compile(shape, ("gradient",))(*(corner + 5e-4).T)["gradient"]
    for backend in ("ball", "interval"):
        bounds = rsym.enclose(shape, boxes, backend=backend)["value"]
        ratio = (bounds[:, 1] - bounds[:, 0]) / (1e-3 * abs(gradient).sum(axis=1))
        assert np.median(ratio) < 1.3
        assert np.quantile(ratio, 0.97) < 6


def test_a_displacement_that_adds_material_is_not_cut_by_the_bounds_of_its_operands():
    discs = rsym.disc(1), rsym.disc(1, (1, 0))
    assert rsym.displacement_blend(*discs, 1).box is None
    assert rsym.displacement_blend(*discs, -1).box.ends == (discs[0] | discs[1]).box.ends
