"""Folds that cancel: a function with switches that is one polynomial all the same.

The switches that occur, one after the other, are polynomials other than zero, so the points at which none of them is
zero are dense. At such a point the function is that to which the signs of the switches lead. If all signs that
switches can have together lead to one polynomial P, a continuous function is P everywhere. Signs that exclude one
another need not be looked at: of x - y > 0 and y - z > 0, x - z > 0 follows.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from itertools import combinations_with_replacement
from typing import TypeAlias

import sympy as sp

from rsym.verify.generators import generators
from rsym.verify.local import Local
from rsym.verify.polynomials import polynomial_of
from rsym.verify.resolution import resolve

MOST = 128  # functions that are looked at: a fold of three coordinates takes a dozen
Form: TypeAlias = Mapping[tuple[int, ...], Fraction]  # a polynomial, its coefficients by the powers
_CONTINUOUS = frozenset({"abs", "min", "max"})
_WHOLE = -1  # no node: what the box decides is decided, nothing else


def folded(local: Local, number: int) -> sp.Poly | None:
    """The polynomial that a node is on a box on which it has switches; None where it is not proved to be one.

    Examples
    --------
    >>> import rsym, sympy as sp
    >>> from rsym import x, y, z
    >>> from rsym.verify.local import Model
    >>> model = Model(rsym.Shape(sp.Max(x, y) + sp.Min(x, y) - z, (x, y, z)), {})
    >>> folded(model.over(((-1, 1),) * 3), model.root).as_expr()
    x + y - z
    """
    found, count = None, 0
    stack: list[tuple[int, tuple[Form, ...]]] = [(number, ())]
    while stack:
        part, known = stack.pop()
        count += 1
        made = generators(local, part)
        nodes = local.model.builder.nodes
        if count > MOST or made.hard or not all(nodes[one].operation in _CONTINUOUS for one in made.switched):
            return None
        if not made.switches:
            polynomial = _polynomial(local, part)
            if polynomial is None or (found is not None and polynomial != found):
                return None
            found = polynomial
            continue
        switch = next((one for one in made.switches if generators(local, one).analytic), None)
        tested = None if switch is None else _polynomial(local, switch)
        if switch is None or tested is None:
            return None
        if tested.is_zero:  # what is compared is one function
            stack.append((resolve(local, part, switch, 1), known))
            continue
        form = _form(tested)
        opposite = {powers: -value for powers, value in form.items()}
        for side, own in ((1, form), (-1, opposite)):
            other = opposite if side > 0 else form
            if not any(_follows(other, first, second) for first, second in combinations_with_replacement(known, 2)):
                stack.append((resolve(local, part, switch, side), (*known, own)))
    return found


def _polynomial(local: Local, number: int) -> sp.Poly | None:
    written = polynomial_of(local.model, resolve(local, number, _WHOLE, 1))
    symbols = [sp.Symbol(name, real=True) for name in local.model.builder.coordinates]
    return None if written is None else sp.Poly(written, *symbols, domain=sp.QQ)


def _form(polynomial: sp.Poly) -> Form:
    return {powers: Fraction(int(value.p), int(value.q)) for powers, value in polynomial.terms()}


def _follows(form: Form, first: Form, second: Form) -> bool:
    """Whether a form is a*first + b*second with a, b >= 0, not both zero: it is positive where these are."""
    powers = list({*form, *first, *second})
    rows = [[one.get(power, Fraction(0)) for one in (form, first, second)] for power in powers]
    for (f, p, q), (g, r, s) in combinations_with_replacement(rows, 2):
        determinant = p * s - q * r
        if determinant:
            a, b = (f * s - q * g) / determinant, (p * g - f * r) / determinant
            return a >= 0 and b >= 0 and a + b > 0 and all(v == a * u + b * w for v, u, w in rows)
    pairs = [(v, u) for v, u, _ in rows if u]
    ratio = pairs[0][0] / pairs[0][1]
    return ratio > 0 and all(v == ratio * u for v, u, _ in rows)
