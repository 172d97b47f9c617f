"""Fillets of bodies: the radius they promise, where they leave the body alone, parts, letters, meshes."""

from collections import Counter

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, x, y, z
from rsym.model.blends.fillets import fillet

BOX = ((-1.2, 1.2), (-0.8, 0.8), (-0.2, 1.4))


def slab(symbol, low, high):
    return (symbol - low) * (high - symbol) / (high - low)


def body(expression, name):
    return Shape(expression, (x, y, z), bounds=BOX).named(name)


def bracket(continuity):
    """An angle with a rounded inner edge and a hole with a rounded rim, cut from slabs."""
    base, wall = body(sp.Rational(3, 10) - z, "base"), body(-sp.Rational(7, 10) - x, "wall")
    hole = body((sp.Rational(1, 5) ** 2 - (x - sp.Rational(3, 10)) ** 2 - y**2) / sp.Rational(2, 5), "hole")
    angle = fillet(base, wall, sp.Rational(3, 10), continuity)
    rounded = fillet(angle, hole, sp.Rational(3, 20), continuity, "difference")
    around = rsym.conjunction(slab(x, -1, 1), slab(y, sp.Rational(-3, 5), sp.Rational(3, 5)), slab(z, 0, 1.3))
    return rounded & Shape(around, (x, y, z))


@pytest.mark.slow
@pytest.mark.parametrize("continuity", ["G1", "G2"])
def test_a_filleted_bracket_is_a_closed_body_with_its_parts(continuity):
    shape = bracket(continuity)
    assert [name for name, _ in shape.parts] == ["base", "wall", "hole"]
    mesh = rsym.mesh(shape, 96)
    edges = Counter(edge for a, b, c in mesh.faces.tolist() for edge in ((a, b), (b, c), (c, a)))
    assert set(edges.values()) == {1}
    assert all((b, a) in edges for a, b in edges)
    assert len(mesh.vertices) - len(edges) // 2 + len(mesh.faces) == 0, "one hole: Euler characteristic 0"


def test_the_circle_adds_what_a_circle_adds():
    """Area between two walls and the quarter circle: (1 - pi/4)*radius**2."""
    radius = 0.5
    half_planes = [Shape(-x, (x, y), bounds=((-1, 1), (-1, 1))), Shape(-y, (x, y))]
    axis = (np.arange(2000) + 0.5) / 2000
    points = np.meshgrid(axis, axis)
    added = rsym.compile(fillet(*half_planes, radius))(*points)["value"] > 0
    assert_close(added.mean(), (1 - np.pi / 4) * radius**2, rtol=1e-3)
    assert not added[points[0] ** 2 + points[1] ** 2 >= radius**2].any()


@pytest.mark.parametrize(("operation", "sign"), [("union", 1), ("intersection", -1), ("difference", -1)])
def test_outside_the_tube_nothing_is_moved_and_inside_material_goes_one_way(operation, sign):
    plain = {"union": rsym.disjunction, "intersection": rsym.conjunction, "difference": rsym.difference}[operation]
    points = np.meshgrid(np.linspace(-1, 1, 41), np.linspace(-1, 1, 41))
    sharp = rsym.compile(Shape(plain(x, y), (x, y)))(*points)["value"]
    far, near = np.hypot(*points) > 0.41, np.hypot(*points) < 0.39
    for continuity in ("G1", "G2"):
        shape = Shape(fillet(x, y, 0.4, continuity, operation), (x, y))
        change = rsym.compile(shape)(*points)["value"] - sharp
        assert (change[far] == 0).all()
        assert (sign * change[near] > 0).all()


def test_letters_of_radius_and_angle_are_letters_of_the_body():
    r, turn = sp.symbols("r turn", real=True)
    floor = Shape(-y, (x, y), bounds=((-1, 1), (-1, 1)))
    ramp = Shape(x * sp.sin(turn) - y * sp.cos(turn), (x, y), letters={turn: 1})
    # The ramp rises at the angle `turn`: above it is the wedge of opening pi - turn.
    shape = fillet(floor, ramp, r, angle=sp.pi - turn, letters={r: 0.25})
    assert set(shape.letters) == {"r", "turn"}
    kernel = rsym.compile(shape, ("value", "curvature"))
    for radius, angle in ((0.25, 1.0), (0.1, 0.5)):
        # The circle above the floor and the ramp that touches both, its lowest point towards the edge.
        half = (np.pi - angle) / 2
        centre = radius / np.sin(half)
        towards = np.array([-np.cos(half), np.sin(half)])
        point = towards * (centre - radius)
        fields = kernel(*point, letters={"r": radius, "turn": angle})
        assert_close(fields["value"], 0, atol=1e-15)
        assert_close(fields["curvature"], -1 / radius, rtol=1e-12)


