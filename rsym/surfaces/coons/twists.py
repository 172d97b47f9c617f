"""Twists p_uv at the nodes of a grid, estimated from what is known around them.

Of one patch, where only its corners are known, they are chosen by `with_twists`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.coons.energies import gram_matrices
from rsym.surfaces.parameters import real_array

PATCH_KINDS = ("zero", "bilinear", "adini", "energy")


def estimate_twists(
    points: ArrayLike,
    kind: str = "bessel",
    *,
    u: ArrayLike | None = None,
    v: ArrayLike | None = None,
    u_tangents: ArrayLike | None = None,
    v_tangents: ArrayLike | None = None,
) -> Floats:
    """Mixed derivatives p_uv at the nodes of a grid of points.

    =========== ==================================================================================================
    zero        0: Ferguson's surface, flat at every node
    bilinear    mean of the twists p11 - p10 - p01 + p00 of the cells around a node, over their areas
    central     (p++ - p+- - p-+ + p--)/((u+ - u-)(v+ - v-)) over the neighbours of a node; one-sided at the border
    adini       [p_v(u+) - p_v(u-)]/(u+ - u-) + [p_u(v+) - p_u(v-)]/(v+ - v-) - central: exact for surfaces
                f(u){1, v} + {1, u}g(v)
    bessel      of the biquadratic through 3 x 3 points: exact for every biquadratic
    =========== ==================================================================================================

    Parameters
    ----------
    points : (r, s, 3)
        The nodes p(u_i, v_j).
    kind : str
        One of the above.
    u, v : (r,), (s,), optional
        The parameters of the nodes, increasing; by default 0, 1, 2, ...
    u_tangents, v_tangents : (r, s, 3), optional
        p_u and p_v at the nodes, for `adini`; by default those of parabolas through three nodes.

    Returns
    -------
    (r, s, 3) array

    Raises
    ------
    RsymError
        For an unknown kind, arrays that do not fit, or a grid too small for the kind.

    Examples
    --------
    >>> x, y = np.meshgrid([0.0, 1.0, 3.0], [0.0, 2.0, 3.0], indexing="ij")
    >>> grid = np.stack([x, y, x**2 * y**2], axis=-1)
    >>> estimate_twists(grid, "bessel", u=[0, 1, 3], v=[0, 2, 3])[2, 1, 2].round(12)    # 4 x y
    np.float64(24.0)
    """
    nodes = _grid(points, "points")
    known = [_knots(given, count, name) for given, count, name in zip((u, v), nodes.shape[:2], "uv", strict=True)]
    if not isinstance(kind, str) or kind not in KINDS:
        raise RsymError(f"no twist estimator {kind!r}", code="twist", remedy=f"choose from {', '.join(KINDS)}")
    if kind == "bessel" or (kind == "adini" and (u_tangents is None or v_tangents is None)):
        _need_three(nodes, kind)
    slopes = [
        _fit(given, nodes.shape, name) if given is not None else None
        for given, name in ((u_tangents, "u_tangents"), (v_tangents, "v_tangents"))
    ]
    return KINDS[kind](nodes, known[0], known[1], slopes)


def bessel_slopes(knots: Floats) -> Floats:
    """The matrix (n, n) that takes values at knots to the slopes there of parabolas through three neighbours.

    Examples
    --------
    >>> (bessel_slopes(np.array([0.0, 1.0, 3.0])) @ np.array([0.0, 1.0, 9.0])).round(12).tolist()
    [0.0, 2.0, 6.0]
    """
    count = len(knots)
    matrix = np.zeros((count, count))
    for row in range(count):
        first = min(max(row - 1, 0), count - 3)
        three = knots[first : first + 3]
        for k in range(3):
            others = np.delete(three, k)
            matrix[row, first + k] = (2 * knots[row] - others.sum()) / np.prod(three[k] - others)
    return matrix


def _differences(knots: Floats) -> Floats:
    """The matrix (n, n) of difference quotients over both neighbours, one-sided at the ends."""
    count = len(knots)
    matrix = np.zeros((count, count))
    for row in range(count):
        low, high = max(row - 1, 0), min(row + 1, count - 1)
        matrix[row, high], matrix[row, low] = (sign / (knots[high] - knots[low]) for sign in (1, -1))
    return matrix


def _both(rows: Floats, nodes: Floats, columns: Floats) -> Floats:
    return np.asarray(np.einsum("ai,ijc,bj->abc", rows, nodes, columns))


def _bilinear(nodes: Floats, u: Floats, v: Floats, slopes: list[Floats | None]) -> Floats:
    inner = np.diff(np.diff(nodes, axis=0), axis=1) / (np.diff(u)[:, None] * np.diff(v))[..., None]
    total, cells = np.zeros_like(nodes), np.zeros((*nodes.shape[:2], 1))
    for i in (slice(1, None), slice(None, -1)):
        for j in (slice(1, None), slice(None, -1)):
            total[i, j] += inner
            cells[i, j] += 1
    return total / cells


def _central(nodes: Floats, u: Floats, v: Floats, slopes: list[Floats | None]) -> Floats:
    return _both(_differences(u), nodes, _differences(v))


def _adini(nodes: Floats, u: Floats, v: Floats, slopes: list[Floats | None]) -> Floats:
    p_u = np.einsum("ai,ijc->ajc", bessel_slopes(u), nodes) if slopes[0] is None else slopes[0]
    p_v = np.einsum("bj,ijc->ibc", bessel_slopes(v), nodes) if slopes[1] is None else slopes[1]
    across_u = np.einsum("ai,ijc->ajc", _differences(u), p_v)
    across_v = np.einsum("bj,ijc->ibc", _differences(v), p_u)
    return np.asarray(across_u + across_v - _central(nodes, u, v, slopes))


KINDS: dict[str, Callable[[Floats, Floats, Floats, list[Floats | None]], Floats]] = {
    "zero": lambda nodes, u, v, slopes: np.zeros_like(nodes),
    "bilinear": _bilinear,
    "central": _central,
    "adini": _adini,
    "bessel": lambda nodes, u, v, slopes: _both(bessel_slopes(u), nodes, bessel_slopes(v)),
}


def _grid(given: Any, name: str) -> Floats:
    try:
        nodes = np.array(real_array(given))
    except (TypeError, ValueError) as error:
        raise RsymError(f"{name} must be an array of numbers (r, s, 3)", code="array") from error
    if nodes.ndim != 3 or nodes.shape[2] != 3 or min(nodes.shape[:2]) < 2 or not np.isfinite(nodes).all():
        raise RsymError(
            f"{name} must be finite and have the shape (r, s, 3) with r, s >= 2, got the shape {nodes.shape}",
            code="array",
        )
    return nodes


def _fit(given: Any, shape: tuple[int, ...], name: str) -> Floats:
    array = _grid(given, name)
    if array.shape != shape:
        raise RsymError(f"{name} must have the shape of the points, {shape}, got {array.shape}", code="array")
    return array


def _knots(given: ArrayLike | None, count: int, name: str) -> Floats:
    try:
        knots = np.arange(float(count)) if given is None else real_array(given)
    except (TypeError, ValueError):
        knots = np.zeros(0)
    if knots.shape != (count,) or not np.isfinite(knots).all() or not (np.diff(knots) > 0).all():
        raise RsymError(
            f"{name} must be {count} finite increasing numbers, got {given!r}", code="knots", remedy="one for each row"
        )
    return knots


def _need_three(nodes: Floats, kind: str) -> None:
    if min(nodes.shape[:2]) < 3:
        raise RsymError(
            f"twists of the kind {kind!r} need 3 x 3 points, got {nodes.shape[0]} x {nodes.shape[1]}",
            code="twist",
            remedy="choose bilinear or central, or adini with tangents",
        )


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
