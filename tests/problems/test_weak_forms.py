"""Weak forms written as functions: the bits of `solve`, exact solutions, scikit-fem's own answers, what is refused."""

import math
import pickle

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.problems.weak.reading import weak_form
from rsym.problems.weak.traced import form_functions

RIM = rsym.disc(1).named("rim")
RING = RIM - rsym.disc(sp.Rational(1, 2)).named("bore")
ELLIPSE = 1 - x**2 - y**2 / sp.Rational(36, 100)


def laplace(u, v, w):
    return u.grad @ v.grad


def one(v, w):
    return 1.0 * v


def error(solution, exact):
    """In the mean square, as a share."""
    points, weights = solution.rule.points, solution.rule.weights
    wanted = sp.lambdify((x, y), exact)(*points.T)
    return math.sqrt(np.sum(weights * (solution.jets(points, 0)[0] - wanted) ** 2) / np.sum(weights * wanted**2))


def same(found, other):
    return np.array_equal(found.coefficients, other.coefficients) and np.array_equal(found.others, other.others)


def swirl(x, y):
    return 1 + np.hypot(x, y)


@pytest.mark.parametrize(
    ("a", "l", "conditions", "letters", "equation", "all_conditions"),
    [
        (laplace, one, 0, {}, "-laplacian(u) = 1", 0),
        (
            {"inside": laplace, "rim": lambda u, v, w: w.c * u * v},
            {"inside": lambda v, w: np.exp(w.x[0]) * v, "rim": lambda v, w: w.x[1] * v},
            {"bore": x},
            {"c": swirl},
            "-laplacian(u) = exp(x)",
            {"bore": x, "rim": rsym.robin(swirl, y)},
        ),
        (
            lambda u, v, w: w.k * laplace(u, v, w) + w.x[1] ** 2 * u * v + (w.b @ u.grad) * v,
            lambda v, w: w.f * v,
            {"rim": 0, "bore": rsym.constant()},
            {"k": rsym.Shape(2 + x, (x, y)), "b": (y, 3), "f": swirl},
            "-div(k*grad(u)) + y^2*u + dot(b, grad(u)) = f",
            {"rim": 0, "bore": rsym.constant()},
        ),
        (
            lambda u, v, w: (0.3 * u.laplacian * v.laplacian + 0.7 * np.einsum("ij,ij", u.hess, v.hess)) * w.d,
            one,
            {"bore": rsym.clamped()},
            {"d": 2},
            "d*bilaplacian(u) = 1",
            {"bore": rsym.clamped()},
        ),
    ],
)
def test_for_one_problem_the_answer_is_that_of_solve_to_the_last_bit(
    a,
    l,  # noqa: E741
    conditions,
    letters,
    equation,
    all_conditions,
):
    found = rsym.solve_form(RING, a, l, conditions, cells=8, letters=letters)
    poisson = sp.Rational(3, 10) if "bilaplacian" in equation else None
    other = rsym.solve(RING, equation, all_conditions, cells=8, letters=letters, poisson=poisson)
    if poisson is None:
        assert same(found, other)
    # Sums of coefficients are rounded in another order.
    np.testing.assert_allclose(found.coefficients, other.coefficients, atol=1e-9 * abs(other.coefficients).max())


def test_corners_and_an_axis_are_those_of_solve():
    square = rsym.rectangle(1, 1, (1, 0)).named("edge")
    found = rsym.solve_form(square, laplace, one, 0, cells=6)
    assert found.report.corners == 4
    assert same(found, rsym.solve(square, "-laplacian(u) = 1", 0, cells=6))
    half = RIM & rsym.half_plane((1, 0), 0)
    ball = rsym.solve_form(half, laplace, one, {"rim": 0}, cells=6, axis=y)
    assert same(ball, rsym.solve(half, "-laplacian(u) = 1", {"rim": 0}, cells=6, axis=y))
    u, v = form_functions(("x", "y"), 1)
    assert (u.laplacian * v).terms == {(0, 1): 1 / x, (0, 3): 1, (0, 5): 1}


