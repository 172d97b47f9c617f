"""How the formation of a body is read off its program: what drops, what is absorbed, what factors are shared."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

from rsym.logic.sign_form import Signed, postorder, stripped
from rsym.program.builder import Builder
from rsym.program.operations import CONJUNCTIONS, LOGICAL
from rsym.verify.bodies.formation import Formation, Gate
from rsym.verify.bodies.relations import Relations
from rsym.verify.local import Model


class Tree(NamedTuple):
    """kind: "leaf" or "select" with its node or test, "min" or "max" of two or more trees of other kinds."""

    kind: str
    parts: tuple[Tree, ...] = ()
    node: int = -1


def formation(model: Model, legal: Callable[[int], bool]) -> Formation:
    """The formation of a model; `legal` says of an R-operation whether its parameter certainly is.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> corner = rsym.Shape(rsym.conjunction(x, 2 * y, -z), (x, y, z))
    >>> formation(Model(corner, {}), lambda number: True).gates
    (Gate(operation='min', first=0, second=1, test=-1), Gate(operation='min', first=3, second=2, test=-1))
    """
    done: dict[Signed, Tree] = {}
    builder, leaves = model.builder, []
    root = stripped(builder, model.root, 1)
    parts = list(postorder(root, lambda part: _operands(builder, part, legal)))
    for part, operands in parts:
        if not operands:
            leaves.append(part.number if part.sign > 0 else builder.neg(part.number))
    relations = Relations(model, leaves)
    for part, operands in parts:
        operation, arguments, _ = builder.nodes[part.number]
        if not operands:
            done[part] = _leaf(model, relations, part.number if part.sign > 0 else builder.neg(part.number))
        elif operation == "select":
            test = builder.sub(arguments[0], arguments[1])
            done[part] = Tree("select", tuple(done[operand] for operand in operands), test)
        else:
            kind = "min" if (operation in CONJUNCTIONS) == (part.sign > 0) else "max"
            done[part] = _combined(relations, kind, [done[operand] for operand in operands])
    formed = _numbered(builder, done[root])
    return replace(formed, definitions=tuple(dict.fromkeys(leaves)), origins=relations.origins)


def _leaf(model: Model, relations: Relations, leaf: int) -> Tree:
    """A leaf d*r with a factor d of other leaves has the sign of (d and r) or (-d and -r)."""
    pair = relations.split(leaf)
    if pair is None:
        return Tree("leaf", node=leaf)
    negated = [model.builder.neg(number) for number in pair]
    value = model.builder.value(pair[1])
    if value is not None:
        return Tree("leaf", node=pair[0] if value > 0 else negated[0])
    both = (Tree("min", tuple(Tree("leaf", node=number) for number in side)) for side in (pair, negated))
    return Tree("max", tuple(both))


def _combined(relations: Relations, kind: str, operands: Sequence[Tree]) -> Tree:
    """A min or max of all operands of its operands of the same kind, without those that never count."""
    flat: list[Tree] = []
    for operand in operands:
        flat.extend(operand.parts if operand.kind == kind else [operand])
    kept: list[Tree] = []
    for tree in dict.fromkeys(flat):
        if not any(_absorbs(relations, kind, other, tree) for other in kept):
            kept = [other for other in kept if not _absorbs(relations, kind, tree, other)] + [tree]
    return kept[0] if len(kept) == 1 else Tree(kind, tuple(kept))


def _absorbs(relations: Relations, kind: str, one: Tree, other: Tree) -> bool:
    return relations.comparable and _is_never_less(relations, *((other, one) if kind == "min" else (one, other)))


def _is_never_less(relations: Relations, p: Tree, q: Tree) -> bool:
    """Whether p >= q everywhere, as far as their forms and their leaves tell."""
    if p == q:
        return True
    if p.kind == q.kind == "leaf":
        return relations.is_never_less(p.node, q.node)
    if q.kind == "max":
        return all(_is_never_less(relations, p, part) for part in q.parts)
    if p.kind == "min":
        return all(_is_never_less(relations, part, q) for part in p.parts)
    if p.kind == "max":
        return any(_is_never_less(relations, part, q) for part in p.parts)
    return q.kind == "min" and any(_is_never_less(relations, p, part) for part in q.parts)


def _numbered(builder: Builder, tree: Tree) -> Formation:
    """The tree as leaves and gates of two, each part once; iterative, for trees may be deep."""
    leaves: dict[int, int] = {}
    tests: dict[int, int] = {}
    gates: list[tuple[str, _Place, _Place, int]] = []
    known: dict[Tree, _Place] = {}
    stack = [tree]
    while stack:
        part = stack[-1]
        waiting = [inner for inner in part.parts if inner not in known]
        if waiting:
            stack.extend(reversed(waiting))
            continue
        stack.pop()
        if part.kind == "leaf":
            known[part] = _Place(False, leaves.setdefault(part.node, len(leaves)))
        if part in known:
            continue
        place, *others = (known[inner] for inner in part.parts)
        for other in others:
            test = tests.setdefault(part.node, len(tests)) if part.kind == "select" else -1
            gates.append((part.kind, place, other, test))
            place = _Place(True, len(gates) - 1)
        known[part] = place
    count = len(leaves)
    numbered = (Gate(op, a.after(count), b.after(count), test) for op, a, b, test in gates)
    return Formation(builder, tuple(leaves), tuple(numbered), tuple(tests))


class _Place(NamedTuple):
    """A gate or a leaf by its number among its kind."""

    is_gate: bool
    number: int

    def after(self, leaves: int) -> int:
        """The number among leaves and gates together."""
        return self.number + leaves * self.is_gate


def _operands(builder: Builder, part: Signed, legal: Callable[[int], bool]) -> Sequence[Signed]:
    operation, arguments, _ = builder.nodes[part.number]
    if operation in LOGICAL and legal(part.number):
        return [stripped(builder, argument, part.sign) for argument in arguments[:2]]
    if operation == "select":
        return [stripped(builder, argument, part.sign) for argument in arguments[2:]]
    return ()