def test_a_rounded_edge_of_curved_faces_keeps_to_the_faces():
    """Two spheres: away from the edge the boundary is that of the spheres, to order 1 normalised."""
    ball = [Shape((1 - (x - shift) ** 2 - y**2 - z**2) / 2, (x, y, z)) for shift in (-0.5, 0.5)]
    shape = fillet(*ball, 0.2, "G2")
    angle = np.linspace(0, 2 * np.pi, 7)
    kernel = rsym.compile(shape, ("value", "gradient"))
    fields = kernel(1.5 + 0 * angle, 0 * angle, 0 * angle)
    assert_close(fields["value"], 0 * angle, atol=1e-16)
    assert_close(np.linalg.norm(fields["gradient"], axis=-1), 1 + 0 * angle, rtol=1e-14)
    waist = kernel(0 * angle, 0.87 * np.cos(angle), 0.87 * np.sin(angle))["value"]
    assert (waist > 0).all(), "the edge is at radius sqrt(3)/2 = 0.866"


def test_what_is_promised_is_said():
    assert "radius 1/4" in fillet(x, y, sp.Rational(1, 4)).guarantee
    promise = fillet(x, y, 1, "G2", angle=sp.pi / 3).guarantee
    assert promise.endswith("G2")
    assert "-1/2" in promise


@pytest.mark.parametrize(
    ("make", "code"),
    [
        (lambda: fillet(x, y, 0), "positive"),
        (lambda: fillet(x, y, sp.Symbol("r")), "unknown-letter"),
        (lambda: fillet(x, y, 1, "C2"), "continuity"),
        (lambda: fillet(x, y, 1, operation="sum"), "operation"),
        (lambda: fillet(x, y, 1, angle=0), "parameter"),
        (lambda: fillet(x, y, 1, angle=4), "parameter"),
        (lambda: fillet(Shape(x, (x, y)), Shape(x, (x, y, z)), 1), "coordinates"),
    ],
)
def test_what_is_refused(make, code):
    with pytest.raises(RsymError) as caught:
        make()
    assert caught.value.code == code


def _from_round_box(points, halves, radius):
    """The signed distance of a box with round edges, positive inside."""
    beyond = np.abs(points) - (np.array(halves) - radius)
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return radius - outside - np.minimum(beyond.max(axis=1), 0)


ROUND = {
    "rectangle": (lambda: rsym.rectangle(6, 4, system=rsym.Rho(0.5)), (3, 2), 0.5),
    "box": (lambda: rsym.box(60, 40, 25, system=rsym.Rho(4)), (30, 20, 12.5), 4),
    "product": (lambda: rsym.product(rsym.strip(-3, 3), (4 - z**2) / 4, system=rsym.Rho(1)), (3, 9e9, 2), 1),
    "prism": (
        lambda: rsym.extrude(rsym.strip(-3, 3), -1, 2, system=rsym.Rho(1)).translate(0, 0, -0.5),
        (3, 9e9, 1.5),
        1,
    ),
}


@pytest.mark.parametrize("name", ROUND)
def test_the_edges_of_a_piece_under_rho_have_its_radius(name):
    made, halves, radius = ROUND[name]
    shape = made()
    reach = np.minimum(halves, 10 * radius) * 1.2
    points = np.random.default_rng(3).uniform(-1, 1, (20000, len(halves))) * reach
    near = np.abs(points) + np.array(halves) - reach / 1.2 if name == "box" else points
    truth = _from_round_box(near, halves, radius)
    inside = shape.contains(*near.T)
    clear = np.abs(truth) > 1e-12
    assert (inside == (truth > 0))[clear].all()
    assert 1000 < (truth > 0).sum() < 19000


