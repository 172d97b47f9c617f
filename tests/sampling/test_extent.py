"""Bounds that are found: known extents, nothing outside, every kind of unboundedness refused with its direction."""

import math

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close
from oracles.many_balls import many_balls

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.backends import kernel
from rsym.backends.interpreter import interpret
from rsym.bounds.far_forms import NEARNESS, FarForms, direction_of
from rsym.logic.sign_form import surface_form
from rsym.program.builder import Builder
from rsym.program.fields import program_of
from rsym.program.lowering import lower
from rsym.sampling.extent import extent, proved_signs
from rsym.sampling.form_signs import Boxes, FormBounds, FormSigns, cube, grid, halves, slabs
from rsym.sampling.regions.region_signs import TapedBounds
from rsym.sampling.windows import bounds_or_extent

C = rsym.R0.conjunction
# A rotation without symmetry; rows are the directions of the body.
TURN = np.linalg.qr(np.array([[3.0, 1.0, -2.0], [0.5, 2.0, 1.0], [-1.0, 1.5, 2.5]]))[0]
U, V, W = (sum(float(c) * v for c, v in zip(row, (x, y, z), strict=True)) for row in TURN)
BOX = np.abs(TURN).T @ [1, 2, 3]
ROD = 5 * np.abs(TURN[2]) + 2 * np.sqrt(1 - TURN[2] ** 2)
TORUS = 3 * np.sqrt(1 - TURN[2] ** 2) + 1
GYROID = sp.sin(x) * sp.cos(y) + sp.sin(y) * sp.cos(z) + sp.sin(z) * sp.cos(x)
SPHERES = [1 - (x - 3 * k) ** 2 - (y - k) ** 2 - z**2 for k in range(12)]

# Name: shape, lower and upper ends of the true extent.
BODIES = {
    "ball": (1 - x**2 - y**2 - z**2, (-1, -1, -1), (1, 1, 1)),
    "outside of a ball": (x**2 + y**2 + z**2 - 1, (-1, -1, -1), (1, 1, 1)),
    "shell": (C(1 - x**2 - y**2 - z**2, x**2 + y**2 + z**2 - 0.998), (-1, -1, -1), (1, 1, 1)),
    "far away": (1e-6 - (x - 100) ** 2 - y**2 - (z + 3) ** 2, (99.999, -1e-3, -3.001), (100.001, 1e-3, -2.999)),
    "half-spaces": (C(4 - x, x - 3, 1 - y, y + 1, 2 - z, z), (3, -1, 0), (4, 1, 2)),
    "turned half-spaces": (C(1 - U, 1 + U, 2 - V, 2 + V, 3 - W, 3 + W), -BOX, BOX),
    "tetrahedron": (C(x, y, z, 1 - x - y - z), (0, 0, 0), (1, 1, 1)),
    "capped cylinder": (C(4 - x**2 - y**2, 5 - z, z + 5), (-2, -2, -5), (2, 2, 5)),
    "turned cylinder": (C(4 - U**2 - V**2, 5 - W, W + 5), -ROD, ROD),
    "sheet": (C(100 - x, 100 + x, 10 - y, y - 9, 0.001 - z, z), (-100, 9, 0), (100, 10, 0.001)),
    "strips": (C((4 - x) * (x - 1), (2 - y) * (y + 2), (3 - z) * (z + 100)), (1, -2, -100), (4, 2, 3)),
    "R_p": (rsym.Rp(4).conjunction(1 - x**2, 4 - y**2, 9 - z**2), (-1, -2, -3), (1, 2, 3)),
    "quartic torus": (36 * (x**2 + y**2) - (x**2 + y**2 + z**2 + 8) ** 2, (-4, -4, -1), (4, 4, 1)),
    "turned torus": (36 * (U**2 + V**2) - (U**2 + V**2 + W**2 + 8) ** 2, -TORUS, TORUS),
    "torus by roots": (1 - sp.sqrt((sp.sqrt(x**2 + y**2) - 3) ** 2 + z**2), (-4, -4, -1), (4, 4, 1)),
    "products": (1 - x**2 * y**2 - y**2 * z**2 - z**2 * x**2 - x**2 - y**2 - z**2, (-1, -1, -1), (1, 1, 1)),
    "cone": (C(-z - sp.sqrt(x**2 + y**2), z + 2), (-2, -2, -2), (2, 2, 0)),
    "paraboloid": (C(z - x**2 - y**2, 4 - z), (-2, -2, 0), (2, 2, 4)),
    "bored ball": (C(4 - x**2 - y**2 - z**2, x**2 + y**2 - 1), (-2, -2, -math.sqrt(3)), (2, 2, math.sqrt(3))),
    "bell": (sp.exp(-(x**2) - y**2 - z**2) - math.exp(-4), (-2, -2, -2), (2, 2, 2)),
    "gyroid in a ball": (C(9 - x**2 - y**2 - z**2, GYROID + 2), (-3, -3, -3), (3, 3, 3)),
    "spheres": (rsym.R0.disjunction(*SPHERES), (-1, -1, -1), (34, 12, 1)),
}
UNBOUNDED = {
    "half-space": (x, {"-y", "+y", "-z", "+z"}),
    "cylinder": (1 - x**2 - y**2, {"-z", "+z"}),
    "cylinder beside the axis": (1 - (x - 3) ** 2 - (y - 4) ** 2, {"-z", "+z"}),
    "half a cylinder": (C(1 - x**2 - z**2, y - 1), {"+y"}),
    "without a ball": (C(x**2 + y**2 + z**2 - 1, 4 - x**2 - y**2), {"-z", "+z"}),
    "gyroid": (GYROID, {"-x", "+x", "-y", "+y", "-z", "+z"}),
}


