"""Closure: for every operation and every facility derived from it the answer is there, or a refusal that is written.

What is written of an operation is held against its plain meaning at points, so an answer that is left out, or wrong,
is red and not only slow or weak.
"""

import itertools
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.analysis.contracts.table import PROMISES
from rsym.backends import plain
from rsym.backends.c_source import c_source
from rsym.backends.interpreter import interpret
from rsym.backends.llvm_backend import LlvmFunction
from rsym.backends.numpy_backend import NumpyFunction
from rsym.bounds import ball_domains, far_forms
from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import BallFunction
from rsym.bounds.intervals import IntervalFunction
from rsym.bounds.mean_values import SMOOTH
from rsym.program import definedness, jumps
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative
from rsym.program.expansion import expand
from rsym.program.lowering import LOWERINGS
from rsym.program.one_sided import gradient_of_one_side
from rsym.program.operations import OPERATIONS
from rsym.verify.domains import is_defined
from rsym.verify.generators import is_analytic_at
from rsym.verify.local import Model

NAMES = ("u0", "u1", "u2", "u3")
DATA = {"powi": 5, "const": Fraction(1, 3), "input": "u0", "monomial": (2, 1, -2)}
PARAMETERS = {
    **dict.fromkeys(("r_alpha_conjunction", "r_alpha_disjunction"), Fraction(1, 2)),
    **dict.fromkeys(("r0m_conjunction", "r0m_disjunction", "r0m_partial", "monomial"), Fraction(2)),
    **dict.fromkeys(("rp_conjunction", "rp_disjunction", "rp_versine", "norm"), Fraction(5, 2)),
    **dict.fromkeys(("equivalence", "joining", "absolute_power", "signed_power"), Fraction(3)),
}
GRID = [-2.3, -1.0, -0.5, 0.0, 0.7, 1.0, 3.1]
LOW, HIGH = np.array([1.0, 1.7, 2.4, 3.1]), np.array([1.05, 1.75, 2.45, 3.15])  # all is defined and analytic here
SQUARES = {"trimming": 0, "normalised": 1}  # arguments that are sums of squares

# Refusals.
NO_SERIES = {
    *("sign", "min", "max", "select", "undefined", "gap", "trimming"),  # not analytic, or never asked for
    *("r0_conjunction", "r0_disjunction", "versine", "absolute_power", "signed_power"),
    *("r_alpha_conjunction", "r_alpha_disjunction", "r0m_conjunction", "r0m_disjunction", "r0m_partial", "monomial"),
    *("norm", "rp_conjunction", "rp_disjunction", "rp_versine", "equivalence", "joining"),
}
NO_MEAN_VALUE = {"sign", "select", "atan2", "undefined"}  # jumps
NO_MEAN_VALUE |= {"pow", "versine", "gap", *PARAMETERS}  # left out: bounds are wider than they need be
NEVER_ANALYTIC = {"undefined", "zero_with"}
NO_DEGREE = {"const", "undefined", "sign", "sin", "cos", "exp", "log", "pow", "atan2", "versine", "r0m_partial"}
NO_DEGREE |= {"r0m_conjunction", "r0m_disjunction", "monomial", "rp_versine", "absolute_power", "signed_power"}
NO_DEGREE |= {"trimming"}  # takes the square of the trimmed function, which has another degree


def single(operation, letter=False):
    """A builder and the node of an operation on inputs; its parameter a number, or the letter `parameter`."""
    builder = Builder(NAMES, ("parameter",))
    count = OPERATIONS[operation].arity - (operation in PARAMETERS)
    arguments = [builder.input(name) for name in NAMES[:count]]
    if operation in PARAMETERS:
        arguments.append(builder.input("parameter") if letter else builder.const(PARAMETERS[operation]))
    return builder, builder.make(operation, *arguments, data=DATA.get(operation)), count


def values(operation, points, node=None, made=None):
    """The plain meaning of the operation, or of another node beside it, at points (n, 4)."""
    builder, own, _ = made or single(operation)
    program = builder.program({"value": own if node is None else node})
    inputs = dict(zip(NAMES, points.T, strict=True))
    return np.broadcast_to(interpret(program, inputs)["value"], len(points))


def safe(count=64):
    return np.random.default_rng(5).uniform(LOW, HIGH, (count, 4))


