"""How the boundary moves with a letter: against exact volumes, differences of volumes, and moved points."""

import json
import math

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import x, y, z
from rsym.sampling.boundaries import boundary

pytestmark = pytest.mark.slow

a, b, c, p, r = sp.symbols("a b c p r", real=True)
PI = np.pi
VOLUMES = {
    "ball": (rsym.sphere(r, letters={r: 2}), r, 16 * PI, 1e-6),
    "torus": (rsym.torus(a, b, letters={a: 2, b: 0.5}), b, 4 * PI**2, 1e-5),
    "tube": (rsym.torus(a, b, letters={a: 2, b: 0.5}), a, 2 * PI**2 * 0.25, 3e-4),
    "box": (rsym.box(2 * a, 2, 2, letters={a: 1.1}), a, 8, 1e-12),
    "ellipsoid": (rsym.ellipsoid(a, b, 1, letters={a: 2, b: 1.5}), a, 2 * PI, 3e-5),
    "cylinder": (rsym.cylinder(r, letters={r: 2}) & rsym.slab(-1, c, letters={c: 1}), c, 4 * PI, 1e-3),
    "hole": (rsym.sphere(2) - rsym.sphere(r, letters={r: 1}), r, -4 * PI, 1e-5),
    "moved": (rsym.sphere(1).translate(p, 0, 0, letters={p: 0}), p, 0, 1e-6),
}
AREAS = {
    "disc": (rsym.disc(r, letters={r: 2}), r, 4 * PI),
    "ellipse": (rsym.ellipse(a, b, letters={a: 2, b: 1}), a, PI),
    "rectangle": (rsym.rectangle(a, b, letters={a: 2, b: 1}), b, 2),
    "ring": (rsym.disc(2) - rsym.disc(r, letters={r: 1}), r, -2 * PI),
    "clipped": (rsym.Shape(p - y + 0 * x, (x, y), letters={p: 0.25}, bounds=((-1, 2), (-1, 1))), p, 3),
}


@pytest.mark.random
@pytest.mark.parametrize("name", VOLUMES)
def test_volumes_whose_derivative_is_known(name):
    shape, letter, exact, tolerance = VOLUMES[name]
    found = rsym.sensitivity(shape, letter, resolution=32)
    assert abs(found.volume_derivative - exact) < tolerance * max(abs(exact), 1)
    assert found.values.shape == found.mesh.faces.shape


@pytest.mark.parametrize("name", AREAS)
def test_areas_whose_derivative_is_known(name):
    shape, letter, exact = AREAS[name]
    found = rsym.sensitivity(shape, letter)
    assert_close(found.area_derivative, exact, rtol=1e-7)
    assert [one.shape for one in found.values] == [(len(line) - 1, 2) for line in found.lines]


def test_in_space_the_order_is_four():
    errors = []
    for resolution in (16, 32):
        shape, letter, exact, _ = VOLUMES["ellipsoid"]
        errors.append(abs(rsym.sensitivity(shape, letter, resolution=resolution).volume_derivative - exact))
    assert errors[0] > 10 * errors[1]


@pytest.mark.parametrize("letter", ["a2", *(pytest.param(one, marks=pytest.mark.slow) for one in ("a", "a1", "p1"))])
def test_the_area_of_the_body_against_differences(letter):
    body = rsym.paper.skeleton_body()
    value = float(body.letters[letter].default)
    step = 1e-4 * value
    areas = [boundary(body.with_letters({letter: value + s * step}), body.bounds).area() for s in (-1, 1)]
    assert_close(rsym.sensitivity(body, letter).area_derivative, (areas[1] - areas[0]) / (2 * step), rtol=1e-6)


@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")
@pytest.mark.parametrize("letter", ["rb", "h3", "eps"])
def test_the_volume_of_the_car_against_differences_of_meshes(letter):
    """At 256, for a coarser mesh misses gaps; not by z2, for the lid of the boot lies in the plane of the windows."""
    car = rsym.paper.car()
    value = float(car.letters[letter].default)
    step = 0.01 * value
    volumes = [rsym.mesh(car, 256, letters={letter: value + s * step}).volume for s in (-1, 1)]
    found = rsym.sensitivity(car, letter, resolution=256)
    difference = (volumes[1] - volumes[0]) / (2 * step)
    assert abs(found.volume_derivative - difference) < 0.01 * abs(difference)


def test_the_sign_is_that_of_growth():
    """Positive outwards: a larger disc, a smaller hole."""
    disc = rsym.sensitivity(rsym.disc(r, letters={r: 2}), r)
    hole = rsym.sensitivity(rsym.disc(3) - rsym.disc(r, letters={r: 2}), r)
    assert disc.at([[2, 0]])[0] > 0 > hole.at([[2, 0]])[0]
    assert hole.at([[3, 0]])[0] == 0


