"""Bodies on skeletons: the condition for a boundary that keeps off its skeleton, against sampling and proofs."""

from itertools import pairwise

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import Letter, RsymError, Shape, x, y, z
from rsym.model.positivity import positive_polynomial
from rsym.model.primitives.curves import arc, circle, graph, helix, polyline, segment, space_curve
from rsym.model.skeletons import analytic_condition, blend_on_skeleton
from rsym.paper.models import model_path

A, A1, A2, P1, P2, R, S, T = sp.symbols("a a1 a2 p1 p2 r s t", real=True)
SEED = (A1 - x) * (A2 + x) / P1 - P2
SEED_LETTERS = {A1: 8, A2: Letter(5.3, minimum=1, maximum=20), P1: Letter(40, minimum=5), P2: 0.1}
ROD = segment((-A, 0), (A, 0), letters={A: 5})


def truth(condition, values):
    return bool(condition.subs(values))


@pytest.mark.parametrize("degree", [1, 2, 3])
def test_a_polynomial_is_positive_where_its_condition_holds(degree):
    """At random coefficients against the least of many values; nearly as often true as false."""
    letters = sp.symbols(f"c0:{degree + 1}", real=True)
    condition = positive_polynomial(sp.Poly(letters, S), sp.Integer(-1), sp.Rational(3, 2))
    random, held = np.random.default_rng(degree), 0
    decide = sp.lambdify(letters, condition, "math")
    for _ in range(2000):
        coefficients = random.normal(size=degree + 1)
        coefficients[-1] = abs(coefficients[-1]) + random.random()
        least = np.polyval(coefficients, np.linspace(-1, 1.5, 801)).min()
        if abs(least) > 1e-4:
            assert decide(*coefficients) == (least > 0)
            held += least > 0
    assert 400 < held < 1600


def test_without_letters_any_degree_is_decided():
    """Also where it comes near to zero, touches it, or has irrational coefficients."""
    zero, one = sp.S.Zero, sp.S.One
    wave = sp.Poly(sp.chebyshevt(9, 2 * S - 1) + 1, S)
    touch = sp.Poly((S - sp.Rational(1, 3)) ** 2 * (S + 1) ** 5, S)
    assert positive_polynomial(wave + sp.Rational(1, 10**9), zero, one) is sp.true
    assert positive_polynomial(wave - sp.Rational(1, 10**9), zero, one) is sp.false
    assert positive_polynomial(touch, zero, one) is sp.false
    assert positive_polynomial(sp.Poly((S - sp.sqrt(2)) ** 4 - S, S), zero, sp.Rational(1, 5)) is sp.true
    assert positive_polynomial(sp.Poly((S - sp.sqrt(2)) ** 4 - S, S), zero, one) is sp.false


def test_the_condition_of_the_paper_s_body_is_the_one_known():
    """a2 > a + p1 p2/(a1 + a), and likewise for a1; a profile that is known to be concave needs its ends alone."""
    condition = analytic_condition(ROD, SEED, letters=SEED_LETTERS)
    assert len(condition.args) == 2
    known = {A: 5, A1: 8, P1: 40, P2: sp.Rational(1, 10)}
    limit = 5 + sp.Rational(4, 13)
    assert not truth(condition, {**known, A2: limit})
    assert truth(condition, {**known, A2: limit + sp.Rational(1, 10**9)})
    shipped = [rsym.load(model_path("skeleton"), shape=name) for name in ("f_o", "h")]
    assert set(analytic_condition(*shipped).args) == set(condition.args)


