"""Polygons against winding numbers: hundreds of random outlines, each edge once, normalised along every edge."""

from itertools import chain

import numpy as np
import pytest
import sympy as sp
from oracles import outlines
from oracles.boundary_points import Expansion, assert_normalised, random_motion
from oracles.closeness import assert_close

import rsym
from rsym import R1, Rp, RsymError, x, y
from rsym.model.nodes import Fold
from rsym.model.primitives.outlines import Junction, monotone_formula
from rsym.model.primitives.polygons import polygon, regular_polygon

ELL = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
# A bay between two towers, wider at the bottom than at the top: its walls, prolonged, meet above it.
DOVETAIL = [(0, 0), (7, 0), (7, 3), (4, 3), (6, 1), (1, 1), (3, 3), (0, 3)]
KINDS = {
    outlines.star: (8, 30, 120),
    outlines.untangled: (5, 9, 16, 30),
    outlines.spiral: (14, 40, 110),
    outlines.comb: (8, 24, 120),
    outlines.blocks: (4, 12, 30, 90),
}
OUTLINES = [(kind, size) for kind, sizes in KINDS.items() for size in sizes]


def drawn(kind, size, seed):
    corners = kind(np.random.default_rng([seed, size]), size)
    return corners[::-1] if seed % 2 else corners


def counterclockwise(corners):
    following = np.roll(corners, -1, axis=0)
    area = np.sum(corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0])
    return corners if area > 0 else corners[::-1]


def turning(corners):
    """Without the straight ones, of which only blocks have some."""
    before, after = np.roll(corners, 1, axis=0), np.roll(corners, -1, axis=0)
    (ax, ay), (bx, by) = (corners - before).T, (after - corners).T
    return corners[abs(ax * by - ay * bx) > 1e-9]


def around(corners, count, seed=0):
    low, high = corners.min(axis=0), corners.max(axis=0)
    return low + (1.2 * np.random.default_rng(seed).random((count, 2)) - 0.1) * (high - low)


def truth(formula, corners, points):
    """The formula in logic: on the left of an edge, and, or."""
    if not isinstance(formula, Junction):
        (ax, ay), (bx, by) = corners[formula], corners[(formula + 1) % len(corners)]
        return (bx - ax) * (points[:, 1] - ay) > (by - ay) * (points[:, 0] - ax)
    parts = [truth(branch, corners, points) for branch in formula.branches]
    return np.all(parts, axis=0) if formula.common else np.any(parts, axis=0)


def edges_of(formula):
    if not isinstance(formula, Junction):
        return [formula]
    return list(chain.from_iterable(map(edges_of, formula.branches)))


def half_planes(expression):
    if not isinstance(expression, Fold):
        return [expression]
    return list(chain.from_iterable(map(half_planes, expression.operands)))


@pytest.mark.random
@pytest.mark.parametrize(("kind", "size"), OUTLINES)
def test_the_formula_is_the_polygon_and_has_every_edge_once(kind, size):
    for seed in range(30):
        corners = turning(counterclockwise(drawn(kind, size, seed)))
        formula, shared = monotone_formula([tuple(map(float, corner)) for corner in corners])
        points = around(corners, 400, seed)
        assert (truth(formula, corners, points) == outlines.inside(corners, points)).all()
        dropped = [second for _, second in shared]
        assert sorted([*edges_of(formula), *dropped]) == list(range(len(corners)))
        if kind not in (outlines.comb, outlines.blocks):
            assert not dropped


@pytest.mark.random
@pytest.mark.parametrize(("kind", "size"), OUTLINES)
def test_omega_is_positive_inside_and_normalised_along_every_edge(kind, size):
    corners = drawn(kind, size, 4)
    shape = polygon(corners)
    points = around(corners, 1000)
    value = rsym.compile(shape)(*points.T)["value"]
    assert ((value > 0) == outlines.inside(corners, points)).all()
    shares = np.random.default_rng(5).uniform(0.1, 0.9, (3, len(corners), 1))
    edges = (corners + shares * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 2).astype(np.longdouble)
    on_edges, gradient = Expansion(shape).value_and_gradient(edges)
    assert_close(on_edges, np.zeros(len(edges)), atol=1e-14 * np.abs(corners).max())
    # The points lie on the edges to 1e-16 only; near corners that counts a hundredfold and more.
    assert_close(np.hypot(*gradient.T), np.ones(len(edges)), atol=1e-10)


