"""The pieces of shapes that a model file may call: the functions of Python themselves."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from rsym.analysis.normalisation import normalise
from rsym.analysis.transformations import transform
from rsym.model.constructions import extrude, product, revolve, section, sweep
from rsym.model.shape import Shape
from rsym.model.thickness import offset, shell

# Given by the model as a whole, not by a call.
_FROM_THE_MODEL = ("letters", "system", "bounds", "coordinates")


@dataclass(frozen=True)
class Piece:
    """A function that makes a shape.

    shapes: how many of its first arguments are shapes. plane: whether those are plane shapes even in a model of space.
    space: whether what it makes is in space.
    """

    function: Callable[..., Any]
    shapes: int = 0
    plane: bool = False
    space: bool = False

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


_MOTIONS = (Shape.translate, Shape.rotate, Shape.scale, Shape.mirror, Shape.shear)
PIECES: Mapping[str, Piece] = dict(
    (
        *_named(*(Piece(motion, shapes=1) for motion in _MOTIONS)),
        *_named(
            *(Piece(function, shapes=1, plane=True, space=True) for function in (extrude, revolve, sweep, product))
        ),
        *_named(*(Piece(function, shapes=1) for function in (offset, shell, transform, normalise))),
        *_named(Piece(section, shapes=1, space=True)),
    )
)
# Those whose mention makes a model one of space.
SPACE = frozenset(name for name, piece in PIECES.items() if piece.space)
