"""Gregory's square: ribbons that disagree on the twist at a corner are both kept.

T_ij(u, v) = [a d/dv p_u(i, v) + b d/du p_v(u, j)]/(a + b), with a the distance from the edge u = i and b that from
v = j, stands in the place of the twist at the corner (i, j). On either edge it is the derivative of that edge's
ribbon, so no ribbon is bent; at the corner itself it has no value, and the mean is taken (Gregory 1974).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.surfaces import symbols
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.corners import CornerData
from rsym.surfaces.corrections import MEETING
from rsym.surfaces.functions.entries import entries_of
from rsym.surfaces.functions.formulas import CompiledFormulas
from rsym.surfaces.patch import LetterValues, Orders


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
        return [np.add.reduce([part[k][..., None] * jumps[k] for k in range(4)]) for part in parts]

    def expression(self) -> sp.ImmutableMatrix:
        """The correction as expressions in u, v and the letters."""
        by_u, by_v = self.corners.by_u.expressions(), self.corners.by_v.expressions()
        jumps = sp.permutedims(by_u, (1, 0, 2)) - by_v
        entries = [entries_of(jumps[2 + i, 2 + j]) for i in (0, 1) for j in (0, 1)]
        return sp.ImmutableMatrix(
            [sum((w * e[c] for w, e in zip(self.weights, entries, strict=True)), sp.S.Zero) for c in range(3)]
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


def _weight(blend_u: HermiteBlend, blend_v: HermiteBlend, i: int, j: int) -> sp.Expr:
    """-G_i(u) G_j(v) (a - b)/(2(a + b)): T - mean is that share of the difference of the twists."""
    a = symbols.u if i == 0 else 1 - symbols.u
    b = symbols.v if j == 0 else 1 - symbols.v
    share = sp.Piecewise(((a - b) / (2 * (a + b)), a + b > 0), (0, True))
    g, h = blend_u.functions[2 + i].subs(symbols.t, symbols.u), blend_v.functions[2 + j].subs(symbols.t, symbols.v)
    return -g * h * share
