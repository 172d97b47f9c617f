"""The syntax tree to SymPy, every operation once, constants never evaluated; verbatim, nothing is.

Rational constants are folded exactly, other constants are built unevaluated and
held; only what depends on coordinates or letters meets SymPy's own rules.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from operator import add, mul
from typing import Any, TypeAlias

import sympy as sp
from sympy.core.function import AppliedUndef

from rsym.language import exact
from rsym.language.exact import checked, division_by_zero
from rsym.language.extent import HIGHEST_DEGREE, Extent, Work, check_degree, joined, measured
from rsym.language.functions import MADE, TextFunction, made
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
from rsym.model.nodes import Held, RealNode
from rsym.model.symbols import real_symbol


@dataclass(frozen=True, slots=True)
class Built:
    """A piece: `exact` if it is rational, `number` if it is any constant, neither if it is open.

    `items` and `text` are those of a vector and of a quoted choice, which only pieces of shapes take.

    The expression of a constant is unevaluated throughout; `outer` wraps it so that SymPy cannot look inside.
    """

    expression: sp.Expr
    extent: Extent
    exact: Fraction | None = None
    number: float | None = None
    items: tuple[Built, ...] | None = None
    text: str | None = None

    @property
    def outer(self) -> sp.Expr:
        """The piece as it stands among open pieces."""
        return Held(self.expression) if self.number is not None and self.exact is None else self.expression


def exact_part(value: Fraction) -> Built:
    """A rational constant."""
    bits = value.numerator.bit_length() + value.denominator.bit_length()
    return Built(sp.Rational(value.numerator, value.denominator), Extent(bits=bits), value, float(value))


def symbol_part(name: str) -> Built:
    """A letter, a coordinate, or an assigned name that is shown as such."""
    return Built(real_symbol(name), Extent())


def vector_part(items: Sequence[Built]) -> Built:
    """A list of parts."""
    extent = joined((Extent(), *(item.extent for item in items)))
    return Built(sp.Tuple(*(item.outer for item in items)), extent, items=tuple(items))


def text_part(text: str) -> Built:
    """A quoted choice."""
    return Built(sp.Symbol(text), Extent(), text=text)


def constant_part(
    expression: sp.Expr, extent: Extent, place: Position, numeric: Callable[..., float], *numbers: Any
) -> Built:
    """A constant that is not rational, its approximate value numeric(*numbers)."""
    try:
        value = numeric(*numbers)
    except ZeroDivisionError:
        raise division_by_zero(place) from None
    except ValueError:
        raise place.refuse("this constant is not a real number", "not-real", "correct the formula") from None
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise place.refuse("this constant is too large for float64", "number-too-large", "correct the formula")
    return Built(expression, extent, None, value)


def open_part(expression: sp.Expr, extent: Extent, place: Position) -> Built:
    """What SymPy made of an operation on open pieces; a number if the variables have cancelled.

    Such a number must leave here, lest the next operation make SymPy evaluate it.
    """
    if expression.is_Rational:
        return exact_part(checked(Fraction(int(expression.p), int(expression.q)), place))
    if not _varies(expression):
        raise place.refuse(
            f"coordinates and letters cancel and leave the constant {expression}",
            "constant",
            "write that constant, or correct the formula",
        )
    return Built(expression, extent)


def _varies(expression: sp.Expr) -> bool:
    """Whether there is a symbol in it or a node that SymPy does not look into; unlike is_number without recursion."""
    stack = [expression]
    while stack:
        part = stack.pop()
        if part.is_Symbol or isinstance(part, RealNode | AppliedUndef):
            return True
        stack.extend(part.args)
    return False


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


class Verbatim(FormulaBuilder):
    """Builds formulas as they are written: every operation of the text becomes one node, its arguments in their order.

    What `dumps` writes is read so: SymPy's own evaluation would distribute a factor,
    sort terms or take a root, and the program would be another one.

    A number in front of a product and those that divide it are one rational coefficient; a minus is the coefficient
    -1; a divisor is a power with the opposite exponent. A decimal is the float of that name.
    """

    def _combine(self, node: Expression, parts: list[Built], known: Mapping[str, Built]) -> Built:
        match node:
            case Number():
                number = exact_part(node.value)
                return Built(sp.Float(float(node.value)), number.extent) if node.point else number
            case Sum():
                written = zip(node.signs, parts, node.parts, strict=True)
                terms = [_opposite_written(part, text) if sign < 0 else part for sign, part, text in written]
                if len(terms) == 1:
                    return terms[0]
                made = sp.Add(*(term.expression for term in terms), evaluate=False)
            case Product():
                factors = self._factors(node, parts)
                if len(factors) == 1:
                    return factors[0] if factors[0].exact is None else exact_part(factors[0].exact)
                made = sp.Mul(*(factor.expression for factor in factors), evaluate=False)
            case Power():
                made = parts[0].expression
                for exponent in parts[1:]:
                    _check_power(made, exponent.expression, node.place)
                    made = sp.Pow(made, exponent.expression, evaluate=False)
                degrees = math.prod(_degree(exponent) for exponent in parts[1:])
                extent = joined(part.extent for part in parts)
                extent = replace(extent, width=1, bits=0, degree=parts[0].extent.degree * max(degrees, 1))
                return Built(made, self._budget.afford(extent, node.place))
            case Call(function="exp") if parts[0].exact == 1:
                made = sp.E
            case Call() if node.function in self._operations:
                made = self._operations[node.function].symbolic(*(part.expression for part in parts))
            case _:
                return super()._combine(node, parts, known)
        extent = replace(joined(part.extent for part in parts), width=1, bits=0)
        return Built(made, self._budget.afford(extent.of_terms() if made.is_Add else extent, node.place))

    def _factors(self, node: Product, parts: list[Built]) -> list[Built]:
        """The factors of a product, the rational coefficient first if it is not 1."""
        coefficient, others, leading = exact_part(exact.ONE).exact, list[Built](), True
        assert coefficient is not None
        for sign, text, part in zip(node.signs, node.parts, parts, strict=True):
            leading = leading and part.exact is not None
            if part.exact is not None and (leading or (sign < 0 and isinstance(text, Number))):
                value = part.exact if sign > 0 else exact.power(part.exact, -1, text.place)
                coefficient = exact.checked(coefficient * value, text.place)
            elif sign < 0:
                others.append(_inverse_written(part, text))
                _check_power(part.expression, sp.S.NegativeOne, text.place)
            elif not others and isinstance(text, Sum) and text.signs == (-1,) and _is_minus(part.expression):
                coefficient = -coefficient  # -x*y is one product, not one of -x
                others.append(Built(part.expression.args[1], part.extent))
            else:
                others.append(part)
        return others if coefficient == 1 and others else [exact_part(coefficient), *others]


def _degree(exponent: Built) -> int:
    """What an exponent multiplies the length of numbers by: SymPy may evaluate the power later."""
    if exponent.exact is not None:
        return math.ceil(abs(exponent.exact))
    if exponent.expression.free_symbols:
        return 1
    size = abs(exponent.expression.evalf(5))
    return math.ceil(size) if size.is_Float and size < 2 * HIGHEST_DEGREE else 2 * HIGHEST_DEGREE


def _check_power(base: sp.Expr, exponent: sp.Expr, place: Position) -> None:
    """Refuse a division by the constant zero, and a root of a negative constant."""
    if base.free_symbols or exponent.free_symbols:
        return
    value, power = base.evalf(15), exponent.evalf(15)
    nothing = value == 0 or (value.is_Float and value._prec == 1)  # no digit of it is known
    if nothing and power.is_negative:
        raise exact.division_by_zero(place)
    if value.is_negative and power.is_Float and not float(power).is_integer():
        raise place.refuse("this constant is not a real number", "not-real", "correct the formula")


def _is_minus(expression: sp.Expr) -> bool:
    return bool(expression.is_Mul and len(expression.args) == 2 and expression.args[0] == -1)


def _opposite_written(part: Built, text: Expression) -> Built:
    """The part behind a minus; a product that stands there, not one by name, takes it into its coefficient."""
    if part.exact is not None and isinstance(text, Number | Product):
        return exact_part(-part.exact)
    expression = part.expression
    if expression.is_Float:
        return Built(-expression, part.extent)
    if isinstance(text, Product) and expression.is_Mul and expression.args[0].is_Number:
        first, *rest = expression.args
        factors = rest if first == -1 and first.is_Integer else [-first, *rest]
        made = sp.Mul(*factors, evaluate=False) if len(factors) > 1 else factors[0]
        return Built(made, part.extent)
    inner = expression.args if isinstance(text, Product) and expression.is_Mul else (expression,)
    return Built(sp.Mul(-1, *inner, evaluate=False), part.extent)


def _inverse_written(part: Built, text: Expression) -> Built:
    expression = part.expression
    if isinstance(text, Power) and expression.is_Pow and expression.exp.is_Rational:
        return Built(sp.Pow(expression.base, -expression.exp, evaluate=False), part.extent)
    return Built(sp.Pow(expression, -1, evaluate=False), part.extent)
