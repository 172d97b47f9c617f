"""Patches cut along lines of constant parameter, such as the knots of splines."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters
from rsym.surfaces.bsplines.spline_surfaces import BSplineSurface
from rsym.surfaces.parameters import Interval, LetterValues
from rsym.surfaces.patch import Domain, Orders, Patch, patches_of


class PatchPiece(Patch):
    """A patch over a smaller rectangle; on its edges its derivatives are those from inside.

    Examples
    --------
    >>> from rsym.surfaces.parametric import ParametricSurface
    >>> from rsym.surfaces.symbols import u, v
    >>> kinked = ParametricSurface((u, v, sp.Piecewise((0, u < 1), (u - 1, True))), ((0, 2), (0, 1)))
    >>> [PatchPiece(kinked, (part, (0, 1))).derivative(1, 0).tolist() for part in ((0, 1), (1, 2))]
    [[1.0, 0.0, 0.0], [1.0, 0.0, 1.0]]
    """

    def __init__(self, patch: Patch, domain: Domain) -> None:
        (patch,) = patches_of([patch])
        self.patch: Patch = patch.patch if isinstance(patch, PatchPiece) else patch
        try:
            inside = [(float(low), float(high)) for low, high in domain]
        except (TypeError, ValueError) as error:
            raise RsymError(
                f"a domain is two intervals, got {domain!r}", code="domain", remedy="for example ((0, 1), (0, 0.5))"
            ) from error
        self._domain = (inside[0], inside[1])
        for (low, high), (start, stop), name in zip(inside, patch.domain, "uv", strict=True):
            if not start <= low < high <= stop:
                raise RsymError(
                    f"{name} of a piece must lie in [{start:g}, {stop:g}], got [{low:g}, {high:g}]",
                    code="domain",
                    remedy="cut inside the domain of the patch",
                )

    @property
    def domain(self) -> Domain:
        """The intervals of u and v."""
        return self._domain

    @property
    def letters(self) -> Letters:
        """Those of the whole."""
        return self.patch.letters

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders; at an upper end that of the whole does not share, from just below it."""
        ends = zip((u, v), self._domain, self.patch.domain, strict=True)
        below = [
            places if own[1] == whole[1] else np.minimum(places, np.nextafter(own[1], own[0]))
            for places, own, whole in ends
        ]
        return self.patch.evaluate(below[0], below[1], orders, letters)

    def expression(self) -> sp.ImmutableMatrix:
        """The formula of the whole."""
        return self.patch.expression()


def split_patch(patch: Patch, u: Sequence[float] | None = None, v: Sequence[float] | None = None) -> list[PatchPiece]:
    """The pieces of a patch between lines u = const and v = const; by default the inner knots of a B-spline surface.

    `continuity_report` of them tells how smooth the patch is across those lines.

    Examples
    --------
    >>> import numpy as np
    >>> net = np.stack([*np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij"), np.zeros((5, 4))], -1)
    >>> [piece.domain for piece in split_patch(BSplineSurface(net))]
    [((0.0, 0.5), (0.0, 1.0)), ((0.5, 1.0), (0.0, 1.0))]
    """
    (patch,) = patches_of([patch])
    rows, columns = (_intervals(patch, given, axis) for axis, given in enumerate((u, v)))
    return [PatchPiece(patch, (row, column)) for row in rows for column in columns]


def _intervals(patch: Patch, given: Sequence[float] | None, axis: int) -> list[Interval]:
    low, high = patch.domain[axis]
    inner = given if given is not None else patch.knots[axis] if isinstance(patch, BSplineSurface) else ()
    return [*pairwise(sorted({low, high, *(float(one) for one in inner if low < one < high)}))]
