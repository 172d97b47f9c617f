"""Elastic bodies whose state is known: `python tests/opponent/hunt.py elastic`.

Displacements are polynomials and waves, of which loads and tractions are derived, or potentials of Kolosov with poles
in a hole: a plate with a round or an elliptic hole, thick rings, curved beams, turning discs. What is held is held by
the true displacement, the rest is drawn by the true stress. Errors of displacements may be three times the estimate,
those of stresses, where they are worst, three times that of stresses.
"""

from dataclasses import dataclass

import numpy as np
import sympy as sp

import rsym
from opponent.fields import put
from opponent.kolosov import about_ellipse, of_potentials
from opponent.typings import body, cut, rational
from rsym import x, y
from rsym.logic.leaf_names import shape_leaf_parts
from rsym.logic.sign_form import shape_form
from rsym.problems.elastic.solving import BESIDE, corners_of
from rsym.program.raising import raised


@dataclass(frozen=True)
class Case:
    """A body, what it is made of, what it is put to, its displacements and stresses as functions of arrays."""

    family: str
    shape: rsym.Shape
    conditions: dict
    given: dict
    moved: object
    stresses: object

    def __str__(self):
        return f"{self.shape.expression} {self.conditions} {self.given}"


def material(random):
    """Young's modulus and Poisson's ratio, and whether it is plane stress."""
    young = [sp.Integer(1), sp.Integer(7), 2 + sp.sin(x), 1 + x**2 + y**2][random.integers(4)]
    poisson = [sp.Rational(3, 10), sp.S.Zero, sp.Rational(9, 20), sp.Rational(49, 100), sp.Rational(-1, 5)]
    return young, poisson[random.integers(5)], ("stress", "strain")[random.integers(2)]


def stress(u, v, young, poisson, plane):
    """The stresses xx, yy, xy of displacements."""
    xx, yy, xy = sp.diff(u, x), sp.diff(v, y), (sp.diff(u, y) + sp.diff(v, x)) / 2
    if plane == "strain":
        young, poisson = young / (1 - poisson**2), poisson / (1 - poisson)
    c = young / (1 - poisson**2)
    return c * (xx + poisson * yy), c * (yy + poisson * xx), young / (1 + poisson) * xy


def any_displacement(random):
    """Polynomials or waves."""
    a, b, c, d = (rational(random, -2, 2) for _ in range(4))
    if random.random() < 0.5:
        return a * x**3 + b * x * y + c * y, b * y**3 - d * x**2 * y + a * x
    return sp.sin((1 + a) * x + b * y) + c * x, sp.cos(b * x + y) * sp.exp(d * y / 3)


def normal(leaf):
    """The outward one on the boundary of a leaf."""
    slope = [sp.diff(leaf, one) for one in (x, y)]
    length = sp.sqrt(slope[0] ** 2 + slope[1] ** 2)
    return [-one / length for one in slope]


def pulled(leaf, found):
    """The traction on a leaf, of stresses."""
    (p, q), (xx, yy, xy) = normal(leaf), found
    return rsym.traction((xx * p + xy * q, xy * p + yy * q))


def leaves_of(shape):
    """By the names of parts, and all of them."""
    form = shape_form(shape)
    leaves = [raised(form.builder.nodes, leaf) for leaf in form.leaves]
    parts = shape_leaf_parts(shape)
    return {part[-1]: leaf for part, leaf in zip(parts, leaves, strict=True)}, leaves


def parts_at_random(random, shape, found, u, v):
    """The conditions: parts are held as u and v have it, or drawn; one at least is held."""
    named, leaves = leaves_of(shape)
    if not shape.parts:
        beside = sp.Mul(*leaves) if len(leaves) < 4 else 0
        return {...: {"x": u + beside * (1 + x), "y": v - beside}}
    names = sorted(named)
    held = {names[random.integers(len(names))]} | {name for name in names if random.random() < 0.4}
    return {name: {"x": u, "y": v} if name in held else pulled(named[name], found) for name in names}


def holed(random):
    """A ring or a square plate with a hole, whose sides are parts, and the radius of the hole."""
    a, b = rational(random, 1.2, 2), rational(random, 0.3, 0.8)
    hole = rsym.disc(b).named("bore")
    if random.random() < 0.5:
        return rsym.disc(a).named("rim") - hole, b
    sides = [rsym.half_plane(n, -a).named(k) for k, n in (("l", (1, 0)), ("r", (-1, 0)), ("t", (0, -1)), ("b", (0, 1)))]
    return sides[0] & sides[1] & sides[2] & sides[3] - hole, b


