"""Twist estimators on the surfaces that they are exact for, and the patch of least energy."""

import numpy as np
import pytest
from oracles.closeness import assert_close

import rsym
from rsym.surfaces import BicubicCoons, HermiteBlend, estimate_twists, with_twists

U, V = np.array([0.0, 1.0, 2.5, 3.0, 4.5]), np.array([-1.0, 0.5, 1.0, 3.0])


def grid(z, u=U, v=V):
    x, y = np.meshgrid(u, v, indexing="ij")
    return np.stack([x, y, z(x, y)], axis=-1)


def twists(kind, z, **options):
    return estimate_twists(grid(z), kind, u=U, v=V, **options)[..., 2]


@pytest.mark.parametrize("kind", ["bilinear", "central", "adini", "bessel"])
def test_every_kind_is_exact_for_bilinear_surfaces(kind):
    assert_close(twists(kind, lambda x, y: 3 * x * y + x - y), np.full((5, 4), 3.0), atol=1e-12)
    assert np.all(twists("zero", lambda x, y: 3 * x * y) == 0)


def test_bessel_is_exact_for_biquadratic_surfaces_and_adini_is_not():
    x, y = np.meshgrid(U, V, indexing="ij")
    wanted = 4 * x * y + 2 * x
    assert_close(twists("bessel", lambda x, y: x**2 * y**2 + x**2 * y), wanted, atol=1e-11)
    assert np.abs(twists("adini", lambda x, y: x**2 * y**2 + x**2 * y) - wanted).max() > 1


def test_adini_is_exact_for_ruled_sums_of_any_shape():
    x, y = np.meshgrid(U, V, indexing="ij")

    def z(x, y):
        return np.sin(x) * (1 + 2 * y) + (x - 3) * np.exp(y / 2)

    p_u = grid(lambda x, y: np.cos(x) * (1 + 2 * y) + np.exp(y / 2))
    p_v = grid(lambda x, y: 2 * np.sin(x) + (x - 3) * np.exp(y / 2) / 2)
    found = twists("adini", z, u_tangents=p_u, v_tangents=p_v)
    assert_close(found, 2 * np.cos(x) + np.exp(y / 2) / 2, atol=1e-12)


@pytest.mark.parametrize(
    ("points", "kind", "message"),
    [
        (np.zeros((2, 2, 3)), "bessel", "3 x 3 points"),
        (np.zeros((3, 3)), "zero", "shape"),
        (np.zeros((3, 3, 3)), "farin", "choose from zero"),
    ],
)
def test_what_cannot_be_estimated_is_refused(points, kind, message):
    with pytest.raises(rsym.RsymError, match=message):
        estimate_twists(points, kind)


def bending(patch):
    """The energy by a rule of its own: midpoints on a fine grid."""
    s = (np.arange(400) + 0.5) / 400
    parts = patch.derivatives(s[:, None], s[None, :], ((2, 0), (1, 1), (0, 2)))
    return sum(weight * (part**2).sum(axis=-1).mean() for weight, part in zip((1, 2, 1), parts, strict=True))


@pytest.mark.slow
def test_the_twists_of_least_energy_cannot_be_bettered():
    rng = np.random.default_rng(1964)
    matrix = rng.normal(size=(4, 4, 3))
    blends = HermiteBlend.class2(2, 1.2), HermiteBlend.cubic()
    best = with_twists(BicubicCoons(matrix, *blends), "energy")
    matrix[2:, 2:] = best.matrix[2:, 2:]
    assert np.array_equal(best.matrix, matrix)
    least = bending(best)
    for _ in range(10):
        other = best.matrix
        other[2:, 2:] += rng.normal(size=(2, 2, 3)) * 0.3
        assert bending(best.with_matrix(other)) > least + 1e-3
    slope = (bending(best.with_matrix(_moved(best, 1e-3))) - bending(best.with_matrix(_moved(best, -1e-3)))) / 2e-3
    assert abs(slope) < 1e-3


def _moved(patch, step):
    matrix = patch.matrix
    matrix[2, 3, 1] += step
    return matrix
