"""The promise of the program: its derivatives are the derivatives."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles.closeness import assert_close
from oracles.tiers import examples
from oracles.trees import LEAVES, formulas, trees, x, y, z

import rsym
from rsym import R0, R1, R0m, RAlpha, Rp, Shape
from rsym.backends.interpreter import interpret_nodes
from rsym.backends.kernel import compile_program
from rsym.program.fields import program_of

NAMES = ("value", "gradient", "laplacian")
POINTS = 5
SYSTEMS = [R0, R1, RAlpha(sp.Rational(1, 3)), R0m(2), Rp(4), Rp(sp.Rational(5, 2))]


def node_scale(program, points):
    """The largest absolute node value at each point."""
    nodes = interpret_nodes(program, dict(zip("xyz", points, strict=True)))
    return np.nanmax([np.abs(np.broadcast_to(node, len(points[0]))) for node in nodes], axis=0)


def exact(expressions, points):
    """The values of SymPy expressions with 50 digits, (points, expressions)."""
    function = sp.lambdify((x, y, z), list(expressions), modules="mpmath", cse=True)
    with mpmath.workdps(50):
        return np.array([[float(value) for value in function(*map(mpmath.mpf, point))] for point in points.T])


def numerical(expression, point, orders):
    """Derivatives by differences with 50 digits."""
    function = sp.lambdify((x, y, z), expression.doit(), modules="mpmath", cse=True)
    with mpmath.workdps(50):
        place = tuple(mpmath.mpf(float(c)) for c in point)
        return np.array([float(mpmath.diff(function, place, tuple(map(int, order)))) for order in orders])


@settings(max_examples=examples(40), deadline=None, derandomize=True)
@given(tree=trees(), seed=st.integers(0, 2**32 - 1))
def test_derivatives_of_random_trees(tree, seed):
    shape = Shape(tree, (x, y, z))
    program = program_of(shape, NAMES)
    points = np.random.default_rng(seed).uniform(-2, 2, (3, POINTS))
    allowed = 1e-10 * node_scale(program, points)
    results = {name: rsym.compile(shape, NAMES, backend=name)(*points) for name in ("numpy", "llvm")}
    for name in NAMES:
        assert np.array_equal(results["numpy"][name], results["llvm"][name], equal_nan=True)
    got = results["llvm"]
    expected = exact([tree, *rsym.gradient(shape), rsym.laplacian(shape)], points)
    assert_close(got["value"], expected[:, 0], atol=allowed)
    assert_close(got["gradient"], expected[:, 1:4], atol=allowed[:, None])
    assert_close(got["laplacian"], expected[:, 4], atol=allowed)
    steps = np.eye(3, dtype=int)
    assert_close(got["gradient"][0], numerical(tree, points.T[0], steps), atol=allowed[0])
    assert_close(got["laplacian"][0], numerical(tree, points.T[0], 2 * steps).sum(), atol=allowed[0])


@settings(max_examples=examples(40), deadline=None, derandomize=True)
@given(tree=trees(systems=SYSTEMS, max_leaves=5), seed=st.integers(0, 2**32 - 1))
def test_derivatives_in_every_system(tree, seed):
    """By differences with 50 digits; ties of R_1 have no derivative and are left out."""
    shape = Shape(tree, (x, y, z))
    point = np.random.default_rng(seed).uniform(-2, 2, (3, 1))
    got = rsym.compile(shape, NAMES)(*point)
    if np.isfinite(got["laplacian"]).all():
        allowed = 1e-10 * node_scale(program_of(shape, NAMES), point)[0]
        steps = np.eye(3, dtype=int)
        assert_close(got["value"], exact([tree], point)[:, 0], atol=allowed)
        assert_close(got["gradient"][0], numerical(tree, point.T[0], steps), atol=allowed)
        assert_close(got["laplacian"][0], numerical(tree, point.T[0], 2 * steps).sum(), atol=allowed)


def test_derivatives_where_systems_are_mixed():
    """Distinct operands: min(f, f) would be a tie everywhere."""
    a, b, c, d, e, f, *_ = LEAVES
    tree = R1.conjunction(R0.disjunction(a, R1.disjunction(b, c, d)), -R1.conjunction(R0.conjunction(e, -f), -a * b))
    shape = Shape(tree, (x, y, z))
    points = np.random.default_rng(4).uniform(-2, 2, (3, 200))
    got = rsym.compile(shape, NAMES)(*points)
    expected = exact([tree, *rsym.gradient(shape), rsym.laplacian(shape)], points)
    allowed = 1e-10 * node_scale(program_of(shape, NAMES), points)
    assert_close(got["value"], expected[:, 0], atol=allowed)
    assert_close(got["gradient"], expected[:, 1:4], atol=allowed[:, None])
    assert_close(got["laplacian"], expected[:, 4], atol=allowed)


def test_all_six_fields_of_a_body_against_fifty_digits():
    body = rsym.paper.skeleton_body()
    values = {sp.Symbol(n, real=True): sp.Rational(str(float(v.default))) for n, v in body.letters.items()}
    omega = body.expression.subs(values)
    shape = Shape(omega, (x, y))
    squared = sum((d**2 for d in rsym.gradient(shape)), sp.S.Zero)
    unit = rsym.normalise(shape)
    expressions = {
        "value": omega,
        "normalised": unit.expression,
        "gradient_squared": squared,
        "normalised_gradient_squared": sum((d**2 for d in rsym.gradient(unit)), sp.S.Zero),
        "laplacian": rsym.laplacian(shape),
        "normalised_laplacian": rsym.laplacian(unit),
    }
    points = np.random.default_rng(7).uniform((-8, -4), (9, 4), (20, 2)).T
    got = rsym.compile(body, rsym.SIX)(*points)
    expected = exact(expressions.values(), np.vstack([points, np.zeros(20)]))
    for name, column in zip(expressions, expected.T, strict=True):
        assert_close(got[name], column, atol=1e-9 * max(1, np.abs(column).max()))


class Truth:
    """The Boolean meaning."""

    @staticmethod
    def conjunction(f, g):
        return min(f, g)

    @staticmethod
    def disjunction(f, g):
        return max(f, g)


sizes = st.sampled_from([1.0, 1e-20, 1e20, 1e-150, 1e-300, 5e-324, 1e200, 1e308, 0.5, 3.0, 1e-9])
inputs = st.tuples(*[st.tuples(st.sampled_from([-1, 1]), sizes).map(lambda p: p[0] * p[1])] * 3)


@settings(max_examples=examples(40), deadline=None, derandomize=True)
@given(formula=formulas(3), points=st.lists(inputs, min_size=4, max_size=12), system=st.sampled_from(SYSTEMS))
def test_the_sign_is_the_boolean_truth(formula, points, system):
    shape = Shape(formula((x, y, z), system), (x, y, z))
    columns = np.array(points).T
    truth = [np.sign(formula(point, Truth)) for point in points]
    for backend in ("numpy", "llvm"):
        got = rsym.compile(shape, backend=backend)(*columns)["value"]
        assert np.sign(got).tolist() == truth


def test_a_wrong_sign_in_a_rule_would_be_seen(monkeypatch):
    """Red proof: the disjunction's derivative rule applied to a conjunction must fail the comparison."""
    from rsym.program import differentiation

    wrong = dict(differentiation.RULES, r0_conjunction=differentiation.RULES["r0_disjunction"])
    monkeypatch.setattr(differentiation, "RULES", wrong)
    shape = Shape(R0.conjunction(x, y), (x, y, z))
    got = compile_program(program_of(shape, ("gradient",)), ("gradient",), shape)(0.3, 0.4, 0.0)["gradient"]
    with pytest.raises(AssertionError):
        assert_close(got[0], numerical(shape.expression, (0.3, 0.4, 0.0), [(1, 0, 0)])[0], atol=1e-10)


def test_the_program_reads_as_a_listing_and_has_a_digest():
    first, second = (program_of(Shape(x * k + y, (x, y)), ("value",)) for k in (2, 3))
    assert "value = v" in str(first)
    assert first.digest != second.digest
    assert first.digest == program_of(Shape(x * 2 + y, (x, y)), ("value",)).digest


@pytest.mark.slow
def test_size_grows_linearly_with_depth():
    sizes_at = []
    for depth in (10, 20, 40):
        nest = x
        for k in range(depth):
            nest = R0.conjunction(nest, y - k) if k % 2 else R0.disjunction(nest, z + k)
        sizes_at.append(len(program_of(Shape(nest, (x, y, z)), rsym.SIX)))
    assert sizes_at[2] - sizes_at[1] <= 2.2 * (sizes_at[1] - sizes_at[0])
