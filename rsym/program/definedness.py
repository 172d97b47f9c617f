"""Where a program is defined, as far as its form tells."""

from __future__ import annotations

from rsym.program.operations import OPERATIONS
from rsym.program.program import Node, live


class Definedness:
    """What the form of a program says of undefined values, by node."""

    def __init__(self, nodes: tuple[Node, ...], nonnegative: list[bool]) -> None:
        self._nodes = nodes
        self._nonnegative = nonnegative
        self._total: list[bool] = []
        for operation, arguments, _ in nodes:
            defined = OPERATIONS[operation].total or (operation == "sqrt" and nonnegative[arguments[0]])
            self._total.append(defined and all(self._total[argument] for argument in arguments))

    def causes(self, number: int) -> tuple[int, ...]:
        """Nodes of which one is undefined wherever this node is, as far down as that can be followed."""
        found: dict[int, None] = {}
        seen: set[int] = set()
        stack = [number]
        while stack:
            part = stack.pop()
            if part in seen or self._total[part]:
                continue
            seen.add(part)
            if self._passes_on(part):
                stack.extend(self._nodes[part].arguments)
            else:
                found[part] = None
        return tuple(found)

    def _passes_on(self, number: int) -> bool:
        """Whether a node is undefined where an argument is, and only there."""
        operation, arguments, _ = self._nodes[number]
        if operation == "sqrt":
            return self._nonnegative[arguments[0]]
        row = OPERATIONS[operation]
        return row.total and row.strict

    def fails_with(self, number: int, cause: int) -> bool:
        """Undefined wherever the node `cause` is."""
        known: dict[int, bool] = {}
        for k in live(self._nodes, [number]):
            operation, arguments, _ = self._nodes[k]
            fails = [known[argument] for argument in arguments]
            if k == cause or operation == "undefined":
                known[k] = True
            elif operation == "select":
                known[k] = fails[3] and any(fails[:3])
            else:
                known[k] = OPERATIONS[operation].strict and any(fails)
        return known[number]


def is_decisive(definedness: Definedness, node: Node) -> bool:
    """Whether a select has no value where what it compares is undefined."""
    first, second, _, no = node.arguments
    causes = [cause for u in (first, second) for cause in definedness.causes(u)]
    return all(definedness.fails_with(no, cause) for cause in causes)
