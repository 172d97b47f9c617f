"""Sharp meshes against formulas, and against trimesh and manifold3d, which share no code with them."""

import contextlib
import itertools

import manifold3d
import numpy as np
import pytest
import sympy as sp
import trimesh
from oracles.closeness import assert_close
from oracles.trees import LEAVES
from scipy.spatial import ConvexHull, HalfspaceIntersection

import rsym
from rsym import x, y, z
from rsym.logic.sign_form import surface_form
from rsym.sampling.kernels.mesher_kernels import mesher_kernels
from rsym.sampling.lattice import SHIFTS, lattice_over
from rsym.sampling.regions.region_kernels import region_kernels
from rsym.sampling.sharp.corners import on_active_leaf, solve

AXES = (x, y, z)


def cube(half):
    return ((-half, half),) * 3


def rotation(seed):
    quaternion = np.random.default_rng(seed).normal(size=4)
    return trimesh.transformations.quaternion_matrix(quaternion / np.linalg.norm(quaternion))[:3, :3]


def accepted(mesh, euler_characteristic=None):
    """The status of a mesh that manifold3d accepts."""
    status = mesh.status
    strict = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.faces.astype(np.uint64)))
    assert strict.status() == manifold3d.Error.NoError
    assert (status.closed, status.pinched, status.duplicates) == (True, 0, 0)
    if euler_characteristic is not None:
        assert status.euler_characteristic == euler_characteristic
    return status


def judged(mesh, euler_characteristic=None):
    """And that trimesh accepts."""
    status = accepted(mesh, euler_characteristic)
    other = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert other.is_watertight
    assert other.is_winding_consistent
    assert other.euler_number == status.euler_characteristic
    assert_close([status.volume, status.area], [other.volume, other.area], rtol=1e-9)
    return status


def flawless(mesh, euler_characteristic):
    """The status of a mesh without any remark but of clipping."""
    status = judged(mesh, euler_characteristic)
    assert (status.folded, status.degenerate, status.off_surface) == (0, 0, None)
    return status


def letters(count):
    return sp.symbols(f"n:{count}", real=True)


def values(numbers):
    return {f"n{k}": float(number) for k, number in enumerate(np.ravel(numbers))}


@pytest.fixture(scope="module")
def polyhedra():
    """A mesher of bodies within eight planes n.x <= d: letters n, d plane by plane."""
    names = letters(32)
    planes = [names[k + 3] - sum(n * s for n, s in zip(names[k : k + 3], AXES, strict=True)) for k in range(0, 32, 4)]
    return rsym.Mesher(rsym.Shape(rsym.conjunction(*planes), AXES, letters=dict.fromkeys(names, 1), bounds=cube(2)))


def polyhedron(normals, distances):
    """Letters of a body within at most eight planes; the others are far away."""
    planes = np.tile([0, 0, 1.0, 9.0], (8, 1))
    planes[: len(normals)] = np.column_stack([normals, distances])
    return values(planes)


def hull(normals, distances):
    """The same body by scipy."""
    corners = HalfspaceIntersection(np.column_stack([normals, -np.asarray(distances)]), np.zeros(3)).intersections
    return ConvexHull(corners)


def nearest(points, corners):
    """How far the farthest of some corners is from the points."""
    return max(np.linalg.norm(points - corner, axis=1).min() for corner in corners)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 6, 11])
def test_a_rotated_cube_is_exact(polyhedra, seed):
    """Seed 6: a lattice point that is cut off from the others near a corner makes no crumb there."""
    turn = rotation(seed)
    mesh = polyhedra(64, letters=polyhedron([*turn, *-turn], np.ones(6)))
    status = flawless(mesh, 2)
    assert_close([status.volume, status.area], [8, 24], rtol=1e-12)
    assert nearest(mesh.vertices, np.array(list(itertools.product((-1, 1), repeat=3))) @ turn) < 1e-12
    lengths = [np.linalg.norm(np.diff(edge.points, axis=0), axis=1).sum() for edge in mesh.features]
    assert_close(lengths, [2] * 12, rtol=1e-12)
    assert_close([edge.angle for edge in mesh.features], [90] * 12, rtol=1e-12)


