"""Surfaces of cardinal functions: through a family of curves, a grid of points, a network of both families.

A loft of curves r_0(u), ..., r_n(u) is P_v = sum_j phi_j(v) r_j(u), and only the cardinal functions phi_j differ
(Golovanov, 3.7.1 to 3.7.3); a grid of points is P_u P_v; Gordon's surface is P_u + P_v - P_u P_v.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.corrections import MEETING, Correction
from rsym.surfaces.functions.cardinals import (
    CubicCardinals,
    LagrangeCardinals,
    hermite_cardinals,
    lagrange_cardinals,
    named_cardinals,
    spline_cardinals,
)
from rsym.surfaces.functions.univariate import Constant, Stack
from rsym.surfaces.networks.curve_networks import Network, network, network_latex
from rsym.surfaces.networks.families import across, family
from rsym.surfaces.parameters import LetterValues, real_array
from rsym.surfaces.patch import Orders
from rsym.surfaces.transfinite import BooleanSum, Loft


class HermiteSurface(BooleanSum):
    """The C1 surface through curves that is a composite Hermite spline across them.

    p(u, v) = F0(w) r_j(u) + F1(w) r_(j+1)(u) + h_j (G0(w) q_j(u) + G1(w) q_(j+1)(u)) between the knots v_j and
    v_(j+1), with w = (v - v_j)/h_j and slopes q_j by differences of the neighbours; at the ends the third derivative in
    v vanishes. A curve shapes the surface as far as its second neighbours. Two curves give the ruled surface.

    Parameters
    ----------
    curves : sequence of curves
        Three SymPy expressions in one parameter, a function, points (n, 3), or a `Nurbs` each; all are brought to the
        interval of the first, which is that of u.
    knots : sequence of increasing numbers or "chord", optional
        Where in v the curves lie; 0, 1, 2, ... by default. "chord": as far apart as the curves are on the average.
    closed : bool
        Whether the first curve follows the last; then one more knot says where.
    letters : mapping, optional
        Symbols or names to numbers or `rsym.Letter`.

    Notes
    -----
    Golovanov, (3.7.1), for knots 0, 1, 2, ...; other knots are ours.

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> bowl = HermiteSurface([(t, y, t**2 + y**2) for y in (-1, 0, 1)], knots=(-1, 0, 1))
    >>> bowl(0.5, [0.0, 0.5]).tolist()
    [[0.5, 0.0, 0.25], [0.5, 0.5, 0.5]]
    """

    def __init__(
        self,
        curves: Sequence[Any],
        knots: Sequence[Any] | str | None = None,
        closed: bool = False,
        *,
        letters: Mapping[Any, Any] | None = None,
    ) -> None:
        self.curves: Stack = family(curves, letters, "the curve", least=3 if closed else 2)
        self.cardinals: CubicCardinals = hermite_cardinals(across(self.curves, knots, closed), closed=closed)
        super().__init__(along_v=Loft(self.cardinals, self.curves))

    def _repr_latex_(self) -> str:
        """The sum, its functions and curves by name; `expression` writes them out."""
        return _latex(self.curves, r"\varphi_j")


class SplineLoft(BooleanSum):
    """The C2 surface through curves that is a natural cubic spline across them, or a periodic one.

    The surface to take through many curves; every curve shapes all of it, the less the farther away.
    Parameters as of `HermiteSurface`. Golovanov, 3.7.2, allows such functions in place of Lagrange's.

    Examples
    --------
    >>> import numpy as np
    >>> from rsym.surfaces.symbols import t
    >>> angles = 2 * np.pi * np.arange(8) / 8
    >>> tube = SplineLoft([(2 * np.cos(a), 2 * np.sin(a), t) for a in angles], closed=True)
    >>> tube(0.5, 2).round(12).tolist(), tube.closed
    ([0.0, 2.0, 0.5], (False, True))
    """

    def __init__(
        self,
        curves: Sequence[Any],
        knots: Sequence[Any] | str | None = None,
        closed: bool = False,
        *,
        letters: Mapping[Any, Any] | None = None,
    ) -> None:
        self.curves: Stack = family(curves, letters, "the curve", least=3 if closed else 2)
        self.cardinals: CubicCardinals = spline_cardinals(across(self.curves, knots, closed), closed=closed)
        super().__init__(along_v=Loft(self.cardinals, self.curves))

    def _repr_latex_(self) -> str:
        """The sum, its functions and curves by name; `expression` writes them out."""
        return _latex(self.curves, r"\varphi_j")


class LagrangeSurface(BooleanSum):
    """The polynomial across its curves: p(u, v) = sum_j L_j(v) r_j(u).

    More than six curves swing, which is warned of: take `SplineLoft`. Curves, knots, letters as of `HermiteSurface`.
    Source: Golovanov, (3.7.2), for knots 0, 1, 2, ....

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> patch = LagrangeSurface([(t, 0, 0), (t, 1, t), (t, 2, 4 * t)])
    >>> patch.expression()[2].factor()
    u*v**2
    """

    def __init__(
        self,
        curves: Sequence[Any],
        knots: Sequence[Any] | str | None = None,
        *,
        letters: Mapping[Any, Any] | None = None,
    ) -> None:
        self.curves: Stack = family(curves, letters, "the curve")
        self.cardinals: LagrangeCardinals = lagrange_cardinals(across(self.curves, knots, False))
        super().__init__(along_v=Loft(self.cardinals, self.curves))

    def _repr_latex_(self) -> str:
        """The sum, its functions and curves by name; `expression` writes them out."""
        return _latex(self.curves, r"L_j")


def _latex(curves: Stack, function: str) -> str:
    return rf"$\displaystyle p(u, v) = \sum_{{j=0}}^{{{len(curves.curves) - 1}}} {function}(v)\, r_j(u)$"


class TensorProductSurface(BooleanSum):
    """The surface of bicubic Hermite patches through points p_ij: p(u, v) = sum_ij phi_i(u) psi_j(v) p_ij.

    phi and psi are the cardinal functions of composite Hermite splines: so p_u at a point is the Hermite slope along i,
    p_v along j, p_uv both (inside, for uniform knots, (p_(i+1)(j+1) - p_(i+1)(j-1) - p_(i-1)(j+1) + p_(i-1)(j-1))/4).
    C1; every point shapes the cells up to its second neighbours.

    Parameters
    ----------
    points : numbers (r, s, 3)
        Indices in u, then in v.
    u_knots, v_knots : sequences of increasing numbers, optional
        0, 1, 2, ... by default; of a closed direction one more, for the first row again.
    closed : pair of bool
        Whether the first row follows the last, in u and in v.
    cardinals : "hermite", "spline" or "lagrange"
        Other cardinal functions; with splines the surface is C2.

    Notes
    -----
    Golovanov, (3.7.9), for Hermite and knots 0, 1, 2, ...; the rest is ours.

    Examples
    --------
    >>> import numpy as np
    >>> x, y = np.meshgrid([0, 1, 2], [0, 1, 2, 3], indexing="ij")
    >>> patch = TensorProductSurface(np.stack([x, y, x**2 * y], axis=-1))
    >>> patch(0.5, [1.0, 1.5]).tolist(), patch.derivative(0, 0, (2, 1)).tolist()
    ([[0.5, 1.0, 0.25], [0.5, 1.5, 0.375]], [0.0, 0.0, 2.0])
    """

    def __init__(
        self,
        points: ArrayLike,
        u_knots: Sequence[Any] | None = None,
        v_knots: Sequence[Any] | None = None,
        *,
        closed: tuple[bool, bool] = (False, False),
        cardinals: str = "hermite",
    ) -> None:
        try:
            grid = np.array(real_array(points))
        except (TypeError, ValueError) as error:
            raise RsymError(
                "points are an array of real numbers (r, s, 3)", code="points", remedy="np.stack([x, y, z], axis=-1)"
            ) from error
        if grid.ndim != 3 or grid.shape[2] != 3 or min(grid.shape) < 2 or not np.isfinite(grid).all():
            raise RsymError(
                f"expected finite points of the shape (r, s, 3), r and s at least 2, got the shape {grid.shape}",
                code="points",
                remedy="np.stack([x, y, z], axis=-1) of three arrays (r, s)",
            )
        basis = []
        for count, given, ends, name in zip(grid.shape, (u_knots, v_knots), closed, "uv", strict=False):
            knots = range(count + ends) if given is None else given
            if len(knots) != count + ends:
                raise RsymError(
                    f"{count} rows of points in {name} need {count + ends} knots, got {len(knots)}",
                    code="knots",
                    remedy="one knot for each row; of a closed direction one more, for the first row again",
                )
            basis.append(named_cardinals(cardinals, knots, ends, name))
        super().__init__(corners=Constant(grid, basis[0].domain), basis=(basis[0], basis[1]))
        self.points = grid

    def _repr_latex_(self) -> str:
        """The sum, its functions and points by name; `expression` writes them out."""
        rows, columns, _ = self.points.shape
        sums = rf"\sum_{{i=0}}^{{{rows - 1}}} \sum_{{j=0}}^{{{columns - 1}}}"
        return rf"$\displaystyle p(u, v) = {sums} \varphi_i(u)\, \psi_j(v)\, p_{{ij}}$"


class GordonSurface(BooleanSum):
    """The surface through all curves of a network, r_j(u) and s_i(v), which meet in points p_ij.

    p(u, v) = sum_j psi_j(v) r_j(u) + sum_i phi_i(u) s_i(v) - sum_ij phi_i(u) psi_j(v) p_ij

    with cardinal functions phi_i, psi_j of the knots u_i, v_j. It is as smooth as they and the curves are. The formula
    holds only if every u-curve meets the v-curve i at the same parameter u_i, and alike in v; otherwise one family is
    missed. So the intersections are found first, and curves that do not fit are run through at another pace.

    Parameters
    ----------
    u_curves, v_curves : sequences of curves
        r_0, r_1, ... along u, in the order of v; s_0, s_1, ... along v, in the order of u. Three SymPy expressions in
        one parameter, a function, points (n, 3), or a `Nurbs` each; those of a family are brought to the interval of
        its first. One or two may be points: poles. What lies beyond the outermost curves is cut off.
    cardinals_u, cardinals_v : "auto", "lagrange", "hermite", "spline", or functions
        Functions: a `Curve` of shape (n,), or a tuple of expressions in t. "auto": Lagrange's polynomials up to six
        curves, natural cubic splines beyond, periodic ones for closed families.
    u_knots, v_knots : sequences of increasing numbers, optional
        The parameters u_i of the v-curves, v_j of the u-curves; by default the means of the curves' own.
    closed : pair of bool, optional
        Whether the surface closes in u, in v. By default it does where all curves along it close smoothly; a last curve
        across that is the first again is then left out. Three curves across are the least.
    reparametrise : "auto" or "refuse"
        What to do with curves that do not fit: r_j(f_j(u)) with an increasing cubic f_j that leads u_i to the curve's
        own parameter there, an exact composition: no curve is fitted. f_j is a C2 spline where that increases enough,
        and C1 (PCHIP) where the paces differ much. Or raise.
    tolerance : float
        By which share of the size of the network curves may miss one another, as measured ones do; v-curves are met all
        the same, u-curves are missed by about as much: `correction` tells.
    letters : mapping, optional
        Symbols or names to numbers or `rsym.Letter`; the intersections are found for the values given here.

    Raises
    ------
    RsymError
        If a pair of curves does not meet, meets more than once or out of order, or does not fit and must: the pair,
        the distance and the parameters are named.

    Notes
    -----
    Golovanov, (3.7.5); Gordon (1969). Reparametrisation, closed families and poles are ours.

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> along = [(t, y, t * y) for y in (0, 1, 2)]
    >>> over = [(x, 2 * t, 2 * x * t) for x in (0, 1)]     # another pace: v_j = 0, 1/2, 1
    >>> patch = GordonSurface(along, over)
    >>> patch.network.v_knots, patch(0.5, 0.75).tolist()
    ((0.0, 0.5, 1.0), [0.5, 1.5, 0.75])
    """

    def __init__(
        self,
        u_curves: Sequence[Any],
        v_curves: Sequence[Any],
        *,
        cardinals_u: Any = "auto",
        cardinals_v: Any = "auto",
        u_knots: Sequence[Any] | None = None,
        v_knots: Sequence[Any] | None = None,
        closed: tuple[bool, bool] | None = None,
        reparametrise: str = "auto",
        tolerance: float = MEETING,
        letters: Mapping[Any, Any] | None = None,
    ) -> None:
        self.network: Network = network(
            u_curves,
            v_curves,
            u_knots=u_knots,
            v_knots=v_knots,
            closed=closed,
            reparametrise=reparametrise,
            tolerance=tolerance,
            letters=letters,
        )
        net = self.network
        of_u = named_cardinals(cardinals_u, net.u_knots, net.closed[0], "u")
        of_v = named_cardinals(cardinals_v, net.v_knots, net.closed[1], "v")
        super().__init__(Loft(of_u, net.v_curves), Loft(of_v, net.u_curves), net.points)

    @cached_property
    def correction(self) -> Correction:
        """The greatest gap of the curves, and how far the surface passes from the u-curves; at the defaults of letters.

        It holds the v-curves. Curves of another pace count as they are run through here.
        """
        functions, _ = self.basis
        assert functions is not None
        return self.network.correction(functions)

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        if letters:
            self.network.check(self.letters.values_with(letters))
        return super().evaluate(u, v, orders, letters)

    def _repr_latex_(self) -> str:
        """The three sums, their functions and curves by name; `expression` writes them out."""
        return f"$\\displaystyle {network_latex(self.network)}$"
