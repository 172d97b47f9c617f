"""Nodes that are polynomials: for these, divisibility and singular points are decided exactly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

import sympy as sp

from rsym.logic.stripping import scaled
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.verify.boxes.cyclotomic import HIGHEST as LARGEST_FIELD
from rsym.verify.boxes.cyclotomic import Field, order_for_root, order_for_turns
from rsym.verify.boxes.local import Model

LARGEST = 120  # nodes of a program that is written out as a polynomial
HIGHEST = 32  # degree, beyond which dividing takes longer than it is worth
NESTED = (1, 2, 4, 8)  # a root within a root asks for a field so many times as large; of cos(pi/32) for the last


def polynomial_of(
    model: Model, number: int, roots: dict[sp.Symbol, sp.Expr] | None = None, *, free: bool = False
) -> sp.Expr | None:
    """The node as a polynomial of the coordinates with rational coefficients, if it is one of moderate size.

    With `roots`, square roots and moduli may stand in it too, as symbols, to which their squares are added there. If
    `free`, everything else may too, as symbols that know nothing of each other: cos(pi/7), a letter that ranges.
    """
    if len(model.order(number)) > LARGEST:
        return None
    parts: dict[int, sp.Expr] = {}
    for part in model.order(number):
        operation, arguments, data = model.builder.nodes[part]
        inner = [parts[argument] for argument in arguments]
        if operation == "const" and isinstance(data, Fraction):
            parts[part] = sp.Rational(data.numerator, data.denominator)
        elif operation == "input":
            value = _opaque(part) if free else _fixed(model, str(data))
            if value is None:
                return None
            parts[part] = value
        elif operation == "add":
            parts[part] = inner[0] + inner[1]
        elif operation == "mul":
            parts[part] = inner[0] * inner[1]
        elif operation == "neg":
            parts[part] = -inner[0]
        elif operation == "powi":
            parts[part] = inner[0] ** int(str(data))
        elif operation == "div" and inner[1].is_Rational and inner[1] != 0:
            parts[part] = inner[0] / inner[1]
        elif operation in {"sqrt", "abs"} and roots is not None:
            parts[part] = sp.Dummy(real=True)
            roots[parts[part]] = inner[0] if operation == "sqrt" else inner[0] ** 2
        elif free:
            parts[part] = _opaque(part)
        else:
            return None
    return parts[number]


def _opaque(part: int) -> sp.Expr:
    return sp.Symbol(f"node {part}", real=True)


def _fixed(model: Model, name: str) -> sp.Expr | None:
    """A coordinate as a symbol, a letter as its number; None for a letter that ranges."""
    if name in model.builder.coordinates:
        return sp.Symbol(name, real=True)
    low, high = model.letters[name]
    return sp.Rational(low.numerator, low.denominator) if low == high else None


class Ring:
    """Polynomials of the coordinates of a model with coefficients in the field of its numbers.

    The field has the cosines and sines of fractions of a turn and the square roots of numbers that stand in the model,
    as far as it is not too large for that.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.implied: dict[tuple[object, ...], bool] = {}  # which signs of polynomials tell those of others
        self._lowered: dict[Any, int] = {}
        order = _order(model.builder, model.order(model.root))
        roots = [part for part in model.order(model.root) if model.builder.nodes[part].operation == "sqrt"]
        for times in NESTED:
            self._begin(Field(order * times))
            if all(self.polynomial(part) is not None for part in roots if self._radicand(part)):
                return
            if self.field.degree > LARGEST_FIELD // 2:
                break
        self._begin(Field(order))

    def _begin(self, field: Field) -> None:
        self.field = field
        names = self.model.builder.coordinates
        self.ring, *gens = sp.ring([sp.Symbol(name, real=True) for name in names], field.domain)
        self._coordinates = dict(zip(names, gens, strict=True))
        self._known: dict[int, Any] = {}

    def _radicand(self, part: int) -> bool:
        """Whether a root is that of a positive number of the field."""
        inner = self._polynomial(self.model.builder.nodes[part].arguments[0])
        return inner is not None and inner.is_ground and self.field.sign(inner.coeff(1)) > 0

    def polynomial(self, number: int) -> Any:
        """The node as an element of the ring; None if it is none, or not of moderate size."""
        return self._polynomial(number) if len(self.model.order(number)) <= LARGEST else None

    def _polynomial(self, number: int) -> Any:
        for part in self.model.order(number):
            if part not in self._known:
                self._known[part] = self._made(part)
        return self._known[number]

    def _made(self, part: int) -> Any:
        builder = self.model.builder
        operation, arguments, data = builder.nodes[part]
        if operation == "const" and isinstance(data, Fraction):
            return self.ring.ground_new(self.field.rational(data))
        if operation == "input":
            return self._input(str(data))
        if operation in {"cos", "sin"}:
            share = _share(builder, arguments[0])
            if share is None:
                return None
            value = self.field.cosine(share if operation == "cos" else Fraction(1, 4) - share)
            return None if value is None else self.ring.ground_new(value)
        inner = [self._known[argument] for argument in arguments]
        if not inner or any(one is None for one in inner):
            return None
        return self._combined(operation, inner, data)

    def _input(self, name: str) -> Any:
        if name in self._coordinates:
            return self._coordinates[name]
        low, high = self.model.letters[name]
        return self.ring.ground_new(self.field.rational(low)) if low == high else None

    def _combined(self, operation: str, inner: Sequence[Any], data: object) -> Any:
        if operation == "add":
            return inner[0] + inner[1]
        if operation == "mul":
            return inner[0] * inner[1]
        if operation == "neg":
            return -inner[0]
        if operation == "powi":
            return inner[0] ** int(str(data))
        if operation == "div" and inner[1].is_ground and inner[1] != 0:
            return inner[0].mul_ground(self.field.domain.one / inner[1].coeff(1))
        if operation == "sqrt" and inner[0].is_ground:
            root = self.field.root(inner[0].coeff(1))
            return None if root is None else self.ring.ground_new(root)
        return None

    def written(self, polynomial: Any) -> sp.Expr:
        """A polynomial as an expression."""
        symbols, total = self.ring.symbols, []
        for powers, coefficient in polynomial.terms():
            monomial = (symbol**power for symbol, power in zip(symbols, powers, strict=True))
            total.append(self.field.written(coefficient) * sp.Mul(*monomial))
        return sp.Add(*total)

    def lowered(self, polynomial: Any) -> int:
        """A polynomial as a node of the model."""
        if polynomial not in self._lowered:
            self._lowered[polynomial] = lower(self.model.builder, self.written(polynomial))
        return self._lowered[polynomial]