@pytest.mark.parametrize("degree", [1, 3, 4])
def test_convection_and_diffusion_by_a_tensor_have_the_order_of_splines(degree):
    u = ELLIPSE * sp.exp(x) * sp.cos(2 * y)
    tensor, wind = sp.Matrix([[3 + x, y], [y / 2, 2]]), sp.Matrix([8 + y, 5 * x])
    slope = sp.Matrix([u.diff(x), u.diff(y)])
    flux = tensor * slope
    load = -flux[0].diff(x) - flux[1].diff(y) + wind.dot(slope) - u

    def a(u, v, w):
        return (w.K @ u.grad) @ v.grad + np.dot(np.array([8 + w.x[1], 5 * w.x[0]]), u.grad) * v - u * v

    shape = rsym.Shape(ELLIPSE, (x, y))
    found = [
        error(rsym.solve_form(shape, a, lambda v, w: load * v, 0, degree=degree, cells=n, letters={"K": tensor}), u)
        for n in (12, 24)
    ]
    assert math.log2(found[0] / found[1]) > degree + 0.7
    assert found[1] < (3e-3, 0, 3e-6, 6e-8)[degree - 1]


def test_what_flows_along_stands_beside_derivatives_of_v():
    """-div(grad u - b u) = div F, nothing held: (grad u - b u) . grad v = -F . grad v and what leaves by the rim."""
    u = 1 + x**2 - x * y
    b, flux = (2 + y, x), (x * y, sp.exp(x))
    left = sp.Matrix([u.diff(x) - b[0] * u, u.diff(y) - b[1] * u])
    out = x * left[0] + y * left[1]
    rest = -left[0].diff(x) - left[1].diff(y) + u - flux[0].diff(x) - flux[1].diff(y)

    def a(u, v, w):
        return (u.grad - u * np.array(b)) @ v.grad + u.value * v

    def load(v, w):
        return rest * v - np.array(flux) @ v.grad

    def leaving(v, w):
        return (out + np.array(flux) @ w.n) * v

    found = rsym.solve_form(RIM, a, {"inside": load, "boundary": leaving}, cells=6)
    assert error(found, u) < 1e-9


@pytest.mark.parametrize("sign", [1, -1])
def test_values_may_be_held_by_the_form_alone(sign):
    """Nitsche's way, the symmetric one and the other: normals, the size of cells and derivatives on the boundary."""

    def on_the_edge(u, v, w):
        return -(u.grad @ w.n) * v - sign * u * (v.grad @ w.n) + 50 / w.h * u * v

    def given(v, w):
        return w.x[0] * (-sign * (v.grad @ w.n) + 50 / w.h * v)

    found = rsym.solve_form(RIM, {"inside": laplace, "rim": on_the_edge}, {"inside": one, "rim": given}, cells=6)
    assert error(found, x + (1 - x**2 - y**2) / 4) < 1e-9


def test_a_form_of_the_residual_is_consistent_on_every_grid():
    """Streamline diffusion: the equation itself, times the size of cells, tested by the slope along the wind."""
    wind = np.array([20, 10])

    def a(u, v, w):
        return (
            0.1 * laplace(u, v, w)
            + (wind @ u.grad) * v
            + w.h / 50 * (wind @ u.grad - 0.1 * u.laplacian) * (wind @ v.grad)
        )

    u = (1 - x**2 - y**2) * (2 + x)
    load = -(u.diff(x, 2) + u.diff(y, 2)) / 10 + 20 * u.diff(x) + 10 * u.diff(y)

    def l(v, w):  # noqa: E743
        return load * (v + w.h / 50 * (wind @ v.grad))

    for cells in (5, 9):
        assert error(rsym.solve_form(RIM, a, l, 0, cells=cells), u) < 1e-10


