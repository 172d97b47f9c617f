"""Parts without a value somewhere, and steps: what is measured, meshed, sampled, drawn and proved of them."""

import math
import warnings

import numpy as np
import pytest
import sympy as sp
from matplotlib.figure import Figure
from oracles.closeness import assert_close

import rsym
from rsym import Shape, x, y, z
from rsym.logic.sign_form import shape_form
from rsym.sampling.boundary_distances import boundary_distances

pytestmark = pytest.mark.filterwarnings("ignore:omega has no value:rsym.RsymWarning")
PARTIAL = {"sqrt": sp.sqrt(x - 2), "log": sp.log(x - 2), "asin": sp.asin(x - 4), "root": (x - 2) ** sp.Rational(1, 3)}
A = sp.Symbol("a", real=True)
WINDOW = ((-3, 1.5), (-3, 3))
BALL = 1 - x**2 - y**2 - z**2
CUBE = ((-1.5, 1.5),) * 3
STEPS = {
    "sign": sp.sign(BALL),
    "piecewise": sp.Piecewise((1, BALL > 0), (-1, True)),
    "strict": sp.Piecewise((0, BALL <= 0), (1, True)),
    "sum": 2 * sp.sign(BALL) + x / 2,
    "nested": sp.Piecewise((sp.Piecewise((1, z < 5), (-1, True)), BALL > 0), (-1, True)),
}


EXPONENTS = {"letter": A, "irrational": sp.sqrt(2), "varying": y, "wave": sp.cos(3 * x)}


@pytest.mark.parametrize("name", EXPONENTS)
def test_a_power_without_a_value_deletes_no_disc(name):
    """Of negative bases a power has a value where its exponent is whole: that of a letter may be."""
    power = EXPONENTS[name]
    shape = rsym.disc(1) | Shape((x - 0.5) ** power - 1 - y, (x, y), letters={A: 2.5} if power is A else {})
    points = np.random.default_rng(1).uniform(-3, 3, (2, 2000))
    for value in (2.5, 2.0, 3.0, 0.5) if power is A else (0.0,):
        exponents = np.broadcast_to(sp.lambdify((x, y, A), power)(*points, value), 2000)
        with np.errstate(invalid="ignore"):
            other = (points[0] - 0.5) ** exponents - 1 - points[1] > 0  # NaN is not
        found = shape.contains(*points, letters={"a": value} if power is A else None)
        assert (found == (other | (np.hypot(*points) < 1))).all()


@pytest.mark.parametrize("name", PARTIAL)
def test_the_measure_of_a_disc_beside_a_part_without_a_value(name):
    found = rsym.measure(rsym.disc(1) | Shape(PARTIAL[name] - y, (x, y)), bounds=WINDOW)
    assert_close([found.area, found.length], [np.pi, 2 * np.pi], rtol=1e-11)


@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
def test_the_measure_of_what_ends_with_its_domain():
    found = rsym.measure(Shape(sp.sqrt(9 - x**2) - y, (x, y), bounds=((-4, 4), (-1, 4))))
    assert_close(found.area, 4.5 * np.pi + 6, rtol=1e-9)
    assert found.area.error < 1e-6
    assert_close(found.length, 3 * np.pi + 6, rtol=1e-8)  # with the cap below, without the ends of the domain


DISC = 1 - x**2 - y**2
WHOLE = {
    "root": (sp.sqrt(DISC) + 1, math.pi),
    "factor": (sp.sqrt(DISC * (2 + x**2)) + 1, math.pi),
    "arc": (sp.acos(x**2 + y**2) + 1, math.pi),
    "other arc": (sp.asin(x**2 + y**2) + 2, math.pi),
    "quotient": (sp.sqrt(DISC / (2 + y**2)) + 1, math.pi),
    "gate": (sp.sqrt(sp.Min(1 - x**2, 1 - y**2)) + 1, 4.0),
    "conjunction": (sp.sqrt(rsym.conjunction(DISC, x + 2)) + 1, math.pi),
}


