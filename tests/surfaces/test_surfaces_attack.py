"""What once went wrong with patches, each with an oracle of its own."""

import mpmath
import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

from rsym.backends.kernel import compiled
from rsym.errors import RsymError, RsymWarning
from rsym.surfaces import sphere, sphere_octant
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.twists import estimate_twists, with_twists
from rsym.surfaces.functions import formulas
from rsym.surfaces.functions.curves import as_curve
from rsym.surfaces.joints.continuity import continuity_report
from rsym.surfaces.joints.joining import join
from rsym.surfaces.meshes import mesh_patches
from rsym.surfaces.networks.composite import CompositeCoons
from rsym.surfaces.networks.gordon import LagrangeSurface, TensorProductSurface
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v


def paraboloid(steepness, radius):
    """z = steepness r**2 in polar parameters r, angle."""
    return ParametricSurface((u * sp.cos(v), u * sp.sin(v), steepness * u**2), ((0, radius), (0, 3)))


@pytest.mark.parametrize(("steepness", "radius"), [(1, 1), (1, 10**6), (1000, 1), (1, 200)])
def test_curvatures_near_a_pole_do_not_depend_on_the_size_of_the_domain(steepness, radius):
    r = np.array([0, 1e-9, 3e-7, 4e-6, 1e-4, 1e-3, 0.01, 0.5]) / steepness
    expected = 4 * steepness**2 / (1 + 4 * steepness**2 * r**2) ** 2
    assert_close(paraboloid(steepness, radius).gaussian_curvature(r, 1.0) / expected, np.ones(8), atol=1e-9)


def test_normals_on_both_sides_of_an_inner_pole_follow_the_parameters():
    disc = ParametricSurface((u * sp.cos(v), u * sp.sin(v), u**2), ((-1, 1), (0, 3)))
    assert_close(disc.normal([-1e-3, -1e-9, 1e-9, 1e-3], 1.0)[:, 2], [-1, -1, 1, 1], atol=1e-5)


@pytest.mark.slow
def test_a_sphere_has_one_curvature_all_the_way_to_its_pole():
    point = (sp.cos(u) * sp.cos(v), sp.sin(u) * sp.cos(v), sp.sin(v))
    globe = ParametricSurface(point, ((0, 2 * sp.pi), (-sp.pi / 2, sp.pi / 2)), closed=(True, False))
    latitudes = np.pi / 2 - 10.0 ** -np.arange(4, 17)
    assert_close(globe.mean_curvature(1.0, latitudes), -np.ones(13), atol=1e-12)
    shares = 1 - 10.0 ** -np.arange(1, 17)
    assert_close(sphere_octant(1)(0.3, 1.0), [0, 0, 1], atol=1e-15)
    assert_close(sphere_octant(1).gaussian_curvature(0.3, shares), np.ones(16), atol=1e-11)


def test_curvatures_near_a_pole_of_no_symmetry_agree_with_fifty_digits():
    point = sp.Matrix([u * sp.cos(v) * (1 + u), u * sp.sin(v) / (1 + u * u), u * u * (1 + u * sp.cos(v))])
    tip = ParametricSurface(point, ((0, 1), (0, 6)))
    n = point.diff(u).cross(point.diff(v))
    (e, f, g), second = (
        (point.diff(a).dot(point.diff(b)) for a, b in ((u, u), (u, v), (v, v))),
        [n.dot(point.diff(a, b)) for a, b in ((u, u), (u, v), (v, v))],
    )
    gauss = sp.lambdify((u, v), (second[0] * second[2] - second[1] ** 2) / (e * g - f**2) ** 2, "mpmath")
    r = [1e-14, 1e-9, 1e-7, 5e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2]
    with mpmath.workdps(60):
        expected = [float(gauss(mpmath.mpf(one), mpmath.mpf(0.7))) for one in r]
    assert_close(tip.gaussian_curvature(r, 0.7), expected, rtol=2e-10)