@pytest.mark.random
@pytest.mark.parametrize("sides", [3, 4, 5, 6, 7])
def test_pyramids_are_exact(polyhedra, sides):
    """As many planes as sides meet in the tip."""
    turn = rotation(sides)
    around = 2 * np.pi * np.arange(sides) / sides + 0.1
    normals = np.vstack([np.column_stack([np.cos(around), np.sin(around), np.full(sides, 0.8)]), [[0, 0, -1]]]) @ turn
    distances = np.array([0.45] * sides + [0.5])
    status = flawless(polyhedra(48, letters=polyhedron(normals, distances)), 2)
    body = hull(normals, distances)
    assert_close([status.volume, status.area], [body.volume, body.area], rtol=1e-11)


@pytest.fixture(scope="module")
def wedges():
    """Meshers of what is within six planes and both of two others, or either of them."""
    names = letters(32)
    planes = [names[k + 3] - sum(n * s for n, s in zip(names[k : k + 3], AXES, strict=True)) for k in range(0, 32, 4)]
    given = {"letters": dict.fromkeys(names, 1), "bounds": cube(1.7)}
    either = rsym.conjunction(*planes[:6], rsym.disjunction(*planes[6:]))
    return [rsym.Mesher(rsym.Shape(body, AXES, **given)) for body in (rsym.conjunction(*planes), either)]


@pytest.mark.random
@pytest.mark.parametrize("angle", [30, 45, 60, 90, 135, 170, 179, 181, 190, 225, 270, 285])
def test_wedges_of_any_angle_are_exact(wedges, angle):
    turn, radians = rotation(angle), np.radians(angle)
    box = np.column_stack([np.vstack([turn, -turn]), [0.9, 0.9, 0.8, 0.9, 0.9, 0.7]])
    sides = np.array([[0, -1, 0], [-np.sin(radians), np.cos(radians), 0]]) @ turn
    mesh = wedges[angle > 180](47, letters=values(np.vstack([box, np.column_stack([sides, [0.01, 0]])])))
    block = manifold3d.Manifold.cube((1.8, 1.8, 1.5)).translate((-0.9, -0.9, -0.7))
    halves = [block.trim_by_plane(-(side @ turn.T), -distance) for side, distance in zip(sides, (0.01, 0), strict=True)]
    body = halves[0] + halves[1] if angle > 180 else halves[0] ^ halves[1]
    status = flawless(mesh, 2)
    # manifold3d merges what is closer than 1e-12 or so.
    assert_close([status.volume, status.area], [body.volume(), body.surface_area()], rtol=1e-9)


SMOOTH = {
    "sphere": (1 - x**2 - y**2 - z**2, 4 / 3 * np.pi, 4 * np.pi),
    "torus": (
        sp.Rational(9, 100) - (sp.sqrt(x**2 + y**2) - sp.Rational(3, 4)) ** 2 - z**2,
        2 * np.pi**2 * 0.75 * 0.09,
        4 * np.pi**2 * 0.75 * 0.3,
    ),
    # A spheroid: its area has a closed form.
    "ellipsoid": (1 - x**2 - y**2 - 4 * z**2, 2 / 3 * np.pi, 2 * np.pi * (1 + np.arctanh(np.sqrt(0.75)) / np.sqrt(12))),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SMOOTH)
def test_smooth_bodies_converge_with_the_square_of_the_cell(name):
    expression, volume, area = SMOOTH[name]
    shape = rsym.Shape(expression, AXES, bounds=cube(1.1))
    mesher, value = rsym.Mesher(shape), rsym.compile(shape)
    errors = []
    for cells in (32, 64, 128):
        mesh = mesher(cells)
        status = flawless(mesh, 0 if name == "torus" else 2)
        errors.append([abs(status.volume - volume), abs(status.area - area)])
        assert np.abs(value(*mesh.vertices.T)["value"]).max() < 1e-12
    assert (np.log2(np.divide(errors[:-1], errors[1:])) > 1.95).all()


BALL = 1 - x**2 - y**2 - z**2


def torus(radius, thickness, shift, across, along):
    return thickness**2 - (sp.sqrt((x - shift) ** 2 + across**2) - radius) ** 2 - along**2


