"""Spline curves through points or nearest to them."""

from __future__ import annotations

from typing import Any

from rsym.arrays import Floats
from rsym.surfaces.bsplines.band_qr import DEPENDENT, BandQR
from rsym.surfaces.bsplines.bspline_data import space_along
from rsym.surfaces.bsplines.bspline_fitting import SplineFit, check_met, check_near, residual_at, singular, undetermined
from rsym.surfaces.bsplines.spline_knots import are_settled, check_data
from rsym.surfaces.bsplines.spline_spaces import SplineSpace


def fitted_curve(
    points: Floats, vertices: Any, order: Any, parameters: Any, knots: Any, closed: bool
) -> tuple[SplineSpace, Floats, SplineFit]:
    """The space, the vertices and the fit of the spline curve nearest to points (n, 3); through them for n vertices.

    Examples
    --------
    >>> import numpy as np
    >>> points = np.array([[0.0, 0, 0], [1, 1, 0], [2, 4, 0], [3, 9, 0]])
    >>> space, vertices, fit = fitted_curve(points, 3, 3, range(4), "averaged", False)
    >>> (vertices.round(9) + 0.0).tolist(), fit.residual.maximum < 1e-14
    ([[0.0, 0.0, 0.0], [1.5, 0.0, 0.0], [3.0, 9.0, 0.0]], True)
    """
    space, t = space_along(points[:, None, :], 0, "t", vertices, order, parameters, False, knots, closed)
    t = t.reshape(-1)
    check_data(t, space, "t")
    settled = are_settled(t, space)
    system = BandQR(space.matrix(t), 0.0 if settled else DEPENDENT)
    dependent = system.dependent if settled else undetermined(system)
    if dependent is not None:
        raise singular((space,), f"the vertex {dependent} along t")
    found = system.solve(points)
    check_near(found, points)
    residual = residual_at(points, space.spline(found)(t), (t,))
    if space.count == len(points):
        check_met(residual, points)
    return space, found, SplineFit(points, (t,), (residual,))