@pytest.mark.random
@pytest.mark.parametrize("corners", [ELL, DOVETAIL, DOVETAIL[::-1]], ids=["ell", "dovetail", "clockwise"])
@pytest.mark.parametrize(("system", "order"), [(rsym.R0, 1), (R1, 4), (Rp(4), 3)])
def test_normalised_to_the_order_of_the_system(corners, system, order):
    for seed in range(2):
        moved = random_motion(polygon(corners, system=system), seed)
        assert_normalised(moved, order, seed=seed, clearance=0.02, higher_tolerance=1e-7)


def test_edges_on_one_line_share_their_half_plane():
    assert polygon(DOVETAIL).expression.operands.count(3 - y) == 1
    assert len(half_planes(polygon(DOVETAIL).expression)) == 7


def test_convex_polygons_are_conjunctions():
    corners = [(int(100 * np.cos(t)), int(100 * np.sin(t))) for t in np.linspace(0, 6, 40)]
    assert len(polygon(corners).expression.args) == 40
    regular = regular_polygon(17).expression
    assert len(half_planes(regular)) == 17
    assert regular.atoms(Fold) == regular.atoms(type(regular))


def test_either_way_round_from_any_corner_and_in_any_container():
    expected = set(half_planes(polygon(ELL).expression))
    for corners in (ELL[::-1], ELL[3:] + ELL[:3], [*ELL, ELL[0]], sp.Matrix(ELL), tuple(map(list, ELL)), np.array(ELL)):
        assert set(half_planes(polygon(corners).expression)) == expected
    halved = [ELL[0], (1, 0), *ELL[1:], (0, 1)]
    assert set(half_planes(polygon(halved).expression)) == expected
    assert polygon(np.array(ELL) / 4.0).box.ends == ((-0.05, 0.55), (-0.05, 0.55))


def test_letters_stay_letters():
    a, b = sp.symbols("a b", real=True)
    shape = polygon([(0, 0), (a, 0), (a, 1), (b, 1), (b, a), (0, a)], letters={a: 2, b: 1})
    assert set(shape.letters) == {"a", "b"}
    assert set(half_planes(shape.expression)) == {y, a - x, 1 - y, b - x, a - y, x}
    assert_normalised(random_motion(shape, 3), 1)
    changed = rsym.compile(shape)
    corners = np.array([(0, 0), (3, 0), (3, 1), (0.5, 1), (0.5, 3), (0, 3)])
    points = around(corners, 500)
    assert ((changed(*points.T, letters={a: 3, b: 0.5})["value"] > 0) == outlines.inside(corners, points)).all()


@pytest.mark.random
@pytest.mark.parametrize("sides", [3, 4, 5, 7, 12])
def test_regular_polygons(sides):
    radius, u = sp.symbols("r u", real=True)
    shape = regular_polygon(sides, radius, (u, 1), letters={radius: 1.5, u: -2})
    angles = 2 * np.pi * np.arange(sides) / sides
    corners = np.stack([1.5 * np.cos(angles) - 2, 1.5 * np.sin(angles) + 1], axis=1)
    points = around(corners, 500)
    value = rsym.compile(shape)(*points.T)["value"]
    assert ((value > 0) == outlines.inside(corners, points)).all()
    room = 0.1 * np.ptp(corners, axis=0).max()
    assert_close(np.transpose(shape.box.ends), [corners.min(axis=0) - room, corners.max(axis=0) + room], atol=1e-12)
    assert_normalised(random_motion(shape, sides), 1, clearance=1e-3)
    assert_normalised(regular_polygon(sides, 2, system=R1), 4, clearance=1e-4)


HIGH = sp.Symbol("h", real=True)


@pytest.mark.parametrize(
    ("points", "letters", "message"),
    [
        ([(0, 0), (1, 0)], None, "three corners or more"),
        ("corners", None, "sequence of corners"),
        (3, None, "sequence of corners"),
        ([(0, 0), (1, 0), 5], None, "corner 3"),
        ([(0, 0), (1, 0), (0, 1, 2)], None, "corner 3"),
        ([(0, 0), (1, 0), (1, 0), (0, 1)], None, "twice"),
        ([(0, 0), (1, 0), (2, 0), (3, 0)], None, "turns back"),
        ([(0, 0), (2, 0), (1, 0), (1, 1)], None, "turns back"),
        ([(0, 0), (2, 2), (2, 0), (0, 2)], None, "cross or touch"),
        ([(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)], None, "cross or touch"),
        ([(0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1)], None, "cross or touch"),
        ([(0, 0), (HIGH, 0), (0, 1)], None, "no value"),
        ([(0, 0), (1, HIGH), (2, 0), (1, 2)], {HIGH: 0}, "lie on one line"),
        (
            [(0, 0), (3, 0), (3, 1), (2, 1), (2, 0.5), (1, 0.5), (1, HIGH), (0, HIGH)],
            {HIGH: 1},
            "one line",
        ),
    ],
)
def test_what_is_no_simple_polygon_is_refused(points, letters, message):
    with pytest.raises(RsymError, match=message):
        polygon(points, letters=letters)


