"""Certificates of cells: what is simple surely is, and nothing thin is passed over."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from oracles.closeness import assert_close
from oracles.leaf_kernels import LeafKernels
from oracles.tiers import examples
from oracles.trees import trees
from oracles.undefined import without_value
from scipy import ndimage, optimize

import rsym
from rsym import x, y, z
from rsym.logic.leaf_names import leaf_names
from rsym.logic.sign_form import cap_letters, surface_form
from rsym.sampling.kernels.mesher_kernels import mesher_kernels
from rsym.sampling.regions.regions import whole_form
from rsym.sampling.sharp import certificates
from rsym.sampling.sharp.certificates import STEEPEST, Form, certify
from rsym.sampling.sharp.clusters import clusters
from rsym.sampling.sharp.crossings import CompiledLeaves
from rsym.sampling.sharp.signs import find_blocks
from rsym.sampling.sharp.suspects import suspects

SHIFT = np.array((0.381966, 0.414214, 0.442777))


def certified(shape, resolution, *, depth=3):
    """The form of a shape with caps, the lattice, and what is unresolved; every block is handed over."""
    lower, upper = np.array(shape.box.ends, float).T
    spacing = (upper - lower).max() / resolution * np.ones(3)
    lattice = np.concatenate([lower - SHIFT * spacing, spacing])
    form = surface_form(shape).capped()
    letters = {name: letter.default for name, letter in shape.letters.items()}
    for name, low, high in zip("xyz", lower, upper, strict=True):
        letters.update(zip(cap_letters(name), (low, high), strict=True))
    counts = np.ceil((upper - lower) / spacing / 8 + 0.1).astype(int)
    corner = 8 * np.indices(counts).reshape(3, -1)
    table = Form(LeafKernels(form, letters), len(form.leaves), whole_form(form))
    return table, lattice, certify(table, lattice, corner, depth=depth)


def suspected(expression, resolution=16, size=1.2):
    table, lattice, found = certified(solid(expression, size), resolution)
    return suspects(table.leaves, lattice, found), lattice


def solid(expression, size=1.2):
    return rsym.Shape(expression, (x, y, z), bounds=((-size, size),) * 3)


ROTATION = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
MOVE = np.array([0.05, -0.03, 0.02])


def moved(expression):
    """Turned and shifted, so that no lattice plane is special."""
    return expression.subs(dict(zip((x, y, z), ROTATION @ np.array([x, y, z]) - MOVE, strict=True)), simultaneous=True)


def place_of(point):
    return ROTATION.T @ (np.array(point) + MOVE)


def ball(centre, radius):
    return sp.Float(radius) ** 2 - (x - centre) ** 2 - y**2 - z**2


def box(low, high):
    return rsym.conjunction(x - low, high - x, HALF - y, HALF + y, HALF - z, HALF + z)


BALL = 1 - x**2 - y**2 - z**2
TORUS = sp.Rational(1, 10) - z**2 - (sp.sqrt(x**2 + y**2) - sp.Rational(7, 10)) ** 2
HALF = sp.Rational(6, 10)
CUBE = box(-HALF, HALF)
OCTAHEDRON = sp.Rational(9, 10) - abs(x) - abs(y) - abs(z)


@pytest.mark.parametrize("expression", [BALL, TORUS, CUBE, moved(CUBE), OCTAHEDRON, 1 - x**8 - y**8 - z**8])
def test_smooth_bodies_and_cubes_are_simple_everywhere(expression):
    _, _, found = certified(solid(expression), 24)
    assert len(found) == 0
    assert found.tested[0] > 0


def test_cells_whose_bounds_are_too_wide_are_simple_after_all():
    square = x**2 + y**2 + z**2 + sp.Rational(39, 100)
    torus = solid(moved(sp.Rational(49, 25) * (x**2 + y**2) - square**2))
    left = [len(certified(torus, 24, depth=depth)[2]) for depth in (0, 3)]
    assert left[0] > 500
    assert left[1] == 0


@pytest.mark.random
@pytest.mark.parametrize("resolution", [16, 32])
@pytest.mark.parametrize("thickness", [0.01, 0.001])
@pytest.mark.parametrize("single", [False, True])
def test_a_thin_shell_is_a_wall_of_its_thickness(resolution, thickness, single):
    t = sp.Rational(str(thickness))
    inner = x**2 + y**2 + z**2 - (1 - t) ** 2
    expression = (t / 2) ** 2 - (sp.sqrt(x**2 + y**2 + z**2) - 1) ** 2 if single else rsym.conjunction(BALL, inner)
    (wall,), lattice = suspected(expression, resolution)
    assert wall.kind == "wall"
    assert wall.cells > 0.5 * np.pi * (2 / lattice[3]) ** 2  # as many as the sphere has
    assert_close(wall.thickness * lattice[3], thickness, rtol=1e-3)
    assert "wall" in wall.remark


@pytest.mark.parametrize("thickness", [0.01, 0.001])
def test_the_mesh_of_a_thin_shell_comes_with_a_word(thickness):
    shell = solid(rsym.conjunction(BALL, x**2 + y**2 + z**2 - (1 - sp.Rational(str(thickness))) ** 2))
    with pytest.warns(rsym.RsymWarning, match="Unresolved: a wall"):
        mesh = rsym.mesh(shell, 24, method="sharp")
    assert "Unresolved: a wall" in str(mesh.status)


@pytest.mark.slow
def test_what_is_unresolved_is_one_warning_of_one_paragraph():
    with pytest.warns(rsym.RsymWarning) as caught:
        status = rsym.mesh(rsym.paper.car(), 64).status
    (warning,) = caught
    assert str(warning.message) == " ".join(status.brief) + " `.status.remarks` tells all."
    assert "\n" not in str(warning.message)
    assert len(status.brief) <= 3 < len(status.remarks)


def test_a_gap_is_found_where_it_is_narrowest():
    (gap,), lattice = suspected(moved(rsym.disjunction(ball(-0.505, 0.5), ball(0.405, 0.4))))
    assert (gap.kind, gap.leaves) == ("gap", (0, 1))
    assert_close(gap.thickness * lattice[3], 0.01, rtol=1e-9)
    assert_close(gap.place, place_of([0, 0, 0]), atol=1e-9)


def test_the_point_where_bodies_touch():
    (touch,), _ = suspected(moved(rsym.disjunction(ball(-0.5, 0.5), ball(0.4, 0.4))))
    assert touch.kind == "touch"
    assert_close(touch.place, place_of([0, 0, 0]), atol=1e-9)


@pytest.mark.parametrize(
    ("expression", "area"),
    [
        (rsym.disjunction(box(-HALF, sp.Rational(1, 10)), box(sp.Rational(1, 10), HALF)), 1.44),
        (-((x**2 + y**2 - sp.Rational(1, 2)) ** 2), 2.4 * 2 * np.pi * np.sqrt(0.5)),
    ],
)
def test_a_sheet_without_a_change_of_sign(expression, area):
    (sheet,), lattice = suspected(expression)
    assert sheet.kind == "sheet"
    assert sheet.cells > 0.7 * area / lattice[3] ** 2


def test_a_ball_between_the_lattice_points():
    (lost,), lattice = suspected(rsym.disjunction(BALL, ball(1.1, 0.01).subs({y: y - 1, z: z - 1})))
    assert (lost.kind, lost.leaves) == ("wall", (1,))
    assert_close(lost.place, [1.1, 1, 1], atol=1e-6)
    assert_close(lost.thickness * lattice[3], 0.02, rtol=1e-6)


@pytest.mark.parametrize("limits", [(z + 1,), (z,)])
def test_the_tip_of_a_cone(limits):
    (tip,), _ = suspected(rsym.conjunction(z**2 - x**2 - y**2, 1 - z, *limits).subs({x: x - sp.Rational(1, 10)}))
    assert tip.kind == "apex"
    assert_close(tip.place, [0.1, 0, 0], atol=1e-9)


@pytest.mark.parametrize(
    ("expression", "edge"),
    [
        (rsym.conjunction(x, sp.Rational(15, 100) * y - x, 1 - y, 1 - z, 1 + z), lambda p: np.hypot(p[0], p[1])),
        # The crevice around the neck of two balls that overlap by 0.002.
        (
            rsym.disjunction(ball(-0.499, 0.5), ball(0.499, 0.5)),
            lambda p: np.hypot(p[0], np.hypot(p[1], p[2]) - np.sqrt(0.25 - 0.499**2)),
        ),
    ],
)
def test_edges_that_taper_to_nothing(expression, edge):
    (knife,), _ = suspected(expression)
    assert knife.kind == "knife"
    assert edge(knife.place) < 1e-9


@pytest.mark.parametrize(
    ("kind", "expression", "thickness"),
    [
        # Sides that would meet at y = -2, and balls that would be closest at y = 0.
        ("wall", rsym.conjunction(x, (y + 2) / 20 - x, 1 - y, 1 + y, 1 - z, 1 + z), 0.05),
        ("gap", rsym.conjunction(rsym.disjunction(ball(-5.01, 5), ball(5.01, 5)), y - HALF, HALF - z, HALF + z), 0.092),
    ],
)
def test_what_lies_outside_of_the_body_is_no_thinnest_place(kind, expression, thickness):
    found, lattice = suspected(expression)
    (thin,) = (suspect for suspect in found if suspect.kind in {kind, "knife", "touch"})
    assert thin.kind == kind
    assert thickness <= thin.thickness * lattice[3] < 1.3 * thickness


def test_corners_within_a_leaf_are_said_to_be_unknown():
    found, _ = suspected(moved(OCTAHEDRON))
    assert {suspect.kind for suspect in found} == {"unresolved"}
    tips = [place_of(sign * 0.9 * np.eye(3)[k]) for k in range(3) for sign in (1, -1)]
    assert all(min(np.linalg.norm(suspect.place - tip) for tip in tips) < 0.15 for suspect in found)


def test_where_a_leaf_is_undefined_no_cell_is_passed_over():
    _, lattice, found = certified(solid(without_value(2 - x) - y**2), 7)
    cells = np.indices((8, 8, 8)).reshape(3, -1)
    lower, upper = (lattice[:3, None] + lattice[3:, None] * (cells + end) for end in (0, 1))
    within = ((upper > -1.2) & (lower < 1.2)).all(axis=0)
    assert np.array_equal(found.cells, cells[:, within])


def test_beyond_the_end_of_a_domain_nothing_is_left_open():
    _, _, found = certified(solid(sp.sqrt(x - 2) - y**2), 7)
    assert not found.cells.size


def compiled(shape, resolution):
    form = surface_form(shape).capped()
    kernels = mesher_kernels(form)
    kernels.set({name: float(letter.default) for name, letter in shape.letters.items()}, shape.bounds)
    lower, upper = np.array([[float(end) for end in side] for side in shape.bounds]).T
    spacing = (upper - lower) / resolution
    lattice = np.concatenate([lower - SHIFT * spacing, spacing])
    blocks = find_blocks(kernels, lattice, (resolution + 1,) * 3)
    return Form(CompiledLeaves(kernels), len(form.leaves), whole_form(form)), lattice, blocks, kernels


@pytest.mark.slow
def test_the_gap_about_the_wheels_of_the_car():
    shape = rsym.paper.car()
    form, lattice, blocks, kernels = compiled(shape, 128)
    unresolved = certify(form, lattice, blocks.corner, blocks.words)
    found = suspects(form.leaves, lattice, unresolved, leaf_names(kernels.form, shape))
    gap = next(one for one in found if one.kind == "gap")
    assert gap.names == ("wheel arches", "wheels")
    # The radii differ by 0.2; a cell is 0.27 long along y and 0.10 along z.
    assert 0.2 / lattice[4] < gap.thickness + 1e-9 < 1
    finer = lattice * [1, 1, 1, 0.5, 0.5, 0.5]
    blocks = find_blocks(kernels, finer, (258,) * 3)
    unresolved = certify(form, finer, blocks.corner, blocks.words)
    assert {suspect.kind for suspect in suspects(form.leaves, finer, unresolved)} == {"knife"}


def test_compiled_leaves_are_the_leaves_times_positive_numbers():
    shape = solid(rsym.conjunction(BALL, TORUS, x + y * z))
    plain, made = certified(shape, 8)[0].leaves, compiled(shape, 8)[0].leaves
    rng = np.random.default_rng(6)
    ids, points = rng.integers(0, 9, 50).astype(np.int16), rng.uniform(-1, 1, (3, 50))
    (value, gradient), (other_value, other_gradient) = (leaves.evaluate(ids, points) for leaves in (plain, made))
    factor = np.linalg.norm(other_gradient, axis=0) / np.linalg.norm(gradient, axis=0)
    assert_close(other_value, factor * value, atol=1e-12)
    assert_close(other_gradient, factor * gradient, atol=1e-12)
    assert np.array_equal(made.active(points)[0] >= 0, plain.active(points)[0] >= 0)
    # The bounds are those of the leaves themselves, closer where a coordinate repeats.
    for inner, bounds, outer in zip(
        plain.evaluate(ids, points + 0.05),
        made.enclose(ids, points, points + 0.1),
        plain.enclose(ids, points, points + 0.1),
        strict=True,
    ):
        (low, high), (lowest, highest) = (np.moveaxis(both, -2, 0) for both in (bounds, outer))
        assert ((lowest - 1e-12 <= low) & (low <= inner) & (inner <= high) & (high <= highest + 1e-12)).all()


@pytest.mark.slow
def test_neither_threads_nor_cuts_nor_what_was_known_before_change_anything(monkeypatch):
    form, lattice, blocks, _ = compiled(rsym.paper.car(), 64)
    plain = certify(form, lattice, blocks.corner, blocks.words)
    assert len(plain) > 100
    monkeypatch.setattr(certificates, "BLOCKS", 24)
    monkeypatch.setattr(certificates, "CELLS", 16)
    with ThreadPoolExecutor(2) as pool:
        for skip in (blocks.words, None):
            again = certify(form, lattice, blocks.corner, skip, pool=pool)
            for name in ("cells", "owner", "leaf", "lower", "upper"):
                assert np.array_equal(getattr(again, name), getattr(plain, name))


CELLS = 6
PLATE, GRAIN = sp.Rational(1, 200) - (x - y / 3) ** 2, sp.Rational(1, 40) - x**2 - y**2 - z**2


@pytest.mark.slow
@settings(max_examples=examples(12), deadline=None)
@given(trees(more=(PLATE, GRAIN, abs(x) - z / 3, sp.Max(x, y) + z)))
def test_random_trees_against_dense_samples(expression):
    """No piece of either sign is lost without a word, and in a cell that is simple one direction serves the surface."""
    table, lattice, found = certified(solid(expression, 1.4), CELLS - 1)
    unresolved = np.zeros((CELLS,) * 3, np.bool_)
    unresolved[tuple(found.cells[:, (found.cells < CELLS).all(axis=0)])] = True
    points = lattice[:3, None] + lattice[3:, None] * np.indices((8 * CELLS + 1,) * 3).reshape(3, -1) / 8
    inside = (table.leaves.active(points)[0] >= 0).reshape((8 * CELLS + 1,) * 3)
    near = np.zeros(inside.shape, np.bool_)
    for cell in np.argwhere(unresolved):
        near[tuple(slice(8 * i, 8 * i + 9) for i in cell)] = True
    for sign in (inside, ~inside):
        label, count = ndimage.label(sign, np.ones((3, 3, 3)))
        seen = np.union1d(label[::8, ::8, ::8], label[near])
        assert np.setdiff1d(np.arange(1, count + 1), seen).size == 0
    assert_one_direction(table.leaves, lattice, inside, unresolved)


def assert_one_direction(leaves, lattice, inside, unresolved):
    """In simple cells the normals of the surface, found by bisection and differences, have one cone."""
    edges = []
    for axis in range(3):
        start = np.argwhere(np.diff(inside, axis=axis))
        edges.append(np.stack([start, start + np.eye(3, dtype=int)[axis]]))
    low, high = np.concatenate(edges, axis=1)
    cell = np.minimum(low // 8, CELLS - 1)
    keep = ~unresolved[tuple(cell.T)]
    low, high, (cells, cell) = low[keep], high[keep], np.unique(cell[keep], axis=0, return_inverse=True)
    start, end = (lattice[:3, None] + lattice[3:, None] * place.T / 8 for place in (low, high))
    normals = normals_between(leaves, start, end)
    for number in np.random.default_rng(1).permutation(len(cells))[:40]:
        mine = normals[:, cell.ravel() == number]
        _, off = optimize.nnls(np.concatenate([mine, 1e3 * np.ones((1, mine.shape[1]))]), [0, 0, 0, 1e3])
        assert off > STEEPEST - 1e-3


def normals_between(leaves, start, end):
    outside = leaves.active(start)[0] < 0
    start, end = np.where(outside, start, end), np.where(outside, end, start)
    for _ in range(30):
        middle = (start + end) / 2
        there = leaves.active(middle)[0] >= 0
        start, end = np.where(there, start, middle), np.where(there, middle, end)
    steps = 1e-6 * np.eye(3)
    slopes = [leaves.active(end + step[:, None])[0] - leaves.active(end - step[:, None])[0] for step in steps]
    return np.array(slopes) / np.linalg.norm(slopes, axis=0)


def test_clusters_are_those_of_an_image():
    image = np.random.default_rng(9).random((14, 17, 11)) < 0.04
    image[3, :, 5] = image[:, 8, 2] = True
    cells = np.argwhere(image).T
    labels, _ = ndimage.label(image, np.ones((3, 3, 3)))
    _, first, expected = np.unique(labels[image], return_index=True, return_inverse=True)
    assert len(first) > 20
    assert (clusters(cells) == np.argsort(np.argsort(first))[expected]).all()
