"""Functions of one parameter: curves, ribbons, blending and cardinal functions, and what is made of them.

A value has any shape: () for a scalar, (3,) for a point, (n,) for a basis and
(n, 3) for a family of curves. Patches are sums of products of such functions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from math import prod
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from rsym.arrays import Floats
from rsym.errors import RsymError
from rsym.model.letters import Letters, as_letters
from rsym.surfaces.functions.formulas import CompiledFormulas, entries_and_shape, entries_of, exact, real_expressions
from rsym.surfaces.parameters import Interval, LetterValues, as_interval, inside, parameter_arrays, real_array
from rsym.surfaces.symbols import t

# The parameter of a curve may be written by any of these names.
PARAMETERS = ("t", "u", "v", "s")
NO_LETTERS = Letters({})


class Univariate(ABC):
    """A function of one parameter with values of some shape."""

    shape: tuple[int, ...]
    domain: Interval
    closed: bool = False
    letters: Letters = NO_LETTERS

    @abstractmethod
    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders, (*t.shape, *shape) each; t lies in the domain.

        `letters` is None for the defaults, or holds every letter of this curve and perhaps others.
        """

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The value in `rsym.surfaces.symbols.t` and the letters; None where it is not one formula."""
        return None

    def at_start(self, letters: LetterValues = None) -> Floats:
        """The value at the lower end of the interval: of a function that does not vary, its value."""
        return self.evaluate(np.array(self.domain[0]), [0], letters)[0]

    @property
    def is_smooth_formula(self) -> bool:
        """Whether `expressions` gives formulas without pieces, which a kernel of the whole patch may take in."""
        return False

    def __call__(self, t: ArrayLike, order: int = 0, *, letters: LetterValues = None) -> Floats:
        """The derivative of this order, (*t.shape, *shape)."""
        values = self.letters.values_with(letters) if letters else None
        if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 0:
            raise RsymError(f"an order of derivative is an integer >= 0, got {order!r}", code="order", remedy="order=1")
        (places,) = parameter_arrays(t)
        return self.evaluate(inside(places, self.domain, self.closed, "t"), [int(order)], values)[0]


class Formula(Univariate):
    """SymPy expressions in one parameter, of any shape; compiled, with derivatives to any order.

    Examples
    --------
    >>> helix = Formula((sp.cos(t), sp.sin(t), t / 4), domain=(0, 6))
    >>> helix(0.0).tolist(), helix([0.0, 0.0], 1)[:, 1:].tolist()
    ([1.0, 0.0, 0.0], [[1.0, 0.25], [1.0, 0.25]])
    """

    def __init__(
        self,
        expressions: Any,
        letters: Mapping[Any, Any] | None = None,
        domain: tuple[Any, Any] = (0.0, 1.0),
        *,
        what: str = "a curve",
        closed: bool = False,
    ) -> None:
        entries, self.shape = entries_and_shape(expressions)
        real, self.letters = real_expressions(entries, t, PARAMETERS, as_letters(letters), what)
        self.domain = as_interval(domain, "a curve")
        self.closed = closed
        self._entries = tuple(real)

    @cached_property
    def _compiled(self) -> CompiledFormulas:
        return CompiledFormulas(self._entries, (t.name,), self.letters, (self.domain,))

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        values = letters or self.letters.values_with(None)
        parts = self._compiled.evaluate([t], [(order,) for order in orders], values)
        return [part.reshape((*t.shape, *self.shape)) for part in parts]

    @property
    def is_smooth_formula(self) -> bool:
        """Always."""
        return True

    def expressions(self) -> sp.ImmutableDenseNDimArray:
        """The value in t and the letters."""
        return sp.ImmutableDenseNDimArray(self._entries, self.shape)


class Unvarying(Univariate):
    """A function that does not depend on its parameter, though perhaps on letters."""

    @abstractmethod
    def value(self, letters: LetterValues = None) -> Floats:
        """What it is everywhere, in the shape."""

    def at_start(self, letters: LetterValues = None) -> Floats:
        """The same."""
        return self.value(letters)

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The value, and zero for every derivative."""
        value = self.value(letters)
        return [np.broadcast_to(value * float(order == 0), (*t.shape, *self.shape)) for order in orders]


class Constant(Unvarying):
    """An array of numbers."""

    def __init__(self, values: ArrayLike, domain: Interval = (0.0, 1.0)) -> None:
        self.values = np.array(real_array(values))
        self.shape = self.values.shape
        self.domain = domain
        given = np.array(values, object).reshape(-1)
        self._given = tuple(one if isinstance(one, sp.Expr) else None for one in given)

    def value(self, letters: LetterValues = None) -> Floats:
        """The numbers."""
        return self.values

    @property
    def is_smooth_formula(self) -> bool:
        """Always."""
        return True

    def expressions(self) -> sp.ImmutableDenseNDimArray:
        """The numbers: SymPy's as given, others as fractions."""
        pairs = zip(self._given, self.values.flat, strict=True)
        entries = [exact(value) if given is None else given for given, value in pairs]
        return sp.ImmutableDenseNDimArray(entries, self.shape)


