"""Functions that are like solutions at a corner, and meet the conditions on both of its edges, however curved, exactly.

With leaves f, g positive inside and p, q their gradients at the corner, v = f/|p| is the distance from the first edge
to first order, and w = g/|q| that from the second; u = (w + v cos alpha)/sin alpha goes along the first. In these leaf
coordinates both edges are straight: theta = 0 where f = 0, theta = alpha where g = 0, and at the corner they turn and
stretch nothing. There

    (1 - r**2/R**2)**m * r**(lambda + 2*j) * sin(lambda*theta),    lambda = k*pi/alpha,

is 0 on both edges; cos has no slope across them at straight edges; k - 1/2 for k is for one edge of each kind, the sine
counted from that which is 0. Without the factor those with j = 0 are harmonic where edges are straight. Where
cos alpha = 0 no polynomial that is 0 on both edges has the Laplacian -1, but

    -v**2/2 - Im(z**2 log z)/(2 alpha),    z = u + i*v,

has. All are 0 beyond a circle inside of which the coordinates are one to one and no other part of the boundary lies.

Source: P. Grisvard (1985), Elliptic problems in nonsmooth domains, chapter 4, for the functions at straight edges.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.problems.corners.corners import PlaneCorner
from rsym.problems.corners.leaf_jets import LeafJets, leaf_jets

CIRCLE = 720  # places around a corner, at its reach, of which the nearest in leaf coordinates is the radius
MARGIN = 0.999  # of that radius, for what lies between the places
WHOLE = 1e-9  # exponents so near to a whole number are those of polynomials, which need no functions of their own
EDGE = 1e-6  # radians: what is on an edge but for rounding
TINY = 1e-100  # of a radius; its powers do not overflow


class Term(NamedTuple):
    """A function at a corner: r**exponent times sin or cos of rate*theta, "log" for that with Laplacian -1."""

    kind: str
    rate: float
    exponent: float


@dataclass(frozen=True)
class LocalFunctions:
    """The functions at one corner: 0 beyond the `reach` of the corner, and beyond `radius` in leaf coordinates."""

    corner: PlaneCorner
    terms: tuple[Term, ...]
    radius: float
    power: int
    turned: bool  # theta is counted from the second edge
    jets: LeafJets


@dataclass(frozen=True)
class CornerFunctions:
    """Singular functions at corners of a shape, all together.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> from rsym.problems.corners.corners import corners
    >>> shape = rsym.Shape(rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(-x, y)), (x, y))
    >>> inner = [corner for corner in corners(shape) if corner.is_reentrant]
    >>> found = corner_functions(shape, inner, terms=2, levels=1, load=False)
    >>> [(kind, round(exponent, 6)) for kind, rate, exponent in found.terms]
    [('sin', 0.666667), ('sin', 1.333333)]
    >>> values, gradients, laplacians = found.at(np.array([[0.0, -0.25], [-0.25, 0.25], [0.25, 0.0]]))
    >>> values.round(6).tolist()
    [[0.0, 0.0], [0.194836, 0.0], [0.0, 0.0]]
    """

    parts: tuple[LocalFunctions, ...]

    def __len__(self) -> int:
        return sum(len(part.terms) for part in self.parts)

    @property
    def corners(self) -> tuple[PlaneCorner, ...]:
        """The corner of each function."""
        return tuple(part.corner for part in self.parts for _ in part.terms)

    @property
    def terms(self) -> tuple[Term, ...]:
        """What each function is."""
        return tuple(term for part in self.parts for term in part.terms)

    def at(self, points: Floats) -> tuple[Floats, Floats, Floats]:
        """Values (n, k), gradients (n, 2, k) and Laplacians (n, k) at points (n, 2).

        At the corner itself derivatives that are infinite come out as large numbers.
        """
        found = self.derivatives(points, 2)
        return found[0].T, found[1:3].transpose(2, 0, 1), (found[3] + found[5]).T

    def derivatives(self, points: Floats, order: int) -> Floats:
        """Derivatives up to the order 0, 1 or 2 at points (n, 2): value, x, y, xx, xy, yy, of those (kinds, k, n)."""
        points = np.asarray(points, np.float64)
        out = np.zeros(((1, 3, 6)[order], len(self), len(points)))
        done = 0
        for part in self.parts:
            near = np.flatnonzero(np.hypot(*(points - part.corner.point).T) < part.corner.reach)
            if len(near):
                some, found = _local(part, points[near], order)
                out[:, done : done + len(part.terms), near[some]] = found
            done += len(part.terms)
        return out


def corner_functions(
    shape: Shape,
    corners: Sequence[PlaneCorner],
    natural: Collection[int] = (),
    *,
    terms: int = 7,
    levels: int = 3,
    highest: float = 9.0,
    load: bool | Sequence[bool] = True,
    power: int = 7,
    letters: Mapping[Any, float] | None = None,
) -> CornerFunctions:
    """The singular functions at corners of a shape.

    Parameters
    ----------
    shape : Shape
        Whose `corners` they are, with the same letters.
    corners : sequence of PlaneCorner
    natural : collection of int
        The leaves on which nothing is prescribed (Neumann, Robin); on the others the functions are 0.
    terms, levels : int
        The largest k, and the number of j. Those with a whole exponent, which are smooth, are left out.
    highest : float
        The largest exponent lambda + 2*j.
    load : bool, or one for each corner
        Whether there are those with logarithms, which solutions of -laplacian(u) = 1 need where cos alpha = 0.
    power : int
        m, at least 3: so many times less one the functions are smooth where they end.

    Raises
    ------
    RsymError
        ``cusp`` for a corner whose edges touch: leaf coordinates do not tell them apart.
    """
    parts = []
    loads = [load] * len(corners) if isinstance(load, bool) else load
    for corner, loaded in zip(corners, loads, strict=True):
        if corner.is_cusp:
            raise RsymError(
                f"the edges {corner.parts[0]!r} and {corner.parts[1]!r} touch: a cusp has no functions of this kind",
                code="cusp",
                where=f"({corner.point[0]:.10g}, {corner.point[1]:.10g})",
                remedy="move one of them, or leave the cusp out",
            )
        free = tuple(leaf in natural for leaf in corner.leaves)
        chosen = _terms(corner.angle, free, terms, levels, highest, load=loaded)
        if chosen:
            jets = leaf_jets(shape, corner.leaves, letters)
            parts.append(LocalFunctions(corner, chosen, _radius(corner, jets), power, free == (True, False), jets))
    return CornerFunctions(tuple(parts))


def _terms(
    angle: float, free: tuple[bool, ...], terms: int, levels: int, highest: float, *, load: bool
) -> tuple[Term, ...]:
    """The functions at a corner, the least smooth first."""
    kind, shift = "cos" if all(free) else "sin", 0.5 if free[0] != free[1] else 0.0
    rates = [(k - shift) * math.pi / angle for k in range(1, terms + 1)]
    found = [Term(kind, rate, rate + 2 * j) for rate in rates if not _is_whole(rate) for j in range(levels)]
    if load and not any(free) and abs(math.cos(angle)) < WHOLE:
        found += [Term("log", 2.0, 2.0 + 2 * j) for j in range(levels)]
    return tuple(sorted((term for term in found if term.exponent <= highest), key=lambda term: term.exponent))


def _is_whole(rate: float) -> bool:
    return abs(rate - round(rate)) < WHOLE


def _radius(corner: PlaneCorner, jets: LeafJets) -> float:
    """The largest radius in leaf coordinates of a disc that lies within the reach."""
    around = np.linspace(0, 2 * math.pi, CIRCLE, endpoint=False)
    places = corner.point + corner.reach * np.stack([np.cos(around), np.sin(around)], axis=1)
    u, v, _ = _coordinates(corner, jets.at(places)[:, 0])
    return MARGIN * float(np.hypot(u, v).min())


def _coordinates(corner: PlaneCorner, leaves: Floats) -> tuple[Floats, Floats, Floats]:
    """Leaf coordinates u, v and w of anything linear in the two leaves (2, ...)."""
    first, second = (math.hypot(*slope) for slope in corner.gradients)
    v, w = leaves[0] / first, leaves[1] / second
    return (w + v * math.cos(corner.angle)) / math.sin(corner.angle), v, w


class _Polar(NamedTuple):
    """Polar leaf coordinates; of `angle` and `rest` = alpha - angle the smaller is exact, `first` says which."""

    r: Floats
    angle: Floats
    rest: Floats
    first: Flags


def _polar(corner: PlaneCorner, u: Floats, v: Floats, w: Floats) -> _Polar:
    alpha = corner.angle
    cut = (alpha + 2 * math.pi) / 2  # opposite to the middle
    along = (v + w * math.cos(alpha)) / math.sin(alpha)
    angle, rest = np.arctan2(v, u), np.arctan2(w, along)
    angle = np.where(angle > cut, angle - 2 * math.pi, np.where(angle < cut - 2 * math.pi, angle + 2 * math.pi, angle))
    rest = np.where(rest > cut, rest - 2 * math.pi, np.where(rest < cut - 2 * math.pi, rest + 2 * math.pi, rest))
    return _Polar(np.hypot(u, v), angle, rest, np.abs(angle) <= np.abs(rest))


def _local(part: LocalFunctions, points: Floats, order: int) -> tuple[Ints, Floats]:
    """The points within the radius, and the derivatives there, (kinds, k, n)."""
    corner, jets = part.corner, part.jets.at(points)
    u, v, w = _coordinates(corner, jets)  # (6, n)
    polar = _polar(corner, u[0], v[0], w[0])
    inside = polar.r < part.radius
    if not corner.alone:
        inside &= (polar.angle > -EDGE) & (polar.rest > -EDGE)
    some = np.flatnonzero(inside)
    u, v = u[:, some], v[:, some]
    radial = _Radial(_Polar(*(array[some] for array in polar)), part)
    # The frame of polar coordinates: derivatives of u and v along er and et.
    c, s = u[0] / radial.r, v[0] / radial.r
    along, across = c * u[1:] + s * v[1:], c * v[1:] - s * u[1:]
    out = np.empty(((1, 3, 6)[order], len(part.terms), len(some)))
    pairs = [(0, 0), (0, 1), (1, 1)] if order == 2 else []
    squares = [(along[i] * along[j], across[i] * across[j]) for i, j in pairs]
    mixed = [along[i] * across[j] + along[j] * across[i] for i, j in pairs]
    for k, term in enumerate(part.terms):
        value, dr, dt, rr, rt, flat = radial.of(term)
        out[0, k] = value
        if order > 0:
            out[1:3, k] = dr * along[:2] + dt * across[:2]
        for number, ((a, b), m) in enumerate(zip(squares, mixed, strict=True)):
            # tt is flat - rr: in the Laplacian what is harmonic cancels.
            bent = dr * along[2 + number] + dt * across[2 + number]
            out[3 + number, k] = rr * (a - b) + rt * m + flat * b + bent
    return some, out


class _Radial:
    """Terms with their derivatives in polar coordinates, at points within the radius."""

    def __init__(self, polar: _Polar, part: LocalFunctions) -> None:
        self.polar, self.turned, self.alpha = polar, part.turned, part.corner.angle
        self.r = np.maximum(polar.r, TINY)
        share, m = self.r / part.radius, part.power
        rest = np.maximum((1 - share) * (1 + share), 0.0)
        # The factor, r times its derivative, and r**2 times its second one.
        self.chi = rest**m
        self.chi1 = -2 * m * share**2 * rest ** (m - 1)
        self.chi2 = self.chi1 + 4 * m * (m - 1) * share**4 * rest ** (m - 2)
        self._waves: dict[tuple[str, float], tuple[Floats, Floats]] = {}
        self._sizes: dict[tuple[float, int], Floats] = {}

    def of(self, term: Term) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
        """Value, derivatives along r and across, second ones rr and rt, and the Laplacian rr + tt."""
        if term.kind == "log":
            return self._logarithm(term)
        if (term.kind, term.rate) not in self._waves:
            self._waves[term.kind, term.rate] = self._wave(term)
        s, ds = self._waves[term.kind, term.rate]
        f, f1, f2, flat = self._radial(term.exponent, term.rate)
        size, r = self._size(term), self.r
        s, ds = size * s, size * ds
        return f * r**2 * s, f1 * r * s, f * r * ds, f2 * s, (f1 - f) * ds, flat * s

    def _size(self, term: Term) -> Floats:
        """r**(exponent - 2), of one power for all that differ from it by squares."""
        times = round((term.exponent - term.rate) / 2)
        if (term.rate, times) not in self._sizes:
            lower = term._replace(exponent=term.exponent - 2)
            found = self._size(lower) * self.r**2 if times > 0 else self.r ** (term.exponent - 2)
            self._sizes[term.rate, times] = found
        return self._sizes[term.rate, times]

    def _radial(self, e: float, rate: float) -> tuple[Floats, Floats, Floats, Floats]:
        """Of F = chi*r**e: F, r F', r**2 F'', and r**2 F'' + r F' - rate**2 F, all over r**e."""
        chi, chi1, chi2 = self.chi, self.chi1, self.chi2
        f1 = e * chi + chi1
        f2 = e * (e - 1) * chi + 2 * e * chi1 + chi2
        return chi, f1, f2, (e - rate) * (e + rate) * chi + (2 * e + 1) * chi1 + chi2

    def _wave(self, term: Term) -> tuple[Floats, Floats]:
        """The sine or cosine of rate*theta, and its derivative by theta, from the nearer edge."""
        near, far = (self.polar.rest, self.polar.angle) if self.turned else (self.polar.angle, self.polar.rest)
        from_near = ~self.polar.first if self.turned else self.polar.first
        angle = np.where(from_near, near, far)
        s, c = np.sin(term.rate * angle), np.cos(term.rate * angle)
        # At the far edge rate*alpha is a multiple of pi, or an odd one of pi/2 where conditions are mixed.
        whole = round(2 * term.rate * self.alpha / math.pi)
        sine, cosine = (0.0, 1.0, 0.0, -1.0)[whole % 4], (1.0, 0.0, -1.0, 0.0)[whole % 4]
        sin = np.where(from_near, s, sine * c - cosine * s)
        cos = np.where(from_near, c, cosine * c + sine * s)
        value, slope = (sin, term.rate * cos) if term.kind == "sin" else (cos, -term.rate * sin)
        return value, -slope if self.turned else slope

    def _logarithm(self, term: Term) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats]:
        """r**(2*j) chi S with S = -v**2/2 - Im(z**2 log z)/(2 alpha), of which r S' and the like follow."""
        e, r = term.exponent, self.r
        # From the second edge the function looks the same.
        first = self.polar.first
        t = np.where(first, self.polar.angle, self.polar.rest)
        s2, c2, log = np.sin(2 * t), np.cos(2 * t), np.log(r)
        n = 2 * self.alpha
        s = -(np.sin(t) ** 2) / 2 - (log * s2 + t * c2) / n  # S/r**2
        st = -s2 / 2 - (2 * log * c2 + c2 - 2 * t * s2) / n
        st, sign = np.where(first, st, -st), np.where(first, 1.0, -1.0)
        a, b = -s2 / n, sign * -2 * c2 / n  # r times the derivatives of s and st by r
        f, f1, f2, flat = self._radial(e, 2.0)
        size = self._size(term)
        rr = f2 * s + (2 * f1 - f) * a
        rt = (f1 - f) * st + f * b
        # The Laplacian of S is -1.
        lap = flat * s + 2 * (f1 - 2 * f) * a - f
        return f * r**2 * size * s, (f1 * s + f * a) * r * size, f * r * size * st, rr * size, rt * size, lap * size
