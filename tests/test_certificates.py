"""Certificates of cells: what is simple surely is, and nothing thin is passed over."""

import numpy as np
import pytest
import sympy as sp
from closeness import assert_close
from leaf_kernels import LeafKernels

import rsym
from rsym import x, y, z
from rsym.codegen.sign_form import cap_letters, surface_form
from rsym.sampling.sharp.certificates import Form, certify
from rsym.sampling.sharp.gates import gate_table
from rsym.sampling.sharp.suspects import suspects

SHIFT = np.array((0.381966, 0.414214, 0.442777))


def certified(shape, resolution, *, depth=3):
    """The form of a shape with caps, the lattice, and what is unresolved; every block is handed over."""
    lower, upper = np.array(shape.bounds, float).T
    spacing = (upper - lower).max() / resolution * np.ones(3)
    lattice = np.concatenate([lower - SHIFT * spacing, spacing])
    form = surface_form(shape).capped()
    letters = {name: letter.default for name, letter in shape.letters.items()}
    for name, low, high in zip("xyz", lower, upper, strict=True):
        letters.update(zip(cap_letters(name), (low, high), strict=True))
    kernels = LeafKernels(form, letters)
    counts = np.ceil((upper - lower) / spacing / 8 + 0.1).astype(int)
    corner = 8 * np.indices(counts).reshape(3, -1)
    table = Form(kernels, len(form.leaves), gate_table(form))
    return table, lattice, certify(table, lattice, corner, depth=depth)


def solid(expression, size=1.2):
    return rsym.Shape(expression, (x, y, z), bounds=((-size, size),) * 3)


def turned(expression):
    """Under a rotation that no lattice plane is used to."""
    rotation = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]
    return expression.subs(dict(zip((x, y, z), rotation @ np.array([x, y, z]), strict=True)), simultaneous=True)


BALL = 1 - x**2 - y**2 - z**2
TORUS = sp.Rational(1, 10) - z**2 - (sp.sqrt(x**2 + y**2) - sp.Rational(7, 10)) ** 2
HALF = sp.Rational(6, 10)
CUBE = rsym.conjunction(HALF - x, HALF + x, HALF - y, HALF + y, HALF - z, HALF + z)


@pytest.mark.parametrize("expression", [BALL, TORUS, CUBE, turned(CUBE)])
def test_smooth_bodies_and_cubes_are_simple_everywhere(expression):
    _, _, found = certified(solid(expression), 24)
    assert len(found) == 0
    assert found.tested[0] > 0


@pytest.mark.parametrize("resolution", [16, 32])
@pytest.mark.parametrize("thickness", [0.01, 0.001])
@pytest.mark.parametrize("single", [False, True])
def test_a_thin_shell_is_a_wall_of_its_thickness(resolution, thickness, single):
    t = sp.Rational(str(thickness))
    inner = x**2 + y**2 + z**2 - (1 - t) ** 2
    expression = (t / 2) ** 2 - (sp.sqrt(x**2 + y**2 + z**2) - 1) ** 2 if single else rsym.conjunction(BALL, inner)
    table, lattice, found = certified(solid(expression), resolution)
    (wall,) = suspects(table.leaves, lattice, found)
    assert wall.kind == "wall"
    assert_close(wall.thickness * lattice[3], thickness, rtol=1e-3)
