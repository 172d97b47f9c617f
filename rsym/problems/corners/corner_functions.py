"""Functions that are like solutions at a corner, and meet the conditions on both of its edges, however curved, exactly.

With leaves f, g positive inside and p, q their gradients at the corner, v = f/|p| is the distance from the first edge
to first order, and w = g/|q| that from the second; u = (w + v cos alpha)/sin alpha goes along the first. In these leaf
coordinates both edges are straight: theta = 0 where f = 0, theta = alpha where g = 0, and at the corner they turn and
stretch nothing. Where edges are curved a factor of each leaf, `Bend`, makes u + i*v = z + c z**2 to second order, so
that what is harmonic there is so here but for two orders more, not one. There

    (1 - r**2/R**2)**m * r**(lambda + 2*j) * sin(lambda*theta),    lambda = k*pi/alpha,

is 0 on both edges; cos has no slope across them at straight edges; k - 1/2 for k is for one edge of each kind, the sine
counted from that which is 0. Without the factor those with j = 0 are harmonic where edges are straight. Where
cos alpha = 0 no polynomial that is 0 on both edges has the Laplacian -1, but

    -v**2/2 - Im(z**2 log z)/(2 alpha),    z = u + i*v,

has. A factor, `Growth`, takes convection and a diffusion that varies along. All are 0 beyond a circle inside of which
the coordinates are one to one and no other part of the boundary lies.

What is left at a curved edge is for the splines: where conditions change on an arc of radius 1, -laplacian(u) = 1 has
errors of degree 5 of 5e-4, 1e-4, 2e-5 and 1e-6 at 16, 24, 32 and 48 cells, by leaf coordinates that are not bent
3e-4, 2e-4, 4e-5 and 2e-5.

Source: P. Grisvard (1985), Elliptic problems in nonsmooth domains, chapter 4, for the functions at straight edges.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from rsym.arrays import Floats, Ints
from rsym.errors import RsymError
from rsym.model.shape import Shape
from rsym.problems.corners.corners import PlaneCorner
from rsym.problems.corners.growth import Growth
from rsym.problems.corners.leaf_coordinates import bends, coordinates_of, largest_radius
from rsym.problems.corners.leaf_jets import LeafJets, leaf_jets
from rsym.problems.corners.singular_loops import LOG, corner_terms
from rsym.problems.splines.cardinals import multiplied
from rsym.sampling.rules.division import Grading

WHOLE = 1e-9  # exponents so near to a whole number are those of polynomials, which need no functions of their own

KINDS = ("sin", "cos", "log")  # as the loop counts them


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
    growth: Growth | None = None

    def derivatives(self, points: Floats, order: int) -> Floats:
        """Derivatives up to the order 0, 1 or 2 at points (n, 2) within the reach: (n, kinds, terms)."""
        corner, out = self.corner, np.zeros((len(points), (1, 3, 6)[order], len(self.terms)))
        halves = [round(2 * term.rate * corner.angle / math.pi) for term in self.terms]
        kinds = [KINDS.index(term.kind) for term in self.terms]
        multiples = max((half for half, kind in zip(halves, kinds, strict=True) if kind != LOG), default=0)
        corner_terms(
            *coordinates_of(corner, self.jets.at(points)),
            corner.angle,
            self.radius,
            self.power,
            self.turned,
            corner.alone,
            np.array(kinds, np.int64),
            np.array(halves, np.int64),
            np.array([round((term.exponent - term.rate) / 2) for term in self.terms], np.int64),
            np.array([term.rate for term in self.terms]),
            np.empty((3, multiples + 1)),
            out,
        )
        if self.growth is None:
            return out
        factor = self.growth.at(points - np.array(corner.point), order)
        found = multiplied(out.transpose(1, 0, 2), factor[:, :, None], 2, order)
        return np.ascontiguousarray(found.transpose(1, 0, 2))


class FunctionsThere(Protocol):
    """What there has to be at one corner: terms, the least smooth first, 0 beyond the reach of the corner."""

    @property
    def corner(self) -> PlaneCorner:
        """Where."""

    @property
    def terms(self) -> Sequence[Any]:
        """What each function is; they have an `exponent`, that of what has finite energy if it is above 0."""

    def derivatives(self, points: Floats, order: int) -> Floats:
        """Derivatives up to an order at points (n, 2) within the reach: (n, kinds, terms)."""


F = TypeVar("F", bound=FunctionsThere, covariant=True)


@dataclass(frozen=True)
class CornerFunctions(Generic[F]):
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
    >>> (values.round(6) + 0.0).tolist()
    [[0.0, 0.0], [0.194836, 0.0], [0.0, 0.0]]
    """

    parts: tuple[F, ...]

    def __len__(self) -> int:
        return sum(len(part.terms) for part in self.parts)

    @property
    def corners(self) -> tuple[PlaneCorner, ...]:
        """The corner of each function."""
        return tuple(part.corner for part in self.parts for _ in part.terms)

    @property
    def terms(self) -> tuple[Any, ...]:
        """What each function is."""
        return tuple(term for part in self.parts for term in part.terms)

    @property
    def grading(self) -> Grading:
        """The corners, towards which cells are divided, and how the work of functions of any kind falls there.

        That of a singular function grows with its gradient squared; of it and a smooth one with the gradient; the
        weight is not smooth at a re-entrant corner.
        """
        points = np.array([part.corner.point for part in self.parts]).reshape(-1, 2)
        least = np.array([part.terms[0].exponent for part in self.parts])
        bent = np.array([part.corner.is_reentrant for part in self.parts])
        return Grading(points, np.minimum(2 * least, np.where(bent, 2.0, 1 + least)))

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
        for first, part, near in self.near(points):
            out[:, first : first + len(part.terms), near] = part.derivatives(points[near], order).transpose(1, 2, 0)
        return out

    def near(self, points: Floats) -> Iterator[tuple[int, F, Ints]]:
        """Of each corner within whose reach some points (n, 2) lie the number of its first function, and which do."""
        first, order = 0, np.argsort(points[:, 0], kind="stable")
        across = points[order, 0]
        for part in self.parts:
            (u, v), reach = part.corner.point, part.corner.reach
            beside = order[slice(*np.searchsorted(across, [u - reach, u + reach]))]
            near = np.sort(beside[np.hypot(points[beside, 0] - u, points[beside, 1] - v) < reach])
            if len(near):
                yield first, part, near
            first += len(part.terms)