@pytest.mark.parametrize("name", WHOLE)
def test_where_a_domain_ends_is_no_boundary_however_it_is_written(name):
    """Factors above 0 are stripped of leaves, and minima are gates: what is left of the domain is still its end."""
    expression, area = WHOLE[name]
    shape = Shape(expression, (x, y), bounds=((-3, 3),) * 2)
    with pytest.warns(rsym.RsymWarning, match="not counted as boundary"):
        found = rsym.measure(shape)
    assert_close(found.area, area, rtol=1e-9)
    assert (found.length, len(rsym.level_lines(shape, resolution=32))) == (0, 0)


@pytest.mark.parametrize(
    "other", [sp.sqrt(DISC) + 1, sp.sqrt(2 * DISC) + 1, sp.sqrt(DISC * (2 + x**2)) + 1, sp.acos(x**2 + y**2) + 1]
)
def test_the_end_of_a_domain_that_is_a_face_too_is_boundary(other):
    """Where both must hold; where one will do omega is above 0 up to there, and unknown beyond."""
    for operands in ((other, DISC), (DISC, other)):
        shape = Shape(rsym.conjunction(*operands), (x, y), bounds=((-2, 2),) * 2)
        assert_close(rsym.measure(shape).length, 2 * math.pi, rtol=1e-9)
        assert len(rsym.level_lines(shape, resolution=16)) == 1
        shape = Shape(rsym.disjunction(*operands), (x, y), bounds=((-2, 2),) * 2)
        with pytest.warns(rsym.RsymWarning, match="not counted as boundary"):
            assert rsym.measure(shape).length == 0
        assert len(rsym.level_lines(shape, resolution=16)) == 0


HALF = sp.Rational(3, 2)
# On x = 0 a part ends where it is positive, and where it is negative omega of the union is zero.
UNIONS = {
    "an end": (sp.Rational(3, 4) - x**HALF / 2, 8),
    "a face": (-sp.Rational(3, 4) - x**HALF / 2, 12),
    "by halves": (y - x**HALF / 2, 10),
    "as a choice": (sp.Piecewise((sp.Rational(3, 4), x > 0)), 8),
    "by value": (sp.Rational(3, 4) + sp.log(1 + sp.sqrt(sp.exp(x) - 1)), 8),
}


@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize("name", UNIONS)
def test_a_union_ends_where_a_part_of_it_does_on_a_face_of_the_other(name):
    part, length = UNIONS[name]
    for operands in ((part, x), (x, part)):
        shape = Shape(rsym.disjunction(*operands), (x, y)) & rsym.rectangle(4, 4)
        found = rsym.measure(shape)
        assert_close((found.area, found.length), (8, length), rtol=2e-6)
        lines = rsym.level_lines(shape, resolution=40).lines
        assert sum(np.linalg.norm(np.diff(line, axis=0), axis=1).sum() for line in lines) == pytest.approx(
            length, abs=0.1
        )
        solid = rsym.measure(Shape(rsym.disjunction(*operands), (x, y, z)) & rsym.box(4, 4, 2))
        assert_close((solid.volume, solid.surface), (16, 2 * length + 16), rtol=1e-5)


def test_points_and_distances_know_where_a_union_ends():
    part = y - x**HALF / 2
    shape = Shape(rsym.disjunction(part, x), (x, y)) & rsym.rectangle(4, 4)
    points = rsym.sample(shape, 1000, over="boundary", rng=1).points
    there = points[np.abs(points[:, 0]) < 1e-12]
    assert there[:, 1].max() < 0
    assert len(there) == pytest.approx(200, abs=4 * math.sqrt(160))  # 2 of a length of 10
    radius = sp.Symbol("radius")
    for join, missing in ((rsym.conjunction, 0), (rsym.disjunction, 1)):
        disc = radius**2 - x**2 - y**2
        whole = Shape(join(sp.sqrt(disc) + 1, disc), (x, y), letters={radius: 1})
        found, _ = boundary_distances(whole, ["radius"], points / 2, 10.0)(np.array([1.0]))
        assert np.isnan(found).mean() == missing