def quarter(shape):
    """What is right of and above the axes."""
    return shape & rsym.half_plane((1, 0), 0).named("left") & rsym.half_plane((0, 1), 0).named("below")


def case(seed):
    """The case of a seed."""
    random = np.random.default_rng(seed)
    way = ("any", "any", "typed", "potentials", "known", "beam", "ellipse")[random.integers(7)]
    if way == "ellipse":
        return elliptic(random)
    young, poisson, plane = material(random)
    pull, other = rational(random, 0.2, 1), rational(random, -1, 1)
    if way in ("potentials", "known", "beam"):
        young = sp.Integer(7)
        shape, r = holed(random)
        some = lambda powers: {n: rational(random, -1, 1) for n in powers}  # noqa: E731
        phi, psi = some([-2, -1, 1, 2, 3]), some([-3, -2, -1, 1, 2])
        if way == "known":  # a plate that is pulled, or a ring under pressure
            phi, psi = {1: pull / 4, -1: pull * r**2 / 2}, {1: -pull / 2, -1: -pull * r**2 / 2, -3: pull * r**4 / 2}
            phi, psi = (phi, psi) if random.random() < 0.5 else ({1: pull}, {-1: other})
        if way == "beam":
            phi, psi = {"log": pull, 1: other}, some([-1])
            shape = quarter(rsym.disc(r + 1).named("rim") - rsym.disc(r).named("bore"))
        u, v = of_potentials(phi, psi, young, poisson, plane)
    else:
        kind, shape = body(random)
        u, v = any_displacement(random)
        if way == "typed":
            shape, way = cut(random, shape), f"typed {kind}"
        elif random.random() < 0.7 and kind in ("disc", "ellipse"):
            line = rsym.half_plane([(1, 0), (0, 1), (3, 4)][random.integers(3)], rational(random, -0.4, 0.4))
            shape = shape.named("body") & line.named("cut")
        else:
            way = f"any {kind}"
    found = stress(u, v, young, poisson, plane)
    conditions = parts_at_random(random, shape, found, u, v)
    loads = [-sp.diff(found[0], x) - sp.diff(found[2], y), -sp.diff(found[2], x) - sp.diff(found[1], y)]
    if way in ("potentials", "known", "beam"):
        loads = [0, 0]
    given = {"young": young, "poisson": poisson, "plane": plane, "loads": loads, "cells": int(random.integers(12, 29))}
    moved, stresses = (sp.lambdify((x, y), list(one), "numpy") for one in ((u, v), found))
    return Case(way, shape, conditions, given, moved, stresses)


def elliptic(random):
    """A quarter of a plate with an elliptic hole, pulled far away along x or y."""
    a, b, edge = rational(random, 0.55, 1), rational(random, 0.2, 0.5), rational(random, 1.5, 3)
    stresses = about_ellipse(float(a), float(b), random.integers(2))
    sides = rsym.half_plane((-1, 0), -edge).named("right") & rsym.half_plane((0, -1), -edge).named("above")
    shape = quarter(sides - rsym.ellipse(a, b).named("hole"))
    along = [rsym.traction([lambda p, q, k=k: stresses(p, q)[k] for k in pair]) for pair in ((0, 2), (2, 1))]
    conditions = {"left": rsym.roller(), "below": rsym.roller(), "right": along[0], "above": along[1]}
    given = {"young": 7, "poisson": sp.Rational(3, 10), "cells": int(random.integers(20, 41))}
    return Case("ellipse", shape, conditions, given, None, stresses)


def asked(case):
    """The word and what is wrong."""

    def question():
        found = rsym.elasticity(case.shape, case.conditions, **case.given)
        rule, rows = found.rule, []
        if case.moved is not None:
            truth = np.array([np.broadcast_to(one, len(rule.points)) for one in case.moved(*rule.points.T)])
            apart = np.sum((found.jets(rule.points)[:, 0] - truth) ** 2, axis=0)
            largest = np.sqrt(np.max(np.sum(truth**2, axis=0)))
            rows.append((np.sqrt(np.sum(rule.weights * apart) / rule.weights.sum()) / largest, found.report.estimate))
        points = np.vstack([rule.points, rule.boundary.points])
        for corner in corners_of(found.body)[1]:
            points = points[np.hypot(*(points - corner).T) > BESIDE * rule.grid.size]
        truth = np.array([np.broadcast_to(one, len(points)) for one in case.stresses(*points.T)])
        rows.append((np.abs(found.stresses(points)[:3] - truth).max() / np.abs(truth).max(), found.report.stress))
        return rows

    return put(question)
