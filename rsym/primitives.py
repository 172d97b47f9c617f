"""The primitives by themselves; each is a name of `rsym` too."""

from rsym.model.primitives.arcs import arc, circle
from rsym.model.primitives.curves import graph, polyline, segment
from rsym.model.primitives.space_curves import helix, space_curve

__all__ = [
    "arc",
    "circle",
    "graph",
    "helix",
    "polyline",
    "segment",
    "space_curve",
]