@pytest.mark.random
@pytest.mark.parametrize("name", BODIES)
def test_the_true_extent_lies_inside_and_little_is_added(name):
    expression, lower, upper = BODIES[name]
    found = np.array(extent(Shape(expression, (x, y, z))))
    sides = np.subtract(upper, lower)
    assert (found[:, 0] < lower).all()
    assert (found[:, 1] > upper).all()
    assert (found[:, 1] - found[:, 0] < 1.04 * sides).all()


@pytest.mark.random
@pytest.mark.parametrize("name", UNBOUNDED)
def test_what_has_no_end_is_refused_with_its_directions(name):
    expression, directions = UNBOUNDED[name]
    with pytest.raises(RsymError) as caught:
        extent(Shape(expression, (x, y, z)))
    assert caught.value.code in {"unbounded", "unproved"}  # a thin one far out is met by no point
    assert set(caught.value.message.partition("directions ")[2].split(", ")) == directions
    assert "bounds=" in caught.value.remedy


def test_a_tilted_direction_is_told_by_numbers():
    with pytest.raises(RsymError) as caught:
        extent(Shape(C(1 - U**2 - V**2, W), (x, y, z)))
    first = caught.value.message.partition("directions (")[2].partition(")")[0]
    assert_close([float(number) for number in first.split(", ")], TURN[2], atol=0.02)


EMPTY = {
    "far from zero": -1 - x**2 - y**2 - z**2,
    "a point": -(x**2) - y**2 - z**2,
    "nearly zero": x**2 + y**2 + z**2 - x * y - y * z + 1e-4,
    "disjoint": C(x - 1, -x, 1 - y**2 - z**2),
}


@pytest.mark.parametrize("expression", EMPTY.values(), ids=EMPTY)
def test_an_empty_zero_set_is_an_error(expression):
    with pytest.raises(RsymError) as caught:
        extent(Shape(expression, (x, y, z)))
    assert caught.value.code == "empty"


def test_letters_count_by_value_and_nothing_is_compiled_again(monkeypatch):
    a, b = sp.symbols("a b", real=True)
    shape = Shape(C(a**2 - x**2 - (y - b) ** 2, (2 - z) * (z - b) / (2 - b)), (x, y, z), letters={a: 1, b: 0})
    extent(shape)
    monkeypatch.setattr(kernel, "make_function", None)
    found = np.array(extent(shape, {"a": 0.01, "b": -500}))
    assert_close(found[:2], [[-0.01, 0.01], [-500.01, -499.99]], atol=4e-4)
    assert_close(found[2], [-500, 2], atol=10)
    with pytest.raises(RsymError, match="no letter 'c'"):
        extent(shape, {"c": 1})


