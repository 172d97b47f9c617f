"""Twists of one patch, chosen where only its corners are known."""

from __future__ import annotations

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.energies import gram_matrices
from rsym.surfaces.coons.twists import estimate_twists

PATCH_KINDS = ("zero", "bilinear", "adini", "energy")


def with_twists(patch: BicubicCoons, kind: str) -> BicubicCoons:
    """The patch with other twists at its corners, everything else as it is.

    ``zero`` is Ferguson's patch; ``bilinear`` and ``adini`` see `rsym.surfaces.estimate_twists`; ``energy`` takes the
    twists that make the integral of |p_uu|^2 + 2 |p_uv|^2 + |p_vv|^2 least: a linear system, since the integral is
    quadratic in the corner information.

    Raises
    ------
    RsymError
        For another kind, or a patch that is not made of a matrix (4, 4, 3) of numbers.

    Examples
    --------
    >>> matrix = np.zeros((4, 4, 3))
    >>> matrix[1, :2, 0] = matrix[2:, :2, 0] = matrix[:2, 1, 1] = matrix[:2, 2:, 1] = 1
    >>> matrix[1, 1, 2] = matrix[1, 2:, 2] = matrix[2:, 1, 2] = 1       # z = u v but for its twists
    >>> with_twists(BicubicCoons(matrix), "adini")(0.5, 0.5).round(12).tolist()
    [0.5, 0.5, 0.25]
    """
    if not isinstance(patch, BicubicCoons):
        raise RsymError(
            f"twists are chosen for a BicubicCoons, got {type(patch).__name__}",
            code="twist",
            remedy="estimate_twists takes a grid of points",
        )
    matrix = patch.matrix
    if kind not in PATCH_KINDS or matrix.shape != (4, 4, 3):
        raise RsymError(
            f"no twists of the kind {kind!r} for one patch with a matrix {matrix.shape}",
            code="twist",
            remedy=f"choose from {', '.join(PATCH_KINDS)} for a matrix (4, 4, 3)",
        )
    if kind == "energy":
        matrix[2:, 2:] = _least_bending(matrix, patch.blend_u, patch.blend_v)
    else:
        matrix[2:, 2:] = estimate_twists(matrix[:2, :2], kind, u_tangents=matrix[2:, :2], v_tangents=matrix[:2, 2:])
    return patch.with_matrix(matrix)


def _least_bending(matrix: Floats, blend_u: HermiteBlend, blend_v: HermiteBlend) -> Floats:
    """The twists (2, 2, 3) of least bending energy."""
    of_u, of_v = (gram_matrices(blend, None, blend.letters.values_with(None), range(3)) for blend in (blend_u, blend_v))
    hessian = np.add.reduce([weight * np.kron(of_u[2 - k][0], of_v[k][0]) for k, weight in enumerate((1, 2, 1))])
    free = np.zeros((4, 4), np.bool_)
    free[2:, 2:] = True
    inner, fixed = np.flatnonzero(free), np.flatnonzero(~free)
    flat = matrix.reshape(16, 3)
    twists = np.linalg.solve(hessian[np.ix_(inner, inner)], -hessian[np.ix_(inner, fixed)] @ flat[fixed])
    return np.asarray(twists.reshape(2, 2, 3))
