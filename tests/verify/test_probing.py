"""One-sided limits at points of plane curves that are known in closed form."""

import math
from itertools import pairwise

import mpmath as mp
import pytest
from mpmath import mpf
from oracles.closeness import assert_close

from rsym.verify.points.extrapolation import limit
from rsym.verify.points.probing import Sample, classify

STEP = mpf("1e-15")
ORIGIN = (mpf(0), mpf(0))


def differences(w, third=False):
    """A field from a formula, its derivatives by central differences with twice the digits."""

    def ddx(f):
        return lambda x, y: (f(x + STEP, y) - f(x - STEP, y)) / (2 * STEP)

    def ddy(f):
        return lambda x, y: (f(x, y + STEP) - f(x, y - STEP)) / (2 * STEP)

    first = [ddx(w), ddy(w)]
    second = [ddx(first[0]), ddx(first[1]), ddy(first[1])]
    thirds = [ddx(second[0]), ddx(second[1]), ddx(second[2]), ddy(second[2])] if third else []

    def field(x, y):
        with mp.workdps(100):
            values = [[f(x, y) for f in order] for order in ([w], first, second, thirds)]
        return Sample(values[0][0], *map(tuple, values[1:3]), tuple(values[3]) or None)

    return field


def at(w, centre=ORIGIN, radius=0.0, **options):
    return classify(differences(w), centre, radius, **{"digits": 32, "value": w, **options})


def positive(x):
    return max(x, mpf(0))


def disk_like(x, y, exponent):
    return y - positive(x) ** exponent


@pytest.mark.parametrize("factor", [lambda x, y: 1, lambda x, y: x * x + y * y], ids=["plain", "smooth function"])
def test_a_right_angle_is_one_though_the_function_may_be_smooth(factor):
    joint = at(lambda x, y: factor(x, y) * (x + y - mp.hypot(x, y)))
    assert (joint.kind, joint.continuity, joint.branches, joint.proved) == ("corner", "G0", 2, False)
    assert_close([joint.tangent_jump, *joint.curvatures], [90, 0, 0], atol=1e-15)
    assert joint.reason == "convex"
    assert at(lambda x, y: -factor(x, y) * (x + y - mp.hypot(x, y))).reason == "reentrant"


def test_the_tip_of_the_published_body():
    """Two extrapolations that share nothing with these found 144.811726903 degrees and 0.0433063556 on both sides."""

    def body(x, y):
        trim = (25 - x * x) / 10
        across = (mp.hypot(trim, y * y) - trim) / 2
        return (8 - x) * (mpf("5.3") + x) / 40 - mpf("0.1") - mp.hypot(y, across)

    with mp.workdps(50):
        tip = ((mpf("2.7") - mp.sqrt(mpf("2.7") ** 2 + 4 * (mpf("42.4") - 4))) / 2, mpf(0))
    joint = at(body, tip)
    assert (joint.kind, joint.continuity) == ("corner", "G0")
    assert_close(joint.point[0], -4.99212109628947, atol=1e-13)
    assert_close(joint.tangent_jump, 144.811726903, atol=1e-9)
    assert_close(joint.curvatures, [0.0433063556] * 2, atol=1e-10)
    assert max(joint.tangent_jump_error, joint.curvature_jump_error) < 1e-12


def test_the_stadium_jumps_by_the_curvature_of_its_ends():
    joint = at(lambda x, y: 1 - y * y - positive(abs(x) - 1) ** 2, (mpf(1), mpf(1)))
    assert (joint.kind, joint.continuity) == ("curvature jump", "G1")
    assert_close([joint.curvature_jump, *joint.curvatures], [1, 1, 0], atol=1e-14)


@pytest.mark.random
@pytest.mark.parametrize(("exponent", "continuity", "jumps"), [(2, "G1", (2, 0)), (3, "G2", (0, 6)), (4, "G3", (0, 0))])
@pytest.mark.parametrize("third", [False, True])
def test_the_order_of_contact_of_two_arcs(exponent, continuity, jumps, third):
    """On both arcs |grad w| changes too, which must not matter."""

    def w(x, y):
        return (1 + x + 2 * y) * (y - x * x / 3 - positive(x) ** exponent)

    joint = classify(differences(w, third), ORIGIN, 0.0, digits=32, value=w)
    assert joint.continuity == continuity
    assert_close([joint.curvature_jump, joint.derivative_jump], jumps, atol=1e-12)
    assert max(joint.tangent_jump, joint.derivative_jump_error) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("n", [3, 5, 7])
