"""Rules of integration on shapes in the plane: areas, lengths, parts against exact values."""

import math

import numpy as np
import pytest
import sympy as sp
from oracles.arcs import exact, random_tree, shape_of
from scipy.integrate import quad
from scipy.special import ellipe

import rsym
from rsym import conjunction, disjunction, x, y
from rsym.backends import kernel as kernels
from rsym.sampling.kernels import mesher_kernels
from rsym.sampling.rules.division import Grading
from rsym.sampling.rules.quadrature import prepared

SEEDS = (1, 2, 5, 10, 12, 13, 14, 22, 26, 29, 30, 31, 34, 36, 37, 39, 3, 7, 17, 64)


def plane(expression, **more):
    return rsym.Shape(expression, (x, y), **more)


def errors(shape, area, length, **more):
    rule = rsym.quadrature(shape, **more)
    assert rule.weights.min() >= 0
    assert rule.boundary.weights.min() >= 0
    return abs(rule.weights.sum() - area), abs(rule.boundary.weights.sum() - length)


def test_ellipse_has_its_area_and_length():
    rule = rsym.quadrature(plane(1 - x**2 / 4 - y**2))
    assert abs(rule.weights.sum() / (2 * math.pi) - 1) <= 1e-15
    assert abs(rule.boundary.weights.sum() / (8 * ellipe(3 / 4)) - 1) < 1e-14
    assert rule.unresolved == 0
    found = rule.boundary
    assert np.allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-15)
    assert abs((found.weights * (found.points * found.normals).sum(axis=1)).sum() / (4 * math.pi) - 1) < 1e-14


@pytest.mark.parametrize(
    "seed", [seed if k < 5 else pytest.param(seed, marks=pytest.mark.slow) for k, seed in enumerate(SEEDS)]
)
def test_random_trees_have_their_areas_and_lengths(seed):
    leaves, tree = random_tree(seed)
    area, lengths = exact(leaves, tree)
    rule = rsym.quadrature(shape_of(leaves, tree), cells=24)
    assert abs(rule.weights.sum() / float(area) - 1) < 1e-12
    for number, length in enumerate(lengths):
        part = f"leaf {number}"
        found = rule.boundary.of(part).weights.sum() if part in rule.parts else 0.0
        assert abs(found - float(length)) < 1e-11


@pytest.mark.parametrize("cells", [4, 8, 11])
def test_sides_along_the_grid_are_counted_once(cells):
    shape = plane(disjunction(conjunction(x, y, 2 - x, 1 - y), conjunction(x, y, 1 - x, 2 - y)))
    rule = rsym.quadrature(shape, cells=cells, bounds=((0, 2), (0, 2)), near=[(1, 1)])
    assert abs(rule.weights.sum() - 3) < 1e-14
    lengths = [rule.boundary.of(part).weights.sum() for part in rule.parts[:6]]
    assert np.allclose(lengths, [2, 2, 1, 1, 1, 1], atol=1e-14)
    assert abs(rule.boundary.weights.sum() - 8) < 1e-14


@pytest.mark.parametrize("turn", [1e-16, math.pi / 2, 1e-13, 1e-12, 1e-9, 1e-6])
def test_what_is_turned_by_hardly_anything_keeps_the_length_of_its_sides(turn):
    """Where two sides meet neither axis is across both: a side that a rounding inclines lost most of a cell there."""
    for shape, area, length in (
        (rsym.rectangle(3, 1), 3, 8),
        (rsym.disc(1) & rsym.half_plane((0, 1), 0), math.pi / 2, math.pi + 2),
    ):
        off = errors(shape.rotate(turn), area, length, cells=9, order=12)
        assert max(off) < 1e-12, (turn, off)


@pytest.mark.parametrize("cells", [8, 9])
def test_a_side_between_two_insides_is_no_boundary(cells):
    both = disjunction(conjunction(x, 1 - x, y, 1 - y), conjunction(x - 1, 2 - x, y, 2 - y))
    assert max(errors(plane(both), 3, 8, cells=cells, bounds=((0, 2), (0, 2)))) < 1e-14


