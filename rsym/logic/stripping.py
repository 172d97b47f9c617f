"""Stripping: a node without what does not change its zeros, and the sign that this leaves.

Negations, constants and factors of one sign count as a sign; odd powers and normalisation keep sign and zeros, and so
does what rises through 0, however steeply: atan and erf of u, tanh(u), sinh(u), exp(u) - 1, 1/(1 + exp(-u)) - 1/2.
Which factors have one sign is for the caller to say: by their form everywhere, by their values on a box, or
by the signs of tests on many boxes at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.row import UP

TERMS, FACTORS = 32, 5  # parts of a sum that is compared with others, and products in one another
LARGEST = Fraction(2**180)  # coefficients beyond are of another unit: their fourth power is hardly a number


class Signed(NamedTuple):
    """A node times 1 or -1."""

    number: int
    sign: int = 1

    def made(self, builder: Builder) -> int:
        """The node of the product."""
        return self.number if self.sign > 0 else builder.neg(self.number)


def keeps_sign(builder: Builder, number: int) -> bool:
    """Whether a node has zeros and signs of its first argument by its form: odd powers, and what is normalised."""
    operation, _, data = builder.nodes[number]
    return operation == "normalised" or (operation == "powi" and isinstance(data, int) and data % 2 == 1)


@dataclass(frozen=True)
class Stripping:
    """What drops from a node.

    Parameters
    ----------
    builder : Builder
        Where the nodes are.
    sign_of : function
        1 or -1 where a factor certainly has that sign, else 0: then it stays.
    divisor_sign : function, optional
        The same of divisors, where that is another question.
    keeps : function, optional
        Whether a power or what is normalised has the zeros and signs of its first argument; by default `keeps_sign`.
    otherwise : function, optional
        What else a node may be replaced by.

    Examples
    --------
    >>> b = Builder(("x", "y"), ())
    >>> x, y = b.input("x"), b.input("y")
    >>> drop = Stripping(b, lambda number: formal_sign(b, number))
    >>> drop(b.mul(b.const(-3), b.powi(b.div(x, b.add(b.const(1), b.square(y))), 3))) == Signed(x, -1)
    True
    """

    builder: Builder
    sign_of: Callable[[int], int]
    divisor_sign: Callable[[int], int] | None = None
    keeps: Callable[[int], bool] | None = None
    otherwise: Callable[[int], Signed | None] | None = None

    def __call__(self, number: int, sign: int = 1) -> Signed:
        """What is left in the end."""
        *_, last = self.steps(number, sign)
        return last

    def steps(self, number: int, sign: int = 1) -> Iterator[Signed]:
        """The node, and what is left of it from step to step."""
        part: Signed | None = Signed(number, sign)
        while part is not None:
            number, sign = part
            yield part
            inner = self._inner(number)
            part = None if inner is None else Signed(inner.number, sign * inner.sign)

    def _inner(self, number: int) -> Signed | None:
        operation, arguments, _ = self.builder.nodes[number]
        if operation == "neg":
            return Signed(arguments[0], -1)
        if operation == "zero_with":
            return Signed(arguments[1])
        if operation in {"normalised", "powi", "signed_power"}:
            kept = keeps_sign(self.builder, number) if self.keeps is None else self.keeps(number)
            return Signed(arguments[0]) if kept else None
        if operation == "mul":
            for one, other in (arguments, arguments[::-1]):
                if sign := self.sign_of(one):
                    return Signed(other, sign)
        if operation == "div" and (sign := (self.divisor_sign or self.sign_of)(arguments[1])):
            return Signed(arguments[0], sign)
        if (inner := rising(self.builder, number)) is not None:
            return inner
        return None if self.otherwise is None else self.otherwise(number)


def rising(builder: Builder, number: int) -> Signed | None:
    """The u of a node that rises, or falls, with u alone, and is 0 where u is, by its form; else None.

    Examples
    --------
    >>> b = Builder(("x",), ())
    >>> logistic = b.div(b.const(1), b.add(b.const(1), b.make("exp", b.input("x"))))
    >>> rising(b, b.sub(logistic, b.const(Fraction(1, 2)))) == Signed(b.input("x"), -1)
    True
    >>> logistic = b.make("exp", b.neg(b.make("softplus", b.input("x"))))
    >>> rising(b, b.sub(logistic, b.const(Fraction(1, 2)))) == Signed(b.input("x"), -1)
    True
    """
    operation, arguments, _ = builder.nodes[number]
    row = OPERATIONS[operation]
    if row.grows == (UP,) and row.parity == "odd":
        return Signed(arguments[0])
    if operation == "atan2" and constant_sign(builder, arguments[1]) > 0:
        return Signed(arguments[0])
    if operation != "add":
        return None
    (one, some), (other, more) = (scaled(builder, argument) for argument in arguments)
    if builder.nodes[one].operation == builder.nodes[other].operation == "exp" and some == -more:
        (first,), (second,) = builder.nodes[one].arguments, builder.nodes[other].arguments
        doubled = builder.neg(first) == second  # sinh
        return Signed(first if doubled else builder.sub(first, second), 1 if some > 0 else -1)
    return _above(builder, number, Fraction(0))


def _above(builder: Builder, number: int, level: Fraction) -> Signed | None:
    """What has the sign of the node less a level, where that is an exponential less 1 in the end."""
    sign = 1
    while True:
        number, times = scaled(builder, number)
        sign, level = sign if times > 0 else -sign, level / times
        operation, arguments, _ = builder.nodes[number]
        if operation == "exp":
            exponent, slope = scaled(builder, arguments[0])
            inner = builder.nodes[exponent]
            if inner.operation == "softplus" and slope == -1 and level == Fraction(1, 2):  # 1/(1 + exp(u))
                return Signed(inner.arguments[0], -sign)
            return Signed(arguments[0], sign) if level == 1 else None
        constants = [builder.value(argument) for argument in arguments]
        if operation == "add" and (constant := next((c for c in constants if c is not None), None)) is not None:
            level -= constant
            number = arguments[1] if constants[0] is not None else arguments[0]
        elif operation == "div" and constants[0] and level / constants[0] > 0 and is_positive(builder, arguments[1]):
            # c/v is above t where v is below c/t, both of one sign
            sign, level, number = (-sign if constants[0] > 0 else sign), constants[0] / level, arguments[1]
        else:
            return None


def formal_sign(builder: Builder, number: int) -> int:
    """The sign that the form of a node shows wherever it is defined; 0 where it shows none, as of a letter."""
    return 1 if is_positive(builder, number) else constant_sign(builder, number)


def constant_sign(builder: Builder, number: int) -> int:
    """The sign of a rational constant; 0 of anything else."""
    value = builder.value(number) or 0
    return (value > 0) - (value < 0)


def is_positive(builder: Builder, number: int) -> bool:
    """Whether the form of a node shows that it is positive wherever it is defined; no form shows it of a letter."""
    operation, arguments, data = builder.nodes[number]
    if operation == "const":
        value = builder.value(number)
        return value is None or value > 0  # pi, e
    if operation == "exp":
        return True
    if operation == "add":
        return all(builder.nonnegative[a] for a in arguments) and any(is_positive(builder, a) for a in arguments)
    if operation in {"mul", "div", "sqrt"} or (operation == "powi" and data is not None):
        return all(is_positive(builder, argument) for argument in arguments)
    return False


def scaled(builder: Builder, number: int) -> tuple[int, Fraction]:
    """A node u and a rational number c, not 0, with c*u for the node.

    Examples
    --------
    >>> b = Builder(("x",), ())
    >>> x = b.input("x")
    >>> scaled(b, b.neg(b.mul(b.const(3), x))) == (x, -3)
    True
    """
    times = Fraction(1)
    while True:
        operation, arguments, _ = builder.nodes[number]
        value = builder.value(arguments[0]) if operation == "mul" else None
        if operation == "neg":
            number, times = arguments[0], -times
        elif value:
            number, times = arguments[1], times * value
        else:
            return number, times


def _divided(builder: Builder, number: int, deep: int = FACTORS) -> tuple[int, Fraction]:
    """The same without the numbers within a product: sqrt(2)*x and 5/17 of sqrt(2)*(5/17*x)."""
    inner, times = scaled(builder, number)
    if deep and builder.nodes[inner].operation == "mul":
        (one, p), (other, q) = (_divided(builder, part, deep - 1) for part in builder.nodes[inner].arguments)
        if p * q != 1:
            return builder.mul(one, other), times * p * q
    return inner, times


def bare(builder: Builder, number: int) -> int:
    """The node without sign and constant factor: its zeros are the same."""
    return unscaled(builder, number).number


def factor(builder: Builder, number: int) -> int:
    """The sign of the constant factor that `bare` takes away."""
    return unscaled(builder, number).sign


def unscaled(builder: Builder, number: int) -> Signed:
    """A node u and a sign: the node is u times a constant of that sign. Asked on every box, worked out once."""
    if number not in builder.scaled:
        inner, times = _divided(builder, number)
        made, positive = _sum(builder, inner) if builder.nodes[inner].operation == "add" else (inner, 1)
        builder.scaled[number] = made, positive if times > 0 else -positive
    return Signed(*builder.scaled[number])


def of_size(builder: Builder, part: Signed) -> Signed:
    """A sum by its first coefficient where that is so large or small that squares of it are no numbers.

    Examples
    --------
    >>> b = Builder(("x",), ())
    >>> x, tiny = b.input("x"), b.const(Fraction(1, 10**300))
    >>> of_size(b, Signed(b.sub(tiny, b.mul(tiny, x)))) == Signed(b.sub(x, b.const(1)), -1)
    True
    """
    sum_ = sum_terms(builder, part.number) if builder.nodes[part.number].operation == "add" else None
    if sum_ is None or 1 / LARGEST < abs(sum_[0][min(sum_[0])]) < LARGEST:
        return part
    made, sign = _sum(builder, part.number)
    return Signed(made, part.sign * sign)


def _sum(builder: Builder, number: int) -> tuple[int, int]:
    """A sum divided by the coefficient of its first term, and the sign of that: x - 1/2 of 1 - 2*x."""
    found = sum_terms(builder, number)
    if found is None:
        return number, 1
    terms, constant = found
    leading = terms[min(terms)]
    made = builder.const(constant / leading)
    for part in sorted(terms):
        made = builder.add(made, builder.mul(builder.const(terms[part] / leading), part))
    return made, 1 if leading > 0 else -1


def sum_terms(builder: Builder, number: int) -> tuple[dict[int, Fraction], Fraction] | None:
    """The coefficients of the terms of a sum, and its constant.

    Terms of one node are added up; None where they cancel, and where there are many: the sum stays as it is written.
    """
    found = multiples(builder, number)
    return found if found[0] and all(found[0].values()) else None


def multiples(builder: Builder, number: int) -> tuple[dict[int, Fraction], Fraction]:
    """The coefficients of the terms of a sum, 0 for those that cancel, and its constant; of many terms none."""
    terms: dict[int, Fraction] = {}
    constant, stack, count = Fraction(0), [(number, Fraction(1))], 0
    while stack:
        part, times = stack.pop()
        count += 1
        inner, share = _divided(builder, part)
        operation, arguments, data = builder.nodes[part]
        if operation == "add":
            stack.extend((argument, times) for argument in arguments)
        elif inner != part:
            stack.append((inner, times * share))
        elif operation == "const" and isinstance(data, Fraction):
            constant += times * data
        else:
            terms[part] = terms.get(part, Fraction(0)) + times
        if count > TERMS:
            return {}, Fraction(0)
    return terms, constant


def even_root(builder: Builder, number: int) -> int | None:
    """The u of |u|, u*u and an even power of u, which have the zeros of u and change no sign there; else None."""
    operation, arguments, data = builder.nodes[number]
    square = operation == "mul" and arguments[0] == arguments[1]
    even = operation == "powi" and isinstance(data, int) and data % 2 == 0
    return arguments[0] if square or even or operation == "abs" else None


def is_even(builder: Builder, number: int) -> bool:
    """Whether a node shows by its form that it is zero without a change of sign, if at all."""
    return even_root(builder, scaled(builder, number)[0]) is not None


def sign_gate(builder: Builder, operation: str, first: int, second: int) -> int:
    """The minimum or maximum for the sign alone: constants drop, of which one that is not positive is outside.

    Examples
    --------
    >>> b = Builder(("x",), ())
    >>> sign_gate(b, "min", b.input("x"), b.const(1)) == sign_gate(b, "max", b.const(0), b.input("x")) == b.input("x")
    True
    """
    idle = 1 if operation == "min" else -1
    for one, other in ((first, second), (second, first)):
        value = builder.value(one)
        if value is not None:
            return other if (value > 0) == (idle > 0) else one
    if bare(builder, first) == bare(builder, second):
        same = factor(builder, first) == factor(builder, second)
        return first if same else builder.const(-idle)  # of a condition and its opposite one holds but on a line
    return builder.make(operation, first, second)
