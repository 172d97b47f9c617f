"""Singular curves of bodies, traced: known curves, known angles, known jumps of curvature."""

import itertools
import math
from collections import defaultdict

import numpy as np
import sympy as sp
from closeness import assert_close

import rsym
from rsym import Shape, x, y, z
from rsym.codegen.balls import ctx
from rsym.verify.bodies.continuation import cross
from rsym.verify.bodies.tracing import trace
from rsym.verify.generators import generators
from rsym.verify.joints import meeting
from rsym.verify.local import Model
from rsym.verify.locus import reduce


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


def traced(expression, size, letters=None, smallest=1e-2, middle=(0, 0, 0)):
    """All curves of a shape within a cube, off centre so that no face lies on a plane of symmetry."""
    model = Model(Shape(expression, (x, y, z), letters={}), letters or {})
    bounds = tuple((c - size * 0.51, c + size * 0.49) for c in middle)
    boxes = groups(model, bounds, smallest)
    return [curve for met, own in boxes.items() for curve in trace(model, met, ("first", "second"), own, extent=size)]


def test_the_rim_of_a_cut_ball():
    (rim,) = traced(rsym.conjunction(1 - x**2 - y**2 - z**2, z - sp.Rational(1, 2)), 2.5)
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
    # The ball lies to the left, seen from outside: below the plane's normal the curve runs clockwise around z.
    steps = np.cross(rim.points[:-1], rim.points[1:])[:, 2]
    assert (np.sign(steps) == np.sign(steps[0])).all()
    assert_close(rim.normals[:, 0], rim.points, atol=1e-14)
    left = np.cross(rim.normals[:-1, 0], np.diff(rim.points, axis=0))
    assert (left[:, 2] > 0).all()
