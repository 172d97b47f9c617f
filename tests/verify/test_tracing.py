"""Singular curves of bodies, traced: known curves, known angles, known jumps of curvature."""

import itertools
import math
import re
from collections import defaultdict
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import Shape, x, y, z
from rsym.bounds.balls import arb, ctx
from rsym.program.lowering import lower
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.joints import meeting
from rsym.verify.boxes.krawczyk import refined, unique_zero
from rsym.verify.boxes.local import Model
from rsym.verify.boxes.locus import reduce
from rsym.verify.curves import components, following
from rsym.verify.curves.continuation import ZeroCurve, cross
from rsym.verify.curves.tracing import trace

BALL = 1 - x**2 - y**2 - z**2
HALF = sp.Rational(1, 2)
CUBE = rsym.conjunction(rsym.conjunction(1 - x**2, 1 - y**2), 1 - z**2)


def two_sheets(model, box):
    """The meeting on a box grown by a quarter; None where nothing is singular, False where that stays open."""
    grown = model.over(tuple((a - (b - a) / 4, b + (b - a) / 4) for a, b in box[:3]) + box[3:])
    locus = reduce(grown, model.root)
    if locus.kind == "none" or reduce(model.over(box), model.root).kind == "none":
        return None
    found = generators(grown, locus.nodes[0]) if locus.kind == "leaf" else None
    if found is not None and found.analytic:
        return None
    met = meeting(grown, locus, found)
    for arc in met.arcs if met else ():
        product = cross(grown.gradient(arc.function), grown.gradient(arc.side))
        if not (generators(grown, arc.function).analytic and generators(grown, arc.side).analytic):
            return False
        if all(component.contains(0) for component in product):
            return False
    return met or False


def groups(model, bounds, smallest=1e-2):
    """The boxes of an octree by the two sheets that meet in them."""
    found, level = defaultdict(list), [bounds]
    with ctx.workprec(80):
        while level:
            box = level.pop(0)
            met = two_sheets(model, box)
            if met:
                found[met].append(box)
            elif met is False and box[0][1] - box[0][0] > smallest:
                middles = [(a + b) / 2 for a, b in box[:3]]
                halves = [((a, m), (m, b)) for (a, b), m in zip(box, middles, strict=False)]
                level += [(*part, *box[3:]) for part in itertools.product(*halves)]
    return found


def traced(expression, size, *, letters=None, smallest=1e-2, keep=lambda box: True, corners=(), symbols=()):
    """All curves of a shape within a cube, off centre so that no face lies on a plane of symmetry."""
    shape = Shape(expression, (x, y, z), letters=dict.fromkeys(symbols, 0.5))
    model = Model(shape, letters or {})
    found = groups(model, ((-size * 0.51, size * 0.49),) * 3, smallest)
    kept = [(met, [box for box in boxes if keep(box)]) for met, boxes in found.items()]
    return [
        curve
        for met, boxes in kept
        for curve in trace(model, met, ("first", "second"), boxes, extent=size, corners=corners)
    ]


def all_along(curve):
    """The enclosure of the jump between the points too."""
    low, high = re.search(r"all along .* between (\S+) and (\S+?)(?: degrees)?;", curve.reason).groups()
    return float(low), float(high)


def test_the_rim_of_a_cut_ball():
    (rim,) = traced(rsym.conjunction(BALL, z - HALF), 2.5)
    assert rim.traced
    assert rim.proved
    assert rim.closed
    assert (rim.kind, rim.continuity) == ("edge", "G0")
    assert 32 <= len(rim.points) <= 300
    assert rim.radius <= 1e-12
    assert_close(rim.points[:, 2], np.full(len(rim.points), 0.5), atol=1e-15)
    assert_close(np.hypot(*rim.points[:, :2].T), np.full(len(rim.points), math.sqrt(0.75)), atol=1e-15)
    assert_close(rim.length, 2 * math.pi * math.sqrt(0.75), rtol=1e-3)
    assert_close(rim.tangent_jump, 120, atol=1e-12)
    assert 0 < rim.tangent_jump_error < 1e-12
    assert_close(rim.dihedral_angles, np.full(len(rim.points), 60.0), atol=1e-12)
    low, high = all_along(rim)
    assert 110 < low < 120 < high < 130
    # The ball lies to the left, seen from outside: below the plane's normal the curve runs clockwise around z.
    steps = np.cross(rim.points[:-1], rim.points[1:])[:, 2]
    assert (np.sign(steps) == np.sign(steps[0])).all()
    assert_close(rim.normals[:, 0], rim.points, atol=1e-14)
    left = np.cross(rim.normals[:-1, 0], np.diff(rim.points, axis=0))
    assert (left[:, 2] > 0).all()


