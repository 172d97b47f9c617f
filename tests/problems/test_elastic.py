"""Elastic bodies against exact solutions: a bar, a thick ring (Lame), a hole under tension (Kirsch)."""

import math

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y

HALF = sp.Rational(1, 2)
RING = rsym.disc(1).named("rim") - rsym.disc(HALF).named("bore")
QUARTER = RING & rsym.half_plane((1, 0), 0).named("left") & rsym.half_plane((0, 1), 0).named("low")
HELD = {"left": (0, None), "low": (None, 0)}


@pytest.mark.parametrize("strain", [False, True])
def test_a_thick_ring_under_pressure(strain):
    """u_r = A r + B/r, with Lame's A and B of the pressure 1 in the bore."""
    nu = 0.3
    found = rsym.elasticity(QUARTER, HELD, young=1, poisson=nu, loads={"bore": 1}, cells=20, strain=strain)
    a, b = ((1 + nu) * (1 - 2 * nu), 1 + nu) if strain else (1 - nu, 1 + nu)
    for r, angle in ((0.6, 0.3), (0.9, 1.1)):
        place = r * math.cos(angle), r * math.sin(angle)
        np.testing.assert_allclose(found(*place) @ place / r, (a * r + b / r) / 3, rtol=3e-6)
        sx, sy, shear = found.stress(*place)
        radial = (sx * place[0] ** 2 + sy * place[1] ** 2 + 2 * shear * place[0] * place[1]) / r**2
        assert abs(radial - (1 - 1 / r**2) / 3) < 3e-4
        assert abs(sx + sy - 2 / 3) < 3e-4
    np.testing.assert_allclose(found.reaction("low"), (0, -0.5), atol=2e-3)


def test_kirsch_hole():
    """A hole of radius 1/2 under the tension 1 along x; on the rim the exact tractions, at the hole the stress is 3."""
    r2 = x**2 + y**2
    ratio = sp.Rational(1, 4) / r2
    c2, s2 = (x**2 - y**2) / r2, 2 * x * y / r2
    c4, s4 = 2 * c2**2 - 1, 2 * c2 * s2
    sx = 1 - ratio * (sp.Rational(3, 2) * c2 + c4) + sp.Rational(3, 2) * ratio**2 * c4
    sy = -ratio * (HALF * c2 - c4) - sp.Rational(3, 2) * ratio**2 * c4
    shear = -ratio * (HALF * s2 + s4) + sp.Rational(3, 2) * ratio**2 * s4
    loads = {"rim": (sx * x + shear * y, shear * x + sy * y)}
    found = rsym.elasticity(QUARTER, HELD, young=1, poisson=0.3, loads=loads, cells=24, degree=5)
    assert abs(found.stress(0, 0.5)[0] - 3) < 2e-3
    exact = sp.lambdify((x, y), [sx, sy, shear])(0.5, 0.6)
    np.testing.assert_allclose(found.stress(0.5, 0.6), exact, atol=3e-5)


def test_displacements_that_are_given_and_what_is_not_held():
    column = rsym.rectangle(1, 1).named("sides") & rsym.half_plane((0, 1), -HALF).named("floor")
    held = {"floor": (None, 0), "sides": (None, None)}
    with pytest.raises(rsym.RsymError, match="nothing holds the body along x"):
        rsym.elasticity(column, held, young=10, poisson=0, body=(0, -2))
    square = rsym.rectangle(1, 1)
    linear = rsym.elasticity(square, {...: (2 * x + y, x - y)}, young=3, poisson=0.25, cells=8)
    np.testing.assert_allclose(linear(0.2, 0.1), (0.5, 0.1), atol=1e-12)
    # E/(1 - nu**2) = 3.2, shear modulus 1.2, twice the shear strain 2.
    np.testing.assert_allclose(linear.stress(0.1, 0.2), (3.2 * (2 - 0.25), 3.2 * (0.5 - 1), 2.4), atol=1e-9)
    assert abs(linear.von_mises(0.1, 0.2) - math.sqrt(_mises(linear.stress(0.1, 0.2)))) < 1e-12


def _mises(stress):
    sx, sy, shear = stress
    return sx**2 - sx * sy + sy**2 + 3 * shear**2


@pytest.mark.parametrize(("young", "poisson"), [(0, 0.3), (1, 0.5), (1, -1)])
def test_what_is_no_material_is_refused(young, poisson):
    with pytest.raises(rsym.RsymError, match="Young") as raised:
        rsym.elasticity(QUARTER, HELD, young=young, poisson=poisson)
    assert raised.value.code == "material"
