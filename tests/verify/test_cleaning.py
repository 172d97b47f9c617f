"""The clean-up before a proof changes nothing but the form."""

import random

import mpmath as mp
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import conjunction, disjunction, trimming, verify_smoothness, x, y, z
from rsym.model.functions import Softplus
from rsym.model.nodes import expand_nodes
from rsym.verify.cleaning import cleaned

F, G, H = x**2 + y - 2, y**2 - x - sp.Rational(1, 3), 1 - x * y
SQUARE = sp.expand((x - y) ** 2 * (x**2 + 1))
LOST = sp.log(x)


def raw(expression):
    return expand_nodes(expression)


CASES = {
    sp.sqrt(x**2 * y**2 + x**2): sp.Abs(x) * sp.sqrt(y**2 + 1),
    sp.sqrt(SQUARE): sp.Abs(x - y) * sp.sqrt(x**2 + 1),
    1 / sp.sqrt(SQUARE): 1 / (sp.Abs(x - y) * sp.sqrt(x**2 + 1)),
    SQUARE ** sp.Rational(3, 2): sp.Abs(x - y) ** 3 * (x**2 + 1) ** sp.Rational(3, 2),
    sp.sqrt(sp.expand(x**4 * (x**2 + x + 1))): x**2 * sp.sqrt(x**2 + x + 1),
    sp.sqrt(sp.expand((x + sp.pi * y) ** 2)): sp.Abs(x + sp.pi * y),
    sp.Abs(sp.expand((x - y) ** 3 * (x + 1) ** 2)): (x + 1) ** 2 * (x - y) ** 2 * sp.Abs(x - y, evaluate=False),
    x + y - sp.sqrt(x**2 + y**2): conjunction(x, y),
    2 * x - y + sp.sqrt(4 * x**2 + y**2): disjunction(2 * x, -y),
    (F + G) / 2 - sp.sqrt(F**2 + G**2) / 2: conjunction(F, G) / 2,
    raw(conjunction(F, G, H)) + x**3: conjunction(conjunction(F, G), H) + x**3,
    raw(conjunction(sp.exp(x), disjunction(F, H))): conjunction(sp.exp(x), disjunction(F, H)),
    raw(conjunction(x, y)) + raw(disjunction(x**3, sp.sin(y))): conjunction(x, y) + disjunction(x**3, sp.sin(y)),
    sp.tanh(F) * y: (1 - 2 * sp.exp(-Softplus(2 * F))) * y,
    1 / (2 + sp.exp(F) / 3) ** 2: sp.exp(-2 * Softplus(F - sp.log(6))) / 4,
    raw(trimming(F, G)): trimming(F, G),
    raw(trimming(y, conjunction(G, H))): trimming(y, conjunction(G, H)),
}


@pytest.mark.random
@pytest.mark.parametrize("before", CASES, ids=str)
def test_the_form_changes_and_the_function_does_not(before):
    after = cleaned(before)
    assert after != before
    assert not after.has(sp.sqrt(F**2 + G**2))
    assert cleaned(after) == after
    rng = random.Random(1)
    functions = [sp.lambdify((x, y), raw(form), "mpmath") for form in (before, after, CASES[before])]
    with mp.workdps(60):
        for _ in range(20):
            point = [mp.mpf(rng.randint(1, 3000)) / 997 * rng.choice([1, -1]) for _ in range(2)]
            first, *others = (function(*point) for function in functions)
            assert all(abs(other - first) <= mp.mpf(10) ** -40 * (1 + abs(first)) for other in others)


@pytest.mark.parametrize(
    "expression",
    [
        sp.sqrt(x**2 * y - x**2),  # 0 on x = 0, where the root of y - 1 may not exist
        sp.sqrt(sp.expand(-(x**2) * (y**2 + 1))),
        sp.sqrt(x**2 + y**2) - x,
        x + y - sp.sqrt(x**2 + 2 * y**2),
        x + 2 * y - sp.sqrt(x**2 + y**2),
        F + G - sp.sqrt(F**2 + G**2 + 1),
        LOST * (y + 1) - LOST * y - LOST + sp.expand(F * H) + G - sp.sqrt(F**2 * H**2 + G**2),  # undefined for x < 0
        sp.sqrt(y**2 + (sp.sqrt(y**4 + x**2) / 2 + x) ** 2),
        sp.sqrt((x + y + 1) ** 500 + x),
        sp.sqrt(sp.Float("0.01") * x**2 + y**2) - sp.Float("0.1") * x - y,  # 0.1**2 is not 0.01 in binary
    ],
    ids=str,
)
def test_what_is_no_such_thing_stays(expression):
    assert not cleaned(expression).has(type(conjunction(x, y)), type(disjunction(x, y)), type(trimming(x, y)))
    assert raw(cleaned(expression)).count(sp.Pow) == expression.count(sp.Pow)


def test_random_formulas_written_out_in_roots_are_found_again():
    rng = random.Random(3)

    def tree(depth):
        if depth == 0:
            return rng.randint(-4, 4) * x + (rng.randint(-4, 4) or 1) * y + rng.randint(-3, 3)
        return rng.choice([conjunction, disjunction])(tree(depth - 1), tree(depth - 1))

    for depth in (1, 2, 2, 3):
        expression = tree(depth)
        found = cleaned(raw(expression))
        assert not found.has(sp.sqrt)
        assert not any(part.is_Pow and part.exp == sp.S.Half for part in sp.preorder_traversal(found))
        with mp.workdps(50):
            point = {x: sp.Rational(7, 11), y: sp.Rational(-5, 13)}
            assert abs(sp.N((raw(found) - raw(expression)).subs(point), 45)) < 1e-40


@pytest.mark.slow
def test_the_published_body_in_roots_has_the_verdict_of_the_published_body():
    body = rsym.paper.skeleton_body()
    written = body.replace(expression=raw(body.expression))
    report = verify_smoothness(written)
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert_close(report.defects[0].point[0], -4.992121096289474, atol=1e-9)
    assert_close(report.defects[0].tangent_jump, 144.811726903428, atol=1e-8)
    assert cleaned(written.expression) == body.expression  # so it has all its verdicts


def test_the_corners_of_a_rectangle_in_roots_are_proved():
    across, along = 1 - x**2, sp.Rational(1, 4) - y**2
    omega = across + along - sp.sqrt(across**2 + along**2)
    report = verify_smoothness(rsym.Shape(omega, (x, y), bounds=((-2, 2), (-1, 1))))
    assert report.verdict == "REFUTED"
    assert len(report.defects) == 4
    assert all(joint.proved and joint.kind == "corner" for joint in report.defects)
    assert_close([joint.tangent_jump for joint in report.defects], [90] * 4, atol=1e-10)


@pytest.mark.random
@pytest.mark.parametrize("factor", [sp.Rational(1, 10**300), -sp.Rational(1, 10**300), sp.Integer(10) ** 200, 1e-200])
def test_a_factor_of_omega_beyond_the_range_of_squares_drops(factor):
    """The boundary is the same, the sign too; with -factor the inside is the outside of the ball."""
    ball = rsym.Shape(factor * (1 - x**2 - y**2 - z**2), (x, y, z), bounds=((-1.5, 1.6),) * 3)
    for method in ("space", "meridian"):
        report = rsym.verify_smoothness(ball, method=method)
        assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
    low, high = rsym.verify_smoothness(ball, method="space").curvatures
    assert low <= (1 if factor > 0 else -1) <= high
    assert high - low < 0.2