def test_full_cells_have_the_plain_rule_and_all_are_sorted():
    rule = rsym.quadrature(plane(1 - x**2 - y**2), cells=8, order=3)
    assert (np.diff(rule.cells) >= 0).all()
    assert (np.diff(rule.boundary.cells) >= 0).all()
    nodes = (np.polynomial.legendre.leggauss(3)[0] + 1) / 2
    lower, _ = rule.grid.corners(rule.full)
    for cell, corner in zip(rule.full, lower.T, strict=True):
        points = rule.points[rule.cells == cell]
        plain = corner + rule.grid.size * np.stack(np.meshgrid(nodes, nodes, indexing="ij"), -1).reshape(-1, 2)
        assert np.allclose(points, plain, atol=1e-14)
    assert set(rule.full) < set(rule.touched)


def test_cells_are_graded_towards_points():
    square = plane(conjunction(x, y, 1 - x, 1 - y))
    rule = rsym.quadrature(square, cells=4, near=[(0.3, 0.6)])
    distance = np.abs(rule.points - [0.3, 0.6]).max(axis=1)
    assert distance.min() < 1e-8
    # r**(-1) is integrated over the square, by polar coordinates about the point.
    sides = ((0.3, 0.6, 0.4), (0.7, 0.6, 0.4), (0.6, 0.3, 0.7), (0.4, 0.3, 0.7))
    truth = sum(d * (math.asinh(a / d) + math.asinh(b / d)) for d, a, b in sides)
    assert abs((rule.weights / np.linalg.norm(rule.points - [0.3, 0.6], axis=1)).sum() - truth) < 1e-7
    assert abs(rule.weights.sum() - 1) < 1e-14


def test_where_integrals_fall_towards_a_point_rules_are_smaller():
    """The integral of r**(e - 2) over a square of side 2 about 0 is 8/e times that of (1/cos t)**e up to pi/4."""
    square = prepared(plane(conjunction(1 - x**2, 1 - y**2)), None, None)
    for exponent, share in ((4 / 3, 0.4), (4.0, 0.2)):
        truth = 8 / exponent * quad(lambda t, e=exponent: math.cos(t) ** -e, 0, math.pi / 4, epsabs=1e-14)[0]
        known = Grading(np.zeros((1, 2)), np.array([exponent]))
        found, whole = (square.rule(3, 8, near) for near in (known, np.zeros((1, 2))))
        for rule in (found, whole):
            radius = np.linalg.norm(rule.points, axis=1)
            assert abs(np.sum(rule.weights * radius ** (exponent - 2)) / truth - 1) < 2e-9
            assert abs(rule.weights.sum() - 4) < 1e-13
        # Eight plain cells around that which is graded.
        assert len(found.weights) - 8 * 64 < share * (len(whole.weights) - 8 * 64)


def test_what_touches_crosses_or_ends_in_points():
    circles = plane(conjunction(1 - (x + 1) ** 2 - y**2, 1 - x**2 - (y + 1) ** 2))  # no axis serves at a corner
    assert max(errors(circles, math.pi / 2 - 1, math.pi, cells=8)) < 1e-12
    kissing = plane(disjunction(1 - x**2 - y**2, 1 - (x - 2) ** 2 - y**2))
    area, length = errors(kissing, 2 * math.pi, 4 * math.pi, cells=16)
    assert area < 1e-13
    assert length < 4e-7  # so long two discs that touch are one to rounding
    inner = plane(conjunction(1 - x**2 - y**2, (x - 0.5) ** 2 + y**2 - 0.25))
    assert errors(inner, 0.75 * math.pi, 3 * math.pi, cells=16)[0] < 1e-13
    cusp = plane(conjunction(x**3 - y**2, 1 - x), bounds=((-0.5, 1.5), (-1.5, 1.5)))
    assert errors(cusp, 0.8, 2 + 2 * (13 * math.sqrt(13) - 8) / 27, cells=16) < (2e-12, 1e-10)
    node = plane(2 * (x**2 - y**2) - (x**2 + y**2) ** 2)
    lemniscate = 2 * math.sqrt(2) * 2.622057554292119
    assert max(errors(node, 2, lemniscate, cells=16)) < 1e-10


