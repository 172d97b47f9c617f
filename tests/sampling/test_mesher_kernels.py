"""The mesher's kernels against plain evaluations of the formulas at points."""

import subprocess
import sys
import threading

import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from oracles.closeness import assert_close
from oracles.many_balls import many_balls
from oracles.tiers import examples
from oracles.trees import trees
from oracles.undefined import without_value

import rsym
from rsym import x, y, z
from rsym.errors import RsymError
from rsym.logic.sign_form import surface_form
from rsym.sampling.kernels import mesher_code
from rsym.sampling.kernels import mesher_kernels as module
from rsym.sampling.kernels.mesher_kernels import MesherKernels, columns, mesher_kernels, padded
from rsym.sampling.lattice import SHIFTS
from rsym.sampling.sharp.crossings import _offsets, find_crossings, sample_signs
from rsym.sampling.sharp.signs import find_blocks
from rsym.sampling.sharp.topology import topology

r, alpha = sp.symbols("r alpha", real=True)
BOUNDS = ((-1.5, 1.5),) * 3
LATTICE = np.array([*(-1.5 - 3 / 24 * np.array(SHIFTS)), *[3 / 24] * 3])
CELLS = (25, 25, 25)
BLOCK = np.indices((9, 9, 9)).reshape(3, -1)


def kernels_of(expression, letters=None):
    shape = rsym.Shape(expression, (x, y, z), letters=letters, bounds=BOUNDS)
    kernels = mesher_kernels(surface_form(shape).capped())
    kernels.set(shape.letters.values_with(None), BOUNDS)
    return kernels


def omega(expression, points):
    """The sign of omega in the bounds, by NumPy alone."""
    value = np.broadcast_to(sp.lambdify((x, y, z), expression.doit())(*points), points.shape[1:])
    return (value >= 0) & (np.abs(points) <= 1.5).all(axis=0)


def unpacked(bits):
    return np.unpackbits(bits, axis=1, count=729, bitorder="little").astype(bool)


@pytest.mark.slow
@settings(max_examples=examples(6), deadline=None)
@given(trees(max_leaves=7, more=(abs(x) - y, sp.sin(3 * x) * y + z / 4, sp.exp(x) - y**2 - z)))
def test_signs_of_all_lattice_points(expression):
    """Kept blocks have the signs of omega; in blocks that are not kept omega has one sign."""
    kernels = kernels_of(expression)
    blocks = find_blocks(kernels, LATTICE, CELLS)
    bits = unpacked(sample_signs(kernels, blocks, LATTICE, None))
    kept = {tuple(corner): row for corner, row in zip(blocks.corner.T.tolist(), bits, strict=True)}
    for corner in 8 * np.indices((4, 4, 4)).reshape(3, -1).T:
        inside = omega(expression, LATTICE[:3, None] + LATTICE[3:, None] * (corner[:, None] + BLOCK))
        if tuple(corner) in kept:
            differs = kept[tuple(corner)] != inside
            assert differs.sum() == 0
        else:
            assert inside.all() or not inside.any()


@pytest.mark.slow
@settings(max_examples=examples(8), deadline=None)
@given(trees(max_leaves=5))
def test_crossings_are_zeros_on_their_leaf(expression):
    kernels = kernels_of(expression)
    blocks = find_blocks(kernels, LATTICE, CELLS)
    surface = topology(blocks.corner, sample_signs(kernels, blocks, LATTICE, None))
    found = find_crossings(kernels, blocks, surface, LATTICE, None)
    if not found.count:
        return
    points = found.points[:, : found.count]
    body = sp.Min(expression.doit(), *(1.5 - side for side in (x, -x, y, -y, z, -z)))
    value = np.abs(sp.lambdify((x, y, z), body)(*points))
    assert_close(value, np.zeros_like(value), atol=1e-12)
    own, gradient = np.empty(padded(found.count)), np.empty((3, padded(found.count)))
    kernels.leaf(found.count, found.leaf, found.points, own, gradient)
    assert_close(own[: found.count], np.zeros(found.count), atol=1e-12)
    steps = 1e-6 * np.eye(3)
    for axis in range(3):
        ends = [np.zeros((3, padded(found.count))) for _ in range(2)]
        for end, sign in zip(ends, (1, -1), strict=True):
            end[:, : found.count] = points + sign * steps[axis][:, None]
        values = [np.empty(padded(found.count)) for _ in range(2)]
        for end, one in zip(ends, values, strict=True):
            kernels.leaf(found.count, found.leaf, end, one, np.empty_like(gradient))
        slope = (values[0] - values[1])[: found.count] / 2e-6
        assert_close(found.gradients[axis, : found.count], slope, atol=1e-6)