@pytest.mark.slow
def test_the_curve_of_viviani_but_for_its_node():
    """The unit sphere and a cylinder through its axis meet at the angle acos(x); both loops end at the node."""
    curves = traced(rsym.conjunction(BALL, HALF**2 - (x - HALF) ** 2 - y**2), 2.5, smallest=0.02)
    assert len(curves) == 2
    for loop in curves:
        assert loop.traced
        assert loop.proved
        assert not loop.closed
        a, b, c = loop.points.T
        assert_close(a**2 + b**2 + c**2, np.ones(len(a)), atol=4e-15)
        assert_close((a - 0.5) ** 2 + b**2, np.full(len(a), 0.25), atol=2e-15)
        assert_close(loop.tangent_jumps, np.degrees(np.arccos(a)), atol=1e-6)
        assert (np.sign(c) == np.sign(c[0])).all()
        assert a[[0, -1]].min() > 0.98
        assert loop.length > 3.7
    assert {math.copysign(1, loop.points[1, 2]) for loop in curves} == {1, -1}


def test_a_curve_ends_on_the_face_where_it_leaves_the_boxes():
    """In the boxes on the right the rim is an arc: one coordinate of its ends is a side of a box, the others follow."""
    sides = set()

    def right(box):
        if box[0][0] >= 0:
            sides.update(*box[:2])
        return box[0][0] >= 0

    (arc,) = traced(rsym.conjunction(BALL, z - HALF), 2.5, keep=right)
    assert arc.traced
    assert not arc.closed
    for end in arc.points[[0, -1]]:
        assert sides & set(end[:2])
        assert_close(np.hypot(end[0], end[1]), math.sqrt(0.75), atol=1e-15)
    assert arc.points[:, 0].min() >= 0


@pytest.mark.slow
def test_the_edges_of_a_cube_end_in_its_corners():
    corners = [
        (tuple((value - 0.06, value + 0.06) for value in point), SingularPoint(point, 1e-15, "corner", "G0"))
        for point in itertools.product((-1.0, 1.0), repeat=3)
    ]
    edges = traced(CUBE, 3.2, corners=corners, smallest=0.06)
    assert len(edges) == 12
    assert all(edge.traced and edge.proved and edge.kind == "edge" for edge in edges)
    for edge in edges:
        assert_close(np.abs(edge.points[[0, -1]]), np.ones((2, 3)), atol=1e-15)
        assert_close(edge.length, 2, rtol=1e-12)
        assert_close(edge.tangent_jump, 90, atol=1e-9)


def test_a_capsule_has_two_circles_where_its_curvature_jumps():
    circles = traced(HALF**2 - y**2 - z**2 - sp.Max(sp.Abs(x) - 1, 0) ** 2, 3.3)
    assert sorted(float(circle.points[0, 0]) for circle in circles) == [-1, 1]
    for circle in circles:
        assert circle.traced
        assert circle.proved
        assert circle.closed
        assert (circle.kind, circle.continuity) == ("curvature jump", "G1")
        assert circle.tangent_jump == 0
        assert_close(circle.curvature_jumps, np.full(len(circle.points), 2.0), atol=1e-9)
        assert abs(circle.curvature_jump - 2) <= circle.curvature_jump_error < 1e-9
        low, high = all_along(circle)
        assert 1.5 < low < 2 < high < 2.5
        assert_close(np.hypot(*circle.points[:, 1:].T), np.full(len(circle.points), 0.5), atol=1e-12)