def test_the_size_of_cells_is_that_of_the_grid():
    shape = rsym.disc(sp.Symbol("d"), letters={"d": 1})
    found = rsym.solve_form(shape, lambda u, v, w: u * v, lambda v, w: w.h * v, cells=6)
    for one, size in ((found, 2 / 6), (found.with_letters({"d": 3}), 6 / 6)):
        assert abs(one(0, 0) / np.max(one.rule.grid.size) - 1) < 1e-12
        assert abs(one(0, 0) / size - 1) < 0.1


def test_forms_of_parts_and_of_the_rest_hold_where_they_say():
    half = (RIM & rsym.half_plane((0, 1), 0).named("cut")).named("half")
    length = {"rim": math.pi, "cut": 2.0, "half": math.pi + 2, "boundary": math.pi + 2}

    def total(places):
        loads = {place: (lambda v, w, k=k: 10**k * v) for k, place in enumerate(places)}
        found = rsym.solve_form(half, lambda u, v, w: u * v, loads, cells=8, corners=False, estimate=False)
        return found.integral()  # v = 1

    assert abs(total(["rim"]) - length["rim"]) < 1e-10
    assert abs(total(["rim", ...]) - (length["rim"] + 10 * length["cut"])) < 1e-9
    assert abs(total(["boundary", "cut"]) - (length["boundary"] + 10 * length["cut"])) < 1e-9
    # Where parts lie in one another the smallest that is named has its form, as a condition; a and l by themselves.
    assert abs(total(["half", "cut", "inside"]) - (length["rim"] + 20 + 50 * math.pi)) < 1e-9
    a = {"inside": lambda u, v, w: u.grad @ v.grad, "half": lambda u, v, w: u * v, "cut": lambda u, v, w: 3 * u * v}
    found = rsym.solve_form(half, a, {"cut": lambda v, w: 2 * v, ...: lambda v, w: v}, cells=8)
    said = rsym.solve(half, "-laplacian(u) = 0", {"half": rsym.robin(1, 1), "cut": rsym.robin(3, 2)}, cells=8)
    assert abs(found(0.2, 0.3) - said(0.2, 0.3)) < 1e-12
    with pytest.raises(rsym.RsymError, match="all of that part belongs to"):
        total(["half", "rim", "cut"])


def test_functions_of_scikit_fem_mean_here_what_they_mean_there():
    skfem = pytest.importorskip("skfem")
    from skfem.helpers import dot, grad, mul

    @skfem.BilinearForm
    def a(u, v, w):
        return dot(mul(np.array([[2, 0.5], [0.5, 3]]), grad(u)), grad(v)) + np.sqrt(1 + w.x[0]) * u.grad[1] * v

    @skfem.LinearForm
    def l(v, w):  # noqa: E743
        return np.exp(w.x[0]) * np.cos(w.x[1]) * v

    @skfem.BilinearForm
    def on_the_right(u, v, w):
        return (2 + w.n[0] * w.x[1]) * u * v

    mesh = skfem.MeshQuad.init_tensor(*[np.linspace(0, 1, 9)] * 2).with_defaults()
    basis = skfem.Basis(mesh, skfem.ElementQuadP(5))
    edge = basis.boundary("right")
    answer = skfem.solve(
        *skfem.condense(a.assemble(basis) + on_the_right.assemble(edge), l.assemble(basis), D=basis.get_dofs("left"))
    )
    left, right = (rsym.Shape(f, (x, y)).named(name) for name, f in {"left": x, "right": 1 - x}.items())
    square = left & right & rsym.Shape(y * (1 - y), (x, y))
    found = rsym.solve_form(square, {"inside": a, "right": on_the_right}, l, {"left": 0}, cells=12, corners=False)
    places = np.array([[0.3, 0.8, 0.5], [0.4, 0.7, 0.1]])
    np.testing.assert_allclose(found(*places), basis.probes(places) @ answer, rtol=5e-5)  # corners, of both


