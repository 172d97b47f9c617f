"""Turns, and finite reflection groups: the map that folds everything onto one chamber.

The mirrors with inner normals a_1, a_2, ... bound the chamber p . a_i >= 0.
With w_1, w_2, ... dual to the normals (w_i . a_j = 1 if i = j, else 0), a point of
the chamber is its own part along the mirrors' common line or plane plus
sum_i (w_i . p) a_i, and of all images of a point under the group the one in the
chamber has the largest w_i . p, for each i. So the folded point is

    P p + sum_i a_i h_i(p),   h_i(p) = the largest q . p over the images q of w_i

P being the projection onto what all mirrors have in common. No fold
stands within another: the formula is flat, each h_i is convex, and a box of
points has its exact image.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import coordinate
from rsym.model.bounding import BoundingBox
from rsym.model.shape import Bounds, Shape
from rsym.model.systems import R1
from rsym.model.vectors import Vector, dot


def turned_coordinates(shape: Shape, axis: Any) -> tuple[sp.Symbol, sp.Symbol]:
    """The two coordinates that a turn about the axis changes, the angle from the first to the second.

    Examples
    --------
    >>> import rsym
    >>> turned_coordinates(rsym.sphere(), "y")
    (z, x)
    """
    if shape.dimension == 2 and axis is None:
        return shape.coordinates
    if shape.dimension == 2:
        raise RsymError("a turn in the plane has no axis", code="axis", remedy="leave it out")
    position = 2 if axis is None else coordinate(axis, shape.coordinates)
    return shape.coordinates[(position + 1) % 3], shape.coordinates[(position + 2) % 3]


def turned_box(shape: Shape, turning: Sequence[sp.Symbol], radius: float = 0.0) -> BoundingBox | None:
    """The box that holds the old one, moved out by a radius along the first of these coordinates, however it turns.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> turned_box(rsym.Shape(x, (x, y), bounds=((-1, 2), (-4, 0))), (x, y), 1).ends
    ((-5.0, 5.0), (-5.0, 5.0))
    """

    def turned(ends: Bounds) -> Bounds:
        box: Mapping[sp.Symbol, tuple[float, float]] = dict(zip(shape.coordinates, ends, strict=True))
        (low, high), *others = (box[symbol] for symbol in turning)
        moved = ((low + radius, high + radius), *others)
        reach = math.hypot(*(max(map(abs, pair)) for pair in moved))
        return tuple((-reach, reach) if symbol in turning else box[symbol] for symbol in shape.coordinates)

    return shape.box and shape.box.mapped(turned)


MOST_IMAGES = 240  # of a weight; 120 have the largest group in space, H3
SAME = 1e-9  # two images nearer than this are one: those of groups this small lie further than 0.02 apart

Floats = tuple[float, ...]


def folded(normals: Sequence[Vector], coordinates: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """The coordinates of the image in the chamber.

    Raises
    ------
    RsymError
        For normals that depend on one another, or whose reflections do not make a finite group.

    Examples
    --------
    >>> from rsym import x, y
    >>> folded([(sp.Integer(1), sp.Integer(0)), (sp.Integer(0), sp.Integer(1))], (x, y))
    [Abs(x), Abs(y)]
    """
    matrix = sp.Matrix([list(normal) for normal in normals])
    gram = matrix * matrix.T
    if abs(sp.N(gram.det())) < SAME:
        raise RsymError("the normals depend on one another", code="mirrors", remedy="leave out the ones that repeat")
    weights = _simple(gram.inv() * matrix)
    rest = _simple(sp.eye(len(coordinates)) - matrix.T * weights) * sp.Matrix(coordinates)
    largest = sp.Matrix([_largest(orbit(tuple(weights.row(i)), normals), coordinates) for i in range(len(normals))])
    return list(rest + matrix.T * largest)


def farthest(first: sp.Symbol, second: sp.Symbol, count: int, start: sp.Expr) -> sp.Expr:
    """The largest component of a point of the plane along `count` directions, at the angles start*pi + 2 pi k/count.

    Opposite directions, where the count is even, make one form |.|.

    Examples
    --------
    >>> from rsym import x, y
    >>> farthest(x, y, 4, sp.Integer(0))
    disjunction(Abs(x), Abs(y), system=R1)
    """
    angles = [(start + sp.Rational(2 * k, count)) * sp.pi for k in range(count if count % 2 else count // 2)]
    forms = [first * sp.cos(angle) + second * sp.sin(angle) for angle in angles]
    return R1.disjunction(*(forms if count % 2 else (_absolute(form) for form in forms)))


def within_half_a_sector(first: sp.Symbol, second: sp.Symbol, count: int) -> tuple[sp.Expr, sp.Expr]:
    """A point of the plane folded onto 0 <= theta <= pi/count by the mirrors at all multiples of that angle.

    With X the largest component along the directions 2 k pi/count and Y that along those between, it is
    (X, (Y - X cos(pi/count))/sin(pi/count)).

    Examples
    --------
    >>> from rsym import x, y
    >>> within_half_a_sector(x, y, 2)
    (Abs(x), Abs(y))
    """
    straight, between = (farthest(first, second, count, sp.Rational(start, count)) for start in (0, 1))
    half = sp.pi / count
    return straight, (between - straight * sp.cos(half)) / sp.sin(half)


def orbit(weight: Vector, normals: Sequence[Vector]) -> list[Vector]:
    """All images of a vector under the reflections in mirrors with these normals."""
    images = [weight]
    for parent, number in _descent(_floats(weight), [_floats(normal) for normal in normals])[1:]:
        image, normal = images[parent], normals[number]
        factor = 2 * dot(image, normal) / dot(normal, normal)
        images.append(tuple(_plain(a - factor * b) for a, b in zip(image, normal, strict=True)))
    return images


def _descent(weight: Floats, normals: Sequence[Floats]) -> list[tuple[int, int]]:
    """Of which image and in which mirror each image is one; exact numbers of an endless group would swell."""
    places, origins = [weight], [(0, 0)]
    for parent, place in enumerate(places):  # grows while it is walked
        for number, normal in enumerate(normals):
            factor = 2 * _product(place, normal) / _product(normal, normal)
            image = tuple(a - factor * b for a, b in zip(place, normal, strict=True))
            if not any(_near(image, other) for other in places):
                places.append(image)
                origins.append((parent, number))
        if len(places) > MOST_IMAGES:
            raise RsymError(
                "reflections in these mirrors do not make a finite group",
                code="mirrors",
                remedy="the angles between mirrors must be pi/m, in space with 1/m1 + 1/m2 + 1/m3 > 1",
            )
    return origins


def _largest(images: Sequence[Vector], coordinates: Sequence[sp.Symbol]) -> sp.Expr:
    """The largest q . p; where -q is an image too, |q . p| stands for both."""
    forms: list[sp.Expr] = []
    used: list[Floats] = []
    opposite = [tuple(-value for value in _floats(image)) for image in images]
    for image in images:
        place = _floats(image)
        if any(_near(place, other) for other in used):
            continue
        form = dot(image, coordinates)
        if any(_near(place, other) for other in opposite):
            used.append(tuple(-value for value in place))
            form = _absolute(form)
        forms.append(form)
    return R1.disjunction(*forms)


def _absolute(form: sp.Expr) -> sp.Expr:
    """|form|; of a sum SymPy would try to find the sign."""
    return sp.Abs(form, evaluate=form.is_Symbol)


def _simple(matrix: sp.Matrix) -> sp.Matrix:
    return matrix.applyfunc(_plain)


def _plain(value: sp.Expr) -> sp.Expr:
    return sp.radsimp(sp.expand(value))


def _product(a: Floats, b: Floats) -> float:
    return sum(p * q for p, q in zip(a, b, strict=True))


def _floats(vector: Vector) -> Floats:
    return tuple(float(sp.N(value)) for value in vector)


def _near(a: Sequence[float], b: Sequence[float]) -> bool:
    return all(abs(p - q) < SAME for p, q in zip(a, b, strict=True))
