"""Corner data of a patch: what its edges say there, whether they agree, and what is done about twists if they do not.

With k derivatives across u and l across v, entry (k, i), (l, j) is d^(k+l)p/du^k dv^l at the corner (i, j). The
edges u = i know it as the l-th derivative of their ribbon of order k, the edges v = j the other way round.

Gregory's square keeps both where ribbons disagree on the twist at a corner:
T_ij(u, v) = [a d/dv p_u(i, v) + b d/du p_v(u, j)]/(a + b), with a the distance from the edge u = i and b that from
v = j, stands in its place. On either edge it is the derivative of that edge's ribbon, so no ribbon is bent; at the
corner itself it has no value, and the mean is taken (Gregory 1974).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.reports.numbers import point
from rsym.surfaces import symbols
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.corrections import MEETING, Correction, enough, longest, sizes
from rsym.surfaces.functions.formulas import CompiledFormulas, entries_of
from rsym.surfaces.functions.univariate import Sampled, Univariate, Unvarying
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.patch import Orders

WORDS = ("point", "first derivative", "second derivative")


def ends(order: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The place and the order of derivative of each function of a class: 0, 1, 0, 1, ... and 0, 0, 1, 1, ..."""
    return (0, 1) * order, tuple(k for k in range(order) for _ in (0, 1))


