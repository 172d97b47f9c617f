"""Surfaces that are given as formulas in u and v."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters, as_letters
from rsym.model.symbols import real_replacements, symbols_of
from rsym.surfaces.functions.formulas import CompiledFormulas, entries_and_shape, exact
from rsym.surfaces.parameters import LetterValues, as_interval
from rsym.surfaces.patch import Domain, Orders, Patch


class ParametricSurface(Patch):
    """The patch (x(u, v), y(u, v), z(u, v)) of three SymPy expressions.

    Parameters
    ----------
    point : three expressions in u and v
        What else they contain must be letters.
    domain : pair of pairs of float
        The intervals of u and v.
    letters : mapping, optional
        Symbols or names to numbers or `rsym.Letter`.
    closed : pair of bool
        Whether it closes smoothly in u, and in v.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym.surfaces.symbols import u, v
    >>> r = sp.Symbol("r")
    >>> tube = ParametricSurface((r * sp.cos(u), r * sp.sin(u), v), ((0, 2 * sp.pi), (0, 1)), letters={r: 2})
    >>> tube(0, 1).tolist(), float(tube.mean_curvature(1, 0)), float(tube.mean_curvature(1, 0, letters={"r": 4}))
    ([2.0, 0.0, 1.0], -0.25, -0.125)
    """

    def __init__(
        self,
        point: Any,
        domain: tuple[tuple[Any, Any], tuple[Any, Any]] = ((0, 1), (0, 1)),
        *,
        letters: Mapping[Any, Any] | None = None,
        closed: tuple[bool, bool] = (False, False),
    ) -> None:
        entries, shape = entries_and_shape(point)
        known = as_letters(letters)
        unknown = sorted({symbol.name for symbol in symbols_of(*entries)} - {"u", "v", *known})
        if shape != (3,) or unknown:
            raise RsymError(
                f"a surface has an unknown symbol {unknown[0]!r}" if unknown else "a surface has three coordinates",
                code="unknown-letter" if unknown else "surface",
                remedy=f"declare it: letters={{{unknown[0]!r}: number}}" if unknown else "give (x, y, z) in u and v",
            )
        replacements = real_replacements(entries)
        self._point = sp.ImmutableMatrix([entry.xreplace(replacements) for entry in entries])
        if not isinstance(closed, tuple | list) or len(closed) != 2:
            raise RsymError(
                f"closed says it of u and of v, got {closed!r}", code="closed", remedy="closed=(True, False)"
            )
        self._letters, self._closed = known, (bool(closed[0]), bool(closed[1]))
        if not isinstance(domain, Sequence | np.ndarray) or len(domain) != 2:
            raise RsymError(
                f"a domain is a pair of the intervals of u and v, got {domain!r}",
                code="domain",
                remedy="for example ((0, 1), (0, 1))",
            )
        self._domain = as_interval(domain[0], "u"), as_interval(domain[1], "v")
        ends = [[one if isinstance(one, sp.Expr) else exact(float(one)) for one in pair] for pair in domain]
        self._ends = tuple((low, high) for low, high in ends)

    @property
    def ends(self) -> tuple[tuple[sp.Expr, sp.Expr], ...]:
        """The domain exactly: constants as they were given, and floats as the decimals that they are written as."""
        return self._ends

    @property
    def domain(self) -> Domain:
        """The intervals of u and v."""
        return self._domain

    @property
    def closed(self) -> tuple[bool, bool]:
        """As it was declared."""
        return self._closed

    @property
    def letters(self) -> Letters:
        """The named parameters."""
        return self._letters

    def expression(self) -> sp.ImmutableMatrix:
        """The point (x, y, z)."""
        return self._point

    @cached_property
    def _compiled(self) -> CompiledFormulas:
        return CompiledFormulas(list(self._point), ("u", "v"), self._letters, self._domain)

    def evaluate(self, u: Floats, v: Floats, orders: Orders, letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        return self._compiled.evaluate([u, v], orders, self._letters.values_with(letters))
