"""Systems against dense algebra: conjugate gradients, eigenvalues, extension, sums axis by axis."""

import numpy as np
import pytest
from scipy import sparse

import rsym
from rsym.problems.splines.web import web_splines
from rsym.problems.systems import iterations, linear
from rsym.problems.systems.forms import Assembler, CellPoints, extended


def laplace(n):
    line = sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(n, n))
    scale = sparse.diags(10.0 ** np.linspace(-3, 3, n * n))
    return (scale @ (sparse.kron(line, sparse.eye(n)) + sparse.kron(sparse.eye(n), line)) @ scale).tocsr()


def scaled(matrix):
    scale = sparse.diags(linear.scales(matrix))
    return (scale @ matrix @ scale).toarray()


def test_both_ways_to_solve_agree_with_dense_algebra(monkeypatch):
    matrix, right = laplace(12), np.arange(144.0)
    exact = np.linalg.solve(matrix.toarray(), right)
    direct = linear.solve_system(matrix, right, definite=True, dimension=2)
    monkeypatch.setitem(linear.DIRECT, 2, 10)
    steps = linear.solve_system(matrix, right, definite=True, dimension=2)
    assert direct.steps == 0 < steps.steps
    condition = np.linalg.cond(scaled(matrix))
    assert 0.9 * condition < direct.condition < (1 + 1e-9) * condition
    assert 0.999 * condition < steps.condition < (1 + 1e-9) * condition
    for found in (direct, steps):
        np.testing.assert_allclose(found.values, exact, rtol=1e-8)
        assert found.residual < 1e-12


def test_splines_that_reach_far_beyond_a_thin_part_do_not_make_a_fixed_answer_unsure():
    """A neck of 0.005 beside cells of 1/8: numbers of splines are open to 1e-4, what they add up to is not."""
    shape = rsym.rectangle(2, 2) - rsym.rectangle(1, 1, (0.5, 0.5)).rotate(0.1)
    high, low = (rsym.solve(shape, "-laplacian(u) = 1", 0, cells=16, degree=degree) for degree in (6, 4))
    assert abs(high.integral() / low.integral() - 1) < 1e-5


def test_steps_that_do_not_end_give_way_to_factors_or_are_told(monkeypatch):
    matrix, right = laplace(12), np.arange(144.0)
    exact = np.linalg.solve(matrix.toarray(), right)
    monkeypatch.setitem(linear.DIRECT, 2, 10)
    monkeypatch.setattr(linear, "FEWER_STEPS", 5)
    found = linear.solve_system(matrix, right, definite=True, dimension=2)
    assert found.steps == 0
    assert not found.stopped
    np.testing.assert_allclose(found.values, exact, rtol=1e-8)
    monkeypatch.setitem(linear.RESCUED, 2, 10)
    monkeypatch.setattr(linear, "MOST_STEPS", 38)
    with pytest.warns(rsym.RsymWarning, match="after 38 steps"):
        found = linear.solve_system(matrix, right, definite=True, dimension=2)
    assert found.stopped
    assert linear.STEPS_SMALL < found.residual < linear.UNSURE
    monkeypatch.setattr(linear, "MOST_STEPS", 5)
    with pytest.raises(rsym.RsymError, match="nearly singular"):
        linear.solve_system(matrix, right, definite=True, dimension=2)


def carried(n):
    """One that is not symmetric."""
    along = sparse.kron(sparse.diags([-1.0, 1.0], [-1, 1], shape=(n, n)), sparse.eye(n))
    return (laplace(n) + sparse.diags(laplace(n).diagonal() / 6) @ along).tocsr()


def test_what_is_not_symmetric_is_solved_by_steps_or_by_factors_where_these_are_slow(monkeypatch):
    matrix, right = carried(12), np.arange(144.0)
    exact = np.linalg.solve(matrix.toarray(), right)

    def found():
        return linear.solve_system(matrix, right, definite=False, dimension=3, symmetric=False)

    factored = found()
    monkeypatch.setitem(linear.DIRECT_UNEVEN, 3, 10)
    steps = found()
    monkeypatch.setattr(iterations, "UNEVEN_STEPS", 5)
    slow = found()
    assert factored.steps == slow.steps == 0 < steps.steps < 400
    # An error is the inverse times the residual: that of the scaled system for one, of rounding alone for the other,
    # at most eps*n times the sizes of matrix and answer. By Cauchy and Schwarz, row by row of the inverse.
    scale = linear.scales(matrix)
    gain = np.linalg.norm(np.linalg.inv(matrix.toarray()) / scale, axis=1)
    scaled = scale[:, None] * matrix.toarray() * scale
    rounding = 144 * np.finfo(float).eps * np.linalg.norm(scaled) * np.linalg.norm(exact / scale)
    for one in (factored, steps, slow):
        assert one.residual < 1e-11
        assert (np.abs(one.values - exact) <= gain * (one.residual * np.linalg.norm(scale * right) + rounding)).all()


def test_a_singular_system_that_is_not_symmetric_is_refused_by_steps_too(monkeypatch):
    monkeypatch.setitem(linear.DIRECT_UNEVEN, 3, 10)
    one = np.eye(60)
    ring = sparse.csr_matrix(3 * one - 2 * np.roll(one, 1, axis=1) - np.roll(one, -1, axis=1))
    with pytest.raises(rsym.RsymError) as raised:
        linear.solve_system(ring, np.arange(60.0), definite=False, dimension=3, symmetric=False)
    assert raised.value.code == "singular"