def test_the_last_pieces_at_a_cusp_hold_no_more_boundary_than_their_sides():
    """A deltoid: where its gradient is nearly 0 a piece of a side of 1e-13 held a length of 46."""
    square = x**2 + y**2
    deltoid = plane(27 - square**2 - 18 * square + 8 * (x**3 - 3 * x * y**2), bounds=((-4, 4), (-4, 4)))
    with pytest.warns(rsym.RsymWarning, match="not resolved where its boundary has cusps"):
        found = rsym.measure(deltoid)
    assert abs(found.boundary - 16) < found.boundary.error < 2
    assert abs(found.content - 2 * math.pi) < found.content.error


def test_small_and_thin_things_are_found():
    speck = plane(1e-8 - (x - 0.3) ** 2 - (y - 0.03) ** 2, bounds=((-1, 1), (-1, 1)))
    rule = rsym.quadrature(speck, cells=4)
    assert abs(rule.weights.sum() / (math.pi * 1e-8) - 1) < 1e-10
    wall = plane(conjunction(1 - x**2 - y**2, x**2 + y**2 - (1 - 1e-6) ** 2))
    area, length = errors(wall, math.pi * (2e-6 - 1e-12), 2 * math.pi * (2 - 1e-6), cells=8)
    assert area < 1e-15
    assert length < 1e-13
    # A parabola that meets the upper side of a cell twice, close to each other.
    grazing = plane(conjunction(0.25 + 1e-9 - 2 * (x - 0.13) ** 2 - y, y), bounds=((-1, 1), (-1, 1)))
    root = math.sqrt((0.25 + 1e-9) / 2)
    assert errors(grazing, 4 / 3 * (0.25 + 1e-9) * root, 0, cells=8)[0] < 1e-14


def test_kinks_inside_of_leaves_are_seen():
    diamond = plane(1 - abs(x) - abs(y)).named("diamond") & plane(y + 0.5).named("cut")
    rule = rsym.quadrature(diamond, cells=9, bounds=((-1, 1), (-1, 1)))
    assert abs(rule.weights.sum() - 1.75) < 1e-14
    assert abs(rule.boundary.of("diamond").weights.sum() - 3 * math.sqrt(2)) < 1e-14
    assert abs(rule.boundary.of("cut").weights.sum() - 1) < 1e-14


def test_bounds_cap_the_shape():
    rule = rsym.quadrature(plane(x**2 + y**2 - 1), bounds=((-2, 2), (-2, 3)), cells=16)
    assert abs(rule.weights.sum() - (20 - math.pi)) < 1e-13
    caps = [rule.boundary.of(f"cap {name}").weights.sum() for name in ("x lower", "x upper", "y lower", "y upper")]
    assert np.allclose(caps, [5, 5, 4, 4], atol=1e-13)
    empty = rsym.quadrature(plane(-1 - x**2 - y**2), bounds=((-2, 2), (-2, 2)))
    assert len(empty.weights) == len(empty.boundary.weights) == len(empty.full) == 0


def test_what_cannot_be_resolved_is_told():
    rule = rsym.quadrature(plane(conjunction(1 - x**2 - y**2, (x - y) ** 2)), cells=8)
    assert abs(rule.weights.sum() - math.pi) < rule.unresolved < 0.1


def test_the_system_the_normal_form_and_motions_change_nothing():
    leaves, tree = random_tree(1)
    rules = [rsym.quadrature(shape_of(leaves, tree, system), cells=8) for system in (rsym.R0, rsym.R1)]
    normal = rsym.quadrature(rsym.normalise(shape_of(leaves, tree)), cells=8)
    for other in (rules[1], normal):
        assert np.array_equal(other.points, rules[0].points)
        assert np.array_equal(other.weights, rules[0].weights)
    moved = rsym.quadrature(shape_of(leaves, tree).rotate(0.4).translate(3, 1), cells=16)
    assert abs(moved.weights.sum() / rules[0].weights.sum() - 1) < 1e-12


def test_letters_move_and_nothing_is_compiled(monkeypatch):
    r = sp.Symbol("r", real=True)
    ring = plane(conjunction(1 - x**2 - y**2, (x - r) ** 2 + y**2 - r**2), letters={r: rsym.Letter(0.25)})
    rsym.quadrature(ring, cells=8)

    def refused(*_, **__):
        raise AssertionError("something is compiled")

    monkeypatch.setattr(mesher_kernels, "FormCode", refused)
    monkeypatch.setattr(kernels, "make_function", refused)
    rule = rsym.quadrature(ring, cells=8, letters={"r": 0.375})
    assert abs(rule.weights.sum() - math.pi * (1 - 0.375**2)) < 1e-12


