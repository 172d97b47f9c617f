"""Screw symmetry and the coil spring, against turned sections, exact gradients and volumes."""

import numpy as np
import pytest
import sympy as sp
from oracles.closeness import assert_close

import rsym
from rsym import RsymError, Shape, conjunction, x, y, z
from rsym.model.symmetry.screws import coil, screw, wound

a, b, c = sp.symbols("a b c", real=True)
SECTION = Shape((1 - x**2 / 4 - 2 * y**2) / 2 + x / 9, (x, y), bounds=((-3, 3), (-1, 1)))


def points(count=4000, reach=6.0):
    return np.random.default_rng(2).uniform(-reach, reach, (3, count))


def volume(mesh):
    corners = mesh.vertices[mesh.faces]
    return np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6


@pytest.mark.parametrize("pitch", [8.0, -3.0])
def test_a_twisted_bar_is_its_section_turned(pitch):
    bar = screw(SECTION, a, letters={a: 1})
    u, v, w = points()
    p, q = np.array([1, 1j]) @ [u, v] * np.exp(-2j * np.pi * w / pitch), 0
    p, q = p.real, p.imag
    got = rsym.compile(bar)(u, v, w, letters={"a": pitch})["value"]
    assert_close(got, rsym.compile(SECTION)(p, q)["value"], atol=1e-12)
    assert bar.bounds is None


def test_a_twisted_bar_with_several_starts():
    bar = screw(Shape(SECTION.expression.subs(x, x - 2), (x, y)), 6, starts=3)
    u, v, w = points()
    for turn, climb in [(2 * np.pi / 3, 0), (np.pi / 3, 1)]:
        moved = (u + 1j * v) * np.exp(1j * turn)
        again = rsym.compile(bar)(moved.real, moved.imag, w + climb)["value"]
        assert_close(again, rsym.compile(bar)(u, v, w)["value"], atol=1e-11)


def test_a_shape_in_space_is_twisted_about_any_axis():
    block = Shape(1 - x**2 - 2 * y**2 - z / 3 + x * z, (x, y, z), bounds=((-3, 3), (-1, 1), (-4, 4)))
    twisted = screw(block, 5, axis=x)
    u, v, w = points()
    turned = (v + 1j * w) * np.exp(-2j * np.pi * u / 5)
    expected = rsym.compile(block)(u, turned.real, turned.imag)["value"]
    assert_close(rsym.compile(twisted)(u, v, w)["value"], expected, atol=1e-11)
    reach = np.hypot(1, 4)
    assert twisted.bounds == ((-3, 3), (-reach, reach), (-reach, reach))


@pytest.mark.slow
def test_a_twisted_bar_meshes_closed():
    square = Shape(conjunction(1 - x**2, 1 - y**2), (x, y))
    bar = Shape(conjunction(screw(square, 6).expression, (9 - z**2) / 6), (x, y, z), bounds=((-2, 2), (-2, 2), (-4, 4)))
    mesh = rsym.mesh(bar, 64)
    assert "closed" in str(mesh.status)
    assert_close(volume(mesh), 4 * 6, rtol=2e-3)


@pytest.mark.parametrize("kind", ["even", "any"])
def test_what_is_wound_is_its_section_across_the_turns(kind):
    section = SECTION if kind == "even" else SECTION.replace(expression=SECTION.expression + y / 5)
    thread = wound(section, 4, a, motif=kind, letters={a: 3})
    u, v, w = points()
    climb = w - 3 * np.arctan2(v, u) / (2 * np.pi)
    height = (climb - 3 * np.round(climb / 3)) / np.sqrt(1 + (3 / (8 * np.pi)) ** 2)
    expected = rsym.compile(section)(np.hypot(u, v) - 4, height)["value"]
    assert_close(rsym.compile(thread)(u, v, w)["value"], expected, atol=1e-12)


def on_the_coil(radius, wire, pitch, count=2000):
    angle, around = np.random.default_rng(3).uniform(-np.pi, np.pi, (2, count))
    slope = np.hypot(1, pitch / (2 * np.pi * radius))
    out = radius + wire * np.cos(around)
    return out * np.cos(angle), out * np.sin(angle), wire * np.sin(around) * slope + pitch * angle / (2 * np.pi)