def test_the_jump_across_an_oblique_joint():
    """-2*c*u**2 more in the second derivatives on one side, u oblique: a jump of 2*c*(b . grad u)**2/|grad F|."""
    u = x + y / 2 - z / 3 + sp.Rational(1, 5)
    (joint,) = traced(1 - x**2 - 2 * y**2 - 3 * z**2 - sp.Rational(3, 4) * sp.Max(u, 0) ** 2, 2.5)
    assert joint.proved
    assert joint.continuity == "G1"
    gradient, switch = -2 * joint.points * [1, 2, 3], np.array([1, 1 / 2, -1 / 3])
    size = np.linalg.norm(gradient, axis=1)[:, None]
    assert_close(joint.normals, np.stack([-gradient / size] * 2, axis=1), atol=1e-12)
    along = np.cross(gradient, switch)
    b = np.cross(along / np.linalg.norm(along, axis=1)[:, None], -gradient / size)
    assert_close(joint.curvature_jumps, 1.5 * (b @ switch) ** 2 / size[:, 0], atol=1e-12)
    assert_close(joint.curvature_jump, joint.curvature_jumps.max(), atol=1e-12)


@pytest.mark.slow
def test_fillets_end_in_a_jump_of_one_over_the_radius_or_smoothly():
    def borders(continuity):
        system = rsym.Rho(sp.Rational(3, 4), continuity=continuity)
        return traced(rsym.conjunction(1 - x, 1 - y, system=system), 3.1)

    rounded = borders("G1")
    places = sorted(tuple(border.points[0, :2]) for border in rounded)
    assert_close(places, [[0.25, 1], [1, 0.25]], atol=1e-12)
    for border in rounded:
        assert border.proved
        assert (border.kind, border.continuity) == ("curvature jump", "G1")
        assert_close(border.curvature_jump, 4 / 3, atol=1e-9)
        assert_close(np.sort(border.points[[0, -1], 2]), [-3.1 * 0.51, 3.1 * 0.49], atol=1e-12)
    for border in borders("G2"):
        assert border.traced
        assert border.proved
        assert (border.kind, border.continuity) == ("smooth joint", "G2")
        assert border.curvature_jump == border.tangent_jump == 0


def test_what_agrees_to_many_digits_is_not_called_proved():
    nothing = sp.sin(1) ** 2 + sp.cos(1) ** 2 - 1
    (circle,) = traced(BALL + sp.Abs(x - sp.Rational(1, 8)) * nothing, 2.5)
    assert circle.traced
    assert not circle.proved
    assert (circle.kind, circle.continuity) == ("smooth joint", "G2")
    assert "no proof" in circle.reason


def test_a_letter_that_ranges_moves_the_rim():
    a = sp.Symbol("a", real=True)
    letters = {"a": (Fraction(1, 2), Fraction(501, 1000))}
    (rim,) = traced(rsym.conjunction(BALL, z - a), 2.5, letters=letters, symbols=(a,))
    assert rim.traced
    assert rim.proved
    assert rim.closed
    for height in (0.5, 0.501):
        near = rim.points * [1, 1, 0]
        near *= math.sqrt(1 - height**2) / np.linalg.norm(near, axis=1)[:, None]
        near[:, 2] = height
        assert (np.linalg.norm(near - rim.points, axis=1) <= rim.radius).all()
        angle = math.degrees(math.acos(-height))
        assert abs(rim.tangent_jump - angle) <= rim.tangent_jump_error


@pytest.mark.slow
def test_each_part_of_a_range_has_a_rim_of_its_own():
    a = sp.Symbol("a", real=True)
    shape = Shape(rsym.conjunction(BALL, z - a), (x, y, z), letters={a: 0.5})
    model = Model(shape, {"a": (Fraction(1, 2), Fraction(502, 1000))})
    parts = ((0.5, 0.501), (0.501, 0.502))
    found = [groups(model, (*((-1.275, 1.225),) * 3, part)) for part in parts]
    (met,) = found[0]
    rims = trace(model, met, ("ball", "plane"), [box for one in found for box in one[met]], extent=2.5)
    assert_close([rim.points[0, 2] for rim in rims], [0.5005, 0.5015], atol=1e-12)
    assert all(rim.traced and rim.closed and rim.radius < 2e-3 for rim in rims)


