"""The closed curves that bound a shape in the plane, by the leaves that they are made of."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from rsym.arrays import Ints
from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_names
from rsym.model.recent import placed, recently
from rsym.model.shape import Shape
from rsym.sampling.level_lines import dense_outline
from rsym.sampling.plane_leaves import PlaneLeaves, leaves_of
from rsym.sampling.windows import bounds_or_extent

RESOLUTION = 256
# Newton's method begins at so many places along each side; what it finds is so near, by the size of the shape.
SEEDS, ON_LEAF = 17, 1e-9


class BoundaryLoop(NamedTuple):
    """A curve: its leaves, and whether it goes around a hole."""

    leaves: tuple[int, ...]
    hole: bool


@recently(16, placed)
def loops_of(shape: Shape, axis: Collection[int] = ()) -> tuple[BoundaryLoop, ...]:
    """The curves of the boundary, as a lattice shows them; without leaves on an axis the pieces that are left.

    Raises
    ------
    RsymError
        For a curve that is too small for the lattice.

    Examples
    --------
    >>> import rsym
    >>> [(loop.leaves, loop.hole) for loop in loops_of(rsym.disc(1) - rsym.disc(0.5))]
    [((0,), False), ((1,), True)]
    """
    lines = dense_outline(shape, RESOLUTION)
    leaves = leaves_of(shape, (0, 1), {})
    cell = max(high - low for low, high in bounds_or_extent(shape, None)) / RESOLUTION
    found = []
    for line in lines:
        _, active = leaves.distance(np.asarray(line))
        if np.ptp(line, axis=0).max() < cell:
            raise _too_small(shape, int(active[0]))
        u, v = np.diff(line, axis=0).T
        turned = float(np.sum(line[:-1, 0] * v - line[:-1, 1] * u))
        found += [BoundaryLoop(tuple(np.unique(piece).tolist()), turned < 0) for piece in _pieces(active, axis)]
    _require_all(shape, leaves, {*axis, *(leaf for loop in found for leaf in loop.leaves)})
    return tuple(sorted(found, key=lambda loop: (loop.hole, loop.leaves)))


def _pieces(leaves: Ints, axis: Collection[int]) -> list[Ints]:
    """What is left of the leaves along a closed curve where those on an axis are taken out."""
    on = np.flatnonzero(np.isin(leaves, list(axis)))
    if not len(on):
        return [leaves]
    every = np.split(np.roll(leaves, -on[0]), np.sort((on - on[0]) % len(leaves)))
    return [piece[1:] for piece in every if len(piece) > 1]


def _require_all(shape: Shape, leaves: PlaneLeaves, seen: Collection[int]) -> None:
    """Refuse leaves that no curve has, where Newton's method from places all over finds them on the boundary."""
    unseen = [leaf for leaf in range(leaves.count) if leaf not in seen]
    if not unseen:
        return
    box = np.array(bounds_or_extent(shape, None))
    u, v = (np.linspace(low, high, SEEDS) for low, high in box)
    places = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    near = ON_LEAF * float(np.ptp(box, axis=1).max())
    for leaf in unseen:
        points = leaves.slide(places, np.full(len(places), leaf))
        points = points[np.all((box[:, 0] <= points) & (points <= box[:, 1]), axis=1)]
        distance, active = leaves.distance(points)
        if np.any((distance <= near) & (active == leaf)):
            raise _too_small(shape, leaf)


def _too_small(shape: Shape, leaf: int) -> RsymError:
    return RsymError(
        f"{shape_leaf_names(shape)[leaf]} bounds something too small to tell whether it is a hole",
        code="hole",
        remedy=f"leave it out, or make it larger than the shape over {RESOLUTION}",
    )


def holes(shape: Shape, unknown: Collection[int], axis: Collection[int] = ()) -> tuple[tuple[int, ...], ...]:
    """Leaves at unknown levels by the curves that they make up; in space each by itself.

    About an axis, on which some leaves lie, curves that end there close around it.

    Raises
    ------
    RsymError
        For a curve that has other leaves too, for a leaf that makes up two curves.
    """
    if not unknown:
        return ()
    if shape.dimension != 2:
        return tuple((leaf,) for leaf in unknown)
    names: Mapping[int, str] = dict(enumerate(shape_leaf_names(shape)))
    found: list[tuple[int, ...]] = []
    for loop in loops_of(shape, axis):
        level = [leaf for leaf in loop.leaves if leaf in unknown]
        if level and len(level) < len(loop.leaves):
            other = next(leaf for leaf in loop.leaves if leaf not in unknown)
            raise RsymError(
                f"{names[level[0]]} is at an unknown level, and {names[other]} goes on from it with another condition",
                code="condition",
                remedy="give rsym.constant() to all of a closed curve",
            )
        if level:
            found.append(loop.leaves)
    twice = {leaf for k, one in enumerate(found) for other in found[:k] for leaf in one if leaf in other}
    if twice:
        raise RsymError(
            f"{names[min(twice)]} makes up several closed curves, each of which has a level of its own",
            code="condition",
            remedy="make each hole a part of its own",
        )
    return tuple(found)
