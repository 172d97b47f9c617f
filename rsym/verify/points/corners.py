"""Corners: three analytic sheets that pass through one point, proved, with the angles at which they meet.

Where the gradients of three leaves are independent all over a box, the leaves are coordinates there: no point has
the same three values as another, and the box is cut like octants. So if Krawczyk's operator proves a common zero the
formula of signs says what the boundary is around it, and if it proves none no three sheets meet in the box.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from rsym.bounds.balls import arb, ctx
from rsym.logic.kleene import Formula, Literal, replaced
from rsym.verify.answers.singular import SingularPoint
from rsym.verify.boxes.borders import is_within
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.krawczyk import common_zero, narrowed_zero
from rsym.verify.boxes.local import PRECISE, Local
from rsym.verify.boxes.sheets import Sheets, sheets
from rsym.verify.boxes.vectors import Vector, determinant, dot, error, floats, length, radius_of
from rsym.verify.points.links import Link, octants

Names: TypeAlias = Callable[[int], str]


@dataclass(frozen=True)
class Corner:
    """What three sheets make on a box.

    Attributes
    ----------
    sheets : tuple of int
        The leaves, nodes; exactly these can be the boundary on the grown box, and all are analytic there.
    origins : tuple of int
        The nodes of the model that they are pieces of, for their names.
    exists : bool
        Whether they have a common zero in the grown box; it is the only one.
    point : SingularPoint or None
        The corner, if it lies in the box itself and the boundary is not smooth there.
    normals : tuple of three floats each
        The outward unit normals of the sheets at the corner.
    edges : tuple of pairs
        Places in `sheets` of those that meet along edges of the boundary in the box.
    pinched : tuple of pairs
        Those along which the body touches itself: it lies in two opposite wedges.
    cracked : bool
        Whether omega is zero on a sheet, or a part of one, without a change of sign.
    """

    sheets: tuple[int, int, int]
    origins: tuple[int, int, int]
    exists: bool
    point: SingularPoint | None
    normals: tuple[tuple[float, ...], ...]
    edges: tuple[tuple[int, int], ...]
    pinched: tuple[tuple[int, int], ...]
    cracked: bool


def corner(local: Local, number: int | None = None, names: Names | None = None) -> Corner | None:
    """What three sheets make of a node, by default of the root, on a box; None where they are not three, or not proved.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.Shape(rsym.conjunction(x, y, z - 1), (x, y, z)), {})
    >>> found = corner(model.over(((-0.1, 0.2), (-0.1, 0.2), (0.9, 1.2))))
    >>> found.point.point, found.point.kind, found.point.tangent_jump, found.edges
    ((0.0, 0.0, 1.0), 'corner', 90.0, ((0, 1), (0, 2), (1, 2)))
    """
    model = local.model
    grown = local.surroundings
    found = sheets(grown, model.root if number is None else number)
    if found is None or len(found.leaves) != 3 or not all(generators(grown, leaf).analytic for leaf in found.leaves):
        return None
    if not determinant([grown.gradient(leaf) for leaf in found.leaves]) != 0:
        return None
    zero = common_zero(grown, found.leaves)
    if zero is None:
        return None
    around = octants(numbered(found))
    if not zero.exists:
        return _made(found, around, None, ())
    at = narrowed_zero(grown, found.leaves, zero)
    with ctx.workprec(PRECISE):
        within = is_within(at, found.leaves)
        inside = within is not False and all(a.overlaps(b) for a, b in zip(at.sides, local.sides[:3], strict=False))
        normals = [outward(at, leaf, _inside(around, k)) for k, leaf in enumerate(found.leaves)]
        point = _point(at, found, around, normals, names) if inside else None
        if point is not None and within is None:
            point = doubted(point)
    return _made(found, around, point, tuple(floats(normal) for normal in normals))


def doubted(point: SingularPoint) -> SingularPoint:
    """A point on the border of the bounds, or too near to say."""
    doubt = f"{point.reason}; whether within the bounds or beside them is not decided"
    return replace(point, proved=False, reason=doubt)


def numbered(found: Sheets) -> Formula:
    """The formula of sheets with their places in the place of their nodes."""
    return replaced(found.formula, {leaf: Literal(place) for place, leaf in enumerate(found.leaves)})


def _inside(around: Link, sheet: int) -> int:
    """The sign that a sheet has inside wherever it is the boundary; 0 where both are, or none."""
    signs = {sign for edge in around.edges for place, sign in edge.arcs if place == sheet}
    return signs.pop() if len(signs) == 1 else 0


def outward(at: Local, number: int, inside: int) -> Vector:
    """The unit normal of a sheet that points away from the side of this sign; for 0 that of the positive side."""
    x, y, z = at.gradient(number)
    size = length((x, y, z)) * (-1 if inside >= 0 else 1)
    return x / size, y / size, z / size


def angle(a: Vector, b: Vector) -> arb:
    """The angle between two vectors in degrees."""
    cross = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    return arb.atan2(length(cross), dot(a, b)) * 180 / arb.pi()


def largest_angle(around: Link, gradients: Sequence[Vector]) -> arb:
    """The largest angle between the outward normals of two sheets that meet along an edge, in degrees."""
    largest = arb(0)
    for edge in around.edges:
        normals = [tuple(-sign * part for part in gradients[sheet]) for sheet, sign in edge.arcs]
        for n, one in enumerate(normals):
            for other in normals[:n]:
                largest = largest.max(angle(one, other))  # type: ignore[arg-type]
    return largest


def _point(
    at: Local, found: Sheets, around: Link, normals: Sequence[Vector], names: Names | None
) -> SingularPoint | None:
    if not around.edges:
        return None
    units = [outward(at, leaf, -1) for leaf in found.leaves]
    jump = largest_angle(around, units)
    kind = "corner" if around.is_disc else "node"
    return SingularPoint(
        point=floats(at.sides[:3]),
        radius=radius_of(at.sides[:3]),
        kind=kind,
        continuity="G0" if around.is_disc else "broken",
        names=tuple(dict.fromkeys(map(names, found.origins))) if names else (),
        tangent_jump=float(jump.mid()),
        tangent_jump_error=error(jump),
        proved=True,
        reason=describe(around, "three analytic sheets meet at independent normals"),
    )


def describe(around: Link, start: str) -> str:
    """What small spheres see of sheets."""
    if around.is_disc:
        return f"{start}; small spheres see one curve of the boundary"
    pieces = f"{around.components(1)} pieces of the inside and {around.components(-1)} of the outside"
    crack = ", and omega is zero without a change of sign" if around.cracked else ""
    return f"{start}; small spheres see {pieces}{crack}"


def _made(found: Sheets, around: Link, point: SingularPoint | None, normals: tuple[tuple[float, ...], ...]) -> Corner:
    edges: dict[tuple[int, int], None] = {}
    pinched: dict[tuple[int, int], None] = {}
    for edge in around.edges:
        first, second = (place for place, sign in enumerate(edge.covector) if sign == 0)
        (edges if len(edge.arcs) == 2 else pinched)[first, second] = None
    leaves, origins = found.leaves, found.origins
    return Corner(
        (leaves[0], leaves[1], leaves[2]),
        (origins[0], origins[1], origins[2]),
        bool(normals),
        point,
        normals,
        tuple(sorted(edges)),
        tuple(sorted(pinched)),
        around.cracked,
    )
