"""Near eigenvalues: what is amplified is told, and answers of which nothing is known are not given silently."""

import warnings

import numpy as np
import pytest
from scipy.special import j0, jn_zeros

import rsym
from rsym import x
from rsym.problems import refinement

DISC, SQUARE = rsym.disc(1), rsym.rectangle(1, 1, (0.5, 0.5))
EDGES = rsym.rectangle(2, 2) - rsym.rectangle(1, 1, (0.5, 0.5))
L_FIRST = 9.639723844021955  # the first eigenvalue of the L, L. N. Trefethen and T. Betcke (2006)
DRUM, FLAT = float(jn_zeros(0, 1)[0] ** 2), 2 * np.pi**2


def helmholtz(value):
    return f"-laplacian(u) - {float(value)!r}*u = 1"


def test_the_amplification_is_that_of_the_nearest_eigenvalue():
    """2*lambda/|lambda - c|, and that of a shift by convection, and of Steklov's problem."""
    for off in (1e-3, -1e-6):
        found = rsym.solve(DISC, helmholtz(DRUM * (1 + off)), 0, cells=24, degree=5)
        assert abs(found.report.amplification * abs(off) / 2 - 1) < 0.05
        root = np.sqrt(DRUM * (1 + off))
        assert abs(found(0, 0) * root**2 / (1 / j0(root) - 1) - 1) < 3 * found.report.estimate < 1e-3
    carried = f"-laplacian(u) + 2*diff(u, x) - {(FLAT + 1) * (1 + 1e-5)!r}*u = 1"
    assert 1e5 < rsym.solve(SQUARE, carried, 0, cells=16).report.amplification < 4e5
    steklov = rsym.solve(DISC, "-laplacian(u) = x", rsym.robin(-1 - 1e-5), cells=8).report
    assert abs(steklov.amplification / 2e5 - 1) < 0.05
    assert steklov.condition is None


@pytest.mark.parametrize("corners", [True, False])
@pytest.mark.parametrize("convection", ["", " + 2*diff(u, x)"])
def test_an_answer_beside_an_eigenvalue_is_told_of(corners, convection):
    value = L_FIRST + bool(convection)
    with pytest.warns(rsym.RsymWarning, match="amplified by up to"):
        found = rsym.solve(EDGES, f"-laplacian(u){convection} - {value!r}*u = 1", 0, cells=8, corners=corners)
    assert found.report.estimate > 0.05
    assert "amplified by up to" in str(found.report)


def test_forms_and_tolerances_and_letters_are_told_of_too(monkeypatch):
    def near(u, v, w):
        return u.grad @ v.grad - w.c * u * v

    eigenvalue = rsym.modes(DISC, 1, cells=6, degree=2).values[0]  # of its grid: 1e-4 too large
    with pytest.warns(rsym.RsymWarning, match="amplified"):
        found = rsym.solve_form(DISC, near, lambda v, w: v, 0, cells=6, degree=2, letters={"c": DRUM * (1 + 1e-6)})
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert abs(found.with_letters({"c": 10})(0, 0) - (1 / j0(np.sqrt(10)) - 1) / 10) < 1e-3
    with pytest.warns(rsym.RsymWarning, match="amplified"):
        found.with_letters({"c": DRUM * (1 - 1e-6)})
    with pytest.raises(rsym.RsymError, match="nearly singular"):
        found.with_letters({"c": float(eigenvalue)})
    value = np.pi**2 * (1 + 1e-7)
    monkeypatch.setattr(refinement, "STEPS", 2)
    with pytest.warns(rsym.RsymWarning, match=r"above the tolerance of 1e-10; .* amplified by up to 2e\+07"):
        found = rsym.solve(SQUARE, f"-laplacian(u) - {value!r}*u = x", {}, tolerance=1e-10)
    # u'' + c*u = -x, u' = 0 at 0 and at 1
    root = np.sqrt(value)
    exact = (1 - np.cos(root)) / (value * root * np.sin(root))
    assert abs(found(0, 0.5) / -exact - 1) < 10 * found.report.estimate < 1e-3


@pytest.mark.parametrize(
    ("shape", "equation", "conditions"),
    [
        (DISC, helmholtz(10), 0),
        (SQUARE, helmholtz(34), 0),
        (SQUARE, helmholtz(800), {}),
        (EDGES, helmholtz(12.4), 0),
        (EDGES, "-laplacian(u) + 30*diff(u, x) - 5*u = 1", 0),
        (SQUARE, "-laplacian(u) - 30*sin(5*x)*u = y", 0),
        (DISC, "-laplacian(u) = x", rsym.robin(-1.5)),
        (SQUARE, "bilaplacian(u) - 500*u = 1", rsym.clamped()),
    ],
)
def test_what_has_one_answer_is_not_warned_of(shape, equation, conditions):
    """Warnings are errors here."""
    report = rsym.solve(shape, equation, conditions, cells=12).report
    assert 1 <= report.amplification < 1000
    assert report.rounding < 1e-8


@pytest.mark.slow
def test_waves_on_small_cells_are_no_singular_system():
    """Functions of corners that small cells nearly make up."""
    equation = "-laplacian(u) - 1590*u = exp(x)"
    one, other = (rsym.solve(SQUARE, equation, 0, cells=32, corners=corners) for corners in (True, False))
    assert abs(one.integral() / other.integral() - 1) < 1e-2


def test_what_is_positive_or_has_a_maximum_principle_is_not_asked():
    for equation in ("-laplacian(u) + y**2*u = 1", "-laplacian(u) + 50*diff(u, x) = 1"):
        found = rsym.solve(DISC, equation, {...: rsym.robin(1 + x**2)}, cells=6, estimate=False)
        assert found.report.amplification is None