def test_slide_ends_on_the_leaf_and_leaves_others_alone():
    kernels = kernels_of(rsym.conjunction(1 - x**2 - y**2 - z**2, z))
    points = np.zeros((3, padded(9)))
    points[:, :9] = np.random.default_rng(1).uniform(-1, 1, (3, 9))
    before, leaf = points.copy(), np.array([0, 1, -1] * 8, np.int16)
    kernels.slide(9, leaf, points, 6)
    assert_close(np.linalg.norm(points[:, :9][:, 0::3], axis=0), np.ones(3), atol=1e-14)
    assert_close(points[2, :9][1::3], np.zeros(3), atol=1e-15)
    assert np.array_equal(points[:2, :9][:, 1::3], before[:2, :9][:, 1::3])
    assert np.array_equal(points[:, :9][:, 2::3], before[:, :9][:, 2::3])


@pytest.mark.random
@pytest.mark.parametrize("scale", [1e-250, 1e-30, 1e30, 1e250])
def test_the_scale_of_a_leaf_does_not_matter(scale):
    kernels = kernels_of(rsym.conjunction(sp.Float(scale) * (1 - x**2 - y**2 - z**2), z + sp.Rational(1, 2)))
    points = np.zeros((3, padded(1)))
    points[:, 0] = 0.6, 0.0, 0.8
    value, leaf = np.empty(padded(1)), np.empty(padded(1), np.int16)
    kernels.value(1, points, value, leaf)
    assert abs(value[0]) < 1e-15
    assert leaf[0] == 0


def test_letters_change_nothing_but_constants():
    ball = r**2 - x**2 - y**2 - z**2
    kernels = kernels_of(ball, {r: 1})
    twin = kernels_of(ball, {r: sp.Rational(1, 2)})
    assert twin.source is kernels.source
    points, value, leaf = np.zeros((3, padded(1))), np.empty(padded(1)), np.empty(padded(1), np.int16)
    for one, radius in ((kernels, 1.0), (twin, 0.5)):
        points[0, 0] = radius
        one.value(1, points, value, leaf)
        assert value[0] == 0


def test_what_a_thread_compiles_ahead_is_not_compiled_again(monkeypatch, folder):
    made, code = [], mesher_code.mesher_code
    monkeypatch.setattr(mesher_code, "mesher_code", lambda formulas: made.append(formulas) or code(formulas))
    ellipsoid = rsym.Shape(sp.Rational(7, 9) - x**2 - 3 * y**2 - z**2, (x, y, z))
    module.compile_ahead(surface_form(ellipsoid))
    kernels = mesher_kernels(surface_form(ellipsoid))
    for thread in threading.enumerate():
        if thread.name == "rsym-compiler":
            thread.join()
    assert len(made) == 1
    assert mesher_kernels(surface_form(ellipsoid)).source is kernels.source


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder of compiled code, which keeps short texts too."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(mesher_code, "KEPT_FROM", 0)
    return tmp_path / "rsym"


@pytest.fixture
def texts(monkeypatch):
    """The forms of which a text was made."""
    made, code = [], mesher_code.mesher_code
    monkeypatch.setattr(mesher_code, "mesher_code", lambda formulas: made.append(formulas.form) or code(formulas))
    return made


