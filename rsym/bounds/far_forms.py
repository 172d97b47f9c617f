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

from collections.abc import Iterable

from rsym.logic.sign_form import SignForm
from rsym.program.builder import Builder
from rsym.program.operations import OPERATIONS
from rsym.program.program import live
from rsym.program.row import NEARNESS, Far


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
            else:
                rule = None if self.source.uniform[number] else OPERATIONS[node.operation].far
                parts = [self.forms[argument] for argument in node.arguments]
                self.forms[number] = Far(near, 0) if rule is None else rule(b, node, parts)


def far_leaves(form: SignForm) -> tuple[Builder, tuple[int, ...]]:
    """Nodes with the signs of the leaves of a form, in x, u and t."""
    forms = FarForms(form.builder)
    nodes = tuple(forms[leaf].node for leaf in form.leaves)
    return forms.builder, nodes
