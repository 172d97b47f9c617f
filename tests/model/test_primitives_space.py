"""Space primitives: order of normalisation, membership, letters, bounds, volumes, thickness."""

import math

import numpy as np
import pytest
import sympy as sp
from oracles.boundary_points import assert_normalised, boundary_points, random_motion
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.primitives import (
    box,
    capsule,
    cone,
    cylinder,
    double_cone,
    ellipsoid,
    frustum,
    gyroid,
    half_space,
    helicoid,
    helix_tube,
    implicit,
    lidinoid,
    nappe,
    neovius,
    quadric,
    schwarz_d,
    schwarz_p,
    slab,
    sphere,
    torus,
)

CUBE = ((-1.5, 1.5),) * 3
WIDE = ((-6, 6),) * 3
MATRIX = ((-2, 1, 0), (1, -1, sp.Rational(1, 2)), (0, sp.Rational(1, 2), 3))


def tenths(number):
    return sp.Rational(number, 10)


PRIMITIVES = [
    ("half-space", half_space((1, -2, 2), tenths(4)), 4, CUBE),
    ("slab", slab(-1, tenths(3), (2, 1, 2)), 1, CUBE),
    ("sphere", sphere(2, (1, 0, -1)), 1, None),
    ("exact sphere", sphere(2, (1, 0, -1), exact=True), 4, None),
    ("box", box(1, 2, 3, (1, 0, 0)), 1, None),
    ("infinite cylinder", cylinder(tenths(7), None, (tenths(5), 0, 0)), 1, CUBE),
    ("cylinder", cylinder(1, 3, (0, 1, 0)), 1, None),
    ("capsule", capsule((0, 0, 0), (1, 2, 2), tenths(7)), 1, None),
    ("exact capsule", capsule((0, 0, 0), (1, 2, 2), tenths(7), exact=True), 4, None),
    ("cone", cone(1, 2, (0, 0, 1)), 1, None),
    ("frustum", frustum(2, 1, 3, (1, 1, 0)), 1, None),
    ("widening frustum", frustum(1, 2, 1), 1, None),
    ("nappe", nappe(tenths(6), (0, 0, -1)), 4, CUBE),
    ("double cone", double_cone(tenths(6), (tenths(2), 0, 0)), 1, CUBE),
    ("ellipsoid", ellipsoid(3, 2, 1, (1, 2, 3)), 1, None),
    ("ellipsoid of the source", ellipsoid(3, 2, 1, length=1), 1, None),
    ("quadric", quadric(MATRIX, (1, 0, -1), tenths(5), length=3), 1, CUBE),
    ("conic", quadric(((1, 0), (0, -2)), (0, 1), 1), 1, CUBE[:2]),
    ("torus", torus(3, 1, (1, 0, 0)), 1, None),
    ("exact torus", torus(3, 2, form="exact"), 4, None),
    ("quartic torus", torus(3, 2, (0, 0, 1), form="quartic"), 1, None),
    ("helicoid", helicoid(2), 2, CUBE),
    ("flight", helicoid(2, tenths(3)), 1, CUBE),
    ("helix tube", helix_tube(), 1, WIDE),
    ("thick steep tube", helix_tube(1, tenths(8), 20), 1, CUBE),
    ("exact helix tube", helix_tube(3, 1, 3, exact=True), 3, WIDE),
    ("spring", helix_tube(turns=2), 1, None),
    ("gyroid", gyroid(2, tenths(3)), 1, CUBE),
    ("gyroid sheet", gyroid(3, 0, tenths(4)), 1, CUBE),
    ("primitive surface", schwarz_p(2, tenths(5)), 1, CUBE),
    ("diamond surface", schwarz_d(3), 1, CUBE),
    ("surface of Neovius", neovius(3), 1, CUBE),
    ("lidinoid", lidinoid(3), 1, CUBE),
    ("implicit", implicit(x**4 + y**3 * z - sp.sin(z) - 1, length=2), 1, CUBE),
    ("normalised union", implicit(rsym.disjunction(1 - x**2 - y**2, z - x)), 1, CUBE),
]