def test_functions_of_numpy_become_formulas():
    def a(u, v, w):
        p, q = w.x
        value = np.sin(p) * np.exp(-q) / (2 + np.cos(q)) ** 2 + np.hypot(p, 1) - abs(q) ** 1.5 + np.arctan2(p, 3 + q)
        return sp.sqrt(1 + sp.tanh(p) ** 2) * np.float64(2) * u * v - (2**p + value) * v * u + 0 * (u.x * v.y)

    (found,) = weak_form(RIM, a, lambda v, w: 0, {}).inside.form.values()
    p, q = 0.3, -0.7
    value = math.sin(p) * math.exp(-q) / (2 + math.cos(q)) ** 2 + math.hypot(p, 1) - 0.7**1.5 + math.atan2(p, 3 + q)
    wanted = 2 * math.sqrt(1 + math.tanh(p) ** 2) - (2**p + value)
    assert abs(float(found.subs({x: p, y: q})) - wanted) < 1e-14


def test_letters_call_nothing_and_compile_nothing(monkeypatch):
    d, times = sp.Symbol("d"), []
    shape = rsym.disc(d, letters={d: 1}).named("rim")

    def a(u, v, w):
        times.append(w)
        return w["c"] * laplace(u, v, w) / w.d

    forms = {"rim": lambda u, v, w: w.n[0] ** 2 * u * v + w.n[1] ** 2 * w.d * u * v}
    found = rsym.solve_form(shape, {"inside": a, **forms}, lambda v, w: 4 * v, cells=6, letters={"c": 1})
    assert abs(found(0, 0) - 3) < 1e-11  # u = 1 - r**2 + 2, for u_n = -2
    assert len(times) == 1
    monkeypatch.setattr("rsym.backends.kernel.make_function", None)
    other = found.with_letters({"d": 2, "c": 1})
    assert len(times) == 1
    rim = other.rule.boundary
    ways = rim.weights * (rim.normals[:, 0] ** 2 + 2 * rim.normals[:, 1] ** 2)
    assert abs(ways @ other.jets(rim.points, 0)[0] / (16 * math.pi) - 1) < 1e-9  # v = 1
    again = pickle.loads(pickle.dumps(other))
    assert again(0.3, 0.1) == other(0.3, 0.1)


def test_without_cells_the_tolerance_is_met_and_a_formula_is_there():
    found = rsym.solve_form(RIM, laplace, lambda v, w: np.exp(w.x[0]) * v, y, tolerance=1e-6)
    assert found.report.estimate <= 1e-6
    other = rsym.solve(RIM, "-laplacian(u) = exp(x)", y, tolerance=1e-6)
    assert same(found, other)
    assert found.formula(5) == other.formula(5)
    assert found.flux("rim") == pytest.approx(other.flux("rim"), rel=1e-5)  # by the gradient, by Green's formula


def test_the_sign_of_a_form_is_that_of_its_values():
    found = rsym.solve_form(
        RIM,
        {"inside": lambda u, v, w: -laplace(u, v, w), "rim": lambda u, v, w: -2 * u * v},
        lambda v, w: -4 * v,
        cells=6,
    )
    assert same(found, rsym.solve(RIM, "-laplacian(u) = 4", rsym.robin(2), cells=6))


