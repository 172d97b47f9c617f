"""Points proved by second derivatives: a leaf without a gradient, and two leaves that touch.

At a zero p of a leaf and of its gradient the leaf is like its quadratic form, if that is regular (Morse): a double
cone if it has both signs, an isolated point if it has one. Where f = g = 0 and grad g = k grad f, the surfaces are
graphs over one tangent plane, and g is there on f = 0 like the quadratic form Q of g - k f on that plane. If Q has
one sign, g has it on all of f = 0 but p: small spheres are cut by two curves that do not meet. If it has both, the
curves cross in four points. Where s P_g = q P_f + c h**k with k even, grad h and grad f independent, and s, q, c not 0,
the surfaces touch along f = h = 0, and g has one sign beside that on f = 0: the curves touch in two points.
Source: Milnor, Morse Theory (1963), lemma 2.2.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from flint import arb_mat

from rsym.bounds.balls import arb
from rsym.logic.kleene import Formula, ternary
from rsym.verify.boxes.contact_relations import contacts_of
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.vanishing import Exact


@dataclass(frozen=True)
class Judgement:
    """What a boundary is at a point: a kind and continuity of `SingularPoint`, and why."""

    kind: str
    continuity: str
    reason: str


def inertia(matrix: Sequence[Sequence[arb]]) -> tuple[int, ...] | None:
    """The signs of the eigenvalues of a symmetric matrix of balls; None where one may be zero.

    It is carried over to the approximate eigenvectors V: V' M V has the same signs, and its circles of Gershgorin
    do not hold 0.

    Examples
    --------
    >>> inertia([[arb(0), arb(1)], [arb(1), arb(0)]])
    (-1, 1)
    """
    count = len(matrix)
    middles = np.array([[float(part.mid()) for part in row] for row in matrix])
    if not np.isfinite(middles).all():
        return None
    vectors = np.linalg.eigh(middles)[1]
    v = arb_mat(count, count, [arb(float(part)) for part in vectors.ravel()])
    moved = v.transpose() * arb_mat(count, count, [part for row in matrix for part in row]) * v
    if v.det().contains(0):
        return None
    signs = []
    for row in range(count):
        rest = sum((abs(moved[row, column]) for column in range(count) if column != row), arb(0))
        own = moved[row, row]
        if not abs(own) > rest:
            return None
        signs.append(1 if own > 0 else -1)
    return tuple(signs)


def hessian(at: Local, number: int) -> list[list[arb]]:
    """Balls around the second derivatives of a node."""
    return [at.gradient(first) for first in at.model.gradient(number)]


def without_gradient(at: Local, leaf: int, inside: int) -> Judgement | None:
    """What a leaf is where it and its gradient vanish, `inside` being its sign there; None where that stays open."""
    signs = inertia(hessian(at, leaf))
    if signs is None:
        return None
    if len(set(signs)) == 1:
        side = "inside" if signs[0] == inside else "outside"
        return Judgement("isolated point", "broken", f"a definite quadratic form: all around it is {side}")
    return Judgement("node", "broken", "the gradient vanishes, and the quadratic form has both signs: a double cone")


def touching(at: Local, f: int, g: int, formula: Formula) -> Judgement | None:
    """What two leaves that touch make of a formula of theirs, the leaves 0 and 1; None where that stays open.

    That f and g vanish at the point and that their gradients are parallel must be known.
    """
    p, q = at.gradient(f), at.gradient(g)
    k = _largest(p)
    if p[k].contains(0) or q[k].contains(0):
        return None
    ratio = q[k] / p[k]
    signs = _bending(at, g, f, ratio)
    return None if signs is None else _judged(formula, 1 if ratio > 0 else -1, signs)


def touching_along(known: Exact, at: Local, f: int, g: int, formula: Formula) -> Judgement | None:
    """As `touching`, of two leaves that touch along a curve through the point, by a relation of their polynomials."""
    contacts = contacts_of(at.model)
    for contact in contacts.between(f, g):
        forms = contacts.form(contact.first), contacts.form(contact.second)
        zeros = [(factor, power) for factor, power in contact.factors if not at.nonzero(factor)]
        if None in forms or len(zeros) != 1 or zeros[0][1] % 2 or not known.vanishes(zeros[0][0]):
            continue
        p, q = at.gradient(f), at.gradient(zeros[0][0])
        if all((p[i] * q[j] - p[j] * q[i]).contains(0) for i, j in ((0, 1), (1, 2), (2, 0))):
            continue
        first, second = (
            form[0].sign(at) * at.sign(factor)
            for form, factor in zip(forms, (contact.quotient, contact.multiplier), strict=True)
            if form is not None
        )
        rest = contact.sign * math.prod(
            at.sign(factor) ** power for factor, power in contact.factors if at.nonzero(factor)
        )
        if first * second * rest:
            sign = rest * second if contact.first == f else -rest * first  # of g where f = 0
            return _judged(formula, first * second, (sign,), along=True)
    return None


def touch_once(box: Local, at: Local, f: int, g: int) -> bool:
    """Whether two leaves, analytic on a box, that touch at a point in it, certainly do not meet elsewhere in it.

    Where f = 0 the vector x - p is at right angles to some value of grad f on the box, by the mean value theorem. If
    g - k f bends one way along all such vectors, g has one sign there, by Taylor's; likewise f where g = 0.
    """
    p, q = at.gradient(f), at.gradient(g)
    k = _largest(p)
    if p[k].contains(0) or q[k].contains(0):
        return False
    ratio = q[k] / p[k]
    first, second = _bending(box, g, f, ratio), _bending(box, f, g, 1 / ratio)
    return first is not None and second is not None and len(set(first)) == 1 == len(set(second))


def _largest(vector: Sequence[arb]) -> int:
    return max(range(3), key=lambda axis: float(abs(vector[axis]).lower()))


def _bending(local: Local, g: int, f: int, ratio: arb) -> tuple[int, ...] | None:
    """The signs of the quadratic form of g - ratio f on the planes across grad f; None where one may be zero."""
    p = local.gradient(f)
    k = _largest(p)
    if p[k].contains(0) or not all(part.is_finite() for part in p):
        return None
    first, second = hessian(local, f), hessian(local, g)
    difference = arb_mat(3, 3, [second[i][j] - ratio * first[i][j] for i, j in product(range(3), repeat=2)])
    plane = [[p[k] if axis == i else -p[i] if axis == k else arb(0) for axis in range(3)] for i in range(3) if i != k]
    basis = arb_mat(2, 3, [part for row in plane for part in row])
    form = basis * difference * basis.transpose()
    return inertia([[form[i, j] for j in range(2)] for i in range(2)])


def _judged(formula: Formula, way: int, signs: tuple[int, ...], *, along: bool = False) -> Judgement:
    """By the cells of a small sphere: two caps on either side of the tangent plane, and bands where f = 0 = g part.

    Sheets that touch `along` a curve part a band of one sign in two.
    """

    def value(f: int, g: int) -> int:
        return ternary(formula, {0: f, 1: g})

    caps = [(1, way), (-1, -way)]
    # Beside f = 0 a band has the g of the form; it is passed through from the cap that has this g too.
    bands = [(-1 if way == sign else 1, sign) for sign in dict.fromkeys(signs)]
    crossed = len(bands) > 1
    if crossed or along:
        bands = [*bands, *bands]
    pieces = {side: _pieces([value(*cap) for cap in caps], [value(*band) for band in bands], side) for side in (1, -1)}
    cracked = any(_is_cracked(value, band) for band in bands)
    reason = f"two sheets touch; small spheres see {pieces[1]} pieces of the inside and {pieces[-1]} of the outside"
    if cracked:
        return Judgement("no sign change", "broken", reason + ", and omega is zero without a change of sign")
    if 0 in pieces.values():
        return Judgement("isolated point", "broken", reason)
    if max(pieces.values()) > 1:
        return Judgement("tangency", "broken", reason)
    if not crossed:
        return Judgement("tangency", "analytic", reason + ": the boundary is one of the sheets")
    return Judgement("tangency", "G0", reason + "; two edges cross, the angle between the sheets is 0 there")


def _pieces(caps: list[int], bands: list[int], side: int) -> int:
    """How many pieces one side has; each band lies between both caps, which meet nowhere else."""
    own_caps, own_bands = caps.count(side), bands.count(side)
    return (1 if own_bands else own_caps) if own_caps else own_bands


def _is_cracked(value: Callable[[int, int], int], band: tuple[int, int]) -> bool:
    """Whether the formula is zero on a sheet beside a band, with one sign on both sides."""
    for zero in (0, 1):
        (f, g), (u, v) = [(way * band[0], band[1]) if zero == 0 else (band[0], way * band[1]) for way in (0, -1)]
        if value(f, g) == 0 and value(u, v) == value(*band):
            return True
    return False
