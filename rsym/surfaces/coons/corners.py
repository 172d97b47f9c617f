"""Corner data of a patch: what its edges say there, and whether they agree.

With k derivatives across u and l across v, entry (k, i), (l, j) is d^(k+l)p/du^k dv^l at the corner (i, j). The
edges u = i know it as the l-th derivative of their ribbon of order k, the edges v = j the other way round.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.surfaces.functions.entries import entries_of
from rsym.surfaces.functions.univariate import Curve, LetterValues, Sampled, Unvarying

Array: TypeAlias = NDArray[np.float64]

# Share of the size of the patch by which edges may miss one another at a corner: rounding of data given to nine digits.
AGREEMENT = 1e-9
WORDS = ("point", "first derivative", "second derivative")


def ends(order: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The place and the order of derivative of each function of a class: 0, 1, 0, 1, ... and 0, 0, 1, 1, ..."""
    return (0, 1) * order, tuple(k for k in range(order) for _ in (0, 1))


class Corners(Unvarying):
    """The corner data (n, n, 3) of ribbons C (n, 3) of v and E (n, 3) of u; twists are the mean of what both say."""

    def __init__(self, across_u: Curve, across_v: Curve) -> None:
        size = across_u.shape[0]
        places, orders = ends(size // 2)
        self.by_v = Sampled(across_v, places, orders)  # indices [a, b]
        self.by_u = Sampled(across_u, places, orders)  # indices [b, a]
        self.shape = (size, size, 3)
        self.domain = across_u.domain
        self.letters = self.by_v.letters.merge(self.by_u.letters)

    def both(self, letters: LetterValues = None) -> tuple[Array, Array]:
        """The data [a, b] by the edges u = 0, 1 and by the edges v = 0, 1."""
        return np.swapaxes(self.by_u.value(letters), 0, 1), self.by_v.value(letters)

    def value(self, letters: LetterValues = None) -> Array:
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

    def check(self) -> None:
        """Refuse points and tangents at corners on which the edges do not agree."""
        by_u, by_v = self.both()
        size = max(float(np.ptp(by_u[:2, :2], axis=(0, 1)).max()), float(np.abs(by_u[:2, :2]).max()) * 1e-6)
        _, orders = ends(self.shape[0] // 2)
        for a, k in enumerate(orders):
            for b, j in enumerate(orders):
                gap = float(np.sqrt(((by_u[a, b] - by_v[a, b]) ** 2).sum()))
                scale = max(size, float(np.abs(by_u[a, b]).max()))
                if not k * j and not gap <= AGREEMENT * scale:
                    raise _disagreement(a % 2, b % 2, (k, j), gap, by_u[a, b], by_v[a, b])

    def twist_gap(self) -> float:
        """The largest distance between what both pairs of edges say of a mixed derivative."""
        by_u, by_v = self.both()
        return float(np.sqrt(((by_u - by_v)[2:, 2:] ** 2).sum(axis=-1)).max(initial=0.0))


def _mean(a: sp.Expr, b: sp.Expr) -> sp.Expr:
    return a if a == b else (a + b) / 2


def _disagreement(i: int, j: int, order: tuple[int, int], gap: float, by_u: Array, by_v: Array) -> RsymError:
    """The error of edges that do not meet at the corner (i, j), or of a ribbon that is not tangent to an edge there."""
    across, along = order
    if not across and not along:
        first, second = f"the edge u{i} at v = {j}", f"the edge v{j} at u = {i}"
    elif across:
        first, second = f"the {WORDS[across]} across the edge u{i} at v = {j}", f"that along the edge v{j} at u = {i}"
    else:
        first, second = f"the {WORDS[along]} along the edge u{i} at v = {j}", f"that across the edge v{j} at u = {i}"
    return RsymError(
        f"{first} is {_point(by_u)} and {second} is {_point(by_v)}: a gap of {gap:.3g}",
        code="corner",
        where=f"corner ({i}, {j})",
        remedy="make the edges meet there"
        if not across and not along
        else "make the ribbon agree with the edge that it ends on",
    )


def _point(values: Array) -> str:
    return f"({', '.join(f'{value:.6g}' for value in values)})"
