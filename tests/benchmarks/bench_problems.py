"""Boundary value problems at equal error: rsym against scikit-fem, each as a user who knows it would set it up.

scikit-fem has elements of degree 4, curved to the second degree where boundaries are, and meshes graded by hand; the
degree and cells of rsym are those that just reach the error.
"""

import math

import numpy as np
import pytest
import scipy.sparse.linalg as sla
import skfem as fem
import sympy as sp
from skfem.models.poisson import laplace, mass, unit_load

import rsym
from rsym import x, y

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of scikit-fem

DISC = 5.783185962946784521  # the square of the first zero of J0
SQUARE = 0.14057701495515551  # Saint-Venant's series
ELL = 9.6397238440219410527  # Trefethen and Betcke (2006), Reentrant corners of membranes
CUT = rsym.Shape(rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(-x, y)), (x, y))


def told(exact, most):
    """How far values may be from the exact one, as a share; what it is."""

    def error(value):
        found = abs(value / exact - 1)
        assert found <= most, found
        return f"{found:.1e}"

    return error


def graded(mesh, levels, *corners):
    """Triangles next to corners divided again and again."""
    for _ in range(levels):
        centres = mesh.p[:, mesh.t].mean(axis=1)
        distance = np.min([np.hypot(*(centres - np.array(corner)[:, None])) for corner in corners], axis=0)
        mesh = mesh.refined(np.flatnonzero(distance < 1.5 * distance.min()))
    return mesh


def least_eigenvalue(mesh, element, shift):
    basis = fem.Basis(mesh, element)
    stiffness, masses, *_ = fem.condense(laplace.assemble(basis), mass.assemble(basis), D=basis.get_dofs())
    return sla.eigsh(stiffness.tocsc(), 1, masses.tocsc(), sigma=shift, return_eigenvectors=False)[0]


def rigidity(mesh, element):
    basis = fem.Basis(mesh, element)
    load = unit_load.assemble(basis)
    return 4 * load @ fem.solve(*fem.condense(laplace.assemble(basis), load, D=basis.get_dofs()))


def test_the_drum_of_a_disc(benchmark, contest):
    """First eigenvalue of a disc, 1e-9"""
    shape = rsym.disc(1)
    contenders = {
        "rsym, degree 5, 6 cells": lambda: rsym.modes(shape, 1, degree=5, cells=6).values[0],
        "scikit-fem, P2 isoparametric, 33 025": lambda: least_eigenvalue(
            fem.MeshTri2.init_circle(6), fem.ElementTriP2(), 5.5
        ),
        "scikit-fem, P3, curved to degree 2, 18 625": lambda: least_eigenvalue(
            fem.MeshTri2.init_circle(5), fem.ElementTriP3(), 5.5
        ),
    }
    contest.run(benchmark, contenders, told(DISC, 2e-8))
    assert abs(contenders["rsym, degree 5, 6 cells"]() / DISC - 1) < 1e-9


def test_the_torsion_of_a_square(benchmark, contest):
    """Torsion of a square, 1e-8"""
    shape = rsym.rectangle(1, 1)
    corners = [(0, 0), (0, 1), (1, 0), (1, 1)]
    contenders = {
        "rsym, degree 4, 10 cells": lambda: float(rsym.torsion(shape, cells=10)),
        "scikit-fem, P4, uniform, 16 641": lambda: rigidity(fem.MeshTri().refined(5), fem.ElementTriP4()),
        "scikit-fem, P4, graded by hand, 2 081": lambda: rigidity(
            graded(fem.MeshTri.init_symmetric().refined(1), 5, *corners), fem.ElementTriP4()
        ),
    }
    contest.run(benchmark, contenders, told(SQUARE, 1e-8))


def test_the_drum_of_three_squares(benchmark, contest):
    """First eigenvalue of the L, 1e-8"""
    contenders = {
        "rsym, degree 4, 20 cells": lambda: rsym.modes(CUT, 1, cells=20).values[0],
        "scikit-fem, P4, graded by hand, 7 289": lambda: least_eigenvalue(
            graded(fem.MeshTri.init_lshaped().refined(3), 14, (0, 0)), fem.ElementTriP4(), 9.0
        ),
    }
    contest.run(benchmark, contenders, told(ELL, 1e-8))


