"""What small spheres around a point see of a body: numbers, not proof.

On a lattice of directions the sign of omega is sampled; the cells of each sign are counted, and the normals compared
where it changes. On ever smaller spheres both settle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from rsym.arrays import Floats
from rsym.backends.numpy_backend import NumpyFunction
from rsym.program.expansion import expand
from rsym.verify.boxes.local import Model

FINENESS = 40  # steps along an edge of the cube of directions: cones of 3 degrees are seen
HALVINGS = 30
COARSE = 2.0  # degrees that the largest angle between normals so far apart may miss


@dataclass(frozen=True)
class View:
    """How many pieces of inside and outside a small sphere sees, and the largest angle between normals on it."""

    inside: int
    outside: int
    undefined: bool
    turn: float

    def __str__(self) -> str:
        nan = ", and places where omega is undefined" if self.undefined else ""
        return f"{self.inside} pieces of the inside and {self.outside} of the outside{nan}"


Sampler: TypeAlias = Callable[[Floats], Floats]


def sampler(model: Model) -> Sampler:
    """A function of points (n, 3): omega and its gradient there, (4, n)."""
    nodes = (model.root, *model.gradient(model.root))
    function = NumpyFunction(expand(model.builder.program({str(place): node for place, node in enumerate(nodes)})))
    letters = [float((model.letters[name][0] + model.letters[name][1]) / 2) for name in model.builder.letters]

    def sampled(points: Floats) -> Floats:
        outputs = [np.empty(len(points)) for _ in nodes]
        function.run([np.ascontiguousarray(row) for row in points.T], letters, outputs)
        return np.stack(outputs)

    return sampled


def views(sampled: Sampler, centre: Sequence[float], radii: Sequence[float]) -> list[View]:
    """What spheres around a point see.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> cone = Model(rsym.Shape(z**2 - x**2 - y**2, (x, y, z)), {})
    >>> print(views(sampler(cone), (0.0, 0.0, 0.0), [0.1])[0])
    2 pieces of the inside and 1 of the outside
    """
    directions, pairs = _lattice()
    return [_view(sampled, np.asarray(centre) + size * directions, pairs) for size in radii]


def _view(sampled: Sampler, points: Floats, pairs: NDArray[np.int64]) -> View:
    signs = _signs(sampled(points)[0])
    counts = {sign: _pieces(signs == sign, pairs) for sign in (1, -1)}
    inner, outer = pairs[:, signs[pairs[0]] * signs[pairs[1]] < 0]
    inner, outer = np.where(signs[inner] > 0, inner, outer), np.where(signs[inner] > 0, outer, inner)
    low, high = points[inner], points[outer]
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        inside = (_signs(sampled(middle)[0]) > 0)[:, None]
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    gradients = sampled(low)[1:]
    with np.errstate(all="ignore"):
        normals = gradients / np.linalg.norm(gradients, axis=0)
    normals = normals[:, np.isfinite(normals).all(axis=0)]
    least = float((normals.T @ normals).min()) if normals.size else math.nan
    return View(counts[1], counts[-1], bool((signs == 0).any()), math.degrees(math.acos(max(-1.0, min(1.0, least)))))


def _signs(values: Floats) -> NDArray[np.int64]:
    return np.where(np.isnan(values), 0, np.where(values > 0, 1, -1))


def _pieces(own: NDArray[np.bool_], pairs: NDArray[np.int64]) -> int:
    i, j = pairs[:, own[pairs[0]] & own[pairs[1]]]
    labels = connected_components(coo_array((np.ones(len(i)), (i, j)), (len(own), len(own))), directed=False)[1]
    return len(set(labels[own].tolist()))


@cache
def _lattice() -> tuple[Floats, NDArray[np.int64]]:
    """Unit vectors through the points of a lattice on the surface of a cube, and the pairs of neighbours."""
    n = FINENESS
    points = [point for point in product(range(n + 1), repeat=3) if 0 in point or n in point]
    places = {point: number for number, point in enumerate(points)}
    pairs = []
    for (i, j, k), number in places.items():
        for other in ((i + 1, j, k), (i, j + 1, k), (i, j, k + 1)):
            if other in places:
                pairs.append((number, places[other]))
    # Turned a little, so that no direction lies on the planes of symmetry of a model.
    turn = np.linalg.qr(np.array([[1.0, 0.3, 0.1], [0.2, 1.0, -0.3], [-0.1, 0.4, 1.0]]))[0]
    directions = (np.array(points) * (2 / n) - 1) @ turn
    return directions / np.linalg.norm(directions, axis=1, keepdims=True), np.array(pairs).T