def a_of(text):
    """A form with one wrong thing in it."""
    wrong = {
        "square": lambda u, v, w: u * u.x * v,
        "sine": lambda u, v, w: np.sin(u) * v,
        "over": lambda u, v, w: v / (1 + u),
        "power": lambda u, v, w: laplace(u, v, w) + u**2 * v,
        "without u": lambda u, v, w: laplace(u, v, w) + w.x[0] * v,
        "without v": lambda u, v, w: laplace(u, v, w) + u,
        "constant": lambda u, v, w: 1.0,
        "vector": lambda u, v, w: u.grad * v,
        "normal": lambda u, v, w: (u.grad @ w.n) * v,
        "unknown": lambda u, v, w: w.kk * laplace(u, v, w),
        "symbol": lambda u, v, w: sp.Symbol("q") * laplace(u, v, w),
        "compared": lambda u, v, w: np.where(w.x[0] > 0, 1, 2) * laplace(u, v, w),
        "equal": lambda u, v, w: (2 if w.x[0] == 0 else 1) * laplace(u, v, w),
        "no formula": lambda u, v, w: math.gamma(w.x[0]) * laplace(u, v, w),
        "ragged": lambda u, v, w: (w.r @ u.grad) @ v.grad,
        "empty": lambda u, v, w: (w.e @ u.grad) @ v.grad,
        "of space": lambda u, v, w: (w.s @ u.grad) @ v.grad,
        "third": lambda u, v, w: u.grad[2] * v,
        "mixed": lambda u, v, w: np.sqrt(1 + sp.tanh(w.x[0])) * laplace(u, v, w),
        "ufunc": lambda u, v, w: np.i0(w.x[0]) * laplace(u, v, w),
        "shape": lambda u, v, w: RIM * laplace(u, v, w),
        "shape behind": lambda u, v, w: laplace(u, v, w) * RIM,
        "arity": lambda u, v: laplace(u, v, None),
        "attribute": lambda u, v, w: u.curl * v,
        "text": "u*v",
        "hyperbolic": lambda u, v, w: u.x * v.x - u.y * v.y,
        "first order": lambda u, v, w: u.x * v,
        "indefinite plate": lambda u, v, w: (
            u.laplacian * v.laplacian + 3 * (u.hess[0, 0] * v.hess[0, 1] + u.hess[0, 1] * v.hess[0, 0])
        ),
        "part": {"inside": laplace, "rum": lambda u, v, w: u * v},
        "too high": lambda u, v, w: u.laplacian * v.laplacian,
        "level": laplace,
        "twice": {"inside": laplace, "rim": lambda u, v, w: w.h * u * v},
    }
    return wrong[text]


@pytest.mark.parametrize(
    ("wrong", "code", "words"),
    [
        ("square", "form", r"not linear in u: u\*u_x"),
        ("sine", "form", "sin of u"),
        ("over", "form", "division by 1 \\+ u"),
        ("power", "form", "a power of u"),
        ("without u", "form", r"the form a has a term without u: x\*v"),
        ("without v", "form", "without v: u"),
        ("constant", "form", "without u"),
        ("vector", "form", "array of the shape"),
        ("normal", "form", "w.n, the normal"),
        ("unknown", "unknown-letter", "w has no 'kk'"),
        ("symbol", "unknown-letter", "contains q"),
        ("compared", "form", "compares x"),
        ("equal", "form", "compares x"),
        ("no formula", "form", "makes one number"),
        ("ragged", "form", "entries of 2 shapes"),
        ("empty", "form", "entries of 0 shapes"),
        ("of space", "form", "cannot be read"),
        ("third", "form", "cannot be read"),
        ("mixed", "form", "cannot be read"),
        ("ufunc", "form", "compares|cannot be read"),
        ("shape", "operator", r"no operator \*; remedy: .*shape.expression is omega"),
        ("shape behind", "form", "a coefficient"),
        ("arity", "form", "cannot be read"),
        ("attribute", "form", "no 'curl'"),
        ("text", "form", "must be a function"),
        ("hyperbolic", "not-elliptic", "not elliptic"),
        ("first order", "not-elliptic", "not elliptic"),
        ("indefinite plate", "not-elliptic", "not elliptic"),
        ("part", "unknown-part", "'rum'"),
        ("too high", "degree", "degree 2"),
        ("level", "singular", "nothing fixes"),
        ("twice", "form", "there is a letter 'h'"),
    ],
)
def test_what_is_no_form_is_refused_with_a_remedy(wrong, code, words):
    conditions = {} if wrong == "level" else 0
    letters = {"h": 1} if wrong == "twice" else {"r": ((1, 2), 3), "e": (), "s": np.eye(3)}
    degree = 1 if wrong == "too high" else 3
    with pytest.raises(rsym.RsymError, match=words) as raised:
        rsym.solve_form(RIM, a_of(wrong), one, conditions, cells=6, degree=degree, letters=letters)
    assert raised.value.code == code
    assert raised.value.remedy or code == "degree"


