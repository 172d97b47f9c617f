"""Verdicts on bodies in space of which letters range: certified for every value, refuted for at least one."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.verify.boxes.local import Model
from rsym.verify.cover.box_arrays import cut, halves
from rsym.verify.cover.surfaces import SheetInspector
from rsym.verify.fibres import simplest_between

c, d = sp.symbols("c d", real=True)
WINDOW = ((-2.5, 2.4), (-2.45, 2.5), (-2.3, 2.5))
Q = sp.Rational
RADIUS = sp.sqrt(x**2 + y**2)
SQUARES = x**2 + y**2 + z**2
PAIR = 1 - (x - c) ** 2 - y**2 - z**2, 1 - (x + c) ** 2 - y**2 - z**2


def judged(expression, bounds=WINDOW, **letters):
    symbols = {sp.Symbol(name, real=True): sum(map(sp.nsimplify, ends)) / 2 for name, ends in letters.items()}
    shape = rsym.Shape(expression, (x, y, z), letters=symbols, bounds=bounds)
    return rsym.verify_smoothness(shape, letters=letters, method="space")


# Regular for every value by hand: where the gradient vanishes, omega does not.
REGULAR = {
    "sphere": (c**2 - SQUARES, {"c": (1, 2)}),
    "ellipsoid": (1 - x**2 / c**2 - y**2 / d**2 - z**2, {"c": (1, 2), "d": (1, 2)}),
    "torus": (c**2 - (RADIUS - Q(3, 2)) ** 2 - z**2, {"c": (Q(1, 4), Q(3, 4))}),
    "hyperboloid of one sheet": (x**2 + y**2 - z**2 - c, {"c": (Q(1, 4), 1)}),
    "gyroid": (sp.sin(x) * sp.cos(y) + sp.sin(y) * sp.cos(z) + sp.sin(z) * sp.cos(x) - c, {"c": (Q(-1, 10), Q(1, 10))}),
    "balls apart": (rsym.disjunction(*PAIR), {"c": (Q(11, 10), Q(13, 10))}),
    "an edge beyond the bounds": (rsym.conjunction(1 - z, x + 5 + c), {"c": (-1, 1)}),
    "turned ellipsoid": (
        1 - (x * sp.cos(c) + y * sp.sin(c)) ** 2 / 4 - (y * sp.cos(c) - x * sp.sin(c)) ** 2 - z**2,
        {"c": (0, 1)},
    ),
    "helix": (Q(1, 9) - (x - sp.cos(c * z)) ** 2 - (y - sp.sin(c * z)) ** 2, {"c": (Q(1, 2), 1)}),
}


@pytest.mark.random
@pytest.mark.parametrize("name", REGULAR)
def test_what_is_regular_for_every_value_is_certified(name):
    expression, letters = REGULAR[name]
    report = judged(expression, **letters)
    assert (report.verdict, report.continuity) == ("CERTIFIED", "analytic")
    low, high = report.curvatures
    assert low <= report.attained[0] <= report.attained[1] <= high


# The truth at one value is another one; None: nothing but CERTIFIED would be false.
DEFECTS = {
    "a cone at 0": (x**2 + y**2 - z**2 - c, {"c": (-1, 1)}, "DEGENERATE"),
    "a cone at the end": (x**2 + y**2 - z**2 - c, {"c": (0, 1)}, "DEGENERATE"),
    "a cone at a fraction": (x**2 + y**2 - z**2 - c + Q(3, 7), {"c": (Q(1, 3), 2)}, "DEGENERATE"),
    "a cone at a root": (x**2 + y**2 - z**2 - c**2 + 2, {"c": (1, 2)}, None),
    "a Cassini's node": (
        c - ((x - 1) ** 2 + y**2 + z**2) * ((x + 1) ** 2 + y**2 + z**2),
        {"c": (Q(3, 4), Q(3, 2))},
        "DEGENERATE",
    ),
    "a ball that is a point": (c**2 - SQUARES, {"c": (0, 1)}, "DEGENERATE"),
    "a tube that is a circle": (c**2 - (RADIUS - Q(3, 2)) ** 2 - z**2, {"c": (0, Q(3, 4))}, None),
    "balls that meet": (rsym.disjunction(*PAIR), {"c": (Q(1, 2), Q(6, 5))}, None),
    "balls that touch at the end": (rsym.disjunction(*PAIR), {"c": (1, Q(13, 10))}, "DEGENERATE"),
    "a box": (rsym.conjunction(c - x, c + x, c - y, c + y, c - z, c + z), {"c": (1, 2)}, "REFUTED"),
    "a bead": (rsym.conjunction(4 - SQUARES, x**2 + y**2 - c**2), {"c": (Q(1, 2), 1)}, "REFUTED"),
    "a kink that vanishes": (z - c * sp.Abs(x), {"c": (0, 1)}, "REFUTED"),
    "a kink at the end": (z - sp.Abs(x) * sp.Max(c - Q(99, 100), 0), {"c": (0, 1)}, None),
    "a jump of the curvature": (z - c * x * sp.Abs(x), {"c": (-1, 1)}, None),
    "a tip at 0": (z - sp.sqrt(x**2 + y**2 + c**2), {"c": (-1, 1)}, None),
    "an edge near a face": (rsym.conjunction(1 - z, x + Q(5, 2) + c), {"c": (Q(-1, 50), 1)}, None),
    "a ball that leaves": (1 - (x - c) ** 2 - y**2 - z**2, {"c": (0, 10)}, None),
    "a ball that is gone at the end": (1 - (x - c) ** 2 - y**2 - z**2, {"c": (0, Q(7, 2))}, None),
    "two letters": (x**2 + y**2 - z**2 - c * d + 1, {"c": (Q(1, 2), 2), "d": (Q(1, 2), 2)}, None),
}


@pytest.mark.random
@pytest.mark.parametrize("name", DEFECTS)
def test_what_is_singular_at_a_single_value_is_never_certified(name):
    expression, letters, verdict = DEFECTS[name]
    report = judged(expression, **letters)
    assert report.verdict != "CERTIFIED"
    assert verdict is None or report.verdict == verdict
    if report.verdict in {"REFUTED", "DEGENERATE"}:
        assert report.statements[0][0].startswith("what follows is said of ")


@pytest.mark.slow
@pytest.mark.parametrize("method", ["meridian", "space", "plane"])
def test_a_boundary_that_leaves_the_bounds_for_some_value_is_not_certified(method):
    squares = (x - c) ** 2 + y**2 + (0 if method == "plane" else z**2)
    coordinates, bounds = ((x, y), WINDOW[:2]) if method == "plane" else ((x, y, z), WINDOW)
    shape = rsym.Shape(1 - squares, coordinates, letters={c: 0}, bounds=bounds)
    method = "auto" if method == "plane" else method
    assert rsym.verify_smoothness(shape, letters={"c": (0, 1)}, method=method).verdict == "CERTIFIED"
    assert rsym.verify_smoothness(shape, letters={"c": (0, 5)}, method=method).verdict != "CERTIFIED"


def test_a_smooth_joint_counts_for_every_value():
    report = judged(z - c * x**2 * sp.Abs(x), c=(1, 2))
    assert (report.verdict, report.continuity) == ("CERTIFIED", "G2")
    assert {curve.kind for curve in report.curves} <= {"smooth joint"}


@pytest.mark.slow
def test_the_bounds_of_the_curvature_hold_for_every_value():
    low, high = judged(c**2 - SQUARES, c=(1, 2)).curvatures
    assert low <= 0.5 < 1 <= high < 2


def test_boxes_with_ranges_are_cut_in_space_and_across_marked_sides():
    boxes = np.array([[(0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 8.0)]])
    assert halves(boxes).shape == (8, 4, 2)
    assert (halves(boxes)[:, 3] == [0, 8]).all()
    marked = np.array([[False, True, False, True]])
    assert cut(boxes, marked)[:, [1, 3]].tolist() == [
        [[0.0, 0.5], [0.0, 4.0]],
        [[0.0, 0.5], [4.0, 8.0]],
        [[0.5, 1.0], [0.0, 4.0]],
        [[0.5, 1.0], [4.0, 8.0]],
    ]


def test_the_simplest_fraction():
    third = Fraction(1, 3)
    assert simplest_between(third, third) == third
    assert simplest_between(Fraction(-5, 2), Fraction(-7, 3)) == Fraction(-5, 2)
    generator = np.random.default_rng(20261123)
    for _ in range(50):
        low, high = sorted(Fraction(int(n), 97) for n in generator.integers(-400, 400, 2))
        found = simplest_between(low, high)
        assert low <= found <= high
        below = range(1, found.denominator)
        assert not any((low * q).__ceil__() <= (high * q).__floor__() for q in below)


def test_a_jump_on_a_box_with_letters_that_range_is_left_open():
    """It may be there for some values only; of the value in the middle a report says what it is."""
    a = sp.Symbol("a", real=True)
    step = sp.sign(x - a)
    jump = step + step**2 - 1  # 1 where x > a, else -1; as a sign might have a value of its own, it is no gate
    model = Model(rsym.Shape(jump, (x, y, z), letters={a: 0.25}), {"a": (Fraction(1, 5), Fraction(3, 10))})
    box = ((0.0, 0.5), (0.0, 0.5), (0.0, 0.5))
    kinds = [SheetInspector().inspect(model.over((*box, ends))).kind for ends in ((0.2, 0.3), (0.25, 0.25))]
    assert kinds == ["open", "open"]
    fixed = Model(rsym.Shape(jump.subs(a, sp.Rational(1, 4)), (x, y, z)), {})
    assert SheetInspector().inspect(fixed.over(box)).kind == "leap"
