"""The primitives by themselves; each is a name of `rsym` too."""

from rsym.analysis.normalisation import implicit
from rsym.model.primitives.curves import arc, circle, graph, helix, polyline, segment, space_curve
from rsym.model.primitives.helical import helicoid, helix_tube
from rsym.model.primitives.periodic import gyroid, lidinoid, neovius, schwarz_d, schwarz_p
from rsym.model.primitives.plane import disc, ellipse, half_plane, line, rectangle, strip, superellipse
from rsym.model.primitives.polygons import polygon, regular_polygon
from rsym.model.primitives.quadrics import ellipsoid, quadric, torus
from rsym.model.primitives.space import (
    box,
    capsule,
    cone,
    cylinder,
    double_cone,
    frustum,
    half_space,
    nappe,
    slab,
    sphere,
)

__all__ = [
    "arc",
    "box",
    "capsule",
    "circle",
    "cone",
    "cylinder",
    "disc",
    "double_cone",
    "ellipse",
    "ellipsoid",
    "frustum",
    "graph",
    "gyroid",
    "half_plane",
    "half_space",
    "helicoid",
    "helix",
    "helix_tube",
    "implicit",
    "lidinoid",
    "line",
    "nappe",
    "neovius",
    "polygon",
    "polyline",
    "quadric",
    "rectangle",
    "regular_polygon",
    "schwarz_d",
    "schwarz_p",
    "segment",
    "slab",
    "space_curve",
    "sphere",
    "strip",
    "superellipse",
    "torus",
]