@pytest.mark.slow
def test_the_condition_of_the_paper_s_body_is_where_proofs_turn():
    body = blend_on_skeleton(ROD, SEED, letters=SEED_LETTERS)
    found = rsym.smoothness_threshold(body, "a2", between=(5.3, 5.35), tolerance=1e-3)
    assert found.refuted < 5 + 4 / 13 < found.certified
    revolved = rsym.revolve(body)
    condition = analytic_condition(ROD, SEED, letters=SEED_LETTERS)
    for value in (sp.Rational(53, 10), sp.Rational(535, 100)):
        verdict = rsym.verify_smoothness(revolved, letters={"a2": value}).verdict
        holds = truth(condition, {A: 5, A1: 8, P1: 40, P2: sp.Rational(1, 10), A2: value})
        assert verdict == ("CERTIFIED" if holds else "REFUTED")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("skeleton", "profile", "limit"),
    [
        (polyline([(0, 0), (3, 0), (3, 2)]), R - x / 10, sp.Rational(3, 10)),
        (arc(2, 0, sp.pi / 2), R - x / 4, sp.Rational(1, 2)),
    ],
)
def test_the_conditions_of_other_bodies_are_where_proofs_turn(skeleton, profile, limit):
    body = blend_on_skeleton(skeleton, profile, letters={R: 1})
    condition = analytic_condition(skeleton, profile, letters={R: 1})
    assert truth(condition, {R: limit + sp.Rational(1, 50)})
    assert not truth(condition, {R: limit - sp.Rational(1, 50)})
    assert (
        rsym.verify_smoothness(body, bounds=((-3, 6), (-3, 5)), letters={"r": limit + sp.Rational(1, 50)}).verdict
        == "CERTIFIED"
    )
    assert (
        rsym.verify_smoothness(body, bounds=((-3, 6), (-3, 5)), letters={"r": limit - sp.Rational(1, 50)}).verdict
        != "CERTIFIED"
    )


def sampled(points):
    """A polyline, densely."""
    return np.concatenate([np.linspace(p, q, 400) for p, q in pairwise(points)]).T


def bow(radius, start, end):
    angles = np.linspace(start, end, 1500)
    return radius * np.cos(angles), radius * np.sin(angles)


PATHS = {
    "segment, convex": (segment((-2, 1), (3, -1)), R + S * x**2 - T * y, sampled([(-2.0, 1), (3, -1)])),
    "segment, cubic": (segment((-2, 1), (3, -1)), R + S * x - T * x**3 / 5, sampled([(-2.0, 1), (3, -1)])),
    "segment, quotient": (segment((0, 0), (3, 0)), R / (1 + x) + S * x / (x - 4) + T, sampled([(0.0, 0), (3, 0)])),
    "closed polyline": (
        polyline([(0, 0), (2, 0), (1, 2)], closed=True),
        R + S * (x - y) + T * x * y,
        sampled([(0.0, 0), (2, 0), (1, 2), (0, 0)]),
    ),
    "arc": (arc(2, -1, 4), R + S * x + T * y, bow(2, -1, 4)),
    "arc, even": (arc(2, -2, 2), R + S * x**2 + T * x, bow(2, -2, 2)),
    "circle": (circle(2), R + S * x + T * y, bow(2, 0, 2 * np.pi)),
    "trimmed line": (
        Shape(rsym.trimming((3 * x - 4 * y) / 5, (x + 1) * (2 - x)), (x, y)),
        R + S * x + T * x * y,
        sampled([(-1.0, -0.75), (2.0, 1.5)]),
    ),
    "moved": (
        segment((-1, 0), (1, 0)).scale(2).rotate(sp.pi / 6).translate(1, 2),
        R + S * x + T * y**2 / 4,
        sampled([(1 - 3**0.5, 1.0), (1 + 3**0.5, 3.0)]),
    ),
}


@pytest.mark.random
@pytest.mark.parametrize("name", PATHS)
def test_the_condition_is_that_the_profile_is_positive_all_along_the_curve(name):
    """Against the least of many values, at random letters; often true and often false."""
    skeleton, profile, curve = PATHS[name]
    letters = tuple(symbol for symbol in (R, S, T) if profile.has(symbol))
    condition = analytic_condition(skeleton, profile, letters=dict.fromkeys(letters, 1))
    decide, value = sp.lambdify(letters, condition, "math"), sp.lambdify((x, y, *letters), profile, "numpy")
    random, held = np.random.default_rng(0), 0
    for _ in range(500):
        numbers = random.normal(size=len(letters)) * [2, 1, 1][: len(letters)]
        least = value(*curve, *numbers).min()
        if abs(least) > 1e-3:
            assert bool(decide(*numbers)) == (least > 0)
            held += least > 0
    assert 40 < held < 460