def all_of(form):
    """What kernels that are new to the process say of a form."""
    kernels = MesherKernels(form)
    kernels.set({"r": 1.25}, BOUNDS)
    points, bounds = columns(np.linspace(-1, 1, 27).reshape(3, 9)), np.zeros((8, padded(9)))
    value, leaf = np.zeros(padded(9)), np.zeros(padded(9), np.int16)
    kernels.value(9, points, value, leaf)
    kernels.enclose(9, leaf, points, points + 0.25, bounds)
    kept, words = kernels.kept(np.array([[-2, -1], [0, 1]] * 3, np.float64).reshape(6, 2), None, None, whole)
    return [part.tobytes() for part in (value, leaf, bounds[:, :9], kept, words)]


def whole(call, count, grain):
    return [call(0, count)]


@pytest.fixture
def form():
    shape = rsym.Shape(rsym.conjunction(r - x**2 - y**2 - z**2, z + x / 3), (x, y, z), letters={r: 1}, bounds=BOUNDS)
    return surface_form(shape).capped()


def test_kernels_of_a_form_are_made_once_on_a_machine(folder, texts, form):
    first = all_of(form)
    assert [all_of(form), all_of(form)] == [first, first]
    assert len(texts) == 1
    assert len(list((folder / mesher_code.KIND).iterdir())) == 1


def test_kept_kernels_tell_their_program_and_their_text(folder, texts, form):
    first, second = MesherKernels(form), MesherKernels(form)
    assert not texts[1:]
    assert second.source == first.source
    assert second.program.digest == first.program.digest


