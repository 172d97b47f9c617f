"""The pieces of shapes that a model file may call: the functions of Python themselves."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from rsym.analysis.implicit import implicit
from rsym.analysis.normalisation import normalise
from rsym.analysis.transformations import transform
from rsym.model.blends.displacement import bounded_blend, displacement_blend
from rsym.model.blends.fillets import fillet
from rsym.model.constructions import extrude, product, revolve, section, sweep
from rsym.model.primitives.arcs import arc, circle
from rsym.model.primitives.cones import cone, double_cone, frustum, nappe
from rsym.model.primitives.curves import graph, polyline, segment
from rsym.model.primitives.helical import helicoid, helix_tube
from rsym.model.primitives.periodic import gyroid, lidinoid, neovius, schwarz_d, schwarz_p
from rsym.model.primitives.plane import disc, ellipse, half_plane, line, rectangle, strip, superellipse
from rsym.model.primitives.polygons import polygon, regular_polygon
from rsym.model.primitives.quadrics import ellipsoid, quadric, torus
from rsym.model.primitives.space import box, capsule, cylinder, half_space, slab, sphere
from rsym.model.primitives.space_curves import helix, space_curve
from rsym.model.shape import Shape
from rsym.model.skeletons import blend_on_skeleton
from rsym.model.symmetry.cyclic import cyclic
from rsym.model.symmetry.mirrors import kaleidoscope, mirror_group, mirrored
from rsym.model.symmetry.rows import grid, row
from rsym.model.symmetry.screws import coil, screw, wound
from rsym.model.symmetry.waves import triangle_wave
from rsym.model.thickness import offset, shell

# What a formula grows with.
_MOST = {**dict.fromkeys(("order", "sides", "count", "counts", "starts"), 400), "terms": 100}
# Given by the model as a whole, not by a call.
_FROM_THE_MODEL = ("letters", "system", "bounds", "coordinates")


@dataclass(frozen=True)
class Piece:
    """A function that makes a shape, or an expression.

    shapes: how many of its first arguments are shapes. plane: whether those are plane shapes even in a model of space.
    space: whether what it makes is in space. most: the largest number of what is counted by a parameter.
    """

    function: Callable[..., Any]
    shapes: int = 0
    plane: bool = False
    space: bool = False
    most: Mapping[str, int] = field(default_factory=lambda: _MOST)

    @cached_property
    def signature(self) -> inspect.Signature:
        """The parameters that a call in a model may give."""
        whole = inspect.signature(self.function)
        kept = [
            parameter.replace(name="shape") if name == "self" else parameter
            for name, parameter in whole.parameters.items()
            if name not in _FROM_THE_MODEL
        ]
        return whole.replace(parameters=kept)

    def takes(self, name: str) -> bool:
        """Whether the function has this parameter."""
        return name in inspect.signature(self.function).parameters


def _named(*pieces: Piece) -> Iterator[tuple[str, Piece]]:
    return ((piece.function.__name__, piece) for piece in pieces)


_SWEPT = (extrude, product, revolve, sweep, wound)
_OF_ONE = (
    *(Shape.translate, Shape.rotate, Shape.scale, Shape.mirror, Shape.shear),
    *(implicit, offset, shell, transform),
    *(cyclic, grid, kaleidoscope, mirror_group, mirrored, row),
)
PIECES: Mapping[str, Piece] = dict(
    (
        *_named(*(Piece(function) for function in (arc, circle, graph, polyline, quadric, segment, triangle_wave))),
        *_named(*(Piece(function) for function in (disc, ellipse, half_plane, line, polygon, rectangle))),
        *_named(*(Piece(function) for function in (regular_polygon, strip, superellipse))),
        *_named(*(Piece(function, space=True) for function in (box, capsule, cylinder, half_space, slab, sphere))),
        *_named(*(Piece(function, space=True) for function in (cone, double_cone, ellipsoid, frustum, nappe, torus))),
        *_named(*(Piece(function, space=True) for function in (gyroid, lidinoid, neovius, schwarz_d, schwarz_p))),
        *_named(*(Piece(function, space=True) for function in (coil, helicoid, helix, helix_tube))),
        *_named(*(Piece(function, 1) for function in _OF_ONE)),
        # To order 3 a hundred terms take seconds, a car for ever.
        *_named(Piece(normalise, 1, most={"order": 2})),
        *_named(*(Piece(function, 1, plane=True, space=True) for function in _SWEPT)),
        *_named(*(Piece(function, 1, space=True) for function in (screw, section))),
        *_named(*(Piece(function, 2) for function in (blend_on_skeleton, displacement_blend, fillet))),
        *_named(Piece(space_curve, 2, space=True), Piece(bounded_blend, 3)),
    )
)
# Those whose mention makes a model one of space.
SPACE = frozenset(name for name, piece in PIECES.items() if piece.space)