@pytest.mark.slow
def test_a_flat_corner_has_no_curvature_and_the_tip_of_a_cone_none_that_is_finite():
    frame = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    matrix = np.zeros((4, 4, 3))
    matrix[1, 1, 0] = matrix[0, 1, 1] = matrix[1, 2:, 0] = matrix[0, 2:, 1] = 1
    matrix[2:, 1] = matrix[2:, 2:] = matrix[1, 1] - matrix[0, 1]
    corner = BicubicCoons(matrix @ frame)
    assert_close(corner.mean_curvature(0.3, [0.0, 1e-9, 1e-3, 0.5]), np.zeros(4), atol=1e-9)
    cone = ParametricSurface((u * sp.cos(v), u * sp.sin(v), u), ((0, 1), (0, 6)))
    r = 10.0 ** -np.arange(1, 12)
    assert_close(cone.mean_curvature(r, 1.0) * r, np.full(11, np.sqrt(1 / 8)), atol=1e-12)
    assert np.isnan(cone.mean_curvature(0, 1.0))


def side_by_side(opening, beyond=v):
    """z = sin 2x over [0, 1]^2 and, torn from it by `opening` in y, over [1, 2] x [0, 1]."""
    left = ParametricSurface((u, v, sp.sin(2 * u)))
    right = ParametricSurface((1 + u, beyond, sp.sin(2 + 2 * u) + opening(beyond)))
    return continuity_report([left, right])


@pytest.mark.slow
@pytest.mark.parametrize(
    "opening",
    [
        lambda y: sp.exp(-((30 * (y - sp.Rational(2, 5))) ** 2)) / 1000,  # joined at both ends
        lambda y: sp.exp(-((200 * y) ** 2)) / 1000,  # torn at one end, joined over all the rest
        lambda y: sp.Piecewise((0, y < sp.Rational(4, 5)), ((y - sp.Rational(4, 5)) ** 4, True)),
    ],
)
def test_a_crack_in_a_part_of_an_edge_is_reported_as_broken(opening):
    report = side_by_side(opening)
    gap = sp.lambdify(v, opening(v), "numpy")
    widest = gap(np.linspace(0, 1, 5001)).max()
    assert report.continuity == "broken"
    assert_close(report.edges[0].gap.value, widest, rtol=1e-3)
    assert abs(gap(report.edges[0].gap.point[1]) - widest) < 1e-3 * widest
    left = [one.interval for one in report.free if (one.patch, one.edge) in ((0, "u1"), (1, "u0"))]
    assert all(stop - start < 1e-4 for start, stop in left)


def test_edges_that_overlap_by_a_hundredth_are_found():
    report = side_by_side(lambda y: 0, v + sp.Rational(99, 100))
    assert report.continuity == "G2"
    assert_close(report.edges[0].intervals[0], [0.99, 1.0], atol=1e-9)


SADDLE = ParametricSurface((u, v, u * v))
GRID = np.stack([*np.meshgrid(np.arange(4.0), np.arange(5.0), indexing="ij"), np.zeros((4, 5))], axis=-1)


@pytest.mark.parametrize(
    "made",
    [
        lambda: SADDLE(np.array([0.5 + 1j]), 0.5),
        lambda: SADDLE.grid("a", [0.5]),
        lambda: as_curve((t, t**2, 0))(0.5, -1),
        lambda: as_curve((t, t**2, 0))("a"),
        lambda: as_curve(np.ones((3, 3)) * 1j),
        lambda: BicubicCoons(np.ones((4, 4, 3)) * 1j),
        lambda: TensorProductSurface("abc"),
        lambda: TensorProductSurface(GRID * 1j),
        lambda: BSplineSurface.interpolate(GRID * 1j),
        lambda: ParametricSurface((u, v, 0), closed=True),
        lambda: ParametricSurface((u, v, sp.Symbol("u") * v), letters={"u": 2})(0.5, 0.5),
        lambda: estimate_twists(GRID, ["bessel"]),
        lambda: estimate_twists(GRID, u=[0, 1, 2, np.inf]),
        lambda: estimate_twists(GRID, u="abcd"),
        lambda: with_twists(SADDLE, "zero"),
        lambda: mesh_patches(None),
        lambda: HermiteBlend.class1(1, float("nan")),
        lambda: HermiteBlend.class2(float("inf"), 1),
        lambda: HermiteBlend.class2(0, 1j),
        lambda: continuity_report([SADDLE], gap="a"),
        lambda: continuity_report([ParametricSurface((u, v, sp.log(u)))]),
        lambda: continuity_report([ParametricSurface((1, 1, 1)), SADDLE]),
    ],
)
def test_what_is_no_number_or_no_patch_is_refused_with_a_remedy(made):
    with pytest.raises(RsymError) as error:
        made()
    assert error.value.remedy


