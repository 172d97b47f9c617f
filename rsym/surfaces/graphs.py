"""Graphs of functions as patches."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from rsym.errors import RsymError
from rsym.model.letters import Letters, as_letters
from rsym.model.shape import Shape
from rsym.model.symbols import x, y
from rsym.model.traversal import substitute
from rsym.surfaces import symbols
from rsym.surfaces.formulas import CompiledFormulas
from rsym.surfaces.patch import Array, Domain, LetterValues, Orders, Patch


class Graph(Patch):
    """The surface z = f(x, y) over a rectangle, with the parameters u = x and v = y.

    Parameters
    ----------
    expression : sympy.Expr
        f, in x, y and letters.
    bounds : pair of pairs
        ((xmin, xmax), (ymin, ymax)).
    letters : mapping, optional
        ``{symbol or name: number or Letter}``.

    Examples
    --------
    >>> saddle = Graph(x * y, ((-1, 1), (-1, 1)))
    >>> saddle(0.5, [0.0, 1.0]).tolist(), saddle.gaussian_curvature(0, 0).tolist()
    ([[0.5, 0.0, 0.0], [0.5, 1.0, 0.5]], -1.0)
    """

    def __init__(self, expression: sp.Expr, bounds: Any, letters: Mapping[Any, Any] | None = None) -> None:
        plane = Shape(expression, (x, y), letters=as_letters(letters), bounds=bounds)
        if plane.bounds is None:
            raise RsymError("a graph needs the rectangle it stands over", code="bounds", remedy="((0, 1), (0, 1))")
        self._domain: Domain = (plane.bounds[0], plane.bounds[1])
        self._letters = plane.letters
        self._height = substitute(plane.expression, {x: symbols.u, y: symbols.v})

    @property
    def domain(self) -> Domain:
        """The rectangle."""
        return self._domain

    @property
    def letters(self) -> Letters:
        """The letters of f."""
        return self._letters

    def expression(self) -> sp.ImmutableMatrix:
        """(u, v, f(u, v))."""
        return sp.ImmutableMatrix([symbols.u, symbols.v, self._height])

    @cached_property
    def _compiled(self) -> CompiledFormulas:
        return CompiledFormulas(list(self.expression()), ("u", "v"), self._letters, self._domain)

    def evaluate(self, u: Array, v: Array, orders: Orders, letters: LetterValues = None) -> list[Array]:
        """The derivatives of these orders."""
        distinct = tuple(dict.fromkeys((int(i), int(j)) for i, j in orders))
        found = self._compiled.evaluate([u, v], distinct, self._letters.values_with(letters))
        return [np.ascontiguousarray(np.moveaxis(found[distinct.index((i, j))], 0, -1)) for i, j in orders]