def test_in_space_paths_run_where_the_curves_do():
    """A profile that falls along each, and is zero at a known place."""
    bone = graph([(0, 0, 0), (0, 0, 3), (1, 0, 4), (-1, 0, 4)], [(0, 1), (1, 2), (1, 3)])
    assert analytic_condition(bone, R - z, letters={R: 1}).subs({R: 4}) == sp.false
    assert analytic_condition(bone, R - z, letters={R: 1}).subs({R: sp.Rational(401, 100)}) == sp.true
    hoop = circle(2, (0, 0, 1), axis=(0, 3, 4))
    top = 1 + 2 * sp.Rational(3, 5)
    assert truth(analytic_condition(hoop, R - z, letters={R: 1}), {R: top + sp.Rational(1, 100)})
    assert not truth(analytic_condition(hoop, R - z, letters={R: 1}), {R: top})
    spring = helix(2, 1, 3).translate(0, 0, 5)
    assert analytic_condition(spring, R - z, letters={R: 1}) == sp.And(R - 5 > 0, R - 8 > 0)
    assert analytic_condition(spring, R - x**2 - y**2, letters={R: 1}) == (R - 4 > 0)
    axis = Shape(rsym.trimming(sp.sqrt(4 * x**2 + (z - A) ** 2), (4 - y**2) / 4), (x, y, z), letters={A: 1})
    assert analytic_condition(axis, z + y - R, letters={R: 1}) == sp.And(A - R - 2 > 0, A - R + 2 > 0)


def test_a_profile_with_a_pole_on_the_skeleton_is_not_positive():
    """Neither where it changes its sign there nor where it does not; a pole beyond the ends does no harm."""
    assert analytic_condition(segment((-5, 0), (5, 0)), 100 + 1 / x**2) == sp.false
    for profile in (R + 1 / x, R + 1 / (x - A)):
        assert not truth(analytic_condition(ROD, profile, letters={R: 1}), {R: 100, A: 5})
    assert truth(analytic_condition(ROD, R + 1 / (x - 6), letters={R: 1}), {R: 2, A: 5})


@pytest.mark.slow
def test_an_offset_body_needs_a_positive_number_on_any_skeleton():
    anywhere = space_curve(x**2 + y**2 - 1, z)
    assert analytic_condition(anywhere, R, letters={R: 1}) == (R > 0)
    body = blend_on_skeleton(ROD, R, letters={R: 1})
    low, high = np.array(rsym.extent(body)).T
    assert (low > [-6.1, -1.1]).all()
    assert (high < [6.1, 1.1]).all()
    assert (np.array(body.box.ends)[:, 0] < low).all()
    assert (np.array(body.box.ends)[:, 1] > high).all()


def test_bounds_hold_bodies_of_which_curves_meet():
    star = graph([(0, 0), (3, 0), (-1, 2), (-1, -2)], [(0, 1), (0, 2), (0, 3)])
    body = blend_on_skeleton(star, sp.Rational(1, 2) + x / 10)
    with pytest.warns(rsym.RsymWarning, match="not proved that the boundary lies within"):
        assert "1 closed and 0 open" in str(rsym.level_lines(body, resolution=100).status)


def test_letters_of_the_skeleton_need_no_second_mention():
    body = blend_on_skeleton(ROD, (A + 1 - x) / R, letters={R: 20})
    assert sorted(body.letters) == ["a", "r"]
    profile = Shape((A + 1 - x) / R, (x, y), letters={A: 5, R: 20})
    assert blend_on_skeleton(ROD, profile) == body


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: blend_on_skeleton(y, 1), "skeleton"),
        (lambda: blend_on_skeleton(ROD, R), "unknown-letter"),
        (lambda: blend_on_skeleton(ROD, "thick"), "number"),
        (lambda: analytic_condition(ROD, sp.exp(x)), "no-condition"),
        (lambda: analytic_condition(ROD, R + x**4, letters={R: 1}), "no-condition"),
        (lambda: analytic_condition(helix(1, 1), 2 + z), "no-condition"),
        (lambda: analytic_condition(space_curve(x, y), 2 + z), "no-condition"),
        (lambda: analytic_condition(Shape(rsym.trimming(y, x), (x, y)), 2 + x), "no-condition"),
        (lambda: analytic_condition(helix(2, 1, 3), 3 + x), "no-condition"),
    ],
)
def test_what_has_no_condition_is_refused(make, code):
    with pytest.raises(RsymError) as caught:
        make()
    assert caught.value.code == code
