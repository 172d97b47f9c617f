"""Curves in space that are no segments and no arcs."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, positive
from rsym.model.equation import combine
from rsym.model.primitives.curve_nodes import Helix
from rsym.model.primitives.extents import box_around
from rsym.model.shape import Shape
from rsym.model.symbols import x, y, z


def space_curve(f: Any, g: Any, *, letters: LetterMapping = None) -> Shape:
    """The curve in which two surfaces meet, f = g = 0: sqrt(f**2 + g**2).

    Normalised to order 1 where f and g are and their gradients are at right
    angles; elsewhere zero on the curve and positive off it, no more.

    Parameters
    ----------
    f, g : shapes in space, or expressions in x, y, z and letters
        Zero on the two surfaces.
    letters : mapping, optional
        The values of letters in expressions.

    Raises
    ------
    RsymError
        For a shape in the plane.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> axis = space_curve(x, y)
    >>> axis.expression
    sqrt(x**2 + y**2)
    """
    surfaces = [item if isinstance(item, Shape) else Shape(item, (x, y, z), letters=letters) for item in (f, g)]
    if any(surface.dimension != 3 for surface in surfaces):
        raise RsymError(
            "a space curve needs two shapes in space, got one in the plane",
            code="coordinates",
            remedy="extrude or revolve it first; in the plane a curve is its own boundary",
        )
    curve: Shape = combine(lambda first, second: sp.sqrt(first**2 + second**2), *surfaces)
    return curve


def helix(radius: Any = 1, pitch: Any = 1, turns: Any = None, *, letters: LetterMapping = None) -> Shape:
    """The line of a screw about z through (radius, 0, 0): (R cos a, R sin a, p a/(2 pi)), right-handed.

    sqrt((k**2 (R**2 - x**2 - y**2)**2/4 + d + d**2/(12 R**2))/(1 + k**2 R**2)) with k = 2 pi/p and
    d = (x - R cos(k z))**2 + (y - R sin(k z))**2: from the cylinder, and from the point of the curve across the axis.

    Normalised to order 1 in every direction, off the ends if it has any. It is analytic off the curve. A left-handed
    one is its mirror image.

    Parameters
    ----------
    radius, pitch : positive numbers or expressions
        R, and p: the height of one turn.
    turns : positive number or expression, optional
        Where it ends, from z = 0 on; by default it is endless.
    letters : mapping, optional
        The values of letters in the numbers.

    Raises
    ------
    RsymError
        For a number that is not positive.

    Examples
    --------
    >>> import rsym
    >>> spring = helix(2, 1, turns=3)
    >>> float(rsym.compile(spring)(-2.0, 0.0, 1.5)["value"].round(12))
    0.0
    """
    numbers = [positive(radius, "the radius of a helix", letters), positive(pitch, "the pitch of a helix", letters)]
    if turns is None:
        return Shape(Helix(x, y, z, *numbers), (x, y, z), letters=letters)
    numbers.append(positive(turns, "the number of turns", letters))
    reach, rise, count = (default(item, letters, "a helix") for item in numbers)
    bounds = box_around([(-reach, -reach, 0.0), (reach, reach, rise * count)])
    return Shape(Helix(x, y, z, *numbers), (x, y, z), letters=letters, bounds=bounds)