def test_krawczyk_in_space():
    """x = y, z = 2 x, |p| = 1."""

    def values(point):
        u, v, w = point
        return [u - v, w - 2 * u, u**2 + v**2 + w**2 - 1]

    def jacobian(point):
        u, v, w = point
        return [[arb(1), arb(-1), arb(0)], [arb(-2), arb(0), arb(1)], [2 * u, 2 * v, 2 * w]]

    zero = unique_zero(values, jacobian, (arb(0.4, 0.1), arb(0.4, 0.1), arb(0.8, 0.1)))
    assert zero.exists
    narrow = refined(values, jacobian, zero.box)
    assert_close([float(side.mid()) for side in narrow], np.array([1, 1, 2]) / math.sqrt(6), atol=1e-15)
    assert all(float(arb(side.rad())) < 1e-14 for side in narrow)
    assert not unique_zero(values, jacobian, (arb(2, 0.1),) * 3).exists


@pytest.mark.slow
def test_circles_that_are_close_are_told_apart():
    circles = traced(rsym.conjunction(BALL, z**2 - sp.Rational(1, 2500)), 2.5, smallest=3e-3)
    assert all(circle.traced and circle.closed for circle in circles)
    heights = sorted(float(circle.points[0, 2]) for circle in circles)
    assert_close(heights, [-0.02, 0.02], atol=1e-15)
    for circle in circles:
        assert_close(circle.points[:, 2], np.full(len(circle.points), circle.points[0, 2]), atol=1e-15)
        assert_close(circle.length, 2 * math.pi * math.sqrt(1 - 0.02**2), rtol=1e-3)


def test_what_is_not_accounted_for_is_said(monkeypatch):
    monkeypatch.setattr(components, "_PARTS", 1)
    curves = traced(rsym.conjunction(BALL, z - HALF), 2.5)
    assert not any(curve.traced for curve in curves)
    assert any(curve.kind == "unresolved" and len(curve.points) == 1 for curve in curves)
    assert any("stay open" in curve.reason for curve in curves)


def test_a_closed_curve_may_be_met_from_both_ends(monkeypatch):
    monkeypatch.setattr(following, "_MOST", 100)
    (rim,) = traced(rsym.conjunction(BALL, z - HALF), 2.5)
    assert rim.traced
    assert rim.closed
    assert_close(rim.length, 2 * math.pi * math.sqrt(0.75), rtol=1e-3)
    monkeypatch.setattr(following, "_MOST", 50)
    assert not any(curve.traced for curve in traced(rsym.conjunction(BALL, z - HALF), 2.5))


def test_what_is_found_beside_an_end_continues_what_was_followed():
    """A circle of which first one half is sought, then the other: one closed curve, each half followed once."""
    model = Model(Shape(x, (x, y, z)), {})
    pair = [lower(model.builder, expression) for expression in (x**2 + y**2 - 1, z + x / 4)]
    left, right = (((low, low + 1.5), (-1.5, 1.5), (-0.5, 0.5)) for low in (-1.5, 0.0))
    with ctx.workprec(128):
        curve = ZeroCurve(model, (pair[0], pair[1]), [], 3.0)
        search = components.Search(curve, [left], ())
        search.account(left)
        (half,) = search.components
        search.ground = components.Search(curve, [left, right], ()).ground
        search.account(right)
        (whole,) = search.components
    assert not search.open
    assert (half.ends, whole.ends) == (("face", "face"), ("closed", "closed"))
    assert {id(knot) for knot in half.knots} <= {id(knot) for knot in whole.knots}
    assert len(whole.tubes) == len(whole.knots) - 1
    assert whole.knots[0] is whole.knots[-1]
    turns = [math.atan2(knot.middle[1], knot.middle[0]) for knot in whole.knots]
    steps = [(b - a + math.pi) % (2 * math.pi) - math.pi for a, b in itertools.pairwise(turns)]
    assert math.isclose(abs(sum(steps)), 2 * math.pi)