class Stack(Univariate):
    """Several functions of one shape side by side, (n, *shape); their letters are merged by name."""

    def __init__(self, curves: Sequence[Univariate]) -> None:
        self.curves = tuple(curves)
        first = self.curves[0]
        self.shape = (len(self.curves), *first.shape)
        self.domain = first.domain
        self.closed = all(curve.closed for curve in self.curves)
        letters = NO_LETTERS
        for curve in self.curves:
            letters = letters.merge(curve.letters)
            if curve.shape != first.shape or not np.allclose(curve.domain, first.domain):
                raise RsymError(
                    f"functions of the shapes {first.shape} and {curve.shape} over {first.domain} and {curve.domain}"
                    " cannot stand side by side",
                    code="curve",
                    remedy="bring them to a common interval: on_interval(curve, a, b)",
                )
        self.letters = letters

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        each = [curve.evaluate(t, orders, letters) for curve in self.curves]
        return [np.stack(parts, axis=t.ndim) for parts in zip(*each, strict=True)]

    @property
    def is_smooth_formula(self) -> bool:
        """Whether all parts are."""
        return all(curve.is_smooth_formula for curve in self.curves)

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The values, if all are formulas."""
        parts = [curve.expressions() for curve in self.curves]
        if any(part is None for part in parts):
            return None
        return sp.ImmutableDenseNDimArray([entry for part in parts for entry in entries_of(part)], self.shape)


class Resized(Univariate):
    """A curve over another interval: c(m(t)) with the affine map m, which runs backwards if asked to."""

    def __init__(self, curve: Univariate, domain: Interval, *, backwards: bool = False) -> None:
        self.curve = curve
        self.shape, self.closed, self.letters = curve.shape, curve.closed, curve.letters
        self.domain = domain
        (a, b), (c, d) = domain, curve.domain
        self.start, self.end = (d, c) if backwards else (c, d)
        self.speed = (self.end - self.start) / (b - a)

    def evaluate(self, t: Floats, orders: Sequence[int], letters: LetterValues = None) -> list[Floats]:
        """The derivatives of these orders."""
        a, b = self.domain
        share = (t - a) / (b - a)
        # Exact at both ends, where corners must meet.
        inner = np.clip(self.start * (1 - share) + self.end * share, *self.curve.domain)
        parts = self.curve.evaluate(inner, orders, letters)
        return [part * self.speed**order for part, order in zip(parts, orders, strict=True)]

    @property
    def is_smooth_formula(self) -> bool:
        """Whether what it is made of is."""
        return self.curve.is_smooth_formula

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The value, if the curve is a formula."""
        inner = self.curve.expressions()
        if inner is None:
            return None
        a, b, start, end = map(exact, (*self.domain, self.start, self.end))
        return inner.xreplace({t: start + (t - a) * (end - start) / (b - a)})


def on_interval(curve: Univariate, low: float, high: float) -> Univariate:
    """The curve with its parameter brought to [low, high]."""
    return curve if curve.domain == (low, high) else Resized(curve, (float(low), float(high)))


def backwards(curve: Univariate) -> Univariate:
    """The curve run through from its end to its start, over the same interval."""
    return Resized(curve, curve.domain, backwards=True)


class Sampled(Unvarying):
    """Values and derivatives of a function at some places, as a constant: (n, *shape)."""

    def __init__(self, curve: Univariate, places: Sequence[float], orders: Sequence[int]) -> None:
        self.curve = curve
        self.places, self.orders = tuple(places), tuple(orders)
        self.shape = (len(self.places), *curve.shape)
        self.domain, self.letters = curve.domain, curve.letters

    def value(self, letters: LetterValues = None) -> Floats:
        """The samples."""
        wanted = sorted(set(self.orders))
        parts = self.curve.evaluate(np.array(self.places), wanted, letters)
        return np.stack([parts[wanted.index(order)][row] for row, order in enumerate(self.orders)])

    @property
    def is_smooth_formula(self) -> bool:
        """Whether what it is made of is."""
        return self.curve.is_smooth_formula

    def expressions(self) -> sp.ImmutableDenseNDimArray | None:
        """The samples, if the function is a formula."""
        inner = self.curve.expressions()
        if inner is None:
            return None
        rows = [
            entry.diff(t, order).subs(t, exact(place))
            for place, order in zip(self.places, self.orders, strict=True)
            for entry in entries_of(inner)
        ]
        return sp.ImmutableDenseNDimArray(rows, self.shape)


class SingleSample(Sampled):
    """The value or a derivative of a function at one place, as a constant of its shape."""

    def __init__(self, curve: Univariate, place: float, order: int) -> None:
        super().__init__(curve, [place], [order])
        self.shape = curve.shape

    def value(self, letters: LetterValues = None) -> Floats:
        """The sample."""
        return np.asarray(super().value(letters)[0])


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