def corner_functions(
    shape: Shape,
    corners: Sequence[PlaneCorner],
    natural: Collection[int] = (),
    *,
    terms: int = 7,
    levels: int = 3,
    highest: float = 9.0,
    steepest: float = math.inf,
    load: bool | Sequence[bool] = True,
    power: int = 7,
    letters: Mapping[Any, float] | None = None,
    growths: Sequence[Growth | None] = (),
) -> CornerFunctions[LocalFunctions]:
    """The singular functions at corners of a shape.

    Parameters
    ----------
    shape : Shape
        Whose `corners` they are, with the same letters.
    corners : sequence of PlaneCorner
    natural : collection of int
        The leaves on which nothing is prescribed (Neumann, Robin); on the others the functions are 0.
    terms, levels : int
        The largest k, and the number of j. Those with a whole exponent, which are smooth, are left out but at
        re-entrant corners with values on an edge, where weights have a root in them.
    highest : float
        The largest exponent lambda + 2*j.
    steepest : float
        The largest rate lambda.
    load : bool, or one for each corner
        Whether there are those with logarithms, which solutions of -laplacian(u) = 1 need where cos alpha = 0.
    power : int
        m, at least 3: so many times less one the functions are smooth where they end.
    growths : sequence of Growth or None, optional
        The factors of the functions at each corner; none by default.

    Raises
    ------
    RsymError
        ``cusp`` for a corner whose edges touch: leaf coordinates do not tell them apart.
    """
    parts = []
    loads = [load] * len(corners) if isinstance(load, bool) else load
    for corner, loaded, growth in zip(corners, loads, growths or [None] * len(corners), strict=True):
        if corner.is_cusp:
            raise RsymError(
                f"the edges {corner.parts[0]!r} and {corner.parts[1]!r} touch: a cusp has no functions of this kind",
                code="cusp",
                where=f"({corner.point[0]:.10g}, {corner.point[1]:.10g})",
                remedy="move one of them, or leave the cusp out",
            )
        chosen = terms_at(corner, natural, terms=terms, levels=levels, highest=highest, steepest=steepest, load=loaded)
        free = corner.free(natural)
        if chosen:
            jets = leaf_jets(shape, corner.leaves, letters, corner.lines)
            jets = replace(jets, bends=bends(corner, jets)[1])
            radius, turned = largest_radius(corner, jets), free == (True, False)
            parts.append(LocalFunctions(corner, chosen, radius, power, turned, jets, growth))
    return CornerFunctions(tuple(parts))


def terms_at(
    corner: PlaneCorner,
    natural: Collection[int] = (),
    *,
    terms: int = 7,
    levels: int = 3,
    highest: float = 9.0,
    steepest: float = math.inf,
    load: bool = True,
) -> tuple[Term, ...]:
    """What the functions at a corner are, the least smooth first; arguments as in `corner_functions`.

    Examples
    --------
    >>> corner = PlaneCorner((0.0, 0.0), math.pi / 2, (1, 0), ("y", "x"), ((0.0, 1.0), (1.0, 0.0)), 1.0)
    >>> [term.kind for term in terms_at(corner)], terms_at(corner, load=False), terms_at(corner, {0, 1})
    (['log', 'log', 'log'], (), ())
    >>> terms_at(corner, {1}, load=False)
    ()
    """
    free = corner.free(natural)
    kind, shift = "cos" if all(free) else "sin", 0.5 if free[0] != free[1] else 0.0
    rates = [(k - shift) * math.pi / corner.angle for k in range(1, terms + 1)]
    rates = [rate for rate in rates if rate <= steepest]
    # Smooth functions that are 0 on edges are a weight times smooth ones, unless the weight has a root in it.
    rooted = corner.is_reentrant and not all(free)
    found = [Term(kind, rate, rate + 2 * j) for rate in rates if rooted or not _is_whole(rate) for j in range(levels)]
    if load and not any(free) and abs(math.cos(corner.angle)) < WHOLE:
        found += [Term("log", 2.0, 2.0 + 2 * j) for j in range(levels)]
    return tuple(sorted((term for term in found if term.exponent <= highest), key=lambda term: term.exponent))


def _is_whole(rate: float) -> bool:
    return abs(rate - round(rate)) < WHOLE