@pytest.mark.parametrize("kind", [mesher_code.KIND, "kernels"])
@pytest.mark.parametrize("damage", [b"", b"short", None])
def test_kernels_of_which_something_is_damaged_are_made_again(folder, texts, form, kind, damage):
    first = all_of(form)
    for entry in (folder / kind).iterdir():
        kept = entry.read_bytes()
        entry.write_bytes(kept[: len(kept) // 2] if damage is None else damage)
    assert all_of(form) == first
    assert len(texts) == 2
    assert all_of(form) == first
    assert len(texts) == 2


def test_what_makes_the_text_is_part_of_the_name(folder, texts, form, monkeypatch):
    MesherKernels(form)
    monkeypatch.setattr(mesher_code, "digest_of_rooms", lambda *_: "otherwise")
    MesherKernels(form)
    assert len(texts) == len(list((folder / mesher_code.KIND).iterdir())) == 2
    monkeypatch.setattr(mesher_code, "digest_of_rooms", lambda *_: "")  # what cannot be told is not kept
    for _ in range(2):
        MesherKernels(form)
    assert len(texts) == 4
    assert len(list((folder / mesher_code.KIND).iterdir())) == 2


def test_what_is_wrong_is_not_kept(folder, form, monkeypatch):
    code = mesher_code.mesher_code
    monkeypatch.setattr(mesher_code, "mesher_code", lambda s: [text.replace("fadd", "fsub") for text in code(s)])
    with pytest.raises(RsymError) as caught:
        MesherKernels(form)
    assert caught.value.code == "miscompiled"
    assert not (folder / mesher_code.KIND).exists()


def test_the_room_of_kernels_is_made_by_the_rooms_that_are_digested():
    """All rooms from which the text of kernels takes anything: what they import."""
    code = "import sys, rsym.sampling.kernels.mesher_code; print(*(m for m in sys.modules if m.startswith('rsym.')))"
    names = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()
    rooms = {name.rpartition(".")[0].removeprefix("rsym").removeprefix(".").replace(".", "/") for name in names}
    assert rooms <= {"", "sampling", *mesher_code.ROOMS}


@pytest.mark.parametrize("value", [-1, 2])
def test_an_illegal_parameter_is_refused(value):
    with pytest.raises(RsymError) as caught:
        kernels_of(rsym.conjunction(x, y, system=rsym.RAlpha(alpha)), {alpha: value})
    assert caught.value.code == "parameter"


@pytest.mark.random
@pytest.mark.parametrize(
    "expression",
    [
        (1 - x**2 - y**2 - z**2) * without_value(-x - sp.Rational(1, 3)),
        x * without_value(-x) - sp.Rational(3, 5) - y**2,  # negative wherever it is defined but for a part
        without_value(-sp.Max(z, x)) + 9,
        x**2 * without_value(-x) - sp.Rational(3, 5) - y**2,
    ],
)
def test_where_the_boundary_may_be_undefined_the_place_is_told(expression):
    kernels = kernels_of(expression)
    blocks = find_blocks(kernels, LATTICE, CELLS)
    with pytest.raises(RsymError, match="no value near") as caught:
        sample_signs(kernels, blocks, LATTICE, None)
    assert caught.value.code == "undefined"


@pytest.mark.random
@pytest.mark.parametrize(
    ("expression", "inside"),
    [
        (
            (1 - x**2 - y**2 - z**2) * sp.sqrt(x + sp.Rational(1, 3)),
            lambda u, v, w: (u > -1 / 3) & (u**2 + v**2 + w**2 < 1),
        ),
        (sp.sqrt(x) - sp.Rational(3, 5) - y**2, lambda u, v, w: (u > 0) & (u > (0.6 + v**2) ** 2)),
        (sp.log(x) + 9, lambda u, v, w: u > np.exp(-9)),
        (x ** sp.Rational(3, 2) - sp.Rational(3, 5) - y**2, lambda u, v, w: (u > 0) & (u**3 > (0.6 + v**2) ** 2)),
    ],
)
def test_where_the_end_of_a_domain_is_known_the_body_ends_there(expression, inside):
    points = np.random.default_rng(5).uniform(-1.5, 1.5, (3, 2000))
    kernels = kernels_of(expression)
    sample_signs(kernels, find_blocks(kernels, LATTICE, CELLS), LATTICE, None)
    value, active = np.empty(padded(2000)), np.empty(padded(2000), np.int16)
    kernels.value(2000, columns(points), value, active)
    np.testing.assert_array_equal(value[:2000] > 0, inside(*points))


@pytest.mark.slow
def test_more_gates_than_bits_of_a_word():
    """Forty balls: the flags of their gates fill two words."""
    centres = np.random.default_rng(3).integers(-10, 10, (40, 3))
    balls = [
        sp.Rational(1, 9) - sum((a - sp.Rational(int(c), 8)) ** 2 for a, c in zip((x, y, z), row, strict=True))
        for row in centres
    ]
    kernels = kernels_of(rsym.disjunction(*balls))
    assert kernels.words == 2
    blocks = find_blocks(kernels, LATTICE, CELLS)
    bits = unpacked(sample_signs(kernels, blocks, LATTICE, None))
    for corner, row in zip(blocks.corner.T, bits, strict=True):
        points = LATTICE[:3, None] + LATTICE[3:, None] * (corner[:, None] + BLOCK)
        distance = ((points[:, None] - centres.T[:, :, None] / 8) ** 2).sum(axis=0).min(axis=0)
        inside = (distance <= 1 / 9) & (np.abs(points) <= 1.5).all(axis=0)
        assert np.array_equal(row, inside)


def test_points_of_a_block_are_in_the_order_of_its_bits():
    assert np.array_equal(_offsets()[:, :729], BLOCK)
    assert isinstance(kernels_of(x), MesherKernels)


@pytest.mark.random
@pytest.mark.parametrize("expression", [abs(x), x**2, rsym.disjunction(x, -x)])
def test_a_zero_without_a_change_of_sign_is_kept(expression):
    """Every block that the plane x = 0 passes through, those in the middle of the bounds too."""
    corner = find_blocks(kernels_of(expression), LATTICE, CELLS).corner
    ends = [LATTICE[0] + LATTICE[3] * (corner[0] + shift) for shift in (0, 8)]
    on_plane = corner[1:, (ends[0] <= 0) & (ends[1] >= 0)]
    assert len(np.unique(on_plane, axis=1).T) == 16


def test_what_llvm_would_compile_too_long_is_evaluated_by_tapes():
    few, _, _ = many_balls(20, 3, rsym.R1)
    many, _, _ = many_balls(70, 3)
    one_leaf = sp.Add(*(sp.sin(k * x) * sp.exp(k * y) for k in range(1, 500)))
    chosen = [
        module.backend_for(surface_form(rsym.Shape(e, (x, y, z)))) for e in (few.expression, many.expression, one_leaf)
    ]
    assert chosen == ["llvm", "tape", "tape"]
    assert module.backend_for(surface_form(many), "llvm") == "llvm"
