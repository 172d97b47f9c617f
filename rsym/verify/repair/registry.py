"""The moves that are known by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

from rsym.errors import RsymError
from rsym.model.wording import listing, proposal
from rsym.verify.repair.blending import PaskoBlend, RhoBlend
from rsym.verify.repair.lettering import LetterMove
from rsym.verify.repair.moves import Move
from rsym.verify.repair.rounding import Round

MOVES: Mapping[str, Move] = MappingProxyType(
    {move.name: move for move in (LetterMove(), Round(), RhoBlend(), PaskoBlend())}
)


def chosen_moves(moves: Sequence[str | Move] | None) -> list[Move]:
    """The moves that are asked for, by name or as they are; all that are known for None.

    Examples
    --------
    >>> [move.name for move in chosen_moves(["round"])]
    ['round']
    """
    names = list(MOVES) if moves is None else moves
    if isinstance(names, str) or not isinstance(names, Sequence):
        raise RsymError(f"moves must be a list, got {moves!r}", code="move", remedy=f"such as {list(MOVES)[:2]}")
    for name in names:
        if not isinstance(name, Move) and name not in MOVES:
            raise RsymError(
                f"no move {name!r}; the moves are: {listing(MOVES)}",
                code="move",
                remedy=proposal(name, MOVES, "use one of these, or a Move of your own"),
            )
    return [name if isinstance(name, Move) else MOVES[name] for name in names]
