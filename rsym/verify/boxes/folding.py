"""Folds that cancel: a function with switches that is one polynomial all the same.

The switches that occur, one after the other, are polynomials other than zero, so the points at which none of them is
zero are dense. At such a point the function is that to which the signs of the switches lead. If all signs that
switches can have together lead to one polynomial P, a continuous function is P everywhere. Signs that exclude one
another need not be looked at: of x - y > 0 and y - z > 0, x - z > 0 follows.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations_with_replacement
from typing import Any, NamedTuple, TypeAlias

from rsym.program.operations import BRANCHING, JUMPING
from rsym.verify.boxes.cyclotomic import Field
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.polynomials import Ring, ring_of
from rsym.verify.boxes.resolution import resolve

MOST = 128  # functions that are looked at: a fold of three coordinates takes a dozen
Form: TypeAlias = Mapping[tuple[int, ...], Any]  # a polynomial, its coefficients by the powers
CONTINUOUS = BRANCHING - JUMPING
WHOLE = -1  # no node: what the box decides is decided, nothing else


class KnownPolynomial(NamedTuple):
    """A node that is a polynomial, and the sign that it has."""

    node: int
    side: int


def folded(local: Local, number: int) -> Any:
    """The polynomial that a node is on a box on which it has switches; None where it is not proved to be one.

    It is an element of the ring of the model.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.Shape(sp.Max(x, y) + sp.Min(x, y) - z, (x, y, z)), {})
    >>> folded(model.over(((-1, 1),) * 3), model.root).as_expr()
    x + y - z
    """
    ring = ring_of(local.model)
    found, count = None, 0
    stack: list[tuple[int, tuple[KnownPolynomial, ...]]] = [(number, ())]
    while stack:
        part, known = stack.pop()
        count += 1
        made = generators(local, part)
        nodes = local.model.builder.nodes
        if count > MOST or made.hard or not all(nodes[one].operation in CONTINUOUS for one in made.switched):
            return None
        if not made.switches:
            polynomial = ring.polynomial(resolve(local, part, WHOLE, 1))
            if polynomial is None or (found is not None and polynomial != found):
                return None
            found = polynomial
            continue
        switch = next((one for one in made.switches if generators(local, one).analytic), None)
        if switch is None:
            return None
        flat = resolve(local, switch, WHOLE, 1)
        tested = ring.polynomial(flat)
        if tested is None:
            return None
        if tested == 0:  # what is compared is one function
            stack.append((resolve(local, part, switch, 1), known))
            continue
        for side in (1, -1):
            other, pairs = KnownPolynomial(flat, -side), combinations_with_replacement(known, 2)
            if not any(_follows(ring, other, first, second) for first, second in pairs):
                stack.append((resolve(local, part, switch, side), (*known, KnownPolynomial(flat, side))))
    return found


def _follows(ring: Ring, other: KnownPolynomial, first: KnownPolynomial, second: KnownPolynomial) -> bool:
    """Whether what is known of two switches tells the same of another. Asked on every box, worked out once."""
    key = other, first, second
    if key not in ring.implied:
        forms = ({powers: value * side for powers, value in ring.polynomial(node).terms()} for node, side in key)
        ring.implied[key] = _is_combined(ring.field, *forms)
    return ring.implied[key]


def _is_combined(field: Field, form: Form, first: Form, second: Form) -> bool:
    """Whether a form is a*first + b*second with a, b >= 0, not both zero: it is positive where these are."""
    powers, zero = list({*form, *first, *second}), field.domain.zero
    rows = [[one.get(power, zero) for one in (form, first, second)] for power in powers]
    for (f, p, q), (g, r, s) in combinations_with_replacement(rows, 2):
        determinant = p * s - q * r
        if determinant != zero:
            a, b = (f * s - q * g) / determinant, (p * g - f * r) / determinant
            if not all(v == a * u + b * w for v, u, w in rows):
                return False
            signs = field.sign(a), field.sign(b)
            return min(signs) >= 0 and max(signs) > 0
    pairs = [(v, u) for v, u, _ in rows if u != zero]
    ratio = pairs[0][0] / pairs[0][1]
    return all(v == ratio * u for v, u, _ in rows) and field.sign(ratio) > 0
