"""What is thinner than a pixel is painted, wherever between rays it is; what cannot be known is told."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z
from rsym.output.cameras import Camera
from rsym.output.rendering import Scene
from rsym.sampling.pencils import Pencil
from rsym.sampling.rays import Caster

SIZE = (96, 72)
CAMERAS = {"front": Camera(0, 90), "slanted": Camera(25, 40), "eye": Camera(10, 70, field_of_view=40)}


def dark(image):
    """Where something is painted on white."""
    return (np.asarray(image)[..., :3] < 250).any(axis=2)


def places_along(image, first, last):
    """The pixels, columns and rows, that a line in space is seen in."""
    points = np.linspace(first, last, 400)
    return np.rint(image.view.project(points)[0]).astype(int)


@pytest.mark.parametrize("samples", [1, 16])
@pytest.mark.parametrize("camera", CAMERAS)
@pytest.mark.parametrize("thick", [0.8, 0.2, 0.02])
def test_a_needle_between_rays_is_painted_all_along(thick, camera, samples):
    pixel = 5 / SIZE[1]
    body = rsym.box(1, 1, 1) | rsym.box(thick * pixel, thick * pixel, 4, (0.013, 0.007, 2))
    image = rsym.render(body, camera=CAMERAS[camera], size=SIZE, samples=samples)
    painted = dark(image)
    for column, row in places_along(image, (0.013, 0.007, 0.6), (0.013, 0.007, 3.9)):
        assert painted[row - 1 : row + 2, column - 1 : column + 2].any()
    assert not image.undecided.any()


def test_a_fin_and_a_wire_before_a_wall_are_painted():
    wall = rsym.box(4, 0.2, 3)
    wire = rsym.box(4, 0.004, 0.004, (0, 1, 0.3)).named("wire")
    image = rsym.render(wall | wire, camera="front", size=SIZE, colour_by="part")
    assert "wire" in image.parts
    assert set(image.parts) != {"wire"}
    seen = places_along(image, (-1.8, 1, 0.3), (1.8, 1, 0.3))
    plain = np.asarray(image)[10, SIZE[0] // 2, :3].astype(int)
    for column, row in seen:
        near = np.asarray(image)[row - 1 : row + 2, column, :3].astype(int)
        assert (np.abs(near - plain).max(axis=1) > 20).any()


def test_the_arrays_of_an_image_are_those_of_the_rays_through_middles():
    needle = rsym.sphere(1) | rsym.box(0.004, 0.004, 3, (0.013, 0, 2))
    image = rsym.render(needle, camera="front", size=SIZE)
    there = np.isfinite(image.depth)
    assert (dark(image) & ~there)[5:30].any(axis=1).all()
    points = image.points[there]
    assert np.abs(np.linalg.norm(points, axis=1) - 1).max() < 1e-9


def test_what_was_seen_well_is_painted_as_it_was():
    body = rsym.box(2, 2, 1) - rsym.cylinder(0.5, 3)
    caster = Caster(body)
    view = CAMERAS["slanted"].frame(np.array([[1, 1, 1], [-1, -1, -1.0]]), SIZE)
    scene = Scene(caster, view, ())
    seen = scene.seen()
    shown, found = scene.shown(seen)
    assert shown is seen
    assert not len(found.pixels)
    assert not len(found.undecided)
    assert not found.blind


def test_what_beams_cannot_tell_is_told():
    ball = sp.expand((1 - x**2 - y**2 - z**2) ** 5)
    body = rsym.Shape(ball, (x, y, z), bounds=((-1.5, 1.5),) * 3)
    with pytest.warns(rsym.RsymWarning, match="undecided|thinner than a pixel"):
        rsym.render(body, size=(32, 24))
    twice = rsym.Shape((1 - x**2 - y**2 - z**2) * (x - 0.2) ** 2, (x, y, z), bounds=((-1.5, 1.5),) * 3)
    with pytest.warns(rsym.RsymWarning, match="undecided|thinner than a pixel"):
        rsym.render(twice, size=(32, 24))
    figure = plt.figure(figsize=(1, 1), dpi=50)
    rsym.plot_mesh(twice, ax=figure.add_subplot(projection="3d"))
    with pytest.warns(rsym.RsymWarning, match="undecided|thinner than a pixel"):
        figure.canvas.draw()
    plt.close(figure)


def test_beams_of_some_pixels_between_two_depths(monkeypatch):
    ball = rsym.Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z), bounds=((-3, 3),) * 3)
    pencil = Pencil((12, 8), (-3, 2, 9), (0.5, 0, 0), (0, -0.5, 0), direction=(0, 0, -1))
    caster = Caster(ball)
    every = caster.starts(pencil).reshape(-1)
    which = np.array([40, 41, 3, 95])
    assert (caster.starts(pencil, which=which) == every[which]).all()
    assert np.isinf(caster.starts(pencil, which=which, far=6.2)).all()  # the ball begins 7 from the plane of the eye
    behind = caster.starts(pencil, which=which[:1], near=6.2)
    assert 6.2 <= behind[0] <= 7.1
    with monkeypatch.context() as patched:
        patched.setattr("rsym.sampling.rays.default_backend", lambda: "numpy")
        slow = Caster(rsym.Shape((4 - x**2 - y**2 - z**2) / 4, (x, y, z), bounds=((-3.1, 3),) * 3))
        assert np.isinf(slow.starts(pencil, which=which, far=6.2)).all()
        assert 6.2 <= slow.starts(pencil, which=which[:1], near=6.2)[0] <= 7.1
        found = np.isfinite(slow.starts(pencil))
    assert (found == np.isfinite(every).reshape(8, 12)).all()
