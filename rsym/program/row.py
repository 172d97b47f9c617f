"""What is known of an operation: one row of the table.

A row says what an operation means, how it is written out, differentiated and bounded, and where it is defined and
analytic. Every set of operations, every test of a domain and the images of what is monotone are computed from it.
Rules make nodes through `Nodes`, so the table needs no builder, and no array package: a meaning is given one.
Last come the rules that many rows share: how operations scale, for `far_forms`, and what jumps part, for `Jumps`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any, NamedTuple, Protocol, TypeAlias

from rsym.program.program import Data, Node

HALF = Fraction(1, 2)
SELF, SWITCH = -1, -2  # places that are no arguments: the operation itself, the node that decides its branch
UP, DOWN, UP_IN_SIZE = "+", "-", "|+|"  # how an operation grows with an argument


class Nodes(Protocol):
    """What a rule asks of a builder."""

    @property
    def nodes(self) -> list[Node]:
        """All nodes."""

    @property
    def nonnegative(self) -> list[bool]:
        """Which are never negative."""

    @property
    def uniform(self) -> list[bool]:
        """Which are the same for all points."""

    def make(self, operation: str, *arguments: int, data: Data = None) -> int:
        """The node as it stands."""

    def value(self, number: int) -> Fraction | None:
        """The number that a constant is."""

    def const(self, value: Fraction | int) -> int:
        """A constant."""

    def input(self, name: str) -> int:
        """An input."""

    def undefined(self) -> int:
        """NaN."""

    def neg(self, a: int) -> int:
        """-a."""

    def add(self, a: int, b: int) -> int:
        """A + b."""

    def sub(self, a: int, b: int) -> int:
        """A - b."""

    def mul(self, a: int, b: int) -> int:
        """a*b."""

    def square(self, a: int) -> int:
        """a*a."""

    def div(self, a: int, b: int) -> int:
        """a/b."""

    def powi(self, a: int, exponent: int) -> int:
        """a**exponent."""

    def sqrt(self, a: int) -> int:
        """sqrt(a)."""

    def abs(self, a: int) -> int:
        """|a|."""

    def absolute_power(self, a: int, exponent: int) -> int:
        """|a|**exponent."""

    def signed_power(self, a: int, exponent: int) -> int:
        """sign(a)*|a|**exponent."""

    def select(self, a: int, b: int, yes: int, no: int) -> int:
        """`yes` where a > b, else `no`."""

    def normalised(self, f: int, q: int) -> int:
        """f/sqrt(f**2 + q)."""

    def zero_with(self, f: int, g: int) -> int:
        """The value of g, 0 where f is."""


class Far(NamedTuple):
    """A node seen from far away, and its degree (see `far_forms`)."""

    node: int
    degree: int


class Test(NamedTuple):
    """A condition on one place: "nonzero", "apart" (nonzero, and defined), "positive" or "nonnegative"."""

    kind: str
    place: int


Clause: TypeAlias = tuple[Test, ...]  # one of which must hold
Clauses: TypeAlias = tuple[Clause, ...]  # all of which must hold


def nonzero(*places: int) -> Clause:
    """One of these arguments is not zero."""
    return tuple(Test("nonzero", place) for place in places)


def apart(place: int) -> Clause:
    """It is defined, and not zero."""
    return (Test("apart", place),)


def positive(place: int) -> Clause:
    """It is above zero."""
    return (Test("positive", place),)


def nonnegative(place: int) -> Clause:
    """It is zero or above."""
    return (Test("nonnegative", place),)


class Admissible(NamedTuple):
    """What a parameter may be: above `low`, or that itself if `closed`, and at most `high`; below it if `below`."""

    low: int
    high: int | None = None
    closed: bool = False
    below: bool = False

    def holds(self, value: Any) -> bool:
        """Whether a number, or all of a ball, lies in it."""
        enough = value >= self.low if self.closed else value > self.low
        if self.high is None:
            return bool(enough)
        return bool(enough) and bool(value < self.high if self.below else value <= self.high)

    def excludes(self, value: Any) -> bool:
        """Whether a number, or all of a ball, lies outside it."""
        short = value < self.low if self.closed else value <= self.low
        if self.high is None:
            return bool(short)
        return bool(short) or bool(value >= self.high if self.below else value > self.high)


Given: TypeAlias = Sequence[int]  # the derivatives or jumps of the arguments
Meaning: TypeAlias = Callable[..., Any]
Expansion: TypeAlias = Callable[[Nodes, Node], int]
Rule: TypeAlias = Callable[[Nodes, int, Node, Given], int]
FarRule: TypeAlias = Callable[[Nodes, Node, Sequence[Far]], Far]


@dataclass(frozen=True)
class Operation:
    """One operation.

    Attributes
    ----------
    arity : int
        How many arguments; a parameter, which does not vary from point to point, comes last.
    meaning : callable
        The plain meaning on arrays, the array package first. It shares no code with the expansion.
    expansion : callable, optional
        The same in primitive operations; without one the operation is primitive, and every backend has a text.
    derivative, jump, far : callable, optional
        Its derivative, from those of the arguments; how far the sides of a choice below it may part its values
        (`jumps`); its form far away (`far_forms`). None is a refusal: it has no derivative of its own, nothing bounds
        the sides, it has no degree.
    formula : callable, optional
        The expression that SymPy prints for `rsym.lambdify`.
    texts : mapping of str to str
        How a primitive operation is written in "numpy", "c" and "llvm".
    grows : tuple of str
        For each argument UP, DOWN or UP_IN_SIZE; empty where it is not monotone in all of them.
    at : callable, optional
        For a monotone operation its value at points, in the numbers of ball arithmetic; sizes of what grows in size.
    rounding : str
        What its value in float64 may be off by (`interval_monotone`), for a monotone operation.
    domain : clauses
        Where it has a value, beside the range of its parameter; empty where it always has. Maybe too strict.
    parameter, analytic_parameter : Admissible, optional
        What the parameter may be, and for which of these the operation is analytic where the clauses say so.
    analytic, analytic_even : clauses, optional
        Where it is analytic in its arguments; for an even whole parameter. () is everywhere, None is nowhere.
    strict : bool
        Whether it is undefined where any argument is.
    nonnegative, symmetric, homogeneous : bool
        Never below 0; the same with its two operands exchanged; of degree 1 in the operands.
    parity : str
        "even" or "odd" in its first argument.
    branching : bool
        Whether it is one of several analytic functions, by the sign of its switch; jumping: which differ there.
    logic : str
        "and" or "or", for the operations of R-systems.
    zeros : tuple of str
        The signs of operands at which it is zero: 0, +, - or * for any.
    """

    arity: int
    meaning: Meaning
    expansion: Expansion | None = None
    derivative: Rule | None = None
    jump: Rule | None = None
    far: FarRule | None = None
    formula: Callable[..., Any] | None = None
    texts: Mapping[str, str] = field(default_factory=dict)
    grows: tuple[str, ...] = ()
    at: Callable[..., Any] | None = None
    rounding: str = ""
    domain: Clauses = ()
    parameter: Admissible | None = None
    analytic_parameter: Admissible | None = None
    analytic: Clauses | None = None
    analytic_even: Clauses | None = None
    strict: bool = False
    nonnegative: bool = False
    symmetric: bool = False
    homogeneous: bool = False
    parity: str = ""
    branching: bool = False
    jumping: bool = False
    logic: str = ""
    zeros: tuple[str, ...] = ()

    @property
    def total(self) -> bool:
        """Whether it is defined for all real arguments."""
        return not self.domain and self.parameter is None

    @property
    def thin(self) -> bool:
        """Whether it is undefined on thin sets alone, where something vanishes."""
        parts = all(any(test.kind in {"nonzero", "apart"} for test in clause) for clause in self.domain)
        return not self.total and self.parameter is None and parts

    @property
    def smooth(self) -> bool:
        """Whether its one-sided slopes lie in the images of its derivative, as the mean-value theorem asks."""
        return not self.torn and self.domain != NOWHERE

    @property
    def torn(self) -> bool:
        """Whether its values jump, at zeros of its switch or, analytic nowhere, at places of its own."""
        return self.jumping or (self.total and self.analytic is None)

    @property
    def kinked(self) -> bool:
        """Whether its zero set may have a kink where those of its arguments have none."""
        alone = any(signs[0] == "0" and "0" not in signs[1:] for signs in self.zeros)
        scales = self.homogeneous or bool(self.parity)
        return self.branching or bool(self.logic) or (alone and scales and nonzero(0) in (self.analytic or ()))


NOWHERE: Clauses = ((),)  # a clause without tests never holds


NEARNESS = "nearness"


def raised(b: Nodes, part: Far, degree: int) -> int:
    """The node w at a higher degree: t to the difference times w."""
    return b.mul(b.powi(b.input(NEARNESS), degree - part.degree), part.node)


def aligned(b: Nodes, parts: Sequence[Far]) -> tuple[list[int], int]:
    """The nodes at their highest degree."""
    degree = max(part.degree for part in parts)
    return [raised(b, part, degree) for part in parts], degree


def homogeneous(b: Nodes, node: Node, parts: Sequence[Far]) -> Far:
    """What scales with its first two operands; the parameter comes last."""
    operands, degree = aligned(b, parts[:2])
    return Far(b.make(node.operation, *operands, *(part.node for part in parts[2:])), degree)


def summed(b: Nodes, jumps: Sequence[int]) -> int:
    """The sum of jumps."""
    total = b.const(0)
    for jump in jumps:
        total = b.add(total, jump)
    return total


def lipschitz(factor: int) -> Rule:
    """An operation of which no partial derivative is larger in size."""
    return lambda b, number, node, jumps: b.mul(b.const(factor), summed(b, jumps[:2]))


def unbounded(b: Nodes, number: int, node: Node, jumps: Sequence[int]) -> int:
    """Nothing is known of the other sides where an argument jumps."""
    return b.select(summed(b, jumps), b.const(0), b.make("exp", b.const(10**5)), b.const(0))


def within(b: Nodes, size: int, total: int, most: int) -> int:
    """4 total/size where that is below 1, else `most` where there is a jump at all."""
    wide = b.mul(b.const(4), total)
    some = b.select(total, b.const(0), b.const(most), b.const(0))
    return b.select(size, wide, b.make("div", wide, size), some)


def of_power(b: Nodes, number: int, node: Node, jumps: Sequence[int]) -> int:
    """A (|u| + j)**(a - 1) j for a constant exponent a >= 1, 2 j**a for 0 < a < 1."""
    base, exponent = node.arguments
    value = b.value(exponent)
    if value is None or value <= 0:
        return unbounded(b, number, node, jumps)
    if value < 1:
        return b.mul(b.const(2), b.absolute_power(jumps[0], exponent))
    reach = b.absolute_power(b.add(b.abs(base), jumps[0]), b.sub(exponent, b.const(1)))
    return b.mul(b.mul(exponent, reach), jumps[0])
