"""Functions at corners of elastic bodies and plates: powers of r times sums of waves, 0 where these are held.

As those of Laplace's equation they are of leaf coordinates, and cut off. Where a weight has a root in it, at re-entrant
corners with values, smooth functions that are 0 there are not that weight times smooth ones: polynomials are among
them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rsym.arrays import Complexes, Floats
from rsym.model.shape import Shape
from rsym.problems.corners.corners import PlaneCorner
from rsym.problems.corners.goursat import SHIFTS, EdgeConditions, exponents
from rsym.problems.corners.leaf_coordinates import bends, coordinates_of, largest_radius
from rsym.problems.corners.leaf_jets import LeafJets, leaf_jets
from rsym.problems.corners.singular_loops import wave_terms

# Of an L with its notch held, on 32 cells of degree 6, energies are off by 1e-8 without functions beyond 1.6, and by
# 1e-9 without those beyond 2.5, of one level 1e-8 too, of three no less.
STEEPEST, LEVELS = 2.5, 2
HIGHEST = 3  # of polynomials, and twice as much more as a plate's deflection has than its slopes
WHOLE = 1e-9  # exponents so near to a whole number are those of polynomials
TINY = 1e-9
SHIFT = 1e-5  # of an exponent, for derivatives: (SHIFT*log(r))**2 is 4e-8 where r is 1e-9


class WaveTerm(NamedTuple):
    """A function at a corner: the real part of its exponent with its level in it, which one it is, and the level."""

    exponent: float
    function: int
    level: int


@dataclass(frozen=True)
class WaveFunctions:
    """The functions at one corner: 0 beyond the `reach` of the corner, and beyond `radius` in leaf coordinates.

    rates, waves, top : what `wave_terms` makes functions of, each of one or more components.
    """

    corner: PlaneCorner
    terms: tuple[WaveTerm, ...]
    rates: Complexes
    waves: Complexes
    top: int
    radius: float
    power: int
    jets: LeafJets

    def derivatives(self, points: Floats, order: int) -> Floats:
        """Derivatives up to the order 0, 1 or 2 at points (n, 2) within the reach: (n, components*kinds, terms)."""
        count, orders, *_, components = self.waves.shape
        out = np.zeros((len(points), components, (1, 3, 6)[order], len(self.terms)))
        wave_terms(
            *coordinates_of(self.corner, self.jets.at(points)),
            self.corner.angle,
            self.radius,
            self.power,
            self.corner.alone,
            self.rates,
            self.top,
            self.waves,
            np.empty((count, orders, components, 3), np.complex128),
            np.array([term.function for term in self.terms], np.int64),
            np.array([term.level for term in self.terms], np.int64),
            out,
        )
        return out.reshape(len(points), -1, len(self.terms))

    def component(self, axis: int) -> WaveFunctions:
        """One component of each."""
        return replace(self, waves=np.ascontiguousarray(self.waves[..., axis : axis + 1]))


def wave_functions(
    shape: Shape, corner: PlaneCorner, conditions: EdgeConditions, *, power: int, most: float = STEEPEST
) -> WaveFunctions | None:
    """The functions at a corner whose edges do not touch, None where splines do as well.

    most : the largest real part of an exponent.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.problems.corners.corners import corners
    >>> from rsym.problems.corners.goursat import of_body
    >>> ell = rsym.Shape(rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(-x, y)), (x, y))
    >>> (inner,) = (corner for corner in corners(ell) if corner.is_reentrant)
    >>> free, held = (of_body(inner, [[one, one]] * 2, 2.0) for one in (False, True))
    >>> [round(term.exponent, 4) for term in wave_functions(ell, inner, free, power=5, most=1.5).terms]
    [0.5445, 0.9085, 2.5445, 2.9085]
    >>> found = wave_functions(ell, inner, held, power=5).derivatives(np.array([[0.0, -0.25], [-0.25, 0.0]]), 0)
    >>> np.abs(found).max(axis=(1, 2)).round(12) + 0.0
    array([0.        , 0.69506124])
    """
    jets = leaf_jets(shape, corner.leaves, None, corner.lines)
    bend, factors = bends(corner, jets)
    found = [(*one, LEVELS) for one in _singular(conditions, bend, most)]
    if corner.is_reentrant:
        found += [(*one, 1) for one in _polynomials(corner.angle, conditions, 2 if bend else 1)]
    if not found:
        return None
    jets = replace(jets, bends=factors)
    terms = sorted(
        WaveTerm(rate.real + 2 * level, function, level)
        for function, (rate, _, levels) in enumerate(found)
        for level in range(levels)
    )
    rates, waves, _ = zip(*found, strict=True)
    made = np.array(rates, np.complex128), np.array(waves, np.complex128)
    return WaveFunctions(corner, tuple(terms), *made, conditions.top, largest_radius(corner, jets), power, jets)


def _singular(conditions: EdgeConditions, bend: complex, most: float) -> Iterator[tuple[complex, Complexes]]:
    """Exponents and waves of what is no polynomial; of exponents that are not real, of both parts."""
    for rate, ways, _ in exponents(conditions.rows, most):
        if abs(rate - round(rate.real)) < WHOLE:
            continue
        for own in ways.T:
            waves = conditions.waves(rate, own, bend)
            waves /= np.abs(waves[0]).max()
            yield from ((rate, part * waves) for part in ((1, -1j) if rate.imag else (1,)))
    if not conditions.fits:
        # What a shift of the exponent 1 changes: r*log(r) and r*theta times waves.
        for own in (
            way for rate, ways, _ in exponents(conditions.rows, most) if abs(rate - 1) < WHOLE for way in ways.T
        ):
            yield 1 + SHIFT * 1j, conditions.waves(1 + SHIFT * 1j, own, bend) * (-1j / SHIFT)


def _polynomials(angle: float, conditions: EdgeConditions, orders: int) -> Iterator[tuple[complex, Complexes]]:
    """Powers and waves, of so many orders, of polynomials of one component that are 0 as often as that on the edges."""
    for component, (first, second) in enumerate(conditions.zeros):
        zeros = [(theta, k) for theta, count in ((0.0, first), (angle, second)) for k in range(count)]
        for degree in range(1, HIGHEST + 2 * conditions.top + 1) if zeros else ():
            waves = [(q, degree - 2 * q, phase) for q in range(SHIFTS) for phase in (0, 1) if degree - 2 * q >= phase]
            # cos(m*theta - phase*pi/2) and its derivative, that of cos(t) being cos(t + pi/2).
            rows = [[m**k * math.cos(m * t + (k - phase) * math.pi / 2) for _, m, phase in waves] for t, k in zeros]
            _, sizes, ways = np.linalg.svd(np.array(rows))
            for own in ways[np.count_nonzero(sizes > TINY) :]:
                made = np.zeros((orders, SHIFTS, 2, len(conditions.zeros)), np.complex128)
                for value, (q, _, phase) in zip(own, waves, strict=True):
                    made[0, q, :, component] += value / 2 * np.array([1, 1] if phase == 0 else [-1j, 1j])
                yield complex(degree - conditions.top), made
