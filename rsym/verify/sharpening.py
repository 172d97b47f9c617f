"""A sharper bound of the curvature: the boxes with the largest bounds are divided until theirs is tight."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

from rsym.bounds.balls import ctx
from rsym.sampling.effort import Effort
from rsym.verify.covering import PRECISION, extent_of, halves
from rsym.verify.examination import Finding, examine
from rsym.verify.local import Box, Model

TIGHT = 0.05  # the share of the largest bound that may be due to its enclosure


def sharpened_bound(
    model: Model, settled: Sequence[tuple[Box, Finding]], bounds: Box, budget: int, effort: Effort | None = None
) -> float:
    """The largest curvature on the settled boxes, proved, from at most `budget` further boxes."""
    extent, effort, allowed = extent_of(bounds), effort or Effort(), budget
    heap = [(-f.curvature, n, box, f.slack) for n, (box, f) in enumerate(settled) if f.kind in {"regular", "joined"}]
    heapq.heapify(heap)
    count = len(settled)
    with ctx.workprec(PRECISION):
        while heap and heap[0][3] > TIGHT and budget > 0 and not effort.is_over:
            effort.reach(1 - budget / allowed)
            bound, _, box, _ = heapq.heappop(heap)
            for half in halves(model, box):
                finding = examine(model.over(half), extent)
                budget, count = budget - 1, count + 1
                if finding.kind == "open":
                    heapq.heappush(heap, (bound, count, half, 0.0))
                elif finding.kind != "empty":
                    heapq.heappush(heap, (max(bound, -finding.curvature), count, half, finding.slack))
    return -heap[0][0] if heap else 0.0
