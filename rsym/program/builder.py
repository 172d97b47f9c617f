"""Making nodes: equal ones once, and what is exact simplified on the way.

Every rule holds in exact arithmetic; none reorders a sum or a product, none
replaces an undefined value by a defined one except a factor or numerator 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from functools import reduce
from typing import TypeAlias

from rsym.program.operations import OPERATIONS
from rsym.program.program import Data, Node, Program, assemble
from rsym.program.row import HALF as HALF

ONE = Fraction(1)

# Exact folding stops here: float64 ends at about 1100 bits, beyond that the numbers only cost time.
_FOLDED_BITS = 4096


class Builder:
    """A growing program. Nodes are numbers; the methods named after operations return numbers."""

    def __init__(self, coordinates: tuple[str, ...], letters: tuple[str, ...]) -> None:
        self.coordinates = coordinates
        self.letters = letters
        self.nodes: list[Node] = []
        self.uniform: list[bool] = []
        self.nonnegative: list[bool] = []
        self._ranges: list[Range | None] = []
        self.derivatives: dict[tuple[int, str], int] = {}
        self.scaled: dict[int, tuple[int, int]] = {}
        self.chosen: dict[int, int | None] = {}
        self.switches: dict[int, int] = {}
        self.steps: set[int] = set()  # choices by conditions that somebody wrote: they may jump
        self.walls: dict[int, dict[int, int | None]] = {}  # ends of domains, and limits there (`logic.domains`)
        self.ending: dict[int, int] = {}  # gates that say where something has a value, and their operand that does
        self.rewritten = False  # whether a sign form has other leaves than its node
        self._index: dict[Node, int] = {}

    def make(self, operation: str, *arguments: int, data: Data = None) -> int:
        """The node with this operation, arguments and data, as it stands."""
        node = Node(operation, arguments, data)
        number = self._index.get(node)
        if number is None:
            number = self._index[node] = len(self.nodes)
            self.nodes.append(node)
            varying = operation == "input" and data in self.coordinates
            self.uniform.append(not varying and all(self.uniform[argument] for argument in arguments))
            self._ranges.append(constant_range(node, [self._ranges[argument] for argument in arguments]))
            self.nonnegative.append(self._is_nonnegative(node))
        return number

    def program(self, outputs: Mapping[str, int]) -> Program:
        """The frozen program with these outputs."""
        program = assemble(self.nodes, self.coordinates, self.letters, outputs)
        assert all(len(node.arguments) == OPERATIONS[node.operation].arity for node in program.nodes)
        return program

    def value(self, number: int) -> Fraction | None:
        """The exact rational value of a constant node."""
        node = self.nodes[number]
        return node.data if node.operation == "const" and isinstance(node.data, Fraction) else None

    def _is_nonnegative(self, node: Node) -> bool:
        operation, arguments, data = node
        if operation == "const":
            return isinstance(data, str) or (isinstance(data, Fraction) and data >= 0)
        if (known := self._ranges[-1]) is not None and known[0] > CLEAR:
            return True
        if OPERATIONS[operation].nonnegative:
            return True
        if operation == "mul" and arguments[0] == arguments[1]:
            return True
        if operation == "powi" and isinstance(data, int) and data % 2 == 0:
            return True
        return operation in {"add", "mul", "div", "powi"} and all(self.nonnegative[a] for a in arguments)

    def const(self, value: Fraction | int) -> int:
        """An exact constant."""
        return self.make("const", data=Fraction(value))

    def input(self, name: str) -> int:
        """A coordinate or a letter."""
        return self.make("input", data=name)

    def _folded(self, value: Fraction) -> int | None:
        small = max(value.numerator.bit_length(), value.denominator.bit_length()) <= _FOLDED_BITS
        return self.const(value) if small else None

    def _operand_of(self, operation: str, number: int) -> int | None:
        node = self.nodes[number]
        return node.arguments[0] if node.operation == operation else None

    def neg(self, a: int) -> int:
        """Return -a."""
        value = self.value(a)
        if value is not None:
            return self.const(-value)
        inner = self._operand_of("neg", a)
        return self.make("neg", a) if inner is None else inner

    def add(self, a: int, b: int) -> int:
        """Return a + b."""
        p, q = self.value(a), self.value(b)
        if p == 0:
            return b
        if q == 0:
            return a
        if p is not None and q is not None:
            folded = self._folded(p + q)
            if folded is not None:
                return folded
        if a == b:
            return self.mul(self.const(2), a)
        return self.make("add", *sorted((a, b)))

    def sub(self, a: int, b: int) -> int:
        """Return a - b."""
        return self.add(a, self.neg(b))

    def mul(self, a: int, b: int) -> int:
        """Return a*b; signs move outwards, constants to the left."""
        if self.value(b) is not None:
            a, b = b, a
        p, q = self.value(a), self.value(b)
        if p == 0:
            return a
        if p == 1:
            return b
        if p == -1:
            return self.neg(b)
        if p is not None and q is not None:
            folded = self._folded(p * q)
            if folded is not None:
                return folded
        for first, second in ((a, b), (b, a)):
            inner = self._operand_of("neg", first)
            if inner is not None:
                return self.neg(self.mul(inner, second))
        return self._product(a, b)

    def _product(self, a: int, b: int) -> int:
        p = self.value(a)
        if p is not None and self.nodes[b].operation == "mul":
            c, rest = self.nodes[b].arguments
            q = self.value(c)
            folded = None if q is None else self._folded(p * q)
            if folded is not None:
                return self.mul(folded, rest)
        root, size = self._operand_of("sqrt", a), self._operand_of("abs", a)
        if a == b and root is not None and self.nonnegative[root]:
            return root
        if a == b and size is not None:
            return self.square(size)
        return self.make("mul", *((a, b) if p is not None else sorted((a, b))))

    def square(self, a: int) -> int:
        """Return a*a."""
        return self.mul(a, a)

    def div(self, a: int, b: int) -> int:
        """Return a/b; what is the same for all points is inverted once."""
        p, q = self.value(a), self.value(b)
        if p == 0:
            return a
        if q is not None and q != 0:
            folded = self._folded(1 / q)
            if folded is not None:
                return self.mul(folded, a)
        for first, other, signed in ((a, b, True), (b, a, False)):
            inner = self._operand_of("neg", first)
            if inner is not None:
                return self.neg(self.div(inner, other) if signed else self.div(other, inner))
        if self.uniform[b] and p != 1:
            return self.mul(a, self.make("div", self.const(1), b))
        return self.make("div", a, b)

    def powi(self, a: int, exponent: int) -> int:
        """Return a**exponent for an integer exponent."""
        if exponent < 0:
            return self.div(self.const(1), self.powi(a, -exponent))
        if exponent == 0:
            return self.const(1)
        if exponent <= 2:
            return a if exponent == 1 else self.square(a)
        value = self.value(a)
        if value is not None and self._folds(value, exponent):
            return self.const(value**exponent)
        inner = self._operand_of("neg", a)
        if inner is not None:
            power = self.powi(inner, exponent)
            return self.neg(power) if exponent % 2 else power
        root, size = self._operand_of("sqrt", a), self._operand_of("abs", a)
        if root is not None and self.nonnegative[root] and exponent % 2 == 0:
            return self.powi(root, exponent // 2)
        if size is not None and exponent % 2 == 0:
            return self.powi(size, exponent)
        return self.make("powi", a, data=exponent)

    @staticmethod
    def _folds(value: Fraction, exponent: int) -> bool:
        return max(value.numerator.bit_length(), value.denominator.bit_length()) * exponent <= _FOLDED_BITS

    def sqrt(self, a: int) -> int:
        """Return sqrt(a); the root of a square is the absolute value."""
        value = self.value(a)
        if value is not None and value >= 0:
            root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
            if root * root == value:
                return self.const(root)
        node = self.nodes[a]
        if node.operation == "mul" and node.arguments[0] == node.arguments[1]:
            return self.abs(node.arguments[0])
        return self.make("sqrt", a)

    def abs(self, a: int) -> int:
        """Return |a|."""
        value = self.value(a)
        if value is not None:
            return self.const(abs(value))
        inner = self._operand_of("neg", a)
        if inner is not None:
            return self.abs(inner)
        if self.nodes[a].operation == "sign":
            return self.square(a)  # where both are not 0 both are 1, and one switch is enough
        return a if self.nonnegative[a] else self.make("abs", a)

    def absolute_power(self, a: int, exponent: int) -> int:
        """Return |a|**exponent, an ordinary power for an even integer."""
        value = self.value(exponent)
        if value is not None and value.denominator == 1 and value % 2 == 0:
            return self.powi(a, int(value))
        return self.make("absolute_power", a, exponent)

    def signed_power(self, a: int, exponent: int) -> int:
        """Return sign(a)*|a|**exponent, an ordinary power for an odd integer."""
        value = self.value(exponent)
        if value is not None and value.denominator == 1 and value % 2 == 1:
            return self.powi(a, int(value))
        if value == 0:
            return self.div(a, self.abs(a))
        return self.make("signed_power", a, exponent)

    def undefined(self) -> int:
        """NaN on purpose."""
        return self.make("undefined")

    def select(self, a: int, b: int, yes: int, no: int) -> int:
        """Return `yes` where a > b, elsewhere `no`."""
        p, q = self.value(a), self.value(b)
        if p is not None and q is not None:
            return yes if p > q else no
        return yes if yes == no else self.make("select", a, b, yes, no)

    def step(self, a: int, b: int, yes: int, no: int) -> int:
        """Return the choice of a condition that somebody wrote, which may jump."""
        chosen = self.select(a, b, yes, no)
        if chosen not in (yes, no):
            self.steps.add(chosen)
        return chosen

    def normalised(self, f: int, q: int) -> int:
        """Return f/sqrt(f**2 + q) for q >= 0."""
        inner = self._operand_of("neg", f)
        return self.make("normalised", f, q) if inner is None else self.neg(self.make("normalised", inner, q))

    def zero_with(self, f: int, g: int) -> int:
        """Return g, which goes to 0 where f does, and 0 where f is, even if g is undefined there."""
        inner = self._operand_of("neg", f)
        if inner is not None:
            return self.zero_with(inner, g)
        outer = self._operand_of("neg", g)
        if outer is not None:
            return self.neg(self.zero_with(f, outer))
        return g if self.value(f) or self.value(g) is not None else self.make("zero_with", f, g)

    def normalisation(self, f: int, denominator: int) -> int | None:
        """Recognise f/denominator with denominator = sqrt((k f)**2 + q), k rational, q >= 0."""
        radicand = self._operand_of("sqrt", denominator)
        if radicand is None:
            return None
        terms, square = self._terms(radicand), self.square(f)
        for position, term in enumerate(terms):
            scale = self._root_of_ratio(term, square)
            rest = terms[:position] + terms[position + 1 :]
            if scale is not None and rest and all(self.nonnegative[other] for other in rest):
                unit = self.normalised(self.mul(self.const(scale), f), reduce(self.add, rest))
                return self.mul(self.const(1 / scale), unit)
        return None

    def _root_of_ratio(self, term: int, square: int) -> Fraction | None:
        """The rational k > 0 with term = k**2 * square."""
        if term == square:
            return ONE
        node = self.nodes[term]
        if node.operation != "mul" or node.arguments[1] != square:
            return None
        ratio = self.value(node.arguments[0])
        root = None if ratio is None or ratio <= 0 else self.value(self.sqrt(self.const(ratio)))
        return root or None

    def _terms(self, number: int) -> list[int]:
        terms, stack = [], [number]
        while stack:
            current = stack.pop()
            node = self.nodes[current]
            if node.operation == "add":
                stack.extend(reversed(node.arguments))
            else:
                terms.append(current)
        return terms


Range: TypeAlias = tuple[Fraction, Fraction]

SCALE = 2**64  # ends are rounded outwards to multiples of 1/SCALE
LARGE = Fraction(2**64)
CLEAR = Fraction(1, 2**32)  # what is above that is positive in float64 too


def constant_range(node: Node, inner: Sequence[Range | None]) -> Range | None:
    """Bounds of a node whose arguments have these; None where it is no such constant, or not of moderate size.

    Examples
    --------
    >>> low, high = constant_range(Node("sqrt", (0,), None), [(Fraction(2), Fraction(2))])
    >>> low**2 < 2 < high**2, high - low < 1e-18
    (True, True)
    """
    if node.operation == "const":
        return (node.data, node.data) if isinstance(node.data, Fraction) and abs(node.data) < LARGE else None
    known = [one for one in inner if one is not None]
    if len(known) < max(1, len(inner)) or node.operation not in {"add", "mul", "neg", "sqrt"}:
        return None
    (low, high), *others = known
    if node.operation == "add":
        low, high = low + others[0][0], high + others[0][1]
    elif node.operation == "mul":
        products = [a * b for a in (low, high) for b in others[0]]
        low, high = min(products), max(products)
    elif node.operation == "neg":
        low, high = -high, -low
    elif low < 0:
        return None
    else:
        low = Fraction(math.isqrt(math.floor(low * SCALE**2)), SCALE)
        high = Fraction(math.isqrt(math.ceil(high * SCALE**2)) + 1, SCALE)
    low, high = Fraction(math.floor(low * SCALE), SCALE), Fraction(math.ceil(high * SCALE), SCALE)
    return (low, high) if max(abs(low), abs(high)) < LARGE else None