def plate(holes):
    """A plate with round holes in a row."""
    half = sp.Rational(3, 5) * (holes + 1)
    middles = [sp.Rational(6, 5) * (k - sp.Rational(holes - 1, 2)) for k in range(holes)]
    bored = [(x - middle) ** 2 + y**2 - sp.Rational(4, 25) for middle in middles]
    return rsym.conjunction(sp.Rational(9, 100) - z**2, 1 - y**2, half - x, half + x, *bored)


def boxed(half):
    return rsym.conjunction(*[half - sign * axis for axis in AXES for sign in (1, -1)])


TOPOLOGY = {
    **{f"{holes} holes": (plate(holes), 2 - 2 * holes) for holes in (0, 1, 2, 5)},
    "a hollow ball": (rsym.difference(BALL, sp.Rational(1, 2) - x**2 - y**2 - z**2), 4),
    "a hollow box": (rsym.difference(boxed(1), boxed(sp.Rational(3, 5))), 4),
    "linked tori": (
        rsym.disjunction(torus(1, sp.Rational(1, 4), 0, y, z), torus(1, sp.Rational(1, 4), 1, z, y)),
        0,
    ),
    "crossing cylinders": (rsym.conjunction(1 - x**2 - y**2, 1 - x**2 - z**2), 2),
    "a pierced ball": (rsym.difference(BALL, sp.Rational(1, 4) - x**2 - y**2), 0),
    "two balls": (rsym.disjunction(BALL.subs(x, x - 1), BALL.subs(x, x + sp.Rational(1, 2))), 2),
}


@pytest.mark.random
@pytest.mark.parametrize("name", TOPOLOGY)
def test_the_euler_characteristic_is_exact(name):
    expression, expected = TOPOLOGY[name]
    bounds = ((-3.7, 3.7), (-1.6, 1.6), (-1.6, 1.6))
    status = flawless(rsym.mesh(rsym.Shape(expression, AXES, bounds=bounds), 121), expected)
    assert status.unresolved == ()


def test_intersections_of_curved_leaves_converge_too():
    """Crossing cylinders: 16/3 and 16; their edges are vertices on both leaves."""
    expression, _ = TOPOLOGY["crossing cylinders"]
    mesher, errors = rsym.Mesher(rsym.Shape(expression, AXES, bounds=cube(1.3))), []
    for cells in (32, 64):
        mesh = mesher(cells)
        status = flawless(mesh, 2)
        errors.append([abs(status.volume - 16 / 3), abs(status.area - 16)])
        for edge in mesh.features:
            a, b, c = edge.points.T
            assert np.abs(np.stack([1 - a**2 - b**2, 1 - a**2 - c**2])).max() < 1e-12
    assert (np.log2(np.divide(errors[0], errors[1])) > 1.95).all()


SQUARE, SLAB = rsym.conjunction(1 - x, 1 + x, 1 - y, 1 + y), rsym.conjunction(1 - z, 1 + z)
# Leaves with kinks, or with R-operations inside.
OTHERS = {
    "octahedron": (1 - abs(x) - abs(y) - abs(z), 2),
    "square ring": (sp.Rational(1, 2) - abs(sp.sqrt(x**2 + y**2) - 1) - abs(z), 0),
    "leaning box": (1 - sp.Max(abs(x), abs(y), abs(z)) - z / 10, 2),
    "pieces": (sp.Piecewise((BALL, x < 0), (1 - y**2 - z**2 - x**2 / 2, True)), 2),
    "joined bars": (
        sp.Rational(1, 4)
        - rsym.joining(rsym.trimming(sp.sqrt(y**2 + z**2), 1 - x**2), rsym.trimming(sp.sqrt(x**2 + z**2), 1 - y**2)),
        2,
    ),
    "blend": (rsym.conjunction(SQUARE, SLAB) + sp.Rational(1, 5) / (1 + SQUARE**2 + SLAB**2), 2),
    "R inside": (rsym.conjunction(1 - x**2, 1 - y**2) + rsym.disjunction(x, y) / 10 - z**2, 2),
    "charges": (sp.exp(-(x**2) - y**2 - z**2) + sp.exp(-2 * ((x - 1) ** 2 + y**2 + z**2)) - sp.Rational(1, 2), 2),
    "trimmed": (sp.Rational(1, 4) - rsym.trimming(sp.sqrt(y**2 + z**2), 1 - x**2), 2),
}


