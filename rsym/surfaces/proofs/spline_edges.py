"""Edges of B-spline surfaces as polynomials with rational coefficients, span by span."""

from __future__ import annotations

from fractions import Fraction
from typing import TypeAlias

from rsym.surfaces.bsplines.spline_spaces import SplineSpace
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.functions.entries import exact
from rsym.surfaces.joints.edges import Edge

# Coefficients of the powers of the parameter, the lowest first.
Polynomial: TypeAlias = list[Fraction]
Part: TypeAlias = tuple[Fraction, Fraction]
ONE, NONE = Fraction(1), Fraction(0)


def spline_jet(
    surface: BSplineSurface, edge: Edge, part: Part
) -> tuple[dict[tuple[int, int], list[Polynomial]], list[Fraction]]:
    """Three polynomials of the parameter along the edge for each order (along, across), and the knots inside the part.

    The polynomials are those of the span in the middle of the part. Derivatives across are towards growing u or v.

    Examples
    --------
    >>> net = [[[i, j, i * j] for j in range(3)] for i in range(3)]
    >>> surface = BSplineSurface(net, order=(3, 3))
    >>> vectors, knots = spline_jet(surface, Edge(surface, "u1"), (NONE, ONE))
    >>> [[str(c) for c in one] for one in vectors[0, 0]], knots
    ([['2', '0', '0'], ['0', '2', '0'], ['0', '4', '0']], [])
    """
    spaces = surface.spaces if edge.across == 0 else surface.spaces[::-1]
    net = surface.net if edge.across == 0 else surface.net.swapaxes(0, 1)
    knots = [_knots(space) for space in spaces]
    end = _fraction(edge.patch.domain[edge.across][int(edge.upper)])
    first, fixed = _pieces(knots[0], spaces[0].degree, end, edge.upper)
    second, moving = _pieces(knots[1], spaces[1].degree, (part[0] + part[1]) / 2, False)
    used = [[[_fraction(x) for x in net[i % len(net), j % net.shape[1]]] for j in second] for i in first]
    vectors = {}
    for i, j in ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        across = [_at(_differentiated(one, j), end) for one in fixed]
        along = [_differentiated(one, i) for one in moving]
        vectors[i, j] = [_combined(across, along, [[cell[axis] for cell in row] for row in used]) for axis in range(3)]
    inner = sorted({one for one in knots[1] if part[0] < one < part[1]})
    return vectors, inner


def _fraction(value: float) -> Fraction:
    return Fraction(str(exact(value)))


def _knots(space: SplineSpace) -> list[Fraction]:
    return [_fraction(one) for one in space.knots]


def _pieces(knots: list[Fraction], degree: int, place: Fraction, before: bool) -> tuple[range, list[Polynomial]]:
    """Numbers and polynomials of the basis functions on the span round a place, or before it."""
    spans = [k for k in range(len(knots) - 1) if knots[k] < knots[k + 1]]
    before = before or place == knots[-degree - 1]
    inside = [k for k in spans if (knots[k] < place <= knots[k + 1] if before else knots[k] <= place < knots[k + 1])]
    span = inside[0]
    known: dict[int, Polynomial] = {span: [ONE]}
    for k in range(1, degree + 1):
        raised: dict[int, Polynomial] = {}
        for i in range(span - k, span + 1):
            rising = _ramp(known.get(i), knots[i], knots[i + k])
            falling = _ramp(known.get(i + 1), knots[i + k + 1], knots[i + 1])
            raised[i] = [a + b for a, b in zip(_padded(rising, k + 1), _padded(falling, k + 1), strict=True)]
        known = raised
    numbers = range(span - degree, span + 1)
    return numbers, [known[i] for i in numbers]


def _ramp(function: Polynomial | None, zero: Fraction, end: Fraction) -> Polynomial:
    """A function times (t - zero)/(end - zero), none where the knots coincide."""
    if function is None or end == zero:
        return []
    scale = ONE / (end - zero)
    shifted = [NONE, *function]
    return [scale * (a - zero * b) for a, b in zip(shifted, _padded(function, len(shifted)), strict=True)]


def _padded(coefficients: Polynomial, length: int) -> Polynomial:
    return [*coefficients, *[NONE] * (length - len(coefficients))]


def _differentiated(coefficients: Polynomial, times: int) -> Polynomial:
    for _ in range(times):
        coefficients = [k * c for k, c in enumerate(coefficients)][1:] or [NONE]
    return coefficients


def _at(coefficients: Polynomial, place: Fraction) -> Fraction:
    total = NONE
    for coefficient in reversed(coefficients):
        total = total * place + coefficient
    return total


def _combined(across: list[Fraction], along: list[Polynomial], vertices: list[list[Fraction]]) -> Polynomial:
    """The sum of vertices times numbers times polynomials."""
    weights = [sum((a * row[j] for a, row in zip(across, vertices, strict=True)), NONE) for j in range(len(along))]
    length = max(map(len, along))
    rows = [_padded(one, length) for one in along]
    return [sum((w * row[k] for w, row in zip(weights, rows, strict=True)), NONE) for k in range(length)]