class CornerData(Unvarying):
    """The corner data (n, n, 3) of ribbons C (n, 3) of v and E (n, 3) of u; twists are the mean of what both say."""

    def __init__(self, across_u: Univariate, across_v: Univariate) -> None:
        size = across_u.shape[0]
        places, orders = ends(size // 2)
        self.by_v = Sampled(across_v, places, orders)  # indices [a, b]
        self.by_u = Sampled(across_u, places, orders)  # indices [b, a]
        self.shape = (size, size, 3)
        self.domain = across_u.domain
        self.letters = self.by_v.letters.merge(self.by_u.letters)

    def both(self, letters: LetterValues = None) -> tuple[Floats, Floats]:
        """The data [a, b] by the edges u = 0, 1 and by the edges v = 0, 1."""
        return np.swapaxes(self.by_u.value(letters), 0, 1), self.by_v.value(letters)

    def value(self, letters: LetterValues = None) -> Floats:
        """The data."""
        by_u, by_v = self.both(letters)
        # Half of each, so that two infinite tangents do not make a NaN.
        return np.where(by_u == by_v, by_v, by_u / 2 + by_v / 2)

    @property
    def is_smooth_formula(self) -> bool:
        """Whether the ribbons are."""
        return self.by_u.is_smooth_formula and self.by_v.is_smooth_formula

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The data, if the ribbons are formulas."""
        by_u, by_v = self.by_u.expressions(), self.by_v.expressions()
        if by_u is None or by_v is None:
            return None
        turned = sp.permutedims(by_u, (1, 0, 2))
        pairs = zip(entries_of(turned), entries_of(by_v), strict=True)
        return sp.ImmutableDenseNDimArray([a if a == b else (a + b) / 2 for a, b in pairs], self.shape)

    def check(self, tolerance: float, letters: LetterValues = None) -> None:
        """Refuse points and tangents at corners on which the edges do not agree."""
        by_u, by_v = self.both(letters)
        size = max(float(np.ptp(by_u[:2, :2], axis=(0, 1)).max()), float(np.abs(by_u[:2, :2]).max()) * 1e-6)
        _, orders = ends(self.shape[0] // 2)
        shares = np.zeros(self.shape[:2])
        # Of points and of derivatives in one parameter alone: twists are another matter.
        for a, b in np.argwhere(np.outer(orders, orders) == 0).tolist():
            gap = float(sizes(by_u[a, b] - by_v[a, b]))
            shares[a, b] = gap / max(size, float(np.abs(by_u[a, b]).max()))
            shares[a, b] = np.inf if np.isnan(shares[a, b]) else shares[a, b]
        for a, b in np.argwhere(shares > tolerance).tolist():
            raise _disagreement(a % 2, b % 2, (orders[a], orders[b]), by_u[a, b], by_v[a, b], float(shares.max()))

    def correction(self, functions_u: Univariate, functions_v: Univariate) -> Correction:
        """How far the edges of the Boolean sum are from those given: it holds the mean at each corner.

        On the edge u = i that is sum_b g_b(v) (M - by_u)[i, b], on v = j alike. Functions are those that blend in u
        and in v.
        """
        by_u, by_v = self.both()
        gap = float(sizes((by_u - by_v)[:2, :2]).max())
        if (by_u == by_v).all():
            return Correction(0.0, 0.0, (0.0, 0.0))
        missed = np.where(by_u == by_v, 0.0, by_v / 2 - by_u / 2)
        found = []
        for end in (0, 1):
            for across, data, functions in ((0, missed[end], functions_v), (1, missed[:, end], functions_u)):
                away, along = longest(functions, data)
                found.append((away, (float(end), along) if across == 0 else (along, float(end))))
        return Correction(gap, *max(found))

    def twist_gap(self) -> float:
        """The largest distance between what both pairs of edges say of a mixed derivative."""
        by_u, by_v = self.both()
        return float(np.sqrt(((by_u - by_v)[2:, 2:] ** 2).sum(axis=-1)).max(initial=0.0))


def _disagreement(i: int, j: int, order: tuple[int, int], by_u: Floats, by_v: Floats, share: float) -> RsymError:
    """The error of edges that do not meet at the corner (i, j), or of a ribbon that is not tangent to an edge there."""
    across, along = order
    mend = "make the ribbon agree with the edge that it ends on" if across or along else "make the edges meet there"
    if not across and not along:
        first, second = f"the edge u{i} at v = {j}", f"the edge v{j} at u = {i}"
    elif across:
        first, second = f"the {WORDS[across]} across the edge u{i} at v = {j}", f"that along the edge v{j} at u = {i}"
    else:
        first, second = f"the {WORDS[along]} along the edge u{i} at v = {j}", f"that across the edge v{j} at u = {i}"
    return RsymError(
        f"{first} is {point(by_u, 6)} and {second} is {point(by_v, 6)}: a gap of {float(sizes(by_u - by_v)):.3g}",
        code="corner",
        where=f"corner ({i}, {j})",
        remedy=f"{mend}, or blend the gaps in: tolerance={enough(share)}" if np.isfinite(share) else mend,
    )


def gregory_of(
    corners: str, data: CornerData, blends: tuple[HermiteBlend, HermiteBlend], tolerance: float
) -> Gregory | None:
    """The correction for twists on which the edges disagree, if there is one."""
    if corners not in ("mean", "gregory", "refuse"):
        raise RsymError(f"corners is mean, gregory or refuse, got {corners!r}", code="corner")
    gap = data.twist_gap()
    size = float(np.ptp(data.both()[0][:2, :2], axis=(0, 1)).max())
    if corners == "mean" or gap <= (tolerance if corners == "refuse" else MEETING) * size:
        return None
    if corners == "refuse" or blends[0].order == 3:
        raise RsymError(
            f"the edges disagree by {gap:.3g} on the mixed derivatives at a corner",
            code="twist",
            remedy='corners="gregory" (class 2) keeps both, corners="mean" takes the mean',
        )
    return Gregory(*blends, data)


class Gregory:
    """What has to be added to a patch with mean twists: -sum_ij G_i(u) G_j(v) (T_ij - mean)."""

    def __init__(self, blend_u: HermiteBlend, blend_v: HermiteBlend, corners: CornerData) -> None:
        self.corners = corners
        self.letters: Letters = blend_u.letters.merge(blend_v.letters)
        self.weights = [_weight(blend_u, blend_v, i, j) for i in (0, 1) for j in (0, 1)]

    @cached_property
    def _compiled(self) -> CompiledFormulas:
        return CompiledFormulas(self.weights, ("u", "v"), self.letters, ((0.0, 1.0), (0.0, 1.0)))

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues) -> list[Floats]:
        """The derivatives (..., 3) of these orders; `letters` holds them all."""
        by_u, by_v = self.corners.both(letters)
        jumps = (by_u - by_v)[2:, 2:].reshape(4, 3)
        values = {name: (letters or {})[name] for name in self.letters}
        parts = self._compiled.evaluate([u, v], orders, values)
        return [np.add.reduce([part[..., k, None] * jumps[k] for k in range(4)]) for part in parts]

    def expression(self) -> sp.ImmutableMatrix:
        """The correction as expressions in u, v and the letters."""
        by_u, by_v = self.corners.by_u.expressions(), self.corners.by_v.expressions()
        jumps = sp.permutedims(by_u, (1, 0, 2)) - by_v
        entries = [entries_of(jumps[2 + i, 2 + j]) for i in (0, 1) for j in (0, 1)]
        return sp.ImmutableMatrix(
            [sum((w * e[c] for w, e in zip(self.weights, entries, strict=True)), sp.S.Zero) for c in range(3)]
        )


def _weight(blend_u: HermiteBlend, blend_v: HermiteBlend, i: int, j: int) -> sp.Expr:
    """-G_i(u) G_j(v) (a - b)/(2(a + b)): T - mean is that share of the difference of the twists."""
    a = symbols.u if i == 0 else 1 - symbols.u
    b = symbols.v if j == 0 else 1 - symbols.v
    share = sp.Piecewise(((a - b) / (2 * (a + b)), a + b > 0), (0, True))
    g, h = blend_u.functions[2 + i].subs(symbols.t, symbols.u), blend_v.functions[2 + j].subs(symbols.t, symbols.v)
    return -g * h * share
