"""Leaves seen from far away: the sign of a function on a cone that goes to infinity.

A point with the direction u on the faces of the cube max|u_i| = 1 at the size s
is x = s u; with the nearness t = 1/s a node of degree d is

    f(u/t) = t**-d w(u, t),

and where w has a sign over a range of u and 0 <= t <= 1/B, f has the same sign
beyond the cube of half-side B in all those directions, at once: what needs
infinite intervals in x, where nothing is left of a difference, is a small box in
u and t. For a polynomial w is sum_k p_k(u) t**(d - k), but it is made node by
node, so a square stays a square; sums and R-operations bring their operands to
one degree first. What has no degree, sin and exp say, is kept as a function of x
of degree 0.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple, TypeAlias

from rsym.logic.sign_form import SignForm
from rsym.program.builder import Builder
from rsym.program.program import Node, live

NEARNESS = "nearness"


class Far(NamedTuple):
    """The node w and the degree d."""

    node: int
    degree: int


def direction_of(coordinate: str) -> str:
    """The name of the coordinate u that belongs to a coordinate x; no letter of a user has a space in its name."""
    return f"{coordinate} direction"


class FarForms:
    """The far forms of nodes of `source`, in a builder that has x, u and t as coordinates.

    Examples
    --------
    >>> source = Builder(("x", "y"), ())
    >>> x, y = source.input("x"), source.input("y")
    >>> forms = FarForms(source)
    >>> far = forms[source.add(source.square(x), y)]
    >>> far.degree, len(forms.builder.program({"value": far.node}))
    (2, 6)
    """

    def __init__(self, source: Builder) -> None:
        directions = [direction_of(name) for name in source.coordinates]
        self.source = source
        self.builder = Builder((*source.coordinates, *directions, NEARNESS), source.letters)
        self.forms: dict[int, Far] = {}
        self._near: dict[int, int] = {}

    def __getitem__(self, number: int) -> Far:
        self._make([number])
        return self.forms[number]

    def _make(self, numbers: Iterable[int]) -> None:
        b = self.builder
        for number in live(self.source.nodes, numbers):
            if number in self.forms:
                continue
            node = self.source.nodes[number]
            near = b.make(node.operation, *(self._near[argument] for argument in node.arguments), data=node.data)
            self._near[number] = near
            if node.operation == "input" and not self.source.uniform[number]:
                self.forms[number] = Far(b.input(direction_of(str(node.data))), 1)
            elif node.operation in RULES and not self.source.uniform[number]:
                self.forms[number] = RULES[node.operation](b, node, [self.forms[a] for a in node.arguments])
            else:
                self.forms[number] = Far(near, 0)


def far_leaves(form: SignForm) -> tuple[Builder, tuple[int, ...]]:
    """Nodes with the signs of the leaves of a form, in x, u and t."""
    forms = FarForms(form.builder)
    nodes = tuple(forms[leaf].node for leaf in form.leaves)
    return forms.builder, nodes


Rule: TypeAlias = Callable[[Builder, Node, Sequence[Far]], Far]


def _raised(b: Builder, part: Far, degree: int) -> int:
    """The node w at a higher degree: t to the difference times w."""
    return b.mul(b.powi(b.input(NEARNESS), degree - part.degree), part.node)


def _aligned(b: Builder, parts: Sequence[Far]) -> tuple[list[int], int]:
    degree = max(part.degree for part in parts)
    return [_raised(b, part, degree) for part in parts], degree


def _add(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    (u, v), degree = _aligned(b, parts)
    return Far(b.add(u, v), degree)


def _mul(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    u, v = parts
    return Far(b.mul(u.node, v.node), u.degree + v.degree)


def _div(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    u, v = parts
    return Far(b.div(u.node, v.node), u.degree - v.degree)


def _neg(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    return Far(b.neg(parts[0].node), parts[0].degree)


def _abs(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    return Far(b.abs(parts[0].node), parts[0].degree)


def _powi(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    assert isinstance(node.data, int)
    return Far(b.powi(parts[0].node, node.data), parts[0].degree * node.data)


def _sqrt(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    """An odd degree is raised to an even one first."""
    degree = parts[0].degree + parts[0].degree % 2
    return Far(b.sqrt(_raised(b, parts[0], degree)), degree // 2)


def _select(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    compared, _ = _aligned(b, parts[:2])
    branches, degree = _aligned(b, parts[2:])
    return Far(b.select(*compared, *branches), degree)


def _normalised(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    """f/sqrt(f**2 + q): q has twice the degree of f."""
    f, q = parts
    degree = max(f.degree, -(-q.degree // 2))
    return Far(b.normalised(_raised(b, f, degree), _raised(b, q, 2 * degree)), 0)


def _zero_with(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    f, g = parts
    return Far(b.zero_with(f.node, g.node), g.degree)


def _homogeneous(b: Builder, node: Node, parts: Sequence[Far]) -> Far:
    """What scales with its first two operands; the parameter comes last."""
    operands, degree = _aligned(b, parts[:2])
    return Far(b.make(node.operation, *operands, *(part.node for part in parts[2:])), degree)


RULES: dict[str, Rule] = {
    "add": _add,
    "mul": _mul,
    "div": _div,
    "neg": _neg,
    "abs": _abs,
    "powi": _powi,
    "sqrt": _sqrt,
    "select": _select,
    "normalised": _normalised,
    "zero_with": _zero_with,
    **dict.fromkeys(
        "min max r0_conjunction r0_disjunction r_alpha_conjunction r_alpha_disjunction"
        " rp_conjunction rp_disjunction equivalence joining norm".split(),
        _homogeneous,
    ),
}
