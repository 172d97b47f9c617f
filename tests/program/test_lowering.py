import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y
from rsym.program.fields import program_of

a, b = sp.symbols("a b", real=True)


def operations(expression, **letters):
    shape = Shape(expression, (x, y), letters=letters)
    return [node.operation for node in program_of(shape, ("value",)).nodes]


def value(expression, u, v, **letters):
    return rsym.compile(Shape(expression, (x, y), letters=letters), backend="numpy")(u, v)["value"]


@pytest.mark.parametrize(
    "expression",
    [
        x**3 + y**-2 + x ** sp.Rational(3, 2) + 1 / sp.sqrt(y),
        sp.sqrt(x) ** 5 * x ** sp.Rational(1, 3) + x**y + sp.pi * x + sp.E * y,
        sp.tan(x) + sp.sinh(y) * sp.cosh(x) - sp.tanh(y) + sp.cot(x),
        sp.atan(x) + sp.asin(y / 3) + sp.acos(x / 3) + sp.log(x) + sp.exp(-y),
        sp.Min(x, y, 1) + sp.Max(x, y**2) + sp.Abs(x - y) + sp.sign(x - y),
        sp.Piecewise((x, x < y), (y, x <= 1), (x * y, True)),
        sp.Piecewise((x, (x < y) & (y > 1)), (y, (x > 1) | ~(y < 2)), (5, True)),
        sp.GoldenRatio * x + sp.Float("0.1", 40) * y,
    ],
)
def test_every_function_means_what_sympy_means(expression):
    for u, v in ((0.7, 1.3), (1.6, 0.8), (1.1, 2.5)):
        assert_close(value(expression, u, v), float(expression.subs({x: u, y: v}).evalf(30)), rtol=1e-13)


@pytest.mark.parametrize("expression", [sp.gamma(x), sp.zeta(x), sp.DiracDelta(x), sp.besselj(0, x), sp.LambertW(x)])
def test_what_a_program_cannot_hold_is_refused_by_name(expression):
    with pytest.raises(RsymError) as caught:
        rsym.compile(Shape(expression, (x, y)))
    assert caught.value.code == "unsupported-function"
    assert type(expression).__name__ in str(caught.value)


@pytest.mark.parametrize(
    "expression", [x + sp.I, x * sp.zoo, sp.Piecewise((x, sp.Contains(x, sp.S.Integers)), (y, True))]
)
def test_other_things_that_are_refused(expression):
    with pytest.raises(RsymError):
        rsym.compile(Shape(expression, (x, y)))


def test_python_floats_are_exact_binary_values():
    program = program_of(Shape(x + 0.1, (x, y)), ("value",))
    (constant,) = [node.data for node in program.nodes if node.operation == "const"]
    assert constant == sp.Rational(0.1)


def test_a_constant_beyond_float64_is_refused():
    with pytest.raises(RsymError) as caught:
        rsym.compile(Shape(x + sp.Integer(10) ** 400, (x, y)))
    assert caught.value.code == "number-too-large"


def test_normalisation_is_one_node():
    f = 1 - x**2 / 4 - y
    assert "normalised" in operations(f / sp.sqrt(f**2 + 4 * x**2 + 1))
    assert "normalised" in operations(a * f / sp.sqrt(f**2 + a**2), a=2)
    assert "normalised" in operations(f / sp.sqrt(f**2 / 4 + 1))
    assert "normalised" not in operations(f / sp.sqrt(f**2 + x))
    assert "normalised" not in operations(f / sp.sqrt(f**2 / 3 + 1))
    assert_close(value(f / sp.sqrt(f**2 / 4 + 1), 0.5, -1.0), 1.9375 / np.sqrt(1.9375**2 / 4 + 1), rtol=1e-15)


def test_the_square_of_a_root_is_its_radicand_where_that_is_not_negative():
    radius = sp.sqrt(x**2 + y**2, evaluate=False)
    assert "sqrt" not in operations(sp.Pow(radius, 2, evaluate=False))


def test_a_quadratic_in_one_variable_is_completed():
    for expression in ((3 - x) * (x + 1), x**2 - 5 * x + y, (a - x) * (x - b) / (a - b), x**2 + a * x):
        program = program_of(Shape(expression, (x, y), letters={a: 2, b: 5}), ("value",))
        coordinate = next(k for k, node in enumerate(program.nodes) if node.data == "x")
        uses = {k for k, node in enumerate(program.nodes) if coordinate in node.arguments}
        assert len(uses) == 1, expression
        got = rsym.compile(Shape(expression, (x, y), letters={a: 2, b: 5}))(1.7, 0.4)["value"]
        assert_close(got, float(expression.subs({x: 1.7, y: 0.4, a: 2, b: 5})), rtol=1e-14)


def test_a_letter_is_never_divided_by_on_the_way():
    shape = Shape(a * x**2 + b * x, (x, y), letters={a: 0, b: 3})
    assert rsym.compile(shape)(2.0, 0.0)["value"] == 6.0


def test_a_condition_without_truth_gives_nan():
    for condition in (sp.sqrt(x) < 1, sp.sqrt(x) <= 1, sp.sqrt(x) > 1, sp.sqrt(x) >= 1):
        assert np.isnan(value(sp.Piecewise((1, condition), (2, True)), -1.0, 0.0))
    assert np.isnan(value(sp.Piecewise((x, x > 2)), 1.0, 0.0))


def test_the_derivative_of_a_maximum_on_its_tie_is_undefined():
    """The gradient of max is a Piecewise with NaN on the tie; the normalised shape is NaN there alone."""
    shape = rsym.normalise(Shape(1 - sp.Max(x, 0) ** 2 - y**2, (x, y)))
    kernel = rsym.compile(shape, backend="numpy")
    w = 1 - 0.3**2 - 0.4**2
    assert_close(kernel(0.3, 0.4)["value"], w / np.sqrt(w**2 + 4 * (0.3**2 + 0.4**2)), atol=1e-15)
    assert np.isnan(kernel(0.0, 0.4)["value"])
