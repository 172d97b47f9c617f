"""Corner data of a patch: what its edges say there, and whether they agree.

With k derivatives across u and l across v, entry (k, i), (l, j) is d^(k+l)p/du^k dv^l at the corner (i, j). The
edges u = i know it as the l-th derivative of their ribbon of order k, the edges v = j the other way round.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.corrections import Correction, enough, greatest, sizes
from rsym.surfaces.functions.entries import entries_of
from rsym.surfaces.functions.univariate import LetterValues, Sampled, Univariate, Unvarying

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
        return sp.ImmutableDenseNDimArray([_mean(a, b) for a, b in pairs], self.shape)

    def check(self, tolerance: float, letters: LetterValues = None) -> None:
        """Refuse points and tangents at corners on which the edges do not agree."""
        by_u, by_v = self.both(letters)
        size = max(float(np.ptp(by_u[:2, :2], axis=(0, 1)).max()), float(np.abs(by_u[:2, :2]).max()) * 1e-6)
        _, orders = ends(self.shape[0] // 2)
        shares = np.zeros(self.shape[:2])
        for a, b in self._single(orders):
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
                away, (along,) = greatest(partial(_distance, functions, data), functions.domain)
                found.append((away, (float(end), along) if across == 0 else (along, float(end))))
        return Correction(gap, *max(found))

    def _single(self, orders: Sequence[int]) -> Iterator[tuple[int, int]]:
        """The places of points and of derivatives in one parameter alone: twists are another matter."""
        return ((a, b) for a, k in enumerate(orders) for b, j in enumerate(orders) if not k * j)

    def twist_gap(self) -> float:
        """The largest distance between what both pairs of edges say of a mixed derivative."""
        by_u, by_v = self.both()
        return float(np.sqrt(((by_u - by_v)[2:, 2:] ** 2).sum(axis=-1)).max(initial=0.0))


def _mean(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return a if a == b else (a + b) / 2


def _distance(functions: Univariate, data: Floats, t: Floats) -> Floats:
    return sizes(functions(t) @ data)


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
        f"{first} is {_point(by_u)} and {second} is {_point(by_v)}: a gap of {float(sizes(by_u - by_v)):.3g}",
        code="corner",
        where=f"corner ({i}, {j})",
        remedy=f"{mend}, or blend the gaps in: tolerance={enough(share)}" if np.isfinite(share) else mend,
    )


def _point(values: Floats) -> str:
    return f"({', '.join(f'{value:.6g}' for value in values)})"