def test_letters_decide_whether_there_is_an_end():
    a = sp.Symbol("a", real=True)
    shape = Shape(1 - a * x**2 - y**2 - z**2, (x, y, z), letters={a: 1})
    assert_close(np.array(extent(shape, {"a": 4}))[0], [-0.5, 0.5], atol=0.02)
    with pytest.raises(RsymError, match=r"directions -x, \+x"):
        extent(shape, {"a": 0})
    with pytest.raises(RsymError, match="goes on beyond"):
        extent(shape, {"a": -1})


@pytest.mark.slow
def test_the_car_fits_and_its_printed_reading_does_not():
    """Beyond the box no sample of the car is inside; the headlights of the printed formula go on to the front."""
    car = rsym.paper.car()
    found = np.array(extent(car))
    bounds = np.array(car.bounds)
    assert (found[:, 0] > bounds[:, 0] - 0.5).all()
    assert (found[:, 1] < bounds[:, 1]).all()
    axes = [np.linspace(low - 1, high + 1, 90) for low, high in bounds]
    inside = rsym.compile(car)(*np.meshgrid(*axes, indexing="ij"))["value"] > 0
    for k in range(3):
        used = axes[k][inside.any(axis=tuple(i for i in range(3) if i != k))]
        assert found[k, 0] < used.min()
        assert used.max() < found[k, 1]
    text = rsym.paper.models.model_path("car")
    with pytest.raises(RsymError, match=r"directions \+y;") as caught:
        extent(rsym.load(text, shape="W_printed"))
    assert caught.value.code == "unproved"


def random_body(seed):
    """Conjunctions of random planes and quadrics, joined; for odd seeds with a ball in each."""
    generator = np.random.default_rng(seed)
    leaves = []
    for _ in range(6):
        a, b, c, d = map(float, generator.normal(size=4).round(3))
        plane = a * x + b * y + c * z + d
        leaves.append(plane if generator.random() < 0.6 else 1 + d**2 - (x - a) ** 2 - (y - b) ** 2 + c * z**2)
    ball = [9 - x**2 - y**2 - z**2] * (seed % 2)
    return rsym.R0.disjunction(C(*leaves[:3], *ball), C(*leaves[3:], *ball))


def outcome(shape):
    """A box, for an empty zero set one at 0, and which of the three it is."""
    try:
        return np.array(extent(shape)), "bounds"
    except RsymError as error:
        return np.zeros((3, 2)), error.code


@pytest.mark.slow
def test_random_bodies_have_one_sign_outside_or_do_not_end():
    generator, outcomes = np.random.default_rng(1), []
    for seed in range(16):
        shape = Shape(random_body(seed), (x, y, z))
        box, kind = outcome(shape)
        outcomes.append(kind)
        if kind == "unbounded":
            assert seed % 2 == 0
            continue
        places = box.mean(axis=1)[:, None] + (1 + np.diff(box)) * generator.normal(size=(3, 20_000)) ** 3
        outside = ((places < box[:, :1]) | (places > box[:, 1:])).any(axis=0)
        assert outside.sum() > 5000
        assert (rsym.compile(shape, backend="numpy")(*places[:, outside])["value"] < 0).all()
    assert outcomes.count("bounds") > 5
    assert outcomes.count("unbounded") > 3


def test_in_the_plane():
    lemniscate = Shape(2 * (x**2 - y**2) - (x**2 + y**2) ** 2, (x, y))
    found = np.array(extent(lemniscate))
    assert_close(found[:, 1], [math.sqrt(2), 0.5], atol=0.03)
    with pytest.raises(RsymError) as caught:
        extent(Shape(x * y - 1, (x, y)))
    assert caught.value.code == "unbounded"