def test_cusps(n):
    joint = at(lambda x, y: x**n - y * y)
    assert (joint.kind, joint.continuity, joint.branches, joint.tangent_jump) == ("cusp", "G0", 2, 180)
    assert math.isinf(joint.curvatures[0]) == (n == 3)


@pytest.mark.parametrize("n", [4, 5])
def test_a_curvature_that_grows_without_bound(n):
    joint = at(lambda x, y: x**n - y**3)
    assert (joint.kind, joint.continuity, joint.curvature_jump) == ("unbounded curvature", "G1", math.inf)
    assert joint.tangent_jump < 1e-9


@pytest.mark.random
@pytest.mark.parametrize(
    ("w", "kind", "branches"),
    [
        (lambda x, y: (x * x + y * y) ** 2 - x * x + y * y, "node", 4),
        (lambda x, y: y * y - x**4, "node", 4),
        (lambda x, y: (y - x * x) * (y - 2 * x * x) * (y + x * x), "node", 6),
        (lambda x, y: x * x + 3 * y * y, "isolated point", 0),
        (lambda x, y: -(x * x) - abs(y), "isolated point", 0),
        (lambda x, y: -((y - x * x) ** 2), "no sign change", 2),
        (lambda x, y: -abs(y), "no sign change", 2),
        (lambda x, y: y * x**2, "node", 4),
        (lambda x, y: y + 0 * mp.sqrt(x), "end", 1),
        (lambda x, y: y * (y * y - x * x) + 0 * mp.sqrt(x), "end", 3),
        (lambda x, y: mp.atan2(y, x), "end", 1),
        (lambda x, y: 1 + x + y, "unresolved", 0),
        (lambda x, y: positive(y) - positive(x), "unresolved", 0),
    ],
)
def test_no_two_branches_no_curve(w, kind, branches):
    joint = at(w)
    assert (joint.kind, joint.branches, joint.continuity) == (
        kind,
        branches,
        "unknown" if kind == "unresolved" else "broken",
    )
    assert not joint.proved


def test_directions_of_the_branches_of_a_node():
    assert at(lambda x, y: y * (x - y)).reason == "branches leave at 0, 45, 180, 225 degrees"


def test_a_centre_known_badly_widens_the_errors_and_is_refused_when_too_bad():
    def w(x, y):
        return 1 - y * y - positive(abs(x) - 1) ** 2 + y * positive(x - 1) ** 3

    off = (mpf(1) + mpf("3e-8"), mpf(1) - mpf("2e-8"))
    joint = at(w, off, 5e-8)
    assert joint.kind == "curvature jump"
    assert abs(joint.curvature_jump - 1) <= joint.curvature_jump_error < 1e-4
    assert at(w, off, 1e-5).kind == "unresolved"


def test_a_field_without_derivatives_is_judged_by_its_zeros():
    def field(x, y):
        return Sample(y - positive(x) ** 2, (mp.nan,) * 2, (mp.nan,) * 3)

    joint = classify(field, ORIGIN, 0.0, digits=32)
    assert (joint.kind, joint.continuity) == ("curvature jump", "G1")
    assert_close(joint.curvature_jump, 2, atol=1e-8)


@pytest.mark.parametrize("powers", [(1, 2), (0.5, 1), (1 / 3, 2 / 3), (0.25, 0.5), (2**0.5, 2), (0.9, 2)])
def test_a_limit_is_as_near_as_its_error_says(powers):
    with mp.workdps(40):
        values = [7 + sum(mpf(2) ** (-k * mpf(p)) for p in powers) / 100 for k in range(14)]
        found = limit(values, mpf("1e-20"))
    assert abs(found.value - 7) <= 10 * found.error < mpf("1e-6")
    assert_close(float(found.exponent), min(powers), atol=5e-2)


def test_a_logarithm_is_no_limit():
    found = limit([k * mp.log(2) for k in range(14)], mpf("1e-10"))
    assert not found.finite
    assert all(not limit([sign * v for v in (1, 2, 4, 8, 16, 32, 64)], mpf("1e-10")).finite for sign in (1, -1))
    noisy = [mpf((-7) ** k % 11 - 5) for k in range(14)]
    assert all(a != b for a, b in pairwise(noisy))
    assert mp.isnan(limit(noisy, mpf("1e-10")).value) or limit(noisy, mpf("1e-10")).error > mpf("1e-3")
