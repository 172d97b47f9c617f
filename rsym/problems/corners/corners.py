"""The corners of a plane shape: where two leaves vanish and both bound it."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rsym.arrays import Flags, Floats, Ints
from rsym.errors import RsymError
from rsym.logic.leaf_names import shape_leaf_names
from rsym.model.recent import placed, recently
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.problems.corners.common_zeros import CommonZero, common_zeros
from rsym.problems.corners.leaf_boxes import LeafBoxes, leaf_boxes
from rsym.problems.corners.leaf_jets import StraightEdge, leaf_jets
from rsym.problems.corners.reaches import Tips, reaches
from rsym.problems.corners.sectors import Sector, sectors
from rsym.sampling.form_signs import Boxes
from rsym.sampling.windows import bounds_or_extent

STRAIGHT = 1e-6  # radians: what turns less is no corner
WIDER = 1e-6  # of the bounds: what lies on them is found
SINGULAR = "singular-leaf"
ON_LINE = 1e-13  # of the size of a shape: what is on a straight edge but for rounding
ALONG = np.polynomial.legendre.leggauss(14)[0]  # places along an edge, of the size of a shape


@dataclass(frozen=True)
class PlaneCorner:
    """A corner of the boundary, looked at from inside.

    Attributes
    ----------
    point : pair of float
    angle : float
        Of the inside, between 0 and 2 pi; above pi the corner is re-entrant. At a cusp, where the edges touch, 0 or
        2 pi.
    leaves : pair of int
        The leaves, by their numbers in the sign form, of both edges: counter-clockwise from the first to the second
        is inside.
    parts : pair of str
        What they are called.
    gradients : pair of pairs of float
        Those of the leaves, rows of A; both point inside.
    reach : float
        Within this distance no other part of the boundary lies, and leaf coordinates are one to one; 0 of a cusp.
    alone : bool
        Whether no other leaf passes through the point; else only what lies between the edges is of this corner.
    natural : pair of bool, optional
        Whether nothing is prescribed on the first and the second edge; by default as on all of their leaves.
    straight : pair of bool
        Which edges are straight though their leaves are not linear, such as that of a strip; there the distance from
        the line stands for the leaf.

    Examples
    --------
    >>> corner = PlaneCorner((0.0, 0.0), math.pi / 2, (1, 0), ("y", "x"), ((0.0, 1.0), (1.0, 0.0)), 1.0)
    >>> corner.edges.round(12).tolist(), corner.is_reentrant, corner.is_cusp
    ([[1.0, 0.0], [0.0, 1.0]], False, False)
    """

    point: tuple[float, float]
    angle: float
    leaves: tuple[int, int]
    parts: tuple[str, str]
    gradients: tuple[tuple[float, float], tuple[float, float]]
    reach: float
    alone: bool = True
    straight: tuple[bool, bool] = (False, False)
    natural: tuple[bool, bool] | None = None

    @property
    def is_reentrant(self) -> bool:
        """Whether the inside is not convex there."""
        return self.angle > math.pi

    @property
    def is_cusp(self) -> bool:
        """Whether both edges leave in one direction."""
        return self.angle in (0.0, 2 * math.pi)

    @property
    def is_flat(self) -> bool:
        """Whether it is a point of a smooth edge, where conditions change."""
        return self.angle == math.pi

    def free(self, natural: Collection[int]) -> tuple[bool, bool]:
        """Whether nothing is prescribed on each edge, where nothing is on these leaves."""
        return (self.leaves[0] in natural, self.leaves[1] in natural) if self.natural is None else self.natural

    @property
    def lines(self) -> tuple[StraightEdge | None, StraightEdge | None]:
        """What stands for the leaves of straight edges; that along a flat one stands for the second."""
        if self.is_flat:
            straight = StraightEdge(self.point, self.gradients[0]) if self.straight[0] else None
            return straight, StraightEdge(self.point, (float(self.edges[0, 0]), float(self.edges[0, 1])))
        first, second = (
            StraightEdge(self.point, slope) if straight else None
            for slope, straight in zip(self.gradients, self.straight, strict=True)
        )
        return first, second

    @property
    def edges(self) -> Floats:
        """The unit directions of both edges, (2, 2)."""
        p, q = (np.array(slope) / math.hypot(*slope) for slope in self.gradients)
        return np.array([[p[1], -p[0]], [-q[1], q[0]]]) + 0.0  # no zeros with a sign


def corners(shape: Shape, letters: Mapping[Any, float] | None = None, bounds: Any = None) -> tuple[PlaneCorner, ...]:
    """All corners of the boundary of a plane shape, in the order of their coordinates.

    Boxes are divided until each is proved, up to rounding, to hold no common zero of leaves that matter, or one. What
    is inside around it follows from gradients, where leaves touch from curvatures. Where leaves go on as each other,
    and where bounds cut the shape off, there is no corner; one that lies on the bounds is one.

    Parameters
    ----------
    shape : Shape
        In the plane.
    letters : mapping, optional
        Override the defaults.
    bounds : pairs, optional
        Where to look: else the bounds of the shape, else its extent.

    Raises
    ------
    RsymError
        ``singular-leaf`` where a leaf itself has a corner, a kink or a double point on the boundary, ``degenerate``
        where leaves run along each other and cannot be told apart, both with the place; as `extent` without bounds.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> quarters = rsym.conjunction(1 - x**2, 1 - y**2, rsym.disjunction(-x, y))
    >>> for corner in corners(rsym.Shape(quarters, (x, y))):
    ...     print(corner.point, round(corner.angle / math.pi, 12), corner.parts)
    (-1.0, -1.0) 0.5 ('1 - y**2', '1 - x**2')
    (-1.0, 1.0) 0.5 ('1 - x**2', '1 - y**2')
    (0.0, -1.0) 0.5 ('-x', '1 - y**2')
    (0.0, 0.0) 1.5 ('y', '-x')
    (1.0, 0.0) 0.5 ('1 - x**2', 'y')
    (1.0, 1.0) 0.5 ('1 - y**2', '1 - x**2')
    """
    found, refused = surveyed_corners(shape, letters, bounds)
    if refused:
        raise refused[0]
    return found


def inward_corners(shape: Shape) -> Floats:
    """Where corners point inwards, (n, 2), as far as they are known: stresses have no bound there.

    Examples
    --------
    >>> import rsym
    >>> inward_corners(rsym.rectangle(4, 4) - rsym.rectangle(2, 2).translate(1, 1)).round(9) + 0.0
    array([[0., 0.]])
    """
    try:
        found, _ = surveyed_corners(shape)
    except RsymError:
        found = ()
    return np.array([corner.point for corner in found if corner.angle > math.pi]).reshape(-1, 2)


@recently(16, placed)
def surveyed_corners(
    shape: Shape, letters: Mapping[Any, float] | None = None, bounds: Any = None
) -> tuple[tuple[PlaneCorner, ...], tuple[RsymError, ...]]:
    """The `corners` of a shape, and in place of those that are refused the reasons.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> found, refused = surveyed_corners(rsym.Shape(rsym.conjunction(1 - x**2 - y**2, y + abs(x)), (x, y)))
    >>> len(found), [error.code for error in refused]
    (2, ['singular-leaf'])
    """
    require_shape(shape)
    if shape.dimension != 2:
        raise RsymError(
            "corners are those of a shape in the plane, got one in space", code="dimension", remedy="take a section"
        )
    box = _box(shape, letters, bounds)
    leaves = leaf_boxes(shape, letters)
    named = shape_leaf_names(shape)
    found: list[PlaneCorner] = []
    met: list[Ints] = []
    meetings, along = common_zeros(leaves, box)
    refused = list(along)
    size = float(np.hypot(*box.sides[:, 0]))
    for meeting in meetings:
        try:
            zeros, own = _at(shape, leaves, meeting, letters)
        except RsymError as error:
            if error.code != SINGULAR:
                raise
            refused.append(error)
            continue
        alone = len(own) == 1 and {leaves.lines[k] for k in zeros} == {leaves.lines[k] for k in own[0][:2]}
        corners_here = [_corner(leaves, named, meeting, sector, alone=alone) for sector in own]
        found += [corner for corner in corners_here if corner is not None]
        met += [zeros for corner in corners_here if corner is not None]
    return _with_reaches(leaves, found, met, size), tuple(refused)


def flat_corners(shape: Shape, places: Sequence[tuple[Floats, int, tuple[bool, bool]]]) -> tuple[PlaneCorner, ...]:
    """The points on leaves, by their numbers, where conditions change to and from natural ones along the edge.

    Both edges are one: from the point the first goes so that inside is to the left.

    Examples
    --------
    >>> import rsym
    >>> (found,) = flat_corners(rsym.disc(1), [(np.array([0.0, -1.0]), 0, (True, False))])
    >>> found.edges.round(12).tolist(), 0 < found.reach <= 2
    ([[1.0, 0.0], [-1.0, 0.0]], True)
    """
    leaves, named, box = leaf_boxes(shape), shape_leaf_names(shape), _box(shape, None, None)
    size = float(np.hypot(*box.sides[:, 0]))
    found = []
    for point, leaf, natural in places:
        slope = leaves.at(point[:, None])[leaf, 1:, 0]
        p, place = (float(slope[0]), float(slope[1])), (float(point[0]), float(point[1]))
        both = named[leaf], named[leaf]
        found.append(PlaneCorner(place, math.pi, (leaf, leaf), both, (p, p), 0.0, natural=natural))
    return _with_reaches(leaves, found, [np.array([corner.leaves[0]]) for corner in found], size)


def _with_reaches(
    leaves: LeafBoxes, found: Sequence[PlaneCorner], met: Sequence[Ints], size: float
) -> tuple[PlaneCorner, ...]:
    """The corners with their reaches, straight edges known; `met` are the leaves that vanish at each."""
    known = [k for k, corner in enumerate(found) if not corner.is_cusp]
    if not known:
        return tuple(found)
    straight = _straight(leaves, [found[k] for k in known], size)
    own = [replace(found[k], straight=(bool(p), bool(q))) for k, (p, q) in zip(known, straight, strict=True)]
    tips = Tips(
        np.array([corner.point for corner in own]).reshape(-1, 2),
        np.array([corner.leaves for corner in own], np.int64).reshape(-1, 2),
        np.array([(one.gradients[0], one.edges[0]) if one.is_flat else one.gradients for one in own]).reshape(-1, 2, 2),
        np.array([corner.angle for corner in own]),
        straight,
        [met[k] for k in known],
    )
    far = reaches(leaves, tips, size).tolist()
    made = {k: replace(corner, reach=reach) for k, corner, reach in zip(known, own, far, strict=True)}
    return tuple(made.get(k, corner) for k, corner in enumerate(found))


def _box(shape: Shape, letters: Mapping[Any, float] | None, bounds: Any) -> Boxes:
    """Where to look."""
    low, high = np.array(bounds_or_extent(shape, bounds, letters), float).T[:, :, None]
    return Boxes(low - WIDER * (high - low), high + WIDER * (high - low))


def _at(
    shape: Shape, leaves: LeafBoxes, meeting: CommonZero, letters: Mapping[Any, float] | None
) -> tuple[Ints, list[Sector]]:
    """The leaves that vanish at a place where some meet, and the sectors inside around it."""
    near = leaves.over(Boxes(*(meeting.point[:, None] + side * 4 * meeting.radius for side in (-1, 1))))[..., 0]
    signs = (near[:, 0, 0] > 0).astype(int) - (near[:, 0, 1] < 0)
    matter = leaves.matter(near[..., None])[:, 0]
    if not matter.any():
        return np.empty(0, np.int64), []
    met = np.flatnonzero(signs == 0)
    steady = leaves.steady(near[..., None])[:, 0]
    for leaf in met[matter[met] & ~steady[met]]:
        raise RsymError(
            f"a leaf has a kink or no gradient there: {shape_leaf_names(shape)[leaf]}",
            code=SINGULAR,
            where=f"({meeting.point[0]:.10g}, {meeting.point[1]:.10g})",
            remedy="join the parts that meet there by R-operations, so that each has a formula of its own",
        )
    met = met[steady[met]]
    gradients = {leaf: near[leaf, 1:].mean(axis=1) for leaf in met.tolist()}
    hessians = dict.fromkeys(gradients, np.zeros(3))
    if meeting.touching:
        found = leaf_jets(shape, tuple(gradients), letters).at(meeting.point[None])
        hessians = dict(zip(gradients, found[:, 3:, 0], strict=True))
    return met, sectors(leaves.form.gates, signs.tolist(), gradients, hessians)


def _corner(
    leaves: LeafBoxes, named: tuple[str, ...], meeting: CommonZero, sector: Sector, *, alone: bool
) -> PlaneCorner | None:
    """The corner that a sector is, of unknown reach; None if its edges go on as each other."""
    both = sector.first, sector.second
    if abs(sector.opening - math.pi) < STRAIGHT:
        return None
    slopes = leaves.at(meeting.point[:, None])[list(both), 1:, 0]
    angle = sector.opening if sector.opening in (0.0, 2 * math.pi) else _angle(slopes)
    (px, py), (qx, qy) = slopes.tolist()
    place = float(meeting.point[0]), float(meeting.point[1])
    parts, gradients = (named[both[0]], named[both[1]]), ((px, py), (qx, qy))
    return PlaneCorner(place, angle, both, parts, gradients, 0.0, alone)


def _straight(leaves: LeafBoxes, own: Sequence[PlaneCorner], size: float) -> Flags:
    """Which edges (n, 2) are straight of leaves that are not linear: 0 at many places of their tangents, without kinks.

    Of a flat corner the second is what goes along it.
    """
    points = np.repeat([corner.point for corner in own], 2, axis=0).T
    slopes = np.array([corner.gradients for corner in own]).reshape(-1, 2).T
    numbers = np.array([corner.leaves for corner in own]).ravel()
    lengths = np.hypot(*slopes)
    p, q = slopes / lengths
    on = points[:, :, None] + size * ALONG * np.stack([-q, p])[:, :, None]
    beside = on + size * ALONG[::-1] * np.stack([p, q])[:, :, None]
    with np.errstate(all="ignore"):
        found = leaves.at(np.concatenate([on, beside], axis=2).reshape(2, -1))
        found = found.reshape(leaves.count, 3, len(numbers), -1)[numbers, :, np.arange(len(numbers))]
        values, gradients = found[:, 0, : len(ALONG)], found[:, 1:, len(ALONG) :]
        zero = np.abs(values).max(axis=1) <= ON_LINE * size * lengths
        linear = np.abs(gradients - slopes.T[:, :, None]).max(axis=(1, 2)) <= ON_LINE * lengths
    straight: Flags = (zero & ~linear & ~np.array(leaves.kinked)[numbers]).reshape(-1, 2)
    straight[:, 1] |= [corner.is_flat for corner in own]
    return straight


def _angle(slopes: Floats) -> float:
    """From the edge with the first inner normal counter-clockwise to that with the second."""
    (p, q), (u, v) = slopes
    return math.atan2(q * u - p * v, -(p * u + q * v)) % (2 * math.pi)
