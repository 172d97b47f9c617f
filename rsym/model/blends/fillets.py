"""Fillets: edges rounded with a given radius, and what is promised of them."""

from __future__ import annotations

from itertools import product
from typing import Any

import sympy as sp

from rsym.errors import RsymError
from rsym.model.arguments import LetterMapping, default, positive
from rsym.model.arguments import angle as in_radians
from rsym.model.blends.operands import Operands
from rsym.model.blends.rho import Rho
from rsym.model.rnodes import ROperation
from rsym.model.shape import Shape
from rsym.model.systems import R0


def fillet(
    a: Any,
    b: Any,
    radius: Any,
    continuity: str = "G1",
    operation: str = "union",
    angle: Any = None,
    *,
    degrees: bool = False,
    letters: LetterMapping = None,
) -> Any:
    """Union, intersection or difference with the edge between a and b rounded.

    The operation in the system `Rho`. Outside a tube around the edge nothing is
    moved. What is promised, which `.expression.guarantee` says of the result
    too, is said in the values of a and b as coordinates. Of shapes these are lengths, in R_1,
    where leaves know them: planes, slabs, discs, balls, cylinders, cones, tori, moved and scaled;
    others are best normalised, so that values are distances near the faces.

    Round faces that meet and cut with the rest of the body afterwards: where a and b share a face or touch, both
    values are small along all of it, and the union bulges there. Of shapes that share a face this is measured, and an
    RsymWarning says by how much and where.

    G1: the fillet is the circle of this radius that touches both faces, exact for
    planes that meet at the given angle; tangents are continuous, the curvature
    jumps by 1/radius at both ends. Normalised to order 1 on the faces, and on the fillet of such planes.

    G2: the fillet starts and ends where the circle does, with continuous
    curvature, at right angles at most 1.295/radius. Normalised to order 1 on the faces alone.

    Parameters
    ----------
    a, b : shapes or expressions
        Their faces.
    radius : number or expression in letters
        Positive, in the unit of the operands.
    continuity : {"G1", "G2"}
        Circle, or continuous curvature.
    operation : {"union", "intersection", "difference"}
        A union fills the inner edge, the others take the outer edge away.
    angle : number or expression in letters, optional
        In (0, pi), in radians: opening of the wedge between the faces that the circle lies in;
        by default a right angle. Faces that meet at another angle get another radius.
    degrees : bool
        Whether the angle is in degrees.
    letters : mapping, optional
        Values of letters in the numbers.

    Warns
    -----
    RsymWarning
        Where shapes share a face, and the blend moves it.

    Raises
    ------
    RsymError
        For a radius that is not positive, an angle that is not in (0, pi), an unknown continuity or operation.

    Source: Rvachev (1982), Shapiro (2007), section 3.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> corner = fillet(x, y, 1, operation="intersection")
    >>> corner
    conjunction(x, y, system=Rho(1))
    >>> print(corner.guarantee)
    circular fillet of radius 1 between faces at right angles: G1, curvature jumps by 1/radius where it ends
    """
    given = Operands.of(a, b, letters=letters)
    operands = given.in_lengths()
    size = positive(radius, "the radius", operands.letters)
    made = operands.combined(operation, Rho(size, continuity, _cosine(angle, degrees, operands)))
    first, second = given.items[:2]
    if isinstance(first, Shape) and isinstance(second, Shape) and _share_a_face(first, second):
        from rsym.sampling.offsets import tell_of_bulge

        tell_of_bulge(made, operands.combined(operation, R0), (first, second))
    return made


def _share_a_face(*shapes: Shape) -> bool:
    """Whether leaves of two shapes have a factor in common, as polynomials tell."""
    coordinates = shapes[0].coordinates
    one, other = (
        {leaf for leaf in _leaves(shape.expression) if leaf.is_polynomial(*coordinates) and not leaf.has(sp.Float)}
        for shape in shapes
    )
    return any(sp.gcd(f, g).free_symbols & set(coordinates) for f, g in product(one, other))


def _leaves(part: sp.Expr) -> list[sp.Expr]:
    """What R-operations join."""
    if isinstance(part, ROperation):
        return [leaf for operand in part.operands for leaf in _leaves(operand)]
    return _leaves(part.args[1]) if part.is_Mul and part.args[0] == -1 and len(part.args) == 2 else [part]


def _cosine(angle: Any, degrees: bool, operands: Operands) -> sp.Expr:
    """The product of the unit normals: minus the cosine of the angle between the faces."""
    if angle is None:
        return sp.S.Zero
    opening = in_radians(angle, "the angle", degrees=degrees)
    if not 0 < default(opening, operands.letters, "the angle") < sp.pi.evalf():
        remedy = "in radians, or degrees=True"
        raise RsymError(f"the angle must be in (0, pi), got {angle}", code="parameter", remedy=remedy)
    return -sp.cos(opening)
