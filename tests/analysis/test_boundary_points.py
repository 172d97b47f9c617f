"""The oracle of normalisation itself: its series against mpmath, its verdicts on fields known to be right and wrong."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.boundary_points import Expansion, assert_normalised, boundary_points, random_motion
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z

FIELDS = [
    sp.exp(x * y) + sp.log(2 + x),
    sp.sin(3 * x) * sp.cos(y) - sp.tan(x),
    sp.sinh(x) / sp.cosh(y) + sp.tanh(x),
    sp.asin(x / 2) * sp.acos(y) + sp.atan(x),
    sp.atan2(y, x) + 2 * sp.atan2(y, -x),
    sp.Abs(x - y) * x + sp.Max(x, y**2) * sp.Min(x, y),
    sp.Mod(7 * x, 2) * y + sp.sign(x) * sp.floor(3 * y) * x**2,
    (2 + x) ** sp.Rational(1, 3) + (2 + x) ** y + x**-3 + x**7,
    sp.Piecewise((x**2, x > y), (y**3, True)) + sp.pi * x + sp.sqrt(2) * y + sp.Float("0.1"),
    (x**2 + y**2) ** sp.Rational(3, 2) + rsym.conjunction(x, y, x + 1),
]
BOX = ((-1.3, 1.3), (-1.3, 1.3))


@pytest.mark.parametrize("field", FIELDS, ids=str)
def test_series_are_taylors(field):
    points = np.array([[0.3, 0.7], [-0.4, 0.55], [0.6, -0.21]])
    slopes = np.array([[0.6, 0.8], [1, 0], [-0.5, 0.2]])
    got = Expansion(rsym.Shape(field, (x, y))).series(points, slopes, 4)
    value = sp.lambdify((x, y), field.doit(), "mpmath")
    with mpmath.workdps(40):
        for point, slope, series in zip(points, slopes, got.T, strict=True):
            line = [lambda t, p=p, d=d: mpmath.mpf(p) + t * mpmath.mpf(d) for p, d in zip(point, slope, strict=True)]
            expected = mpmath.taylor(lambda t, line=line: value(line[0](t), line[1](t)), 0, 4)
            assert_close(series, [float(mpmath.re(part)) for part in expected], atol=1e-15, rtol=1e-14)


@pytest.mark.parametrize("seed", range(3))
def test_exact_fields_pass_in_the_plane_and_in_space(seed):
    square = rsym.Shape(rsym.R1.conjunction(1 - x, 1 + x, 1 - y, 1 + y), (x, y), bounds=BOX)
    cone = rsym.Shape(3 * z / 5 - 4 * sp.sqrt(x**2 + y**2) / 5, (x, y, z), bounds=((-1, 1),) * 3)
    for shape in (square, cone):
        moved = random_motion(shape, seed)
        points = assert_normalised(moved, 4)
        assert len(points) == 200
        low, high = np.array(moved.bounds).T
        assert ((points >= low) & (points <= high)).all()


def test_wrong_fields_fail():
    disc = (1 - x**2 - y**2) / 2
    with pytest.raises(AssertionError, match="off by 1"):
        assert_normalised(rsym.Shape(2 * disc, (x, y), bounds=BOX), 1)
    with pytest.raises(AssertionError, match="off by"):
        assert_normalised(rsym.Shape(disc, (x, y), bounds=BOX), 2)
    assert_normalised(rsym.Shape(disc, (x, y), bounds=BOX), 1)


def test_edges_are_kept_away_from():
    square = rsym.Shape(rsym.conjunction((1 - x**2) / 2, (1 - y**2) / 2), (x, y), bounds=BOX)
    points, _ = boundary_points(square, 300, clearance=0.05)
    assert np.abs(points).min(axis=1).max() < 0.95
    assert np.abs(points).min(axis=1).max() > 0.5
    few, _ = boundary_points(square, 100, away_from=[x - y, lambda points: points[:, 0] - 1])
    assert np.abs(few[:, 0] - few[:, 1]).min() > 0.02
    assert (few[:, 0] < 0.98).all()
