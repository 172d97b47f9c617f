"""Piecewise polynomials of one parameter."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from scipy.interpolate import PPoly

from rsym.arrays import Floats
from rsym.surfaces.functions.formulas import exact
from rsym.surfaces.functions.univariate import Univariate
from rsym.surfaces.parameters import LetterValues
from rsym.surfaces.symbols import t as parameter


class Polynomials(Univariate):
    """A piecewise polynomial with values of any shape, as `scipy.interpolate.PPoly` holds it.

    Examples
    --------
    >>> import numpy as np
    >>> hat = Polynomials(PPoly(np.array([[1.0, -1.0], [0.0, 1.0]]), np.array([0.0, 1.0, 2.0])))
    >>> hat([0.5, 1.5]).tolist(), hat([0.5, 1.5], 1).tolist()
    ([0.5, 0.5], [1.0, -1.0])
    """

    def __init__(self, polynomials: PPoly, *, closed: bool = False) -> None:
        self.polynomials = polynomials
        self.shape = polynomials.c.shape[2:]
        self.domain = (float(polynomials.x[0]), float(polynomials.x[-1]))
        self.closed = closed
        self._derivatives = {0: polynomials}

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders; at a knot those of the piece that begins there."""
        return [self._derivative(order)(t) for order in orders]

    def _derivative(self, order: int) -> PPoly:
        if order not in self._derivatives:
            self._derivatives[order] = self.polynomials.derivative(order)
        return self._derivatives[order]

    @property
    def is_smooth_formula(self) -> bool:
        """Whether there is one piece alone."""
        return len(self.polynomials.x) == 2

    def expressions(self) -> sp.ImmutableDenseNDimArray:
        """The pieces in t."""
        knots = [exact(knot) for knot in self.polynomials.x]
        coefficients = self.polynomials.c.reshape(*self.polynomials.c.shape[:2], -1)
        entries = [_pieces(coefficients[:, :, column], knots) for column in range(coefficients.shape[2])]
        return sp.ImmutableDenseNDimArray(entries, self.shape)


def _pieces(coefficients: Floats, knots: Sequence[sp.Expr]) -> sp.Expr:
    """The polynomials of one component, highest power first, each from its own knot."""
    pieces = [
        sum((exact(c) * (parameter - start) ** power for power, c in enumerate(piece[::-1])), sp.S.Zero)
        for piece, start in zip(coefficients.T, knots, strict=False)
    ]
    if len(pieces) == 1:
        return pieces[0]
    inner = [(piece, parameter < end) for piece, end in zip(pieces[:-1], knots[1:], strict=False)]
    return sp.Piecewise(*inner, (pieces[-1], True))
