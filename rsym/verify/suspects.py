"""Suspects: what subdivision could not settle, gathered into points and classified."""

from __future__ import annotations

import math
from collections.abc import Sequence

from rsym.verify.covering import Box, Covering
from rsym.verify.local import Model
from rsym.verify.report import Joint

CROWD = 400  # boxes: points that resist leave one to thirty
# Kinds for which there is no curve whose curvature could be continuous.
DEGENERATIONS = frozenset({"node", "isolated point", "no sign change", "end"})


def classify_suspects(model: Model, region: Box, found: Covering) -> list[Joint]:
    """One joint for each cluster of boxes that are left; none if there are too many to be points."""
    result: list[Joint] = []
    if len(found.left) > CROWD:
        return result
    for cluster in clusters([box for box, _ in found.left]):
        centre = [math.fsum(box[k][0] + box[k][1] for box in cluster) / (2 * len(cluster)) for k in range(2)]
        radius = max(math.dist(centre, corner) for box in cluster for corner in zip(*box[:2], strict=True))
        result.append(Joint((centre[0], centre[1]), radius, "unresolved", "broken", reason="not classified"))
    return result


def clusters(boxes: Sequence[Box]) -> list[list[Box]]:
    """The boxes in groups of those that touch."""
    groups: list[list[Box]] = []
    for box in boxes:
        touching = [group for group in groups if any(_touch(box, other) for other in group)]
        for group in touching:
            groups.remove(group)
        groups.append([box, *(other for group in touching for other in group)])
    return groups


def _touch(a: Box, b: Box) -> bool:
    return all(a[k][0] <= b[k][1] and b[k][0] <= a[k][1] for k in range(2))