@pytest.mark.random
@pytest.mark.parametrize(("name", "shape", "order", "bounds"), PRIMITIVES, ids=[row[0] for row in PRIMITIVES])
def test_every_primitive_is_normalised_to_the_order_it_states(name, shape, order, bounds):
    assert_normalised(random_motion(shape, seed=len(name), bounds=bounds), order, seed=len(name))


@pytest.mark.parametrize("shape", [sphere(), torus(form="radial"), ellipsoid(), cylinder()])
def test_order_one_is_not_order_two(shape):
    """Red proof of the oracle."""
    with pytest.raises(AssertionError):
        assert_normalised(shape, 2, 20, bounds=(shape.box and shape.box.ends) or CUBE)


A, B, C = sp.symbols("A B C", positive=True)
IN_LETTERS = [
    lambda a, b, c, **k: half_space((a, b, c), a, **k),
    lambda a, b, c, **k: slab(-a, b, (c, 1, 0), **k),
    lambda a, b, c, **k: sphere(a, (b, c, 0), **k),
    lambda a, b, c, **k: box(a, b, c, (a, 0, 0), **k),
    lambda a, b, c, **k: cylinder(a, b, (0, c, 0), **k),
    lambda a, b, c, **k: capsule((a, 0, 0), (0, b, c), c, **k),
    lambda a, b, c, **k: cone(a, b, (0, c, 0), **k),
    lambda a, b, c, **k: frustum(a, b, c, **k),
    lambda a, b, c, **k: nappe(a, (b, c, 0), **k),
    lambda a, b, c, **k: double_cone(a, (b, c, 0), **k),
    lambda a, b, c, **k: ellipsoid(c, b, a, (a, 0, 0), **k),
    lambda a, b, c, **k: quadric(((a, b, 0), (b, -c, 0), (0, 0, 1)), (c, 0, 0), b, length=a, **k),
    lambda a, b, c, **k: torus(a + b, a, (c, 0, 0), **k),
    lambda a, b, c, **k: torus(a + b, a, (c, 0, 0), form="quartic", **k),
    lambda a, b, c, **k: helicoid(a, **k),
    lambda a, b, c, **k: helicoid(c, a / 10, **k),
    lambda a, b, c, **k: helix_tube(a + b, a, c, 2, **k),
    lambda a, b, c, **k: gyroid(a, b / 10, **k),
    lambda a, b, c, **k: schwarz_d(a, b / 10, a / 20, **k),
    lambda a, b, c, **k: implicit(a * x**2 - b * y * z + c, length=c, **k),
]


@pytest.mark.random
@pytest.mark.parametrize("build", IN_LETTERS)
def test_letters_stand_for_numbers_everywhere(build):
    first = {A: sp.Rational(3, 4), B: sp.Rational(1, 2), C: sp.Rational(5, 4)}
    other = {A: sp.Rational(4, 5), B: sp.Rational(3, 5), C: sp.Rational(9, 8)}
    shape = build(A, B, C, letters=first)
    points = np.random.default_rng(1).uniform(-2, 2, (3, 200))
    for values in (first, other):
        plain = build(*values.values())
        expected = rsym.compile(plain)(*points)["value"]
        got = rsym.compile(shape)(*points, letters={key.name: float(value) for key, value in values.items()})["value"]
        assert_close(got, expected, atol=1e-12)
    box = build(*first.values()).box
    assert (shape.box is None) == (box is None)
    if box is not None:
        assert_close(shape.box.ends, box.ends, atol=1e-12)


def rho(p):
    return np.hypot(p[0], p[1])


def from_segment(p, start, end):
    start, end = (np.array(tip, float)[:, None] for tip in (start, end))
    share = np.clip(((p - start) * (end - start)).sum(axis=0) / ((end - start) ** 2).sum(), 0, 1)
    return np.linalg.norm(p - start - share * (end - start), axis=0)


def from_helix(p, radius, pitch):
    """The least distance from points of the helix, densely."""
    turn = np.linspace(-4 * np.pi, 4 * np.pi, 8001)
    curve = np.stack([radius * np.cos(turn), radius * np.sin(turn), pitch * turn / (2 * np.pi)])
    return np.array([np.linalg.norm(curve - point[:, None], axis=0).min() for point in p.T])


