"""The one comparison of the suite."""

import numpy as np


def assert_close(got, expected, *, atol=0.0, rtol=0.0):
    """|got - expected| <= atol + rtol*|expected|; NaN, differing shapes and meaningless tolerances fail."""
    got, expected = np.asarray(got, float), np.asarray(expected, float)
    assert 0 < np.max(atol) or 0 < rtol < 1e-2, "give a tolerance that can fail"
    assert got.shape == expected.shape, f"shapes {got.shape} and {expected.shape}"
    assert np.isfinite(expected).all(), "the oracle is not finite"
    assert np.isfinite(got).all(), f"{(~np.isfinite(got)).sum()} values are not finite"
    error = np.abs(got - expected) - (np.asarray(atol) + rtol * np.abs(expected))
    assert (error <= 0).all(), f"off by {np.abs(got - expected).max()}, allowed {np.max(atol)} + {rtol} relative"