@pytest.mark.parametrize(("make", "symmetric"), [(laplace, True), (carried, False)])
def test_threads_do_not_change_the_bits_of_conjugate_gradients(make, symmetric, monkeypatch):
    monkeypatch.setitem(linear.DIRECT, 2, 10)
    monkeypatch.setitem(linear.DIRECT_UNEVEN, 2, 10)
    found = []
    for threads in (1, 3):
        monkeypatch.setattr(iterations, "checked_threads", lambda _, count=threads: count)
        kinds = {"definite": symmetric, "symmetric": symmetric}
        made = linear.solve_system(make(12), np.arange(144.0), dimension=2, **kinds)
        assert made.steps > 0
        found.append(made.values)
    assert (found[0] == found[1]).all()


@pytest.mark.parametrize(("apart", "count"), [(0.0, 143), (1e-8, 143), (1e-5, 144)])
def test_functions_that_others_make_up_leave_the_answer_alone(apart, count):
    """The last function is a sum of two others, but for a little of something else."""
    line = 2 * np.eye(12) - np.eye(12, k=1) - np.eye(12, k=-1)
    whole, right = np.kron(line, np.eye(12)) + np.kron(np.eye(12), line), np.arange(144.0)
    made = np.vstack([np.eye(143, 144), np.eye(144)[3] + np.eye(144)[70] + apart * np.eye(144)[143]])
    matrix = sparse.csr_matrix(made @ whole @ made.T)
    found = linear.solve_system(matrix, made @ right, definite=True, dimension=2, last=1)
    exact = np.append(np.linalg.solve(whole[:count, :count], right[:count]), np.zeros(144 - count))
    np.testing.assert_allclose(made.T @ found.values, exact, rtol=0, atol=1e-6 * np.abs(exact).max())
    for last in (0, 1):  # what is singular without it is refused with it too
        again = sparse.block_diag([np.ones((2, 2)), matrix], format="csr")
        with pytest.raises(rsym.RsymError, match="the system"):
            linear.solve_system(again, np.arange(146.0), definite=True, dimension=2, last=last)


def test_eigenvalues_agree_with_dense_algebra():
    matrix, mass = laplace(8), sparse.diags(10.0 ** np.linspace(-6, 6, 64)).tocsr()
    values, vectors = linear.eigenpairs(matrix, mass, 3)
    scale = np.diag(1 / np.sqrt(mass.diagonal()))
    np.testing.assert_allclose(values, np.linalg.eigvalsh(scale @ matrix.toarray() @ scale)[:3], rtol=1e-9)
    np.testing.assert_allclose(matrix @ vectors, mass @ vectors * values, atol=1e-6 * np.abs(matrix @ vectors).max())


def test_a_singular_system_is_refused():
    with pytest.raises(rsym.RsymError, match="no answer"):
        linear.factored(sparse.csr_matrix(np.array([[1.0, 0.0], [0.0, 0.0]])))


@pytest.mark.parametrize(("dimension", "order"), [(2, 1), (2, 2), (3, 1)])
def test_sums_axis_by_axis_are_those_of_points(dimension, order):
    """The same rule, once known to be a plain one, once not."""
    rng, q = np.random.default_rng(3), 4
    counts = (3, 2, 2)[:dimension]
    cells = np.arange(int(np.prod(counts)))
    splines = web_splines(np.zeros(dimension), 0.5, counts, 2, cells, cells)
    t = (np.polynomial.legendre.leggauss(q)[0] + 1) / 2
    local = np.stack(np.meshgrid(*[t] * dimension, indexing="ij"), axis=-1).reshape(-1, dimension)
    points = ((splines.cells(cells)[:, None] + local) * 0.5).reshape(-1, dimension)
    owner = np.repeat(cells, q**dimension)
    assembler = Assembler(splines, order, threads=1)
    kinds = assembler.kinds
    forms, weight = rng.standard_normal((len(points), kinds, kinds)), rng.standard_normal((kinds, len(points)))
    loads = rng.standard_normal((len(points), kinds, 2))
    for given, symmetric in ((forms, False), (forms + forms.transpose(0, 2, 1), True)):
        plain, other = (
            assembler.matrix(where, lambda some, _, given=given: given[some], lambda _: weight, symmetric=symmetric)
            for where in (CellPoints(points, owner, cells, q), CellPoints(points, owner))
        )
        np.testing.assert_allclose(plain.toarray(), other.toarray(), atol=1e-10 * np.abs(other.toarray()).max())
    even = forms + forms.transpose(0, 2, 1)
    half, whole = (
        assembler.matrix(CellPoints(points, owner), lambda some, _: even[some], lambda _: weight, symmetric=symmetric)
        for symmetric in (True, False)
    )
    np.testing.assert_allclose(half.toarray(), whole.toarray(), atol=1e-10 * np.abs(whole.toarray()).max())
    first, second = (
        assembler.loads(where, lambda some, _: loads[some], lambda _: weight, 2)
        for where in (CellPoints(points, owner, cells, q), CellPoints(points, owner))
    )
    np.testing.assert_allclose(first, second, atol=1e-11 * np.abs(second).max())


def test_the_extended_matrix_is_that_of_the_extension():
    full = np.array([9 * i + j for i in range(9) for j in range(9) if (i - 4) ** 2 + (j - 4) ** 2 < 14])
    splines = web_splines(np.zeros(2), 1.0, (9, 9), 2, np.arange(81), full)
    n = len(splines.active)
    matrix = sparse.random(n, n, 0.1, random_state=1, format="csr")
    matrix = (matrix + matrix.T).tocsr()
    e = splines.extension.toarray()
    np.testing.assert_allclose(extended(splines, matrix).toarray(), e.T @ matrix.toarray() @ e, atol=1e-9)
