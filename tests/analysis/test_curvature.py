"""Curvatures against textbook formulas, against bending measured on values of omega alone, and against each other."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, x, y, z

SPACE = ("mean_curvature", "gaussian_curvature", "principal_curvatures", "principal_directions")
SPHERE = Shape(4 - x**2 - y**2 - z**2, (x, y, z))
ELLIPSOID = Shape(1 - x**2 / 9 - y**2 / 4 - z**2, (x, y, z))
REVOLVED = Shape(1 - x**2 / 9 - (y**2 + z**2) / 4, (x, y, z))
TORUS = Shape(1 - (sp.sqrt(x**2 + y**2) - 3) ** 2 - z**2, (x, y, z))
QUARTIC = Shape(1 - x**4 - y**4 - z**4, (x, y, z))
ROUNDED = conjunction(1 - x**2, 1 - y**2 - x * y / 3, 2 - x - y) - sp.Rational(1, 5)
TRIMMED = rsym.trimming(1 - x**2 - y**2 - z**2, conjunction(x + z / 3, y + 2)) - sp.Rational(3, 10)


def principal(shape, point, **options):
    return rsym.compile(shape, ("principal_curvatures",), **options)(*map(float, point))["principal_curvatures"]


def ellipsoid_points(count=200):
    rng = np.random.default_rng(1)
    directions = rng.normal(size=(3, count))
    return directions / np.linalg.norm(directions, axis=0) * np.array([[3.0], [2.0], [1.0]])


def bending(expression, point, direction, inwards):
    """-(s(h) + s(-h))/h**2 of the heights s above the tangent at distances h, s found by Newton on 60-digit values."""
    symbols = (x, y, z)[: len(point)]
    with mpmath.workdps(60):
        value = sp.lambdify(symbols, expression.doit(), "mpmath")
        level = value(*map(mpmath.mpf, map(float, point)))
        h = mpmath.mpf(10) ** -8

        def height(step):
            place = [mpmath.mpf(float(p)) + step * mpmath.mpf(float(d)) for p, d in zip(point, direction, strict=True)]
            return mpmath.findroot(
                lambda s: value(*(q + s * mpmath.mpf(float(n)) for q, n in zip(place, inwards, strict=True))) - level,
                (mpmath.mpf(0), h * h),
                tol=1e-50,
            )

        return float((height(h) + height(-h)) / h**2)


def exactly(expressions, *point):
    """Values in closed form with 40 digits."""
    with mpmath.workdps(40):
        values = sp.lambdify((x, y, z)[: len(point)], expressions, "mpmath", cse=True)(*map(mpmath.mpf, point))
        assert all(mpmath.im(value) == 0 for value in values)
        return [float(value) for value in values]


# --- in the plane


def test_plane_curvature_of_known_curves_is_positive_where_convex():
    circle, line = Shape(9 - x**2 - y**2, (x, y)), Shape(x - 2 * y + 1, (x, y))
    angle = np.linspace(0, 6, 50)
    kernel = rsym.compile(circle, ("curvature",))
    assert_close(kernel(3 * np.cos(angle), 3 * np.sin(angle))["curvature"], np.full(50, 1 / 3), atol=1e-14)
    outside = rsym.compile(circle.replace(expression=-circle.expression), ("curvature",))
    assert_close(outside(3 * np.cos(angle), 3 * np.sin(angle))["curvature"], np.full(50, -1 / 3), atol=1e-14)
    assert rsym.compile(line, ("curvature",))(0.3, 0.4)["curvature"] == 0
    ellipse = rsym.compile(Shape(1 - x**2 / 9 - y**2 / 4, (x, y)), ("curvature",))
    expected = 6 / (9 * np.sin(angle) ** 2 + 4 * np.cos(angle) ** 2) ** 1.5
    assert_close(ellipse(3 * np.cos(angle), 2 * np.sin(angle))["curvature"], expected, rtol=1e-13)


@pytest.mark.parametrize(
    "expression", [ROUNDED, conjunction(x, y, system=rsym.Rp(4)) * (2 - x - y) - sp.Rational(1, 9)]
)
def test_plane_curvature_is_the_bending_of_the_level_line(expression):
    kernel = rsym.compile(Shape(expression, (x, y)), ("gradient", "curvature"))
    for point in ([0.4, 0.3], [0.7, 0.9], [0.2, 0.95]):
        found = kernel(*point)
        inwards = found["gradient"] / np.hypot(*found["gradient"])
        expected = bending(expression, point, [-inwards[1], inwards[0]], inwards)
        assert_close(found["curvature"], expected, atol=1e-11)


@pytest.mark.slow
def test_plane_curvature_in_closed_form_keeps_r_nodes_and_is_minus_the_divergence_of_the_normal():
    closed = rsym.curvature(Shape(ROUNDED, (x, y)))
    assert closed.has(type(conjunction(x, y)))
    expanded = ROUNDED.doit()
    slope = sp.sqrt(sp.diff(expanded, x) ** 2 + sp.diff(expanded, y) ** 2)
    divergence = sum(sp.diff(sp.diff(expanded, s) / slope, s) for s in (x, y))
    ours, theirs = exactly([closed, -divergence], 0.4, 0.3)
    assert_close(ours, theirs, rtol=1e-15)
    assert_close(rsym.compile(Shape(ROUNDED, (x, y)), ("curvature",))(0.4, 0.3)["curvature"], theirs, atol=1e-13)


def test_the_curvature_belongs_to_the_boundary_and_not_to_its_equation():
    points = 3 * np.cos([0.3, 1.1]), 2 * np.sin([0.3, 1.1])
    one = Shape(1 - x**2 / 9 - y**2 / 4, (x, y))
    same = [
        one,
        Shape(one.expression * sp.exp(x - y), (x, y)),
        rsym.normalise(one),
        Shape(1e-90 * one.expression, (x, y)),
    ]
    values = [rsym.compile(shape, ("curvature",))(*points)["curvature"] for shape in same]
    for other in values[1:]:
        assert_close(other, values[0], rtol=1e-12)


# --- in space


def test_curvatures_of_the_ellipsoid_everywhere():
    points = ellipsoid_points()
    found = rsym.compile(ELLIPSOID, SPACE)(*points)
    u = (points**2 / np.array([[81.0], [16.0], [1.0]])).sum(axis=0)
    gauss = 1 / (36 * u**2)
    mean = (14 - (points**2).sum(axis=0)) / (2 * 36 * u**1.5)
    assert_close(found["gaussian_curvature"], gauss, rtol=1e-12)
    assert_close(found["mean_curvature"], mean, rtol=1e-12)
    assert_close(found["principal_curvatures"].mean(axis=-1), mean, rtol=1e-12)
    assert_close(found["principal_curvatures"].prod(axis=-1), gauss, rtol=1e-12)
    assert (found["principal_curvatures"][:, 0] >= found["principal_curvatures"][:, 1]).all()


UMBILICS = [(sx * 3 * np.sqrt(5 / 8), 0.0, sz * np.sqrt(3 / 8)) for sx in (-1, 1) for sz in (-1, 1)]
S2, S3 = 2**-0.25, 3**-0.25
NAMED = {
    "sphere": (SPHERE, (2 / 3, -4 / 3, 4 / 3), (0.5, 0.5)),
    "its poles": (SPHERE, (0, 0, -2), (0.5, 0.5)),
    "ellipsoid, end of the long axis": (ELLIPSOID, (3, 0, 0), (3.0, 0.75)),
    "ellipsoid, end of the middle axis": (ELLIPSOID, (0, -2, 0), (2.0, 2 / 9)),
    "ellipsoid, end of the short axis": (ELLIPSOID, (0, 0, 1), (0.25, 1 / 9)),
    "revolved ellipse, pole": (REVOLVED, (-3, 0, 0), (0.75, 0.75)),
    "revolved ellipse, equator": (REVOLVED, (0, 0, 2), (0.5, 2 / 9)),
    "torus, outside": (TORUS, (4, 0, 0), (1.0, 0.25)),
    "torus, inside": (TORUS, (0, -2, 0), (1.0, -0.5)),
    "torus, top": (TORUS, (0, 3, 1), (1.0, 0.0)),
    "quartic, planar point": (QUARTIC, (0, 1, 0), (0.0, 0.0)),
    "quartic, corner": (QUARTIC, (S3, S3, -S3), (3**0.75, 3**0.75)),
    "quartic, edge": (QUARTIC, (S2, 0, S2), (3 * S2, 0.0)),
    **{f"ellipsoid, umbilic {k}": (ELLIPSOID, point, (3 / 8, 3 / 8)) for k, point in enumerate(UMBILICS)},
}


@pytest.mark.random
@pytest.mark.parametrize("name", NAMED)
def test_principal_curvatures_at_named_points(name):
    shape, point, expected = NAMED[name]
    four = (*expected, sum(expected) / 2, expected[0] * expected[1])
    found = rsym.compile(shape, SPACE)(*map(float, point))
    assert_close(
        [*found["principal_curvatures"], found["mean_curvature"], found["gaussian_curvature"]], four, atol=1e-10
    )
    closed = [*rsym.principal_curvatures(shape), rsym.mean_curvature(shape), rsym.gaussian_curvature(shape)]
    at = dict(zip((x, y, z), map(float, point), strict=True))
    assert_close([float(value.subs(at)) for value in closed], four, atol=1e-10)
    check_directions(shape, np.array([point], float))


def test_every_point_of_a_sphere_is_an_umbilic():
    points = np.random.default_rng(2).normal(size=(3, 2000))
    points *= 2 / np.linalg.norm(points, axis=0)
    found = rsym.compile(SPHERE, ("principal_curvatures",))(*points)["principal_curvatures"]
    assert_close(found, np.full((2000, 2), 0.5), atol=1e-14)  # no root of a rounding error
    closed = sp.lambdify((x, y, z), rsym.principal_curvatures(SPHERE))(*points)
    assert_close(closed, np.full((2, 2000), 0.5), atol=1e-13)


def test_at_umbilics_nothing_is_lost_in_closed_form():
    umbilic = {x: 3 * sp.sqrt(sp.Rational(5, 8)), y: 0, z: sp.sqrt(sp.Rational(3, 8))}
    assert [sp.nsimplify(k.subs(umbilic)) for k in rsym.principal_curvatures(ELLIPSOID)] == [sp.Rational(3, 8)] * 2


def check_directions(shape, points, tolerance=1e-9):
    """Unit, tangent, orthogonal, and eigenvectors: against numpy's symmetric eigensolver on the projected Hessian."""
    found = rsym.compile(shape, ("gradient", "hessian", *SPACE))(*points.T)
    slope = np.linalg.norm(found["gradient"], axis=-1)
    normal = found["gradient"] / slope[:, None]
    projection = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    operator = -projection @ found["hessian"] @ projection / slope[:, None, None]
    first, second = found["principal_directions"].transpose(1, 0, 2)
    frames = np.stack([first, second, normal], axis=1)
    assert_close(frames @ frames.transpose(0, 2, 1), np.broadcast_to(np.eye(3), frames.shape), atol=1e-12)
    for k, direction in enumerate((first, second)):
        turned = np.einsum("nij,nj->ni", operator, direction)
        assert_close(turned, found["principal_curvatures"][:, k, None] * direction, atol=tolerance)
    lifted = operator + 1e6 * normal[:, :, None] * normal[:, None, :]
    assert_close(found["principal_curvatures"], np.linalg.eigvalsh(lifted)[:, 1::-1], atol=1e-8)