def grid(operation):
    arity = max(1, OPERATIONS[operation].arity - (operation in PARAMETERS))
    points = np.array(list(itertools.product(GRID, repeat=arity)))
    points = np.hstack([points, np.ones((len(points), 4 - arity))])
    if operation in SQUARES:
        points[:, SQUARES[operation]] **= 2
    return points


def backends(operation):
    builder, node, _ = single(operation)
    program, points = expand(builder.program({"value": node})), safe()
    expected = values(operation, points)
    for backend in (NumpyFunction, LlvmFunction):
        got = np.empty(len(points))
        backend(program).run([np.ascontiguousarray(column) for column in points.T], [0.0], [got])
        assert np.allclose(got, expected, rtol=1e-12, atol=0, equal_nan=True)
    assert "out0[i] = " in c_source(program, {"parameter": 1.0})


def plain_route(operation):
    """What `rsym.lambdify` prints."""
    if OPERATIONS[operation].arity == 0:
        return
    symbols = [sp.Symbol(name, real=True) for name in NAMES]
    _, _, count = single(operation)
    given = [*symbols[:count], *([sp.Rational(PARAMETERS[operation])] if operation in PARAMETERS else [])]
    formula = plain._formula(operation, given, DATA.get(operation))
    points = safe()
    got = sp.lambdify(symbols, formula, "numpy")(*points.T)
    assert np.allclose(got, values(operation, points), rtol=1e-9, atol=0)


def derivatives(operation):
    made = single(operation)
    builder, node, count = made
    points, step = safe(), 1e-5
    one_sided = gradient_of_one_side(builder, node)
    for k, name in enumerate(NAMES[:count]):
        moved = np.eye(4)[k] * step
        slope = (values(operation, points + moved) - values(operation, points - moved)) / (2 * step)
        for found in (derivative(builder, node, name), one_sided[k]):
            assert np.allclose(values(operation, points, found, made), slope, rtol=1e-5, atol=1e-7, equal_nan=True)


def intervals(operation):
    builder, node, _ = single(operation)
    found = IntervalFunction(builder.program({"value": node}), "numpy")(list(LOW), list(HIGH), [1.0])["value"]
    known = values(operation, safe())
    if operation == "undefined":
        return
    assert (found[0] <= known).all()
    assert (known <= found[1]).all()
    assert found[1] - found[0] <= 40 * np.ptp(known) + 1e-9


def balls(operation):
    builder, node, _ = single(operation)
    sides = [arb((low + high) / 2, (high - low) / 2) for low, high in zip(LOW, HIGH, strict=True)]
    (found,) = BallFunction(builder.nodes, [node])(dict(zip(NAMES, sides, strict=True)))
    if operation == "undefined":
        assert found is None
        return
    known = values(operation, safe())
    assert float(found.lower()) <= known.min() + 1e-12
    assert known.max() <= float(found.upper()) + 1e-12
    assert float(found.upper()) - float(found.lower()) <= 40 * np.ptp(known) + 1e-9


def taylor_series(operation):
    """One input: all arguments are t plus numbers."""
    builder = Builder(("t",), ())
    t, arity = builder.input("t"), OPERATIONS[operation].arity - (operation in PARAMETERS)
    arguments = [builder.add(t, builder.const(Fraction(7 * k, 10))) for k in range(arity)]
    arguments += [builder.const(PARAMETERS[operation])] if operation in PARAMETERS else []
    data = {**DATA, "input": "t"}.get(operation)
    node = builder.make(operation, *arguments, data=data)
    with truncated(2, 64):
        (found,) = SeriesFunction(builder.nodes, [node])(arb(1))
    assert (found is None) == (operation in NO_SERIES)
    if found is not None and arity:
        points = np.array([[1.0, 1.7, 2.4, 3.1]])
        assert float(found[0]) == pytest.approx(values(operation, points)[0])


def mean_values(operation):
    assert (operation in SMOOTH) != (operation in NO_MEAN_VALUE)


def totality(operation):
    """What is said to be defined everywhere is; what passes NaN on does."""
    if operation in {"const", "input"}:
        return
    points = grid(operation)
    undefined = bool(np.isnan(values(operation, points)).any())
    assert not (operation in definedness._TOTAL and undefined)
    count = single(operation)[2]
    for k in range(count):
        spoilt = points.copy()
        spoilt[:, k] = np.nan
        passes = bool(np.isnan(values(operation, spoilt)).all())
        assert passes or operation not in definedness._STRICT


