"""Shapes whose formula is zero inside are solved on as their outlines are."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.problems.seams.atoms import atoms_of
from rsym.problems.seams.proof import unproved
from rsym.problems.seams.rows import rows_of
from rsym.problems.seams.seamless import seamless

HALF = sp.Rational(1, 2)
BESSEL, L_DRUM, L_TORSION, SQUARE_TORSION = 2.404825557695773, 9.639723844021941, 0.856303208882184, 0.140577014955155
DISC = 4 - x**2 - y**2


def rect(left, right, bottom, top):
    """A rectangle by its sides."""
    middle = sp.Rational(left + right) / 2, sp.Rational(bottom + top) / 2
    return rsym.rectangle(right - left, top - bottom).translate(*middle)


def plane(formula):
    return rsym.Shape(formula, (x, y))


def round_drum(radius):
    return (BESSEL / radius) ** 2


HALF_DISC = rsym.disc(2) & plane(x)
DRUMS = {
    "mirrored": (rsym.mirrored(HALF_DISC), round_drum(2)),
    "half or half": (HALF_DISC | (rsym.disc(2) & plane(-x)), round_drum(2)),
    "ring or core": ((rsym.disc(2) - rsym.disc(1)) | rsym.disc(1), round_drum(2)),
    "quadrants": (rect(0, 1, 0, 1) | rect(-1, 0, 0, 1) | rect(0, 1, -1, 0) | rect(-1, 0, -1, 0), np.pi**2 / 2),
    "L, flush": (rect(0, 1, 0, 2) | rect(1, 2, 0, 1), L_DRUM),
    "L, by a difference": (rect(0, 2, 0, 2) - rect(1, 2, 1, 2), L_DRUM),
    "L, overlapping": (rect(0, 1, 0, 2) | rect(sp.Rational(99, 100), 2, 0, 1), L_DRUM),
    "L, of three": (rect(0, 1, 0, 1) | rect(0, 1, 1, 2) | rect(1, 2, 0, 1), L_DRUM),
    "doubled line": (rsym.Shape(DISC * (x - HALF) ** 2, (x, y), bounds=((-2.2, 2.2),) * 2), round_drum(2)),
    "distance of a disc": (plane(1 - sp.sqrt(x**2 + y**2)), round_drum(1)),
    "distance of a diamond": (plane(1 - abs(x) - abs(y)), np.pi**2),
    "distance of a ring": (plane(HALF - abs(sp.sqrt(x**2 + y**2) - 3 * HALF)), 9.753322124754),
    "distance of a plate": (plane(1 - sp.Max(abs(x) / 2, abs(y))), np.pi**2 * 5 / 16),
}


@pytest.mark.parametrize("name", DRUMS)
def test_drums_of_parts_are_those_of_their_outlines(name):
    shape, truth = DRUMS[name]
    found = rsym.modes(shape, 1, cells=20).values[0]
    assert abs(found / truth - 1) < 3e-8


def test_a_t_and_its_outline_have_one_drum():
    parts = rect(-3 * HALF, 3 * HALF, 1, 2) | rect(-HALF, HALF, -1, 1)
    outline = rsym.polygon([(-1.5, 1), (-0.5, 1), (-0.5, -1), (0.5, -1), (0.5, 1), (1.5, 1), (1.5, 2), (-1.5, 2)])
    one, other = (rsym.modes(shape, 1, cells=24).values[0] for shape in (parts, outline))
    assert abs(one / other - 1) < 1e-6


def test_sections_of_parts_twist_like_their_outlines():
    for shape, truth in ((DRUMS["L, flush"][0], L_TORSION), (DRUMS["quadrants"][0], 16 * SQUARE_TORSION)):
        assert abs(float(rsym.torsion(shape, cells=32)) / truth - 1) < 1e-8


def test_tangent_joints_are_proved_and_answered():
    caps = [rsym.disc(HALF, (side, 0)) & plane(side * x - 1) for side in (1, -1)]
    flush = rect(-1, 1, -HALF, HALF) | caps[0] | caps[1]
    overlapping = rect(-1, 1, -HALF, HALF) | rsym.disc(HALF, (1, 0)) | rsym.disc(HALF, (-1, 0))
    one, other = (rsym.modes(shape, 1, cells=32).values[0] for shape in (flush, overlapping))
    assert abs(one / other - 1) < 1e-4


def test_parts_that_touch_may_be_cut_and_put_together():
    # Discs side by side touch in a point, next to which the weight has a root in it.
    for other, radius, most in ((rsym.disc(2, (1, 0)), 2, 1e-10), (rsym.disc(1, (2, 0)), 1, 1e-4)):
        both = rsym.disc(1) | other
        cuts = [plane(side * (3 * x + 4 * y - 1) / 5) for side in (1, -1)]
        found = rsym.modes((both & cuts[0]) | (both & cuts[1]), 1, cells=24).values[0]
        assert abs(found / round_drum(radius) - 1) < most


def test_two_cubes_are_a_box():
    cubes = rsym.box(1, 1, 1) | rsym.box(1, 1, 1).translate(1, 0, 0)
    box = rsym.box(2, 1, 1).translate(HALF, 0, 0)
    one, other = (rsym.solve(shape, "-laplacian(u) = 1", 0, cells=8)(HALF, 0, 0) for shape in (cubes, box))
    assert abs(one / other - 1) < 1e-10


@pytest.mark.parametrize("over", [0, sp.Rational(1, 1000)])
def test_two_halves_of_a_ball_are_a_ball(over):
    ball = rsym.sphere(1)
    halves = (ball & rsym.Shape(x + over, (x, y, z))) | (ball & rsym.Shape(over - x, (x, y, z)))
    assert abs(rsym.solve(halves, "-laplacian(u) = 6", 0, cells=6)(0, 0, 0) - 1) < 1e-8


PAIR = rect(0, 1, 0, 1).named("A") | rect(1, 2, 0, 1).named("B")


def test_parts_side_by_side_keep_their_names():
    u = rsym.solve(PAIR, "-laplacian(u) = 1", 0, cells=16)
    halves = [u.flux(name) for name in ("A", "B")]
    assert halves == pytest.approx([-1, -1], abs=2e-4)
    v = rsym.solve(PAIR, "-laplacian(u) = 0", {"A": x, "B": x}, cells=8)
    assert [v.flux("A"), v.flux("B")] == pytest.approx([-1, 1], abs=1e-10)


def test_conditions_of_parts_side_by_side_change_between_them():
    where = plane(1 - x)
    whole = rect(0, 2, 0, 1)
    conditions = [0, rsym.neumann(0)]
    one = rsym.solve(PAIR, "-laplacian(u) = 1", dict(zip("AB", conditions, strict=True)), cells=16)
    other = rsym.solve(whole, "-laplacian(u) = 1", rsym.switched(where, *conditions), cells=16)
    places = np.array([0.3, 0.9, 1.1, 1.7])
    assert np.abs(one(places, 0.4) / other(places, 0.4) - 1).max() < 2e-3
    held = rsym.solve(PAIR, "-laplacian(u) = 1", {"A": 0}, cells=16)
    assert held(1.5, 0.5) == one(1.5, 0.5)
    body = rsym.elasticity(PAIR, {"A": rsym.fixed()}, young=1, poisson=0.3, loads=(0, -1), cells=12)
    assert body.displacement(1.9, 0.5)[1] < -0.1  # the seam is not held


def test_letters_move_parts_apart_and_together():
    a = sp.Symbol("a", real=True)
    shape = HALF_DISC | (rsym.disc(2) & rsym.Shape(a - x, (x, y), letters={a: 0}))
    flush = rsym.modes(shape, 1, cells=16)
    wide = flush.with_letters({"a": 1})
    assert [abs(one.values[0] / round_drum(2) - 1) < 1e-10 for one in (flush, wide, wide.with_letters({"a": 0}))] == [
        True
    ] * 3


@pytest.mark.parametrize("wrong", [((0,), (2,), (5,)), ((0, 2), (1,))])
def test_wrong_clauses_are_not_proved(wrong):
    atoms = atoms_of(DRUMS["L, flush"][0])
    assert len(unproved(atoms, wrong))


def test_rows_know_seams():
    assert len(rows_of(atoms_of(DRUMS["half or half"][0])).seams) > 50
    assert not len(rows_of(atoms_of(DRUMS["L, by a difference"][0])).seams)


def test_what_shares_no_leaf_stays_as_it_is():
    for shape in (rsym.disc(1), rsym.disc(1) | rsym.disc(1, (1, 0)), rsym.rectangle(2, 1)):
        assert seamless(shape).shape == shape


def test_edges_inside_of_which_nothing_is_proved_are_refused_with_their_place():
    halves = (rsym.disc(1) & plane(x - y)) | (rsym.disc(1) & plane(sp.sin(y - x)))  # one line by two formulas
    with pytest.raises(rsym.RsymError, match="the formula is zero inside") as raised:
        rsym.modes(halves, 1, cells=8)
    assert (raised.value.code, raised.value.where is not None) == ("seam", True)
    overlapping = (rsym.disc(1) & plane(x - y)) | (rsym.disc(1) & plane(sp.sin(y - x) + sp.Rational(1, 2)))
    assert abs(rsym.modes(overlapping, 1, cells=20).values[0] / round_drum(1) - 1) < 1e-9


def test_a_point_inside_where_a_formula_is_zero_is_not_held():
    # Against harmonic polynomials fitted on the boundary, r**2*(cos**4 + sin**4) = 1.
    angle = np.linspace(0, np.pi / 4, 400)
    radius = 1 / np.sqrt(np.cos(angle) ** 4 + np.sin(angle) ** 4)
    powers, most = 4 * np.arange(24), radius.max()
    columns = (radius[:, None] / most) ** powers * np.cos(np.outer(angle, powers))
    shares = np.linalg.lstsq(columns, radius**2 / 4, rcond=None)[0]
    truth = shares @ (0.1 / most) ** powers - 0.1**2 / 4
    found = rsym.solve(plane(x**2 + y**2 - x**4 - y**4), "-laplacian(u) = 1", 0, cells=40)(0.1, 0)
    assert abs(found / truth - 1) < 1e-5
    body = rsym.Shape(x**2 + y**2 + z**2 - x**4 - y**4 - z**4, (x, y, z))
    assert "disjunction" in str(seamless(body).shape)


def test_large_forms_that_are_zero_inside_are_refused_and_combs_are_not():
    def comb(teeth):
        shape = rect(0, 2 * teeth, 0, 1)
        for k in range(teeth):
            shape = shape | rect(2 * k, 2 * k + 1, 1, 2)
        return shape

    assert seamless(comb(6)).rewritten
    with pytest.raises(rsym.RsymError, match="the formula is zero inside"):
        seamless(comb(40))
