"""Repetition: of a body that is its own image under motions it is enough to search one piece.

- Reflections x -> -x, x <-> y, x <-> -y that map the bounds onto themselves: of all images of a point under them, the
  one that lies farthest in a given direction is on the inner side of every mirror. So every point of the boundary is
  the image of one in that chamber.
- Where a coordinate does not occur, a layer across it is enough.
- Along an axis about which a body turns as it climbs, omega(R(-k z)(x, y)), every point has an image in any layer
  across the axis, at its own distance from it.

What is proved of a neighbourhood of each point of the piece holds of a neighbourhood of all its images. A defect in the
piece is one of the body, but not the whole list of them: then the whole region is searched.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, product

import numpy as np
import sympy as sp

from rsym.arrays import Flags
from rsym.model.shape import Shape
from rsym.model.symbols import postorder, rebuild, symbols_of
from rsym.verify.boxes.local import Box, Model
from rsym.verify.cover.images import Boxes
from rsym.verify.cover.likeness import Likeness

LAYER = 2.0**-10  # of the extent: about the boxes that it takes where a surface is not simple
LONGEST = 4_000  # parts of a program, beyond which to look for reflections takes longer than they may spare

CHAMBERS = 16  # of a piece which costs a sixteenth of the search or less

Normal = tuple[int, int, int]
Motion = tuple[tuple[int, int], ...]  # of the coordinates of the image, which of the point each is, and its sign


@dataclass(frozen=True)
class Repetition:
    """The piece of a region that is searched, and what covers the region with its images.

    mirrors: inner normals of the reflections; region: the bounds, thin across the axes along which the body repeats
    itself, of which `same` are those along which nothing changes and `axis` the one about which the body turns.
    """

    mirrors: tuple[Normal, ...]
    region: Box
    same: tuple[int, ...] = ()
    axis: int | None = None

    def meets(self, boxes: Boxes) -> Flags:
        """Which boxes (n, k, 2) have a point on the inner side of every mirror, each mirror for itself.

        Examples
        --------
        >>> boxes = np.array([[(0.0, 1.0), (0.5, 2.0), (0.0, 1.0)], [(0.0, 1.0), (1.5, 2.0), (0.0, 1.0)]])
        >>> Repetition(((1, -1, 0),), ((-2.0, 2.0),) * 3).meets(boxes).tolist()
        [True, False]
        """
        found = np.ones(len(boxes), bool)
        for normal in self.mirrors:
            farthest = [part * boxes[:, axis, int(part > 0)] for axis, part in enumerate(normal) if part]
            found &= np.sum(farthest, axis=0) >= 0  # two numbers at most: rounding does not change the sign of a sum
        return found

    def images(self, boxes: Boxes, whole: Box) -> Boxes:
        """The images of boxes in space, as far as they are boxes: not those of a body that turns."""
        spread = boxes.copy()
        for axis in self.same:
            spread[:, axis] = whole[axis]
        return np.concatenate([_moved(spread, motion) for motion in self.motions])

    @cached_property
    def motions(self) -> tuple[Motion, ...]:
        """All that the reflections make, one after the other."""
        found: dict[Motion, None] = {((0, 1), (1, 1), (2, 1)): None}
        waiting = list(found)
        while waiting:
            motion = waiting.pop()
            for image in (_after(_reflection(normal), motion) for normal in self.mirrors):
                if image not in found:
                    found[image] = None
                    waiting.append(image)
        return tuple(found)

    @property
    def is_small(self) -> bool:
        """Whether the piece is so small a part of the region that it is worth a search that may be in vain."""
        return len(self.motions) >= CHAMBERS or bool(self.same) or self.axis is not None

    @property
    def sentence(self) -> str:
        """By what the rest of the region follows from the piece."""
        reflections = f"{len(self.mirrors)} reflections" if len(self.mirrors) > 1 else "a reflection"
        parts = [reflections] * bool(self.mirrors) + ["shifts"] * bool(self.same)
        parts += ["a screw motion"] * (self.axis is not None)
        return f"one piece was searched; the rest is made of its images under {' and '.join(parts)}, which keep omega"


def repetition(model: Model, region: Box) -> Repetition | None:
    """What repeats itself in a region, but for turns; None where nothing is seen to.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - 2 * y**2 - 2 * z**2, (x, y, z))
    >>> repetition(Model(ball, {}), ((-2, 2),) * 3).mirrors
    ((1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 1, -1), (0, 1, 1))
    """
    parts = model.order(model.root)
    present = {model.builder.nodes[part].data for part in parts if model.builder.nodes[part].operation == "input"}
    same = tuple(k for k, name in enumerate(model.builder.coordinates) if name not in present)
    layer = _layer(region, same)
    mirrors = tuple(_mirrors(model, layer)) if len(parts) <= LONGEST else ()
    return Repetition(mirrors, layer, same) if mirrors or same else None


def turning(shape: Shape, region: Box) -> Repetition | None:
    """A layer across the axis about which a body turns as it climbs, as wide as the region is when it is turned.

    Examples
    --------
    >>> import rsym
    >>> bar = rsym.screw(rsym.ellipse(2, 1), 8)
    >>> turning(bar, ((-2, 2),) * 3).axis, turning(rsym.sphere(1), ((-2, 2),) * 3)
    (2, None)
    """
    axis = _screw_axis(shape)
    if axis is None:
        return None
    radius = math.hypot(*(max(-low, high) for k, (low, high) in enumerate(region) if k != axis))
    reach = math.nextafter(radius, math.inf)
    wide = tuple(side if k == axis else (-reach, reach) for k, side in enumerate(region))
    return Repetition((), _layer(wide, (axis,)), (), axis)


def _layer(region: Box, axes: tuple[int, ...]) -> Box:
    """A region, thin across some axes."""
    extent = max(high - low for low, high in region[:3])
    middle = {k: region[k][0] + (region[k][1] - region[k][0]) / 2 for k in axes}
    thin = {
        k: (max(region[k][0], at - LAYER * extent), min(region[k][1], at + LAYER * extent)) for k, at in middle.items()
    }
    return tuple(thin.get(k, side) for k, side in enumerate(region))


def _mirrors(model: Model, region: Box) -> Iterator[Normal]:
    """The normals of the reflections that keep the region and the sign of omega, away from the same side of a point.

    The point (1, 5/8, 9/32) is on none of the mirrors.
    """
    likeness = None
    for normal in ((1, 0, 0), (0, 1, 0), (0, 0, 1), *_diagonal()):
        motion = _reflection(normal)
        if tuple(map(tuple, _moved(np.array([region[:3]]), motion)[0].tolist())) == tuple(map(tuple, region[:3])):
            likeness = likeness or Likeness(model)
            names = model.builder.coordinates
            if likeness.holds({name: (names[k], sign) for name, (k, sign) in zip(names, motion, strict=True)}):
                yield normal


def _diagonal() -> Iterator[Normal]:
    for (i, j), sign in product(combinations(range(3), 2), (-1, 1)):
        yield tuple(1 if k == i else sign if k == j else 0 for k in range(3))  # type: ignore[misc]


def _reflection(normal: Normal) -> Motion:
    """The reflection that turns a normal round: one coordinate changes its sign, or two change places."""
    axes = [k for k in range(3) if normal[k]]
    if len(axes) == 1:
        return tuple((k, -1 if k == axes[0] else 1) for k in range(3))
    (i, j), sign = axes, -normal[axes[0]] * normal[axes[1]]
    return tuple({i: (j, sign), j: (i, sign)}.get(k, (k, 1)) for k in range(3))


def _after(second: Motion, first: Motion) -> Motion:
    return tuple((first[k][0], first[k][1] * sign) for k, sign in second)


def _moved(boxes: Boxes, motion: Motion) -> Boxes:
    """The images of boxes, exactly."""
    moved = boxes.copy()
    for axis, (k, sign) in enumerate(motion):
        moved[:, axis] = boxes[:, k] if sign > 0 else -boxes[:, k, ::-1]
    return moved


def _screw_axis(shape: Shape) -> int | None:
    """The axis along which a body climbs as it turns, right- or left-handed; None if the equation does not show one."""
    for axis in range(3):
        along = shape.coordinates[axis]
        angles = {
            part.args[0]
            for part in postorder(shape.expression)
            if isinstance(part, sp.sin | sp.cos) and along in symbols_of(part.args[0])
        }
        for angle in sorted(angles, key=sp.default_sort_key)[:2]:
            steady = not set(symbols_of(angle / along)) & set(shape.coordinates)
            if steady and _turns(shape, axis, angle):
                return axis
    return None


def _turns(shape: Shape, axis: int, angle: sp.Expr) -> bool:
    """Whether the coordinates occur in those of a frame that turns by an angle and in the distance from the axis alone.

    X = x cos(angle) + y sin(angle), Y = y cos(angle) - x sin(angle), x**2 + y**2 = X**2 + Y**2.
    """
    first, second = (symbol for k, symbol in enumerate(shape.coordinates) if k != axis)
    frame = sp.symbols("X Y", cls=sp.Dummy, real=True)
    for one, other in ((first, second), (second, first)):
        replaced = rebuild(shape.expression, lambda part: _in_frame(part, one, other, angle, frame))  # noqa: B023
        if not set(symbols_of(replaced)) & set(shape.coordinates):
            return True
    return False


def _in_frame(
    part: sp.Basic, one: sp.Symbol, other: sp.Symbol, angle: sp.Expr, frame: tuple[sp.Symbol, sp.Symbol]
) -> sp.Basic | None:
    """A sum with the terms that make coordinates of the frame replaced."""
    if not part.is_Add:
        return None
    cosine, sine = (f(angle, evaluate=False) for f in (sp.cos, sp.sin))
    wanted = {
        "xc": one * cosine,
        "ys": other * sine,
        "yc": other * cosine,
        "xs": one * sine,
        "xx": one**2,
        "yy": other**2,
    }
    found: dict[str, list[sp.Expr]] = {name: [] for name in wanted}
    rest = []
    for term in part.args:
        for name, what in wanted.items():
            coefficient = term / what
            if not {one, other} & set(symbols_of(coefficient)) and not coefficient.has(angle):
                found[name].append(coefficient)
                break
        else:
            rest.append(term)
    xc, ys, yc, xs, xx, yy = (sp.Add(*terms) for terms in found.values())
    if xc != ys or yc != -xs or xx != yy:
        return None
    return sp.Add(*rest, xc * frame[0], yc * frame[1], xx * (frame[0] ** 2 + frame[1] ** 2))
