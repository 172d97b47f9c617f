"""Gordon's surface through a network of curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from rsym.arrays import Floats
from rsym.surfaces.corrections import MEETING, Correction
from rsym.surfaces.functions.cardinals import named_cardinals
from rsym.surfaces.networks.curve_networks import Network, network, network_latex
from rsym.surfaces.patch import LetterValues, Orders
from rsym.surfaces.transfinite import BooleanSum, Loft


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
