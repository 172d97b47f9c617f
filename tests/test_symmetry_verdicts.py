"""Verdicts on what is repeated around an axis, and on what stands on mirrors or crosses them, against plane geometry.

Discs and balls at the distance 1 from the axis: neighbours meet if sin(pi/n) is less than the radius, and their meeting
is an edge on a border between sectors. What a mirror cuts through the centre is whole again; what it cuts elsewhere
has an edge there.
"""

import math

import pytest
import sympy as sp

import rsym
from rsym import Shape, x, y, z

R = sp.Rational
FLAT, DEEP = ((-2, 2),) * 2, ((-2, 2),) * 3


def disc(radius, centre=(1, 0)):
    return Shape(radius**2 - (x - centre[0]) ** 2 - (y - centre[1]) ** 2, (x, y), bounds=FLAT)


def ball(radius, centre=(1, 0, 0)):
    far = sum((symbol - place) ** 2 for symbol, place in zip((x, y, z), centre, strict=True))
    return Shape(radius**2 - far, (x, y, z), bounds=DEEP)


def said(shape, **options):
    report = rsym.verify_smoothness(shape, **options)
    return report.verdict, report.continuity


def truth(order, radius):
    return ("REFUTED", "G0") if math.sin(math.pi / order) < radius else ("CERTIFIED", "analytic")


@pytest.mark.parametrize("order", [3, 5, 6, 7])
def test_discs_around_a_point(order):
    wide, narrow = R(3, 4), R(2, 5)
    for motif in ("any", "even"):
        assert said(rsym.cyclic(disc(wide), order, motif=motif)) == truth(order, wide)
    assert said(rsym.kaleidoscope(disc(narrow), order)) == truth(order, narrow)


@pytest.mark.parametrize("order", [2, 5])
def test_a_disc_that_crosses_a_mirror_has_an_edge_there_however_little_it_is_off(order):
    assert said(rsym.kaleidoscope(disc(R(1, 2), (1, R(1, 4))), order)) == ("REFUTED", "G0")
    for off in (R(1, 10**9), R(1, 10**30)):
        assert said(rsym.kaleidoscope(disc(R(2, 5), (1, off)), order), timeout=3)[0] != "CERTIFIED"


@pytest.mark.parametrize("off", [R(1, 10**9), R(1, 10**15)])
def test_neighbours_that_nearly_touch(off):
    """Six discs of half the distance between their centres: a little more is an edge, a little less is none."""
    for made in (rsym.kaleidoscope, lambda shape, order: rsym.cyclic(shape, order, motif="any")):
        assert said(made(disc(R(1, 2) + off), 6), timeout=3)[0] not in {"CERTIFIED", "DEGENERATE"}
        assert said(made(disc(R(1, 2) - off), 6), timeout=3)[0] not in {"REFUTED", "DEGENERATE"}
        assert said(made(disc(R(1, 2)), 6), timeout=3)[0] not in {"CERTIFIED", "REFUTED"}


@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (lambda: rsym.cyclic(ball(R(3, 4)), 6, motif="any"), ("REFUTED", "G0")),
        (lambda: rsym.cyclic(ball(R(1, 2)), 5, motif="any"), ("CERTIFIED", "analytic")),
        (lambda: rsym.kaleidoscope(ball(R(2, 5)), 5), ("CERTIFIED", "analytic")),
        (lambda: rsym.kaleidoscope(ball(R(1, 2), (1, R(1, 4), 0)), 3), ("REFUTED", "G0")),
    ],
)
def test_balls_around_an_axis(made, expected):
    assert said(made(), method="space") == expected


def test_a_mirror_that_is_off_by_a_rounding_cuts():
    """A mirror with the root of 3 in 16 digits in its normal: what it reflects is not what it meets."""
    root, slope = R("1.7320508075688772"), sp.sqrt(3)
    beyond = sp.Abs(y - slope * (x - 1)) - (y - slope * (x - 1))

    def reflected(normal):
        there = {x: x - normal / 4 * beyond, y: y + beyond / 4}
        return Shape(disc(R(2, 5)).expression.subs(there, simultaneous=True), (x, y), bounds=FLAT)

    assert said(reflected(slope)) == ("CERTIFIED", "analytic")
    assert said(reflected(root), timeout=5)[0] != "CERTIFIED"