@pytest.mark.random
@pytest.mark.parametrize("name", OTHERS)
def test_leaves_that_are_no_sign_form_keep_the_promises(name):
    expression, expected = OTHERS[name]
    shape = rsym.Shape(expression, AXES, bounds=cube(2.2))
    mesh = rsym.Mesher(shape)(53)
    status = judged(mesh, expected)
    assert (status.degenerate, status.off_surface) == (0, None)
    assert status.folded_share < 1e-4
    assert np.abs(rsym.compile(shape)(*mesh.vertices.T)["value"]).max() < 1e-10


@pytest.mark.slow
@pytest.mark.parametrize("system", [rsym.R1, rsym.RAlpha(sp.Rational(1, 3)), rsym.R0m(2), rsym.Rp(3)], ids=str)
def test_all_systems_give_the_same_bits(system):
    def body(s):
        expression = s.disjunction(s.conjunction(1 - x**2 - y**2, 1 - z**2), BALL.subs(x, x - 1))
        return rsym.Shape(expression, AXES, bounds=cube(2.1))

    same(rsym.mesh(body(system), 24), rsym.mesh(body(rsym.R0), 24))
    same(rsym.mesh(rsym.normalise(body(system)), 24), rsym.mesh(body(rsym.R0), 24))


def same(mesh, other):
    assert np.array_equal(mesh.faces, other.faces)
    for one, another in ((mesh.vertices, other.vertices), (mesh.normals, other.normals)):
        assert one.tobytes() == another.tobytes()


def test_a_letter_that_is_changed_gives_what_a_fresh_mesh_does():
    r = sp.Symbol("r", real=True)
    expression = rsym.difference(rsym.conjunction(r**2 - x**2 - y**2, 1 - z**2), r / 4 - x**2 - z**2)
    mesher = rsym.Mesher(rsym.Shape(expression, AXES, letters={r: 1}, bounds=cube(1.7)))
    for radius in (0.7, 1.3, 0.7):
        fresh = rsym.mesh(rsym.Shape(expression, AXES, letters={r: radius}, bounds=cube(1.7)), 32)
        same(mesher(32, letters={"r": radius}), fresh)


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1e-40, 1e-9, 1e6, 1e40])
def test_no_scale_is_too_small_or_too_large(scale):
    k = sp.Float(scale)
    expression = rsym.difference(rsym.conjunction(k**2 - x**2 - y**2, k - z, k + z), k**2 / 4 - x**2 - z**2)
    mesh = rsym.mesh(rsym.Shape(expression, AXES, bounds=cube(1.3 * scale)), 32)
    unit = rsym.Shape(expression.subs({s: s * k for s in AXES}), AXES, bounds=cube(1.3))
    assert_close(flawless(mesh, 0).volume / scale**3, flawless(rsym.mesh(unit, 32), 0).volume, rtol=1e-12)


@pytest.mark.slow
def test_a_body_a_million_from_the_origin_has_its_edges():
    turn, far = rotation(5), 1e6
    planes = [
        1 - sum(sp.Float(float(n)) * (s - far) for n, s in zip(row, AXES, strict=True)) for row in [*turn, *-turn]
    ]
    mesh = rsym.mesh(rsym.Shape(rsym.conjunction(*planes), AXES, bounds=((far - 1.9, far + 1.9),) * 3), 48)
    assert_close(flawless(mesh, 2).volume, 8, rtol=1e-10)


@pytest.mark.parametrize("cells", [(20, 40, 80), (100, 10, 10)])
def test_cells_may_be_long(polyhedra, cells):
    turn = rotation(5)
    status = flawless(polyhedra(cells, letters=polyhedron([*turn, *-turn], np.ones(6))), 2)
    assert_close([status.volume, status.area], [8, 24], rtol=1e-12)


def open_sides(status):
    return sorted(loop.sides for loop in status.loops)