def test_points_of_the_boundary_move_by_the_speed():
    """The boundary of the body at another letter is where the speed says, to second order."""
    body = rsym.paper.skeleton_body()
    found = rsym.sensitivity(body, "p1")
    start = rsym.sample(body, 100, over="boundary", rng=2)
    omega = rsym.compile(body, ("value", "gradient"))
    for step, allowed in ((0.1, 1e-4), (0.05, 2.5e-5)):
        moved = start.points + step * found.at(start.points)[:, None] * start.normals
        fields = omega(*moved.T, letters={"p1": 40 + step})
        assert np.abs(fields["value"] / np.linalg.norm(fields["gradient"], axis=1)).max() < allowed


def test_the_formula_is_the_field():
    letters = {a: 2, b: 1.5}
    ball = rsym.ellipsoid(a, b, 1, letters=letters) - rsym.half_space((1, 0, 0), b, letters=letters)
    found = rsym.sensitivity(ball, "a")
    points = rsym.sample(ball, 50, over="boundary", rng=1, resolution=32).points
    formula = sp.lambdify((x, y, z, a, b), found.expression)
    on_ball = np.abs(points[:, 0] ** 2 / 4 + points[:, 1] ** 2 / 2.25 + points[:, 2] ** 2 - 1) < 1e-9
    # Off the edges the gradient of omega is that of the active leaf times a positive factor, its derivative too.
    values = formula(*points[on_ball].T, 2, 1.5)
    assert_close(found.at(points[on_ball]), values, rtol=1e-6)
    assert_close(found.at(points[~on_ball]), np.zeros((~on_ball).sum()), atol=1e-12)


def test_the_formula_keeps_r_nodes():
    shape = rsym.Shape(1 - rsym.trimming(x, r - y), (x, y), letters={r: 2})
    assert rsym.sensitivity(shape, r, bounds=((-3, 3), (-3, 3))).expression.has(rsym.trimming(x, r - y).func)


def test_each_side_of_an_edge_has_its_speed():
    can = rsym.cylinder(r, letters={r: 2}) & rsym.slab(-1, 1)
    found = rsym.sensitivity(can, r, resolution=16)
    assert sorted(set(np.unique(found.values.round(9)).tolist())) == [0, 1]


def test_the_report():
    found = rsym.sensitivity(rsym.disc(r, letters={r: 2}), r)
    assert str(found).startswith("When r grows from 2, the boundary moves outwards by between 1 and 1 to a unit of it")
    record = json.loads(found.to_json())
    assert_close(record["area_derivative"], 4 * PI, rtol=1e-9)


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: rsym.sensitivity(3, "r"), "shape"),
        (lambda: rsym.sensitivity(rsym.disc(1), "r"), "unknown-letter"),
        (lambda: rsym.sensitivity(rsym.disc(r, letters={r: 1}), "r", resolution=0), "resolution"),
        (lambda: rsym.sensitivity(rsym.disc(r, letters={r: 1}), "r").volume_derivative, "dimension"),
        (lambda: rsym.sensitivity(rsym.disc(r, letters={r: 1}), "r").mesh, "dimension"),
        (lambda: rsym.sensitivity(rsym.sphere(r, letters={r: 1}), "r").area_derivative, "dimension"),
        (lambda: rsym.sensitivity(rsym.disc(r, letters={r: 1}), "r").at([1, 2]), "points"),
    ],
)
def test_what_is_refused(call, code):
    with pytest.raises(rsym.RsymError) as raised:
        call()
    assert raised.value.code == code
    assert raised.value.remedy


@pytest.mark.parametrize("thin", [100, 3000])
def test_what_is_thinner_than_the_lattice_moves_too(thin):
    a = sp.Symbol("a", positive=True)
    width = a / thin
    fin = rsym.disc(1) | rsym.rectangle(width, 4, letters={a: 1})
    half = 0.5 / thin  # it is beside the disc from sqrt(1 - half**2) to 2
    truth = (4 - 2 * math.sqrt(1 - half**2)) / thin
    assert rsym.sensitivity(fin, "a").area_derivative == pytest.approx(truth, rel=1e-9)
    hole = rsym.disc(2) - rsym.disc(width, (0.5, 0.3), letters={a: 1})
    assert rsym.sensitivity(hole, "a").area_derivative == pytest.approx(-2 * math.pi / thin**2, rel=1e-9)


def test_the_boundary_has_what_is_thinner_than_the_lattice():
    finned = rsym.disc(1) | rsym.rectangle(0.003, 4)
    found = boundary(finned, ((-3, 3),) * 2, 64)
    assert found.points[:, 1].max() == pytest.approx(2, rel=1e-9)
    holed = boundary(rsym.disc(2) - rsym.disc(0.001, (0.5, 0.3)), ((-3, 3),) * 2, 64)
    assert len(holed.lines) == 2
    assert holed.area() == pytest.approx(math.pi * (4 - 1e-6), rel=1e-7)