def above_line(p, pitch):
    """The angle from the line of the helicoid at the height of the point up to the point, in (-pi, pi]."""
    turned = np.exp(1j * (np.arctan2(p[1], p[0]) - 2 * np.pi * p[2] / pitch))
    return np.angle(turned)


MEMBERS = [
    (half_space((0, 3, 4), 1), lambda p: 0.6 * p[1] + 0.8 * p[2] - 1),
    (slab(-1, 0.5, (0, 3, 4)), lambda p: 0.75 - np.abs(0.6 * p[1] + 0.8 * p[2] + 0.25)),
    (box(1, 2, 3), lambda p: np.min(np.array([[0.5], [1], [1.5]]) - np.abs(p), axis=0)),
    (cylinder(1, 2), lambda p: np.minimum(1 - rho(p), 1 - np.abs(p[2]))),
    (capsule((0, 0, 0), (1, 1, 1), 0.5), lambda p: 0.5 - from_segment(p, (0, 0, 0), (1, 1, 1))),
    (cone(1, 2, (0, 0, -1)), lambda p: np.minimum(1 - rho(p) - (p[2] + 1) / 2, p[2] + 1)),
    (frustum(2, 1, 2, (0, 0, -1)), lambda p: np.minimum(2 - (p[2] + 1) / 2 - rho(p), 1 - np.abs(p[2]))),
    (nappe(0.5), lambda p: 0.5 - np.arctan2(rho(p), p[2])),
    (double_cone(0.5), lambda p: 0.5 - np.arctan2(rho(p), np.abs(p[2]))),
    (ellipsoid(2, 1, 0.5), lambda p: 1 - np.linalg.norm(p / np.array([[2], [1], [0.5]]), axis=0)),
    (quadric(), lambda p: np.sqrt(1 + p[2] ** 2) - rho(p)),
    (torus(1.5, 0.5), lambda p: 0.5 - np.hypot(rho(p) - 1.5, p[2])),
    (torus(1.5, 0.5, form="quartic"), lambda p: 0.5 - np.hypot(rho(p) - 1.5, p[2])),
    (helicoid(3), lambda p: np.pi / 2 - np.abs(above_line(p, 3) - np.pi / 2)),
    (helix_tube(1.5, 0.5, 2), lambda p: 0.5 - from_helix(p, 1.5, 2)),
    (helix_tube(1, 0.7, 9), lambda p: 0.7 - from_helix(p, 1, 9)),
    (schwarz_p(2, 0.5), lambda p: np.cos(np.pi * p).sum(axis=0) - 0.5),
    (gyroid(4, -0.3), lambda p: (np.sin(np.pi * p / 2) * np.cos(np.pi * p[[1, 2, 0]] / 2)).sum(axis=0) + 0.3),
    # The other usual form of the diamond surface, moved by a quarter of a period in every direction.
    (schwarz_d(3), lambda p: _diamond(2 * np.pi * p / 3 - np.pi / 4)),
]


def _diamond(p):
    return np.cos(p).prod(axis=0) * math.sqrt(2) + np.sin(p).prod(axis=0) * math.sqrt(2)


@pytest.mark.random
@pytest.mark.parametrize(("shape", "truth"), MEMBERS)
def test_inside_is_positive(shape, truth):
    points = np.random.default_rng(2).uniform(-2.5, 2.5, (3, 2000))
    margin = truth(points)
    clear = np.abs(margin) > 1e-3
    assert 0.005 < (margin > 0).mean() < 0.8
    assert (np.sign(rsym.compile(shape)(*points)["value"]) == np.sign(margin))[clear].all()


