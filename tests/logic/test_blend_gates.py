"""Blends taken apart for meshes keep sign and zero set."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import R0, Rho, Sardf, Shape, x, y, z
from rsym.model.blends.gates import with_gates

HALF, COSINE = sp.Rational(1, 2), sp.Rational(1, 3)
SYSTEMS = [Rho(HALF), Rho(HALF, "G2"), Rho(HALF, cosine=COSINE), Rho(HALF, "G2", cosine=-COSINE), Sardf(HALF)]
POINTS = np.random.default_rng(5).uniform(-1.5, 1.5, (3, 20_000))


def operands():
    return R0.conjunction(x + 1, HALF - y), R0.disjunction(y - 1, -x - z - 1), z - 1 - x * y / 2


@pytest.mark.random
@pytest.mark.parametrize("system", SYSTEMS, ids=str)
@pytest.mark.parametrize("name", ["conjunction", "disjunction"])
def test_taken_apart_a_blend_has_the_same_sign(system, name):
    blend = getattr(system, name)(*operands())
    seen = set()
    for whole in (blend, -blend, 2 * blend, R0.conjunction(blend, x + y), R0.disjunction(z, -blend)):
        apart = with_gates(whole)
        assert apart != whole
        signs = [np.sign(rsym.compile(Shape(part, (x, y, z)))(*POINTS)["value"]) for part in (whole, apart)]
        assert (signs[0] == signs[1]).all()
        seen |= set(signs[0])
    assert seen == {-1, 1}


def test_a_fillet_between_smooth_faces_stays_whole_and_other_blends_too():
    face = Rho(HALF).disjunction(x, y)
    assert with_gates(face) == face
    inside = x + Rho(HALF).disjunction(operands()[0], y)
    assert with_gates(inside) is inside


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
def test_a_letter_that_is_no_radius_is_refused():
    rho = sp.Symbol("rho", real=True)
    blend = Rho(rho).conjunction(*operands()[:2])
    body = Shape(blend, (x, y, z), letters={rho: 0.2}, bounds=((-2, 2),) * 3)
    assert len(rsym.mesh(body, 24).faces)
    with pytest.raises(rsym.RsymError):
        rsym.mesh(body, 24, letters={"rho": -1})


@pytest.mark.slow
def test_edges_of_filleted_bodies_are_exact():
    pipes = [rsym.cylinder(1, 4), rsym.cylinder(1, 4).rotate(sp.pi / 2, x)]
    mesh = rsym.mesh(rsym.fillet(*pipes, sp.Rational(3, 10)), 48)
    assert mesh.status.closed
    height = np.abs(mesh.vertices[:, 2])
    rim = mesh.vertices[(height > 2 - 1e-9) & (np.hypot(*mesh.vertices[:, :2].T) > 1 - 1e-9)]
    assert len(rim) > 50
    assert_close(np.hypot(*rim[:, :2].T), np.ones(len(rim)), atol=1e-9)
