"""A bilinear and a linear form as data: coefficients of pairs of derivatives, inside and on parts of the boundary."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import sympy as sp

from rsym.arrays import Floats
from rsym.model.symbols import real_symbol, symbols_of
from rsym.problems.conditions import Name
from rsym.problems.terms import Row

INSIDE, BOUNDARY = "inside", "boundary"
SIZE, NORMALS = "w__h", ("w__n0", "w__n1", "w__n2")  # what cells and boundaries are known by alone


@dataclass(frozen=True)
class FormTerms:
    """The coefficients of a bilinear form, by numbers of derivatives of v and u, and those of a linear one, of v.

    Examples
    --------
    >>> one = FormTerms({(0, 0): sp.S(2)}, {})
    >>> one.plus(FormTerms({(0, 0): sp.S(1), (0, 1): sp.S(1)}, {0: sp.S(3)}))
    FormTerms(form={(0, 0): 3, (0, 1): 1}, load={0: 3})
    """

    form: Mapping[tuple[int, int], sp.Expr] = field(default_factory=dict)
    load: Mapping[int, sp.Expr] = field(default_factory=dict)

    def plus(self, other: FormTerms) -> FormTerms:
        """The sum."""
        return FormTerms(_sum(self.form, other.form), _sum(self.load, other.load))

    @property
    def negated(self) -> FormTerms:
        """Both times -1."""
        return FormTerms({k: -one for k, one in self.form.items()}, {k: -one for k, one in self.load.items()})

    @property
    def symmetric(self) -> bool:
        """Whether u and v may be exchanged."""
        return all(self.form.get((j, i)) == value for (i, j), value in self.form.items())

    @property
    def expressions(self) -> dict[str, sp.Expr]:
        """All of them by name."""
        found = {form_name(i, j): value for (i, j), value in self.form.items()}
        return found | {load_name(i): value for i, value in self.load.items()}


def form_name(test: int, trial: int) -> str:
    """What the coefficient of a pair of derivatives is called."""
    return f"a {test} {trial}"


def load_name(test: int) -> str:
    """What that of a derivative of v is called; of v itself as in equations."""
    return f"f{test}" if test else "f"


def _sum(one: Mapping[Any, sp.Expr], other: Mapping[Any, sp.Expr]) -> dict[Any, sp.Expr]:
    total = {key: one.get(key, sp.S.Zero) + other.get(key, sp.S.Zero) for key in (*one, *other)}
    return {key: value for key, value in total.items() if value != 0}


@dataclass(frozen=True)
class WeakForm:
    """a(u, v) = l(v) for all v: what `EllipticEquation` is to an equation.

    edges : the terms that are integrated along parts of the boundary, those of a and those of l by themselves, by name:
        along one, ``boundary`` along all of it, ``...`` along what none of the others names.
    functions : the Python functions of coordinates that names in the coefficients stand for.
    """

    coordinates: tuple[sp.Symbol, ...]
    inside: FormTerms
    edges: tuple[Mapping[Name, FormTerms], ...] = ()
    functions: Mapping[str, Callable[..., Any]] = field(default_factory=dict)

    @property
    def _every(self) -> list[FormTerms]:
        """All terms, those inside first."""
        return [self.inside, *(terms for own in self.edges for terms in own.values())]

    @property
    def _seconds(self) -> int:
        """The number of the first of the second derivatives."""
        return 1 + len(self.coordinates)

    @property
    def order(self) -> int:
        """4 with second derivatives of u times those of v, else 2."""
        return 4 if any(min(pair) >= self._seconds for pair in self.inside.form) else 2

    @cached_property
    def highest(self) -> int:
        """The order of the highest derivatives of u or v."""
        kinds = [kind for one in self._every for kind in (*(k for pair in one.form for k in pair), *one.load)]
        return 2 if max(kinds, default=0) >= self._seconds else 1

    @property
    def diffusion(self) -> tuple[Row, ...]:
        """The coefficients of the first derivatives of both."""
        n = range(1, 1 + len(self.coordinates))
        return tuple(tuple(self.inside.form.get((i, j), sp.S.Zero) for j in n) for i in n)

    @property
    def leading(self) -> sp.Expr:
        """The coefficient whose sign is that of the highest derivatives."""
        pairs = [(k, k) for k in (self._seconds, 1, 0)][(0 if self.order == 4 else 1) :]
        return next((self.inside.form[pair] for pair in pairs if pair in self.inside.form), sp.S.Zero)

    @property
    def symmetric(self) -> bool:
        """Whether the form is, on the boundary too."""
        return all(one.symmetric for one in self._every)

    @property
    def definite(self) -> bool:
        """Whether the form is symmetric and not below 0, for what can be said of its coefficients."""
        within = {(i, j) for i in range(1, self._seconds) for j in range(1, self._seconds)} | {(0, 0)}
        on = {(0, 0)}
        plain = within.issuperset(self.inside.form) and all(on.issuperset(one.form) for one in self._every[1:])
        mass = [one.form.get((0, 0), sp.S.Zero) for one in self._every]
        return self.symmetric and plain and all(one.is_nonnegative for one in mass)

    @property
    def places(self) -> dict[tuple[int, int], str]:
        """Which expression is the coefficient of a pair of derivatives of v and u."""
        return {pair: self._name(*pair) for pair in self.inside.form}

    @property
    def load_places(self) -> dict[int, str]:
        """And which that of a derivative of v on the right side."""
        return {kind: load_name(kind) for kind in self.inside.load}

    def _name(self, test: int, trial: int) -> str:
        first = range(1, self._seconds)
        return f"a{test - 1}{trial - 1}" if test in first and trial in first else form_name(test, trial)

    @property
    def expressions(self) -> dict[str, sp.Expr]:
        """The coefficients inside by names: ``a01`` and the like first, as those of equations, 0 or not; ``f``."""
        found = {f"a{i}{j}": value for i, row in enumerate(self.diffusion) for j, value in enumerate(row)}
        found |= {self._name(*pair): value for pair, value in self.inside.form.items()}
        return found | {"f": sp.S.Zero} | {load_name(k): value for k, value in self.inside.load.items()}

    @property
    def negated(self) -> WeakForm:
        """The same times -1."""
        edges = tuple({name: one.negated for name, one in own.items()} for own in self.edges)
        return replace(self, inside=self.inside.negated, edges=edges)

    @property
    def sized(self) -> bool:
        """Whether the size of cells is in it."""
        return real_symbol(SIZE) in symbols_of(*(value for one in self._every for value in one.expressions.values()))

    def on_leaf(self, names: Sequence[str]) -> FormTerms:
        """What is integrated along a leaf of the boundary that has these names, that of the smallest part first.

        Examples
        --------
        >>> terms = {name: FormTerms({}, {0: sp.S(k)}) for k, name in enumerate(("half", "rim", "boundary", ...), 1)}
        >>> form = WeakForm((), FormTerms(), (terms,))
        >>> [form.on_leaf(names).load for names in (["rim", "half"], ["half"], ["bore"])]
        [{0: 5}, {0: 4}, {0: 7}]
        """
        total = FormTerms()
        for own in self.edges:
            chosen: Name = next((name for name in names if name in own), ...)
            for name in (BOUNDARY, chosen):
                total = total.plus(own.get(name, FormTerms()))
        return total


@dataclass(frozen=True)
class GivenValues:
    """The function of coordinates that has one value everywhere, or given ones at the points it is asked for."""

    values: float | Floats

    def __call__(self, *coordinates: Any) -> float | Floats:
        """These values."""
        return self.values


def sized(form: WeakForm, size: float) -> WeakForm:
    """The form on cells of a size."""
    return replace(form, functions={**form.functions, SIZE: GivenValues(size)})