@pytest.mark.parametrize(
    ("radius", "gap", "cells"), [(0.4, 0.012, 64), (0.39, 0.00036, 50), (0.23, 0.006, 33), (0.5, -0.0012, 33)]
)
def test_a_hole_beside_the_end_of_a_domain_is_a_circle(radius, gap, cells):
    radius, gap = map(sp.nsimplify, (radius, gap))
    place = (1 - radius - gap) * sp.Matrix([3, 4]) / 5
    shape = Shape(sp.sqrt(DISC) + 1, (x, y)) - rsym.disc(radius, tuple(place))
    (line,) = rsym.level_lines(shape, resolution=cells, bounds=((-3, 3),) * 2)
    away = line - np.array(place, float).ravel()
    np.testing.assert_allclose(np.hypot(*away.T), float(radius), rtol=1e-9)
    turn = abs(np.diff(np.unwrap(np.arctan2(*away.T))).sum())
    far, r = float(1 - radius - gap), float(radius)
    missing = 0 if gap > 0 else 2 * math.acos((1 - far**2 - r**2) / (2 * far * r))
    assert turn == pytest.approx(2 * math.pi - missing, rel=1e-9)


@pytest.mark.parametrize("name", PARTIAL)
def test_the_mesh_of_a_ball_beside_a_part_without_a_value(name):
    beside = rsym.sphere(1) | Shape(PARTIAL[name] - z, (x, y, z))
    box = (*WINDOW[:1], (-2, 2), (-2, 2))
    mesh, alone = (rsym.mesh(one, 24, bounds=box) for one in (beside, rsym.sphere(1)))
    assert mesh.status.closed
    assert_close([mesh.volume, mesh.area], [alone.volume, alone.area], rtol=1e-12)
    one, other = (Shape(shape.expression, (x, y, z), bounds=box) for shape in (beside, rsym.sphere(1)))
    view = rsym.Camera(target=(0, 0, 0))
    picture, plain = (rsym.render(shape, size=(40, 30), camera=view) for shape in (one, other))
    assert np.abs(np.asarray(picture.pixels, int) - np.asarray(plain.pixels, int)).max() <= 1


def test_points_are_drawn_in_a_body_beside_a_part_without_a_value():
    drawn = rsym.sample(rsym.sphere(1) | Shape(sp.sqrt(x - 2) - z, (x, y, z)), 300, rng=1, bounds=((-2, 1.9),) * 3)
    assert (np.linalg.norm(drawn.points, axis=1) <= 1).all()


@pytest.mark.parametrize("name", STEPS)
def test_a_step_in_space_is_its_condition(name):
    shape = Shape(STEPS[name], (x, y, z), bounds=CUBE)
    found = rsym.measure(shape)
    assert_close([found.volume, found.surface], [4 * np.pi / 3, 4 * np.pi], rtol=1e-10)
    assert rsym.mesh(shape, 16).status.closed
    assert shape.contains([0, 0.99, 1.01], 0, 0).tolist() == [True, True, False]


def test_a_step_in_the_plane_is_its_condition():
    found = rsym.measure(Shape(sp.sign(1 - x**2 - y**2), (x, y), bounds=((-1.5, 1.5),) * 2))
    assert_close([found.area, found.length], [np.pi, 2 * np.pi], rtol=1e-12)
    within = sp.And(x > 0, y > 0, x + y < 1)
    for triangle in (sp.Piecewise((1, within), (-1, True)), sp.Piecewise((-1, sp.Not(within)), (1, True))):
        found = rsym.measure(Shape(triangle, (x, y), bounds=((-0.5, 1.5),) * 2))
        assert_close([found.area, found.length], [0.5, 2 + np.sqrt(2)], rtol=1e-12)


def test_no_boundary_is_seen_where_both_sides_of_a_step_are_inside():
    """Discs of radii 1 and 2 to the right and to the left of x = 0, where two lines of length 1 bound."""
    halves = sp.Piecewise((1 - x**2 - y**2, x > 0), (4 - x**2 - y**2, True))
    shape = Shape(halves, (x, y), bounds=((-2.5, 2.5),) * 2)
    found = rsym.measure(shape)
    assert_close([found.area, found.length], [2.5 * np.pi, 3 * np.pi + 2], rtol=1e-10)
    (line,) = rsym.level_lines(shape, resolution=64)
    assert np.abs(line[None] - np.array([[[0, 1]], [[0, -1]], [[0, 2]], [[0, -2]]])).sum(-1).min(1).max() < 1e-12


