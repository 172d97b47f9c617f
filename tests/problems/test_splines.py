"""B-splines against SciPy's, and the extension against what it must reproduce: polynomials."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

from rsym.problems.splines.cardinals import derivatives, pieces
from rsym.problems.splines.evaluation import jets
from rsym.problems.splines.web import web_splines


@pytest.mark.parametrize("degree", range(1, 7))
def test_pieces_are_those_of_scipy(degree):
    spline = BSpline.basis_element(np.arange(degree + 2.0))
    t = np.array([0.1, 0.5, 0.93])
    for row, k in zip(pieces(degree), range(degree, -1, -1), strict=True):
        np.testing.assert_allclose(np.polyval(row[::-1], t), spline(t + k), rtol=1e-11, atol=1e-16)


def everywhere(degree, counts=(6, 5), lower=(-1.0, 2.0), size=0.5):
    cells = np.arange(int(np.prod(counts)))
    return web_splines(np.array(lower), size, counts, degree, cells, cells)


@pytest.mark.parametrize("degree", [2, 3, 5])
def test_derivatives_are_those_of_scipy(degree):
    splines = everywhere(degree)
    values = np.random.default_rng(1).standard_normal((1, len(splines.active)))
    points = np.random.default_rng(2).uniform((-1, 2), (2, 4.5), (20, 2))
    knots = [low + 0.5 * np.arange(-degree, n + degree + 1) for low, n in ((-1.0, 6), (2.0, 5))]
    table = values.reshape(splines.shape)
    for index, found in zip(derivatives(2, 2), jets(splines, values, points, 2)[:, 0], strict=True):
        along = [
            BSpline(k, np.eye(n), degree)(t, nu)
            for k, n, t, nu in zip(knots, splines.shape, points.T, index, strict=True)
        ]
        expected = np.einsum("ni,nj,ij->n", *along, table)
        np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("degree", [1, 3, 4])
def test_the_extension_reproduces_polynomials(degree):
    """Of outer splines the coefficients are made of inner ones; those of a polynomial must come out as they were."""
    touched = np.arange(14 * 14)
    full = np.array([14 * i + j for i in range(14) for j in range(14) if (i - 6.3) ** 2 + (j - 6.8) ** 2 < 33])
    splines = web_splines(np.zeros(2), 1.0, (14, 14), degree, touched, full)
    position = np.stack(np.unravel_index(splines.active, splines.shape), axis=1) / 10
    polynomial = position[:, 0] ** degree * (1 - position[:, 1]) ** degree + position[:, 0]
    assert 0 < splines.inner.sum() < len(splines.active)
    np.testing.assert_allclose(splines.extension @ polynomial[splines.inner], polynomial, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("degree", [1, 3])
def test_on_both_sides_of_closed_sides_are_functions_of_their_own(degree):
    """One polynomial on one side, another on the other, of inner functions, extended on each side."""
    touched = np.arange(14 * 14)
    inner = np.array([14 * i + j for i in range(14) for j in range(14) if abs(i - 6.5) > 1 and 0 < j < 13])
    closed = np.array([[14 * 6 + j, 14 * 7 + j] for j in range(14)])
    splines = web_splines(np.zeros(2), 1.0, (14, 14), degree, touched, inner, closed)
    assert len(splines.active) == (14 + 2 * degree) * (14 + degree)
    position = np.stack(np.unravel_index(splines.active, splines.shape), axis=1) / 10
    right = np.zeros(len(splines.active), bool)
    right[splines.functions(np.arange(14 * 7, 14 * 14))] = True
    assert right.sum() == (7 + degree) * (14 + degree)
    values = np.where(right, position[:, 0] ** degree, 3 - position[:, 1] ** degree)
    assert 0 < splines.inner.sum() < len(splines.active)
    found = splines.extension @ values[splines.inner]
    np.testing.assert_allclose(found, values, rtol=1e-9, atol=1e-9)
    ones = jets(splines, np.where(right, 5.0, 2.0)[None], np.array([[6.999, 3.3], [7.001, 3.3], [0.1, 1.0]]), 1)
    np.testing.assert_allclose(ones[:, 0], [[2, 5, 2], [0, 0, 0], [0, 0, 0]], atol=1e-12)


def test_on_an_edge_along_cells_the_own_side_answers():
    """The edge on the left of a gap of two cells lies in the first of these, where nothing of the shape is."""
    cells = np.array([10 * i + j for i in (0, 1, 2, 3, 6, 7, 8, 9) for j in range(10)])
    splines = web_splines(np.zeros(2), 1.0, (10, 10), 3, cells, cells)
    values = np.full((1, len(splines.active)), 2.0)
    values[0, splines.functions(np.arange(60, 100))] = 5.0
    found = jets(splines, values, np.array([[4.0, 3.3], [6.0, 3.3], [4.0, 10.0], [3.9, 1.2]]), 0)
    np.testing.assert_allclose(found[0, 0], [2, 5, 2, 2], atol=1e-12)


def test_points_beside_the_grid_are_in_no_cell_and_the_far_side_is_in_the_last():
    splines = everywhere(2)
    found = splines.cell_of(np.array([[-1.0, 2.0], [2.0, 4.5], [2.1, 3.0], [0.0, 1.9], [np.nan, 3.0]]))
    assert found.tolist() == [0, 29, -1, -1, -1]


def test_in_space_constants_are_sums_of_splines():
    cells = np.arange(27)
    splines = web_splines(np.zeros(3), 1.0, (3, 3, 3), 2, cells, cells)
    found = jets(splines, np.ones((1, len(splines.active))), np.array([[0.3, 1.7, 2.9]]), 1)
    np.testing.assert_allclose(found[:, 0, 0], [1, 0, 0, 0], atol=1e-14)
