"""Mirrors: a shape and its images in one mirror, in mirrors through a point, in the mirrors of a polyhedron."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, number, point, unit_vector, whole
from rsym.model.bounding import Bounds
from rsym.model.equation import substituted
from rsym.model.motions import axis_vector
from rsym.model.nodes import Held
from rsym.model.requirements import require_shape
from rsym.model.shape import Shape
from rsym.model.symbols import rebuild, symbols_of
from rsym.model.symmetry.reflections import folded, turned_box, turned_coordinates, within_half_a_sector
from rsym.model.vectors import Vector, dot

_GOLDEN = (1 + sp.sqrt(5)) / 2
# The inner normals of the three mirrors that bound the chamber.
GROUPS: dict[str, tuple[tuple[Any, ...], ...]] = {
    "tetrahedral": ((1, -1, 0), (0, 1, -1), (0, 1, 1)),
    "octahedral": ((1, -1, 0), (0, 1, -1), (0, 0, 1)),
    "icosahedral": ((1, 0, 0), (0, 1, 0), (-_GOLDEN / 2, -sp.Rational(1, 2), (_GOLDEN - 1) / 2)),
}


def mirrored(shape: Shape, normal: Any = None, distance: Any = 0, *, letters: LetterMapping = None) -> Shape:
    """A shape and its mirror image: omega(p + (|s| - s) n), s = n . p - d, with the unit normal n.

    What lies on the side of the normal counts, what lies behind the mirror is
    replaced. Exact on both sides; on the mirror s = 0 there is a kink
    unless the boundary meets it at a right angle.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    normal : coordinate or direction, optional
        By default along the first coordinate, and then omega(|x|, y, ...).
    distance : number or expression
        d, of the mirror from the origin, in the unit of the coordinates.
    letters : mapping, optional
        Values of the letters in the normal and the distance.

    Raises
    ------
    RsymError
        For a normal of the wrong dimension, or of no length.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> mirrored(rsym.Shape(1 - (x - 2)**2 - y**2, (x, y))).expression
    -y**2 - (Abs(x) - 2)**2 + 1
    """
    require_shape(shape)
    known = shape.letters.merge(letters)
    n = axis_vector(shape, shape.coordinates[0] if normal is None else normal, "the normal", letters)
    d = number(distance, "the distance")
    depth = dot(n, shape.coordinates) - d
    beyond = sp.Abs(depth, evaluate=depth.is_Symbol) - depth
    places = {symbol: symbol + beyond * component for symbol, component in zip(shape.coordinates, n, strict=True)}
    unit = [default(component, known, "the normal") for component in n]
    away = default(d, known, "the distance")
    box = shape.box and shape.box.mapped(lambda ends: _reflected(ends, unit, away), stated=not symbols_of(d, *n))
    return substituted(shape, places, letters=letters, box=box)


def kaleidoscope(shape: Shape, order: Any, *, axis: Any = None) -> Shape:
    """A shape in the 2 n sectors between n mirrors through a point of the plane or an axis in space.

    What lies in the chamber 0 <= theta <= pi/n counts, every second sector
    holds a mirror image; the motif may be any. Exact inside the sectors, kinks on the
    mirrors theta = k pi/n unless the boundary meets them at a right angle. With

        X = the largest x cos(2 k pi/n) + y sin(2 k pi/n), Y = the largest with (2 k + 1) pi/n, k = 0..n - 1

    the folded point is (X, (Y - X cos(pi/n))/sin(pi/n)): no angle is taken, and the centre is not special.

    Parameters
    ----------
    shape : Shape
        In the plane or in space.
    order : integer
        n >= 2.
    axis : symbol, optional
        The coordinate of a shape in space about which to turn, as for `cyclic`.

    Raises
    ------
    RsymError
        For an order below 2, or a wrong axis.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> kaleidoscope(rsym.Shape(x - y - 1, (x, y)), 2).expression
    Abs(x) - Abs(y) - 1
    """
    require_shape(shape)
    n = whole(order, "the order", 2)
    first, second = turned_coordinates(shape, axis)
    places = dict(zip((first, second), within_half_a_sector(first, second, n), strict=True))
    return substituted(shape, places, box=turned_box(shape, (first, second)))


def mirror_group(shape: Shape, group: Any) -> Shape:
    """A shape in all chambers of a finite reflection group: of a polyhedron, or of given mirrors through the origin.

    "tetrahedral", 24 chambers: x >= y >= |z| counts
    "octahedral", 48: x >= y >= z >= 0
    "icosahedral", 120: x >= 0, y >= 0, z >= g**2 x + g y with the golden ratio g; the five-fold axis
        is (0, 1, g), the three-fold one (1/g, 0, g), the two-fold one z
    normals: n . p >= 0 for each

    The folded point is sum_i a_i h_i(p), a_i the normals, h_i the largest of the linear forms q . p
    over the images q of the vectors dual to the normals. Exact inside the chambers; on the
    mirrors there are kinks unless the boundary meets them at a right angle.

    Parameters
    ----------
    shape : Shape
        In space, or in the plane for normals with two components; any motif.
    group : text or sequence of points
        A name, or inner normals of the mirrors that bound the chamber: numbers, of any length.

    Raises
    ------
    RsymError
        For an unknown name, dependent normals, or mirrors whose reflections do not make a finite group.

    Source: Coxeter, Regular polytopes, chapters 5 and 11.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> cube = mirror_group(rsym.Shape(1 - x, (x, y, z)), "octahedral")
    >>> cube.expression
    1 - disjunction(Abs(x), Abs(y), Abs(z), system=R1)
    """
    require_shape(shape)
    normals = _normals(group, shape.dimension)
    places = dict(zip(shape.coordinates, folded(normals, shape.coordinates), strict=True))
    return substituted(shape, places, box=turned_box(shape, shape.coordinates))


def _normals(group: Any, dimension: int) -> list[Vector]:
    if not isinstance(group, str | sp.Symbol):
        return [tuple(map(_short, unit_vector(normal, dimension, "a normal"))) for normal in group]
    if str(group) not in GROUPS or dimension != 3:
        raise RsymError(
            f"the group must be one of {', '.join(GROUPS)} in space, or normals of mirrors; "
            f"got {str(group)!r} in {dimension} dimensions",
            code="mirrors",
            remedy="in the plane use kaleidoscope(shape, order)",
        )
    return [point(normal, 3, "a normal") for normal in GROUPS[str(group)]]


def _short(component: sp.Expr) -> sp.Expr:
    """Roots stay exact through many reflections; products of sines would swell, 40 digits of them do not."""
    exact = rebuild(component, lambda part: part.args[0] if isinstance(part, Held) else None)
    return sp.Rational(sp.N(exact, 40)) if exact.has(sp.Function) else exact


def _reflected(bounds: Bounds, normal: Sequence[float], distance: float) -> Bounds:
    """The box around the old one and the image of what it has on the side of the normal."""
    corners: list[tuple[float, ...]] = [()]
    for pair in bounds:
        corners = [(*corner, end) for corner in corners for end in pair]
    images = []
    for corner in corners:
        depth = sum(a * b for a, b in zip(normal, corner, strict=True)) - distance
        images.append(tuple(a - 2 * max(depth, 0.0) * b for a, b in zip(corner, normal, strict=True)))
        if depth >= 0:
            images.append(corner)
    return tuple((min(axis), max(axis)) for axis in zip(*images, strict=True))
