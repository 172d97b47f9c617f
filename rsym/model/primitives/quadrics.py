"""Ellipsoids, any quadric, and the torus, which is the tube of a circle."""

from __future__ import annotations

from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, number, point, positive
from rsym.model.primitives.formulas import centred, normalised, superquadric, within
from rsym.model.shape import Shape
from rsym.model.symbols import SPACE
from rsym.model.vectors import minus, squared

HYPERBOLOID = ((-1, 0, 0), (0, -1, 0), (0, 0, 1))


def ellipsoid(
    a: Any = 3, b: Any = 2, c: Any = 1, centre: Any = (0, 0, 0), length: Any = None, *, letters: LetterMapping = None
) -> Shape:
    """L*u/sqrt(u**2 + L**2*|grad u|**2) with u = 1 - x**2/a**2 - y**2/b**2 - z**2/c**2: Rvachev's theorem.

    L, by default the smallest semi-axis, is what omega is at the centre, and what it tends to far away but for
    the sign; L = 1 is the form of the source. Normalised to order 1, analytic everywhere. a = b = c = L = R gives
    R*(R**2 - r**2)/(R**2 + r**2).

    Raises
    ------
    RsymError
        For a semi-axis or length that is not positive, or a centre that is not three numbers.

    Examples
    --------
    >>> import rsym
    >>> rsym.compile(rsym.ellipsoid(3, 2, 1))([0.0, 3.0], 0.0, 0.0)["value"].tolist()
    [1.0, 0.0]
    """
    named = (("a", a), ("b", b), ("c", c))
    axes = tuple(positive(axis, f"the semi-axis {name}", letters) for name, axis in named)
    return superquadric(SPACE, axes, sp.Integer(2), point(centre, 3, "the centre"), length, letters)


def quadric(
    matrix: Any = HYPERBOLOID,
    vector: Any = None,
    constant: Any = 1,
    length: Any = 1,
    *,
    letters: LetterMapping = None,
) -> Shape:
    """L*u/sqrt(u**2 + L**2*|grad u|**2), u = p . M p + v . p + c: inside where the quadratic is positive.

    M is symmetric, 3 by 3, or 2 by 2 for a conic in the plane; v is zero unless given. L, in the unit of the
    coordinates, is what omega tends to far away in size. Normalised to order 1 and analytic except where
    u and its gradient vanish together, as at the apex of a cone.

    Raises
    ------
    RsymError
        For a matrix that is not symmetric of two or three rows, a vector of another size, or a length that is
        not positive.

    Examples
    --------
    >>> import rsym
    >>> rsym.quadric(((0, 0), (0, 0)), (0, 1), 0).expression
    y/sqrt(y**2 + 1)
    """
    try:
        rows = [list(row) for row in matrix.tolist()] if hasattr(matrix, "tolist") else [*map(list, matrix)]
    except TypeError:
        rows = []
    size = len(rows)
    if size not in (2, 3) or any(len(row) != size for row in rows):
        raise RsymError(f"the matrix must be 2 by 2 or 3 by 3, got {matrix!r}", code="matrix")
    form = sp.Matrix([[number(entry, "an entry of the matrix") for entry in row] for row in rows])
    if form != form.T:
        raise RsymError(
            f"the matrix must be symmetric, got {form.tolist()}",
            code="matrix",
            remedy="give (M + M.T)/2, which is the same quadratic",
        )
    place = sp.Matrix(SPACE[:size])
    linear = sp.Matrix(point(vector or (0,) * size, size, "the vector"))
    constant = number(constant, "the constant")
    for entry in (*form, *linear, constant):
        default(entry, letters, "a coefficient")
    function = sp.expand((place.T * form * place)[0]) + linear.dot(place) + constant
    unit = positive(length, "the length", letters)
    expression = normalised(function, squared(2 * form * place + linear), unit)
    return Shape(expression, SPACE[:size], letters=letters)


def torus(
    major: Any = 3,
    minor: Any = 1,
    centre: Any = (0, 0, 0),
    form: str = "radial",
    *,
    letters: LetterMapping = None,
) -> Shape:
    """A ring about an axis parallel to z: the circle of radius R thickened by r, in one of three forms.

    "radial"   (r**2 - (rho - R)**2 - z**2)/(2 r), order 1, singular on the axis, which is outside.
    "exact"    r - sqrt((rho - R)**2 + z**2), the distance, to every order; singular on the axis and on the circle.
    "quartic"  Rvachev's theorem for 4 R**2 rho**2 - (rho**2 + z**2 + R**2 - r**2)**2, order 1, analytic everywhere,
               between -r and r.

    Raises
    ------
    RsymError
        Unless 0 < minor < major, or for another form.

    Examples
    --------
    >>> import rsym
    >>> rsym.torus(3, 1).expression
    -z**2/2 - (sqrt(x**2 + y**2) - 3)**2/2 + 1/2
    """
    major, minor = positive(major, "the major radius", letters), positive(minor, "the minor radius", letters)
    if default(major - minor, letters) <= 0:
        raise RsymError(
            f"the minor radius must be below the major one, got {minor} and {major}",
            code="torus",
            remedy="for a body without a hole revolve a disc",
        )
    if form not in ("radial", "exact", "quartic"):
        raise RsymError(f'the form must be "radial", "exact" or "quartic", got {form!r}', code="form")
    centre = point(centre, 3, "the centre")
    across, aside, up = minus(SPACE, centre)
    round_axis = across**2 + aside**2
    if form == "quartic":
        level = round_axis + up**2 + major**2 - minor**2
        slope = 16 * (round_axis * (2 * major**2 - level) ** 2 + (up * level) ** 2)
        expression = normalised(4 * major**2 * round_axis - level**2, slope, minor)
    else:
        expression = within((sp.sqrt(round_axis) - major) ** 2 + up**2, minor, form == "exact")
    box = centred(centre, (major + minor, major + minor, minor), letters)
    return Shape(expression, SPACE, letters=letters, box=box)
