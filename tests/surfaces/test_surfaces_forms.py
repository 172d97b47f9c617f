"""Fundamental forms and principal curvatures against those of the textbook."""

import numpy as np
import sympy as sp
from oracles.closeness import assert_close

from rsym.surfaces import ParametricSurface
from rsym.surfaces.symbols import u, v

RNG = np.random.default_rng(1827)


def test_a_helicoid():
    """E = 1, F = 0, G = 1 + u**2; L = N = 0, M = -1/sqrt(G); it is minimal."""
    surface = ParametricSurface((u * sp.cos(v), u * sp.sin(v), v), ((-2, 2), (0, 6)))
    at_u, at_v = RNG.uniform(-2, 2, 50), RNG.uniform(0, 6, 50)
    G = 1 + at_u**2
    zero = np.zeros(50)
    first, second = (
        np.array([[1 + zero, zero], [zero, G]]),
        np.array([[zero, -1 / np.sqrt(G)], [-1 / np.sqrt(G), zero]]),
    )
    assert_close(surface.first_fundamental_form(at_u, at_v), np.moveaxis(first, -1, 0), atol=1e-14)
    assert_close(surface.second_fundamental_form(at_u, at_v), np.moveaxis(second, -1, 0), atol=1e-14)
    assert_close(surface.principal_curvatures(at_u, at_v), np.stack([1 / G, -1 / G], axis=-1), atol=1e-14)


def test_a_cylinder_seen_from_outside():
    """Along the axis it is straight, around it bends away from its normal; scalars give matrices."""
    surface = ParametricSurface((2 * sp.cos(u), 2 * sp.sin(u), v), ((0, 6), (0, 1)))
    assert_close(surface.first_fundamental_form(1, 0.5), [[4.0, 0.0], [0.0, 1.0]], atol=1e-15)
    assert_close(surface.second_fundamental_form(1, 0.5), [[-2.0, 0.0], [0.0, 0.0]], atol=1e-15)
    assert_close(surface.principal_curvatures(1, 0.5), [0.0, -0.5], atol=1e-15)
