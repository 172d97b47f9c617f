"""Meshes: rsym against a dense grid by lambdify and marching cubes of scikit-image, the volume beside the time."""

import numpy as np
import pytest
import sympy as sp
from rivals import expanded, lambdified
from skimage.measure import marching_cubes

import rsym
from rsym import conjunction, x, y, z
from rsym.sampling.lattice import lattice_over
from rsym.sampling.manifolds import measure

CUBE = ((-1.3, 1.3),) * 3
CELLS = 160
CYLINDERS = [(1 - u**2 - v**2) / 2 for u, v in ((x, y), (x, z), (y, z))]
# The cylinders' common parts: Archimedes knew the first.
BODIES = {
    "ball": ((1 - x**2 - y**2 - z**2) / 2, 4 * sp.pi / 3),
    "part common to two cylinders": (conjunction(*CYLINDERS[:2]), sp.Rational(16, 3)),
    "part common to three": (conjunction(*CYLINDERS), 8 * (2 - sp.sqrt(2))),
}


def race(benchmark, contest, shape, volume):
    plain = lambdified(shape, expanded(shape))
    lattice = lattice_over(shape.bounds, CELLS)

    def ours():
        return rsym.mesh(shape, CELLS).status.volume

    def dense():
        axes = lattice.open_axes()
        spacing = tuple(float(np.diff(axis.ravel()[:2])[0]) for axis in axes)
        vertices, faces, _, _ = marching_cubes(plain(*axes), 0.0, spacing=spacing, gradient_direction="ascent")
        return measure(vertices, faces).volume

    contest.points = int(np.prod(lattice.counts))
    contenders = {"rsym.mesh, vertices on the surface": ours, "lambdify and marching_cubes": dense}
    contest.run(benchmark, contenders, lambda got: f"volume {100 * (got / float(volume) - 1):+.4f} %", rounds=3)


@pytest.mark.parametrize("name", BODIES)
def test_a_body_of_known_volume(benchmark, contest, name):
    expression, volume = BODIES[name]
    contest.title = f"Mesh of the {name}"
    race(benchmark, contest, rsym.Shape(expression, (x, y, z), bounds=CUBE), volume)


@pytest.mark.filterwarnings("ignore::rsym.RsymWarning")  # thin walls, in either mesh
def test_the_car(benchmark, contest):
    """Mesh of the car, volume against twice the cells"""
    car = rsym.paper.car()
    race(benchmark, contest, car, rsym.mesh(car, 2 * CELLS).status.volume)