@pytest.mark.parametrize(
    ("expression", "verdict"),
    [
        (rsym.disc(1).expression, "CERTIFIED"),
        (sp.sign(1 - x**2 - y**2), "CERTIFIED"),
        (sp.Piecewise((1, x**2 + y**2 < 1), (-1, True)), "CERTIFIED"),
        (sp.Piecewise((1 - x**2 - y**2, x > 0), (2 - 2 * x**2 - 2 * y**2, True)), "CERTIFIED"),
        (sp.Piecewise((1, (x > 0) & (y > 0) & (x + y < 1)), (-1, True)), "REFUTED"),
        (sp.Piecewise((1 - x**2 - y**2, x > 0), (4 - x**2 - y**2, True)), "REFUTED"),
    ],
)
def test_verdicts_of_steps_and_beside_parts_without_a_value(expression, verdict):
    window = ((-2.5, 2.5), (-2.5, 2.5))
    assert rsym.verify_smoothness(Shape(expression, (x, y), bounds=window)).verdict == verdict
    beside = rsym.disjunction(expression, sp.log(x - 3) - y)
    assert rsym.verify_smoothness(Shape(beside, (x, y), bounds=window)).verdict == verdict


POLES = {
    "reciprocal": (1 / x - y, 2),
    "tangent": (sp.tan(x) - y, 3),
    "quotient": ((x**2 + y**2 - 1) / x, 2),
    "even": (1 / x**2 - y, 2),
    "two": (1 / x + 1 / (x - 1) - y, 3),
}


@pytest.mark.parametrize("name", POLES)
def test_a_pole_is_no_boundary(name):
    expression, count = POLES[name]
    lines = rsym.level_lines(Shape(expression, (x, y), bounds=((-4, 4), (-4, 4))), resolution=200)
    assert len(lines) == count
    assert (lines.status.kept, lines.status.unresolved_corners) == (0, 0)
    value = rsym.compile(Shape(expression, (x, y)), ("value", "gradient"))(*np.concatenate(list(lines)).T)
    distance = np.abs(value["value"]) / np.linalg.norm(value["gradient"], axis=1)
    assert np.nanmax(distance) < 1e-12


def test_the_measure_of_a_body_with_a_pole():
    with pytest.warns(rsym.RsymWarning, match="at a pole"):
        found = rsym.measure(Shape((x**2 + y**2 - 1) / x, (x, y)), bounds=((-2, 2), (-2, 2)))
    assert_close(found.area, 8.0, rtol=1e-12)
    assert_close(sum(length for name, length in found.parts.items() if "cap" not in name), 2 * np.pi, rtol=1e-12)


JUMPS = {
    "measure": lambda: rsym.measure(Shape(sp.floor(x) - y, (x, y)), bounds=((-2, 2), (-2, 2))),
    "points": lambda: rsym.sample(Shape(sp.floor(x) - y, (x, y)), 9, over="boundary", bounds=((-2, 2), (-2, 2))),
    "mod": lambda: rsym.measure(Shape(sp.Mod(x, 1) - sp.Rational(1, 2), (x, y)), bounds=((-2, 2), (-2, 2))),
    "mesh": lambda: rsym.mesh(Shape(sp.floor(x) - z, (x, y, z)), 16, bounds=CUBE),
    "rays": lambda: rsym.render(Shape(sp.floor(x) - z, (x, y, z), bounds=CUBE), size=(16, 12)),
}


@pytest.mark.parametrize("name", JUMPS)
def test_jumps_that_cannot_be_traced_are_refused(name):
    with pytest.raises(rsym.RsymError, match="cannot be traced") as refusal:
        JUMPS[name]()
    assert refusal.value.code == "jump"


def test_lines_of_jumps_that_cannot_be_traced_are_right_at_their_vertices_and_told():
    jump = Shape(sp.floor(1 - x**2 - y**2) + sp.Rational(1, 2), (x, y), bounds=((-1.3, 1.2), (-1.3, 1.2)))
    with pytest.warns(rsym.RsymWarning, match="jumps with a floor or a Mod"):
        (line,) = rsym.level_lines(jump, resolution=48)
    assert np.abs(np.hypot(*line.T) - 1).max() < 1e-12


