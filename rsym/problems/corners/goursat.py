"""Elastic bodies and plates at a corner by Goursat's functions: exponents, and how what belongs to them turns.

With phi = A z**l and psi = B z**l, z = r*exp(i*theta) from the first edge,

    f(k) = k*phi - z*conj(phi') - conj(psi)

is 2*mu*(u + i*v), the displacement, for Kolosov's number k = kappa of the material; for k = -1, but for a turn, the
force that goes through what lies between z and the corner, and the slope of a plate with the deflection
Re(conj(z)*phi + chi), chi' = psi; for k = (3 + nu)/(1 - nu) the moments and forces in that. So a condition on an edge
is Re(way*f(k)) = 0, two at each edge: a matrix on the real and imaginary parts of A and B, analytic in l, of which each
`EdgeRow` is a row. Exponents are where it is singular; where l is not real both parts of a function are meant.

In leaf coordinates w = z + c*z**2 + ... of curved edges f has besides, to the next power of r, that of A1 and B1 and

    (c*w**2 - 2*conj(c)*w*conj(w))*conj(phi'),

with which A1 and B1 meet the conditions on both edges again.

Source: E. Goursat (1898); G. V. Kolosov (1909); M. L. Williams (1952).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy import linalg

from rsym.arrays import Complexes, Floats
from rsym.problems.corners.corners import PlaneCorner

# A, conj(A), B, conj(B) of the real and imaginary parts of A and B.
PARTS = np.array([[1, 1j, 0, 0], [1, -1j, 0, 0], [0, 0, 1, 1j], [0, 0, 1, -1j]])
LEAST = 0.05  # an exponent: there is none below 1/4 but 0
# Starts of Newton's method, for an angle up to pi: up to 0.5 it misses nothing of 600 corners, by 0.7 at 227.
APART = 0.3
STEPS, FEW = 20, 4  # of it: 12 do, a digit takes three where exponents are double
NEAR, SAME = 1e-5, 1e-6  # places for derivatives; exponents
SINGULAR, RESONANT = 1e-9, 1e-6  # of the largest singular value
SHIFTS = 3  # of waves: m, m - 2 and, of what follows on curved edges, m - 4
SLOPE = FORCE = -1.0  # of f


class Exponent(NamedTuple):
    """What is singular there, (4, functions), on the real and imaginary parts of A and B.

    simple : whether there are no functions with logarithms besides.
    """

    rate: complex
    ways: Floats | Complexes
    simple: bool


class EdgeRow(NamedTuple):
    """The condition Re(way*f(kappa)) = 0 at an angle."""

    theta: float
    kappa: float
    way: complex


@dataclass(frozen=True)
class EdgeConditions:
    """What holds on both edges of a corner, and of which functions.

    rows : the conditions.
    zeros : of each component how often it is 0 on each of the edges.
    kappa, ways : its components are the displacements Re(way*f(kappa)); without ways it is a plate's deflection.
    turned : whether ways turn as an edge does.
    forces : what stands in place of 0 in the conditions for constant forces on the edges, times r.

    Examples
    --------
    >>> corner = PlaneCorner((0.0, 0.0), 1.5 * math.pi, (1, 0), ("y", "x"), ((0.0, 1.0), (1.0, 0.0)), 1.0)
    >>> body, plate = of_body(corner, ((False, False),) * 2, 2.0), of_plate(corner, (2, 2), None)
    >>> [[round(one.rate.real, 8) for one in exponents(part.rows, 1.0)] for part in (body, plate)]
    [[0.54448374, 0.90852919, 1.0], [0.54448374, 0.90852919, 1.0]]
    """

    rows: tuple[EdgeRow, ...]
    zeros: tuple[tuple[int, int], ...]
    kappa: float = SLOPE
    ways: tuple[complex, ...] = ()
    turned: bool = False
    forces: tuple[float, ...] = ()

    @property
    def fits(self) -> bool:
        """Whether a linear displacement takes the forces; else logarithms do."""
        if not any(self.forces):
            return True
        here, wanted = matrix(1.0, self.rows).real, np.array(self.forces)
        left = here @ np.linalg.lstsq(here, wanted, rcond=SINGULAR)[0] - wanted
        return bool(np.abs(left).max() <= SINGULAR * np.abs(wanted).max())

    @property
    def top(self) -> int:
        """So much higher is the power of r than the exponent."""
        return 0 if self.ways else 1

    def waves(self, rate: complex, own: Complexes, bend: complex) -> Complexes:
        """The coefficients (orders, shifts, 2, components) of exp(+-i*m*theta)*r**(rate + top + order).

        own : the real and imaginary parts of A and B. m is rate + top + order - 2*shift.
        """
        parts = np.asarray(PARTS @ own, np.complex128)
        after = self._after(rate, parts, bend) if bend and not self.turned else None
        found = np.zeros((2 if bend else 1, SHIFTS, 2, len(self.zeros)), np.complex128)
        for order, one in enumerate((parts,) if after is None else (parts, after)):
            for k, way in enumerate(self.ways):
                found[order, :2, :, k] = _parts(rate + order, self.kappa, way) @ one
            if not self.ways:
                found[order, 0, :, 0] = one[2:] / (2 * (rate + order + 1))
                found[order, 1, :, 0] = one[:2] / 2
        if after is not None:
            for k, way in enumerate(self.ways):
                found[1, :, :, k] += _bent(rate, bend, way) @ parts
            if not self.ways:
                both = np.array([bend, bend.conjugate()])
                found[1, 0, :, 0] -= both * parts[2:] / (rate + 2)  # chi' = psi by z, and dz = (1 - 2*c*w)*dw
                found[1, 2, :, 0] -= both.conj() * parts[:2] / 2
        return found

    def _after(self, rate: complex, parts: Complexes, bend: complex) -> Complexes | None:
        """A1, B1 and conjugates (4,), for the next order on curved edges; None where rate + 1 is an exponent too."""
        turn = 1j * np.array([[rate + 1, -rate - 1], [rate - 1, 1 - rate], [rate - 3, 3 - rate]])
        left = [np.einsum("qs,qsp,p", np.exp(turn * row.theta), _bent(rate, bend, row.way), parts) for row in self.rows]
        here = matrix(rate + 1, self.rows)
        sizes = np.linalg.svd(here, compute_uv=False)
        return None if sizes[-1] < RESONANT * sizes[0] else np.asarray(PARTS @ np.linalg.solve(here, -np.array(left)))


def of_body(
    corner: PlaneCorner, held: Sequence[Sequence[bool]], kappa: float, pulls: Sequence[complex] = (0j, 0j)
) -> EdgeConditions:
    """Those of an elastic body, of which is known whether it is held along each coordinate on each edge.

    pulls : the forces on an area at the corner, on each edge, as x + i*y.
    """
    turn = complex(*corner.edges[0])
    ways = turn, -1j * turn
    # Of edges that are held, or free, along both coordinates alike it does not matter which these are.
    frame = turn if any(both[0] != both[1] for both in held) else 1.0
    rows, forces = [], []
    for theta, both, pull in zip((0.0, corner.angle), held, (-pulls[0], pulls[1]), strict=True):
        # f(-1) is the force times a quarter of a turn: that along one coordinate is what is across.
        across, along = frame, -1j * frame
        rows += [EdgeRow(theta, kappa, across) if both[0] else EdgeRow(theta, FORCE, along)]
        rows += [EdgeRow(theta, kappa, along) if both[1] else EdgeRow(theta, FORCE, across)]
        seen = pull * frame / turn
        forces += [0.0 if both[0] else seen.real, 0.0 if both[1] else -seen.imag]
    zeros = tuple((int(held[0][k]), int(held[1][k])) for k in (0, 1))
    return EdgeConditions(tuple(rows), zeros, kappa, ways, forces=tuple(forces))


def of_plate(corner: PlaneCorner, zeros: tuple[int, int], poisson: float | None) -> EdgeConditions:
    """Those of a plate whose edges are clamped, supported or free: 2, 1 or 0 zeros of its deflection."""
    # Between straight supported edges and clamped ones the ratio does not matter.
    nu = poisson or 0.0
    kappa = (3 + nu) / (1 - nu)
    rows = []
    for theta, count in zip((0.0, corner.angle), zeros, strict=True):
        along = cmath.exp(-1j * theta)
        own = ((SLOPE, along), (kappa, along)) if count == 1 else ((SLOPE if count else kappa, way) for way in (1, 1j))
        rows += [EdgeRow(theta, *one) for one in own]
    return EdgeConditions(tuple(rows), (zeros,), turned=1 in zeros)


def _parts(rate: complex | Complexes, kappa: float, way: complex) -> Complexes:
    """Of Re(way*f) the coefficients (..., 2 shifts, 2, 4) of waves, for each of A, conj(A), B, conj(B)."""
    rate = np.asarray(rate, np.complex128)
    found = np.zeros((*rate.shape, 2, 2, 4), np.complex128)
    for sign, one in enumerate((way, way.conjugate())):
        found[..., 0, sign, sign] = one * kappa / 2
        found[..., 0, sign, 2 + sign] = -one.conjugate() / 2
        found[..., 1, sign, sign] = -one.conjugate() * rate / 2
    return found


def _bent(rate: complex, bend: complex, way: complex) -> Complexes:
    """What a bend adds to the next order, (shifts, 2, 4)."""
    found = np.zeros((SHIFTS, 2, 4), np.complex128)
    for sign, (one, c) in enumerate(((way.conjugate(), bend), (way, bend.conjugate()))):
        found[1, sign, sign] = -one * c * rate
        found[2, sign, sign] = one * c.conjugate() * rate / 2
    return found


def matrix(rate: complex | Complexes, rows: Sequence[EdgeRow]) -> Complexes:
    """The conditions (..., rows, 4) on the real and imaginary parts of A and B."""
    rate = np.asarray(rate, np.complex128)
    turn = 1j * np.stack([rate, -rate, rate - 2, 2 - rate], axis=-1).reshape(*rate.shape, 2, 2)
    every = [np.einsum("...qs,...qsp->...p", np.exp(turn * row.theta), _parts(rate, *row[1:])) for row in rows]
    return np.asarray(np.stack(every, axis=-2) @ PARTS)


@lru_cache(256)
def exponents(rows: tuple[EdgeRow, ...], most: float) -> tuple[Exponent, ...]:
    """Those with a real part up to a bound and no imaginary part below 0, the least first.

    Newton's method from a lattice, for the determinant, then for the matrix, finds them.
    """
    angle = max(row.theta for row in rows)
    # Beyond, the sines of l*angle are larger than what they have to be.
    high = (1 + math.log(4 * (most + 1 + max(abs(row.kappa) for row in rows)))) / angle
    step = APART * min(1, math.pi / angle)
    at: Complexes = (np.arange(LEAST, most + step, step)[:, None] + 1j * np.arange(0, high, step)).ravel()
    moves = np.ones_like(at)
    for _ in range(STEPS):
        with np.errstate(all="ignore"):
            here, above, below = (np.linalg.det(matrix(at + side, rows)) for side in (0, NEAR, -NEAR))
            moves = np.nan_to_num(2 * NEAR * here / (above - below))
            at = at - moves / np.maximum(1, np.abs(moves) / step)
    at = np.where(at.imag < 0, at.conj(), at)
    there = (at.real > LEAST) & (at.real <= most + SAME) & (at.imag < high) & (np.abs(moves) < np.sqrt(SAME))
    found: list[Exponent] = []
    for start in at[there]:
        if all(abs(start - known.rate) > SAME for known in found):
            one = _polished(complex(start), rows)
            if one is not None and all(abs(one.rate - known.rate) > SAME for known in found):
                found.append(one)
    return tuple(sorted(found, key=lambda one: (one.rate.real, one.rate.imag)))


def _polished(rate: complex, rows: Sequence[EdgeRow]) -> Exponent | None:
    """An exponent near a place; None if none is."""

    def slope() -> Complexes:
        return np.asarray((matrix(rate + NEAR, rows) - matrix(rate - NEAR, rows)) / (2 * NEAR))

    for _ in range(FEW):
        steps = linalg.eigvals(matrix(rate, rows), slope())
        rate -= complex(steps[np.argmin(np.abs(steps))])
    if abs(rate.imag) < SAME:
        rate = complex(rate.real)
    here = matrix(rate, rows)
    left, sizes, ways = np.linalg.svd(here if rate.imag else here.real)
    own = sizes <= SINGULAR * sizes[0]
    if not own.any():
        return None
    turns = np.linalg.svd(left[:, own].conj().T @ slope() @ ways[own].conj().T, compute_uv=False)
    return Exponent(rate, ways[own].conj().T, bool(turns[-1] > RESONANT * sizes[0]))