def _order(builder: Builder, parts: Sequence[int]) -> int:
    """The least M, or nearly, whose field has the turns and the roots of fractions among some nodes."""
    shares, order = [], 1
    for part in parts:
        operation, arguments, _ = builder.nodes[part]
        if operation in {"cos", "sin"} and (share := _share(builder, arguments[0])) is not None:
            shares.append(share if operation == "cos" else Fraction(1, 4) - share)
        elif operation == "sqrt" and (value := builder.value(arguments[0])) is not None and value > 0:
            order = math.lcm(order, order_for_root(value))
    order = math.lcm(order, order_for_turns(shares))
    return order if Field.degree_of(order) <= LARGEST_FIELD else 1


def _share(builder: Builder, number: int) -> Fraction | None:
    """The fraction of a turn that an angle is, if it is written as a fraction of pi."""
    angle, times = scaled(builder, number)
    operation, _, data = builder.nodes[angle]
    if operation != "const":
        return None
    return times / 2 if data == "pi" else Fraction(0) if data == 0 else None


def ring_of(model: Model) -> Ring:
    """The ring of a model, remembered with it.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y
    >>> model = Model(rsym.Shape((x - sp.sqrt(2) * y) * (x + sp.sqrt(2) * y), (x, y)), {})
    >>> ring = ring_of(model)
    >>> ring.polynomial(model.root) == ring.polynomial(lower(model.builder, x**2 - 2 * y**2))
    True
    """
    return model.remembered(Ring)


def multiplicity(model: Model, number: int, divisor: int, most: int = 4) -> float:
    """How often one polynomial divides another, up to `most`, infinitely often where that is zero. Remembered.

    0 where they are no polynomials.
    """
    return model.remembered(_multiplicity, number, divisor, most)


def _multiplicity(model: Model, number: int, divisor: int, most: int) -> float:
    if model.builder.value(number) == 0:
        return math.inf
    ring = ring_of(model)
    dividend = ring.polynomial(number)
    if dividend is None:
        return 0
    if dividend == 0:
        return math.inf
    unit = ring.polynomial(divisor)
    if unit is None or _degree(unit) < 1 or _degree(dividend) > HIGHEST:
        return 0
    count = 0
    while count < most:
        dividend, remainder = dividend.div(unit)
        if remainder != 0:
            return count
        count += 1
    return most


def _degree(polynomial: Any) -> int:
    """The total degree of a polynomial that is not zero."""
    return max((sum(powers) for powers in polynomial.monoms()), default=0)


def same_zeros(model: Model, a: int, b: int, *, free: bool = False) -> bool:
    """Whether two nodes are polynomials that are equal or opposite.

    If `free`, also polynomials of what is itself none: then they are so wherever both are defined.
    """
    if not free:
        f, g = (ring_of(model).polynomial(number) for number in (a, b))
        return f is not None and g is not None and (f == g or f == -g)
    p, q = polynomial_of(model, a, free=free), polynomial_of(model, b, free=free)
    return p is not None and q is not None and 0 in (sp.expand(p - q), sp.expand(p + q))


def sum_of_squares(polynomial: sp.Poly) -> list[tuple[sp.Rational, sp.Poly]]:
    """Positive factors and linear polynomials of whose squares a quadratic one is the sum; none if it is not.

    Examples
    --------
    >>> x, y = sp.symbols("x y")
    >>> [(factor, form.as_expr()) for factor, form in sum_of_squares(sp.Poly(x**2 + x * y + y**2, x, y, domain=sp.QQ))]
    [(1, x + y/2), (3/4, y)]
    >>> sum_of_squares(sp.Poly(x**2 + 3 * x * y + y**2, x, y, domain=sp.QQ))
    []
    """
    squares: list[tuple[sp.Rational, sp.Poly]] = []
    while not polynomial.is_zero:
        gens = polynomial.gens
        leading = next((x for x in gens if polynomial.total_degree() == 2 == polynomial.degree(x)), None)
        factor = sp.Integer(0) if leading is None else polynomial.as_expr().coeff(leading, 2)
        if leading is None or not factor > 0:
            return []
        form = sp.Poly(polynomial.diff(leading).as_expr() / (2 * factor), *gens, domain=sp.QQ)
        squares.append((factor, form))
        polynomial = sp.Poly(polynomial.as_expr() - factor * form.as_expr() ** 2, *gens, domain=sp.QQ)
    return squares
