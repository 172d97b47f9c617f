"""Half-plane, strip, line, disc, ellipse, superellipse and rectangle: the signed primitives of the plane."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, Point, default, number, point, positive, unit_vector
from rsym.model.primitives.formulas import between, centred, superquadric, within
from rsym.model.shape import Shape
from rsym.model.symbols import PLANE, x, y
from rsym.model.systems import R0, RSystem
from rsym.model.vectors import dot, minus, norm, squared


def half_plane(normal: Any = (1, 0), distance: Any = 0, *, letters: LetterMapping = None) -> Shape:
    """N . p - d, n the unit vector along `normal`: what lies beyond the line at distance d from the origin.

    Exact: the signed distance. Analytic everywhere; unbounded.

    Raises
    ------
    RsymError
        For a normal that is zero, or a number that is none.

    Examples
    --------
    >>> import rsym
    >>> rsym.half_plane((3, 4), 2).expression
    3*x/5 + 4*y/5 - 2
    """
    distance = number(distance, "the distance")
    default(distance, letters, "the distance")
    return Shape(dot(unit_vector(normal, 2, "the normal", letters), PLANE) - distance, PLANE, letters=letters)


def strip(lower: Any = -1, upper: Any = 1, direction: Any = (1, 0), *, letters: LetterMapping = None) -> Shape:
    """(b - s)*(s - a)/(b - a) with s = n . p: between two parallel lines, n the unit vector along `direction`.

    Normalised to order 1. Analytic everywhere; unbounded.

    Raises
    ------
    RsymError
        Unless lower < upper, or for a direction that is zero.

    Examples
    --------
    >>> import rsym
    >>> rsym.strip(0, 2).expression
    x*(2 - x)/2
    """
    along = dot(unit_vector(direction, 2, "the direction", letters), PLANE)
    return Shape(between(along, lower, upper, letters), PLANE, letters=letters)


def line(start: Any = (0, 0), end: Any = (1, 0), *, letters: LetterMapping = None) -> Shape:
    """((x - x1)*(y2 - y1) - (y - y1)*(x2 - x1))/L: the half-plane to the right of the line from start to end.

    Exact: the signed distance from the line through both points, L apart. Analytic everywhere; unbounded.

    Raises
    ------
    RsymError
        For points that coincide, or are not two numbers each.

    Examples
    --------
    >>> import rsym
    >>> rsym.line((0, 0), (0, 2)).expression
    x
    """
    start, end = point(start, 2, "the start"), point(end, 2, "the end")
    for component in start:
        default(component, letters, "the start")
    if all(default(b - a, letters, "the end") == 0 for a, b in zip(start, end, strict=True)):
        raise RsymError(f"the start and the end must differ, got {start} and {end}", code="direction")
    return Shape(right_of(start, end), PLANE, letters=letters)


def right_of(start: Point, end: Point) -> sp.Expr:
    """The signed distance from the line through two points, positive to the right of the way from start to end.

    Examples
    --------
    >>> right_of((0, 0), (3, 4))
    4*x/5 - 3*y/5
    """
    across, up = map(sp.sympify, minus(end, start))
    length = norm((across, up))
    return (x - start[0]) * (up / length) - (y - start[1]) * (across / length)


def disc(radius: Any = 1, centre: Any = (0, 0), exact: bool = False, *, letters: LetterMapping = None) -> Shape:
    """(R**2 - |p - c|**2)/(2 R); with `exact` R - |p - c|, the distance itself.

    Normalised to order 1 and analytic everywhere; the exact form to every order, singular at the centre.

    Raises
    ------
    RsymError
        For a radius that is not positive, or a centre that is not two numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.disc(2).expression
    -x**2/4 - y**2/4 + 1
    >>> rsym.disc(2, exact=True).expression
    2 - sqrt(x**2 + y**2)
    """
    radius = positive(radius, "the radius", letters)
    centre = point(centre, 2, "the centre")
    expression = within(squared(minus(PLANE, centre)), radius, exact)
    return Shape(expression, PLANE, letters=letters, box=centred(centre, (radius, radius), letters))


def ellipse(
    a: Any = 2, b: Any = 1, centre: Any = (0, 0), length: Any = None, *, letters: LetterMapping = None
) -> Shape:
    """L*u/sqrt(u**2 + L**2*|grad u|**2) with u = 1 - x**2/a**2 - y**2/b**2: Rvachev's theorem.

    L, by default the smaller semi-axis, is what omega is at the centre, and what it tends to far away but for
    the sign; L = 1 is the form of the source. Normalised to order 1, analytic everywhere.

    Raises
    ------
    RsymError
        For a semi-axis or length that is not positive, or a centre that is not two numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.ellipse(2, 1))([0.0, 2.0], 0.0)["value"].tolist()
    [1.0, 0.0]
    """
    return superellipse(a, b, 2, centre, length, letters=letters)


def superellipse(
    a: Any = 2,
    b: Any = 1,
    exponent: Any = 4,
    centre: Any = (0, 0),
    length: Any = None,
    *,
    letters: LetterMapping = None,
) -> Shape:
    """L*u/sqrt(u**2 + L**2*|grad u|**2) with u = 1 - |x/a|**n - |y/b|**n: Rvachev's theorem.

    L is the length that omega does not exceed, by default the smaller semi-axis. Normalised to order 1. Analytic
    everywhere where n is an even integer; for any other n omega has n - 1 continuous derivatives, rounded up, on
    the two axes of symmetry, which the boundary crosses (2 n - 3 where n < 2, that is none for n up to 3/2).

    Raises
    ------
    RsymError
        For a semi-axis or length that is not positive, an exponent that is not above 1, or a centre that is not two
        numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.superellipse(2, 1, 4))([0.0, 2.0], 0.0)["value"].tolist()
    [1.0, 0.0]
    """
    axes = (positive(a, "the semi-axis a", letters), positive(b, "the semi-axis b", letters))
    power = number(exponent, "the exponent")
    if default(power, letters, "the exponent") <= 1:
        raise RsymError(
            f"the exponent must be above 1, got {exponent}",
            code="exponent",
            remedy="for a rhombus use polygon: with exponent 1 the gradient jumps on both axes",
        )
    return superquadric(PLANE, axes, power, point(centre, 2, "the centre"), length, letters)


def rectangle(
    width: Any = 2, height: Any = 1, centre: Any = (0, 0), *, system: RSystem = R0, letters: LetterMapping = None
) -> Shape:
    """The conjunction of two strips (a**2 - x**2)/(2 a), a half the side: width along x, height along y.

    In `Rho`, which takes lengths, of a - |x|: its corners are circles of exactly that radius.

    Normalised to order 1 on the sides, in R_0. Analytic there except at the corners, where it is continuous.

    Raises
    ------
    RsymError
        For a side that is not positive, or a centre that is not two numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.rectangle(2, 4).expression
    conjunction(1/2 - x**2/2, 1 - y**2/4)
    """
    sides = (("width", width), ("height", height))
    halves = tuple(positive(side, f"the {name}", letters) / 2 for name, side in sides)
    centre = point(centre, 2, "the centre")
    strips = (
        within(part**2, half, not system.keeps_sets) for half, part in zip(halves, minus(PLANE, centre), strict=True)
    )
    return Shape(system.conjunction(*strips), PLANE, letters=letters, box=centred(centre, halves, letters))
