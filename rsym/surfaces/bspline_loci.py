"""Vertices kept on planes or along curves while the others are fitted to data.

The source says that an iteration does this and not how. Here each step lets a kept vertex slide along the tangents of
its plane or curve, fits all vertices together, and brings the kept ones back: Gauss-Newton's method. Planes take one
step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rsym.errors import RsymError
from rsym.surfaces.band_qr import BandQR
from rsym.surfaces.bspline_fitting import Pair, broadcast, collocation, singular
from rsym.surfaces.curves import as_curve
from rsym.surfaces.spline_spaces import Spaces, tensor_values
from rsym.surfaces.univariate import Curve

Array: TypeAlias = NDArray[np.float64]

# Steps of the iteration, and the share of the size of the net below which a step is none.
STEPS, STILL = 100, 1e-13
# Places of a curve that are compared before Newton's method sets in.
PLACES = 257


class Locus(Protocol):
    """Where vertices may lie."""

    def frames(self, points: Array) -> tuple[Array, Array]:
        """The nearest places (n, 3), and orthonormal tangents there (n, 3, dimension)."""


@dataclass(frozen=True)
class Plane:
    """The plane through a point, perpendicular to a normal.

    Examples
    --------
    >>> feet, tangents = Plane((0, 0, 1), (0, 0, 2)).frames(np.array([[3.0, 4.0, 5.0]]))
    >>> feet.tolist(), tangents.shape
    ([[3.0, 4.0, 1.0]], (1, 3, 2))
    """

    point: ArrayLike
    normal: ArrayLike
    _place: Array = field(init=False, repr=False, compare=False)
    _unit: Array = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        place, normal = (np.array(one, np.float64) for one in (self.point, self.normal))
        length = float(np.sqrt((normal**2).sum()))
        if place.shape != (3,) or normal.shape != (3,) or not np.isfinite(place).all() or not 0 < length < np.inf:
            raise RsymError("a plane has a point (3,) and a normal (3,) that is not zero", code="plane")
        object.__setattr__(self, "_place", place)
        object.__setattr__(self, "_unit", normal / length)

    def frames(self, points: Array) -> tuple[Array, Array]:
        """The feet of the perpendiculars, and two tangents."""
        heights = np.einsum("ni,i->n", points - self._place, self._unit)
        # The axis least along the normal gives tangents without cancellation.
        first = np.cross(self._unit, np.eye(3)[np.abs(self._unit).argmin()])
        first /= np.sqrt((first**2).sum())
        tangents = np.stack([first, np.cross(self._unit, first)], axis=-1)
        return points - heights[:, None] * self._unit, np.broadcast_to(tangents, (len(points), 3, 2))


@dataclass(frozen=True, eq=False)
class Along:
    """The points of a curve."""

    curve: Curve

    def frames(self, points: Array) -> tuple[Array, Array]:
        """The nearest points of the curve, and its unit tangents there."""
        low, high = self.curve.domain
        sampled = np.linspace(low, high, PLACES)
        gaps = self.curve(sampled)[None] - points[:, None]
        t = sampled[np.einsum("nti,nti->nt", gaps, gaps).argmin(axis=1)]
        for _ in range(20):
            place, speed, bend = self.curve.evaluate(t, [0, 1, 2])
            gap = place - points
            slope = np.einsum("ni,ni->n", speed, gap)
            square = np.einsum("ni,ni->n", speed, speed)
            rise = square + np.einsum("ni,ni->n", bend, gap)
            # Where Newton's step would climb, that of Gauss and Newton does not.
            t = self._inside(t - slope / np.where(rise > 0.1 * square, rise, square))
        place, speed = self.curve.evaluate(t, [0, 1])
        lengths = np.sqrt(np.einsum("ni,ni->n", speed, speed))
        return place, (speed / lengths[:, None])[:, :, None]

    def _inside(self, t: Array) -> Array:
        low, high = self.curve.domain
        return low + np.mod(t - low, high - low) if self.curve.closed else np.clip(t, low, high)


@dataclass(frozen=True, eq=False)
class Kept:
    """Vertices and the locus that they are kept on, by numbers i*(m+1) + j."""

    vertices: NDArray[np.intp]
    locus: Locus


def kept_vertices(given: Sequence[tuple[Any, Any]], shape: tuple[int, int]) -> list[Kept]:
    """The user's pairs (index into the net, plane or curve)."""
    numbers = np.arange(shape[0] * shape[1]).reshape(shape)
    taken: set[int] = set()
    result = []
    for index, locus in given:
        try:
            vertices = np.atleast_1d(numbers[index]).ravel()
        except IndexError as error:
            raise RsymError(f"no vertices {index!r} in a net of {shape[0]} x {shape[1]}", code="kept") from error
        twice = taken.intersection(vertices.tolist())
        if twice:
            vertex = divmod(min(twice), shape[1])
            raise RsymError(f"the vertex {vertex} is kept on two loci", code="kept", remedy="give each vertex one")
        taken.update(vertices.tolist())
        result.append(Kept(vertices, locus if isinstance(locus, Plane) else Along(as_curve(locus, what="a locus"))))
    return result


