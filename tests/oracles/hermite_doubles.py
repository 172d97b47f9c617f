"""Patches for tests, of their own making: polynomials of corner data, and lambdified formulas."""

import numpy as np
import sympy as sp

from rsym.surfaces.patch import Patch
from rsym.surfaces.symbols import u, v

# Coefficients of 1, t, t^2, ... of F0, F1, G0, G1 and of F0, F1, G0, G1, H0, H1.
CUBIC = np.array([[1, 0, -3, 2], [0, 0, 3, -2], [0, 1, -2, 1], [0, 0, -1, 1]], float)
QUINTIC = np.array(
    [
        [1, 0, 0, -10, 15, -6],
        [0, 0, 0, 10, -15, 6],
        [0, 1, 0, -6, 8, -3],
        [0, 0, 0, -4, 7, -3],
        [0, 0, 0.5, -1.5, 1.5, -0.5],
        [0, 0, 0, 0.5, -1, 0.5],
    ]
)
UNIT = ((0.0, 1.0), (0.0, 1.0))


class Corners(Patch):
    """f(u)^T Q f(v) with cubic or quintic f, term by term."""

    domain = UNIT

    def __init__(self, matrix):
        self.matrix = np.asarray(matrix, float)
        self.functions = [np.polynomial.Polynomial(row) for row in (CUBIC if len(self.matrix) == 4 else QUINTIC)]

    def evaluate(self, u, v, orders, letters=None):
        result = []
        for i, j in orders:
            f = np.stack([one.deriv(i)(u) for one in self.functions], axis=-1)
            g = np.stack([one.deriv(j)(v) for one in self.functions], axis=-1)
            result.append(np.einsum("...a,abc,...b->...c", f, self.matrix, g))
        return result


class Lambdified(Patch):
    """Three expressions in u and v, differentiated by SymPy and lambdified."""

    def __init__(self, point, domain=UNIT, closed=(False, False)):
        self.point = [sp.sympify(one) for one in point]
        self.given, self.known = (domain, closed), {}

    domain = property(lambda self: self.given[0])
    closed = property(lambda self: self.given[1])

    def evaluate(self, u_values, v_values, orders, letters=None):
        zero = 0 * (u_values + v_values)
        for i, j in orders:
            if (i, j) not in self.known:
                self.known[i, j] = sp.lambdify((u, v), [sp.diff(sp.diff(one, u, i), v, j) for one in self.point])
        return [np.stack([zero + one for one in self.known[order](u_values, v_values)], axis=-1) for order in orders]


def sheet(seed, classes=2, bump=0.3):
    """Random corner data of a bent unit square."""
    matrix = bump * np.random.default_rng(seed).normal(size=(2 * classes, 2 * classes, 3))
    for i in (0, 1):
        matrix[i, 2:4, 1] += 1
        matrix[2:4, i, 0] += 1
        for j in (0, 1):
            matrix[i, j, :2] += (i, j)
    return matrix


def sphere(longitudes, latitudes, radius=1, shift=(0, 0, 0)):
    """A piece of a sphere; u runs over the longitudes and v over the latitudes, in either direction."""
    (a, b), (c, d) = longitudes, latitudes
    theta, phi = a + (b - a) * u, c + (d - c) * v
    unit = (sp.cos(theta) * sp.cos(phi), sp.sin(theta) * sp.cos(phi), sp.sin(phi))
    return Lambdified([radius * one + off for one, off in zip(unit, shift, strict=True)])
