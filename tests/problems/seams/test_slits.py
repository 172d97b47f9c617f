"""Slits without width: a set has none, and it is told where one was typed."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z

DISC = rsym.disc(1)


def plane(formula):
    return rsym.Shape(formula, (x, y))


RIGHT, LEFT, UP, DOWN = plane(x), plane(-x), plane(y), plane(-y)
SLITS = {
    "abs": DISC & (plane(sp.Abs(y)) | LEFT),
    "square": DISC & (plane(y**2) | LEFT),
    "f or not f": DISC & (UP | DOWN | LEFT),
    "difference": DISC - (UP & DOWN & RIGHT),
    "curved": DISC & (plane(sp.Abs(y - x**2)) | LEFT),
    "short": DISC & (plane(sp.Abs(y)) | plane(sp.Abs(x) - sp.Rational(1, 2))),
}
NONE = {
    "two halves": (DISC & UP) | (DISC & DOWN),
    "doubled line": plane((1 - x**2 - y**2) * (x - sp.Rational(1, 5)) ** 2).replace(bounds=((-2, 2),) * 2),
    "mirrored": rsym.mirrored(DISC & RIGHT),
    "no edge": DISC & (plane(sp.Abs(x)) | plane(sp.Rational(1, 100) - x**2)),
}


@pytest.mark.parametrize("name", SLITS)
def test_a_slit_without_width_is_told(name):
    with pytest.warns(rsym.RsymWarning, match="such a slit without width is left out"):
        found = rsym.modes(SLITS[name], 1, cells=8, estimate=False)
    assert found.values[0] == pytest.approx(5.783185962946785, rel=1e-6)


@pytest.mark.parametrize("name", NONE)
def test_parts_that_share_an_edge_are_no_slit(name):
    assert rsym.modes(NONE[name], 1, cells=8, estimate=False).values[0] == pytest.approx(5.783185962946785, rel=1e-6)


def test_shafts_bodies_and_space_tell_too():
    with pytest.warns(rsym.RsymWarning, match="such a slit"):
        assert float(rsym.torsion(SLITS["abs"], cells=8)) == pytest.approx(np.pi / 2, rel=1e-6)
    ball = rsym.sphere(1) & (rsym.Shape(sp.Abs(z), (x, y, z)) | rsym.Shape(-x, (x, y, z)))
    with pytest.warns(rsym.RsymWarning, match="such a slit"):
        assert rsym.solve(ball, "-laplacian(u) = 6", 0, cells=3, estimate=False)(0, 0, 0) == pytest.approx(1, rel=1e-6)
