"""Arcs of constant curvature, lines and circles: proved where the arc is that of a polynomial.

k = -N/g**p with polynomials N and g**2 is constant along F = 0 where 2 g**2 T(N) - p N T(g**2) vanishes there, T the
derivative along the arc; a multiple of F does.
"""

from __future__ import annotations

import sympy as sp

from rsym.verify.local import Model
from rsym.verify.polynomials import polynomial_of

HIGHEST = 12  # degree of F, beyond which dividing takes longer than it is worth


def constant_curvatures(model: Model, function: int) -> tuple[bool, ...]:
    """Which curvatures of an arc are proved to be constant: along it and, for a body of revolution, across."""
    count = 2 if model.body else 1
    expression = polynomial_of(model, function)
    symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
    if expression is None or sp.Poly(expression, *symbols).total_degree() > HIGHEST:
        return (False,) * count
    f = sp.Poly(expression, *symbols, domain=sp.QQ)
    fx, fy = f.diff(symbols[0]), f.diff(symbols[1])
    square = fx**2 + fy**2
    bent = fx.diff(symbols[0]) * fy**2 - 2 * fx.diff(symbols[1]) * fx * fy + fy.diff(symbols[1]) * fx**2
    forms = [(bent, 3)]
    if model.body:
        ratio, rest = sp.div(fy, sp.Poly(symbols[1], *symbols, domain=sp.QQ))
        forms.append((ratio, 1) if rest.is_zero else (sp.Poly(symbols[0], *symbols, domain=sp.QQ), 0))

    def along(p: sp.Poly) -> sp.Poly:
        return fy * p.diff(symbols[0]) - fx * p.diff(symbols[1])

    changes = [2 * square * along(top) - power * top * along(square) for top, power in forms]
    return tuple(bool(sp.div(change, f)[1].is_zero) for change in changes)
