"""Edges in space where two expressions meet: errors are what they are said to be."""

import numpy as np
import pytest
import sympy as sp

import rsym
from rsym import x, y, z


def solid(formula):
    return rsym.Shape(formula, (x, y, z))


def block(**sides):
    """The faces of a box, or of an L with e or f in place of the last two."""
    return {name: solid(formula).named(name) for name, formula in sides.items()}


ROUND = x**2 + y**2 - 2 * z**2
BOX = block(a=x, b=1 - x, c=y, d=1 - y, e=z, f=1 - z)
ELL = block(a=x, b=y, c=2 - x, d=2 - y, e=1 - x, f=1 - y, g=z, h=1 - z)
WAVE, SADDLE = sp.exp(x) * sp.sin(y) + x * z, x**2 - y**2 + x * z
AT = {"a": (x, 0), "b": (y, 0), "c": (x, 2), "d": (y, 2), "e": (x, 1), "f": (y, 1), "g": (z, 0), "h": (z, 1)}
FACES = {"a": (x, 0), "b": (x, 1), "c": (y, 0), "d": (y, 1), "e": (z, 0), "f": (z, 1)}
CASES = {
    "box": (
        BOX["a"] & BOX["b"] & BOX["c"] & BOX["d"] & BOX["e"] & BOX["f"],
        {name: WAVE.subs(*place) for name, place in FACES.items()},
        WAVE,
        1e-5,
    ),
    "L": (
        ELL["a"] & ELL["b"] & ELL["c"] & ELL["d"] & (ELL["e"] | ELL["f"]) & ELL["g"] & ELL["h"],
        {name: SADDLE.subs(*place) for name, place in AT.items()},
        SADDLE,
        1e-6,
    ),
    "cylinder": (
        solid(1 - x**2 - y**2).named("side") & solid(z) & solid(1 - z),
        {"side": 1 - 2 * y**2, ...: x**2 - y**2},
        x**2 - y**2,
        1e-3,
    ),
    "cap": (
        solid(1 - x**2 - y**2 - z**2).named("ball") & solid(z - sp.Rational(1, 4)).named("cut"),
        {"ball": 1 - 3 * z**2, "cut": x**2 + y**2 - sp.Rational(1, 8)},
        ROUND,
        1e-3,
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_errors_at_edges_are_what_they_are_said_to_be(name):
    shape, given, truth, most = CASES[name]
    u = rsym.solve(shape, "-laplacian(u) = 0", given, cells=4 if name == "box" else 6)
    points, exact = u.rule.points.T, sp.lambdify((x, y, z), truth)(*u.rule.points.T)
    error = np.sqrt(np.average((u(*points) - exact) ** 2, weights=u.rule.weights)) / np.abs(exact).max()
    assert error <= 2 * u.report.estimate < most
