"""What the boxes of a proof say in sentences, and whether there is a boundary at all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

from flint import ctx

from rsym.codegen.balls import arb
from rsym.verify.covering import PRECISION, Covering
from rsym.verify.local import Model
from rsym.verify.report import Joint


def has_boundary(model: Model, found: Covering, joints: Sequence[Joint]) -> bool:
    """Whether a zero of omega is proved: a joint, or a regular box on whose corners its leaf has both signs."""
    if joints:
        return True
    with ctx.workprec(PRECISION):
        for box, finding in found.settled:
            if finding.kind in {"regular", "double"}:
                (leaf,) = finding.locus.nodes[:1]
                ranges = [arb(low).union(arb(high)) for low, high in box[2:]]
                signs = {model.on([arb(x), arb(y), *ranges]).sign(leaf) for x, y in product(*box[:2])}
                if {1, -1} <= signs:
                    return True
    return False


def statements(verdict: str, found: Covering, joints: Sequence[Joint], exists: bool) -> tuple[tuple[str, bool], ...]:
    """Sentences, each with whether it is proved."""
    kinds = [finding.kind for _, finding in found.settled]
    result = []
    if not exists:
        result.append(("no point of the boundary was found within the bounds", not found.settled and not found.left))
    if "double" in kinds:
        result.append(("omega is zero on a curve without changing its sign", True))
    if "regular" in kinds and exists:
        text = f"on {kinds.count('regular')} boxes the boundary is a regular analytic arc"
        orders = [finding.order for _, finding in found.settled if finding.kind == "regular"]
        if min(orders) < math.inf:
            level = math.ceil(min(orders)) - 1
            text = f"on {kinds.count('regular')} boxes the boundary is a regular arc of class C^{level}"
        result.append((text, True))
    if "joined" in kinds:
        result.append(
            (f"on {kinds.count('joined')} boxes it consists of two analytic arcs that meet in one point", True)
        )
    if found.left:
        result.append((f"on {len(found.left)} boxes nothing is proved of the boundary as a whole", False))
    for joint in joints:
        place = ", ".join(f"{value:.10g}" for value in joint.point)
        result.append((f"at ({place}): {joint.kind}, {joint.continuity}; {joint.reason}", joint.proved))
    return tuple(result)
