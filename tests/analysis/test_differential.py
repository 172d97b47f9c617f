import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Shape, conjunction, trimming, x, y
from rsym.analysis.differential import derivative
from rsym.model.symbols import postorder

POINTS = np.random.default_rng(3).uniform(-2, 2, (2, 200))


def test_r_nodes_are_kept_in_derivatives():
    gradient = rsym.gradient(Shape(conjunction(x, y, x * y), (x, y)))
    assert gradient.has(type(conjunction(x, y)))


def test_against_sympy_on_smooth_functions():
    expression = sp.sin(x * y) * sp.exp(x) / (1 + y**2) + sp.atan2(y, x) + sp.log(x) ** y + sp.sqrt(x + y)
    for symbol in (x, y):
        ours, theirs = derivative(expression, symbol), sp.diff(expression, symbol)
        assert abs((ours - theirs).subs({x: sp.Rational(17, 10), y: sp.Rational(2, 5)}).evalf(30)) < 1e-20


@pytest.mark.slow
def test_the_hessian_is_that_of_the_square_roots():
    shape = Shape(conjunction(x - 1, trimming(y, x)), (x, y))
    ours = rsym.hessian(shape)
    theirs = sp.hessian(shape.expression.doit(), (x, y))
    at = {x: sp.Rational(1, 3), y: sp.Rational(5, 4)}
    assert max(abs(e) for e in (ours - theirs).subs(at).evalf(30)) < 1e-20
    assert abs((rsym.laplacian(shape) - theirs.trace()).subs(at).evalf(30)) < 1e-20


def test_no_dirac_and_no_heaviside_ever():
    expression = sp.Abs(x * y) * sp.Min(x, y**2) + sp.Max(x, y, 1)
    for _ in range(3):
        expression = derivative(expression, x)
        assert not expression.has(sp.DiracDelta, sp.Heaviside, sp.Derivative)


def test_sympys_own_second_derivative_of_r1_has_no_dirac_either():
    node = conjunction(x**2, y, x * y, system=rsym.R1)
    second = sp.diff(node, x, 2)
    assert not second.has(sp.DiracDelta, sp.Heaviside, sp.Abs)
    assert second.subs({x: 1, y: 5}).evalf() == sp.Float(2)
    assert sp.diff(node, y, 2).subs({x: 1, y: 5}).evalf() == 0


def test_a_tie_is_undefined():
    assert derivative(sp.Min(x, y), x).subs({x: 1, y: 1}) is sp.nan
    assert derivative(sp.Min(x, y), x).subs({x: 0, y: 1}) == 1
    assert derivative(sp.Max(x, y), x).subs({x: 0, y: 1}) == 0


def test_piecewise_differentiates_its_branches():
    inner = sp.Piecewise((x**2, x > y), (y * x, True))
    assert derivative(inner, x) == sp.Piecewise((2 * x, x > y), (y, True))


@pytest.mark.parametrize("count", [2, 3])
def test_the_gradient_of_a_joining_in_every_quadrant(count):
    """The first operand counts by its size, whose derivative is its sign."""
    shape = Shape(rsym.joining(*(x, y, x + y - 1)[:count]), (x, y))
    points = np.array([(0.3, 0.4), (-0.3, 0.4), (-0.3, -0.4), (0.3, -0.4)]).T
    expected = rsym.compile(shape, ("gradient", "hessian"), backend="numpy")(*points)
    closed = sp.lambdify((x, y), [rsym.gradient(shape), rsym.hessian(shape)])
    for k, point in enumerate(points.T):
        slope, bend = closed(*point)
        assert_close(slope.ravel().astype(float), expected["gradient"][k], atol=1e-13)
        assert_close(bend.astype(float), expected["hessian"][k], atol=1e-11)


@pytest.mark.parametrize("system", [rsym.R0, rsym.RAlpha(0.5), rsym.R0m(2), rsym.Rp(4)])
def test_a_fold_is_differentiated_at_linear_cost(system):
    """One factor a pair of operands: products of those of all pairs that follow would make 36 and 90 new parts."""

    def size(count):
        node = conjunction(*(sp.Symbol(f"a{k}", real=True) * x - k - y for k in range(count)), system=system)
        return len(set(postorder(derivative(derivative(node, x), y))))

    few, some, many = size(4), size(8), size(12)
    assert many - some <= 1.2 * (some - few)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_the_derivative_of_a_fold_is_the_sum_over_its_operands(backend):
    """Against the partial derivatives of the node itself."""
    operands = (x, y + 2, 3 - x * y, 1 + x**2)
    for system in (rsym.R0, rsym.RAlpha(0.5), rsym.R0m(2), rsym.Rp(4)):
        node = conjunction(*operands, system=system)
        count = len(node.args) - len(operands)
        terms = (node.fdiff(count + k + 1) * sp.diff(operand, x) for k, operand in enumerate(operands))
        both = [Shape(made, (x, y)) for made in (derivative(node, x), sp.Add(*terms))]
        ours, plain = (rsym.compile(shape, backend=backend)(*POINTS)["value"] for shape in both)
        assert_close(ours, plain, rtol=1e-12)
