"""A linear differential equation as data: its coefficients, found in text or in SymPy.

    -div(A grad u) + b . grad u + c u + D bilaplacian(u) = f

Text is read by the parser of the model language, and is never run. What stands before a derivative is brought to this
form by the product rule.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef

from rsym.errors import RsymError
from rsym.language.equations import UNKNOWN, parse_equation
from rsym.language.stating import WrittenEquation
from rsym.model.shape import Shape
from rsym.model.symbols import as_expression, real_replacements, real_symbol, substitute
from rsym.model.wording import listing
from rsym.problems.equation_text import EquationReader
from rsym.problems.terms import SECOND, Meaning, Row, ScalarTerm, TermCalculus, too_high

Function = Callable[..., Any]


@dataclass(frozen=True)
class EllipticEquation:
    """-div(A grad u) + b . grad u + c u + D bilaplacian(u) = f, the coefficients expressions.

    functions : the Python functions of coordinates that names in the coefficients stand for.

    Examples
    --------
    >>> from rsym import x, y
    >>> equation = equation_of("-div((1 + x)*grad(u)) + 2*u = y", (x, y))
    >>> equation.diffusion, equation.reaction, equation.load
    (((x + 1, 0), (0, x + 1)), 2, y)
    """

    coordinates: tuple[sp.Symbol, ...]
    diffusion: tuple[Row, ...]
    convection: Row
    reaction: sp.Expr
    bending: sp.Expr
    load: sp.Expr
    functions: Mapping[str, Function] = field(default_factory=dict)

    @property
    def order(self) -> int:
        """4 with a bilaplacian, else 2."""
        return 2 if self.bending == 0 else 4

    @property
    def highest(self) -> int:
        """The order of the highest derivatives that are integrated."""
        return self.order // 2

    @property
    def leading(self) -> sp.Expr:
        """The coefficient whose sign is that of the highest derivatives."""
        return self.bending if self.bending != 0 else self.diffusion[0][0]

    @property
    def symmetric(self) -> bool:
        """Whether the form of the equation is."""
        n = len(self.coordinates)
        even = all(self.diffusion[i][j] == self.diffusion[j][i] for i in range(n) for j in range(i))
        return even and not any(self.convection)

    @property
    def definite(self) -> bool:
        """Whether the form of the equation is symmetric and not below 0, for what can be said of its coefficients."""
        return self.symmetric and bool(self.reaction.is_nonnegative)

    @property
    def negated(self) -> EllipticEquation:
        """The equation times -1."""
        return replace(
            self,
            diffusion=tuple(tuple(-one for one in row) for row in self.diffusion),
            convection=tuple(-one for one in self.convection),
            reaction=-self.reaction,
            bending=-self.bending,
            load=-self.load,
        )

    @property
    def expressions(self) -> dict[str, sp.Expr]:
        """The coefficients by names: ``a01``, ``b0``, ``c``, ``d``, ``f``."""
        found = {f"a{i}{j}": value for i, row in enumerate(self.diffusion) for j, value in enumerate(row)}
        found |= {f"b{i}": value for i, value in enumerate(self.convection)}
        return found | {"c": self.reaction, "d": self.bending, "f": self.load}

    @property
    def places(self) -> dict[tuple[int, int], str]:
        """Which of them is the coefficient of a pair of derivatives, of v and of u, those of bending left out."""
        n = range(len(self.coordinates))
        found = {(0, 1 + i): f"b{i}" for i in n} | {(1 + i, 1 + j): f"a{i}{j}" for i in n for j in n}
        return found | {(0, 0): "c"}

    @property
    def load_places(self) -> dict[int, str]:
        """And which that of a derivative of v on the right side."""
        return {0: "f"}


def equation_of(
    given: Any, coordinates: tuple[sp.Symbol, ...], named: Mapping[str, Any] | None = None
) -> EllipticEquation:
    """The equation that a text, or an equation or an expression of SymPy, states.

    named : what names stand for that are no coordinates: an expression, a Shape, a Python function of coordinates, or
        vectors and matrices of these.

    Raises
    ------
    RsymError
        For what is no linear equation in u, an unknown name, an order that is not offered.

    Examples
    --------
    >>> import sympy as sp
    >>> from rsym import x, y
    >>> u = sp.Function("u")(x, y)
    >>> equation_of(sp.Eq(-u.diff(x, 2) - u.diff(y, 2) + u, x), (x, y)) == equation_of("-laplacian(u) + u = x", (x, y))
    True
    """
    names = tuple((named or {}).items())
    if isinstance(given, str) and all(isinstance(value, sp.Symbol) for _, value in names):
        return _read(given, coordinates, names)
    return _stated(given, coordinates, dict(names))


@lru_cache(16)  # the same text again, as of other letters
def _read(text: str, coordinates: tuple[sp.Symbol, ...], names: tuple[tuple[str, Any], ...]) -> EllipticEquation:
    return _stated(text, coordinates, dict(names))


def _stated(given: Any, coordinates: tuple[sp.Symbol, ...], named: Mapping[str, Any]) -> EllipticEquation:
    functions, meanings = meanings_of(named)
    calculus = TermCalculus(coordinates, frozenset(map(real_symbol, functions)))
    if isinstance(given, WrittenEquation):
        meanings = {**given.meanings, **meanings}
    if isinstance(given, str | WrittenEquation):
        left, right = parse_equation(given) if isinstance(given, str) else (given.left, given.right)
        reader = EquationReader(calculus, meanings)
        whole = reader.scalar(left).plus(reader.scalar(right).scaled(sp.S.NegativeOne, calculus))
    else:
        whole = _from_sympy(given, calculus)
    minus = tuple(tuple(-one for one in row) for row in whole.second)
    made = EllipticEquation(coordinates, _even(minus), whole.first, whole.zero, whole.fourth, -whole.value, functions)
    if not any(map(any, made.diffusion)) and made.bending == 0:
        raise RsymError(
            f"the equation has no second derivatives of {UNKNOWN}: it is not elliptic",
            code="not-elliptic",
            remedy='for example "-laplacian(u) = 1"',
        )
    varying = {*coordinates, *map(real_symbol, functions)}.intersection(made.bending.free_symbols)
    if varying:
        raise RsymError(
            f"what stands before bilaplacian(u) depends on {sorted(map(str, varying))[0]}",
            code="equation",
            remedy="divide the equation by it",
        )
    # laplacian(u) = f and -laplacian(u) = -f are one equation.
    return made.negated if made.leading.is_negative else made


def meanings_of(named: Mapping[str, Any]) -> tuple[dict[str, Function], dict[str, Meaning]]:
    """The Python functions among what names stand for, and what each name means: vectors and matrices as tuples.

    Examples
    --------
    >>> meanings_of({"k": [[2, 0], [0, 1]], "c": abs})
    ({'c': <built-in function abs>}, {'k': ((2, 0), (0, 1)), 'c': c})
    """
    functions: dict[str, Function] = {}

    def meaning(name: str, value: Any) -> Meaning:
        if isinstance(value, Shape):
            return value.expression
        if isinstance(value, sp.MatrixBase | np.ndarray) and np.ndim(value):
            value = list(value) if isinstance(value, sp.MatrixBase) and value.cols == 1 else value.tolist()
        if isinstance(value, list | tuple):
            return tuple(meaning(f"{name}__{k}", one) for k, one in enumerate(value))
        if callable(value) and not isinstance(value, sp.Basic):
            functions[name] = value
            return real_symbol(name)
        return as_expression(value)

    meanings = {name: meaning(name, value) for name, value in named.items()}
    return functions, meanings


def _even(matrix: tuple[Row, ...]) -> tuple[Row, ...]:
    """Of constants only the symmetric part counts."""
    if any(one.free_symbols for row in matrix for one in row):
        return matrix
    n = range(len(matrix))
    return tuple(tuple((matrix[i][j] + matrix[j][i]) / 2 for j in n) for i in n)


def _from_sympy(given: Any, d: TermCalculus) -> ScalarTerm:
    """The coefficients of an equation, or of an expression that is to be 0, in one unknown function."""
    whole = given.lhs - given.rhs if isinstance(given, sp.Equality) else as_expression(given)
    whole = substitute(whole, real_replacements((whole, *d.coordinates)))
    unknown = whole.atoms(AppliedUndef)
    if len(unknown) != 1 or set(next(iter(unknown)).args) != set(d.coordinates):
        raise RsymError(
            f"expected an equation in one unknown function of {listing(map(str, d.coordinates))}, got {given}",
            code="equation",
            remedy='u = sympy.Function("u")(x, y), or text: "-laplacian(u) = 1"',
        )
    (u,) = unknown
    whole = sp.expand(whole.doit())
    total, rest, fourth = d.nothing, whole, {}
    for part in sorted({u, *whole.atoms(sp.Derivative)}, key=lambda one: -len(getattr(one, "variables", ()))):
        place = sp.Dummy()
        replaced = sp.expand(rest.xreplace({part: place}))
        factor = replaced.coeff(place, 1)
        rest = sp.expand(replaced - factor * place)
        if rest.has(place) or factor.has(u):
            raise RsymError(f"the equation is not linear in {u}", code="equation", remedy=SECOND)
        variables = list(getattr(part, "variables", ()))
        if len(variables) > 2:
            fourth[tuple(variables.count(symbol) for symbol in d.coordinates)] = factor
            continue
        term = replace(d.nothing, zero=sp.S.One)
        for symbol in variables:
            term = d.diff(term, d.coordinates.index(symbol))
        total = total.plus(term.scaled(factor, d))
    if fourth:
        # Those of the bilaplacian, the mixed ones twice.
        orders = [tuple(2 * (i == k) + 2 * (j == k) for k in d.axes) for i in d.axes for j in d.axes]
        bending = fourth.get(orders[0], sp.S.Zero)
        if {order: orders.count(order) * bending for order in orders} != fourth:
            raise too_high()
        total = replace(total, fourth=bending)
    return replace(total, value=rest)