def test_level_lines_and_sections_need_no_bounds():
    (circle,) = rsym.level_lines(Shape(1 - (x - 30) ** 2 - y**2, (x, y)), resolution=64)
    assert_close(np.hypot(circle[:, 0] - 30, circle[:, 1]), np.ones(len(circle)), atol=1e-12)
    (circle,) = rsym.level_lines(Shape(4 - x**2 - y**2 - z**2, (x, y, z)), section={"z": 1}, resolution=64)
    assert_close(np.hypot(*circle.T), np.full(len(circle), math.sqrt(3)), atol=1e-12)
    with pytest.raises(RsymError) as caught:
        rsym.level_lines(Shape(x + y, (x, y)))
    assert caught.value.code == "unbounded"


def test_given_bounds_come_first():
    ball = Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    assert bounds_or_extent(ball, None) == ((-2, 2),) * 3
    assert bounds_or_extent(ball, ((0, 1),) * 3) == ((0, 1),) * 3
    assert bounds_or_extent(Shape(ball.expression, (x, y, z)), None) == extent(ball)


FAR = [
    x**2 + 3 * y - 1 / (2 + z**2),
    rsym.R0.conjunction(x**3 - y, z + 1) * (x + y) - rsym.RAlpha(0.5).disjunction(x, y * z),
    sp.sqrt(x**2 + y + z**4 + 3) - sp.Abs(x - 1) + sp.Piecewise((x**2, x > y**2), (y, True)),
    sp.sqrt(x**3 + 2 * z**2 + 3) * y - x,
    sp.sin(x) * y + sp.exp(-(z**2)) * x**2 - 5,
    sp.Min(x, y**2) - (x**2 - y) / sp.sqrt((x**2 - y) ** 2 + 4 * x**2 + 1) + rsym.Rp(4).conjunction(x, z**2),
]


@pytest.mark.parametrize("expression", FAR, ids=str)
def test_far_forms_are_the_function_times_a_power_of_the_nearness(expression):
    program = program_of(Shape(expression, (x, y, z)), ("value",))
    builder = Builder(("x", "y", "z"), ())
    forms = FarForms(builder)
    node, degree = forms[lower(builder, expression + 1000)]
    far = forms.builder.program({"value": node})
    generator = np.random.default_rng(3)
    direction, size = generator.uniform(-1, 1, (3, 400)), 2.0 ** generator.integers(0, 6, 400)
    places = dict(zip("xyz", direction * size, strict=True))
    inputs = {direction_of(name): row for name, row in zip("xyz", direction, strict=True)} | {NEARNESS: 1 / size}
    values = interpret(program, places)["value"] + 1000
    far_values = interpret(far, inputs | places)["value"] * size**degree
    known = np.isfinite(values)
    assert known.sum() > 150
    assert_close(far_values[known], values[known], atol=1e-6, rtol=1e-9)


def test_signs_far_away_hold_at_random_points():
    shape = Shape(random_body(5), (x, y, z))
    signs = FormSigns(FormBounds(surface_form(shape)), {})
    generator = np.random.default_rng(6)
    centre, width = generator.uniform(-1, 1, (3, 300)), 0.1
    centre[generator.integers(0, 3, 300), np.arange(300)] = np.where(generator.random(300) < 0.5, 1, -1)
    cones = Boxes(np.maximum(centre - width, -1), np.minimum(centre + width, 1))
    face = np.abs(centre) == 1
    cones = Boxes(np.where(face, centre, cones.lower), np.where(face, centre, cones.upper))
    found = signs.beyond(cones, 8.0)
    value = rsym.compile(shape, backend="numpy")
    assert (found != 0).sum() > 50
    for _ in range(50):
        direction = cones.lower + generator.random((3, 300)) * cones.sides
        values = value(*(direction * 8 * 2.0 ** generator.uniform(0, 9, 300)))["value"]
        assert ((np.sign(values) == found) | (found == 0)).all()


