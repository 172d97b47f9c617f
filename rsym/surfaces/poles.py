"""Poles: points to which whole edges shrink, alone or together with those of other patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rsym.surfaces.edge_matching import Border
from rsym.surfaces.edges import Edge
from rsym.surfaces.forms import dot, limit_forms

Array = NDArray[np.float64]

SAMPLES = (9, 17)


@dataclass(frozen=True, eq=False)
class Fan:
    """The directions in which patches leave a pole: place, normal and curvature tensor (3, 3) of each of n.

    The tensor T gives the normal curvature T w . w of a unit tangent w. border says which edge a direction is of.
    """

    points: Array
    normals: Array
    tensors: Array
    border: NDArray[np.int64]
    parameters: Array


def clusters(borders: Sequence[Border]) -> list[list[Border]]:
    """Edges that are points, those within reach of one another together."""
    groups: list[list[Border]] = []
    for border in borders:
        near = [group for group in groups if any(_near(border, one) for one in group)]
        whole = [border, *(one for group in near for one in group)]
        groups = [*(group for group in groups if group not in near), whole]
    return [sorted(group, key=lambda border: (border.index, border.edge.name)) for group in groups]


def fan(group: Sequence[Border], count: int) -> Fan:
    """What the patches of a pole are in `count` directions each, their normals turned to one side."""
    parts: list[tuple[Array, Array, Array, NDArray[np.int64], Array]] = []
    for number, border in enumerate(group):
        t = np.linspace(*border.edge.interval, count)
        points, normals, tensors = _directions(border.edge, t)
        if parts and np.nansum(dot(np.nanmean(normals, axis=0), parts[0][1])) < 0:
            normals, tensors = -normals, -tensors
        parameters = np.stack(border.edge.parameters(t), axis=-1)
        parts.append((points, normals, tensors, np.full(count, number), parameters))
    return Fan(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def spread(fan: Fan) -> tuple[Array, Array, Array]:
    """Gap, angle in degrees and difference of curvatures between all pairs of directions, (n, n) each."""
    gaps = np.linalg.norm(fan.points[:, None] - fan.points[None], axis=-1)
    crossed = np.linalg.norm(np.cross(fan.normals[:, None], fan.normals[None]), axis=-1)
    angles = np.degrees(np.arctan2(crossed, dot(fan.normals[:, None], fan.normals[None])))
    difference = fan.tensors[:, None] - fan.tensors[None]
    known = np.isfinite(difference).all(axis=(-1, -2))
    jumps = np.full(known.shape, np.nan)
    jumps[known] = np.abs(np.linalg.eigvalsh(difference[known])).max(axis=-1)
    return gaps, angles, jumps


def _directions(edge: Edge, t: Array) -> tuple[Array, Array, Array]:
    """Points, normals and curvature tensors; the basis at a pole is p_uv and the derivative out of the edge."""
    u, v = edge.parameters(t)
    forms = limit_forms(edge.patch, u, v, edge.letters)
    orders = ((0, 0), (1, 1), (0, 1) if edge.across == 1 else (1, 0))
    points, turning, leaving = edge.patch.derivatives(u, v, orders, letters=edge.letters)
    first, second = (turning, leaving) if edge.across == 1 else (leaving, turning)
    basis = np.stack([first, second], axis=-1)
    with np.errstate(all="ignore"):
        area = forms.E * forms.G - forms.F**2
        rows = [np.stack([forms.G, -forms.F], axis=-1), np.stack([-forms.F, forms.E], axis=-1)]
        dual = basis @ (np.stack(rows, axis=-2) / area[:, None, None])
    form = np.stack([np.stack([forms.L, forms.M], axis=-1), np.stack([forms.M, forms.N], axis=-1)], axis=-2)
    return points, forms.normal, dual @ form @ np.swapaxes(dual, -1, -2)


def _near(one: Border, other: Border) -> bool:
    return bool(np.linalg.norm(one.points[0] - other.points[0]) <= min(one.reach, other.reach))
