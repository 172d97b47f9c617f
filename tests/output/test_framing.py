"""Frames of pictures: the whole body is within them, as its formula has it, however thin its parts are."""

from __future__ import annotations

import numpy as np
import pytest

import rsym
from rsym import x, y, z
from rsym.output.cameras import Camera
from rsym.output.framing import framed
from rsym.sampling.ray_march import ArrayRays
from rsym.sampling.rays import Caster

ANGLES = np.linspace(0, 2 * np.pi, 400)
RING = 3 * np.stack([np.cos(ANGLES), np.sin(ANGLES), 0 * ANGLES], axis=1)
CAMERAS = (Camera(), Camera(90, -90), Camera(10, 70), Camera(field_of_view=35))


def mast(radius=5e-3):
    return rsym.box(2, 2, 1) | rsym.cylinder(radius, 6)


def needle():
    """Of a length that is a thousandth of the bounds it stands in, thinner than any pixel of a coarse picture."""
    return rsym.Shape(1e-4 - 1e4 * (x - 5) ** 2 - 1e4 * y**2 - (z + 3) ** 2, (x, y, z), bounds=((-20, 20),) * 3)


BODIES = {
    "a ring round a ball": (lambda: rsym.torus(3, 0.02) | rsym.sphere(1), RING),
    "a mast on a box": (mast, np.array([[0, 0, 3.0], [0, 0, -3.0]])),
    "a needle alone": (needle, np.array([[5, 0, -3.01], [5, 0, -2.99]])),
}


@pytest.mark.parametrize("camera", CAMERAS, ids=["usual", "top", "flat", "eye"])
@pytest.mark.parametrize("name", BODIES)
def test_what_is_thinner_than_a_pixel_is_within_the_frame(name, camera):
    body, points = BODIES[name]
    view = framed(Caster(body()), camera, (320, 240))
    places = view.project(points)[0]
    assert (places > 0).all()
    assert (places < np.array(view.size) - 1).all()


def test_a_frame_is_no_larger_than_what_beams_leave_open():
    view = framed(Caster(needle()), Camera(0, 0), (320, 240))
    assert view.pixel * 240 < 0.2  # of a needle .02 long; its bounds are 40 wide


def test_zoom_is_how_much_larger_all_is_than_what_just_fits():
    caster = Caster(rsym.sphere(1))
    one, *others = (framed(caster, Camera(zoom=zoom), (160, 120)) for zoom in (1, 2, 4))
    assert [one.pixel / other.pixel for other in others] == [2, 4]
    assert all((one.middle == other.middle).all() for other in others)


def test_without_a_compiler_beams_leave_open_what_holds_the_body(monkeypatch):
    monkeypatch.setattr("rsym.sampling.rays.default_backend", lambda: "numpy")
    caster = Caster(mast(0.02))
    assert isinstance(caster._kernels, ArrayRays)
    for camera in (Camera(), Camera(field_of_view=35)):
        view = framed(caster, camera, (160, 120))
        places = view.project(np.array([[0, 0, 3.0], [0, 0, -3.0]]))[0]
        assert (places > 0).all()
        assert (places < np.array(view.size) - 1).all()