def test_directions_are_eigenvectors_wherever_the_normal_points():
    check_directions(ELLIPSOID, ellipsoid_points().T)
    check_directions(TORUS, np.random.default_rng(3).uniform(-4, 4, (200, 3)))
    axes = np.concatenate([np.eye(3), -np.eye(3)])
    check_directions(SPHERE, 2 * axes)
    check_directions(ELLIPSOID, axes * np.array([3.0, 2.0, 1.0]))
    # At the seam of the tangent frame, where the third component of the normal changes its sign.
    check_directions(REVOLVED, np.array([[1.0, 1.0, s] for s in (0.0, -0.0, 1e-300, -1e-300, 1e-12, -1e-12)]))


@pytest.mark.slow
def test_principal_curvatures_of_r_nodes_are_the_bending_along_the_principal_directions():
    expression = conjunction(1 - x**2 - y**2, z + x / 2, 1 - z) - sp.Rational(1, 10)
    point = [0.3, 0.2, 0.4]
    found = rsym.compile(Shape(expression, (x, y, z)), ("gradient", *SPACE))(*point)
    inwards = found["gradient"] / np.linalg.norm(found["gradient"])
    bent = [bending(expression, point, direction, inwards) for direction in found["principal_directions"]]
    assert_close(found["principal_curvatures"], bent, atol=1e-10)
    closed = rsym.principal_curvatures(Shape(expression, (x, y, z)))
    assert closed[0].has(type(conjunction(x, y)))
    assert_close(exactly(closed, *point), found["principal_curvatures"], atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("expression", [ELLIPSOID.expression, TRIMMED])
def test_both_backends_give_the_same_bits_and_plain_sympy_the_same_values(expression):
    shape = Shape(expression, (x, y, z))
    points = np.random.default_rng(4).uniform(-1.5, 1.5, (3, 500))
    slow, fast = (rsym.compile(shape, SPACE, backend=backend)(*points) for backend in ("numpy", "llvm"))
    plain = rsym.lambdify(shape, SPACE)(*points)
    for name in SPACE:
        np.testing.assert_array_equal(slow[name], fast[name])
        assert plain[name].shape == slow[name].shape
    for name in SPACE[:3]:
        assert_close(plain[name], slow[name], atol=1e-9, rtol=1e-9)
    text = rsym.source(shape, "c", SPACE)
    assert "principal_directions_1_2" in text


def test_float32():
    points = ellipsoid_points().astype(np.float32)
    exact, single = (rsym.compile(ELLIPSOID, SPACE, dtype=dtype)(*points) for dtype in ("float64", "float32"))
    for name in SPACE[:3]:
        assert single[name].dtype == np.float32
        assert_close(single[name], exact[name], rtol=2e-5, atol=2e-6)
    umbilics = principal(ELLIPSOID, UMBILICS[0], dtype="float32")
    assert_close(umbilics, [3 / 8, 3 / 8], atol=1e-6)


def test_undefined_where_the_gradient_vanishes_and_on_edges():
    middle = rsym.compile(SPHERE, SPACE)(0.0, 0.0, 0.0)
    assert all(np.isnan(middle[name]).all() for name in SPACE)
    edge = rsym.compile(Shape(conjunction(x + z, y + z**2), (x, y, z)), SPACE)(-1.0, -1.0, 1.0)
    assert all(np.isnan(edge[name]).all() for name in SPACE)
    kink = rsym.compile(Shape(z + x * sp.Abs(x) / 2, (x, y, z)), SPACE)(0.0, 0.0, 0.0)
    assert np.isnan(kink["principal_directions"][1]).all()
    assert np.isnan(rsym.compile(Shape(x**2 + y**2, (x, y)), ("curvature",))(0.0, 0.0)["curvature"])


@pytest.mark.parametrize(
    "field", ["mean_curvature", "gaussian_curvature", "principal_curvatures", "principal_directions"]
)
def test_a_curvature_of_space_is_refused_in_the_plane(field):
    with pytest.raises(RsymError, match=r"3 coordinates.*the plane") as caught:
        rsym.compile(Shape(x * y, (x, y)), (field,))
    assert caught.value.code == "dimension"
    if field != "principal_directions":
        with pytest.raises(RsymError, match=r"3 coordinates.*use curvature"):
            getattr(rsym, field)(Shape(x * y, (x, y)))


def test_the_curvature_of_the_plane_is_refused_in_space():
    for refused in (rsym.curvature, lambda shape: rsym.compile(shape, ("curvature",))):
        with pytest.raises(RsymError, match=r"2 coordinates.*mean_curvature"):
            refused(SPHERE)


# --- as fields and on meshes


def test_level_lines_of_the_curvature():
    ellipse = Shape(1 - x**2 / 9 - y**2 / 4, (x, y), bounds=((-4, 4), (-3, 3)))
    lines = rsym.level_lines(ellipse, 0.3, field="curvature", resolution=64)
    points = np.concatenate(list(lines))
    assert lines.status.kept == 0
    assert_close(rsym.compile(ellipse, ("curvature",))(*points.T)["curvature"], np.full(len(points), 0.3), atol=1e-9)


def test_the_curvature_of_a_section_is_that_of_its_line():
    """The section z = 0.6 of the sphere of radius 1 is a circle of radius 0.8."""
    ball = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-1, 1), (-1, 1), (-1, 1)))
    (circle,) = rsym.level_lines(ball, 1.25, field="curvature", resolution=48, section={z: 0.6})
    assert_close(np.hypot(*circle.T), np.full(len(circle), 0.8), atol=1e-9)


