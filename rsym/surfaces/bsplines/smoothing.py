"""Smoothness as data: rows that ask second derivatives of a spline surface to vanish.

s sum_ij A_ij (|B_uu|^2 + 2 |B_uv|^2 + |B_vv|^2) with the vertices B_uu, B_uv, B_vv of the derivatives and the integrals
A_ij of their basis functions, parameters brought to [0, 1]. It is no less than s times the thin-plate energy
integral |p_uu|^2 + 2 |p_uv|^2 + |p_vv|^2, since basis functions are positive and their sum is 1, and vanishes with it:
for planes with u and v proportional to lengths. The idea of such a penalty: Eilers and Marx (1996).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.bsplines.spline_spaces import Spaces, SplineSpace


def checked_smoothing(given: Any) -> float:
    """A finite number that is not negative.

    Examples
    --------
    >>> checked_smoothing(1e-6)
    1e-06
    """
    try:
        value = math.nan if isinstance(given, bool | str) else float(given)
    except (TypeError, ValueError):
        value = math.nan
    if not 0 <= value < math.inf:
        raise RsymError(
            f"smoothing is a number >= 0, got {given!r}", code="smoothing", remedy="1e-6 for data that leave holes"
        )
    return value


def smoothness_rows(spaces: Spaces) -> Floats:
    """Rows (m, vertices of u times those of v) whose squares sum up to the formula above for s = 1."""
    (n, n_u, n_uu), (m, m_v, m_vv) = (_derivatives(space) for space in spaces)
    return np.concatenate([np.kron(n_uu, m), math.sqrt(2) * np.kron(n_u, m_v), np.kron(n, m_vv)])


def _derivatives(space: SplineSpace) -> list[Floats]:
    """For the function and its first two derivatives the vertices, each times the root of its integral."""
    low, high = space.domain
    knots, matrix = (space.knots - low) / (high - low), space.unrolled(np.eye(space.count))
    found = []
    for degree in range(space.degree, space.degree - 3, -1):
        if degree < 0:  # straight between its knots
            found.append(np.zeros((0, space.count)))
            continue
        integrals = (knots[degree + 1 :] - knots[: -degree - 1]) / (degree + 1)
        rows = np.sqrt(integrals)[:, None] * matrix
        found.append(rows[: space.count] if space.closed else rows)
        if degree:
            lengths = (knots[degree + 1 : -1] - knots[1 : -degree - 1])[:, None]
            steps = degree * np.diff(matrix, axis=0)
            # Where knots stand so often that there is a kink, the derivative has one vertex less.
            matrix = np.divide(steps, lengths, out=np.zeros_like(steps), where=lengths > 0)
            knots = knots[1:-1]
    return found
