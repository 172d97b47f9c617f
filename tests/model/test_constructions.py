import warnings

import numpy as np
import pytest
import sympy as sp
from oracles.boundary_points import assert_normalised
from oracles.closeness import assert_close

import rsym
from rsym import Letter, RsymError, Shape, x, y, z

k, s, t = sp.symbols("k s t", real=True)
PLANE = Shape(1 - x**2 / 4 - x * y**3 + y, (x, y), bounds=((-2, 3), (-1, 2)))
BODY = Shape(1 - x**2 / 4 - x * y**3 + z * y, (x, y, z), bounds=((-2, 3), (-1, 2), (0, 1)))
RANDOM = np.random.default_rng(7)


def values(shape, points, letters=None):
    return rsym.compile(shape)(*points.T, letters=letters)["value"]


def turn(angle, axis):
    """By the exponential of the cross product's matrix, which shares nothing with Rodrigues' formula."""
    from scipy.linalg import expm

    a, b, c = np.asarray(axis, float) / np.linalg.norm(axis)
    return expm(angle * np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]]))


PLANE_MAPS = {
    "translate": (PLANE.translate(2, -3), np.eye(2), [2, -3]),
    "rotate": (PLANE.rotate(sp.Rational(7, 5)), turn(1.4, [0, 0, 1])[:2, :2], [0, 0]),
    "mirror": (PLANE.mirror((3, 4), 2), np.eye(2) - 2 * np.outer([0.6, 0.8], [0.6, 0.8]), [2.4, 3.2]),
    "mirror in an axis": (PLANE.mirror(y), np.diag([1, -1]), [0, 0]),
    "stretch": (PLANE.scale((2, 3)), np.diag([2, 3]), [0, 0]),
    "shear": (PLANE.shear(y, x, 2), np.array([[1, 0], [2, 1]]), [0, 0]),
}
SPACE_MAPS = {
    "translate": (BODY.translate((2, -3, 1)), np.eye(3), [2, -3, 1]),
    "rotate": (BODY.rotate(1, (1, -2, 2)), turn(1, [1, -2, 2]), [0, 0, 0]),
    "rotate about z": (BODY.rotate(1), turn(1, [0, 0, 1]), [0, 0, 0]),
    "rotate about x": (BODY.rotate(1, x), turn(1, [1, 0, 0]), [0, 0, 0]),
    "mirror": (BODY.mirror(z, 1), np.diag([1, 1, -1]), [0, 0, 2]),
    "shear": (BODY.shear(x, z, -1), np.array([[1, 0, -1], [0, 1, 0], [0, 0, 1]]), [0, 0, 0]),
}


@pytest.mark.parametrize("space", [False, True])
@pytest.mark.parametrize("name", sorted({*PLANE_MAPS, *SPACE_MAPS}))
def test_a_moved_shape_has_at_a_moved_point_the_value_of_the_shape(name, space):
    shape, maps = (BODY, SPACE_MAPS) if space else (PLANE, PLANE_MAPS)
    if name not in maps:
        return
    moved, matrix, shift = maps[name]
    box = np.array(shape.bounds)
    points = RANDOM.uniform(box[:, 0], box[:, 1], (200, len(box)))
    images = points @ np.asarray(matrix, float).T + shift
    assert_close(values(moved, images), values(shape, points), atol=1e-12)
    low, high = np.array(moved.bounds).T
    assert ((images >= low - 1e-12) & (images <= high + 1e-12)).all()


def test_a_centre_stays_where_it_is():
    centre = np.array([[1.0, 2.0]])
    for moved in (PLANE.rotate(1, centre=(1, 2)), PLANE.scale((2, 5), centre=(1, 2))):
        assert_close(values(moved, centre), values(PLANE, centre), atol=1e-13)
    assert_close(values(PLANE.scale(3, centre=(1, 2)), centre), 3 * values(PLANE, centre), atol=1e-13)


def test_what_keeps_angles_keeps_the_normalisation():
    disc = Shape((1 - x**2 - y**2) / 2, (x, y), bounds=((-1.2, 1.2), (-1.2, 1.2)))
    moved = disc.translate(k, 1, letters={k: 3}).rotate(2 * k).scale(k).mirror((1, k), k)
    assert moved.letters.keys() == {"k"}
    assert_normalised(moved, 1)
    with pytest.raises(AssertionError):
        assert_normalised(disc.scale((1, 2)), 1)


def test_parts_move_with_the_shape():
    moved = (PLANE.named("body") | Shape(x, (x, y)).named("half")).translate(1, 0).scale(2)
    assert [name for name, _ in moved.parts] == ["body", "half"]
    assert sp.expand(moved.parts[1][1]) == x - 2


