"""Singular functions at corners: powers and logarithms in the coordinates of two leaves.

f and g are the leaves of a corner, (p, q) the linear map of (f, g) that is a rotation of the plane in the limit. Both
edges are rays there, however curved they are, so with z = p + iq = r exp(i theta)

    (1 - r**2/R**2)**m * r**(2j) * Im z**(k pi/angle),    0 < theta < angle,

is exactly 0 on both. Where nothing flows through an edge, it is Re z**..., or half a step between. At right corners
z**2 is smooth, and what a load needs is -q**2/2 - Im(z**2 log z)/pi, of which minus the Laplacian is 1.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.problems.corners.places import LeafCorner
from rsym.problems.splines.cardinals import derivatives

POWER = 7  # m
SHARE = {True: 0.95, False: 0.45}  # of the distance of other leaves: re-entrant or not
POWERS = (0, 1, 2)  # j
LARGEST = 5.0  # of the exponents pi k/angle
WHOLE = 1e-6
MOST = 400  # functions, each of which meets all others


@dataclass(frozen=True)
class SingularFunctions:
    """The functions of one corner: terms are ("sin" | "cos" | "log", exponent, j)."""

    corner: LeafCorner
    terms: tuple[tuple[str, float, int], ...]
    radius: float

    def __call__(self, points: Floats, leaves: Floats) -> Floats:
        """Derivatives (kinds, functions, n) at points (n, 2), given those (2, kinds, n) of the two leaves."""
        order = {1: 0, 3: 1, 6: 2}[leaves.shape[1]]
        found = np.zeros((leaves.shape[1], len(self.terms), len(points)))
        # The leaves may meet elsewhere too.
        away = np.linalg.norm(points - np.array(self.corner.point), axis=1)
        near = np.flatnonzero(away < 2 * self.radius)
        if not len(near):
            return found
        p, q = np.einsum("ab,bkn->akn", np.array(self.corner.turned), leaves[:, :, near])
        near_too = p[0] ** 2 + q[0] ** 2 < self.radius**2
        near, p, q = near[near_too], p[:, near_too], q[:, near_too]
        plane = self._plane(p[0], q[0], order)
        for number, values in enumerate(plane):
            found[:, number, near] = _chained(order, values, p, q)
        return found

    def _plane(self, p: Floats, q: Floats, order: int) -> Iterator[list[Floats]]:
        """Of each term the derivatives by p and q up to an order: value, p, q, pp, pq, qq."""
        t = np.maximum(p * p + q * q, 1e-300)
        angle = self.corner.angle
        theta = np.arctan2(q, p) % (2 * math.pi)
        theta = np.where(theta > math.pi + angle / 2, theta - 2 * math.pi, theta)
        log = np.log(t) / 2 + 1j * theta
        z = np.where(t > 1e-300, p + 1j * q, 1e-150)
        rho = [_radial(p, q, t, self.radius, j, order) for j in range(max(POWERS) + 1)]
        made: dict[tuple[str, float], list[Floats]] = {}
        for kind, exponent, j in self.terms:
            if (kind, exponent) not in made:
                made[kind, exponent] = _angular(kind, exponent, p, q, z, log, order)
            s, r = made[kind, exponent], rho[j]
            found = [s[0] * r[0]]
            if order >= 1:
                found += [s[1] * r[0] + s[0] * r[1], s[2] * r[0] + s[0] * r[2]]
            if order == 2:
                found += [
                    s[3] * r[0] + 2 * s[1] * r[1] + s[0] * r[3],
                    s[4] * r[0] + s[1] * r[2] + s[2] * r[1] + s[0] * r[4],
                    s[5] * r[0] + 2 * s[2] * r[2] + s[0] * r[5],
                ]
            yield found


def _angular(kind: str, exponent: float, p: Floats, q: Floats, z: Any, log: Any, order: int) -> list[Floats]:
    """The derivatives of Im z**e, of Re z**e, or of that with a logarithm: harmonic, but for -q**2/2 in the last."""
    if kind == "log":
        first: list[Any] = [-z * z * log / math.pi, -(2 * z * log + z) / math.pi, -(2 * log + 3) / math.pi]
    else:
        power = np.exp(exponent * log) * (1j if kind == "cos" else 1)
        slope = exponent * power / z
        first = [power, slope, (exponent - 1) * slope / z if order == 2 else slope]
    value, d, dd = first
    found = [value.imag, d.imag, d.real, dd.imag, dd.real, -dd.imag]
    if kind == "log":
        found[0], found[2], found[5] = found[0] - q * q / 2, found[2] - q, found[5] - 1
    return found


def _radial(p: Floats, q: Floats, t: Floats, radius: float, j: int, order: int) -> list[Floats]:
    """The derivatives of (1 - t/R**2)**m * t**j, t = p**2 + q**2."""
    u, e = 1 - t / radius**2, -1 / radius**2
    c = [u**POWER, POWER * e * u ** (POWER - 1), POWER * (POWER - 1) * e**2 * u ** (POWER - 2)]
    w = [t**j, j * t ** max(j - 1, 0), j * (j - 1) * t ** max(j - 2, 0)]
    rho = [c[0] * w[0], c[1] * w[0] + c[0] * w[1], c[2] * w[0] + 2 * c[1] * w[1] + c[0] * w[2]]
    found = [rho[0], 2 * p * rho[1], 2 * q * rho[1]]
    if order == 2:
        found += [2 * rho[1] + 4 * p * p * rho[2], 4 * p * q * rho[2], 2 * rho[1] + 4 * q * q * rho[2]]
    return found


def _chained(order: int, s: list[Floats], p: Floats, q: Floats) -> Floats:
    """Derivatives by x and y of a function of p and q."""
    found = np.empty_like(p)
    found[0] = s[0]
    if order >= 1:
        for k in (1, 2):
            found[k] = s[1] * p[k] + s[2] * q[k]
    if order == 2:
        for k, index in enumerate(derivatives(2, 2)[3:], 3):
            i, j = (1 + axis for axis, times in enumerate(index) for _ in range(times))
            found[k] = s[1] * p[k] + s[2] * q[k]
            found[k] += s[3] * p[i] * p[j] + s[4] * (p[i] * q[j] + p[j] * q[i]) + s[5] * q[i] * q[j]
    return found


def singular_functions(
    corners: Sequence[LeafCorner], valued: Collection[int], loaded: Sequence[bool]
) -> tuple[SingularFunctions, ...]:
    """What solutions of equations of the second order have at corners, given which leaves have values.

    loaded : whether there is a load at each corner: without one, right corners have nothing.

    Examples
    --------
    >>> import rsym
    >>> from rsym.problems.corners.places import corners_of
    >>> ell = rsym.rectangle(2, 2) - rsym.rectangle(1, 1).translate(0.5, 0.5)
    >>> corners = corners_of(ell)
    >>> [round(one.terms[0][1], 4) for one in singular_functions(corners, range(9), [True] * 6)]
    [2.0, 2.0, 2.0, 0.6667, 2.0, 2.0]
    >>> [round(one.terms[0][1], 4) for one in singular_functions(corners, range(9), [False] * 6)]
    [0.6667]
    """
    found = []
    for corner, load in zip(corners, loaded, strict=True):
        first, second = (leaf in valued for leaf in corner.leaves)
        shift = 0.0 if first == second else 0.5
        kind = "sin" if first else "cos"
        step = math.pi / corner.angle
        every = [(k - shift) * step for k in range(1, 2 + int(LARGEST / step))]
        # Smooth ones are splines times the weight, unless that has a root in it, as at re-entrant corners.
        sharp = corner.angle > math.pi + WHOLE
        exponents = [e for e in every if e < LARGEST and (sharp or abs(e - round(e)) > WHOLE)]
        terms = [(kind, e, j) for e in exponents for j in POWERS]
        if abs(step - 2) < WHOLE and first and second and load:
            terms = [("log", 2.0, j) for j in POWERS]
        radius = SHARE[sharp] * corner.distance
        if terms and radius > 0:
            found.append(SingularFunctions(corner, tuple(terms), radius))
    # Of many corners the sharpest matter.
    found.sort(key=lambda one: -one.corner.angle)
    kept, total = [], 0
    for one in found:
        total += len(one.terms)
        if total <= MOST:
            kept.append(one)
    return tuple(sorted(kept, key=lambda one: one.corner.point))
