"""One equation through every layer."""

import numpy as np
import trimesh
from oracles.closeness import assert_close

import rsym

MODEL = """
letter R = 2 in [1, 4] "to the middle of the tube"
letter r = 0.5 in [0.1, 0.9] "of the tube"
coordinates x y
bounds x [-0.7, 0.7] y [-3, 3]
omega = (r^2 - x^2 - (y - R)^2)/(2*r)
"""


def test_from_text_to_a_solid_on_disk(tmp_path):
    profile = rsym.loads(MODEL)
    assert rsym.gradient(profile).shape == (2, 1)
    (circle,) = rsym.level_lines(profile, resolution=200)
    assert_close(np.hypot(circle[:, 0], circle[:, 1] - 2), np.full(len(circle), 0.5), atol=1e-12)
    assert rsym.compile(rsym.normalise(profile))(0.0, 2.5)["value"] == 0
    ring = rsym.revolve(profile)
    mesh = rsym.mesh(ring, 120, letters={"r": 0.4})
    assert mesh.status.closed
    assert mesh.status.euler_characteristic == 0
    assert_close(mesh.status.volume, 2 * np.pi**2 * 2 * 0.4**2, rtol=5e-3)
    path = tmp_path / "ring.stl"
    rsym.write(mesh, path)
    body = trimesh.load_mesh(path)
    assert body.is_watertight
    assert_close(body.volume, mesh.status.volume, rtol=1e-5)
    tube = rsym.compile(ring, ("normalised_gradient_squared",))(*rsym.mesh(ring, 60).vertices.T)
    assert_close(tube["normalised_gradient_squared"], np.ones(len(tube["normalised_gradient_squared"])), atol=1e-9)
