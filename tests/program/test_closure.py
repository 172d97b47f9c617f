"""Closure: for every operation and every facility derived from it the answer is there, or a refusal that is written.

What is written of an operation is held against its plain meaning at points, so an answer that is left out, or wrong,
is red and not only slow or weak.
"""

import itertools
from dataclasses import MISSING, fields, replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.analysis.contracts.table import PROMISES
from rsym.backends import plain
from rsym.backends.interpreter import interpret
from rsym.backends.llvm_code import LlvmFunction
from rsym.backends.numpy_backend import NumpyFunction
from rsym.backends.source import KNOWN, program_source
from rsym.bounds import balls as ball_backend
from rsym.bounds import far_forms
from rsym.bounds.ball_series import SeriesFunction, arb, truncated
from rsym.bounds.balls import BallFunction
from rsym.bounds.intervals import IntervalFunction
from rsym.program import raising
from rsym.program.builder import Builder
from rsym.program.differentiation import derivative, gradient_of_one_side
from rsym.program.expansion import expand
from rsym.program.fields import Jumps
from rsym.program.lowering import LOWERINGS
from rsym.program.operations import OPERATIONS, SMOOTH
from rsym.program.program import Node
from rsym.program.row import Operation
from rsym.verify.boxes.domains import is_defined
from rsym.verify.boxes.generators import is_analytic_at
from rsym.verify.boxes.local import Model

NAMES = ("u0", "u1", "u2", "u3")
DATA = {"powi": 5, "const": Fraction(1, 3), "input": "u0", "monomial": (2, 1, -2)}
PARAMETERS = {
    **dict.fromkeys(("r_alpha_conjunction", "r_alpha_disjunction"), Fraction(1, 2)),
    **dict.fromkeys(("r0m_conjunction", "r0m_disjunction", "r0m_partial", "monomial"), Fraction(2)),
    **dict.fromkeys(("rp_conjunction", "rp_disjunction", "rp_versine", "norm"), Fraction(5, 2)),
    **dict.fromkeys(("equivalence", "joining", "absolute_power", "signed_power"), Fraction(3)),
}
GRID = [-2.3, -1.0, -0.5, 0.0, 0.7, 1.0, 3.1]
LOW, HIGH = np.array([1.01, 1.7, 2.4, 3.1]), np.array([1.05, 1.75, 2.45, 3.15])  # all is defined and analytic here
SQUARES = {"trimming": 0, "normalised": 1}  # arguments that are sums of squares

# Refusals.
NO_SERIES = {
    *(
        "asinh",
        "erf",
        "floor",
        "softplus",
        "sign",
        "min",
        "max",
        "select",
        "undefined",
        "gap",
        "trimming",
    ),  # not analytic, or never asked for
    *("r0_conjunction", "r0_disjunction", "versine", "absolute_power", "signed_power"),
    *("r_alpha_conjunction", "r_alpha_disjunction", "r0m_conjunction", "r0m_disjunction", "r0m_partial", "monomial"),
    *("norm", "rp_conjunction", "rp_disjunction", "rp_versine", "equivalence", "joining"),
}
JUMPS = {"sign", "select", "atan2"}  # at zeros of a switch
TORN = {*JUMPS, "floor"}
SWITCHED = {"abs", "sign", "min", "max", "select"}
NO_MEAN_VALUE = {*TORN, "undefined"}
UNBOUNDED = {"trimming", "r0m_partial", "monomial", "rp_versine"}  # where a choice below them is on its border
EVEN = {"norm", "rp_conjunction", "rp_disjunction", "equivalence"}
FREE = {"monomial", "absolute_power", "signed_power"}  # the parameter may be any number
LINEAR = {"add", "neg", "select", "zero_with"}
SIGNED = {"mul", "div", "neg", "powi", "atan2", "monomial", "zero_with"}  # have rules of their own
MONOTONE = {"min", "max", "sign", "exp", "erf", "asinh", "floor", "softplus", "gap", "trimming", "norm", "joining"}
MONOTONE |= {f"{system}_{word}" for system in ("r0", "r_alpha", "rp") for word in ("conjunction", "disjunction")}
NEVER_ANALYTIC = {"undefined", "floor"}
NO_DEGREE = {
    "const",
    "input",
    "undefined",
    "sign",
    "sin",
    "cos",
    "exp",
    "log",
    "pow",
    "atan2",
    "versine",
    "r0m_partial",
}
NO_DEGREE |= {"r0m_conjunction", "r0m_disjunction", "monomial", "rp_versine", "absolute_power", "signed_power"}
NO_DEGREE |= {
    "asinh",
    "erf",
    "floor",
    "softplus",
    "trimming",
}  # takes the square of the trimmed function, which has another degree


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
    for language in set(KNOWN) - {"vm"}:
        assert "out0" in program_source(program, language, {"parameter": 1.0})


