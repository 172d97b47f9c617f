"""Random points of a shape: inside it, on its boundary or on one part of that, uniformly by area, length or volume.

Inside: boxes that are proved to be outside are thrown away, points of the others that are outside too; what is left is
uniform, whatever the boxes. On the boundary: points of the chords or triangles of a fine polygon or mesh are moved onto
their leaf, and kept in proportion to how much longer or larger the boundary is there than the chord or triangle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError, warn
from rsym.logic.inside import inside_kernel
from rsym.model.requirements import require_count, require_shape
from rsym.model.shape import Bounds, Shape
from rsym.model.wording import proposal
from rsym.sampling.extent import proved_signs
from rsym.sampling.form_signs import Boxes, FormSigns, halves
from rsym.sampling.labels import BOUNDARY, Labeller, Labels
from rsym.sampling.leaf_fields import LeafFields, distances, longest_side
from rsym.sampling.memory import Budget, TooLarge, free_memory
from rsym.sampling.meshing import mesh
from rsym.sampling.outlines import outline
from rsym.sampling.plane import plane_sampler
from rsym.sampling.plane_leaves import NEWTON_STEPS, leaves_of
from rsym.sampling.windows import bounds_or_extent

Names: TypeAlias = NDArray[np.str_]

INSIDE = "inside"
RESOLUTION = {2: 512, 3: 128}
CANDIDATES = 8  # for each point of a stratified sample
OPEN = 1 / 4  # of the volume of the boxes kept: so little of unknown sign is small enough
MOST_BOXES = 1 << 15
BATCH = 1 << 16
MOST_EMPTY = 32  # batches without a point, one after the other
# The boundary is at most so much larger than its chords and triangles, but for what the resolution does not resolve.
LARGEST_STRETCH = 1.25
NEAR = 1e-9  # of the size: points farther from the active leaf, or beyond the bounds, are not of the boundary


@dataclass(frozen=True, eq=False)
class Samples:
    """Random points of a shape.

    Attributes
    ----------
    points : (n, dim) array
    normals : (n, dim) array, or None for points inside
        Outward unit normals, those of the leaf that a point lies on.
    parts : (n,) array of str, or None for points inside
        The part that a point lies on, as a mesh names it: a part of the shape, or else a leaf by its formula.

    Examples
    --------
    >>> import rsym
    >>> found = rsym.sample(rsym.disc(1), 3, rng=1)
    >>> found.points.shape, found.normals, found.parts
    ((3, 2), None, None)
    """

    points: Floats
    normals: Floats | None = None
    parts: Names | None = None

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        where = "inside" if self.parts is None else f"on {', '.join(np.unique(self.parts)[:5])}"
        return f"Samples({len(self)} points {where[:100]})"


class _Drawn(NamedTuple):
    """Points (k, dim), a number by whose order neighbours lie together, and what is known on a boundary."""

    points: Floats
    order: Floats
    normals: Floats | None = None
    parts: Names | None = None

    def take(self, which: NDArray[Any]) -> _Drawn:
        return _Drawn(*(None if one is None else one[which] for one in self))  # type: ignore[arg-type]


_Source: TypeAlias = Callable[[int, np.random.Generator], _Drawn]  # about so many points, independent and uniform


def sample(
    shape: Shape,
    n: int,
    *,
    over: str = INSIDE,
    rng: Any = None,
    stratified: bool = False,
    bounds: Any = None,
    letters: Mapping[Any, float] | None = None,
    resolution: Any = None,
) -> Samples:
    """Random points of a shape, uniform by area or volume inside, by length or area on the boundary.

    Inside they are exactly so. On the boundary they lie on a leaf to rounding; how far their density is from uniform
    goes down with the fourth power of the cell against the radius of curvature, with its square beside curved edges; in
    the plane to nothing but rounding. Where the boundary bends within a cell, or has detail that a mesh of the same
    resolution misses or warns of, it needs a finer one.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    n : int
        How many points.
    over : str
        "inside", "boundary", or the name of a part, for points of the boundary on that part.
    rng : int, numpy.random.Generator or None
        A seed or a generator; the same seed gives the same points. Without it every call gives others.
    stratified : bool
        Whether the points are spread evenly, each drawn from its own n-th of the shape: the same density, sums that
        vary less; the points are then no longer independent.
    bounds, letters
        Override those of the shape. Points outside of the bounds are not drawn; without any, the shape must end.
    resolution : int or one for each axis, optional
        Of the mesh, or of the lattice in the plane, that points of the boundary start from; by default 128 in space
        and 512 in the plane.

    Returns
    -------
    Samples
        ``.points`` (n, dim), and for the boundary ``.normals`` (n, dim), outward, and ``.parts`` (n,).

    Raises
    ------
    RsymError
        For a number of points that is not positive, an unknown part, one that has nothing of the boundary, a shape
        that is empty within its bounds, or that goes on without end and has none, more points than memory holds.

    Warns
    -----
    RsymWarning
        For a shape that leaves its own bounds; bounds given here are taken for what is wanted.

    Examples
    --------
    >>> import rsym
    >>> ring = rsym.disc(2).named("rim") - rsym.disc(1).named("hole")
    >>> inside = rsym.sample(ring, 1000, rng=1).points
    >>> bool(ring.contains(*inside.T).all())
    True
    >>> found = rsym.sample(ring, 1000, over="boundary", rng=1)
    >>> sorted(set(found.parts.tolist())), 600 < found.parts.tolist().count("rim") < 730
    (['hole', 'rim'], True)
    >>> hole = rsym.sample(ring, 4, over="hole", rng=1)
    >>> bool(abs(hole.normals + hole.points).max() < 1e-12)
    True
    """
    require_shape(shape)
    require_count("n", n, "for example sample(shape, 1000)")
    generator = _generator(rng)
    drawn_in_all = n * (CANDIDATES if stratified else 1)
    _check_memory(drawn_in_all, shape.dimension)
    if not isinstance(over, str):
        raise RsymError(f"over is inside, boundary or the name of a part, got {over!r}", code="over", remedy=INSIDE)
    if over == INSIDE:
        source = _inside(shape, bounds, letters)
    else:
        lines = _on_lines if shape.dimension == 2 else _on_surface
        fineness = RESOLUTION[shape.dimension] if resolution is None else resolution
        source = lines(shape, bounds, letters, fineness, over)
    drawn = _gathered(source, drawn_in_all, generator)
    if stratified:
        strata = np.argsort(drawn.order, kind="stable").reshape(n, CANDIDATES)
        drawn = drawn.take(generator.permutation(strata[np.arange(n), generator.integers(CANDIDATES, size=n)]))
    return Samples(drawn.points, drawn.normals, drawn.parts)


def _check_memory(count: int, dimension: int) -> None:
    """Refuse points that do not fit, those of a batch and put together."""
    try:
        Budget(free_memory()).claim(2.0 * 8 * (dimension + 1) * count)
    except TooLarge as error:
        raise RsymError(
            f"{count} points: {error.message}",
            code="memory",
            remedy="fewer at a time, one call after the other with one rng=numpy.random.default_rng(1)",
        ) from None


def _generator(rng: Any) -> np.random.Generator:
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError) as error:
        raise RsymError(
            f"expected a seed or a numpy.random.Generator, got {rng!r}", code="rng", remedy="for example rng=1"
        ) from error


def _gathered(source: _Source, count: int, generator: np.random.Generator) -> _Drawn:
    """So many points, by batches."""
    found: list[_Drawn] = []
    missing, empty = count, 0
    while missing > 0:
        found.append(source(min(missing + missing // 8 + 64, BATCH), generator))
        missing -= len(found[-1].points)
        empty = 0 if len(found[-1].points) else empty + 1
        if empty > MOST_EMPTY:
            raise RsymError(
                f"no point found in {empty} batches: the shape is empty in its bounds, very thin, or undefined",
                code="empty",
                remedy="check signs and letters, or give bounds=... that fit it",
            )
    columns = zip(*found, strict=True)
    return _Drawn(*(None if one[0] is None else np.concatenate(one)[:count] for one in columns))  # type: ignore[arg-type]


def _inside(shape: Shape, bounds: Any, letters: Mapping[Any, float] | None) -> _Source:
    """Points of boxes that hold the inside, those alone where omega is positive."""
    box = bounds_or_extent(shape, bounds, letters)
    lower, upper = np.array(box).T
    own = bounds is None and shape.bounds is None
    if own and shape.contains(*lower, letters=letters):
        raise RsymError(
            "the inside goes on without end", code="unbounded", remedy="give bounds=((xmin, xmax), ...), or ~shape"
        )
    boxes, within = _holding(proved_signs(shape, letters), Boxes(lower[:, None], upper[:, None]))
    if bounds is None and ((within.lower == lower[:, None]) | (within.upper == upper[:, None])).any():
        warn("the shape leaves its bounds; points are drawn within them alone, wider bounds=... hold all of it")
    volumes = np.prod(boxes.sides, axis=0)
    shares = np.cumsum(volumes / volumes.sum())
    kernel = inside_kernel(shape)
    hits = draws = 0

    def draw(count: int, generator: np.random.Generator) -> _Drawn:
        nonlocal hits, draws
        size = count if not draws else min(BATCH, count * draws // max(hits, 1))
        which = np.minimum(np.searchsorted(shares, generator.random(size), side="right"), len(shares) - 1)
        points = (boxes.lower[:, which] + boxes.sides[:, which] * generator.random((len(lower), size))).T
        with np.errstate(invalid="ignore"):
            points = points[kernel(*points.T, letters=letters)["value"] > 0]
        hits, draws = hits + len(points), draws + size
        return _Drawn(points, _along_a_curve(points, box))

    return draw


def _holding(signs: FormSigns, boxes: Boxes) -> tuple[Boxes, Boxes]:
    """Boxes that together hold all of the inside, and those of them, most, that hold nothing else."""
    within = boxes[np.zeros(0, int)]
    while True:
        found = signs.over(boxes)
        within, boxes = within.followed_by(boxes[found > 0]), boxes[found == 0]
        kept = within.followed_by(boxes)
        if not len(kept):
            raise RsymError(
                "the shape is empty: omega is negative all over its bounds",
                code="empty",
                remedy="check signs, letters and bounds",
            )
        left, whole = (float(np.prod(one.sides, axis=0).sum()) for one in (boxes, kept))
        if left <= OPEN * whole or len(kept) > MOST_BOXES:
            return kept, within
        boxes, _ = halves(boxes)


def _along_a_curve(points: Floats, box: Bounds) -> Floats:
    """The places of points along a curve through the box that visits one quarter after the other (Morton's)."""
    lower, upper = np.array(box).T
    with np.errstate(invalid="ignore"):
        steps = np.clip((points - lower) / (upper - lower) * (1 << 16), 0, (1 << 16) - 1).astype(np.uint64)
    code = np.zeros(len(points), np.uint64)
    for bit in range(16):
        for axis in range(points.shape[1]):
            place = np.uint64(bit * points.shape[1] + axis)
            code |= (steps[:, axis] >> np.uint64(bit) & np.uint64(1)) << place
    return code.astype(np.float64)


def _on_surface(shape: Shape, bounds: Any, letters: Mapping[Any, float] | None, resolution: Any, over: str) -> _Source:
    """Points of triangles, moved onto their leaf.

    A point at the distance d outside of where it is moved to, on a triangle inclined by t, stands for cos t/(1 + 2 H d)
    of its area on the surface, but for d^2.
    """
    box = bounds_or_extent(shape, bounds, letters)
    body = mesh(shape, resolution, bounds=box, letters=letters, cap=False)
    fields = LeafFields(shape, ("mean_curvature",), letters)
    on_faces, middles = fields.on_faces(body), body.vertices[body.faces].mean(axis=1)
    leaf = fields.active(middles) if body.leaf is None else body.leaf.copy()
    walls = [*fields.form.walls]
    if (ends := np.isin(leaf, walls)).any():
        leaf[ends] = fields.bounding(fields.at(leaf[ends], middles[ends], longest_side(body))["point"])
    label = body.called if callable(body.called) else Labeller(shape, letters)
    a, b, c = (body.vertices[body.faces[:, k]] for k in range(3))
    areas = np.linalg.norm(flat := np.cross(b - a, c - a), axis=1)
    shares = np.cumsum(np.where(_wanted(shape, label(middles, leaf), over) & ~np.isin(leaf, walls), areas, 0.0))

    def draw(count: int, generator: np.random.Generator) -> _Drawn:
        faces = np.searchsorted(shares, shares[-1] * generator.random(count), side="right")
        one, two = np.sqrt(generator.random(count)), generator.random(count)
        weights = np.stack([1 - one, one * (1 - two), one * two], axis=1)
        start = np.einsum("ij,ijk->ik", weights, body.vertices[body.faces[faces]])
        found, plane = on_faces(faces, weights), flat[faces] / areas[faces][:, None]
        with np.errstate(all="ignore"):
            normals = -found["gradient"] / np.linalg.norm(found["gradient"], axis=1)[:, None]
            off = np.einsum("ij,ij->i", start - found["point"], normals)
            stretch = np.einsum("ij,ij->i", normals, plane) / (1 + 2 * found["mean_curvature"] * off)
        normals = np.where(np.isfinite(normals).all(axis=1)[:, None], normals, plane)
        active = fields.bounding(found["point"])  # chords at a hollow edge lie off it
        away = np.where(np.isin(active, walls), np.inf, distances(fields.at(active, found["point"])))
        kept = _kept(stretch, found["point"], away, box, generator)
        there = label(found["point"][kept], leaf[faces[kept]])
        kept, names = kept[there.on(over)], there.each[there.on(over)]
        return _Drawn(found["point"][kept], _along_a_curve(found["point"][kept], box), normals[kept], names)

    return draw


def _on_lines(shape: Shape, bounds: Any, letters: Mapping[Any, float] | None, resolution: Any, over: str) -> _Source:
    """Points of the chords of a polygon, moved onto their leaf across the chord: the arc is a graph over its chord."""
    box = bounds_or_extent(shape, bounds, letters)
    sampler = plane_sampler(shape, "value", resolution=resolution, bounds=box, letters=letters)
    leaves = leaves_of(shape, (0, 1), {}, letters, box)
    leaves.form.require_traced()
    lines = [np.empty((0, 2)), *outline(sampler, leaves)]
    start, end = (np.concatenate([line[part] for line in lines]) for part in (slice(None, -1), slice(1, None)))
    along, middles = end - start, (start + end) / 2
    length, leaf, label = np.hypot(*along.T), leaves.active(middles)[1], Labeller(shape, letters)
    if (ends := np.isin(leaf, leaves.walls)).any():
        leaf[ends] = leaves.of_active(leaves.slide(middles[ends], leaf[ends]))[2]
    shares = np.cumsum(np.where(_wanted(shape, label(middles, leaf), over), length, 0.0))
    with np.errstate(all="ignore"):
        across = np.stack([along[:, 1], -along[:, 0]], axis=1) / length[:, None]  # the outside is to the right

    def onto(places: Floats, which: NDArray[Any], number: NDArray[Any]) -> Floats:
        """How far along the normals of their chords points are from a leaf."""
        moved = np.zeros(len(places))
        for _ in range(NEWTON_STEPS):
            ((value, gradient),) = leaves.of(places + moved[:, None] * across[which], number)
            slope = np.einsum("ij,ij->i", gradient, across[which])
            with np.errstate(all="ignore"):
                moved = moved - value / slope
        return np.where(np.abs(moved) <= length[which], moved, 0.0)

    def draw(count: int, generator: np.random.Generator) -> _Drawn:
        places = shares[-1] * generator.random(count)
        which = np.searchsorted(shares, places, side="right")
        at = end[which] - ((shares[which] - places) / length[which])[:, None] * along[which]
        number = leaf[which]
        points = at + onto(at, which, number)[:, None] * across[which]
        other = leaves.active(points)[1]
        (beyond,) = np.nonzero(other != number)  # the chord goes on from one leaf to the next
        back = onto(at[beyond], which[beyond], other[beyond])
        points[beyond] = at[beyond] + back[:, None] * across[which[beyond]]
        value, gradient, active = leaves.of_active(points)
        with np.errstate(all="ignore"):
            away = np.where(np.isin(active, leaves.walls), np.inf, np.abs(value) / np.linalg.norm(gradient, axis=1))
            normals = -gradient / np.hypot(*gradient.T)[:, None]
            stretch = 1 / np.einsum("ij,ij->i", normals, across[which])
        normals = np.where(np.isfinite(normals).all(axis=1)[:, None], normals, across[which])
        kept = _kept(stretch, points, away, box, generator)
        there = label(points[kept], leaf[which[kept]])
        kept, names = kept[there.on(over)], there.each[there.on(over)]
        return _Drawn(points[kept], places[kept], normals[kept], names)

    return draw


def _wanted(shape: Shape, labels: Labels, over: str) -> Flags:
    """Which pieces of the boundary belong to the part."""
    names = labels.each
    if not len(names):
        raise RsymError(
            "the shape has no boundary within its bounds", code="empty", remedy="check signs, letters and bounds"
        )
    if not labels.on(over).any():
        there = f"inside, boundary, or a part on the boundary: {', '.join(np.unique(names)[:20])}"
        what = "has nothing of the boundary" if over in dict(shape.parts) else "is no part of the shape"
        raise RsymError(
            f"{over!r} {what}", code="over", remedy=proposal(over, (INSIDE, BOUNDARY, *names.tolist()), there)
        )
    return labels.on(over)


def _kept(
    stretch: Floats, points: Floats, away: Floats, box: Bounds, generator: np.random.Generator
) -> NDArray[np.intp]:
    """Which points to keep, in proportion to the stretch; where that is not known it is taken for 1.

    Those of the boundary alone: what is `away` from its active leaf lies on the continuation of another one.
    """
    chance = np.where(np.isfinite(stretch), stretch, 1.0) / LARGEST_STRETCH
    lower, upper = np.array(box).T
    near = NEAR * float((upper - lower).max())
    within = ((lower - near <= points) & (points <= upper + near)).all(axis=1) & ~(away > near)
    return np.flatnonzero((generator.random(len(points)) < chance) & within)