def test_boxes_are_divided_without_gaps():
    box = Boxes(np.array([[-1.0], [0.0], [2.0]]), np.array([[3.0], [1.0], [2.5]]))
    for parts in (grid(box, 5), halves(halves(box)[0])[0]):
        assert_close(np.prod(parts.sides, axis=0).sum(), 2.0, rtol=1e-12)
        hull = parts.hull()
        assert (hull.lower == box.lower).all()
        assert (hull.upper == box.upper).all()
    faces = slabs(cube(3, 1.0), np.zeros((3, 2)))
    assert sorted(map(tuple, faces.centres.T)) == sorted(map(tuple, np.vstack([np.eye(3), -np.eye(3)])))


@pytest.mark.slow
@pytest.mark.parametrize("method", ["sharp", "smooth"])
def test_a_mesh_without_bounds_holds_the_whole_body_at_any_letters(method):
    r = sp.Symbol("r", real=True)
    ball = Shape(r**2 - (x - 40) ** 2 - y**2 - z**2, (x, y, z), letters={r: 1})
    for radius in (1, 50):
        found = rsym.mesh(ball, 40, method=method, letters={"r": radius}).status
        assert found.closed
        assert not found.clipped
        assert_close(found.volume, 4 / 3 * np.pi * radius**3, rtol=0.009)
    turned = rsym.mesh(rsym.revolve(Shape(1 - x**2 / 9 - y**2, (x, y))), 40, method=method).status
    assert_close(turned.volume, 4 * np.pi, rtol=0.009)
    with pytest.raises(RsymError) as caught:
        rsym.mesh(Shape(1 - x**2 - y**2, (x, y, z)), method=method)
    assert caught.value.code == "unbounded"


def of_many_leaves():
    """Leaves of several kinds, with letters and without, some undefined, some without end."""
    r = sp.Symbol("r", real=True)
    discs, _, _ = many_balls(60, 2)
    more = [
        (r - x) * (2 + x) - y**2 / 3,
        sp.sqrt(x + 2) - 3 - y**2,
        sp.sin(3 * x) / 4 - y**2 - x**2,
        1 - abs(x - r) * 8 - y**2,
        *(1 - (x - k) ** 2 * (2 + sp.cos(y)) - (y + k) ** 2 for k in range(4)),
        *(x**3 - 3 * x * y**2 + k * y - x * y / 3 - y**4 for k in range(4)),
    ]
    parts = [Shape(leaf, (x, y), letters={r: 1.25} if leaf.has(r) else None) for leaf in more]
    return (discs | rsym.disjunction(*parts)) & Shape(y + 5, (x, y))


def test_signs_of_many_leaves_by_tapes_are_those_of_compiled_bounds():
    shape = of_many_leaves()
    signs = proved_signs(shape)
    assert isinstance(signs.bounds, TapedBounds)
    compiled = FormSigns(FormBounds(signs.bounds.form), signs.letters)
    generator = np.random.default_rng(4)
    centres, sizes = generator.uniform(-3, 3, (2, 999)), 2.0 ** generator.uniform(-9, 2, (2, 999))
    boxes = Boxes(centres - sizes, centres + sizes)
    found = signs.over(boxes)
    np.testing.assert_array_equal(found, compiled.over(boxes))
    leaves = [bounds.near([boxes], signs.letters) for bounds in (signs.bounds, compiled.bounds)]
    np.testing.assert_array_equal(*leaves)
    assert min((found == sign).sum() for sign in (-1, 0, 1)) > 20
    for size in (3.0, 50.0, 2.0**40):
        cones = halves(halves(slabs(cube(2, 1.0), np.zeros((2, 2))))[0])[0]
        np.testing.assert_array_equal(signs.beyond(cones, size), compiled.beyond(cones, size))


@pytest.mark.parametrize("dimension", [2, 3])
def test_the_extent_of_many_balls_is_found_without_compiled_bounds(dimension, monkeypatch):
    shape, centres, radii = many_balls(70, dimension)
    monkeypatch.setattr("rsym.sampling.extent.FormBounds", None)
    for (low, high), along in zip(extent(shape), centres.T, strict=True):
        exact = (along - radii).min(), (along + radii).max()
        assert low <= exact[0] < exact[1] <= high
        assert high - low <= 1.05 * (exact[1] - exact[0])
