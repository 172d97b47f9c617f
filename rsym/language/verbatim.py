"""Formulas that SymPy must not touch: every operation of the text becomes one node, its arguments in their order.

What `dumps` writes is read so: SymPy's own evaluation would distribute a factor,
sort terms or take a root, and the program would be another one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import sympy as sp

from rsym.language import exact
from rsym.language.building import FormulaBuilder
from rsym.language.extent import HIGHEST_DEGREE, joined
from rsym.language.parts import Built, exact_part
from rsym.language.syntax import Call, Expression, Number, Position, Power, Product, Sum


class Verbatim(FormulaBuilder):
    """Builds formulas as they are written.

    A number in front of a product and those that divide it are one rational coefficient; a minus is the coefficient
    -1; a divisor is a power with the opposite exponent. A decimal is the float of that name.
    """

    def _combine(self, node: Expression, parts: list[Built], known: Mapping[str, Built]) -> Built:
        match node:
            case Number():
                return self._number(node)
            case Sum():
                written = zip(node.signs, parts, node.parts, strict=True)
                terms = [_opposite(part, text) if sign < 0 else part for sign, part, text in written]
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

    def _number(self, node: Number) -> Built:
        number = exact_part(node.value)
        return Built(sp.Float(float(node.value)), number.extent) if node.point else number

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
                others.append(_inverse(part, text))
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


def _opposite(part: Built, text: Expression) -> Built:
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


def _inverse(part: Built, text: Expression) -> Built:
    expression = part.expression
    if isinstance(text, Power) and expression.is_Pow and expression.exp.is_Rational:
        return Built(sp.Pow(expression.base, -expression.exp, evaluate=False), part.extent)
    return Built(sp.Pow(expression, -1, evaluate=False), part.extent)
