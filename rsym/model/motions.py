"""Motions of shapes: each puts the inverse of an affine map into the coordinates.

What keeps distances keeps the order of normalisation; scaling multiplies omega
by the factor and keeps it too; stretching and shearing do not.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Self, TypeAlias, TypeVar

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, coordinate, default, number, point, positive, unit_vector
from rsym.model.arguments import turn as turn_of
from rsym.model.bounding import BoundingBox
from rsym.model.equation import Equation, substituted
from rsym.model.letters import Letters
from rsym.model.spelling import british
from rsym.model.symbols import symbols_of

Matrix: TypeAlias = sp.ImmutableDenseMatrix
S = TypeVar("S", bound="Movable")


@dataclass(frozen=True, init=False, repr=False)
class Movable(Equation):
    """The motions of a shape; every number may be an expression in letters, whose values `letters` adds."""

    def translate(self, *offset: Any, letters: LetterMapping = None) -> Self:
        """The shape moved by an offset: omega(p - offset).

        Raises
        ------
        RsymError
            Unless there is one number for each coordinate.

        Examples
        --------
        >>> import rsym
        >>> rsym.Shape(1 - rsym.x**2 - rsym.y**2, (rsym.x, rsym.y)).translate(3, 0).expression
        -y**2 - (x - 3)**2 + 1
        """
        given = offset[0] if len(offset) == 1 and isinstance(offset[0], tuple | list) else offset
        vector = Matrix(point(given, self.dimension, "an offset"))
        return _moved(self, sp.eye(self.dimension), sp.eye(self.dimension), vector, letters)

    @british
    def rotate(
        self,
        angle: Any,
        axis: Any = None,
        centre: Any = None,
        *,
        degrees: bool = False,
        letters: LetterMapping = None,
    ) -> Self:
        """The shape turned counterclockwise about a centre, by default the origin; in space about an axis.

        Parameters
        ----------
        angle : number or expression
            In radians, or in degrees.
        degrees : bool
            Whether the angle is in degrees.
        axis : coordinate or direction, in space
            Through the centre; by default the third coordinate. The turn is counterclockwise for those it points at.
        centre : point, optional
            What stays where it is.

        Raises
        ------
        RsymError
            For an axis in the plane, or one without direction.

        Warns
        -----
        RsymWarning
            For a rational number of radians beyond a whole turn: degrees are typed so.

        Examples
        --------
        >>> import rsym, sympy as sp
        >>> rsym.Shape(rsym.x - 1, (rsym.x, rsym.y)).rotate(sp.pi / 2).expression
        y - 1
        >>> rsym.Shape(rsym.x - 1, (rsym.x, rsym.y)).rotate(90, degrees=True).expression
        y - 1
        """
        if self.dimension == 2 and axis is not None:
            raise RsymError("a turn in the plane has no axis", code="axis", remedy="rotate(angle, centre=(x, y))")
        turn = turn_of(angle, "an angle", degrees=degrees)
        if self.dimension == 2:
            matrix = Matrix([[sp.cos(turn), -sp.sin(turn)], [sp.sin(turn), sp.cos(turn)]])
        else:
            matrix = _about(axis_vector(self, self.coordinates[2] if axis is None else axis, "an axis", letters), turn)
        return _about_centre(self, matrix, matrix.T, centre, letters)

    @british
    def scale(self, factor: Any, centre: Any = None, *, letters: LetterMapping = None) -> Self:
        """The shape enlarged about a centre: k omega(p/k), which keeps the normalisation.

        A factor for each coordinate stretches: omega is then not normalised any more.

        Raises
        ------
        RsymError
            For a factor that is not positive.

        Examples
        --------
        >>> import rsym
        >>> rsym.Shape((1 - rsym.x**2 - rsym.y**2) / 2, (rsym.x, rsym.y)).scale(2).expression
        -x**2/4 - y**2/4 + 1
        """
        if isinstance(factor, tuple | list):
            if len(factor) != self.dimension:
                raise RsymError(f"expected {self.dimension} factors, got {len(factor)}", code="point")
            factors = [positive(one, "a factor", self.letters.merge(letters)) for one in factor]
            matrix, inverse = sp.diag(*factors), sp.diag(*(1 / one for one in factors))
            return _about_centre(self, matrix, inverse, centre, letters)
        size = positive(factor, "a factor", self.letters.merge(letters))
        one = sp.eye(self.dimension)
        return _about_centre(self, one * size, one / size, centre, letters, factor=size)

    def mirror(self, normal: Any, distance: Any = 0, *, letters: LetterMapping = None) -> Self:
        """The mirror image in the line, or plane, n . p = distance.

        Parameters
        ----------
        normal : coordinate or direction
            n, made a unit vector.

        Raises
        ------
        RsymError
            For a normal without direction.

        Examples
        --------
        >>> import rsym
        >>> rsym.Shape(rsym.x - 1, (rsym.x, rsym.y)).mirror(rsym.x).expression
        -x - 1
        """
        unit = Matrix(axis_vector(self, normal, "a normal", letters))
        matrix = sp.eye(self.dimension) - 2 * unit * unit.T
        offset = 2 * number(distance, "a distance") * unit
        return _moved(self, matrix, matrix, offset, letters)

    def shear(self, along: Any, by: Any, amount: Any, *, letters: LetterMapping = None) -> Self:
        """Every point moved along one coordinate by an amount times another; omega is not normalised any more.

        Raises
        ------
        RsymError
            For something that is no coordinate, or twice the same.

        Examples
        --------
        >>> import rsym
        >>> from rsym import x, y
        >>> rsym.Shape(1 - x**2, (x, y)).shear(x, y, 2).expression
        1 - (x - 2*y)**2
        """
        row, column = (coordinate(given, self.coordinates, "the direction of a shear") for given in (along, by))
        if row == column:
            raise RsymError(f"a shear along {along} goes by another coordinate", code="shear")
        share = sp.zeros(self.dimension, self.dimension)
        share[row, column] = number(amount, "an amount")
        one = sp.eye(self.dimension)
        return _moved(self, one + share, one - share, sp.zeros(self.dimension, 1), letters)


def axis_vector(shape: Equation, given: Any, what: str, letters: LetterMapping) -> tuple[sp.Expr, ...]:
    """The direction of a coordinate, or any other, as a vector of length 1.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> [axis_vector(rsym.Shape(x, (x, y)), given, "a normal", None) for given in (y, (3, 4))]
    [(0, 1), (3/5, 4/5)]
    """
    if isinstance(given, int | str | sp.Symbol):
        position = coordinate(given, shape.coordinates, what)
        return tuple(sp.Integer(k == position) for k in range(shape.dimension))
    return unit_vector(given, shape.dimension, what, shape.letters.merge(letters))


def _about(axis: tuple[sp.Expr, ...], angle: sp.Expr) -> Matrix:
    """The turn about an axis through the origin. Source: Rodrigues (1840)."""
    a, b, c = axis
    cosine, sine = sp.cos(angle), sp.sin(angle)
    cross = Matrix([[0, -c, b], [c, 0, -a], [-b, a, 0]])
    along = Matrix(3, 3, lambda i, j: axis[i] * axis[j])
    return cosine * sp.eye(3) + sine * cross + (1 - cosine) * along


def _about_centre(shape: S, matrix: Matrix, inverse: Matrix, centre: Any, letters: LetterMapping, factor: Any = 1) -> S:
    """The map that leaves the centre where it is."""
    fixed = Matrix([0] * shape.dimension if centre is None else point(centre, shape.dimension, "a centre"))
    return _moved(shape, matrix, inverse, fixed - matrix * fixed, letters, factor)


def _moved(shape: S, matrix: Matrix, inverse: Matrix, offset: Matrix, letters: LetterMapping, factor: Any = 1) -> S:
    """The image under p -> matrix p + offset."""
    known = shape.letters.merge(letters)
    _check_constant(shape, (*matrix, *offset))
    images = inverse * (Matrix(shape.coordinates) - offset)
    places = dict(zip(shape.coordinates, images, strict=True))
    return substituted(shape, places, factor=factor, letters=letters, box=_box(shape, matrix, offset, known))


def _check_constant(shape: Equation, numbers: tuple[sp.Expr, ...]) -> None:
    """A motion takes all points alike."""
    varying = [symbol for symbol in shape.coordinates if symbol in symbols_of(*numbers)]
    if varying:
        raise RsymError(
            f"a motion is the same everywhere, but a number in it contains the coordinate {varying[0]}",
            code="coordinates",
            remedy="for a map that varies from place to place use transform, with its inverse",
        )


def _box(shape: S, matrix: Matrix, offset: Matrix, letters: Letters) -> BoundingBox | None:
    """The box around the moved box, letters at their defaults; the box of a window is exact where the numbers are."""
    if shape.box is None:
        return None
    fixed = not symbols_of(*matrix, *offset)
    exact = fixed and shape.bounds is not None and all(entry.is_Rational for entry in (*matrix, *offset))
    value = (lambda entry, _: Fraction(int(entry.p), int(entry.q))) if exact else default
    rows = [[value(entry, letters) for entry in matrix.row(k)] for k in range(shape.dimension)]
    shifts = [value(entry, letters) for entry in offset]

    def moved(ends: Any) -> Any:
        box = []
        for row, shift in zip(rows, shifts, strict=True):
            exactly = [tuple(map(Fraction, pair)) for pair in ends] if exact else ends
            parts = [sorted((entry * low, entry * high)) for entry, (low, high) in zip(row, exactly, strict=True)]
            box.append((shift + sum(low for low, _ in parts), shift + sum(high for _, high in parts)))
        return tuple(box)

    return shape.box.mapped(moved, stated=fixed)