def test_threads_change_no_bit():
    leaves, tree = random_tree(3)
    one, four = (rsym.quadrature(shape_of(leaves, tree), cells=300, order=2, threads=count) for count in (1, 4))
    assert np.array_equal(one.points, four.points)
    assert np.array_equal(one.weights, four.weights)
    assert np.array_equal(one.boundary.points, four.boundary.points)


FOLDS = [
    pytest.param(x - sp.Rational(1, 7), 0.3673469387755102, id="between sides of cells"),
    pytest.param(x - sp.Rational(1, 2), 0.125, id="along them"),
    pytest.param(x + 2 * y - 1, 0.5833333333333334, id="askew"),
    pytest.param((x - sp.Rational(1, 2)) ** 2 + (y - sp.Rational(1, 2)) ** 2 - sp.Rational(1, 10), None, id="a circle"),
]


@pytest.mark.parametrize(("fold", "wanted"), FOLDS)
@pytest.mark.parametrize("cells", [1, 4, 6])
def test_rules_end_and_begin_on_folds_which_bound_nothing(fold, wanted, cells):
    square = plane(conjunction(x, 1 - x, y, 1 - y))
    rule = prepared(square, ((-0.01, 1.01), (-0.01, 1.01)), None, (fold,)).rule(cells, 6)
    values = sp.lambdify((x, y), fold)(*rule.points.T) * np.ones(len(rule.points))
    if wanted is None:  # where it is negative, a disc of the area pi/10, less pi/200 of the integral over all
        wanted = 1 / 6 - 1 / 10 + math.pi / 200
        assert abs(rule.weights[values < 0].sum() - math.pi / 10) < 1e-9
    assert abs(rule.weights @ np.maximum(values, 0) - wanted) < 1e-12
    assert abs(rule.weights.sum() - 1) < 1e-14
    assert abs(rule.boundary.weights.sum() - 4) < 1e-14
    assert set(rule.boundary.leaves) == set(rsym.quadrature(square, cells=cells, order=6).boundary.leaves)


def test_rules_of_one_fold_are_not_those_of_another():
    square = plane(conjunction(x, 1 - x, y, 1 - y))
    for where in (sp.Rational(1, 7), sp.Rational(2, 7)):
        rule = prepared(square, ((0, 1), (0, 1)), None, (x - where,)).rule(4, 6)
        assert abs(rule.weights[rule.points[:, 0] < where].sum() - where) < 1e-14


def test_refusals():
    disc = plane(1 - x**2 - y**2).named("disc")
    rule = rsym.quadrature(disc, cells=4)
    assert rule.boundary.of("disc").weights.sum() == rule.boundary.weights.sum()
    with pytest.raises(rsym.RsymError, match="disc"):
        rule.boundary.of("rim")
    with pytest.raises(rsym.RsymError, match="bounds"):
        rsym.quadrature(plane(x**2 + y**2 - 1))
    with pytest.raises(rsym.RsymError, match="bounds"):
        rsym.quadrature(plane(x))
    for wrong in ({"cells": 0}, {"order": 1.5}, {"near": [1, 2, 3]}):
        with pytest.raises(rsym.RsymError):
            rsym.quadrature(disc, **wrong)


def test_a_leaf_that_is_divided_by_nothing_is_refused_and_not_divided_for_ever():
    r = sp.Symbol("r", real=True)
    hole = rsym.disc(r, letters={r: 0.25}).translate(0.5, 0).named("hole")
    plate = (rsym.disc(1) - hole).replace(bounds=((-1.1, 1.1), (-1.1, 1.1)))
    with pytest.raises(rsym.RsymError, match="hole is infinite or undefined"):
        rsym.quadrature(plate, cells=4, order=2, letters={"r": 0})
    # A point that is left out of a disc is none.
    point = plane((x - 0.3) ** 2 + (y - 0.01) ** 2)
    assert rsym.quadrature(rsym.disc(1) & point, cells=8).weights.sum() == pytest.approx(math.pi, abs=1e-12)