SOLIDS = [
    (sphere(1), 4 * math.pi / 3, 2),
    (ellipsoid(3, 2, 1), 8 * math.pi, 2),
    (box(1, 2, 3), 6, 2),
    (cylinder(1, 2), 2 * math.pi, 2),
    (capsule((0, 0, -1), (0, 0, 1), 1), 2 * math.pi + 4 * math.pi / 3, 2),
    (cone(1, 2), 2 * math.pi / 3, 2),
    (frustum(2, 1, 3), 7 * math.pi, 2),
    (torus(3, 1), 6 * math.pi**2, 0),
    (torus(3, 2, form="quartic"), 24 * math.pi**2, 0),
    # A tube has the volume of its section times the length of its middle line, and every slice the same.
    (helix_tube(3, 1, 4, turns=1), math.pi * math.hypot(6 * math.pi, 4), 2),
]


@pytest.mark.random
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")  # slivers where a plane cuts a tube, the axis of a helix
@pytest.mark.parametrize(("shape", "volume", "euler"), SOLIDS)
def test_solids_mesh_closed_with_their_volume_inside_their_bounds(shape, volume, euler):
    mesh = rsym.mesh(shape, 48)
    assert mesh.status.closed
    assert mesh.status.euler_characteristic == euler
    assert_close(mesh.status.volume, volume, rtol=8e-3)
    bounds = np.array(shape.box.ends)
    extent = np.ptp(bounds, axis=1)
    room = extent.max() / 12
    assert_close(mesh.vertices.min(axis=0), bounds[:, 0] + room, atol=0.03 * extent.max())
    assert_close(mesh.vertices.max(axis=0), bounds[:, 1] - room, atol=0.03 * extent.max())


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
def test_a_gyroid_in_a_cube_of_whole_periods_takes_half_of_it():
    mesh = rsym.mesh(gyroid(2) & box(4, 4, 4), 48)
    assert mesh.status.closed
    assert_close(mesh.status.volume, 32, rtol=2e-3)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
def test_the_flight_of_a_screw_is_closed_and_has_the_volume_of_its_slices():
    mesh = rsym.mesh(helicoid(2, tenths(2)) & cylinder(1, 3), 48)
    assert mesh.status.closed
    assert mesh.status.components == 1
    places = np.linspace(-1, 1, 1001)
    aside, along = np.meshgrid(places, places)
    half, angle = 0.1, 0.1 * math.pi
    slice_of_it = (aside**2 < half**2 + (along * math.tan(angle)) ** 2) & (aside**2 + along**2 < 1)
    assert_close(mesh.status.volume, 3 * slice_of_it.mean() * 4, rtol=8e-3)


@pytest.mark.slow
def test_a_flight_is_as_thick_as_it_says():
    pitch, thickness = 2.0, 0.2
    points, _ = boundary_points(helicoid(2, tenths(2)), bounds=CUBE)
    points = points.astype(float)
    turn = np.linspace(-2.5 * np.pi, 2.5 * np.pi, 20001)
    angles = np.arctan2(points[:, 1], points[:, 0])[:, None] - turn
    height = points[:, 2, None] - pitch * turn / (2 * np.pi)
    lines = np.hypot(points[:, 0], points[:, 1])[:, None] * np.sin(angles)
    ratio = np.sqrt(lines**2 + height**2).min(axis=1) / (thickness / 2)
    assert 0.9955 < ratio.min()
    assert ratio.max() < 1.0005


SHEETS = [
    (gyroid, 0.1, 0.988, 1.004),
    (schwarz_p, 0.1, 0.999, 1.034),
    (schwarz_d, 0.1, 0.968, 1.004),
    (neovius, 0.05, 0.99, 1.034),
    (lidinoid, 0.02, 0.98, 1.02),
]


@pytest.mark.random
@pytest.mark.parametrize(("surface", "thickness", "low", "high"), SHEETS)
def test_a_sheet_is_as_thick_as_it_says(surface, thickness, low, high):
    """Measured along normals of the surface in its middle."""
    points, normals = boundary_points(surface(1), bounds=CUBE)
    steps = np.linspace(0, thickness, 801)
    sheet = rsym.compile(surface(1, 0, thickness))
    measured = np.zeros(len(points))
    for sign in (1, -1):
        ray = (points[:, None] + sign * steps[:, None] * normals[:, None]).astype(float)
        measured += steps[np.argmax(sheet(*np.moveaxis(ray, 2, 0))["value"] < 0, axis=1)]
    assert low < measured.min() / thickness
    assert measured.max() / thickness < high


