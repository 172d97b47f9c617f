"""How the formation of a body is read off its program: what drops, what is absorbed, what factors are shared.

Faces of a model often lie in one plane, or touch along a line because one body lies inside another. No box, however
small, tells that from near misses; exact division of leaves that are polynomials does.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import NamedTuple

import sympy as sp

from rsym.logic.gates import Gate, gate_of
from rsym.logic.sign_form import Operand, stripped
from rsym.logic.stripping import Signed
from rsym.model.symbols import with_operands
from rsym.program.builder import Builder
from rsym.program.lowering import lower
from rsym.verify.boxes.local import Model
from rsym.verify.boxes.polynomials import polynomial_of
from rsym.verify.cover.formation import Fork, Formation


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
    (Gate(operation='min', first=0, second=1), Gate(operation='min', first=3, second=2))
    """
    done: dict[Signed, Tree] = {}
    builder = model.builder
    root = stripped(builder, model.root)
    parts = list(with_operands(root, lambda part: _operands(builder, part, legal), tuple))
    leaves = [part.made(builder) for part, operands in parts if not operands]
    relations = Relations(model, leaves)
    for part, operands in parts:
        operation, arguments, _ = builder.nodes[part.number]
        if not operands:
            done[part] = _leaf(model, relations, part.made(builder))
        elif operation == "select":
            test = builder.sub(arguments[0], arguments[1])
            done[part] = Tree("select", tuple(done[operand] for operand in operands), test)
        else:
            kind = gate_of(operation, part.sign)
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
    gates: list[tuple[str, Operand, Operand, int]] = []
    known: dict[Tree, Operand] = {}
    stack = [tree]
    while stack:
        part = stack[-1]
        waiting = [inner for inner in part.parts if inner not in known]
        if waiting:
            stack.extend(reversed(waiting))
            continue
        stack.pop()
        if part.kind == "leaf":
            known[part] = Operand(False, leaves.setdefault(part.node, len(leaves)))
        if part in known:
            continue
        place, *others = (known[inner] for inner in part.parts)
        for other in others:
            test = tests.setdefault(part.node, len(tests)) if part.kind == "select" else -1
            gates.append((part.kind, place, other, test))
            place = Operand(True, len(gates) - 1)
        known[part] = place
    count = len(leaves)
    numbered: list[Gate | Fork] = []
    for kind, *operands, test in gates:
        first, second = (operand.after(count) for operand in operands)
        numbered.append(Fork(first, second, test) if kind == "select" else Gate(kind, first, second))
    return Formation(builder, tuple(leaves), tuple(numbered), tuple(tests))


def _operands(builder: Builder, part: Signed, legal: Callable[[int], bool]) -> Sequence[Signed]:
    operation, arguments, _ = builder.nodes[part.number]
    if gate_of(operation) and legal(part.number):
        return [stripped(builder, argument, part.sign) for argument in arguments[:2]]
    if operation == "select":
        return [stripped(builder, argument, part.sign) for argument in arguments[2:]]
    return ()


# What leaves that are polynomials have in common: a factor, or an order that holds everywhere.
HIGHEST, MOST = 8, 60  # degree and number of terms of a polynomial that is factored: a few milliseconds
MANY = 64  # leaves, beyond which pairs are not compared


class Relations:
    """Exact relations between leaves, each a node of the model."""

    def __init__(self, model: Model, leaves: Sequence[int]) -> None:
        self.model = model
        self.comparable = len(leaves) <= MANY
        self.leaves = tuple(dict.fromkeys(leaves)) if self.comparable else ()
        self.symbols = [sp.Symbol(name, real=True) for name in model.builder.coordinates]
        self.origins: dict[int, list[int]] = {}  # of a factor, the leaves that have it
        self._orders: dict[tuple[int, int], bool] = {}

    @cached_property
    def polynomials(self) -> dict[int, sp.Poly]:
        """The leaves that are polynomials of moderate size."""
        found: dict[int, sp.Poly] = {}
        for leaf in self.leaves:
            expression = polynomial_of(self.model, leaf)
            if expression is None:
                continue
            polynomial = sp.Poly(expression, *self.symbols, domain=sp.QQ)
            if 0 < polynomial.total_degree() <= HIGHEST and len(polynomial.terms()) <= MOST:
                found[leaf] = polynomial
        return found

    @cached_property
    def _factors(self) -> dict[int, tuple[sp.Rational, list[tuple[sp.Poly, int]]]]:
        return {leaf: polynomial.factor_list() for leaf, polynomial in self.polynomials.items()}

    @cached_property
    def _shared(self) -> set[sp.Poly]:
        """The irreducible factors of more than one leaf that is not just that factor itself."""
        counts = Counter(factor for _, factors in self._factors.values() for factor, _ in factors)
        reducible = {
            factor
            for _, factors in self._factors.values()
            for factor, power in factors
            if len(factors) > 1 or power > 1
        }
        same = {factor for factor, count in counts.items() if count > 1}
        return same & (reducible | {f for f in same if self._is_rescaled(f)})

    def _is_rescaled(self, factor: sp.Poly) -> bool:
        """Whether leaves are different multiples of one irreducible polynomial."""
        multiples = {constant for constant, factors in self._factors.values() if factors == [(factor, 1)]}
        return len(multiples) > 1

    def split(self, leaf: int) -> tuple[int, int] | None:
        """Nodes d, r such that the leaf has the sign of d*r; d is a factor that another leaf has too, r may be 1."""
        if leaf not in self.polynomials:
            return None
        constant, factors = self._factors[leaf]
        for factor, power in factors:
            if factor in self._shared and power % 2 == 1:
                powers = (f.as_expr() ** (p - 1 if f == factor else p) for f, p in factors)
                parts = [lower(self.model.builder, part) for part in (factor.as_expr(), sp.Mul(constant, *powers))]
                for part in parts:
                    self.origins.setdefault(part, []).append(leaf)
                return parts[0], parts[1]
        return None

    def is_never_less(self, f: int, g: int) -> bool:
        """Whether f >= g everywhere, by the factors of f - g."""
        if f == g:
            return True
        if f not in self.polynomials or g not in self.polynomials:
            return False
        if (f, g) not in self._orders:
            self._orders[f, g] = _is_nonnegative(self.polynomials[f] - self.polynomials[g])
        return self._orders[f, g]


def _is_nonnegative(polynomial: sp.Poly) -> bool:
    """Whether the factors of a polynomial show that it is never negative."""
    terms = polynomial.terms()
    highest = max(terms, key=lambda term: term[0])
    if highest[1] < 0 or any(power % 2 for power in highest[0]):
        return False  # along a ray it is negative far away, or on one side
    constant, factors = polynomial.factor_list()
    return constant >= 0 and all(power % 2 == 0 or _is_positive(factor) for factor, power in factors)


def _is_positive(factor: sp.Poly) -> bool:
    """Whether a polynomial of one variable has no real root, and a positive leading coefficient."""
    used = [symbol for symbol in factor.gens if factor.degree(symbol) > 0]
    if len(used) != 1:
        return False
    single = sp.Poly(factor.as_expr(), used[0], domain=sp.QQ)
    return bool(single.LC() > 0) and single.count_roots() == 0
