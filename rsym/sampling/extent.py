"""Bounds that are found: a proved box around the zero set of a shape.

1. Beyond a cube the directions are divided until over each cone the sign is
   known; a zero set that goes on beyond 1e12 has no box.
2. The cube is divided into a grid; what is left is the box around those grid
   boxes whose sign is not known, again and again until it stays.
3. From each side slabs without zeros are taken off, thinner and thinner, down to
   a hundredth of the side; what is left gets a margin.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rsym.arrays import Flags, Floats
from rsym.errors import RsymError
from rsym.logic.lifting import opened
from rsym.logic.sign_form import SignForm, surface_form
from rsym.model.recent import recently, written
from rsym.model.requirements import require_shape
from rsym.model.shape import Bounds, Shape
from rsym.sampling.form_signs import (
    Boxes,
    FormBounds,
    FormSigns,
    LeafBounds,
    check_parameters,
    cube,
    grid,
    halves,
    points,
    slabs,
)

LARGEST, SMALLEST = 2.0**40, 2.0**-40  # 1e12, far beyond any model in any unit, and 1e-12
DEEPEST = 9  # halvings of cones and slabs: a cone is then 1/256 of a cube's face
MOST = 4096  # boxes left open at once; the paper's models need a tenth of that
GRID = {2: 16, 3: 8}  # boxes along each axis: 256 or 512 in all fill the vectors
SLACK, MARGIN = 1 / 100, 1 / 200  # of a side; on simple bodies a box is then 3 % too long at most


def extent(shape: Shape, letters: Mapping[Any, float] | None = None) -> Bounds:
    """The bounds of the zero set of a shape: a box that provably contains it, a few per cent longer on simple bodies.

    Parameters
    ----------
    shape : Shape
        In the plane or in space; a window that it states is not looked at.
    letters : mapping, optional
        Override the defaults.

    Returns
    -------
    tuple of pairs
        As `Shape` takes them. Outside, the shape has one sign.

    Raises
    ------
    RsymError
        ``unbounded`` where the zero set goes on beyond 1e12, ``unproved`` where it cannot be proved to end, with the
        directions; ``empty`` where there is none.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> (left, right), (bottom, top) = extent(rsym.Shape(1 - (x - 5) ** 2 - y**2 / 4, (x, y)))
    >>> 3.97 < left < 4 < 6 < right < 6.03 and -2.06 < bottom < -2 < 2 < top < 2.06
    True
    """
    require_shape(shape)
    return _extent(shape, tuple(shape.letters.values_with(letters).items()))


@recently(16, written)
def _extent(shape: Shape, values: tuple[tuple[str, float], ...]) -> Bounds:
    return extent_of(proved_signs(shape, dict(values)))


def proved_signs(shape: Shape, letters: Mapping[Any, float] | None = None) -> FormSigns:
    """The signs of its form over boxes and cones, of a large one by tapes where the packages for them are there."""
    bounds, values = _leaf_bounds(shape), shape.letters.values_with(letters)
    check_parameters(bounds.form, values)
    return FormSigns(bounds, values)


@recently(16, written)
def _leaf_bounds(shape: Shape) -> LeafBounds:
    form = opened_form(shape)
    try:
        from rsym.sampling.kernels.mesher_kernels import backend_for
        from rsym.sampling.regions.region_signs import TapedBounds
    except (ImportError, OSError):
        return FormBounds(form)
    return TapedBounds(form) if backend_for(form) == "tape" else FormBounds(form)


def extent_of(signs: FormSigns) -> Bounds:
    """The bounds of the zero set of a form at letters."""
    dimension = len(signs.coordinates)
    outside, left = _sign_beyond(signs, LARGEST)
    if not outside:
        raise _unbounded(signs, left)
    box = _contracted(signs, cube(dimension, LARGEST))
    # Where boxes as large as their distance say nothing, cones may.
    while _sign_beyond(signs, size := _reach(box) / 4, outside)[0]:
        box = _contracted(signs, cube(dimension, size))
    box = _trimmed(signs, box, outside)
    margin = box.sides * MARGIN
    return tuple(zip((box.lower - margin)[:, 0].tolist(), (box.upper + margin)[:, 0].tolist(), strict=True))


def opened_form(shape: Shape) -> SignForm:
    """Its sign form, with roots lifted where that helps bounds."""
    return opened(surface_form(shape))


def holds_boundary(signs: FormSigns, bounds: Bounds) -> bool:
    """Whether it is proved, with little work, that all that lies outside some bounds has one sign."""
    lower, upper = np.array(bounds)[:, :1], np.array(bounds)[:, 1:]
    whole = cube(len(bounds), _reach(Boxes(lower, upper)))
    outside, _ = _sign_beyond(signs, float(whole.upper.max()))
    if not outside:
        return False
    sides = slabs(whole, np.hstack([lower - whole.lower, whole.upper - upper]))
    return bool(_free(signs, sides, outside)[0].all())


def _reach(box: Boxes) -> float:
    return float(max(-box.lower.min(), box.upper.max()))


def _sign_beyond(signs: FormSigns, size: float, expected: int = 0) -> tuple[int, Boxes]:
    """The sign beyond a cube, or 0 and the directions left; a point without the sign expected ends the search."""
    cones, seen = _faces(len(signs.coordinates)), {0}
    for _ in range(DEEPEST):
        found = signs.beyond(cones, size)
        seen |= set(found.tolist())
        cones = cones[found == 0]
        if not len(cones) and len(seen - {0}) == 1:
            return max(seen, key=abs), cones
        if len(cones) > MOST or (expected and (signs.over(points(cones.centres * size)) == -expected).any()):
            break
        cones, _ = halves(cones)
    return 0, cones


def _faces(dimension: int) -> Boxes:
    """The faces of the cube max|u_i| = 1."""
    return slabs(cube(dimension, 1.0), np.zeros((dimension, 2)))


def _contracted(signs: FormSigns, box: Boxes) -> Boxes:
    """The box around the grid boxes whose sign is not known, until that is hardly smaller."""
    while True:
        parts = grid(box, GRID[len(signs.coordinates)])
        parts = parts[signs.over(parts) == 0]
        if not len(parts) or parts.hull().sides.max() < SMALLEST:
            raise _empty()
        before, box = box, parts.hull()
        if (box.sides > 0.8 * before.sides).all():
            return box


def _trimmed(signs: FormSigns, box: Boxes, outside: int) -> Boxes:
    """The box without slabs at its sides that have the sign of the outside.

    `known` (dim, 2) is how far from each side a slab cannot reach: a point with the other sign is there, or a slab of
    that thickness was tried in vain.
    """
    known = np.full((len(box.lower), 2), np.inf)
    while (thick := known > SLACK * box.sides).any():
        if box.sides.max() < SMALLEST:
            raise _empty()
        thickness = np.where(thick, np.minimum(known / 2, box.sides / 4), 0.0)
        free, depths = _free(signs, slabs(box, thickness), outside)
        known = np.where(thick, np.where(free, known - thickness, np.minimum(depths, thickness)), known)
        taken = np.where(free, thickness, 0.0)
        box = Boxes(box.lower + taken[:, :1], box.upper - taken[:, 1:])
    return box


def _free(signs: FormSigns, sides: Boxes, outside: int) -> tuple[Flags, Floats]:
    """Which slabs at the sides of a box have the sign of the outside all over, (dim, 2).

    For the others, how far from the side the nearest point with another sign was met.
    """
    slab, boxes = np.arange(len(sides)), sides
    free, depths = np.ones(len(sides), bool), np.full(len(sides), np.inf)
    for _ in range(DEEPEST):
        found = signs.over(boxes.followed_by(points(boxes.centres)))
        other = (found[: len(boxes)] == -outside) | (found[len(boxes) :] == -outside)
        np.minimum.at(depths, slab[other], _depths(boxes[other], sides, slab[other]))
        counts = np.bincount(slab[found[: len(boxes)] == 0], minlength=len(sides))
        free &= np.isinf(depths) & (counts <= MOST)
        going = (found[: len(boxes)] == 0) & free[slab]
        boxes, origin = halves(boxes[going])
        slab = slab[going][origin]
        if not len(boxes):
            break
    free[slab] = False
    return free.reshape(-1, 2), depths.reshape(-1, 2)


def _depths(boxes: Boxes, sides: Boxes, slab: NDArray[np.intp]) -> Floats:
    """How far the centres of boxes lie from the outer face of their slabs."""
    axis, column = slab // 2, np.arange(len(boxes))
    centre = boxes.centres[axis, column]
    lower, upper = sides.lower[axis, slab], sides.upper[axis, slab]
    depths: Floats = np.where(slab % 2 == 0, centre - lower, upper - centre)
    return depths


def _unbounded(signs: FormSigns, left: Boxes) -> RsymError:
    places = np.hstack([left.lower, left.centres, left.upper]) * LARGEST
    seen = set(signs.over(points(places)).tolist())
    goes_on = {-1, 1} <= seen
    verdict = "goes on beyond 1e12" if goes_on else "could not be proved to end"
    return RsymError(
        f"the zero set {verdict} in the directions {', '.join(_directions(signs.coordinates, left))}",
        code="unbounded" if goes_on else "unproved",
        remedy="give bounds=((xmin, xmax), ...), or cut the shape off with a bounded one",
    )


def _directions(names: tuple[str, ...], left: Boxes) -> list[str]:
    """The axes among the directions left; without any, three of the directions."""
    axes = []
    for column, face in enumerate(_faces(len(names)).centres.T):
        if ((left.lower <= face[:, None]) & (face[:, None] <= left.upper)).all(axis=0).any():
            axes.append("-+"[column % 2] + names[column // 2])
    if axes:
        return axes
    some = left.centres[:, :: -(-len(left) // 3)]
    units = some / np.linalg.norm(some, axis=0)
    return ["(" + ", ".join(f"{value:.2f}" for value in unit) + ")" for unit in units.T]


def _empty() -> RsymError:
    return RsymError(
        "the zero set is empty: the shape has one sign everywhere, or differs from that only within 1e-12",
        code="empty",
        remedy="check signs and letters: omega must be positive inside and negative outside",
    )