def constrained_net(
    spaces: Spaces, points: Array, parameters: Pair, kept: Sequence[Kept], start: Array
) -> tuple[Array, bool]:
    """The net nearest the points in the sense of least squares with its kept vertices where they may lie."""
    net, size = start, float(np.abs(points).max())
    everywhere = np.concatenate([one.vertices for one in kept])
    for _ in range(STEPS):
        net, frames, widths = _brought_back(net, kept)
        before = net.reshape(-1, 3)[everywhere]
        net = net + _step(spaces, points, parameters, net, frames, widths)
        moved = float(np.abs(net.reshape(-1, 3)[everywhere] - before).max())
        if moved <= STILL * size:
            break
    else:
        net, frames, widths = _brought_back(net, kept)
    # The last rounding goes to the free vertices: the kept ones lie where they should.
    net, frames, widths = _brought_back(net, kept)
    widths[everywhere] = 0
    return net + _step(spaces, points, parameters, net, frames, widths), moved <= 1e3 * STILL * size


def _brought_back(net: Array, kept: Sequence[Kept]) -> tuple[Array, Array, NDArray[np.intp]]:
    """The net with kept vertices on their loci, the directions (number, 3, 3) of all, and how many of them count."""
    flat = net.reshape(-1, 3).copy()
    frames = np.broadcast_to(np.eye(3), (len(flat), 3, 3)).copy()
    widths = np.full(len(flat), 3)
    for one in kept:
        flat[one.vertices], tangents = one.locus.frames(flat[one.vertices])
        widths[one.vertices] = tangents.shape[2]
        frames[one.vertices, :, : tangents.shape[2]] = tangents
    return flat.reshape(net.shape), frames, widths


def _step(
    spaces: Spaces, points: Array, parameters: Pair, net: Array, frames: Array, widths: NDArray[np.intp]
) -> Array:
    """The change of the net, along its frames, that fits the points best."""
    numbers, values = collocation(spaces, parameters)
    offsets = np.cumsum(widths) - widths
    matrix = np.zeros((3 * len(numbers), int(widths.sum())))
    rows = np.broadcast_to(np.arange(len(numbers))[:, None], numbers.shape)
    for direction in range(3):
        there = widths[numbers] > direction
        columns = offsets[numbers[there]] + direction
        for axis in range(3):
            matrix[3 * rows[there] + axis, columns] = values[there] * frames[numbers[there], axis, direction]
    rest = points - tensor_values(spaces, net, *broadcast(parameters))
    system = BandQR(matrix)
    if system.dependent is not None:
        vertex = int(np.searchsorted(np.cumsum(widths), system.dependent, side="right"))
        raise singular(spaces, f"the vertex {divmod(vertex, spaces[1].count)}")
    found = system.solve(rest.reshape(-1))
    change = np.zeros((len(widths), 3))
    for direction in range(3):
        free = np.flatnonzero(widths > direction)
        change[free] += found[offsets[free] + direction, None] * frames[free, :, direction]
    return change.reshape(net.shape)