def test_letters_of_a_motion_are_those_of_the_shape():
    moved = PLANE.translate(k, s, letters={k: 1, s: Letter(2, minimum=0)})
    assert moved.bounds is None  # letters move it
    assert moved.box.ends == ((-1, 4), (1, 4))
    with pytest.raises(RsymError, match="s"):
        PLANE.translate(k, s, letters={k: 1})
    with pytest.raises(RsymError, match="two things"):
        moved.rotate(k, letters={k: 2})


@pytest.mark.parametrize(
    "wrong",
    [
        lambda: PLANE.translate(1),
        lambda: PLANE.translate("x", 1),
        lambda: PLANE.rotate(1, (0, 0, 1)),
        lambda: BODY.rotate(1, (0, 0, 0)),
        lambda: BODY.rotate(1, "w"),
        lambda: PLANE.scale(0),
        lambda: PLANE.scale((1, 2, 3)),
        lambda: PLANE.mirror((0, 0)),
        lambda: PLANE.shear(x, x, 1),
        lambda: PLANE.rotate(sp.oo),
        lambda: rsym.extrude(BODY, 0, 1),
        lambda: rsym.extrude(PLANE, 1, 1),
        lambda: rsym.extrude(Shape(x + z, (x, y), letters={z: 1}), 0, 1),
        lambda: rsym.product(PLANE, x),
        lambda: rsym.section(PLANE, x),
        lambda: rsym.section(BODY, "w"),
        lambda: rsym.sweep(PLANE, {k: z}, 0, 1),
        lambda: rsym.sweep(PLANE, {}, 0, 1),
        lambda: rsym.sweep(PLANE, [(k,)], 0, 1),
        lambda: rsym.shell(PLANE, -1),
        lambda: rsym.offset(PLANE, "wide"),
        lambda: rsym.transform(PLANE, {z: x}),
        lambda: rsym.transform(PLANE, [x]),
        lambda: rsym.transform(PLANE, 3),
    ],
)
def test_what_cannot_be_is_refused(wrong):
    with pytest.raises(RsymError):
        wrong()


@pytest.mark.slow
def test_a_prism_is_normalised_and_has_its_volume():
    disc = Shape((k**2 - x**2 - y**2) / (2 * k), (x, y), letters={k: 2}, bounds=((-2.2, 2.2), (-2.2, 2.2)))
    prism = rsym.extrude(disc, -k, 3)
    assert_normalised(prism, 1)
    assert prism.bounds == ((-2.2, 2.2), (-2.2, 2.2), (-2.5, 3.5))
    mesh = rsym.mesh(prism, 64)
    assert "closed" in str(mesh.status)
    corners = mesh.vertices[mesh.faces]
    volume = np.linalg.det(corners).sum() / 6
    assert_close(volume, np.pi * 4 * 5, rtol=5e-3)


def test_extruding_in_another_system():
    assert rsym.extrude(PLANE, 0, 1, system=rsym.R1).expression == rsym.R1.conjunction(PLANE.expression, (1 - z) * z)


def test_a_product_is_inside_where_both_factors_are():
    body = rsym.product(PLANE, sp.sin(z))
    points = RANDOM.uniform(-3, 3, (500, 3))
    both = (values(PLANE, points[:, :2]) > 0) & (np.sin(points[:, 2]) > 0)
    assert ((values(body, points) > 0) == both).all()


def test_a_section_is_the_body_in_its_plane():
    cut = rsym.section(BODY, x, y + k, letters={k: sp.Rational(1, 2)})
    assert [symbol.name for symbol in cut.coordinates] == ["y", "z"]
    points = RANDOM.uniform(-1, 1, (50, 2))
    whole = np.column_stack([points[:, 0] + 0.5, points])
    assert_close(values(cut, points), values(BODY, whole), atol=1e-13)
    assert cut.bounds == ((-1, 2), (0, 1))


def test_a_sweep_has_at_each_height_the_profile_of_that_height():
    profile = Shape(k**2 - x**2 - s * y**2, (x, y), letters={k: 2, s: 3}, bounds=((-2, 2), (-2, 2)))
    body = rsym.sweep(profile, {k: 2 - z / 4 + s, "s": t * z + s}, 0, t, letters={t: 4})
    assert body.letters.keys() == {"s", "t"}
    assert body.bounds is None
    points = RANDOM.uniform(-2, 2, (50, 2))
    for height in (1.0, 3.0):
        lifted = np.column_stack([points, np.full(50, height)])
        inside = values(profile, points, {"k": 5 - height / 4, "s": 4 * height + 3})
        assert ((values(body, lifted) > 0) == (inside > 0)).all()


