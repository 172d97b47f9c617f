"""Poles: points to which whole edges shrink, alone or together with those of other patches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rsym.arrays import Floats
from rsym.surfaces.forms import dot, limit_forms
from rsym.surfaces.joints.borders import Border
from rsym.surfaces.joints.edges import PatchEdge

SAMPLES = (17, 33)


@dataclass(frozen=True, eq=False)
class Fan:
    """The directions in which patches leave a pole: place, normal and curvature tensor (3, 3) of each of n.

    The tensor T gives the normal curvature T w . w of a unit tangent w.
    """

    points: Floats
    normals: Floats
    tensors: Floats
    parameters: Floats


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
    parts = []
    for border in group:
        t = np.linspace(*border.edge.interval, count)
        parts.append((*_directions(border.edge, t), np.stack(border.edge.parameters(t), axis=-1)))
    points, leaving, normals, tensors, parameters = (np.stack(column) for column in zip(*parts, strict=True))
    signs = _sides(leaving, normals)[:, None, None]
    normals, tensors = signs * normals, signs[..., None] * tensors
    return Fan(*(one.reshape(-1, *one.shape[2:]) for one in (points, normals, tensors, parameters)))


def _sides(leaving: Floats, normals: Floats) -> Floats:
    """A sign for each patch that turns all normals to one side: along edges that two of them share they agree.

    Patches are taken one after the other, always the one with the edge nearest to an edge of those taken before.
    """
    ends, there = leaving[:, [0, -1]], normals[:, [0, -1]]
    near = np.einsum("aid,bjd->abij", ends, ends)
    same = np.einsum("aid,bjd->abij", there, there)
    signs = np.zeros(len(ends))
    signs[0] = 1.0
    while (signs == 0).any():
        open_pairs = (signs[:, None] != 0) & (signs[None] == 0)
        nearest = np.where(open_pairs[..., None, None], np.nan_to_num(near, nan=-1.0), -np.inf)
        a, b, i, j = np.unravel_index(int(np.argmax(nearest)), near.shape)
        signs[b] = signs[a] * (-1.0 if same[a, b, i, j] < 0 else 1.0)
    return signs


def spread(fan: Fan) -> tuple[Floats, Floats, Floats]:
    """Gap, angle in degrees and difference of curvatures between all pairs of directions, (n, n) each."""
    gaps = np.linalg.norm(fan.points[:, None] - fan.points[None], axis=-1)
    crossed = np.linalg.norm(np.cross(fan.normals[:, None], fan.normals[None]), axis=-1)
    angles = np.degrees(np.arctan2(crossed, dot(fan.normals[:, None], fan.normals[None])))
    difference = fan.tensors[:, None] - fan.tensors[None]
    known = np.isfinite(difference).all(axis=(-1, -2))
    jumps = np.full(known.shape, np.nan)
    jumps[known] = np.abs(np.linalg.eigvalsh(difference[known])).max(axis=-1)
    return gaps, angles, jumps


def _directions(edge: PatchEdge, t: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Points, unit directions, normals and curvature tensors; the basis at a pole is p_uv and the derivative across."""
    u, v = edge.parameters(t)
    forms = limit_forms(edge.patch, u, v, edge.letters)
    orders = ((0, 0), (1, 1), (0, 1) if edge.across == 1 else (1, 0))
    points, turning, leaving = edge.patch.derivatives(u, v, orders, letters=edge.letters)
    first, second = (turning, leaving) if edge.across == 1 else (leaving, turning)
    basis = np.stack([first, second], axis=-1)
    with np.errstate(all="ignore"):
        area = forms.E * forms.G - forms.F**2
        rows = [np.stack([forms.G, -forms.F], axis=-1), np.stack([-forms.F, forms.E], axis=-1)]
        direction = leaving / np.sqrt(dot(leaving, leaving))[:, None]
        dual = basis @ (np.stack(rows, axis=-2) / area[:, None, None])
    form = np.stack([np.stack([forms.L, forms.M], axis=-1), np.stack([forms.M, forms.N], axis=-1)], axis=-2)
    return points, direction, forms.normal, dual @ form @ np.swapaxes(dual, -1, -2)


def _near(one: Border, other: Border) -> bool:
    return bool(np.linalg.norm(one.points[0] - other.points[0]) <= min(one.reach, other.reach))