def local_at(operation, low, high):
    """The operation over a box, on x, y, z and x + y; the balls of its arguments."""
    model = Model(rsym.Shape(x + y + z, (x, y, z)), {})
    b = model.builder
    given = [b.input("x"), b.input("y"), b.input("z")]
    given.append(b.add(given[0], given[1]))
    count = OPERATIONS[operation].arity - (operation in PARAMETERS)
    arguments = given[:count] + ([b.const(PARAMETERS[operation])] if operation in PARAMETERS else [])
    if operation in SQUARES:
        k = SQUARES[operation]
        arguments[k] = b.square(arguments[k])
    node = b.make(operation, *arguments, data={**DATA, "input": "x"}.get(operation))
    local = model.over(tuple(zip(low[:3], high[:3], strict=True)))
    return local, node


def domains(operation):
    """Defined and analytic where all arguments are apart from each other and from 0; a test that holds is right."""
    local, node = local_at(operation, LOW, HIGH)
    wanted = operation != "undefined"
    assert is_defined(local, node) == wanted
    assert is_analytic_at(local, node) == (operation not in NEVER_ANALYTIC)
    builder = local.model.builder
    doubts = ball_domains.doubts(builder.nodes, [node])
    for test, arguments in doubts:
        assert test(*(local.value(argument) for argument in arguments)) == wanted
    for point in grid(operation):
        values_there = values(operation, point[None])
        if np.isnan(values_there[0]):
            operands = [arb(value) for value in point[: single(operation)[2]]]
            operands += [arb(float(PARAMETERS[operation]))] if operation in PARAMETERS else []
            tests = ball_domains.TESTS
            assert operation in tests
            assert not tests[operation](*operands)


def choices(operation):
    """The companion of a jumping argument is a bound; without one there is no jump but at choices."""
    builder, node, count = single(operation)
    smooth = jumps.Jumps(builder)[node]
    assert (builder.value(smooth) == 0) == (operation not in jumps.SWITCHES)
    if count == 0:
        return
    jumping = builder.make("sign", builder.add(builder.input("u0"), builder.const(-1)))  # 1 on one side of u0 = 1
    raised = builder.add(jumping, builder.const(3))
    arguments = [raised, *builder.nodes[node].arguments[1:]]
    other = builder.make(operation, *arguments, data=DATA.get(operation))
    companion = jumps.Jumps(builder)[other]
    ones = np.ones((1, 4)) * [1.0, 1.7, 2.4, 3.1]
    bound = values(operation, ones, companion, (builder, node, count))[0]
    sides = [values(operation, np.array([[value, 1.7, 2.4, 3.1]]))[0] for value in (2.0, 3.0, 4.0)]
    if operation != "undefined":
        assert bound >= max(abs(sides[0] - sides[1]), abs(sides[2] - sides[1])) * (1 - 1e-12)


def far_form(operation):
    """The sign at s u is that of the far form at u and 1/s."""
    if operation == "input":
        return
    builder, node, _count = single(operation)
    forms = far_forms.FarForms(builder)
    far = forms[node]
    assert (far.degree == 0 and operation in NO_DEGREE) or operation not in NO_DEGREE
    points, size = grid(operation), 8.0
    inputs = dict(zip(NAMES, size * points.T, strict=True))
    inputs |= {far_forms.direction_of(name): column for name, column in zip(NAMES, points.T, strict=True)}
    inputs |= {far_forms.NEARNESS: 1 / size}
    got = np.broadcast_to(interpret(forms.builder.program({"value": far.node}), inputs)["value"], len(points))
    expected = values(operation, size * points)
    known = ~np.isnan(expected) & (np.abs(expected) > 1e-9)
    assert (np.sign(got) == np.sign(expected))[known].all()
    if operation not in NO_DEGREE:
        assert np.allclose(got[known] * size**far.degree, expected[known], rtol=1e-9)


CHECKS = (
    *(backends, plain_route, derivatives, intervals, balls, taylor_series, mean_values),
    *(totality, domains, choices, far_form),
)


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("operation", OPERATIONS)
def test_every_facility_answers_for_every_operation(operation, check):
    check(operation)


def test_a_form_without_promise_is_not_lowered():
    """What a program can hold, contracts know: and lint, which asks them."""
    assert set(LOWERINGS) <= set(PROMISES)
