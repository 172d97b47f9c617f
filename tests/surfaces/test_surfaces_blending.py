"""Blending functions against fifty digits, quadrature and the conditions that define them."""

import math
import pickle

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from scipy.interpolate import CubicHermiteSpline

from rsym.errors import RsymError
from rsym.model.letters import Letter
from rsym.model.symbols import real_symbol
from rsym.surfaces.blends.blend_families import resolved
from rsym.surfaces.blends.blending import HermiteBlend, part_of_pi
from rsym.surfaces.blends.blending_checks import TOLERANCE, is_zero, never_negative
from rsym.surfaces.symbols import t

LAM, MU, NU, ALPHA = sp.symbols("lambda mu nu alpha")
QUARTER = sp.pi / 2
PLACES = np.linspace(0.0, 1.0, 12)
ANGLES = [1e-12, 1e-8, 1e-4, 1e-3, 0.05, 0.5, 0.999, 1.0, 1.001, math.pi / 2, 2.0, 3.0, math.pi, 4.0, 6.1]


def all_blends():
    return [
        HermiteBlend.linear(),
        HermiteBlend.cubic(),
        HermiteBlend.quintic(),
        HermiteBlend.class1(LAM, ALPHA, letters={LAM: -0.7, ALPHA: 1.2}),
        HermiteBlend.class1(1, 4.0),
        HermiteBlend.class2(MU, ALPHA, letters={MU: 2, ALPHA: 0.4}),
        HermiteBlend.class2(-12, 0),
        HermiteBlend.trigonometric(0.25),
        HermiteBlend.from_smoothstep(t**2 * (3 - 2 * t) + t**3 * (1 - t) ** 2, 1.0),
    ]


def turned(a, at, order):
    """Derivatives of 1, t, cos(at), sin(at), to fifty digits."""
    a, at = mp.mpf(a), mp.mpf(at)
    phase = a * at + order * mp.pi / 2
    return [mp.mpf(order == 0), [at, 1][order] if order < 2 else 0, a**order * mp.cos(phase), a**order * mp.sin(phase)]


def basis_by_solving(a, order):
    """F1, G1 of the Hermite basis of 1, t, cos, sin: a linear system in 120 digits."""
    with mp.workdps(120):
        rows = [turned(a, end, k) for k in (0, 1) for end in (0, 1)]
        found = mp.inverse(mp.matrix(rows))
        values = [[turned(a, float(place), order) for place in PLACES]]
        return np.array([[float(mp.fdot(one, found[:, column])) for column in range(4)] for one in values[0]])


@pytest.mark.random
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_class_one_against_120_digits_for_every_angle(order):
    letters = HermiteBlend.class1(1, ALPHA, letters={ALPHA: 1})
    for angle in ANGLES:
        allowed = 5e-15 * 4**order * (10 if angle > 6 else 1)
        found = letters(PLACES, order, letters={"alpha": angle})
        assert_close(found, basis_by_solving(angle, order), atol=allowed)


@pytest.mark.random
@pytest.mark.parametrize("angle", [1e-9, 0.05, 1.01, math.pi / 2, 4.0])
def test_numbers_are_as_good_as_letters(angle):
    blend = HermiteBlend.class1(1, angle)
    for order in (0, 3):
        assert_close(blend(PLACES, order), basis_by_solving(angle, order), atol=5e-15 * 4**order)
    if angle < math.pi:
        assert_close(HermiteBlend.class2(2, angle)(PLACES), completion(2, angle, 0), atol=2e-15)


def completion(mu, a, order):
    """Class II by its definition, to 120 digits: f1 is given, the rest makes 1, cos, sin exact."""
    f1 = sp.Poly(3 * t**2 - 2 * t**3 + sp.Rational(mu) * t**2 * (1 - t) ** 2 * (2 * t - 1), t)
    for _ in range(order):
        f1 = f1.diff(t)
    rows = []
    with mp.workdps(120):
        for place in map(float, PLACES):
            one, _, cosine, sine = turned(a, place, order)
            step = mp.mpf(str(sp.N(f1.eval(sp.Rational(place)), 110)))
            # cos = F0 + cos(a) F1 - a sin(a) G1 and sin = sin(a) F1 + a G0 + a cos(a) G1
            g1 = (one - step + mp.cos(a) * step - cosine) / (mp.mpf(a) * mp.sin(a))
            rows.append([one - step, step, (sine - mp.sin(a) * step) / mp.mpf(a) - mp.cos(a) * g1, g1])
    return np.array([[float(value) for value in row] for row in rows])


