"""What the boxes of a proof say in sentences, and whether there is a boundary at all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

from flint import ctx

from rsym.codegen.balls import arb
from rsym.verify.covering import PRECISION, Covering, side
from rsym.verify.local import Model
from rsym.verify.report import Joint
from rsym.verify.wording import plural


def has_boundary(model: Model, found: Covering, joints: Sequence[Joint]) -> bool:
    """Whether a zero of omega is proved: a joint, or a settled box on which omega has both signs.

    There omega has the sign of a continuous function, so it has a zero; of a double zero the inner function counts.
    """
    if joints:
        return True
    with ctx.workprec(PRECISION):
        for box, finding in found.settled:
            number = finding.locus.nodes[0] if finding.locus.kind in {"leaf", "double"} else model.root
            ranges = [side(*ends) for ends in box[2:]]
            points = product(*((low, low + (high - low) / 2, high) for low, high in box[:2]))
            if {1, -1} <= {model.on([arb(x), arb(y), *ranges]).sign(number) for x, y in points}:
                return True
    return False


def statements(found: Covering, exists: bool) -> tuple[tuple[str, bool], ...]:
    """Sentences about the whole boundary, each with whether it is proved; joints speak for themselves."""
    kinds = [finding.kind for _, finding in found.settled]
    result = []
    if not exists:
        empty = not found.settled and not found.left
        result.append((f"no point of the boundary {'lies' if empty else 'was found'} within the bounds", empty))
    if "double" in kinds:
        result.append(("omega is zero on a curve without changing its sign", True))
    if "regular" in kinds and exists:
        orders = [finding.order for _, finding in found.settled if finding.kind == "regular"]
        level = min(orders)
        smooth = "analytic arc" if level == math.inf else f"arc of class C^{math.ceil(level) - 1}"
        result.append((f"on {boxes(kinds.count('regular'))} the boundary is a regular {smooth}", True))
    if "joined" in kinds:
        text = f"on {boxes(kinds.count('joined'))} it consists of two analytic arcs that meet in one point"
        result.append((text, True))
    if found.left:
        result.append((f"on {boxes(len(found.left))} nothing is proved of the boundary as a whole", False))
    return tuple(result)


def boxes(count: int) -> str:
    """So many boxes."""
    return plural(count, "box", "boxes")
