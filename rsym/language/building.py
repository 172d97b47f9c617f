"""The syntax tree to SymPy, every operation once, constants never evaluated.

Rational constants are folded exactly, other constants are built unevaluated and
held; only what depends on coordinates or letters meets SymPy's own rules.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from functools import reduce
from operator import add, mul
from typing import Any, TypeAlias

import sympy as sp

from rsym.language import exact
from rsym.language.extent import Extent, Work, check_degree, joined, measured
from rsym.language.functions import TextFunction
from rsym.language.nodes import MADE, made
from rsym.language.parts import Built, constant_part, exact_part, open_part, text_part, vector_part
from rsym.language.syntax import (
    Call,
    Expression,
    Name,
    Number,
    Position,
    Power,
    Product,
    Quoted,
    Sum,
    Vector,
    postorder,
)

PieceCall: TypeAlias = Callable[[Call, list[Built]], sp.Expr]


class FormulaBuilder:
    """Builds expressions with one table of functions and one budget."""

    def __init__(
        self,
        operations: Mapping[str, TextFunction],
        pieces: PieceCall | None = None,
        coordinates: frozenset[sp.Symbol] | None = None,
    ) -> None:
        self._operations = operations
        self._coordinates = coordinates
        self._pieces = pieces
        self._budget = Work()

    def build(self, expression: Expression, known: Mapping[str, Built]) -> Built:
        """The expression in SymPy; names mean what `known` says."""
        done: list[Built] = []
        for node in postorder(expression):
            first = len(done) - len(node.parts)
            done[first:] = [self._combine(node, done[first:], known)]
        return done[0]

    def _combine(self, node: Expression, parts: list[Built], known: Mapping[str, Built]) -> Built:
        match node:
            case Number():
                return exact_part(node.value)
            case Name():
                return known[node.name]
            case Sum():
                terms = [part if sign > 0 else _opposite(part) for sign, part in zip(node.signs, parts, strict=True)]
                return self._join(terms, node.place, sp.Add, add, math.fsum)
            case Product():
                written = zip(node.signs, parts, node.parts, strict=True)
                factors = [part if sign > 0 else _inverse(part, text.place) for sign, part, text in written]
                return self._join(factors, node.place, sp.Mul, mul, math.prod)
            case Power():
                return reduce(lambda base, exponent: self._raise(base, exponent, node.place), parts)
            case Vector():
                return vector_part(parts)
            case Quoted():
                return text_part(node.value)
            case Call() if node.function in self._operations:
                return self._call(node, parts)
            case Call() if node.function in MADE:
                extent = self._budget.afford(joined(part.extent for part in parts).opaque(len(parts)), node.place)
                return Built(made(node, [part.outer for part in parts], self._coordinates), extent)
            case Call():
                return self._piece(node, parts)

    def _join(
        self,
        parts: list[Built],
        place: Position,
        symbolic: Any,
        fold: Callable[[Fraction, Fraction], Fraction],
        numeric: Callable[[Iterable[float]], float],
    ) -> Built:
        """A sum or a product in one step: term by term SymPy would take quadratic time."""
        rationals = [part.exact for part in parts if part.exact is not None]
        pieces = [part for part in parts if part.exact is None]
        if rationals:
            pieces.append(exact_part(reduce(lambda left, right: exact.checked(fold(left, right), place), rationals)))
        if len(pieces) == 1:
            return pieces[0]
        extent = self._budget.afford(joined(part.extent for part in parts), place)
        numbers = [part.number for part in pieces if part.number is not None]
        if len(numbers) == len(pieces):
            held = symbolic(*(part.expression for part in pieces), evaluate=False)
            return constant_part(held, extent, place, numeric, numbers)
        result = symbolic(*(part.outer for part in pieces))
        return open_part(result, extent.of_terms() if result.is_Add else extent, place)

    def _raise(self, base: Built, exponent: Built, place: Position) -> Built:
        if exponent.exact is not None and exponent.exact.denominator == 1:
            whole = int(exponent.exact)
            if base.exact is not None:
                return exact_part(exact.power(base.exact, whole, place))
            if base.number is None:
                raised = base.extent.raised(whole, distributes=not base.expression.is_Add)
                extent = self._budget.afford(raised, place)
                return open_part(sp.Pow(base.outer, whole), extent, place)
        extent = self._budget.afford(joined((base.extent, exponent.extent)), place)
        if base.number is not None and exponent.number is not None:
            held = sp.Pow(base.expression, exponent.expression, evaluate=False)
            return constant_part(held, extent, place, math.pow, base.number, exponent.number)
        return Built(sp.Pow(base.outer, exponent.outer, evaluate=False), extent)

    def _piece(self, node: Call, parts: list[Built]) -> Built:
        """A piece by name; its size is that of what came out of it."""
        if self._pieces is None:
            raise node.place.refuse(f"{node.function} cannot stand here", "letter-value", "write a number")
        self._budget.afford(joined([Extent(), *(part.extent for part in parts)]), node.place)
        for part in parts:  # what stands in the place of a coordinate is raised to all powers in which that stands
            check_degree(measured(part.expression), node.place)
        expression = self._pieces(node, parts)
        exact.check_numbers(expression, node.place)
        extent = self._budget.afford(measured(expression), node.place)
        return Built(expression, extent.of_terms() if expression.is_Add else extent)

    def _call(self, node: Call, parts: list[Built]) -> Built:
        operation = self._operations[node.function]
        rationals = [part.exact for part in parts if part.exact is not None]
        if operation.exact is not None and len(rationals) == len(parts):
            return exact_part(operation.exact(*rationals))
        extent = joined(part.extent for part in parts).opaque(len(parts))
        self._budget.afford(extent, node.place, sorts=operation.sorts)
        numbers = [part.number for part in parts if part.number is not None]
        if len(numbers) == len(parts) and operation.numeric is not None:
            held = operation.symbolic(*(part.expression for part in parts))
            return constant_part(held, extent, node.place, operation.numeric, *numbers)
        arguments = [part.outer for part in parts]
        result = operation.symbolic(*arguments)
        for part, argument in zip(parts, arguments, strict=True):
            if result is argument:  # min(u, u) is u
                return part
        return Built(result, extent.opaque(len(result.args)))


def _opposite(part: Built) -> Built:
    if part.exact is not None:
        return exact_part(-part.exact)
    if part.number is not None:
        return Built(sp.Mul(-1, part.expression, evaluate=False), part.extent, None, -part.number)
    return Built(-part.expression, part.extent)


def _inverse(part: Built, place: Position) -> Built:
    if part.exact is not None:
        return exact_part(exact.power(part.exact, -1, place))
    if part.number is not None:
        held = sp.Pow(part.expression, -1, evaluate=False)
        return constant_part(held, part.extent, place, lambda number: 1 / number, part.number)
    return open_part(sp.Pow(part.expression, -1), part.extent, place)
