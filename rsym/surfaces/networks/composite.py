"""The composite Coons surface: a cubic Coons patch in every cell of a network of curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.corrections import MEETING, Correction
from rsym.surfaces.functions.cardinals import CubicCardinals, SlopeFunctions, hermite_cardinals
from rsym.surfaces.functions.univariate import Constant, Sampled, Unvarying
from rsym.surfaces.networks.curve_networks import Network, network, network_latex
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Orders
from rsym.surfaces.transfinite import BooleanSum, Loft

Entries: TypeAlias = NDArray[Any]


class CompositeCoons(BooleanSum):
    """The C1 surface of cubic Coons patches, one in every cell of a network; local, unlike `GordonSurface`.

    In the cell (i, j), with t = (u - u_i)/h_i, w = (v - v_j)/k_j and A = (F0, F1, h G0, h G1) of the cubic blend,

        p(u, v) = A(t) . (s_i, s_(i+1), D_i, D_(i+1))(v) + (r_j, r_(j+1), E_j, E_(j+1))(u) . A(w) - A(t) . M A(w);

    the ribbons D_i(v), E_j(u) are the slopes of composite Hermite splines across the curves (`HermiteSurface`). M holds
    the points p_ij, the tangents of the ribbons D_i(v_j), E_j(u_i), and twists. The network is interpolated and the
    surface is C1 for any twists.

    Parameters
    ----------
    u_curves, v_curves, u_knots, v_knots, closed, reparametrise, tolerance, letters
        As of `GordonSurface`.
    twists : "mean", "zero" or numbers (number of v-curves, number of u-curves, 3)
        The twists in M; by default the means (D_i'(v_j) + E_j'(u_i))/2 of what the ribbons say. The surface itself has
        p_uv = D_i'(v_j) + E_j'(u_i) - twist there: with the default the same mean, with zero their sum.

    Notes
    -----
    Golovanov, (3.7.6) to (3.7.8), for knots 0, 1, 2, .... The twists, the proof that tangents of the ribbons (and not
    those of the curves) make it interpolate, other knots and closed families by cyclic slopes are ours. It is computed
    as one Boolean sum with the cardinal functions phi, psi of those splines and their slope functions beta, gamma,

        sum psi_j r_j + sum phi_i s_i - sum phi_i psi_j p_ij - sum beta_i gamma_j (twist_ij - (p_uv of the third sum)).

    Examples
    --------
    >>> from rsym.surfaces.symbols import t
    >>> from rsym.surfaces.functions.univariate import Formula
    >>> along = [Formula((t, y, t * y), domain=(0, 2)) for y in (0, 1, 2)]
    >>> over = [Formula((x, t, x * t), domain=(0, 2)) for x in (0, 1, 2)]
    >>> patch = CompositeCoons(along, over)
    >>> patch(0.5, 1.25).tolist(), patch.derivative(1, 1, (1, 1)).tolist()
    ([0.5, 1.25, 0.625], [0.0, 0.0, 1.0])
    """

    def __init__(
        self,
        u_curves: Sequence[Any],
        v_curves: Sequence[Any],
        *,
        twists: Any = "mean",
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
        round_u, round_v = net.closed
        of_u = hermite_cardinals(net.u_knots, closed=round_u)
        of_v = hermite_cardinals(net.v_knots, closed=round_v)
        super().__init__(Loft(of_u, net.v_curves), Loft(of_v, net.u_curves), net.points)
        slopes = SlopeFunctions(net.u_knots, closed=round_u), SlopeFunctions(net.v_knots, closed=round_v)
        correction = TwistCorrection(net, of_u, of_v, twists)
        correction.check()
        self._correction = BooleanSum(corners=correction, basis=slopes)

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
        parts = super().evaluate(u, v, orders, letters)
        more = self._correction.evaluate(u, v, orders, letters)
        return [part - extra for part, extra in zip(parts, more, strict=True)]

    def expression(self) -> sp.ImmutableMatrix:
        """The point as expressions in u, v and the letters."""
        return super().expression() - self._correction.expression()

    def _repr_latex_(self) -> str:
        """The sums, their functions and curves by name; `expression` writes them out."""
        twists = r"\sum_i \sum_j \beta_i(u)\, \gamma_j(v) (\tau_{ij} - \tau^0_{ij})"
        return rf"$\displaystyle {network_latex(self.network)} - {twists}$"


class TwistCorrection(Unvarying):
    """Twists less those of the tensor product of the points, as a constant (number of v-curves, of u-curves, 3)."""

    def __init__(self, net: Network, of_u: CubicCardinals, of_v: CubicCardinals, twists: Any) -> None:
        self.shape, self.domain = (of_u.count, of_v.count, 3), of_u.domain
        self.of_u, self.of_v = of_u, of_v
        self.points = net.points
        self.along = Sampled(net.u_curves, net.u_knots[: of_u.count], (1,) * of_u.count)  # r_j'(u_i), [i, j]
        self.over = Sampled(net.v_curves, net.v_knots[: of_v.count], (1,) * of_v.count)  # s_i'(v_j), [j, i]
        self.letters = net.points.letters.merge(self.along.letters).merge(self.over.letters)
        self.given = None if isinstance(twists, str) and twists == "mean" else _given(twists, self.shape)

    def value(self, letters: LetterValues = None) -> Floats:
        """The numbers."""
        p, r_u, s_v = (one.at_start(letters) for one in (self.points, self.along, self.over))
        given = None if self.given is None else self.given.values
        return _combined(p, r_u, s_v, self.of_u.slopes, self.of_v.slopes, given)

    def check(self) -> None:
        """Refuse curves that are infinitely fast at a point of the network."""
        if self.given is not None:
            return
        for curves, name, other in ((self.along, "u", "v"), (self.over, "v", "u")):
            wrong = np.argwhere(~np.isfinite(curves(curves.domain[0])).all(axis=-1))
            if len(wrong):
                across, own = map(int, wrong[0])
                raise RsymError(
                    f"the {name}-curve {own} has no finite tangent where it meets the {other}-curve {across}",
                    code="twist",
                    where=f"the {name}-curve {own} at {name} = {curves.places[across]:.6g}",
                    remedy='write it in another parameter, or give twists, such as twists="zero"',
                )

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The numbers, if the curves are formulas."""
        parts = [one.expressions() for one in (self.points, self.along, self.over)]
        if any(part is None for part in parts):
            return None
        slopes = [one.exact_slopes() for one in (self.of_u, self.of_v)]
        p, r_u, s_v, in_u, in_v = (np.array(one.tolist(), dtype=object) for one in (*parts, *slopes))
        given = None if self.given is None else np.array(self.given.expressions().tolist(), dtype=object)
        return sp.ImmutableDenseNDimArray(_combined(p, r_u, s_v, in_u, in_v, given).tolist())


