"""Where operations are certainly defined: what a comparison must know before it is decided for a whole box."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TypeAlias

from rsym.bounds.ball_arithmetic import ZERO, arb
from rsym.program.operations import OPERATIONS, PARTIAL
from rsym.program.program import Node, live
from rsym.program.row import Test as Condition

Test: TypeAlias = Callable[..., bool]


def holds(condition: Condition, *operands: arb) -> bool:
    """Whether a condition holds all over the balls of the arguments."""
    kind, place = condition
    operand = operands[place]
    if kind == "nonnegative":
        return bool(operand >= ZERO)
    return bool(operand > ZERO) or (kind != "positive" and bool(operand < ZERO))


def is_defined(operation: str, *operands: arb) -> bool:
    """Whether an operation is certainly defined wherever its arguments are. It may be too strict, never too lax."""
    row = OPERATIONS[operation]
    legal = row.parameter is None or row.parameter.holds(operands[-1])
    return legal and all(any(holds(condition, *operands) for condition in clause) for clause in row.domain)


def doubts(nodes: Sequence[Node], numbers: Sequence[int]) -> list[tuple[Test, tuple[int, ...]]]:
    """The tests, with the nodes they take, that make these nodes defined all over a box."""
    partial_nodes = [nodes[number] for number in live(nodes, numbers) if nodes[number].operation in PARTIAL]
    return [(partial(is_defined, node.operation), node.arguments) for node in partial_nodes]
