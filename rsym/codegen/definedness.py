"""Where a program is defined, as far as its form tells."""

from __future__ import annotations

from rsym.codegen.program import Node, live

# Defined for all real arguments.
_TOTAL = frozenset(
    "const input add mul neg powi abs sign min max select sin cos exp r0_conjunction r0_disjunction".split()
)
# NaN if one argument is. (Powers are not: NaN**0 = 1.)
_STRICT = frozenset(
    "add mul div neg powi sqrt abs sign min max sin cos exp log atan2 r0_conjunction r0_disjunction"
    " versine gap trimming normalised".split()
)


class Definedness:
    """What the form of a program says of undefined values, by node."""

    def __init__(self, nodes: tuple[Node, ...], nonnegative: list[bool]) -> None:
        self._nodes = nodes
        self._total: list[bool] = []
        for operation, arguments, _ in nodes:
            defined = operation in _TOTAL or (operation == "sqrt" and nonnegative[arguments[0]])
            self._total.append(defined and all(self._total[argument] for argument in arguments))

    def is_total(self, number: int) -> bool:
        """Defined at every point."""
        return self._total[number]

    def cause(self, number: int) -> int:
        """What alone makes this node undefined where it is so, as far down as there is one such."""
        while self._nodes[number].operation in _TOTAL & _STRICT:
            partial = {argument for argument in self._nodes[number].arguments if not self._total[argument]}
            if len(partial) != 1:
                break
            (number,) = partial
        return number

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
                known[k] = operation in _STRICT and any(fails)
        return known[number]


def is_decisive(definedness: Definedness, node: Node) -> bool:
    """Whether a select has no value where what it compares is undefined."""
    first, second, _, no = node.arguments
    return all(definedness.is_total(u) or definedness.fails_with(no, definedness.cause(u)) for u in (first, second))