def plain_route(operation):
    """What `rsym.lambdify` prints."""
    if operation in {"const", "input"}:
        return
    symbols = [sp.Symbol(name, real=True) for name in NAMES]
    _, _, count = single(operation)
    given = [*symbols[:count], *([sp.Rational(PARAMETERS[operation])] if operation in PARAMETERS else [])]
    formula = raising.raised_node(Node(operation, tuple(range(len(given))), DATA.get(operation)), given)
    points = safe()
    got = sp.lambdify(symbols, formula, [plain._MISSING, "numpy"])(*points.T)
    assert np.allclose(got, values(operation, points), rtol=1e-9, atol=0, equal_nan=True)


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


def strictness(operation):
    """NaN is passed on, or it is not."""
    count = single(operation)[2]
    spoilt = [grid(operation) for _ in range(count)]
    for k, points in enumerate(spoilt):
        points[:, k] = np.nan
    passes = count > 0 and all(bool(np.isnan(values(operation, points)).all()) for points in spoilt)
    assert OPERATIONS[operation].strict == (passes and operation not in {"monomial", "absolute_power"})  # NaN**0 is 1


def signs_and_symmetries(operation):
    """What a row says of signs, symmetries and degrees is true on a grid, and what is true is said."""
    row, points, count = OPERATIONS[operation], grid(operation), single(operation)[2]
    if count == 0:
        return
    known = values(operation, points)
    assert row.nonnegative == bool((known[~np.isnan(known)] >= 0).all())
    # Linear operations have rules of their own.
    doubled = values(operation, points * 2)
    assert row.homogeneous == (operation not in LINEAR and np.allclose(doubled, 2 * known, equal_nan=True))
    mirrored = values(operation, points * [-1, 1, 1, 1])
    if operation not in SIGNED and SQUARES.get(operation) != 0:
        for sign, parity in ((1, "even"), (-1, "odd")):
            assert (row.parity == parity) == np.allclose(mirrored, sign * known, equal_nan=True)
    if count > 1:
        exchanged = values(operation, points[:, [1, 0, 2, 3]]) if operation not in SQUARES else np.nan
        assert row.symmetric == np.allclose(exchanged, known, equal_nan=True)
        inside = {"and": points[:, :2].min(axis=1), "or": points[:, :2].max(axis=1)}
        found = [word for word, truth in inside.items() if (np.sign(truth) == np.sign(known)).all()]
        assert [row.logic] == (found or [""])


def zeros(operation):
    """By the signs of its arguments an operation is zero exactly where its row says."""
    points, count = grid(operation), single(operation)[2]
    if operation in {"monomial", "select"}:  # by its exponents; by what it chooses
        return
    known = values(operation, points)
    said = OPERATIONS[operation].zeros
    for signs in itertools.product((0, 1, -1), repeat=count):
        here = (np.sign(points[:, :count]) == signs).all(axis=1)
        if here.any() and not (operation == "atan2" and not any(signs)):  # its jump
            fits = [
                all(c == "*" or {"0": 0, "+": 1, "-": -1}[c] == s for c, s in zip(w, (*signs, 1), strict=False))
                for w in said
            ]
            assert any(fits) == bool((known[here] == 0).all()), signs


