"""Derivatives by letters: how the distance from a zero set changes when a letter moves.

The distance of first order of f is f_1 = f/sqrt(f**2/L**2 + |grad f|**2), as in `rsym.normalise`. Its derivative by a
letter p is that of the program, with d/dp grad f in it; where f = 0 it is (df/dp)/|grad f|, the speed at which the zero
set moves out of where f is positive. At corners all of it is that of one side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from rsym.errors import RsymError
from rsym.program.builder import Builder
from rsym.program.calculus import OneSided
from rsym.program.differentiation import ONE_SIDED, derivative, unless_equal
from rsym.program.operations import OPERATIONS
from rsym.program.program import live

# L is an input, so that other points compile nothing; no letter of a user has a space in its name.
LENGTH = "length L"


@dataclass(frozen=True)
class FirstOrder:
    """The distance of first order from the zero set of a node, and its derivatives by letters.

    Examples
    --------
    >>> builder = Builder(("x", "y"), ("r", LENGTH))
    >>> x, r = builder.input("x"), builder.input("r")
    >>> found = FirstOrder(builder, builder.sub(r, x))
    >>> print(builder.program({"by r": found.by("r", {})}).outputs[0][0])
    by r
    """

    builder: Builder
    node: int

    @cached_property
    def _calculus(self) -> OneSided:
        return OneSided(self.builder, self.node)

    @cached_property
    def _whole(self) -> int:
        b, length = self.builder, self.builder.input(LENGTH)
        scaled = b.mul(b.square(length), self._calculus.gradient_squared)
        return b.mul(length, b.normalised(self.node, scaled))

    @property
    def distance(self) -> int:
        """The distance, positive where the node is; 0 where that is 0, at corners too."""
        return self.builder.zero_with(self.node, self._whole)

    def by(self, letter: str, known: dict[tuple[int, str], int]) -> int:
        """Its derivative by a letter; `known` keeps what is differentiated, for other nodes of the builder too."""
        refuse_parameter(self.builder, self.node, letter)
        b, slope = self.builder, self.builder.sqrt(self._calculus.gradient_squared)
        moved, whole = (derivative(b, node, letter, rules=ONE_SIDED, known=known) for node in (self.node, self._whole))
        # Where the node is 0 its second derivatives do not matter, and at corners they are not finite.
        return unless_equal(b, b.abs(self.node), whole, b.div(moved, slope))


def refuse_parameter(builder: Builder, number: int, letter: str) -> None:
    """Refuse a letter that a parameter of an operation below a node depends on: rules of derivatives leave it out."""
    depends: dict[int, bool] = {}
    for part in live(builder.nodes, [number]):
        operation, arguments, data = builder.nodes[part]
        depends[part] = data == letter if operation == "input" else any(depends[one] for one in arguments)
        if OPERATIONS[operation].parameter is not None and depends[arguments[-1]]:
            raise RsymError(
                f"the letter {letter!r} is the parameter of an operation ({operation}), by which it has no derivative",
                code="parameter-letter",
                remedy="choose its value, and leave it out here",
            )
