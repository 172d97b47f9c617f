"""Corners, nodes and isolated points proved by one-sided derivatives, against angles known otherwise."""

import math
import random
from fractions import Fraction

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import conjunction, disjunction, x, y
from rsym.model.powers import absolute_power
from rsym.verify.boxes.local import Model
from rsym.verify.points.directions import classify_by_directions

ORIGIN = (0, 0)
THIRD, SEVENTH = sp.Rational(1, 3), sp.Rational(1, 7)


def proved(expression, point=ORIGIN):
    model = Model(rsym.Shape(expression, (x, y)), {})
    return classify_by_directions(model, (Fraction(point[0]), Fraction(point[1])), frozenset())


@pytest.mark.random
@pytest.mark.parametrize(
    ("omega", "point", "turn"),
    [
        (conjunction(x, y) + x**3, ORIGIN, 90),
        (x + y - sp.sqrt(x**2 + y**2), ORIGIN, 90),
        (sp.sqrt(x**2 + y**2) - x / 2 - y, ORIGIN, 180 - math.degrees(2 * math.atan(0.5))),
        (conjunction(x - THIRD, y - SEVENTH * x), (THIRD, SEVENTH / 3), 90 + math.degrees(math.atan(1 / 7))),
        (conjunction(x, y, 2 * y - x, system=rsym.R1), ORIGIN, 90 + math.degrees(math.atan(1 / 2))),
        (conjunction(disjunction(x, y), y - x + x**2), ORIGIN, 45),
        (conjunction(x, y, system=rsym.Rp(3)) + x * y, ORIGIN, 90),
        (conjunction(x, y, x + y, system=rsym.R0m(2)), ORIGIN, 90),
        ((x**2 + y**2) * conjunction(sp.sin(x), sp.exp(y) - 1), ORIGIN, 90),
        (conjunction(conjunction(x, y), y - x**2), ORIGIN, 90),  # an operand touches the edge
        (conjunction(x + y, y, system=rsym.RAlpha(sp.Rational(1, 2))) + x**2, ORIGIN, 45),
        (rsym.trimming(y, x) - sp.Abs(x) / 2, ORIGIN, 180 - math.degrees(2 * math.atan(0.5))),
        (disjunction(x, y, system=rsym.Rp(4)) + absolute_power(x - y, sp.Integer(3)), ORIGIN, 90),
        (y - 2 * sp.Abs(x) / (1 + y), ORIGIN, 180 - math.degrees(2 * math.atan(0.5))),
        (sp.Max(sp.Abs(x), sp.Abs(y)) - x - y / 2, ORIGIN, 180 - math.degrees(math.atan(2))),
        (sp.sqrt(2 * x**2 + sp.exp(x) * y**2) - y * sp.sqrt(2), ORIGIN, math.degrees(2 * math.atan(2**0.5))),
    ],
    ids=str,
)
def test_corners_have_the_turn_that_plane_geometry_gives_them(omega, point, turn):
    joint = proved(omega, point)
    assert (joint.kind, joint.continuity, joint.branches, joint.proved) == ("corner", "G0", 2, True)
    assert_close(joint.tangent_jump, turn, atol=1e-11)
    assert 0 < joint.tangent_jump_error < 1e-11
    assert_close(joint.point, [float(part) for part in point], atol=1e-15)


@pytest.mark.parametrize(
    ("omega", "kind", "branches"),
    [
        (sp.Abs(x) + sp.Abs(y), "isolated point", 0),
        (x**2 * (1 + y) + 3 * y**2, "isolated point", 0),
        (x**2 + 3 * y**2 + x**3, "isolated point", 0),  # a sum of squares but for higher orders
        (-sp.sqrt(x**2 + y**2) + x / 2 + y**2, "isolated point", 0),
        (sp.Abs(x) - sp.Abs(y), "node", 4),
        (rsym.equivalence(x, 2 * y) - x / 4 - sp.sin(x) * y, "node", 4),
        ((x - y**2) * (y + x**2), "node", 4),
        (conjunction(x, y) * conjunction(-x, -y), "node", 4),
    ],
    ids=str,
)
def test_what_is_no_curve(omega, kind, branches):
    joint = proved(omega)
    assert (joint.kind, joint.branches, joint.proved) == (kind, branches, True)


@pytest.mark.random
@pytest.mark.parametrize(
    "omega",
    [
        y + x * sp.Abs(x),  # G1
        y - sp.Max(x, 0) ** 2,
        y + absolute_power(x, sp.Rational(3, 2)),
        sp.exp(x) - 1 - sp.sin(y) - sp.Abs(x - y) / 2,
        x - y**2 + conjunction(x, y) * disjunction(x, y),  # smooth to first order
        conjunction(y, x**2 - y),  # a cusp: both branches along one axis
        conjunction(y - x**2, 2 * x**2 - y),
        y**2 - x**3,
        sp.sqrt(x**2 + y**2) - x,  # a half-line without a change of sign
        sp.Abs(x - y),
        conjunction(x, -x),
        rsym.trimming(y, x) - y / 2 - x**2,  # a zero without a change of sign
        conjunction(x, y * (y - x**2) * (y + x**2)),  # three branches in one direction
        y * conjunction(x, y),  # the zero of the factor on the edge
        conjunction(x, y) + 1,  # not zero at the point
        conjunction(x, y) * sp.sqrt(x),  # undefined on one side
        conjunction(x, y) * sp.sqrt(1 - 2 / (2 + x)),
        conjunction(x, y) / y,
        conjunction(x, y) * (sp.sign(x) + sp.Rational(1, 2)),  # has a jump
        conjunction(x, y) * (sp.sign(x - 2 * y) ** 2 + sp.sign(x - 2 * y) - sp.Rational(1, 2)),
        sp.Piecewise((x + y, x > y), (y - x, True)),
        sp.Max(conjunction(x, y), sp.sign(y) - sp.Rational(1, 2)),
        sp.Piecewise((conjunction(x, y), sp.sign(y) < sp.Rational(1, 2)), (x, True)),
        conjunction(x, y) + absolute_power(x, sp.Rational(1, 2)),  # no slope
        conjunction(x, y) * absolute_power(x, -sp.Rational(1, 2)),
        sp.log(x + 1) * absolute_power(2 + x, y),
    ],
    ids=str,
)
def test_nothing_is_claimed_where_there_is_no_such_proof(omega):
    assert proved(omega) is None


