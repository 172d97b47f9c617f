"""What the sheets of a boundary are called: by the definitions that they come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rsym.logic.leaf_names import leaf_names
from rsym.logic.sign_form import SignForm
from rsym.model.shape import Shape
from rsym.program.builder import Builder
from rsym.program.program import live

NUMBERED = "leaf "  # a definition without a name whose formula is too long to be one
BETWEEN = " / "  # what stands between the names of definitions that have a face in common


class Naming:
    """Names of nodes: that of the definition itself, of the one that a factor or a continued sheet was made of.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> from rsym.verify.local import Model
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z)).named("ball")
    >>> shape = ball & rsym.Shape(z, (x, y, z)).named("table")
    >>> model = Model(shape, {})
    >>> naming = Naming(shape, model.builder, model.builder.nodes[model.root].arguments, {})
    >>> [naming(node) for node in model.builder.nodes[model.root].arguments]
    ['ball', 'table']
    """

    def __init__(
        self, shape: Shape, builder: Builder, definitions: Sequence[int], origins: Mapping[int, Sequence[int]]
    ) -> None:
        self._builder = builder
        names = leaf_names(SignForm(builder, tuple(definitions), ()), shape)
        if len(names) == 1 and names[0].startswith(NUMBERED):
            names = ("omega",)
        self._names = dict(zip(definitions, names, strict=True))
        for node, own in origins.items():
            self._names[node] = BETWEEN.join(dict.fromkeys(self._names[one] for one in own))
        self._parts = {node: frozenset(live(builder.nodes, [node])) for node in self._names}

    def __call__(self, node: int) -> str:
        """The name of a node, or of its negative; of others that of the definition with which it shares most."""
        for one in (node, self._builder.neg(node)):
            if one in self._names:
                return self._names[one]
        own = frozenset(live(self._builder.nodes, [node]))
        shares = {one: len(own & parts) / len(own | parts) for one, parts in self._parts.items()}
        self._names[node] = name = self._names[max(shares, key=lambda one: (shares[one], -one))]
        return name