@pytest.mark.parametrize("sizes", [(4.0, 1.0, 3.0), (2.0, 1.7, 40.0), (3.0, 0.2, 0.5), (1.0, 0.9, 9.0)])
def test_a_coil_is_normalised_to_order_1_on_all_of_its_surface(sizes):
    spring = coil(a, b, c, letters={a: 4, b: 1, c: 3})
    place = on_the_coil(*sizes)
    kernel = rsym.compile(spring, ("value", "gradient"))
    got = kernel(*place, letters=dict(zip("abc", sizes, strict=True)))
    assert_close(got["value"], np.zeros(2000), atol=1e-13)
    assert_close(np.linalg.norm(got["gradient"], axis=1), np.ones(2000), atol=1e-11)
    # Nowhere else is it zero: its sign is that of f.
    u, v, w = points()
    climb = w - sizes[2] * np.arctan2(v, u) / (2 * np.pi)
    height = (climb - sizes[2] * np.round(climb / sizes[2])) / np.hypot(1, sizes[2] / (2 * np.pi * sizes[0]))
    inside = sizes[1] ** 2 > (np.hypot(u, v) - sizes[0]) ** 2 + height**2
    assert (kernel(u, v, w, letters=dict(zip("abc", sizes, strict=True)))["value"] > 0).tolist() == inside.tolist()


def test_a_coil_has_no_false_zero_on_its_axis():
    near = np.array([0.0, 1e-12, 1e-3])
    got = rsym.compile(coil(4, 1, 3))(near, 0.0, 1.0)["value"]
    assert (got < -1).all()


def test_a_coil_ends_flat_and_normalised():
    spring = coil(4, 1, 3, turns=a, letters={a: 2})
    kernel = rsym.compile(spring, ("value", "gradient"))
    out, up = np.random.default_rng(4).uniform(-0.5, 0.5, (2, 100))
    for angle, climb in [(-2 * np.pi, -3.0), (2 * np.pi, 3.0)]:
        end = kernel((4 + out) * np.cos(angle), (4 + out) * np.sin(angle), climb + up)
        assert_close(end["value"], np.zeros(100), atol=1e-12)
        assert_close(end["gradient"], np.tile([0, -np.sign(climb), 0], (100, 1)), atol=1e-11)
    assert kernel(4.0, 0.1, 3.0)["value"] < 0 < kernel(4.0, -0.1, 3.0)["value"]


@pytest.mark.slow
def test_a_spring_meshes_closed_and_holds_what_pappus_says():
    spring = coil(4, 1, 3, turns=sp.Rational(7, 2))
    mesh = rsym.mesh(spring, 96)
    assert "one piece, closed" in str(mesh.status)
    slope = np.hypot(1, 3 / (8 * np.pi))
    assert_close(volume(mesh), 3.5 * 2 * np.pi * 4 * np.pi * slope, rtol=4e-3)


@pytest.mark.parametrize(
    ("call", "code"),
    [
        (lambda: screw(SECTION, 0), "pitch"),
        (lambda: screw(SECTION, 1, axis=z), "axis"),
        (lambda: screw(SECTION, 1, starts=0), "integer"),
        (lambda: screw(SECTION, a), "unknown-letter"),
        (lambda: screw(Shape(x + y, (x, y)), 1, starts=2), "not-even"),
        (lambda: screw(Shape(x + y + a, (x, y), letters={a: 1}), a, letters={a: 2}), "letter-conflict"),
        (lambda: wound(Shape(x + y + z, (x, y, z)), 1, 1), "coordinates"),
        (lambda: wound(Shape(x + y, (x, y)), 1, 1), "not-even"),
        (lambda: wound(SECTION, 0, 1), "positive"),
        (lambda: coil(1, 1, 9), "coil"),
        (lambda: coil(4, 1, 2), "coil"),
        (lambda: coil(4, -1, 2), "positive"),
        (lambda: coil(4, 1, 3, turns=0), "positive"),
    ],
)
def test_what_is_refused(call, code):
    with pytest.raises(RsymError) as caught:
        call()
    assert caught.value.code == code