def growth(operation):
    """What a row says of growth is true, and what is bounded by two corners is said."""
    row, count = OPERATIONS[operation], single(operation)[2]
    assert bool(row.grows) == (operation in MONOTONE)
    points = grid(operation)
    for k, way in enumerate(row.grows[:count]):
        own = np.abs(points) if way == "|+|" else points
        step = np.zeros(4)
        step[k] = 0.125
        if way == "|+|" or (operation in SQUARES and SQUARES[operation] == k):
            step = step * np.where(points >= 0, 1, -1)
        change = values(operation, points + step) - values(operation, points)
        change = change[~np.isnan(change)]
        assert own.shape == points.shape
        assert (change <= 1e-12).all() if way == "-" else (change >= -1e-12).all()
    if len(row.grows) > count:  # the parameter
        builder, node, _ = made = single(operation, letter=True)
        slope = [
            np.broadcast_to(
                interpret(
                    builder.program({"value": node}),
                    {**dict(zip(NAMES, points.T, strict=True)), "parameter": float(PARAMETERS[operation]) + shift},
                )["value"],
                len(points),
            )
            for shift in (0.0, 0.125)
        ]
        change = slope[1] - slope[0]
        assert len(made) == 3
        assert (change <= 1e-12).all() if row.grows[-1] == "-" else (change >= -1e-12).all()
    if row.at is not None:
        operands = [arb(value) for value in (1.0, 1.75, 2.5)[:count]]
        operands += [arb(float(PARAMETERS[operation]))] if operation in PARAMETERS else []
        assert float(row.at(*operands)) == pytest.approx(values(operation, np.array([[1.0, 1.75, 2.5, 1.0]]))[0])


def parameters(operation):
    """Where the meaning of a parameter ends; beyond it there is no value, and no claim."""
    legal = OPERATIONS[operation].parameter
    assert (legal is not None) == (operation in PARAMETERS and operation not in FREE)
    if legal is None:
        return
    node = single(operation, letter=True)[:2]
    for value in (-3.0, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0):
        inputs = {"u0": 1.0, "u1": 1.75, "parameter": value}
        undefined = np.isnan(interpret(node[0].program({"value": node[1]}), inputs)["value"])
        assert not (undefined and legal.holds(value))
        assert not (not undefined and legal.excludes(value) and operation not in {"norm", "rp_versine"})
    if operation in ("r_alpha_conjunction", "r_alpha_disjunction"):  # min and max at the end of the range
        assert not OPERATIONS[operation].analytic_parameter.holds(1)


def edges_of_domains(operation):
    """Poles of powers, kinks on the axes that an even parameter smooths, and what branches or jumps."""
    row = OPERATIONS[operation]
    assert (row.branching, row.jumping) == (operation in SWITCHED, operation in JUMPS)
    assert (row.analytic_even is not None) == (operation in EVEN)
    if operation in {"absolute_power", "signed_power"}:
        assert not ball_backend.is_defined(operation, arb(0, 1), arb(-1))
        assert ball_backend.is_defined(operation, arb(0, 1), arb(1))
    if operation == "trimming":
        assert not ball_backend.is_defined(operation, arb(-1), arb(1))
    if operation == "monomial":
        assert not ball_backend.is_defined(operation, arb(0), arb(0), arb(1))
    if operation in EVEN:
        clauses = [{(test.kind, test.place) for test in clause} for clause in row.analytic_even]
        assert clauses == [{("nonzero", 0), ("nonzero", 1)}]


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
    doubts = ball_backend.doubts(builder.nodes, [node])
    for test, arguments in doubts:
        assert test(*(local.value(argument) for argument in arguments)) == wanted
    for point in grid(operation):
        values_there = values(operation, point[None])
        if np.isnan(values_there[0]):
            operands = [arb(value) for value in point[: single(operation)[2]]]
            operands += [arb(float(PARAMETERS[operation]))] if operation in PARAMETERS else []
            assert not ball_backend.is_defined(operation, *operands)


