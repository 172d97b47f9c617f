"""A choice between two formulas, on every route, also in the condition of another."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Shape, x, y
from rsym.model.choices import Choice

# |x| - y above the diagonal, x*y below; then the sign of that decides.
INNER = Choice(y, x, sp.Abs(x) - y, x * y)
OUTER = Choice(INNER, 0, INNER**2 + x, sp.sqrt(-INNER) - y)


def oracle(a, b):
    inner = np.where(b > a, abs(a) - b, a * b)
    with np.errstate(invalid="ignore"):
        return np.where(inner > 0, inner**2 + a, np.sqrt(-inner) - b)


def test_all_routes_agree_with_plain_cases():
    a, b = np.random.default_rng(3).uniform(-2, 2, (2, 200))
    shape = Shape(OUTER, (x, y))
    printed = sp.lambdify((x, y), OUTER)
    with np.errstate(invalid="ignore"):
        values = [printed(a, b), *(rsym.compile(shape, backend=name)(a, b)["value"] for name in ("llvm", "numpy"))]
    for value in (*values, rsym.lambdify(shape)(a, b)["value"]):
        assert_close(value, oracle(a, b), atol=1e-15)
    exact = [OUTER.subs({x: sp.Rational(p), y: sp.Rational(q)}).evalf(30) for p, q in zip(a[:9], b[:9], strict=True)]
    assert_close([float(value) for value in exact], oracle(a[:9], b[:9]), atol=1e-15)


def test_each_formula_is_differentiated_on_its_own():
    points = np.array([[1.0, -0.5, 0.3], [-2.0, 1.0, 0.7]])
    step = 1e-6
    shape = Shape(OUTER, (x, y))
    across = (oracle(points[0] + step, points[1]) - oracle(points[0] - step, points[1])) / (2 * step)
    along = (oracle(points[0], points[1] + step) - oracle(points[0], points[1] - step)) / (2 * step)
    assert_close(rsym.compile(shape, ("gradient",))(*points)["gradient"], np.transpose([across, along]), rtol=1e-7)
    with np.errstate(invalid="ignore"):
        symbolic = sp.lambdify((x, y), list(rsym.gradient(shape)))(*points)
    assert_close(np.broadcast_arrays(*symbolic), [across, along], rtol=1e-7)


def test_what_is_not_chosen_need_not_be_real():
    assert float(Choice(x, 0, x, sp.sqrt(-x)).subs(x, 2).evalf(5)) == 2
    assert float(Choice(x, 0, sp.sqrt(x), -x).subs(x, -2).evalf(5)) == 2
    left = Choice(x, y, 1, 0).subs(x, 1).evalf()
    assert left.has(y), "undecided as long as a symbol is there"


@pytest.mark.parametrize(("printed", "text"), [(str, "(x if x > y else 0)"), (sp.latex, r"\begin{cases} x & x > y")])
def test_it_prints(printed, text):
    assert printed(Choice(x, y, x, 0)).startswith(text)