def test_a_factor_that_is_a_sign_is_a_curve_of_the_boundary():
    """Both axes bound the quadrant, and the line through it has the body on one side: four rays and two quadrants."""
    node = proved(conjunction(x, y) * sp.sign(x - 2 * y))
    assert (node.kind, node.branches, node.proved) == ("node", 4, True)


def tree(rng, leaves, depth):
    """A formula, and what it means on arrays."""
    if depth == 0:
        return rng.choice(leaves)
    (first, f), (second, g) = tree(rng, leaves, depth - 1), tree(rng, leaves, depth - 1)
    operations = [
        (conjunction(first, second), lambda u, v: f(u, v) + g(u, v) - np.hypot(f(u, v), g(u, v))),
        (disjunction(first, second), lambda u, v: f(u, v) + g(u, v) + np.hypot(f(u, v), g(u, v))),
        (conjunction(first, second, system=rsym.R1), lambda u, v: np.minimum(f(u, v), g(u, v))),
        (disjunction(first, second, system=rsym.R1), lambda u, v: np.maximum(f(u, v), g(u, v))),
        (sp.Abs(first, evaluate=False) - second / 3, lambda u, v: np.abs(f(u, v)) - g(u, v) / 3),
        (first + second, lambda u, v: f(u, v) + g(u, v)),
    ]
    return (first, f) if first == second else rng.choice(operations)


def line(rng, bend):
    a, b = rng.randint(-5, 5), rng.randint(-5, 5) or 1
    if not bend:
        return a * x + b * y, lambda u, v: a * u + b * v
    bent = sp.sin(a * x + b * y) + (a * x + b * y) ** 2 * (1 + x)
    return bent, lambda u, v: np.sin(a * u + b * v) + (a * u + b * v) ** 2 * (1 + u)


def sign_changes(omega, radius):
    """Directions in which omega changes its sign on a small circle, by sampling; None if it is small on an arc."""
    angles = np.linspace(0, 2 * np.pi, 20_001)[:-1] + 1e-5
    values = omega(radius * np.cos(angles), radius * np.sin(angles)) / radius
    if np.sum(np.abs(values) < 1e-3) > 200:
        return None
    return angles[np.sign(values) != np.sign(np.roll(values, 1))]


@pytest.mark.slow
@pytest.mark.parametrize("bend", [False, True], ids=["plane", "bent"])
def test_random_trees_of_lines_have_the_directions_that_sampling_finds(bend):
    rng = random.Random(7 + bend)
    kinds = []
    for _ in range(25):
        formula, omega = tree(rng, [line(rng, bend) for _ in range(4)], 3)
        joint = proved(formula)
        kinds.append(None if joint is None else joint.kind)
        found = sign_changes(omega, 1e-7)
        if joint is None or found is None:
            continue
        assert joint.branches == len(found), formula
        if joint.kind == "corner":
            turn = abs(180 - math.degrees(found[1] - found[0]))
            assert_close(joint.tangent_jump, turn, atol=0.05)
            assert joint.tangent_jump > 1e-9
    assert {"corner", "isolated point"} <= set(kinds)
    assert kinds.count(None) <= 8, kinds


F, G = x**2 + y - 2, y**2 - x - THIRD


@pytest.mark.parametrize("omega", [conjunction(F, G) + F**3, sp.Max(F, -G) * (2 + x**2)], ids=str)
def test_corners_at_irrational_points_are_proved_through_the_whole_check(omega):
    box = ((0, 2.03), (-2, 2.07))
    report = rsym.verify_smoothness(rsym.Shape(omega, (x, y), bounds=box))
    assert report.verdict == "REFUTED"
    assert len(report.defects) == 2
    gradients = sp.lambdify((x, y), [[F.diff(x), F.diff(y)], [G.diff(x), G.diff(y)]], "mpmath")
    for joint in report.defects:
        with mp.workdps(40):
            point = mp.findroot(sp.lambdify((x, y), [F, G], "mpmath"), joint.point)
            (a, b), (c, d) = gradients(*point)
            turn = mp.degrees(abs(mp.atan2(a * d - b * c, a * c + b * d)))
            turn = turn if omega.has(conjunction(x, y).func) else 180 - turn
            assert mp.norm(mp.matrix(joint.point) - point) <= joint.radius
            assert abs(joint.tangent_jump - turn) <= joint.tangent_jump_error < 1e-11
        assert joint.proved