def _combined(p: Entries, r_u: Entries, s_v: Entries, in_u: Entries, in_v: Entries, given: Entries | None) -> Entries:
    """Twists minus p_uv of the tensor product of the points p, in the arithmetic of the arrays.

    r_u holds the tangents of the u-curves, [i, j], s_v those of the v-curves, [j, i]; in_u, in_v take values to slopes.
    """

    def along_v(values: Entries) -> Entries:
        return np.tensordot(in_v, values.swapaxes(0, 1), 1).swapaxes(0, 1)

    of_points = along_v(np.tensordot(in_u, p, 1))
    twists = (np.tensordot(in_u, s_v.swapaxes(0, 1), 1) + along_v(r_u)) / 2 if given is None else given
    return np.asarray(twists - of_points)


def _given(twists: Any, shape: tuple[int, ...]) -> Constant:
    if isinstance(twists, str):
        if twists == "zero":
            return Constant(np.zeros(shape))
        raise RsymError(f"twists are mean, zero or numbers, got {twists!r}", code="twist", remedy='twists="mean"')
    data = Constant(twists)
    if data.shape != shape or not np.isfinite(data.values).all():
        raise RsymError(
            f"twists are finite numbers of the shape {shape} (v-curves, u-curves, 3), got the shape {data.shape}",
            code="twist",
            remedy="one vector for each point of the network",
        )
    return data
