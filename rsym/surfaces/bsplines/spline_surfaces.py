"""B-spline surfaces: nets of vertices, and nets for data.

p(u, v) = sum_ij B_ij N_(i,k)(u) M_(j,l)(v)

Source: Rogers and Adams, Mathematical Elements for Computer Graphics (1990), section 6-9 and equations 6-83 and 6-84.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces import symbols
from rsym.surfaces.bsplines.bspline_data import checked_points, directions, orders_of, pair_of, spaces_for_data
from rsym.surfaces.bsplines.bspline_fitting import (
    Pair,
    Residual,
    SplineFit,
    check_met,
    checked_smoothing,
    fitted_net,
    residual_of,
)
from rsym.surfaces.bsplines.parameter_correction import approximated
from rsym.surfaces.bsplines.scattered_data import spaces_for_scattered
from rsym.surfaces.bsplines.spline_spaces import Spaces, checked_space, tensor_values
from rsym.surfaces.functions.formulas import exact
from rsym.surfaces.parameters import Interval, LetterValues
from rsym.surfaces.patch import Orders, Patch

Both: TypeAlias = tuple[Any, Any]

# Polynomial pieces up to which a formula is given: SymPy takes about 5 ms for each of them.
PIECES = 400


class BSplineSurface(Patch):
    """A B-spline surface of orders (k, l) over a net of vertices.

    p(u, v) = sum_ij B_ij N_(i,k)(u) M_(j,l)(v); the surface is C^(k-2) in u and C^(l-2) in v where no knot is repeated.

    Parameters
    ----------
    net : array (n + 1, m + 1, 3)
        The vertices B.
    order : pair of int, optional
        One more than the degrees, 2 <= k <= n + 1; (4, 4) by default.
    knots : pair of arrays, optional
        For u and for v, and the surface runs over their interval; None, or None for one of them: uniform over [0, 1],
        open ends k times. (The source has 0, 1, 2, ..., n - k + 2.) A closed direction takes the knots of one period,
        or all.
    closed : pair of bool
        Whether the vertices go round in u, and in v; the first is not repeated.
    degree : pair of int, optional
        In the place of `order`: one less.

    Examples
    --------
    >>> ridge = BSplineSurface([[[i, j, j == 1] for j in range(3)] for i in range(2)], order=(2, 3))
    >>> ridge(0.5, [0.0, 0.5, 1.0]).tolist()
    [[0.5, 0.0, 0.0], [0.5, 1.0, 0.5], [0.5, 2.0, 0.0]]
    >>> ridge.expression()
    Matrix([
    [                                          u],
    [                        2*u*v + 2*v*(1 - u)],
    [u*(-2*v**2 + 2*v) + (1 - u)*(-2*v**2 + 2*v)]])
    """

    def __init__(
        self,
        net: ArrayLike,
        order: tuple[int, int] | None = None,
        knots: Both | None = None,
        closed: tuple[bool, bool] = (False, False),
        *,
        degree: tuple[int, int] | None = None,
    ) -> None:
        self.net = checked_points(net, "the net of vertices")
        self.net.setflags(write=False)
        orders, given = orders_of(order, degree), (None, None) if knots is None else pair_of(knots, "knots")
        wishes = zip(orders, given, self.net.shape[:2], directions(closed), "uv", strict=True)
        first, second = (checked_space(*wish) for wish in wishes)
        self.spaces: Spaces = (first, second)
        self.fit: SplineFit | None = None

    @classmethod
    def _fitted(cls, spaces: Spaces, net: Floats, fit: SplineFit) -> BSplineSurface:
        first, second = spaces
        orders = (first.degree + 1, second.degree + 1)
        surface = cls(net, orders, (first.knots, second.knots), (first.closed, second.closed))
        surface.fit = fit
        return surface

    @classmethod
    def interpolate(
        cls,
        points: ArrayLike,
        order: tuple[int, int] | None = None,
        *,
        degree: tuple[int, int] | None = None,
        vertices: tuple[int, int] | None = None,
        parameters: str | Both = "chord-length",
        per_point: bool = False,
        knots: str | Both = "averaged",
        closed: tuple[bool, bool] = (False, False),
    ) -> BSplineSurface:
        """The surface through a net of points, equation 6-83, or through scattered ones, with as many vertices.

        Parameters
        ----------
        points : array (r, s, 3), or (n, 3)
            The data; u goes along the first axis. A row whose points coincide is a pole. Scattered points (n, 3) need
            parameters for each and `vertices`, and are met only if they lie about as regularly as a net.
        order, degree : pair of int, optional
            The orders in u and in v, or the degrees, which are one less; cubic by default.
        parameters : "chord-length", "centripetal" or pair
            Of the data: shares of the chord length of the columns and rows, of the roots of the chords, from 0 to 1 or
            over the interval of knots that are given; or given: r and s numbers, or (r, s) for each point, and the
            surface runs from the least to the greatest. A closed direction has one more, which ends the period.
            Of scattered points: n numbers u and n numbers v, or "plane": their places in the plane nearest to them. The
            surface then runs from 0 to 1 if all lie there (a closed direction always), otherwise over all parameters.
        per_point : bool
            Whether each point has its own chord-length parameters, as the source prints them, in one system for all;
            otherwise the means over columns and rows, which gives two small systems.
        knots : "averaged", "uniform" or pair
            Means of neighbouring parameters, which always determine the surface; uniform ones as in the source, which
            do not where data are crowded; or given for u and v.
        closed : pair of bool
            Whether the points go round in u, and in v; the first is not repeated.
        vertices : pair of int
            Of scattered points: the numbers of vertices along u and v, together as many as points.

        Raises
        ------
        RsymError
            For data that do not determine the vertices: the vertex that has no datum of its own (Schoenberg-Whitney),
            or depends on others, is named; and for those that determine them too badly to be met.

        Examples
        --------
        >>> points = [[[i, j, i * i - j * j] for j in range(5)] for i in range(6)]
        >>> surface = BSplineSurface.interpolate(points)
        >>> surface.residual.maximum < 1e-13
        True
        """
        data = checked_points(points, "the points", scattered=True)
        if data.ndim == 2:
            counts = _all_vertices(vertices, len(data))
            spaces, found = spaces_for_scattered(
                data, counts, orders_of(order, degree), parameters, knots, closed, False
            )
            surface = cls._near_scattered(data, spaces, found, 0, (), 0.0)
            check_met(surface.residual, data)
            return surface
        if vertices is not None and pair_of(vertices, "vertices") != data.shape[:2]:
            raise RsymError(
                f"a surface through a net of {data.shape[0]} x {data.shape[1]} points has as many vertices, "
                f"got {vertices!r}",
                code="vertices",
                remedy="leave vertices out, or use least_squares",
            )
        spaces, found = spaces_for_data(
            data, data.shape[:2], orders_of(order, degree), parameters, per_point, knots, closed
        )
        net = fitted_net(spaces, data, found)
        residual = residual_of(spaces, net, data, found)
        check_met(residual, data)
        return cls._fitted(spaces, net, SplineFit(data, found, (residual,)))

    @classmethod
    def least_squares(
        cls,
        points: ArrayLike,
        vertices: tuple[int, int],
        order: tuple[int, int] | None = None,
        *,
        degree: tuple[int, int] | None = None,
        parameters: str | Both = "chord-length",
        per_point: bool = False,
        knots: str | Both = "averaged",
        closed: tuple[bool, bool] = (False, False),
        corrections: int = 0,
        kept: Sequence[tuple[Any, Any]] = (),
        smoothing: float = 0.0,
    ) -> BSplineSurface:
        """The surface with fewer vertices that passes a net of points, or scattered ones, nearest, equation 6-84.

        Parameters
        ----------
        points : array (r, s, 3), or (n, 3)
            The data. Scattered ones, (n, 3), in any order, need `parameters` for each.
        vertices : pair of int
            Their numbers n + 1 and m + 1. The fewer, the smoother.
        corrections : int
            Hoschek's corrections of the parameters, at most; afterwards each point has its own. `fit.history` tells
            the residual after each.
        kept : sequence of pairs
            Vertices, as an index into the net, and the plane or curve that they are kept on: ``(numpy.s_[0, :],
            Plane(point, normal))``, or a curve in any form that a patch takes.
        smoothing : float
            s in: mean square of the distances + s sum A_ij (|B_uu|^2 + 2 |B_uv|^2 + |B_vv|^2), the least of which is
            taken. The sum is no less than the thin-plate energy; parameters are brought to [0, 1], B_uu, ... are the
            vertices of second derivatives, A_ij the integrals of their basis functions. Small numbers such as 1e-6 fill
            the holes of scattered data; vertices may then be more than the data.

        Others as in `interpolate`.

        Examples
        --------
        >>> points = [[[i, j, i * i - j * j] for j in range(5)] for i in range(6)]
        >>> surface = BSplineSurface.least_squares(points, (4, 3), (4, 3), parameters=(range(6), range(5)))
        >>> surface.net.shape, surface.residual.maximum < 1e-13
        ((4, 3, 3), True)
        >>> u, v = np.random.default_rng(0).random((2, 200))
        >>> cloud = np.stack([u, v, u * v**2], axis=-1)
        >>> surface = BSplineSurface.least_squares(cloud, (6, 5), parameters=(u, v))
        >>> surface(0.5, 0.5).round(12).tolist(), surface.domain
        ([0.5, 0.5, 0.125], ((0.0, 1.0), (0.0, 1.0)))
        """
        data, orders = checked_points(points, "the points", scattered=True), orders_of(order, degree)
        share = checked_smoothing(smoothing)
        if data.ndim == 2:
            spaces, found = spaces_for_scattered(data, vertices, orders, parameters, knots, closed, share > 0)
            return cls._near_scattered(data, spaces, found, corrections, kept, share)
        spaces, found = spaces_for_data(data, vertices, orders, parameters, per_point, knots, closed)
        return cls._fitted(spaces, *approximated(spaces, data, found, corrections, kept, share))

    @classmethod
    def _near_scattered(
        cls,
        points: Floats,
        spaces: Spaces,
        parameters: Pair,
        corrections: Any,
        kept: Sequence[tuple[Any, Any]],
        smoothing: float,
    ) -> BSplineSurface:
        """The surface nearest to points (n, 3): they are a net of one column, each point with its own parameters."""
        u, v = (one[:, None] for one in parameters)
        net, fit = approximated(spaces, points[:, None], (u, v), corrections, kept, smoothing)
        history = tuple(replace(one, worst=one.worst[:1]) for one in fit.history)
        places = tuple(one[:, 0] for one in fit.parameters)
        return cls._fitted(spaces, net, SplineFit(points, places, history, fit.converged))

    @property
    def order(self) -> tuple[int, int]:
        """The orders (k, l)."""
        return self.spaces[0].degree + 1, self.spaces[1].degree + 1

    @property
    def degree(self) -> tuple[int, int]:
        """The degrees, one less than the orders."""
        return self.spaces[0].degree, self.spaces[1].degree

    @property
    def knots(self) -> Pair:
        """All knots of u and of v."""
        return self.spaces[0].knots, self.spaces[1].knots

    @property
    def domain(self) -> tuple[Interval, Interval]:
        """The intervals of u and v."""
        return self.spaces[0].domain, self.spaces[1].domain

    @property
    def closed(self) -> tuple[bool, bool]:
        """Whether the vertices go round in u, and in v."""
        return self.spaces[0].closed, self.spaces[1].closed

    @property
    def parameters(self) -> Pair:
        """Those of the data: of rows and columns, or of each point, (r, s) or (n,) both."""
        u, v = self._data().parameters
        return u, v

    @property
    def residual(self) -> Residual:
        """How far the surface passes from its data."""
        return self._data().residual

    def _data(self) -> SplineFit:
        if self.fit is None:
            raise RsymError(
                "this surface was made of vertices, not of data",
                code="no-data",
                remedy="BSplineSurface.interpolate(points)",
            )
        return self.fit

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives, by SciPy's B-splines: one direction after the other where u and v span a grid."""
        return [tensor_values(self.spaces, self.net, u, v, order) for order in orders]

    def _repr_latex_(self) -> str:
        """The sum for a notebook: as a polynomial of each span it would fill pages."""
        (n, m), (k, j) = self.net.shape[:2], self.order
        terms = rf"B_{{i,j}}\, N_{{i,{k}}}(u)\, M_{{j,{j}}}(v)"
        return rf"$\displaystyle p(u, v) = \sum_{{i=1}}^{{{n}}} \sum_{{j=1}}^{{{m}}} {terms}$"

    def expression(self) -> sp.ImmutableMatrix:
        """The point as SymPy expressions, piecewise where there are inner knots."""
        pieces = self.spaces[0].pieces * self.spaces[1].pieces
        if pieces > PIECES:
            raise RsymError(
                f"a formula of {pieces} polynomial pieces is of no use; the limit is {PIECES}",
                code="no-formula",
                remedy="fit with fewer vertices",
            )
        bases = [
            [entry.subs(symbols.t, letter) for entry in space.expressions()]
            for space, letter in zip(self.spaces, (symbols.u, symbols.v), strict=True)
        ]
        rows = [
            sum(
                (
                    n * sum((exact(x) * m for x, m in zip(line, bases[1], strict=True)), sp.S.Zero)
                    for n, line in zip(bases[0], self.net[:, :, axis], strict=True)
                ),
                sp.S.Zero,
            )
            for axis in range(3)
        ]
        return sp.ImmutableMatrix(rows)


def _all_vertices(vertices: Any, available: int) -> Both:
    """The numbers of vertices of a surface through scattered points."""
    counts = (0, 0) if vertices is None else pair_of(vertices, "vertices")
    if not all(isinstance(one, int | np.integer) for one in counts) or counts[0] * counts[1] != available:
        got = "none" if vertices is None else " x ".join(map(str, counts))
        raise RsymError(
            f"a surface through scattered points has as many vertices, {available} points, got {got}",
            code="vertices",
            remedy="vertices=(n, m) with that product, or least_squares with fewer",
        )
    return counts