@pytest.mark.slow
def test_what_leaves_the_bounds_is_capped_or_left_open_there():
    """A ball through all six sides of a box, and what it leaves of the box: a frame."""
    sides = [(f"the {end} end of {axis}",) for end in ("lower", "upper") for axis in "xyz"]
    radius = 1.3
    for inside in (1, -1):
        shape = rsym.Shape(inside * (sp.Float(radius) ** 2 - x**2 - y**2 - z**2), AXES, bounds=cube(1))
        mesher = rsym.Mesher(shape)
        status = flawless(mesher(40), 2 if inside > 0 else -8)
        caps = np.pi * (radius - 1) ** 2 * (2 * radius + 1) / 3
        ball = 4 / 3 * np.pi * radius**3 - 6 * caps
        assert_close(status.volume, ball if inside > 0 else 8 - ball, rtol=4e-3)
        status = mesher(40, cap=False).status
        assert status.clipped
        assert not status.capped
        assert open_sides(status) == sorted(sides)


def test_a_tube_is_open_at_both_ends():
    status = rsym.Mesher(rsym.Shape(1 - x**2 - y**2, AXES, bounds=cube(1.3)))(24, cap=False).status
    assert open_sides(status) == [("the lower end of z",), ("the upper end of z",)]
    assert (status.genera, status.repeated_edges) == ((0,), 0)


@pytest.mark.slow
def test_corners_at_caps_that_no_crossing_shows_are_found():
    """A knife's edge that leaves the bounds: its cells see two leaves, and a third and a fourth cut it."""
    blade = rsym.conjunction(x * y / 3 - z, sp.Rational(3, 2) - x**2 / 4 - (y - z) ** 2)
    mesher = rsym.Mesher(rsym.Shape(blade, AXES, bounds=((-1.6, 1.5), (-1.5, 1.7), (-1.4, 1.6))))
    assert [mesher(cells).status.off_surface for cells in (12, 17, 21, 24)] == [None] * 4


@pytest.mark.random
@pytest.mark.parametrize("thickness", [0.01, 0.001])
@pytest.mark.parametrize("cells", [16, 48])
def test_shells_thinner_than_a_cell_are_named(thickness, cells):
    shell = rsym.conjunction(BALL, x**2 + y**2 + z**2 - (1 - sp.Float(thickness)) ** 2)
    status = judged(rsym.Mesher(rsym.Shape(shell, AXES, bounds=cube(1.2)))(cells))
    walls = [suspect for suspect in status.unresolved if suspect.kind == "wall"]
    assert walls
    assert_close(min(wall.thickness for wall in walls), thickness * cells / 2.4, rtol=1e-3)


@contextlib.contextmanager
def unless_empty():
    try:
        yield
    except rsym.RsymError as refusal:
        if refusal.code != "no-surface":
            raise


def random_tree(generator, leaves):
    if len(leaves) == 1:
        return leaves[0] * generator.choice([1, -1])
    first = int(generator.integers(1, len(leaves)))
    joined = (rsym.conjunction, rsym.disjunction)[generator.integers(2)]
    return joined(random_tree(generator, leaves[:first]), random_tree(generator, leaves[first:]))


def off_is_told(status, bounds, kernel, mesh, chosen=None):
    caps = (np.abs(mesh.vertices.T[:, :, None] - np.array(bounds)[:, None]) < 1e-9).any(axis=(0, 2))
    value = kernel(*mesh.vertices[~caps].T, letters=chosen)["value"]
    assert status.off_surface is not None or not value.size or np.abs(value).max() < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("count", [2, 3, 5, 8])
def test_random_trees_of_quadrics_are_manifolds(count):
    """25 each. Coarse: edges as sharp as knives, tips, touching bodies; what is off the surface is told."""
    generator, names = np.random.default_rng(count), letters(7 * count)
    terms = (1, x, y, z, x**2, y**2, x * z)
    leaves = [
        sum(name * term for name, term in zip(names[k : k + 7], terms, strict=True)) for k in range(0, 7 * count, 7)
    ]
    tree = random_tree(generator, leaves)
    shape = rsym.Shape(tree, AXES, letters=dict.fromkeys(names, 1), bounds=((-1.6, 1.5), (-1.5, 1.7), (-1.4, 1.6)))
    mesher, kernel, meshes = rsym.Mesher(shape), rsym.compile(shape), 0
    for _ in range(25):
        chosen = values(generator.normal(size=7 * count))
        with unless_empty():
            mesh = mesher(12, letters=chosen)
            status = judged(mesh)
            assert status.degenerate == 0
            off_is_told(status, shape.bounds, kernel, mesh, chosen)
            meshes += 1
    assert meshes > 15


