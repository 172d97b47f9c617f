"""The largest turn of the normal at a tip: numbers, from the limits of the gradient along generators.

The boundary at a tip is a graph over the plane across `upward` v. In each half plane that v bounds there is one
direction d = cos(t) v + sin(t) e in which H vanishes; the limit of the gradient along it is the normal there.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize

from rsym.bounds.balls import arb, ctx
from rsym.verify.bodies.rays import Rays

AROUND = 48  # generators: opposite ones are among them
BITS = 64
OFF = 1e-9  # degrees: the search ends at steps of 1e-9 radians, where the angle hardly changes any more


def largest_turn(rays: Rays) -> tuple[float, float]:
    """The largest angle between two normals in degrees, and an estimate of its error; NaN where there is none.

    Examples
    --------
    >>> import sympy as sp
    >>> import rsym
    >>> from fractions import Fraction
    >>> from rsym import x, y, z
    >>> from rsym.verify.bodies.rays import exact_at, rays_at
    >>> from rsym.verify.local import Model
    >>> model = Model(rsym.Shape(z - sp.sqrt(x**2 + y**2), (x, y, z)), {})
    >>> origin = [arb(0)] * 3
    >>> known = exact_at(model, origin, dict.fromkeys("xyz", Fraction(0)), frozenset())
    >>> round(largest_turn(rays_at(model, known))[0], 9)
    90.0
    """
    if rays.upward is None:
        return math.nan, math.nan
    with ctx.workprec(BITS):
        return _largest(_normals(rays, np.array(rays.upward)))


def _largest(normal: Callable[[float], NDArray[np.float64] | None]) -> tuple[float, float]:
    angles = np.arange(AROUND) * (2 * math.pi / AROUND)
    found = [normal(angle) for angle in angles]
    known = [(angle, own) for angle, own in zip(angles, found, strict=True) if own is not None]
    if len(known) < 3:
        return math.nan, math.nan
    normals = np.array([own for _, own in known])
    turns = np.linalg.norm(normals[:, None] - normals[None], axis=2)
    i, j = np.unravel_index(int(turns.argmax()), turns.shape)

    def shortfall(pair: NDArray[np.float64]) -> float:
        a, b = (normal(float(angle)) for angle in pair)
        return 0.0 if a is None or b is None else -float(np.linalg.norm(a - b))

    start = np.array([known[i][0], known[j][0]])
    step = 2 * math.pi / AROUND
    simplex = start + np.array([[0, 0], [step, 0], [0, step]])
    better = minimize(shortfall, start, method="Nelder-Mead", options={"initial_simplex": simplex, "xatol": 1e-9})
    chord = max(float(turns[i, j]), -float(better.fun))
    return math.degrees(2 * math.asin(min(chord / 2, 1.0))), OFF


def _normals(rays: Rays, upward: NDArray[np.float64]) -> Callable[[float], NDArray[np.float64] | None]:
    """The unit normal by the angle of the half plane."""
    v = upward / np.linalg.norm(upward)
    first = np.cross(v, np.eye(3)[int(np.abs(v).argmin())])
    first /= np.linalg.norm(first)
    second = np.cross(v, first)

    def normal(angle: float) -> NDArray[np.float64] | None:
        outwards = math.cos(angle) * first + math.sin(angle) * second
        # H > 0 upwards, H < 0 downwards
        down = brentq(lambda t: _height(rays, _balls(t, v, outwards)), 0, math.pi, xtol=1e-15)
        gradient = rays.slopes.gradient(_balls(down, v, outwards))
        if gradient is None or not all(part.is_finite() for part in gradient):
            return None
        found = np.array([float(part.mid()) for part in gradient])
        unit: NDArray[np.float64] = found / np.linalg.norm(found)
        return unit

    return normal


def _balls(angle: float, v: NDArray[np.float64], outwards: NDArray[np.float64]) -> tuple[arb, ...]:
    return tuple(arb(float(part)) for part in math.cos(angle) * v + math.sin(angle) * outwards)


def _height(rays: Rays, direction: tuple[arb, ...]) -> float:
    value = rays.slopes.at(direction)[rays.slopes.number]
    return math.nan if value is None else float(value.mid())