@pytest.mark.random
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_class_two_against_120_digits_for_every_angle(order):
    letters = HermiteBlend.class2(MU, ALPHA, letters={MU: 0, ALPHA: 1})
    for angle, mu in zip([a for a in ANGLES if a < 3.1], [-12, -3, 0, 1, 3, 0.5] * 3, strict=False):
        found = letters(PLACES, order, letters={"alpha": angle, "mu": mu})
        assert_close(found, completion(mu, angle, order), atol=3e-15 * (1 + abs(mu)) * 4**order)


def test_at_the_angle_zero_both_families_are_polynomials():
    cubic = CubicHermiteSpline([0, 1], np.eye(4)[:2], np.eye(4)[2:])(PLACES)
    assert_close(HermiteBlend.cubic()(PLACES), cubic, atol=1e-15)
    one = HermiteBlend.class1(LAM, ALPHA, letters={LAM: 1, ALPHA: Letter(0, minimum=0, maximum=2)})
    two = HermiteBlend.class2(MU, ALPHA, letters={MU: 0, ALPHA: 0})
    assert_close(one(PLACES), cubic, atol=1e-15)
    for blend in (two, HermiteBlend.class2(0, 0)):
        # 1, t, t**2 are reproduced, which leaves G1 = (t**2 - F1)/2
        assert_close(blend(PLACES)[:, 3], (PLACES**2 - cubic[:, 1]) / 2, atol=1e-15)
        assert_close(blend(PLACES)[:, 1] + blend(PLACES)[:, 2] + blend(PLACES)[:, 3], PLACES, atol=1e-15)


