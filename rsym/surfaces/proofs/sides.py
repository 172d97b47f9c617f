"""What two patches are on a common edge, and what says that one passes smoothly into the other.

With T along the edge, D out of a patch and N = T x D, the tangent planes agree where D2 . N1 = 0; then D2 = a D1 + b T,
and the curvatures agree where II1(D2, D2) = II2(D2, D2). The functions here are rational but for one root, and take
whatever can be added and multiplied: values of a field, or series.

Source of the second condition: Pegna and Wolter (1992), the linkage curve theorem.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

# Three coordinates, each a value of a field or a series.
from rsym.model.vectors import cross

Vector: TypeAlias = Sequence[Any]
COUNT = 18


class Side(NamedTuple):
    """The point, the derivatives along the edge and out of the patch, and the second derivatives."""

    point: Vector
    along: Vector
    out: Vector
    along_along: Vector
    along_out: Vector
    out_out: Vector

    @property
    def normal(self) -> Vector:
        """N = T x D, which points to one side of a patch and to the other side of what continues it."""
        return cross(self.along, self.out)


def sides(values: Sequence[Any]) -> tuple[Side, Side]:
    """Both patches from 36 numbers.

    Examples
    --------
    >>> first, second = sides(range(36))
    >>> list(first.out), list(second.point)
    ([6, 7, 8], [18, 19, 20])
    """
    halves = values[:COUNT], values[COUNT:]
    first, second = (Side(*(half[k : k + 3] for k in range(0, COUNT, 3))) for half in halves)
    return first, second


def dot(a: Vector, b: Vector) -> Any:
    """The scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def difference(a: Vector, b: Vector) -> Vector:
    """A vector from b to a."""
    return [x - y for x, y in zip(a, b, strict=True)]


def bending(side: Side, along: Any, out: Any) -> Any:
    """N . p'' in the direction along T + out D."""
    normal = side.normal
    mixed = along * out * dot(normal, side.along_out)
    return along * along * dot(normal, side.along_along) + mixed + mixed + out * out * dot(normal, side.out_out)


def linkage(first: Side, second: Side, axes: Sequence[int] = (0, 1, 2)) -> Any:
    """What vanishes if the curvatures agree, for patches with equal tangent planes: II1(D2, D2) - II2(D2, D2).

    D2 = a D1 + b T with a = (T x D2)_i/N1_i and b = (D2 x D1)_i/N1_i for any axis i. The denominators are multiplied
    up, and axes added: the difference comes with the factor |N1| and the sum of N1_i**2.
    """
    normal = first.normal
    a, b = cross(first.along, second.out), cross(second.out, first.out)

    def product(one: Vector, other: Vector) -> Any:
        head, *rest = (one[axis] * other[axis] for axis in axes)
        return sum(rest, head)

    mixed = product(a, b) * dot(normal, first.along_out)
    own = product(b, b) * dot(normal, first.along_along) + mixed + mixed + product(a, a) * dot(normal, first.out_out)
    return own - product(normal, normal) * dot(normal, second.out_out)


def curvature(side: Side, length: Any) -> Any:
    """The normal curvature across the edge, for the normal N; `length` is |N|."""
    return across(side) / (dot(side.along, side.along) * length * length * length)


def across(side: Side) -> Any:
    """The normal curvature across the edge, times |T|**2 |N|**3."""
    return bending(side, -dot(side.along, side.out), dot(side.along, side.along))


def facing_normals(first: Side, second: Side) -> Any:
    """-N1 . N2: positive where one patch continues the other, for then N1 and N2 are opposite."""
    return -dot(first.normal, second.normal)


def jump_numerator(first: Side, second: Side) -> Any:
    """What vanishes with the jump of curvature, without roots: B1 G2 S2 W + B2 G1 S1**2.

    With B, G = |T|**2, S = |N|**2 the curvature across is B/(G S**(3/2)), and N1, N2 are opposite. The jump times
    G1 G2 S1**2 S2**(3/2) is B1 G2 S2 |N1| |N2| + B2 G1 S1**2; the product of the lengths exceeds W = -N1 . N2 by
    |N1 x N2|**2/(|N1| |N2| + W), which is nothing where the tangent planes agree.
    """
    G, S = dot(first.along, first.along), dot(first.normal, first.normal)
    return jump_slack(first, second) * facing_normals(first, second) + across(second) * G * S * S


def jump_slack(first: Side, second: Side) -> Any:
    """The factor B1 G2 S2 of the product of the lengths."""
    return across(first) * dot(second.along, second.along) * dot(second.normal, second.normal)
