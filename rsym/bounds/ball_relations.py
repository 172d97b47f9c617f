"""Balls of products and quotients whose operands have something in common."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rsym.bounds.ball_arithmetic import arb, direction, square
from rsym.bounds.ball_parameters import norm_share
from rsym.bounds.ball_systems import gap_share, share
from rsym.bounds.relations import relation
from rsym.program.program import Node

Image = Callable[..., arb | None]
IMAGES: dict[str, Image] = {
    "square": square,
    "direction": direction,
    "share": share,
    "norm_share": norm_share,
    "gap_share": gap_share,
}


def related(nodes: Sequence[Node], number: int) -> tuple[Image, tuple[int, ...]] | None:
    """The image of a product or quotient and the nodes it takes, if its operands are related."""
    found = relation(nodes, number)
    return None if found is None else (IMAGES[found[0]], found[1])
