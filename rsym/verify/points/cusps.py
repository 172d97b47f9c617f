"""Cusps: a leaf whose second derivatives vanish along one line, and whose third do not (A_2).

At a zero p of a leaf F and of its gradient let the matrix of second derivatives be semidefinite with a kernel of
dimension 1, along k, and F'''(k, k, k) = c not 0. By the splitting lemma there are coordinates a, b, u near p with
F = s (a**2 + b**2) + g(u), s = 1 or -1; the third derivative of g is c up to a factor, for the critical point in a, b
moves by O(u**2) alone. So g is strictly monotone, and F = 0 is the graph of a continuous function u of a, b: a
surface. It leaves p along one ray of the kernel, as a**2 + b**2 is of the size of |u|**3, while a surface with a
tangent plane leaves in all its directions: it is no better than G0. Source: Arnold, Gusein-Zade and Varchenko,
Singularities of Differentiable Maps I (1985), section 11.
"""

from __future__ import annotations

from itertools import product

from rsym.bounds.balls import exact
from rsym.model.vectors import cross
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.vanishing import Exact
from rsym.verify.points.contacts import Judgement

KIND = "cusp"


def cusp(known: Exact, at: Local, leaf: int) -> Judgement | None:
    """Whether a leaf, which vanishes at a point with its gradient, has a cusp there.

    Examples
    --------
    >>> import rsym
    >>> from fractions import Fraction
    >>> from rsym import x, y, z
    >>> from rsym.bounds.balls import arb
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.Shape(z**3 - x**2 - y**2 + x * z**2, (x, y, z)), {})
    >>> at = model.on([arb(0)] * 3)
    >>> cusp(Exact(at, dict.fromkeys("xyz", Fraction(0)), frozenset()), at, model.root).continuity
    'G0'
    """
    second = [at.model.gradient(first) for first in at.model.gradient(leaf)]
    found = [known.value(node) for row in second for node in row]
    values = [value for value in found if value is not None]
    if len(values) < len(found):
        return None
    rows = [values[:3], values[3:6], values[6:]]
    cofactors = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])]
    if sum(a * b for a, b in zip(rows[0], cofactors[0], strict=True)) != 0:
        return None
    # Of a matrix of rank 2 each row of cofactors is in the kernel; a positive minor says that the form has one sign.
    along = next((row for k, row in enumerate(cofactors) if row[k] > 0), None)
    if along is None:
        return None
    direction = [exact(part) for part in along]
    third = sum(
        (direction[i] * direction[j] * slope * direction[k])
        for i, j in product(range(3), repeat=2)
        for k, slope in enumerate(at.gradient(second[i][j]))
    )
    if third == 0 or third.contains(0):
        return None
    return Judgement(KIND, "G0", "a surface that leaves the point along one ray: of two squares and a third power")
