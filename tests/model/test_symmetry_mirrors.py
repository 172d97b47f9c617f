"""Mirrors and reflection groups, against points reflected one by one until they are in the chamber."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.model.nodes import Held
from rsym.model.symmetry.mirrors import GROUPS, _short, kaleidoscope, mirror_group, mirrored
from rsym.model.symmetry.reflections import folded, orbit

a, b = sp.symbols("a b", real=True)
# No symmetry of its own, and a different value at every point near the origin.
LOPSIDED = Shape(x + y / 3 - z / 7 + x * y / 5 - z**2 / 9, (x, y, z), bounds=((-3, 4), (-2, 2), (-1, 1)))
FLAT = Shape(x + y / 3 + x * y / 5 - y**2 / 9, (x, y), bounds=((-3, 4), (-2, 2)))


def points(dimension, count=3000):
    return np.random.default_rng(8).uniform(-5, 5, (dimension, count))


def numbers(normals):
    return np.array([[float(sp.N(component)) for component in normal] for normal in normals])


def reflected_into(normals, place):
    """Reflect in the mirror that is most in the way, until none is; the point and the map that took it there."""
    units = normals / np.linalg.norm(normals, axis=1)[:, None]
    size = len(place)
    place, turn = place.copy(), np.broadcast_to(np.eye(size), (place.shape[1], size, size)).copy()
    for _ in range(40):
        depth = units @ place
        worst, least = depth.argmin(axis=0), np.minimum(depth.min(axis=0), 0)
        chosen = units[worst]
        place = place - 2 * (least * chosen.T)
        mirror = np.eye(size) - 2 * (least < 0)[:, None, None] * chosen[:, :, None] * chosen[:, None, :]
        turn = mirror @ turn
    assert (units @ place).min() > -1e-12
    return place, turn


def assert_folded(shape, made, normals):
    """Values, gradients, and that nothing changes under the generators."""
    place = points(shape.dimension)
    inside, turn = reflected_into(normals, place)
    plain = rsym.compile(shape, ("value", "gradient"))(*inside)
    kernel = rsym.compile(made, ("value", "gradient"))
    got = kernel(*place)
    assert_close(got["value"], plain["value"], atol=1e-12)
    assert_close(got["gradient"], np.einsum("pi,pij->pj", plain["gradient"], turn), atol=1e-11)
    for normal in normals:
        unit = normal / np.linalg.norm(normal)
        image = place - 2 * np.outer(unit, unit @ place)
        assert_close(kernel(*image)["value"], got["value"], atol=1e-12)


@pytest.mark.random
@pytest.mark.parametrize("group", list(GROUPS))
def test_polyhedral_groups(group):
    made = mirror_group(LOPSIDED, group)
    assert_folded(LOPSIDED, made, numbers(GROUPS[group]))
    reach = np.sqrt(16 + 4 + 1)
    assert made.bounds == ((-reach, reach),) * 3


@pytest.mark.parametrize(("group", "size"), [("tetrahedral", 24), ("octahedral", 48), ("icosahedral", 120)])
def test_the_number_of_chambers(group, size):
    normals = [tuple(map(sp.sympify, normal)) for normal in GROUPS[group]]
    assert len(orbit((sp.Integer(7), sp.Integer(3), sp.Integer(1)), normals)) == size


@pytest.mark.parametrize(
    ("shape", "normals"),
    [
        (LOPSIDED, [(1, 2, 2)]),
        (LOPSIDED, [(1, 0, 0), (-1, sp.sqrt(3), 0)]),
        (LOPSIDED, [(0, 1, 1), (1, 0, 0)]),
        (FLAT, [(0, 1), (sp.sin(sp.pi / 7), -sp.cos(sp.pi / 7))]),
        (FLAT, [(0.0, 2.0), (0.5, -np.sqrt(0.75))]),
    ],
)
def test_groups_of_given_mirrors(shape, normals):
    assert_folded(shape, mirror_group(shape, normals), numbers([tuple(map(sp.sympify, n)) for n in normals]))


@pytest.mark.random
@pytest.mark.parametrize("order", [2, 3, 4, 7, 12])
def test_kaleidoscopes(order):
    wall = np.pi / order
    normals = np.array([[0, 1], [np.sin(wall), -np.cos(wall)]])
    assert_folded(FLAT, kaleidoscope(FLAT, order), normals)
    # In space about x: the angle is in (y, z).
    upright = Shape(y - z / 3 + x * z / 5, (x, y, z))
    turned = np.column_stack([np.zeros(2), normals])
    assert_folded(upright, kaleidoscope(upright, order, axis=x), turned)


def test_the_centre_of_a_kaleidoscope_has_a_value_and_no_angle_is_taken():
    made = kaleidoscope(FLAT, 6)
    assert float(rsym.compile(made)(0.0, 0.0)["value"]) == 0.0
    assert not made.expression.has(sp.atan2)


@pytest.mark.parametrize("letters", [None, {"a": 1.0, "b": -0.5}])
def test_one_mirror(letters):
    made = mirrored(FLAT, (a, 1), b, letters={a: 2, b: 0.75})
    place = points(2)
    slope, distance = (2, 0.75) if letters is None else (1.0, -0.5)
    unit = np.array([slope, 1]) / np.hypot(slope, 1)
    depth = unit @ place - distance
    inside = place - 2 * np.outer(unit, np.minimum(depth, 0))
    assert_close(rsym.compile(made)(*place, letters=letters)["value"], rsym.compile(FLAT)(*inside)["value"], atol=1e-12)


def test_mirrors_know_the_box_of_both_halves():
    assert mirrored(FLAT).expression == FLAT.expression.subs(x, sp.Abs(x))
    assert mirrored(FLAT).bounds == ((-4, 4), (-2, 2))
    assert mirrored(FLAT, (0, -1), 1).bounds == ((-3, 4), (-2, 2))
    assert mirrored(FLAT, (0, 2), -1).bounds == ((-3, 4), (-4, 2))


def test_roots_of_normals_stay_exact():
    """Held ones too, as a model file has them."""
    root = Held(sp.sqrt(3))
    for coordinate in folded([tuple(map(_short, n)) for n in ((sp.S(1), sp.S(0)), (-sp.S(1), root))], (x, y)):
        assert not coordinate.has(sp.Float)
        assert max(abs(number.q) for number in coordinate.atoms(sp.Rational)) <= 12


def test_normalisation_is_kept():
    """Every order: the copies are moved, not bent."""
    ball = Shape(sp.Rational(1, 2) - sp.sqrt((x - 3) ** 2 + (y - 2) ** 2 + (z - 1) ** 2), (x, y, z))
    directions = points(3) / np.linalg.norm(points(3), axis=0)
    place = np.array([-2, 1, 3])[:, None] + directions / 2
    got = rsym.compile(mirror_group(ball, "octahedral"), ("value", "gradient", "hessian"))(*place)
    assert_close(got["value"], np.zeros(3000), atol=1e-14)
    assert_close(np.linalg.norm(got["gradient"], axis=1), np.ones(3000), atol=1e-14)
    assert_close(
        np.einsum("pi,pij,pj->p", got["gradient"], got["hessian"], got["gradient"]), np.zeros(3000), atol=1e-12
    )


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: mirror_group(LOPSIDED, "cubic"), "mirrors"),
        (lambda: mirror_group(FLAT, "octahedral"), "mirrors"),
        (lambda: mirror_group(LOPSIDED, [(1, 0, 0), (2, 0, 0)]), "mirrors"),
        (lambda: mirror_group(FLAT, [(0, 1), (sp.sin(1), -sp.cos(1))]), "mirrors"),
        (lambda: mirror_group(LOPSIDED, [(1, 0), (0, 1)]), "point"),
        (lambda: mirror_group(FLAT, [(0, 1), (a, 1)]), "unknown-letter"),
        (lambda: kaleidoscope(FLAT, 1), "integer"),
        (lambda: kaleidoscope(FLAT, 3, axis=x), "axis"),
        (lambda: mirrored(FLAT, (0, 0)), "direction"),
        (lambda: mirrored(FLAT, (1, 0, 0)), "point"),
        (lambda: mirrored(FLAT, (1, 0), a), "unknown-letter"),
    ],
)
def test_what_is_refused(call, code):
    with pytest.raises(RsymError) as caught:
        call()
    assert caught.value.code == code