DOUBLE = Shape(
    sp.Rational(1, 25) - (x**2 * (1 - x**2) - y**2) ** 2 - z**2,
    (x, y, z),
    bounds=((-1.3, 1.3), (-0.9, 0.9), (-0.4, 0.4)),
)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "half_size", "genus"),
    [
        (ELLIPSOID, (3.1, 2.1, 1.1), 0),
        (QUARTIC, (1.1,) * 3, 0),
        (TORUS, (4.1, 4.1, 1.1), 1),
        (DOUBLE, (1.3, 0.9, 0.4), 2),
    ],
)
def test_gauss_bonnet(shape, half_size, genus):
    mesh = rsym.mesh(shape, 96, bounds=[(-half, half) for half in half_size])
    assert mesh.status.euler_characteristic == 2 - 2 * genus
    curvature = rsym.vertex_curvatures(mesh, shape)["gaussian_curvature"]
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    total = (curvature[mesh.faces].mean(axis=1) * areas).sum()
    assert_close(total / (2 * np.pi), mesh.status.euler_characteristic, atol=0.02)


def test_vertex_curvatures_of_a_ball_follow_its_letter():
    radius = sp.Symbol("R", real=True)
    ball = Shape(radius**2 - x**2 - y**2 - z**2, (x, y, z), letters={radius: 1}, bounds=((-3.2, 3.2),) * 3)
    mesh = rsym.mesh(ball, 12, letters={"R": 3})
    found = rsym.vertex_curvatures(mesh, ball, letters={"R": 3})
    count = len(mesh.vertices)
    assert_close(found["principal_curvatures"], np.full((count, 2), 1 / 3), atol=1e-13)
    assert found["principal_directions"].shape == (count, 2, 3)
    with pytest.raises(RsymError, match="revolve"):
        rsym.vertex_curvatures(mesh, Shape(x, (x, y)))
