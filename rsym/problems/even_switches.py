"""Functions that tell by their sign where conditions change, made even: of those of one sign weights are no better.

A function that is steep where it changes its sign, and flat elsewhere, makes weights that are as good as 0, or as 1,
but for a layer that no spline resolves. In its place stand straight lines through the same places.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from operator import mul

import numpy as np
import sympy as sp
from scipy.spatial import cKDTree

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.shape import Shape

# Of values by distances to the nearest change, the largest by the least. On a disc it is 1.4 of x, 4 of tanh(3*x), with
# errors 1.6 to 2 times those of x at 16 and 32 cells, and 14 of tanh(10*x), with errors 20 to 66 times these.
UNEVEN = 8.0
BETTER = 0.5
NEAR = 1e-3  # of the size of a shape: there values are left out
TIMES = 4.0  # between two points of different signs, so far off at most, a change must be


def spread(values: Floats, edge: Floats, points: Floats, size: float) -> float:
    """How uneven a function is that has such values (n,) on an edge (n, 2) and changes its sign at some points.

    Examples
    --------
    >>> t = np.linspace(-1, 1, 51)
    >>> edge, middle = np.stack([t, 0 * t], axis=1), np.zeros((1, 2))
    >>> [round(spread(values, edge, middle, 2.0), 3) for values in (3 * t, np.tanh(10 * t))]
    [1.0, 9.499]
    """
    away = cKDTree(points).query(edge)[0]
    rates = np.abs(values[away > NEAR * size]) / away[away > NEAR * size]
    return float(rates.max() / max(rates.min(), np.finfo(float).tiny)) if len(rates) else 1.0


def unexplained(values: Floats, edge: Floats, points: Floats, near: float) -> Floats | None:
    """A place of an edge where values change their sign, from one point to another that is near, but at no point known.

    Examples
    --------
    >>> t = np.linspace(-1, 1, 50)
    >>> edge = np.stack([t, 0 * t], axis=1)
    >>> unexplained(t, edge, np.zeros((1, 2)), 0.1), unexplained(t, edge, np.ones((1, 2)), 0.1)
    (None, array([0.02040816, 0.        ]))
    """
    above, below = edge[values > 0], edge[values <= 0]
    if not len(above) or not len(below):
        return None
    gap, _ = cKDTree(below).query(above)
    away = cKDTree(points).query(above)[0] if len(points) else np.full(len(above), np.inf)
    wrong = (gap <= near) & (away > TIMES * gap)
    return above[np.argmax(wrong)] if wrong.any() else None


def evened(
    shape: Shape, where: sp.Expr, values: Floats, edge: Floats, points: Floats, tangents: Floats, size: float
) -> sp.Expr:
    """The function, or straight lines with its signs on the edge where it is uneven and they are less so.

    where : with the values (n,) on an edge, points (n, 2) of a leaf; it changes its sign at `points`, where the leaf
        has such tangents.

    Raises
    ------
    RsymError
        For an uneven one in the place of which no straight lines stand.
    """
    own = spread(values, edge, points, size)
    if own <= UNEVEN:
        return where
    found, least = None, np.inf
    for lines in _lines(points, tangents):
        products = np.prod([edge @ normal - level for normal, level in lines], axis=0)
        sure = cKDTree(points).query(edge)[0] > NEAR * size
        alike = np.sign(products[sure]) * np.sign(values[sure])
        if abs(alike.sum()) == len(alike) and (rate := spread(products, edge, points, size)) < least:
            least = rate
            x, y = shape.coordinates
            factors = [sp.Float(a) * x + sp.Float(b) * y - sp.Float(level) for (a, b), level in lines]
            found = reduce(mul, factors) * int(np.sign(alike.sum()))
    if found is None:
        raise _steep(edge[np.argmin(np.abs(values))])
    return found if least < BETTER * own else where


def _steep(point: Floats) -> RsymError:
    place = ", ".join(f"{value:.6g}" for value in point)
    return RsymError(
        f"what tells where conditions change is steep at ({place}), and flat elsewhere",
        code="condition",
        remedy="give a function or a shape of that sign that grows evenly along the edge: x instead of tanh(100*x)",
    )


def evened_between(
    shape: Shape, where: sp.Expr, values: Floats, edge: Floats, way: tuple[Floats, Floats], along: Floats
) -> sp.Expr:
    """Likewise of a function that changes its sign nowhere on an edge, but on a straight way from one piece to another.

    along : its values at places evenly spaced from end to end of the way.
    """
    places = way[0] + np.linspace(0, 1, len(along))[:, None] * (way[1] - way[0])
    change = places[np.argmin(np.abs(along))]
    size = float(np.linalg.norm(way[1] - way[0]))
    if spread(along, places, change[None], size) <= UNEVEN:
        return where
    normal = (way[1] - way[0]) / size * np.sign(along[-1] - along[0])
    level = float(normal @ change)
    if not (np.sign(edge @ normal - level) == np.sign(values)).all():
        raise _steep(change)
    return sp.Add(*(sp.Float(a) * t for a, t in zip(normal, shape.coordinates, strict=True)), -sp.Float(level))


def _lines(points: Floats, tangents: Floats) -> Iterator[list[tuple[Floats, float]]]:
    """Straight lines, as normals and levels: across the edge at each point, one through all, from point to point."""
    yield [(tangent, float(tangent @ point)) for point, tangent in zip(points, tangents, strict=True)]
    middle = points.mean(axis=0)
    if len(points) > 1:
        normal = np.linalg.svd(points - middle)[2][1]
        yield [(normal, float(normal @ middle))]
    if len(points) % 2 == 0:
        order = np.argsort(np.arctan2(*(points - middle).T[::-1]))
        for first in range(2):
            ends = np.roll(points[order], first, axis=0).reshape(-1, 2, 2)
            ways = ends[:, 1] - ends[:, 0]
            normals = np.stack([-ways[:, 1], ways[:, 0]], axis=1) / np.linalg.norm(ways, axis=1)[:, None]
            yield [(normal, float(normal @ end[0])) for normal, end in zip(normals, ends, strict=True)]