def test_a_sweep_that_grows_is_not_cut_by_the_bounds_of_its_profile():
    profile = Shape(k**2 - x**2 - y**2, (x, y), letters={k: 1}, bounds=((-1.2, 1.2),) * 2)
    body = rsym.sweep(profile, {k: 1 + z / 2}, 0, 4)
    found = rsym.mesh(body, 24)
    assert found.status.closed
    assert not found.status.clipped
    assert_close(found.vertices[:, 0].max(), 3, atol=0.02)


def test_a_letter_that_is_known_to_be_positive_is_swept_too():
    r = sp.Symbol("r", positive=True)
    body = rsym.sweep(rsym.disc(r, letters={r: 2}), {"r": 2 - z / 4}, 0, 4)
    assert not body.letters
    assert body.expression.free_symbols == {x, y, z}


def test_a_shell_is_a_wall_of_its_thickness():
    ball = Shape(2 - sp.sqrt(x**2 + y**2 + z**2), (x, y, z), bounds=((-2.2, 2.2),) * 3)
    wall = rsym.shell(ball, k, letters={k: sp.Rational(1, 2)})
    radii = np.array([1.4, 1.6, 1.9, 2.1])
    along = np.outer(radii, [0.48, 0.6, 0.64])
    assert (np.sign(values(wall, along)) == [-1, 1, 1, -1]).all()
    assert_normalised(wall, 1)
    grown = rsym.offset(ball, k, letters={k: 3})
    assert grown.bounds == (((-5.2, 5.2),) * 3)
    assert_close(values(grown, along), 5 - radii, atol=1e-14)
    assert rsym.offset(ball, -1).bounds == ball.bounds


def test_a_map_is_renormalised_on_request():
    disc = Shape((4 - x**2 - y**2) / 4, (x, y))
    bent = rsym.transform(disc, [x, y - k * x**2], bounds=((-2, 2), (-2, 6)), letters={k: 1})
    assert_close(values(bent, np.array([[1.0, 2.5]])), values(disc, np.array([[1.0, 1.5]])), atol=1e-15)
    assert_normalised(rsym.transform(disc, {y: y - x**2}, renormalise=True, bounds=bent.bounds), 1)
    with pytest.raises(AssertionError):
        assert_normalised(bent, 1)


