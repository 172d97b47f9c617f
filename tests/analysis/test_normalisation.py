"""Normalisation of orders 1, 2, 3: derivatives along normals, curvatures, other equations of the same function."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Rp, RsymError, RsymWarning, Shape, x, y, z
from rsym.model import rnodes
from rsym.model.nodes import Trimming, ZeroWith
from rsym.model.symbols import postorder

pytestmark = pytest.mark.filterwarnings("ignore:the shape has corners")
DIGITS = 60
ELLIPSE = 1 - x**2 / 9 - y**2
QUADRATIC = x * y / 2 - x**2 - 2 * y**2 + x + y + 3
CORNER = rsym.conjunction(x, 1 - y)
ELLIPSOID = 1 - x**2 / 9 - y**2 / 4 - z**2
SKELETON = rsym.paper.skeleton_body()
# Equation and a place from which Newton's method finds its boundary.
PLANE = {
    "ellipse": (ELLIPSE, (2.1, 0.7)),
    "quadratic": (QUADRATIC, (1.9, 0.9)),
    "corner": (CORNER, (0.7, 0.6)),
    "skeleton": (
        SKELETON.expression.subs({sp.Symbol(n, real=True): v.default for n, v in SKELETON.letters.items()}),
        (3.2, 1.1),
    ),
}
SPACE = {"ellipsoid": (ELLIPSOID, (1.5, 1.0, 0.7))}
MEANINGS = {
    sp.Add: lambda *terms: mpmath.fsum(terms),
    sp.Mul: lambda *factors: mpmath.fprod(factors),
    rnodes.R0Conjunction: lambda f, g: f + g - mpmath.hypot(f, g),
    ZeroWith: lambda f, g: g,
    Trimming: lambda f, t: mpmath.hypot(f, (mpmath.hypot(t, f**2) - t) / 2),
}


def power(exponent):
    """The function u**exponent for an exponent that is an integer or half of one."""
    return (
        (lambda u, _: u ** int(exponent)) if exponent.is_integer else (lambda u, _: mpmath.sqrt(u) ** int(2 * exponent))
    )


def function_of(expression):
    """Values of an expression with mpmath, equal parts evaluated once."""
    order = postorder(expression)
    place = {id(part): k for k, part in enumerate(order)}
    steps = [
        (part, power(part.exp) if part.is_Pow else MEANINGS.get(type(part)), [place[id(a)] for a in part.args])
        for part in order
    ]

    def function(point):
        values = []
        for part, meaning, arguments in steps:
            if part.is_Symbol:
                values.append(point["xyz".index(part.name)])
            elif part.is_Number:
                values.append(mpmath.mpf(part.p) / part.q if part.is_Rational else mpmath.mpf(part))
            else:
                values.append(meaning(*(values[k] for k in arguments)))
        return values[-1]

    return function


def foot(omega, start):
    """A point of omega = 0, the inner unit normal and the orders of differentiation, by Newton and differences."""
    point = [mpmath.mpf(str(c)) for c in start]
    for _ in range(12):
        value, slope = omega(point), slopes(omega, point)
        point = [c - value * s / mpmath.fdot(slope, slope) for c, s in zip(point, slope, strict=True)]
    assert abs(omega(point)) < mpmath.mpf(10) ** (8 - DIGITS)
    slope = slopes(omega, point)
    return point, [s / mpmath.norm(slope) for s in slope]


def slopes(omega, point):
    size = len(point)
    return [
        mpmath.diff(lambda *p: omega(p), tuple(point), tuple(int(j == k) for j in range(size))) for k in range(size)
    ]


def along(function, point, normal):
    """The first four derivatives along a normal, from values alone: five of them, 1e-10 apart."""
    step = mpmath.mpf(10) ** -10
    low, below, here, above, high = (
        function([c + k * step * n for c, n in zip(point, normal, strict=True)]) for k in range(-2, 3)
    )
    return [
        (8 * (above - below) - (high - low)) / (12 * step),
        (16 * (above + below) - (high + low) - 30 * here) / (12 * step**2),
        ((high - low) - 2 * (above - below)) / (2 * step**3),
        (high + low - 4 * (above + below) + 6 * here) / step**4,
    ]


CASES = [(name, order) for name in (*PLANE, *SPACE) for order in (1, 2, 3) if (name, order) != ("skeleton", 3)]
LARGE = {("ellipsoid", 3), ("corner", 3)}  # formulas of seconds


@pytest.mark.random
@pytest.mark.parametrize("keep_sign", [False, True])
@pytest.mark.parametrize(
    ("name", "order"), [pytest.param(*case, marks=[pytest.mark.slow] if case in LARGE else []) for case in CASES]
)
def test_the_derivatives_along_the_normal(name, order, keep_sign):
    equation, start = {**PLANE, **SPACE}[name]
    unit = rsym.normalise(Shape(equation, (x, y, z)[: len(start)]), order=order, length=2, keep_sign=keep_sign)
    with mpmath.workdps(DIGITS):
        point, normal = foot(function_of(equation), start)
        found = along(function_of(unit.expression), point, normal)
    assert_close(np.array(found[:order], float), [1.0, 0.0, 0.0][:order], atol=1e-9)
    assert abs(found[order]) > 1e-3  # and not one order more, or the test could not fail


def test_the_second_order_needs_the_derivatives_of_the_tensor_alone():
    """Red proof: (grad omega . grad)**2 omega also differentiates the direction and is twice too much."""
    unit = rsym.normalise(Shape(ELLIPSE, (x, y)))
    w = unit.expression
    slope = rsym.gradient(unit)
    once = sum(g * sp.diff(w, v) for g, v in zip(slope, (x, y), strict=True))
    twice = sum(g * sp.diff(once, v) for g, v in zip(slope, (x, y), strict=True))
    with mpmath.workdps(DIGITS):
        point, normal = foot(function_of(ELLIPSE), PLANE["ellipse"][1])
        candidates = (w, w - w**2 * twice / 2, rsym.normalise(Shape(ELLIPSE, (x, y)), order=2).expression)
        second = [float(along(function_of(f), point, normal)[1]) for f in candidates]
    assert abs(second[2]) < 1e-9
    assert_close(second[1], -second[0], rtol=1e-9)


ANGLES = np.linspace(0.1, 6.2, 40)


@pytest.mark.slow
def test_minus_the_laplacian_of_order_2_is_the_curvature():
    cosine, sine = np.cos(ANGLES), np.sin(ANGLES)
    for order in (2, 3):
        found = rsym.compile(rsym.normalise(Shape(ELLIPSE, (x, y)), order=2), "laplacian")(3 * cosine, sine)
        field = rsym.compile(Shape(ELLIPSE, (x, y)), f"normalised_{order}_laplacian")(3 * cosine, sine)
        curvature = 3 / (9 * sine**2 + cosine**2) ** 1.5
        assert_close(-found["laplacian"], curvature, rtol=1e-11)
        assert_close(-field[f"normalised_{order}_laplacian"], curvature, rtol=1e-11)


def test_minus_the_laplacian_of_order_2_is_twice_the_mean_curvature():
    points = np.array([3, 2, 1])[:, None] * np.array(
        [np.cos(ANGLES) * np.cos(3 * ANGLES), np.sin(ANGLES) * np.cos(3 * ANGLES), np.sin(3 * ANGLES)]
    )
    found = rsym.compile(Shape(ELLIPSOID, (x, y, z)), "normalised_2_laplacian")(*points)["normalised_2_laplacian"]
    weight = (points**2 / np.array([81, 16, 1])[:, None]).sum(axis=0)
    assert_close(-found, (14 - (points**2).sum(axis=0)) / (36 * weight**1.5), rtol=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
def test_the_closed_form_is_the_field(order):
    shape = Shape(ELLIPSE - x * y / 2, (x, y))
    points = np.random.default_rng(3).uniform(-1, 2, (2, 30))
    field = f"normalised_{order}".removesuffix("_1")
    assert_close(
        rsym.compile(rsym.normalise(shape, order=order), backend="numpy")(*points)["value"],
        rsym.compile(shape, field)(*points)[field],
        rtol=1e-9,
        atol=1e-11,
    )


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_length_makes_it_covariant_to_scale(order):
    small, large = Shape(ELLIPSE, (x, y)), Shape(ELLIPSE.subs({x: x / 10, y: y / 10}, simultaneous=True), (x, y))
    points = np.random.default_rng(4).uniform(-1, 2, (2, 20))
    first = rsym.compile(rsym.normalise(small, order=order, length=2), backend="numpy")(*points)["value"]
    second = rsym.compile(rsym.normalise(large, order=order, length=20), backend="numpy")(*(10 * points))["value"]
    assert_close(second, 10 * first, rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("order", [0, -1, 1.5, "1", True])
def test_an_order_must_be_a_positive_integer(order):
    with pytest.raises(RsymError, match="positive integer"):
        rsym.normalise(Shape(x, (x, y)), order=order)


@pytest.mark.parametrize("length", [0, -1, sp.Integer(-2)])
def test_a_length_must_be_positive(length):
    with pytest.raises(RsymError):
        rsym.normalise(Shape(x, (x, y)), length=length)


SQUARE = rsym.rectangle(2, 2)
ANGLE = rsym.polygon([(-1, -1), (1, -1), (1, 0), (0, 0), (0, 1), (-1, 1)]) - rsym.disc(0.2, (-0.5, -0.5))
CORNERED = {
    "square": (SQUARE, 1.3),
    "an L with a hole": (ANGLE, 1.3),
    "pentagon": (rsym.regular_polygon(5), 1.3),
    "a star": (rsym.polygon([(3, 0), (1, 1), (0, 3), (-1, 1), (-3, 0), (-1, -1), (0, -3), (1, -1)]), 3.5),
    "the car from the side": (rsym.section(rsym.paper.car(), z, 0.2), None),
}


def over_a_grid(shape, half, count=201):
    """The values of omega and of another function over a grid that holds the corners and sides, and beyond."""
    box = shape.bounds if half is None else ((-half, half),) * 2
    lines = [np.linspace(*side, count) for side in box]
    return np.meshgrid(*lines)


@pytest.mark.random
@pytest.mark.parametrize("name", CORNERED)
def test_the_sign_of_omega_is_kept(name):
    shape, half = CORNERED[name]
    points = over_a_grid(shape, half)
    omega = rsym.compile(shape, backend="numpy")(*points)["value"]
    unit = rsym.normalise(shape, order=2, keep_sign=True)
    found = rsym.compile(unit, backend="numpy")(*points)["value"]
    clear = np.abs(omega) > 1e-9  # omega rounds to 0 or beside it on a side
    assert clear.mean() > 0.9
    assert (np.sign(found[clear]) == np.sign(omega[clear])).all()
    first = rsym.compile(shape, "normalised", backend="numpy")(*points)["normalised"]
    assert (np.abs(found[clear] / first[clear] - 1) <= 0.5 + 1e-12).all()


def test_the_undamped_form_changes_the_sign_within_a_square():
    """Red proof: it is what `keep_sign` is for."""
    inside = np.linspace(-0.999, 0.999, 200)
    with pytest.warns(RsymWarning, match=r"corners.*keep_sign.*Rp\(4\)"):
        plain = rsym.normalise(SQUARE, order=2)
    values = rsym.compile(plain)(*np.meshgrid(inside, inside))["value"]
    assert (values < 0).mean() > 0.1


@pytest.mark.filterwarnings("ignore:What is thinner than a cell")
@pytest.mark.slow
def test_the_boundary_of_a_square_is_one_curve():
    kept = rsym.normalise(SQUARE, order=2, keep_sign=True)
    assert len(rsym.level_lines(kept)) == 1
    assert len(rsym.level_lines(rsym.normalise(SQUARE, order=2))) > 1


@pytest.mark.slow
def test_the_kept_sign_is_of_order_2_at_the_worst_points_that_are_found():
    shape = Shape(ELLIPSE, (x, y), bounds=((-4, 4), (-2, 2)))
    report = rsym.verify_normalisation(rsym.normalise(shape, 2, keep_sign=True), 2, resolution=48, work=0)
    assert_close([place.deviation for place in report.worst], [0, 0], atol=1e-20)


WITHOUT_CORNERS = {
    "an ellipse": Shape(ELLIPSE, (x, y)),
    "operands that never vanish together": Shape(rsym.conjunction(1 - x**2, 2 - x**2), (x, y)),
    "min": Shape(rsym.conjunction(x, 1 - y, system=rsym.R1), (x, y)),
    "the body of Fig. 11": SKELETON,
}


@pytest.mark.parametrize("name", WITHOUT_CORNERS)
@pytest.mark.filterwarnings("error")
def test_nothing_is_warned_of_without_corners(name):
    rsym.normalise(WITHOUT_CORNERS[name], order=2)


@pytest.mark.filterwarnings("error")
def test_nothing_is_warned_of_where_the_sign_is_kept_and_at_order_1():
    rsym.normalise(SQUARE, order=2, keep_sign=True)
    rsym.normalise(SQUARE)


@pytest.mark.parametrize("system", [rsym.R0m(2), rsym.RAlpha(0.5), Rp(4)])
def test_corners_in_every_system_are_warned_of(system):
    with pytest.warns(RsymWarning, match="corners"):
        rsym.normalise(SQUARE.with_system(system), order=2)


def test_half_planes_in_another_system_keep_the_order_that_the_warning_names():
    triangle = rsym.polygon([(0, 0), (3, 0), (0, 2)])
    kept = triangle.with_system(Rp(4))
    with mpmath.workdps(DIGITS):
        along_a_side = along(lambda p: kept.expression.subs({x: p[0], y: p[1]}).evalf(DIGITS), (1, 0), (0, 1))
    assert_close(np.array(along_a_side[:3], float), [1.0, 0.0, 0.0], atol=1e-9)
    assert kept.contract().order == 3


CORNERS = {
    "square": (SQUARE, [(1, 1), (-1, 1), (1, -1)]),
    "an L with a hole": (ANGLE, [(0, 0), (1, 0), (-1, -1)]),
    "in another system": (SQUARE.with_system(Rp(4)), [(1, 1), (-1, 1)]),
    "min": (Shape(rsym.conjunction(x, y, system=rsym.R1), (x, y)), [(0, 0)]),
    "a joint with a choice": (Shape(sp.Piecewise((x, x > y), (2 * x - y, True)) - y, (x, y)), [(1, 1)]),
    "a crossing": (Shape(x * y, (x, y)), [(0, 0)]),
    "a cube": (rsym.box(2, 2, 2), [(1, 1, 1), (1, 0, 1), (-1, 0.5, -1)]),
}
VALUES = ("normalised", "normalised_2", "normalised_2_keep_sign")


@pytest.mark.random
@pytest.mark.parametrize(
    ("name", "backend"), [*((name, "numpy") for name in CORNERS), ("square", "llvm"), ("square", "lambdify")]
)
def test_what_is_normalised_is_0_at_a_corner(name, backend):
    """Red proof: one corner among collocation points, and a loss is NaN."""
    shape, points = CORNERS[name]
    points = np.array(points, float).T
    fields = VALUES if shape.dimension == 2 else VALUES[:1]
    make = rsym.lambdify if backend == "lambdify" else lambda *given: rsym.compile(*given, backend=backend)
    found = make(shape, fields)(*points)
    assert all((found[field] == 0).all() for field in fields), found
    if name == "a crossing":
        return  # without an R-operation the formula stays as it is
    for order in (1, 2):
        for keep_sign in (False, True):
            unit = rsym.normalise(shape, order if shape.dimension == 2 else 1, keep_sign=keep_sign)
            assert (make(unit, ("value",))(*points)["value"] == 0).all()


def test_the_gradient_at_a_corner_does_not_exist():
    fields = ("normalised_gradient", "normalised_2_gradient", "normalised_2_keep_sign_gradient")
    found = rsym.compile(SQUARE, fields)([1.0, 1.0, 0.5], [1.0, 0.25, 0.5])
    for field in fields:
        assert np.isnan(found[field]).all(axis=1).tolist() == [True, False, False]
        assert_close(found[field][1], [-1.0, 0.0], atol=1e-14)


def test_where_omega_itself_jumps_what_is_normalised_is_not_0():
    step = Shape(sp.Piecewise((x, x > 0), (x - 1, True)) + 0 * y, (x, y))
    assert np.isnan(rsym.compile(step, "normalised")(0.0, 0.0)["normalised"])


BOXES = [[[1, 1], [1, 1]], [[0.9, 1], [1, 1.1]], [[-2, 2], [-2, 2]], [[1, 1], [0.5, 0.75]]]


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["interval", "ball"])
def test_bounds_around_a_corner_hold_its_value(backend):
    unit = rsym.normalise(SQUARE, order=2)
    for shape, field in ((SQUARE, "normalised"), (SQUARE, "normalised_2"), (unit, "value")):
        found = rsym.enclose(shape, np.array(BOXES, float), field, backend=backend)[field]
        assert (found[:, 0] <= 0).all(), field
        assert (found[:, 1] >= 0).all(), field
    if backend == "ball":
        assert (rsym.enclose(SQUARE, BOXES[:1], VALUES, backend="ball")["normalised_2"] == 0).all()


@pytest.mark.slow
@pytest.mark.parametrize("field", ["normalised", "normalised_2", "normalised_3", "normalised_2_keep_sign"])
def test_the_gradient_of_what_is_normalised_is_that_of_the_closed_form(field):
    order = int(field.split("_")[1]) if "_" in field else 1
    unit = rsym.normalise(Shape(ELLIPSE, (x, y)), order, keep_sign="sign" in field)
    points = np.random.default_rng(5).uniform(-2, 2, (2, 30))
    found = rsym.compile(Shape(ELLIPSE, (x, y)), (f"{field}_gradient", f"{field}_gradient_squared"))(*points)
    expected = rsym.compile(unit, "gradient", backend="numpy")(*points)["gradient"]
    assert found[f"{field}_gradient"].shape == (30, 2)
    assert_close(found[f"{field}_gradient"], expected, rtol=1e-8, atol=1e-10)
    assert_close(found[f"{field}_gradient_squared"], (expected**2).sum(axis=-1), rtol=1e-8, atol=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["square", "an L with a hole"])
def test_the_sign_is_kept_to_order_3(name):
    shape, half = CORNERED[name]
    points = over_a_grid(shape, half)
    fields = ("value", "normalised_2_keep_sign", "normalised_3_keep_sign")
    found = rsym.compile(shape, fields, backend="numpy")(*points)
    clear = np.abs(found["value"]) > 1e-9
    for field in fields[1:]:
        assert (np.sign(found[field][clear]) == np.sign(found["value"][clear])).all()
        assert np.isfinite(found[field]).all()


@pytest.mark.parametrize(
    ("field", "said"),
    [
        ("normalised_0", "order 0 is `value`"),
        ("normalised_1", "order 1 is `normalised`"),
        ("normalised_1_gradient", "order 1 is `normalised_gradient`"),
        ("normalised_4", "orders 2 and 3"),
        ("normalised_2_gradients", "no field"),
        ("normalised_keep_sign", "order 1 is `normalised`"),
    ],
)
def test_a_field_of_another_order_is_refused(field, said):
    with pytest.raises(RsymError, match=said) as caught:
        rsym.compile(SQUARE, field)
    assert "normalised_2" in caught.value.remedy


def test_a_direction_has_no_value_where_it_has_none():
    """The same quotient, but of no limit: what is written by hand is not filled in."""
    cosine = Shape(x / sp.sqrt(x**2 + y**2), (x, y))
    assert np.isnan(rsym.compile(cosine)(0.0, 0.0)["value"])
    for backend in ("numpy", "llvm"):
        assert np.isnan(rsym.compile(Shape(x * y, (x, y)), "curvature", backend=backend)(0.0, 0.0)["curvature"])


def test_a_normalised_shape_is_meshed_and_joined_by_its_logic():
    """Its sign form is that of omega; the contract speaks of what it is made of."""
    unit = rsym.normalise(SQUARE)
    assert len(rsym.level_lines(unit)) == 1
    assert unit.contract().order == rsym.normalise(rsym.strip()).contract().order == 1
    joined = unit & rsym.Shape(x, (x, y))
    assert (rsym.compile(joined)([1.0, 1.0], [1.0, -1.0])["value"] == 0).all()
    assert str(unit.expression) == str(unit.expression.args[1])