@pytest.mark.random
@pytest.mark.parametrize("blend", all_blends(), ids=lambda blend: str(blend.functions[1])[:30])
def test_conditions_at_the_ends_by_high_precision_limits(blend):
    values = {symbol: sp.Rational(str(blend.letters[symbol.name].default)) for symbol in symbols_in(blend)}
    functions = [sp.lambdify(t, one.xreplace(values), "mpmath") for one in blend.functions]
    with mp.workdps(40):
        for number, function in enumerate(functions):
            for order in range(blend.order):
                for end in (0, 1):
                    found = mp.diff(function, end, order, h=mp.mpf(10) ** -8)
                    assert abs(found - ((number // 2, number % 2) == (order, end))) < 1e-7


def symbols_in(blend):
    return {symbol for one in blend.functions for symbol in one.free_symbols} - {t}


@pytest.mark.slow
def test_the_classical_special_cases():
    theta = np.pi * PLACES / 2
    closed = 2 * (1 - np.cos(theta) + np.sin(theta) - theta) / (4 - np.pi)
    closed_g = 4 * ((theta - np.sin(theta)) - (np.pi / 2 - 1) * (1 - np.cos(theta))) / (np.pi * (4 - np.pi))
    assert_close(HermiteBlend.class1(1, np.pi / 2)(PLACES)[:, [1, 3]], np.stack([closed, closed_g], 1), atol=2e-15)
    half_turn = np.sin(np.pi * PLACES / 2) ** 2
    assert_close(HermiteBlend.class1(1, np.pi)(PLACES)[:, 1], half_turn, atol=1e-15)
    expected = [np.cos(theta) ** 2, np.sin(theta) ** 2]
    expected += [2 / np.pi * np.sin(theta) * (1 - np.sin(theta)), -2 / np.pi * np.cos(theta) * (1 - np.cos(theta))]
    assert_close(HermiteBlend.trigonometric(0)(PLACES), np.stack(expected, axis=1), atol=1e-15)
    quintic = HermiteBlend.quintic()(PLACES)[:, 1]
    assert_close(HermiteBlend.class2(3, 1)(PLACES)[:, 1], quintic, atol=1e-15)
    assert_close(HermiteBlend.class1(0, 1.3)(PLACES), HermiteBlend.cubic()(PLACES), atol=1e-15)
    # at a full turn F1 = t - sin(2 pi t)/(2 pi)
    near_full = HermiteBlend.class1(1, 6.283)(PLACES)[:, 1]
    assert_close(near_full, PLACES - np.sin(2 * np.pi * PLACES) / (2 * np.pi), atol=1e-4)


def test_the_movement_at_a_quarter_is_as_small_as_the_theory_says():
    fine = np.linspace(0, 1, 2001)
    moved = np.abs(HermiteBlend.class1(1, np.pi / 2)(fine) - HermiteBlend.cubic()(fine)).max(axis=0)
    assert_close(moved, [0.0023, 0.0023, 0.0071, 0.0071], atol=6e-5)


@pytest.mark.random
@pytest.mark.parametrize("angle", [1e-6, 0.3, 1.0, 1.5707963267948966, 2.5])
def test_arcs_of_the_angle_are_kept_for_every_shape_parameter(angle):
    step = t**2 * (3 - 2 * t) + t**3 * (1 - t) ** 2
    blends = [HermiteBlend.class1(1, angle), HermiteBlend.from_smoothstep(step, angle)]
    blends += [HermiteBlend.class2(mu, angle) for mu in (-12, 0.5, 3)]
    for start in (0.0, 2.2):
        ends = np.array([start, start + angle])
        for values, slopes in ((np.cos, lambda x: -np.sin(x)), (np.sin, np.cos)):
            data = np.array([*values(ends), *(angle * slopes(ends))])
            for blend in blends:
                assert_close(blend(PLACES) @ data, values(start + angle * PLACES), atol=2e-15)


@pytest.mark.slow
def test_answers_that_are_proved():
    cubic = HermiteBlend.cubic()
    for blend in all_blends():
        answer = blend.is_partition_of_unity()
        assert answer
        assert answer.proved
    symmetric = [blend.is_symmetric() for blend in all_blends()]
    assert [bool(one) for one in symmetric] == [True] * 8 + [False]
    assert all(one.proved for one in symmetric[:8])
    assert cubic.reproduces(t**3 - t).proved
    assert HermiteBlend.class2(MU, QUARTER, letters={MU: 2}).reproduces(sp.cos(QUARTER * t + 1)).proved
    assert HermiteBlend.class1(1, ALPHA, letters={ALPHA: 2}).reproduces(sp.sin(real_symbol("alpha") * t)).proved
    assert HermiteBlend.trigonometric(NU, letters={NU: 2}).reproduces(sp.sin(QUARTER * t)).proved


def test_answers_that_are_no_name_the_worst_place():
    answer = HermiteBlend.cubic().reproduces(sp.cos(QUARTER * t))
    fine = np.linspace(0, 1, 4001)
    error = np.abs(CubicHermiteSpline([0, 1], [1, 0], [0, -np.pi / 2])(fine) - np.cos(np.pi * fine / 2))
    assert not answer
    assert_close(answer.worst, error.max(), rtol=1e-5)
    assert_close(answer.where, fine[error.argmax()], atol=1e-3)
    assert "no, by 0.0107" in str(answer)
    lopsided = HermiteBlend.from_smoothstep(t**2 * (3 - 2 * t) + t**3 * (1 - t) ** 2, 1.0).is_symmetric()
    assert not lopsided
    # the added t**3 (1-t)**2 + t**2 (1-t)**3 = (t(1-t))**2 has its maximum in the middle
    assert_close([lopsided.worst, lopsided.where], [1 / 16, 0.5], atol=1e-12)


def test_what_holds_for_the_defaults_of_the_letters_alone_does_not_hold():
    blend = HermiteBlend.class1(LAM, QUARTER, letters={LAM: 1})
    arc = sp.cos(QUARTER * t)
    assert not blend.reproduces(arc)
    assert blend.reproduces(arc, letters={"lambda": 1})
    narrow = HermiteBlend.class1(LAM, QUARTER, letters={LAM: Letter(1, minimum=1, maximum=1.5)})
    assert "lambda = 1.5" in str(narrow.reproduces(arc))


def slopes(blend, count=20001):
    return blend(np.linspace(0, 1, count), 1)[:, 1].min()


@pytest.mark.random
@pytest.mark.parametrize(
    "family",
    [
        lambda value: HermiteBlend.class1(value, np.pi / 2),
        lambda value: HermiteBlend.class1(value, 3.0),
        lambda value: HermiteBlend.class1(value, 0.3),
        lambda value: HermiteBlend.class2(value, 1.0),
        HermiteBlend.trigonometric,
    ],
)
def test_the_monotone_range_is_where_the_slope_turns_negative(family):
    low, high = map(float, family(1).monotone_range())
    room = 1e-3 * (high - low)
    for value in (low + room, high - room):
        assert slopes(family(value)) > -1e-15 * (1 + abs(value))
        assert family(value).is_monotone()
    for value in (low - room, high + room):
        answer = family(value).is_monotone()
        assert slopes(family(value)) < 0
        assert not answer
        assert answer.proved


def test_the_monotone_ranges_of_the_theory():
    ends = [float(end) for end in HermiteBlend.class1(1, QUARTER).monotone_range()]
    assert_close(ends, [-94.1, 23.9], atol=0.06)
    assert HermiteBlend.class2(0, 1).monotone_range() == (-12, 3)
    assert HermiteBlend.trigonometric(0).monotone_range() == (-sp.pi / (4 - sp.pi), 1)
    _, inner = HermiteBlend.class2(0, QUARTER).monotone_range(ribbons=True)
    assert_close(float(inner), 3 - math.pi**2 / 8, atol=1e-14)
    assert HermiteBlend.class2(0, 0).monotone_range(ribbons=True) == (-12, 2)
    with pytest.raises(RsymError, match="known monotone range"):
        HermiteBlend.cubic().monotone_range()


@pytest.mark.random
@pytest.mark.parametrize("angle", [0.2, 1.0, np.pi / 2])
@pytest.mark.parametrize("name", ["class2", "trigonometric"])
def test_in_the_narrower_range_the_ribbons_keep_their_signs(name, angle):
    def family(value):
        return HermiteBlend.class2(value, angle) if name == "class2" else HermiteBlend.trigonometric(value)

    low, high = map(float, family(0).monotone_range(ribbons=True))
    fine = np.linspace(0, 1, 20001)
    for value in (low, high - 1e-4):
        assert family(value + 1e-9).is_monotone()
        assert family(value)(fine)[:, 3].max() < 1e-15
        assert family(value)(fine)[:, 2].min() > -1e-15
    assert family(high + 1e-2)(fine)[:, 3].max() > 1e-11


def test_the_narrower_range_is_not_guessed():
    for blend in (HermiteBlend.class1(1, 1), HermiteBlend.class2(1, 2.5)):
        with pytest.raises(RsymError, match="known for class2 and trigonometric up to the angle pi/2"):
            blend.monotone_range(ribbons=True)
    # and at 2.5 it would indeed be wrong
    assert HermiteBlend.class2(-12, 2.5)(PLACES)[:, 3].max() > 0.1


def test_letters_move_without_another_kernel():
    blend = HermiteBlend.class2(MU, ALPHA, letters={MU: Letter(0, minimum=-12, maximum=3), ALPHA: 1})
    for angle in (1e-9, 0.7, 2.0):
        got = blend(PLACES, letters={"mu": 1.5, ALPHA: angle})
        assert_close(got, HermiteBlend.class2(1.5, angle)(PLACES), atol=2e-15)
    assert len(blend.curve._compiled._functions) == 1
    assert_close(blend.with_letters({"mu": 2, "other": 7})(PLACES), blend(PLACES, letters={"mu": 2}), atol=1e-15)
    assert blend.is_monotone(letters={"mu": 3})


def test_blends_are_values():
    assert HermiteBlend.class2(1, np.pi / 2) == HermiteBlend.class2(1, QUARTER)
    assert len({HermiteBlend.cubic(), HermiteBlend.cubic(), HermiteBlend.quintic()}) == 2
    blend = HermiteBlend.class1(LAM, QUARTER, letters={LAM: 0.5})
    copy = pickle.loads(pickle.dumps(blend))
    assert copy == blend
    assert copy.exact_angle is None
    assert HermiteBlend.class1(1, QUARTER).exact_angle == QUARTER
    assert HermiteBlend.class2(MU, 1, letters={MU: 1}).exact_angle == 1


def test_formulas_are_what_is_computed():
    for blend in all_blends():
        values = {symbol: sp.Rational(str(blend.letters[symbol.name].default)) for symbol in symbols_in(blend)}

        written = [one.xreplace(values).subs(t, sp.Rational(1, 3)) for one in resolved(blend.formulas)]
        assert_close([float(sp.N(one, 30)) for one in written], blend(1 / 3), atol=1e-15)


def test_latex_reads_like_the_theory():
    text = HermiteBlend.class2(MU, QUARTER, letters={MU: 0})._repr_latex_()
    assert r"F_{0}(t) &= 1 - F_{1}(t)" in text
    assert r"F_{1}(t) &= \mu t^{2} \left(1 - t\right)^{2} \left(2 t - 1\right) - 2 t^{3} + 3 t^{2}" in text
    assert r"G_{0}(t) &= - G_{1}(1 - t)" in text
    assert r"\frac{2 \left(F_{0}(t) - \cos{\left(\frac{\pi t}{2} \right)}\right)}{\pi}" in text
    for blend in all_blends():
        assert "Piecewise" not in blend._repr_latex_()
        assert r"\begin{cases}" not in blend._repr_latex_()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: HermiteBlend((1 - t, t**2 + t)), "F1 must have the value 1 at t = 1, got 2"),
        (lambda: HermiteBlend((1 - t, t, t, t)), "F0 must have the derivative 0 at t = 0, got -1"),
        (lambda: HermiteBlend([1 - t]), "2, 4 or 6 functions, got 1"),
        (lambda: HermiteBlend((1 - MU * t, t)), "unknown symbol 'mu'"),
        (lambda: HermiteBlend((1 - MU * t, t), letters={MU: 2}), "F0 must have the value 0 at t = 1, got -1"),
        (lambda: HermiteBlend.from_smoothstep(t, 1), "F0 must have the derivative 0 at t = 0, got -1"),
        (lambda: HermiteBlend.class2(0, math.pi), r"angle of class II must lie in \[0, pi\), got 3.14"),
        (lambda: HermiteBlend.class1(0, -1), r"\[0, 2\*pi\), got -1"),
        (lambda: HermiteBlend.class1(LAM, 1), "unknown symbol 'lambda'"),
    ],
)
def test_what_is_no_blend_is_refused(make, message):
    with pytest.raises(RsymError, match=message):
        make()


def test_the_proofs_can_fail():
    """Red proofs of the two decisions by algebra."""
    x = real_symbol("alpha")
    assert is_zero(sp.sin(x * t) ** 2 + sp.cos(x * t) ** 2 - 1)
    assert not is_zero(sp.sin(x * t) ** 2 + sp.cos(x * t) ** 2 - 1 + TOLERANCE * t)
    assert never_negative(sp.Poly(t * (t - sp.Rational(1, 3)) ** 2 * (1 - t), t))
    assert not never_negative(sp.Poly(t * (t - sp.Rational(1, 3)) * (1 - t), t))
    assert not never_negative(sp.Poly(-t, t))


def test_parts_of_pi():
    assert part_of_pi(math.pi / 3) == sp.pi / 3
    assert part_of_pi(math.radians(37)) == 37 * sp.pi / 180
    assert part_of_pi(0.0) == 0
    assert part_of_pi(1.0471975) == sp.Rational("1.0471975")
