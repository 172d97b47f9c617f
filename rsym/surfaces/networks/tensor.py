"""The tensor product surface of a grid of points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rsym.errors import RsymError
from rsym.surfaces.functions.cardinals import named_cardinals
from rsym.surfaces.functions.univariate import Constant
from rsym.surfaces.parameters import real_array
from rsym.surfaces.transfinite import BooleanSum


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