def test_floors_of_bays_may_differ_by_letters_that_agree_at_their_defaults():
    g, h = sp.symbols("g h", real=True)
    corners = [(0, 0), (5, 0), (5, 2), (4, 2), (4, g), (3, g), (3, 2), (2, 2), (2, h), (1, h), (1, 2), (0, 2)]
    shape = polygon(corners, letters={g: 1, h: 1})
    value = rsym.compile(shape)
    assert value(3.5, 0.8, letters={g: 0.5})["value"] < 0 < value(1.5, 0.8, letters={g: 0.5})["value"]


def test_numbers_for_the_sides_are_whole():
    for sides in (2, 3.5, "six"):
        with pytest.raises(RsymError, match="number of sides"):
            regular_polygon(sides)
    with pytest.raises(RsymError, match="radius must be positive"):
        regular_polygon(6, -1)


def test_outlines_of_the_oracle():
    square = np.array([(0, 0), (2, 0), (2, 2), (0, 2)])
    assert outlines.inside(square, [(1, 1), (3, 1), (-1, 1), (1, -1)]).tolist() == [True, False, False, False]
    assert half_planes(rsym.conjunction(x, rsym.disjunction(y, -x))) == [x, y, -x]


SYMMETRIC = {
    "rectangle": ([(0, 0), (2, 0), (2, 1), (0, 1)], "xy"),
    "triangle": ([(0, 0), (2, 0), (1, 3)], "x"),
    "T": ([(0, 0), (1, 0), (1, 2), (2, 2), (2, 3), (-1, 3), (-1, 2), (0, 2)], "x"),
    "plus": ([(1, 0), (2, 0), (2, 1), (3, 1), (3, 2), (2, 2), (2, 3), (1, 3), (1, 2), (0, 2), (0, 1), (1, 1)], "xy"),
    "H": ([(0, 0), (1, 0), (1, 2), (2, 2), (2, 0), (3, 0), (3, 5), (2, 5), (2, 3), (1, 3), (1, 5), (0, 5)], "xy"),
    "arrow": ([(0, 0), (2, 1), (0, 2), (0.5, 1)], "y"),
}


@pytest.mark.parametrize("name", SYMMETRIC)
def test_a_symmetric_polygon_is_an_even_motif(name):
    """R_0 is not associative: in the order of the edges omega would differ from its mirror image by a tenth."""
    corners, axes = SYMMETRIC[name]
    middle = [(min(axis) + max(axis)) / 2 for axis in zip(*corners, strict=True)]
    made = polygon(corners).translate(-middle[0], -middle[1])
    for axis in (x, y):
        if axis.name in axes:
            rows = rsym.row(made, 10, axis=axis, count=2)
            places = {x: 0, y: 0, axis: 10}
            assert rows.contains(places[x], places[y]) == made.contains(0, 0)
        else:
            with pytest.raises(RsymError, match="must be even"):
                rsym.row(made, 10, axis=axis, count=2)


@pytest.mark.random
@pytest.mark.parametrize("sides", range(3, 13))
def test_a_regular_polygon_is_an_even_motif(sides):
    made = regular_polygon(sides, 2)
    rsym.row(made, 10, axis=y)
    rsym.row(made.rotate(sp.pi / 2), 10)
    if sides % 2 == 0:
        rsym.grid(made, (10, 10))
    if sides in (4, 8):  # all mirrors
        rsym.grid(made.rotate(sp.pi / sides), (10, 10))
    angle = 2 * np.pi * np.arange(sides) / sides
    corners = list(zip(2 * np.cos(angle), 2 * np.sin(angle), strict=True))
    u, v = np.random.default_rng(4).uniform(-3, 3, (2, 500))
    assert (made.contains(u, v) == polygon(corners).contains(u, v)).all()
