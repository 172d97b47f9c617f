"""Energies of patches f(u)^T Q g(v), from the Gram matrices of their blending functions.

    J_k = integral of the sum over i + j = k of binomial(k, i) |d^k p/du^i dv^j|^2
        = sum over x, y, z and i + j = k of binomial(k, i) trace(K_i Q L_j Q^T),     K_i = integral of f^(i) f^(i)^T,

L_j the same of g: J_1 is the stretch, J_2 the bending of a thin plate, J_3 the jerk. Functions that are linear in a
parameter, f = f0 + lambda f1, have Gram matrices quadratic in it, and the energy is quadratic in the parameter of each
direction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import comb
from typing import Any, TypeAlias

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.symbols import real_symbol
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.coons.bicubic import BicubicCoons
from rsym.surfaces.functions.formulas import CompiledFormulas
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.symbols import t

Weights: TypeAlias = tuple[float, float, float]

BENDING: Weights = (0.0, 1.0, 0.0)
# Gauss's rule with so many places is exact up to degree 39; it is applied to halves until the digits stand.
PLACES, MOST_PANELS, AGREEMENT = 20, 256, 1e-12
# Second differences of functions linear in a parameter are rounding.
LINEAR = 1e-12


def energy(patch: BicubicCoons, weights: Weights = BENDING, *, letters: LetterValues = None) -> float:
    """w1 J_1 + w2 J_2 + w3 J_3, by default the bending of a thin plate.

    Examples
    --------
    >>> paraboloid = np.zeros((4, 4, 3))
    >>> paraboloid[1, :, 2] = [1, 1, 0, 0]
    >>> paraboloid[3, :, 2] = [2, 2, 0, 0]  # z = u**2, p_uu = 2
    >>> round(energy(BicubicCoons(paraboloid)), 12)
    4.0
    """
    return float(coefficients(patch, (None, None), weights, letters)[0, 0])


def coefficients(
    patch: BicubicCoons, parameters: tuple[str | None, str | None], weights: Weights, letters: LetterValues
) -> Floats:
    """The energy as sum of c[a, b] lambda_u**a lambda_v**b, (3, 3): a letter for each direction, or none."""
    if not isinstance(patch, BicubicCoons):
        raise RsymError(
            f"the energy is that of a BicubicCoons, got {type(patch).__name__}",
            code="patch",
            remedy="give the patch of a corner information matrix",
        )
    factors = checked_weights(weights)
    values = patch.letters.values_with(letters)
    grams_u, grams_v = (
        gram_matrices(blend, name, values, [k for k in range(4) if any(factors[k:])])
        for blend, name in zip((patch.blend_u, patch.blend_v), parameters, strict=True)
    )
    matrix = patch.data(patch.data.domain[0], letters={name: values[name] for name in patch.data.letters})
    total = np.zeros((3, 3))
    for k, weight in enumerate(factors):
        for i in range(k + 1) if weight else ():
            total += weight * comb(k, i) * np.einsum("amn,npc,bpq,mqc->ab", grams_u[i], matrix, grams_v[k - i], matrix)
    return total


def gram_matrices(
    blend: HermiteBlend, parameter: str | None, values: Mapping[str, float], orders: Sequence[int]
) -> dict[int, Floats]:
    """By the order k: the coefficients (3, n, n) of 1, lambda, lambda**2 in the integral of f^(k) f^(k)^T.

    Examples
    --------
    >>> gram_matrices(HermiteBlend.linear(), None, {}, [0])[0][0].round(12).tolist()
    [[0.333333333333, 0.166666666667], [0.166666666667, 0.333333333333]]
    """
    parts = linear_parts(blend, parameter, values)
    known = CompiledFormulas([one for part in parts for one in part], (t.name,), blend.letters, ((0.0, 1.0),))

    def integrals(panels: int) -> Floats:
        places, weights = _gauss(panels)
        rows = known.interpreted(places, [(order,) for order in orders], values)
        constant, slope = np.moveaxis(rows.reshape(len(orders), 2, -1, len(places)), 1, 0)
        square, mixed, last = (
            np.einsum("kmp,knp,p->kmn", a, b, weights) for a, b in ((constant,) * 2, (constant, slope), (slope,) * 2)
        )
        return np.stack([square, mixed + mixed.transpose(0, 2, 1), last], axis=1)

    return dict(zip(orders, _settled(integrals), strict=True))


def linear_parts(
    blend: HermiteBlend, parameter: str | None, values: Mapping[str, float]
) -> tuple[tuple[sp.Expr, ...], tuple[sp.Expr, ...]]:
    """f0 and f1 of functions f0 + lambda f1."""
    if parameter is None or parameter not in blend.letters:
        return blend.functions, (sp.Integer(0),) * len(blend.functions)
    at = [[one.xreplace({real_symbol(parameter): sp.Integer(k)}) for one in blend.functions] for k in range(3)]
    known = CompiledFormulas([one for row in at for one in row], (t.name,), blend.letters, ((0.0, 1.0),))
    rows = known.interpreted(_gauss(1)[0], [(0,)], values).reshape(3, -1, PLACES)
    if not np.abs(rows[2] - 2 * rows[1] + rows[0]).max() <= LINEAR * np.abs(rows).max():
        raise RsymError(
            f"the blending functions are not linear in {parameter!r}",
            code="not-linear",
            remedy="choose the lambda of class1, the mu of class2 or the nu of trigonometric; alpha is none of them",
        )
    return tuple(at[0]), tuple(one - zero for zero, one in zip(at[0], at[1], strict=True))


def checked_weights(weights: Weights) -> tuple[float, ...]:
    """0 for positions and the weights of stretch, bending and jerk."""
    given = np.asarray(weights, np.float64)
    if given.shape != (3,) or not np.isfinite(given).all() or (given < 0).any() or not given.any():
        raise RsymError(
            f"the weights of stretch, bending and jerk are three numbers >= 0, not all 0, got {weights!r}",
            code="weights",
            remedy="(0, 1, 0) is bending alone",
        )
    return (0.0, *given.tolist())


def _gauss(panels: int) -> tuple[Floats, Floats]:
    """Places and weights on [0, 1]."""
    places, weights = np.polynomial.legendre.leggauss(PLACES)
    starts = np.arange(panels)[:, None] / panels
    return (starts + (places + 1) / (2 * panels)).reshape(-1), np.tile(weights / (2 * panels), panels)


def _settled(integrals: Any) -> Floats:
    """The integrals, once halving the panels changes nothing."""
    panels, found = 2, integrals(1)
    while panels <= MOST_PANELS:
        finer = integrals(panels)
        if (np.abs(finer - found) <= AGREEMENT * np.abs(finer).max(axis=(1, 2, 3), keepdims=True)).all():
            return np.asarray(finer)
        panels, found = 2 * panels, finer
    raise RsymError(
        "an energy of these blending functions is infinite, or too rough to integrate",
        code="energy",
        remedy="bending needs continuous slopes and jerk continuous second derivatives: take a smoother F1",
    )
