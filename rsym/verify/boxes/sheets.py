"""The sheets on one box: the leaves that can be the boundary there, and the formula of signs that joins them.

What `locus` does for two leaves is done here for any number: conjunctions and disjunctions to any depth, products,
and leaves that are sums of |u|, min and max, each of which falls into the smallest or largest of its pieces:
a - |u| = min(a - u, a + u).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from rsym.logic.gates import gate_of
from rsym.logic.kleene import Connective, Formula, Literal, as_gate, joined, leaves_of, replaced, without_idle
from rsym.logic.stripping import bare, factor
from rsym.program.builder import Builder
from rsym.program.operations import PARTIAL
from rsym.program.program import live
from rsym.verify.boxes.domains import is_defined, is_defined_itself, is_legal
from rsym.verify.boxes.generators import generators
from rsym.verify.boxes.local import Local
from rsym.verify.boxes.locus import NONE, Locus, chosen, reduce, stripping
from rsym.verify.boxes.polynomials import same_zeros
from rsym.verify.boxes.vectors import dot, sign_of

MOST = 12  # leaves: a box with more of them is divided


@dataclass(frozen=True)
class Sheets:
    """The leaves of a formula, nodes that are positive inside of their own; `origins`, where each was found."""

    leaves: tuple[int, ...]
    formula: Formula
    origins: tuple[int, ...]


def sheets(local: Local, number: int) -> Sheets | None:
    """The sheets of the zero set of a node on a box; None where they are not known, no leaves where there is no zero.

    Wherever the node is defined on the box, its sign is that of the formula.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.verify.boxes.local import Model
    >>> model = Model(rsym.Shape(rsym.conjunction(x, -rsym.conjunction(y, z)), (x, y, z)), {})
    >>> found = sheets(model.over(((-1, 1),) * 3), model.root)
    >>> len(found.leaves), found.formula.operation, found.formula.operands[1].operation
    (3, 'min', 'max')
    """
    return local.made(_sheets, number)


def _sheets(local: Local, number: int) -> Sheets | None:
    origins: dict[int, int] = {}
    formula = _formula(local, number, origins)
    if formula is None or len(leaves_of(formula)) > 2 * MOST:
        return None
    formula = _merged(local, formula)
    if len(leaves_of(formula)) > MOST:
        return None
    formula = without_idle(formula)
    leaves = leaves_of(formula)
    if leaves and _drops_undefined(local, number, leaves):
        return None
    return Sheets(leaves, formula, tuple(origins[leaf] for leaf in leaves))


def _drops_undefined(local: Local, number: int, leaves: tuple[int, ...]) -> bool:
    """Whether a part that no leaf keeps may be undefined on the box: there the node has no boundary either."""
    model = local.model
    nodes, doubtful = model.builder.nodes, model.made(_doubtful, number)
    if not doubtful:
        return False
    local.value(number)  # and of all that it is made of
    stack, seen = [number], set().union(*(model.made(_doubtful, leaf) for leaf in leaves))
    while stack:
        part = stack.pop()
        if part in seen or part not in doubtful:
            continue
        seen.add(part)
        operation, arguments, _ = nodes[part]
        if operation == "normalised":
            if not is_defined(local, arguments[1], but_for_thin_sets=True):
                return True
            stack.append(arguments[0])
        elif operation in PARTIAL and not is_defined_itself(local, part):
            return True
        elif operation == "select" and (branch := chosen(local, part)) is not None:
            stack.extend((*arguments[:2], branch[0]))  # a branch that is not taken may be undefined
        else:
            stack.extend(arguments)
    return False


def _doubtful(builder: Builder, number: int) -> frozenset[int]:
    """The parts of a node that may be undefined somewhere, by themselves or by what they are made of."""
    found: set[int] = set()
    for part in live(builder.nodes, [number]):
        operation, arguments, _ = builder.nodes[part]
        if operation in PARTIAL or not found.isdisjoint(arguments):
            found.add(part)
    return frozenset(found)


def locus_of(local: Local, number: int) -> Locus:
    """The locus of a node on a box; of several leaves only those count that the logic needs."""
    locus = reduce(local, number)
    if locus.kind not in {"several", "conjunction", "disjunction", "product"}:
        return locus
    found = sheets(local, number)
    if found is None or len(found.leaves) > 2:
        return locus
    b, leaves, single = local.model.builder, found.leaves, as_gate(found.formula)
    if not leaves:
        return NONE
    if single is None:
        return Locus("double", leaves) if len(leaves) == 1 else locus
    operation, signs = single
    nodes = tuple(leaf if sign > 0 else b.neg(leaf) for leaf, sign in zip(leaves, signs, strict=True))
    return Locus("leaf" if len(leaves) == 1 else "conjunction" if operation == "min" else "disjunction", nodes)


def _formula(local: Local, number: int, origins: dict[int, int]) -> Formula | None:
    """The signs of a node by those of its leaves, recursively wherever the operation changes."""
    local.value(number)  # and of all that it is made of, at once
    number, sign = stripping(local)(number)
    known = local.sign(number)
    if known and is_defined(local, number):
        return known * sign
    operation = local.model.builder.nodes[number].operation
    if (word := gate_of(operation)) and is_legal(local, number):
        return _times(_chained(local, number, word, origins), sign)
    locus = reduce(local, number)
    if locus.kind == "leaf":
        return _times(_leaf(local, locus.nodes[0], number, origins), sign)
    if locus.kind == "product":
        return _times(_gate("product", [_formula(local, node, origins) for node in locus.nodes]), sign)
    return None


def _times(formula: Formula | None, sign: int) -> Formula | None:
    return None if formula is None else joined("product", sign, formula)


def _gate(operation: str, operands: list[Formula | None]) -> Formula | None:
    found = [operand for operand in operands if operand is not None]
    return joined(operation, *found) if len(found) == len(operands) else None


def _chained(local: Local, number: int, word: str, origins: dict[int, int]) -> Formula | None:
    """The operands of a chain of one kind of operation; a known sign that absorbs the others settles it."""
    nodes, operands, stack = local.model.builder.nodes, [], [number]
    while stack:
        part = stack.pop()
        operation, arguments, _ = nodes[part]
        if gate_of(operation) == word and is_legal(local, part):
            stack.extend(reversed(arguments[:2]))
        elif local.sign(part) == (-1 if word == "min" else 1):
            return local.sign(part)
        else:
            operands.append(part)
    return _gate(word, [_formula(local, part, origins) for part in operands])


def _leaf(local: Local, leaf: int, origin: int, origins: dict[int, int]) -> Formula | None:
    """One leaf, or the pieces of one that is a sum of absolute values."""
    builder = local.model.builder
    if generators(local, leaf).switches:
        pieces = _pieces(local, leaf)
        if isinstance(pieces, Connective):
            found: dict[int, Formula | None] = {}
            for piece in leaves_of(pieces):
                found[piece] = _formula(local, piece, origins)
            known = {piece: formula for piece, formula in found.items() if formula is not None}
            for inner in (inner for formula in known.values() for inner in leaves_of(formula)):
                origins[inner] = origin
            return replaced(pieces, known) if len(known) == len(found) else None
    own = bare(builder, leaf)
    node = next((other for other in origins if bare(builder, other) == own), leaf)
    origins.setdefault(node, origin)
    return Literal(node, factor(builder, node) * factor(builder, leaf))


def _pieces(local: Local, number: int) -> Formula:
    """A node as min and max of others, equal to it in value."""
    builder = local.model.builder
    operation, arguments, _ = builder.nodes[number]
    if not generators(local, number).switches:
        return Literal(number)
    if operation in {"abs", "min", "max", "select"} and (branch := chosen(local, number)) is not None:
        return _pieces(local, branch[0] if branch[1] > 0 else builder.neg(branch[0]))
    if operation == "abs" and is_defined(local, arguments[0]):
        return Connective("max", (Literal(arguments[0]), Literal(builder.neg(arguments[0]))))
    if operation in {"min", "max"} and is_defined(local, number):
        return Connective(operation, (_pieces(local, arguments[0]), _pieces(local, arguments[1])))
    if operation == "neg":
        return _mapped(_pieces(local, arguments[0]), builder.neg, -1)
    if operation == "add":
        first, second = _pieces(local, arguments[0]), _pieces(local, arguments[1])
        return _sums(first, second, builder.add)
    if operation == "mul":
        for own, other in (arguments, arguments[::-1]):
            if local.sign(own) and generators(local, own).analytic:
                return _mapped(_pieces(local, other), partial(builder.mul, own), local.sign(own))
    return Literal(number)


def _mapped(pieces: Formula, rule: Callable[[int], int], sign: int) -> Formula:
    """The pieces under a function that grows with them, or falls."""
    if isinstance(pieces, Connective):
        operation = pieces.operation if sign > 0 else {"min": "max", "max": "min"}[pieces.operation]
        return Connective(operation, tuple(_mapped(operand, rule, sign) for operand in pieces.operands))
    assert isinstance(pieces, Literal)
    return Literal(rule(pieces.leaf))


def _sums(first: Formula, second: Formula, add: Callable[[int, int], int]) -> Formula:
    """min(a, b) + c = min(a + c, b + c)."""
    if isinstance(first, Connective):
        return Connective(first.operation, tuple(_sums(operand, second, add) for operand in first.operands))
    assert isinstance(first, Literal)
    return _mapped(second, partial(add, first.leaf), 1)


def _merged(local: Local, formula: Formula) -> Formula:
    """Leaves that are one polynomial, up to the sign, are one leaf; only tried of those that nearly are."""
    leaves, same = leaves_of(formula), {}
    for n, leaf in enumerate(leaves):
        for other in leaves[:n]:
            sign = _direction(local, leaf, other) if other not in same else 0
            if sign and same_zeros(local.model, leaf, other):
                same[leaf] = Literal(other, sign)
                break
    return replaced(formula, same)


def _direction(local: Local, first: int, second: int) -> int:
    """1 or -1 where two gradients may be parallel everywhere and certainly make an acute or an obtuse angle."""
    a, b = local.gradient(first), local.gradient(second)
    if not all((a[i] * b[j] - a[j] * b[i]).contains(0) for i in range(len(a)) for j in range(i)):
        return 0
    return sign_of(dot(a, b))
