"""What a weak form reckons with: sums of coefficients times a derivative of v, of u, or of both.

A form is called once, with such sums instead of arrays. What is not linear is refused where it happens; what is left at
the end are the coefficients, expressions in coordinates and letters.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rsym.errors import RsymError
from rsym.model.arguments import number
from rsym.problems.splines.cardinals import derivatives

NONE = -1  # where no derivative of v, or of u, stands
Term = tuple[int, int]  # numbers of derivatives in the order of `derivatives`: of v, of u
LINEAR = "a form is a sum of terms, each a coefficient times one of u and its derivatives times one of v and its own"
AS_LETTER = 'what is no formula goes in as a letter: letters={"k": function}, and w.k stands for it in the form'
# NumPy's functions look for methods of these names.
FUNCTIONS: Mapping[str, Callable[..., Any]] = {
    "sqrt": sp.sqrt,
    "exp": sp.exp,
    "log": sp.log,
    "sin": sp.sin,
    "cos": sp.cos,
    "tan": sp.tan,
    "arcsin": sp.asin,
    "arccos": sp.acos,
    "arctan": sp.atan,
    "arctan2": sp.atan2,
    "sinh": sp.sinh,
    "cosh": sp.cosh,
    "tanh": sp.tanh,
    "hypot": lambda a, b: sp.sqrt(a**2 + b**2),
    "conjugate": lambda a: a,
}


@dataclass(frozen=True, eq=False, repr=False)
class Traced:
    """A sum of coefficients times derivatives.

    terms : the coefficients, none of them 0.
    words : how each derivative is written behind its function: "", "_x", "_xy".

    Examples
    --------
    >>> from rsym import x
    >>> u, v = form_functions(("x", "y"), None)
    >>> (x * u * v.grad[0] + u.grad @ v.grad).terms
    {(1, 0): x, (1, 1): 1, (2, 2): 1}
    """

    terms: Mapping[Term, sp.Expr]
    words: tuple[str, ...] = ()

    # SymPy's operators leave the answer to this class.
    _op_priority = 1000.0

    @property
    def coefficient(self) -> sp.Expr:
        """What it is where neither u nor v is in it."""
        if any(term != (NONE, NONE) for term in self.terms):
            raise RsymError(
                f"{self} stands where a coefficient must, such as in a function or a matrix of SymPy",
                code="form",
                remedy=LINEAR,
            )
        return self.terms.get((NONE, NONE), sp.S.Zero)

    def __repr__(self) -> str:
        return " + ".join(self._written(term) for term in self.terms) or "0"

    def _written(self, term: Term) -> str:
        value = self.terms[term]
        known = [name + self.words[kind] for name, kind in zip("vu", term, strict=True) if kind != NONE][::-1]
        factor = [f"({value})" if value.is_Add else str(value)] if value != 1 or not known else []
        return "*".join(factor + known)

    def _beside(self, other: Any) -> Traced | None:
        """What stands on the other side of an operator; None for what has operators of its own."""
        if isinstance(other, Traced):
            return other
        if isinstance(other, np.ndarray):
            return None if other.ndim else self._beside(other.item())
        return None if isinstance(other, sp.MatrixBase) else coefficient_of(other)

    def __add__(self, other: Any) -> Any:
        beside = self._beside(other)
        if beside is None:
            return NotImplemented
        total = dict(self.terms)
        for term, value in beside.terms.items():
            total[term] = total.get(term, sp.S.Zero) + value
        return made(total, self.words or beside.words)

    __radd__ = __add__

    def __neg__(self) -> Traced:
        return made({term: -value for term, value in self.terms.items()}, self.words)

    def __pos__(self) -> Traced:
        return self

    def __sub__(self, other: Any) -> Any:
        beside = self._beside(other)
        return NotImplemented if beside is None else self + -beside

    def __rsub__(self, other: Any) -> Any:
        beside = self._beside(other)
        return NotImplemented if beside is None else beside + -self

    def __mul__(self, other: Any) -> Any:
        beside = self._beside(other)
        if beside is None:
            return NotImplemented
        words = self.words or beside.words
        total: dict[Term, sp.Expr] = {}
        for one, a in self.terms.items():
            for two, b in beside.terms.items():
                for name, p, q in zip("vu", one, two, strict=True):
                    if NONE not in (p, q):
                        raise RsymError(
                            f"the form is not linear in {name}: {name}{words[p]}*{name}{words[q]} is in it",
                            code="form",
                            remedy=LINEAR,
                        )
                term = (max(one[0], two[0]), max(one[1], two[1]))
                total[term] = total.get(term, sp.S.Zero) + a * b
        return made(total, words)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        beside = self._beside(other)
        return NotImplemented if beside is None else self * self._plain("division by", lambda a: 1 / a, beside)

    def __rtruediv__(self, other: Any) -> Any:
        beside = self._beside(other)
        return NotImplemented if beside is None else beside / self

    def __pow__(self, other: Any) -> Any:
        beside = self._beside(other)
        if beside is None:
            return NotImplemented
        return self if beside.terms == {(NONE, NONE): 1} else self._plain("a power of", operator.pow, self, beside)

    def __rpow__(self, other: Any) -> Any:
        beside = self._beside(other)
        return NotImplemented if beside is None else self._plain("a power of", operator.pow, beside, self)

    def __abs__(self) -> Traced:
        return self._plain("the absolute value of", sp.Abs, self)

    @staticmethod
    def _plain(what: str, function: Callable[..., Any], *parts: Traced) -> Traced:
        """A function of what must hold neither u nor v."""
        for one in parts:
            if any(term != (NONE, NONE) for term in one.terms):
                raise RsymError(f"the form is not linear: {what} {one} is in it", code="form", remedy=LINEAR)
        return coefficient_of(function(*(one.coefficient for one in parts)))

    def __getattr__(self, name: str) -> Any:
        if name not in FUNCTIONS:
            raise AttributeError(f"{type(self).__name__} has no {name!r}")
        return partial(self._called, name)

    def _called(self, name: str, *others: Any) -> Traced:
        return self._plain(f"{name} of", FUNCTIONS[name], self, *map(coefficient_of, others))

    def _sympy_(self) -> sp.Expr:
        return self.coefficient

    def _compared(self, other: Any = None) -> Any:
        raise RsymError(
            f"the form compares {self} or makes one number of it, but it stands for all points at once",
            code="form",
            remedy=f"sympy.Piecewise, sympy.Max, sympy.Abs are formulas; {AS_LETTER}",
        )

    __lt__ = __le__ = __gt__ = __ge__ = __eq__ = __ne__ = _compared
    __bool__ = __float__ = __int__ = _compared
    __hash__ = None  # type: ignore[assignment]


def made(terms: Mapping[Term, sp.Expr], words: tuple[str, ...] = ()) -> Traced:
    """The sum of what is not 0."""
    return Traced({term: value for term, value in sorted(terms.items()) if value != 0}, words)


def coefficient_of(value: Any) -> Traced:
    """A number or an expression as a coefficient."""
    if isinstance(value, Traced):
        return value
    try:
        return made({(NONE, NONE): number(value, "a coefficient")})
    except RsymError as error:
        raise RsymError(error.message, code="form", remedy=AS_LETTER) from error


def coefficients(values: Any) -> Any:
    """A coefficient, or an array of those in a nest of tuples."""
    return objects([coefficients(one) for one in values]) if isinstance(values, tuple) else coefficient_of(values)


def objects(values: list[Any]) -> NDArray[Any]:
    """An array of things that NumPy knows nothing of, of arrays alike one of one more dimension."""
    shapes = {np.shape(one) for one in values}
    if len(shapes) != 1:
        raise RsymError(
            f"a vector or matrix of a form has entries of {len(shapes)} shapes",
            code="form",
            remedy='rows are of one length, letters={"K": ((2, 0), (0, 1))}',
        )
    found = np.empty((len(values), *shapes.pop()), object)
    for place, one in enumerate(values):
        found[place] = one
    return found


@dataclass(frozen=True, eq=False, repr=False)
class FormFunction(Traced):
    """u or v, and its derivatives.

    grad, hess : arrays of the first and the second derivatives; `grad` is what dot, mul and others of scikit-fem take.
    laplacian : the sum of second derivatives; about an axis that of the body in space.
    """

    place: int = 1
    names: tuple[str, ...] = ()
    axis: int | None = None

    @property
    def value(self) -> Traced:
        """U or v itself."""
        return self

    @property
    def grad(self) -> NDArray[Any]:
        """The gradient (dimension,)."""
        return objects([self._derivative(index) for index in derivatives(len(self.names), 1)[1:]])

    @property
    def hess(self) -> NDArray[Any]:
        """The second derivatives (dimension, dimension)."""
        n = range(len(self.names))
        return objects([objects([self._derivative(tuple((k == i) + (k == j) for k in n)) for j in n]) for i in n])

    @property
    def laplacian(self) -> Traced:
        """The sum of the pure second derivatives, about an axis that of the body in space."""
        total: Traced = sum(np.diag(self.hess).tolist(), made({}))
        if self.axis is not None:
            across = 1 - self.axis
            total = total + self.grad[across] / sp.Symbol(self.names[across], real=True)
        return total

    def __getattr__(self, name: str) -> Any:
        if not name.startswith("_") and name in self.names:
            return self.grad[self.names.index(name)]
        return super().__getattr__(name)

    def _derivative(self, index: tuple[int, ...]) -> Traced:
        kind = derivatives(len(self.names), 2).index(index)
        return Traced({_term(self.place, kind): sp.S.One}, self.words)


def _term(place: int, kind: int) -> Term:
    return (kind, NONE) if place == 0 else (NONE, kind)


def form_functions(names: tuple[str, ...], axis: int | None) -> tuple[FormFunction, FormFunction]:
    """U and v, functions of coordinates of these names.

    Examples
    --------
    >>> u, v = form_functions(("x", "y"), None)
    >>> 2 * u.laplacian * v - u * v.x
    2*u_xx*v + 2*u_yy*v + -1*u*v_x
    """
    words = tuple(
        "_" * any(index) + "".join(name * times for name, times in zip(names, index, strict=True))
        for index in derivatives(len(names), 2)
    )
    u, v = (FormFunction({_term(place, 0): sp.S.One}, words, place, names, axis) for place in (1, 0))
    return u, v
