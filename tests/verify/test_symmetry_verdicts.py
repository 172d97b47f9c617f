"""Verdicts on what is repeated around an axis, and on what stands on mirrors or crosses them, against plane geometry.

Discs and balls at the distance 1 from the axis: neighbours meet if sin(pi/n) is less than the radius, and their meeting
is an edge on a border between sectors. What a mirror cuts through the centre is whole again; what it cuts elsewhere
has an edge there.
"""

import math

import pytest
import sympy as sp
from oracles.tiers import of_the_day

import rsym
from rsym import Shape, x, y, z
from rsym.bounds.balls import ctx
from rsym.verify.boxes.classes import parted
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import PRECISION, Model
from rsym.verify.boxes.polynomials import ring_of
from rsym.verify.cover.surfaces import SheetInspector

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


@pytest.mark.slow
@pytest.mark.parametrize("order", of_the_day([3, 5, 6], 1))
def test_discs_around_a_point(order):
    wide, narrow = R(3, 4), R(2, 5)
    for motif in ("any", "even"):
        assert said(rsym.cyclic(disc(wide), order, motif=motif)) == truth(order, wide)
    assert said(rsym.kaleidoscope(disc(narrow), order)) == truth(order, narrow)


@pytest.mark.slow
@pytest.mark.parametrize("order", of_the_day([2, 5], 1))
def test_a_disc_that_crosses_a_mirror_has_an_edge_there_however_little_it_is_off(order):
    assert said(rsym.kaleidoscope(disc(R(1, 2), (1, R(1, 4))), order)) == ("REFUTED", "G0")
    for off in (R(1, 10**9), R(1, 10**30)):
        assert said(rsym.kaleidoscope(disc(R(2, 5), (1, off)), order), timeout=1)[0] != "CERTIFIED"


NEIGHBOURS = (rsym.kaleidoscope, lambda shape, order: rsym.cyclic(shape, order, motif="any"))


@pytest.mark.slow
@pytest.mark.parametrize("off", [R(1, 10**9), R(1, 10**15)])
def test_neighbours_that_nearly_touch(off):
    """Six discs of half the distance between their centres: a little more is an edge, a little less is none."""
    for made in NEIGHBOURS:
        assert said(made(disc(R(1, 2) + off), 6), timeout=1)[0] not in {"CERTIFIED", "DEGENERATE"}
        assert said(made(disc(R(1, 2) - off), 6), timeout=1)[0] not in {"REFUTED", "DEGENERATE"}


@pytest.mark.slow
def test_neighbours_that_touch():
    for made in NEIGHBOURS:
        assert said(made(disc(R(1, 2)), 6), timeout=1)[0] not in {"CERTIFIED", "REFUTED"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("made", "expected"),
    [
        (lambda: rsym.cyclic(ball(R(1, 2)), 5, motif="any"), ("CERTIFIED", "analytic")),
        (lambda: rsym.kaleidoscope(ball(R(2, 5)), 5), ("CERTIFIED", "analytic")),
        (lambda: rsym.kaleidoscope(ball(R(1, 2), (1, R(1, 4), 0)), 3), ("REFUTED", "G0")),
    ],
)
def test_balls_around_an_axis(made, expected):
    assert said(made(), method="space") == expected


@pytest.mark.slow
def test_a_mirror_that_is_off_by_a_rounding_cuts():
    """A mirror with the root of 3 in 16 digits in its normal: what it reflects is not what it meets."""
    root, slope = R("1.7320508075688772"), sp.sqrt(3)
    beyond = sp.Abs(y - slope * (x - 1)) - (y - slope * (x - 1))

    def reflected(normal):
        there = {x: x - normal / 4 * beyond, y: y + beyond / 4}
        return Shape(disc(R(2, 5)).expression.subs(there, simultaneous=True), (x, y), bounds=FLAT)

    assert said(reflected(slope)) == ("CERTIFIED", "analytic")
    assert said(reflected(root), timeout=5)[0] != "CERTIFIED"


@pytest.mark.parametrize("off", [0, R(1, 10**9), R(1, 10**30)])
def test_an_edge_on_one_mirror_crosses_another_that_the_ball_stands_on(off):
    """The edge lies in z = 0 and crosses x = y at x = 1/2 - sqrt(3/25); only where the fold cancels it is one edge."""
    folded = {x: sp.Max(x, y), y: sp.Min(x, y), z: sp.Abs(z)}
    shape = ball(R(7, 10), (R(1, 2), R(1, 2) + off, R(1, 2)))
    model = Model(shape.replace(expression=shape.expression.subs(folded, simultaneous=True)), {})
    place = 0.5 - math.sqrt(3 / 25)
    box = ((place - 1e-4, place + 1e-4), (place - 1.1e-4, place + 1e-4), (-1e-4, 1.2e-4))
    with ctx.workprec(PRECISION):
        found = SheetInspector().inspect(model.over(box), model.root)
    assert found.kind == ("joined" if off == 0 else "open")
    if found.meeting is not None:
        ring = ring_of(model)
        assert {ring.polynomial(arc.function).as_expr() for arc in found.meeting.arcs} == {
            sp.expand(R(49, 100) - (x - R(1, 2)) ** 2 - (y - R(1, 2)) ** 2 - (z - side) ** 2)
            for side in (R(1, 2), -R(1, 2))
        }


def test_what_jumps_on_the_switch_is_not_parted():
    """Both sides are polynomials that agree on z = 0, where the function itself has another value."""
    folds = sp.Max(x, y) + sp.Min(x, y) + sp.Abs(z)
    for expression, is_parted in ((folds, True), (folds + sp.sign(z) ** 2 - 1, False)):
        model = Model(Shape(expression, (x, y, z)), {})
        local = model.over(((-1, 1),) * 3)
        assert (parted(local, model.root, generators(local, model.root)) is not None) == is_parted


@pytest.mark.slow
def test_a_polyhedron_of_one_leaf_has_edges_between_its_faces():
    largest = rsym.R1.disjunction(*(sp.Abs(form, evaluate=False) for form in (x + y, x - y, 2 * z)))
    report = rsym.verify_smoothness(rsym.Shape(1 - largest, (x, y, z), bounds=((-2, 2),) * 3))
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")
    assert len(report.curves) == 12
    assert len([point for point in report.points if point.kind == "corner"]) == 8
    assert not len(report.undecided)


@pytest.mark.slow
def test_a_half_space_in_all_chambers():
    half = rsym.Shape(R(9, 10) - x / 2 - y / 2, (x, y, z))
    report = rsym.verify_smoothness(rsym.mirror_group(half, "octahedral"), bounds=((-2, 2),) * 3)
    assert (report.verdict, report.continuity) == ("REFUTED", "G0")  # a rhombic dodecahedron
    assert (len(report.curves), len(report.points)) == (24, 14)