@pytest.mark.parametrize(("sides", "made"), [(3, None), (4, [(2, 0), (0, 2), (-2, 0), (0, -2)]), (6, None)])
def test_the_corners_of_polygons_under_rho_have_its_radius(sides, made):
    """Half-planes as far as the corner, a circle there; parallel edges were joined before, and are no lengths then."""
    system = rsym.Rho(0.25)
    shape = rsym.polygon(made, system=system) if made else rsym.regular_polygon(sides, 2, system=system)
    points = np.random.default_rng(3).uniform(-2, 2, (20000, 2))
    normals = np.stack([f((2 * np.arange(sides) + 1) * np.pi / sides) for f in (np.cos, np.sin)])
    apothem = 2 * np.cos(np.pi / sides)
    corners = 2 * np.stack([f(2 * np.arange(sides) * np.pi / sides) for f in (np.cos, np.sin)])
    middles = corners * (1 - 0.25 / apothem)
    beyond = np.linalg.norm(points[:, :, None] - middles, axis=1) > 0.25
    along = corners / 2
    u = np.einsum("nik,ik->nk", points[:, :, None] - middles, along)
    v = np.einsum("nik,ik->nk", points[:, :, None] - middles, along[::-1] * [[-1], [1]])
    in_cone = np.abs(np.arctan2(v, u)) < np.pi / sides
    truth = (points @ normals < apothem).all(axis=1) & ~(beyond & in_cone).any(axis=1)
    assert (shape.contains(*points.T) == truth).all()


def test_a_polygon_under_rho_tells_of_corners_with_another_radius():
    for corners in ([(0, 0), (4, 0), (4, 3)], [(0, 0), (4, 0), (4, 2), (2, 2), (2, 4), (0, 4)]):
        with pytest.warns(rsym.RsymWarning, match="1/2 is not the radius of all corners"):
            rsym.polygon(corners, system=rsym.Rho(sp.Rational(1, 2)))


def test_the_rims_of_a_cylinder_under_rho_have_its_radius():
    shape = rsym.cylinder(5, 10, system=rsym.Rho(1))
    points = np.random.default_rng(3).uniform(-6, 6, (20000, 3))
    truth = _from_round_box(np.stack([np.hypot(*points[:, :2].T), points[:, 2]], axis=1), (5, 5), 1)
    assert (shape.contains(*points.T) == (truth > 0)).all()


def test_a_fillet_of_shapes_that_share_a_face_tells_how_far_it_moves_it():
    """On the axis the top of the right one lies where both operands are -radius*(1 - 1/sqrt(2)) = -0.146."""
    plate, block = rsym.rectangle(4, 2), rsym.rectangle(2, 2, (1, 0))
    with pytest.warns(rsym.RsymWarning, match="moves a face that its operands share, by") as caught:
        made = rsym.fillet(plate, block, 0.5)
    by = float(str(caught[0].message).split("share, by ")[1].split(" at ")[0])
    top = rsym.extent(made)[1][1] - 1
    assert 0.1 < by <= top + 1e-9
    outline = np.concatenate(list(rsym.level_lines(made)))
    assert by == pytest.approx(outline[:, 1].max() - 1, rel=0.05)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    "other", [rsym.rectangle(2, 6), rsym.rectangle(2, 2, (10, 0)), rsym.disc(1, (2, 1))], ids=["cross", "far", "disc"]
)
def test_a_fillet_that_moves_no_shared_face_is_silent(other):
    rsym.fillet(rsym.rectangle(4, 2), other, 0.5)


def test_the_fillet_of_shapes_has_its_radius():
    """Between sides of rectangles and beside a bore, whose leaves are parabolas: .516 to .528 for .5 with these."""
    cross = rsym.fillet(rsym.rectangle(6, 2).named("beam"), rsym.rectangle(2, 6), 0.5)
    angles = np.linspace(0.1, np.pi / 2 - 0.1, 40)
    values = rsym.compile(cross)(1.5 - 0.5 * np.cos(angles), 1.5 - 0.5 * np.sin(angles))["value"]
    assert abs(values).max() < 1e-14
    assert cross.part("beam").contains(2.9, 0.9)
    boss = rsym.fillet(rsym.box(8, 8, 2), rsym.cylinder(1, 6), 0.5)
    values = rsym.compile(boss)(1.5 - 0.5 * np.cos(angles), 0.0, 1.5 - 0.5 * np.sin(angles))["value"]
    assert abs(values).max() < 1e-14


def test_what_rounds_keeps_the_names_of_what_it_rounds():
    plate = rsym.extrude(rsym.rectangle(4, 2).named("outline"), 0, 1, system=rsym.Rho(0.1))
    assert plate.part("outline").contains(1.9, 0.9, 3)