def choices(operation):
    """The companion of a jumping argument is a bound; without one there is no jump but at choices."""
    builder, node, count = single(operation)
    smooth = Jumps(builder)[node]
    assert (builder.value(smooth) == 0) == (operation not in TORN)
    if count == 0:
        return
    jumping = builder.make("sign", builder.add(builder.input("u0"), builder.const(-1)))  # 1 on one side of u0 = 1
    raised = builder.add(jumping, builder.const(3))
    arguments = [raised, *builder.nodes[node].arguments[1:]]
    if operation == "pow":
        arguments[1] = builder.const(Fraction(17, 10))
    other = builder.make(operation, *arguments, data=DATA.get(operation))
    companion = Jumps(builder)[other]
    ones = np.ones((1, 4)) * [1.0, 1.7, 2.4, 3.1]
    bound = values(operation, ones, companion, (builder, node, count))[0]
    sides = [values(operation, np.array([[value, 1.7, 2.4, 3.1]]))[0] for value in (2.0, 3.0, 4.0)]
    if operation != "undefined":
        assert np.isfinite(bound) == (operation not in UNBOUNDED)
        assert bound >= max(abs(sides[0] - sides[1]), abs(sides[2] - sides[1])) * (1 - 1e-12)


def far_form(operation):
    """The sign at s u is that of the far form at u and 1/s."""
    if operation == "input":
        return
    builder, node, _count = single(operation)
    forms = far_forms.FarForms(builder)
    far = forms[node]
    assert (OPERATIONS[operation].far is None) == (operation in NO_DEGREE)
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


CELLS = {
    "expansion": backends,
    "texts": backends,
    "derivative": derivatives,
    "jump": choices,
    "far": far_form,
    "formula": plain_route,
    "grows": growth,
    "at": balls,
    "rounding": intervals,
    "domain": domains,
    "parameter": parameters,
    "analytic_parameter": parameters,
    "analytic": domains,
    "analytic_even": edges_of_domains,
    "strict": strictness,
    "nonnegative": signs_and_symmetries,
    "symmetric": signs_and_symmetries,
    "homogeneous": signs_and_symmetries,
    "parity": signs_and_symmetries,
    "branching": edges_of_domains,
    "jumping": edges_of_domains,
    "logic": signs_and_symmetries,
    "zeros": zeros,
}
CHECKS = (
    *(backends, plain_route, derivatives, intervals, balls, taylor_series, mean_values),
    *(strictness, signs_and_symmetries, zeros, growth, parameters, edges_of_domains, domains, choices, far_form),
)


@pytest.mark.parametrize("operation", OPERATIONS)
def test_every_facility_answers_for_every_operation(operation):
    for check in CHECKS:
        check(operation)


def test_a_form_without_promise_is_not_lowered():
    """What a program can hold, contracts know: and lint, which asks them."""
    assert set(LOWERINGS) <= set(PROMISES)


def filled(row):
    """The cells of a row that say something."""
    return [cell for cell in fields(row) if cell.name in CELLS and getattr(row, cell.name) != default_of(cell)]


def default_of(cell):
    return cell.default if cell.default is not MISSING else cell.default_factory()


def test_every_cell_has_a_check():
    assert {cell.name for cell in fields(Operation)} == {"arity", "meaning", *CELLS}


@pytest.mark.parametrize("operation", OPERATIONS)
def test_a_cell_that_is_deleted_turns_the_closure_red(operation, monkeypatch):
    """Red proof."""
    row = OPERATIONS[operation]
    for cell in filled(row):
        with monkeypatch.context() as without:
            without.setitem(OPERATIONS, operation, replace(row, **{cell.name: default_of(cell)}))
            checks = dict.fromkeys((CELLS[cell.name], edges_of_domains, signs_and_symmetries, domains))
            assert any(fails(check, operation) for check in checks), cell.name


def fails(check, operation):
    try:
        check(operation)
    except (AssertionError, AttributeError, LookupError, TypeError):
        return True
    return False
