"""How far a body that was grown or shrunk is from the one that it was made of, measured on the boundaries of both."""

from __future__ import annotations

import warnings

import numpy as np

from rsym.errors import RsymError, RsymWarning, warn
from rsym.model.shape import Shape
from rsym.sampling.distances import distance_to_lines, distance_to_mesh
from rsym.sampling.extent import extent
from rsym.sampling.level_lines import level_lines
from rsym.sampling.meshing import mesh

RESOLUTION = {2: 256, 3: 40}
SHARE = 0.01  # of the distance asked for: what is less off than this is not told
CHORD = 1e-3  # of the size, in space: chords of a mesh of this resolution are off by less where it is smooth


def tell_of_range(body: Shape, moved: Shape, distance: float, what: str, why: str) -> None:
    """Warn of the least and the largest distance of the boundary of `moved` from that of the body, if they differ.

    Where the two have no bounds, which cannot be measured, the warning says why alone.
    """
    if distance == 0:
        return
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RsymWarning)
            found = _range(body, moved, abs(distance))
    except RsymError as error:
        if error.code != "empty":
            warn(f"the {what} may differ from {abs(distance):g}, and it could not be measured: {why}")
        return
    if found is not None:
        low, high = found
        warn(f"the {what} is {low:.4g} to {high:.4g} instead of {abs(distance):g}: {why}")


def _range(body: Shape, moved: Shape, distance: float) -> tuple[float, float] | None:
    """The least and the largest distance, None where they are the one asked for."""
    boxes = extent(body), extent(moved)
    size = max(high - low for low, high in boxes[0])
    if body.dimension == 2:
        lines, others = (
            level_lines(one, bounds=box, resolution=RESOLUTION[2])
            for one, box in zip((body, moved), boxes, strict=True)
        )
        found = distance_to_lines(np.concatenate(list(others)), list(lines))
    else:
        faces, walls = (mesh(one, RESOLUTION[3], bounds=box) for one, box in zip((body, moved), boxes, strict=True))
        found = distance_to_mesh(walls.vertices, faces)
    low, high = float(found.min()), float(found.max())
    slack = max(SHARE * distance, CHORD * size)
    return (low, high) if low < distance - slack or high > distance + slack else None