@pytest.mark.slow
def test_random_trees_of_all_kinds_are_manifolds():
    generator = np.random.default_rng(1)
    for count in (3, 6, 12, 24):
        leaves = [LEAVES[k] for k in generator.integers(len(LEAVES), size=count)]
        shape = rsym.Shape(random_tree(generator, leaves), AXES, bounds=((-1.6, 1.5), (-1.5, 1.7), (-1.4, 1.6)))
        with unless_empty():
            mesh = rsym.Mesher(shape)(14)
            status = judged(mesh)
            assert status.degenerate == 0
            off_is_told(status, shape.bounds, rsym.compile(shape), mesh)


@pytest.mark.slow
def test_exact_zeros_on_lattice_points():
    """Integer polynomials on a lattice of integers, which these bounds undo the shift of."""
    generator = np.random.default_rng(2)
    names = letters(10)
    terms = [1, x, y, z, x * y, y * z, z * x, x**2, y**2, z**2]
    bounds = tuple((shift - 4, shift + 4) for shift in SHIFTS)
    quadric = sum(name * term for name, term in zip(names, terms, strict=True))
    shape = rsym.Shape(rsym.conjunction(quadric, x * y - z + 2), AXES, letters=dict.fromkeys(names, 1), bounds=bounds)
    mesher, value = rsym.Mesher(shape), rsym.compile(shape)
    axes, zeros, meshes = lattice_over(bounds, 8).open_axes(), 0, 0
    for _ in range(20):
        chosen = values(generator.integers(-2, 3, 10))
        zeros += np.count_nonzero(value(*axes, letters=chosen)["value"] == 0)
        with unless_empty():
            assert judged(mesher(8, letters=chosen)).degenerate == 0
            meshes += 1
    assert zeros > 500
    assert meshes > 15


@pytest.mark.slow
@pytest.mark.parametrize("cells", [256, (256, 300, 200)])
def test_the_car_has_five_parts_without_a_flaw(car, cells):
    status = accepted(car(cells), 0)
    assert (status.components, status.degenerate, status.off_surface) == (5, 0, None)
    assert status.folded_share < 1e-6


@pytest.mark.slow
def test_a_coarse_car_names_the_gap_at_its_wheels(car):
    gaps = [suspect for suspect in car(128).status.unresolved if suspect.kind == "gap"]
    assert any("wheel" in name for gap in gaps for name in gap.names)


@pytest.fixture(scope="module")
def car():
    return rsym.Mesher(rsym.paper.car())


@pytest.mark.parametrize("reading", ["standard", "literal"])
def test_the_skeleton_body_revolved_is_closed(reading):
    status = judged(rsym.Mesher(rsym.revolve(rsym.paper.skeleton_body(reading=reading)))(96), 2)
    assert (status.folded, status.degenerate, status.off_surface) == (0, 0, None)


@pytest.mark.parametrize("backend", [mesher_kernels, region_kernels])
def test_a_point_goes_where_it_would_alone(backend):
    bounds = ((-1.0, 1.0),) * 3
    kernels = backend(surface_form(rsym.Shape(rsym.conjunction(1 - x**2 - y**2 - z**2, 0.3 - x * y), AXES)))
    kernels.set({}, bounds)
    lattice, generator = np.array([-1.0, -1, -1, 0.1, 0.1, 0.1]), np.random.default_rng(6)
    both = np.array([[0, 0, 1], [1, -1, -1], [-1, -1, -1]], np.int16)[:, generator.integers(0, 3, 10)]
    for find in (lambda which, start: solve(kernels, both[:, which], start, lattice, None),
                 lambda which, start: on_active_leaf(kernels, start, lattice, None)):  # fmt: skip
        start = generator.uniform(-1, 1, (3, 10))
        away = start * 0.03 ** np.arange(10)  # the first take several steps, the last ones none
        start = find(np.arange(10), start) + away
        together = find(np.arange(10), start)
        alone = [find(np.array([k]), start[:, [k]]) for k in range(10)]
        assert np.array_equal(together, np.concatenate(alone, axis=1))