def test_the_drum_of_three_squares_to_ten_digits(benchmark, contest):
    """First eigenvalue of the L, 1e-10"""
    contenders = {
        "rsym, degree 5, 28 cells": lambda: rsym.modes(CUT, 1, degree=5, cells=28).values[0],
    }
    contest.run(benchmark, contenders, told(ELL, 1e-10), rounds=3)


RADIUS, FILM = sp.Rational(2, 5), sp.Rational(5, 2)
EXACT = y * (x**2 + y**2 - RADIUS**2) * sp.exp(x) * sp.cos(y)
LOAD = -sp.diff(EXACT, x, 2) - sp.diff(EXACT, y, 2)
FLUX = x * sp.diff(EXACT, x) + y * sp.diff(EXACT, y) + FILM * EXACT


def half_ring():
    """0 on cut and bore, Robin's condition on the rim."""
    shape = (rsym.disc(1).named("rim") & rsym.half_plane((0, 1), 0).named("cut")) - rsym.disc(0.4).named("bore")
    unknown = sp.Function("u")(x, y)
    equation = sp.Eq(-sp.diff(unknown, x, 2) - sp.diff(unknown, y, 2), LOAD)
    conditions = {"rim": rsym.robin(FILM, FLUX), "cut": 0, "bore": 0}
    return lambda: rsym.solve(shape, equation, conditions, degree=5, cells=12)


def half_ring_by_elements(radial, around):
    """Triangles of a grid of polar coordinates, their edges curved to degree 2."""
    load, flux, film = *(sp.lambdify((x, y), one) for one in (LOAD, FLUX)), float(FILM)
    forms = [
        fem.BilinearForm(lambda u, v, w: film * u * v),
        fem.LinearForm(lambda v, w: load(*w.x) * v),
        fem.LinearForm(lambda v, w: flux(*w.x) * v),
    ]

    def solved():
        polar = fem.MeshTri2.from_mesh(
            fem.MeshTri.init_tensor(np.linspace(float(RADIUS), 1, radial + 1), np.linspace(0, math.pi, around + 1))
        )
        r, angle = polar.doflocs
        mesh = fem.MeshTri2(np.array([r * np.cos(angle), r * np.sin(angle)]), polar.t)
        rim = mesh.facets_satisfying(
            lambda places: (np.hypot(*places) > 0.97) & (places[1] > 1e-9), boundaries_only=True
        )
        basis, on_rim = (
            fem.Basis(mesh, fem.ElementTriP4()),
            fem.FacetBasis(mesh, fem.ElementTriP4(), facets=rim),
        )
        matrix = laplace.assemble(basis) + forms[0].assemble(on_rim)
        right = forms[1].assemble(basis) + forms[2].assemble(on_rim)
        held = basis.get_dofs(np.setdiff1d(mesh.boundary_facets(), rim))
        return basis, fem.solve(*fem.condense(matrix, right, D=held))

    return solved


def test_mixed_conditions_on_half_a_ring(benchmark, contest):
    """Half ring, mixed conditions, 1e-8"""
    exact = sp.lambdify((x, y), EXACT)

    def error(found):
        if isinstance(found, rsym.Solution):
            points, weights = found.rule.points, found.rule.weights
            values = found.jets(points, 0)[0]
        else:
            basis, coefficients = found
            points = basis.global_coordinates().value.reshape(2, -1).T
            weights, values = basis.dx.ravel(), np.asarray(basis.interpolate(coefficients)).ravel()
        truth = exact(*points.T)
        share = math.sqrt(weights @ (values - truth) ** 2 / (weights @ truth**2))
        assert share < 1e-8
        return f"{share:.1e} in the root of the mean square"

    contenders = {
        "rsym, degree 5, 12 cells": half_ring(),
        "scikit-fem, P4, curved to degree 2, 16 705": half_ring_by_elements(16, 64),
    }
    contest.run(benchmark, contenders, error)