def test_a_capsule_is_g1_where_its_ends_begin():
    kernel = rsym.compile(capsule(), ("gradient", "hessian"))
    below, on, above = (kernel(0.6, 0.8, 1.0 + step) for step in (-1e-9, 0.0, 1e-9))
    assert_close(below["gradient"], on["gradient"], atol=1e-8)
    assert_close(above["gradient"], on["gradient"], atol=1e-8)
    assert_close(above["hessian"][2, 2] - below["hessian"][2, 2], -1.0, atol=1e-12)


@pytest.mark.parametrize(
    "shape",
    [
        ellipsoid(),
        quadric(MATRIX, length=2),
        torus(form="quartic"),
        gyroid(),
        schwarz_p(thickness=tenths(1)),
        helicoid(1, tenths(1)),
        implicit(x * C - y**3, length=C, letters={C: 2}),
    ],
)
def test_the_theorem_is_one_operation_of_a_program(shape):
    operations = [node.operation for node in rsym.compile(shape).program.nodes]
    assert operations.count("normalised") == 1


def test_what_is_far_away_has_a_value():
    for shape in (ellipsoid(), torus(form="quartic"), quadric()):
        assert np.isfinite(rsym.compile(shape)(1e60, 1e60, 1e60)["value"])


def test_implicit_finds_the_coordinates_and_keeps_what_a_shape_brings():
    assert implicit(x - y).coordinates == (x, y)
    assert implicit(x - z**2).coordinates == (x, y, z)
    height = sp.Symbol("z")
    assert implicit(y - height, letters={"z": 1}).coordinates == (x, y)
    given = Shape(C - x**2, (x, y), letters={C: 1}, bounds=((-2, 2), (-2, 2)))
    assert implicit(given).letters == given.letters
    assert implicit(given).bounds == given.bounds
    assert implicit(given, length=A, letters={A: 3}).letters.keys() == {"A", "C"}


BAD = [
    (lambda: half_space((0, 0, 0)), "direction"),
    (lambda: half_space((0, 1)), "point"),
    (lambda: half_space(distance=C), "unknown-letter"),
    (lambda: slab(1, 1), "interval"),
    (lambda: sphere(0), "positive"),
    (lambda: sphere("1"), "number"),
    (lambda: sphere(1, (0, 0)), "point"),
    (lambda: box(1, -1, 1), "positive"),
    (lambda: cylinder(1, 0), "positive"),
    (lambda: capsule((1, 1, 1), (1, 1, 1)), "direction"),
    (lambda: cone(1, -C, letters={C: 1}), "positive"),
    (lambda: frustum(1, 0), "positive"),
    (lambda: nappe(sp.pi / 2), "angle"),
    (lambda: double_cone(30), "angle"),
    (lambda: ellipsoid(1, 1, 0), "positive"),
    (lambda: ellipsoid(length=-1), "positive"),
    (lambda: quadric(((1, 2, 0), (0, 1, 0), (0, 0, 1))), "matrix"),
    (lambda: quadric(((1, 2),)), "matrix"),
    (lambda: quadric(((1, 0), (0, 1)), (1, 0, 0)), "point"),
    (lambda: torus(1, 1), "torus"),
    (lambda: torus(2, 1, form="cubic"), "form"),
    (lambda: helicoid(-1), "positive"),
    (lambda: helicoid(1, tenths(5)), "thickness"),
    (lambda: helix_tube(1, 1), "tube"),
    (lambda: helix_tube(turns=0), "positive"),
    (lambda: gyroid(0), "positive"),
    (lambda: gyroid(1, 0, tenths(5)), "thickness"),
    (lambda: implicit(C, letters={C: 1}), "implicit"),
    (lambda: implicit("x"), "expression"),
    (lambda: implicit(x, length=0), "positive"),
    (lambda: implicit(sphere(), (x, y, z)), "coordinates"),
]


@pytest.mark.parametrize(("build", "code"), BAD)
def test_what_makes_no_shape_is_refused(build, code):
    with pytest.raises(RsymError) as caught:
        build()
    assert caught.value.code == code
