"""Every rule of differentiation, first and second order, against differences with 50 digits."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import R0, R1, R0m, RAlpha, Rp, Shape, equivalence, joining, trimming, x, y
from rsym.backends.interpreter import interpret
from rsym.model.functions import Softplus
from rsym.model.nodes import ZeroWith
from rsym.model.powers import absolute_power, signed_power
from rsym.program.builder import Builder
from rsym.program.differentiation import RULES, derivative
from rsym.program.fields import program_of
from rsym.program.operations import OPERATIONS

CASES = {
    "add mul": x * y + x**2 * y - 3 * x,
    "div": (x + y**2) / (x * y + 5),
    "neg powi": -(x**5) + y**-3,
    "pow": (x + 2) ** y + (y + 2) ** sp.Rational(1, 3),
    "sqrt": sp.sqrt(x * y + x + 4),
    "root with powers of its radicand": (x * y + x + 4) ** sp.Rational(7, 2) + (x + 2) ** sp.Rational(5, 2),
    "abs": sp.Abs(x - y) * (x + y**2),
    "sign": sp.sign(x - y) * x**2 * y,
    "min": sp.Min(x * y, x - y, y**2 - 3),
    "max": sp.Max(x * y, x - y, y**2 - 3),
    "select": sp.Piecewise((x**2 * y, x > y), (sp.sin(x) * y, x < -1), (x**3, True)),
    "sin cos": sp.sin(x * y) * sp.cos(x - y**2),
    "exp log": sp.exp(-x * y) * sp.log(x + y**2 + 3),
    "erf": sp.erf(x * y - 1) * x,
    "asinh r": sp.asinh(x * y - 1) * y + sp.acosh(x**2 + y**2 + 1),
    "floor r": sp.floor(x * y) * x**2 + sp.Mod(x - y, 2) * y,
    "softplus r": Softplus(x * y - y),
    "atan2": sp.atan2(x * y + 3, x - y),
    "tan tanh": sp.tan(x / 3) * sp.tanh(y) + sp.sinh(x) * sp.cosh(y),
    "asin acos atan": sp.asin(x / 4) * sp.acos(y / 4) + sp.atan(x * y),
    "r0_conjunction versine": R0.conjunction(x * y, x - y, 3 - x**2),
    "r0_disjunction": R0.disjunction(x * y, x - y, 3 - x**2),
    "r1": R1.conjunction(R1.disjunction(x * y, x - y), 3 - x**2),
    "r_alpha": RAlpha(sp.Rational(1, 3)).conjunction(RAlpha(-sp.Rational(1, 2)).disjunction(x * y, x - y), 3 - x**2),
    "r0m partial monomial": R0m(2).conjunction(R0m(3).disjunction(x * y, x - y), 3 - x**2),
    "rp even": Rp(4).conjunction(Rp(6).disjunction(x * y, x - y), 3 - x**2),
    "rp odd": Rp(3).conjunction(Rp(5).disjunction(x * y, x - y), 3 - x**2),
    "rp fraction": Rp(sp.Rational(5, 2)).conjunction(Rp(sp.Rational(7, 2)).disjunction(x * y, x - y), 3 - x**2),
    "equivalence norm": equivalence(equivalence(x * y, x - y, order=1), 3 - x**2, x - 1, order=3),
    "joining": joining(joining(x * y, x - y, order=2), trimming(3 - x**2, x), order=3),
    "trimming gap": trimming(x - y**2, 2 - x * y),
    "zero_with": ZeroWith(x - y, (x - y) * sp.sin(x)),
    "normalised": (x * y - 1) / sp.sqrt((x * y - 1) ** 2 + x**2 + y**2),
}
POINTS = np.random.default_rng(11).uniform((0.2, 0.3), (1.9, 1.7), (6, 2)).T * np.array([[1], [-1]])


@pytest.mark.random
@pytest.mark.parametrize("name", CASES)
def test_a_rule(name):
    expression = CASES[name]
    points = POINTS if "exp" in name or "r" in name else np.abs(POINTS)
    result = rsym.compile(Shape(expression, (x, y)), ("gradient", "hessian"))(*points)
    exact = sp.lambdify((x, y), expression.doit(), modules="mpmath")
    for k, point in enumerate(points.T):
        with mpmath.workdps(50):
            place = tuple(map(mpmath.mpf, point))
            first = [float(mpmath.diff(exact, place, order)) for order in ((1, 0), (0, 1))]
            second = [float(mpmath.diff(exact, place, order)) for order in ((2, 0), (1, 1), (0, 2))]
        assert_close(result["gradient"][k], first, atol=1e-12 * (1 + np.abs(first).max()))
        assert_close(result["hessian"][k][[0, 0, 1], [0, 1, 1]], second, atol=1e-11 * (1 + np.abs(second).max()))


def test_every_operation_has_a_rule_and_every_rule_a_case():
    assert set(RULES) | {"const", "input"} == set(OPERATIONS)
    seen = set()
    for expression in CASES.values():
        program = program_of(Shape(expression, (x, y)), ("value", "gradient", "hessian"))
        seen |= {node.operation for node in program.nodes}
    assert seen - {"const", "input"} == set(RULES)


@pytest.mark.parametrize("node", [R1.conjunction(x, y), R1.disjunction(x, y), sp.Min(x, y), sp.Max(x, y)])
def test_a_tie_has_no_derivative(node):
    gradient = rsym.compile(Shape(node, (x, y)), ("gradient",))([1.0, 1.0], [1.0, 2.0])["gradient"]
    assert np.isnan(gradient[0]).all()
    assert sorted(gradient[1]) == [0, 1]


def test_half_powers_have_the_derivatives_that_there_are_at_0():
    """Of x sqrt(x) as a product there is 0/0."""
    kernel = rsym.compile(Shape(x ** sp.Rational(5, 2) + (x**2 + y**2) ** sp.Rational(3, 2), (x, y)), "gradient")
    assert kernel(0.0, 0.0)["gradient"].tolist() == [0, 0]
    builder = Builder(("x",), ())
    node = builder.mul(builder.powi(builder.input("x"), 2), builder.sqrt(builder.input("x")))
    for _ in range(2):
        node = derivative(builder, node, "x")
        assert interpret(builder.program({"d": node}), {"x": [0.0]})["d"] == [0.0]


def test_the_kink_of_the_absolute_value_has_none():
    result = rsym.compile(Shape(sp.Abs(x) + y, (x, y)), ("value", "gradient"))([0.0, -2.0], 0.0)
    assert result["value"].tolist() == [0, 2]
    assert np.isnan(result["gradient"][0, 0])
    assert result["gradient"][1].tolist() == [-1, 1]


def test_the_angle_of_a_sine_and_a_cosine_is_the_angle():
    turn, places = 3 * x - 2 * y * x, np.random.default_rng(3).uniform(-3, 3, (2, 300))
    sine, cosine = (function(3 * places[0] - 2 * places[1] * places[0]) for function in (np.sin, np.cos))
    double = cosine**2 - sine**2
    waves = {
        sp.atan2(sp.sin(turn), sp.cos(turn)): (1, 0),
        sp.atan2(sp.sin(turn), sp.Abs(sp.cos(turn))): (np.sign(cosine), 1),
        sp.atan2(sp.sin(turn), sp.cos(2 * turn)): (
            (cosine * double + 4 * sine**2 * cosine) / (sine**2 + double**2),
            2,
        ),
    }
    for wave, (slope, quotients) in waves.items():
        kernel = rsym.compile(rsym.Shape(wave, (x, y)), ("gradient",))
        expected = np.stack([slope * (3 - 2 * places[1]), slope * -2 * places[0]], axis=1)
        assert_close(kernel(*places)["gradient"], expected, rtol=1e-9, atol=1e-9)
        assert sum(node.operation == "div" for node in kernel.program.nodes) == quotients


@pytest.mark.parametrize("base", [-1.7, 0.6])
def test_powers_are_differentiated_by_an_exponent_that_is_a_letter(base):
    p = sp.Symbol("p", real=True)
    for power in (absolute_power, signed_power):
        builder = Builder(("x",), ("p",))
        number = builder.make(power.__name__, builder.input("x"), builder.input("p"))
        program = builder.program({"by": derivative(builder, number, "p")})
        found = interpret(program, {"x": base, "p": 2.5})["by"]
        sign = np.sign(base) if power is signed_power else 1.0
        exact = float(mpmath.diff(lambda e, sign=sign: sign * mpmath.mpf(abs(base)) ** e, 2.5))
        assert_close(found, exact, rtol=1e-14)
        assert_close(float(power(x, p).diff(p).subs({x: base, p: 2.5})), exact, rtol=1e-14)
