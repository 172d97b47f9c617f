"""Leaves of one kind: the same calls and formulas but for uniform numbers, which lie in a row for each leaf.

So the code of a form grows with the kinds of its leaves. Every place of a uniform number has a place of its own in the
row, so that numbers that happen to be equal make no kind.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

import numpy as np

from rsym.arrays import Integers
from rsym.bounds.ray_forms import MODEL, NUMBER, RayCall, RayForm, RayValue
from rsym.model.symbols import with_operands
from rsym.program.program import Node, Program
from rsym.sampling.kernels.form_code import leaf_outputs
from rsym.sampling.kernels.routines import Formulas

# The calls of a leaf, and which of them is it; the nodes of its value and gradient, and which of them are these.
Calls: TypeAlias = tuple[tuple[RayCall, ...], RayValue]
Nodes: TypeAlias = tuple[tuple[Node, ...], tuple[int, ...]]
SCALE = 0  # what the value is multiplied by, in a row
# A model is made for all leaves where more than one in so many needs it, and it takes more operations than that.
FEW, MUCH = 4, 100


@dataclass(frozen=True)
class LeafKind:
    """What the leaves of a kind have in common.

    Attributes
    ----------
    rays : RayForm
        Of one leaf; its uniform numbers are places in a row, its first calls those that leaves share.
    points : Formulas or None
        Value and gradient, by the names of `leaf_outputs` (0); a guard has none.
    """

    rays: RayForm
    points: Formulas | None


class LeafKinds:
    """The kinds of leaves, which each leaf is of, what its row is made of, and which models are made for all of them.

    The rows hold numbers out of three arrays in a row: the scales of leaves, the uniform numbers of their models, and
    the nodes of their formulas at points.
    """

    def __init__(self, rays: RayForm, points: Program) -> None:
        count = len(rays.leaves) - rays.guards
        nodes_begin = count + len(rays.uniforms.outputs)
        outputs = dict(points.outputs)
        numbers: dict[tuple[Calls, Nodes | None], int] = {}
        calls_of, nodes_of = _ordered_calls(rays), ordered_nodes(points)
        self.shared = _shared(rays, calls_of)
        self.kinds: list[LeafKind] = []
        self.leaves: list[tuple[int, int]] = []  # the kind of a leaf, and where its row begins
        sources: list[int] = []
        for k, leaf in enumerate(rays.leaves):
            row = len(sources)
            calls, uniforms = _lifted_calls(calls_of, self.shared, len(rays.coordinates), leaf)
            sources += [min(k, count - 1), *(count + number for number in uniforms)]
            nodes = None
            if k < count:
                nodes, constants = _lifted_nodes(nodes_of, points.uniform, [outputs[name] for name in leaf_outputs(k)])
                sources += [nodes_begin + number for number in constants]
            self.leaves.append((numbers.setdefault((calls, nodes), len(numbers)), row))
            if len(numbers) > len(self.kinds):
                formulas = None if nodes is None else _formulas(points.coordinates, nodes, SCALE + 1 + len(uniforms))
                known = tuple(calls_of[number - len(rays.coordinates)] for number in self.shared)
                of_one = replace(rays, calls=(*known, *calls[0]), leaves=calls[1:], guards=0)
                self.kinds.append(LeafKind(of_one, formulas))
        self.sources: Integers = np.array(sources, np.int64)


def _ordered_calls(rays: RayForm) -> list[RayCall]:
    """The calls, operands of sums in an order that the numbers of nodes have no part in."""
    shapes: dict[tuple[str, tuple[int, ...]], int] = {}
    known, found = list(range(len(rays.coordinates))), []
    for function, arguments in rays.calls:
        keys = [known[number] if kind == MODEL else -1 for kind, number in arguments]
        # A sum has the same bits with its operands exchanged.
        if function.startswith("add") and len(set(rays.library[function].parameters)) == 1 and keys[0] > keys[1]:
            keys, arguments = keys[::-1], arguments[::-1]
        known.append(shapes.setdefault((function, tuple(keys)), len(rays.coordinates) + len(shapes)))
        found.append(RayCall(function, arguments))
    return found


def ordered_nodes(program: Program) -> list[Node]:
    """The nodes, operands of sums and products in an order that the numbers of nodes have no part in."""
    shapes: dict[Node, int] = {}
    known: list[int] = []
    found: list[Node] = []
    for uniform, (operation, arguments, data) in zip(program.uniform, program.nodes, strict=True):
        if not uniform and operation in {"add", "mul"} and known[arguments[0]] > known[arguments[1]]:
            arguments = arguments[::-1]
        found.append(Node(operation, arguments, data))
        shape = Node(operation, tuple(known[argument] for argument in arguments), data)
        known.append(-1 if uniform else shapes.setdefault(shape, len(shapes)))
    return found


def _models(calls: Sequence[RayCall], first: int, number: int) -> Sequence[int]:
    """The models that a model is made of."""
    arguments = calls[number - first].arguments if number >= first else ()
    return [value.number for value in arguments if value.kind == MODEL]


def _shared(rays: RayForm, calls: Sequence[RayCall]) -> list[int]:
    """The models that many leaves need and that are much to make, in order."""
    first = len(rays.coordinates)
    operands = partial(_models, calls, first)
    leaves = [leaf.number for leaf in rays.leaves if leaf.kind == MODEL]
    uses = Counter(number for leaf in leaves for number, _ in with_operands(leaf, operands, int))
    sizes = {name: len(function.program) for name, function in rays.library.items()}

    def size(model: int) -> int:
        inside = (number for number, _ in with_operands(model, operands, int) if number >= first)
        return sum(sizes[calls[number - first].function] for number in inside)

    many = (number for number, count in uses.items() if number >= first and count * FEW > len(leaves))
    return sorted(number for number in many if size(number) > MUCH)


def _lifted_calls(
    all_calls: Sequence[RayCall], shared: Sequence[int], first: int, leaf: RayValue
) -> tuple[Calls, list[int]]:
    """The calls that make a leaf, uniform numbers as places in its row, and these numbers."""
    local = {k: k for k in range(first)} | {number: first + k for k, number in enumerate(shared)}
    calls: list[RayCall] = []
    uniforms: list[int] = []

    def own(value: RayValue) -> RayValue:
        if value.kind == MODEL:
            return RayValue(MODEL, local[value.number])
        uniforms.append(value.number)
        return RayValue(NUMBER, SCALE + len(uniforms))

    def operands(number: int) -> Sequence[int]:
        return () if number in local else _models(all_calls, first, number)

    if leaf.kind == MODEL:
        for number, _ in with_operands(leaf.number, operands, int):
            if number not in local:
                function, arguments = all_calls[number - first]
                calls.append(RayCall(function, tuple(map(own, arguments))))
                local[number] = first + len(shared) + len(calls) - 1
    return (tuple(calls), own(leaf)), uniforms


def _lifted_nodes(
    all_nodes: Sequence[Node], uniform: Sequence[bool], outputs: Sequence[int]
) -> tuple[Nodes, list[int]]:
    """The nodes of outputs, uniform ones as letters 0, 1, ... in their place, and these nodes."""
    local: dict[int, int] = {}
    nodes: list[Node] = []
    uniforms: list[int] = []

    def own(number: int) -> int:
        if not uniform[number]:
            return local[number]
        nodes.append(Node("input", (), f"{len(uniforms)}"))
        uniforms.append(number)
        return len(nodes) - 1

    def operands(number: int) -> Sequence[int]:
        return [argument for argument in all_nodes[number].arguments if not uniform[argument] and argument not in local]

    for output in outputs:
        for number, _ in with_operands(output, operands, int) if not uniform[output] else ():
            if number not in local:
                operation, arguments, data = all_nodes[number]
                nodes.append(Node(operation, tuple(map(own, arguments)), data))
                local[number] = len(nodes) - 1
    places = tuple(map(own, outputs))
    return (tuple(nodes), places), uniforms


def _formulas(coordinates: tuple[str, ...], nodes: Nodes, offset: int) -> Formulas:
    """Formulas whose letters are the places of a row from `offset` on."""
    letters = tuple(str(node.data) for node in nodes[0] if node.operation == "input" and node.data not in coordinates)
    outputs = tuple(zip(leaf_outputs(0), nodes[1], strict=True))
    return Formulas(Program(nodes[0], coordinates, letters, outputs), offset)