def test_a_network_with_an_infinitely_fast_curve_is_refused_by_name():
    speeds = (t, sp.sqrt(t), t)
    across = [(x, t, 0) for x in (0, sp.Rational(1, 3), 1)]
    along = [(speed, sp.Rational(j, 2), 0) for j, speed in enumerate(speeds)]
    with pytest.raises(RsymError, match="the u-curve 1 has no finite tangent where it meets the v-curve 0"):
        CompositeCoons(along, across)
    assert_close(CompositeCoons(along, across, twists="zero")(0.7, 0.2)[1:], [0.2, 0], atol=1e-14)


def test_lagrange_surfaces_meet_their_curves_far_from_the_origin_of_the_parameter():
    knots = 1e8 + np.arange(5)
    surface = LagrangeSurface([(sp.cos(t) * (j + 1), sp.sin(t), j**2) for j in range(5)], knots)
    s = np.linspace(0, 1, 7)
    expected = np.stack([np.stack([(j + 1) * np.cos(s), np.sin(s), 0 * s + j**2], -1) for j in range(5)], axis=1)
    assert_close(surface.grid(s, knots), expected, atol=1e-14)


def test_matrices_of_class_three_are_joined_to_second_order_in_whatever_way():
    p, q = (BicubicCoons(np.random.default_rng(seed).normal(size=(6, 6, 3))) for seed in (0, 1))
    s = np.linspace(0, 1, 5)
    found = [join(p, "u1", q, "u0", k, tolerance=10) for k in (2, 2 + 0 * t)]
    found.append(join(p, "u1", q, "u0", 2, tolerance=10, transfinite=True))
    with pytest.warns(RsymWarning, match="not proved of a function of Python"):
        found.append(join(p, "u1", q, "u0", lambda w: 2 + 0 * w, tolerance=10))
    for one in found:
        assert_close(one.derivative(0.0, s, (2, 0)), 4 * p.derivative(1.0, s, (2, 0)), atol=1e-9)


def test_patches_with_the_same_blends_share_one_kernel(monkeypatch):
    blends = HermiteBlend.class2(sp.Rational(1, 7), sp.pi / 3), HermiteBlend.cubic()
    made = []
    monkeypatch.setattr(formulas, "compiled", lambda *args: made.append(args) or compiled(*args))
    generator = np.random.default_rng(5)
    for _ in range(4):
        matrix = generator.normal(size=(4, 4, 3))
        point = BicubicCoons(matrix, *blends)(0.3, 0.8)
        assert_close(point, np.einsum("a,abc,b->c", blends[0](0.3), matrix, blends[1](0.8)), atol=1e-14)
    assert sum(len(program.letters) == 48 for program, *_ in made) == 1


@pytest.mark.slow
def test_meshes_close_far_from_the_origin():
    turn = np.linalg.qr(np.random.default_rng(8).normal(size=(3, 3)))[0]
    pieces = [BicubicCoons(_moved(one.matrix @ turn, 1e8)) for one in sphere(1)]
    whole = mesh_patches(pieces, 12)
    assert whole.status.closed
    assert len(whole.vertices) == len(mesh_patches(sphere(1), 12).vertices)


def _moved(matrix, far):
    matrix[:2, :2] += [far, far / 3, -far / 7]
    return matrix