def test_conditions_on_fluxes_and_loads_with_u_are_refused():
    with pytest.raises(rsym.RsymError, match="'rim' is one on the flux") as raised:
        rsym.solve_form(RIM, laplace, one, {"rim": rsym.robin(1)}, cells=6)
    assert '"rim": lambda u, v, w: c * u * v' in raised.value.remedy
    with pytest.raises(rsym.RsymError, match="plates"):
        rsym.solve_form(RIM, laplace, one, rsym.clamped(), cells=6)
    square = rsym.rectangle(2, 2) & rsym.half_plane((1, 0), -2).named("far")
    with pytest.raises(rsym.RsymError, match="'far' has nothing of the boundary"):
        rsym.solve_form(square, {"inside": laplace, "far": lambda u, v, w: u * v}, one, {...: 0}, cells=6)


def test_data_that_are_undefined_are_told_with_a_place():
    with pytest.raises(rsym.RsymError, match=r"'f' is undefined at \(-"):
        rsym.solve_form(RIM, laplace, lambda v, w: np.sqrt(w.x[0]) * v, 0, cells=6)
    with pytest.raises(rsym.RsymError, match=r"on the boundary is undefined at \(-"):
        rsym.solve_form(RIM, laplace, {"rim": lambda v, w: np.log(w.x[0]) * v}, {"rim": 0}, cells=6)
    with pytest.raises(rsym.RsymError, match=r"on the boundary is undefined at \(-"):
        rsym.solve(RIM, "-laplacian(u) = 1", rsym.robin(1, sp.log(x)), cells=6)


def test_a_system_whose_answer_would_be_rounding_is_refused():
    def turned(u, v, w):
        return laplace(u, v, w) + u * v.x  # not of constant v

    with pytest.raises(rsym.RsymError, match="singular"):
        rsym.solve_form(RIM, turned, one, cells=6)


@pytest.mark.slow
def test_corner_functions_that_splines_nearly_make_up_refuse_no_problem_that_is_not_symmetric():
    """u = exp(5*x/2)*w, w of an equation that is symmetric; each solution has an error of its own."""
    shape = rsym.rectangle(2, 2) - rsym.rectangle(1, 1, (0.5, 0.5))
    other = rsym.solve(shape, "-laplacian(u) + 25/4*u = exp(-5*x/2)", 0, cells=32, degree=5)
    found = rsym.solve_form(shape, lambda u, v, w: u.grad @ v.grad + 5 * u.x * v, lambda v, w: v, 0, cells=32, degree=5)
    assert found(0.2, -0.3) == pytest.approx(math.exp(0.5) * other(0.2, -0.3), rel=1e-5)


@pytest.mark.slow
def test_what_is_carried_along_in_space_is_solved_by_steps():
    u = (1 - x**2 - y**2 - z**2) * sp.exp(x)
    load = -sum(u.diff(one, 2) for one in (x, y, z)) + 10 * u.diff(x) + 5 * y * u.diff(z)

    def a(u, v, w):
        return u.grad @ v.grad + (10 * u.x + 5 * w.x[1] * u.z) * v

    found = rsym.solve_form(rsym.sphere(1), a, lambda v, w: load * v, 0, cells=18, degree=2)
    assert found.report.unknowns > 3000
    assert found.report.steps > 0
    assert abs(found(0.1, 0.2, 0.3) - 0.86 * math.exp(0.1)) < 5e-5


def test_a_part_of_the_name_of_a_place_is_refused():
    ring = rsym.disc(1).named("boundary") - rsym.disc(0.5)
    forms = {"inside": laplace, "boundary": lambda u, v, w: u * v}
    with pytest.raises(rsym.RsymError, match="'boundary' is a part of this shape, and where forms stand"):
        rsym.solve_form(ring, forms, lambda v, w: v, cells=8)
