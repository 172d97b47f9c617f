"""Rays against dense signs of omega in float64: no code is shared with what is checked."""

import numpy as np
import pytest
import sympy as sp
from oracles.tiers import of_the_day

import rsym
from rsym import x, y, z
from rsym.errors import RsymError
from rsym.logic.sign_form import shape_form
from rsym.paper.models import MODELS, model_path
from rsym.sampling import rays as casting
from rsym.sampling.kernels import ray_code, ray_kernels
from rsym.sampling.pencils import Cut, Pencil
from rsym.sampling.ray_march import ArrayRays
from rsym.sampling.rays import Caster

BOX = ((-3, 3),) * 3
BALL = rsym.Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z), bounds=BOX)


def space(name):
    shape = rsym.load(model_path(name))
    return shape if shape.dimension == 3 else rsym.revolve(shape)


def letters_of(shape, generator):
    """Random ones between the defaults and an end of their ranges."""
    found = {}
    for name, letter in shape.letters.items():
        ends = [letter.default if end is None else end for end in (letter.minimum, letter.maximum)]
        end = float(generator.choice([float(end) for end in ends]))
        found[name] = float(letter.default) + 0.5 * generator.random() * (end - float(letter.default))
    return found


def camera(bounds, size, azimuth=-0.96, elevation=0.384, *, eye=True, room=1.6):
    """A pencil that looks at the middle of the bounds."""
    width, height = size
    low, high = np.array(bounds, float).T
    middle, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    se, ce, sa, ca = np.sin(elevation), np.cos(elevation), np.sin(azimuth), np.cos(azimuth)
    right, up, back = np.array([-sa, ca, 0]), np.array([-se * ca, -se * sa, ce]), np.array([ce * ca, ce * sa, se])
    pixel = room * radius / height
    corner = middle - right * pixel * width / 2 + up * pixel * height / 2
    if eye:
        return Pencil(size, corner, right * pixel, -up * pixel, eye=middle + back * 4 * radius)
    return Pencil(size, corner + back * 2 * radius, right * pixel, -up * pixel, direction=-back)


class Dense:
    """Truth by the signs of the ordinary kernel at many places of each ray, and bisection."""

    def __init__(self, shape, letters, bounds):
        self.kernel, self.letters, self.box = rsym.compile(shape, ("value",)), letters, np.array(bounds, float)

    def inside(self, points):
        return self.kernel(*np.moveaxis(points, -1, 0), letters=self.letters)["value"] > 0

    def depth(self, origins, directions, places):
        """Of the first place inside."""
        with np.errstate(all="ignore"):
            ends = [(self.box[:, k] - origins) / directions for k in (0, 1)]
        first, last = np.fmin(*ends).max(axis=1), np.fmax(*ends).min(axis=1)
        t = first[:, None] + (last - first)[:, None] * np.linspace(1e-9, 1, places)
        met = self.inside(origins[:, None] + directions[:, None] * t[..., None]) & (last > first)[:, None]
        at, rows = met.argmax(axis=1), np.arange(len(t))
        low, high = t[rows, np.maximum(at - 1, 0)], t[rows, at]
        for _ in range(50):
            middle = (low + high) / 2
            deep = self.inside(origins + directions * middle[:, None])
            low, high = np.where(deep, low, middle), np.where(deep, middle, high)
        return np.where(met.any(axis=1), np.where(at == 0, first, high), np.inf)


