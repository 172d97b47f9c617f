"""The pieces of shapes that a model file may call: the functions of Python themselves, a row for each.

Whatever is told of pieces follows from here: calls in the language, the names of `rsym` and of `rsym.primitives`,
the table of the README (`python tests/stubs.py` writes these three). So a new primitive is its function, with its
docstring, in a module of `model/primitives`, and its name in a row below.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from operator import attrgetter
from typing import Any

# What a formula grows with.
_MOST = {**dict.fromkeys(("order", "sides", "count", "counts", "starts"), 400), "terms": 100}
# Given by the model as a whole, not by a call.
_FROM_THE_MODEL = ("letters", "system", "bounds", "coordinates")


@dataclass(frozen=True)
class Piece:
    """A function that makes a shape, or an expression.

    home: its module in the package, where `Shape` stands for methods. family: what it is listed under.
    shapes: how many of its first arguments are shapes. plane: whether those are plane shapes even in a model of space.
    space: whether what it makes is in space. most: the largest number of what is counted by a parameter.
    """

    name: str
    home: str
    family: str
    shapes: int = 0
    plane: bool = False
    space: bool = False
    most: Mapping[str, int] = field(default_factory=lambda: _MOST)

    @property
    def is_method(self) -> bool:
        """Whether it is a method of `Shape`."""
        return self.home == "model.shape"

    @property
    def is_primitive(self) -> bool:
        """Whether it makes a shape of numbers, or of an expression: a name of `rsym.primitives`."""
        return self.home.startswith("model.primitives.") or self.name == "implicit"

    @cached_property
    def function(self) -> Callable[..., Any]:
        """The function, imported when it is first called."""
        path = f"Shape.{self.name}" if self.is_method else self.name
        found: Callable[..., Any] = attrgetter(path)(import_module(f"rsym.{self.home}"))
        return found

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


def _row(family: str, home: str, names: str, **more: Any) -> Iterator[tuple[str, Piece]]:
    return ((name, Piece(name, home, family, **more)) for name in names.split())


_PLANE, _CURVES, _SPACE = "in the plane", "curves, zero on them", "in space"
_PERIODIC, _ANY, _MOVED = "along a screw, in all directions", "any expression", "moved"
_SWEPT, _REPEATED, _BLENDED = "of another dimension or thickness", "repeated", "blended"
# Families and homes may stand in several rows; a piece stands in one.
PIECES: Mapping[str, Piece] = dict(
    (
        *_row(_PLANE, "model.primitives.plane", "half_plane strip line disc ellipse superellipse rectangle"),
        *_row(_PLANE, "model.primitives.polygons", "polygon regular_polygon"),
        *_row(_CURVES, "model.primitives.curves", "segment polyline graph"),
        *_row(_CURVES, "model.primitives.arcs", "circle arc"),
        *_row(_CURVES, "model.primitives.space_curves", "helix", space=True),
        *_row(_CURVES, "model.primitives.space_curves", "space_curve", shapes=2, space=True),
        *_row(_SPACE, "model.primitives.space", "half_space slab sphere box cylinder capsule", space=True),
        *_row(_SPACE, "model.primitives.cones", "cone frustum nappe double_cone", space=True),
        *_row(_SPACE, "model.primitives.quadrics", "ellipsoid torus", space=True),
        *_row(_SPACE, "model.primitives.quadrics", "quadric"),
        *_row(_PERIODIC, "model.primitives.helical", "helicoid helix_tube", space=True),
        *_row(_PERIODIC, "model.symmetry.screws", "coil", space=True),
        *_row(_PERIODIC, "model.primitives.periodic", "gyroid schwarz_p schwarz_d neovius lidinoid", space=True),
        *_row(_ANY, "analysis.implicit", "implicit", shapes=1),
        # To order 3 a hundred terms take seconds, a car for ever.
        *_row(_ANY, "analysis.normalisation", "normalise", shapes=1, most={"order": 2}),
        *_row(_MOVED, "model.shape", "translate rotate scale mirror shear", shapes=1),
        *_row(_MOVED, "analysis.transformations", "transform", shapes=1),
        *_row(_SWEPT, "model.constructions", "extrude revolve product sweep", shapes=1, plane=True, space=True),
        *_row(_SWEPT, "model.constructions", "section", shapes=1, space=True),
        *_row(_SWEPT, "model.thickness", "offset shell", shapes=1),
        *_row(_REPEATED, "model.symmetry.cyclic", "cyclic", shapes=1),
        *_row(_REPEATED, "model.symmetry.rows", "row grid", shapes=1),
        *_row(_REPEATED, "model.symmetry.mirrors", "mirrored kaleidoscope mirror_group", shapes=1),
        *_row(_REPEATED, "model.symmetry.screws", "screw", shapes=1, space=True),
        *_row(_REPEATED, "model.symmetry.screws", "wound", shapes=1, plane=True, space=True),
        *_row(_REPEATED, "model.symmetry.waves", "triangle_wave"),
        *_row(_BLENDED, "model.blends.fillets", "fillet", shapes=2),
        *_row(_BLENDED, "model.blends.displacement", "displacement_blend", shapes=2),
        *_row(_BLENDED, "model.blends.displacement", "bounded_blend", shapes=3),
        *_row(_BLENDED, "model.skeletons", "blend_on_skeleton", shapes=2),
    )
)
# Those whose mention makes a model one of space.
SPACE = frozenset(name for name, piece in PIECES.items() if piece.space)
