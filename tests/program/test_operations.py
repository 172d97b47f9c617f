"""What was said of one operation in several places and is said once: the truth of it, and that all places follow."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import R1, Rp, Shape, joining, x, y, z
from rsym.bounds import balls
from rsym.bounds.balls import BallFunction, arb
from rsym.bounds.intervals import IntervalFunction
from rsym.model.functions import FUNCTIONS
from rsym.model.nodes import RealNode
from rsym.model.rewriting import REWRITTEN
from rsym.program.builder import Builder
from rsym.program.fields import program_of
from rsym.program.lowering import LOWERINGS
from rsym.program.operations import KINKED, OPERATIONS, SMOOTH
from rsym.verify.boxes.domains import is_legal
from rsym.verify.boxes.generators import is_analytic_at
from rsym.verify.boxes.local import Model
from rsym.verify.continuity import curves
from rsym.verify.cover import images
from rsym.verify.cover.images import conditions
from rsym.verify.lint import slopes


def test_a_norm_is_defined_for_all_orders_above_0():
    """Of joining of order 1 it is a part of the derivative, which one place took for undefined there."""
    assert balls.is_defined("norm", arb(1), arb(2), arb(1))
    assert not balls.is_defined("norm", arb(1), arb(2), arb(-1))
    model = Model(Shape(joining(x, y, order=1), (x, y)), {})
    norm = model.builder.make("norm", *(model.builder.input(name) for name in "xy"), model.builder.const(1))
    local = model.over(((1, 2), (1, 2)))
    assert is_legal(local, norm)
    assert images.is_legal(model.builder, norm)
    assert is_analytic_at(local, norm)


def test_r_alpha_is_legal_at_1_and_not_analytic_there():
    builder = Builder(("x", "y"), ())
    node = builder.make("r_alpha_conjunction", builder.input("x"), builder.input("y"), builder.const(1))
    assert images.is_legal(builder, node)
    assert conditions(builder, node) is None
    assert OPERATIONS["r_alpha_conjunction"].parameter.holds(1)


def test_bounds_of_r_operations_are_sharpened():
    """A coordinate that an R-operation uses twice does not widen its bounds as twice two coordinates would."""
    shape = Shape(Rp(4).conjunction(x - x**3 / 2, y + x / 4), (x, y))
    program = program_of(shape, ("value",))
    (number,) = (number for _, number in program.outputs)
    low, high = np.array([0.4, 0.4]), np.array([0.45, 0.45])
    plain, sharp = (
        IntervalFunction(program, "numpy", sharpened=nodes)(list(low), list(high))["value"] for nodes in ((), (number,))
    )
    points = np.random.default_rng(3).uniform(low, high, (500, 2)).T
    values = rsym.compile(shape)(*points)["value"]
    assert sharp[0] <= values.min() < values.max() <= sharp[1]
    assert sharp[1] - sharp[0] < 0.9 * (plain[1] - plain[0])
    jumps = {"sign", "select", "atan2", "undefined", "floor"}
    assert set(OPERATIONS) - set(SMOOTH) == jumps


@pytest.mark.parametrize("operation", ["min", "max", "select", "atan2", "gap", "zero_with"])
def test_what_is_defined_for_all_numbers_is_total(operation):
    assert OPERATIONS[operation].total


def test_trimming_takes_a_square():
    assert not OPERATIONS["trimming"].total
    assert not balls.is_defined("trimming", arb(-1, 0.5), arb(1))


def test_kinks_of_zero_sets_follow_from_the_rows():
    junctions = {name for name in OPERATIONS if name.endswith("junction")}
    kinked = {"abs", "sign", "min", "max", "select", "joining", "equivalence", "absolute_power", "signed_power"}
    assert set(KINKED) == junctions | kinked


def test_functions_that_level_off_are_some_that_a_program_holds():
    assert set(slopes._BOUNDED) <= set(LOWERINGS)
    assert slopes._BOUNDED


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_curve_takes_what_is_analytic_wherever_it_is_defined(name):
    row, t = FUNCTIONS[name], sp.Symbol("t", real=True)
    one = row.kind(*(t / 4, t / 3)[: row.arity[0]], evaluate=False)
    if row.analytic:
        assert curves.Curve((t, one), t, sp.Rational(1, 4), sp.Rational(1, 2)).dimension == 2
    else:
        with pytest.raises(rsym.RsymError) as caught:
            curves.Curve((t, one), t, sp.Rational(1, 4), sp.Rational(1, 2))
        assert caught.value.code == "curve"


@pytest.mark.random
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_model_file_takes_what_python_takes(name):
    """The same program, whether a formula is written in Python or in a file; and saved as it was."""
    row, least = FUNCTIONS[name], 1 if name == "acosh" else 0
    arguments = ("x/4 + 1" if least else "x/4", "y/8 + 1/2", "z/4")[: max(1, row.arity[0])]
    text = f"coordinates x y z\nbounds x [-1, 1] y [-1, 1] z [-1, 1]\nshape = {name}({', '.join(arguments)}) + y - z"
    written = rsym.loads(text)
    inner = (x / 4 + least, y / 8 + sp.Rational(1, 2), z / 4)[: max(1, row.arity[0])]
    made = Shape(row.kind(*inner) + y - z, (x, y, z), bounds=((-1, 1),) * 3)
    points = np.random.default_rng(9).uniform(0.1, 0.9, (3, 40))
    for field in ("value", "gradient"):
        one, other = (rsym.compile(shape, (field,))(*points)[field] for shape in (written, made))
        assert np.isfinite(other).all()
        np.testing.assert_allclose(one, other, rtol=1e-13, atol=1e-15)
    assert rsym.loads(rsym.dumps(made)).expression == made.expression
    constant = rsym.loads(f"coordinates x y\nshape = x + y + {name}({', '.join([f'{least} + 1/2'] * len(inner))})")
    assert float(rsym.compile(constant)(0.0, 0.0)["value"]) == pytest.approx(
        float(row.number(*[least + 0.5] * len(inner)))
    )
    assert FUNCTIONS[name].kind in {*LOWERINGS, *REWRITTEN}


def test_python_takes_no_function_that_a_model_file_has_no_word_for():
    kinds = {kind for kind in LOWERINGS if issubclass(kind, sp.Function) and not issubclass(kind, RealNode)}
    assert kinds - {sp.Piecewise} <= {row.kind for row in FUNCTIONS.values()}


def test_softplus_and_erf_keep_their_digits():
    """Stable where log(1 + exp(u)) overflows or loses what is small."""
    shape = Shape(FUNCTIONS["softplus"].kind(x) + 0 * y, (x, y))
    found = rsym.compile(shape)([-700.0, -40.0, 0.0, 40.0, 1e5], 0.0)["value"]
    np.testing.assert_allclose(found, np.logaddexp(0, [-700.0, -40.0, 0.0, 40.0, 1e5]), rtol=1e-15)
    assert (
        str(rsym.conjunction(FUNCTIONS["softplus"].kind(x), y, system=R1)) == "conjunction(softplus(x), y, system=R1)"
    )
    function = BallFunction(*_one("erf"))
    (ball,) = function({"x": arb(1, 0.5)})
    assert ball.contains(arb(0.5).erf())
    assert ball.contains(arb(1.5).erf())
    assert float(ball.rad()) < 0.24
    assert float(rsym.lambdify(Shape(sp.erf(x) + y, (x, y)))(0.5, 0.0)["value"]) == pytest.approx(0.5204998778130465)


def _one(operation):
    builder = Builder(("x",), ())
    return builder.nodes, [builder.make(operation, builder.input("x"))]


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_softplus_far_below_zero_has_derivatives(dtype):
    """exp(-u) overflows there, and its derivatives are none of those of softplus, which vanish."""
    shape = Shape(FUNCTIONS["softplus"].kind(x) + 0 * y, (x, y))
    at = np.array([-np.inf, -1e8, -800.0, -100.0, -80.0, 0.0, 80.0, 800.0, np.inf], dtype)
    found = rsym.compile(shape, ["gradient", "hessian"], dtype=dtype)(at, np.zeros_like(at))
    close = {"rtol": 1e-4 if dtype == "float32" else 1e-13, "atol": 1e-37}
    size = np.exp(-np.abs(at.astype(float)))
    slope = np.where(at > 0, 1, size) / (1 + size)
    np.testing.assert_allclose(found["gradient"][:, 0], slope, **close)
    bending = size / (1 + size) ** 2
    np.testing.assert_allclose(found["hessian"][:, 0, 0], bending, **close)
