"""Ribbons: what a patch does across its edges, as given or as it follows from the edges alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.surfaces.blends.blending import HermiteBlend
from rsym.surfaces.functions.curves import as_curve
from rsym.surfaces.functions.entries import entries_of, exact
from rsym.surfaces.functions.univariate import LetterValues, Sampled, Stack, Univariate, Unvarying, on_interval

EDGES = ("u0", "u1", "v0", "v1")


class Blended(Univariate):
    """The curve sum_a f_a(t) d_a of functions (n,) and constants (n, 3)."""

    def __init__(self, functions: Univariate, data: Univariate) -> None:
        self.functions, self.data = functions, data
        self.shape, self.domain = data.shape[1:], functions.domain
        self.letters = functions.letters.merge(data.letters)

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        data = self.data.at_start(letters)
        parts = self.functions.evaluate(t, orders, letters)
        return [np.add.reduce([part[..., row, None] * one for row, one in enumerate(data)]) for part in parts]

    @property
    def is_smooth_formula(self) -> bool:
        """Whether functions and constants are."""
        return self.functions.is_smooth_formula and self.data.is_smooth_formula

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The value, if functions and constants are formulas."""
        functions, data = self.functions.expressions(), self.data.expressions()
        if functions is None or data is None:
            return None
        flat, rows = entries_of(data), entries_of(functions)
        return sp.ImmutableDenseNDimArray(
            [sum((f * flat[3 * row + c] for row, f in enumerate(rows)), sp.S.Zero) for c in range(3)], (3,)
        )


class Combination(Univariate):
    """A sum of functions of one shape with constant weights, numbers or arrays that broadcast to the shape."""

    def __init__(self, curves: Sequence[Univariate], weights: Sequence[ArrayLike]) -> None:
        self.stack = Stack(curves)
        self.shape, self.domain = self.stack.shape[1:], self.stack.domain
        self.closed, self.letters = self.stack.closed, self.stack.letters
        self.weights = [np.broadcast_to(np.asarray(weight, np.float64), self.shape) for weight in weights]

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        each = [curve.evaluate(t, orders, letters) for curve in self.stack.curves]
        terms = [[weight * part for part in parts] for weight, parts in zip(self.weights, each, strict=True)]
        return [np.add.reduce(parts) for parts in zip(*terms, strict=True)]

    @property
    def is_smooth_formula(self) -> bool:
        """Whether what it is made of is."""
        return self.stack.is_smooth_formula

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The sum, if all are formulas."""
        inner = self.stack.expressions()
        if inner is None:
            return None
        flat, size = entries_of(inner), prod(self.shape)
        entries = [
            sum((exact(w.flat[k]) * flat[row * size + k] for row, w in enumerate(self.weights)), sp.Integer(0))
            for k in range(size)
        ]
        return sp.ImmutableDenseNDimArray(entries, self.shape)


def tangent_ribbons(edges: Mapping[str, Univariate]) -> dict[str, Univariate]:
    """For each edge the cubic ribbon with the tangents of the edges that it ends on, and Adini's twists.

    p_uv(i, j) = p_v(1, j) - p_v(0, j) + p_u(i, 1) - p_u(i, 0) - (p(1, 1) - p(1, 0) - p(0, 1) + p(0, 0)): what a
    surface f(u){1, v} + {1, u}g(v) through the corners has.
    """
    functions = HermiteBlend.cubic().curve
    twist = [[_adini(edges, i, j) for j in (0, 1)] for i in (0, 1)]
    ribbons: dict[str, Univariate] = {}
    for end in (0, 1):
        across_u = [_at(edges[f"v{j}"], end, 1) for j in (0, 1)]
        across_v = [_at(edges[f"u{i}"], end, 1) for i in (0, 1)]
        ribbons[f"u{end}"] = Blended(functions, Stack([*across_u, *twist[end]]))
        ribbons[f"v{end}"] = Blended(functions, Stack([*across_v, twist[0][end], twist[1][end]]))
    return ribbons


def _adini(edges: Mapping[str, Univariate], i: int, j: int) -> Univariate:
    slopes = [_at(edges["u1"], j, 1), _at(edges["u0"], j, 1), _at(edges["v1"], i, 1), _at(edges["v0"], i, 1)]
    points = [_at(edges["u1"], 1, 0), _at(edges["u1"], 0, 0), _at(edges["u0"], 1, 0), _at(edges["u0"], 0, 0)]
    return Combination([*slopes, *points], [1, -1, 1, -1, -1, 1, 1, -1])


def _at(curve: Univariate, place: int, order: int) -> Univariate:
    """A point or tangent of a curve over [0, 1], as a constant (3,)."""
    return Row(Sampled(curve, [float(place)], [order]))


class Row(Unvarying):
    """The first row of a constant (1, 3), as a constant (3,)."""

    def __init__(self, rows: Unvarying) -> None:
        self.rows, self.shape = rows, rows.shape[1:]
        self.domain, self.letters = rows.domain, rows.letters

    def value(self, letters: LetterValues = None) -> Floats:
        """The row."""
        return np.asarray(self.rows.value(letters)[0])

    @property
    def is_smooth_formula(self) -> bool:
        """Whether the rows are."""
        return self.rows.is_smooth_formula

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The row, if it is a formula."""
        inner = self.rows.expressions()
        return None if inner is None else sp.ImmutableDenseNDimArray(entries_of(inner), self.shape)


def unit_curve(given: Any, letters: Mapping[Any, Any] | None, what: str) -> Univariate:
    """Whatever a user means by a curve, over [0, 1]."""
    return on_interval(as_curve(given, letters, what=what), 0.0, 1.0)


def ribbons_of(
    edges: Mapping[str, Univariate], ribbons: Mapping[str, Any] | None, order: int, letters: Mapping[Any, Any] | None
) -> list[dict[str, Univariate]]:
    """The edges and their derivatives across, order by order."""
    if order == 1 or ribbons is None:
        if order == 3 or (order == 1 and ribbons is not None):
            expected = "no ribbons" if order == 1 else "ribbons (first, second) for each edge"
            raise RsymError(f"a patch of class {order} takes {expected}", code="ribbons", remedy="change order=")
        return [dict(edges)] if order == 1 else [dict(edges), tangent_ribbons(edges)]
    if set(ribbons) != set(EDGES):
        raise RsymError(
            f"ribbons are given for {', '.join(EDGES)}, got {', '.join(map(str, ribbons))}",
            code="ribbons",
            remedy="a mapping from each edge to the derivative across it",
        )
    rows: list[dict[str, Univariate]] = [dict(edges)] + [{} for _ in range(order - 1)]
    for name in EDGES:
        for row, one in zip(rows[1:], _derivatives_across(ribbons[name], order, name), strict=True):
            row[name] = unit_curve(one, letters, f"the ribbon of the edge {name}")
    return rows


def _derivatives_across(given: Any, order: int, name: str) -> Sequence[Any]:
    """The order - 1 ribbons of one edge; one alone need not be wrapped."""
    if isinstance(given, tuple | list) and len(given) == order - 1 and (order == 3 or not _is_number(given[0])):
        return given
    if order == 2:
        return (given,)
    raise RsymError(
        f"a patch of class 3 takes a pair (first, second derivative) across the edge {name}", code="ribbons"
    )


def _is_number(given: Any) -> bool:
    return np.ndim(given) == 0 and not callable(given) and not isinstance(given, Univariate)
