"""How operations scale: their forms far away, which rows give to `far_forms`."""

from __future__ import annotations

from collections.abc import Sequence

from rsym.program.program import Node
from rsym.program.row import Far, Nodes

NEARNESS = "nearness"


def raised(b: Nodes, part: Far, degree: int) -> int:
    """The node w at a higher degree: t to the difference times w."""
    return b.mul(b.powi(b.input(NEARNESS), degree - part.degree), part.node)


def aligned(b: Nodes, parts: Sequence[Far]) -> tuple[list[int], int]:
    """The nodes at their highest degree."""
    degree = max(part.degree for part in parts)
    return [raised(b, part, degree) for part in parts], degree


def homogeneous(b: Nodes, node: Node, parts: Sequence[Far]) -> Far:
    """What scales with its first two operands; the parameter comes last."""
    operands, degree = aligned(b, parts[:2])
    return Far(b.make(node.operation, *operands, *(part.node for part in parts[2:])), degree)
