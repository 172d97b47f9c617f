"""Surfaces through a family of curves r_0(u), ..., r_n(u): p(u, v) = sum_j phi_j(v) r_j(u).

Only the cardinal functions phi_j differ (Golovanov, 3.7.1 to 3.7.3).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rsym.surfaces.functions.cardinals import (
    CubicCardinals,
    LagrangeCardinals,
    hermite_cardinals,
    lagrange_cardinals,
    spline_cardinals,
)
from rsym.surfaces.functions.univariate import Stack
from rsym.surfaces.networks.families import across, family
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