SOLIDS = {
    "box": (rsym.box(60, 40, 25), 2, 60 * 40 * 25 - 56 * 36 * 21),
    "cube": (rsym.box(20, 20, 20), 2, 20**3 - 16**3),
    "cylinder": (rsym.cylinder(5, 10), 1, np.pi * (25 * 10 - 16 * 8)),
    "drilled": (rsym.box(8, 8, 4) - rsym.cylinder(1, 9), 1, (64 - np.pi) * 4 - (36 - 4 * np.pi) * 2),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_the_walls_of_a_shell_have_the_thickness_that_was_asked_for(name):
    body, thickness, volume = SOLIDS[name]
    assert_close(rsym.measure(rsym.shell(body, thickness)).volume, volume, rtol=1e-9)


def test_an_offset_piece_is_the_piece_of_other_numbers():
    assert rsym.offset(rsym.disc(10), 2).expression == rsym.disc(12).expression
    assert rsym.offset(rsym.box(60, 40, 25), -2).expression == rsym.box(56, 36, 21).expression
    assert rsym.offset(~rsym.sphere(3), 1).expression == (~rsym.sphere(2)).expression
    assert rsym.offset(rsym.disc(2).scale(3), -1).expression == rsym.disc(5).expression
    assert rsym.offset(rsym.slab(1, 4, (0, 3, 4)), 1).expression.equals(rsym.slab(0, 5, (0, 3, 4)).expression)


# Of each the true distance from the boundary, written by hand.
def _to_segment(p, end):
    share = np.clip(p @ end / (end @ end), 0, 1)
    return np.linalg.norm(p - share[:, None] * end, axis=1)


LONE = {
    "ball": (rsym.sphere(2, (1, 2, 3)), lambda p: 2 - np.linalg.norm(p - [1, 2, 3], axis=1)),
    "ring": (
        rsym.torus(3, 1).rotate(1, (1, 2, 3)),
        lambda p: 1 - np.hypot(np.hypot(*(p @ turn(1, [1, 2, 3])).T[:2]) - 3, (p @ turn(1, [1, 2, 3]))[:, 2]),
    ),
    "capsule": (
        rsym.capsule((0, 0, 0), (1, 2, 2), sp.Rational(3, 2)),
        lambda p: 1.5 - _to_segment(p, np.array([1.0, 2.0, 2.0])),
    ),
    "slab": (rsym.slab(0, 3, (1, 2, 2)), lambda p: 1.5 - np.abs(p @ [1 / 3, 2 / 3, 2 / 3] - 1.5)),
    "cylinder": (
        rsym.cylinder(2).rotate(0.12345678912345, x),
        lambda p: 2 - np.hypot(*(p @ turn(0.12345678912345, [1, 0, 0])).T[:2]),
    ),
    "not normalised": (Shape(4 - x**2 - y**2 - z**2, (x, y, z)), lambda p: 2 - np.linalg.norm(p, axis=1)),
    "a letter": (rsym.sphere(k, letters={k: 2}), lambda p: 2 - np.linalg.norm(p, axis=1)),
}


@pytest.mark.parametrize("name", LONE)
@pytest.mark.parametrize("distance", [sp.Rational(-1, 2), sp.Rational(3, 4), -5])
def test_every_leaf_that_knows_its_distance_is_moved_by_it(name, distance):
    shape, truth = LONE[name]
    points = RANDOM.uniform(-5, 5, (400, 3))
    expected = truth(points) + float(distance)
    moved = values(rsym.offset(shape, distance), points)
    clear = np.abs(expected) > 1e-9
    assert (np.sign(moved) == np.sign(expected))[clear].all()
    near = np.abs(expected) < 1e-2
    assert_close(moved[near], expected[near], atol=1e-3)


def test_where_no_leaf_knows_the_thickness_its_range_is_told():
    """Of the ellipse: at its vertices the depth of omega is 1/2 where s*(1 + s/(2*a)) tells it otherwise."""
    with pytest.warns(rsym.RsymWarning, match=r"the thickness is 0\.45\d* to 0\.47\d* instead of 0\.5: omega measures"):
        rsym.shell(rsym.ellipse(3, 2), sp.Rational(1, 2))
    with pytest.warns(rsym.RsymWarning, match=r"the offset is 1 to 1\.4\d* instead of 1: edges keep their corners"):
        rsym.offset(rsym.rectangle(6, 4), 1)
    with pytest.warns(rsym.RsymWarning, match="could not be measured"):
        rsym.shell(Shape(x - y**2, (x, y)), 1)
    rsym.offset(rsym.disc(1) | rsym.disc(1, (1, 0)), 1)  # unions grow exactly


def test_small_offsets_of_wide_bodies_are_measured_to_rounding():
    """At the sharp edges of a cube that grows by d the distance is d*sqrt(3); chords of the ball are off by more."""
    wide = rsym.sphere(8) | rsym.box(5, 5, 5).translate(40, 0, 0)
    with pytest.warns(rsym.RsymWarning, match=r"the offset is 0\.02 to 0\.03464 instead of 0\.02: edges keep"):
        rsym.offset(wide, sp.Rational(1, 50))


@pytest.mark.slow
def test_no_range_is_told_for_walls_that_the_lattice_cannot_see():
    """Of the bore, whose mesh has holes in its wall, the nearest chord is on a lid: .6 for .24."""
    bored = rsym.box(4.85, 4.3, 4.7) - rsym.cylinder(sp.Rational(3, 4), 40)
    bodies = rsym.box(7.7, 6.95, 4.15) | bored.translate(40, 0, 0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rsym.offset(bodies.rotate(sp.Rational(5, 2), axis="x"), -sp.Rational(6, 25))


def test_a_distance_in_letters_has_no_term_that_cancels():
    """sin**2 + cos**2 of a turn stayed in it: 2 500 characters."""
    r = sp.Symbol("r", real=True)
    turned = rsym.sphere(r, (1, 2, 3), letters={r: 1}).rotate(sp.Rational(3, 2), axis="x")
    assert len(str(rsym.offset(turned, 1).expression)) < 200


def test_a_shell_thicker_than_the_body_is_the_body():
    wall = rsym.shell(rsym.disc(1), 2)
    points = RANDOM.uniform(-2, 2, (200, 2))
    assert (np.sign(values(wall, points)) == np.sign(1 - np.linalg.norm(points, axis=1))).all()


def test_a_fillet_grows_with_the_body():
    corner = Shape(rsym.conjunction(4 - x, 3 - y, system=rsym.Rho(1)), (x, y))
    grown = rsym.offset(corner, sp.Rational(1, 2))
    assert grown.expression == rsym.conjunction(sp.Rational(9, 2) - x, sp.Rational(7, 2) - y, system=rsym.Rho(1.5))
