"""The precedence parser of expressions: sums of products of signed powers, as in MATLAB.

-x^2 is -(x^2), 2^-1 is 1/2, 2^3^2 is (2^3)^2, and .* ./ .^ ** mean * / ^ ^.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import TypeVar

from rsym.language.exact import literal
from rsym.language.functions import COMPARISONS, CONNECTIVES, NODES, PIECEWISE, in_quotes
from rsym.language.pieces import PIECES
from rsym.language.scanner import Cursor, Token
from rsym.language.syntax import ARITIES, KEYWORDS, Call, Expression, Name, Number, Power, Product, Quoted, Sum, Vector
from rsym.model.wording import listing, proposal

DEEPEST_NESTING = 100
MOST_ITEMS = 1000  # a polygon of so many corners is taken apart in seconds
_HALF = Fraction(1, 2)
EXAMPLE = "for example piecewise(1 - x, x > 0, 1 + x)"
_Item = TypeVar("_Item")


class ExpressionParser:
    """Parses expressions from a cursor; every bracket is one level of depth.

    arities : the fewest and the most arguments of each function; None is any number.
    vectors : whether a vector may stand where a number may.
    """

    def __init__(
        self,
        cursor: Cursor,
        arities: Mapping[str, tuple[int, int | None]] = ARITIES,
        *,
        vectors: bool = False,
    ) -> None:
        self._cursor = cursor
        self._arities = arities
        self._vectors = vectors
        self._depth = 0

    def expression(self) -> Expression:
        """A sum."""
        place, signs, parts = self._cursor.token.place, [1], [self._product()]
        while operator := self._cursor.accept("+", "-"):
            signs.append(1 if operator.text == "+" else -1)
            parts.append(self._product())
        return parts[0] if len(parts) == 1 else Sum(place, tuple(signs), tuple(parts))

    def _product(self) -> Expression:
        place, signs, parts = self._cursor.token.place, [1], [self._power()]
        while operator := self._cursor.accept("*", "/", ".*", "./"):
            signs.append(1 if operator.text.endswith("*") else -1)
            parts.append(self._power())
        return parts[0] if len(parts) == 1 else Product(place, tuple(signs), tuple(parts))

    def _power(self) -> Expression:
        place, sign = self._cursor.token.place, self._sign()
        parts = [self._operand()]
        while self._cursor.accept("^", "**", ".^"):
            exponent_place, exponent_sign = self._cursor.token.place, self._sign()
            exponent = self._operand()
            parts.append(exponent if exponent_sign > 0 else Sum(exponent_place, (-1,), (exponent,)))
        power = parts[0] if len(parts) == 1 else Power(parts[0].place, tuple(parts))
        return power if sign > 0 else Sum(place, (-1,), (power,))

    def _sign(self) -> int:
        sign = 1
        while operator := self._cursor.accept("+", "-"):
            sign = sign if operator.text == "+" else -sign
        return sign

    def _operand(self) -> Expression:
        """A number, a name, a call or a bracket; behind it may stand `deg`."""
        operand = self._bare_operand()
        unit = self._cursor.token
        if unit.text != "deg":
            return operand
        self._cursor.read()
        return Product(unit.place, (1, 1, -1), (operand, Name(unit.place, "pi"), Number(unit.place, Fraction(180))))

    def _bare_operand(self) -> Expression:
        token = self._cursor.token
        if token.text == "(":
            return self._group()
        if token.text == "[" and self._vectors:
            return self._argument()
        if token.kind == "number":
            self._cursor.read()
            point = not token.text.isdigit()
            return Number(token.place, literal(token.text, token.place), point=point)
        if token.kind == "name" and token.text not in KEYWORDS:
            self._cursor.read()
            return self._call(token) if self._cursor.token.text == "(" else self._name(token)
        raise self._cursor.unexpected("a number, a name or '('", "finish the formula, or remove the last operator")

    def _group(self) -> Expression:
        opening = self._open()
        inner = self.expression()
        self._cursor.close(opening, ")")
        self._depth -= 1
        return inner

    def _call(self, function: Token) -> Expression:
        start = self._cursor.mark()
        if function.text in PIECES or function.text in NODES:
            return self._piece(function)
        if function.text == PIECEWISE:
            return self._piecewise(function)
        opening = self._open()
        arguments = self._list(self.expression, ")")
        self._cursor.close(opening, ")")
        self._depth -= 1
        self._check_call(function, len(arguments), start)
        return _called(function, tuple(arguments))

    def _name(self, token: Token) -> Expression:
        if token.text in self._arities:
            raise token.place.refuse(
                f"the function {token.text} stands without arguments", "arity", f"write {token.text}(...)"
            )
        return Name(token.place, token.text)

    def _list(self, item: Callable[[], _Item], closing: str) -> list[_Item]:
        """Items with commas between them."""
        items: list[_Item] = []
        if self._cursor.token.text != closing:
            items.append(item())
            while self._cursor.accept(","):
                items.append(item())
        return items

    def _piece(self, function: Token) -> Expression:
        """A call whose arguments may be vectors and texts, and may have names."""
        opening = self._open()
        arguments = self._list(self._named_argument, ")")
        self._cursor.close(opening, ")")
        self._depth -= 1
        names = [name.text for name, _ in arguments if name is not None]
        for (before, _), (name, value) in pairwise(arguments):
            if before is not None and name is None:
                message = f"an argument without a name stands behind {before.shown}"
                raise value.place.refuse(message, "arity", "arguments with names come last")
        return Call(function.place, function.text, tuple(value for _, value in arguments), tuple(names))

    def _piecewise(self, function: Token) -> Expression:
        """Values and conditions in turn; a last value without a condition holds elsewhere."""
        opening = self._open()
        arguments = self._list(self._condition, ")")
        self._cursor.close(opening, ")")
        self._depth -= 1
        if len(arguments) < 2:
            raise function.place.refuse(f"{function.text} takes a value and a condition at least", "arity", EXAMPLE)
        for k, argument in enumerate(arguments):
            if is_condition(argument) != (k % 2 == 1):
                message = f"argument {k + 1} of {function.text} must be a {'condition' if k % 2 else 'formula'}"
                raise argument.place.refuse(message, "condition", EXAMPLE)
        return Call(function.place, function.text, tuple(arguments))

    def _condition(self) -> Expression:
        """A formula, two that are compared, or conditions in and(...), or(...), not(...)."""
        token = self._cursor.token
        if token.text in CONNECTIVES and self._cursor.following.text == "(":
            self._cursor.read()
            opening = self._open()
            inner = self._list(self._condition, ")")
            self._cursor.close(opening, ")")
            self._depth -= 1
            if not inner or not all(map(is_condition, inner)) or (token.text == "not" and len(inner) != 1):
                raise token.place.refuse(
                    f"{token.text} takes {'one condition' if token.text == 'not' else 'conditions'}",
                    "condition",
                    "for example and(x > 0, y > 0)",
                )
            return Call(token.place, token.text, tuple(inner))
        left = self.expression()
        if operator := self._cursor.accept(*COMPARISONS):
            return Call(left.place, operator.text, (left, self.expression()))
        return left

    def _named_argument(self) -> tuple[Token | None, Expression]:
        if self._cursor.token.kind == "name" and self._cursor.following.text == "=":
            name = self._cursor.read()
            self._cursor.read()
            return name, self._argument()
        return None, self._argument()

    def _argument(self) -> Expression:
        token = self._cursor.token
        if token.kind == "text":
            self._cursor.read()
            return Quoted(token.place, token.quoted)
        if token.text != "[":
            return self.expression()
        opening = self._open()
        items = self._list(self._argument, "]")
        self._cursor.close(opening, "]")
        self._depth -= 1
        if len(items) > MOST_ITEMS:
            raise token.place.refuse(f"a list of {len(items)}; {MOST_ITEMS} are the most", "too-large", "use fewer")
        return Vector(token.place, tuple(items))

    def _open(self) -> Token:
        opening = self._cursor.read()
        self._depth += 1
        if self._depth > DEEPEST_NESTING:
            raise opening.place.refuse(
                f"more than {DEEPEST_NESTING} brackets inside one another", "too-deep", "name a part of the formula"
            )
        return opening

    def _check_call(self, function: Token, count: int, start: int) -> None:
        if function.text not in self._arities:
            product = f"the functions are {listing(self._arities)}; for a product write {function.text}*(...)"
            remedy = in_quotes(function.text) or proposal(function.text, (*self._arities, *PIECES, PIECEWISE), product)
            raise function.place.refuse(f"no function {function.shown}", "unknown-name", remedy)
        fewest, most = self._arities[function.text]
        if fewest <= count and (most is None or count <= most):
            return
        if comma := self._cursor.decimal_comma(start):
            raise comma
        takes = f"{fewest}" if fewest == most else f"{fewest} or more"
        raise function.place.refuse(
            f"{function.text} takes {takes} argument{'s' * (takes != '1')}, got {count}",
            "arity",
            "add the missing arguments, or remove those too many",
        )


def is_condition(expression: Expression) -> bool:
    """Whether it is true or false, not a number."""
    return isinstance(expression, Call) and expression.function in (*COMPARISONS, *CONNECTIVES)


def _called(function: Token, arguments: tuple[Expression, ...]) -> Expression:
    if function.text in ("rfNOT", "negation"):
        return Sum(function.place, (-1,), arguments)
    if function.text == "sqrt":
        return Power(function.place, (*arguments, Number(function.place, _HALF)))
    return Call(function.place, function.text, arguments)
