"""Joining patches that are matrices of corner information: rows of one become rows of the other."""

from __future__ import annotations

from typing import Any

import numpy as np

from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.corrections import Correction, greatest, sizes
from rsym.surfaces.functions.entries import entries_of
from rsym.surfaces.functions.univariate import Constant
from rsym.surfaces.joints.edges import Edge
from rsym.surfaces.joints.meeting import apart

# Blends are one and the same if they agree here to rounding; families with different parameters differ by far more.
PLACES = np.linspace(0.0, 1.0, 23)
ROUNDING = 1e-12


def joined_matrix(p: BicubicCoons, first: Edge, q: BicubicCoons, second: Edge, k: float, depth: int) -> BicubicCoons:
    """The patch q with the rows of its edge taken from p: those of order n times k^n, counted out of p and into q."""
    if not 0 < k < np.inf:
        raise RsymError(f"k must be positive, got {k!r}", code="k", remedy="k < 0 would fold q back over p")
    along_p, along_q = (_blend_along(edge) for edge in (first, second))
    if not _agree(along_p, along_q, first.reverse):
        how = " run backwards" if first.reverse else ""
        raise RsymError(
            f"along the edge {second.name} q has the blend {along_q!r}, and p another along its {first.name}{how}",
            code="blend",
            remedy="give both patches the same blend along the edge, or join with transfinite=True",
        )
    if depth >= along_q.order:
        raise RsymError(
            f"matrices of class {along_q.order} hold no derivatives of order {depth}",
            code="class",
            remedy="matrices (6, 6, 3), or transfinite=True",
        )
    source, given = _entries(p), _entries(q)
    target = given.astype(np.result_type(source, given))
    rows_p, rows_q = _rows(source, first), _rows(target, second)
    # Out of p is towards growing u at its upper edge, into q at its lower one.
    factor = k if first.upper != second.upper else -k
    for order in range(depth + 1):
        row = rows_p[2 * order + int(first.upper)]
        rows_q[2 * order + int(second.upper)] = factor**order * (_backwards(row) if first.reverse else row)
    letters = p.data.letters.merge(q.data.letters)
    joined = BicubicCoons(target, q.blend_u, q.blend_v, letters=letters if len(letters) else None)
    added = q.with_matrix(joined.matrix - q.matrix)
    moved, (u, v) = greatest(lambda u, v: sizes(added(u, v)), *added.domain)
    joined.correction = Correction(apart(first, second)[0], moved, (u, v))
    return joined


def _entries(patch: BicubicCoons) -> np.ndarray[Any, Any]:
    """The matrix: numbers, or expressions if it has letters."""
    if isinstance(patch.data, Constant):
        return patch.data.values
    expressions = patch.data.expressions()
    assert expressions is not None
    return np.array(entries_of(expressions), dtype=object).reshape(patch.data.shape)


def _rows(matrix: np.ndarray[Any, Any], edge: Edge) -> np.ndarray[Any, Any]:
    """The matrix as a view whose rows run along the edge."""
    return matrix if edge.across == 0 else np.swapaxes(matrix, 0, 1)


def _backwards(row: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """The same curve from its end: both ends change places, derivatives of odd order their sign."""
    pairs = row.reshape(-1, 2, *row.shape[1:])[:, ::-1].copy()
    pairs[1::2] *= -1
    return pairs.reshape(row.shape)


def _blend_along(edge: Edge) -> HermiteBlend:
    patch = edge.patch
    assert isinstance(patch, BicubicCoons)
    return patch.blend_v if edge.across == 0 else patch.blend_u


def _agree(one: HermiteBlend, other: HermiteBlend, reverse: bool) -> bool:
    """Whether a curve in the first blend, run backwards if so said, is the one in the second blend of the same data."""
    if one.order != other.order or one.letters != other.letters:
        return False
    values = np.moveaxis(_backwards(np.moveaxis(one(1 - PLACES), -1, 0)), 0, -1) if reverse else one(PLACES)
    return bool(np.abs(values - other(PLACES)).max() <= ROUNDING)
