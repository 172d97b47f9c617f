"""Table 1 again: time and memory of drawing the valve against the number of points and of sub-boxes.

The box round the body is cut into sub-boxes, each is sampled and meshed on its
own, and only one of them is in memory at a time, as the source describes it.
"""

from __future__ import annotations

import itertools
import math
import time
import tracemalloc
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from rsym.errors import RsymError
from rsym.model.shape import Bounds, Shape
from rsym.paper.drawing import mesh_quietly
from rsym.paper.models import valve
from rsym.sampling.mesh import Mesh

# Along each axis: 0.125, 1, 3.375 and 15.625 million points; the source has 27 and 125 boxes of 50 points cubed.
POINTS = (50, 100, 150, 250)
BOXES = (1, 3, 5)


@dataclass(frozen=True)
class Cost:
    """What drawing took with so many points and sub-boxes."""

    points: int
    boxes: int
    seconds: float
    megabytes: float
    triangles: int


def measure() -> tuple[Cost, ...]:
    """Every combination once: first for the seconds, then again for the memory, since watching memory takes time.

    Then boxes that hold no surface are left out: they take less than those that do.

    The memory is the peak of what Python and NumPy hold, the triangles of all boxes included, as tracemalloc
    counts it; what the interpreter and compiled code take for themselves is not in it.
    """
    shape = valve()
    meshes(shape, 20, 1)  # compiles
    return tuple(_cost(shape, points, boxes) for points in POINTS for boxes in BOXES)


def _cost(shape: Shape, points: int, boxes: int) -> Cost:
    start = time.perf_counter()
    pieces = meshes(shape, points, boxes)
    seconds = time.perf_counter() - start
    triangles, held = sum(piece.status.triangles for piece in pieces.values()), list(pieces)
    del pieces
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    meshes(shape, points, boxes, held)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return Cost(points**3, boxes**3, seconds, (peak - before) / 1e6, triangles)


def meshes(shape: Shape, points: int, boxes: int, only: Iterable[Bounds] = ()) -> dict[Bounds, Mesh]:
    """The surface in each box that holds some, `points` and `boxes` along each axis; `only` in these, if any are given.

    Examples
    --------
    >>> import rsym
    >>> from rsym import x, y, z
    >>> ball = rsym.Shape(1 - x**2 - y**2 - z**2, (x, y, z), bounds=((-2, 2),) * 3)
    >>> len(meshes(ball, 30, 1)), len(meshes(ball, 30, 3))
    (1, 21)
    """
    assert shape.bounds is not None
    # The mesher adds a layer of points on either side, so that neighbouring boxes overlap instead of leaving gaps.
    cells = max(2, math.ceil(points / boxes) - 2)
    pieces = {}
    for box in only or _sub_boxes(shape.bounds, boxes):
        try:
            # All points of a box are sampled, as in the source.
            pieces[box] = mesh_quietly(shape, (cells,) * len(box), method="smooth", bounds=box)
        except RsymError as error:
            if error.code != "no-surface":
                raise
    return pieces


def _sub_boxes(bounds: Bounds, boxes: int) -> list[Bounds]:
    cuts = [np.linspace(low, high, boxes + 1).tolist() for low, high in bounds]
    return list(itertools.product(*(list(itertools.pairwise(cut)) for cut in cuts)))