def test_where_both_sides_of_a_step_are_one_leaf_there_is_one():
    """Beside the step two equal leaves took turns, and corners were sought between them: 22.4 for 2 pi."""
    disc = 1 - x**2 - y**2
    for one, other in ((2 * disc, disc), (disc, disc * (1 + y**2))):
        shape = Shape(sp.Piecewise((one, x > 0), (other, True)), (x, y), bounds=((-2, 2), (-2, 2)))
        lines = rsym.level_lines(shape, resolution=64)
        assert_close(lines.length, 2 * np.pi, rtol=1e-3)
        assert lines.status.unresolved_corners == 0


@pytest.mark.parametrize(
    "step",
    [
        sp.Heaviside(1 - x**2 - y**2) - sp.Rational(1, 2),
        2 * sp.Heaviside(1 - x**2 - y**2) - 1,
        sp.Piecewise((1, sp.And(sp.Ne(x, sp.Rational(1, 2)), x**2 + y**2 < 1)), (-1, True)),
    ],
)
def test_other_words_for_a_disc(step):
    found = rsym.measure(Shape(step, (x, y)), bounds=((-2, 2), (-2, 2)))
    assert_close([found.area, found.length], [np.pi, 2 * np.pi], rtol=1e-12)


GAP = rsym.disc(1) | Shape(sp.log(x - 2) - y, (x, y))
GAP_IN_SPACE = rsym.sphere(1) | Shape(sp.sqrt(x - 2) - z, (x, y, z))
PICTURES = {
    "lines": lambda: rsym.level_lines(GAP, resolution=32, bounds=((-2, 3), (-2, 2))),
    "field": lambda: rsym.plot_field(GAP, ax=Figure().add_subplot(), resolution=32, bounds=((-2, 3), (-2, 2))),
    "sheet": lambda: rsym.plot_fields(GAP, figure=Figure(), resolution=32, bounds=((-2, 3), (-2, 2))),
    "section": lambda: rsym.level_lines(GAP_IN_SPACE, section={z: 0}, resolution=32, bounds=((-2, 3), (-2, 2))),
    "rays": lambda: rsym.render(GAP_IN_SPACE.replace(bounds=((-2, 3), (-2, 2), (-2, 2))), size=(16, 12)),
    "mesh": lambda: rsym.mesh(GAP_IN_SPACE, 16, bounds=((-2, 3), (-2, 2), (-2, 2))),
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_tells_once_where_a_part_has_no_value(name):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", rsym.RsymWarning)
        PICTURES[name]()
    (gap,) = [str(one.message) for one in told if "has no value" in str(one.message)]
    assert "in 80 % of the bounds" in gap or "in 82 % of the bounds" in gap  # 17 points stand for 4/5 in space
    assert "where x - 2 is negative" in gap
    assert not any("is undefined on" in str(one.message) for one in told)


def test_lint_tells_which_part_has_no_value_where():
    (found,) = [one for one in rsym.lint(GAP, bounds=((-2, 3), (-2, 2))).findings if one.kind == "without a value"]
    assert "log(x - 2)" in str(found.places[0])
    assert found.point[0] < 2
    assert_close(found.range[0], 0.8, atol=0.05)


def test_no_points_are_drawn_where_a_body_ends_with_its_domain():
    shape = Shape(rsym.conjunction(sp.sqrt(x) - z, 4 - x**2 - y**2 - z**2), (x, y, z))
    drawn = rsym.sample(shape, 300, over="boundary", rng=1, resolution=16, bounds=((-2.1, 2.1),) * 3)
    assert (drawn.points[:, 0] > 1e-9).all()


def test_conditions_within_conditions_stay_conditions():
    """Two decide each other: what one of them leaves of the other jumps as before. 5.69 for 4.71."""
    disc = sp.Rational(3, 2) - x**2 - y**2
    decided = sp.Piecewise((y**2 + 3, sp.And(x > sp.Rational(1, 4), disc > 0)), (-1, disc <= 0), (2, True))
    found = rsym.measure(Shape(decided, (x, y), bounds=((-2, 2), (-2, 2))))
    assert_close(found.area, 1.5 * np.pi, rtol=1e-12)


def test_a_jump_that_shows_on_a_hundredth_of_its_condition_is_one():
    """No segment meets it: the difference of the sides is 0 but where sin(y) is nearly 1."""
    bump = sp.Max(0, sp.sin(y) - sp.Rational(99999, 100000))
    disc = 1 - x**2 - y**2
    assert len(shape_form(Shape(sp.Piecewise((disc, x > 0), (disc + bump, True)), (x, y))).leaves) == 4
    smooth = sp.Piecewise((sp.exp(x) - y, x < 0), (1 + x - y, True))
    assert len(shape_form(Shape(smooth, (x, y))).leaves) == 1


@pytest.mark.parametrize(
    ("expression", "leaves"),
    [(sp.sqrt(x) - 2, 1), (2 - sp.sqrt(x), 2), (sp.sqrt(x) + 2, 1), (-sp.sqrt(x), 1), (sp.sqrt(x), 1)],
)
def test_roots_beside_numbers_leave_no_constant_leaf(expression, leaves):
    shape = Shape(expression, (x, y))
    assert len(shape_form(shape).leaves) == leaves
    places = np.array([-3, -0.5, 0.25, 3.5, 4.5, 9])
    truth = [bool((value := expression.subs({x: place, y: 0})).is_real and value > 0) for place in places]
    assert shape.contains(places, 0.0).tolist() == truth


@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize("cells", [16, 24])
def test_the_inner_side_of_a_shell_stays_where_it_is_if_the_outer_one_is_the_end_of_a_domain(cells):
    # The inner leaf has a kink at the wall, and beside caps its vertices were put there: 4.2 for 9.3.
    middle = (sp.Rational(-11, 16), sp.Rational(15, 16), sp.Rational(-7, 16))
    square = sum((one - place) ** 2 for one, place in zip((x, y, z), middle, strict=True)) / 2
    leaf = sp.asin(square - sp.Rational(25, 128)) - sp.Rational(3, 8)
    mesh = rsym.mesh(rsym.Shape(leaf, (x, y, z), bounds=((-2.013, 2.017),) * 3), cells)
    inner, outer = (math.sqrt(25 / 64 + 2 * level) for level in (math.sin(3 / 8), 1))
    away = [outer - (2.013 - 11 / 16), outer - (2.017 - 15 / 16)]
    cut = sum(math.pi * h**2 * (3 * outer - h) / 3 for h in away)
    assert mesh.volume == pytest.approx(4 / 3 * math.pi * (outer**3 - inner**3) - cut, rel=6 / cells**2)


@pytest.mark.parametrize("other", ["log(2 - r)", "1 - sqrt(r)", "1 - r**2"])
@pytest.mark.parametrize("dimension", [2, 3])
def test_where_a_domain_ends_on_a_face_of_another_formula_the_face_bounds(dimension, other):
    """So for lines and for samples, however the face is written: they have one zero, to rounding."""
    coordinates = (x, y, z)[:dimension]
    square = sum(one**2 for one in coordinates)
    face = {"log(2 - r)": sp.log(2 - square), "1 - sqrt(r)": 1 - sp.sqrt(square), "1 - r**2": 1 - square**2}[other]
    body = rsym.Shape(sp.sqrt(1 - square) + sp.Rational(1, 2), coordinates) & rsym.Shape(face, coordinates)
    body = body.replace(bounds=((-2, 2),) * dimension)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rsym.RsymWarning)  # of what has no value beyond
        points = np.asarray(rsym.sample(body, 4000, over="boundary", rng=1).points)
        lines = rsym.level_lines(body) if dimension == 2 else ()
    assert np.abs(np.linalg.norm(points, axis=1) - 1).max() < 1e-12
    below = np.count_nonzero(points[:, -1] < -0.75) / len(points)
    share = np.arccos(0.75) / np.pi if dimension == 2 else 0.125
    assert abs(below - share) < 5 * np.sqrt(share * (1 - share) / len(points))
    for line in lines:
        assert (line[0] == line[-1]).all()
    assert len(lines) == (dimension == 2)
