"""Exact patches against the plain parametrisations, implicit equations and closed curvatures."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym.errors import RsymError
from rsym.model.letters import Letter
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.exact import (
    cone,
    cone_quarter,
    cylinder,
    cylinder_quarter,
    ellipsoid,
    ellipsoid_octant,
    sphere,
    sphere_octant,
    torus,
    torus_quarter,
)
from rsym.surfaces.coons.revolution import Arc, Revolution, Segment
from rsym.surfaces.parametric import ParametricSurface
from rsym.surfaces.symbols import t, u, v

QUARTER = np.pi / 2
U, V = np.meshgrid(np.linspace(0, 1, 21), np.linspace(0, 1, 21), indexing="ij")
STEP = t**2 * (3 - 2 * t) + t**3 * (1 - t) ** 2

KEEPING = [
    HermiteBlend.class1(1, QUARTER),
    HermiteBlend.class2(-12, QUARTER),
    HermiteBlend.class2(0.7, QUARTER),
    HermiteBlend.class2(3, QUARTER),
    HermiteBlend.trigonometric(-3),
    HermiteBlend.trigonometric(1),
    HermiteBlend.from_smoothstep(STEP, QUARTER),
]


def turning(rho, height, theta, scale=(1, 1)):
    return np.stack([scale[0] * rho * np.cos(theta), scale[1] * rho * np.sin(theta), height + 0 * theta], axis=-1)


@pytest.mark.random
@pytest.mark.parametrize("number", range(len(KEEPING)))
def test_octants_and_quarters_are_exact_for_every_blend_that_promises_it(number):
    blend_u, blend_v = KEEPING[number], KEEPING[number - 3]
    theta, phi = QUARTER * U, QUARTER * V
    got = ellipsoid_octant(3, 2, 1, blend_u=blend_u, blend_v=blend_v)(U, V)
    assert_close(got, turning(np.cos(phi), np.sin(phi), theta, (3, 2)), atol=3e-15)
    got = torus_quarter(3, 1, blend_u=blend_u, blend_v=blend_v)(U, V)
    assert_close(got, turning(3 + np.cos(phi), np.sin(phi), theta), atol=4e-15)
    ball = sphere_octant(1, blend_u=blend_u, blend_v=blend_v)
    assert_close(np.linalg.norm(ball(U, V), axis=-1), np.ones(U.shape), atol=1e-15)


def test_a_shape_parameter_slides_without_leaving_the_sphere():
    mu, nu = sp.symbols("mu nu")
    blend_u = HermiteBlend.class2(mu, QUARTER, letters={mu: Letter(0, minimum=-12, maximum=3)})
    octant = sphere_octant(2, blend_u=blend_u, blend_v=HermiteBlend.trigonometric(nu, letters={nu: 0}))
    assert set(octant.letters) == {"mu", "nu"}
    for values in ({"mu": -12, "nu": 1}, {"mu": 3, "nu": -3}):
        assert_close(np.linalg.norm(octant(U, V, letters=values), axis=-1), np.full(U.shape, 2.0), atol=2e-15)


def octant_matrix(a, b, c):
    """The matrix as it stands in the theory: quarter data of cos, sin and 1."""
    cosine, sine, one = np.array([1, 0, 0, -QUARTER]), np.array([0, 1, QUARTER, 0]), np.array([1.0, 1, 0, 0])
    return np.stack([a * np.outer(cosine, cosine), b * np.outer(sine, cosine), c * np.outer(one, sine)], axis=-1)


def test_the_corner_data_and_what_the_cubic_blend_and_zero_twists_make_of_them():
    assert_close(ellipsoid_octant(3, 2, 1).matrix, octant_matrix(3, 2, 1), atol=1e-15)
    cubic = HermiteBlend.cubic()
    rough = sphere_octant(1, blend_u=cubic, blend_v=cubic, exact=False)
    assert_close(np.linalg.norm(rough(U, V), axis=-1).min() - 1, -0.0237, atol=5e-5)
    flat = octant_matrix(1, 1, 1)
    flat[2:, 2:] = 0
    ferguson = BicubicCoons(flat, KEEPING[0], KEEPING[0])
    assert np.abs(np.linalg.norm(ferguson(U, V), axis=-1) - 1).max() > 0.04


@pytest.mark.random
@pytest.mark.parametrize(
    ("longitude", "start", "span"), [((0.3, 1.1), -0.4, 0.7), ((2, 3.5), 1, 4.5), ((-1, 1e-4), 0, 1e-5)]
)
def test_any_arc_turns_over_any_angle(longitude, start, span):
    surface = Revolution(Arc((3, 1), (2, 0.5), start, span), scale=(1, 0.7))
    theta, phi = longitude[0] + longitude[1] * U, start + span * V
    expected = turning(3 + 2 * np.cos(phi), 1 + 0.5 * np.sin(phi), theta, (1, 0.7))
    assert_close(surface.patch(longitude)(U, V), expected, atol=2e-14)
    if longitude[1] < 3 and span < 3:
        blends = {"blend_u": HermiteBlend.class2(2, longitude[1]), "blend_v": HermiteBlend.class2(-3, span)}
        assert_close(surface.patch(longitude, **blends)(U, V), expected, atol=2e-14)


@pytest.mark.slow
def test_cones_cylinders_and_rings():
    theta = QUARTER * U
    for blend_v in (None, HermiteBlend.class1(0.3, 1.0), HermiteBlend.class1(1, QUARTER), HermiteBlend.class2(1, 0)):
        got = cone_quarter(2, 3, top=0.5, blend_v=blend_v)(U, V)
        assert_close(got, turning(2 - 1.5 * V, 3 * V, theta), atol=3e-15)
    assert_close(cylinder_quarter(2, 3)(U, V), turning(2 + 0 * V, 3 * V, theta), atol=3e-15)
    ring = Revolution(Segment((1, 2), (3, 2))).patch((0.5, 1))
    assert_close(ring(U, V), turning(1 + 2 * V, 2 + 0 * V, 0.5 + U), atol=5e-15)


def assembled():
    return {
        "sphere": sphere(2, pieces=(3, 2), blend_u=HermiteBlend.class2(1, 2 * np.pi / 3)),
        "ellipsoid": ellipsoid(3, 2, 1, pieces=(2, 2)),
        "torus": torus(3, 1, pieces=(2, 3)),
        "cone": cone(2, 3, top=1, pieces=(2, 1)),
        "cylinder": cylinder(2, 3, pieces=(3, 1)),
    }


@pytest.mark.random
@pytest.mark.parametrize("name", ["sphere", "ellipsoid", "torus", "cone", "cylinder"])
def test_whole_surfaces_lie_on_their_shape_with_normals_outwards(name):
    patches = assembled()[name]
    shape = patches[0].surface.shape
    kernel = rsym.compile(shape, ("value", "gradient"))
    (x0, x1), (y0, y1), (z0, z1) = shape.bounds
    u, v = U[::4, ::4], V[::4, ::4]
    for patch in patches:
        points = patch(u, v)
        assert (points > [x0, y0, z0]).all()
        assert (points < [x1, y1, z1]).all()
        found = kernel(*np.moveaxis(points, -1, 0))
        assert_close(found["value"], np.zeros(u.shape), atol=1e-14)
        inwards = found["gradient"] / np.linalg.norm(found["gradient"], axis=-1)[..., None]
        assert_close(patch.normal(u, v), -inwards, atol=1e-13)


@pytest.mark.slow
def test_the_sphere_has_one_curvature_poles_included():
    near = np.concatenate([10.0 ** -np.arange(1, 17), [0.0, 0.5]])
    rows = np.concatenate([near, 1 - near])
    u, v = np.meshgrid(np.linspace(0, 1, 7), rows, indexing="ij")
    for number, blend in enumerate((None, KEEPING[2])):
        for patch in sphere(2, blend_u=blend, blend_v=blend)[number : number + 1]:
            assert_close(patch.gaussian_curvature(u, v), np.full(u.shape, 0.25), atol=1e-10)
            assert_close(patch.mean_curvature(u, v), np.full(u.shape, -0.5), atol=1e-10)
            assert_close(patch.normal(u, v), patch(u, v) / 2, atol=5e-15)


@pytest.mark.slow
def test_curvatures_of_ellipsoid_torus_and_cone_in_closed_form():
    a, b, c = 3.0, 2.0, 1.0
    points = ellipsoid_octant(a, b, c)(U, V)
    weight = (points**2 / np.array([a, b, c]) ** 4).sum(axis=-1)
    assert_close(ellipsoid_octant(a, b, c).gaussian_curvature(U, V), 1 / (a * b * c * weight) ** 2, rtol=1e-11)
    cosine = np.cos(QUARTER * V)
    assert_close(torus_quarter(3, 1).mean_curvature(U, V), -(3 + 2 * cosine) / (2 * (3 + cosine)), atol=1e-13)
    at = cone_quarter(1, 1).mean_curvature(0.5, [0.0, 0.5])
    assert_close(at, [-np.sqrt(2) / 4, -np.sqrt(2) / 2], rtol=1e-12)


def test_curvature_at_a_pole_that_bends_differently_in_every_direction():
    """Polar coordinates on z = (1 + a) x**2 + (1 - a) y**2, where z_uuvv is not 0 at the pole."""
    a = 0.3
    bowl = ParametricSurface((v * sp.cos(u), v * sp.sin(u), v**2 * (1 + a * sp.cos(2 * u))), domain=((0, 6), (0, 1)))
    around = np.linspace(0, 6, 9)
    for height in (0.0, 1e-9, 1e-7):
        assert_close(bowl.gaussian_curvature(around, height), np.full(9, 4 * (1 - a**2)), atol=1e-6)
        assert_close(np.abs(bowl.mean_curvature(around, height)), np.full(9, 2.0), atol=1e-6)


def test_the_apex_of_a_cone_has_no_curvature():
    assert np.isnan(cone_quarter(1, 1).mean_curvature([0.0, 0.5], 1.0)).all()
    assert np.isnan(cone_quarter(1, 1).gaussian_curvature(0.5, 1.0))


@pytest.mark.slow
def test_octants_meet_with_equal_second_derivatives():
    patches = sphere(1)
    east, north, south = patches[1], patches[3], patches[0]
    along = np.linspace(0, 1, 9)
    for order in ((0, 0), (1, 0), (2, 0), (1, 1)):
        assert_close(east.derivative(1.0, along, order), north.derivative(0.0, along, order), atol=1e-14)
    for order in ((0, 0), (0, 1), (0, 2), (1, 1)):
        assert_close(south.derivative(along, 1.0, order), east.derivative(along, 0.0, order), atol=1e-14)
    last = patches[-1].derivative(1.0, along, (2, 0))
    assert_close(last, east.derivative(0.0, along, (2, 0)), atol=1e-14)


@pytest.mark.slow
def test_dimensions_and_angles_may_be_letters():
    R, r, angle = sp.symbols("R r angle")
    letters = {R: 3, r: 1}
    ring = torus_quarter(R, r, letters=letters)
    values = {"R": 5.0, "r": 2.0}
    phi = QUARTER * V
    assert_close(ring(U, V, letters=values), turning(5 + 2 * np.cos(phi), 2 * np.sin(phi), QUARTER * U), atol=1e-14)
    omega = rsym.compile(ring.surface.shape)(*np.moveaxis(ring(U, V, letters=values), -1, 0), letters=values)["value"]
    assert_close(omega, np.zeros(U.shape), atol=1e-13)
    bent = Revolution(Arc((0, 0), (1, 1), 0, angle), letters={angle: 1}).patch((0, angle))
    for size in (1e-7, 0.4, 2.0, 4.0):
        expected = turning(np.cos(size * V), np.sin(size * V), size * U)
        assert_close(bent(U, V, letters={"angle": size}), expected, atol=3e-15)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: sphere_octant(1, blend_v=HermiteBlend.cubic()),
            r"in v does not keep arcs of the angle pi/2: cos\(pi\*t/2\) comes back off by 0.0108.*class1\(1, pi/2\)",
        ),
        (
            lambda: sphere_octant(1, blend_u=HermiteBlend.class2(0, 1.0)),
            "in u does not keep arcs of the angle pi/2",
        ),
        (lambda: torus(3, 1, pieces=(4, 3), blend_v=KEEPING[1]), r"angle 2\*pi/3"),
        (lambda: cylinder_quarter(1, 1, blend_v=KEEPING[1]), r"in v does not keep straight lines: t comes back off"),
        (lambda: sphere_octant(-1), "a radius of an arc must be positive, got -1"),
        (lambda: ellipsoid_octant(1, 0, 1), "a scale must be positive, got 0"),
        (lambda: torus(1, 2), "R = 1 is less than r = 2"),
        (lambda: sphere(1, pieces=(0, 2)), r"positive integers, got \(0, 2\)"),
        (lambda: sphere(1, pieces=(1, 2)), "use shorter pieces"),
        (lambda: Arc((0, 0), (1, 1), 0, -1), r"span of an arc lies in \(0, 2 pi\], got -1"),
        (lambda: Segment((1, 1), (1, 1)), "a segment has two ends"),
        (lambda: sphere_octant(sp.Symbol("a")), "unknown symbol 'a'"),
    ],
)
def test_what_is_not_exact_is_refused_with_a_remedy(make, message):
    with pytest.raises(RsymError, match=message):
        make()


@pytest.mark.slow
def test_the_formula_of_a_patch_is_that_of_the_surface_by_algebra():
    mu = sp.Symbol("mu", real=True)
    theta, phi = sp.pi * u / 2, sp.pi * v / 2
    blend = HermiteBlend.class2(mu, QUARTER, letters={mu: 1})
    for patch in (ellipsoid_octant(3, 2, 1), ellipsoid_octant(3, 2, 1, blend_u=blend, blend_v=blend)):
        expected = (3 * sp.cos(theta) * sp.cos(phi), 2 * sp.sin(theta) * sp.cos(phi), sp.sin(phi))
        for got, wanted in zip(patch.expression(), expected, strict=True):
            assert sp.expand(sp.numer(sp.together((got - wanted).rewrite(sp.exp)))) == 0