def complaints(shape, letters, pencil, count, places, seed=0, *, closely=1):
    """Rays of a picture that dense signs contradict, by more than a fifth of a pixel; how many are in doubt.

    One ray of `closely` is asked at all places, as is whatever differs; the others at an eighth of them.
    """
    generator = np.random.default_rng(seed)
    caster = Caster(shape, letters)
    hits, dense = caster.look(pencil), Dense(shape, letters, caster.bounds)
    width, height = pencil.size
    rows, columns = generator.integers(0, height, count), generator.integers(0, width, count)
    met = np.argwhere(hits.met)
    if len(met):  # half of the rays hit
        rows[::2], columns[::2] = met[generator.integers(0, len(met), len(rows[::2]))].T
    origins, directions = pencil.rays(columns + 0.5, rows + 0.5)
    depth = hits.depth[rows, columns]
    pixel = pencil.pixel[0] + pencil.pixel[1] * np.where(np.isfinite(depth), np.abs(depth), 0)
    truth, same = np.empty(count), np.zeros(count, bool)
    for which, number in ((np.arange(count) % closely != 0, places // 8), (np.ones(count, bool), places)):
        asked = np.flatnonzero(which & ~same)
        truth[asked] = dense.depth(origins[asked], directions[asked], number)
        with np.errstate(invalid="ignore"):
            close = np.abs(truth - depth) < 0.02 * pixel + 1e-9
        same[asked] = ((np.isinf(truth) & np.isinf(depth)) | close)[asked]
    found = []
    for k in np.flatnonzero(~same):
        # Dense signs step over a chord that is shorter than their steps.
        behind = depth[k] + np.array([1e-9, 1e-7, 1e-5, 1e-3, 1e-2]) * pixel[k]
        if depth[k] < truth[k] and dense.inside(origins[k] + behind[:, None] * directions[k]).any():
            continue
        turns = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        moved = [(0.2 * s * np.cos(a), 0.2 * s * np.sin(a)) for a in turns for s in (0.5, 1)]
        around = dense.depth(*pencil.rays(*(np.array([columns[k], rows[k]]) + 0.5 + moved).T), places)
        near = around[np.isfinite(around)]
        if np.isinf(depth[k]):
            fine = len(near) < len(around)
        else:
            fine = len(near) and near.min() - 0.5 * pixel[k] <= depth[k] <= near.max() + 0.5 * pixel[k]
        if not fine:
            found.append((int(columns[k]), int(rows[k]), float(depth[k]), float(truth[k])))
    return found, int(hits.undecided.sum())


@pytest.mark.random
@pytest.mark.parametrize("name", MODELS)
def test_shipped_models(name):
    shape = space(name)
    assert complaints(shape, None, camera(shape.bounds, (160, 120)), 300, 800) == ([], 0)


@pytest.mark.slow
@pytest.mark.parametrize("name", of_the_day(MODELS, 4))
def test_twenty_thousand_rays_for_three_sets_of_letters(name):
    shape, generator = space(name), np.random.default_rng(5)
    for k in range(3):
        letters = letters_of(shape, generator) if k else None
        pencil = camera(shape.bounds, (400, 300), k - 0.96, 0.384 - 0.3 * k, eye=k % 2 == 0)
        assert complaints(shape, letters, pencil, 20_000, 4000, closely=13) == ([], 0)


def shape_of(expression, letters=None):
    return rsym.Shape(expression, (x, y, z), letters=letters, bounds=BOX)


def attacks():
    """Bodies that are hard on enclosures."""
    p, k = sp.symbols("p k", real=True)
    ball, disc = (4 - x**2 - y**2 - z**2) / 4, (4 - x**2 - y**2) / 4
    other = (1 - (x - 2) ** 2 - y**2 - z**2) / 2
    return {
        "thin wall": shape_of(rsym.conjunction(ball, 1e-8 - (x + y) ** 2)),
        "thin shell": shape_of(rsym.conjunction(ball, (x**2 + y**2 + z**2 - 3.999999) / 4)),
        "touching": shape_of(rsym.disjunction(other, (1 - x**2 - y**2 - z**2) / 2)),
        "nested trimming": shape_of(0.5 - rsym.trimming(rsym.trimming(x - y, disc), (4 - z**2) / 4)),
        "norm": shape_of(1.5 - sp.sqrt(rsym.Rp(p).conjunction(x, y) ** 2 + z**2), {p: rsym.Letter(2.5, 1.5, 4)}),
        "angle": shape_of(rsym.conjunction(ball, sp.sin(k * sp.atan2(y, x)) + z / 4), {k: 5}),
        "waves": shape_of(rsym.conjunction(ball, sp.sin(4 * x) * sp.cos(4 * y) + sp.sin(4 * z) * sp.cos(4 * x))),
        "0/0": shape_of(rsym.conjunction(ball, (x**2 - y**2) / (x**2 + y**2) + sp.Rational(1, 3))),
        "pole": shape_of(rsym.conjunction(ball, 1 / (x - y) - 1)),
        "undefined": shape_of(rsym.conjunction(ball, sp.sqrt(1 - x**2 - y**2) - z)),
        "powers": shape_of(1.7 - (sp.Abs(x) ** 1.5 + sp.Abs(y) ** 1.5 + sp.Abs(z) ** 3.0)),
        "alpha": shape_of(rsym.RAlpha(sp.Rational(1, 2)).conjunction(ball, z) - sp.Rational(1, 10)),
        "order": shape_of(rsym.R0m(2).disjunction(other, disc - z**2) - sp.Rational(1, 20)),
        "sardf": shape_of(rsym.Sardf().conjunction(ball, x + y) - sp.Rational(1, 20)),
        "rho": shape_of(rsym.conjunction(ball, rsym.conjunction(x, y, system=rsym.Rho(sp.Rational(1, 2))))),
        "choice": shape_of(sp.Piecewise((ball, x > y), (other, True))),
    }


ATTACKS = attacks()


@pytest.mark.random
@pytest.mark.parametrize("name", ATTACKS)
@pytest.mark.parametrize("eye", [True, False])
def test_attacks(name, eye):
    shape = ATTACKS[name]
    pencil = camera(shape.bounds, (120, 90), 0.7, 0.3, eye=eye, room=1.2)
    assert complaints(shape, None, pencil, 400, 1500) == ([], 0)


def test_depth_normal_and_curvature_of_a_ball():
    generator = np.random.default_rng(3)
    origins, aims = generator.normal(size=(2, 500, 3))
    origins = 3 * origins / np.linalg.norm(origins, axis=1)[:, None]
    directions = aims - origins
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    along = np.einsum("ij,ij->i", origins, directions)
    with np.errstate(invalid="ignore"):
        depth = -along - np.sqrt(along**2 - 9 + 4)
    caster = Caster(BALL, bounds=((-5, 5),) * 3)
    hits = caster.cast(origins, directions)
    expected = np.where(depth > 0, depth, np.inf)
    met = np.isfinite(expected)
    assert (hits.met == met).all()
    assert met.sum() > 100
    np.testing.assert_allclose(hits.depth[met], expected[met], rtol=1e-13)
    np.testing.assert_allclose(hits.normal[met], hits.points[met] / 2, atol=1e-13)
    fields = hits.fields("gaussian_curvature", "mean_curvature")
    np.testing.assert_allclose(fields["gaussian_curvature"][met], 0.25)
    np.testing.assert_allclose(np.abs(fields["mean_curvature"][met]), 0.5)
    assert np.isnan(fields["mean_curvature"][~met]).all()


def test_bounds_and_cuts_are_leaves():
    caster = Caster(BALL, bounds=((-1, 5), (-5, 5), (-5, 5)))
    hits = caster.cast([[-3, 0, 0], [-3, 0, 1.9]], [1, 0, 0], cuts=[Cut((-2, 0, 0), -1.0)])
    assert hits.leaf.tolist() == [7, 7]
    assert hits.depth[0] == pytest.approx(3.5)
    assert hits.normal[0].tolist() == [-1, 0, 0]
    plain = caster.cast([[-3, 0, 0], [-3, 0, 1.9]], [1, 0, 0])
    assert plain.leaf.tolist() == [1, 0]
    assert plain.depth[0] == 2
    assert plain.normal[0].tolist() == [-1, 0, 0]
    assert caster.leaves[1] == "cap x lower"


def test_a_surface_that_lies_in_the_bounds_is_itself():
    half = rsym.Shape(rsym.conjunction((4 - x**2 - y**2 - z**2) / 4, z), (x, y, z), bounds=((-3, 3), (-3, 3), (0, 3)))
    hits = Caster(half).cast([0.3, 0.2, -5.0], [0, 0, 1.0])
    assert hits.leaf == 1
    assert hits.depth == pytest.approx(5)


def test_of_coplanar_leaves_the_first_is_met():
    twice = rsym.disjunction(rsym.conjunction(z, x), rsym.conjunction(z + z**3, 1 - x, x + 1))
    shape = rsym.Shape(rsym.conjunction(twice, 1 - z), (x, y, z), bounds=BOX)
    hits = Caster(shape).cast(
        np.stack([np.linspace(-0.6, 0.6, 50), np.zeros(50), np.full(50, -2.0)], axis=1), [0.1, 0.2, 1]
    )
    assert (hits.leaf == np.where(hits.points[:, 0] > 0, 0, 2)).all()


def test_threads_and_rays_one_by_one_agree():
    shape = space("car")
    pencil = camera(shape.bounds, (90, 70), room=0.8)
    one, three = (Caster(shape, threads=threads).look(pencil) for threads in (1, 3))
    for name in ("depth", "leaf", "normal", "undecided"):
        np.testing.assert_array_equal(getattr(one, name), getattr(three, name))
    single = Caster(shape).cast(*pencil.rays(), pixel=pencil.pixel)
    assert (single.met == one.met).mean() > 0.999
    both = single.met & one.met
    apart = np.abs(single.depth[both] - one.depth[both])
    assert apart.max() < 0.5 * pencil.pixel[1] * 200
    assert np.quantile(apart, 0.99) < 1e-11


@pytest.mark.random
@pytest.mark.parametrize("name", ["car", "spring", "clip", "valve"])
def test_arrays_march_as_the_kernels_do(name, monkeypatch):
    shape = space(name)
    pencil = camera(shape.bounds, (40, 30), room=1.0)
    fast = Caster(shape).look(pencil)
    monkeypatch.setattr(casting, "default_backend", lambda: "numpy")
    slow = Caster(shape)
    assert isinstance(slow._kernels, ArrayRays)
    found = slow.look(pencil)
    assert (found.met == fast.met).mean() > 0.998
    both = found.met & fast.met
    assert np.quantile(np.abs(found.depth[both] - fast.depth[both]), 0.98) < 1e-9
    assert (found.leaf == fast.leaf)[both].mean() > 0.98
    assert np.nanquantile(np.abs(found.normal[both] - fast.normal[both]), 0.98) < 1e-7


def test_letters_change_and_nothing_is_compiled():
    k = sp.Symbol("k", real=True)
    shape = rsym.Shape((k**2 - x**2 - y**2 - z**2) / 4, (x, y, z), letters={k: 2}, bounds=BOX)
    caster = Caster(shape)
    kernels = caster._kernels
    for radius in (2.0, 1.5, 0.25):
        caster.set({k: radius})
        assert caster.cast([0, 0, 5], [0, 0, -1]).depth == pytest.approx(5 - radius, rel=1e-14)
    assert caster._kernels is kernels


def crowd(count):
    """Balls and turned ellipsoids whose sizes are letters, cut by a box, a root and a part that stands twice."""
    generator = np.random.default_rng(7)
    k, m = sp.symbols("k m", real=True)
    places = [[sp.Rational(int(number), 64) for number in row] for row in generator.integers(-128, 128, (count, 3))]
    bodies = []
    for number, (a, b, c) in enumerate(places):
        u, v, w = x - a, y - b, z - c
        body = u**2 + v**2 + w**2 if number % 2 else u**2 + 2 * v**2 + 3 * w**2 + sp.Rational(number, count) * u * v
        bodies.append((k if number % 3 else m) ** 2 - body)
    part = rsym.conjunction(rsym.disjunction(*bodies[:3]), x + z + 1)
    inside = rsym.conjunction(rsym.disjunction(part, *bodies[3:]), *(2 - side for side in (x, -x, y, -y, z, -z)))
    rest = rsym.disjunction(inside, rsym.conjunction(part, -inside, 1 - y))
    return rsym.Shape(
        rsym.conjunction(rest, sp.sqrt(z + sp.Rational(7, 4)) - sp.Rational(1, 8)),
        (x, y, z),
        letters={k: rsym.Letter(0.6, 0.2, 1), m: rsym.Letter(0.4, 0.2, 1)},
        bounds=BOX,
    )


def large_from(celled, tabled, monkeypatch):
    """Take forms of so many gates for large ones."""
    monkeypatch.setattr(ray_kernels, "_kernels", {})
    monkeypatch.setattr(casting, "_made", getattr(casting._made, "__wrapped__", casting._made))
    monkeypatch.setattr(ray_code, "CELLED", celled)
    monkeypatch.setattr(ray_code, "TABLED", tabled)


def seen_by(shape, tabled, monkeypatch):
    """What two sets of letters show to a picture and to rays from everywhere, and the kernels."""
    large_from(8, tabled, monkeypatch)
    caster, generator = Caster(shape), np.random.default_rng(11)
    origins, aims = generator.normal(size=(2, 400, 3))
    for letters in (None, {"k": 0.5, "m": 0.8}):
        caster.set(letters)
        yield caster._kernels.formulas.tabled, caster.look(camera(shape.bounds, (64, 48), room=1.2))
        yield caster._kernels.formulas.tabled, caster.cast(origins * 3, aims - origins, pixel=(1e-3, 0.0))


@pytest.mark.parametrize("count", [12, pytest.param(80, marks=pytest.mark.slow)])
def test_tables_of_kinds_give_the_bits_of_branches(count, monkeypatch):
    shape = crowd(count)
    tables = list(seen_by(shape, 8, monkeypatch))
    branches = list(seen_by(shape, 10**9, monkeypatch))
    for (tabled, one), (never, other) in zip(tables, branches, strict=True):
        assert tabled
        assert not never
        assert one.met.sum() > 20
        assert not one.undecided.any()
        for name in ("depth", "leaf", "normal", "undecided"):
            np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_cells_leave_out_nothing_that_matters(monkeypatch):
    shape, pencil, seen = crowd(12), camera(BOX, (96, 72), room=1.2), []
    for gates in (8, 10**9):
        large_from(gates, gates, monkeypatch)
        seen += [Caster(shape, threads=threads).look(pencil) for threads in (1, 3)]
    one, same, other, _ = seen
    np.testing.assert_array_equal(one.depth, same.depth)
    np.testing.assert_array_equal(one.leaf, same.leaf)
    assert (one.met == other.met).mean() > 0.999
    both = one.met & other.met
    assert np.quantile(np.abs(one.depth[both] - other.depth[both]), 0.98) < 1e-9


@pytest.mark.random
def test_a_large_form_by_dense_signs(monkeypatch):
    large_from(8, 8, monkeypatch)
    shape = crowd(12)
    assert complaints(shape, None, camera(shape.bounds, (120, 90), 0.7, 0.3, room=1.2), 400, 1500) == ([], 0)


def test_leaves_that_differ_by_numbers_are_of_one_kind():
    k = sp.Symbol("k", real=True)
    places = [(sp.Rational(a, 7), sp.Rational(b, 5), sp.Rational(3, 8)) for a in range(1, 6) for b in range(1, 5)]
    balls = [k**2 - (x - a) ** 2 - (y - b) ** 2 - (z - c) ** 2 for a, b, c in places]
    formulas = ray_code.RayFormulas(shape_form(shape_of(rsym.disjunction(*balls, z), {k: 1})))
    assert formulas.count == 21
    assert len(formulas.kinds.kinds) < 8


@pytest.mark.slow
def test_a_thousand_balls_by_the_formula_of_a_ball():
    generator = np.random.default_rng(1)
    centres, radii = generator.integers(-640, 640, (1000, 3)), generator.integers(19, 58, 1000)
    numbers = [[sp.Rational(int(number), 64) for number in row] for row in np.column_stack([centres, radii])]
    balls = [r**2 - (x - a) ** 2 - (y - b) ** 2 - (z - c) ** 2 for a, b, c, r in numbers]
    shape = rsym.Shape(rsym.disjunction(*balls), (x, y, z), bounds=((-11, 11),) * 3)
    pencil = camera(shape.bounds, (120, 90), room=1.2)
    hits = Caster(shape).look(pencil)
    assert not hits.undecided.any()
    origins, directions = (part.reshape(-1, 3) for part in pencil.rays())
    centres, radii = centres / 64, radii / 64
    away = origins[:, None] - centres
    along = -np.einsum("ijk,ik->ij", away, directions)
    off = np.einsum("ijk,ijk->ij", away, away) - along**2  # the squared distance of the ray from the centre
    depths = np.where(off < radii**2, along - np.sqrt(np.maximum(radii**2 - off, 0)), np.inf)
    nearest, found = depths.min(axis=1), hits.depth.ravel()
    both = np.isfinite(nearest) & np.isfinite(found)
    right = np.isinf(nearest) & np.isinf(found)
    right[both] = np.abs(nearest[both] - found[both]) < 1e-9
    pixel = pencil.pixel[1] * np.where(np.isfinite(depths), depths, along)
    rim = np.abs(np.sqrt(off) - radii) < 0.1 * pixel
    assert both.mean() > 0.3
    assert right.mean() > 0.99
    assert (right | rim.any(axis=1)).all()
    own = depths[both & right].argmin(axis=1)
    normals = (hits.points.reshape(-1, 3)[both & right] - centres[own]) / radii[own][:, None]
    np.testing.assert_allclose(hits.normal.reshape(-1, 3)[both & right], normals, atol=1e-8)


def test_deep_nests_that_are_alike_share_their_kernels():
    def nest(leaves):
        body = BALL.expression
        for k in range(leaves):
            body = (rsym.disjunction if k % 2 else rsym.conjunction)(body, x + k * y / leaves + 3 * (-1) ** k)
        return shape_of(body)

    one, other = Caster(nest(400)), Caster(nest(400))
    assert one._kernels is other._kernels
    assert one.cast([0, 0, 5], [0, 0, -1]).depth == other.cast([0, 0, 5], [0, 0, -1]).depth == 3


def test_a_ray_that_begins_inside_meets_the_body_there():
    hits = Caster(BALL).cast([[0, 0, 0], [0, 0, 5]], [0, 0, 1.0], near=0.5)
    assert hits.depth.tolist() == [0.5, np.inf]


@pytest.mark.parametrize(
    ("origins", "directions"), [([0, 0], [0, 1]), ([0, 0, 0], [0, 0, 0]), ([[0, 0, 0]] * 2, [[0, 0, 1]] * 3)]
)
def test_what_is_no_ray_is_refused(origins, directions):
    with pytest.raises(RsymError):
        Caster(BALL).cast(origins, directions)


def test_illegal_parameters_are_refused():
    p = sp.Symbol("p", real=True)
    shape = rsym.Shape(rsym.Rp(p).conjunction(x, y), (x, y, z), letters={p: 2}, bounds=BOX)
    with pytest.raises(RsymError, match="out of its range"):
        Caster(shape, {p: 1})


def test_more_leaves_than_have_numbers_are_refused(monkeypatch):
    monkeypatch.setattr(ray_kernels, "MOST_LEAVES", 2)
    with pytest.raises(RsymError, match="at most 2 leaves"):
        ray_kernels.RayKernels(shape_form(shape_of(rsym.conjunction(x, y, z))))


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("fadd <8 x double> %v", "fsub <8 x double> %v"), ("fmul <8 x double> %v", "fadd <8 x double> %v")],
)
def test_miscompiled_kernels_are_refused(right, wrong, monkeypatch):
    code = ray_kernels.caster_code
    monkeypatch.setattr(ray_kernels, "caster_code", lambda formulas: code(formulas).replace(right, wrong))
    shape = rsym.Shape(rsym.conjunction(BALL.expression, x**3 - y, z + x * y), (x, y, z), bounds=BOX)
    with pytest.raises(RsymError, match="differ from their formulas"):
        ray_kernels.RayKernels(shape_form(shape))


@pytest.mark.parametrize("kind", range(3))
def test_a_miscompiled_kind_is_refused(kind, monkeypatch):
    def broken(formulas):
        functions = code(formulas).split("define ")
        (number,) = (k for k, text in enumerate(functions) if f"@value{kind}(" in text.partition("\n")[0])
        assert "fadd" in functions[number]
        functions[number] = functions[number].replace("fadd", "fsub")
        return "define ".join(functions)

    large_from(2, 2, monkeypatch)
    code = ray_kernels.caster_code
    monkeypatch.setattr(ray_kernels, "caster_code", broken)
    shape = rsym.Shape(rsym.conjunction(BALL.expression, x**3 - y, z + x * y - 10), (x, y, z), bounds=BOX)
    with pytest.raises(RsymError, match="differ from their formulas"):
        ray_kernels.RayKernels(shape_form(shape))
